"""Beliefs that stand in Minecraft, as their simulators are: people walk into them."""

import json
import re
from pathlib import Path
from typing import Any

import pytest
import yaml
from tests.people import Person
from tests.servers import GameServer

from beliefnest import Nest, Scenario
from beliefnest.errors import InputError, UnknownNameError, WorldError

LEFT, RIGHT = (-2, -51, -4), (2, -51, -4)
LONG_S = 120
MOVE = """
await getItemFromChest(bot, new Vec3(-2, -51, -4), {diamond: 1})
await goToPosition(bot, new Vec3(2, -51, -3), 0)
await depositItemIntoChest(bot, new Vec3(2, -51, -4), {diamond: 1})
"""
# Sally puts the diamond away and looks elsewhere, and then so does the observer.
AWAY = "await bot.look({} * Math.PI, 0, true)"
SCRIPT = [
    {
        "agent": "sally",
        "program": "await depositItemIntoChest(bot, new Vec3(-2, -51, -4), {diamond: 1});"
        + AWAY.format(1 / 2),
    },
    {"agent": "observer", "program": AWAY.format(1)},
]
# A walk to the place that a line of the layout names, and the scene there.
TRAVEL = """
const there = at => Math.abs(bot.entity.position.x - at) < 30
bot.chat(LINE)
const corners = [[-2, -4], [2, -4], [-2, 11], [2, 11]].map(([x, z]) => new Vec3(X + x, -51, z))
while (!there(X) || !corners.every(place => bot.blockAt(place))) await waitTicks(bot, 1)
"""
LOOK = """
await goToPosition(bot, new Vec3(X, -51, -2), 1)
const found = {}
for (const [side, x] of [['left', X - 2], ['right', X + 2]]) {
  const block = () => bot.blockAt(new Vec3(x, -51, -4))
  while (block()?.name !== 'chest') await waitTicks(bot, 1)
  const chest = await bot.openContainer(block())
  found[side] = Object.fromEntries(chest.containerItems().map(({name, count}) => [name, count]))
  await bot.closeWindow(chest)
}
found.players = Object.keys(bot.players).filter(name => name !== bot.username).sort()
found.unseen = bot.blockAt(new Vec3(X, -52, 11)).name
if (JSON.stringify(found) !== JSON.stringify(EXPECTED)) throw new Error(JSON.stringify(found))
"""
WATCH = """
const sally = () => bot.players.sally_2?.entity?.position.x - X
if (!(sally() < -1)) throw new Error('Sally is at ' + sally())
bot.chat('I watch.')
while (!(sally() > 0)) await waitTicks(bot, 1)
"""


def sally_anne(of_anne):
    """Sally-Anne with another Anne, in which agents see what is before them alone."""
    written: dict[str, Any] = yaml.safe_load(Scenario.load("sally-anne", 1).text)
    agents = written["agents"]
    agents["anne"] |= {"position": [-1.5, -51, -2.5], **of_anne}
    agents["sally"]["position"] = [-2.5, -51, -1.5]
    written |= {"script": SCRIPT, "static_blocks": ["stone_bricks"]}
    written["perception"]["field_of_view"] = 120
    for part in ("probes", "conditions", "expectations"):
        written.pop(part)
    return Scenario.from_mapping(written)


@pytest.fixture
def play_of_a_person():
    return sally_anne({"type": "human"})


def test_the_example_of_the_page_runs(capsys):
    page = (Path(__file__).parents[2] / "docs" / "visiting.md").read_text(encoding="utf-8")
    (example,) = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    exec(compile(example.replace("listen=25565", "listen=0"), "visiting.md", "exec"), {})
    (printed,) = re.findall(r"```text\n(.*?)```", page, re.DOTALL)
    assert capsys.readouterr().out == printed


def where(nest, path):
    return next(each for each in nest.layout() if each.path == path)


def script(text, there, **values):
    for name, value in {"LINE": there.command, "X": there.origin[0], **values}.items():
        text = re.sub(rf"\b{name}\b", lambda _, value=value: json.dumps(value), text)
    return text


