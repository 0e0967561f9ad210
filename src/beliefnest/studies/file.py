"""YAML files of studies."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

import msgspec

from beliefnest.episodes.policies import policy_beside
from beliefnest.episodes.task import Task
from beliefnest.errors import ScenarioError
from beliefnest.scenarios.document import Document, plain
from beliefnest.scenarios.sources import builtin_names
from beliefnest.scenarios.yaml_reading import read_yaml
from beliefnest.studies.checking import StudyKeyError, checked_conditions, checked_limits, several
from beliefnest.studies.design import Design, Template, template_named
from beliefnest.studies.episode_design import (
    EpisodeDesign,
    Policies,
    check_episodes_alone,
    check_scenarios_alone,
    listed,
    seeds_of,
)
from beliefnest.worlds.names import check_world

__all__ = ["read_design"]


class _StudyFile(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Form of a study's file; `Design` and `EpisodeDesign` document the keys."""

    scenarios: list[str] | str = []
    models: list[str] | str | None = None
    templates: list[str] | str = []
    repeats: int = 1
    seed: int = 0
    variations: dict[str, Any] | int = {}
    conditions: list[int] | None = None
    constraints: list[str] | str = []
    world: str | None = None
    attempts: int = 3
    temperature: float | None = 0.0
    max_tokens: int | None = 1_000_000
    max_cost: float | None = 5.0
    claims_from: str | None = None
    tasks: list[str] | str | None = None
    policies: list[str | dict[str, str]] | str | dict[str, str] = []
    orders: list[int | Literal["omniscient"]] = []
    seeds: list[int] | int = 1
    help: bool = False


def read_design(path: Path) -> Design | EpisodeDesign:
    """Return the design in a YAML file; paths in the file are relative to its folder.

    Raises:
        ScenarioError: The file is wrong; the message names file, line and key.
    """
    document = read_yaml(path)
    try:
        found = msgspec.convert(plain(document.root), _StudyFile)
    except msgspec.ValidationError as error:
        raise _fault(document, str(error)) from None
    if found.world is not None:
        with document.naming(("world",)):
            check_world(found.world, servers=False)
    with document.naming(("templates",)):
        templates = tuple(
            template_named(name, path.parent) for name in several("templates", found.templates)
        )
    try:
        if found.tasks is None:
            return _scenarios(found, path, templates)
        return _episodes(found, path, several("tasks", found.tasks))
    except StudyKeyError as fault:
        raise document.fault(fault.path, str(fault)) from None


def _scenarios(found: _StudyFile, path: Path, templates: tuple[Template, ...]) -> Design:
    check_scenarios_alone(found.policies, found.orders, found.seeds, found.help)
    return Design(
        scenarios=tuple(
            _beside(name, path, builtin_names()) for name in several("scenarios", found.scenarios)
        ),
        models=("offline",) if found.models is None else several("models", found.models),
        templates=templates,
        repeats=found.repeats,
        seed=found.seed,
        variations=found.variations,
        conditions=checked_conditions(found.conditions),
        constraints=several("constraints", found.constraints),
        world="embedded" if found.world is None else found.world,
        attempts=found.attempts,
        temperature=found.temperature,
        limits=checked_limits(found.max_tokens, found.max_cost),
        claims_from=found.claims_from,
    )


def _episodes(found: _StudyFile, path: Path, tasks: Sequence[str]) -> EpisodeDesign:
    check_episodes_alone(found.scenarios, found.templates, found.constraints, found.claims_from)
    if isinstance(found.variations, int):
        raise StudyKeyError(
            "variations", "variations of tasks must be lists of values; give `seeds` for instances"
        )
    known = [*Task.names(), *builtin_names()]
    return EpisodeDesign(
        tasks=tuple(_beside(name, path, known) for name in tasks),
        policies=tuple(_policies_beside(each, path.parent) for each in listed(found.policies)),
        models=() if found.models is None else several("models", found.models),
        orders=tuple(found.orders),
        seeds=seeds_of(found.seeds, found.seed),
        repeats=found.repeats,
        variations=found.variations,
        conditions=checked_conditions(found.conditions),
        world="scripted" if found.world is None else found.world,
        help=found.help,
        limits=checked_limits(found.max_tokens, found.max_cost),
    )


def _policies_beside(policies: Policies, folder: Path) -> Policies:
    if isinstance(policies, str):
        return policy_beside(policies, folder)
    return {agent: policy_beside(name, folder) for agent, name in policies.items()}


def _beside(name: str, path: Path, known: Sequence[str]) -> str:
    return name if name in known else str(path.parent / name)


def _fault(document: Document, error: str) -> ScenarioError:
    what, _, place = error.partition(" - at `$.")
    key = place.rstrip("`").partition("[")[0].partition(".")[0]
    if what.startswith("Object contains unknown field"):
        key = what.split("`")[1]
        what = f"unknown key; keys are {', '.join(_StudyFile.__struct_fields__)}"
    what = what[:1].lower() + what[1:].replace("`", "'")
    return document.fault((key,) if key else (), what)
