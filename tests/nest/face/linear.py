"""A plain model of a nest with branches: a history is the list of acts that lead to it.

What a branch holds is told by a nest in memory in which these acts are done one after the other,
and which never switches back, forks from the past, deletes or is resumed. Nothing of how branches
are kept or restored is used.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

import beliefnest as bn
from beliefnest.timeline.journal import FOLLOW

Act = Callable[[bn.Nest], None]
MAIN = "main"


@dataclass(eq=False)
class Branch:
    """One timeline; `acts` are its own, each with the tick it ended at."""

    path: str
    name: str
    base: "tuple[Branch, int, int] | None" = None
    start: int = 0
    head: int = 0
    acts: list[tuple[int, Act]] = field(default_factory=list)
    description: str = ""

    def until(self, tick: int) -> int:
        """Return the number of its acts that had ended at a tick."""
        return sum(ended <= tick for ended, _ in self.acts)

    def lies_in(self, other: "Branch") -> bool:
        """Return True if it is another one, or rests on it."""
        return self is other or (self.base is not None and self.base[0].lies_in(other))


class LinearModel:
    """Branches of all simulators, and which each of them is on.

    Args:
        opened: Makes the nest in which everything begins.
    """

    def __init__(self, opened: Callable[[], bn.Nest]) -> None:
        self._opened = opened
        self.branches = [Branch("/", MAIN)]
        self.selected = {"/": self.branches[0]}

    def find(self, path: str, name: str) -> Branch | None:
        """Return the branch of a name."""
        return next((b for b in self.branches if (b.path, b.name) == (path, name)), None)

    def controller(self, path: str) -> Branch:
        """Return the branch that a simulator's state comes from."""
        while path not in self.selected:
            path = path.rpartition("/")[0] or "/"
        return self.selected[path]

    def of(self, path: str) -> list[tuple[str, tuple[str, str, int] | None, int, int, str]]:
        """All that is told of a simulator's own branches."""
        return [
            (
                b.name,
                None if b.base is None else (b.base[0].path, b.base[0].name, b.base[2]),
                b.start,
                b.head,
                b.description,
            )
            for b in self.branches
            if b.path == path
        ]

    def place_of(self, branch: Branch, tick: int) -> tuple[Branch, int, int]:
        """Branch, number of its acts, and tick, of a tick in the past of a branch."""
        while tick < branch.start:
            assert branch.base is not None
            branch = branch.base[0]
        return branch, branch.until(tick), tick

    @contextmanager
    def nest(self, branch: Branch, acts: int | None = None) -> Iterator[bn.Nest]:
        """Make a nest and repeat in it, one by one, the acts that led to a place on a branch."""
        with self._opened() as nest:
            self._lead(nest, branch, len(branch.acts) if acts is None else acts)
            yield nest

    def _lead(self, nest: bn.Nest, branch: Branch, acts: int) -> None:
        if branch.base is not None:
            base, before, _ = branch.base
            self._lead(nest, base, before)
            if base.path != branch.path:
                nest[branch.path].switch("fork")
        for _, act in branch.acts[:acts]:
            act(nest)

    def may_switch(self, path: str, name: str, at: int | None) -> bool:
        """Return True if a simulator can be switched, to a past tick or now."""
        if name == FOLLOW:
            return path != "/" and at is None
        if self.find(path, name) is not None:
            return at is None
        return at is None or 0 <= at <= self.controller(path).head

    def switch(self, path: str, name: str, at: int | None) -> None:
        """Put a simulator on a branch."""
        if name == FOLLOW:
            self.selected.pop(path, None)
            return
        branch = self.find(path, name)
        if branch is None:
            source = self.controller(path)
            base = (source, len(source.acts), source.head)
            if at is not None:
                base = self.place_of(source, at)
            branch = Branch(path, name, base, base[2], base[2])
            self.branches.append(branch)
        self.selected[path] = branch

    def may_delete(self, branch: Branch, recursive: bool) -> bool:
        """Return True if the branch can be deleted: no simulator is on it, none rests on it."""
        gone = [b for b in self.branches if b.lies_in(branch)]
        return (recursive or len(gone) == 1) and not any(b in gone for b in self.selected.values())

    def delete(self, branch: Branch) -> None:
        """Remove a branch and what rests on it."""
        self.branches = [b for b in self.branches if not b.lies_in(branch)]
