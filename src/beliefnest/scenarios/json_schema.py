"""JSON schema of scenario files, generated from the types in `format`, for editors and errors."""

from collections.abc import Iterable
from functools import cache
from inspect import cleandoc
from typing import Any

import msgspec

from beliefnest.scenarios.document import LABELLED
from beliefnest.scenarios.format import ScenarioFile, WrittenFile

_HOLE = {
    "description": "A parameter, which its value replaces, or an expression of parameters.",
    "type": "string",
    "pattern": r"^\$\{[^{}]*\}$",
}
_AS_WRITTEN = ("ParameterEntry", "InstanceEntry")
"""Definitions in which `${...}` is not replaced."""
_DECLARING = ("parameters", "constraints", "instances", "conditions")
"""Keys whose values contain no `${...}` to replace."""


def schema() -> dict[str, Any]:
    """Return the JSON schema of a scenario file for editors, with descriptions.

    Where a value is not a text, the schema also allows a text `${...}`; the value of a parameter
    replaces it.
    """
    published = _form()
    definitions = {
        name: entry if name in _AS_WRITTEN else _with_holes(entry)
        for name, entry in published["$defs"].items()
    }
    return {**published, "$defs": {**definitions, "Hole": _HOLE}}


def _with_holes(entry: dict[str, Any]) -> dict[str, Any]:
    """Return an object's definition in which properties and values inside them may be holes."""
    properties = {
        key: value if key in _DECLARING else _or_hole(value)
        for key, value in entry.get("properties", {}).items()
    }
    return {**entry, "properties": properties}


def _or_hole(value: dict[str, Any]) -> dict[str, Any]:
    about: dict[str, Any] = {k: value[k] for k in ("description", "default") if k in value}
    bare = {key: part for key, part in value.items() if key not in about}
    forms = [_holes_inside(form) for form in bare.get("anyOf", [bare] if bare else [])]
    if forms and all(form.get("type") != "string" for form in forms):
        forms.append({"$ref": "#/$defs/Hole"})
    return {**about, **({"anyOf": forms} if len(forms) > 1 else bare)}


def _holes_inside(form: dict[str, Any]) -> dict[str, Any]:
    """Return the form of a list or mapping whose values may be holes; other forms unchanged."""
    inner = dict(form)
    for key in ("items", "additionalProperties"):
        if isinstance(inner.get(key), dict):
            inner[key] = _or_hole(inner[key])
    if "prefixItems" in inner:
        inner["prefixItems"] = [_or_hole(each) for each in inner["prefixItems"]]
    return inner


@cache
def _form() -> dict[str, Any]:
    """Return the JSON schema of a scenario file after parameters are filled in."""
    _, definitions = msgspec.json.schema_components(
        (ScenarioFile, WrittenFile), ref_template="#/$defs/{name}"
    )
    for entry in definitions.values():
        # Python 3.13 removes the indentation of docstrings; older versions keep it.
        # Attributes have descriptions of their own.
        entry["description"] = cleandoc(entry["description"]).partition("\n\nAttributes:")[0]
    strict, written = definitions["ScenarioFile"], definitions.pop("WrittenFile")
    definitions["ScenarioFile"] = {**strict, "properties": written["properties"]}
    overriding = {k: dict(v) for k, v in written["properties"].items() if k != "conditions"}
    overriding["agents"] = _mapping_of(_override_of("AgentEntry", definitions))
    overriding["perception"] = _override_of("Perception", definitions)
    overriding["map"] = _override_of("MapEntry", definitions)
    for key in LABELLED:
        entry = overriding[key]["items"]["$ref"].rpartition("/")[2]
        by_label = _mapping_of(_override_of(entry, definitions))
        overriding[key] = {"anyOf": [overriding[key], by_label]}
    condition = _override_of("ScenarioFile", definitions)
    definitions["ScenarioFileOverride"]["properties"] = overriding
    properties = dict(written["properties"])
    properties["conditions"] = {**properties["conditions"], "additionalProperties": condition}
    # A map can show where agents stand; without one, each agent has a position.
    properties["agents"] = overriding["agents"]
    placed = {"agents": {"additionalProperties": {"required": ["position"]}, "minProperties": 1}}
    definitions["ScenarioFile"] = {
        **strict,
        "properties": properties,
        "required": written["required"],
        "if": {"required": ["map"]},
        "else": {"required": ["box", "agents"], "properties": placed},
    }
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$ref": "#/$defs/ScenarioFile",
        "$defs": definitions,
    }


