"""Errors about a server's missing features come before anything is played, with advice."""

import re
import socket
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager

import numpy as np
import pytest
from msgspec.structs import replace
from tests.servers import GameServer

from beliefnest.errors import BeliefNestError, BodyError, InputError, WorldError
from beliefnest.world.frames import Frame, Snapshot
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import AgentState, Box, EventKind
from beliefnest.worlds.by_name import open_world
from beliefnest.worlds.names import check_world
from beliefnest.worlds.protocol import World
from beliefnest.worlds.servers.address import ServerAddress, overwriting

BOX = Box((0, 0, 0), (6, 4, 6))
LONG = 3600
SOON = {"patience": 3}
CHEST, FOREIGN = (2, 1, 2), (5, 2, 5)


def start() -> Snapshot:
    registry = Registry.load()
    blocks = np.zeros(BOX.shape, dtype=np.int32)
    blocks[:, 0, :] = registry.state_id("stone")
    blocks[BOX.index(CHEST)] = registry.state_id("chest")
    agents = {"sally": AgentState((1.5, 1.0, 3.5), inventory={"diamond": 2})}
    return Snapshot(0, BOX, Terrain.of(blocks), {CHEST: {"emerald": 2}}, agents)


@pytest.fixture(scope="module")
def server() -> Iterator[GameServer]:
    with GameServer(ops=["BeliefNest", "Second"]) as running:
        yield running


@contextmanager
def on_console(server: GameServer, lines: tuple[str, str] | None) -> Iterator[None]:
    """Yield the server after one line is typed; type the other line afterwards."""
    if lines is None:
        yield
        return
    server.type(lines[0])
    try:
        yield
    finally:
        server.type(lines[1])


def opened(world: World, snapshot: Snapshot | None = None) -> None:
    world.open_body("/", "seed", snapshot or start(), lambda frame: None)


@pytest.mark.parametrize(
    ("lines", "query", "said"),
    [
        (
            ("deop BeliefNest", "op BeliefNest"),
            {"patience": 3},
            r"not use /fill, /setblock.*: op BeliefNest",
        ),
        pytest.param(
            *(("lack item", "lack"), SOON, r"BeliefNest may not use /item"),
            marks=pytest.mark.long,
        ),
        (("verify BeliefNest", "trust BeliefNest"), {}, r"asks Microsoft.*online-mode=false"),
        (("room 0", "room 9"), {}, r"is full.*raise max-players"),
        (None, {"version": "1.16.5"}, r"\?version=1\.16\.5 asks.* 1\.20\.4, .*1\.21\.8.*pip"),
    ],
)
def test_what_the_operator_lacks_is_said(server, lines, query, said):
    with on_console(server, lines), pytest.raises(BodyError, match=said):
        open_world(server.address(**query), 0)


@pytest.mark.long
def test_commands_that_are_told_late_are_waited_for(capsys):
    with GameServer(commandsLate=80) as server:
        open_world(server.address(), 0).close()
    said = capsys.readouterr().err
    assert re.search(r"does not let BeliefNest use /fill, .* yet; .*: op BeliefNest", said)
    assert said.count("\n") == 1


LATER = [pytest.param(packet, marks=pytest.mark.long) for packet in (4, 5, 20, 60)]


@pytest.mark.parametrize("packet", [8, *LATER])
def test_a_server_that_dies_during_the_set_up_is_the_cause_that_is_told(packet):
    """The packets are those of the operator's login and of its first commands."""
    with GameServer(diesAt=packet) as server:
        started = time.perf_counter()
        lost = r"connection of .* was lost|does not answer"
        with (
            pytest.raises(BodyError, match=lost),
            closing(open_world(server.address(patience=LONG), 0)) as world,
        ):
            opened(world)
        # The loss is seen at once, and not when patience is at its end.
        assert time.perf_counter() - started < LONG


def test_what_a_server_lacks_and_can_do_without_is_named_at_the_start(server, capsys):
    with on_console(server, ("lack data", "lack")):
        open_world(server.address(), 0).close()
    said = capsys.readouterr().err
    assert "does not let BeliefNest use /data (signs cannot be written on" in said
    assert said.count("\n") == 1


