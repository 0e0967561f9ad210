"""Environments in which agents act in turn; wrong actions are refused at their own turn."""

from copy import deepcopy
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt
from pettingzoo.utils.conversions import parallel_to_aec_wrapper
from pettingzoo.utils.wrappers import OrderEnforcingWrapper

from beliefnest.env.environment import BeliefEnv
from beliefnest.env.saving import SavedEpisode
from beliefnest.errors import InputError


class SavedTurns(msgspec.Struct, frozen=True):
    """Episode up to an agent's turn.

    Attributes:
        episode: Episode up to the last joint step.
        turns: Whose turn it is, what was chosen since then, and what agents were told.
    """

    episode: SavedEpisode
    turns: dict[str, Any]


class TurnsEnv(OrderEnforcingWrapper):  # type: ignore[misc]  # it has no type information
    """A scenario or task in which agents act in turn; `unwrapped` is the parallel environment.

    Args:
        env: The parallel environment.
    """

    def __init__(self, env: BeliefEnv) -> None:
        super().__init__(parallel_to_aec_wrapper(env))

    def step(self, action: Any) -> None:
        """Choose the action of the agent whose turn it is; after the last one, time passes.

        Raises:
            InputError: The action is not in the space, or the agent acts no more and the action is
                not None; it is still its turn.
            BodyError: The Minecraft side failed.
        """
        if self._has_reset and self.agents:
            agent = self.agent_selection
            if not (self.terminations[agent] or self.truncations[agent]):
                self.unwrapped.check_action(agent, action)
            elif action is not None:
                raise InputError(f"the episode is over for {agent}: step with None, or reset()")
        super().step(action)

    def last(self, observe: bool = True) -> Any:
        """Return observation, rewards, ends and info of the agent whose turn it is.

        Raises:
            InputError: The episode is over, and no agent has a turn.
        """
        if self._has_reset and not self.agents:
            raise InputError("the episode is over, and no agent has a turn: call reset()")
        return super().last(observe)

    def action_masks(self, agent: str | None = None) -> npt.NDArray[np.int8]:
        """Return 1 for each action of `flat` that can begin as far as its agent knows.

        Args:
            agent: Name of the agent; None: the one whose turn it is.

        Raises:
            InputError: No episode has begun, or the agent cannot act.
        """
        masks: npt.NDArray[np.int8] = self.unwrapped.action_masks(agent or self.agent_selection)
        return masks

    def save(self) -> SavedTurns:
        """Return the episode up to this turn, for `restore` of this environment or of a copy.

        Raises:
            InputError: No episode has begun, or its world was changed by hand.
        """
        turns = {name: each for name, each in vars(self.env).items() if name != "env"}
        return SavedTurns(self.unwrapped.save(), deepcopy(turns))

    def restore(self, saved: SavedTurns) -> None:
        """Play a saved episode again up to the turn at which it was saved.

        Raises:
            InputError: The episode is not one of this environment; the current one continues.
            BodyError: The Minecraft side failed.
        """
        if not isinstance(saved, SavedTurns):
            raise InputError(f"{saved!r:.100} is no saved episode; give what save() returned")
        self.unwrapped.restore(saved.episode)
        self.env.__dict__.update(deepcopy(saved.turns))
        self._has_reset = True
