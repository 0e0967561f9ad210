"""Copies of an environment as a vector environment of Gymnasium, in one process."""

from collections.abc import Callable, Mapping, Sequence
from copy import deepcopy
from typing import Any

import numpy as np
import numpy.typing as npt
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space, concatenate, create_empty_array, iterate

from beliefnest.adapters.pettingzoo.environment import BeliefEnv, BeliefSpace
from beliefnest.errors import InputError
from beliefnest.world.seeds import checked_seed

_Flags = npt.NDArray[np.bool_]


class BeliefVectorEnv(VectorEnv[Any, Any, Any]):
    """Copies of an environment that are stepped together; each agent of a copy is a row.

    After the end of a copy's episode its next step begins another one, ignores the actions and
    gives the reward 0 (`AutoresetMode.NEXT_STEP`). Copy i of n plays the seeds s + i, s + i + n,
    s + i + 2n, ...

    Args:
        make: Function that returns a new environment.
        copies: Number of copies.

    Attributes:
        envs: The copies.
        rows: Copy and agent of each row.

    Raises:
        InputError: There is no copy, or the environment has no arrays.
    """

    def __init__(self, make: Callable[[], BeliefEnv], copies: int) -> None:
        if not isinstance(copies, int) or copies < 1:
            raise InputError(f"copies is {copies!r}; it must be at least 1")
        self.envs = [make() for _ in range(copies)]
        first, agents = self.envs[0], self.envs[0].possible_agents
        self.single_observation_space = first.observation_space(agents[0])
        self.single_action_space = first.action_space(agents[0])
        if isinstance(self.single_observation_space, BeliefSpace):
            raise InputError('copies need observations of a fixed size: use observations="arrays"')
        self.rows = [(number, agent) for number in range(copies) for agent in agents]
        self.num_envs = len(self.rows)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        self.metadata = {**first.metadata, "autoreset_mode": AutoresetMode.NEXT_STEP}
        self._batch: Any = create_empty_array(self.single_observation_space, self.num_envs)
        self._seeds = [first.first_seed + number for number in range(copies)]

    def reset(
        self, *, seed: int | Sequence[int] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Begin an episode in each copy.

        Args:
            seed: Seed of the first copy, or one for each; None: the next ones.
            options: Ignored.

        Raises:
            InputError: The seeds are not whole numbers of 64 bits, or not one for each copy.
        """
        if seed is not None:
            self._seeds = self._seeds_from(seed)
        told: dict[tuple[int, str], tuple[Any, dict[str, Any]]] = {}
        for number in range(len(self.envs)):
            told |= self._again(number)
        return self._gathered(told)

    def step(self, actions: Any) -> tuple[Any, npt.NDArray[np.float64], _Flags, _Flags, Any]:
        """Let all agents of all copies act; see PettingZoo's parallel interface."""
        chosen = dict(zip(self.rows, iterate(self.action_space, actions), strict=True))
        rewards = np.zeros(self.num_envs)
        ended, cut = np.zeros(self.num_envs, np.bool_), np.zeros(self.num_envs, np.bool_)
        told: dict[tuple[int, str], tuple[Any, dict[str, Any]]] = {}
        for number, env in enumerate(self.envs):
            if not env.agents:
                told |= self._again(number)
                continue
            rows = [row for row, (copy, _) in enumerate(self.rows) if copy == number]
            mine = {self.rows[row][1]: chosen[self.rows[row]] for row in rows}
            observations, earned, terminations, truncations, infos = env.step(mine)
            for row in rows:
                agent = self.rows[row][1]
                told[number, agent] = (observations[agent], infos[agent])
                rewards[row] = earned[agent]
                ended[row], cut[row] = terminations[agent], truncations[agent]
        observations, infos = self._gathered(told)
        return observations, rewards, ended, cut, infos

    def close_extras(self, **kwargs: Any) -> None:
        """Close all copies."""
        for env in self.envs:
            env.close()

    def _seeds_from(self, seed: int | Sequence[int]) -> list[int]:
        if isinstance(seed, Sequence):
            if len(seed) != len(self.envs):
                raise InputError(f"there are {len(seed)} seeds for {len(self.envs)} copies")
            return [checked_seed(each) for each in seed]
        return [checked_seed(seed) + number for number in range(len(self.envs))]

    def _again(self, number: int) -> Mapping[tuple[int, str], tuple[Any, dict[str, Any]]]:
        """Begin the next episode of a copy."""
        observations, infos = self.envs[number].reset(self._seeds[number])
        self._seeds[number] += len(self.envs)
        return {(number, agent): (observations[agent], infos[agent]) for agent in observations}

    def _gathered(
        self, told: Mapping[tuple[int, str], tuple[Any, dict[str, Any]]]
    ) -> tuple[Any, dict[str, Any]]:
        found = [told[row] for row in self.rows]
        infos: dict[str, Any] = {}
        for row, (_, info) in enumerate(found):
            infos = self._add_info(infos, info, row)
        rows = [observation for observation, _ in found]
        self._batch = concatenate(self.single_observation_space, rows, self._batch)
        return deepcopy(self._batch), infos
