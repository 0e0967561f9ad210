"""People as agents: what they do in a Minecraft client is what a bot does, for all beliefs."""

import io
import os
import re
import signal
import socket
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
import yaml
from tests.people import Person
from tests.servers import serving

from beliefnest import Nest, Scenario
from beliefnest.cli.app import run_command_line
from beliefnest.errors import BodyError, InputError, WorldError
from beliefnest.worlds.minecraft.channel import Channel

LEFT, RIGHT = (-2, -51, -4), (2, -51, -4)
LONG_S = 120
MOVE = """
await goToPosition(bot, new Vec3(-2, -51, -3), 0)
await getItemFromChest(bot, new Vec3(-2, -51, -4), {diamond: 1})
await goToPosition(bot, new Vec3(2, -51, -3), 0)
await depositItemIntoChest(bot, new Vec3(2, -51, -4), {diamond: 1})
"""
MOVE_THERE = """
await goToPosition(bot, new Vec3(2, 1, 3), 0)
await getItemFromChest(bot, new Vec3(2, 1, 2), {diamond: 1})
await goToPosition(bot, new Vec3(8, 1, 3), 0)
await depositItemIntoChest(bot, new Vec3(8, 1, 2), {diamond: 1})
"""
WORKSHOP = """
name: workshop
box: [[0, 0, 0], [12, 5, 12]]
blocks:
  - {block: stone, fill: [[0, 0, 0], [12, 0, 12]]}
  - {block: "lever[face=floor,facing=north]", at: [4, 1, 4]}
  - {block: "oak_door[half=lower,facing=north]", at: [6, 1, 4]}
  - {block: "oak_door[half=upper,facing=north]", at: [6, 2, 4]}
  - {block: dirt, at: [9, 1, 9]}
containers:
  - {at: [6, 1, 9], block: "chest[facing=south]", items: {apple: 3}}
  - {at: [8, 1, 11], block: barrel}
agents:
  sally: {position: [1.5, 1, 1.5]}
  anne: {position: [4.5, 1, 5.5], type: human, inventory: {diamond: 2, cobblestone: 2}}
"""
WORK = """
bot.chat('Hello.'); bot.chat('/msg sally Psst.')
await turnOnLever(bot, new Vec3(4, 1, 4))
await openDoor(bot, new Vec3(6, 1, 4))
await getItemFromChest(bot, new Vec3(6, 1, 9), {apple: 2})
await mineBlock(bot, new Vec3(9, 1, 9), 'dirt')
await placeItem(bot, 'cobblestone', new Vec3(9, 1, 9))
await depositItemIntoChest(bot, new Vec3(8, 1, 11), {apple: 1})
await giveItemToOther(bot, 'sally', 'diamond', 1)
"""
OPEN_AND_GO = """
await openDoor(bot, new Vec3(6, 1, 4))
await goToPosition(bot, new Vec3(6, 1, 10), 0)
await bot.lookAt(new Vec3(6, 1, 12))
"""
DEEDS = ["use_lever", "use_door", "open_container", "get_item_from_chest", "mine_block"]
DEEDS += ["place_block", "open_container", "deposit_item_into_chest", "give_item_to_other"]
SILENT = ("move_to", "block_update", "chat")
BELIEFS = ("/", "/sally", "/anne", "/observer", "/observer/sally", "/observer/anne")


def scenario_file(path: Path) -> None:
    """Sally-Anne, with a person as Anne, who is told nothing by the script."""
    written: dict[str, Any] = yaml.safe_load(Scenario.load("sally-anne", 1).text)
    written["agents"]["anne"]["type"] = "human"
    written["script"] = written["script"][:2]
    for condition in written["conditions"].values():
        condition.pop("probes", None)
    path.write_text(yaml.safe_dump(written), encoding="utf-8")


@pytest.fixture
def scenario(tmp_path):
    path = tmp_path / "with-a-person.yaml"
    scenario_file(path)

    def load(condition):
        return Scenario.load(str(path), condition)

    return load


def contents(nest):
    held = nest.states(BELIEFS)
    return {
        path: {place: (held[path].containers[place].items) for place in (LEFT, RIGHT)}
        for path in BELIEFS
    }


@pytest.fixture(scope="module")
def server():
    with serving(latency=10) as running:
        yield running


def acted_by_a_person(scenario, world, **options):
    """Anne, a person, moves the diamond; what all believe in the end, and what she did."""
    with (
        Nest.open(scenario, world, **options) as nest,
        Person(nest.address, "anne") as anne,
    ):
        nest.play()
        anne.does(MOVE)
        assert nest.wait(lambda: anne.is_done, LONG_S)
        assert nest.wait(lambda: contents(nest)["/"][RIGHT] == {"diamond": 1}, LONG_S)
        return contents(nest), {e.kind for e in nest["/"].state.events if e.actor == "anne"}


