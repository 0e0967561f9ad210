"""Parts of the scripted world that are functions of their arguments alone."""

from beliefnest.errors import WorldError
from beliefnest.world.limits import agent_name_fault, box_fault
from beliefnest.world.texts import fault_of
from beliefnest.world.values import Box, Items, Position

__all__ = [
    "checked_box",
    "checked_name",
    "checked_utterance",
    "rest_of",
    "sum_of",
]


def checked_box(box: tuple[Position, Position]) -> Box:
    """The box between two corners; WorldError if it is none."""
    low, high = (tuple(int(value) for value in corner) for corner in box)
    if len(low) != 3 or len(high) != 3 or any(a > b for a, b in zip(low, high, strict=True)):
        raise WorldError(f"the box {box} is none; give its lower and its upper corner")
    made = Box((low[0], low[1], low[2]), (high[0], high[1], high[2]))
    if fault := box_fault(made):
        raise WorldError(fault)
    return made


def checked_name(name: str) -> str:
    """An agent name; WorldError if it is none."""
    if fault := agent_name_fault(name):
        raise WorldError(fault)
    return name


def checked_utterance(text: str) -> str:
    """A text that can be said at once; WorldError if it cannot."""
    if fault := fault_of(str(text)):
        raise WorldError(fault)
    return str(text)


def sum_of(items: Items, change: Items) -> dict[str, int]:
    """Items with others beside them."""
    return {
        name: items.get(name, 0) + change.get(name, 0)
        for name in [*items, *(change.keys() - items.keys())]
    }


def rest_of(items: Items, change: Items, who: str) -> dict[str, int]:
    """Items without some of them; WorldError if they are not there."""
    for name, count in change.items():
        if items.get(name, 0) < count:
            raise WorldError(f"{who} has {items.get(name, 0)} {name}, not {count}")
    rest = {name: count - change.get(name, 0) for name, count in items.items()}
    return {name: count for name, count in rest.items() if count}
