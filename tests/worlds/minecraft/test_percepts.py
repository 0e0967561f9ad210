"""Programs that read percepts alone, in Minecraft: whatever the sandbox lets them read."""

import json
import re
import subprocess
from collections.abc import Iterator
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.profiles import at_night
from tests.servers import serving

import beliefnest as bn
from beliefnest.cli.app import run_command_line
from beliefnest.world.values import Point
from beliefnest.worlds.by_name import Worlds
from beliefnest.worlds.minecraft import node_messages
from beliefnest.worlds.minecraft.node_files import node_path

NODE = Path(bn.__file__).parent / "worlds" / "minecraft" / "node"
READS = (Path(__file__).parent / "reads.js").read_text()
FLOOR = {"block": "stone", "fill": [[0, 0, 0], [9, 0, 6]]}
WALL = {"block": "bricks", "fill": [[4, 1, 0], [4, 3, 6]]}
GAP = {"block": "air", "fill": [[4, 1, 0], [4, 2, 0]]}
ROOM: dict[str, Any] = {
    "name": "room",
    "box": [[0, 0, 0], [9, 3, 6]],
    "agents": {
        "ann": {"position": [1.5, 1, 3.5], "inventory": {"bread": 2, "dirt": 3}},
        "bob": {"position": [8.5, 1, 4.5], "inventory": {"emerald": 2, "bread": 1}},
    },
    "static_blocks": ["stone"],
    "perception": {"hearing": "sight", "containers": "opaque"},
}

# Members of `bot` that do something, or wait; what comes of it is told by what is perceived.
ACTS = frozenset(
    (
        *("chat", "whisper", "dig", "stopDigging", "placeBlock"),
        *(
            "activateBlock",
            "updateSign",
            "activateEntity",
            "activateItem",
            "deactivateItem",
            "useOn",
        ),
        *("attack", "swingArm", "lookAt", "look", "setControlState"),
        *("clearControlStates", "waitForTicks", "waitForChunksToLoad", "equip", "unequip"),
        *("setQuickBarSlot", "toss", "tossStack", "consume", "sleep"),
        *("wake", "openContainer", "openChest", "openDispenser", "openFurnace"),
        *("openBlock", "closeWindow", "craft"),
    )
)


@pytest.fixture(scope="module")
def worlds() -> Iterator[Worlds]:
    with Worlds(0) as lending:
        yield lending


@cache
def policy() -> dict[str, Any]:
    """Return the members that the sandbox lets programs reach, by kind, and the events."""
    script = (
        "const { kindNames } = require('./src/sandbox/policy/kinds');"
        "const { events } = require('./src/sandbox/policy/events');"
        "console.log(JSON.stringify({ kinds: kindNames, events: Object.keys(events) }))"
    )
    told = subprocess.run(
        [str(node_path()), "-e", script], cwd=NODE, check=True, capture_output=True, text=True
    )
    result: dict[str, Any] = json.loads(told.stdout)
    return result


def reader(then: str) -> str:
    """Return a program that reads all it can, does something, and reads again."""
    gets = sorted({name for kind in policy()["kinds"].values() for name in kind["gets"]})
    events = [name for name in policy()["events"] if name != "physicTick"]
    names = f"const gets = {json.dumps(gets)}, events = {json.dumps(events)}"
    return f"{names}\n{READS}\nread(1)\n{then}\nread(2)\nconsole.log(JSON.stringify(happened))"


def played(
    worlds: Worlds,
    ann: str,
    bob: str = "",
    world: str = "embedded",
    items: dict[str, int] | None = None,
    **more: Any,
) -> tuple[bn.ProgramResult, Point | None]:
    """Return the result of Ann's program while Bob acts, and her place at the end."""
    chest = [{"at": [8, 1, 5], "items": items or {}}]
    scenario = bn.Scenario.from_mapping({**ROOM, "containers": chest, **more})
    with bn.Nest.open(scenario, world=world, worlds=worlds) as nest:
        result = nest["/"].run_all({"ann": ann, "bob": bob}, 400, "percepts")["ann"]
        return result, nest["/"].state.agents["ann"].position


def test_every_call_of_a_bot_is_an_act_or_is_looked_at() -> None:
    looks = re.search(r"function looks.*?\n}", READS, re.DOTALL)
    assert looks is not None
    named = set(re.findall(r"^ {4}(\w+):", looks[0], re.MULTILINE)) - {"random", "time"}
    assert set(policy()["kinds"]["bot"]["calls"]) == ACTS | named


