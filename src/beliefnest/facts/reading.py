"""Reading of facts: their entries, checked against the world that they are about."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Any, Protocol

import msgspec

from beliefnest.errors import BeliefNestError, InputError, UnknownNameError
from beliefnest.facts.kinds import KINDS, Fact, FactEntry, StatedFact
from beliefnest.world.claims import Claim
from beliefnest.world.forms import notes, scene_kinds
from beliefnest.world.paths import BeliefPath, parse_path
from beliefnest.world.registry import Registry
from beliefnest.world.texts import quoted
from beliefnest.world.values import Box, Items, Position, block_at
from beliefnest.world.words import listed, nearest_or_all

_SCENE_KINDS, _NOTES = scene_kinds(FactEntry), notes(FactEntry)

FORMER = {"believed": "path", "position": "at", "place": "at"}
"""Names of keys in earlier versions, or elsewhere in files, and what they are in facts."""

ClaimLike = Claim | Mapping[str, Any]
"""Claim, or the fact that is claimed, as a mapping."""

Where = tuple[str | int, ...]
"""Keys and list indices from the top of a document to an entry or a value of it."""


class FactScene(Protocol):
    """Protocol of checks of names and places; each raises an error that names the key."""

    def fault(self, path: Where, message: str) -> BeliefNestError:
        """Return the error about a key."""

    def belief_path(self, path: Where, text: str) -> BeliefPath:
        """Return the agents of a belief path."""

    def agent(self, path: Where, name: str) -> None:
        """Refuse an unknown agent."""

    def inside(self, path: Where, position: Position) -> None:
        """Refuse a position outside the box."""

    def container(self, path: Where, position: Position) -> Position:
        """Return the position of the container to which a block belongs."""

    def contents(self, path: Where, place: Position, items: Items) -> None:
        """Refuse items that the container at a place could not hold."""

    def possessions(self, path: Where, items: Items) -> None:
        """Refuse items that an agent could not have."""

    def state(self, path: Where, text: str) -> object:
        """Refuse the text of an unknown block state."""


class PlainScene(msgspec.Struct, frozen=True):
    """Checks of facts that are given in code, of which only the agents and the box are known.

    Attributes:
        agents: Names of all agents.
        box: Box of the world.
    """

    agents: Collection[str]
    box: Box

    def fault(self, path: Where, message: str) -> InputError:
        """Return the error about a key."""
        return InputError(f"{'.'.join(map(str, path))}: {message}" if path else message)

    def belief_path(self, path: Where, text: str) -> BeliefPath:
        """Return the agents of a belief path."""
        return parse_path(text, self.agents)

    def agent(self, path: Where, name: str) -> None:
        """Refuse an unknown agent."""
        if name not in self.agents:
            raise InputError(f"a fact is about {name!r}, who is no agent")

    def inside(self, path: Where, position: Position) -> None:
        """Refuse a position outside the box."""
        if position not in self.box:
            raise InputError(
                f"a fact is about {position}, outside the box {self.box.low} to {self.box.high}"
            )

    def container(self, path: Where, position: Position) -> Position:
        """Return the position; which blocks are containers is not known here."""
        self.inside(path, position)
        return position

    def contents(self, path: Where, place: Position, items: Items) -> None:
        """Refuse unknown items and counts below 1."""
        self.possessions(path, items)

    def possessions(self, path: Where, items: Items) -> None:
        """Refuse unknown items and counts below 1."""
        for name, count in items.items():
            Registry.load().item_stack(name)
            if count < 1:
                raise InputError(f"a fact counts {count} {name}; the count is at least 1")

    def state(self, path: Where, text: str) -> object:
        """Refuse the text of an unknown block state."""
        return Registry.load().state_id(text)


def edits_of(entries: Iterable[FactEntry]) -> dict[str, dict[Any, Any]]:
    """Return facts as the arguments of `Simulator.edit` that make them so.

    Raises:
        InputError: An entry is no fact, or there is no such edit.
    """
    edits: dict[str, dict[Any, Any]] = {}
    for entry in entries:
        fact = fact_in(entry)
        if fact.edit is None or entry.path != "/":
            raise InputError(
                f"'{fact}' cannot be set; give the items of a container, where an "
                "agent is, or the state of a block, and no path"
            )
        argument, key, value = fact.edit
        edits.setdefault(argument, {})[key] = value
    return edits


def claimed(entry: FactEntry) -> Sequence[Claim]:
    """Return the claims that state a fact.

    Raises:
        InputError: The entry is no fact, or it cannot be claimed.
    """
    fact = fact_in(entry)
    if not fact.claims or entry.path != "/":
        raise InputError(
            f"'{fact}' cannot be claimed; claim items or `lacks` of a container, or where an "
            "agent is, or the state of a block, and no belief"
        )
    return fact.claims


def as_claims(claims: object) -> Any:
    """Return a list with claims in place of facts; other values stay, for their reader to refuse.

    Raises:
        InputError: A mapping is no fact, or its fact cannot be claimed.
    """
    if not isinstance(claims, list | tuple):
        return claims
    stated = (claimed(plain_entry(e)) if isinstance(e, Mapping) else (e,) for e in claims)
    return [claim for each in stated for claim in each]


def plain_entry(entry: object) -> FactEntry:
    """Return a fact that was given as a mapping; what it names is not checked.

    Raises:
        InputError: The fact is malformed.
    """
    if not isinstance(entry, Mapping):
        raise InputError(f"{entry!r} is no fact; give a mapping such as {{'heard': 'hello'}}")
    for key, value in entry.items():
        if key not in _NOTES:
            former = f"; write {quoted(FORMER[key])}" if key in FORMER else ""
            hint = former or nearest_or_all(str(key), [*_NOTES], "its keys are")
            raise InputError(f"the fact {entry!r} has the key {key!r}{hint}")
        try:
            msgspec.convert({key: value}, FactEntry)
        except msgspec.ValidationError:
            says = _NOTES[key][:1].lower() + _NOTES[key][1:].removesuffix(".")
            raise InputError(
                f"the fact {entry!r}: {quoted(key)} cannot be {value!r}; it says: {says}"
            ) from None
    return msgspec.convert(entry, FactEntry)


def fact_entry(entry: object, scene: PlainScene) -> FactEntry:
    """Return a fact that was given as a mapping, checked.

    Raises:
        InputError: The fact is malformed, or is about a place outside the box.
        PathError: The belief does not exist.
        UnknownNameError: The item or block does not exist.
    """
    return check_entry(plain_entry(entry), (), scene)


def check_entry(entry: FactEntry, path: Where, scene: FactScene) -> FactEntry:
    """Return an entry with the whole container if it names half of one; check all that it names.

    Args:
        entry: The entry.
        path: Its place in a document.
        scene: Checks of names and places.

    Raises:
        BeliefNestError: The entry is no fact, or names something that does not exist.
    """
    try:
        fact_in(entry)
    except (InputError, UnknownNameError) as error:
        raise scene.fault(path, str(error)) from None
    scene.belief_path((*path, "path"), entry.path)
    for key, kind in _SCENE_KINDS.items():
        value, where = getattr(entry, key), (*path, key)
        match kind, value:
            case _, None | () | msgspec.UNSET:
                pass
            case "agent" | "[agent]", str() | tuple():
                for name in [value] if isinstance(value, str) else value:
                    scene.agent(where, name)
            case "block", _ if key == "container":
                whole = scene.container(where, value)
                scene.contents((*path, "items"), whole, entry.items or {})
                entry = msgspec.structs.replace(entry, container=whole)
            case "block" | "place", _:
                scene.inside(where, block_at(value))
            case "[[block]]", _:
                for place in (place for site in value for place in site):
                    scene.inside(where, place)
            case "items", _ if entry.container is None:
                scene.possessions(where, value)
            case "item", _:
                scene.possessions(where, {value: 1})
            case "wanted", _:
                scene.state(where, value)
    return entry


def fact_in(entry: FactEntry) -> Fact:
    """Return the fact of an entry.

    Raises:
        InputError: The entry names no fact, or several.
    """
    if any(len(site) != len(entry.agents) for site in entry.sites):
        raise InputError("each site of a fact must have as many levers as there are `agents`")
    # msgspec omits a default by its identity, which a number loses on its way to another process.
    usual = msgspec.structs.asdict(FactEntry())
    values: dict[str, Any] = {
        key: value
        for key in FactEntry.__struct_fields__
        if key != "path" and (value := getattr(entry, key)) != usual[key]
    }
    kinds = [kind for kind in KINDS if {*kind.keys} <= values.keys() <= {*kind.keys, *kind.more}]
    facts = [fact for kind in kinds if (fact := kind.read(entry)) is not None]
    if len(facts) != 1:
        whole = [kind for kind in KINDS if {*kind.keys} <= values.keys()]
        near = whole or [kind for kind in KINDS if {*kind.keys} & values.keys()] or KINDS
        forms = listed(list(dict.fromkeys(" and ".join(kind.keys) for kind in near)), "or")
        extras = [values.keys() - {*kind.keys, *kind.more} for kind in whole]
        strange = sorted(set.intersection(*extras)) if extras else []
        extra = sorted(set().union(*extras))
        nulls = listed([f"`{key}: null`" for key in extra if usual[key] is None], "or")
        hint = f", without {listed(strange)}" if strange else ""
        hint += nulls and f"; a condition leaves out what the file gives by {nulls}"
        raise InputError(f"the fact {values} makes no sense; give {forms}{hint}")
    return facts[0]


def conditions_of(entry: FactEntry, agents: Collection[str]) -> list[StatedFact]:
    """Return the conditions of an entry, one for each smallest part of its fact.

    Raises:
        InputError: The entry is not valid.
        PathError: The belief does not exist.
    """
    path = parse_path(entry.path, agents)
    return [StatedFact(fact, path) for fact in fact_in(entry).parts]
