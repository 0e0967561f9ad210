"""The page of an episode in a real browser: rounds, who did what, the goal, branches at a round."""

from pathlib import Path
from typing import Any

import pytest
from tests.viewer.page.test_page import assert_accessible, assert_clean

import beliefnest as bn
from beliefnest.cli.options import ShowOptions
from beliefnest.cli.page import write_page
from beliefnest.episodes.policies import Scripted
from beliefnest.episodes.telling import told_episode
from beliefnest_benchmarks.browser import Browser

TASK: dict[str, Any] = {
    "name": "fetch",
    "scenario": {
        "name": "fetch",
        "box": [[0, 0, 0], [12, 3, 6]],
        "blocks": [{"block": "stone", "fill": [[0, 0, 0], [12, 0, 6]]}],
        "static_blocks": ["stone"],
        "containers": [{"at": [1, 1, 1], "items": {"apple": 1}}],
        "agents": {"ann": {"position": [8.5, 1, 3.5]}, "bob": {"position": [9.5, 1, 3.5]}},
    },
    "goal": {"reach": [{"agent": "ann", "items": {"apple": 1}}]},
    "rounds": 4,
    "round_ticks": 5,
}
FETCH = "await getItemFromChest(bot, new Vec3(1, 1, 1), {apple: 1})"


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Play an episode of two rounds, with a branch at the second."""
    file = tmp_path_factory.mktemp("episode") / "run.bn"
    policies = {"ann": Scripted([FETCH, FETCH]), "bob": Scripted(["await think(bot, '<b>')"])}
    with bn.Episode(bn.Task.from_mapping(TASK), policies, store=file) as episode:
        assert episode.play().success
        assert episode.at(1).fork(ann=Scripted([])).play().rounds == 4
    return file


def test_the_rounds_are_told_from_what_a_run_keeps(store: Path) -> None:
    with bn.Nest.read(store) as nest:
        told = told_episode(nest)
    assert told is not None
    main, fork = told["branches"]["main"], told["branches"]["fork 1"]
    assert [part["t"] for part in main["parts"]] == [0, 5]
    assert [part["agents"][0]["ended"] for part in main["parts"]] == ["cut", "ok"]
    ((_, never, tick),) = main["goal"]
    assert not never
    assert main["reached"] == tick and 5 < tick <= 10
    assert (fork["reached"], len(fork["parts"])) == (None, 4)


def test_a_run_without_rounds_tells_of_none(tmp_path: Path) -> None:
    scenario = bn.Scenario.from_mapping(TASK["scenario"])
    with bn.Nest.open(scenario, world="scripted", store=tmp_path / "run.bn") as nest:
        assert told_episode(nest) is None


def texts(browser: Browser, selector: str) -> list[str]:
    return browser.script(
        "return [...document.querySelectorAll(arguments[0])].map(each => each.textContent)",
        selector,
    )


def test_rounds_are_listed_and_lead_to_ticks_programs_and_branches(
    browser: Browser, store: Path, tmp_path: Path
) -> None:
    page = tmp_path / "page.html"
    write_page(ShowOptions(store, depth=1), page)
    browser.open(page.as_uri())
    assert texts(browser, ".begins strong") == ["Round 1", "Round 2"]
    assert texts(browser, ".deed .what")[:2] == [
        "getItemFromChest((1, 1, 1), {apple: 1})",
        "think('<b>')",
    ]
    assert texts(browser, ".fork") == ["\u21b3 fork 1"]
    assert "episode.at(1).fork" in browser.one(".round.now .what-if").text
    shown = "return Number(document.querySelector('.tick').value)"
    browser.click("[data-round='0 0']")
    browser.until(lambda: browser.script(shown) == 0)
    assert "episode.at(0).fork" in browser.one(".round.now .what-if").text
    browser.click("button.deed")
    assert FETCH in browser.one(".chosen-thing pre").text
    browser.click(".goal button")
    browser.until(lambda: browser.script(shown) > 5)
    assert_accessible(browser)
    browser.click(".fork")
    browser.until(lambda: len(texts(browser, ".begins")) == 4)
    assert texts(browser, ".goal .open .when") == ["at no tick"]
    assert "goal not reached" in browser.one(".episode .about").text
    size = browser.driver.get_window_size()
    try:
        browser.driver.set_window_size(400, 900)
        browser.until(lambda: browser.script("return innerWidth <= 500"))
        assert browser.script("return document.documentElement.scrollWidth <= innerWidth")
        assert browser.one(".begins").is_displayed()
    finally:
        browser.driver.set_window_size(size["width"], size["height"])
    assert_clean(browser, "file:")


def test_why_a_program_failed_is_told_beside_it(browser: Browser, tmp_path: Path) -> None:
    policies = {"ann": Scripted(["await turnOnLever(bot, new Vec3(5, 1, 1))"]), "bob": Scripted([])}
    never = {"reach": TASK["goal"]["reach"], "never": [{"agent": "bob", "items": {"apple": 1}}]}
    task = bn.Task.from_mapping({**TASK, "goal": never, "rounds": 2})
    with bn.Episode(task, policies, store=tmp_path / "run.bn") as episode:
        episode.play(1)
        write_page(ShowOptions(tmp_path / "run.bn", depth=1), tmp_path / "page.html")
    browser.open((tmp_path / "page.html").as_uri())
    why = "line 1: turnOnLever: there is no lever at (5, 1, 1), but air. "
    why += "Give the position of a lever."
    assert texts(browser, ".deed .why") == [why]
    assert any(each.endswith(f"which fails: {why}") for each in texts(browser, ".events .what"))
    assert texts(browser, ".goal .when") == ["not yet", "at no tick so far"]
    assert texts(browser, ".goal li")[1].startswith("\u25cb not to be: bob has 1 apple: ")