BOBS = (
    "",
    "bot.chat('hello'); await bot.toss(mcData.itemsByName.emerald.id, null, 1)",
    "await depositItemIntoChest(bot, new Vec3(8, 1, 5), {emerald: 1}); Math.random()",
    "bot.setControlState('jump', true); await bot.waitForTicks(30)",
    "await think(bot, 'psst'); await goToPosition(bot, new Vec3(7, 1, 6), 0)",
)
# Deeds that show nothing beyond the wall or far away.
NEAR = (
    "await goToPosition(bot, new Vec3(2, 1, 1), 0)",
    "await bot.toss(mcData.itemsByName.bread.id, null, 1); await bot.waitForTicks(4)",
    "await placeItem(bot, 'dirt', new Vec3(2, 1, 3))",
    "await waitUntil(bot, () => bot.players.bob.entity, 9).catch(e => console.log(e.message))",
)
BEYOND = (
    *NEAR,
    "await goToPosition(bot, new Vec3(8, 1, 1), 0).catch(error => console.log(error.message))",
    "await getItemFromChest(bot, new Vec3(8, 1, 5), {apple: 1}).catch(e => console.log(e.message))",
    "await giveItemToOther(bot, 'bob', 'bread', 1).catch(error => console.log(error.message))",
)
PLACES = st.tuples(st.integers(7, 9), st.integers(1, 3), st.integers(0, 3))
HIDDEN = st.dictionaries(PLACES, st.sampled_from(["dirt", "lever", "glass"]), max_size=4)
ITEMS = st.dictionaries(st.sampled_from(["apple", "diamond"]), st.integers(1, 3))


@settings(max_examples=at_night(300, 2), deadline=None)
@given(blocks=HIDDEN, items=ITEMS, bob=st.sampled_from(BOBS), then=st.sampled_from(BEYOND))
def test_what_lies_behind_a_wall_changes_no_value_that_is_read(
    worlds: Worlds,
    blocks: dict[tuple[int, int, int], str],
    items: dict[str, int],
    bob: str,
    then: str,
) -> None:
    hidden = [{"block": name, "at": list(place)} for place, name in sorted(blocks.items())]
    plain, _ = played(worlds, reader(then), blocks=[FLOOR, WALL])
    changed, _ = played(worlds, reader(then), bob, items=items, blocks=[FLOOR, WALL, *hidden])
    assert plain.error is None, plain.error
    assert (changed.log, changed.ticks) == (plain.log, plain.ticks)


@settings(max_examples=at_night(300, 2), deadline=None)
@given(
    blocks=HIDDEN,
    items=ITEMS,
    bob=st.sampled_from(BOBS),
    then=st.sampled_from(NEAR),
    eyes=st.sampled_from([{"max_visible_distance": 3}, {"field_of_view": 60}]),
)
def test_what_is_too_far_or_behind_one_s_back_changes_no_value_that_is_read(
    worlds: Worlds,
    blocks: dict[tuple[int, int, int], str],
    items: dict[str, int],
    bob: str,
    then: str,
    eyes: dict[str, int],
) -> None:
    hidden = [{"block": name, "at": list(place)} for place, name in sorted(blocks.items())]
    room = {"perception": {**ROOM["perception"], **eyes}}
    # An agent that looks west all the time sees nothing in the east.
    act = then if "max_visible_distance" in eyes else "await bot.waitForTicks(9)"
    begin = "await bot.look(Math.PI / 2, 0, true); await bot.waitForTicks(1)"
    ann = f"{begin}\n{reader(act)}"
    plain, _ = played(worlds, ann, blocks=[FLOOR], **room)
    changed, _ = played(worlds, ann, bob, items=items, blocks=[FLOOR, *hidden], **room)
    assert plain.error is None, plain.error
    assert (changed.log, changed.ticks) == (plain.log, plain.ticks)


@pytest.mark.parametrize("world", ["embedded", "scripted"])
@pytest.mark.parametrize("walls", [(WALL,), (WALL, GAP)], ids=["wall", "gap"])
def test_who_sees_nothing_gropes_along_what_the_body_bumps_into(
    worlds: Worlds, world: str, walls: tuple[dict[str, Any], ...]
) -> None:
    room = {"perception": {"max_visible_distance": 0.3}, "blocks": [FLOOR, *walls]}
    scenario = bn.Scenario.from_mapping({**ROOM, **room})
    code = "await goToPosition(bot, new Vec3(7, 1, 3), 0)"
    with bn.Nest.open(scenario, world=world, worlds=worlds) as nest:
        result = nest["/"].run("ann", code, 1200, senses="percepts")
        there = nest["/"].state.agents["ann"].position
    assert there is not None
    if GAP in walls:
        assert result.ok, result.error
        assert there[0] > 7
    else:
        assert result.error is not None
        assert result.error.reason == "no_way"
        assert there[0] < WALL["fill"][0][0]


