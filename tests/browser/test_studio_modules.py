"""The pure functions of the studio's modules, run where they run: in a browser."""

from __future__ import annotations

import itertools
import math
import struct
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from flowtree.studio.page.components import STATIC
from tests.browser.chromium import open_page

_SCENE = Path(str(find_spec("nicegui").origin)).parent / "elements" / "scene" / "dist"
_LENGTH = 24  # what a step of the livewire costs where its picture says 0

_INKED = (
    "board.canvas.ink.getContext('2d').getImageData(0, 0, 300, 300).data.filter(value => value > 0).length"
)


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    folder = tmp_path_factory.mktemp("studio")
    grey = np.arange(12, dtype=np.uint8).reshape(3, 4) * 20
    Image.fromarray(grey).save(folder / "grey.png")
    Image.fromarray(255 - grey[1:, :2]).save(folder / "part.png")
    roots = {"flowtree-studio": STATIC, "nicegui-scene": _SCENE}
    with open_page("studio.html", folder, **roots) as shown:
        yield shown


def cost_of(path, cost):
    """What the livewire pays for a path of cells, each step entering the next cell."""
    total = 0
    for (x0, y0), (x1, y1) in itertools.pairwise(path):
        assert max(abs(x1 - x0), abs(y1 - y0)) == 1, "every step leads to a neighbour"
        length = 10 if x0 == x1 or y0 == y1 else 14
        total += math.floor((int(cost[y1, x1]) + _LENGTH) * length / 10 + 0.5)
    return total


def cheapest(cost, start, end):
    """The same by SciPy."""
    high, wide = cost.shape
    cells = np.arange(cost.size).reshape(high, wide)
    rows, columns, tolls = [], [], []
    for dy in (-1, 0, 1):
        for dx in (-1, 0, 1):
            if dx == dy == 0:
                continue
            from_y, from_x = slice(max(0, -dy), high - max(0, dy)), slice(max(0, -dx), wide - max(0, dx))
            to_y, to_x = slice(max(0, dy), high - max(0, -dy)), slice(max(0, dx), wide - max(0, -dx))
            rows.append(cells[from_y, from_x].ravel())
            columns.append(cells[to_y, to_x].ravel())
            length = 10 if 0 in (dx, dy) else 14
            tolls.append(np.floor((cost[to_y, to_x].astype(float) + _LENGTH) * length / 10 + 0.5).ravel())
    graph = coo_array((np.concatenate(tolls), (np.concatenate(rows), np.concatenate(columns))))
    return dijkstra(graph, indices=cells[start[1], start[0]])[cells[end[1], end[0]]]


@pytest.mark.parametrize("seed", range(3))
def test_the_livewire_is_the_cheapest_path(page, seed):
    rng = np.random.default_rng(seed)
    cost = rng.integers(0, 256, (23, 31)).astype(np.uint8)
    start, end = (3, 4), (27, 19)
    path = page.evaluate(
        """([cost, start, end]) => studio.pathTo(studio.cheapestPaths(
            {cost: new Uint8Array(cost), width: 31, height: 23}, start, 40), end)""",
        [cost.ravel().tolist(), start, end],
    )
    assert (tuple(path[0]), tuple(path[-1])) == (start, end)
    assert cost_of(path, cost) == cheapest(cost, start, end)


def test_a_long_wire_follows_a_branch_that_the_pen_misses(page):
    cost = np.full((200, 100), 220, np.uint8)
    branch = [(50 + round(12 * math.sin(y / 25)), y) for y in range(200)]
    for x, y in branch:
        cost[y, x - 1 : x + 2] = 0
    wire = page.evaluate(
        """cost => {
            const wire = new studio.Livewire({cost: new Uint8Array(cost), width: 100, height: 200}, 0.5);
            wire.start([100, 390]);
            let line;
            for (let y = 390; y >= 20; y -= 5) line = wire.follow([100, y]);
            return line;
        }""",
        cost.ravel().tolist(),
    )
    assert wire[0] == [100, 390]
    assert wire[-1] == [100, 20]
    away = [min(math.hypot(x / 2 - bx, y / 2 - by) for bx, by in branch) for x, y in wire[15:-15]]
    assert np.median(away) < 1.5
    assert len(wire) > 150


