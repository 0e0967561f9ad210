"""The same programs are the same deeds in the scripted world as in Minecraft."""

import json
from collections.abc import Iterator

import numpy as np
import pytest
from msgspec.structs import replace
from tests.shared_worlds import WORLDS

from beliefnest.world.frames import Frame, Snapshot
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import AgentState, Box, Event, EventKind, Position
from beliefnest.worlds.by_name import open_world
from beliefnest.worlds.protocol import RunRules, World

BOX = Box((0, 0, 0), (8, 4, 8))
SALLY, ANNE = (1.5, 1.0, 3.5), (6.5, 1.0, 6.5)
LEVER, BUTTON, WOOL, FREE = (4, 1, 1), (6, 1, 1), (2, 1, 6), (4, 1, 6)
OFF, ON = (
    "lever[face=floor,facing=north,powered=false]",
    "lever[face=floor,facing=north,powered=true]",
)
OUT = "stone_button[face=floor,facing=north,powered=false]"
IN = "stone_button[face=floor,facing=north,powered=true]"
PLACES = {LEVER: OFF, BUTTON: OUT, WOOL: "white_wool"}

NOT_COMPARED = (EventKind.MOVE_TO,)


def start() -> Snapshot:
    registry = Registry.load()
    blocks = np.zeros(BOX.shape, dtype=np.int32)
    blocks[:, 0, :] = registry.state_id("stone")
    for place, text in PLACES.items():
        blocks[BOX.index(place)] = registry.state_id(text)
    agents = {
        "sally": AgentState(SALLY, inventory={"dirt": 2}),
        "anne": AgentState(ANNE, inventory={"red_wool": 1}),
    }
    return Snapshot(0, BOX, Terrain.of(blocks), {}, agents)


@pytest.fixture(params=WORLDS, scope="module")
def world(request: pytest.FixtureRequest) -> Iterator[World]:
    opened = open_world(request.param, 0)
    yield opened
    opened.close()


class Played:
    """Results of programs: return values, events, and the state of the world afterwards."""

    def __init__(
        self,
        world: World,
        programs: dict[str, str],
        further: int = 0,
        begun: Snapshot | None = None,
    ) -> None:
        frames: list[Frame] = []
        body = world.open_body("/", "seed", begun or start(), frames.append)
        self.results = body.run(programs, 600)
        body.step(further)
        self.there = body.snapshot()
        body.close()
        self.events: list[Event] = [each for frame in frames for each in frame.events]

    @property
    def told(self) -> list[tuple[EventKind, str | None, dict[str, object]]]:
        left = [each for each in self.events if each.kind not in NOT_COMPARED]
        return [(each.kind, each.actor, dict(each.detail)) for each in left]

    def block(self, place: Position) -> str:
        return Registry.load().text(int(self.there.blocks[BOX.index(place)]))

    def held(self, agent: str) -> dict[str, int]:
        return dict(self.there.agents[agent].inventory)


def update(place: Position, block: str) -> tuple[EventKind, str | None, dict[str, object]]:
    return (EventKind.BLOCK_UPDATE, None, {"position": place, "block": block})


def test_a_lever_is_switched_and_back(world: World) -> None:
    once = f"await turnOnLever(bot, new Vec3{LEVER})"
    # A lever that is on already is left as it is.
    played = Played(world, {"sally": f"{once}\n{once}"})
    assert played.results["sally"].ok, played.results["sally"].error
    assert played.block(LEVER) == ON
    assert played.told == [
        update(LEVER, ON),
        (EventKind.USE_LEVER, "sally", {"position": LEVER, "powered": True}),
    ]
    back = Played(world, {"sally": f"{once}\nawait turnOffLever(bot, new Vec3{LEVER})"})
    assert back.block(LEVER) == OFF
    assert back.told[-1][2] == {"position": LEVER, "powered": False}


def test_properties_of_blocks_are_of_the_same_types(world: World) -> None:
    read = f"console.log(JSON.stringify(bot.blockAt(new Vec3{LEVER}).getProperties()))"
    played = Played(world, {"sally": f"{read}; await turnOnLever(bot, new Vec3{LEVER}); {read}"})
    before, after = map(json.loads, played.results["sally"].log)
    assert before == {"face": "floor", "facing": "north", "powered": False}
    assert after == {**before, "powered": True}


def test_a_button_comes_out_again(world: World) -> None:
    pressed = Played(world, {"anne": f"await pressButton(bot, new Vec3{BUTTON})"})
    assert pressed.results["anne"].ok, pressed.results["anne"].error
    assert pressed.block(BUTTON) == IN
    assert pressed.told == [
        update(BUTTON, IN),
        (EventKind.PRESS_BUTTON, "anne", {"position": BUTTON}),
    ]
    later = Played(world, {"anne": f"await pressButton(bot, new Vec3{BUTTON})"}, further=30)
    assert later.block(BUTTON) == OUT
    assert later.told == [*pressed.told, update(BUTTON, OUT)]


