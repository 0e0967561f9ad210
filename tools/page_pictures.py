"""Write docs/img/page-*.png and participants.png: pages as a real browser shows them.

Needs chromium and chromedriver. Run it with `make pages` after a change of the page.
"""

import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from beliefnest.cli.options import ShowOptions
from beliefnest.cli.page import write_page
from beliefnest.studies.study import Study
from beliefnest_benchmarks.browser import Browser, opened_browser

IMAGES = Path(__file__).parents[1] / "docs" / "img"

GUIDE = IMAGES.parent / "participants.md"

SHOTS = (
    (
        "sally-anne",
        1,
        "at=/observer/sally&tick=104&thing=container-858&sees=sally",
        (1600, 1000),
        False,
    ),
    ("sally-anne", 3, "at=/observer/sally&tick=82&view=plan&thing=agent-2", (1600, 1000), False),
    ("help-sally", None, "at=/anne/sally&tick=150", (1600, 1000), True),
    ("ice-cream-van", 1, "at=/observer/john/mary&thing=agent-3", (400, 1000), False),
)
"""Scenario, condition, what is looked at, width and height, whether it is dark."""

NAMES = ("wide", "plan", "dark", "narrow")


def main() -> None:
    """Play the scenarios and take the pictures."""
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        with opened_browser(place / "profile") as browser:
            for name, (scenario, condition, view, size, dark) in zip(NAMES, SHOTS, strict=True):
                page = _page(place / name, scenario, condition)
                _screen(browser, *size, dark)
                browser.open(f"{page.as_uri()}#{view}")
                browser.until_script("return !document.body.innerText.includes('Looking up why')")
                time.sleep(1)  # what is drawn has to reach the screen
                browser.driver.save_screenshot(str(IMAGES / f"page-{name}.png"))
            _participants(browser, place)


def _participants(browser: Browser, place: Path) -> None:
    """Take the picture of docs/participants.md: a film at its end, and its question."""
    texts = re.findall(r"```yaml\n(.*?)```", GUIDE.read_text(encoding="utf-8"), re.DOTALL)
    for name, text in zip(("transfer.yaml", "study.yaml"), texts, strict=True):
        (place / name).write_text(text, encoding="utf-8")
    page = Study.load(place / "study.yaml").participants(place / "participants").folder
    _screen(browser, 760, 1230, dark=False)
    browser.open(f"{(page / 'index.html').as_uri()}?participant=1")
    browser.click(".bn-continue")
    browser.one(".bn-trial")
    while browser.script("return document.querySelector('.bn-form').hidden"):
        browser.click(".bn-next")
    browser.script("document.activeElement.blur(); scrollTo(0, 0)")
    browser.driver.save_screenshot(str(IMAGES / "participants.png"))


def _page(folder: Path, name: str, condition: int | None) -> Path:
    command = [sys.executable, "-m", "beliefnest", "run", name, "--out", str(folder)]
    if condition is not None:
        command += ["--condition", str(condition)]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    page = folder.with_suffix(".html")
    write_page(ShowOptions(folder), page)
    return page


def _screen(browser: Browser, width: int, height: int, dark: bool) -> None:
    size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500}
    scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
    browser.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    browser.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [scheme]})


if __name__ == "__main__":
    main()