def test_a_thinned_line_stays_where_it_was(page):
    rng = np.random.default_rng(1)
    line = np.cumsum(rng.normal(0, 3, (200, 2)), axis=0).tolist()
    thin = page.evaluate("line => studio.simplify(line, 2)", line)
    assert (thin[0], thin[-1]) == (line[0], line[-1])
    assert len(thin) < 0.7 * len(line)
    apart = page.evaluate("([line, thin]) => line.map(p => studio.distanceToLine(p, thin))", [line, thin])
    assert max(apart) <= 2 + 1e-9
    smooth = page.evaluate("line => studio.smooth(line, 3)", line)
    assert (smooth[0], smooth[-1], len(smooth)) == (line[0], line[-1], len(line))
    assert np.abs(np.diff(smooth, 2, axis=0)).sum() < 0.5 * np.abs(np.diff(line, 2, axis=0)).sum()


def test_the_topmost_stroke_is_picked(page):
    drawn = [{"points": [[0, 0], [10, 0]]}, {"points": [[0, 1], [10, 1]], "width": 6}, {"points": [[5, 9]]}]
    picks = page.evaluate(
        "drawn => [[5, 0], [5, 3.5], [5, 8], [50, 50]].map(p => studio.pick(drawn, p, 1))", drawn
    )
    assert picks == [1, 1, 2, -1]


def test_a_place_and_its_marks_are_each_others_inverse(page):
    marks, lines, axis = {"foot": [412.5, 958], "top": 31}, {"foot": 300, "top": 40}, 170
    there = page.evaluate(
        """([marks, lines, axis]) => {
            const placed = studio.place(marks, lines, axis);
            const dragged = {...placed, x: placed.x + 12, y: placed.y - 7};
            const moved = studio.rescale(dragged, 1.5, [axis, lines.foot]);
            return [studio.marksAt(placed, lines, axis), studio.marksAt(moved, lines, axis)];
        }""",
        [marks, lines, axis],
    )
    assert there[0]["foot"] == pytest.approx(marks["foot"])
    assert there[0]["top"] == pytest.approx(marks["top"])
    scale = (lines["foot"] - lines["top"]) / (marks["foot"][1] - marks["top"])
    assert there[1]["foot"] == pytest.approx([412.5 - 12 / scale, 958 + 7 / scale]), (
        "the foot line met it there"
    )
    tall = there[1]["foot"][1] - there[1]["top"]
    assert tall == pytest.approx((marks["foot"][1] - marks["top"]) / 1.5), (
        "a larger photo shows less of the tree"
    )


def test_photos_share_lines_and_the_compass_turns_as_cameras_do(page):
    out = page.evaluate("studio.layOut(3, 900, 600)")
    assert len(out["axes"]) == 3
    assert 0 < out["lines"]["top"] < out["lines"]["foot"] < 600
    ends = np.ravel(out["columns"])
    assert (np.diff(ends) > 0).all()
    assert ends[0] >= 0
    assert ends[-1] <= 900
    # The camera at yaw t stands at (sin t, 0, cos t): seen from above, with z down, the front is below.
    assert page.evaluate(
        "[[0, 9], [9, 0], [0, -9], [-9, 0], [9, 9]].map(([x, y]) => studio.yawAt(x, y))"
    ) == [
        0,
        90,
        180,
        -90,
        45,
    ]
    back = page.evaluate("[-135, 0, 35, 180].map(yaw => studio.yawAt(...studio.rimAt(yaw, 40)))")
    assert back == [-135, 0, 35, 180]


