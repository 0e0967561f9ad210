"""Built-in prompt filters, in the formats of the paper's appendix.

Each filter takes the simulator before the bar. A word such as `No data` is printed only for
values that the belief lacks; faults are raised.
"""

from collections.abc import Iterable, Mapping

from beliefnest.belief.grounds import AgentBelief, Basis, PerceivedEvent, Source
from beliefnest.belief.view import State
from beliefnest.prompts import event_rows, text
from beliefnest.prompts.filterset import FilterSet, filter
from beliefnest.prompts.memory_filters import FILTERS
from beliefnest.prompts.simulator_view import (
    BranchView,
    belief_of,
    believed_agent,
    blocks_named,
    blocks_where,
    owner_of,
)
from beliefnest.prompts.story_filters import FILTERS as STORY_FILTERS
from beliefnest.world.double_chests import is_left_half
from beliefnest.world.registry import Registry, block_name, parse_state
from beliefnest.world.texts import on_one_line
from beliefnest.world.values import EQUIPMENT_SLOTS, Position

_AIRS = frozenset({"air", "cave_air", "void_air"})
_CHESTS = frozenset({"chest", "trapped_chest", "barrel"})
_EVENT_HEADER = "time;action;agent_name;description"
_CHAT_HEADER = "time;agent_name;message"


@filter("position")
def position(branch: BranchView, agent: str | None = None) -> str:
    """Return an agent's position as `[x, y, z]`; without a name, the owner's.

    `Cannot be seen` for another agent that is not seen at this tick. The owner's last known
    position is printed even if the outer believer does not see the owner; `No data` if it was
    never known.
    """
    state = branch.state
    believed = believed_agent(state, agent)
    if agent in (None, state.owner):
        return text.NO_DATA if believed.position is None else text.point(believed.position)
    return _position(believed)


def _position(believed: AgentBelief) -> str:
    """Return the position of an agent other than the owner."""
    if believed.position is None or not believed.current:
        return text.CANNOT_BE_SEEN
    return text.point(believed.position)


@filter("thought")
def thought(branch: BranchView) -> str:
    """Return the last thought of the belief's owner; `No thought` if there is none.

    In the real world, one line `name: thought` for each agent that has thought something.
    """
    state = branch.state
    if not state.thoughts:
        return text.NO_THOUGHT
    last = {thinker: on_one_line(words) for _, thinker, words in state.thoughts}
    if state.owner is None:
        return "\n".join(f"{thinker}: {last[thinker]}" for thinker in sorted(last))
    return last.get(state.owner, text.NO_THOUGHT)


@filter("chat_log")
def chat_log(branch: BranchView) -> str:
    """Return the heard utterances, one line `time;agent_name;message` each.

    `No chats` if there are none. A whisper names the addressee: `12;anne whispers to sally;Come
    here.`
    """
    state = branch.state
    if not state.chat:
        return text.NO_CHATS
    rows = [
        f"{tick};{speaker}{'' if to is None else f' whispers to {to}'};{on_one_line(words)}"
        for (tick, speaker, words), to in zip(state.chat, state.addressees, strict=True)
    ]
    return "\n".join([_CHAT_HEADER, *rows])


@filter("inventory")
def inventory(branch: BranchView, agent: str | None = None) -> str:
    """Return the items that an agent is known to have, as `{'diamond': 1}`.

    Worn and held items are included. `Empty` if it is known to have nothing, `No data` if
    nothing is known.
    """
    return _inventory(believed_agent(branch.state, agent))


def _inventory(believed: AgentBelief) -> str:
    if believed.inventory:
        return text.mapping(believed.inventory)
    return text.EMPTY if believed.inventory_complete else text.NO_DATA


@filter("equipment")
def equipment(branch: BranchView, agent: str | None = None) -> str:
    """Return the items that an agent was last seen to wear and hold.

    They print as `{'head': 'iron_helmet'}`; `Empty` if there were none, `No data` if the agent
    was never seen.
    """
    worn = believed_agent(branch.state, agent).equipment
    if worn is None:
        return text.NO_DATA
    if not worn:
        return text.EMPTY
    return repr({slot: worn[slot] for slot in EQUIPMENT_SLOTS if slot in worn})


