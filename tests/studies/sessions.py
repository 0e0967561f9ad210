"""Sessions of a participant in a browser: films watched to their end, questions answered."""

from collections.abc import Callable

from beliefnest_benchmarks.browser import Browser


def say(browser: Browser, place: str) -> str:
    """Watch the film to its end step by step, answer the question, and return it."""
    asked = browser.until_script("return document.querySelector('.bn-question')?.textContent")
    while browser.script("return document.querySelector('.bn-form').hidden"):
        browser.click(".bn-next")
    if browser.script("return document.querySelector('.bn-words') !== null"):
        browser.one(".bn-words").send_keys(place)
    else:
        wanted = "anne" if asked == "Who is there?" else place
        browser.script(
            "[...document.querySelectorAll('.bn-option input')].find(e => e.value === arguments[0])"
            ".click()",
            wanted,
        )
    leave(browser, lambda: browser.click(".bn-submit"))
    return str(asked)


def leave(browser: Browser, act: Callable[[], object]) -> None:
    """Act, and wait until the trial is gone."""
    browser.script("document.querySelector('.bn-trial').dataset.before = 'yes'")
    act()
    browser.until_script("return document.querySelector('[data-before]') === null")


def play(browser: Browser, place: str, count: int) -> list[str]:
    """Answer questions, and return them."""
    return [say(browser, place) for _ in range(count)]