@pytest.mark.long
def test_a_server_that_answers_no_completions_is_waited_for(capsys):
    with GameServer(tickMs=10) as server:
        server.type("lack completions")
        world = open_world(server.address(), 0)
        frames: list[Frame] = []
        body = world.open_body("/", "seed", start(), frames.append)
        assert body.snapshot().containers == start().containers
        put = "await depositItemIntoChest(bot, new Vec3(2, 1, 2), {diamond: 2})"
        result = body.run({"sally": put}, 600)["sally"]
        assert result.ok, result.error
        told = [event.kind for frame in frames for event in frame.events]
        assert EventKind.DEPOSIT_ITEM_INTO_CHEST in told
        assert body.snapshot().containers == {CHEST: {"emerald": 2, "diamond": 2}}
        world.close()
    said = capsys.readouterr().err
    assert "does not answer requests for completions of commands" in said
    assert said.count("\n") == 1


@pytest.mark.parametrize("query", ["", "?version=1.20.4"])
def test_nobody_answers(query):
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        address = f"minecraft://127.0.0.1:{free.getsockname()[1]}{query}"
        with pytest.raises(BodyError, match=r"does not answer \(ECONNREFUSED\); start it"):
            open_world(address, 0)


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        (("protect yes", "protect no"), "spawn-protection=0"),
        (("room 1", "room 9"), "no room for the 1 agents"),
    ],
)
def test_what_agents_lack_is_said(server, lines, said):
    with on_console(server, lines):
        world = open_world(server.address(), 0)
        with pytest.raises(BodyError, match=said):
            opened(world)
        world.close()


@pytest.mark.long
def test_what_stands_in_the_box_is_not_touched_unless_asked_and_put_back(server):
    server.type("setblock 5 2 5 minecraft:barrel[facing=up]")
    server.type("item replace block 5 2 5 container.4 with minecraft:bread 3")
    world = open_world(server.address(), 0)
    with pytest.raises(WorldError, match=r"holds 1 other blocks, as barrel at \(5, 2, 5\).*--over"):
        opened(world)
    world.close()
    world = open_world(overwriting(server.address(operator="Second")), 0)
    opened(world)
    body = world.open_body("/sally", "seed", start(), lambda frame: None)
    assert body.snapshot().containers == start().containers
    world.close()
    # The scene is the same as before.
    registry = Registry.load()
    blocks = np.zeros(BOX.shape, dtype=np.int32)
    blocks[BOX.index(FOREIGN)] = registry.state_id("barrel[facing=up]")
    world = open_world(server.address(), 0)
    opened(world, Snapshot(0, BOX, Terrain.of(blocks), {FOREIGN: {"bread": 3}}, {}))
    world.close()
    server.type("setblock 5 2 5 minecraft:air")


@pytest.mark.long
def test_an_agent_whose_name_is_taken_is_not_let_in(server):
    first, second = (
        open_world(server.address(), 0),
        open_world(server.address(operator="Second"), 0),
    )
    opened(first)
    with pytest.raises(WorldError, match="a player called sally is on the server already"):
        opened(second, replace(start(), agents={"sally": AgentState((4.5, 1.0, 4.5))}))
    second.close()
    first.close()


def test_an_agent_does_not_have_the_operators_name(server):
    world = open_world(server.address(), 0)
    with pytest.raises(InputError, match=r"both called BeliefNest; .*\?operator=NAME"):
        opened(world, replace(start(), agents={"BeliefNest": AgentState((1.5, 1.0, 3.5))}))
    world.close()


@pytest.mark.parametrize(
    ("address", "said"),
    [
        ("minecraft://", "not the address of a server"),
        ("minecraft://host:port", "no valid port"),
        ("minecraft://host/world", "not the address of a server"),
        ("minecraft://user:secret@host", "must not contain a name or password"),
        ("minecraft://host?at=1,16", "multiples of 16"),
        ("minecraft://host?operator=a-b", "1 to 16 letters"),
        ("minecraft://host?patience=0", "from 1 to 3600"),
        ("minecraft://host?keep=perhaps", "yes or no"),
        ("minecraft://host?where=here", "known options are version, operator, at"),
        ("Minecraft://host?at=0,0&at=16,16", "option 'at' twice"),
    ],
)
def test_addresses_are_checked_before_anything_is_started(address, said):
    with pytest.raises(BeliefNestError, match=said) as raised:
        check_world(address)
    assert "secret" not in str(raised.value)


def test_addresses():
    found = ServerAddress.parse("minecraft://example.org?at=-32,160&overwrite=yes&version=1.20.4")
    assert (found.host, found.port, found.at) == ("example.org", 25565, (-32, 160))
    assert (found.overwrite, found.keep, found.version) == (True, False, "1.20.4")
    with pytest.raises(InputError, match="plays one run at a time"):
        check_world("minecraft://example.org", servers=False)