@filter("helditem")
def helditem(branch: BranchView, agent: str | None = None) -> str:
    """Return the item in an agent's main hand as last seen.

    `Empty` for an empty hand, `No data` if the agent was never seen.
    """
    return _helditem(believed_agent(branch.state, agent))


def _helditem(believed: AgentBelief) -> str:
    if believed.equipment is None:
        return text.NO_DATA
    return believed.equipment.get("main_hand", text.EMPTY)


@filter("chests")
def chests(branch: BranchView) -> str:
    """Return known chests, trapped chests and barrels, one line each.

    A line is `(x, y, z): {'diamond': 1}`; `{}` for a chest that is empty or whose contents are
    unknown. `Not observed` if no chest is known.
    """
    state = branch.state
    lines = [
        f"{text.position(at)}: {text.mapping(state.containers[at].items)}"
        for at in sorted(state.containers)
        if (block := state.blocks[at]) is None or block_name(block) in _CHESTS
    ]
    return "\n".join(lines) or text.NOT_OBSERVED


@filter("other_players")
def other_players(branch: BranchView) -> str:
    """Return `position`, `helditem` and `inventory` of every agent but the owner, as JSON.

    The values are those of the filters with these names.
    """
    state = branch.state
    return text.as_json(
        {
            name: {
                "position": _position(state.agents[name]),
                "helditem": _helditem(state.agents[name]),
                "inventory": _inventory(state.agents[name]),
            }
            for name in sorted(state.agents)
            if name != state.owner
        }
    )


@filter("blocks")
def blocks(branch: BranchView, names: Iterable[str] | None = None) -> str:
    """Return known blocks, one line `chest: (x, y, z), (x, y, z)` for each name.

    Without names, all known blocks except air. `Not observed` for a name without known blocks.
    """
    lines = [
        f"{name}: {', '.join(map(text.position, places)) or text.NOT_OBSERVED}"
        for name, places in _known_blocks(branch.state, names).items()
    ]
    return "\n".join(lines) or text.NOT_OBSERVED


@filter("blocks_and_visibilities")
def blocks_and_visibilities(
    branch: BranchView, names: Iterable[str] | None = None, others: Iterable[str] = ()
) -> str:
    """Return known blocks, and which agents saw them before and see them at this tick.

    Names as in `blocks`. `Me` is the owner of the belief. `others` are further agents, whose
    sight is reported as the owner believes it to be.
    """
    state = branch.state
    viewers = {} if state.owner is None else {"Me": state}
    viewers |= {name: belief_of(branch, name) for name in _strings(others)}
    parts = []
    for name, places in _known_blocks(state, names).items():
        seen = {text.position(at): _visibility(viewers, at) for at in places}
        parts.append(
            f"{name} visibilities:{text.as_json(seen)}"
            if seen
            else f"{name} visibilities: {text.NOT_OBSERVED}"
        )
    return "\n".join(parts) or text.NOT_OBSERVED


def _visibility(viewers: Mapping[str, State], at: Position) -> dict[str, dict[str, bool]]:
    return {
        viewer: {
            "seen_before": state.blocks[at] is not None,
            "visible_now": state.blocks.current(at),
        }
        for viewer, state in viewers.items()
    }


@filter("block_property")
def block_property(branch: BranchView, name: str) -> str:
    """Return known blocks of one name with their properties, one line `(x, y, z): {...}` each.

    `Not observed` if no such block is known.
    """
    pairs = blocks_named(branch.state, [name])
    lines = [f"{text.position(at)}: {text.mapping(parse_state(block)[1])}" for at, block in pairs]
    return "\n".join(lines) or text.NOT_OBSERVED


