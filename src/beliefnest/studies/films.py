"""Films of agents who look for something: acted out in nests, judged by inference, and by people.

The form of a set of films is that of the food trucks (Baker, Jara-Ettinger, Saxe and Tenenbaum
2017): floors with walls and places, what may be at each place, and paths. Coordinates in files are
[x, y] from 1, y upwards. Nothing is fitted; the file names the parameters.
"""

import itertools
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import msgspec
import numpy as np

from beliefnest.errors import InputError
from beliefnest.minds.inference import Inference
from beliefnest.minds.model import MindModel, simplex_grid
from beliefnest.nest.face.nest import Nest
from beliefnest.perception.options import Perception
from beliefnest.world.scripted import ScriptedWorld
from beliefnest.world.values import Position

__all__ = [
    "LESIONS",
    "Correlation",
    "Film",
    "FilmParameters",
    "Judgment",
    "correlation",
    "films_from",
    "judge",
    "model_of",
    "read_films",
    "staged",
]

AGENT = "student"

Lesion = Literal["true_belief", "no_cost"]
LESIONS: tuple[Lesion, ...] = ("true_belief", "no_cost")
"""Models without a part: an agent who knows the world, and one to whom acts cost nothing."""

_GOAL_BLOCKS = (
    *("gold_block", "emerald_block", "diamond_block", "redstone_block", "lapis_block"),
    *("copper_block", "iron_block", "coal_block", "netherite_block", "quartz_block"),
)
_FLOOR, _WALL, _EMPTY = "stone", "stone", "gravel"
_NOTHING = "none"


@dataclass(frozen=True)
class FilmParameters:
    """Parameters of the model, as published.

    Attributes:
        rewards: Utilities to consider for each goal.
        discount: As for `MindModel`.
        step_cost: Of moving and of acting on a goal.
        stay_cost: As for `MindModel`.
        rationality: As for `MindModel`.
        grid: Steps of the grid of credences.
        smoothing: Of the grid of credences.
    """

    rewards: tuple[float, ...] = (-20, 0, 20, 40, 60, 80, 100)
    discount: float = 0.99
    step_cost: float = 1.0
    stay_cost: float = 0.0
    rationality: float = 2.5
    grid: int = 6
    smoothing: float = 0.075


@dataclass(frozen=True)
class Film:
    """One film.

    Attributes:
        name: Its number in the file.
        size: Cells of the floor along x and y.
        walls: Cells that cannot be entered or seen through.
        places: Cells at which something may be, by name.
        known: Goal at each place that is not in doubt; None: nothing.
        alternatives: By name, the goal at each place in doubt; None: nothing.
        actual: The alternative that is the case; None: the observer does not know.
        goals: Names of the goals.
        path: Cells, one for each tick.
        ended: Whether the agent acts on the goal at the end of its path.
        scored: Whether it counts.
        desires: Judged by people, by goal.
        beliefs: Judged by people, by alternative.
        locations: Judged by people, by alternative, where the observer does not know.
        group: What it is about.
    """

    name: str
    size: tuple[int, int]
    walls: frozenset[tuple[int, int]]
    places: Mapping[str, tuple[int, int]]
    known: Mapping[str, str | None]
    alternatives: Mapping[str, Mapping[str, str | None]]
    actual: str | None
    goals: tuple[str, ...]
    path: tuple[tuple[int, int], ...]
    ended: bool
    scored: bool = True
    desires: Mapping[str, float] = field(default_factory=dict)
    beliefs: Mapping[str, float] = field(default_factory=dict)
    locations: Mapping[str, float] = field(default_factory=dict)
    group: str = ""


@dataclass(frozen=True)
class Judgment:
    """What the model says of a film.

    Attributes:
        film: The film.
        desires: Posterior mean of each goal's utility.
        beliefs: Posterior mean of the initial credence in each alternative.
        locations: Posterior probability of each alternative.
        inference: The whole posterior.
    """

    film: Film
    desires: Mapping[str, float]
    beliefs: Mapping[str, float]
    locations: Mapping[str, float]
    inference: Inference


