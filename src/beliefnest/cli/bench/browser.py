"""A real browser, driven for measurements and for tests."""

import json
import shutil
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.remote.webelement import WebElement

from beliefnest.errors import BodyError

__all__ = ["CHROMIUM", "DRIVER", "Browser", "opened_browser"]

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
# What software drawing tells of itself is no fault of the page.
_DRIVER_TALK = "GL Driver Message"


class Browser:
    """One window; what it asked for and complained about is kept."""

    def __init__(self, driver: webdriver.Chrome) -> None:
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
        """Run a script that ends when it calls its last argument; what it called it with."""
        return self.driver.execute_async_script(text, *arguments)

    def until_script(self, text: str, *arguments: Any) -> Any:
        """Run a script until it gives something."""
        return self.until(lambda: self.script(text, *arguments))

    def until(self, holds: Callable[[], Any]) -> Any:
        """Wait for a condition; what it gave."""
        end = time.monotonic() + _PATIENCE_S
        while True:
            found = holds()
            if found:
                return found
            if time.monotonic() > end:
                raise BodyError(f"the page did not come to it; the console: {self.complaints()}")
            time.sleep(0.02)

    def one(self, selector: str) -> WebElement:
        """Return the element of a selector, once it is there."""
        found: list[WebElement] = self.until(
            lambda: self.driver.find_elements(By.CSS_SELECTOR, selector)
        )
        return found[0]

    def click(self, selector: str) -> None:
        """Click what a selector names, wherever it has been scrolled to."""
        self.one(selector)
        self.script("document.querySelector(arguments[0]).click()", selector)

    def complaints(self) -> list[str]:
        """What the console said since it was last asked."""
        told = self._log("browser")
        return [each["message"] for each in told if _DRIVER_TALK not in each["message"]]

    def _log(self, name: str) -> list[dict[str, Any]]:
        found: list[dict[str, Any]] = self.driver.get_log(name)  # type: ignore[no-untyped-call]
        return found

    def requests(self) -> list[str]:
        """Addresses that were asked for since this was last asked."""
        found = []
        for entry in self._log("performance"):
            message = json.loads(entry["message"])["message"]
            if message["method"] == "Network.requestWillBeSent":
                found.append(message["params"]["request"]["url"])
        return found


@contextmanager
def opened_browser(profile: Path) -> Iterator[Browser]:
    """A browser with an empty profile."""
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