def test_zooming_keeps_the_point_under_the_pointer(page):
    points = page.evaluate(
        """() => {
            const view = new studio.PanZoom();
            view.fit(900, 1120, 430, 600);
            const at = [120, 333], before = view.toPicture(at);
            view.zoom(2.5, at);
            view.zoom(0.7, at);
            return [before, view.toPicture(at), view.toScreen(view.toPicture([7, 9]))];
        }"""
    )
    assert points[0] == pytest.approx(points[1])
    assert points[2] == pytest.approx([7, 9])


def test_a_soft_brush_falls_off_to_its_rim(page):
    layers = page.evaluate("studio.softLayers(0.5, 0.8)")
    widths, opacities = np.transpose(layers)
    assert (np.diff(widths) < 0).all(), "from the rim to the inner part"
    cover = 1 - np.cumprod(1 - opacities)
    assert (np.diff(cover) >= 0).all()
    assert cover[-1] == pytest.approx(0.8)
    assert 0.5 <= widths[-1] < widths[0] <= 1


def test_mattes_are_patched_where_they_changed(page):
    values = page.evaluate(
        """async () => {
            const matte = await studio.MattePicture.load("/files/grey.png");
            matte.as("overlay"); matte.as("grey");
            const known = await matte.patch("/files/part.png", [1, 1, 2, 2]);
            const read = (kind) => Array.from(
                matte.as(kind).getContext("2d").getImageData(0, 0, 4, 3).data);
            return [known, Array.from(matte.alpha), read("grey"), read("overlay")];
        }"""
    )
    grey = np.arange(12, dtype=np.uint8).reshape(3, 4) * 20
    part = 255 - grey[1:, :2]
    grey[1:3, 1:3] = part
    assert values[0] is True
    np.testing.assert_array_equal(np.reshape(values[1], (3, 4)), grey)
    shown = np.reshape(values[2], (3, 4, 4))
    np.testing.assert_array_equal(shown[..., 0], grey)
    veil = np.reshape(values[3], (3, 4, 4))[..., 3].astype(float)
    assert np.corrcoef(veil.ravel(), grey.ravel())[0, 1] < -0.999, "what is not tree lies under colour"


def test_layers_of_numbers_arrive_as_they_were_sent(page):
    rng = np.random.default_rng(2)
    centres, density = rng.normal(size=(5, 3)).astype("<f4"), np.arange(5, dtype=np.uint8)
    blobs = {
        "readVoxels": struct.pack("<Iff", 5, 0.25, 3.5) + centres.tobytes() + density.tobytes(),
        "readField": struct.pack("<I", 2) + np.arange(12, dtype="<f4").tobytes(),
        "readFlow": struct.pack("<I", 3)
        + np.array([-1, 0, 1], "<i4").tobytes()
        + np.arange(9, dtype="<f4").tobytes()
        + np.array([90, 40, 7], "<i4").tobytes()
        + np.array([3, 2, 1], "<i4").tobytes(),
        "readSkeleton": struct.pack("<I", 1) + np.arange(10, dtype="<f4").tobytes(),
    }
    read = {
        name: page.evaluate(
            """([name, bytes]) => {
                const plain = (value) => ArrayBuffer.isView(value) ? Array.from(value) : value;
                const values = studio[name](new Uint8Array(bytes).buffer);
                return ArrayBuffer.isView(values) ? Array.from(values)
                    : Object.fromEntries(Object.entries(values).map(([key, value]) => [key, plain(value)]));
            }""",
            [name, list(blob)],
        )
        for name, blob in blobs.items()
    }
    voxels = read["readVoxels"]
    assert (voxels["edge"], voxels["densest"], voxels["density"]) == (0.25, 3.5, density.tolist())
    np.testing.assert_array_equal(np.array(voxels["centres"], np.float32), centres.ravel())
    assert read["readField"] == list(range(12))
    assert read["readFlow"] == {
        "parent": [-1, 0, 1],
        "points": list(range(9)),
        "step": [90, 40, 7],
        "particles": [3, 2, 1],
        "last": 90,
    }
    assert read["readSkeleton"] == list(range(10))


