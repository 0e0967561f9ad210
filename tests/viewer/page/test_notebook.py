"""`nest.view()` in a notebook that is executed: what it shows is the page, in a real browser."""

from pathlib import Path
from typing import Any

import pytest

from beliefnest_benchmarks.browser import Browser

pytestmark = pytest.mark.extra("ipykernel", "nbclient", "nbformat")

BEFORE = """
import beliefnest as bn
world = bn.ScriptedWorld(
    ((0, 0, 0), (9, 4, 9)),
    {(x, 0, z): "stone" for x in range(10) for z in range(10)}
    | {(x, y, 5): "bricks" for x in range(10) for y in (1, 2, 3)},
    {"sally": (2.5, 1, 2.5), "anne": (4.5, 1, 2.5)},
    inventories={"sally": {"diamond": 1}},
    containers={(3, 1, 3): {}},
)
nest = bn.Nest(world, static_blocks=["stone", "bricks"])
world.deposit("sally", (3, 1, 3), {"diamond": 1})
world.place_agent("sally", (2.5, 1, 7.5))
"""
EPISODE = """
episode = bn.Episode(bn.Task.load("help-find", seed=1), {"anne": "scripted:idle.txt"})
episode.play(1).nest.view()
"""
AFTER = 'world.withdraw("anne", (3, 1, 3), {"diamond": 1})'


@pytest.mark.filterwarnings("ignore")  # of Jupyter's own libraries
def test_a_cell_shows_the_page_of_the_nest_as_it_was_then(tmp_path: Path, browser: Browser) -> None:
    import nbclient
    import nbformat

    (tmp_path / "idle.txt").write_text("")
    cells = [BEFORE, "nest.view(height=640)", AFTER, "nest.view()", "print(repr(nest.view(1)))"]
    cells.append(EPISODE)
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell) for cell in cells])
    resources = {"metadata": {"path": str(tmp_path)}}
    nbclient.NotebookClient(notebook, timeout=300, resources=resources).execute()
    _, first, _, second, printed, episode = notebook.cells
    assert (
        printed.outputs[0].text == "<page of 'scripted', beliefs to depth 1; a notebook shows it>\n"
    )

    def shown_in(cell: Any) -> None:
        (shown,) = cell.outputs
        assert "a notebook shows it" in shown.data["text/plain"]
        file = tmp_path / "cell.html"
        file.write_text(f"<!doctype html><body>{shown.data['text/html']}", encoding="utf-8")
        browser.driver.get(file.as_uri())
        browser.driver.switch_to.frame(browser.one("iframe"))
        browser.until_script("return document.documentElement.dataset.ready")

    for cell, false in ((first, False), (second, True)):
        shown_in(cell)
        browser.click("[data-node='0 /sally']")
        browser.one("[data-node='0 /sally'].chosen")
        told = browser.script("return document.body.innerText")
        assert ("sally puts 1 diamond into (3, 1, 3)" in told, "1 false" in told) == (
            True,
            false,
        )
        assert browser.complaints() == []
    shown_in(episode)
    # Its rounds are listed.
    assert browser.one(".begins strong").text == "Round 1"
