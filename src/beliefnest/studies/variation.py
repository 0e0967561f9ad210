"""Variation of a scenario: values of its parameters, a symmetry, and new names."""

import itertools
import json
import re
from collections.abc import Mapping, Sequence
from typing import Any

import msgspec

from beliefnest.errors import InputError
from beliefnest.scenarios.document import Document, plain
from beliefnest.scenarios.drawn_map import with_map
from beliefnest.scenarios.loading import DocumentChange
from beliefnest.scenarios.parameters import with_parameters
from beliefnest.scenarios.scenario import Scenario
from beliefnest.studies.changes import MovedBySymmetry, Renamed
from beliefnest.studies.scene_changes import SceneChange, SceneKind, changed_scene
from beliefnest.studies.symmetry import SYMMETRIES, Placing, symmetry_named
from beliefnest.world.registry import Registry
from beliefnest.world.texts import quoted
from beliefnest.world.values import Box

CHANGES = ("symmetry", "agents", "items")
"""Keys of `variations` that are not parameters: a symmetry, new names of agents and of items."""


class Variation(msgspec.Struct, frozen=True):
    """Variation of a scenario.

    Attributes:
        values: Values of parameters and of `CHANGES`, by name; all others are as written.
    """

    values: Mapping[str, Any] = msgspec.field(default_factory=dict)

    @property
    def parameters(self) -> dict[str, Any]:
        """Return the values of the scenario's parameters."""
        return {name: value for name, value in self.values.items() if name not in CHANGES}

    @property
    def change(self) -> DocumentChange | None:
        """Return the change to the variation's symmetry and names; None: it has none."""
        return self.scene if any(name in CHANGES for name in self.values) else None

    @property
    def key(self) -> str:
        """Return a text that identifies the variation."""
        return json.dumps(self.values, sort_keys=True)

    @property
    def text(self) -> str:
        """Return the variation in words, for people."""
        parts = (f"{name} {short(value)}" for name, value in self.values.items())
        return ", ".join(parts) or "as written"

    def scenario(self, document: Document, condition: int | None) -> Scenario:
        """Return the variation of a scenario.

        Raises:
            ScenarioError: The variation is not a valid scenario.
            InputError: The name of a symmetry, an agent or an item is unknown.
        """
        return Scenario.varied(document, condition, self.parameters, self.change)

    def scene(self, document: Document) -> Document:
        """Return the document with the variation's symmetry and names.

        Raises:
            ScenarioError: The document cannot be changed with certainty.
            InputError: The name of a symmetry, an agent or an item is unknown.
        """
        agents, items = self._names("agents"), self._names("items")
        if agents or items:
            _check_agents(document, agents)
            _check_items(document, items)
        for change in self._changes(document):
            document = changed_scene(document, change)
        return document

    def template(self, text: str, document: Document) -> str:
        """Return a template of the study, changed to the variation's symmetry and names.

        Raises:
            InputError: The template cannot be changed with certainty, or a name is unknown.
        """
        drawn = with_map(with_parameters(document, self.parameters))
        for change in self._changes(drawn):
            text = change.value("template", text)
        return text

    def _changes(self, document: Document) -> Sequence[SceneChange]:
        symmetry = symmetry_named(self.values.get("symmetry", "as-written"))
        agents, items = self._names("agents"), self._names("items")
        changes: list[SceneChange] = [Renamed(agents, items)] if agents or items else []
        if symmetry != SYMMETRIES[0]:
            changes.append(MovedBySymmetry(Placing(symmetry, _box(document)), Registry.load()))
        return changes

    def _names(self, kind: str) -> Mapping[str, str]:
        names = self.values.get(kind, {})
        if not isinstance(names, dict) or not all(isinstance(n, str) for n in names.values()):
            raise InputError(f"{kind} is {quoted(names)}; give a mapping from old to new names")
        return names


def short(value: object) -> str:
    """Return a value of a variation as a text for people; texts stay as they are."""
    return value if isinstance(value, str) else json.dumps(value)


def _box(document: Document) -> Box:
    corners: Any = plain(document.root.value["box"])
    return Box.between(*corners)


def _check_agents(document: Document, agents: Mapping[str, str]) -> None:
    agents_there = set(document.root.value["agents"].value)
    unknown = [name for name in agents if name not in agents_there]
    if unknown:
        there = ", ".join(sorted(agents_there))
        raise InputError(f"there is no agent {quoted(unknown[0])} to rename; agents are {there}")
    new = [agents.get(name, name) for name in agents_there]
    twice = [name for name in new if new.count(name) > 1]
    if twice:
        raise InputError(f"two agents would be called {quoted(twice[0])}")


def _check_items(document: Document, items: Mapping[str, str]) -> None:
    named = _NamedItems()
    changed_scene(document, named)
    unknown = [name for name in items if name not in named.found | named.words]
    if unknown:
        there = ", ".join(sorted(named.found)) or "none"
        raise InputError(f"there is no item {quoted(unknown[0])} to rename; items are {there}")
    new = [items.get(name, name) for name in sorted(named.found | items.keys())]
    twice = [name for name in new if new.count(name) > 1]
    if twice:
        raise InputError(f"two items would be called {quoted(twice[0])}")


class _NamedItems:
    """Change that leaves values as they are, and notes named items and all words of programs."""

    def __init__(self) -> None:
        self.found: set[str] = set()
        self.words: set[str] = set()

    def value(self, kind: SceneKind, value: Any) -> Any:
        """Return the same value."""
        if kind == "item":
            self.found.add(value)
        elif kind == "program":
            self.words.update(re.findall(r"\w+", value))
        return value


def listed_variations(lists: Mapping[str, Sequence[Any]]) -> list[Variation]:
    """Return every combination of listed values, the last list changing fastest."""
    names = list(lists)
    return [
        Variation(dict(zip(names, combination, strict=True)))
        for combination in itertools.product(*lists.values())
    ]
