"""The studio in a browser: from two photos to an exported tree, tool by tool, as a person goes."""

from __future__ import annotations

import io
import json

import numpy as np
import pytest
from PIL import Image

from flowtree.cli.main import app
from tests.browser.studios import open_studio, show
from tests.clients.node import validate_glb


@pytest.fixture(scope="module")
def studio(tmp_path_factory):
    folder = tmp_path_factory.mktemp("studio")
    with open_studio(folder / "oak") as opened:
        yield opened


def grey(data):
    return np.asarray(Image.open(io.BytesIO(data)).convert("L"), int)


def test_the_first_tree_comes_by_itself(studio):
    studio.picture("start")
    studio.page.get_by_text("Take the bundled pair").click()
    state = studio.until(lambda state: state["height"] == 11.0, "no photos")
    assert len(state["photos"]) == 2
    studio.settle()
    studio.page.wait_for_function("document.querySelector('.figures').textContent.includes('leaves')")
    assert "alike" in studio.page.inner_text(".photo-strip")
    studio.picture("tree")


def test_parameters_are_sliders_with_a_way_back(studio):
    row = studio.page.locator('[data-param="leaves.amount"]')
    row.locator(".q-slider__track-container").focus()
    for _ in range(5):
        studio.press("ArrowRight")
    changed = studio.until(lambda state: state["params"]["leaves"]["amount"] > 1.0, "not changed")
    assert changed["undo"] is not None
    row.locator(".param-reset").click()
    studio.until(lambda state: state["params"]["leaves"]["amount"] == 1.0, "not reset")
    studio.page.locator(".shape").get_by_text("Particle flow", exact=True).click()
    entry = studio.page.locator('[data-param="flow.particle_count"] input')
    entry.fill("70")
    studio.settle()  # what the page is told meanwhile leaves alone what is half typed
    studio.page.wait_for_selector(".state-dot.rest")
    assert entry.input_value() == "70"
    entry.press("End")
    entry.press("0")
    entry.press("Enter")
    entry.blur()
    studio.until(lambda state: state["params"]["flow"]["particle_count"] == 700, "not set")
    studio.settle()
    entry.fill("-3")
    entry.blur()
    studio.page.wait_for_selector(".q-notification")
    assert studio.state()["params"]["flow"]["particle_count"] == 700
    studio.page.wait_for_function(
        "document.querySelector('[data-param=\"flow.particle_count\"] input').value === '700'"
    )
    studio.page.locator(".q-notification button").first.click()
    if studio.pictures is None:  # a small tree will do from now on, and is drawn where it is looked at
        studio.page.locator(".stage").get_by_text("Leaves", exact=True).click()
        leaves = studio.page.locator('[data-param="leaves.most"] input')
        leaves.fill("3000")
        leaves.blur()
        studio.until(lambda state: state["params"]["leaves"]["most"] == 3000, "not set")
        studio.show("leaves")
        studio.show("wood")
    else:
        studio.press("Control+z")
        studio.until(lambda state: state["params"]["flow"]["particle_count"] is None, "not undone")


def test_photos_are_arranged(studio):
    studio.mode("1", "arrange")
    studio.draw((0.25, 0.5), (0.27, 0.53))
    state = studio.until(lambda state: state["photos"][0]["marks"]["foot"] is not None, "not placed")
    foot, top = state["photos"][0]["marks"]["foot"], state["photos"][0]["marks"]["top"]
    assert top < foot[1]
    camera = studio.page.locator(".compass-camera").nth(1)
    box = camera.locator("circle").bounding_box()
    studio.page.mouse.move(box["x"] + 9, box["y"] + 9)
    studio.page.mouse.down()
    studio.page.mouse.move(box["x"], box["y"] - 25, steps=6)
    studio.page.mouse.up()
    turned = studio.until(lambda state: state["photos"][1]["yaw"] != 90, "not turned")
    assert 90 < turned["photos"][1]["yaw"] < 150
    studio.press("Control+z")
    studio.until(lambda state: state["photos"][1]["yaw"] == 90, "one drag is one step back")
    studio.press("Control+z")
    studio.until(lambda state: state["photos"][0]["marks"]["foot"] is None, "not undone")