@pytest.mark.long
def test_who_moved_the_diamond_finds_it_where_sally_believes_it(play_of_a_person):
    with (
        Nest.open(play_of_a_person, realtime=True, listen=0) as nest,
        Person(nest.address, "anne") as anne,
    ):
        nest.play()
        nest["/observer/sally"].embody(unknown="glass")
        nest["/observer"].embody()
        anne.does(MOVE)
        assert nest.wait(lambda: anne.is_done, LONG_S)
        assert nest["/"].state.containers[RIGHT].items == {"diamond": 1}
        assert nest["/observer"].state.containers[LEFT].items == {"diamond": 1}

        belief = where(nest, "/observer/sally")
        expected = {
            "left": {"diamond": 1},
            "right": {},
            # Sally has never turned to where the observer stands.
            "players": ["anne_1", "sally_1"],
            "unseen": "glass",
        }
        anne.does(script(TRAVEL + LOOK, belief, EXPECTED=expected))
        assert nest.wait(lambda: anne.is_done, LONG_S)
        assert nest.people == frozenset()
        assert nest["/"].state.agents["anne"].current

        # The visitor sees, while the program runs, what the observer sees again.
        anne.does(script(TRAVEL + WATCH, where(nest, "/observer")))
        watches = "Nobody hears you here: visitors of a belief are not in it."
        assert nest.wait(lambda: anne.is_done or watches in anne.read, LONG_S)
        programs = {
            "observer": "await bot.lookAt(new Vec3(0, -50, -2), true); await waitTicks(bot, 5)",
            "sally": "await goToPosition(bot, new Vec3(1, -51, -1), 0)",
        }
        results = nest["/"].run_all(programs)
        assert all(result.ok for result in results.values())
        assert nest.wait(lambda: anne.is_done, LONG_S)
        assert [each.path for each in nest.layout()] == ["/", "/observer/sally", "/observer"]

        with Person(nest.address, "sally") as taken:
            assert taken.left().endswith("come as anne, or by another name to look")
        nest["/observer"].embody(False)
        assert nest.wait(lambda: nest.people == {"anne"}, LONG_S)
        assert [each.path for each in nest.layout()] == ["/", "/observer/sally"]


@pytest.mark.long
def test_a_visitor_sees_what_is_tried_out_and_can_come_again_after_a_crash():
    scenario = Scenario.load("red-green-blue", condition=1)
    with Nest.open(scenario, realtime=True, listen=0) as nest:
        belief = nest["/agent_1"]
        belief.embody()
        belief.embody(unknown="glass")
        there = where(nest, "/agent_1")
        blue = (
            "while (bot.blockAt(new Vec3(X + 8, 1, 2))?.name !== 'glass') await waitTicks(bot, 1)"
        )
        with Person(nest.address, "guest") as guest:
            guest.does(script(blue, there))
            assert nest.wait(lambda: guest.is_done, LONG_S)
            belief.switch("aside")
            assert belief.run("agent_1", "await goToPosition(bot, new Vec3(2, 1, 2), 0)").ok
            at = "while (!(bot.players.agent_1_1.entity.position.z < 3)) await waitTicks(bot, 1)"
            guest.does(at)
            assert nest.wait(lambda: guest.is_done, LONG_S)
            # Reality's process ends, and with it whatever stood there.
            nest._engine.bodies.world.interrupt()
            guest.left()
        nest.wait(timeout_s=0)
        with Person(nest.address, "guest") as guest:
            guest.does(script(blue, there))
            guest.does(at)
            assert nest.wait(lambda: guest.is_done, LONG_S)


SAID = "await say(bot, 'There.', [located('diamond', new Vec3(-2, -51, -4))])"
# A place of which only the diamond is known.
IN_THE_CHEST = """
const chest = () => bot.blockAt(new Vec3(X - 2, -51, -4))
while (chest()?.name !== 'chest') await waitTicks(bot, 1)
await goToPosition(bot, new Vec3(X, -51, -2), 1)
const items = await bot.openContainer(chest())
await waitTicks(bot, 5)
const found = items.containerItems().map(({name}) => name).join()
if (found !== 'diamond') throw new Error(found)
"""