def test_a_block_is_mined_and_taken(world: World) -> None:
    played = Played(world, {"sally": f"await mineBlock(bot, new Vec3{WOOL}, 'white_wool')"})
    assert played.results["sally"].ok, played.results["sally"].error
    assert played.block(WOOL) == "air"
    assert played.held("sally") == {"dirt": 2, "white_wool": 1}
    assert played.told == [
        update(WOOL, "air"),
        (EventKind.MINE_BLOCK, "sally", {"position": WOOL, "block": "white_wool"}),
    ]


def test_a_block_is_put_and_gone_from_the_inventory(world: World) -> None:
    played = Played(world, {"anne": f"await placeItem(bot, 'red_wool', new Vec3{FREE})"})
    assert played.results["anne"].ok, played.results["anne"].error
    assert played.block(FREE) == "red_wool"
    assert played.held("anne") == {}
    assert played.told == [
        update(FREE, "red_wool"),
        (EventKind.PLACE_BLOCK, "anne", {"position": FREE, "block": "red_wool"}),
    ]


def test_agents_may_have_names_that_all_objects_of_javascript_have(world: World) -> None:
    begun = start()
    agents = dict(zip(("constructor", "valueOf"), begun.agents.values(), strict=True))
    code = f"await turnOnLever(bot, new Vec3{LEVER}); console.log(Object.keys(bot.players).length)"
    played = Played(world, {"constructor": code}, begun=replace(begun, agents=agents))
    assert played.results["constructor"].log == ("2",), played.results["constructor"].error
    assert played.block(LEVER) == ON


def test_programs_read_stacks_as_they_fill_slots(world: World) -> None:
    chest, begun = (4, 1, 4), start()
    blocks = begun.blocks.draft()
    blocks[BOX.index(chest)] = Registry.load().state_id("chest")
    has = replace(begun.agents["sally"], inventory={"dirt": 70, "ender_pearl": 16, "bow": 2})
    agents, contents = {**begun.agents, "sally": has}, {chest: {"bread": 130}}
    begun = replace(begun, blocks=blocks.terrain(), containers=contents, agents=agents)
    code = f"""
        const told = items => console.log(JSON.stringify(items.map(i => [i.name, i.count]).sort()))
        told(bot.inventory.items())
        await goToPosition(bot, new Vec3{chest}, 1)
        const chest = await bot.openContainer(bot.blockAt(new Vec3{chest}))
        told(chest.containerItems())
    """
    result = Played(world, {"sally": code}, begun=begun).results["sally"]
    assert [json.loads(line) for line in result.log] == [
        [["bow", 1], ["bow", 1], ["dirt", 6], ["dirt", 64], ["ender_pearl", 16]],
        [["bread", 2], ["bread", 64], ["bread", 64]],
    ], result.error


@pytest.mark.parametrize(
    "program",
    [
        f"await turnOnLever(bot, new Vec3{BUTTON})",
        f"await pressButton(bot, new Vec3{LEVER})",
        f"await mineBlock(bot, new Vec3{WOOL}, 'dirt')",
        "await mineBlock(bot, new Vec3(1, 0, 4), 'stone')",
        f"await placeItem(bot, 'red_wool', new Vec3{FREE})",
        f"await placeItem(bot, 'dirt', new Vec3{WOOL})",
        "await placeItem(bot, 'dirt', new Vec3(4, 3, 4))",
        f"await placeItem(bot, 'dirt', new Vec3({int(ANNE[0])}, 1, {int(ANNE[2])}))",
    ],
    ids=[
        "no-lever",
        "no-button",
        "another-block",
        "no-tool",
        "not-there",
        "taken",
        "in-the-air",
        "somebody",
    ],
)
def test_what_cannot_be_done_is_not_done(world: World, program: str) -> None:
    played = Played(world, {"sally": program})
    assert not played.results["sally"].ok
    assert played.results["sally"].error is not None
    assert played.results["sally"].error.skill is not None
    assert played.told == []
    assert played.there.blocks == start().blocks
    assert played.held("sally") == {"dirt": 2}


def test_what_is_said_is_heard_when_the_time_it_takes_is_over(world: World) -> None:
    frames: list[Frame] = []
    body = world.open_body("/", "seed", start(), frames.append)
    program = """
      bot.chat('one')
      await say(bot, 'two')
      await whisper(bot, 'anne', 'three')
    """
    result = body.run({"sally": program}, 200, None, RunRules(speech_ticks=10))["sally"]
    assert result.ok, result.error
    ticks = {text: tick for tick, text in result.said}
    # As long as it takes, up to the tick in which the game passes it on.
    assert [ticks["two"] - ticks["one"], ticks["three"] - ticks["two"]] == pytest.approx(
        [10, 10], abs=2
    )
    assert ticks["one"] == pytest.approx(10, abs=2)
    late = body.run({"sally": "bot.chat('too late')"}, 5, None, RunRules(speech_ticks=10))["sally"]
    assert late.said == ()
    again = body.run({"sally": "await say(bot, 'at once')"}, 200)["sally"]
    assert again.said[0][0] <= body.tick <= late.ticks + result.ticks + 4
    body.close()


