"""Pages of large worlds stay small, and show the whole world."""

from pathlib import Path

import pytest

from beliefnest.cli.options import ShowOptions
from beliefnest.cli.page import write_page
from beliefnest.nest.face.nest import Nest
from beliefnest.viewer.page.html import page_html
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
