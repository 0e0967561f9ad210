"""Syntax trees of agent programs, by tree-sitter; it is imported only when a program is read."""

from collections.abc import Iterator
from functools import lru_cache
from typing import Any


def parsed(code: bytes) -> Any:
    """Return the root node of a program's tree; its `has_error` says if it is no JavaScript."""
    return _parser().parse(code).root_node


def nodes_below(root: Any) -> Iterator[Any]:
    """Yield a node and all below it, in the order of the text."""
    waiting = [root]
    while waiting:
        yield (node := waiting.pop())
        waiting += reversed(node.children)


@lru_cache(maxsize=1)
def _parser() -> Any:
    import tree_sitter_javascript
    from tree_sitter import Language, Parser

    return Parser(Language(tree_sitter_javascript.language()))