def test_programs_hear_what_is_said_and_answer(world: World) -> None:
    asks = """
      const got = []
      bot.on('chat', (who, text) => { got.push(`${who}: ${text}`) })
      bot.once('whisper', (who, text) => { got.push(`${who} whispers ${text}`) })
      await say(bot, 'where is it?')
      const first = await waitForChat(bot, 60)
      const second = await waitForChat(bot, 60)
      const third = await waitForChat(bot, 10)
      console.log(JSON.stringify([first, second, third, got]))
    """
    answers = """
      const asked = await waitForChat(bot)
      await say(bot, `you said ${asked.text}`)
      await waitTicks(bot, 4)
      await whisper(bot, 'sally', 'psst')
    """
    played = Played(world, {"sally": asks, "anne": answers})
    assert all(each.ok for each in played.results.values()), played.results
    first, second, third, got = json.loads(played.results["sally"].log[0])
    assert first == {"speaker": "anne", "text": "you said where is it?", "whispered": False}
    assert second == {"speaker": "anne", "text": "psst", "whispered": True}
    assert third is None
    assert got == [
        "sally: where is it?",
        "anne: you said where is it?",
        "anne whispers psst",
    ]


def test_a_listener_that_fails_ends_its_program(world: World) -> None:
    listens = "bot.on('chat', () => { throw new Error('oh') }); await waitTicks(bot, 20)"
    speaks = "await waitTicks(bot, 5); bot.chat('hi')"
    results = Played(world, {"sally": listens, "anne": speaks}).results
    assert not results["sally"].ok
    assert "oh" in str(results["sally"].error)
    assert results["sally"].ticks < 20


@pytest.mark.parametrize("end", ["", "throw new Error('no')"])
def test_what_is_said_is_said_whether_it_is_waited_for_or_not(world: World, end: str) -> None:
    words = "say(bot, 'one'); whisper(bot, 'anne', 'two'); think(bot, 'three')"
    played = Played(world, {"sally": f"{words}\n{end}"})
    assert {detail["text"] for _, _, detail in played.told} == {"one", "two", "three"}
    assert played.results["sally"].ticks == 1


def test_targets_of_calls_are_noted_by_every_world_alike(world: World) -> None:
    calls = [
        (f"goToPosition(bot, new Vec3{FREE})", FREE, None, False),
        (f"placeItem(bot, 'red_wool', new Vec3{FREE})", FREE, None, True),
        (f"writeSign(bot, new Vec3{FREE}, 'hello')", FREE, None, True),
        ("giveItemToOther(bot, 'anne', 'dirt', 1)", None, "anne", True),
    ]
    program = "\n".join(f"await {call}.catch(() => {{}})" for call, *_ in calls)
    aims = Played(world, {"sally": program}).results["sally"].aims
    expected = [(call.partition("(")[0], *target) for call, *target in calls]
    assert [(aim.call, aim.place, aim.agent, aim.uses) for aim in aims] == expected


def test_a_chest_takes_and_gives_as_much_as_there_is_and_room_for(world: World) -> None:
    chest, full = (4, 1, 4), (1, 1, 1)
    begun = start()
    blocks = begun.blocks.draft()
    blocks[BOX.index(chest)] = blocks[BOX.index(full)] = Registry.load().state_id("chest")
    contents = {chest: {"apple": 2}, full: {"stone": 26 * 64, "dirt": 63}}
    begun = replace(begun, blocks=blocks.terrain(), containers=contents)
    programs = [
        f"await depositItemIntoChest(bot, new Vec3{chest}, {{dirt: 5, diamond: 1}})",
        f"await getItemFromChest(bot, new Vec3{chest}, {{dirt: 9, apple: 3}})",
        f"await depositItemIntoChest(bot, new Vec3{full}, {{dirt: 2, apple: 1}})",
        f"await depositItemIntoChest(bot, new Vec3{full}, {{apple: 1}})",
    ]
    code = "\n".join(f"try {{ {each} }} catch (e) {{ console.log(e.name) }}" for each in programs)
    played = Played(world, {"sally": code}, begun=begun)
    assert played.results["sally"].log == ("SkillError",) * 4
    assert played.held("sally") == {"dirt": 1, "apple": 2}
    held = {place: dict(items) for place, items in played.there.containers.items()}
    assert held == {chest: {}, full: {"stone": 26 * 64, "dirt": 64}}


@pytest.mark.parametrize(
    "program",
    [
        f"await turnOnLever(bot, new Vec3{BUTTON})",
        f"await mineBlock(bot, new Vec3{BUTTON}, 'dirt')",
        f"await openDoor(bot, new Vec3{BUTTON})",
        f"await writeSign(bot, new Vec3{BUTTON}, 'hi')",
        f"await placeItem(bot, 'dirt', new Vec3{BUTTON})",
        "await giveItemToOther(bot, 'anne', 'dirt', 3)",
    ],
    ids=["lever", "mine", "door", "sign", "put", "give"],
)
def test_nobody_walks_for_what_cannot_be_done(world: World, program: str) -> None:
    played = Played(world, {"sally": program})
    assert played.results["sally"].error is not None
    assert played.there.agents["sally"].position == SALLY