def test_photos_hang_where_their_cameras_saw_them(page):
    frame = page.evaluate(
        "studio.frameOf({yaw: 90, metres_per_pixel: 0.02, foot: [260, 590], width: 500, height: 640})"
    )
    assert frame["right"] == pytest.approx([0, 0, -1], abs=1e-12)
    assert frame["toward"] == pytest.approx([1, 0, 0], abs=1e-12)
    # The foot of the trunk is the origin: the picture's middle lies 10 pixels to its left and 270 above it.
    assert frame["middle"] == pytest.approx([0, 5.4, 0.2], abs=1e-12)


def test_a_photos_corners_are_found_in_its_straightened_picture(page):
    warp = np.array([[1.9, 0.2, -30.0], [-0.1, 2.1, 12.0], [1e-4, -2e-5, 1.0]])
    view = {"warp": warp.tolist(), "frame": [800, 600]}
    corners = np.array(page.evaluate("view => studio.cornersOf(view)", view))
    back = np.column_stack([corners, np.ones(4)]) @ warp.T
    np.testing.assert_allclose(back[:, :2] / back[:, 2:], [[0, 0], [800, 0], [800, 600], [0, 600]], atol=1e-6)


def test_keys_mean_what_they_usually_do(page):
    keys = [
        ({"key": "z", "ctrlKey": True}, "undo"),
        ({"key": "Z", "ctrlKey": True, "shiftKey": True}, "redo"),
        ({"key": "y", "metaKey": True}, "redo"),
        ({"key": "["}, "size down"),
        ({"key": "]"}, "size up"),
        ({"key": "2"}, "mode matte"),
        ({"key": "F"}, "frame"),
        ({"key": "f", "ctrlKey": True}, None),
        ({"key": "f", "altKey": True}, None),
        ({"key": "q"}, None),
    ]
    for event, action in keys:
        assert page.evaluate("event => studio.actionOf(event)", event) == action, event


def test_files_go_where_they_belong(page):
    addresses = page.evaluate(
        """[["oak 1.jpg", null], ["Oak.ZIP", null], ["bark.png", "meshing.bark"]]
            .map(([name, parameter]) => studio.addressFor(name, parameter))"""
    )
    assert addresses == [
        "/photo?name=oak%201.jpg",
        "/open?name=Oak.ZIP",
        "/picture/meshing.bark?name=bark.png",
    ]


def test_ink_is_drawn_as_the_pen_moves_and_only_the_stroke_is_sent(page):
    page.evaluate(
        """() => {
            const photo = {width: 300, height: 300, yaw: 0, marks: {seeds: []}};
            Object.assign(photo, {scribbles: [], strokes: [], paint: []});
            board.setState({photos: [photo]});
            board.setTool({mode: "density", name: "add", size: 5, softness: 0.5, strength: 1});
        }"""
    )
    box = page.locator("#board canvas").last.bounding_box()
    requests = []
    page.on("request", lambda request: requests.append(request.url))
    page.mouse.move(box["x"] + 60, box["y"] + 80)
    page.mouse.down()
    drawn = []
    for step in range(1, 30):
        page.mouse.move(box["x"] + 60 + 5 * step, box["y"] + 80 + 3 * step)
        drawn.append(page.evaluate(_INKED))
    assert page.evaluate("sent.length") == 0, "nothing travels while one draws"
    page.mouse.up()
    assert (np.diff(drawn) > 0).mean() > 0.9, "every movement shows at once"
    ((name, value),) = page.evaluate("sent")
    assert name == "command"
    assert value["command"]["command"] == "AddPaint"
    assert value["command"]["width"] == pytest.approx(15)
    assert len(value["command"]["points"]) == 2, "a straight line needs two points"
    assert page.evaluate("board.state.photos[0].paint.length") == 1, (
        "it stays on show until the project has it"
    )
    page.evaluate("board.setState({photos: [{...board.state.photos[0], paint: []}]}, 0)")
    assert page.evaluate("board.state.photos[0].paint.length") == 1
    page.evaluate("board.setState({photos: [{...board.state.photos[0], paint: []}]}, 1)")
    assert page.evaluate("board.state.photos[0].paint.length") == 0
    assert not requests