@pytest.mark.long
@pytest.mark.parametrize("condition", [1, 3])
def test_a_person_moves_the_diamond_and_all_believe_as_if_a_bot_had(condition, scenario, server):
    with Nest.open(Scenario.load("sally-anne", condition), "embedded") as nest:
        nest.play()
        as_with_bots = contents(nest), {e.kind for e in nest["/"].state.events if e.actor == "anne"}
    if condition == 1:
        # No agent hears the messages of her client there; the result shows it.
        assert acted_by_a_person(scenario(1), server.address()) == as_with_bots
    else:
        hosted = acted_by_a_person(scenario(3), "embedded", realtime=True, listen=0)
        assert hosted == as_with_bots


@pytest.mark.long
def test_what_a_person_does_on_a_server_becomes_the_same_actions(server, tmp_path):
    path = tmp_path / "workshop.yaml"
    path.write_text(WORKSHOP, encoding="utf-8")
    with (
        Nest.open(Scenario.load(str(path)), server.address()) as nest,
        Person(nest.address, "anne") as anne,
    ):
        nest.wait_for_people()
        anne.does(WORK)
        assert nest.wait(lambda: anne.is_done, LONG_S)
        done = "receive_item_from_other"
        assert nest.wait(lambda: done in {e.kind for e in nest["/"].state.events}, LONG_S)
        state = nest["/"].state
        told = [(e.kind.value, e.actor) for e in state.events if e.kind.value not in SILENT]
        expected = [*((kind, "anne") for kind in DEEDS), (done, "sally")]
        assert sorted(told) == sorted(expected)
        # Two connections hear of them, whichever comes first.
        for where in ("/", "/sally"):
            assert sorted(words[2] for words in nest[where].state.chat) == ["Hello.", "Psst."]
        assert state.containers[(6, 1, 9)].items == {"apple": 1}
        assert state.containers[(8, 1, 11)].items == {"apple": 1}
        left = {"apple": 1, "cobblestone": 1, "diamond": 1, "dirt": 1}
        assert nest.wait(lambda: nest["/"].state.agents["anne"].inventory == left, LONG_S)
        with pytest.raises(WorldError, match=r"anne is a person.*nest\.take_over"):
            nest["/"].run("anne", "bot.chat('I am a program.')")
        nest.take_over("anne")
        assert anne.left() == "anne is played by BeliefNest from now on"
        assert nest["/"].run("anne", "bot.chat('I am a program.')").ok
        assert nest["/"].state.agents["anne"].inventory == left
        nest.hand_back("anne")
        with Person(nest.address, "anne"):
            nest.wait_for_people()
            assert nest.people == {"anne"}


@pytest.mark.long
def test_what_a_person_did_while_the_operator_stood_still_is_recognised(
    server, tmp_path, monkeypatch
):
    """All that the server sent meanwhile comes at once, when the person looks elsewhere."""
    path = tmp_path / "workshop.yaml"
    path.write_text(WORKSHOP, encoding="utf-8")
    processes = set()
    begin = Channel.begin

    def noting(self, name, **arguments):
        processes.add(self.pid)
        begin(self, name, **arguments)

    monkeypatch.setattr(Channel, "begin", noting)
    with (
        Nest.open(Scenario.load(str(path)), server.address()) as nest,
        Person(nest.address, "anne") as anne,
    ):
        nest.wait_for_people()
        (operator,) = processes
        os.kill(operator, signal.SIGSTOP)
        try:
            anne.does(OPEN_AND_GO)
            anne.finish()
        finally:
            os.kill(operator, signal.SIGCONT)
        assert nest.wait(
            lambda: ("use_door", "anne") in {(e.kind, e.actor) for e in nest["/"].state.events},
            LONG_S,
        )


@pytest.mark.long
def test_who_leaves_stands_there_until_they_come_back(scenario, tmp_path):
    heard = []
    with Nest.open(scenario(1), realtime=True, listen=0, store=tmp_path / "run.bn") as nest:
        nest.on_chat(lambda _, speaker, text: heard.append((speaker, text)))
        with Person(nest.address, "anne") as anne:
            nest.play()
            anne.does("bot.chat('Hello.'); bot.chat('/msg sally Come.')")
            anne.does("await goToPosition(bot, new Vec3(-2, -51, -3), 0)")
            anne.does("await getItemFromChest(bot, new Vec3(-2, -51, -4), {diamond: 1})")
            assert nest.wait(lambda: anne.is_done, LONG_S)
            anne.leave()
            assert nest.wait(lambda: not nest.people, LONG_S)
        assert heard == [("anne", "Hello."), ("anne", "Come.")]
        chats = nest.states(["/sally", "/observer"])
        assert [text for _, _, text in chats["/sally"].chat] == ["Hello.", "Come."]
        assert [text for _, _, text in chats["/observer"].chat] == ["Hello."]
        gone = nest["/observer"].state.agents["anne"]
        assert gone.current
        assert gone.position == pytest.approx((-1.5, -51, -2.5), abs=1)
    with Nest.resume(tmp_path / "run.bn") as nest, Person(nest.address, "anne") as anne:
        nest.wait_for_people()
        anne.does("await goToPosition(bot, new Vec3(2, -51, -3), 0)")
        anne.does("await depositItemIntoChest(bot, new Vec3(2, -51, -4), {diamond: 1})")
        assert nest.wait(lambda: anne.is_done, LONG_S)
        assert nest["/observer"].state.containers[RIGHT].items == {"diamond": 1}
        assert nest["/observer/sally"].state.containers[LEFT].items == {"diamond": 1}


