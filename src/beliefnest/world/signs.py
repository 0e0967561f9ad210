"""Signs: which blocks are signs, and which texts fit on them.

The text is on the front of the sign. It is part of the block, as a `Sign` among block states, so
that every agent that sees the block sees the text.
"""

import functools

from beliefnest.errors import InputError
from beliefnest.world.registry import Registry
from beliefnest.world.texts import escaped, fault_of
from beliefnest.world.values import Block, Sign

MOST_LINES = 4
"""Number of lines of a sign, as in Minecraft."""

LONGEST_LINE = 45
"""Greatest number of characters in a line, as in Mineflayer."""


def is_sign(name: str) -> bool:
    """Return True if a block name is that of a standing, hanging or wall sign."""
    return name.endswith("_sign")


@functools.cache
def sign_states(registry: Registry) -> tuple[int, ...]:
    """Return the block states of all kinds of signs."""
    return tuple(registry.states_of(filter(is_sign, registry.block_names)))


def sign_fault(text: str) -> str | None:
    """Return the fault of a text for a sign, or None.

    A valid text has at most `MOST_LINES` lines. Each line has at most `LONGEST_LINE` characters
    and is a valid utterance (`fault_of`).
    """
    lines = text.split("\n")
    if len(lines) > MOST_LINES:
        return f"a text of {len(lines)} lines; a sign has {MOST_LINES}"
    for line in lines:
        if len(line) > LONGEST_LINE:
            return f"a line of {len(line)} characters; at most {LONGEST_LINE} fit on a sign"
        if fault := fault_of(line):
            return fault
    return None


def sign_words(text: str) -> str:
    """Return the text of a sign on one line, with `/` between its lines."""
    return escaped(" / ".join(text.rstrip("\n").split("\n")))


def block_words(registry: Registry, block: Block) -> str | None:
    """Return a block as text for people, with the text of a sign; None if it is unknown."""
    if isinstance(block, Sign):
        return f'{registry.text(block.state)} that says "{sign_words(block.text)}"'
    return None if block < 0 else registry.text(block)


def written(registry: Registry, state: int, text: str) -> Block:
    """Return a sign with a text; with an empty text, a plain block state.

    Raises:
        InputError: The block is not a sign, or the text does not fit.
    """
    if state < 0 or not is_sign(registry.name(state)):
        there = "unknown" if state < 0 else registry.name(state)
        raise InputError(f"the block is {there}, which is no sign; give a block like oak_sign")
    if fault := sign_fault(text):
        raise InputError(fault)
    lines = text.rstrip("\n")
    return Sign(state, lines) if lines else state


def plain_state(block: Block) -> int:
    """Return the block state id of a block or a sign; -1 is unknown."""
    return block.state if isinstance(block, Sign) else block


def text_of(block: Block) -> str:
    """Return the text on a block; empty if there is none."""
    return block.text if isinstance(block, Sign) else ""
