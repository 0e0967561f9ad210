"""Claims on signs, clause by clause (semantics, section 8.5), in the nest and in the reference."""

from pathlib import Path
from typing import Any

import pytest
from tests.semantics.reference import Reference
from tests.semantics.test_against_reference import split

import beliefnest as bn
from beliefnest.belief.grounds import Basis, Source
from beliefnest.errors import InputError, WorldError
from beliefnest.timeline.export_tables import entry_rows, snapshot_rows
from beliefnest.timeline.journal import TimelineKey
from beliefnest.world.registry import Registry
from beliefnest.world.values import EventKind, Position

LEFT, RIGHT, SIGN = (3, 0, 3), (17, 0, 3), (10, 0, 12)
HOME, AT_SIGN, ALSO_THERE, FAR = (3.5, 0, 5.5), (9.5, 0, 14.5), (11.5, 0, 14.5), (1.5, 0, 19.5)
THERE = bn.Claim.located("diamond", RIGHT)
GRACE = 10


class Hall:
    """The nest and the reference, told the same things. Sight ends at 6 blocks."""

    def __init__(
        self,
        signs: dict[Position, str] | None = None,
        claims: dict[Position, list[bn.Claim]] | None = None,
        store: Path | None = None,
        static_blocks: tuple[str, ...] = (),
        depth: int = 2,
        **options: Any,
    ) -> None:
        options = {"max_visible_distance": 6, "grace": GRACE, "testimony": "informed"} | options
        self.world = bn.ScriptedWorld(
            ((0, 0, 0), (20, 1, 20)),
            {SIGN: "oak_sign"},
            agents={"max": HOME, "nora": AT_SIGN, "bob": FAR},
            containers={LEFT: {"diamond": 1}, RIGHT: {}},
            signs=signs,
            sign_claims=claims,
        )
        perception = bn.Perception(**options)
        self.nest = bn.Nest(self.world, perception, store=store, static_blocks=static_blocks)
        start = self.world.snapshot()
        self.reference = Reference(start, perception, frozenset(static_blocks), depth=depth)
        self.world.listen(lambda frame: self.reference.frame((), frame))

    def where(self, path: str) -> list[Position]:
        """Containers in which a node, and that of the reference, believes the diamond to be."""
        found = dict(self.nest[path].state.containers)
        assert found == self.reference.everything(split(path))["containers"]
        return sorted(place for place, held in found.items() if "diamond" in held.items)

    def write(self, name: str = "nora", text: str = "right", claim: bn.Claim = THERE) -> None:
        self.world.write_sign(name, SIGN, text, claims=[claim])


@pytest.mark.parametrize("testimony", ["none", "accept", "informed"])
def test_a_sign_is_read_by_who_comes_to_see_it(testimony: str) -> None:
    hall = Hall(depth=3, testimony=testimony)
    hall.write()
    assert hall.where("/max") == hall.where("/bob/max") == []
    hall.world.place_agent("max", ALSO_THERE)
    believed = [] if testimony == "none" else [RIGHT]
    assert hall.where("/max") == hall.where("/nora/max") == hall.where("/max/nora/max") == believed
    if believed:
        # Its writer is unknown.
        basis = hall.nest["/max"].state.containers[RIGHT].basis
        assert basis == Basis(hall.world.now, Source.HEARD)


@pytest.mark.parametrize("path", ["/max", "/nora/max", "/max/nora", "/max/nora/max"])
def test_who_sees_it_written_has_it_from_the_writer(path: str) -> None:
    hall = Hall(depth=3)
    hall.world.place_agent("max", ALSO_THERE)
    hall.write()
    assert hall.where(path) == [RIGHT]
    basis = hall.nest[path].state.containers[RIGHT].basis
    assert basis == Basis(hall.world.now, Source.HEARD, EventKind.CHAT, "nora")
    assert hall.where("/nora") == []


def test_nobody_unknown_is_taken_at_their_word() -> None:
    hall = Hall()
    hall.write()
    hall.world.place_agent("max", ALSO_THERE)
    # To Max, Nora reads the sign as he does: he does not know that she wrote it.
    assert hall.where("/max/nora") == [RIGHT]
    assert hall.where("/nora") == []
    hall = Hall(max_visible_distance=None)
    hall.world.open("max", LEFT)
    hall.write()
    assert hall.where("/max") == [LEFT]


