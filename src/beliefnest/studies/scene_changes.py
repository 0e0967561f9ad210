"""Changes of a whole scenario document, such as symmetries and renaming.

This module knows the kind of value at each place of the form. A change knows the new value for each
kind. A key that this module does not list is refused, so that no position is left unchanged.
"""

from collections.abc import Iterator, Mapping
from typing import Any, Protocol

import msgspec
from msgspec.structs import replace

from beliefnest.errors import BeliefNestError, InputError
from beliefnest.facts.kinds import FactEntry
from beliefnest.prompts.templates import BUILT_IN_TEMPLATES
from beliefnest.scenarios.believed import BelievedEntry
from beliefnest.scenarios.document import Document, KeyPath, YamlNode, plain, wrapped
from beliefnest.scenarios.expected import AnswersEntry, ExpectationEntry, ExpectEntry
from beliefnest.scenarios.yaml_reading import template_text
from beliefnest.world.forms import scene_kinds

SceneKind = str
"""Kind of a value: `keep`, `block`, `point`, `place` (a block or a point), `yaw`, `facing`,
`state`, `program`, `text` (read by models), `label` (read only by people), `agent`, `item`, `path`,
`wanted` (a partial block state: only written properties count), `static` (a block's name, or a
position), `template` (Jinja2 text), `terrain` (the key `terrain`)."""


class SceneChange(Protocol):
    """Function from values to new values, by kind."""

    def value(self, kind: SceneKind, value: Any) -> Any:
        """Return the new value.

        Raises:
            BeliefNestError: The value cannot be changed with certainty.
        """


class _Each(msgspec.Struct, frozen=True):
    """List of values of one shape, or a single such value."""

    shape: Any


class _Map(msgspec.Struct, frozen=True):
    """Mapping with keys of one kind and values of one shape."""

    key: SceneKind
    shape: Any


class _OrMapping(msgspec.Struct, frozen=True):
    """Value of one shape, or a mapping of another shape."""

    shape: Any
    mapping: Any


_ITEMS = _Map("item", "keep")
_CORNERS = _Each("block")
_BLOCKS = _Each({"block": "state", "at": "block", "fill": _CORNERS, "walls": _CORNERS})
_EQUIPMENT = dict.fromkeys(("head", "chest", "legs", "feet", "main_hand", "off_hand"), "item")


def _shape(kind: str) -> Any:
    """Return the shape that `note` names: a kind, `items`, or a list in brackets."""
    if kind.startswith("["):
        return _Each(_shape(kind[1:-1]))
    return _ITEMS if kind == "items" else kind


def _shapes(form: type[msgspec.Struct]) -> dict[str, Any]:
    return {key: _shape(kind) for key, kind in scene_kinds(form).items()}


_FACT = _shapes(FactEntry)
_SIGNS = _Each({"at": "block", "text": "text", "block": "state", "claims": _Each(_FACT)})
_EXPECTATION = _shapes(ExpectationEntry)
_BELIEVED = _shapes(BelievedEntry)
_ASKED = _shapes(AnswersEntry)
_EXPECT = {
    **{
        key: _OrMapping(shape, _BELIEVED) if key in ("opens", "arrives", "intends") else shape
        for key, shape in _shapes(ExpectEntry).items()
    },
    "answers": _Each({**_ASKED, "right": _OrMapping(_ASKED["right"], _BELIEVED)}),
    "believes": _Each(_EXPECTATION),
}
_INFER = {
    "agent": "agent",
    "goals": _Map("keep", {"at": "block", "block": "keep", "item": "item"}),
    "doubt": _Map("keep", _Each(_FACT)),
    **dict.fromkeys(
        (
            *("utilities", "credences", "actual", "prior", "rationality", "discount"),
            *("step_cost", "stay_cost", "act_cost", "diagonal", "step_ticks", "stays", "lapse"),
            *("since", "until", "ended", "smooth"),
        ),
        "keep",
    ),
}
_GOAL = {
    "reach": _Each(_FACT),
    "never": _Each(_FACT),
    "messages": "keep",
    "ticks": "keep",
    "helps": "agent",
}
_EPISODE = {
    "goal": _GOAL,
    "goals": _Map("agent", _GOAL),
    "goals_known": "keep",
    "possible_goals": _Map("agent", _Map("keep", _GOAL)),
    "rewards": "keep",
    "order": "keep",
    "players": _Each("agent"),
    "policies": _Map("agent", "keep"),
    "talk": _Each("agent"),
    "play": "keep",
    "rounds": "keep",
    "round_ticks": "keep",
}
_SHAPE: Mapping[str, Any] = {
    "name": "keep",
    "description": "label",
    "reported_by": "keep",
    "box": _CORNERS,
    "terrain": "terrain",
    "blocks": _BLOCKS,
    "containers": _Each(
        {"at": "block", "block": "state", "items": _ITEMS, "label": "label", "looks": "text"}
    ),
    "signs": _SIGNS,
    "places": _Map("keep", "block"),
    "agents": _Map(
        "agent",
        {
            "position": "point",
            "facing": "facing",
            "yaw": "yaw",
            "pitch": "keep",
            "inventory": _ITEMS,
            "equipment": _EQUIPMENT,
            "health": "keep",
            "food": "keep",
            "type": "keep",
            "senses": "keep",
        },
    ),
    "perception": "keep",
    "senses": "keep",
    "static_blocks": _Each("static"),
    "unique": _Each("item"),
    "labels": "keep",
    "initial_beliefs": _Each(
        {
            "path": "path",
            "containers": _Each({"at": "block", "items": _ITEMS, "complete": "keep"}),
            "blocks": _BLOCKS,
            "signs": _SIGNS,
            "agents": _OrMapping(_Each("agent"), _Map("agent", "point")),
            "inventories": _Map("agent", _ITEMS),
        }
    ),
    "script": _Each(
        {
            "label": "label",
            "agent": "agent",
            "program": "program",
            "programs": _Map("agent", "program"),
            "timeout_ticks": "keep",
            "senses": "keep",
        }
    ),
    "probes": _Each(
        {
            "label": "keep",
            "path": "path",
            "acts_in": "path",
            "agent": "agent",
            "task": "text",
            "template": "keep",
            "expect": _EXPECT,
            "infer": _INFER,
            "timeout_ticks": "keep",
            "senses": "keep",
            "intended": "text",
        }
    ),
    "expectations": _Each(_EXPECTATION),
    "episode": _EPISODE,
}


