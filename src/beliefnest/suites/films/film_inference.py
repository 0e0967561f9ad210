"""Exact inference about the agents of films, which are acted out in nests."""

from collections.abc import Mapping
from math import fsum
from typing import Literal

import msgspec
import numpy as np

from beliefnest.errors import InputError
from beliefnest.minds.mind_model import MindModel, simplex_grid
from beliefnest.nest.face.nest import Nest
from beliefnest.perception.options import Perception
from beliefnest.suites.films.film import Film, FilmCell, FilmParameters, JudgedPart, grid_for
from beliefnest.world.values import Position
from beliefnest.worlds.scripted.world import ScriptedWorld

AGENT = "student"

Lesion = Literal["true_belief", "no_cost"]
LESIONS: tuple[Lesion, ...] = ("true_belief", "no_cost")
"""Models that lack a part: the agent has no false beliefs, or its actions cost nothing."""

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


class Judgment(msgspec.Struct, frozen=True):
    """Judgments of the model about a film.

    Attributes:
        film: The film.
        model: Judgments by kind and name: posterior means of the goals' utilities, posterior means
            of the initial credences in the events, and, if the observer is in doubt, probabilities
            of the events.
        impossible: The first step that no hypothesis explains; the judgments are then those before
            this step. None: every step is explained.
    """

    film: Film
    model: Mapping[JudgedPart, Mapping[str, float]]
    impossible: str | None = None


def staged(film: Film) -> Nest:
    """Act a film out in a nest. Walls block sight; goals are blocks of the floor.

    If the observer is in doubt, the places in doubt are empty.
    """
    width, depth = film.size
    blocks: dict[Position, str] = {(x, 0, z): _FLOOR for x in range(width) for z in range(depth)}
    for cell in film.walls:
        x, _, z = _floor(cell)
        blocks[x, 1, z] = blocks[x, 2, z] = _WALL
    contents = dict(film.known)
    contents |= dict.fromkeys(next(iter(film.alternatives.values())), None)
    if not film.observer_doubts:
        contents |= film.alternatives[film.actual[0]]
    for place, goal in contents.items():
        blocks[_floor(film.places[place])] = _block(film, goal)
    feet = [(x - 0.5, 1.0, z - 0.5) for x, z in film.path]
    world = ScriptedWorld(((0, 0, 0), (width - 1, 2, depth - 1)), blocks, agents={AGENT: feet[0]})
    # No limit of distance: the agent sees everything that no wall hides.
    nest = Nest(world, perception=Perception(max_visible_distance=None))
    for place_feet in feet[1:]:
        world.place_agent(AGENT, place_feet)
    return nest


def model_of(
    film: Film, parameters: FilmParameters, lesion: Lesion | None = None, truth: str | None = None
) -> MindModel:
    """Return the model of a film's agent.

    Args:
        film: The film.
        parameters: Parameters of the model.
        lesion: The part that the model lacks; None: none.
        truth: For the lesion `true_belief`, the true alternative, which the agent knows.
    """
    names = list(film.alternatives)
    grid = grid_for(film, parameters) or 1
    credences = simplex_grid(len(names), grid, parameters.smoothing)
    actual: str | Mapping[str, float] | None = None
    if film.observer_doubts:
        actual = dict.fromkeys(film.actual, 1 / len(film.actual))
    if lesion == "true_belief" and truth is not None:
        # Keep only the corner of the grid with the most credence in the true alternative.
        credences = credences[[int(credences[:, names.index(truth)].argmax())]]
        actual = truth if film.observer_doubts else None
    costs = lesion != "no_cost"
    return MindModel(
        agent=AGENT,
        goals={goal: {"block": _block(film, goal)} for goal in film.goals},
        utilities={goal: list(parameters.rewards_of(goal)) for goal in film.goals},
        doubt={
            name: {
                "blocks": {
                    _floor(film.places[place]): _block(film, goal) for place, goal in case.items()
                }
            }
            for name, case in film.alternatives.items()
        },
        credences=credences,
        actual=actual,
        rationality=parameters.rationality,
        # Discounting is a cost of waiting.
        discount=parameters.discount if costs else 1.0,
        step_cost=parameters.step_cost if costs else 0.0,
        stay_cost=parameters.stay_cost if costs else 0.0,
        act_cost=parameters.step_cost if costs else 0.0,
    )


def judge(film: Film, parameters: FilmParameters, lesion: Lesion | None = None) -> Judgment:
    """Act a film out; infer its agent's desires and beliefs, and the true alternative.

    Raises:
        InputError: The film does not fit the model; the message names the film.
    """
    # An agent without false beliefs knows a different world under each alternative.
    cases = film.actual if lesion == "true_belief" else (None,)
    try:
        with staged(film) as nest:
            models = [model_of(film, parameters, lesion, case) for case in cases]
            inferences = [nest["/"].infer(model, ended=film.ended) for model in models]
    except InputError as error:
        raise InputError(f"film {film.name}: {error}") from None
    evidence = np.array([inference.log_evidence for inference in inferences])
    possible = evidence > -np.inf
    if not possible.any():
        evidence = np.zeros(len(inferences))
    shares = np.exp(evidence - evidence.max())
    shares /= shares.sum()

    def mean(factor: str) -> float:
        weighted = zip(shares.tolist(), inferences, strict=True)
        return fsum(share * inference.mean(factor) for share, inference in weighted if share > 0)

    def means(kind: str) -> dict[str, float]:
        each = {name: mean(f"{kind}.{name}") for name in film.alternatives}
        return {
            event: fsum(each[name] for name in sorted(meant))
            for event, meant in film.events.items()
        }

    model: dict[JudgedPart, Mapping[str, float]] = {
        "desires": {goal: mean(f"utility.{goal}") for goal in film.goals},
        "beliefs": means("credence"),
    }
    if film.observer_doubts:
        model["locations"] = means("actual")
    return Judgment(film, model, None if possible.any() else str(inferences[0].impossible))


def _block(film: Film, goal: str | None) -> str:
    if goal is None:
        return _EMPTY
    number = film.goals.index(goal)
    if number >= len(_GOAL_BLOCKS):
        raise InputError(f"it has more than {len(_GOAL_BLOCKS)} goals; use fewer")
    return _GOAL_BLOCKS[number]


def _floor(cell: FilmCell) -> Position:
    return (cell[0] - 1, 0, cell[1] - 1)
