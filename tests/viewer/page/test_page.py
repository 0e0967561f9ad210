"""The page in a real browser: as a file, and live."""

import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.processes import started

from beliefnest.cli.options import ShowOptions
from beliefnest.cli.page import write_page
from beliefnest.nest.face.nest import Nest
from beliefnest.scenarios.scenario import Scenario
from beliefnest_benchmarks.browser import Browser

ROOT = Path(__file__).parents[3]
AXE = ROOT / "src/beliefnest/viewer/page/web/node_modules/axe-core/axe.min.js"

STORIES = {
    "sally-anne": (1, "/observer/sally", "anne takes 1 diamond out of the left chest"),
    "help-sally": (None, "/anne/sally", "anne puts 1 diamond into the right chest"),
    "ice-cream-van": (1, "/observer/john/mary", None),
}


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Each built-in scenario, played, as a page."""
    folder = tmp_path_factory.mktemp("runs")
    written = {}
    for name, (condition, path, _) in STORIES.items():
        store = folder / f"{name}.bn"
        with Nest.open(Scenario.load(name, condition=condition), store=store) as nest:
            nest.play()
        written[name] = folder / f"{name}.html"
        write_page(ShowOptions(store, path=path), written[name])
    return written


def marks(browser: Browser, thing: str) -> list[str]:
    return browser.script(
        "return [...document.querySelectorAll(`[data-row='${arguments[0]}'] [data-mark]`)]"
        ".map(each => each.dataset.mark)",
        thing,
    )


def row(browser: Browser, name: str) -> str:
    """Return the thing of a row in the list of beliefs, by its name."""
    return browser.until(
        lambda: browser.script(
            "return [...document.querySelectorAll('.holds .thing')]"
            ".find(each => each.querySelector('.name').textContent === arguments[0])?.dataset.row",
            name,
        )
    )


def go_to_event(browser: Browser, text: str) -> None:
    browser.until(
        lambda: browser.script(
            "const found = [...document.querySelectorAll('.events button')]"
            ".find(each => each.textContent.includes(arguments[0]));"
            "found?.click(); return !!found",
            text,
        )
    )


def assert_clean(browser: Browser, own: str) -> None:
    assert browser.complaints() == []
    assert [each for each in browser.requests() if not each.startswith((own, "data:"))] == []


def assert_accessible(browser: Browser) -> None:
    browser.script(AXE.read_text(encoding="utf-8"))
    found = browser.driver.execute_async_script(
        "const done = arguments[arguments.length - 1];"
        "axe.run().then(told => done(told.violations.map(each =>"
        " `${each.id}: ${each.nodes.map(node => node.html).join(' | ')}`)))"
    )
    assert found == []


@pytest.mark.parametrize("name", STORIES)
def test_a_file_shows_a_belief_its_time_and_why(browser, pages, name):
    _, path, deed = STORIES[name]
    browser.open(pages[name].as_uri())
    assert browser.one(".node.chosen").get_attribute("data-node") == f"0 {path}"
    if deed is not None:
        go_to_event(browser, deed)
    assert_clean(browser, "file:")
    assert_accessible(browser)


def test_sally_is_believed_to_be_wrong_about_the_left_chest(browser, pages):
    address = pages["sally-anne"].as_uri()
    browser.open(address)
    browser.click("[data-node='0 /observer/sally']")
    go_to_event(browser, "anne takes 1 diamond out of the left chest")
    left, right = row(browser, "left chest"), row(browser, "right chest")
    browser.until(lambda: marks(browser, left) == ["false", "incomplete", "stale"])
    assert marks(browser, right) == ["unknown"]
    browser.click(f"[data-row='{left}']")
    why = browser.until(
        lambda: browser.script(
            "const told = document.querySelector('.why')?.innerText ?? '';"
            "return told.includes('sally') ? told : null"
        )
    )
    said = "observer believes that sally believes that the left chest at (-2, -51, -4) holds"
    assert said in why
    assert "So sally missed this: anne looked in, then anne took 1 diamond out." in why
    browser.until(lambda: f"thing={left}" in browser.driver.current_url)
    link = browser.driver.current_url
    browser.open(link)
    assert browser.script("return document.querySelector('.thing.chosen').dataset.row") == left
    assert "1 diamond" in browser.one(".chosen-thing dl").text
    browser.click("[data-node='0 /']")
    browser.until(lambda: marks(browser, left) == [])
    assert_clean(browser, "file:")


def test_an_agents_sight_and_what_stops_it_are_told(browser, pages):
    hash_ = "#at=/observer&on=0&sees=sally&view=plan&tick=104"
    browser.open(pages["sally-anne"].as_uri() + hash_)
    browser.click(f"[data-row='{row(browser, 'anne')}']")
    told = browser.until(
        lambda: browser.script("return document.querySelector('.look')?.textContent")
    )
    assert re.search(r"sally does not see anne: the stone_bricks at \(\d+, -50, 1\)", told)
    assert browser.one(".blocker").is_displayed()


def test_the_keyboard_moves_through_time(browser, pages):
    browser.open(pages["sally-anne"].as_uri() + "#tick=10&view=plan")
    press = (
        "dispatchEvent(new KeyboardEvent('keydown', {key: arguments[0], shiftKey: arguments[1]}))"
    )
    shown = "return Number(document.querySelector('.tick').value)"
    press = f"document.body.{press.replace('{key', '{bubbles: true, key')}"
    browser.script(press, "ArrowRight", False)
    browser.until(lambda: browser.script(shown) == 11)
    browser.script(press, "ArrowRight", True)
    browser.until(lambda: browser.script(shown) > 11)
    browser.script(press, "Home", False)
    browser.until(lambda: browser.script(shown) == 0)


def test_texts_of_a_run_are_texts_whatever_is_in_them(browser, tmp_path):
    import beliefnest as bn

    world = bn.ScriptedWorld(
        box=((0, 0, 0), (4, 3, 4)),
        blocks={(x, 0, z): "stone" for x in range(5) for z in range(5)},
        agents={"ann": (1.5, 1, 1.5), "bob": (3.5, 1, 3.5)},
    )
    nest = bn.Nest(world, store=tmp_path / "evil.bn")
    evil = "</script><img src=x onerror=\"document.title='taken'\"><script>document.title='taken'"
    world.say("ann", evil)
    nest.close()
    write_page(ShowOptions(tmp_path / "evil.bn", depth=1), tmp_path / "evil.html")
    browser.open((tmp_path / "evil.html").as_uri())
    assert evil in browser.script("return document.querySelector('.events').textContent")
    assert browser.driver.title != "taken"
    assert_clean(browser, "file:")


def test_what_is_written_on_a_sign_is_an_event_and_false_where_it_was_missed(browser, tmp_path):
    import beliefnest as bn

    sign, hidden = (1, 1, 5), (6, 1, 6)
    blocks = {(x, 0, z): "stone" for x in range(7) for z in range(7)}
    blocks |= {(3, y, z): "stone" for y in (1, 2) for z in range(7) if z != 6}
    # Nobody sees that there is no container.
    blocks |= {(5, 1, 6): "stone", (6, 1, 5): "stone", (6, 2, 6): "stone"}
    world = bn.ScriptedWorld(
        box=((0, 0, 0), (6, 3, 6)),
        blocks={**blocks, sign: "oak_sign"},
        agents={"ann": (1.5, 1, 3.5), "bob": (1.5, 1, 2.5)},
        signs={sign: "in"},
        sign_claims={sign: [bn.Claim.located("diamond", hidden)]},
    )
    nest = bn.Nest(world, bn.Perception(testimony="accept"), store=tmp_path / "sign.bn")
    world.place_agent("bob", (5.5, 1, 1.5))
    world.write_sign("ann", sign, "out")
    nest.close()
    page = tmp_path / "sign.html"
    write_page(ShowOptions(tmp_path / "sign.bn", path="/bob", depth=1), page)
    browser.open(page.as_uri())
    told = "return document.querySelector(arguments[0]).textContent"
    assert "ann writes “out” on the sign" in browser.script(told, ".events")
    assert "1 block is false" in browser.script(told, "main, body")
    # The claims of the start are told with the sign, not only as events.
    assert "“in”, which claims that diamond is in (6, 1, 6)" in browser.script(told, ".detail")
    assert "told by a sign" in browser.script(told, ".detail")


def test_claims_hearsay_and_signs_are_told_and_long_paths_keep_their_ends(browser, tmp_path):
    import beliefnest as bn

    left, right, sign = (1, 0, 1), (8, 0, 1), (6, 0, 7)
    world = bn.ScriptedWorld(
        box=((0, 0, 0), (30, 3, 9)),
        blocks={sign: "oak_sign"},
        agents={"max": (2.5, 0, 3.5), "nora": (4.5, 0, 4.5), "abcdefghijklmnop": (5.5, 0, 5.5)},
        containers={left: {"diamond": 1}, right: {}},
        signs={sign: "keep out"},
    )
    perception = bn.Perception(max_visible_distance=12, testimony="informed", grace=5)
    with bn.Nest(world, perception, store=tmp_path / "talk.bn"):
        world.open("max", left)
        world.open("nora", left)
        world.place_agent("max", (28.5, 0, 3.5))
        world.step(20)
        world.say("nora", "It moved.", claims=[bn.Claim.located("diamond", right)])
        world.step(4)
    page = tmp_path / "talk.html"
    write_page(ShowOptions(tmp_path / "talk.bn", path="/max"), page)
    browser.open(page.as_uri())
    texts = "return [...document.querySelectorAll(arguments[0])].map(each => each.textContent)"
    assert browser.script(texts, ".claim") == [
        "claims: diamond is in (8, 0, 1) a lie \u00b7 believed"
    ]
    assert "\u201c\u201d told by nora 4 ticks ago" in browser.script(texts, "[data-mark=heard]")
    assert "\u201ckeep out\u201d" in browser.script(texts, ".tag")
    names = "return [...document.querySelectorAll('.lane-name')].map(each => [each.title,"
    names += "(each.querySelector('.tail') ?? each).textContent])"
    tails = dict(browser.script(names))
    assert tails["/abcdefghijklmnop/max"].endswith("/max")
    assert tails["/abcdefghijklmnop/nora"].endswith("/nora")
    go_to_event(browser, "It moved.")
    told = browser.until(lambda: browser.script(texts, ".chosen-thing dd"))
    assert told[0] == "diamond is in (8, 0, 1): a lie"
    assert set(told[1:]) == {"believed", "believed (3)"}
    assert_clean(browser, "file:")
    assert_accessible(browser)


@pytest.fixture
def server(tmp_path: Path) -> Iterator[str]:
    """`beliefnest serve` of a scenario that begins to run now."""
    command = [sys.executable, "-m", "beliefnest", "serve", "sally-anne", "--condition", "1"]
    command += ["--port", "0", "--out", str(tmp_path / "run")]
    with started(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as process:
        assert process.stdout is not None
        found = re.search(r"http://\S+", process.stdout.readline())
        assert found is not None
        try:
            yield found[0]
        finally:
            process.terminate()
            process.wait()


def test_the_live_page_follows_a_run_and_makes_deeper_simulators(browser, server):
    browser.open(server)
    assert browser.script("return document.querySelectorAll('.line').length") <= 2
    browser.until(lambda: "anne puts 1 diamond" in browser.script("return document.body.innerText"))
    browser.click("[data-node='0 /observer/sally']")
    browser.click(".node.chosen ~ .more")
    browser.click(".deeper button[aria-label='make /observer/sally/anne']")
    browser.one("[data-node='0 /observer/sally/anne'].chosen")
    browser.click(f"[data-row='{row(browser, 'left chest')}']")
    browser.until(
        lambda: (
            "observer believes that sally believes that anne believes"
            in browser.script("return document.querySelector('.why')?.innerText ?? ''")
        )
    )
    # Once the probe has run, its branch is there to jump into.
    browser.until(lambda: browser.script("return document.querySelectorAll('.line').length") == 2)
    browser.click(".line:last-child")
    browser.one("[data-node='1 /observer'].chosen")
    assert_clean(browser, server)