def test_a_fault_in_telling_percepts_leaves_everything_as_it_was(
    worlds: Worlds, monkeypatch: pytest.MonkeyPatch
) -> None:
    scenario = bn.Scenario.from_mapping({**ROOM, "blocks": [FLOOR]})
    walk = "await goToPosition(bot, new Vec3(7, 1, 1), 0)"
    with bn.Nest.open(scenario, worlds=worlds) as nest:
        before = nest["/"].state.agents["ann"]
        told = node_messages.percepts_changes

        def failing(*sensed: Any) -> Any:
            if len(failed) < 3:
                failed.append(told(*sensed))
                return failed[-1]
            raise RuntimeError("no more")

        failed: list[Any] = []
        with monkeypatch.context() as patched, pytest.raises(RuntimeError, match="no more"):
            patched.setattr(node_messages, "percepts_changes", failing)
            nest["/"].run("ann", walk, senses="percepts")
        assert nest["/"].state.agents["ann"] == before
        assert nest["/"].run("ann", walk, senses="percepts").ok


def test_with_the_whole_world_the_same_program_reads_it(worlds: Worlds) -> None:
    scenario = bn.Scenario.from_mapping({**ROOM, "blocks": [FLOOR, WALL]})
    code = "console.log(bot.players.bob.entity === null, bot.blockAt(new Vec3(8, 1, 1)) === null)"
    with bn.Nest.open(scenario, worlds=worlds) as nest:
        seen = nest["/"].run("ann", code)
        kept = nest["/"].run("ann", code, senses="percepts")
    assert (seen.log, kept.log) == (("false false",), ("true true",))


HEARS = """
const heard = []
for (const event of ['chat', 'whisper', 'messagestr']) {
  bot.on(event, (...told) => heard.push([event, ...told].join(' ')))
}
await bot.waitForTicks(12)
console.log(heard.join('; '))"""
SAYS = "await say(bot, 'hi'); await whisper(bot, 'ann', 'psst'); await doNothing(bot)"
WHISPERED = "whisper bob psst; messagestr bob whispers to you: psst"


@pytest.mark.parametrize(
    ("hearing", "walls", "heard"),
    [
        ("sight", (WALL,), WHISPERED),
        ("sight", (), f"chat bob hi; messagestr <bob> hi; {WHISPERED}"),
        ("global", (WALL,), f"chat bob hi; messagestr <bob> hi; {WHISPERED}"),
    ],
)
def test_a_program_hears_what_its_agent_hears(
    worlds: Worlds, hearing: str, walls: tuple[dict[str, Any], ...], heard: str
) -> None:
    room = {"perception": {"hearing": hearing}, "blocks": [FLOOR, *walls]}
    result, _ = played(worlds, HEARS, SAYS, **room)
    assert result.log == (heard,)


def test_in_a_belief_one_reads_what_is_believed_there(worlds: Worlds) -> None:
    look = """
      const names = [new Vec3(8, 1, 5), new Vec3(5, 1, 0)].map(place => bot.blockAt(place)?.name)
      const there = ['bob', 'ann'].map(name => Boolean(bot.players[name]?.entity))
      console.log(names.join(), ...there)"""
    scenario = bn.Scenario.from_mapping({**ROOM, "blocks": [FLOOR, WALL]})
    wall = [(4, y, z) for y in (1, 2, 3) for z in range(7)]
    with bn.Nest.open(scenario, worlds=worlds) as nest:
        nest["/ann"].switch("before")
        assert nest["/ann"].run("ann", look).log == ("air,air false true",)
        # In her own belief what she knows is all there is, and what she does not is unknown.
        assert nest["/ann"].run("ann", look, senses="percepts").log == (", false true",)
        for name in ("air", "bricks"):
            nest["/"].edit(blocks=dict.fromkeys(wall, name))
            nest["/"].step(1)
        nest["/ann"].switch("follow")
        nest["/ann"].switch("after")
        # She knows where Bob was; that he sees her there, behind the wall, she does not believe.
        assert nest["/ann"].run("ann", look, senses="percepts").log == ("air,air true true",)
        assert nest["/ann"].run("bob", look, senses="percepts").log == ("air,air true false",)


@pytest.mark.parametrize("world", ["embedded", "scripted"])
def test_an_experiment_comes_out_the_same(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], world: str
) -> None:
    built_in = resources.files("beliefnest.scenarios").joinpath("builtin", "sally-anne.yaml")
    file = tmp_path / "careful.yaml"
    file.write_text(f"senses: percepts\n{built_in.read_text(encoding='utf-8')}")
    assert run_command_line(["run", str(file), "--condition", "3", "--world", world]) == 0
    assert "NO" not in capsys.readouterr().out


