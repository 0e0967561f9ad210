"""The paper's experiments on a server, in real time, and what may go wrong with one meanwhile."""

import json
import re
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from tests.profiles import NIGHTLY
from tests.servers import GameServer, Served, given_version, serving

from beliefnest import Nest, Scenario
from beliefnest.cli.app import run_command_line
from beliefnest.errors import BodyError, InputError
from beliefnest.world.values import EventKind
from beliefnest.worlds.by_name import open_world

LONG_S = 120
PATIENCE = 60
"""Seconds, for what does come; where something does not, as few as a busy machine allows."""
NEAR = 1.0
LEFT, RIGHT = (-2, -51, -4), (2, -51, -4)
PUT = "await depositItemIntoChest(bot, new Vec3(-2, -51, -4), {diamond: 1})"
FAR = """
await goToPosition(bot, new Vec3(10, -51, -10), 1)
await goToPosition(bot, new Vec3(-10, -51, 10), 1)
"""


WORKSHOP = """
name: workshop
description: Much can be done here.
box: [[0, 0, 0], [12, 5, 12]]
blocks:
  - {block: stone, fill: [[0, 0, 0], [12, 0, 12]]}
  - {block: "lever[face=floor,facing=north]", at: [4, 1, 4]}
  - {block: "stone_button[face=floor,facing=north]", at: [4, 1, 6]}
  - {block: "oak_door[half=lower,facing=north]", at: [6, 1, 4]}
  - {block: "oak_door[half=upper,facing=north]", at: [6, 2, 4]}
  - {block: "oak_fence_gate", at: [8, 1, 4]}
  - {block: "oak_trapdoor", at: [9, 1, 4]}
  - {block: crafting_table, at: [2, 1, 9]}
  - {block: dirt, at: [9, 1, 9]}
containers:
  - {label: furnace, at: [4, 1, 9], block: furnace}
  - {label: chest, at: [6, 1, 9], block: "chest[facing=south]", items: {apple: 3, bread: 2}}
  - {label: barrel, at: [8, 1, 11], block: barrel}
agents:
  sally: {position: [1.5, 1, 1.5], inventory: {oak_planks: 20, iron_pickaxe: 1,
    raw_iron: 2, coal: 2, diamond: 3, cobblestone: 5, iron_helmet: 1}}
  anne: {position: [1.5, 1, 6.5]}
"""
WORK = [
    ("sally", "await turnOnLever(bot, new Vec3(4, 1, 4))"),
    ("sally", "await openDoor(bot, new Vec3(6, 1, 4)); await closeDoor(bot, new Vec3(6, 1, 4))"),
    ("sally", "await openDoor(bot, new Vec3(8, 1, 4)); await openDoor(bot, new Vec3(9, 1, 4))"),
    ("sally", "await mineBlock(bot, new Vec3(9, 1, 9), 'dirt')"),
    ("sally", "await placeItem(bot, 'cobblestone', new Vec3(9, 1, 9))"),
    ("sally", "await craftItem(bot, 'chest', new Vec3(2, 1, 9), 1)"),
    ("sally", "await placeItem(bot, 'chest', new Vec3(10, 1, 6))"),
    ("sally", "await depositItemIntoChest(bot, new Vec3(10, 1, 6), {diamond: 2})"),
    ("anne", "await getItemFromChest(bot, new Vec3(6, 1, 9), {apple: 2, bread: 1})"),
    ("anne", "await depositItemIntoChest(bot, new Vec3(8, 1, 11), {apple: 1})"),
    ("sally", "await smeltItem(bot, 'raw_iron', 'coal', new Vec3(4, 1, 9), 1)"),
    ("sally", "await giveItemToOther(bot, 'anne', 'diamond', 1)"),
    ("anne", "await mineBlock(bot, new Vec3(10, 1, 6), 'chest')"),
    ("sally", "await equip(bot, 'iron_helmet', 'head')"),
    ("sally", "await pressButton(bot, new Vec3(4, 1, 6))"),
]


