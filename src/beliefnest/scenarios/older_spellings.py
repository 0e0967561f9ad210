"""Older spellings of facts in scenario files, rewritten into today's (docs/facts.md)."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from beliefnest.scenarios.document import Document, YamlNode

__all__ = ["respelled"]

_OLD_WITHIN = 2.0
"""Distance that expectations had where none was given."""

_UNKNOWN = {"agent": ("at", "items"), "block": ("state", "like"), "sign": ("text",)}
"""Keys of a fact by its subject. Without any of them, an expectation meant something unknown."""

_PLACES = {"position": "at", "block": "block"}
"""Keys of places in claims, by kind."""

_ALTERED: tuple[tuple[str, dict[str, str], dict[Any, YamlNode]], ...] = (
    ("blocks", {"at": "block", "block": "state"}, {}),
    ("containers", {"at": "container"}, {"items": YamlNode({})}),
)
"""Lists in alternatives of a doubt: their keys with those of facts, and usual values."""

_Nodes = dict[Any, YamlNode]


def respelled(document: Document) -> Document:
    """Return a document with its facts as they are written today.

    If there were older spellings, `Document.older` is a line that says what to write.
    """
    if not isinstance(document.root.value, dict):
        return document
    spelling = _Spelling()
    root = spelling.scene(document.root.value)
    if not spelling.advice:
        return document
    line = min(spelling.advice.values())
    place = f"{document.source}:{line}" if line else document.source
    told = f"{place}: has facts in an older spelling; write {', '.join(spelling.advice)}"
    return replace(document, root=replace(document.root, value=root), older=told)


@dataclass(slots=True)
class _Spelling:
    """Rewriting of one document.

    Attributes:
        advice: What to write, with the first line that it is about.
    """

    advice: dict[str, int] = field(default_factory=dict)

    def scene(self, content: _Nodes, base: _Nodes | None = None) -> _Nodes:
        """Return the content of a document, or the overrides of one of its conditions."""
        found = dict(content)
        if "signs" in content:
            found["signs"] = self._each(content["signs"], self._sign)
        for key, entry in (("expectations", self._expectation), ("probes", self._probe)):
            if key not in content:
                continue
            value, usual = content[key].value, _labelled((base or {}).get(key))
            if isinstance(value, list):
                value = [replace(node, value=entry(node, {})) for node in value]
            elif isinstance(value, dict):
                value = {
                    label: replace(node, value=entry(node, usual.get(label, {})))
                    for label, node in value.items()
                }
            found[key] = replace(content[key], value=value)
        legend = _inner(content.get("map", YamlNode(None)), "legend")
        if legend is not None:
            legend = {character: self._sign(node) for character, node in legend.items()}
            drawn = {**content["map"].value}
            drawn["legend"] = replace(drawn["legend"], value=legend)
            found["map"] = replace(content["map"], value=drawn)
        conditions = content.get("conditions")
        if base is None and conditions is not None and isinstance(conditions.value, dict):
            overrides = {
                number: replace(node, value=self.scene(node.value, content))
                if isinstance(node.value, dict)
                else node
                for number, node in conditions.value.items()
            }
            found["conditions"] = replace(conditions, value=overrides)
        return found

    def _expectation(self, node: YamlNode, usual: Mapping[str, Any]) -> Any:
        """Return an expectation; `usual` is the entry that it overrides, if it overrides one."""
        if not isinstance(node.value, dict):
            return node.value
        entry = {"at" if key == "position" else key: child for key, child in node.value.items()}
        if "position" in node.value:
            self._note("'at' for 'position'", node.value["position"])
            if entry["at"].value is not None and not {"within", "position"} & {*entry, *usual}:
                entry["within"] = self._old_within(node)
        for subject, keys in _UNKNOWN.items():
            if subject in entry and not usual and not entry.keys() & {*keys}:
                entry[keys[0]] = YamlNode(None)
                self._note(f"'{keys[0]}: null' for what is unknown of the {subject}", node)
        return entry

    def _probe(self, node: YamlNode, usual: Mapping[str, Any]) -> Any:
        """Return a probe; `usual` is the entry that it overrides, if it overrides one."""
        if not isinstance(node.value, dict):
            return node.value
        probe = dict(node.value)
        doubt = _inner(probe.get("infer", YamlNode(None)), "doubt")
        if doubt is not None:
            inner = {**probe["infer"].value}
            alternatives = {name: self._alternative(each) for name, each in doubt.items()}
            inner["doubt"] = replace(inner["doubt"], value=alternatives)
            probe["infer"] = replace(probe["infer"], value=inner)
        expect = _inner(node, "expect")
        if expect is None:
            return probe
        entry = dict(expect)
        before = _inner(YamlNode(usual), "expect") or {}
        for key in ("opens", "arrives", "intends"):
            if key in entry:
                entry[key] = self._asked(entry[key])
        walks = {"arrives", "intends"}
        if walks & entry.keys() and not {"within", *walks} & {*before, *(entry.keys() - walks)}:
            entry["within"] = self._old_within(node)
        for key, change in (("answers", self._question), ("believes", self._believes)):
            if key in entry:
                entry[key] = self._each(entry[key], change)
        probe["expect"] = replace(probe["expect"], value=entry)
        return probe

    @staticmethod
    def _each(node: YamlNode, change: Callable[[YamlNode], YamlNode]) -> YamlNode:
        """Change each entry of a list, or a single entry."""
        if isinstance(node.value, list):
            return replace(node, value=[change(each) for each in node.value])
        return change(node)

    def _sign(self, node: YamlNode) -> YamlNode:
        if not isinstance(node.value, dict) or "claims" not in node.value:
            return node
        claims = self._each(node.value["claims"], self._claim)
        return replace(node, value={**node.value, "claims": claims})

    def _claim(self, node: YamlNode) -> YamlNode:
        """Return the fact of a claim."""
        if not isinstance(node.value, dict) or not {"kind", "place"} <= node.value.keys():
            return node
        told = dict(node.value)
        kind, place = told.pop("kind"), told.pop("place")
        item = told.pop("item", YamlNode(None))
        if kind.value == "located":
            told |= {"container": place, "items": YamlNode({item.value: YamlNode(1)}, item.line)}
        elif kind.value == "absent":
            told |= {"container": place, "lacks": item}
        elif kind.value in _PLACES:
            told[_PLACES[kind.value]] = place
        else:
            return node
        self._note("claims as facts, such as 'container' and 'items'", node)
        return replace(node, value=told)

    def _alternative(self, node: YamlNode) -> YamlNode:
        """Return the facts of an alternative of a doubt."""
        if not isinstance(node.value, dict):
            return node
        self._note("the alternatives of 'doubt' as lists of facts", node)
        facts = [
            replace(
                each, value=usual | {keys.get(key, key): part for key, part in each.value.items()}
            )
            for kind, keys, usual in _ALTERED
            for each in _listed(node.value.get(kind))
        ]
        facts += [
            YamlNode({"agent": YamlNode(agent), "at": feet}, feet.line)
            for agent, feet in (_inner(node, "agents") or {}).items()
        ]
        return replace(node, value=facts)

    def _believes(self, node: YamlNode) -> YamlNode:
        return replace(node, value=self._expectation(node, {}))

    def _question(self, node: YamlNode) -> YamlNode:
        if not isinstance(node.value, dict) or "right" not in node.value:
            return node
        return replace(node, value={**node.value, "right": self._asked(node.value["right"])})

    def _asked(self, node: YamlNode) -> YamlNode:
        """Return the fact that is asked for."""
        if not isinstance(node.value, dict) or "believed" not in node.value:
            return node
        self._note("'path' for 'believed'", node)
        return replace(
            node,
            value={"path" if key == "believed" else key: each for key, each in node.value.items()},
        )

    def _old_within(self, node: YamlNode) -> YamlNode:
        self._note(f"'within: {_OLD_WITHIN:g}' where a place has none", node)
        return YamlNode(_OLD_WITHIN)

    def _note(self, told: str, node: YamlNode) -> None:
        self.advice.setdefault(told, node.line)


def _labelled(node: YamlNode | None) -> dict[Any, _Nodes]:
    """Return the entries of a list by label."""
    mappings = [entry.value for entry in _listed(node)]
    return {each["label"].value: each for each in mappings if _is_text(each.get("label"))}


def _listed(node: YamlNode | None) -> list[YamlNode]:
    """Return the mappings in a list."""
    entries = node.value if node is not None and isinstance(node.value, list) else []
    return [each for each in entries if isinstance(each.value, dict)]


def _is_text(node: YamlNode | None) -> bool:
    return node is not None and isinstance(node.value, str)


def _inner(node: YamlNode, key: str) -> _Nodes | None:
    """Return the mapping under a key of a mapping; None: there is none."""
    child = node.value.get(key) if isinstance(node.value, dict) else None
    return child.value if child is not None and isinstance(child.value, dict) else None