@pytest.mark.long
def test_only_who_is_awaited_comes_in_and_acts(scenario):
    act = "await goToPosition(bot, new Vec3(0, -51, 0))"
    with Nest.open(scenario(1), realtime=True, listen=0) as nest:
        for name, told in (
            ("eve", "There is no eve in this scenario; come as anne"),
            ("sally", "sally is played by BeliefNest; come as anne"),
        ):
            with Person(nest.address, name) as stranger:
                assert stranger.left() == told
        with pytest.raises(WorldError, match=rf"anne did not join .* 1\.20\.4.* {nest.address}"):
            nest.wait_for_people(timeout_s=0.5)
        with pytest.raises(WorldError, match=r"anne is a person.*nest\.take_over"):
            nest["/"].run("anne", act)
        with Person(nest.address, "anne") as anne:
            nest.wait_for_people()
            with Person(nest.address, "anne") as other:
                assert other.left() == "anne is here already; nobody else is awaited now"
            nest.take_over("anne")
            assert anne.left() == "anne is played by BeliefNest from now on"
        assert nest["/"].run("anne", act).ok
        nest.hand_back("anne")
        with Person(nest.address, "anne") as anne:
            nest.wait_for_people()
            assert nest.people == {"anne"}
            nest.close()
            assert anne.left() == "The run is over"


@pytest.mark.long
def test_nothing_is_done_while_time_stands_still(scenario):
    with Nest.open(scenario(1), realtime=True, listen=0) as nest:
        with (
            pytest.raises(WorldError, match="not run in real time"),
            Nest.open(Scenario.load("sally-anne"), "scripted") as other,
        ):
            other.pause()
        with Person(nest.address, "anne") as anne:
            nest.play()
            nest.pause()
            nest.pause()
            nest["/"].step(0)
            before, place = nest.tick, nest["/"].state.agents["anne"].position
            # She is not heard, her hand stays as it is, and walking leads nowhere.
            anne.does("bot.chat('Can you hear me?'); bot.setQuickBarSlot(3)")
            anne.does("bot.setControlState('forward', true); await bot.waitForTicks(20)")
            anne.does("bot.clearControlStates(); await bot.waitForTicks(20)")
            while not anne.is_done:
                assert nest.people == {"anne"}
            assert "Time stands still." in anne.read
            assert any("nobody hears you" in line for line in anne.read)
            for act in (lambda: nest.wait(None, 1), lambda: nest["/"].run("sally", "1")):
                with pytest.raises(WorldError, match=rf"stands still at tick {before}.*go_on"):
                    act()
            nest["/observer"].switch("what if")
            assert nest["/observer"].run("sally", "bot.chat('I wonder.')").ok
            nest["/"].step(0)
            state = nest["/"].state
            assert (nest.tick, state.agents["anne"].position, state.chat) == (before, place, [])
            nest.go_on()
            # Her game held what was not so, and is told all anew.
            come = "You are anne."
            assert nest.wait(lambda: sum(come in line for line in anne.read) == 2, LONG_S)
            anne.does("bot.chat('Now?')")
            assert nest.wait(lambda: bool(nest["/"].state.chat), LONG_S)
            assert [words for _, *words in nest["/"].state.chat] == [["anne", "Now?"]]
            anne.does(MOVE)
            assert nest.wait(lambda: contents(nest)["/"][RIGHT] == {"diamond": 1}, LONG_S)


def test_worlds_that_nobody_can_join_refuse_people(scenario):
    for world in ("embedded", "scripted"):
        with pytest.raises(InputError, match=r"type human \(anne.*realtime=True"):
            Nest.open(scenario(1), world)
    with pytest.raises(InputError, match=r"realtime=True .--realtime. as well"):
        Nest.open(scenario(1), listen=0)
    with (
        Nest.open(Scenario.load("sally-anne", 1), realtime=True, listen=0) as nest,
        pytest.raises(BodyError, match="another program listens there"),
    ):
        Nest.open(scenario(1), realtime=True, listen=str(nest.address))


