"""Skills of the scripted world that change blocks: switching, pressing, breaking, placing."""

from collections.abc import Callable
from typing import Any

from beliefnest.world.registry import Registry
from beliefnest.world.values import Position
from beliefnest.worlds.scripted.footpaths import Ground
from beliefnest.worlds.scripted.hand import (
    Doing,
    Hand,
    SkillError,
    block_in,
    text_in,
    walk,
    walk_to_use,
)

_MOST_WAITED = 40


def switch_lever(*, powered: bool) -> Callable[..., Doing]:
    """Return the skill that switches a lever; it does nothing if the lever is in that state."""

    def switch(hand: Hand, position: Any) -> Doing:
        place = block_in(position)
        yield from walk_to_use(hand, place, "lever", "lever".__eq__)
        if _is_powered(hand, place) is powered:
            return
        yield 0
        # Another agent may have switched it in this very tick.
        if _is_powered(hand, place) is not powered:
            hand.world.use_lever(hand.name, place, powered=powered)

    return switch


def press_button(hand: Hand, position: Any) -> Doing:
    """Press a button; if it is pressed already, first wait until it comes out."""
    place = block_in(position)
    yield from walk_to_use(hand, place, "button", lambda name: name.endswith("_button"))
    yield 0
    for _ in range(_MOST_WAITED):
        if not _is_powered(hand, place):
            break
        yield 0
    hand.world.press_button(hand.name, place)


def mine_block(hand: Hand, position: Any, name: Any) -> Doing:
    """Break a block and take its drops."""
    place, wanted = block_in(position), text_in(name)
    yield from walk_to_use(hand, place, wanted, wanted.__eq__, "Look where it is.")
    yield 0
    # Another agent may have replaced it in this very tick.
    if hand.ground().name_at(place) != wanted:
        raise hand.lacking(wanted, place, "Look where it is.")
    hand.world.mine(hand.name, place)


def place_item(hand: Hand, name: Any, position: Any) -> Doing:
    """Place a block of the inventory, from a position next to it."""
    place, item = block_in(position), text_in(name)
    if not hand.inventory.get(item, 0):
        raise SkillError(
            f"the inventory holds no {item}; it holds: {hand.contents}. Get some first."
        )
    _check_free(hand, hand.known(), place)
    yield from walk(hand, place, hand.reach(place, beside=True), "the position")
    hand.check_touch(place, "the position")
    yield 0
    _check_free(hand, hand.ground(), place)
    hand.world.put(hand.name, item, place)


def _check_free(hand: Hand, ground: Ground, place: Position) -> None:
    """Raise SkillError if a ground has a block at a place."""
    if not (ground.name_at(place) or "air").endswith("air"):
        raise hand.lacking("free place", place, "Choose another one.")


def _is_powered(hand: Hand, place: Position) -> bool:
    """Return True if a switch is on."""
    return Registry.load().properties(hand.world.state_at(place)).get("powered") == "true"
