"""Outlines of the built-in scenarios, read in half the time of whole documents."""

from collections.abc import Mapping

import msgspec
from ruamel.yaml import YAML
from ruamel.yaml.nodes import MappingNode, Node

from beliefnest.scenarios.sources import builtin_file


class Outline(msgspec.Struct, frozen=True):
    """Description of a scenario, read without building its scene.

    Attributes:
        name: Its name.
        description: Its description.
        conditions: Descriptions of its conditions, by number.
    """

    name: str
    description: str
    conditions: Mapping[int, str]


def builtin_outline(name: str) -> Outline:
    """Return the outline of a built-in scenario."""
    # Only the nodes of the document are composed. Values with line numbers would take as long
    # again, and the files of the package need no messages.
    text = builtin_file(name).read_text(encoding="utf-8")
    head = _children(YAML(typ="safe", pure=True).compose(text))
    conditions = _children(head.get("conditions"))
    return Outline(
        head["name"].value,
        _described(head),
        {int(number): _described(_children(node)) for number, node in conditions.items()},
    )


def _children(node: Node | None) -> Mapping[str, Node]:
    """Return the values of a mapping by key; none if there is no mapping."""
    if not isinstance(node, MappingNode):
        return {}
    return {key.value: value for key, value in node.value}


def _described(children: Mapping[str, Node]) -> str:
    return children["description"].value if "description" in children else ""