def test_a_chest_stands_where_contents_are_believed_in_an_unknown_block():
    scenario = Scenario.from_mapping(
        {
            "name": "unseen",
            "box": [[-6, -52, -6], [6, -49, 6]],
            "blocks": [{"block": "stone", "fill": [[-6, -52, -6], [6, -52, 6]]}],
            "agents": {"ann": {"position": [0.5, -51, 3.5]}, "bob": {"position": [0.5, -51, -3.5]}},
            "static_blocks": ["stone"],
            "perception": {"testimony": "accept", "max_visible_distance": 3},
        }
    )
    with Nest.open(scenario, realtime=True, listen=0) as nest:
        belief = nest["/ann"]
        belief.embody()
        assert nest["/"].run("bob", SAID).ok
        assert belief.state.blocks[LEFT] is None
        with Person(nest.address, "guest") as guest:
            guest.does(script(IN_THE_CHEST, where(nest, "/ann")))
            assert nest.wait(lambda: guest.is_done, LONG_S)
        belief.switch("try")
        assert belief.placed == {LEFT: (None, "chest")}


# A visitor on a server waits for exactly this scene at the place that the layout names.
FIND = """
const seen = async () => {
  const chest = bot.blockAt(new Vec3(X - 2, -51, -4))
  const found = {chest: chest?.name, unseen: bot.blockAt(new Vec3(X, -52, 11))?.name}
  if (chest?.name === 'chest') {
    const window = await bot.openContainer(chest)
    found.items = window.containerItems().map(({name}) => name)
    await bot.closeWindow(window)
  }
  found.sally = bot.players.sally_1?.entity?.position.x < X
  return JSON.stringify(found)
}
for (let left = 2000; await seen() !== JSON.stringify(EXPECTED); left--) {
  if (left === 0) throw new Error(await seen())
  await waitTicks(bot, 1)
}
"""
TAKE = "await getItemFromChest(bot, new Vec3(-2, -51, -4), {diamond: 1})"


@pytest.mark.long
def test_on_a_server_a_belief_is_built_kept_up_and_what_was_there_put_back():
    scenario = sally_anne({})
    with (
        GameServer() as server,
        Person(f"127.0.0.1:{server.port}", "guest") as guest,
        Nest.open(scenario, world=server.address()) as nest,
    ):
        nest["/"].run("sally", SCRIPT[0]["program"])
        nest["/observer/sally"].embody(unknown="glass")
        there = where(nest, "/observer/sally")
        server.type("op guest")
        stand = dict(zip("xyz", there.command.split()[1:], strict=True))
        above = f"/tp {stand['x']} {there.high[1] + 2} {stand['z']}"
        guest.does(
            f"bot.physicsEnabled = false; bot.chat('/gamemode spectator'); bot.chat('{above}')"
        )
        found = {"chest": "chest", "unseen": "glass", "items": ["diamond"], "sally": True}
        guest.does(script(FIND, there, EXPECTED=found))
        assert nest.wait(lambda: guest.is_done, LONG_S)

        # Anne takes it under Sally's eyes, and the agents know of nobody else.
        look = "await bot.lookAt(new Vec3(-2, -50, -3), true); await waitTicks(bot, 2)"
        assert nest["/"].run("sally", look).ok
        assert nest["/"].run("anne", TAKE + ";bot.chat(Object.keys(bot.players).join())").ok
        assert "_1" not in nest["/"].state.chat[-1][2]
        guest.does(script(FIND, there, EXPECTED={**found, "items": []}))
        assert nest.wait(lambda: guest.is_done, LONG_S)

        nest["/observer/sally"].embody(False)
        guest.does(script(FIND, there, EXPECTED={"chest": "air", "unseen": "air", "sally": False}))
        assert nest.wait(lambda: guest.is_done, LONG_S)
        server.type(f"setblock {there.low[0]} {there.low[1]} {there.low[2]} gold_block")
        with pytest.raises(WorldError, match=r"holds 1 other blocks, as gold_block"):
            nest["/observer/sally"].embody()
        assert [each.path for each in nest.layout()] == ["/"]


def test_what_nobody_could_visit_is_refused(play_of_a_person):
    with Nest.open(Scenario.load("sally-anne", 1), "scripted") as nest:
        with pytest.raises(InputError, match=r"nobody can visit a belief in this world.*realtime"):
            nest["/observer"].embody()
        with pytest.raises(InputError, match="nothing stands where people could go"):
            nest.layout()
    with Nest.open(play_of_a_person, realtime=True, listen=0) as nest:
        with pytest.raises(InputError, match=r"stands in Minecraft already.*nest\.layout"):
            nest["/"].embody()
        with pytest.raises(UnknownNameError, match="fog"):
            nest["/observer"].embody(unknown="fog")
        nest["/observer"].embody(False)
        assert [each.path for each in nest.layout()] == ["/"]
