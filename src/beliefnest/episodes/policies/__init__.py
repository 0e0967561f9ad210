"""Policies, which decide what agents do."""

import difflib
import os
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import parse_qsl, urlencode

from beliefnest.episodes.agent_view import Policy
from beliefnest.episodes.policies.simple import Person, Program, Random, Scripted
from beliefnest.errors import InputError, UnknownNameError
from beliefnest.files import read_regular_text
from beliefnest.importing import (
    installed,
    installed_names,
    is_object_name,
    made_object,
    text_of_object,
)
from beliefnest.llm.model_settings import ModelSettings
from beliefnest.world.texts import quoted
from beliefnest.world.words import listed

if TYPE_CHECKING:  # Models take long to import, and few policies ask one.
    from beliefnest.llm.resolve import Connection

__all__ = [
    "POLICIES",
    "Person",
    "Program",
    "Random",
    "Scripted",
    "draws_by_seed",
    "file_of_policy",
    "is_own_policy",
    "is_program",
    "policy_beside",
    "policy_of_file",
    "resolve_policy",
    "text_of_policy",
    "with_query",
]

POLICIES = (
    "search:ORDER",
    "infer:ORDER",
    "omniscient:search",
    "model:MODEL:ORDER",
    "model:MODEL:omniscient",
    "model:MODEL:ORDER?SETTING=VALUE&...",
    "random",
    "rule:NAME",
    "program:FILE",
    "scripted:FILE",
    "person",
    "person:wait",
    "MODULE:CLASS",
    "FILE.py:CLASS",
)
"""Forms of the names that `resolve_policy` accepts."""

_GROUP = "beliefnest.policies"
"""Group of entry points, each of which names a class or function that makes a policy."""

_HIGHEST = 4
_READ = ("program", "scripted")
"""Policies that are read from files."""
_KINDS = frozenset(form.partition(":")[0] for form in POLICIES) - {"MODULE", "FILE.py"}
"""Words before the colon that are no names of modules."""


def resolve_policy(
    name: str, environment: Mapping[str, str] | None = None, connection: "Connection | None" = None
) -> Policy:
    """Return the policy of a name.

    Args:
        name: Name in one of the forms of `POLICIES`. In a file of `scripted`, lines of `---`
            separate the programs. A model is `offline` or `PROVIDER:NAME`; its settings are those
            of `ModelSettings`, where `system` is a file. A class of one's own, or a function that
            makes a policy, is called without arguments; an installed package may name it by an
            entry point of the group `beliefnest.policies`.
        environment: Variables with keys and base URLs of models; None: those of the process.
        connection: Connection to models; None: retries and limits only.

    Raises:
        UnknownNameError: The policy does not exist.
        InputError: The text after the colon is not valid.
    """
    kind, _, rest = name.partition(":")
    match kind:
        case "program" | "scripted" if rest:
            text = _text(rest)
            return Program(text) if kind == "program" else Scripted(_programs(text))
        case "model" if rest:
            return _model(
                rest, name, os.environ if environment is None else environment, connection
            )
        case "rule" if rest:
            from beliefnest.episodes.policies.rules import rule_of

            return rule_of(rest)
        case "search" | "infer" if rest:
            return _planning(kind, order_of(rest, name))
    if name in _WITHOUT_OPTIONS:
        return _WITHOUT_OPTIONS[name]()
    if is_own_policy(name):
        policy: Policy = made_object(
            name, _GROUP, "policy", "act", "(view), which returns a program"
        )
        return policy
    named = (*POLICIES, *(each for each in installed_names(_GROUP) if each not in _KINDS))
    kinds = {form.partition(":")[0] for form in named} - {"MODULE", "FILE.py"}
    near = difflib.get_close_matches(kind, sorted(kinds), n=1)  # A kind is nearest to itself.
    forms = [form for form in named if form.partition(":")[0] in near] or named
    is_slip = bool(rest) and near != [kind] and bool(near)
    hint = f"did you mean {near[0]}:{rest}?" if is_slip else f"write {listed(forms, 'or')}"
    raise UnknownNameError(f"there is no policy {quoted(name)}; {hint}")


def _omniscient() -> Policy:
    from beliefnest.episodes.policies.search import Omniscient

    return Omniscient()


_WITHOUT_OPTIONS: Mapping[str, Callable[[], Policy]] = {
    "random": Random,
    "person": Person,
    "person:wait": lambda: Person(is_awaited=True),
    "omniscient:search": _omniscient,
}