def test_1b_holds_where_nobody_is_known_to_have_written_it() -> None:
    hall = Hall()
    hall.world.open("max", LEFT)
    hall.write()
    hall.world.place_agent("max", ALSO_THERE)
    # Within the grace period: had it been Nora, she would have had no chance to learn it.
    assert hall.where("/max") == [RIGHT]
    hall = Hall(max_visible_distance=None)
    hall.world.open("max", LEFT)
    hall.world.say("nora", "right", claims=[THERE])
    assert hall.where("/max") == [LEFT]


def test_what_is_perceived_beats_what_is_read() -> None:
    hall = Hall(containers="transparent", max_visible_distance=None, testimony="accept")
    hall.write()
    assert hall.where("/max") == [LEFT]


def test_each_text_on_each_sign_is_read_once() -> None:
    hall = Hall(testimony="accept")
    hall.world.place_agent("max", ALSO_THERE)
    hall.write()
    assert hall.where("/max") == [RIGHT]
    hall.world.place_agent("max", HOME)
    hall.world.open("max", LEFT)
    hall.world.place_agent("max", ALSO_THERE)
    assert hall.where("/max") == [LEFT, RIGHT]
    hall.write(text="elsewhere", claim=bn.Claim.absent("diamond", LEFT))
    assert hall.where("/max") == [RIGHT]
    hall.world.place_agent("max", HOME)
    hall.world.open("max", LEFT)
    hall.write(text="right")
    hall.world.place_agent("max", ALSO_THERE)
    # The old text is nothing new.
    assert hall.where("/max") == [LEFT, RIGHT]


def test_a_text_that_was_read_before_it_claimed_anything_is_nothing_new() -> None:
    hall = Hall(testimony="accept", signs={SIGN: "right"})
    hall.world.place_agent("max", ALSO_THERE)
    hall.world.place_agent("max", HOME)
    hall.world.write_sign("nora", SIGN, "")
    hall.write()
    hall.world.place_agent("max", ALSO_THERE)
    assert hall.where("/max") == []
    hall.world.place_agent("bob", AT_SIGN)
    assert hall.where("/bob") == [RIGHT]


@pytest.mark.parametrize("static", [(), ("oak_sign",)])
def test_signs_claim_something_from_the_start(static: tuple[str, ...]) -> None:
    hall = Hall({SIGN: "right"}, {SIGN: [THERE]}, static_blocks=static, depth=3)
    assert (hall.where("/nora"), hall.where("/nora/bob")) == ([RIGHT], [])
    hall.world.place_agent("max", ALSO_THERE)
    for path in ("/max", "/max/nora", "/nora/max", "/max/nora/max"):
        assert hall.where(path) == [RIGHT]


def test_positions_and_blocks_are_believed_too() -> None:
    told = [bn.Claim.position("bob", (5.5, 0, 5.5)), bn.Claim.block((19, 0, 19), "gold_block")]
    hall = Hall(signs={SIGN: "bob"}, claims={SIGN: told})
    state = hall.nest["/nora"].state
    assert state.agents["bob"].position == (5.5, 0, 5.5)
    assert state.agents["bob"].basis == Basis(0, Source.HEARD)
    assert state.blocks[19, 0, 19] == "gold_block"
    assert state.blocks.basis((19, 0, 19)) == Basis(0, Source.HEARD)


def test_a_belief_that_is_forked_knows_what_signs_say() -> None:
    hall = Hall(testimony="accept")
    hall.write()
    hall.nest["/nora"].switch("what if")
    inner = hall.nest["/nora"].scripted
    inner.place_agent("nora", (9.5, 0, 10.5))
    assert dict(hall.nest["/nora/nora"].state.containers) == dict(
        hall.nest["/nora"].state.containers
    )
    inner.write_sign("nora", SIGN, "left", claims=[bn.Claim.located("diamond", LEFT)])
    (made,) = hall.nest.claims("/nora")
    assert (made.text, made.speaker, made.made_in) == ("left", "nora", "/nora")