def changed_scene(document: Document, change: SceneChange) -> Document:
    """Return a document with all its values changed.

    Args:
        document: Document with its condition merged in and its parameters filled in.
        change: Change of the values.

    Raises:
        ScenarioError: A value cannot be changed with certainty; the message names file, line, key.
    """
    shape = _SHAPE
    labels = document.root.value.get("labels")
    if labels is not None and labels.value is True:
        # Models read the labels of containers in prompts.
        containers = {**_SHAPE["containers"].shape, "label": "text"}
        shape = {**_SHAPE, "containers": _Each(containers)}
    root = _changed(document, document.root, shape, (), change)
    templates = dict(_templates(document, change))
    return replace(document, root=root, templates={**document.templates, **templates})


def _templates(document: Document, change: SceneChange) -> Iterator[tuple[str, str]]:
    """Yield the names and changed texts of the template files that probes name."""
    probes = document.root.value.get("probes")
    for number, probe in enumerate(probes.value if probes is not None else ()):
        named = probe.value.get("template")
        if named is None or not isinstance(named.value, str) or named.value in BUILT_IN_TEMPLATES:
            continue
        path = ("probes", number, "template")
        text = template_text(document, path, named.value)
        yield named.value, str(_leaf(document, YamlNode(text), "template", path, change).value)


def _changed(
    document: Document, node: YamlNode, shape: Any, path: KeyPath, change: SceneChange
) -> YamlNode:
    if isinstance(shape, _OrMapping):
        shape = shape.mapping if isinstance(node.value, dict) else shape.shape
    if node.value is None or shape == "keep" or (path == ("conditions",)):
        return node
    if isinstance(shape, str):
        return YamlNode(_leaf(document, node, shape, path, change).value, node.line)
    if isinstance(shape, _Each) and isinstance(node.value, list):
        parts = [
            _changed(document, child, shape.shape, (*path, number), change)
            for number, child in enumerate(node.value)
        ]
        return YamlNode(parts, node.line)
    if isinstance(shape, _Each):
        return _changed(document, node, shape.shape, path, change)
    if not isinstance(node.value, dict):
        # A value of the wrong form: the later check of the form reports it.
        return node
    inner = {}
    for key, child in node.value.items():
        if key == "conditions" and not path:
            continue
        if isinstance(shape, _Map):
            name, part = _key(document, str(key), shape.key, (*path, key), change), shape.shape
        elif key in shape:
            name, part = key, shape[key]
        else:
            raise document.fault(
                (*path, key), "is not supported in mirrored, turned or renamed scenes"
            )
        inner[name] = _changed(document, child, part, (*path, key), change)
    return YamlNode(inner, node.line)


def _key(document: Document, key: str, kind: SceneKind, path: KeyPath, change: SceneChange) -> str:
    return str(_leaf(document, YamlNode(key), kind, path, change).value)


def _leaf(
    document: Document, node: YamlNode, kind: SceneKind, path: KeyPath, change: SceneChange
) -> YamlNode:
    try:
        return wrapped(change.value(kind, plain(node)))
    except InputError as error:
        raise document.fault(path, str(error)) from error
    except (TypeError, ValueError):
        # A value of the wrong form, as above.
        return node
    except BeliefNestError as error:
        raise document.fault(path, str(error)) from error
