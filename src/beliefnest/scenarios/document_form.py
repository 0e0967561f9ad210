"""Check of a document's form: known keys, and values of the right kind."""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeVar

import msgspec

from beliefnest.errors import InputError, ScenarioError
from beliefnest.facts.reading import FORMER
from beliefnest.scenarios.document import Document, KeyPath, YamlNode, plain, wrapped
from beliefnest.scenarios.format import ScenarioFile, WrittenFile
from beliefnest.scenarios.json_schema import allowed_keys, allowed_values, wanted_form
from beliefnest.world.texts import is_well_formed, quoted, shortened
from beliefnest.world.words import nearest_or_all

_FAULT = re.compile(r"(?P<what>.*?)(?: - at (?P<key>`key` in )?`(?P<path>\$.*)`)?", re.DOTALL)
FAULT_STEP = re.compile(r"\.(?P<name>\w+)|\[(?P<index>\d+)\]|(?P<any>\[\.\.\.\])")
"""Step of a place as msgspec writes it: a name, an index, or any key of a mapping."""
_UNKNOWN_FIELD = re.compile(r"Object contains unknown field `(?P<name>.*)`", re.DOTALL)
_MISSING_FIELD = re.compile(r"Object missing required field `(?P<name>.*)`")

_F = TypeVar("_F", bound=ScenarioFile | WrittenFile)

_LONGEST_FAULT = 160
"""Greatest number of characters of a fault that the validation found; it may quote the value."""

_ASKED = "; a question leaves open how it is: write {path: PATH} with one thing of "
_HOW = ("items", "at", "state", "text", "lacks")
"""Keys of facts that say how something is."""

_PLACE = "[1, 2, 3]"
"""Example of a position."""

_MOST_BITS = 64
"""Bits of whole numbers that messages repeat; Python refuses to format very long ones."""


def check_form(document: Document) -> ScenarioFile:
    """Return the content of a document without a map as typed values.

    Raises:
        ScenarioError: A key is unknown or missing, or a value is of the wrong kind.
    """
    return _checked(document, ScenarioFile)


def check_written(document: Document) -> ScenarioFile | WrittenFile:
    """Return the content of a document as written, with or without a map, as typed values.

    Raises:
        ScenarioError: A key is unknown or missing, or a value is of the wrong kind.
    """
    return _checked(document, WrittenFile if "map" in document.root.value else ScenarioFile)


def check_rules_form(rules: Mapping[str, object]) -> None:
    """Check rules of play that are given in code, as those under `episode` in a file.

    Raises:
        ScenarioError: A key is unknown, or a value is of the wrong kind.
    """
    scene = {"name": "task", "box": [[0, 0, 0]] * 2, "agents": {"a": {"position": [0, 0, 0]}}}
    content = {**scene, "episode": msgspec.to_builtins(rules)}
    check_form(Document("task", wrapped(content), Path()))


def _checked(document: Document, form: type[_F]) -> _F:
    _check_texts(document, document.root, ())
    content = _content_of(document.root, form)
    if isinstance(content, str):
        raise _fault(document, content, form)
    return content


def _content_of(root: YamlNode, form: type[_F]) -> _F | str:
    """Return a document's content as typed values, or what is wrong with it."""
    try:
        return msgspec.convert(plain(root), form)
    except msgspec.ValidationError as error:
        return str(error)
    except InputError as error:  # Options of perception are checked as in code.
        return f"{error} - at `$.perception`"


def _check_texts(document: Document, node: YamlNode, path: KeyPath) -> None:
    """Refuse texts that cannot be stored, as they contain lone surrogates."""
    if isinstance(node.value, dict):
        for key, child in node.value.items():
            if isinstance(key, str) and not is_well_formed(key):
                raise document.fault(path, "has a key with half a character in it")
            _check_texts(document, child, (*path, key))
    elif isinstance(node.value, list):
        for index, child in enumerate(node.value):
            _check_texts(document, child, (*path, index))
    elif isinstance(node.value, str) and not is_well_formed(node.value):
        raise document.fault(path, "has half a character in it; write whole ones")


def _fault(document: Document, error: str, form: type[_F]) -> ScenarioError:
    match = _FAULT.fullmatch(error)
    if match is None:
        return document.fault((), shortened(error, _LONGEST_FAULT))
    steps = [step.groupdict() for step in FAULT_STEP.finditer(match["path"] or "$")]
    return _fault_at(document, _locate(document.root, steps, error, form), match)


