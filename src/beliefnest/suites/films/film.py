"""One film: a floor with places, the path of an agent, and judgments of people."""

from collections.abc import Mapping
from math import comb, prod
from typing import Literal

import msgspec

from beliefnest.minds.infer_entries import MOST_HYPOTHESES

FilmCell = tuple[int, int]
"""Coordinates x, y from 1, y upwards."""

JudgedPart = Literal["desires", "beliefs", "locations"]
ABOUT: tuple[JudgedPart, ...] = ("desires", "beliefs", "locations")
"""Kinds of judgments: wanted goals, initial beliefs, and real contents of places."""

WHOLE = "model"
"""Name of the model that lacks nothing."""

NOTHING = "none"
"""Name for the content of a place without a goal."""


class FilmParameters(msgspec.Struct, frozen=True):
    """Parameters of the model; the defaults are the published ones.

    Attributes:
        rewards: Utilities to consider for each goal.
        rewards_by_goal: Utilities to consider for some goals, instead of `rewards`.
        discount: As for `MindModel`.
        step_cost: Cost of moving and of acting on a goal.
        stay_cost: As for `MindModel`.
        rationality: As for `MindModel`.
        grid: Steps of the grid of credences.
        smoothing: Smoothing of the grid of credences.
    """

    rewards: tuple[float, ...] = (-20, 0, 20, 40, 60, 80, 100)
    rewards_by_goal: Mapping[str, tuple[float, ...]] = msgspec.field(default_factory=dict)
    discount: float = 0.99
    step_cost: float = 1.0
    stay_cost: float = 0.0
    rationality: float = 2.5
    grid: int = 6
    smoothing: float = 0.075

    def rewards_of(self, goal: str) -> tuple[float, ...]:
        """Return the utilities to consider for a goal."""
        return self.rewards_by_goal.get(goal, self.rewards)


class Film(msgspec.Struct, frozen=True):
    """One film.

    Attributes:
        name: Its number in the file.
        size: Cells of the floor along x and y.
        walls: Cells that cannot be entered or seen through.
        places: Cells at which goals may be, by name.
        known: Goal at each place that is not in doubt; None: nothing.
        alternatives: By name, the goal at each place in doubt; None: nothing.
        actual: Alternatives that the observer considers possible; one: it knows the truth.
        goals: Names of the goals.
        path: Cells, one for each tick.
        ended: True if the agent acts on the goal at the end of its path.
        scored: True if it counts.
        people: Mean judgments of people, by kind, then by goal or alternative.
        errors: Standard errors of these means, if the file has them.
        group: Its group; empty: the file names none.
    """

    name: str
    size: tuple[int, int]
    walls: frozenset[FilmCell]
    places: Mapping[str, FilmCell]
    known: Mapping[str, str | None]
    alternatives: Mapping[str, Mapping[str, str | None]]
    actual: tuple[str, ...]
    goals: tuple[str, ...]
    path: tuple[FilmCell, ...]
    ended: bool
    scored: bool = True
    people: Mapping[JudgedPart, Mapping[str, float]] = msgspec.field(default_factory=dict)
    errors: Mapping[JudgedPart, Mapping[str, float]] = msgspec.field(default_factory=dict)
    group: str = ""

    @property
    def observer_doubts(self) -> bool:
        """True if the observer does not know the actual alternative."""
        return len(self.actual) > 1

    @property
    def events(self) -> Mapping[str, frozenset[str]]:
        """Return the events of beliefs and locations: sets of alternatives by name.

        Each alternative is an event. If several places are in doubt, so is each `PLACE=GOAL`.
        """
        names_of_event = {name: frozenset([name]) for name in self.alternatives}
        doubted = next(iter(self.alternatives.values()), {})
        for place in doubted if len(doubted) > 1 else ():
            for name, contents in self.alternatives.items():
                event = event_name(place, contents[place])
                names_of_event[event] = names_of_event.get(event, frozenset()) | {name}
        return names_of_event


def event_name(place: str, goal: str | None) -> str:
    """Return the name of the event that a goal is at a place; None: no goal."""
    return f"{place}={goal or NOTHING}"


class FilmRow(msgspec.Struct, frozen=True):
    """Judgment of the model about a film, with that of people beside it.

    Attributes:
        film: Name of the film.
        group: Its group; None: it has none.
        scored: True if the film counts.
        variant: The part that the model lacks; `model`: none.
        about: Kind of the judgment, one of `ABOUT`.
        name: Goal or event.
        model: The model's mean.
        people: Mean of people; None: not judged.
        people_se: Its standard error; None: not known.
        impossible: The first step that no hypothesis explains; None: each is explained.
        ok: None: judgments are neither right nor wrong.
        outcome: `ok`.
    """

    film: str
    group: str | None
    scored: bool
    variant: str
    about: str
    name: str
    model: float
    people: float | None
    people_se: float | None
    impossible: str | None
    ok: bool | None = None
    outcome: str = "ok"


_MOST_WEIGHTS = 60_000_000
"""Limit of weights of hypotheses in memory, at all steps; about 500 MB."""


def grid_for(film: Film, parameters: FilmParameters) -> int | None:
    """Return the steps of the grid of credences, reduced until the grid fits into memory.

    Returns:
        At most `parameters.grid`; None: not even the grid of certain beliefs fits.
    """
    alternatives = len(film.alternatives)
    others = prod(len(parameters.rewards_of(goal)) for goal in film.goals) * alternatives
    for grid in range(parameters.grid, 0, -1):
        hypotheses = others * comb(grid + alternatives - 1, alternatives - 1)
        if hypotheses <= MOST_HYPOTHESES and hypotheses * len(film.path) <= _MOST_WEIGHTS:
            return grid
    return None
