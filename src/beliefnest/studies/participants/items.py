"""Items that participants see: the cells of a study, without models, and their questions."""

from collections.abc import Iterable, Iterator, Mapping, Sequence

import msgspec

from beliefnest.plan.cells import digest
from beliefnest.plan.scenario_cells import Cell
from beliefnest.scenarios.content import Probe
from beliefnest.scenarios.document import Document
from beliefnest.scenarios.expected_answers import Answers


class ItemQuestion(msgspec.Struct, frozen=True):
    """Question of a probe, as participants answer it.

    Attributes:
        probe: Index of the probe in the scenario.
        index: Index of the question in the probe.
        asked: The question.
    """

    probe: int
    index: int
    asked: Answers

    @property
    def id(self) -> str:
        """Number of the probe and number of the question in it, such as `1.2`."""
        return f"{self.probe + 1}.{self.index + 1}"


class Item(msgspec.Struct, frozen=True):
    """Variation of a scenario under one condition, which a participant sees at most once.

    Attributes:
        name: Name of the item: 16 letters and digits, which depend on the scenario's file, the
            condition, the variation, the world and the seed, but on no model.
        cell: First cell of the study with this content.
        questions: Its questions, in the order of the scenario.
    """

    name: str
    cell: Cell
    questions: tuple[ItemQuestion, ...]

    def probe(self, question: ItemQuestion) -> Probe:
        """Return the probe of a question."""
        return self.cell.scenario.probes[question.probe]

    @property
    def paths(self) -> tuple[str, ...]:
        """Belief paths of the questions, each once."""
        return tuple(dict.fromkeys(self.probe(each).path for each in self.questions))

    def at(self, path: str) -> tuple[ItemQuestion, ...]:
        """Return the questions that are asked of a belief path."""
        return tuple(each for each in self.questions if self.probe(each).path == path)


def items_of(cells: Iterable[Cell], documents: Mapping[str, Document]) -> list[Item]:
    """Return the items of a study, in the order of its cells.

    Args:
        cells: Cells of the study's plan.
        documents: Documents of its scenarios.

    Raises:
        ScenarioError: No probe asks a question; the message names file, line and key.
    """
    items_by_name: dict[str, Item] = {}
    for cell in cells:
        questions = tuple(_questions(cell.scenario.probes))
        if questions:
            item = Item(item_name(cell), cell, questions)
            items_by_name.setdefault(item.name, item)
    if not items_by_name:
        document = next(iter(documents.values()))
        raise document.fault(
            ("probes",),
            "no probe asks a question that people can answer; give one "
            "`expect: {answers: {question: ..., right: ...}}`",
        )
    return list(items_by_name.values())


def left_out(cells: Iterable[Cell]) -> list[str]:
    """Return a line for each probe that people are not asked, with the reason."""
    reasons = []
    for cell in cells:
        for number, probe in enumerate(cell.scenario.probes, 1):
            why = _why_left_out(probe)
            if why:
                name = repr(probe.label) if probe.label else str(number)
                reasons.append(f"{cell.key.scenario}: probe {name} is left out: {why}")
    return list(dict.fromkeys(reasons))


def _why_left_out(probe: Probe) -> str:
    if probe.infer is not None:
        return "it is computed from the agent's course and asks nobody"
    if probe.asks_for_program:
        mixed = " besides its questions; put these into a probe of their own" * bool(
            probe.questions
        )
        return f"it asks for a program, which people do not write{mixed}"
    return ""


def _questions(probes: Sequence[Probe]) -> Iterator[ItemQuestion]:
    for number, probe in enumerate(probes):
        if not _why_left_out(probe):
            for index, asked in enumerate(probe.questions):
                yield ItemQuestion(number, index, asked)


def item_name(cell: Cell) -> str:
    """Return the name of the item of a cell, which no model, repeat or way of asking affects."""
    key = cell.key
    setting = {name: key.setting[name] for name in ("seed", "world")}
    return digest([key.scenario, key.content, key.condition, dict(key.variation), setting])[:16]
