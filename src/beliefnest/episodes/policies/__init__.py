"""Policies: who decides what agents do."""

from pathlib import Path

from beliefnest.episodes.policies.simple import Program, Random, Scripted
from beliefnest.episodes.view import Policy
from beliefnest.errors import InputError, UnknownNameError
from beliefnest.files import read_regular_text

__all__ = ["POLICIES", "Program", "Random", "Scripted", "resolve_policy"]

POLICIES = (
    "search:ORDER",
    "omniscient:search",
    "random",
    "program:FILE",
    "scripted:FILE",
)
"""The forms of names that `resolve_policy` takes."""

_HIGHEST = 4


def resolve_policy(name: str) -> Policy:
    """The policy of a name.

    Args:
        name: As in `POLICIES`. A file of `scripted` has programs between lines of `---`.

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
        case "search" if rest:
            from beliefnest.episodes.policies.search import Search

            return Search(order_of(rest, name))
        case "omniscient" if rest == "search":
            from beliefnest.episodes.policies.search import Omniscient

            return Omniscient()
    raise UnknownNameError(f"no policy {name!r}; write one of {', '.join(POLICIES)}")


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
