"""Copies of an environment as a vector environment of Gymnasium, in one process."""

from collections.abc import Callable, Sequence
from copy import deepcopy
from typing import Any

import numpy as np
import numpy.typing as npt
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space, concatenate, create_empty_array, iterate

from beliefnest.env.environment import BeliefEnv, BeliefSpace
from beliefnest.env.saving import check_no_options
from beliefnest.errors import InputError
from beliefnest.world.seeds import checked_seed

_Told = dict[tuple[int, str], tuple[Any, dict[str, Any]]]
"""Observation and info by copy and agent."""
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
        self.render_mode = first.render_mode
        self._batch: Any = create_empty_array(self.single_observation_space, self.num_envs)
        self._latest: dict[tuple[int, str], Any] | None = None
        self._seeds = [first.first_seed + number for number in range(copies)]

    def reset(
        self, *, seed: int | Sequence[int] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Begin an episode in each copy.

        Args:
            seed: Seed of the first copy, or one for each; None: the next ones.
            options: `reset_mask`, an array of True for the rows of copies that begin again; the
                others go on.

        Raises:
            InputError: The seeds are not whole numbers of 64 bits, or not one for each copy; an
                option does not exist, or the mask parts the rows of a copy.
        """
        others = dict(options or {})
        chosen = self._masked(others.pop("reset_mask", np.ones(self.num_envs, np.bool_)))
        check_no_options(others)
        if seed is not None:
            given = self._seeds_from(seed)
            self._seeds = [
                new if number in chosen else old
                for number, (new, old) in enumerate(zip(given, self._seeds, strict=True))
            ]
        told: _Told = {}
        for number in chosen:
            told |= self._again(number)
        return self._gathered(told)

    def step(self, actions: Any) -> tuple[Any, npt.NDArray[np.float64], _Flags, _Flags, Any]:
        """Let all agents of all copies act; see PettingZoo's parallel interface."""
        chosen = dict(zip(self.rows, iterate(self.action_space, actions), strict=True))
        rewards = np.zeros(self.num_envs)
        ended, cut = np.zeros(self.num_envs, np.bool_), np.zeros(self.num_envs, np.bool_)
        told: _Told = {}
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

    def action_masks(self) -> npt.NDArray[np.int8]:
        """Return the masks of all rows; see `BeliefEnv.action_masks`."""
        return np.concatenate([env.action_masks() for env in self.envs])

    def render(self) -> tuple[Any, ...]:
        """Return the picture of its copy for each row, as the mode of the copies says."""
        shown = [env.render() for env in self.envs]
        return tuple(shown[number] for number, _ in self.rows)

    def close_extras(self, **kwargs: Any) -> None:
        """Close all copies."""
        for env in self.envs:
            env.close()

    def _masked(self, mask: Any) -> list[int]:
        """Return the copies that a mask of rows names."""
        of_rows = isinstance(mask, np.ndarray) and mask.shape == (self.num_envs,)
        if not of_rows or mask.dtype != np.bool_:
            raise InputError(f"reset_mask is {mask!r}; give an array of {self.num_envs} truths")
        named = {copy for (copy, _), masked in zip(self.rows, mask, strict=True) if masked}
        rest = {copy for (copy, _), masked in zip(self.rows, mask, strict=True) if not masked}
        if named & rest:
            raise InputError("reset_mask parts the agents of a copy, which begin again together")
        if self._latest is None and rest:
            raise InputError("reset_mask is for copies that have begun; reset all first")
        return sorted(named)

    def _seeds_from(self, seed: int | Sequence[int]) -> list[int]:
        if isinstance(seed, Sequence):
            if len(seed) != len(self.envs):
                raise InputError(f"there are {len(seed)} seeds for {len(self.envs)} copies")
            return [checked_seed(each) for each in seed]
        return [checked_seed(seed) + number for number in range(len(self.envs))]

    def _again(self, number: int) -> _Told:
        """Begin the next episode of a copy."""
        observations, infos = self.envs[number].reset(self._seeds[number])
        self._seeds[number] += len(self.envs)
        return {(number, agent): (observations[agent], infos[agent]) for agent in observations}

    def _gathered(self, told: _Told) -> tuple[Any, dict[str, Any]]:
        """Return the observations of all rows, and the infos of those that were told something."""
        self._latest = {**(self._latest or {}), **{row: each for row, (each, _) in told.items()}}
        infos: dict[str, Any] = {}
        for number, row in enumerate(self.rows):
            if row in told:
                infos = self._add_info(infos, told[row][1], number)
        rows = [self._latest[row] for row in self.rows]
        self._batch = concatenate(self.single_observation_space, rows, self._batch)
        return deepcopy(self._batch), infos