def entry_fault(document: Document, path: KeyPath, error: str) -> ScenarioError:
    """Return the error about an entry of a document that was validated by itself.

    Args:
        document: The document.
        path: Place of the entry.
        error: Message of the validation.
    """
    match = _FAULT.fullmatch(error)
    if match is None:
        return document.fault(path, shortened(error, _LONGEST_FAULT))
    inner = [
        step["name"] or int(step["index"]) for step in FAULT_STEP.finditer(match["path"] or "")
    ]
    return _fault_at(document, (*path, *inner), match)


def _fault_at(document: Document, path: KeyPath, match: re.Match[str]) -> ScenarioError:
    """Return the error at a place."""
    what = match["what"]
    if unknown := _UNKNOWN_FIELD.fullmatch(what):
        name = unknown["name"]
        return document.fault((*path, name), f"unknown key{_hint(shortened(name), path)}")
    if missing := _MISSING_FIELD.fullmatch(what):
        return document.fault(path, f"the key {quoted(missing['name'])} is missing")
    what = shortened(what[:1].lower() + what[1:].replace("`", "'"), _LONGEST_FAULT)
    if match["key"]:
        quotes = "; put it into quotes" if what.startswith("expected 'str'") else ""
        return document.fault(path, f"a key in it: {what}{quotes}")
    value = plain(_node_at(document.root, list(path)))
    in_range = " got " in what
    if what.startswith("expected") and (wanted := wanted_form(path, ranges=not in_range)):
        at = _standing(document.root, value) if _PLACE in wanted else ""
        what = f"expected {wanted}, got {quoted(value)}{at}"
    return document.fault(path, what + _found(value, what) + _allowed(path, value, what))


def _standing(root: YamlNode, name: object) -> str:
    """Return where the container or place with a name is, for a message; empty: there is none."""
    # The file may have other faults.
    form: Any = plain(root)
    containers, places = form.get("containers"), form.get("places")
    labelled = [*places.items()] if isinstance(places, dict) else []
    for each in containers if isinstance(containers, list) else ():
        labelled += [(each.get("label"), each.get("at"))] if isinstance(each, dict) else []
    at = next((at for label, at in labelled if label == name), None)
    return f"; {quoted(name)} is at {at}" if at and isinstance(name, str) else ""


def _found(value: object, what: str) -> str:
    """Return a value for a message, if the error does not already say it."""
    is_short = isinstance(value, float | None) or (
        isinstance(value, int) and value.bit_length() <= _MOST_BITS
    )
    is_quoted = not what.startswith("expected") or ", got" in what
    return f", got {quoted(value)}" if is_short and not is_quoted else ""


def _allowed(path: KeyPath, value: object, what: str) -> str:
    """Return what is allowed at a place, for a message."""
    if values := allowed_values(path):
        forms = [f"{{{key}: ...}}" for key in allowed_keys(path)]
        return f"; allowed are {', '.join([*values, *forms])}"
    is_text = what.startswith("expected a text, got") and not isinstance(value, list | dict)
    return "; put it into quotes" if is_text else ""


def _hint(name: str, path: KeyPath) -> str:
    allowed = allowed_keys(path)
    inner = [key for key in allowed if name in allowed_keys((*path, key))]
    if inner:
        return f"; it stands under {quoted(inner[0])}"
    if "unknown" in allowed and name in _HOW:
        return f"{_ASKED}{', '.join(key for key in allowed if key not in ('path', 'unknown'))}"
    if FORMER.get(name) in allowed:
        return f"; write {quoted(FORMER[name])}"
    return nearest_or_all(name, allowed, "keys are")


def _locate(
    root: YamlNode, steps: list[dict[str, str | None]], error: str, form: type[_F]
) -> KeyPath:
    """Return the place of an error, for which msgspec writes `[...]` instead of mapping keys.

    For each `[...]`, try the mapping with only one entry at a time. The entry that still causes
    the error is the wrong one.
    """
    path: list[str | int] = []
    for step in steps:
        if step["name"] is not None:
            path.append(step["name"])
        elif step["index"] is not None:
            path.append(int(step["index"]))
        else:
            cuts = {key: _with_only(root, path, key) for key in _node_at(root, path).value}
            key = next((key for key, cut in cuts.items() if _content_of(cut, form) == error), None)
            if key is None:
                break
            root = cuts[key]
            path.append(key)
    return tuple(path)


def _node_at(root: YamlNode, path: list[str | int]) -> YamlNode:
    for key in path:
        root = root.value[key]
    return root


def _with_only(node: YamlNode, path: list[str | int], key: str | int) -> YamlNode:
    """Return the document with the mapping at a path cut down to one key."""
    if not path:
        return YamlNode({key: node.value[key]}, node.line)
    head, *rest = path
    value = node.value.copy()
    value[head] = _with_only(value[head], rest, key)
    return YamlNode(value, node.line)
