"""Syntax trees of agent programs, by tree-sitter; it is imported only when a program is read."""

from functools import lru_cache
from typing import Any


def parsed(code: bytes) -> Any:
    """Return the root node of a program's tree; its `has_error` says if it is no JavaScript."""
    return _parser().parse(code).root_node


@lru_cache(maxsize=1)
def _parser() -> Any:
    import tree_sitter_javascript
    from tree_sitter import Language, Parser

    return Parser(Language(tree_sitter_javascript.language()))
