"""Pages of large worlds stay small, and show the whole world."""

from pathlib import Path

import numpy as np
import pytest

from beliefnest.cli.options import ShowOptions
from beliefnest.cli.page import write_page
from beliefnest.nest.face.nest import Nest
from beliefnest.viewer.page.html import page_html
from beliefnest.world.frames import Snapshot
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import AgentState, Box
from beliefnest.worlds.scripted.world import ScriptedWorld
from beliefnest_benchmarks.browser import Browser
from beliefnest_benchmarks.hills import LARGE, Hills

SHAPE = (96, 48, 80)


def page_of(hills: Hills, ticks: int, place: Path) -> Path:
    store, page = place / "hills.bn", place / "hills.html"
    with Nest(hills.world, store=store):
        for _ in range(ticks):
            hills.tick()
    write_page(ShowOptions(store), page)
    return page


def test_all_beliefs_to_depth_2_of_a_wide_world_take_little_room(tmp_path):
    page = page_of(Hills(SHAPE, agents=3, houses=4), 4, tmp_path)
    program = len(page_html("", {}, served=False))
    assert page.stat().st_size - program < 200_000


@pytest.mark.long
def test_the_page_of_a_large_world_with_many_agents_is_below_5_mb(tmp_path):
    assert page_of(Hills(LARGE, agents=16), 40, tmp_path).stat().st_size < 5_000_000


def test_a_wide_world_is_shown_as_a_whole_from_above_and_in_space(
    browser: Browser, tmp_path: Path
) -> None:
    page = page_of(Hills(SHAPE, agents=3, houses=4), 3, tmp_path)
    browser.open(f"{page.as_uri()}#view=both&at=/agent0")
    shown = "return document.querySelectorAll('.stage:not([hidden]) .over .target').length"
    browser.until_script(shown)
    # Things stand at many heights, so that the highest storey is chosen and nothing is hidden.
    storey = "return [...document.querySelectorAll('select')].at(-2).value"
    assert browser.script(storey) == str(SHAPE[1] - 1)
    room = "const [plan, holder] = ['.plan > canvas', '.holder'].map(each =>"
    room += " document.querySelector(each).getBoundingClientRect());"
    assert browser.script(
        room + "return plan.width <= holder.width && plan.height <= holder.height"
    )
    colours = """
      const canvas = document.querySelector('.stage:last-child .plan > canvas')
      const {data} = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height)
      const found = new Set()
      for (let at = 0; at < data.length; at += 4) found.add(data.slice(at, at + 3).join())
      return found.size
    """
    # Grass, water, planks and stone, each in the light of several slopes.
    assert browser.script(colours) > 8
    assert browser.complaints() == []


def test_of_a_vast_world_the_part_around_agents_is_shown_and_grows_with_them(browser, tmp_path):
    far = {"anne": (30.5, 1, 40.5), "bob": (60.5, 1, 44.5)}
    ground = Terrain.full((400, 8, 300), 0).draft()
    world = ScriptedWorld.from_snapshot(
        Snapshot(
            0,
            Box((0, 0, 0), (399, 7, 299)),
            ground.terrain(),
            {},
            {name: AgentState(place, 0.0) for name, place in far.items()},
        )
    )
    with Nest(world, store=tmp_path / "vast.bn"), world.tick():
        world.place_agent("bob", (330.5, 1, 44.5))
    page = tmp_path / "vast.html"
    write_page(ShowOptions(tmp_path / "vast.bn"), page)

    browser.open(f"{page.as_uri()}#view=plan&at=/&beside=none&tick=0")
    sides = "const {width, height} = document.querySelector('.plan > canvas');"
    browser.until_script(sides + "return width !== 300")
    # Anne and Bob with 24 blocks around them, in steps of 16.
    assert browser.script(sides + "return width / height") == pytest.approx(96 / 64, rel=0.05)
    browser.script("location.hash = '#view=plan&at=/&beside=none&tick=1'")
    browser.until_script(sides + "return width / height > 3")
    marks = "return document.querySelectorAll('.stage:not([hidden]) .over .target').length"
    assert browser.script(marks) == 2
    assert browser.complaints() == []


CLICK = """
const canvas = document.querySelector('.space canvas')
canvas.setPointerCapture = canvas.releasePointerCapture = () => {}
const room = canvas.getBoundingClientRect()
const [across, down] = arguments
const at = {clientX: room.left + room.width * across, clientY: room.top + room.height * down}
for (const kind of ['pointerdown', 'pointerup']) {
  canvas.dispatchEvent(new PointerEvent(kind, {pointerId: 1, button: 0, bubbles: true, ...at}))
}
"""


