"""False beliefs in nodes: differences from the world of their timeline, entry by entry."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from beliefnest.belief.forest import Forest
from beliefnest.nest.explain.comparison import are_elsewhere, are_false
from beliefnest.nest.explain.parts import Contents
from beliefnest.viewer.page.grid_changes import GridChanges
from beliefnest.world.array_types import Cells

WrongElements = tuple[str, ...]
"""`agent-1`: its pose; `inventory-1`: its inventory; `container-7`, `block-7`: those of cell 7."""


class WrongThings:
    """Judge of the false beliefs along a forest, by the rules of `false_beliefs`.

    It judges again only what changed since the last call.

    Args:
        forest: The forest.
        numbers: Numbers of the judged nodes.
        grids: Blocks of these nodes and of node 0.
        false: Cells of the false blocks of each node at the beginning.
    """

    def __init__(
        self, forest: Forest, numbers: Sequence[int], grids: GridChanges, false: Sequence[Cells]
    ) -> None:
        self._forest, self._numbers = forest, list(numbers)
        self._grids = grids
        self._wrong_cells = [set(cells.tolist()) for cells in false]
        self._block_things = [_things_at(cells) for cells in self._wrong_cells]
        self._held: list[Any] = [None for _ in numbers]
        self._content_things: list[WrongElements] = [() for _ in numbers]
        self._owned: dict[int, Any] = {}
        self._owner_things: list[WrongElements] = [() for _ in numbers]

    def found(self, owned_changed: set[int], cells: Mapping[int, Cells]) -> list[WrongElements]:
        """Return the false things in each node after the forest's present entry.

        Args:
            owned_changed: Numbers of the nodes in which an inventory changed.
            cells: Cells whose block changed, by number of the node.
        """
        self._judge_blocks(cells)
        self._judge_contents()
        for at, number in enumerate(self._numbers):
            if number in owned_changed or 0 in owned_changed:
                self._owner_things[at] = self._inventories(number)
        parts = (self._block_things, self._content_things, self._poses(), self._owner_things)
        return [sum(each, ()) for each in zip(*parts, strict=True)]

    def _judge_blocks(self, changed: Mapping[int, Cells]) -> None:
        for at, number in enumerate(self._numbers):
            cells = np.array([], dtype=np.int64)
            for node in {0, number} & changed.keys():
                cells = np.union1d(cells, changed[node])
            if not len(cells):
                continue
            believed, real = (self._grids.states(node, cells) for node in (number, 0))
            is_false = (believed >= 0) & (believed != real)
            wrong = self._wrong_cells[at]
            before = len(wrong)
            wrong.difference_update(cells[~is_false].tolist())
            wrong.update(cells[is_false].tolist())
            if before or wrong:
                self._block_things[at] = _things_at(wrong)

    def _judge_contents(self) -> None:
        forest = self._forest
        real = forest.holdings.of(0).containers
        for at, number in enumerate(self._numbers):
            contents = forest.holdings.of(number).containers
            mark = (_told(real), _told(contents))
            if mark == self._held[at]:
                continue
            self._held[at] = mark
            self._content_things[at] = tuple(
                f"container-{cell}"
                for cell in sorted(contents)
                if are_false(_contents(real, cell), _contents(contents, cell) or _NONE)
            )

    def _poses(self) -> list[WrongElements]:
        table, poses = self._forest.table, self._forest.poses
        pose_id, feet = table.nodes().pose, poses.arrays().feet
        is_known = pose_id >= 0
        if not len(feet):
            return [() for _ in self._numbers]
        moved = are_elsewhere(feet[pose_id[0]], feet[pose_id])
        apart = is_known & (moved | ~is_known[0])
        names_by_node: list[list[str]] = [[] for _ in self._numbers]
        for at, agent in np.argwhere(apart[self._numbers]).tolist():
            names_by_node[at].append(f"agent-{agent}")
        return [tuple(things) for things in names_by_node]

    def _inventories(self, number: int) -> WrongElements:
        forest = self._forest
        things = []
        for agent in range(len(forest.context.agents)):
            real, mine = (Contents(*forest.holdings.inventory(node, agent)) for node in (0, number))
            if are_false(real, mine):
                things.append(f"inventory-{agent}")
        return tuple(things)


def _things_at(cells: set[int]) -> WrongElements:
    return tuple(f"block-{cell}" for cell in sorted(cells))


_NONE = Contents({}, complete=False)


def _contents(containers: Mapping[int, Any], cell: int) -> Contents | None:
    content = containers.get(cell)
    return None if content is None else Contents(content.items, content.complete)


def _told(containers: Mapping[int, Any]) -> dict[int, tuple[Any, bool]]:
    return {cell: (content.items, content.complete) for cell, content in containers.items()}