def test_what_was_claimed_is_listed_with_who_read_it() -> None:
    hall = Hall(signs={SIGN: "right"}, claims={SIGN: [THERE]})
    hall.world.place_agent("max", ALSO_THERE)
    hall.write(text="left", claim=bn.Claim.located("diamond", LEFT))
    first, second = hall.nest.claims()
    assert (first.tick, first.speaker, first.sign, first.false, first.lie) == (
        0,
        None,
        SIGN,
        True,
        False,
    )
    assert first.hearers == ("max", "nora")
    assert first.taken_up("/max") and not first.taken_up("/bob")
    assert first.why("/max").startswith(f"max believes what the sign at {SIGN} says")
    assert first.why("/bob") == "bob has not read it"
    assert first.heard_at("/max") == 1
    assert (second.speaker, second.false, second.lie) == ("nora", False, True)
    assert second.taken_up("/max") and not second.taken_up("/nora")
    assert second.condition("/nora") == "4"
    assert second.condition("/max/nora") == "3"
    assert "sign" in repr(first)


def test_an_explanation_tells_of_the_sign() -> None:
    hall = Hall(signs={SIGN: "right"}, claims={SIGN: [THERE]})
    told = str(hall.nest["/nora"].explain(container=RIGHT))
    assert "nora read on the sign at (10, 0, 12) at tick 0 that diamond is in (17, 0, 3)" in told
    hall.world.place_agent("max", ALSO_THERE)
    told = str(hall.nest["/max"].explain(container=RIGHT))
    assert "max read on the sign at (10, 0, 12) at tick 1 that diamond is in (17, 0, 3)" in told
    hall.write(text="left", claim=bn.Claim.located("diamond", LEFT))
    told = str(hall.nest["/max"].explain(container=LEFT))
    assert "max read on the sign at (10, 0, 12), which nora wrote, at tick 2 that" in told


def test_signs_are_kept_in_run_files(tmp_path: Path) -> None:
    store = tmp_path / "run.bn"
    hall = Hall(signs={SIGN: "right"}, claims={SIGN: [THERE]}, store=store)
    hall.write(text="left", claim=bn.Claim.located("diamond", LEFT))
    hall.nest.close()
    with bn.Nest.resume(store) as nest:
        nest["/"].scripted.place_agent("max", ALSO_THERE)
        assert nest["/max"].state.containers[LEFT].items == {"diamond": 1}
        assert [claim.speaker for claim in nest.claims()] == [None, "nora"]
    with bn.Nest.read(store) as read:
        assert read["/max"].state.containers[LEFT].items == {"diamond": 1}


def test_exports_tell_what_signs_claim() -> None:
    hall = Hall(signs={SIGN: "right"}, claims={SIGN: [THERE]})
    start, frames = hall.world.snapshot(), []
    hall.world.listen(frames.append)
    hall.write(text="left", claim=bn.Claim.located("diamond", LEFT))
    key, registry = TimelineKey((), "main"), Registry.load()
    rows = [*snapshot_rows(key, start, registry), *entry_rows(key, 0, frames[0], registry)]
    assert [
        (row["text"], [claim["place"] for claim in row["claims"]])
        for table, row in rows
        if table == "signs"
    ] == [("right", [RIGHT]), ("left", [LEFT])]


def test_a_sign_that_is_turned_claims_what_it_claimed() -> None:
    hall = Hall()
    hall.write()
    hall.world.set_block(SIGN, "oak_sign[rotation=4]")
    hall.world.place_agent("max", ALSO_THERE)
    assert hall.where("/max") == [RIGHT]
    assert len(hall.nest.claims()) == 1
    hall.world.set_block(SIGN, "air")
    hall.world.set_block(SIGN, "oak_sign")
    assert hall.world.snapshot().sign_claims == {}


def test_what_cannot_be_claimed_is_refused() -> None:
    hall = Hall()
    with pytest.raises(WorldError, match="outside the box"):
        hall.write(claim=bn.Claim.located("diamond", (40, 0, 0)))
    with pytest.raises(WorldError, match="cannot carry claims"):
        hall.write(text="")
    with pytest.raises((WorldError, InputError), match="no text"):
        Hall(claims={SIGN: [THERE]})
    assert hall.world.signs == {}
