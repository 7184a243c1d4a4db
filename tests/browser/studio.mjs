/** The studio's modules at hand of a test: `studio.NAME` are their exports. */

const NAMES = [
  "arranging", "gestures", "pressure",
  "arrangement", "drop", "draw_photo", "foresee", "ink", "lines", "livewire", "matte_picture", "pan_zoom", "photo_planes",
  "layer_objects", "read_layers", "ruler", "shortcuts", "photo_board", "tree_viewer",
];
const loaded = await Promise.all(NAMES.map((name) => import(`flowtree-studio/${name}.mjs`)));
window.scene = await import("nicegui-scene");
window.studio = Object.assign({}, ...loaded);
window.sent = [];
window.board = new studio.PhotoBoard(document.getElementById("board"), (name, value) => sent.push([name, value]));
window.ready = true;
