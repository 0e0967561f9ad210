"""Belief paths: `/` is the real world, `/a/b` is what a believes that b believes."""

from collections.abc import Collection, Iterable

from beliefnest.errors import PathError
from beliefnest.world.texts import quoted

BeliefPath = tuple[str, ...]
"""Agent names, the outermost believer first. The empty path is the real world."""

AND_BELOW = "**"
"""Last part of a path pattern. It means the node and everything below it; alone it means every
belief."""

_DEEPEST = 50
"""Greatest number of names in a path. Each name adds a state, which is computed from those
before it."""


def parse_path(text: str, agents: Collection[str]) -> BeliefPath:
    """Return the agent names of a path, normalised.

    Raises:
        PathError: The text is not a path, names an unknown agent, or is too deep.
    """
    return _parsed(text, text, agents)


def _parsed(text: str, written: str, agents: Collection[str]) -> BeliefPath:
    """Parse a path; `written` is the text that messages quote."""
    if not isinstance(text, str) or not text.startswith("/"):
        raise PathError(f"{quoted(written)} is not a belief path; write '/' or '/agent/agent'")
    if text == "/":
        return ()
    names = text[1:].removesuffix("/").split("/")
    if "" in names:
        raise PathError(f"{quoted(written)} is not a belief path: a name between slashes is empty")
    for name in names:
        if name not in agents:
            there = ", ".join(sorted(agents))
            raise PathError(
                f"{quoted(written)} names an unknown agent {quoted(name)}; agents are {there}"
            )
    return normalised(names)


def parse_pattern(text: str, agents: Collection[str]) -> BeliefPath:
    """Parse a path that may end in `/**`; the result then ends in `**`.

    Raises:
        PathError: As for `parse_path`.
    """
    if not isinstance(text, str) or AND_BELOW not in text.split("/"):
        return parse_path(text, agents)
    above = text.removesuffix(f"/{AND_BELOW}")
    if above == text or AND_BELOW in above.split("/"):
        raise PathError(
            f"{quoted(text)} is not a belief path: '/{AND_BELOW}' may only stand at its end, once"
        )
    return (*_parsed(above or "/", text, agents), AND_BELOW)


def normalised(names: Iterable[str]) -> BeliefPath:
    """Collapse equal neighbours, because an agent knows its own beliefs.

    Raises:
        PathError: The path is too deep.
    """
    path: list[str] = []
    for name in names:
        if not path or path[-1] != name:
            path.append(name)
    if len(path) > _DEEPEST:
        short = quoted(path_text(path))
        raise PathError(f"{short} is {len(path)} beliefs deep; at most {_DEEPEST} are possible")
    return tuple(path)


def path_text(path: Iterable[str]) -> str:
    """Return a path as text."""
    return "/" + "/".join(path)


def paths_below(root: BeliefPath, depth: int, agents: Iterable[str]) -> list[BeliefPath]:
    """Return a path and all paths with up to `depth` more agents, short ones first."""
    names = tuple(agents)
    paths = level = [root]
    for _ in range(depth):
        level = [(*path, name) for path in level for name in names if path[-1:] != (name,)]
        paths = paths + level
    return paths
