"""The built-in tasks: each a generator of instances from a seed."""

import importlib
import inspect
import random
from collections.abc import Mapping
from typing import Any

from beliefnest.errors import InputError, UnknownNameError

__all__ = ["builtin_tasks", "generated", "parameters_of"]

_TASKS: Mapping[str, str] = {
    "blueprint": "blueprint",
    "help-find": "help_find",
    "hide-and-seek": "hide_and_seek",
    "joint-lift": "joint_lift",
    "kitchen": "kitchen",
    "recipe": "recipe",
    "tell-what-is-needed": "tell_what_is_needed",
    "watchman": "watchman",
}


def builtin_tasks() -> Mapping[str, str]:
    """Return the name of each task to the name of its module here."""
    return _TASKS


def parameters_of(name: str) -> Mapping[str, tuple[int, int, int]]:
    """Parameters of a task: name to default, least and greatest value."""
    ranges: Mapping[str, tuple[int, int, int]] = _module(name).PARAMETERS
    return ranges


def generated(name: str, seed: int, parameters: Mapping[str, int]) -> dict[str, Any]:
    """Return an instance of a task, as plain values.

    Args:
        name: The task.
        seed: Which instance.
        parameters: Its size; what is not given has its default.

    Raises:
        UnknownNameError: It has no such parameter.
        InputError: A parameter is out of range.
    """
    ranges = parameters_of(name)
    for key, value in parameters.items():
        if key not in ranges:
            there = ", ".join(ranges) or "none"
            raise UnknownNameError(f"task {name} has no parameter {key!r}; it has {there}")
        _, low, high = ranges[key]
        if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
            raise InputError(f"{key} of task {name} is {value!r}; give {low} to {high}")
    values = {key: parameters.get(key, default) for key, (default, _, _) in ranges.items()}
    chance = random.Random(f"{name} {seed}")
    content: dict[str, Any] = _module(name).instance(chance, **values)
    return {"name": name, **content}


def source_of(name: str) -> str:
    """What a task says of itself: its source in the literature, and what is in it."""
    return inspect.cleandoc(_module(name).__doc__ or "")


def _module(name: str) -> Any:
    return importlib.import_module(f"beliefnest.episodes.tasks.{_TASKS[name]}")