def _override_of(name: str, definitions: dict[str, Any]) -> dict[str, str]:
    """Define a copy of an object's form without required keys, and return a reference to it."""
    override = f"{name}Override"
    definitions[override] = {**definitions[name], "title": override, "required": []}
    return {"$ref": f"#/$defs/{override}"}


def _mapping_of(values: dict[str, str]) -> dict[str, Any]:
    return {"type": "object", "additionalProperties": values}


def allowed_keys(path: Iterable[str | int]) -> list[str]:
    """Return the keys allowed at a place of a scenario file; none if there is no object."""
    return sorted({key for place in _places(path) for key in place.get("properties", {})})


def wanted_form(
    path: Iterable[str | int], file: type = ScenarioFile, *, ranges: bool = False
) -> str:
    """Return in words what stands at a place of a file, with examples of lists.

    Args:
        path: The place.
        file: Form of the file.
        ranges: True to say which numbers are allowed.
    """
    places = [each for each in _places(path, file) if each.get("type", "null") != "null"]
    forms = (_words(each) + (_range(each) if ranges else "") for each in places)
    return ", or ".join(dict.fromkeys(forms))


def _range(form: dict[str, Any]) -> str:
    """Return the bounds of a number in words; empty if it has none."""
    words = {"minimum": "at least", "exclusiveMinimum": "above", "maximum": "at most"}
    bounds = " and ".join(f"{word} {form[key]:,}" for key, word in words.items() if key in form)
    return f", {bounds}" if bounds else ""


_WORDS = {
    "array": ("a list", "[...]"),
    "boolean": ("true or false", "true"),
    "integer": ("an integer", "1"),
    "number": ("a number", "1.5"),
    "object": ("a mapping", "{...}"),
    "string": ("a text", "text"),
}
"""Types of JSON schema in words, and examples."""


def _words(form: dict[str, Any]) -> str:
    words, _ = _WORDS[form["type"]]
    if form["type"] not in ("array", "object"):
        return words
    if keys := form.get("required") or list(form.get("properties", {})):
        return f"{words} with keys such as {', '.join(keys[:5])}"
    return f"{words} such as {_example(form)}"


def _example(form: dict[str, Any], number: int = 1) -> str:
    """Return an example of a value, as in a file.

    Args:
        form: Form of the value.
        number: Number of the value in a list, from 1.
    """
    match form:
        case {"prefixItems": list(parts)}:
            example = f"[{', '.join(_example(part, n) for n, part in enumerate(parts, 1))}]"
        case {"items": dict(part)}:
            example = f"[{_example(part)}]"
        case {"additionalProperties": {"type": "integer"}}:
            example = "{diamond: 1}"
        case {"additionalProperties": dict(part)}:
            example = f"{{name: {_example(part)}}}"
        case {"anyOf": [dict(part), *_]}:
            example = _example(part, number)
        case {"type": "integer" | "number"}:
            example = str(number)
        case _:
            example = _WORDS[form.get("type", "object")][1]
    return example


def _places(path: Iterable[str | int], file: type = ScenarioFile) -> list[dict[str, Any]]:
    """Return the schema's definitions for a place of a file, one for each form."""
    definitions = (_form() if file is ScenarioFile else msgspec.json.schema(file))["$defs"]
    places = [definitions[file.__name__]]
    for key in path:
        inner = [_inside(definition, key) for definition in places]
        places = [leaf for choice in inner for leaf in _choices(choice, definitions)]
    return places


def _inside(definition: dict[str, Any], key: str | int) -> dict[str, Any]:
    if isinstance(key, str) and key in definition.get("properties", {}):
        return dict(definition["properties"][key])
    parts = definition.get("prefixItems", [])
    if isinstance(key, int) and key < len(parts):
        return dict(parts[key])
    inner = definition.get("additionalProperties" if isinstance(key, str) else "items")
    return inner if isinstance(inner, dict) else {}


def _choices(definition: dict[str, Any], definitions: dict[str, Any]) -> list[dict[str, Any]]:
    if "$ref" in definition:
        return [definitions[definition["$ref"].rpartition("/")[2]]]
    choices = definition.get("anyOf", [])
    return [leaf for choice in choices for leaf in _choices(choice, definitions)] or [definition]
