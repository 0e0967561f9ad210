"""Claims that programs make, in the embedded world."""

import re
from collections.abc import Iterator

import pytest

import beliefnest as bn
from beliefnest.world.claims import claims_of

LEFT = (-2, -51, -4)
SPOT = "new Vec3(-2, -51, -4)"


@pytest.fixture(scope="module")
def nest(tmp_path_factory: pytest.TempPathFactory) -> Iterator[bn.Nest]:
    """Three agents in the hall of Sally and Anne, before anything is played."""
    store = tmp_path_factory.mktemp("claims") / "run.bn"
    with bn.Nest.open(bn.Scenario.load("sally-anne", 3), store=store, seed=0) as opened:
        yield opened


def test_skills_say_claims_beside_the_text(nest: bn.Nest) -> None:
    result = nest["/"].run(
        "sally",
        f"await say(bot, 'Look there!', [located('diamond', {SPOT}), positionOf('anne', {SPOT})])\n"
        f"await whisper(bot, 'anne', 'Psst', [absent('diamond', {SPOT}), "
        f"blockAt({SPOT}, 'chest[facing=north]')])\n"
        "await say(bot, 'No more.')",
    )
    assert result.ok, result.error
    assert [(e.detail["text"], e.detail.get("to"), claims_of(e)) for e in result.events] == [
        (
            "Look there!",
            None,
            (bn.Claim.located("diamond", LEFT), bn.Claim.position("anne", LEFT)),
        ),
        (
            "Psst",
            "anne",
            (bn.Claim.absent("diamond", LEFT), bn.Claim.block(LEFT, "chest[facing=north]")),
        ),
        ("No more.", None, ()),
    ]


@pytest.mark.parametrize(
    ("claims", "message"),
    [
        (f"[located('dimond', {SPOT})]", 'the name of an item.*"dimond"'),
        ("[located('diamond', 'there')]", 'the container of claims.0. must be a Vec3.*"there"'),
        ("[located('diamond', new Vec3(900, 0, 0))]", "outside the box"),
        (f"[positionOf('carol', {SPOT})]", "names .carol.; there are the agents anne"),
        (f"[blockAt({SPOT}, 'oak_door[opn=true]')]", "oak_door has no property opn"),
        (f"[blockAt({SPOT}, 'oak_door[open=maybe]')]", "open of oak_door is one of true, false"),
        ("'the diamond is there'", "must be a list"),
        ("[{kind: 'constructor'}]", "must be made with located, absent, positionOf or blockAt"),
    ],
)
def test_what_cannot_be_claimed_is_not_said(nest: bn.Nest, claims: str, message: str) -> None:
    result = nest["/"].run("sally", f"await say(bot, 'x', {claims})")
    assert result.error is not None
    assert result.error.skill == "say"
    assert not result.events
    assert re.search(message, result.error.message)
