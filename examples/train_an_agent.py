"""Train an agent to help somebody who has a false belief, with and without beliefs about beliefs.

Run it with `python examples/train_an_agent.py lost-diamond` or `... joint-lift`, after
`pip install 'beliefnest[sb3,plot]'`. It prints how often learners and other policies succeed in
instances that nobody has learned from, and writes a figure. It takes about a quarter of an hour.
"""

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from sb3_contrib import MaskablePPO
from sb3_contrib.common.maskable.evaluation import evaluate_policy
from stable_baselines3.common.vec_env import VecMonitor, VecNormalize

import beliefnest as bn
from beliefnest.env import sb3_env

COPIES, EPISODES, INSTANCES = 8, 1280, 32
SEEDS = range(1, 6)
TESTED = 1_000_000
"""First of the instances that nobody learns from."""
POLICIES = ("random", "rule:nearest", "rule:any", "search:0", "search:1")
LINES = ("random", "search:0", "search:1")
"""Policies that the figure shows."""
GAMES: dict[str, tuple[str, str, dict[str, Any]]] = {
    "lost-diamond": (str(Path(__file__).with_name("lost-diamond.yaml")), "/anne/sally", {}),
    # One decision here, which lasts as long as the rounds of the task at most.
    "joint-lift": ("joint-lift", "/anne/bob", {"step_ticks": 45, "max_steps": 1}),
}
"""Task, path of Anne's belief about the other agent, and options of the environment, by name."""


def learn(task: str, seed: int, **options: Any) -> tuple[list[float], float]:
    """Train a small network; return the return of each episode, and the mean of new instances."""

    def copies(first: int, **more: Any) -> VecNormalize:
        env = VecMonitor(sb3_env(task, COPIES, seed=first, **options))
        return VecNormalize(env, norm_reward=False, **more)

    def note(known: dict[str, Any], _: object) -> bool:
        earned.extend(each["episode"]["r"] for each in known["infos"] if "episode" in each)
        return True

    earned: list[float] = []
    env = copies(seed * EPISODES)
    learner = MaskablePPO(
        "MultiInputPolicy",
        env,
        n_steps=8,  # many small updates: each changes the policy little
        batch_size=64,
        learning_rate=3e-3,
        ent_coef=0.01,
        gamma=0.0,  # one decision in an episode: nothing comes after it
        policy_kwargs={"net_arch": [64]},
        seed=seed,
        device="cpu",
    )
    learner.learn(EPISODES, callback=note)
    env.close()
    new = copies(TESTED + seed * INSTANCES, training=False)
    new.obs_rms = env.obs_rms
    mean, _ = evaluate_policy(learner, new, n_eval_episodes=INSTANCES)
    new.close()
    return earned, float(mean)


def won(task: str, policy: str, seed: int) -> float:
    """Return the share of the same new instances in which a policy of Anne's succeeds."""
    successes = []
    for number in range(TESTED + seed * INSTANCES, TESTED + (seed + 1) * INSTANCES):
        with bn.Episode(bn.Task.load(task, number), {"anne": policy}, seed=number) as episode:
            successes.append(episode.play().success)
    return float(np.mean(successes))


def draw(curves: Mapping[str, Sequence[Sequence[float]]], lines: Mapping[str, float]) -> Figure:
    """Draw the share of successes of learners by episode, and of other policies as lines."""
    figure = Figure(figsize=(6.4, 3.4), layout="constrained")
    axes = figure.add_subplot(xlabel="episodes", ylabel="share of successes", ylim=(-0.03, 1.03))
    for (label, runs), colour in zip(curves.items(), ("tab:orange", "tab:blue"), strict=True):
        parts = np.array([[np.mean(part) for part in np.array_split(run, 20)] for run in runs])
        at = (np.arange(20) + 0.5) * len(runs[0]) / 20
        axes.plot(at, parts.T, color=colour, linewidth=0.6, alpha=0.5)
        axes.plot(at, parts.mean(axis=0), color=colour, linewidth=2, label=label)
    for (label, share), style in zip(lines.items(), (":", "--", "-."), strict=True):
        axes.axhline(share, color="black", linestyle=style, linewidth=1, label=label)
    figure.legend(loc="outside right center", frameon=False)
    axes.spines[["top", "right"]].set_visible(False)
    return figure


def main(name: str) -> None:
    """Compare all policies in a task."""
    task, other, options = GAMES[name]
    shares = {policy: [won(task, policy, seed) for seed in SEEDS] for policy in POLICIES}
    curves = {}
    for label, nested in (("learned without", []), ("learned with", [other])):
        runs = [learn(task, seed, nested=nested, **options) for seed in SEEDS]
        curves[label], shares[label] = zip(*runs, strict=True)
    print(f"{name:16} mean  lowest  highest of {len(SEEDS)} seeds")
    for label, each in shares.items():
        print(f"{label:16} {np.mean(each):.2f}  {min(each):.2f}    {max(each):.2f}")
    lines = {policy: float(np.mean(shares[policy])) for policy in LINES}
    draw(curves, lines).savefig(f"train-{name}.svg")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Compare learners with other policies in a task.")
    parser.add_argument("task", choices=GAMES)
    main(parser.parse_args().task)
