"""Real browser, driven by measurements and tests."""

import importlib.util
import json
import shutil
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from beliefnest.errors import BodyError, InputError

if TYPE_CHECKING:  # Selenium is optional, and imported when a browser is opened.
    from selenium import webdriver
    from selenium.webdriver.remote.webelement import WebElement

__all__ = ["CHROMIUM", "DRIVER", "Browser", "check_browser", "opened_browser"]

CHROMIUM, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")

_FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--window-size=1600,1000",
)
_PATIENCE_S = 60.0
# Chromium warns about software rendering; these warnings are no faults of the page.
_DRIVER_TALK = "GL Driver Message"


class Browser:
    """One browser window, with logs of its requests and console messages."""

    def __init__(self, driver: "webdriver.Chrome") -> None:
        self.driver = driver

    def open(self, address: str) -> None:
        """Open a page and wait until it shows something."""
        self.driver.get("about:blank")
        self.complaints()
        self.requests()
        self.driver.get(address)
        self.until(lambda: self.script("return document.documentElement.dataset.ready"))

    def script(self, text: str, *arguments: Any) -> Any:
        """Run a script in the page."""
        return self.driver.execute_script(text, *arguments)

    def ask(self, text: str, *arguments: Any) -> Any:
        """Run an asynchronous script; return the value that it passes to its last argument."""
        return self.driver.execute_async_script(text, *arguments)

    def until_script(self, text: str, *arguments: Any) -> Any:
        """Run a script again and again until it returns something true; return that."""
        return self.until(lambda: self.script(text, *arguments))

    def until(self, holds: Callable[[], Any]) -> Any:
        """Wait until a condition returns something true, and return that."""
        end = time.monotonic() + _PATIENCE_S
        while True:
            found = holds()
            if found:
                return found
            if time.monotonic() > end:
                raise BodyError(
                    f"the page did not get there in time; its console says: {self.complaints()}"
                )
            time.sleep(0.02)

    def one(self, selector: str) -> "WebElement":
        """Wait for the element of a selector, and return it."""
        found: list[WebElement] = self.until(
            lambda: self.driver.find_elements("css selector", selector)
        )
        return found[0]

    def click(self, selector: str) -> None:
        """Click the element of a selector, even if it is scrolled out of view."""
        self.one(selector)
        self.script("document.querySelector(arguments[0]).click()", selector)

    def complaints(self) -> list[str]:
        """Return console messages since the last call."""
        told = self._log("browser")
        return [each["message"] for each in told if _DRIVER_TALK not in each["message"]]

    def _log(self, name: str) -> list[dict[str, Any]]:
        found: list[dict[str, Any]] = self.driver.get_log(name)  # type: ignore[no-untyped-call]
        return found

    def requests(self) -> list[str]:
        """Return the addresses that the page has requested since the last call."""
        found = []
        for entry in self._log("performance"):
            message = json.loads(entry["message"])["message"]
            if message["method"] == "Network.requestWillBeSent":
                found.append(message["params"]["request"]["url"])
        return found


def check_browser(bench: str) -> None:
    """Refuse a benchmark that drives a browser if there is none.

    Raises:
        InputError: Selenium or the browser is not installed.
    """
    if importlib.util.find_spec("selenium") is None:
        raise InputError(
            f"bench {bench} needs selenium to drive a browser: run `pip install selenium`"
        )
    if CHROMIUM is None or DRIVER is None:
        raise InputError(f"bench {bench} needs chromium and chromedriver: install them first")


@contextmanager
def opened_browser(profile: Path) -> Iterator[Browser]:
    """Open a browser with an empty profile."""
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service

    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM or ""
    for flag in (*_FLAGS, f"--user-data-dir={profile}"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    driver = webdriver.Chrome(options=options, service=Service(DRIVER))
    try:
        yield Browser(driver)
    finally:
        driver.quit()
