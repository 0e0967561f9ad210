"""Doors of bodies: what programs read, and what becomes of their acts, in beliefs and in the world.

These doors act: those of one path come after each other in both worlds of a pair.
"""

import json
import random
from collections.abc import Iterator

from tests.noninterference.doors import door
from tests.noninterference.pairs import AGENTS, BOX, Played

import beliefnest as bn
from beliefnest.worlds.protocol import ProgramResult

_READS = """
const told = (value) => value == null ? 'nothing' : JSON.stringify(value);
const cells = {cells};
console.log(told(Object.keys(bot.players).sort()), told(bot.inventory.items().map((i) => i.name)));
console.log(told(Object.values(bot.entities).map((e) => [e.username, e.position]).sort()));
console.log(cells.map(([x, y, z]) => told(bot.blockAt(new Vec3(x, y, z))?.name)).join(' '));
const tried = async (act) => {{
  try {{ console.log(told(await act())) }} catch (error) {{ console.log(error.message) }}
}};
{acts}
"""
_ACTS = (
    "goToPosition(bot, new Vec3({x}, 1, {z}), 1)",
    "getItemFromChest(bot, new Vec3({x}, 1, {z}), {{diamond: 1}})",
    "depositItemIntoChest(bot, new Vec3({x}, 1, {z}), {{apple: 1}})",
    "turnOnLever(bot, new Vec3({x}, 1, {z}))",
    "openDoor(bot, new Vec3({x}, 1, {z}))",
    "mineBlock(bot, new Vec3({x}, 1, {z}), 'chest')",
    "placeItem(bot, 'cobblestone', new Vec3({x}, 1, {z}))",
    "giveItemToOther(bot, '{other}', 'apple', 1)",
    "say(bot, 'hello')",
)


@door(every=10)
def forks(world: Played, path: str) -> object:
    """Return what a program reads and does in a body that is made from the belief."""
    simulator, agent = world.nest[path], path.rpartition("/")[2]
    try:
        simulator.switch(f"at {world.nest.tick}")
        result = simulator.run(agent, _program(world.seed), timeout_ticks=400)
        return _told(result), repr(simulator.state), simulator.placed
    except bn.WorldError as error:  # There is no body of an agent whose place is unknown.
        return str(error)
    finally:
        simulator.switch("follow")


@door(every=8)
def programs(world: Played, path: str) -> object:
    """Return what a program of Ann reads and does in the world, by what she perceives."""
    ran = world.nest["/"].run("ann", _program(world.seed), timeout_ticks=400, senses="percepts")
    return _told(ran), repr(world.nest[path].state)


def _program(seed: int) -> str:
    """Return a program that reads cells of the whole box and tries some skills in it."""
    chance = random.Random(f"program {seed}")
    low, high = BOX
    cells = [[chance.randint(*ends) for ends in zip(low, high, strict=True)] for _ in range(40)]
    return _READS.format(cells=json.dumps(cells), acts="\n".join(_acts(chance)))


def _acts(chance: random.Random) -> Iterator[str]:
    for act in chance.sample(_ACTS, 5):
        place = {"x": chance.choice((1, 3, 5, 7, 9, 11)), "z": chance.choice((0, 2, 3, 4, 6))}
        yield f"await tried(() => {act.format(**place, other=chance.choice(AGENTS))});"


def _told(result: ProgramResult) -> object:
    events = [(each.kind, each.actor, each.detail) for each in result.events]
    return result.ok, str(result.error), result.log, result.ticks, events
