"""Workers that play the cells of a study, in any process."""

import threading
import time
import warnings
from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from typing import Any

from beliefnest.errors import BeliefNestError
from beliefnest.llm.claim_reader import claims_from_model
from beliefnest.llm.failures import UnavailableModelError
from beliefnest.llm.messages import Sampling
from beliefnest.llm.model_settings import ModelSettings
from beliefnest.llm.resolve import can_vary, is_free, open_model
from beliefnest.nest.face.nest import Nest
from beliefnest.prompts import Renderer
from beliefnest.scenarios.content import ScenarioWarning
from beliefnest.scenarios.probing import Asking
from beliefnest.scenarios.records import expectation_json, probe_json
from beliefnest.scenarios.running import run_scenario
from beliefnest.studies.cells import Cell, Keyed
from beliefnest.studies.episode_cells import EpisodeCell
from beliefnest.studies.episode_playing import play_episode
from beliefnest.studies.terms import Terms
from beliefnest.worlds.by_name import Worlds
from beliefnest.worlds.minecraft.embedded import launched
from beliefnest.worlds.minecraft.launching import Launch


@dataclass(frozen=True, slots=True)
class CellResult:
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


class Worker:
    """Player of cells, one after the other, in worlds that stay open between them.

    Args:
        stack: Stack that closes the worlds.
        launch: Node of the embedded world, started earlier with seed 0.
    """

    def __init__(self, stack: ExitStack, launch: Launch | None = None) -> None:
        self._worlds = stack.enter_context(Worlds(0, begun=launched(0, launch)))
        self._renderer = Renderer()

    def play(self, cell: Keyed, terms: Terms) -> CellResult:
        """Play a cell; an error of the scenario, world or model is its result."""
        started = time.perf_counter()
        # A process has only standard error for its warnings; the study gives them, each once.
        with warnings.catch_warnings(record=True) as found:
            warnings.simplefilter("always", ScenarioWarning)
            content, unavailable = self._content(cell, terms)
        told = [each for each in found if isinstance(each.message, ScenarioWarning)]
        for each in found:
            if each not in told:
                warnings.warn_explicit(each.message, each.category, each.filename, each.lineno)
        seconds = time.perf_counter() - started
        ours = tuple(each.message for each in told if isinstance(each.message, ScenarioWarning))
        return CellResult(cell.key.name, content, seconds, unavailable, ours)

    def _content(self, cell: Keyed, terms: Terms) -> tuple[dict[str, Any], str]:
        """Return the content of a cell, and why no further cell can be played."""
        unavailable = ""
        try:
            if isinstance(cell, EpisodeCell):
                content = play_episode(cell, terms, self._worlds)
            elif isinstance(cell, Cell):
                content = self._played(cell, terms)
            else:
                raise TypeError(f"{cell!r} is no cell that can be played")
        except BeliefNestError as error:
            content = {"error": str(error), "kind": type(error).__name__}
            if isinstance(error, UnavailableModelError):
                unavailable = str(error)
        return content, unavailable

    def _played(self, cell: Cell, terms: Terms) -> dict[str, Any]:
        key, scenario = cell.key, cell.scenario
        environment = terms.surroundings
        settings = ModelSettings.of_chosen(key.setting)
        connection = terms.connection(settings.answer_limits)
        if can_vary(key.model):
            # Check this before the script, which would otherwise be played in vain.
            connection.budget.check(is_free=is_free(key.model, environment))
        model = open_model(key.model, environment, connection)
        sampling = settings.sampling(Sampling(key.setting["temperature"], key.seed))
        asking = Asking(key.setting["attempts"], sampling, settings)
        store = terms.store(key.name)
        reader = key.setting.get("claims_from")
        claims_from = None
        if reader is not None:
            claims_from = claims_from_model(open_model(reader, environment, connection), sampling)
        with Nest.open(
            scenario,
            key.setting["world"],
            store,
            key.seed,
            self._worlds,
            claims_from=claims_from,
            renderer=self._renderer,
        ) as nest:
            outcome = run_scenario(nest, scenario, model, key.seed, 0.0, _say_nothing, asking)
        return {
            "error": None,
            "ticks": outcome.ticks,
            "run": "" if store is None else f"runs/{store.name}",
            "expectations": [expectation_json(each) for each in outcome.expectations],
            "probes": [
                {**probe_json(each, ""), "answer": each.answer, "seconds": each.ticks / 20}
                for each in outcome.probes
            ],
        }


def _say_nothing(what: str, done: int, total: int) -> None:
    """Ignore progress within a cell: the study reports progress by cells."""


class _Kept(threading.local):
    """Worker of a thread. A process pool has no other place to keep a world open."""

    stack: ExitStack | None = None
    worker: Worker | None = None


_kept = _Kept()


def keep_worker(stack: ExitStack, launch: Launch | None = None) -> Worker:
    """Return a worker that this thread keeps, with the stack, until its process ends."""
    _kept.stack, _kept.worker = stack, Worker(stack, launch)
    return _kept.worker


def play_in_process(cell: Keyed, terms: Terms) -> CellResult:
    """Play a cell with the worker that this thread keeps."""
    # The process of a world ends with the process that started it.
    worker = _kept.worker or keep_worker(ExitStack())
    return worker.play(cell, terms)
