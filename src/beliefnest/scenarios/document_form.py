"""Check of a document's form: known keys, and values of the right kind."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeVar

import msgspec

from beliefnest.facts.reading import FORMER
from beliefnest.scenarios.document import Document, KeyPath, YamlNode, plain, wrapped
from beliefnest.scenarios.form_faults import FormError, converted
from beliefnest.scenarios.format import ScenarioFile, WrittenFile
from beliefnest.scenarios.json_schema import allowed_keys, wanted_form
from beliefnest.world.texts import is_well_formed, quoted, shortened
from beliefnest.world.words import nearest_or_all

_F = TypeVar("_F")

_LONGEST_FAULT = 160
"""Greatest number of characters of a fault that the validation found; it may quote the value."""

_ASKED = "; a question leaves open how it is: write {path: PATH} with one thing of "
_HOW = ("items", "at", "state", "text", "lacks")
"""Keys of facts that say how something is."""

_PLACE = "[1, 2, 3]"
"""Example of a position."""


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
    is_drawn = "map" in document.root.value
    return _checked(document, WrittenFile) if is_drawn else check_form(document)


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
    return converted_at(document, (), plain(document.root), form)


def converted_at(document: Document, path: KeyPath, part: object, form: type[_F]) -> _F:
    """Return a part of a document as a value of a type.

    Args:
        document: The document.
        path: Place of the part.
        part: The part as plain values.
        form: The type.

    Raises:
        ScenarioError: The part is not as the type says; the message names file, line and key.
    """
    try:
        return converted(part, form)
    except FormError as fault:
        place = (*path, *fault.path)
        raise document.fault(place, _words(document, place, fault)) from None


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


def _words(document: Document, path: KeyPath, fault: FormError) -> str:
    """Return what is wrong at a place, and what is allowed there."""
    what, part = shortened(fault.what, _LONGEST_FAULT), fault.part
    if fault.kind == "unknown":
        return f"unknown key{_hint(shortened(str(path[-1])), path[:-1])}"
    wanted = wanted_form(path, ranges=isinstance(part, int | float))
    if fault.kind == "type" and wanted:
        at = _standing(document.root, part) if _PLACE in wanted else ""
        what = f"expected {wanted}, got {quoted(part)}{at}"
    is_bare = wanted == "a text" and not isinstance(part, str | list | dict)
    return f"{what}; put it into quotes" if is_bare else f"{what}{fault.hint}"


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
