"""Skills of the scripted world, each a generator that is advanced once a tick.

Walking takes one tick for each cell. Opening, taking, putting, turning to look, speaking, thinking,
handing over, switching, breaking and placing blocks take one tick each.
"""

import math
from collections.abc import Callable, Mapping
from typing import Any

from beliefnest.errors import InputError
from beliefnest.skills.calls import Call
from beliefnest.world.circuits import Circuits
from beliefnest.world.claims import Claim, claims_from_plain
from beliefnest.world.doors import is_door, is_open
from beliefnest.world.double_chests import CHESTS, StateAt, halves_at
from beliefnest.world.limits import AGENT_SLOTS, WORN_SLOTS, slots_at
from beliefnest.world.registry import Registry
from beliefnest.world.signs import is_sign, sign_fault
from beliefnest.world.texts import MOST_UTTERANCES, quoted
from beliefnest.world.values import EYE_HEIGHT, Items, Position, block_at
from beliefnest.worlds.scripted.facts import sum_of
from beliefnest.worlds.scripted.footpaths import Ground, Near
from beliefnest.worlds.scripted.hand import (
    Doing,
    Hand,
    SkillError,
    block_in,
    doors_in,
    items_in,
    mute_fault,
    number_in,
    point_in,
    text_in,
    walk,
    walk_to_use,
)

_MOST_WAITED = 40


def _switch_lever(*, powered: bool) -> Callable[..., Doing]:
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


def _mine_block(hand: Hand, position: Any, name: Any) -> Doing:
    """Break a block and take its drops."""
    place, wanted = block_in(position), text_in(name)
    yield from walk_to_use(hand, place, wanted, wanted.__eq__, "Look where it is.")
    yield 0
    # Another agent may have replaced it in this very tick.
    if hand.ground().name_at(place) != wanted:
        raise hand.lacking(wanted, place, "Look where it is.")
    hand.world.mine(hand.name, place)


def _place_item(hand: Hand, name: Any, position: Any) -> Doing:
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


_NEAR = 2.0
_CHEST = "Give the position of a chest or barrel."
_CONTAINERS = (*CHESTS, "barrel")


def _go_to_position(hand: Hand, position: Any, dist: Any = 2, doors: Any = None) -> Doing:
    target = point_in("position", position)
    near = number_in("dist", dist)
    doors = doors_in(doors)
    moved = yield from walk(hand, target, Near(block_at(target), near), "the position", doors)
    if not moved:
        yield 0
    hand.world.arrive(hand.name, target)


def _get_item_from_chest(hand: Hand, position: Any, items: Any) -> Doing:
    place, wanted = block_in(position), items_in(items)
    yield from _open(hand, place)
    yield 0
    there, own = hand.world.contents(place), hand.inventory
    moved = _movable(wanted, there, own, AGENT_SLOTS + WORN_SLOTS)
    if moved:
        hand.world.withdraw(hand.name, place, moved)
    what = f"asked for from the chest at {place}, it holds"
    _check_moved(wanted, moved, there, what, "taken. Ask for what is there, or look elsewhere.")


def _deposit_item_into_chest(hand: Hand, position: Any, items: Any) -> Doing:
    place, wanted = block_in(position), items_in(items)
    yield from _open(hand, place)
    yield 0
    world, own = hand.world, hand.inventory
    slots = slots_at(Registry.load(), world.state_at, place)
    moved = _movable(wanted, own, world.contents(place), slots)
    if moved:
        world.deposit(hand.name, place, moved)
    what = f"to be put into the chest at {place}, the inventory holds"
    _check_moved(wanted, moved, own, what, "put in. Get more first, or put in less.")


