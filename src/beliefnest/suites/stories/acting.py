"""Acts of a story in a world: calls of the scripted world, or programs for bots."""

import json
from collections.abc import Sequence

from beliefnest.suites.stories.floor_plan import FloorPlan, feet
from beliefnest.suites.stories.grammar import UseDoor, Write
from beliefnest.suites.stories.story import Act, Come, Go, LookInto, Move, Place, Put, Take, Tell
from beliefnest.world.claims import Claim
from beliefnest.world.values import Position
from beliefnest.worlds.scripted.world import ScriptedWorld


def tell(world: ScriptedWorld, plan: FloorPlan, act: Act) -> None:  # noqa: PLR0912  # one case an act
    """Do one act in one tick."""
    with world.tick():
        match act:
            case Come(agents, room):
                for agent in agents:
                    world.place_agent(agent, feet(plan.stands[room, agent]))
            case Go(agents):
                for agent in agents:
                    world.place_agent(agent, feet(plan.apart[agent]))
            case Move(agent, thing, source, target):
                item = {plan.items[thing]: 1}
                world.withdraw(agent, plan.places[source], item)
                world.deposit(agent, plan.places[target], item)
            case Take(agent, thing, source):
                world.withdraw(agent, plan.places[source], {plan.items[thing]: 1})
            case Put(agent, thing, target):
                world.deposit(agent, plan.places[target], {plan.items[thing]: 1})
            case UseDoor(agent, room, opens):
                world.use_door(agent, plan.doors[room], open=opens)
            case Write(agent, room, text):
                world.write_sign(agent, plan.signs[room], text)
            case LookInto(agent, place):
                world.open(agent, plan.places[place])
            case Tell(agent, None):
                world.say(agent, act.text, _claims(act, plan))
            case Tell(agent, str(hearer)):
                world.whisper(agent, hearer, act.text, _claims(act, plan))
            case _:
                pass


def programs_of(act: Act, plan: FloorPlan) -> dict[str, str]:
    """Return the programs with which bots perform an act, by agent; empty: no bot acts."""
    match act:
        case Come(agents, room):
            return {agent: _walk(plan.stands[room, agent], act.shuts) for agent in agents}
        case Go(agents):
            return {agent: _walk(plan.apart[agent], act.shuts) for agent in agents}
        case Move() | Take() | Put() | UseDoor() | Write() | LookInto() | Tell():
            return {act.agent: _program(act, plan)}
        case _:
            return {}


def _program(  # noqa: PLR0911  # one case an act
    act: Move | Take | Put | UseDoor | Write | LookInto | Tell, plan: FloorPlan
) -> str:
    """Return the program of one agent, which ends at the agent's stand, out of the others' way."""
    match act:
        case Move(agent, thing, source, target):
            taking, putting = _taking(thing, source, plan), _putting(thing, target, plan)
            return taking + putting + _walk(plan.stands[source.room, agent])
        case Take(agent, thing, source):
            return _taking(thing, source, plan) + _walk(plan.stands[source.room, agent])
        case Put(agent, thing, target):
            return _putting(thing, target, plan) + _walk(plan.stands[target.room, agent])
        case UseDoor(agent, room, opens):
            skill = "openDoor" if opens else "closeDoor"
            return f"await {skill}(bot, {_vec3(plan.doors[room])})\n" + _walk(
                plan.stands[room, agent]
            )
        case Write(agent, room, text):
            sign = f"await writeSign(bot, {_vec3(plan.signs[room])}, {json.dumps(text)})\n"
            return sign + _walk(plan.stands[room, agent])
        case LookInto(agent, place):
            where = _vec3(plan.places[place])
            return (
                f"await goToPosition(bot, {where}, 2)\n"
                f"const inside = await bot.openContainer(bot.blockAt({where}))\n"
                "await bot.closeWindow(inside)\n" + _walk(plan.stands[place.room, agent])
            )
        case Tell():
            return _telling(act, plan)


def _taking(thing: str, source: Place, plan: FloorPlan) -> str:
    items = f"{{{plan.items[thing]}: 1}}"
    return f"await getItemFromChest(bot, {_vec3(plan.places[source])}, {items})\n"


def _putting(thing: str, target: Place, plan: FloorPlan) -> str:
    items = f"{{{plan.items[thing]}: 1}}"
    return f"await depositItemIntoChest(bot, {_vec3(plan.places[target])}, {items})\n"


def _claims(tell: Tell, plan: FloorPlan) -> list[Claim]:
    if not tell.is_claimed:
        return []
    make = Claim.located if tell.is_there else Claim.absent
    return [make(plan.items[tell.thing], plan.places[tell.place])]


def _telling(tell: Tell, plan: FloorPlan) -> str:
    make = "located" if tell.is_there else "absent"
    item, place = json.dumps(plan.items[tell.thing]), _vec3(plan.places[tell.place])
    claims = f", [{make}({item}, {place})]" if tell.is_claimed else ""
    said = f"{json.dumps(tell.text)}{claims}"
    if tell.hearer is None:
        return f"await say(bot, {said})"
    return f"await whisper(bot, {json.dumps(tell.hearer)}, {said})"


def _walk(block: Position, shuts: Sequence[str] = ()) -> str:
    doors = ", {closeDoors: true}" if shuts else ""
    return f"await goToPosition(bot, {_vec3(block)}, 0{doors})"


def _vec3(position: Position) -> str:
    return f"new Vec3({', '.join(map(str, position))})"
