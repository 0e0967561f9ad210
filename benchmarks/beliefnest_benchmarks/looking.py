"""Benchmarks of the page and of pictures of a large world: sizes, times, frames while it turns."""

import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from beliefnest.cli.options import ShowOptions
from beliefnest.cli.page import write_page
from beliefnest.nest.face.nest import Nest
from beliefnest.nest.face.recorded import RecordedNest
from beliefnest.timeline.store import Journal
from beliefnest_benchmarks.browser import check_browser, opened_browser
from beliefnest_benchmarks.figures import Metric
from beliefnest_benchmarks.hills import Hills

__all__ = ["measure"]

_TICKS = 100
_FRAMES = 90
_LONGEST_MS = 20_000
_PATHS = ("/", "/agent0", "/agent4", "/agent0/agent4")

_WATCH = """
window.drawn = {count: 0, spent: 0}
window.plainFrame = window.requestAnimationFrame.bind(window)
window.requestAnimationFrame = act => window.plainFrame(now => {
  const began = performance.now()
  act(now)
  window.drawn.count++
  window.drawn.spent += performance.now() - began
})
"""
"""Script that counts the page's own frames and the time that it works for them."""

_TURN = """
const done = arguments[arguments.length - 1]
const [frames, longest] = arguments
const canvas = document.querySelector('.space canvas')
canvas.setPointerCapture = canvas.releasePointerCapture = () => {}
const room = canvas.getBoundingClientRect()
const at = {x: room.left + room.width / 2, y: room.top + room.height / 2}
const send = kind => canvas.dispatchEvent(new PointerEvent(kind, {
  pointerId: 1, pointerType: 'mouse', button: 0, buttons: 1, bubbles: true,
  clientX: at.x, clientY: at.y
}))
send('pointerdown')
window.drawn.count = window.drawn.spent = 0
const began = performance.now()
const next = () => {
  const {count, spent} = window.drawn
  if (count >= frames || performance.now() - began > longest) {
    send('pointerup')
    return done([1000 * count / (performance.now() - began), spent / count])
  }
  at.x += 3
  send('pointermove')
  window.plainFrame(next)
}
next()
"""
"""Script that drags the picture; it returns frames a second, and milliseconds of work a frame."""


def measure() -> Sequence[Metric]:
    """Return all figures of looking at hills of 200 x 64 x 200 blocks with 16 agents.

    Raises:
        InputError: There is no browser to measure in.
    """
    check_browser("looking")
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        store = place / "hills.bn"
        hills = Hills()
        with Nest(hills.world, store=store):
            for _ in range(_TICKS):
                hills.tick()
        return [*_page(place, store), *_pictures(place, store)]


def _page(place: Path, store: Path) -> list[Metric]:
    page = place / "hills.html"
    began = time.perf_counter()
    write_page(ShowOptions(store), page)
    written = time.perf_counter() - began
    with opened_browser(place / "profile") as browser:
        source = {"source": _WATCH}
        browser.driver.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", source)
        browser.open(page.as_uri())
        first = browser.script(
            "return performance.getEntriesByName('first-picture')[0].startTime / 1000"
        )
        rate, work = browser.ask(_TURN, _FRAMES, _LONGEST_MS)
        browser.open(f"{page.as_uri()}#at=/agent0&beside=/")
        both, _ = browser.ask(_TURN, _FRAMES, _LONGEST_MS)
    return [
        Metric("page of a large world, depth 2: writing it", written, "s"),
        Metric("its size", page.stat().st_size / 1e6, "MB", 5.0),
        Metric("its first picture", first, "s", 4.0),
        Metric("the page's own work for a frame while it turns", work, "ms", 16.0),
        Metric("turning, drawn in software", rate, "frames/s", 30.0, at_least=True),
        Metric("turning a belief beside reality", both, "frames/s", 30.0, at_least=True),
    ]


def _pictures(place: Path, store: Path) -> list[Metric]:
    figures = []
    with Journal.read(store) as journal:
        nest = RecordedNest(journal)
        nest.scenes(_PATHS)
        began = time.perf_counter()
        figure = nest.figure(_PATHS)
        figures.append(Metric("four simulators of it: reading", _since(began), "s", 2.0))
        for ending, most in (("svg", 0.5), ("pdf", 0.5), ("png", 2.0)):
            file = place / f"hills.{ending}"
            began = time.perf_counter()
            figure.save(file)
            name = f"their picture as {ending.upper()}"
            figures.append(Metric(f"{name}: writing", _since(began), "s", 2.0))
            figures.append(Metric(f"{name}: size", file.stat().st_size / 1e6, "MB", most))
    return figures


def _since(began: float) -> float:
    return time.perf_counter() - began
