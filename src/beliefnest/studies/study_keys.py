"""Keys of a study, as its file and `Study` take them, and the design that they describe."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import msgspec
from msgspec.structs import fields

from beliefnest.errors import InputError
from beliefnest.llm.model_settings import ModelSettings, query_of
from beliefnest.prompts.templates import Template
from beliefnest.studies.allocation import DESIGNS, Allocation
from beliefnest.studies.checking import StudyKeyError, checked_conditions, checked_limits, several
from beliefnest.studies.design import Constraint, Design
from beliefnest.studies.episode_design import EpisodeDesign, Order, Policies, listed, seeds_of
from beliefnest.studies.items.report import FIXED_SOLVERS, LEARNED
from beliefnest.world.texts import quoted
from beliefnest.world.words import nearest_or_all


class StudyKeys(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Keys of a study with their defaults; `Study` documents them."""

    scenarios: Sequence[str | Mapping[str, Any]] | str = ()
    models: Sequence[str] | str | None = None
    templates: Sequence[str] | str | None = None
    repeats: int = 1
    seed: int = 0
    variations: Mapping[str, Any] | int | None = None
    conditions: Sequence[int] | None = None
    constraints: Sequence[str] | str = ()
    world: str | None = None
    attempts: int = 3
    temperature: float | None = 0.0
    retry_unread: int = 0
    answer: str = ModelSettings().answer
    max_tokens: int | None = 1_000_000
    max_cost: float | None = 5.0
    claims_from: str | None = None
    answer_seconds: float = ModelSettings().answer_seconds
    first_token_seconds: float = ModelSettings().first_token_seconds
    max_output_tokens: int | None = None
    system: str | None = None
    skills: str = ModelSettings().skills
    tasks: Sequence[str] | str | None = None
    policies: Sequence[Policies] | Policies = ()
    orders: Sequence[Order] = ()
    seeds: Sequence[int] | int = 1
    help: bool = False
    design: str = "crossed"
    balance: Sequence[str] | str = ()


def design_of(
    keys: StudyKeys, templates: tuple[Template, ...], constraints: Sequence[Constraint]
) -> Design | EpisodeDesign:
    """Return the design of a study: of episodes if tasks are given, else of scenarios.

    Args:
        keys: The keys.
        templates: The templates that `keys` names.
        constraints: Conditions on a variation's values.

    Raises:
        StudyKeyError: The value of a key is wrong.
    """
    if keys.tasks is not None:
        return _episodes(keys, constraints)
    for name, default in (("policies", ()), ("orders", ()), ("seeds", 1), ("help", False)):
        if getattr(keys, name) not in ([], default):
            message = "policies, orders, seeds and help are for tasks; name tasks to play episodes"
            raise StudyKeyError(name, message)
    groups = labelled_scenarios(keys.scenarios)
    return Design(
        scenarios=tuple(name for _, names in groups for name in names),
        models=("offline",) if keys.models is None else several("models", keys.models),
        templates=templates,
        repeats=keys.repeats,
        seed=keys.seed,
        variations={} if keys.variations is None else keys.variations,
        conditions=checked_conditions(keys.conditions),
        constraints=tuple(constraints),
        world="embedded" if keys.world is None else keys.world,
        attempts=keys.attempts,
        temperature=keys.temperature,
        limits=checked_limits(keys.max_tokens, keys.max_cost),
        claims_from=keys.claims_from,
        settings=_settings(keys),
        design=_allocation(keys.design),
        labels={name: label for label, names in groups for name in names if label},
        balance=_shortcuts(keys),
    )


