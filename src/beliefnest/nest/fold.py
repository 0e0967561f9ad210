"""Folding timelines into states: from the log alone to any node at any of its entries.

Follow-mode beliefs are pure functions of the control timelines (semantics, section 6). A
`Fold` walks along one timeline and carries the states of the nodes someone asked for;
`History` keeps one for the head of every timeline and makes others for the past.
"""

from dataclasses import dataclass, field

from beliefnest.belief import control
from beliefnest.belief.state import BeliefState
from beliefnest.nest.rules import Rules
from beliefnest.timeline.journal import Entry, ForkPoint, Journal, TimelineKey

__all__ = ["History"]

Path = tuple[str, ...]


@dataclass
class _Fold:
    """States of some nodes after the first `position` entries of one timeline.

    The nodes are keyed by their whole path; with a node its ancestors down to the
    timeline's own simulator are always there.
    """

    key: TimelineKey
    position: int
    nodes: dict[Path, BeliefState] = field(default_factory=dict)

    def advance(self, entries: "list[Entry]", rules: Rules) -> None:
        """Fold further entries into all nodes, shallower ones first."""
        order = sorted(self.nodes, key=len)
        for entry in entries:
            for path in order:
                state = self.nodes[path]
                if path == self.key.path:
                    self.nodes[path] = rules.after(state, entry, path)
                else:
                    around = self.nodes[path[:-1]]
                    self.nodes[path] = rules.belief_after(state, around, entry, path)
        self.position += len(entries)


class History:
    """States of any node, at any entry of any timeline of a journal.

    Args:
        journal: The timelines.
        rules: How states follow from one another.
    """

    def __init__(self, journal: Journal, rules: Rules) -> None:
        self._journal = journal
        self._rules = rules
        self._heads: dict[TimelineKey, _Fold] = {}

    def state(self, key: TimelineKey, path: Path, position: int | None = None) -> BeliefState:
        """State of the node `path` after `position` entries of a timeline; None: at its head.

        `path` is the timeline's own simulator or a node below it that follows it.
        """
        count = self._journal.info(key).entries
        head = self._heads.setdefault(key, _Fold(key, 0))
        if position is not None and position != count:
            return self._past(key, path, position)
        if head.position < count and head.nodes:
            entries = list(self._journal.entries(key, head.position, count))
            head.advance(entries, self._rules)
        head.position = count
        if path not in head.nodes:
            self._adopt(head, path)
        return head.nodes[path]

    def forget(self, key: TimelineKey) -> None:
        """Drop what is remembered of a timeline that was deleted or renamed."""
        self._heads.pop(key, None)

    def _past(self, key: TimelineKey, path: Path, position: int) -> BeliefState:
        return self._walk(key, path, position).nodes[path]

    def _adopt(self, head: _Fold, path: Path) -> None:
        """Bring a node asked for late up to the head, computed from the log."""
        late = self._walk(head.key, path, head.position)
        for node, state in late.nodes.items():
            head.nodes.setdefault(node, state)

    def _walk(self, key: TimelineKey, path: Path, position: int) -> _Fold:
        """A fold of `path` and its ancestors from the start of a timeline to `position`."""
        fold = _Fold(key, 0)
        base = self._journal.info(key).base
        for depth in range(len(key.path), len(path) + 1):
            node = path[:depth]
            fold.nodes[node] = self._first(key, base, node, fold)
        fold.advance(list(self._journal.entries(key, 0, position)), self._rules)
        return fold

    def _first(
        self, key: TimelineKey, base: ForkPoint | None, node: Path, fold: _Fold
    ) -> BeliefState:
        """State of a node at the start of a timeline."""
        if base is None:
            if node == ():
                return self._rules.reality()
            return self._rules.first_belief(node, fold.nodes[node[:-1]])
        state = self.state(base.timeline, node, base.entries)
        return control.forked(state) if node == key.path else self._rules.quiet(state)