@dataclass(frozen=True)
class Correlation:
    """Judgments of the model beside people's, pair by pair.

    Attributes:
        model: float64 (pairs,).
        people: float64 (pairs,).
        films: Number of the film of each pair.
    """

    model: np.ndarray[tuple[int], np.dtype[np.float64]]
    people: np.ndarray[tuple[int], np.dtype[np.float64]]
    films: np.ndarray[tuple[int], np.dtype[np.int64]]

    @property
    def r(self) -> float:
        """Pearson's coefficient; nan where one side does not vary."""
        with np.errstate(invalid="ignore", divide="ignore"):
            return float(np.corrcoef(self.model, self.people)[0, 1])


def read_films(path: str | Path) -> tuple[list[Film], FilmParameters]:
    """Read a file of films, with the parameters that it names.

    Raises:
        InputError: The file is missing, or not of the form.
    """
    try:
        content = msgspec.json.decode(Path(path).read_bytes())
    except (OSError, msgspec.DecodeError) as error:
        raise InputError(f"{path}: cannot be read as films: {error}") from None
    try:
        return films_from(content), _parameters(content.get("parameters", {}))
    except (KeyError, TypeError, ValueError, AttributeError, IndexError) as error:
        raise InputError(
            f"{path}: is not of the form of the food trucks ({type(error).__name__}: {error}); "
            "see docs/minds.md"
        ) from None


def films_from(content: Mapping[str, Any]) -> list[Film]:
    """Return the films of a decoded file; KeyError and the like if it has another form."""
    return [
        _film(entry, content["worlds"][entry["world_set"] - 1]) for entry in content["scenarios"]
    ]


def _film(entry: Mapping[str, Any], world: Mapping[str, Any]) -> Film:
    places = {
        key: (int(world[key][0]), int(world[key][1]))
        for key in world
        if re.fullmatch(r"spot\d+", key)
    }
    human = entry.get("human", {})
    doubted = [place for place in places if f"possible_{place}" in world]
    named = {goal for place in doubted for goal in world[f"possible_{place}"] if goal}
    goals = _letters(human, "desire") or tuple(sorted(named))
    left = [goal for goal in goals if goal not in named]
    known: dict[str, str | None] = {}
    for place in places:
        if place not in doubted:
            held = entry.get(f"true_{place}", world.get(f"{place}_holds", ""))
            known[place] = held if held != "" else left.pop(0)
    alternatives = {}
    for combination in itertools.product(*(world[f"possible_{place}"] for place in doubted)):
        name = "+".join(goal or _NOTHING for goal in combination)
        alternatives[name] = dict(zip(doubted, combination, strict=True))
    true = [entry.get(f"true_{place}", "unknown") for place in doubted]
    actual = None if "unknown" in true else "+".join(goal or _NOTHING for goal in true)
    return Film(
        str(entry["id"]),
        (int(world["size"][0]), int(world["size"][1])),
        frozenset((int(x), int(y)) for x, y in world["wall"]),
        places,
        known,
        alternatives,
        actual,
        goals,
        tuple((int(x), int(y)) for x, y in entry["path_xy"]),
        bool(entry["ends_with_eat"]),
        not entry.get("excluded", False),
        _rated(human, "desire", goals),
        _rated(human, "belief", tuple(alternatives)),
        _rated(human, "location", tuple(alternatives)),
        str(entry.get("group", "")),
    )


def _letters(human: Mapping[str, Any], kind: str) -> tuple[str, ...]:
    """Return names of goals in a key such as `desire_KLM_mean_1to7`."""
    for key in human:
        if found := re.match(rf"{kind}_([A-Z]+)_mean", key):
            return tuple(found[1])
    return ()


def _rated(human: Mapping[str, Any], kind: str, names: Sequence[str]) -> dict[str, float]:
    for key, values in human.items():
        if key.startswith(f"{kind}_") and "_mean" in key:
            return dict(zip(names, map(float, values), strict=True))
    return {}


def _parameters(given: Mapping[str, Any]) -> FilmParameters:
    usual = FilmParameters()
    return FilmParameters(
        rewards=tuple(float(value) for value in given.get("reward_levels", usual.rewards)),
        discount=float(given.get("discount", usual.discount)),
        step_cost=float(given.get("move_or_eat_cost", usual.step_cost)),
        stay_cost=float(given.get("stay_cost", usual.stay_cost)),
        rationality=float(given.get("beta", usual.rationality)),
    )