@pytest.fixture(scope="module")
def server() -> Iterator[Served]:
    with serving(latency=15) as running:
        yield running


@pytest.fixture
def console(server: Served) -> GameServer:
    if not isinstance(server, GameServer):
        pytest.skip("its console is out of reach")
    return server


def ran(arguments: list[str], folder: Path, capsys: pytest.CaptureFixture[str]) -> dict[str, Any]:
    assert run_command_line([*arguments, "--out", str(folder), "--json"]) == 0
    report: dict[str, Any] = json.loads(capsys.readouterr().out)
    return report


def same_place(one: list[float] | None, other: list[float] | None, near: float = NEAR) -> bool:
    if one is None or other is None:
        return one is other
    return max(abs(a - b) for a, b in zip(one, other, strict=True)) <= near


@pytest.mark.long
@pytest.mark.parametrize(
    ("name", "conditions"),
    [("sally-anne", (1, 2, 3)), ("ice-cream-van", (1, 2, 3) if NIGHTLY else (1,))],
)
def test_the_experiments_come_out_as_in_the_embedded_world(
    name, conditions, server, tmp_path, capsys
):
    chosen = [text for number in conditions for text in ("--condition", str(number))]
    embedded = ran(["run", name, *chosen], tmp_path / "embedded", capsys)
    played = ran(["run", name, *chosen, "--world", server.address()], tmp_path / "server", capsys)
    for here, there in zip(embedded["runs"], played["runs"], strict=True):
        assert there["ok"]
        assert here["beliefs"].keys() == there["beliefs"].keys()
        states = [(here["reality"], there["reality"])]
        states += [(here["beliefs"][path], there["beliefs"][path]) for path in here["beliefs"]]
        for mine, its in states:
            assert mine["containers"] == its["containers"]
            assert [words[1:] for words in mine["chat"]] == [words[1:] for words in its["chat"]]
            for agent, known in mine["agents"].items():
                assert known["current"] == its["agents"][agent]["current"], agent
                assert same_place(known["position"], its["agents"][agent]["position"]), agent
        for mine, its in zip(here["probes"], there["probes"], strict=True):
            assert (mine["opened"], mine["ok"]) == (its["opened"], its["ok"])
            # Programs go to within two blocks of their targets, from whichever side time lets them.
            assert same_place(mine["arrived"], its["arrived"], 2 * NEAR)


def worked(scenario: Scenario, world: str) -> list[Any]:
    """Return the results of each program: its deeds, all contents, all possessions."""
    told = []
    with Nest.open(scenario, world) as nest:
        for agent, program in WORK:
            result = nest["/"].run(agent, program)
            assert result.ok, result.error
            deeds = sorted((e.kind.value, e.actor or "", str(e.detail)) for e in result.events)
            state = nest["/"].state
            contents = {place: dict(held.items) for place, held in state.containers.items()}
            has = {name: dict(each.inventory) for name, each in state.agents.items()}
            told.append((program, deeds, contents, has))
    return told


@pytest.mark.long
def test_skills_do_and_are_told_as_in_the_embedded_world(tmp_path):
    """Also on a server of another version, whose blocks and windows have other numbers."""
    path = tmp_path / "workshop.yaml"
    path.write_text(WORKSHOP, encoding="utf-8")
    scenario = Scenario.load(str(path))
    with serving(latency=15, version="1.20.2") as older:
        played = worked(scenario, older.address())
        with closing(open_world(older.address(), 0)) as world:
            joined = world.realtime
            assert joined is not None
            assert joined.minecraft in ("1.20.2", *given_version())
    for here, there in zip(worked(scenario, "embedded"), played, strict=True):
        assert here == there


