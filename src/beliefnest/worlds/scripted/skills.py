"""Skills of the scripted world, each a generator that is advanced once a tick.

Walking takes one tick for each cell. Opening, taking, putting, turning to look, speaking, thinking,
handing over, switching, breaking and placing blocks take one tick each.
"""

import math
from collections.abc import Callable, Mapping
from typing import Any

from beliefnest.errors import InputError, WorldError
from beliefnest.skills.calls import Call
from beliefnest.world.circuits import Circuits
from beliefnest.world.claims import Claim, claims_from_plain
from beliefnest.world.doors import is_door, is_open
from beliefnest.world.double_chests import CHESTS, StateAt, halves_at
from beliefnest.world.registry import Registry
from beliefnest.world.signs import sign_fault
from beliefnest.world.texts import MOST_UTTERANCES, quoted
from beliefnest.world.values import EYE_HEIGHT, Position, block_at
from beliefnest.worlds.scripted.building import mine_block, place_item, press_button, switch_lever
from beliefnest.worlds.scripted.footpaths import Near
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

_NEAR = 2.0
_CHEST = "Give the position of a chest or barrel."
_SIGN = "Give the position of a sign."


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
    there = hand.world.contents(place)
    moved = {name: min(n, there.get(name, 0)) for name, n in wanted.items() if there.get(name, 0)}
    if moved:
        hand.world.withdraw(hand.name, place, moved)
    missing = [
        f"{n} {name} asked for from the chest at {place}, it holds {there.get(name, 0)}; "
        f"{moved.get(name, 0)} taken"
        for name, n in wanted.items()
        if there.get(name, 0) < n
    ]
    if missing:
        raise SkillError(f"{'; '.join(missing)}. Ask for what is there, or look elsewhere.")


def _deposit_item_into_chest(hand: Hand, position: Any, items: Any) -> Doing:
    place, wanted = block_in(position), items_in(items)
    yield from _open(hand, place)
    yield 0
    hand.world.deposit(hand.name, place, wanted)


def _open_container(hand: Hand, position: Any) -> Doing:
    yield from _open(hand, block_in(position))


def _open_from_here(hand: Hand, position: Any) -> Doing:
    place = block_in(position)
    yield from _open(hand, place, walks=False)
    return dict(hand.world.contents(place))


def _use_door(to_open: bool) -> Callable[..., Doing]:
    def use(hand: Hand, position: Any) -> Doing:
        place = block_in(position)
        yield from walk_to_use(hand, place)
        there = hand.world.state_at(place)
        if is_open(Registry.load(), there) is to_open:
            return
        if not is_door(Registry.load().name(there)):
            raise hand.lacking("door", place, "Give the position of a door.")
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
    yield from walk_to_use(hand, place)
    if not hand.ground().is_sign(place):
        raise hand.lacking("sign", place, _SIGN)
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
    if hand.known().is_sign(place) is False:
        raise hand.lacking("sign", place, _SIGN)
    yield from _look_at(hand, tuple(part + 0.5 for part in place))
    yield 0
    if not hand.known().is_sign(place):
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
    where = others[name].position
    yield from walk(hand, where, Near(block_at(where), _NEAR), name)
    yield 0
    if not hand.can_throw_to(name):
        raise SkillError(f"{name} cannot be given anything from here: something solid is between")
    hand.world.give(hand.name, name, items_in({text_in(item): count}))


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
    "turnOnLever": switch_lever(powered=True),
    "turnOffLever": switch_lever(powered=False),
    "pressButton": press_button,
    "mineBlock": mine_block,
    "placeItem": place_item,
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
        if not hand.known().may_hold(place):
            raise hand.lacking("chest", place, _CHEST)
        yield from walk_to_use(hand, place)
    yield 0
    hand.check_touch(place, "the container")
    try:
        hand.world.contents(place)
    except WorldError:
        raise hand.lacking("chest", place, _CHEST) from None
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
