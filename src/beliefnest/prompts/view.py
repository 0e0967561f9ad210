"""What prompts need of a simulator: its state, and the beliefs of the agents in it."""

from collections.abc import Mapping
from typing import Protocol

from beliefnest.belief.entries import AgentBelief
from beliefnest.belief.view import State
from beliefnest.errors import InputError, UnknownNameError
from beliefnest.prompts.text import nearest
from beliefnest.world.values import Position

__all__ = ["BranchView", "belief_of", "believed_agent", "owner_of"]


class BranchView(Protocol):
    """A simulator as prompts read it: `branch` in a template."""

    @property
    def state(self) -> State:
        """The simulator's state."""

    @property
    def labels(self) -> Mapping[Position, str]:
        """What containers are called and look as if they held, where prompts may say so."""

    def child(self, agent: str) -> "BranchView":
        """Return the belief simulator of an agent in this one; the owner's own is this one."""


def owner_of(state: State) -> str:
    """Return the agent whose belief a state is.

    Raises:
        InputError: It is the real world, which is nobody's belief.
    """
    if state.owner is None:
        raise InputError(
            "the real world is nobody's belief, so there is no 'me' in it: "
            "name an agent in the filter, or render a belief such as /sally"
        )
    return state.owner


def believed_agent(state: State, agent: str | None) -> AgentBelief:
    """What a state says of an agent; without a name, of its owner.

    Raises:
        InputError: No name was given in the real world.
        UnknownNameError: The scenario has no such agent.
    """
    name = owner_of(state) if agent is None else agent
    if name not in state.agents:
        raise UnknownNameError(f"no agent {name!r} in the scenario{nearest(name, state.agents)}")
    return state.agents[name]


def belief_of(branch: BranchView, agent: str) -> State:
    """Return the state that an agent in a simulator believes.

    Raises:
        UnknownNameError: The scenario has no such agent.
    """
    believed_agent(branch.state, agent)
    return branch.child(agent).state
