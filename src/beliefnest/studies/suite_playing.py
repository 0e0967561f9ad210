"""Playing of the cells of a suite in their folder, which is like that of a study."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager, nullcontext
from pathlib import Path
from typing import Any

from msgspec.structs import replace

from beliefnest.errors import InputError
from beliefnest.llm.budget import RunLimits
from beliefnest.llm.resolve import open_model
from beliefnest.locking import holding
from beliefnest.nest.past.versions import own_versions
from beliefnest.plan.cells import Keyed
from beliefnest.plan.jobs import OnStudyProgress, run_cells
from beliefnest.plan.processes import Crew, processes
from beliefnest.plan.worker import Ahead
from beliefnest.studies.result import StudyResult
from beliefnest.studies.study_folder import StudyFolder
from beliefnest.studies.table import CellKind
from beliefnest.worlds.minecraft.launching import ahead

PlayCells = Callable[[Sequence[Keyed]], None]
"""Function that plays those cells of a plan that have no result yet."""


def play_suite(
    folder: Path,
    kind: CellKind,
    cells: Sequence[Keyed],
    about: Mapping[str, Any],
    models: Iterable[str],
    on_progress: OnStudyProgress,
    limits: RunLimits | None = None,
    jobs: int = 1,
) -> StudyResult:
    """Play the cells of a suite without a result in a folder, and return all results.

    Args:
        folder: Folder of the results; made if it does not exist.
        kind: Kind of the cells.
        cells: The cells.
        about: Further values of the plan.
        models: Names of the models that the cells ask.
        on_progress: Function that receives the progress.
        limits: Limits of tokens and cost; None: the default ones.
        jobs: Number of cells to play in parallel; with several, each cell opens its models.

    Raises:
        InputError: The folder holds something else or a suite of other data, or another process
            plays in it.
        ModelError: A model does not exist, or its key is missing.
    """
    place = StudyFolder.open(folder, kind)
    with cells_player(place, about, models, on_progress, limits or RunLimits(), jobs) as play:
        play(cells)
    return StudyResult(place)


@contextmanager
def cells_player(
    place: StudyFolder,
    about: Mapping[str, Any],
    models: Iterable[str],
    on_progress: OnStudyProgress,
    limits: RunLimits,
    jobs: int,
) -> Iterator[PlayCells]:
    """Hold a folder, and yield the function that plays cells there.

    A plan may grow: give the function all cells of the plan each time. Arguments and errors are
    those of `play_suite`.
    """
    terms = place.terms(limits)
    # Answers of a file go on from cell to cell.
    opened = {name: open_model(name, terms.surroundings, terms.connection()) for name in models}
    shared = replace(terms, models=opened) if jobs == 1 else terms

    def play(cells: Sequence[Keyed]) -> None:
        planned = [cell.plain() for cell in cells]
        plan = {**about, "cells": planned, "invalid": [], "versions": own_versions()}
        _check_same(place, plan)
        place.write_plan(plan)
        run_cells(cells, place, shared, jobs, "loky", on_progress, ahead, hire=kept.hire)

    with holding(place.path), ExitStack() as stack:
        kept = KeptProcesses(stack)
        yield play


class KeptProcesses:
    """Worker processes that are kept from one part of a plan to the next.

    They take longer to start than to play some cells.

    Args:
        stack: Stack that ends them.
    """

    def __init__(self, stack: ExitStack) -> None:
        self._hired = stack.enter_context(ExitStack())
        self._crew: Crew | None = None

    def hire(self, count: int, world: str, ahead: Ahead) -> AbstractContextManager[Crew]:
        """Return at least `count` processes; see `plan.processes.processes`."""
        if self._crew is None or len(self._crew.ready) < count:
            self._hired.close()
            self._crew = self._hired.enter_context(processes(count, world, ahead))
        return nullcontext(self._crew)


def _check_same(place: StudyFolder, plan: Mapping[str, Any]) -> None:
    """Raise InputError if a folder holds another suite, or one of other data."""
    place.check_subjects(plan)
    before = place.plan() if place.has_plan else plan
    played, wanted = ({cell["variation"] for cell in each["cells"]} for each in (before, plan))
    if before.get("data") != plan.get("data") and played.isdisjoint(wanted):
        raise InputError(
            f"{place.path} holds results of {before['data']}, which has nothing in common with "
            f"{plan['data']}; name another folder"
        )