def test_a_scribble_changes_the_matte_and_is_undone(studio):
    studio.mode("2", "matte")
    before = studio.layer("matte/0")
    studio.choose("background")
    studio.draw((0.3, 0.42), (0.6, 0.4))
    studio.until(lambda state: len(state["photos"][0]["scribbles"]) == 1, "no scribble")
    after = studio.changed("matte/0", before)
    assert grey(after).mean() < grey(before).mean() - 0.3
    studio.picture("matte")
    studio.choose("erase")
    studio.draw((0.45, 0.3), (0.45, 0.5))
    studio.until(lambda state: not state["photos"][0]["scribbles"], "not erased")
    studio.press("Control+z")
    studio.until(lambda state: len(state["photos"][0]["scribbles"]) == 1, "the eraser is undone")
    studio.press("Control+z")
    studio.until(lambda state: not state["photos"][0]["scribbles"], "the scribble is undone")
    studio.press("Control+y")
    studio.until(lambda state: len(state["photos"][0]["scribbles"]) == 1, "redone")
    studio.press("Control+z")
    studio.until(lambda state: not state["photos"][0]["scribbles"], "undone")
    studio.until(lambda _: studio.layer("matte/0") == before, "the matte comes back")


def test_colors_are_picked(studio):
    studio.choose("pick-background")
    studio.draw((0.2, 0.2))
    state = studio.until(lambda state: state["photos"][0]["background_colors"], "no colour")
    (color,) = state["photos"][0]["background_colors"]
    red, _, blue = (int(color[k : k + 2], 16) for k in (1, 3, 5))
    assert blue > red + 40, "the sky is blue"
    assert not state["photos"][1]["background_colors"], "it is this photo's alone"
    studio.page.locator(".swatch").click()
    studio.until(lambda state: not state["photos"][0]["background_colors"], "not taken away")
    for _ in range(2):
        studio.press("Control+z")
    studio.until(lambda state: state["redo"] == "Pick colours on photo 1", "not undone")


