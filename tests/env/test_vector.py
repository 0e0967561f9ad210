"""Copies in several processes: the same as in one, and nothing is left of them."""

import os
import signal
import warnings
from contextlib import closing
from typing import Any

import numpy as np
import pytest
from gymnasium.vector.utils import batch_space
from tests.env.test_flat import ROOM

import beliefnest as bn
from beliefnest.env import vector_env
from beliefnest.env.vector import BeliefVectorEnv

pytest.importorskip("pettingzoo", reason="the extra `pettingzoo` is not installed")


def copies(number: int, **options: Any) -> BeliefVectorEnv:
    scene = bn.Scenario.from_mapping(ROOM)
    return vector_env(scene, number, actions="flat", nested=2, max_steps=3, **options)


def alive(env: BeliefVectorEnv) -> list[bool]:
    assert env._workers is not None
    return [process.is_alive() for process in env._workers.processes]


def test_copies_tell_the_same_in_two_processes_as_in_one() -> None:
    with (
        closing(copies(3, reward=tick)) as one,
        closing(copies(3, reward=tick, processes=2)) as two,
    ):
        assert one.rows == two.rows
        np.testing.assert_equal(one.reset(seed=7), two.reset(seed=7))
        one.action_space.seed(1)
        for _ in range(5):
            actions = one.action_space.sample()
            told = one.step(actions)
            np.testing.assert_equal(told, two.step(actions))
            np.testing.assert_equal(one.action_masks(), two.action_masks())
        mask = np.array([copy == 1 for copy, _ in one.rows])
        for seed in (None, 50):
            again = [env.reset(seed=seed, options={"reset_mask": mask}) for env in (one, two)]
            np.testing.assert_equal(*again)
        # Wrong input of a step leaves all copies and processes as they were.
        actions = np.zeros(two.num_envs, int)
        actions[-1] = 10**6
        for env in (one, two):
            with pytest.raises(bn.InputError, match="in copy 2 is not in the action space"):
                env.step(actions)
        np.testing.assert_equal(*(env.step(actions * 0) for env in (one, two)))
        assert alive(two) == [True, True]
        with pytest.raises(bn.InputError, match="the copies are in other processes"):
            _ = two.envs
    assert alive(two) == [False, False]


def tick(nest: bn.Nest, agent: str) -> float:
    """Return the tick of the world as a reward."""
    return float(nest.tick)


@pytest.mark.long  # four processes begin
def test_nothing_is_left_when_a_process_ends_or_a_function_of_the_user_fails() -> None:
    def fail(nest: bn.Nest, agent: str) -> float:
        raise ZeroDivisionError("no reward today")

    with closing(copies(2, processes=2, reward=fail)) as env:
        env.reset(seed=0)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # Gymnasium's copy of the traceback
            with pytest.raises(ZeroDivisionError, match="no reward today"):
                env.step(env.action_space.sample())
        assert alive(env) == [False, False]
    with closing(copies(2, processes=2)) as env:
        env.reset(seed=0)
        assert env._workers is not None
        first = env._workers.processes[0]
        os.kill(first.pid, signal.SIGKILL)
        first.join()
        with pytest.raises(bn.WorkerError, match="a process that steps copies has ended"):
            env.step(env.action_space.sample())
        assert alive(env) == [False, False]


@pytest.mark.parametrize("number", [0, -1, "3", 1.0, True, None])
def test_numbers_of_copies_and_processes_are_whole(number: Any) -> None:
    with pytest.raises(bn.InputError, match=r"copies is .*; give a whole number from 1 on"):
        copies(number)
    with pytest.raises(bn.InputError, match=r"processes is .*; give a whole number from 1 on"):
        copies(1, processes=number)


def test_there_are_as_many_copies_as_processes() -> None:
    with pytest.raises(bn.InputError, match="3 processes cannot share 2 copies; give fewer"):
        copies(2, processes=3)
    with closing(copies(1)) as env:
        with pytest.raises(bn.InputError, match="no episode has begun"):
            env.step(env.action_space.sample())
        with pytest.raises(bn.InputError, match="no episode has begun"):
            env.action_masks()
    scene = bn.Scenario.from_mapping(ROOM)
    with closing(vector_env(scene, 1)) as env:
        env.reset(seed=0)
        with pytest.raises(bn.InputError, match=r"step got \d actions?; give \d, one for"):
            env.step(batch_space(env.single_action_space, 7).sample())
        with pytest.raises(bn.InputError, match='use actions="flat"'):
            env.action_masks()