def _planning(kind: str, order: int) -> Policy:
    if kind == "infer":
        from beliefnest.episodes.policies.infer import Infer

        return Infer(order)
    from beliefnest.episodes.policies.search import Search

    return Search(order)


def is_own_policy(name: str) -> bool:
    """Return True if a policy is a Python object that a user names: code that would be imported."""
    if name.partition(":")[0] in _KINDS:
        return False
    return is_object_name(name) or installed(_GROUP, name) is not None


def draws_by_seed(name: str) -> bool:
    """Return True if a policy itself draws random numbers, apart from those of its programs.

    Args:
        name: Name, as for `resolve_policy`.
    """
    kind, _, rest = name.partition(":")
    if kind == "model":
        from beliefnest.llm.resolve import can_vary

        return can_vary(rest)
    if kind == "rule":
        return "any" in rest
    return kind not in ("search", "infer", "omniscient", *_READ)


def text_of_policy(name: str) -> str:
    """Return the text of a policy's file; empty if it has no file.

    Raises:
        InputError: The file cannot be read.
    """
    if is_own_policy(name):
        entry = installed(_GROUP, name)
        return text_of_object(name if entry is None else entry.value)
    file = _system_file(name)
    if file:
        return ModelSettings.of_file(file).system or ""
    return _text(name.partition(":")[2]) if is_program(name) else ""


def with_query(name: str, query: str) -> str:
    """Return the name of a policy with settings of requests; only models have such settings.

    Args:
        name: Name of a policy. Settings in it count before others.
        query: Settings, as in the names of policies after `?`; empty: none.
    """
    if not query or not name.startswith("model:"):
        return name
    plain, _, own = name.partition("?")
    return f"{plain}?{query}&{own}" if own else f"{plain}?{query}"


def _system_file(name: str) -> str:
    """Return the file of a system message in the name of a policy; empty if it names none."""
    if not name.startswith("model:"):
        return ""
    return dict(parse_qsl(name.partition("?")[2])).get("system", "")


def is_program(name: str) -> bool:
    """Return True if a policy plays programs of a file."""
    kind, _, file = name.partition(":")
    return kind in _READ and bool(file)


def policy_beside(name: str, folder: Path) -> str:
    """Return the name of a policy; if it has a file, look for a relative path in `folder`."""
    file = file_of_policy(name)
    return policy_of_file(name, folder / file) if file else name


def file_of_policy(name: str) -> str:
    """Return the file in the name of a policy; empty if it names none."""
    if is_own_policy(name):
        file = name.rpartition(":")[0]
        return file if file.endswith(".py") else ""
    return _system_file(name) or (name.partition(":")[2] if is_program(name) else "")


def policy_of_file(name: str, file: Path) -> str:
    """Return the name of a policy with another file in it."""
    if is_own_policy(name):
        return f"{file}:{name.rpartition(':')[2]}"
    if _system_file(name):
        plain, _, query = name.partition("?")
        return f"{plain}?{urlencode({**dict(parse_qsl(query)), 'system': str(file)}, safe='/.')}"
    return f"{name.partition(':')[0]}:{file}"


def _model(
    rest: str, name: str, environment: Mapping[str, str], connection: "Connection | None"
) -> Policy:
    from beliefnest.episodes.policies.model import ModelPolicy, OmniscientModelPolicy
    from beliefnest.llm.resolve import Connection, open_model

    plain, _, query = rest.partition("?")
    try:
        settings = ModelSettings.of_query(query)
    except InputError as error:
        raise InputError(f"{quoted(name)}: {error}") from None
    if settings.answer != "text":
        raise InputError(f"{quoted(name)}: policies answer with programs; leave out `answer`")
    model_name, colon, order = plain.rpartition(":")
    if not colon:
        raise InputError(f"{quoted(name)} is not complete; give model:MODEL:ORDER")
    number = 2 if order == "omniscient" else order_of(order, name)
    limited = connection or Connection()
    if query:
        limited = replace(limited, answer_limits=settings.answer_limits)
    model = open_model(model_name, environment, limited)
    kind = OmniscientModelPolicy if order == "omniscient" else ModelPolicy
    return kind(model, number, settings=settings)


def order_of(text: str, name: str) -> int:
    """Return the order of Theory of Mind in a policy's name.

    Raises:
        InputError: The text is no order.
    """
    if not text.isdecimal() or len(text) > 9 or int(text) > _HIGHEST:
        raise InputError(f"{quoted(text)} in {quoted(name)} is no order; give 0 to {_HIGHEST}")
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
