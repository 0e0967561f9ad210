"""Names of containers, signs, doors and switches in prose."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Final

from beliefnest.belief.view import State
from beliefnest.prompts.observations import Happened, Observation, SightChange
from beliefnest.prompts.simulator_view import blocks_where
from beliefnest.world.doors import is_door, is_switch
from beliefnest.world.double_chests import is_left_half
from beliefnest.world.registry import Registry, block_name
from beliefnest.world.signs import is_sign
from beliefnest.world.texts import on_one_line
from beliefnest.world.values import Position

_SIDES: Final = (("western", "eastern"), ("northern", "southern"), ("lower", "upper"))
"""Words for two objects that differ in x, else z, else y."""
_AXES: Final = (0, 2, 1)
_ORDINALS: Final = ("first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth")


def is_named(block: str) -> bool:
    """Return True for the name of a kind of block that has a name in prose."""
    return (
        is_door(block) or is_switch(block) or is_sign(block) or Registry.load().is_container(block)
    )


def kind_name(block: str) -> str:
    """Return the name of a kind of block in prose, without an article."""
    return "sign" if is_sign(block) else block.replace("_", " ")


def apart(bases: Mapping[Position, str]) -> dict[Position, str]:
    """Return names that tell things of one name apart, by position, in order.

    Two of one name get a compass direction (`western chest`), more of them get numbers, counted
    from the west (`first chest`).

    Args:
        bases: Label or kind of each thing.
    """
    groups: dict[str, list[Position]] = {}
    for at, base in bases.items():
        groups.setdefault(base, []).append(at)
    named = {at: name for base, group in groups.items() for at, name in _apart(base, group).items()}
    return dict(sorted(named.items()))


def _apart(base: str, group: Sequence[Position]) -> dict[Position, str]:
    if len(group) == 1:
        return {group[0]: base}
    axis = next(axis for axis in _AXES if len({at[axis] for at in group}) > 1)
    ordered = sorted(group, key=lambda at: (at[axis], at))
    words: Sequence[str] = _SIDES[_AXES.index(axis)]
    if len(group) > 2:  # a pair has two sides
        words = [*_ORDINALS, *(f"{n}th" for n in range(len(_ORDINALS) + 1, len(group) + 1))]
    return {at: f"{word} {base}" for at, word in zip(ordered, words, strict=False)}


def believed_names(
    state: State, observations: Iterable[Observation], labels: Mapping[Position, str]
) -> Mapping[Position, str]:
    """Return the names that the owner of a belief has for things, by position.

    The name of a thing is its label, else its kind as the owner believes it to be, else as it
    last saw it. Things that the owner does not know have no name and affect no other name.

    Args:
        state: The belief.
        observations: Observations of its owner.
        labels: Labels that the owner knows.
    """
    kinds = _lower_halves(_seen_kinds(observations) | _believed_kinds(state))
    bases = {at: kind_name(block) for at, block in kinds.items()}
    return apart({**bases, **{at: on_one_line(label) for at, label in labels.items()}})


def _seen_kinds(observations: Iterable[Observation]) -> dict[Position, str]:
    """Return the kinds of the named things in observations, the latest of each position."""
    kinds: dict[Position, str] = {}
    for each in observations:
        if isinstance(each, SightChange):
            kinds |= each.kinds
        elif isinstance(each, Happened) and each.event.detail.get("position") is not None:
            block = block_name(str(each.event.detail.get("block") or each.block or ""))
            if block and is_named(block):
                kinds[tuple(each.event.detail["position"])] = block
    return kinds


def _believed_kinds(state: State) -> dict[Position, str]:
    named = blocks_where(state, _is_named_block)
    return {at: block_name(text) for at, text in named}


def _is_named_block(text: str) -> bool:
    """Return True if a block has a name in prose; the left half of a double chest has none."""
    registry = Registry.load()
    return is_named(block_name(text)) and not is_left_half(registry, registry.state_id(text))


def _lower_halves(kinds: Mapping[Position, str]) -> dict[Position, str]:
    """Return things without the upper halves of doors, which belong to the lower ones."""
    return {
        at: block
        for at, block in kinds.items()
        if not (is_door(block) and is_door(kinds.get((at[0], at[1] - 1, at[2]), "")))
    }


def known_places(state: State, places: Mapping[str, Position]) -> Mapping[str, Position]:
    """Return the named places of which the owner of a belief knows the cell or the floor."""

    def knows(at: Position) -> bool:
        return at in state.box and state.blocks[at] is not None

    return {
        name: (x, y, z)
        for name, (x, y, z) in places.items()
        if knows((x, y, z)) or knows((x, y - 1, z))
    }