def _movable(wanted: Items, source: Items, target: Items, slots: int) -> dict[str, int]:
    """Return as much of wanted items as the source has and the slots of the target can hold."""
    stack_of = Registry.load().item_stack
    moved: dict[str, int] = {}
    for name, count in wanted.items():
        contents = sum_of(target, moved)
        others = sum(-(-n // stack_of(other)) for other, n in contents.items() if other != name)
        room = (slots - others) * stack_of(name) - contents.get(name, 0)
        if (most := min(count, source.get(name, 0), room)) > 0:
            moved[name] = most
    return moved


def _check_moved(wanted: Items, moved: Items, source: Items, what: str, done: str) -> None:
    """Raise SkillError if less than the wanted items was moved."""
    missing = [
        f"{n} {name} {what} {source.get(name, 0)}; {moved.get(name, 0)}"
        for name, n in wanted.items()
        if moved.get(name, 0) < n
    ]
    if missing:
        raise SkillError(f"{'; '.join(missing)} {done}")


def _open_container(hand: Hand, position: Any) -> Doing:
    yield from _open(hand, block_in(position))


def _open_from_here(hand: Hand, position: Any) -> Doing:
    place = block_in(position)
    yield from _open(hand, place, walks=False)
    return dict(hand.world.contents(place))


def _use_door(to_open: bool) -> Callable[..., Doing]:
    def use(hand: Hand, position: Any) -> Doing:
        place = block_in(position)
        yield from walk_to_use(hand, place, "door", is_door)
        if is_open(Registry.load(), hand.world.state_at(place)) is to_open:
            return
        yield 0
        hand.world.use_door(hand.name, place, open=to_open)

    return use


def _write_sign(hand: Hand, position: Any, lines: Any, claims: Any = ()) -> Doing:
    place, sign_claims = block_in(position), _claims(claims)
    is_list = isinstance(lines, list | tuple) and all(isinstance(line, str) for line in lines)
    text = "\n".join(lines) if is_list else lines
    if not isinstance(text, str):
        raise SkillError(f"text must be a text; it is {quoted(text)}")
    if fault := sign_fault(text):
        raise SkillError(f"text is {fault}")
    yield from walk_to_use(hand, place, "sign", is_sign)
    yield 0
    hand.world.write_sign(hand.name, place, text, sign_claims)


def _look_at(hand: Hand, position: Any) -> Doing:
    target = point_in("position", position)
    yield 0
    x, y, z = hand.feet
    away = (target[0] - x, target[1] - y - EYE_HEIGHT, target[2] - z)
    hand.world.place_agent(
        hand.name,
        hand.feet,
        yaw=math.atan2(-away[0], -away[2]),
        pitch=math.atan2(away[1], math.hypot(away[0], away[2])),
    )


def _read_sign(hand: Hand, position: Any) -> Doing:
    place = block_in(position)
    name = hand.known().name_at(place)
    if name is not None and not is_sign(name):
        raise hand.lacking("sign", place, "Give the position of a sign.")
    yield from _look_at(hand, tuple(part + 0.5 for part in place))
    yield 0
    if not is_sign(hand.known().name_at(place) or ""):
        raise SkillError(f"no sign is to be seen at {place}. Go nearer, or look somewhere else.")
    return hand.signs().get(place, "")


def _claims(plain: Any) -> tuple[Claim, ...]:
    try:
        return claims_from_plain(plain or ())
    except InputError as fault:
        raise SkillError(
            f"{fault}; make each with located, absent, positionOf or blockAt, "
            "like [located('diamond', new Vec3(3, 1, 3))]"
        ) from fault


def _say(hand: Hand, text: Any, claims: Any = ()) -> Doing:
    yield from _speak(hand)
    if hand.may_utter():
        hand.world.say(hand.name, text_in(text), _claims(claims))


def _whisper(hand: Hand, other: Any, text: Any, claims: Any = ()) -> Doing:
    yield from _speak(hand)
    if hand.may_utter():
        hand.world.whisper(hand.name, text_in(other), text_in(text), _claims(claims))


def _chat(hand: Hand, text: str) -> Doing:
    yield from _speak(hand)
    if text and hand.may_utter():
        hand.world.say(hand.name, text)


def _tell(hand: Hand, other: str, text: str) -> Doing:
    yield from _speak(hand)
    if text and hand.may_utter():
        hand.world.whisper(hand.name, other, text)


def _speak(hand: Hand) -> Doing:
    """Wait for the ticks that an utterance takes; several utterances take turns."""
    if hand.mute:
        raise SkillError(mute_fault(hand.name))
    if not hand.speech_ticks:
        yield 0
        return
    words = object()
    hand.mouth.append(words)
    while hand.mouth[0] is not words:
        yield 0
    for _ in range(hand.speech_ticks):
        yield 0
    hand.mouth.remove(words)


def _think(hand: Hand, text: Any) -> Doing:
    yield 0
    if not hand.may_utter():
        raise SkillError(
            f"{hand.name} has uttered {MOST_UTTERANCES} things in one tick, which is the most. "
            "Wait a tick between them."
        )
    hand.world.think(hand.name, text_in(text))


def _give_item(hand: Hand, other: Any, item: Any, count: Any) -> Doing:
    name = text_in(other)
    others = hand.others()
    if name not in others:
        raise SkillError(
            f"{quoted(name)} is no agent that is known to be here; it is {sorted(others)}"
        )
    gift = items_in({text_in(item): count})
    if any(hand.inventory.get(kind, 0) < n for kind, n in gift.items()):
        raise SkillError(f"cannot give {count} {item}: the inventory holds {hand.contents}.")
    where = others[name].position
    yield from walk(hand, where, Near(block_at(where), _NEAR), name)
    yield 0
    if not hand.can_throw_to(name):
        raise SkillError(f"{name} cannot be given anything from here: something solid is between")
    hand.world.give(hand.name, name, gift)


def _wait_ticks(hand: Hand, ticks: Any) -> Doing:
    for _ in range(math.ceil(number_in("ticks", ticks))):
        yield 0


def _wait_for_chat(hand: Hand, ticks: Any = 100) -> Doing:
    for _ in range(math.ceil(number_in("ticks", ticks))):
        yield 0
        for name, *values in hand.news:
            if name in ("chat", "whisper") and values[0] != hand.name:
                return {"speaker": values[0], "text": values[1], "whispered": name == "whisper"}
    return None


def _do_nothing(hand: Hand) -> Doing:
    yield 0


SKILLS: Mapping[str, Callable[..., Doing]] = {
    "goToPosition": _go_to_position,
    "openContainer": _open_container,
    "getItemFromChest": _get_item_from_chest,
    "depositItemIntoChest": _deposit_item_into_chest,
    "openDoor": _use_door(to_open=True),
    "closeDoor": _use_door(to_open=False),
    "turnOnLever": _switch_lever(powered=True),
    "turnOffLever": _switch_lever(powered=False),
    "pressButton": press_button,
    "mineBlock": _mine_block,
    "placeItem": _place_item,
    "writeSign": _write_sign,
    "readSign": _read_sign,
    "lookAt": _look_at,
    "giveItemToOther": _give_item,
    "say": _say,
    "whisper": _whisper,
    "think": _think,
    "waitTicks": _wait_ticks,
    "waitForChat": _wait_for_chat,
    "doNothing": _do_nothing,
}
"""Skills by name."""

CALLS: Mapping[str, Callable[..., Doing]] = {
    "bot.openContainer": _open_from_here,
    "bot.chat": _chat,
    "bot.whisper": _tell,
}
"""Methods of the bot by name."""

UTTERANCES = frozenset(("say", "whisper", "think"))
"""Skills that take effect by the call itself, as in Minecraft, without `await` as well."""


def perform(hand: Hand, call: Call) -> Doing:
    """Make a call of a skill."""
    return SKILLS[call.skill](hand, *call.args)


def _open(hand: Hand, place: Position, *, walks: bool = True) -> Doing:
    if walks:
        yield from walk_to_use(hand, place, "chest", _CONTAINERS.__contains__, _CHEST)
    yield 0
    hand.check_touch(place, "the container")
    if hand.ground().name_at(place) not in _CONTAINERS:
        raise hand.lacking("chest", place, _CHEST)
    if above := _on_lid(hand.world.state_at, place):
        raise SkillError(
            f"the chest at {place} cannot be opened: {above} lies on its lid. Remove it first."
        )
    hand.world.open(hand.name, place)


def _on_lid(state_at: StateAt, place: Position) -> str | None:
    """Return the block that keeps a chest shut: one that carries power, on the lid of either half.

    Bots have the same rule in `worlds/minecraft/node/src/server/plugins/lib/onLid.js`.
    """
    registry, conductors = Registry.load(), Circuits.load().conductors
    if registry.name(state_at(place)) not in CHESTS:
        return None
    lids = [state_at((x, y + 1, z)) for x, y, z in halves_at(registry, state_at, place)]
    return next((registry.name(state) for state in lids if state in conductors), None)
