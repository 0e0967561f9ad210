"""Policies, which decide what agents do."""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from beliefnest.episodes.agent_view import Policy
from beliefnest.episodes.policies.simple import Person, Program, Random, Scripted
from beliefnest.errors import InputError, UnknownNameError
from beliefnest.files import read_regular_text

if TYPE_CHECKING:  # Models take long to import, and few policies ask one.
    from beliefnest.llm.resolve import Connection

__all__ = [
    "POLICIES",
    "Person",
    "Program",
    "Random",
    "Scripted",
    "draws_by_seed",
    "policy_beside",
    "resolve_policy",
    "text_of_policy",
]

POLICIES = (
    "search:ORDER",
    "infer:ORDER",
    "omniscient:search",
    "model:MODEL:ORDER",
    "model:MODEL:omniscient",
    "random",
    "program:FILE",
    "scripted:FILE",
    "person",
    "person:wait",
)
"""Forms of the names that `resolve_policy` accepts."""

_HIGHEST = 4
_READ = ("program", "scripted")
"""Policies that are read from files."""


def resolve_policy(
    name: str,
    environment: Mapping[str, str] | None = None,
    connection: "Connection | None" = None,
) -> Policy:
    """Return the policy of a name.

    Args:
        name: Name in one of the forms of `POLICIES`. In a file of `scripted`, lines of `---`
            separate the programs. A model is `offline` or `PROVIDER:NAME`.
        environment: Variables with keys and base URLs of models; None: those of the process.
        connection: Connection to models; None: retries and limits only.

    Raises:
        UnknownNameError: The policy does not exist.
        InputError: The text after the colon is not valid.
    """
    kind, _, rest = name.partition(":")
    match kind:
        case "random" if not rest:
            return Random()
        case "person" if rest in ("", "wait"):
            return Person(is_awaited=rest == "wait")
        case "program" | "scripted" if rest:
            text = _text(rest)
            return Program(text) if kind == "program" else Scripted(_programs(text))
        case "model" if rest:
            return _model(
                rest, name, os.environ if environment is None else environment, connection
            )
        case "search" | "infer" if rest:
            return _planning(kind, order_of(rest, name))
        case "omniscient" if rest == "search":
            from beliefnest.episodes.policies.search import Omniscient

            return Omniscient()
    raise UnknownNameError(f"there is no policy {name!r}; give one of {', '.join(POLICIES)}")


def _planning(kind: str, order: int) -> Policy:
    if kind == "infer":
        from beliefnest.episodes.policies.infer import Infer

        return Infer(order)
    from beliefnest.episodes.policies.search import Search

    return Search(order)


def draws_by_seed(name: str) -> bool:
    """Return True if a policy itself draws random numbers, apart from those of its programs.

    Args:
        name: Name, as for `resolve_policy`.
    """
    kind, _, rest = name.partition(":")
    if kind == "model":
        from beliefnest.llm.resolve import is_of_provider

        return is_of_provider(rest)
    return kind not in ("search", "infer", "omniscient", *_READ)


def text_of_policy(name: str) -> str:
    """Return the text of a policy's file; empty if it has no file.

    Raises:
        InputError: The file cannot be read.
    """
    kind, _, file = name.partition(":")
    return _text(file) if kind in _READ and file else ""


def policy_beside(name: str, folder: Path) -> str:
    """Return the name of a policy; if it has a file, look for a relative path in `folder`."""
    kind, colon, file = name.partition(":")
    return f"{kind}:{folder / file}" if kind in _READ and colon else name


def _model(
    rest: str, name: str, environment: Mapping[str, str], connection: "Connection | None"
) -> Policy:
    from beliefnest.episodes.policies.model import ModelPolicy, OmniscientModelPolicy
    from beliefnest.llm.resolve import Connection, open_model

    model_name, colon, order = rest.rpartition(":")
    if not colon:
        raise InputError(f"{name!r} is not complete; give model:MODEL:ORDER")
    number = 2 if order == "omniscient" else order_of(order, name)
    model = open_model(model_name, environment, connection or Connection())
    return (OmniscientModelPolicy if order == "omniscient" else ModelPolicy)(model, number)


def order_of(text: str, name: str) -> int:
    """Return the order of Theory of Mind in a policy's name.

    Raises:
        InputError: The text is no order.
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
