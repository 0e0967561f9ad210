"""Variation of a scenario: values of its parameters, a symmetry, and new names.

A scene is mirrored or turned, and its agents and items are renamed, as a whole document.
"""

import itertools
import json
import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import msgspec
from jinja2 import Environment, TemplateSyntaxError

from beliefnest.errors import InputError
from beliefnest.scenarios.document import Document, plain
from beliefnest.scenarios.drawn_map import with_map
from beliefnest.scenarios.format import TerrainEntry
from beliefnest.scenarios.loading import DocumentChange
from beliefnest.scenarios.parameters import with_parameters
from beliefnest.scenarios.scenario import Scenario
from beliefnest.scenarios.terrain_entry import numbers_in, packed_entry
from beliefnest.studies.program_rewriting import Rewriting, rewritten
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
        changes: list[SceneChange] = [_Renamed(agents, items)] if agents or items else []
        if symmetry != SYMMETRIES[0]:
            changes.append(_MovedBySymmetry(Placing(symmetry, _box(document)), Registry.load()))
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


_NUMBER = r"-?\d+(?:\.\d+)?"
_TRIPLE = re.compile(rf"\(\s*({_NUMBER}),\s*({_NUMBER}),\s*({_NUMBER})\s*\)")
_DIRECTIONAL = re.compile(r"\b(north|south|east|west|left|right)\b", re.IGNORECASE)


class _MovedBySymmetry(msgspec.Struct, frozen=True):
    """Change that moves and turns everything by a symmetry.

    Attributes:
        placing: The symmetry and the box.
        registry: Registry of block states.
    """

    placing: Placing
    registry: Registry

    def value(self, kind: SceneKind, value: Any) -> Any:
        """Return the moved value.

        Raises:
            InputError: A text names a direction, or a program computes with one.
        """
        change = self._changes().get(kind)
        return value if change is None else change(value)

    def _changes(self) -> Mapping[SceneKind, Callable[[Any], Any]]:
        placing, symmetry = self.placing, self.placing.symmetry
        return {
            "block": lambda value: placing.block(_triple(value)),
            "point": lambda value: placing.point(_triple(value)),
            "place": lambda value: self._place(_triple(value)),
            "static": lambda value: value if isinstance(value, str) else placing.block(value),
            "yaw": symmetry.yaw,
            "facing": self._facing,
            "state": lambda value: symmetry.block_state(value, self.registry),
            "wanted": lambda value: symmetry.wanted_state(value, self.registry),
            "program": lambda value: rewritten(
                value, Rewriting(self._vector, self._text, lambda key: key)
            ),
            "text": self._told,
            "template": lambda value: _in_template(value, self._told),
            "terrain": self._terrain,
        }

    def _terrain(self, value: Any) -> Any:
        entry = msgspec.convert(value, TerrainEntry)
        numbers = numbers_in(entry, self.placing.box.shape)
        symmetry = self.placing.symmetry
        states = [symmetry.block_state(text, self.registry) for text in entry.states]
        return packed_entry(self.placing.terrain(numbers), states)

    def _facing(self, value: Any) -> Any:
        if isinstance(value, str):
            return self.placing.symmetry.direction(value)
        return self.placing.point(_triple(value))

    def _vector(
        self, vector: tuple[float, float, float], is_direction: bool
    ) -> tuple[float, float, float]:
        if is_direction:
            x, z = self.placing.symmetry.vector(vector[0], vector[2])
            return x, vector[1], z
        return self._place(vector)

    def _place(self, place: tuple[Any, Any, Any]) -> tuple[float, float, float]:
        """Move a place: a block if all coordinates are whole, else a point, as in files."""
        if all(float(part).is_integer() for part in place):
            x, y, z = map(int, place)
            return self.placing.block((x, y, z))
        return self.placing.point(place)

    def _told(self, text: str) -> str:
        if match := _DIRECTIONAL.search(text):
            raise InputError(
                f"says {quoted(match[0])}, which is another direction in a scene that is "
                f"{self._name}; name places by parameters"
            )
        return self._text(text)

    def _text(self, text: str) -> str:
        def moved(match: re.Match[str]) -> str:
            x, y, z = (float(part) if "." in part else int(part) for part in match.groups())
            return f"({', '.join(f'{part:g}' for part in self._place((x, y, z)))})"

        return _TRIPLE.sub(moved, text)

    @property
    def _name(self) -> str:
        return self.placing.symmetry.name


def _in_template(source: str, change: Callable[[str], str]) -> str:
    """Return a template with its literal text and all texts in its expressions changed."""
    try:
        tokens = [(kind, text) for _, kind, text in Environment().lex(source)]
    except TemplateSyntaxError:
        # Leave a template with wrong syntax as it is: rendering reports the error.
        return source
    parts = []
    for kind, text in tokens:
        if kind == "string":
            parts.append(text[0] + change(text[1:-1]) + text[-1])
        else:
            parts.append(change(text) if kind == "data" else text)
    return "".join(parts)


def _triple(value: Any) -> tuple[Any, Any, Any]:
    x, y, z = value
    return x, y, z


class _Renamed(msgspec.Struct, frozen=True):
    """Change that renames agents and items everywhere, including the texts of tasks.

    Attributes:
        agents: New names of agents, by old name.
        items: New names of items, by old name.
    """

    agents: Mapping[str, str]
    items: Mapping[str, str]

    def value(self, kind: SceneKind, value: Any) -> Any:
        """Return the renamed value; raise InputError if a program cannot be parsed."""
        change = self._changes().get(kind)
        return value if change is None else change(value)

    def _changes(self) -> Mapping[SceneKind, Callable[[Any], Any]]:
        return {
            "agent": lambda value: self.agents.get(value, value),
            "item": lambda value: self.items.get(value, value),
            "path": lambda value: "/".join(self.agents.get(n, n) for n in value.split("/")),
            "text": self._told,
            "label": self._told,
            "program": lambda value: rewritten(value, Rewriting(None, self._written, self._key)),
            "template": lambda value: _in_template(value, self._written),
        }

    def _key(self, key: str) -> str:
        return self.agents.get(key, self.items.get(key, key))

    def _written(self, text: str) -> str:
        """Return a renamed text of a program: a name alone, or an utterance."""
        return self._key(text) if text in {*self.agents, *self.items} else self._told(text)

    def _told(self, text: str) -> str:
        words = {**_spellings(self.items, " "), **_spellings(self.agents, "_")}
        if not words:
            return text
        longest_first = sorted(words, key=len, reverse=True)
        pattern = re.compile(rf"(\b[Aa]n? )?\b({'|'.join(map(re.escape, longest_first))})\b")

        def new(match: re.Match[str]) -> str:
            return _with_article(match[1] or "", words[match[2]])

        return pattern.sub(new, text)


def _spellings(names: Mapping[str, str], space: str) -> dict[str, str]:
    """Return new spellings by old ones: as written, capitalized, and items with spaces."""
    spellings: dict[str, str] = {}
    for old, new in names.items():
        spelling = new.replace("_", space)
        spellings[old] = new if "_" in old else spelling
        for spelt in {old.replace("_", space), old}:
            spellings.setdefault(spelt, spelling)
            spellings[spelt[:1].upper() + spelt[1:]] = spelling[:1].upper() + spelling[1:]
    return spellings


def _with_article(article: str, word: str) -> str:
    """Return a word with the article that fits it: `a diamond`, `an apple`."""
    if not article:
        return word
    right = "an " if word[:1].lower() in "aeiou" else "a "
    return (right.capitalize() if article[0] == "A" else right) + word
