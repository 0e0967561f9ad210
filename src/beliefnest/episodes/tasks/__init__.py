"""Tasks by name; the module of each generates instances of it from a seed."""

import inspect
import random
from collections.abc import Mapping
from typing import Any

from beliefnest.errors import InputError, UnknownNameError
from beliefnest.importing import installed, installed_names, load, told_entry
from beliefnest.world.texts import quoted

__all__ = ["generated", "is_task", "parameters_of", "task_names"]

_GROUP = "beliefnest.tasks"
"""Group of entry points by name of the task: modules with `PARAMETERS` and `instance`."""


def task_names() -> tuple[str, ...]:
    """Return the names of the installed tasks, those of this package first."""
    return installed_names(_GROUP)


def is_task(name: str) -> bool:
    """Return True if there is an installed task of a name."""
    return installed(_GROUP, name) is not None


def parameters_of(name: str) -> Mapping[str, tuple[int, int, int]]:
    """Return default, least and greatest value of each parameter of a task."""
    ranges: Mapping[str, tuple[int, int, int]] = _module(name).PARAMETERS
    return ranges


def generated(name: str, seed: int, parameters: Mapping[str, int]) -> dict[str, Any]:
    """Return an instance of a task, as plain values.

    Args:
        name: Name of the task.
        seed: Number of the instance.
        parameters: Values of parameters; the others have their defaults.

    Raises:
        UnknownNameError: A parameter does not exist.
        InputError: A parameter is out of range.
    """
    ranges = parameters_of(name)
    for key, value in parameters.items():
        if key not in ranges:
            there = ", ".join(ranges) or "none"
            raise UnknownNameError(f"task {name} has no parameter {quoted(key)}; it has {there}")
        _, low, high = ranges[key]
        if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
            raise InputError(f"{key} of task {name} is {quoted(value)}; give {low} to {high}")
    values = {key: parameters.get(key, default) for key, (default, _, _) in ranges.items()}
    chance = random.Random(f"{name} {seed}")
    content: dict[str, Any] = _module(name).instance(chance, **values)
    return {"name": name, **content}


def source_of(name: str) -> str:
    """Return the description of a task: its source in the literature, and its setting."""
    return inspect.cleandoc(_module(name).__doc__ or "")


def _module(name: str) -> Any:
    entry = installed(_GROUP, name)
    if entry is None:
        raise UnknownNameError(
            f"there is no task {quoted(name)}; there are {', '.join(task_names())}"
        )
    task = load(entry, "task")
    for part in ("PARAMETERS", "instance"):
        if not hasattr(task, part):
            raise InputError(f"{told_entry(entry, 'task')} has no {part}; see docs/plugins.md")
    return task
