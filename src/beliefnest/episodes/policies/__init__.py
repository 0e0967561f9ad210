"""Policies: who decides what agents do."""

import os
from collections.abc import Mapping
from pathlib import Path

from beliefnest.episodes.policies.simple import Program, Random, Scripted
from beliefnest.episodes.view import Policy
from beliefnest.errors import InputError, UnknownNameError
from beliefnest.files import read_regular_text

__all__ = ["POLICIES", "Program", "Random", "Scripted", "resolve_policy"]

POLICIES = (
    "search:ORDER",
    "omniscient:search",
    "model:MODEL:ORDER",
    "model:MODEL:omniscient",
    "random",
    "program:FILE",
    "scripted:FILE",
)
"""The forms of names that `resolve_policy` takes."""

_HIGHEST = 4


def resolve_policy(name: str, environment: Mapping[str, str] | None = None) -> Policy:
    """The policy of a name.

    Args:
        name: As in `POLICIES`. A file of `scripted` has programs between lines of `---`; a model is
            `offline` or `PROVIDER:NAME`.
        environment: Holds keys and base URLs of models; None: that of the process.

    Raises:
        UnknownNameError: There is no such policy.
        InputError: What stands behind the colon is of no use.
    """
    kind, _, rest = name.partition(":")
    match kind:
        case "random" if not rest:
            return Random()
        case "program" | "scripted" if rest:
            text = _text(rest)
            return Program(text) if kind == "program" else Scripted(_programs(text))
        case "model" if rest:
            return _model(rest, name, os.environ if environment is None else environment)
        case "search" if rest:
            from beliefnest.episodes.policies.search import Search

            return Search(order_of(rest, name))
        case "omniscient" if rest == "search":
            from beliefnest.episodes.policies.search import Omniscient

            return Omniscient()
    raise UnknownNameError(f"no policy {name!r}; write one of {', '.join(POLICIES)}")


def _model(rest: str, name: str, environment: Mapping[str, str]) -> Policy:
    from beliefnest.episodes.policies.model import ModelPolicy, OmniscientModelPolicy
    from beliefnest.llm.resolve import Connection, open_model

    model_name, colon, order = rest.rpartition(":")
    if not colon:
        raise InputError(f"{name!r} is not complete; write model:MODEL:ORDER")
    if order == "omniscient":
        return OmniscientModelPolicy(open_model(model_name, environment, Connection()), 2)
    number = order_of(order, name)
    return ModelPolicy(open_model(model_name, environment, Connection()), number)


def order_of(text: str, name: str) -> int:
    """The order of Theory of Mind in a policy's name.

    Raises:
        InputError: It is none.
    """
    if not text.isdecimal() or int(text) > _HIGHEST:
        raise InputError(f"{text!r} in {name!r} is no order; give 0 to {_HIGHEST}")
    return int(text)


def _programs(text: str) -> tuple[str, ...]:
    parts: list[list[str]] = [[]]
    for line in text.splitlines():
        if line.strip() == "---":
            parts.append([])
        else:
            parts[-1].append(line)
    return tuple("\n".join(lines).strip() for lines in parts)


def _text(file: str) -> str:
    try:
        return read_regular_text(Path(file))
    except (OSError, ValueError) as error:
        raise InputError(f"the program {file} cannot be read: {error}") from None
