"""Filters that separate known from unknown values, with the age and source of memories."""

from beliefnest.belief.grounds import AgentBelief, Basis, ContainerBelief, PerceivedEvent, Source
from beliefnest.belief.view import State
from beliefnest.prompts import text
from beliefnest.prompts.filterset import filter
from beliefnest.prompts.simulator_view import BranchView, blocks_where
from beliefnest.world.doors import is_door, is_switch
from beliefnest.world.event_words import skill_of
from beliefnest.world.registry import block_name, parse_state
from beliefnest.world.signs import sign_words
from beliefnest.world.texts import on_one_line
from beliefnest.world.values import TICKS_PER_SECOND, Position


@filter("containers")
def containers(branch: BranchView) -> str:
    """Return known containers, one line each: known contents, their age and their source.

    Contents are `known`, `known in part` (there may be more) or `unknown`. If the scenario has
    `labels: true`, the label of a container is added: its name and appearance. `Not observed` if
    no container is known.
    """
    state = branch.state
    lines = [_container(branch, at, state.containers[at]) for at in sorted(state.containers)]
    return "\n".join(lines) or text.NOT_OBSERVED


def _container(branch: BranchView, at: Position, content: ContainerBelief) -> str:
    block = branch.state.blocks[at]
    name = "container" if block is None else block_name(block)
    label = branch.labels.get(at)
    called = "" if label is None else f" ({on_one_line(label)})"
    return f"{text.position(at)} {name}{called}: {_holds(branch.state, content)}"


def _holds(state: State, content: ContainerBelief) -> str:
    came = memory(state, content.basis, current=content.current)
    if content.complete:
        return f"known, {text.mapping(content.items) if content.items else 'empty'}; {came}"
    if content.items:
        return f"known in part, {text.mapping(content.items)} and maybe more; {came}"
    return "unknown"


@filter("whereabouts")
def whereabouts(branch: BranchView) -> str:
    """Return one line for each agent but the owner: believed position, its age and its source.

    The line also lists the item in its hand and its known items. `unknown` if its position was
    never known.
    """
    state = branch.state
    return "\n".join(
        f"{name}: {_agent(state, state.agents[name])}"
        for name in sorted(state.agents)
        if name != state.owner
    )


def _agent(state: State, agent: AgentBelief) -> str:
    parts = ["unknown"]
    if agent.position is not None and agent.basis is not None:
        came = memory(state, agent.basis, current=agent.current)
        parts = [f"at {text.point(agent.position)}; {came}"]
    in_hand = (agent.equipment or {}).get("main_hand")
    parts += [] if in_hand is None else [f"{in_hand} in its hand"]
    parts += [f"known to have {text.mapping(agent.inventory)}"] if agent.inventory else []
    return "; ".join(parts)


@filter("mechanisms")
def mechanisms(branch: BranchView) -> str:
    """Return known doors, trapdoors, gates, levers and buttons, one line each, with their state.

    The line also has the age and the source of this knowledge, and the last perceived use. `Not
    observed` if none is known.
    """
    state = branch.state
    lines = []
    for at, block in blocks_where(state, lambda block: _stands(block) is not None):
        basis = state.blocks.basis(at)
        came = "" if basis is None else f"; {_memory_of_block(state, at, basis)}"
        stands = _stands(block)
        lines.append(f"{text.position(at)} {block_name(block)}: {stands}{came}{_use(state, at)}")
    return "\n".join(lines) or text.NOT_OBSERVED


@filter("signs")
def signs(branch: BranchView) -> str:
    """Return known signs, one line each: the text, its age and its source.

    `/` separates the lines of a sign; empty signs are marked. The line also names the agent that
    was last perceived to write on the sign. `Not observed` if no sign is known.
    """
    state = branch.state
    lines = []
    for at, written in state.signs.items():
        block, basis = state.blocks[at], state.blocks.basis(at)
        name = "sign" if block is None else block_name(block)
        says = f'says "{sign_words(written)}"' if written else "says nothing"
        came = "" if basis is None else f"; {_memory_of_block(state, at, basis)}"
        lines.append(f"{text.position(at)} {name}: {says}{came}{_writer(state, at)}")
    return "\n".join(lines) or text.NOT_OBSERVED


def _writer(state: State, at: Position) -> str:
    acts = [event for event in state.events if _is_use(event, at) and "text" in event.detail]
    return f"; last written on by {acts[-1].actor} {_age(state, acts[-1].tick)}" if acts else ""


def _memory_of_block(state: State, at: Position, basis: Basis) -> str:
    return memory(state, basis, current=state.blocks.current(at))


def _stands(block: str) -> str | None:
    """Return the state of a door or switch in a word.

    None for other blocks, and for the upper half of a door.
    """
    name, properties = block_name(block), parse_state(block)[1]
    if is_door(name):
        upper = properties.get("half") == "upper" and "hinge" in properties
        return None if upper else "open" if properties.get("open") == "true" else "shut"
    if is_switch(name):
        return "on" if properties.get("powered") == "true" else "off"
    return None


def _use(state: State, at: Position) -> str:
    uses = [event for event in state.events if _is_use(event, at)]
    if not uses:
        return ""
    last = uses[-1]
    return f"; last used by {last.actor} {_age(state, last.tick)} ({skill_of(last)})"


def _is_use(event: PerceivedEvent, at: Position) -> bool:
    is_deed = event.actor is not None and not event.kind.is_speech
    return is_deed and event.detail.get("position") == at


def memory(state: State, basis: Basis, *, current: bool) -> str:
    """Return the source and the age of an entry in words, as `seen 2 s ago`."""
    if current:
        return "seen now"
    age = _age(state, basis.observed_at)
    match basis.source:
        case Source.PRIOR:
            return "believed from the start"
        case Source.SEEN:
            return f"seen {age}"
        case Source.WITNESSED:
            return f"witnessed {age}"
        case Source.HEARD:
            return f"{_heard(state, basis)} {age}"
        case Source.EDITED:
            return f"edited {age}"


def _heard(state: State, basis: Basis) -> str:
    """Return the source of hearsay in words; a speaker's own words are `said`."""
    if basis.speaker is None:
        # Every utterance has a speaker; only the writer of a sign can be unknown.
        return "read on a sign"
    return "said" if basis.speaker == state.owner else f"heard from {basis.speaker}"


def _age(state: State, tick: int) -> str:
    return f"{text.number(round((state.tick - tick) / TICKS_PER_SECOND, 1))} s ago"


FILTERS = (containers, whereabouts, mechanisms, signs)
"""Filters of this module."""