def staged(film: Film) -> Nest:
    """Act a film out in a nest: walls hide, goals are blocks to stand on.

    Where the observer does not know what is the case, the places in doubt are empty.
    """
    width, depth = film.size
    blocks: dict[Position, str] = {(x, 0, z): _FLOOR for x in range(width) for z in range(depth)}
    for cell in film.walls:
        x, _, z = _floor(cell)
        blocks[x, 1, z] = blocks[x, 2, z] = _WALL
    held = dict(film.known)
    held |= dict.fromkeys(next(iter(film.alternatives.values()), {}), None)
    if film.actual is not None:
        held |= film.alternatives[film.actual]
    for place, goal in held.items():
        blocks[_floor(film.places[place])] = _block(film, goal)
    feet = [(x - 0.5, 1.0, z - 0.5) for x, z in film.path]
    world = ScriptedWorld(((0, 0, 0), (width - 1, 2, depth - 1)), blocks, agents={AGENT: feet[0]})
    # The floor is as large as it is: what is not hidden is seen.
    nest = Nest(world, perception=Perception(max_visible_distance=None))
    for place_feet in feet[1:]:
        world.place_agent(AGENT, place_feet)
    return nest


def model_of(film: Film, parameters: FilmParameters, lesion: Lesion | None = None) -> MindModel:
    """Return the model of a film's agent, whole or with a lesion."""
    rewards = list(parameters.rewards)
    names = list(film.alternatives)
    credences = simplex_grid(len(names), parameters.grid, parameters.smoothing)
    if lesion == "true_belief" and film.actual is not None:
        # The corner of the grid at which the agent is surest of what is the case.
        credences = credences[[int(credences[:, names.index(film.actual)].argmax())]]
    costs = lesion != "no_cost"
    return MindModel(
        agent=AGENT,
        goals={goal: {"block": _block(film, goal)} for goal in film.goals},
        utilities=dict.fromkeys(film.goals, rewards),
        doubt={
            name: {
                "blocks": {
                    _floor(film.places[place]): _block(film, goal) for place, goal in held.items()
                }
            }
            for name, held in film.alternatives.items()
        },
        credences=credences,
        actual=None if film.actual is not None else "unknown",
        rationality=parameters.rationality,
        # To wait for a reward costs as well.
        discount=parameters.discount if costs else 1.0,
        step_cost=parameters.step_cost if costs else 0.0,
        stay_cost=parameters.stay_cost if costs else 0.0,
        act_cost=parameters.step_cost if costs else 0.0,
    )


def judge(film: Film, parameters: FilmParameters, lesion: Lesion | None = None) -> Judgment:
    """Act a film out and infer what its agent wants and believed."""
    with staged(film) as nest:
        inference = nest["/"].infer(model_of(film, parameters, lesion), ended=film.ended)
    return Judgment(
        film,
        {goal: inference.mean(f"utility.{goal}") for goal in film.goals},
        {name: inference.mean(f"credence.{name}") for name in film.alternatives},
        {name: inference.mean(f"actual.{name}") for name in film.alternatives},
        inference,
    )


def correlation(
    judgments: Sequence[Judgment], what: Literal["desires", "beliefs", "locations"]
) -> Correlation:
    """Put the model's judgments of scored films beside people's."""
    pairs = [
        (getattr(judgment, what)[name], value, number)
        for number, judgment in enumerate(judgments)
        if judgment.film.scored
        for name, value in getattr(judgment.film, what).items()
    ]
    columns = np.array(pairs, dtype=np.float64).reshape(-1, 3).T
    return Correlation(columns[0], columns[1], columns[2].astype(np.int64))


def _block(film: Film, goal: str | None) -> str:
    if goal is None:
        return _EMPTY
    number = film.goals.index(goal)
    if number >= len(_GOAL_BLOCKS):
        raise InputError(f"film {film.name} has more than {len(_GOAL_BLOCKS)} goals; use fewer")
    return _GOAL_BLOCKS[number]


def _floor(cell: tuple[int, int]) -> Position:
    return (cell[0] - 1, 0, cell[1] - 1)
