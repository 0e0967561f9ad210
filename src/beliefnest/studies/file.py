"""YAML files of studies."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from msgspec.structs import replace

from beliefnest.episodes.policies import policy_beside
from beliefnest.episodes.task import Task
from beliefnest.errors import ScenarioError, UnknownNameError
from beliefnest.scenarios.document import Document, KeyPath, plain
from beliefnest.scenarios.form_faults import FormError, converted
from beliefnest.scenarios.json_schema import wanted_form
from beliefnest.scenarios.sources import builtin_names
from beliefnest.scenarios.yaml_reading import read_yaml
from beliefnest.studies.checking import StudyKeyError, several
from beliefnest.studies.design import Design, template_named
from beliefnest.studies.episode_design import EpisodeDesign, Policies, listed
from beliefnest.studies.study_keys import StudyKeys, design_of, labelled_scenarios
from beliefnest.world.texts import quoted
from beliefnest.world.words import nearest_or_all
from beliefnest.worlds.names import check_world


def read_design(
    document: Document, instead: Mapping[str, Any] | None = None
) -> Design | EpisodeDesign:
    """Return the design in a YAML file; paths in the file are relative to its folder.

    Args:
        document: Document of the file.
        instead: Values of keys in place of those of the file, with paths as given; None: none.

    Raises:
        ScenarioError: The file is wrong; the message names file, line and key.
    """
    keys_of_file = document.root.value.keys()
    if {"agents", "map", "scenario"} & keys_of_file:
        is_task = bool({"scenario", "episode"} & keys_of_file)
        raise ScenarioError(_no_study(Path(document.source), is_task=is_task))
    try:
        keys = converted(plain(document.root), StudyKeys)
    except FormError as fault:
        raise document.fault(fault.path, _words(fault)) from None
    if keys.world is not None:
        with document.naming(("world",)):
            check_world(keys.world, servers=False)
    templates = []
    for number, name in enumerate(several("templates", keys.templates or ())):
        with document.naming(("templates", number)):
            templates.append(template_named(name, document.folder))
    try:
        constraints = several("constraints", keys.constraints)
        beside = _beside(keys, document.folder)
        return design_of(replace(beside, **(instead or {})), tuple(templates), constraints)
    except StudyKeyError as fault:
        raise document.fault(fault.path, str(fault)) from None


def document_of_study(file: Path) -> Document:
    """Return the document of a study's file.

    Raises:
        ScenarioError: The file cannot be read, or the name is that of a scenario or a task.
    """
    name = str(file)
    if not file.exists() and name in (*Task.names(), *builtin_names()):
        raise ScenarioError(_no_study(file, is_task=name in Task.names()))
    return read_yaml(file)


@contextmanager
def naming_other_kinds(named: str) -> Iterator[None]:
    """Name the command that takes a study or task which is given as a scenario.

    Raises:
        ScenarioError: A scenario cannot be loaded in the block, since it is something else.
    """
    try:
        yield
    except (ScenarioError, UnknownNameError):
        if named in Task.names():
            raise ScenarioError(f"{named} is a task; give it to `beliefnest play`") from None
        if Path(named).is_file():
            keys = read_yaml(Path(named)).root.value.keys()
            if {"scenarios", "tasks"} & keys:
                how = "give it to `beliefnest study` or `beliefnest items`"
                raise ScenarioError(f"{named} is a study; {how}") from None
            if "scenario" in keys:
                raise ScenarioError(f"{named} is a task; give it to `beliefnest play`") from None
        raise


def _no_study(named: Path, *, is_task: bool) -> str:
    """Return a message for a scenario or task that is given as a study."""
    what, command, key = ("task", "play", "tasks") if is_task else ("scenario", "run", "scenarios")
    return (
        f"{named} is a {what}, no study; give it to `beliefnest {command}`, or write a study file "
        f"with `{key}: [{named.name}]`"
    )


def _beside(keys: StudyKeys, folder: Path) -> StudyKeys:
    """Return the keys with the paths of files in them, which are relative to the file's folder."""

    def located(place: KeyPath, name: str, candidates: Sequence[str]) -> str:
        file = folder / name
        if name in candidates:
            return name
        if not file.exists():
            hint = nearest_or_all(name, candidates, "built in are")
            raise StudyKeyError(place, f"there is no file {file}{hint}")
        return str(file)

    scenarios: list[str | Mapping[str, Any]] = []
    for number, (label, names) in enumerate(labelled_scenarios(keys.scenarios)):
        place: KeyPath = ("scenarios", number)
        if label:
            own = [
                located((*place, "scenarios", n), name, builtin_names())
                for n, name in enumerate(names)
            ]
            scenarios.append({"label": label, "scenarios": own})
        else:
            scenarios += [located(place, name, builtin_names()) for name in names]
    candidates = (*Task.names(), *builtin_names())
    tasks = None if keys.tasks is None else several("tasks", keys.tasks)
    return replace(
        keys,
        scenarios=scenarios,
        system=None if keys.system is None else str(folder / keys.system),
        tasks=tasks and [located(("tasks", n), name, candidates) for n, name in enumerate(tasks)],
        policies=tuple(_policies_beside(each, folder) for each in listed(keys.policies)),
    )


def _policies_beside(policies: Policies, folder: Path) -> Policies:
    if isinstance(policies, str):
        return policy_beside(policies, folder)
    return {
        agent: {each: policy_beside(own, folder) for each, own in name.items()}
        if isinstance(name, Mapping)
        else policy_beside(name, folder)
        for agent, name in policies.items()
    }


def _words(fault: FormError) -> str:
    """Return what is wrong with the value of a key."""
    if fault.kind == "type":
        return f"expected {wanted_form(fault.path, StudyKeys)}, got {quoted(fault.part)}"
    return f"{fault.what}{fault.hint}"
