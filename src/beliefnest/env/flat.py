"""Actions by number: calls of skills and utterances about the things that an agent numbers.

A number always stands for the same skill with the same numbers of things. Which of them can begin
is computed from the belief of their agent alone.
"""

import math
import operator
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from itertools import islice, product
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt

from beliefnest.belief.view import State
from beliefnest.env.actions import (
    KIND_OF_PART,
    SPEECH,
    Calls,
    NotKnownError,
    index_of,
)
from beliefnest.env.order import BLOCK_CLASSES, PLACED, Things, block_classes
from beliefnest.episodes.policies.candidates import said
from beliefnest.errors import InputError
from beliefnest.skills.calls import Call
from beliefnest.world.claims import Claim
from beliefnest.world.registry import Registry, block_name
from beliefnest.world.values import Box, Items, Position, block_at

_NEAR = 2
_MOST_OFFERS = 100_000
"""Greatest number of actions by number."""
_TOO_MANY = (
    f"actions='flat' would have more than {_MOST_OFFERS:,} actions; give smaller sizes, or choose "
    "actions='skills'"
)
_GOALS = ("agent", "container", "door", "lever", "button", "sign", "place", "cell")
"""Parts that name somewhere to go."""
_WALKS = ("goToPosition", "giveItemToOther")
"""Skills that end near their goal, not where a hand reaches it."""


class Offer(msgspec.Struct, frozen=True):
    """Action with a number of its own.

    Attributes:
        skill: Name of the skill.
        parts: Numbers of the things that it is about, by part.
        goal: The part that names where its agent goes; empty: it stays where it is.
        distance: Distance from there at which it stands; None: where its hand reaches the place.
    """

    skill: str
    parts: tuple[tuple[str, int], ...]
    goal: str = ""
    distance: int | None = None


class ActorMind(msgspec.Struct, frozen=True):
    """Knowledge of an agent about what it can do.

    Attributes:
        agent: Name of the agent.
        state: Its belief.
        things: The things that it knows, in its order.
        places: Named places, which everybody knows.
        cells: Cells that the rules name to the agent: those of goals, and others of the user.
        may_speak: True if others can hear what it says.
        may_reach: Function of a place, and of a distance at which to stand or None for where a
            hand reaches the place; it returns False if the agent knows that there is no way.
    """

    agent: str
    state: State
    things: Things
    places: Sequence[Position]
    cells: Sequence[Position]
    may_speak: bool
    may_reach: Callable[[Position, float | None], bool]


class FlatActions:
    """Actions of an environment by number.

    Args:
        calls: Conversion of names to calls.
        most: Greatest numbers of things by kind, `places` and `cells` among them.
        speaks: True if any agent may speak.

    Attributes:
        offers: The actions; the first one is to do nothing.

    Raises:
        InputError: There are more than 100,000.
    """

    def __init__(self, calls: Calls, most: Mapping[str, int], *, speaks: bool) -> None:
        self._calls = calls
        offers = _offers(calls, most, speaks=speaks and most["agents"] > 1)
        self.offers = tuple(islice(offers, _MOST_OFFERS + 1))
        if len(self.offers) > _MOST_OFFERS:
            raise InputError(_TOO_MANY)
        self._parts = frozenset(part for offer in self.offers for part, _ in offer.parts)

    def call(self, number: object, mind: ActorMind) -> Call:
        """Return the call that a number stands for.

        Raises:
            InputError: There is no such number.
            NotKnownError: It stands for nothing that the agent knows.
        """
        try:
            offer = self.offers[index_of(number)]
        except (TypeError, ValueError, OverflowError, IndexError):
            raise InputError(
                f"{number!r:.100} is not in the action space; give a number from 0 to "
                f"{len(self.offers) - 1}"
            ) from None
        named = _named(offer, self._values(mind))
        match offer.skill, named:
            case "goToPosition", _:
                return Call("goToPosition", (_goal(named, mind), _distance(named)))
            case "mineBlock", {"cell": cell}:
                return Call("mineBlock", (cell, block_name(_block(cell, mind))))
            case "placeItem", {"item": item, "cell": cell}:
                return Call("placeItem", (item, cell))
            case "say" | "whisper", {"container": _} | {"cell": _}:
                arguments = said(_claim(named, mind)).args
                hearer = [named["agent"]] if "agent" in named else []
                return Call(offer.skill, (*hearer, *arguments))
        return self._calls.action(mind.things, offer.skill, named).call

    def mask(self, mind: ActorMind) -> npt.NDArray[np.int8]:
        """Return 1 for each action that can begin as far as its agent knows, and 0 for others."""
        values, state = self._values(mind), mind.state
        own = state.agents[mind.agent].inventory

        @cache  # many actions are about one place
        def leads(part: str, thing: Any, near: float | None) -> bool:
            goal = _goal({part: thing}, mind)
            return _is_there(part, thing, mind) and mind.may_reach(goal, near)

        def can_begin(offer: Offer) -> bool:
            try:
                named = _named(offer, values)
                if named.get("agent") == mind.agent or _lacks(offer.skill, named, state, own):
                    return False
                if offer.goal:
                    return leads(offer.goal, named[offer.goal], offer.distance)
                if "cell" in named:
                    _block(named["cell"], mind)
            except NotKnownError:
                return False
            return mind.may_speak or offer.skill not in SPEECH

        return np.fromiter(map(can_begin, self.offers), np.int8, len(self.offers))

    def _values(self, mind: ActorMind) -> Mapping[str, Sequence[Any]]:
        """Return the things that numbers stand for, by part."""
        own = {"place": mind.places, "cell": mind.cells}
        others = self._parts - own.keys()
        return {**own, **{part: self._calls.known(mind.things, part) for part in others}}


