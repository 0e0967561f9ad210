"""Scenarios: events in the real world, and probes and expectations about beliefs."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, Self

from beliefnest.scenarios.content import ScenarioContent
from beliefnest.scenarios.document import Document
from beliefnest.scenarios.loading import (
    Change,
    condition_number,
    kept_scenario,
    load_conditions,
    load_scenario,
    scenario_from,
    scenario_in,
)

__all__ = ["Scenario"]


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
        return cls._of(load_scenario(name_or_path, condition_number(condition), parameters))

    @classmethod
    def load_all(cls, name_or_path: str) -> tuple[Self, ...]:
        """Return the scenario under each of its conditions; as written if it has none.

        Raises:
            UnknownNameError: There is neither a built-in scenario nor a file of that name.
            ScenarioError: The file is wrong.
        """
        return tuple(cls._of(content) for content in load_conditions(name_or_path))

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
        return cls._of(scenario_from(content, condition_number(condition), source))

    @classmethod
    def varied(
        cls,
        document: Document,
        condition: int | None,
        parameters: Mapping[str, object] | None = None,
        change: Change | None = None,
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
        return cls._of(scenario_in(document, condition, parameters, change))

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
        return cls._of(kept_scenario(text, templates, condition, source))

    @classmethod
    def _of(cls, content: ScenarioContent) -> Self:
        return cls(**{field.name: getattr(content, field.name) for field in fields(content)})
