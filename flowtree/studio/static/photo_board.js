import { installDrop } from "flowtree-studio/drop.mjs";
import { PhotoBoard } from "flowtree-studio/photo_board.mjs";
import { installShortcuts } from "flowtree-studio/shortcuts.mjs";

export default {
  template: "<div></div>",
  mounted() {
    const emit = (name, value) => this.$emit(name, value);
    this.board = new PhotoBoard(this.$el, emit);
    this.stop = [
      installShortcuts(
        (action) => emit("action", action),
        (held) => {
          this.board.pointers.panning = held;
          this.board.drawInk();
        },
      ),
      installDrop((message) => emit("problem", message)),
    ];
  },
  unmounted() {
    for (const stop of this.stop) stop();
  },
  methods: {
    set_state(state, acknowledged) {
      this.board.setState(state, acknowledged);
    },
    set_layer(name, layer) {
      this.board.setLayer(name, layer);
    },
    remove_layer(name) {
      this.board.removeLayer(name);
    },
    set_tool(tool) {
      this.board.setTool(tool);
    },
    set_how(how) {
      this.board.setHow(how);
    },
    set_photo(number) {
      this.board.setPhoto(number);
    },
    frame() {
      this.board.frame();
    },
    nudge(dx, dy) {
      this.board.nudge(dx, dy);
    },
  },
};