class Told(io.StringIO):
    """Text that another thread writes; it tells when a part of it has come."""

    def __init__(self, part: str) -> None:
        super().__init__()
        self.part, self.has_come = part, threading.Event()

    def write(self, text: str) -> int:
        written = super().write(text)
        if self.part in self.getvalue():
            self.has_come.set()
        return written


@pytest.mark.long
def test_the_example_of_the_page_runs(tmp_path, monkeypatch, capsys):
    """The page's own example: what it prints, and what it writes down."""
    page = (Path(__file__).parents[3] / "docs" / "people.md").read_text(encoding="utf-8")
    ((example,), (written,)) = (
        re.findall(rf"```{kind}\n(.*?)```", page, re.DOTALL) for kind in ("python", "yaml")
    )
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    (tmp_path / "mine.yaml").write_text(written, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    code = compile(example.replace("25565", str(port)), "people.md", "exec")
    told = Told("join as anne")
    with ThreadPoolExecutor(1) as experimenter, monkeypatch.context() as patched:
        patched.setattr("sys.stderr", told)
        played = experimenter.submit(exec, code, {"__name__": "example"})
        # A player who joins before the script has begun is sent away.
        while not told.has_come.wait(0.1):
            assert not played.done(), played.result()
        with Person(f"127.0.0.1:{port}", "anne") as anne:
            anne.does(
                "await new Promise(turn => bot.on('message', m => /your turn/.test(m) && turn()))"
            )
            anne.does(MOVE_THERE)
            played.result()
    assert capsys.readouterr().out.splitlines() == [
        "sally Anne, it is your turn.",
        "{'diamond': 1}",
    ]
    assert run_command_line(["replay", str(tmp_path / "run.bn")]) == 2
    assert "played in real time, which cannot be repeated" in capsys.readouterr().err


@pytest.mark.parametrize("is_on", [True, False])
def test_a_bot_waits_as_the_page_says(is_on):
    page = (Path(__file__).parents[3] / "docs" / "people.md").read_text(encoding="utf-8")
    (wait,) = re.findall(r"```javascript\n(.*?)```", page, re.DOTALL)
    room = yaml.safe_load(WORKSHOP)
    del room["agents"]["anne"]
    room["blocks"] += [
        {"block": f"lever[face=floor,powered={str(is_on).lower()}]", "at": [5, 1, 1]}
    ]
    with Nest.open(Scenario.from_mapping(room), world="scripted") as nest:
        assert nest["/"].run("sally", wait, timeout_ticks=50).ok == is_on


BEHIND_A_WALL = """
name: behind-a-wall
box: [[0, 0, 0], [10, 4, 10]]
blocks:
  - {block: stone, fill: [[0, 0, 0], [10, 0, 10]]}
  - {block: bricks, fill: [[0, 1, 6], [7, 3, 6]]}
agents:
  bob: {position: [2.5, 1, 8.5], inventory: {dirt: 1}}
  anne: {position: [2.5, 1, 2.5], type: human}
static_blocks: [stone, bricks]
"""
OUT_OF_SIGHT = "bot.chat('A secret.'); bot.whisper('anne', 'For you.'); await bot.waitForTicks(5)"
IN_SIGHT = "await goToPosition(bot, new Vec3(9, 1, 3), 0); bot.chat('Here I am.')"


LATER = [pytest.param(each, marks=pytest.mark.long) for each in ("global", "sight")]


@pytest.mark.parametrize("hearing", [{"radius": 8}, *LATER])
def test_a_person_hears_what_their_agent_hears_and_nothing_else(hearing, tmp_path):
    path = tmp_path / "wall.yaml"
    path.write_text(f"{BEHIND_A_WALL}perception: {{hearing: {hearing}}}\n", encoding="utf-8")
    options = {"realtime": True, "listen": 0}
    with (
        Nest.open(Scenario.load(str(path)), **options) as nest,
        Person(nest.address, "anne") as anne,
    ):
        nest.wait_for_people(LONG_S)
        assert nest["/"].run("bob", OUT_OF_SIGHT).ok
        assert nest["/"].run("bob", IN_SIGHT).ok
        anne.does("bot.chat('I see you.')")
        assert nest.wait(lambda: "<anne> I see you." in anne.read, LONG_S)
        assert nest.wait(lambda: "<bob> Here I am." in anne.read, LONG_S)
        heard = [text for _, speaker, text in nest["/anne"].state.chat if speaker == "bob"]
        whispered = "bob whispers to you: For you."
        shown = [line for line in anne.read if "bob" in line and "Here are" not in line]
        aloud = [f"<bob> {text}" for text in heard if text != "For you."]
        assert sorted(shown) == sorted([*aloud, whispered])
        assert ("<bob> A secret." in shown) == (hearing != "sight")
        assert shown.count("<bob> Here I am.") == 1