@pytest.mark.long
def test_the_example_of_the_page_runs(server, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    page = (Path(__file__).parents[3] / "docs" / "servers.md").read_text(encoding="utf-8")
    (example,) = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    example = example.replace("minecraft://localhost:25565", server.address())
    exec(compile(example, "servers.md", "exec"), {"__name__": "example"})
    *_, said, believed = capsys.readouterr().out.splitlines()
    assert said.endswith("sally I am back.")
    assert believed == "{'diamond': 1}"


@pytest.mark.long
def test_what_others_do_between_calls_is_recorded_with_the_next(console, tmp_path):
    store = tmp_path / "run.bn"
    heard = []
    with Nest.open(Scenario.load("sally-anne", 1), console.address(), store) as nest:
        nest.on_chat(lambda tick, speaker, text: heard.append((speaker, text)))
        nest["/"].run("sally", "bot.chat('hello'); await whisper(bot, 'anne', 'psst')")
        # Two connections hear of them, whichever comes first.
        assert sorted(heard) == [("sally", "hello"), ("sally", "psst")]
        console.type("setblock 4 -51 4 minecraft:stone")
        assert nest.wait(lambda: nest["/"].state.blocks[(4, -51, 4)] == "stone")
        told = [e for e in nest["/"].state.events if e.kind is EventKind.BLOCK_UPDATE]
        assert [(e.actor, e.detail["position"]) for e in told] == [(None, (4, -51, 4))]
        with pytest.raises(InputError, match="real time, so programs cannot be tried out"):
            nest.explore("/", "sally", [PUT], lambda *_: 0)
        before = nest.tick
        assert not nest.wait(lambda: False, timeout_s=0.5)
        assert nest.wait(lambda: before + 10 <= nest.tick, LONG_S)
        # An edit is made in the server's world too, after what happened there before.
        console.type("setblock 5 -51 4 minecraft:stone")
        nest["/"].edit(blocks={(4, -51, 4): "air"}, containers={LEFT: {"emerald": 2}})
        nest["/"].run("anne", "await getItemFromChest(bot, new Vec3(-2, -51, -4), {emerald: 1})")
        state = nest["/"].state
        assert state.containers[LEFT].items == {"emerald": 1}
        assert state.blocks[(4, -51, 4)] == "air"
        ticks = [event.tick for event in state.events]
        assert ticks == sorted(ticks)


@pytest.mark.long
def test_a_fork_of_the_real_world_goes_back_to_where_it_was(server):
    with Nest.open(Scenario.load("sally-anne", 1), server.address()) as nest:
        first = nest["/"].branch
        nest["/"].run("sally", PUT)
        nest["/"].switch("other")
        taken = "await getItemFromChest(bot, new Vec3(-2, -51, -4), {diamond: 1})"
        assert nest["/"].run("anne", taken).ok
        assert nest["/"].state.containers[LEFT].items == {}
        nest["/"].switch(first)
        assert nest["/"].state.containers[LEFT].items == {"diamond": 1}
        assert nest["/"].run("anne", taken).ok


@pytest.mark.long
def test_a_bot_that_is_sent_away_comes_back(console):
    with Nest.open(Scenario.load("sally-anne", 1), console.address(patience=PATIENCE)) as nest:
        nest["/"].run("sally", PUT)
        before = nest["/"].state.agents["sally"]
        for number, line in enumerate(("kick sally", "drop sally", "drop BeliefNest")):
            console.type(line)
            # The server does one line after the other.
            console.type(f"setblock {6 + number} -51 4 minecraft:stone")
            told = (6 + number, -51, 4)
            assert nest.wait(lambda told=told: nest["/"].state.blocks[told] == "stone", LONG_S)
            nest.wait(timeout_s=0.5)
            looked = nest["/"].run("sally", "bot.chat(String(bot.inventory.items().length))")
            assert looked.ok, looked.error
            assert looked.said[-1][1] == "0"
            after = nest["/"].state.agents["sally"]
            assert same_place(list(before.position), list(after.position))
        # The operator finds changes of its absence when it is back.
        console.type("drop BeliefNest")
        console.type("setblock 4 -51 4 minecraft:stone")
        assert nest.wait(lambda: nest["/"].state.blocks[(4, -51, 4)] == "stone", LONG_S)


@pytest.mark.long
def test_a_program_whose_bot_is_sent_away_fails_and_the_next_one_runs(console):
    with Nest.open(Scenario.load("sally-anne", 1), console.address(patience=PATIENCE)) as nest:
        console.type("after 60 kick sally")
        result = nest["/"].run("sally", FAR)
        assert not result.ok
        assert result.error is not None
        assert result.error.kind == "bot"
        assert "lost its connection" in result.error.message
        assert nest["/"].run("sally", PUT).ok


@pytest.mark.long
def test_a_server_that_is_stopped_under_a_program_is_the_cause_that_is_told():
    with GameServer() as server:
        nest = Nest.open(Scenario.load("sally-anne", 1), server.address(patience=3))
        server.type("after 20 stop")
        with pytest.raises(
            BodyError, match=r"was lost \(Server closed; .*with the same command and --out"
        ):
            nest["/"].run("sally", FAR)
        nest.close()


@pytest.mark.long
def test_a_bot_that_does_nothing_loses_its_connection_and_others_go_on(console):
    with Nest.open(Scenario.load("sally-anne", 1), console.address(patience=PATIENCE)) as nest:
        console.type("after 20 drop anne")
        result = nest["/"].run("sally", PUT)
        assert result.ok, result.error


@pytest.mark.long
def test_a_step_whose_bot_is_sent_away_is_the_worlds_failure(console):
    with Nest.open(Scenario.load("sally-anne", 1), console.address(patience=PATIENCE)) as nest:
        console.type("after 10 kick sally")
        with pytest.raises(BodyError, match="sally lost its connection to the server"):
            nest.play()


@pytest.mark.long
def test_a_server_that_stands_still_for_a_moment_is_waited_for(console):
    with Nest.open(Scenario.load("sally-anne", 1), console.address(patience=PATIENCE)) as nest:
        console.type("stall 1500")
        assert nest["/"].run("sally", PUT).ok
        ticks = [event.tick for event in nest["/"].state.events]
        assert ticks == sorted(ticks)
        assert nest["/"].state.containers[LEFT].items == {"diamond": 1}


@pytest.mark.long
@pytest.mark.parametrize(("fault", "said"), [("kill", "was lost"), ("freeze", "has not answered")])
def test_a_server_that_ends_leaves_a_run_that_can_be_resumed(fault, said, tmp_path):
    store = tmp_path / "run.bn"
    with GameServer() as first:
        port = first.port
        nest = Nest.open(Scenario.load("sally-anne", 1), first.address(patience=6), store)
        nest["/"].run("sally", PUT)
        tick = nest.tick
        getattr(first, fault)()
        with pytest.raises(BodyError, match=said):
            nest["/"].run("anne", "await goToPosition(bot, new Vec3(2, -51, -3), 0)")
        with pytest.raises(BodyError):
            nest["/"].step(1)
        nest.close()
    with Nest.read(store) as read:
        assert read.at(tick)["/"].state.containers[LEFT].items == {"diamond": 1}
    with GameServer(port=port), Nest.resume(store) as nest:
        assert nest["/"].state.containers[LEFT].items == {"diamond": 1}
        moved = "await getItemFromChest(bot, new Vec3(-2, -51, -4), {diamond: 1})"
        assert nest["/"].run("anne", moved).ok
        assert nest["/observer"].state.containers[LEFT].items == {}
        assert nest.tick > tick


@pytest.mark.long
def test_a_slow_server_corrupts_neither_order_nor_stamps():
    with (
        GameServer(tickMs=100) as slow,
        Nest.open(Scenario.load("sally-anne", 1), slow.address()) as nest,
    ):
        assert nest["/"].run("sally", PUT).ok
        ticks = [event.tick for event in nest["/"].state.events]
        assert ticks == sorted(ticks)
        assert ticks[-1] <= nest.tick
        assert nest["/sally"].state.containers[LEFT].items == {"diamond": 1}