def _named(offer: Offer, values: Mapping[str, Sequence[Any]]) -> Mapping[str, Any]:
    """Return the things that an action is about, by part.

    Raises:
        NotKnownError: A number stands for nothing.
    """
    named = {}
    for part, number in offer.parts:
        things = values[part]
        if number >= len(things):
            raise NotKnownError(f"it knows no {part} {number} so far")
        named[part] = things[number]
    return named


def checked_cells(cells: Sequence[Any], box: Box) -> tuple[Position, ...]:
    """Return cells that a user has named; raise InputError if one is no cell of a box."""
    places = []
    for cell in cells:
        try:
            x, y, z = map(operator.index, cell)
        except (TypeError, ValueError):
            raise InputError(f"cells has {cell!r:.100}; give three whole numbers each") from None
        if (x, y, z) not in box:
            raise InputError(f"cells has {(x, y, z)}, outside the box {box.low}..{box.high}")
        places.append((x, y, z))
    return tuple(places)


def _offers(calls: Calls, most: Mapping[str, int], *, speaks: bool) -> Iterator[Offer]:
    for skill in calls.possible:
        parts = [part for part in skill.parts if part != "count"]
        if parts == ["position"]:
            for part in _GOALS:
                yield from _each(skill.name, {part: most[KIND_OF_PART.get(part, f"{part}s")]})
        elif speaks or skill.name not in SPEECH:
            yield from _each(skill.name, {part: calls.parts[part] for part in parts})
    yield from _each("mineBlock", {"cell": most["cells"]})
    yield from _each("placeItem", {"item": most["items"], "cell": most["cells"]})
    if speaks:
        contents = {"item": most["items"], "container": most["containers"]}
        for about in (contents, {"cell": most["cells"]}):
            yield from _each("say", about)
            yield from _each("whisper", {"agent": most["agents"], **about})


def _each(skill: str, sizes: Mapping[str, int]) -> Iterator[Offer]:
    if math.prod(sizes.values()) > _MOST_OFFERS:
        raise InputError(_TOO_MANY)
    goal = "" if skill in SPEECH else next((part for part in _GOALS if part in sizes), "")
    distance = _distance(sizes) if skill in _WALKS else None
    for numbers in product(*map(range, sizes.values())):
        yield Offer(skill, tuple(zip(sizes, numbers, strict=True)), goal, distance)


def _goal(named: Mapping[str, Any], mind: ActorMind) -> Position:
    """Return where an agent goes for an action.

    Raises:
        NotKnownError: It does not know where another agent is.
    """
    if "agent" not in named:
        where: Position = next(named[part] for part in _GOALS if part in named)
        return where
    position = mind.state.agents[named["agent"]].position
    if position is None:
        raise NotKnownError(f"it does not know where {named['agent']} is")
    return block_at(position)


def _distance(named: Mapping[str, Any]) -> int:
    """Return how far from its goal an agent may stand; what is there may be solid."""
    return 0 if named.keys() & {"place", "cell"} else _NEAR


def _block(cell: Position, mind: ActorMind) -> str:
    """Return what an agent believes to be in a cell.

    Raises:
        NotKnownError: It does not know.
    """
    there: str | None = mind.state.blocks[cell]
    if there is None:
        raise NotKnownError(f"it does not know what is at {cell}")
    return there


def _claim(named: Mapping[str, Any], mind: ActorMind) -> Claim:
    """Return a claim about a container, or, as its speaker believes, about a cell."""
    if "cell" in named:
        return Claim.block(named["cell"], _block(named["cell"], mind))
    return Claim.located(named["item"], named["container"])


def _lacks(skill: str, named: Mapping[str, Any], state: State, own: Items) -> bool:
    """Return True if the holder of a belief knows that what an action needs is not there."""
    item = named.get("item", "")
    match skill:
        case "getItemFromChest":
            content = state.containers.get(named["container"])
            return content is not None and content.complete and not content.items.get(item, 0)
        case "depositItemIntoChest":
            return not own.get(item, 0)
        case "mineBlock":
            there = state.blocks[named["cell"]]
            return there is None or block_name(there) == "air"
        case "placeItem":
            there = state.blocks[named["cell"]]
            is_taken = there is not None and Registry.load().is_solid(block_name(there))
            return is_taken or not own.get(item, 0) or not Registry.load().has_block(item)
        case "giveItemToOther":
            return not own.get(item, 0) or not state.agents[named["agent"]].current
    return False


def _is_there(part: str, thing: Any, mind: ActorMind) -> bool:
    """Return False if an agent knows that a thing is no longer where it was."""
    kind = KIND_OF_PART.get(part)
    if kind not in PLACED:
        return True
    state = mind.state.blocks.terrain[mind.state.box.index(thing)]
    return block_classes()[state] in (-1, BLOCK_CLASSES.index(kind))
