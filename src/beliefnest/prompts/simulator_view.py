"""Read-only view of simulators for prompts: states, and beliefs of agents."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Protocol

from beliefnest.belief.grounds import AgentBelief
from beliefnest.belief.view import State
from beliefnest.errors import InputError, UnknownNameError
from beliefnest.prompts.observations import Observation
from beliefnest.prompts.text import nearest
from beliefnest.world.registry import Registry
from beliefnest.world.texts import quoted
from beliefnest.world.values import Position


class BranchView(Protocol):
    """A simulator as prompts see it: `branch` in a template."""

    @property
    def state(self) -> State:
        """State of the simulator."""

    @property
    def labels(self) -> Mapping[Position, str]:
        """Labels of containers (name and appearance), if prompts may show them."""

    @property
    def names(self) -> Mapping[Position, str]:
        """Names of containers, signs, doors and switches, without articles."""

    @property
    def places(self) -> Mapping[str, Position]:
        """Positions of named places, by name."""

    @property
    def unique(self) -> frozenset[str]:
        """Items of which everybody knows that there is one."""

    @property
    def observations(self) -> Sequence[Observation]:
        """Observations of the owner until now, in the order of time; in the real world, all."""

    def child(self, agent: str) -> "BranchView":
        """Return the simulator of an agent's belief; for the owner, this simulator itself."""


_MOST_LISTED = 250_000
"""Most blocks in a text; their positions are some megabytes."""


def blocks_where(state: State, accepts: Callable[[str], bool]) -> Iterator[tuple[Position, str]]:
    """Yield the known blocks whose text a function accepts, in order of position.

    Raises:
        InputError: They are too many for a text.
    """
    text_of = Registry.load().text
    numbers = [number for number in state.blocks.terrain.states if number >= 0]
    return _listed(state, [number for number in numbers if accepts(text_of(number))])


def blocks_named(state: State, names: Iterable[str]) -> Iterator[tuple[Position, str]]:
    """Yield the known blocks with one of some names, in order of position.

    Raises:
        InputError: They are too many for a text.
        UnknownNameError: No block has such a name.
    """
    return _listed(state, Registry.load().states_of(names))


def _listed(state: State, wanted: Sequence[int]) -> Iterator[tuple[Position, str]]:
    registry, terrain = Registry.load(), state.blocks.terrain
    count = terrain.count(wanted)
    if count > _MOST_LISTED:
        often = max(wanted, key=lambda number: terrain.count([number]))
        raise InputError(
            f"there are {count:,} known blocks to list, most of them {registry.name(often)}; at "
            f"most {_MOST_LISTED:,} are possible: name rarer ones, as in blocks(['chest'])"
        )
    x, y, z = state.box.low
    for i, j, k in terrain.find(wanted).tolist():
        yield (x + i, y + j, z + k), registry.text(terrain[i, j, k])


def owner_of(state: State) -> str:
    """Return the agent that holds a belief.

    Raises:
        InputError: The state is that of the real world.
    """
    if state.owner is None:
        raise InputError(
            "the real world is nobody's belief, so there is no 'me' in it: "
            "name an agent in the filter, or render a belief such as /sally"
        )
    return state.owner


def believed_agent(state: State, agent: str | None) -> AgentBelief:
    """Return the entry of an agent in a state; without a name, that of the owner.

    Raises:
        InputError: No name was given in the real world.
        UnknownNameError: The scenario has no such agent.
    """
    name = owner_of(state) if agent is None else agent
    if name not in state.agents:
        raise UnknownNameError(
            f"no agent {quoted(name)} in the scenario{nearest(name, state.agents)}"
        )
    return state.agents[name]


def belief_of(branch: BranchView, agent: str) -> State:
    """Return the state of an agent's belief in a simulator.

    Raises:
        UnknownNameError: The scenario has no such agent.
    """
    believed_agent(branch.state, agent)
    return branch.child(agent).state