def _shortcuts(keys: StudyKeys) -> tuple[str, ...]:
    names = several("balance", keys.balance)
    for number, name in enumerate(names):
        if name in LEARNED:
            why = (
                f"{name} learns from the items themselves, so that no choice of items balances it; "
                f"give some of {', '.join(FIXED_SOLVERS)}"
            )
            raise StudyKeyError(("balance", number), why)
        if name not in FIXED_SOLVERS:
            why = f"there is no shortcut {quoted(name)}{nearest_or_all(name, list(FIXED_SOLVERS))}"
            raise StudyKeyError(("balance", number), why)
    if names and keys.design != "crossed":
        why = f"design {quoted(keys.design)} allocates conditions itself; leave one of them out"
        raise StudyKeyError("balance", why)
    return names


def labelled_scenarios(entries: object) -> list[tuple[str, tuple[str, ...]]]:
    """Return groups of scenarios: the label, empty for a scenario without one, and the names.

    Raises:
        StudyKeyError: An entry is neither a name nor a mapping with `label` and `scenarios`, or
            some groups have a label and others have none.
    """
    listed = (
        entries if isinstance(entries, Sequence) and not isinstance(entries, str) else [entries]
    )
    labelled: list[tuple[str, tuple[str, ...]]] = []
    for number, each in enumerate(listed if entries != () else ()):
        if not isinstance(each, Mapping):
            labelled.append(("", several("scenarios", each)))
            continue
        place = ("scenarios", number)
        label = each.get("label")
        if set(each) != {"label", "scenarios"} or not isinstance(label, str) or not label.strip():
            message = (
                f"has {quoted(dict(each))}; give a name, or a mapping with `label` and `scenarios`"
            )
            raise StudyKeyError(place, f"scenarios {message}")
        labelled.append((label.strip(), several("scenarios", each["scenarios"])))
    bare = [names[0] for label, names in labelled if not label and names]
    if bare and len(bare) < len(labelled):
        message = f"{bare[0]} has no label, which other scenarios have; give it one"
        raise StudyKeyError("scenarios", message)
    return labelled


def _settings(keys: StudyKeys) -> ModelSettings:
    """Return the settings of requests to models; `system` is the path of a file."""
    values = {each.name: getattr(keys, each.name) for each in fields(ModelSettings)}
    for name, value in values.items():
        # One by one, so that an error names its key.
        try:
            ModelSettings.of_file(**{"system": None, name: value})
        except InputError as error:
            raise StudyKeyError(name, str(error)) from None
    return ModelSettings.of_file(**values)


def _allocation(name: object) -> Allocation:
    for allocation in DESIGNS:
        if allocation == name:
            return allocation
    raise StudyKeyError("design", f"design is {quoted(name)}; give one of {', '.join(DESIGNS)}")


def _episodes(keys: StudyKeys, constraints: Sequence[Constraint]) -> EpisodeDesign:
    foreign = {
        "scenarios": keys.scenarios,
        "templates": keys.templates,
        "constraints": constraints,
        "claims_from": keys.claims_from,
        "design": "" if keys.design == "crossed" else keys.design,
        "balance": keys.balance,
    }
    for name, value in foreign.items():
        if value:
            raise StudyKeyError(name, f"{name} cannot stand beside tasks; make two studies")
    if isinstance(keys.variations, int):
        raise StudyKeyError(
            "variations", "variations of tasks must be lists of values; give `seeds` for instances"
        )
    return EpisodeDesign(
        tasks=several("tasks", keys.tasks),
        policies=listed(keys.policies),
        models=() if keys.models is None else several("models", keys.models),
        orders=tuple(keys.orders),
        seeds=seeds_of(keys.seeds, keys.seed),
        repeats=keys.repeats,
        variations=keys.variations or {},
        conditions=checked_conditions(keys.conditions),
        world="scripted" if keys.world is None else keys.world,
        help=keys.help,
        query=_query(keys),
        limits=checked_limits(keys.max_tokens, keys.max_cost),
    )


def _query(keys: StudyKeys) -> str:
    """Return the settings of requests to models for the names of policies."""
    chosen = _settings(keys).chosen
    chosen.pop("system", None)
    return query_of(None if keys.system is None else Path(keys.system), chosen)
