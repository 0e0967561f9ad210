"""Workers that play the cells of a plan, in any process."""

import threading
import time
import warnings
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, ExitStack
from typing import Any, Protocol

import msgspec

from beliefnest.errors import BeliefNestError
from beliefnest.llm.failures import UnavailableModelError
from beliefnest.plan.cells import Keyed
from beliefnest.plan.terms import PlayStage, Terms
from beliefnest.prompts import Renderer
from beliefnest.scenarios.content import ScenarioWarning
from beliefnest.worlds.by_name import Worlds
from beliefnest.worlds.protocol import World


class CellResult(msgspec.Struct, frozen=True):
    """Result of a cell.

    Attributes:
        name: Name of the cell.
        content: Plain values; reproducible, apart from answers of providers' models.
        seconds: Wall time in seconds.
        unavailable: Why no further cell can be played; empty: others can be.
        warnings: Warnings about the scenario.
    """

    name: str
    content: Mapping[str, Any]
    seconds: float
    unavailable: str = ""
    warnings: tuple[ScenarioWarning, ...] = ()


class Launched(Protocol):
    """World that was launched before it is needed."""

    def worlds(self, seed: int) -> Mapping[str, World]:
        """Return it by its name; it has this seed."""


Ahead = Callable[[str, int], AbstractContextManager[Launched | None]]
"""Function that launches the world of a name with a seed, if it takes long to start."""


class Worker:
    """Player of cells, one after the other, in worlds that stay open between them.

    Args:
        stack: Stack that closes the worlds.
        launch: World that was launched earlier with the same seed; None: none was.
        seed: Seed of the worlds' own random numbers.
        caught: Errors that are results of cells; others are raised.
    """

    def __init__(
        self,
        stack: ExitStack,
        launch: Launched | None = None,
        seed: int = 0,
        caught: type[BeliefNestError] = BeliefNestError,
    ) -> None:
        begun = {} if launch is None else launch.worlds(seed)
        self._worlds = stack.enter_context(Worlds(seed, begun=begun))
        self._renderer = Renderer()
        self._caught = caught

    def play(self, cell: Keyed, terms: Terms) -> CellResult:
        """Play a cell, and note its time and its warnings, which are not shown here."""
        started = time.perf_counter()
        # A process has only standard error for its warnings; the study gives them, each once.
        with warnings.catch_warnings(record=True) as seen:
            warnings.simplefilter("always", ScenarioWarning)
            content, unavailable = self.content(cell, terms)
        ours = tuple(each.message for each in seen if isinstance(each.message, ScenarioWarning))
        for each in seen:
            if each.message not in ours:
                warnings.warn_explicit(each.message, each.category, each.filename, each.lineno)
        return CellResult(cell.key.name, content, time.perf_counter() - started, unavailable, ours)

    def content(self, cell: Keyed, terms: Terms) -> tuple[dict[str, Any], str]:
        """Play a cell; return its content, and why no further cell can be played.

        An error of the scenario, world or model is its content.
        """
        try:
            return cell.play(PlayStage(terms, self._worlds, self._renderer)), ""
        except self._caught as error:
            content = {"error": str(error), "kind": type(error).__name__}
            is_last = isinstance(error, UnavailableModelError)
            return content, str(error) if is_last else ""


class _Kept(threading.local):
    """Worker of a thread. A process pool has no other place to keep a world open."""

    stack: ExitStack | None = None
    worker: Worker | None = None


_kept = _Kept()


def keep_worker(stack: ExitStack, launch: Launched | None = None) -> Worker:
    """Return a worker that this thread keeps, with the stack, until its process ends."""
    _kept.stack, _kept.worker = stack, Worker(stack, launch)
    return _kept.worker


def play_in_process(cell: Keyed, terms: Terms) -> CellResult:
    """Play a cell with the worker that this thread keeps."""
    # The process of a world ends with the process that started it.
    worker = _kept.worker or keep_worker(ExitStack())
    return worker.play(cell, terms)
