"""Benchmarks of the page: size, loading time, scrubbing rate, and delay of the live page."""

import math
import random
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from statistics import median

from beliefnest.cli.options import ShowOptions
from beliefnest.cli.page import write_page
from beliefnest.errors import BodyError
from beliefnest.nest.face.nest import Nest
from beliefnest.perception.options import Perception
from beliefnest.scenarios.scenario import Scenario
from beliefnest.worlds.scripted.world import ScriptedWorld
from beliefnest_benchmarks.browser import Browser, check_browser, opened_browser
from beliefnest_benchmarks.figures import Metric

__all__ = ["measure"]

_TICKS = 10_000
_AGENTS = 8
_BOX = ((0, 0, 0), (24, 3, 24))
_STEP = 0.2158
"""Blocks a player walks in one tick."""

_PICTURES = 60
_CHANGES = 20

_SCRUB = """
const done = arguments[arguments.length - 1]
const [pictures, last] = arguments
const slider = document.querySelector('input[type=range]')
let shown = 0
const began = performance.now()
const next = () => {
  if (shown === pictures) return done(1000 * pictures / (performance.now() - began))
  slider.value = Math.round(last * ((shown * 7) % pictures) / pictures)
  slider.dispatchEvent(new Event('input'))
  shown++
  requestAnimationFrame(() => requestAnimationFrame(next))
}
next()
"""

_WATCH = """
const slider = document.querySelector('input[type=range]')
window.seen = {}
const note = () => { window.seen[slider.max] ??= Date.now() }
new MutationObserver(note).observe(slider, {attributes: true})
"""


def measure() -> Sequence[Metric]:
    """Return all figures of the page.

    Raises:
        InputError: There is no browser to measure in.
    """
    check_browser("viewer")
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        with opened_browser(place / "profile") as browser:
            story, long = _story(place), _long(place)
            browser.open(story.as_uri())
            first = browser.script(
                "return performance.getEntriesByName('first-picture')[0].startTime / 1000"
            )
            browser.open(long.as_uri())
            rate = browser.ask(_SCRUB, _PICTURES, _TICKS)
            late = _late(place, browser)
        return [
            Metric("Sally-Anne as one page", story.stat().st_size / 1e6, "MB", 1.5),
            Metric("its first picture", first, "s", 2.0),
            Metric(
                f"{_TICKS} ticks, {_AGENTS} agents, depth 2", long.stat().st_size / 1e6, "MB", 10
            ),
            Metric("scrubbing there", rate, "pictures/s", 15.0, at_least=True),
            Metric("a change until it is on the live page", late, "ms", 100.0),
        ]


def _story(place: Path) -> Path:
    store, page = place / "story.bn", place / "story.html"
    with Nest.open(Scenario.load("sally-anne", condition=1), store=store) as nest:
        nest.play()
    write_page(ShowOptions(store), page)
    return page


def _long(place: Path) -> Path:
    """Write the page of a long walk of many agents in a hall with walls, and return its path."""
    store, page = place / "long.bn", place / "long.html"
    walk = _Walk()
    with Nest(walk.world, Perception(), static_blocks=["stone", "air"], store=store):
        for _ in range(_TICKS):
            walk.tick()
    write_page(ShowOptions(store), page)
    return page


class _Walk:
    """Agents that walk about among walls."""

    def __init__(self) -> None:
        self._chance = random.Random(8)
        blocks = {(x, 0, z): "stone" for x in range(25) for z in range(25)}
        walls = {(x, z) for x in (6, 12, 18) for z in range(25) if z % 8 > 2}
        blocks |= {(x, y, z): "stone" for x, z in walls for y in (1, 2)}
        self._walls = walls
        self._feet = {f"agent{n}": (3.5, 1.0, 1.5 + 3 * n) for n in range(_AGENTS)}
        self._yaws = {name: self._chance.uniform(-math.pi, math.pi) for name in self._feet}
        self.world = ScriptedWorld(_BOX, blocks, self._feet)

    def tick(self) -> None:
        """Move all agents by one step; agents turn at walls."""
        with self.world.tick():
            for name, (x, y, z) in self._feet.items():
                yaw = self._yaws[name]
                to = (x - math.sin(yaw) * _STEP, y, z - math.cos(yaw) * _STEP)
                inside = all(0.4 < at < 24.6 for at in (to[0], to[2]))
                if inside and (int(to[0]), int(to[2])) not in self._walls:
                    self._feet[name] = to
                else:
                    self._yaws[name] = self._chance.uniform(-math.pi, math.pi)
                self.world.place_agent(name, self._feet[name], self._yaws[name])


def _late(place: Path, browser: Browser) -> float:
    """Return milliseconds from the end of a call that changes the world until the page shows it."""
    store = place / "live.bn"
    delays: list[float] = []
    walk = _Walk()
    with Nest(walk.world, Perception(), static_blocks=["stone", "air"], store=store):
        walk.tick()
        with _served(store) as address:
            browser.open(address)
            browser.script(_WATCH)
            for _ in range(_CHANGES):
                walk.tick()
                changed, tick = time.time(), walk.world.snapshot().tick
                seen = browser.until_script(f"return window.seen[{tick}]")
                delays.append(seen - 1e3 * changed)
    return median(delays)


@contextmanager
def _served(store: Path) -> Iterator[str]:
    command = [sys.executable, "-m", "beliefnest", "serve", str(store), "--port", "0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        if process.stdout is None:
            raise BodyError("the server's output cannot be read")
        words = process.stdout.readline().split()
        try:
            yield next(word for word in words if word.startswith("http://"))
        finally:
            process.terminate()
            process.wait()
