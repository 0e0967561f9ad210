"""The page of an inference in a real browser: posterior over time, what changed it, predictions."""

from pathlib import Path

import pytest
from tests.minds.lanes import lane, walk
from tests.scenarios.test_inferring import FILE, played_in
from tests.viewer.page.test_page import assert_accessible, assert_clean
from tests.viewer.page.test_rounds import texts

import beliefnest as bn
from beliefnest.cli.page import about_run
from beliefnest.timeline.store import Journal
from beliefnest.viewer.page.posteriors import told_inference
from beliefnest_benchmarks.browser import Browser

CLICK = """
const chart = document.querySelector('.posterior figure > svg')
const { left, top, width } = chart.getBoundingClientRect()
const clientX = left + arguments[0] * width
chart.dispatchEvent(new MouseEvent('click', { bubbles: true, clientX, clientY: top + 5 }))
"""


@pytest.fixture
def court() -> tuple[bn.Nest, bn.Inference]:
    """Bob walks towards one of two ends of a lane, and turns round."""
    world = lane(7, 1, agents={"bob": (3, 0)})
    nest = bn.Nest(world)
    walk(world, (4, 0), (3, 0), (2, 0))
    model = bn.MindModel(
        "bob", {"left": {"at": (0, 1, 0)}, "right": {"at": (6, 1, 0)}}, {"left": [0, 9], "right": 5}
    )
    return nest, nest["/"].infer(model)


def test_the_page_is_told_what_the_inference_answers(court: tuple[bn.Nest, bn.Inference]) -> None:
    _, inference = court
    told = told_inference(inference, 2)
    (panel,) = told["panels"]
    (left, _, values), (right, _, _) = panel["series"]
    assert (left, right) == ("left", "right")
    assert values == [round(inference.mean("utility.left", tick), 4) for tick in told["ticks"]]
    assert [tick for tick, _ in told["heats"]] == list(told["ticks"]) == [0, 1, 2, 3]
    for tick, rows in told["heats"]:
        expected = inference.predict(2, tick)[-1]
        assert {(x, 1, z): share for x, z, share in rows} == {
            cell: round(share, 3) for cell, share in expected.items() if share >= 0.005
        }
    tick, text, factors = told["changes"][2]
    assert (tick, factors[0][0]) == (2, "utility.left")
    assert text.startswith("moves from (4, 1, 0)")


def test_a_click_on_a_moment_shows_what_changed(
    court: tuple[bn.Nest, bn.Inference], tmp_path: Path, browser: Browser
) -> None:
    nest, inference = court
    file = tmp_path / "page.html"
    file.write_text(nest.view(inference=inference, steps=2).page, encoding="utf-8")
    browser.open(file.as_uri())
    assert texts(browser, ".posterior h3") == ["wants: mean utility, in steps"]
    browser.script(CLICK, 0.6)  # within the third of four ticks
    browser.until(lambda: "up to tick 2" in browser.one(".posterior .about").text)
    (change,) = texts(browser, ".changes li")
    assert change.startswith("bob moves from (4, 1, 0) to (3, 1, 0): utility.left ")
    shown = [word for word in texts(browser, ".posterior .legend li") if "left" in word]
    assert shown == [f" left {inference.mean('utility.left', 2):.1f}"]
    expected = inference.predict(2, 2)[-1]
    heats = [share for share in expected.values() if share >= 0.005]
    assert len(texts(browser, ".heat")) == len(heats)
    browser.click("[data-view=space]")
    browser.until(lambda: not texts(browser, ".heat"))
    assert_accessible(browser)
    assert_clean(browser, file.as_uri())


def test_the_page_of_a_run_has_the_inferences_of_its_probes(tmp_path: Path) -> None:
    (tmp_path / "lane.yaml").write_text(FILE)
    scenario, file = bn.Scenario.load(str(tmp_path / "lane.yaml")), tmp_path / "run.bn"
    with bn.Nest.open(scenario, "scripted", file) as nest:
        expected = played_in(nest, scenario).probes[0].inferred
    with bn.Nest.read(file) as run, Journal.read(file) as journal:
        (told,) = about_run(journal, run).inferences()
    assert expected is not None
    assert told["title"] == "wish, by /bob"
    means = {name: values[-1] for name, _, values in told["panels"][0]["series"]}
    assert means == {
        name: round(expected.means[f"utility.{name}"], 4) for name in ("left", "right")
    }


def test_a_run_that_lacks_the_ticks_of_a_probe_has_a_page_without_it(tmp_path: Path) -> None:
    (tmp_path / "lane.yaml").write_text(FILE.replace("{grid: 2}", "{grid: 2}\n      since: 3"))
    scenario, file = bn.Scenario.load(str(tmp_path / "lane.yaml")), tmp_path / "run.bn"
    with bn.Nest.open(scenario, "scripted", file):
        pass
    with bn.Nest.read(file) as run, Journal.read(file) as journal:
        assert about_run(journal, run).inferences() == []


def test_a_page_without_inference_has_none(court: tuple[bn.Nest, bn.Inference]) -> None:
    nest, _ = court
    assert nest.view().inference is None