def test_a_branch_is_drawn_and_snaps(studio):
    studio.mode("3", "branches")
    studio.until(lambda _: any("/cost/0" in url for url in studio.requests), "nothing to snap to")
    studio.page.wait_for_timeout(100)
    graph = studio.layer("graph/0")
    studio.draw((0.52, 0.7), (0.6, 0.61), (0.63, 0.57), (0.69, 0.55))
    state = studio.until(lambda state: state["photos"][0]["strokes"], "no stroke")
    (stroke,) = state["photos"][0]["strokes"]
    assert stroke["snapped"]
    assert len(stroke["points"]) > 4, "it follows the branch"
    lines = json.loads(studio.changed("graph/0", graph))["lines"]
    near = min(
        np.hypot(*(np.array(line) - stroke["points"][len(stroke["points"]) // 2]).T).min() for line in lines
    )
    assert near < 25, "what is drawn becomes a branch"
    studio.settle()
    studio.picture("branches")
    studio.choose("tips")
    studio.draw((0.2, 0.3))
    studio.until(lambda state: len(state["photos"][0]["marks"]["seeds"]) == 1, "no tip")
    studio.draw((0.2, 0.3), (0.25, 0.32))
    moved = studio.until(lambda state: len(state["photos"][0]["marks"]["seeds"]) == 1, "moved, not added")
    studio.draw((0.25, 0.32))
    studio.until(lambda state: not state["photos"][0]["marks"]["seeds"], f"still there: {moved['undo']}")
    studio.choose("erase")
    studio.draw((0.6, 0.6), (0.66, 0.66))
    studio.until(lambda state: not state["photos"][0]["strokes"], "not erased")


def test_leaves_are_painted_and_the_tree_grows_there(studio):
    studio.settle()
    skeleton = studio.layer("skeleton")
    before = np.frombuffer(skeleton[4:], "<f4").reshape(-1, 10)
    studio.mode("4", "density")
    studio.draw((0.72, 0.32), (0.9, 0.24))
    state = studio.until(lambda state: state["photos"][0]["paint"], "no paint")
    (layer,) = state["photos"][0]["paint"]
    assert (layer["kind"], layer["softness"], layer["strength"]) == ("add", 0.5, 1)
    studio.changed("skeleton", skeleton)  # the branches come first
    studio.settle()
    after = np.frombuffer(studio.layer("skeleton")[4:], "<f4").reshape(-1, 10)
    # Beside the crown, in the middle of what was painted [m].
    grown = [(np.hypot(part[:, 0] - 3.6, part[:, 1] - 9.0) < 1.2).sum() for part in (before, after)]
    assert grown[1] > grown[0]
    studio.picture("density")
    size = layer["width"]
    studio.press("]")
    studio.choose("erase")
    studio.draw((0.72, 0.32), (0.9, 0.24))
    state = studio.until(lambda state: len(state["photos"][0]["paint"]) == 2, "not painted out")
    assert state["photos"][0]["paint"][1]["kind"] == "erase"
    assert state["photos"][0]["paint"][1]["width"] > size


def test_the_viewer_shows_every_step(studio):
    hidden = () if studio.pictures is None else ("leaves", "wood")
    for name in (*hidden, "skeleton"):
        studio.show(name)
    studio.picture("skeleton")
    studio.show("order")
    studio.show("skeleton")
    for name in ("density", "field", "flow"):
        studio.show(name)
    studio.page.wait_for_selector(".flow-player", state="visible")
    studio.press("p")
    studio.page.wait_for_timeout(500)
    studio.press("p")
    studio.picture("flow")
    shown = {url.rsplit("/", 1)[1] for url in studio.requests if "/layer/" in url}
    assert {"skeleton", "voxels", "field", "flow"} <= shown
    for name in ("density", "field", "flow", "wood", "leaves"):
        studio.show(name)
    studio.page.get_by_role("button", name="As this photo's camera saw it").first.click()
    studio.picture("blend")
    studio.press("m")
    # The key goes by way of the server: a person sees the crosshair before they click.
    studio.page.wait_for_function(
        "document.querySelector('.tree-viewer canvas').style.cursor === 'crosshair'"
    )
    box = studio.page.locator(".tree-viewer canvas").bounding_box()
    studio.page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] * 0.4)
    assert " m high" in studio.page.inner_text(".ruler-label")
    studio.press("Escape")
    studio.press("f")
    if studio.pictures is None:
        for name in ("wood", "leaves"):
            studio.show(name)


def test_a_variant_is_chosen(studio):
    studio.page.get_by_text("Six others of its kind").click()
    studio.page.wait_for_function("document.querySelectorAll('.variant').length === 6")
    studio.page.wait_for_function("document.querySelectorAll('.variant:not(.waiting)').length > 0")
    tile = studio.page.locator(".variant:not(.waiting)").first  # while others may still be on their way
    chosen = int(tile.inner_text())
    tile.click()
    studio.until(lambda state: state["seed"] == chosen, "not chosen")
    studio.page.wait_for_selector(".variant.chosen")
    studio.settle()


def test_a_page_that_is_opened_again_goes_on(studio):
    studio.page.locator('[data-param="branches.smoothing"] input').fill("4")
    studio.page.locator('[data-param="branches.smoothing"] input').blur()
    studio.until(lambda state: state["params"]["branches"]["smoothing"] == 4 and state["busy"], "not begun")
    studio.open()
    state = studio.settle()
    assert len(state["photos"][0]["paint"]) == 2
    studio.page.wait_for_function("document.querySelector('.figures').textContent.includes('leaves')")
    assert studio.page.locator(".state-dot.rest").count() == 1
    studio.press("Control+z")
    studio.until(lambda state: state["params"]["branches"]["smoothing"] != 4, "history is kept")
    studio.settle()


def test_help_and_light(studio):
    studio.press("h")
    studio.page.get_by_text("From two photos to a tree").wait_for()
    studio.picture("help")
    studio.press("h")
    studio.page.get_by_role("button", name="Light or dark").click()
    studio.page.wait_for_selector("body.body--light")
    studio.page.set_viewport_size({"width": 1920, "height": 1080})
    studio.mode("1", "arrange")
    studio.page.wait_for_timeout(400)
    studio.picture("light")
    studio.page.get_by_role("button", name="Light or dark").click()
    studio.page.set_viewport_size({"width": 1280, "height": 800})


def test_the_exported_tree_is_the_command_lines(studio, tmp_path):
    studio.settle()
    studio.press("Control+e")
    with studio.page.expect_download() as waiting:
        studio.page.get_by_text("Write the file").click()
    file = tmp_path / waiting.value.suggested_filename
    waiting.value.save_as(file)
    validate_glb(file)
    again = tmp_path / "again.glb"
    app(["reconstruct", "--project", str(studio.project), "-o", str(again)], standalone_mode=False)
    assert file.read_bytes() == again.read_bytes()


def test_a_second_tab_is_told_and_sees_the_same(studio):
    other = studio.page.context.new_page()
    show(other, studio.address)
    other.get_by_text("open in another tab").wait_for()
    studio.mode("4", "density")
    studio.draw((0.3, 0.5), (0.4, 0.5))
    studio.until(lambda state: len(state["photos"][0]["paint"]) == 3, "not painted")
    other.wait_for_function("!document.querySelector('[aria-label=Undo]').disabled")
    other.close()
    studio.press("Control+z")
    studio.until(lambda state: len(state["photos"][0]["paint"]) == 2, "not undone")


def test_what_is_no_photo_is_refused_in_words(studio, tmp_path):
    text = tmp_path / "notes.jpg"
    text.write_text("no picture")
    with studio.page.expect_file_chooser() as waiting, studio.page.expect_response("**/photo?name=notes.jpg"):
        studio.page.get_by_text("Add photo").click()
        waiting.value.set_files(text)
    studio.page.locator(".q-notification").get_by_text("notes.jpg").wait_for()
    assert len(studio.state()["photos"]) == 2
