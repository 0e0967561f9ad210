"""From a document to a scenario: finding it, choosing the condition, checking what it says."""

from collections.abc import Mapping
from dataclasses import replace
from importlib.resources import files
from pathlib import Path
from typing import Any

from beliefnest.errors import UnknownNameError
from beliefnest.scenarios.build import build_scenario
from beliefnest.scenarios.content import ScenarioContent
from beliefnest.scenarios.document import Document, merged, wrapped
from beliefnest.scenarios.form import check_form
from beliefnest.scenarios.reading import parse_yaml, read_yaml

__all__ = ["builtin_names", "kept_scenario", "load_conditions", "load_scenario", "scenario_from"]

_SUFFIXES = (".yaml", ".yml")


def builtin_names() -> list[str]:
    """Names of the scenarios that come with the package."""
    folder = files("beliefnest.scenarios") / "builtin"
    names = (entry.name for entry in folder.iterdir())
    return sorted(name.removesuffix(".yaml") for name in names if name.endswith(".yaml"))


def load_scenario(name_or_path: str, condition: int | None = None) -> ScenarioContent:
    """See `Scenario.load`."""
    return _scenario(_document(name_or_path), condition)


def load_conditions(name_or_path: str) -> tuple[ScenarioContent, ...]:
    """See `Scenario.load_all`."""
    document = _document(name_or_path)
    numbers = sorted(check_form(document).conditions)
    if not numbers:
        return (_scenario(document, None),)
    return tuple(_scenario(document, number) for number in numbers)


def scenario_from(
    content: Mapping[str, Any], condition: int | None, source: str
) -> ScenarioContent:
    """See `Scenario.from_mapping`."""
    return _scenario(Document(source, wrapped(content), Path()), condition)


def kept_scenario(
    text: str, templates: Mapping[str, str], condition: int | None, source: str
) -> ScenarioContent:
    """See `Scenario.kept`."""
    return _scenario(replace(parse_yaml(text, source), templates=templates), condition)


def _document(name_or_path: str) -> Document:
    names = builtin_names()
    if name_or_path in names:
        folder = Path(str(files("beliefnest.scenarios") / "builtin"))
        document = read_yaml(folder / f"{name_or_path}.yaml")
        return replace(document, source=f"{name_or_path}.yaml")
    path = Path(name_or_path)
    looks_like_path = path.suffix in _SUFFIXES or len(path.parts) > 1
    if not path.name or (not looks_like_path and not path.exists()):
        raise UnknownNameError(
            f"there is no scenario {name_or_path!r}; built in are {', '.join(names)}, "
            "or give the path of a .yaml file"
        )
    return read_yaml(path)


def _scenario(document: Document, condition: int | None) -> ScenarioContent:
    written = check_form(document)
    if condition is None:
        return build_scenario(document, written, None, written.conditions)
    chosen = merged(document, condition)
    return build_scenario(chosen, check_form(chosen), condition, written.conditions)
