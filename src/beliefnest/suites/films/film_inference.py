"""Films acted out in nests, and what exact inference says of their agents."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import fsum
from typing import Literal

import numpy as np

from beliefnest.errors import InputError
from beliefnest.minds.mind_model import MindModel, simplex_grid
from beliefnest.nest.face.nest import Nest
from beliefnest.perception.options import Perception
from beliefnest.suites.films.film import About, Cell, Film, FilmParameters, grid_for
from beliefnest.world.values import Position
from beliefnest.worlds.scripted.world import ScriptedWorld

__all__ = ["AGENT", "LESIONS", "Judgment", "Lesion", "judge", "model_of", "staged"]

AGENT = "student"

Lesion = Literal["true_belief", "no_cost"]
LESIONS: tuple[Lesion, ...] = ("true_belief", "no_cost")
"""Models without a part: an agent who knows the world, and one to whom acts cost nothing."""

_COLOURS = (
    *("yellow", "lime", "light_blue", "red", "blue", "orange", "purple", "white"),
    *("brown", "pink", "cyan", "magenta", "green", "black", "light_gray", "gray"),
)
_GOAL_BLOCKS = (
    *("gold_block", "emerald_block", "diamond_block", "redstone_block", "lapis_block"),
    *("copper_block", "iron_block", "coal_block", "netherite_block", "quartz_block"),
    *(f"{colour}_wool" for colour in _COLOURS),
)
_FLOOR, _WALL, _EMPTY = "stone", "stone", "gravel"


@dataclass(frozen=True)
class Judgment:
    """Judgments of the model about a film.

    Attributes:
        film: The film.
        model: By what it is about, then by name: the posterior mean of each goal's utility, that
            of the initial credence in each event, and the probability of each event where the
            observer does not know what is the case.
        impossible: The first step that no hypothesis explains; what the model says is then the
            posterior before it. None: every step is explained.
    """

    film: Film
    model: Mapping[About, Mapping[str, float]]
    impossible: str | None = None


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
    held |= dict.fromkeys(next(iter(film.alternatives.values())), None)
    if not film.observer_doubts:
        held |= film.alternatives[film.actual[0]]
    for place, goal in held.items():
        blocks[_floor(film.places[place])] = _block(film, goal)
    feet = [(x - 0.5, 1.0, z - 0.5) for x, z in film.path]
    world = ScriptedWorld(((0, 0, 0), (width - 1, 2, depth - 1)), blocks, agents={AGENT: feet[0]})
    # The floor is as large as it is: what is not hidden is seen.
    nest = Nest(world, perception=Perception(max_visible_distance=None))
    for place_feet in feet[1:]:
        world.place_agent(AGENT, place_feet)
    return nest


def model_of(
    film: Film,
    parameters: FilmParameters,
    lesion: Lesion | None = None,
    known: str | None = None,
) -> MindModel:
    """Return the model of a film's agent.

    Args:
        film: The film.
        parameters: Of the model.
        lesion: The part that the model lacks; None: it is whole.
        known: The alternative that is the case, which an agent without false beliefs knows;
            needed for that lesion alone.
    """
    names = list(film.alternatives)
    grid = grid_for(film, parameters) or 1
    credences = simplex_grid(len(names), grid, parameters.smoothing)
    actual: str | Mapping[str, float] | None = None
    if film.observer_doubts:
        actual = dict.fromkeys(film.actual, 1 / len(film.actual))
    if lesion == "true_belief" and known is not None:
        # The corner of the grid at which the agent is surest of what is the case.
        credences = credences[[int(credences[:, names.index(known)].argmax())]]
        actual = known if film.observer_doubts else None
    costs = lesion != "no_cost"
    return MindModel(
        agent=AGENT,
        goals={goal: {"block": _block(film, goal)} for goal in film.goals},
        utilities={goal: list(parameters.rewards_of(goal)) for goal in film.goals},
        doubt={
            name: {
                "blocks": {
                    _floor(film.places[place]): _block(film, goal) for place, goal in held.items()
                }
            }
            for name, held in film.alternatives.items()
        },
        credences=credences,
        actual=actual,
        rationality=parameters.rationality,
        # To wait for a reward costs as well.
        discount=parameters.discount if costs else 1.0,
        step_cost=parameters.step_cost if costs else 0.0,
        stay_cost=parameters.stay_cost if costs else 0.0,
        act_cost=parameters.step_cost if costs else 0.0,
    )


def judge(film: Film, parameters: FilmParameters, lesion: Lesion | None = None) -> Judgment:
    """Act a film out and infer what its agent wants and believed, and what is the case.

    Raises:
        InputError: The film does not fit the model; the message names the film.
    """
    # An agent who knows the world knows another one under each alternative.
    cases = film.actual if lesion == "true_belief" else (None,)
    try:
        with staged(film) as nest:
            models = [model_of(film, parameters, lesion, known) for known in cases]
            found = [nest["/"].infer(model, ended=film.ended) for model in models]
    except InputError as error:
        raise InputError(f"film {film.name}: {error}") from None
    evidence = np.array([inference.log_evidence for inference in found])
    possible = evidence > -np.inf
    if not possible.any():
        evidence = np.zeros(len(found))
    shares = np.exp(evidence - evidence.max())
    shares /= shares.sum()

    def mean(factor: str) -> float:
        told = zip(shares.tolist(), found, strict=True)
        return fsum(share * inference.mean(factor) for share, inference in told if share > 0)

    def means(kind: str) -> dict[str, float]:
        each = {name: mean(f"{kind}.{name}") for name in film.alternatives}
        return {
            event: fsum(each[name] for name in sorted(meant))
            for event, meant in film.events.items()
        }

    model: dict[About, Mapping[str, float]] = {
        "desires": {goal: mean(f"utility.{goal}") for goal in film.goals},
        "beliefs": means("credence"),
    }
    if film.observer_doubts:
        model["locations"] = means("actual")
    return Judgment(film, model, None if possible.any() else str(found[0].impossible))


def _block(film: Film, goal: str | None) -> str:
    if goal is None:
        return _EMPTY
    number = film.goals.index(goal)
    if number >= len(_GOAL_BLOCKS):
        raise InputError(f"it has more than {len(_GOAL_BLOCKS)} goals; use fewer")
    return _GOAL_BLOCKS[number]


def _floor(cell: Cell) -> Position:
    return (cell[0] - 1, 0, cell[1] - 1)
