"""YAML files of studies."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import msgspec
from msgspec.structs import replace

from beliefnest.episodes.policies import policy_beside
from beliefnest.episodes.task import Task
from beliefnest.errors import ScenarioError
from beliefnest.scenarios.document import Document, plain
from beliefnest.scenarios.sources import builtin_names
from beliefnest.scenarios.yaml_reading import read_yaml
from beliefnest.studies.checking import StudyKeyError, several
from beliefnest.studies.design import Design, template_named
from beliefnest.studies.episode_design import EpisodeDesign, Policies, listed
from beliefnest.studies.study_keys import StudyKeys, design_of, labelled_scenarios
from beliefnest.world.words import nearest_or_all
from beliefnest.worlds.names import check_world


def read_design(path: Path, instead: Mapping[str, Any] | None = None) -> Design | EpisodeDesign:
    """Return the design in a YAML file; paths in the file are relative to its folder.

    Args:
        path: The file.
        instead: Values of keys in place of those of the file, with paths as given; None: none.

    Raises:
        ScenarioError: The file is wrong; the message names file, line and key.
    """
    document = read_yaml(path)
    if {"agents", "map"} & document.root.value.keys():
        raise ScenarioError(
            f"{path} is a scenario, no study; write a study file with `scenarios: [{path.name}]`"
        )
    try:
        keys = msgspec.convert(plain(document.root), StudyKeys)
    except msgspec.ValidationError as error:
        raise _fault(document, str(error)) from None
    if keys.world is not None:
        with document.naming(("world",)):
            check_world(keys.world, servers=False)
    with document.naming(("templates",)):
        names = several("templates", keys.templates or ())
        templates = tuple(template_named(name, path.parent) for name in names)
    try:
        constraints = several("constraints", keys.constraints)
        beside = _beside(keys, path)
        return design_of(
            replace(beside, **(instead or {})),
            templates,
            constraints,
        )
    except StudyKeyError as fault:
        raise document.fault(fault.path, str(fault)) from None


def _beside(keys: StudyKeys, path: Path) -> StudyKeys:
    """Return the keys with the paths of files in them, which are relative to the file's folder."""

    def located(key: str, names: object, known: Sequence[str]) -> tuple[str, ...]:
        return tuple(
            name if name in known else str(path.parent / name) for name in several(key, names)
        )

    known = (*Task.names(), *builtin_names())
    return replace(
        keys,
        scenarios=[
            {"label": label, "scenarios": names} if label else names[0]
            for label, names in (
                (label, located("scenarios", names, builtin_names()))
                for label, names in labelled_scenarios(keys.scenarios)
            )
        ],
        system=None if keys.system is None else str(path.parent / keys.system),
        tasks=None if keys.tasks is None else located("tasks", keys.tasks, known),
        policies=tuple(_policies_beside(each, path.parent) for each in listed(keys.policies)),
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


def _fault(document: Document, error: str) -> ScenarioError:
    what, _, place = error.partition(" - at `$.")
    key = place.rstrip("`").partition("[")[0].partition(".")[0]
    if what.startswith("Object contains unknown field"):
        key = what.split("`")[1]
        what = f"unknown key{nearest_or_all(key, StudyKeys.__struct_fields__)}"
    what = what[:1].lower() + what[1:].replace("`", "'")
    return document.fault((key,) if key else (), what)
