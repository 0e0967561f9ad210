"""Meaning of a probe's `infer` in scenarios."""

import math
from dataclasses import fields
from typing import Any

from msgspec.structs import asdict

from beliefnest.facts.reading import check_entry, edits_of
from beliefnest.minds.mind_model import MindModel, simplex_grid
from beliefnest.scenarios.checks import Checks
from beliefnest.scenarios.document import Document, KeyPath
from beliefnest.scenarios.format import GridEntry, InferEntry, LevelsEntry
from beliefnest.scenarios.inferring import Inferring
from beliefnest.world.frames import Snapshot
from beliefnest.world.registry import Registry
from beliefnest.world.values import Items, Position

MOST_HYPOTHESES = 2_000_000
"""Greatest number of combinations of utilities, credences and alternatives."""

_SLACK = 1e-9


class _Supposed(Checks, frozen=True):
    """Checks of alternatives, in which blocks may be containers that are none in the scene."""

    def container(self, path: KeyPath, position: Position) -> Position:
        """Return the position of the container to which a block belongs or would belong."""
        self.inside(path, position)
        return self.container_at(position)

    def contents(self, path: KeyPath, place: Position, items: Items) -> None:
        """Refuse unknown items; how many fit depends on the block."""
        self.possessions(path, items)


def build_inferring(
    document: Document, path: KeyPath, entry: InferEntry, snapshot: Snapshot
) -> Inferring:
    """Build the inference of a probe.

    Raises:
        ScenarioError: The model is not consistent, or names something that does not exist.
    """
    checks = _Supposed(document, snapshot, Registry.load())
    checks.agent((*path, "agent"), entry.agent)
    for name, goal in entry.goals.items():
        if goal.at is not None:
            checks.inside((*path, "goals", name, "at"), goal.at)
    if entry.until is not None and entry.until < entry.since:
        raise document.fault((*path, "until"), f"{entry.until} is before since, {entry.since}")
    doubt = None
    if entry.doubt is not None:
        doubt = {
            name: edits_of(
                check_entry(each, (*path, "doubt", name, number), checks)
                for number, each in enumerate(facts)
            )
            for name, facts in entry.doubt.items()
        }
    utilities = _utilities(document, (*path, "utilities"), entry)
    _check_count(document, path, entry)
    read = {
        "goals": {
            name: {key: value for key, value in asdict(goal).items() if value is not None}
            for name, goal in entry.goals.items()
        },
        "utilities": utilities,
        "doubt": doubt,
        "credences": _credences(document, (*path, "credences"), entry),
    }
    plain = {
        field.name: getattr(entry, field.name)
        for field in fields(MindModel)
        if field.init and field.name not in read
    }
    with document.naming(path):
        model = MindModel(**read, **plain)
    return Inferring(
        model, entry.since, entry.until, entry.ended, entry.smooth, document.where(path)
    )


def _credences(document: Document, path: KeyPath, entry: InferEntry) -> Any:
    credences = entry.credences
    if not isinstance(credences, GridEntry):
        return credences
    with document.naming(path):
        return simplex_grid(len(entry.doubt or {}) or 1, credences.grid, credences.smoothing)


def _utilities(document: Document, path: KeyPath, entry: InferEntry) -> Any:
    utilities = entry.utilities
    if isinstance(utilities, list):
        return utilities
    return {
        goal: _levels(document, (*path, goal), levels)
        if isinstance(levels, LevelsEntry)
        else levels
        for goal, levels in utilities.items()
    }


def _levels(document: Document, path: KeyPath, entry: LevelsEntry) -> list[float]:
    low, high = entry.range
    if not math.isfinite(low) or not math.isfinite(high) or low > high:
        raise document.fault((*path, "range"), "give two numbers, the lower one first")
    count = math.floor((high - low) / entry.step + _SLACK) + 1
    if count > MOST_HYPOTHESES:
        raise document.fault(path, f"has {count:,} values; take a larger step")
    return [low + number * entry.step for number in range(count)]


def _check_count(document: Document, path: KeyPath, entry: InferEntry) -> None:
    """Refuse more hypotheses than fit into memory before creating them."""
    utilities, alternatives = entry.utilities, len(entry.doubt or {}) or 1
    count = len(utilities) if isinstance(utilities, list) else 1
    for levels in () if isinstance(utilities, list) else utilities.values():
        if isinstance(levels, LevelsEntry):
            low, high = levels.range
            count *= math.floor((high - low) / levels.step + _SLACK) + 1
        elif isinstance(levels, list):
            count *= len(levels)
    credences = entry.credences
    if isinstance(credences, GridEntry):
        count *= math.comb(credences.grid + alternatives - 1, alternatives - 1)
    elif credences is not None:
        count *= len(credences)
    if count * alternatives > MOST_HYPOTHESES:
        raise document.fault(
            path,
            f"has {count * alternatives:,} hypotheses, at most {MOST_HYPOTHESES:,} are possible; "
            "name fewer utilities, or a coarser grid of credences",
        )