def test_what_a_command_will_do_is_foreseen(page):
    photo = {"yaw": 0, "marks": {"foot": None, "top": None, "seeds": []}}
    photo |= {"scribbles": [1, 2, 3], "strokes": [], "paint": []}
    commands = [
        {"command": "RemoveScribbles", "photo": 0, "indices": [0, 2]},
        {"command": "AddStroke", "photo": 0, "points": [[1, 2], [3, 4]]},
        {"command": "SetSeeds", "photo": 0, "points": [[5, 6]]},
        {"command": "PlacePhoto", "photo": 0, "foot": [7, 8], "top": 1},
        {"command": "SetMark", "photo": 0, "name": "top", "value": 2},
        {"command": "SetYaw", "photo": 0, "yaw": 45},
        {"command": "SetYaw", "photo": 7, "yaw": 1},
    ]
    (after,) = page.evaluate(
        "([photos, commands]) => (commands.forEach(one => studio.foresee(photos, one)), photos)",
        [[photo], commands],
    )
    assert after["scribbles"] == [2]
    assert after["strokes"][0]["points"] == [[1, 2], [3, 4]]
    assert after["marks"] == {"foot": [7, 8], "top": 2, "seeds": [[5, 6]]}
    assert after["yaw"] == 45


@pytest.mark.parametrize(("distance", "eye"), [(18.0, 1.6), (None, None)])
def test_a_photos_eye_sees_its_plane_fill_the_frame(page, distance, eye):
    view = {"yaw": 35, "metres_per_pixel": 0.02, "foot": [260, 590], "width": 500, "height": 640}
    view |= {"distance": distance, "eye": eye}
    corners, behind = page.evaluate(
        """view => {
            const {THREE} = scene, frame = studio.frameOf(view), camera = new THREE.PerspectiveCamera();
            const {place, target} = studio.aimEye(camera, {view, frame}, 500 / 640, 1, 4);
            camera.position.set(...place);
            camera.lookAt(...target);
            camera.updateMatrixWorld();
            const at = (px, py, away) => {
                const [a, b] = [(px - view.foot[0]) * 0.02, (view.foot[1] - py) * 0.02];
                const {right, toward} = frame;
                return new THREE.Vector3(right[0] * a + toward[0] * away, b, right[2] * a + toward[2] * away)
                    .project(camera).toArray();
            };
            return [[at(0, 0, 0), at(500, 0, 0), at(500, 640, 0)], at(0, 0, -5)];
        }""",
        view,
    )
    np.testing.assert_allclose(np.array(corners)[:, :2], [[-1, 1], [1, 1], [1, -1]], atol=1e-3)
    assert np.abs(np.array(corners)[:, 2]).max() < 1
    # What lies behind the axis is smaller, unless the photo is a parallel projection.
    assert behind[0] == pytest.approx(-1, abs=0.02) if distance is None else behind[0] > -0.9


