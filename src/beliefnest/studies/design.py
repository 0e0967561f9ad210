"""Checked design of a study of scenarios: the values that it combines."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import msgspec

from beliefnest.errors import BeliefNestError, InputError, ScenarioError
from beliefnest.llm.budget import RunLimits
from beliefnest.llm.model_settings import ModelSettings
from beliefnest.prompts.templates import (
    BUILT_IN_TEMPLATES,
    Template,
    built_in_template,
    load_template,
)
from beliefnest.scenarios.document import Document
from beliefnest.scenarios.expressions import evaluate, names_in
from beliefnest.scenarios.parameters import declared_in
from beliefnest.studies.allocation import Allocation
from beliefnest.studies.checking import (
    StudyKeyError,
    check_cells,
    check_count,
    check_once,
    checked_lists,
    is_amount,
    is_count,
    is_whole,
)
from beliefnest.studies.variation import CHANGES, Variation
from beliefnest.world.texts import quoted
from beliefnest.worlds.names import check_world

Constraint = str | Callable[[Mapping[str, Any]], bool]
"""Condition on a variation's values: an expression, or a function of them."""


class Design(msgspec.Struct, frozen=True):
    """Design of a study of scenarios.

    Attributes:
        scenarios: Names of built-in scenarios, or paths of files.
        models: Names of models.
        templates: Prompt templates that replace those of the scenarios; empty: no replacement.
        repeats: Number of times that each cell is played, each time with another seed.
        seed: Seed of the drawn variations; seeds of cells are derived from it.
        variations: Lists of values, all of whose combinations are played; or the number of
            variations to draw.
        conditions: Numbers of conditions; None: all.
        constraints: Conditions on a variation's values.
        world: Name of the world.
        attempts: Greatest number of requests to a model for one probe.
        temperature: Sampling temperature; None: the provider's default.
        limits: Limits of tokens and cost of the whole study.
        claims_from: Name of the model that extracts claims from utterances; None: no extraction.
        settings: Settings of requests to models.
        design: Allocation of conditions to variations.
        labels: Labels of groups of scenarios, by the scenario's name or path.
        balance: Names of shortcuts that are right as often as guesses in the chosen variations.
    """

    scenarios: tuple[str, ...]
    models: tuple[str, ...] = ("offline",)
    templates: tuple[Template, ...] = ()
    repeats: int = 1
    seed: int = 0
    variations: Mapping[str, Sequence[Any]] | int = msgspec.field(default_factory=dict)
    conditions: tuple[int, ...] | None = None
    constraints: tuple[Constraint, ...] = ()
    world: str = "embedded"
    attempts: int = 3
    temperature: float | None = 0.0
    limits: RunLimits = msgspec.field(default_factory=RunLimits)
    claims_from: str | None = None
    settings: ModelSettings = msgspec.field(default_factory=ModelSettings)
    design: Allocation = "crossed"
    labels: Mapping[str, str] = msgspec.field(default_factory=dict)
    balance: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for name, values in (("scenarios", self.scenarios), ("models", self.models)):
            if not values:
                raise StudyKeyError(name, f"a study without {name} has no cells; name at least one")
            check_once(name, values)
        check_once("templates", [template.name for template in self.templates])
        check_once("balance", self.balance)
        check_count("repeats", self.repeats)
        check_count("attempts", self.attempts)
        if self.temperature is not None and not is_amount(self.temperature):
            why = f"temperature is {quoted(self.temperature)}; give a number, at least 0, or None"
            raise StudyKeyError("temperature", why)
        for name, text in (("world", self.world), ("claims_from", self.claims_from or "")):
            if not isinstance(text, str):
                raise StudyKeyError(name, f"{name} is {quoted(text)}; give a name")
        if not is_whole(self.seed):
            raise StudyKeyError("seed", f"seed is {quoted(self.seed)}; it must be a whole number")
        check_world(self.world, servers=False)
        draws = self.variations
        if isinstance(draws, Mapping):
            checked_lists(draws)
        elif not is_count(draws):
            why = f"variations is {quoted(draws)}; give a number, at least 1, or lists of values"
            raise StudyKeyError("variations", why)
        lists = [draws] if isinstance(draws, int) else [len(each) for each in draws.values()]
        check_cells("variations", math.prod(lists))
        check_cells("repeats", self.repeats * len(self.models) * math.prod(lists))

    @property
    def setting(self) -> dict[str, Any]:
        """Return the settings that affect the results of all cells."""
        return {
            "seed": self.seed,
            "world": self.world,
            "attempts": self.attempts,
            "temperature": self.temperature,
            **({} if self.claims_from is None else {"claims_from": self.claims_from}),
            **self.settings.chosen,
        }

    @property
    def asked(self) -> tuple[str, ...]:
        """Names of all models that are asked, also those that extract claims."""
        return (*self.models, *filter(None, [self.claims_from]))

    def plain(self) -> dict[str, Any]:
        """Return the design as plain values for the study's plan."""
        return {
            "scenarios": list(self.scenarios),
            "models": list(self.models),
            "templates": [template.name for template in self.templates],
            "repeats": self.repeats,
            "variations": self.variations
            if isinstance(self.variations, int)
            else {name: list(values) for name, values in self.variations.items()},
            "conditions": None if self.conditions is None else list(self.conditions),
            **({} if self.design == "crossed" else {"design": self.design}),
            **({"balance": list(self.balance)} if self.balance else {}),
            **self.setting,
        }

    def constrained(self) -> Iterator[tuple[int, frozenset[str]]]:
        """Yield the number of each constraint in words, and the names in it.

        Raises:
            StudyKeyError: A constraint is no expression.
        """
        for number, constraint in enumerate(self.constraints):
            if isinstance(constraint, str):
                try:
                    yield number, names_in(constraint)
                except InputError as error:
                    raise StudyKeyError(("constraints", number), str(error)) from None

    def broken_constraint(
        self, document: Document, condition: int | None, variation: Variation
    ) -> BeliefNestError | None:
        """Return an error for the first constraint that a variation breaks; None: none.

        Raises:
            StudyKeyError: A constraint cannot be computed.
        """
        declared = declared_in(document, condition)
        defaults = {name: entry.default for name, entry in declared.items()}
        values = {**dict.fromkeys(CHANGES), **defaults, **variation.values}
        for number, constraint in enumerate(self.constraints):
            words = f"the constraint {quoted(getattr(constraint, '__name__', constraint))}"
            try:
                if isinstance(constraint, str):
                    holds = bool(evaluate(constraint, values))
                else:
                    holds = bool(constraint(values))
            except InputError as error:
                raise StudyKeyError(("constraints", number), str(error)) from None
            except Exception as error:  # a user's function may raise anything; report it
                message = f"{words} raised {type(error).__name__}: {error}"
                raise StudyKeyError(("constraints", number), message) from error
            if not holds:
                return ScenarioError(f"{words} does not hold")
        return None


def template_named(name: str, folder: Path = Path()) -> Template:
    """Return a built-in template, or one in a file.

    Raises:
        TemplateError: There is no such file.
    """
    return built_in_template(name) if name in BUILT_IN_TEMPLATES else load_template(folder / name)
