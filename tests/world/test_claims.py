"""Claims: what they may speak of, and that they keep their meaning on every way."""

from collections.abc import Callable
from typing import Any

import msgspec
import pytest

import beliefnest as bn
from beliefnest.timeline import codec
from beliefnest.timeline.events import event_from
from beliefnest.world.claims import claims_from_plain, claims_of
from beliefnest.world.frames import Frame
from beliefnest.world.values import Event

CHEST = (3, 0, 3)
CLAIMS = (
    bn.Claim.located("minecraft:diamond", CHEST),
    bn.Claim.absent("diamond", CHEST),
    bn.Claim.position("anne", (4.5, 0, 2.25)),
    bn.Claim.block((1, 0, 1), "minecraft:oak_door[ open = true, half=upper]"),
)


def world() -> bn.ScriptedWorld:
    agents = {"sally": (2.5, 0.0, 2.5), "anne": (4.5, 0.0, 2.5)}
    return bn.ScriptedWorld(((0, 0, 0), (7, 3, 7)), agents=agents, containers={CHEST: {}})


def said() -> Event:
    there, frames = world(), list[Frame]()
    there.listen(frames.append)
    there.say("sally", "Listen!", claims=CLAIMS)
    return frames[0].events[0]


def test_a_claim_prints_and_names_things_in_one_way() -> None:
    assert [str(claim) for claim in CLAIMS] == [
        "diamond is in (3, 0, 3)",
        "diamond is not in (3, 0, 3)",
        "anne is at (4.5, 0, 2.25)",
        "(1, 0, 1) is oak_door[half=upper,open=true]",
    ]


def test_claims_stay_the_same_as_plain_data_in_stores_and_in_traces() -> None:
    event = said()
    assert claims_of(event) == CLAIMS
    stored = codec.decode_entry(codec.encode_entry(Frame(3, events=(event,))))
    assert isinstance(stored, Frame)
    assert stored.events == (event,)
    line = msgspec.json.decode(msgspec.json.encode(event.detail))
    assert event_from("chat", "sally", line, ["sally", "anne"]) == event


def test_an_utterance_without_claims_is_as_ever() -> None:
    there, frames = world(), list[Frame]()
    there.listen(frames.append)
    there.say("sally", "hello", claims=[])
    assert frames[0].events[0].detail == {"text": "hello"}


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: bn.Claim.located("dimond", CHEST), "no item 'dimond'.*did you mean diamond"),
        (lambda: bn.Claim.located("diamond", (1, 2)), "three finite numbers"),  # type: ignore[arg-type]
        (lambda: bn.Claim.absent("diamond", (1, 0.5, 2)), "three whole numbers"),  # type: ignore[arg-type]
        (lambda: bn.Claim.position("anne", (1, float("nan"), 2)), "three finite numbers"),
        (lambda: bn.Claim.position("", (1, 0, 2)), "give an agent's name"),
        (lambda: bn.Claim.block(CHEST, "oak_door[opn=true]"), "no property 'opn'"),
        (lambda: bn.Claim.block(CHEST, "ok_door"), "no block 'ok_door'.*oak_door"),
        (lambda: claims_from_plain([{"kind": "located", "place": [1, 2, 3]}]), "lacks 'item'"),
        (
            lambda: claims_from_plain([{"kind": "guess", "place": [1, 2, 3]}]),
            "1: 'guess' is no kind; kinds are located, absent",
        ),
        (lambda: claims_from_plain(7), "claims are 7; give a list of claims"),
        (lambda: claims_from_plain(["in red"]), "claim 1 is 'in red', which is no claim"),
        (lambda: claims_from_plain([{"kind": "absent", "item": "apple"}]), "lacks 'place'"),
        (
            lambda: claims_from_plain([{"kind": "absent", "item": "apple", "place": "red"}]),
            "claim 1: a claim is about the place 'red'; give three finite numbers",
        ),
        (
            lambda: event_from("think", "anne", {"text": "hm", "claims": []}, ["anne"]),
            "only a chat and a block_update with",
        ),
    ],
)
def test_what_is_no_claim_is_refused(make: Callable[[], object], message: str) -> None:
    with pytest.raises(bn.BeliefNestError, match=message):
        make()


@pytest.mark.parametrize(
    ("fact", "claim"),
    [
        (
            {"container": (3, 0, 3), "items": {"diamond": 1}},
            bn.Claim.located("diamond", (3, 0, 3)),
        ),
        ({"container": (3, 0, 3), "lacks": "diamond"}, bn.Claim.absent("diamond", (3, 0, 3))),
        ({"agent": "anne", "at": (3, 0, 3)}, bn.Claim.position("anne", (3.5, 0, 3.5))),
        ({"block": (3, 0, 3), "state": "air"}, bn.Claim.block((3, 0, 3), "air")),
    ],
)
def test_a_fact_can_be_claimed(fact: dict[str, Any], claim: bn.Claim) -> None:
    there = world()
    with bn.Nest(there) as nest:
        there.say("sally", "x", claims=[fact, claim])
        assert [made.claim for made in nest.claims()] == [claim, claim]


@pytest.mark.parametrize(
    ("claim", "message"),
    [
        ({"path": "/anne", "block": (3, 0, 3), "state": "air"}, "cannot be claimed; claim items"),
        ({"heard": "hello"}, "'hello' was heard' cannot be claimed"),
        ({"container": (3, 0, 3), "itmes": {}}, "'itmes'; did you mean 'items'"),
        ({"container": (30, 0, 3), "items": {"diamond": 1}}, "outside the box"),
        (bn.Claim.located("diamond", (30, 0, 3)), "outside the box"),
        (bn.Claim.position("carol", (3, 0, 3)), "names an unknown agent; agents are"),
        ("the diamond is there", "is no claim"),
    ],
)
def test_a_claim_about_what_is_not_there_is_not_said(claim: bn.Claim, message: str) -> None:
    there = world()
    for speak in (
        lambda: there.say("sally", "x", claims=[claim]),
        lambda: there.whisper("sally", "anne", "x", claims=[claim]),
    ):
        with pytest.raises(bn.WorldError, match=message):
            speak()
    assert there.now == 0


@pytest.mark.parametrize("claims", [bn.Claim.located("diamond", CHEST), "diamond", None])
def test_claims_that_are_no_list_are_not_said(claims: Any) -> None:
    there = world()
    with pytest.raises(bn.WorldError, match=r"claims are .*; give a list of claims"):
        there.say("sally", "x", claims=claims)
    assert there.now == 0


@pytest.mark.parametrize(
    "options",
    [{"testimony": "all"}, {"grace": -1}, {"grace": 1.5}, {"grace": True}, {"sincere": 1}],
)
def test_options_of_testimony_are_checked(options: dict[str, object]) -> None:
    with pytest.raises(bn.InputError, match=next(iter(options))):
        bn.Perception(**options)  # type: ignore[arg-type]