class Tablet:
    """A pen and fingers on the board, in its own pixels."""

    def __init__(self, page):
        self.page = page
        self.devtools = page.context.new_cdp_session(page)
        self.box = page.locator("#board canvas").last.bounding_box()
        self.devtools.send("Emulation.setTouchEmulationEnabled", {"enabled": True, "maxTouchPoints": 5})
        page.evaluate(
            """() => {
                const photo = {width: 300, height: 300, yaw: 0, marks: {seeds: []}};
                board.setState({photos: [{...photo, scribbles: [], strokes: [], paint: []}]});
                board.setTool({mode: "density", name: "add", size: 5, softness: 0.5, strength: 1});
                board.frame();
            }"""
        )

    def pen(self, force, *, button="left"):
        """Draws a line; returns the command that it becomes."""
        before = self.page.evaluate("sent.length")
        about = {"pointerType": "pen", "button": button, "force": force}
        for kind, x in [("mousePressed", 60), *(("mouseMoved", 60 + 20 * k) for k in range(1, 6))]:
            place = {"x": self.box["x"] + x, "y": self.box["y"] + 100}
            self.devtools.send("Input.dispatchMouseEvent", {"type": kind, **place, **about})
        self.devtools.send(
            "Input.dispatchMouseEvent", {"type": "mouseReleased", **place, **about, "force": 0}
        )
        commands = self.page.evaluate("count => sent.slice(count).map(([, value]) => value.command)", before)
        assert len(commands) == 1
        return commands[0]

    def fingers(self, *steps):
        """Fingers that go down at the first step's places, move to the others', and go up."""
        for number, places in enumerate(steps):
            points = [
                {"x": self.box["x"] + x, "y": self.box["y"] + y, "id": k} for k, (x, y) in enumerate(places)
            ]
            kind = "touchMove" if number else "touchStart"
            self.devtools.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
        self.devtools.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})

    def __getattr__(self, name):
        return self.page.evaluate(f"board.{name}")


def test_a_tablets_pen_and_fingers(page):
    tablet = Tablet(page)
    page.evaluate("sent.length = 0")
    tablet.fingers([(60, 60)], [(90, 80)], [(120, 100)])
    assert page.evaluate("sent.map(([, value]) => value.command.command)") == ["AddPaint"]
    before = page.evaluate("({...board.transform})")
    tablet.fingers([(100, 100), (200, 100)], [(90, 120), (210, 120)], [(50, 140), (250, 140)])
    after = page.evaluate("({...board.transform})")
    assert after["scale"] == pytest.approx(2 * before["scale"], rel=1e-6), "fingers twice as far apart"
    middle = (140 - after["y"]) / after["scale"]
    assert middle == pytest.approx((100 - before["y"]) / before["scale"]), (
        "what lies between them stays there"
    )
    assert page.evaluate("sent.length") == 1, "two fingers draw nothing"
    page.evaluate("board.frame()")

    weak, usual, hard = (tablet.pen(force) for force in (0.2, 0.5, 0.9))
    assert weak["strength"] == pytest.approx(0.4)
    assert usual["strength"] == hard["strength"] == 1
    page.evaluate("board.setTool({mode: 'branches', name: 'brush', size: 4})")
    thin, usual, thick = (tablet.pen(force)["width"] for force in (0.1, 0.5, 1.0))
    assert usual == pytest.approx(12), "4 % of the photo's height, as with a mouse"
    assert thin < 0.5 * usual < usual < 1.5 * usual < thick

    before = page.evaluate("({...board.transform})")
    tablet.fingers([(60, 60)], [(90, 80)])
    assert page.evaluate("board.transform.x") == pytest.approx(before["x"] + 30), "beside a pen a finger pans"
    assert page.evaluate("board.state.photos[0].strokes.length") == 3


def test_a_hand_beside_the_pen_does_not_draw(page):
    page.evaluate("sent.length = 0")
    page.evaluate(
        """() => {
            const {ink} = board.canvas;
            ink.setPointerCapture = () => {};
            const send = (type, {step = 0, ...about}) => ink.dispatchEvent(new PointerEvent(type, {
                bubbles: true, clientX: 100 + 9 * step, clientY: 100, button: 0, pressure: 0.5, ...about}));
            board.setTool({mode: "density", name: "add", size: 5});
            send("pointerdown", {pointerId: 7, pointerType: "touch"});
            send("pointerdown", {pointerId: 8, pointerType: "pen", button: 5});
            for (const step of [1, 2, 3, 4]) send("pointermove", {pointerId: 8, pointerType: "pen", step});
            send("pointermove", {pointerId: 7, pointerType: "touch", step: 9});
            send("pointerup", {pointerId: 8, pointerType: "pen", step: 6});
            send("pointerup", {pointerId: 7, pointerType: "touch"});
        }"""
    )
    ((_, value),) = page.evaluate("sent")
    assert value["command"]["kind"] == "erase", "the pen's other end takes away"


