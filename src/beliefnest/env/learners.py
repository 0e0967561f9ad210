"""Vector environments in the form of stable-baselines3, whose learners take them as they are."""

from typing import Any

import numpy as np
from stable_baselines3.common.vec_env import VecEnv

from beliefnest.env.vector import BeliefVectorEnv
from beliefnest.errors import InputError


class LearnerEnv(VecEnv):  # type: ignore[misc]  # not installed where types are checked
    """A vector environment for `PPO` and other learners, and for `MaskablePPO` with its masks.

    Where an episode ends, the next one begins in the same step: `terminal_observation` in the info
    is the last observation, as these learners expect it.

    Args:
        env: The vector environment.
    """

    def __init__(self, env: BeliefVectorEnv) -> None:
        self._env = env
        super().__init__(env.num_envs, env.single_observation_space, env.single_action_space)

    def reset(self) -> Any:
        """Begin an episode in each copy, with the seeds of `seed`, otherwise the next ones."""
        observations, _ = self._env.reset(seed=self._seeds[0])
        self._reset_seeds()
        return observations

    def step_async(self, actions: Any) -> None:
        """Keep the actions for `step_wait`."""
        self._actions = actions

    def step_wait(self) -> tuple[Any, Any, Any, list[dict[str, Any]]]:
        """Let all agents act; return observations, rewards, ends and infos of all rows."""
        steps = self._env.advance(self._actions)
        rows = [steps[row] for row in self._env.rows]
        over = np.array([each.is_over for each in rows])
        infos = [each.info for each in rows]
        for number in np.flatnonzero(over):
            cut = {"TimeLimit.truncated": rows[number].is_cut and not rows[number].is_ended}
            infos[number] = {
                **infos[number],
                **cut,
                "terminal_observation": rows[number].observation,
            }
        if over.any():
            self._env.reset(options={"reset_mask": over})
        rewards = np.array([each.reward for each in rows], np.float32)
        return self._env.batch(), rewards, over, infos

    def close(self) -> None:
        """Close all copies, and end the processes."""
        self._env.close()

    def get_images(self) -> list[Any]:
        """Return the picture of its copy for each row."""
        return list(self._env.render())

    def has_attr(self, attr_name: str) -> bool:
        """Return True if there is such an attribute or method of all rows."""
        return hasattr(self._env, attr_name)

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """Return an attribute, which is the same in all rows."""
        return [getattr(self._env, attr_name) for _ in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Refuse: copies are made by the arguments of `sb3_env`."""
        raise InputError(f"{attr_name} cannot be set; give it to sb3_env, if it is an argument")

    def env_method(
        self, method_name: str, *method_args: Any, indices: Any = None, **method_kwargs: Any
    ) -> list[Any]:
        """Return what a method that has a value for each row returns: `action_masks`, `render`."""
        results = getattr(self._env, method_name)(*method_args, **method_kwargs)
        return [results[number] for number in self._get_indices(indices)]

    def env_is_wrapped(self, wrapper_class: type, indices: Any = None) -> list[bool]:
        """Return False for each row: their environments have no wrappers."""
        return [False for _ in self._get_indices(indices)]