def test_a_click_on_merged_faces_chooses_the_block_that_was_hit(browser, tmp_path):
    hills = Hills(SHAPE, agents=1, houses=1)
    page = page_of(hills, 1, tmp_path)
    browser.open(f"{page.as_uri()}#view=space&at=/")
    browser.until_script("return document.querySelector('.space canvas')?.width > 300")
    heading = "return document.querySelector('.chosen-thing h3')?.textContent"
    found = []
    for across, down in ((0.4, 0.62), (0.5, 0.7), (0.62, 0.6)):
        browser.script(CLICK, across, down)
        found.append(browser.until(lambda: _new(browser.script(heading), found)))
    for text in found:
        x, y, z = (int(part) for part in text.removeprefix("block at ").split(", "))
        assert hills.world.block_text((x, y, z)) != "air"
        # The camera looks from above and from the south, so that one of these sides is open.
        sides = ((x, y + 1, z), (x, y, z + 1), (x - 1, y, z), (x + 1, y, z))
        assert "air" in map(hills.world.block_text, sides)


TURN = """
const done = arguments[arguments.length - 1]
const canvas = document.querySelector('.space canvas')
canvas.setPointerCapture = canvas.releasePointerCapture = () => {}
const gl = canvas.getContext('webgl2')
const frames = []
let triangles = 0
// Frames follow one another quickly by this clock, however busy the machine is.
let time = performance.now()
performance.now = () => (time += 10)
const later = window.setTimeout
let calm = () => {}
window.setTimeout = act => { calm = act }
for (const name of ['drawElements', 'drawElementsInstanced']) {
  const draw = gl[name].bind(gl)
  gl[name] = (...given) => {
    triangles += given[1] / 3 * (given[4] ?? 1)
    draw(...given)
  }
}
const small = new OffscreenCanvas(40, 30).getContext('2d', {willReadFrequently: true})
const look = () => {
  small.fillStyle = 'white'
  small.fillRect(0, 0, 40, 30)
  small.drawImage(canvas, 0, 0, 40, 30)
  const sums = [0, 0, 0, 0]
  small.getImageData(0, 0, 40, 30).data.forEach((part, at) => { sums[at % 4] += part })
  frames.push({width: canvas.width, triangles, shade: sums.map(sum => sum / 1200)})
  triangles = 0
}
const room = canvas.getBoundingClientRect()
const at = {clientX: room.left + room.width / 2, clientY: room.top + room.height / 2}
const send = kind => canvas.dispatchEvent(new PointerEvent(kind, {
  pointerId: 1, pointerType: 'mouse', button: 0, buttons: 1, bubbles: true, ...at
}))
const rest = () => {
  if (canvas.width < canvas.clientWidth) return requestAnimationFrame(rest)
  look()
  done(frames)
}
const turn = left => {
  at.clientX += 1
  send('pointermove')
  requestAnimationFrame(() => {
    look()
    if (left > 0) return turn(left - 1)
    send('pointerup')
    window.setTimeout = later
    calm()
    rest()
  })
}
send('pointerdown')
turn(8)
"""
"""Script that drags the picture and lets it rest; it returns width, triangles, colour of frames."""


def test_a_large_world_that_turns_has_far_fewer_triangles_and_the_same_colours(browser, tmp_path):
    page = page_of(Hills(LARGE, agents=4), 1, tmp_path)
    browser.open(f"{page.as_uri()}#view=space&at=/")
    browser.until_script(
        "const c = document.querySelector('.space canvas'); return c.width > c.clientWidth"
    )
    *turning, rest = browser.ask(TURN)
    coarse = [frame for frame in turning if frame["width"] < rest["width"] / 2]
    assert len(coarse) > 5
    for frame in coarse:
        assert 0 < frame["triangles"] < 0.4 * rest["triangles"]
        assert frame["shade"] == pytest.approx(rest["shade"], abs=4)


def test_boxes_beside_each_other_and_on_cubes_are_drawn_and_found(browser, tmp_path):
    state = Registry.load().state_id
    blocks = np.full((9, 4, 9), state("air"), dtype=np.int32)
    blocks[:, 0] = state("smooth_stone")
    blocks[2:7, 1, 2:7] = state("smooth_stone_slab")
    world = ScriptedWorld.from_snapshot(
        Snapshot(
            0,
            Box((0, 0, 0), (8, 3, 8)),
            Terrain.of(blocks),
            {},
            {"anne": AgentState((0.5, 1, 0.5), 0.0)},
        )
    )
    with Nest(world, store=tmp_path / "slabs.bn"):
        world.step()
    page = tmp_path / "slabs.html"
    write_page(ShowOptions(tmp_path / "slabs.bn"), page)
    browser.open(f"{page.as_uri()}#view=space&at=/")
    browser.until_script("return document.querySelector('.space canvas')?.width > 300")
    browser.script(CLICK, 0.5, 0.5)
    heading = "return document.querySelector('.chosen-thing h3')?.textContent"
    assert browser.until_script(heading) == "block at 4, 1, 4"


def _new(text: str | None, earlier: list[str]) -> str | None:
    return text if text not in earlier else None
