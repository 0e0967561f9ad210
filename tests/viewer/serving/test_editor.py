"""The editor of scenario files: in a real browser, and what its server refuses."""

import re
import subprocess
import sys

import httpx2
import pytest
import yaml
from tests.processes import started
from tests.viewer.page.test_page import assert_accessible, assert_clean

from beliefnest.scenarios.scenario import Scenario

SCENE = """\
name: rooms
map:
  legend:
    "#": bricks
    C: {container: chest, label: red box}
    a: {agent: ann, facing: east}
    b: {agent: bob, facing: west}
  floors: |
    #########
    #.a...b.#
    #C......#
    #########
script:  # as written
  - {agent: ann, program: "await doNothing(bot);"}
"""


@pytest.fixture
def served(tmp_path):
    """Serve the editor of a file; return file and address."""
    file = tmp_path / "rooms.yaml"
    file.write_text(SCENE, encoding="utf-8")
    command = [sys.executable, "-m", "beliefnest", "serve", str(file), "--edit", "--port", "0"]
    with started(command, stdout=subprocess.PIPE) as process:
        yield file, re.search(r"http://\S+", process.stdout.readline())[0]


def sees(browser, who, what):
    """Return True if the page says that an agent sees a thing."""
    return (
        browser.script(
            "return document.querySelector(`[data-sees='${arguments[0]}']`)?.className",
            f"{who} {what}",
        )
        == "seen"
    )


def text_of(browser):
    return browser.script("return document.querySelector('textarea').value")


def press(browser, *keys):
    """Press keys on the plan, and wait until the scene is that of all edits."""
    from selenium.webdriver.common.keys import Keys

    plan = browser.one(".touch")
    browser.script("arguments[0].focus()", plan)
    for key in keys:
        count = int(browser.script("return document.documentElement.dataset.scene"))
        plan.send_keys(getattr(Keys, key, key))
        if key in ("ENTER", "DELETE"):
            browser.until(
                lambda count=count: (
                    int(browser.script("return document.documentElement.dataset.scene")) > count
                )
            )


def test_walls_drawn_with_the_keyboard_hide_at_once_and_are_saved(browser, served):
    file, address = served
    browser.open(address)
    browser.until(lambda: sees(browser, "ann", "bob") and sees(browser, "bob", "red box"))
    press(browser, *["ARROW_RIGHT"] * 4, "ARROW_DOWN", "ENTER")
    assert not sees(browser, "ann", "bob")
    assert not sees(browser, "bob", "red box")
    press(browser, "d", "ENTER")
    assert "door: oak" in text_of(browser)
    browser.click("[aria-label='undo (Ctrl+Z)']")
    browser.until(lambda: "door: oak" not in text_of(browser))
    browser.click("[data-tool=agent]")
    browser.script("document.querySelector('[name=agent]').value = 'bob'")
    press(browser, "ARROW_LEFT", "ENTER")
    browser.until(lambda: sees(browser, "ann", "bob"))
    assert_accessible(browser)
    browser.click(".save")
    browser.until(lambda: "is saved" in browser.script("return document.body.innerText"))
    assert_clean(browser, address)
    rows = yaml.safe_load(file.read_text(encoding="utf-8"))["map"]["floors"].splitlines()
    assert rows == ["#########", "#.ab#...#", "#C......#", "#########"]
    assert "script:  # as written" in file.read_text(encoding="utf-8")
    assert Scenario.load(str(file)).setting.snapshot.agents["bob"].position == (3.5, 1, 1.5)


def test_only_the_page_edits_and_no_change_of_others_is_overwritten(served):
    file, address = served
    changed = SCENE.replace("rooms", "other")
    told = {"text": changed}
    with httpx2.Client(base_url=address) as client:
        for refused in (
            client.post("api/save", content=f"text={changed}"),
            client.post("api/save", json=told, headers={"sec-fetch-site": "cross-site"}),
            client.post("api/save", json=told, headers={"host": "elsewhere.example"}),
            client.post("api/save", json=[1]),
            client.post("api/save", json={}),
            client.post("api/scene", json={"text": SCENE, "edits": 3}),
        ):
            assert refused.status_code in {400, 403}
        assert client.get("api/save").status_code == 405
        assert file.read_text(encoding="utf-8") == SCENE
        wrong = client.post("api/scene", json={"text": SCENE.replace("bricks", "brikcs")}).json()
        assert wrong["problem"].startswith("rooms.yaml:4: map.legend.#: no block 'brikcs'")
        person = SCENE.replace("facing: west", "type: human")
        assert "scene" in client.post("api/scene", json={"text": person, "viewer": "bob"}).json()
        file.write_text(changed, encoding="utf-8")
        answer = client.post("api/save", json={"text": SCENE})
        assert "was changed by another program" in answer.json()["problem"]
        assert file.read_text(encoding="utf-8") == changed
