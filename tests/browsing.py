"""Browser that all tests of the page share."""

from collections.abc import Iterator

import pytest

from beliefnest_benchmarks.browser import CHROMIUM, DRIVER, Browser, opened_browser

__all__ = ["browser", "chromium"]


@pytest.fixture(scope="session")
def chromium(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """Open Chromium once for each process of the tests."""
    if CHROMIUM is None or DRIVER is None:
        pytest.fail(
            "the page is tested in Chromium: apt-get install chromium chromium-driver, "
            "or leave these tests out with -m 'ci and not browser'",
            pytrace=False,
        )
    with opened_browser(tmp_path_factory.mktemp("profile")) as opened:
        yield opened


@pytest.fixture
def browser(chromium: Browser) -> Browser:
    """Return the browser, without what the pages of other tests complained about."""
    chromium.driver.get("about:blank")
    chromium.complaints()
    return chromium
