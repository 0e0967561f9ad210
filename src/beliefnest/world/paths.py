"""Belief paths: `/` is the real world, `/a/b` is what a believes that b believes."""

from collections.abc import Collection, Iterable

from beliefnest.errors import PathError

__all__ = [
    "AND_BELOW",
    "BeliefPath",
    "normalised",
    "parse_path",
    "parse_pattern",
    "path_text",
    "paths_below",
]

BeliefPath = tuple[str, ...]
"""Agent names, the outermost believer first; empty: the real world."""

AND_BELOW = "**"
"""At the end of a path: the node and everything below it; alone: every belief."""

_LONGEST_TOLD = 100

_DEEPEST = 50
"""Names in a path: each is a state of its own, computed with all before it."""


def parse_path(text: str, agents: Collection[str]) -> BeliefPath:
    """Return the agent names of a path, normalised.

    Raises:
        PathError: The text is no path, names an agent that there is not, or is too deep.
    """
    return _parsed(text, text, agents)


def _parsed(text: str, written: str, agents: Collection[str]) -> BeliefPath:
    """Return the agent names of a path that is a part of what messages show."""
    if not isinstance(text, str) or not text.startswith("/"):
        raise PathError(f"{_short(written)} is no belief path; write '/' or '/agent/agent'")
    if text == "/":
        return ()
    names = text[1:].removesuffix("/").split("/")
    if "" in names:
        raise PathError(f"{_short(written)} is no belief path: a name between slashes is empty")
    for name in names:
        if name not in agents:
            there = ", ".join(sorted(agents))
            raise PathError(f"{_short(written)} names {_short(name)}; the agents are {there}")
    return normalised(names)


def parse_pattern(text: str, agents: Collection[str]) -> BeliefPath:
    """Return a path that may end in `/**`, which then is the last of the names.

    Raises:
        PathError: As for `parse_path`.
    """
    if not isinstance(text, str) or AND_BELOW not in text.split("/"):
        return parse_path(text, agents)
    above = text.removesuffix(f"/{AND_BELOW}")
    if above == text or AND_BELOW in above.split("/"):
        raise PathError(
            f"{_short(text)} is no belief path: '/{AND_BELOW}' stands at the end of one alone"
        )
    return (*_parsed(above or "/", text, agents), AND_BELOW)


def normalised(names: Iterable[str]) -> BeliefPath:
    """Return the path with equal neighbours collapsed: an agent knows its own beliefs.

    Raises:
        PathError: It is too deep.
    """
    path: list[str] = []
    for name in names:
        if not path or path[-1] != name:
            path.append(name)
    if len(path) > _DEEPEST:
        short = _short(path_text(path))
        raise PathError(f"{short} is {len(path)} beliefs deep; {_DEEPEST} are possible")
    return tuple(path)


def path_text(path: Iterable[str]) -> str:
    """Return the text of a path."""
    return "/" + "/".join(path)


def paths_below(root: BeliefPath, depth: int, agents: Iterable[str]) -> list[BeliefPath]:
    """Return a path and all below it, down to `depth` more agents, shallow ones first."""
    names = tuple(agents)
    found = level = [root]
    for _ in range(depth):
        level = [(*path, name) for path in level for name in names if path[-1:] != (name,)]
        found = found + level
    return found


def _short(text: object) -> str:
    """Return a text in a message, its beginning if it is long."""
    written = repr(text)
    return written if len(written) <= _LONGEST_TOLD else f"{written[:_LONGEST_TOLD]}..."
