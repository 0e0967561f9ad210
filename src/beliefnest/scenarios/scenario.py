"""Scenarios: events in the real world, and probes and expectations about beliefs."""

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, Self

from msgspec.structs import replace

from beliefnest.scenarios.content import ScenarioContent, ScenarioWarning
from beliefnest.scenarios.document import Document, wrapped
from beliefnest.scenarios.loading import (
    DocumentChange,
    condition_number,
    condition_numbers,
    scenario_in,
)
from beliefnest.scenarios.parameters import beyond, declared_in
from beliefnest.scenarios.sources import read_document
from beliefnest.scenarios.yaml_reading import parse_yaml


@dataclass(frozen=True)
class Scenario(ScenarioContent):
    """Scenario under one of its conditions, if it has any; loaded, or built in code."""

    @classmethod
    def load(
        cls,
        name_or_path: str,
        condition: int | str | None = None,
        parameters: Mapping[str, object] | None = None,
    ) -> Self:
        """Return a built-in scenario, or one in a file.

        Args:
            name_or_path: Name of a built-in scenario, or path of a YAML file.
            condition: Number of a condition, or its text; None: as written, no overrides.
            parameters: Values of declared parameters; the others have their defaults.

        Raises:
            UnknownNameError: There is neither a built-in scenario nor a file of that name.
            ScenarioError: The file is wrong, or the condition does not exist.
        """
        document, number = read_document(name_or_path), condition_number(condition)
        scenario = cls.varied(document, number, parameters)
        warn_of_values(document, number, parameters or {})
        return scenario

    @classmethod
    def load_all(cls, name_or_path: str) -> tuple[Self, ...]:
        """Return the scenario under each of its conditions; as written if it has none.

        Raises:
            UnknownNameError: There is neither a built-in scenario nor a file of that name.
            ScenarioError: The file is wrong.
        """
        document = read_document(name_or_path)
        return tuple(cls.varied(document, number) for number in condition_numbers(document))

    @classmethod
    def from_mapping(
        cls,
        content: Mapping[str, Any],
        condition: int | str | None = None,
        source: str = "scenario",
    ) -> Self:
        """Build a scenario from a file's content as dicts, lists and scalars.

        Raises:
            ScenarioError: The content is wrong.
        """
        document = Document(source, wrapped(content), Path())
        return cls.varied(document, condition_number(condition))

    @classmethod
    def varied(
        cls,
        document: Document,
        condition: int | None,
        parameters: Mapping[str, object] | None = None,
        change: DocumentChange | None = None,
    ) -> Self:
        """Return a variation of a document that was read once.

        Args:
            document: Document, as `read_document` returns it.
            condition: Number of a condition; None: as written, no overrides.
            parameters: Values of declared parameters; the others have their defaults.
            change: Function that changes the document to another scene; None: no change.

        Raises:
            ScenarioError: The variation is not a valid scenario.
        """
        content = scenario_in(document, condition, parameters, change)
        return cls(**{field.name: getattr(content, field.name) for field in fields(content)})

    @classmethod
    def kept(
        cls, text: str, templates: Mapping[str, str], condition: int | None, source: str
    ) -> Self:
        """Return the scenario that a run keeps.

        Args:
            text: Text of the scenario file.
            templates: Texts of the templates that the file names, by name.
            condition: Number of the condition; None: it was run as written.
            source: Name of the source for messages.

        Raises:
            ScenarioError: This version cannot read the scenario.
        """
        return cls.varied(replace(parse_yaml(text, source), templates=templates), condition)


def warn_of_values(
    document: Document, condition: int | None, parameters: Mapping[str, object]
) -> None:
    """Warn of given values of parameters that their document does not list."""
    for line in beyond(document, declared_in(document, condition), parameters):
        warnings.warn(ScenarioWarning(line), stacklevel=3)
