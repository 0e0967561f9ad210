"""Learners of stable-baselines3 take environments as they are, with masks; videos show them."""

from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from beliefnest.env import parallel_env, sb3_env, vector_env

pytest.importorskip("stable_baselines3", reason="it is large, and tested at night")
pytestmark = pytest.mark.extra("stable_baselines3", "sb3_contrib")


TASKS = ("joint-lift", "help-find", "kitchen")


@pytest.mark.parametrize("processes", [1, 2])
@pytest.mark.parametrize("task", TASKS)
def test_ppo_and_maskable_ppo_train(task: str, processes: int) -> None:
    from sb3_contrib import MaskablePPO
    from stable_baselines3 import PPO

    for kind in (PPO, MaskablePPO):
        with closing(sb3_env(task, 2, processes=processes, max_steps=2)) as env:
            learner = kind("MultiInputPolicy", env, n_steps=4, batch_size=8, n_epochs=1, seed=3)
            assert learner.learn(8).num_timesteps == 8


@pytest.mark.extra("supersuit")
@pytest.mark.parametrize("task", TASKS)
def test_ppo_trains_with_copies_of_supersuit(task: str) -> None:
    import supersuit
    from stable_baselines3 import PPO

    one = supersuit.pettingzoo_env_to_vec_env_v1(parallel_env(task, actions="flat", max_steps=2))
    with closing(supersuit.concat_vec_envs_v1(one, 2, base_class="stable_baselines3")) as env:
        learner = PPO("MultiInputPolicy", env, n_steps=4, batch_size=8, n_epochs=1)
        assert learner.learn(8).num_timesteps == 8


def test_an_episode_that_ends_is_followed_by_the_next_one_in_the_same_step() -> None:
    given: dict[str, Any] = {"actions": "flat", "max_steps": 2}
    nothing = np.zeros(2, np.int64)
    with closing(sb3_env("joint-lift", 2, **given)) as env:
        env.seed(5)
        first = env.reset()
        env.step(nothing)
        observations, _, over, infos = env.step(nothing)
        assert over.tolist() == [True, True]
        assert [each["TimeLimit.truncated"] for each in infos] == [True, True]
        assert (
            np.stack(env.env_method("action_masks")).tolist()
            == observations["action_mask"].tolist()
        )
        with closing(vector_env("joint-lift", 2, **given)) as other:
            np.testing.assert_equal(first, other.reset(seed=5)[0])
            other.step(nothing)
            last, *_ = other.step(nothing)
            for row, info in enumerate(infos):
                for name, seen in info["terminal_observation"].items():
                    assert np.array_equal(seen, last[name][row])
            np.testing.assert_equal(observations, other.step(nothing)[0])


@pytest.mark.extra("moviepy")
def test_episodes_are_recorded_as_videos(tmp_path: Path) -> None:
    from gymnasium.wrappers.vector import RecordVideo
    from stable_baselines3.common.vec_env import VecVideoRecorder

    given: dict[str, Any] = {"actions": "flat", "max_steps": 2, "render_mode": "rgb_array"}
    nothing = np.zeros(2, np.int64)
    copies = vector_env("joint-lift", 2, **given)
    with closing(RecordVideo(copies, str(tmp_path / "a"), episode_trigger=bool)) as env:
        env.reset(seed=0)
        for _ in range(5):  # two steps and a new beginning, and once more
            env.step(nothing)
    learners = sb3_env("joint-lift", 2, **given)
    with closing(VecVideoRecorder(learners, str(tmp_path / "b"), lambda step: step == 0, 2)) as env:
        env.reset()
        for _ in range(3):
            env.step(nothing)
    videos = sorted(tmp_path.glob("*/*"))
    assert [each.name for each in videos] == [
        "rl-video-episode-1.mp4",
        "rl-video-step-0-to-step-2.mp4",
    ]
    assert all(b"ftyp" in each.read_bytes()[:16] for each in videos)
