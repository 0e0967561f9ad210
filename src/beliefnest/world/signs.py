"""Signs: which blocks are some, and what can be written on them.

The text is that of a sign's front. It is part of its block wherever blocks are told of: as a
`Sign` among block states, so that whoever sees the block sees the text.
"""

from beliefnest.errors import InputError
from beliefnest.world.registry import Registry
from beliefnest.world.texts import escaped, fault_of
from beliefnest.world.values import Block, Sign

__all__ = [
    "LONGEST_LINE",
    "MOST_LINES",
    "block_words",
    "is_sign",
    "plain_state",
    "sign_fault",
    "sign_words",
    "text_of",
    "written",
]

MOST_LINES = 4
"""Lines of a sign, as in Minecraft."""

LONGEST_LINE = 45
"""Characters of a line, as Mineflayer writes them."""


def is_sign(name: str) -> bool:
    """Return True if the block of that name is a sign: one that stands, hangs, or is on a wall."""
    return name.endswith("_sign")


def sign_fault(text: str) -> str | None:
    """What is wrong with a text for a sign; None: nothing.

    It has at most `MOST_LINES` lines, split by line breaks, each of which can be said (`fault_of`)
    and has at most `LONGEST_LINE` characters.
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
    """What is written on a sign, on one line: its lines with `/` between them."""
    return escaped(" / ".join(text.rstrip("\n").split("\n")))


def block_words(registry: Registry, block: Block) -> str | None:
    """Return a block as people read it, with what is written on it; None: unknown."""
    if isinstance(block, Sign):
        return f'{registry.text(block.state)} that says "{sign_words(block.text)}"'
    return None if block < 0 else registry.text(block)


def written(registry: Registry, state: int, text: str) -> Block:
    """Return a block with a text on it; without text it is a block state like any other.

    Raises:
        InputError: The block is no sign, or the text does not fit on one.
    """
    if state < 0 or not is_sign(registry.name(state)):
        there = "not known" if state < 0 else registry.name(state)
        raise InputError(f"the block is {there}, which is no sign; give a block like oak_sign")
    if fault := sign_fault(text):
        raise InputError(fault)
    lines = text.rstrip("\n")
    return Sign(state, lines) if lines else state


def plain_state(block: Block) -> int:
    """Return the block state id of a block, whatever is written on it; -1: unknown."""
    return block.state if isinstance(block, Sign) else block


def text_of(block: Block) -> str:
    """What is written on a block; empty if nothing is."""
    return block.text if isinstance(block, Sign) else ""
