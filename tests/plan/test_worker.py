"""Workers play cells of any kind, and know none."""

import os
from contextlib import ExitStack, nullcontext
from dataclasses import dataclass, replace

import pytest
from tests.children import children

from beliefnest.errors import BeliefNestError, ModelError
from beliefnest.llm.budget import RunLimits
from beliefnest.llm.failures import UnavailableModelError
from beliefnest.plan.cells import Key, cell_seed
from beliefnest.plan.jobs import run_cells
from beliefnest.plan.spending import spent_in
from beliefnest.plan.terms import PlayStage, Terms
from beliefnest.plan.worker import Worker
from beliefnest.studies.suite_playing import KeptProcesses


@dataclass(frozen=True, slots=True)
class NumberKey(Key):
    number: int

    @property
    def seed(self) -> int:
        return cell_seed(self.number)


@dataclass(frozen=True)
class NumberCell:
    """Kind of cell that the package does not have."""

    key: NumberKey
    error: BeliefNestError | None = None
    world: str = ""
    is_quick: bool = True

    def plain(self) -> dict[str, object]:
        return {"name": self.key.name}

    def play(self, stage: PlayStage) -> dict[str, object]:
        if self.error is not None:
            raise self.error
        square, limit = self.key.number**2, stage.terms.limits.tokens
        return {"error": None, "square": square, "limit": limit, "process": os.getpid()}


class Kept:
    """Folder of results, in memory."""

    def __init__(self, ledger):
        self.ledger, self.cells = ledger, {}

    def cell(self, name):
        return self.cells.get(name)

    def write_cell(self, name, content):
        self.cells[name] = content

    def note_seconds(self, name, seconds):
        assert seconds >= 0


def terms_in(folder):
    return Terms(folder / "answers", folder / "spent.jsonl", None, RunLimits(7, None))


def nothing_ahead(world, seed):
    raise AssertionError("a process was started")


def no_world(world, seed):
    return nullcontext()


def test_cells_of_another_kind_are_played_and_go_on(tmp_path):
    folder = Kept(tmp_path / "spent.jsonl")
    told = []
    cells = [NumberCell(NumberKey(number)) for number in range(3)]
    failing = NumberCell(NumberKey(1), ModelError("no answer today"))
    first = [cells[0], failing, cells[2]]
    run_cells(first, folder, terms_in(tmp_path), 1, "loky", told.append, nothing_ahead)
    assert [(each.done, each.failed) for each in told] == [(0, 0), (1, 0), (1, 1), (2, 1)]
    told.clear()
    run_cells(cells, folder, terms_in(tmp_path), 1, "loky", told.append, nothing_ahead)
    assert [(each.done, each.failed) for each in told] == [(2, 0), (3, 0)]
    kept = [folder.cells[cell.key.name] for cell in cells]
    assert [each["square"] for each in kept] == [0, 1, 4]
    assert [(each["key"], each["limit"]) for each in kept] == [
        ({"number": number}, 7) for number in range(3)
    ]
    assert spent_in(folder.ledger).requests == 0


def test_the_processes_of_one_part_of_a_plan_play_the_next_one(tmp_path):
    folder = Kept(tmp_path / "spent.jsonl")
    cells = [replace(NumberCell(NumberKey(number)), is_quick=False) for number in range(4)]
    with ExitStack() as stack:
        kept = KeptProcesses(stack)
        options = {"on_progress": print, "ahead": no_world, "hire": kept.hire}
        for part in (cells[:2], cells):
            run_cells(part, folder, terms_in(tmp_path), 2, "loky", **options)
        processes = {folder.cells[each.key.name]["process"] for each in cells}
        assert os.getpid() not in processes
        assert len(processes) <= 2
        assert processes <= children()
    assert processes.isdisjoint(children())


def test_a_worker_raises_the_errors_that_are_no_results(tmp_path):
    with ExitStack() as stack:
        worker = Worker(stack, caught=ModelError)
        lost = worker.play(
            NumberCell(NumberKey(1), UnavailableModelError("no server")), terms_in(tmp_path)
        )
        assert lost.unavailable == "no server"
        assert lost.content["kind"] == "UnavailableModelError"
        with pytest.raises(BeliefNestError, match="the world is gone"):
            worker.play(
                NumberCell(NumberKey(2), BeliefNestError("the world is gone")), terms_in(tmp_path)
            )
