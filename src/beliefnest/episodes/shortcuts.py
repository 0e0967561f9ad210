"""Shortcuts of a task: rules without any belief about others, with which its maker can be fooled.

A task of order 1 or more should leave them at chance: at the rate of a rule that draws among the
same places.
"""

import random
from collections.abc import Callable, Sequence

from beliefnest.episodes.policies.rules import linear_key
from beliefnest.episodes.task import Task
from beliefnest.episodes.trials import wins_of

_CHANCE = "any"
"""Key of the rule that draws among the places."""
_KEYS = ("nearest", "farthest", "first", "last", "last-seen", "copy", _CHANCE)
_MOST_OTHERS = 2
_FIXED_FEATURES = 4
"""Features of a place besides its distances from agents."""


def rules_of(task: Task, keys: Sequence[str] = ()) -> tuple[str, ...]:
    """Return the rules by which policies play a task, the one at chance level last.

    Players that may speak say one thing, everything, or nothing, and then plan as `search:0` does.
    Other players choose where to take, to put, to switch and to go.

    Args:
        task: The task.
        keys: Keys of places; empty: all keys, also for the distances from agents of the task.
    """
    others = [name for name in task.agents if name not in task.players][:_MOST_OTHERS]
    apart = [f"{far}-{name}" for name in others for far in ("nearest", "farthest")]
    chosen = list(keys) or [*apart, *_KEYS]
    if set(task.players) & set(task.form.speakers):
        silent = [] if keys else [f"{_CHANCE}+plan", f"{_CHANCE}+plan:tell-all"]
        names = [*silent, *(f"{key}+plan:tell" for key in chosen if key != "copy")]
    elif any(each.fact.store is not None for each in task.goal.reach):
        further = [] if keys else [f"{key}+nearest" for key in chosen if key != "nearest"]
        names = [*further, *(f"nearest+{key}" for key in chosen)]
    else:
        names = chosen
    return tuple(names)


def policy_of(rule: str) -> str:
    """Return the name of the policy that follows a rule."""
    return f"rule:{rule}"


def trained_rule(load: Callable[[int], Task], seeds: Sequence[int], tries: int = 16) -> str:
    """Return the best of random linear rules over the features of places.

    Args:
        load: Function that returns the instance of a seed.
        seeds: Instances on which the rules are tried; leave them out of what you report.
        tries: Number of rules that are tried.
    """
    task, chance = load(seeds[0]), random.Random("linear rules")
    size = len(task.agents) + _FIXED_FEATURES
    weights = [[chance.gauss(0, 1) for _ in range(size)] for _ in range(tries)]
    rules = [rules_of(task, [linear_key(each)])[-1] for each in weights]
    won = wins_of(load, [policy_of(each) for each in rules], seeds)
    return rules[won.index(max(won))]