@filter("events")
def events(branch: BranchView) -> str:
    """Return perceived actions except speech, one line each.

    A line is `time;action;agent_name;description`; actions have the names of their skills. `Not
    observed` if there are none.
    """
    perceived = branch.state.events
    if not perceived:
        return text.NOT_OBSERVED
    return "\n".join([_EVENT_HEADER, *map(event_rows.row, perceived)])


@filter("events_and_visibilities")
def events_and_visibilities(branch: BranchView, me: str | None = None) -> str:
    """Return perceived actions with their other witnesses, and the last sightings of agents.

    `me` is an agent whose perspective replaces the owner's, as the owner believes it to be.
    `perceived_by` lists the other agents that, in this perspective, perceived the action.
    Sightings are `visible` (seen now), `lastSeen`, `heardOf` (known from speech only) or `assumed`
    (believed from the start, and not seen since).
    """
    mine = branch if me is None else branch.child(_known(branch, me))
    state = mine.state
    owner = owner_of(state)
    others = {name: belief_of(mine, name) for name in sorted(state.agents) if name != owner}
    rows = [
        (event.tick, f"{event_rows.row(event)};{_witnesses(event, others)}")
        for event in state.events
    ]
    rows += [
        (row_tick, f"{row_tick};{how};{name};position:{where};")
        for name, row_tick, how, where in _sightings(state, list(others))
    ]
    if not rows:
        return text.NOT_OBSERVED
    ordered = sorted(rows, key=lambda row: row[0])
    return "\n".join([f"{_EVENT_HEADER};perceived_by", *(line for _, line in ordered)])


def _known(branch: BranchView, agent: str) -> str:
    believed_agent(branch.state, agent)
    return agent


def _witnesses(event: PerceivedEvent, others: Mapping[str, State]) -> str:
    key = (event.tick, event.kind, event.actor)
    return ", ".join(
        name
        for name, state in others.items()
        if any((seen.tick, seen.kind, seen.actor) == key for seen in state.events)
    )


def _sightings(state: State, names: Iterable[str]) -> list[tuple[str, int, str, str]]:
    """Return name, tick, manner and position of the last sighting of each agent."""
    return [
        (name, believed.basis.observed_at, _how_known(believed), text.point(believed.position))
        for name, believed in ((name, state.agents[name]) for name in names)
        if believed.basis is not None and believed.position is not None
    ]


def _how_known(believed: AgentBelief) -> str:
    if believed.current:
        return "visible"
    match believed.basis:
        case Basis(source=Source.HEARD):
            return "heardOf"
        case Basis(source=Source.PRIOR):
            return "assumed"
        case _:
            return "lastSeen"


def _known_blocks(state: State, names: Iterable[str] | None) -> dict[str, list[Position]]:
    """Return positions of known blocks by name, sorted; requested names may have none.

    A double chest is listed once, at its right half.
    """
    if names is None:
        grouped: dict[str, list[Position]] = {}
        for at, block in blocks_where(state, lambda each: block_name(each) not in _AIRS):
            if _is_whole(block):
                grouped.setdefault(block_name(block), []).append(at)
        return {name: sorted(grouped[name]) for name in sorted(grouped)}
    wanted = [name.removeprefix("minecraft:") for name in _strings(names)]
    grouped = {name: [] for name in wanted}
    for at, block in blocks_named(state, wanted):
        if _is_whole(block):
            grouped[block_name(block)].append(at)
    return grouped


def _is_whole(block: str) -> bool:
    registry = Registry.load()
    return not is_left_half(registry, registry.state_id(block))


def _strings(values: Iterable[str]) -> list[str]:
    """Return a list of names; a template may give one name without a list."""
    if isinstance(values, str):
        return [values]
    return list(values)


BUILT_IN = FilterSet.of(
    [
        position,
        thought,
        chat_log,
        inventory,
        equipment,
        helditem,
        chests,
        other_players,
        blocks,
        blocks_and_visibilities,
        block_property,
        events,
        events_and_visibilities,
        *FILTERS,
        *STORY_FILTERS,
    ]
)
"""Filters of interface.md, and those of the default template."""
