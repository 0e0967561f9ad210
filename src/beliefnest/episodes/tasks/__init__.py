"""Built-in tasks; each module generates instances of a task from a seed."""

import importlib
import inspect
import random
from collections.abc import Mapping
from typing import Any

from beliefnest.errors import InputError, UnknownNameError
from beliefnest.world.texts import quoted

__all__ = ["builtin_tasks", "generated", "parameters_of"]

_TASKS: Mapping[str, str] = {
    "blueprint": "blueprint",
    "help-find": "help_find",
    "hide-and-seek": "hide_and_seek",
    "joint-lift": "joint_lift",
    "kitchen": "kitchen",
    "recipe": "recipe",
    "tell-what-is-needed": "tell_what_is_needed",
    "watch-and-help": "watch_and_help",
    "watchman": "watchman",
    "what-happened-here": "what_happened_here",
    "whom-to-trust": "whom_to_trust",
}


def builtin_tasks() -> Mapping[str, str]:
    """Return the names of the tasks' modules, by name of the task."""
    return _TASKS


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
    return importlib.import_module(f"beliefnest.episodes.tasks.{_TASKS[name]}")