def test_everything_follows_a_photo_that_is_arranged(page):
    view = {"photo": 0, "mirrored": False, "yaw": 90, "metres_per_pixel": 0.02, "foot": [260, 590]}
    view |= {"width": 500, "height": 640, "warp": [[2, 0, 10], [0, 2, 20], [0, 0, 1]]}
    view |= {"placed": {"top_row": 200}}
    seen = page.evaluate("view => studio.seenEnds(view)", view)
    assert (seen["foot"], seen["top"], seen["scale"]) == ([530, 1200], 200, pytest.approx(0.01))
    same, moved, larger, turned = (
        page.evaluate("([view, photo]) => studio.arrangedAnew(view, photo)", [view, {"yaw": 90, **photo}])
        for photo in (
            {"foot": [530, 1200], "top": 200},
            {"foot": [430, 1250], "top": 250},
            {"foot": [530, 1200], "top": 700},
            {"foot": [530, 1200], "top": 200, "yaw": 180},
        )
    )
    assert same == {"scale": 1, "aside": 0, "up": 0, "turn": 0}
    assert moved == {"scale": 1, "aside": pytest.approx(1.0), "up": pytest.approx(0.5), "turn": 0}
    assert (larger["scale"], larger["up"]) == (2, 0)
    assert turned["turn"] == pytest.approx(math.pi / 2)
    told = page.evaluate(
        """() => {
            const told = [];
            const stop = studio.onArranged((photos) => told.push(photos));
            board.setTool({mode: "arrange", name: "move"});
            const marks = {foot: [150, 280], top: 20, seeds: []};
            board.setState({photos: [{...board.state.photos[0], marks}]});
            const drag = board.begin([board.arrange.axes[0], board.arrange.lines.top + 30]);
            for (const step of [1, 2, 3]) {
                drag.move([[board.arrange.axes[0] - 13 * step, board.arrange.lines.top + 30]]);
            }
            board.cancel(drag);
            stop();
            return told.map(([photo]) => photo);
        }"""
    )
    assert told[-1]["foot"] == told[-5]["foot"] == [150, 280], "back where it was"
    asides = [photo["foot"][0] for photo in told[-4:-1]]
    assert asides == sorted(asides)
    assert asides[0] > 151, "every step of the drag is told"


def test_a_height_is_measured_where_the_tree_has_a_gap(page):
    """A pointer seldom meets a twig: beside it the plane through the stem counts, but not the ground."""
    heights = page.evaluate(
        """() => {
            const { THREE } = scene, host = document.createElement("div");
            const camera = new THREE.PerspectiveCamera(60, 1, 0.1, 100);
            camera.position.set(6, 4, 8);
            camera.lookAt(0, 4, 0);
            const ruler = new studio.Ruler(new THREE.Scene(), host);
            const canvas = { getBoundingClientRect: () => ({ x: 0, y: 0, width: 100, height: 100 }) };
            const at = (y) => {
                ruler.measure({ clientX: 50, clientY: y }, canvas, camera, new THREE.Group());
                return ruler.points.map(point => point.y);
            };
            return [at(100), at(50), at(25)];
        }"""
    )
    assert heights[0] == []  # into the ground
    assert heights[1] == pytest.approx([4.0])
    assert heights[2] == pytest.approx([4.0, 4.0 + 10.0 * math.tan(math.radians(30.0)) / 2])