@pytest.mark.long
def test_on_a_server_elsewhere_programs_read_no_more() -> None:
    low = -50
    blocks = [
        {**each, "fill": [[x, y + low, z] for x, y, z in each["fill"]]}
        for each in (FLOOR, WALL, GAP)
    ]
    agents = {"ann": {"position": [1.5, low + 1, 3.5]}, "bob": {"position": [8.5, low + 1, 4.5]}}
    room = {"box": [[0, low, 0], [9, low + 3, 6]], "blocks": blocks, "agents": agents}
    code = f"""
      console.log(bot.players.bob.entity === null)
      await goToPosition(bot, new Vec3(7, {low + 1}, 3), 0)
      console.log(bot.players.bob.entity === null)"""
    with (
        serving() as server,
        bn.Nest.open(bn.Scenario.from_mapping({**ROOM, **room}), world=server.address()) as nest,
    ):
        result = nest["/"].run("ann", code, senses="percepts")
    assert result.log == ("true", "false")


PROGRAMS = {
    "what is seen": """
        const names = []
        for (let x = 0; x <= 9; x++) {
          for (let z = 0; z <= 6; z++) names.push(bot.blockAt(new Vec3(x, 1, z))?.name ?? null)
        }
        console.log(names.join(), bot.players.bob.entity === null)""",
    "through the gap": """
        await goToPosition(bot, new Vec3(6, 1, 3), 0)
        console.log(bot.players.bob.entity.position, bot.blockAt(new Vec3(8, 1, 5)).name)
        await goToPosition(bot, new Vec3(1, 1, 6), 0)
        console.log(bot.players.bob.entity === null, bot.blockAt(new Vec3(8, 1, 5)).name)""",
    "a chest that was never seen": """
        await getItemFromChest(bot, new Vec3(8, 1, 5), {apple: 1})
        console.log(bot.inventory.items().map(({ name, count }) => name + count).sort().join())
        await depositItemIntoChest(bot, new Vec3(8, 1, 5), {bread: 2})
        console.log(bot.inventory.items().map(({ name, count }) => name + count).sort().join())""",
    "a chest that is not there": """
        await getItemFromChest(bot, new Vec3(8, 1, 1), {apple: 1}).catch(() => console.log('none'))
        console.log(bot.entity.position.x > 4)""",
    "what is written": """
        console.log(await readSign(bot, new Vec3(8, 1, 1)).catch(() => 'unseen'))
        await goToPosition(bot, new Vec3(6, 1, 3), 0)
        console.log(bot.blockAt(new Vec3(8, 1, 1)).getSignText()[0])
        console.log(await readSign(bot, new Vec3(8, 1, 1)))
        await writeSign(bot, new Vec3(8, 1, 1), 'no food')
        await goToPosition(bot, new Vec3(1, 1, 3), 0)
        console.log(await readSign(bot, new Vec3(8, 1, 1)))""",
    "no way": """
        await goToPosition(bot, new Vec3(20, 1, 1), 0).catch(() => console.log('no way'))""",
    "somebody unseen": """
        await giveItemToOther(bot, 'bob', 'bread', 1).catch(() => console.log('unseen'))
        await goToPosition(bot, new Vec3(6, 1, 3), 0)
        await giveItemToOther(bot, 'bob', 'bread', 1)
        console.log(bot.inventory.items().map(({ name, count }) => name + count).sort().join())""",
}


def bare(text: str) -> str:
    """Return a console line without what only one of the worlds writes around values."""
    return re.sub(r"[\[\]() ]", "", text)


@pytest.mark.parametrize("what", PROGRAMS)
def test_both_worlds_answer_the_same(worlds: Worlds, what: str) -> None:
    sign = {"block": "oak_sign", "at": [8, 1, 1]}
    texts = [{"at": [8, 1, 1], "text": "tools"}]
    blocks = [FLOOR, WALL, GAP, *([sign] if "written" in what else [])]
    room = {"blocks": blocks, "items": {"apple": 1}, "signs": texts if "written" in what else []}
    found, there = played(worlds, PROGRAMS[what], **room)
    told, place = played(worlds, PROGRAMS[what], world="scripted", **room)
    assert found.error is None, found.error
    assert told.error is None, told.error
    assert [bare(text) for text in found.log] == [bare(text) for text in told.log]
    assert there is not None
    assert place is not None
    assert there == pytest.approx(place, abs=3.5)
