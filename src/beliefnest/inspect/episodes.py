"""Tasks of episodes: a model controls players round after round, from their beliefs."""

import itertools
import threading
from collections.abc import Callable, Coroutine, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from anyio import from_thread
from anyio.to_thread import run_sync
from inspect_ai import Task
from inspect_ai.dataset import MemoryDataset, Sample
from inspect_ai.model import GenerateConfig, ModelOutput, get_model
from inspect_ai.scorer import Score, Scorer, Target, scorer
from inspect_ai.solver import Generate, Solver, TaskState, solver

from beliefnest.episodes.episode import Episode
from beliefnest.episodes.policies.model import ModelPolicy, OmniscientModelPolicy
from beliefnest.episodes.task import Task as Played
from beliefnest.episodes.telling import told_episode
from beliefnest.errors import InputError
from beliefnest.inspect.metrics import CLUSTER, metrics_by
from beliefnest.inspect.task_parts import (
    finish_of,
    messages_of,
    score_of,
    several_files,
)
from beliefnest.llm.messages import Answer, Message, Sampling, Usage
from beliefnest.plan.cells import variation_id

_OMNISCIENT = "omniscient"


def episode_task(
    names: str | list[str],
    *,
    order: int | str | None,
    seeds: int,
    seed: int,
    world: str,
    condition: int | None,
    players: str | list[str] | None,
    parameters: dict[str, Any],
) -> Task:
    """Return a task whose samples are the instances of an episode.

    Args:
        names: Built-in tasks or scenarios, or paths of task or scenario files.
        order: Order of Theory of Mind of the model's players, or `omniscient`; None for the
            order that the task needs.
        seeds: Number of instances.
        seed: Seed of the first instance.
        world: Name of the world.
        condition: Number of a scenario's condition; None for the scenario as written.
        players: Agents that the model controls; None for all players. The task controls the
            others.
        parameters: Values of the task's parameters.

    Raises:
        BeliefNestError: There is no such task, or an argument is invalid.
    """
    if seeds < 1:
        raise InputError(f"seeds is {seeds}; give at least 1")
    if order not in (None, 0, 1, 2, _OMNISCIENT):
        raise InputError(f"order is {order!r}; give 0, 1, 2 or {_OMNISCIENT}")
    chosen = [players] if isinstance(players, str) else players
    samples = []
    sources = several_files(names)
    for name, instance in itertools.product(sources, range(seed, seed + seeds)):
        task = Played.load(name, instance, condition=condition, **parameters)
        by_model = list(task.players) if chosen is None else chosen
        strange = sorted(set(by_model) - set(task.agents))
        if strange:
            raise InputError(f"{name} has no agent {strange[0]!r}; it has {task.agents}")
        about = {
            "task": task.name,
            "plain": task.plain(),
            "instance": instance,
            "needs": f"needs order {task.order}",
            "order": task.order if order is None else order,
            "world": world,
            "players": by_model,
            CLUSTER: variation_id(task.name, instance),
        }
        samples.append(
            Sample(
                input=task.form.description or str(task.goal),
                target=str(task.goal),
                id=f"{task.name}-{instance}",
                metadata=about,
            )
        )
    return Task(
        dataset=MemoryDataset(samples, name=",".join(sources)),
        solver=play_episode(),
        scorer=goal_reached(),
    )


@dataclass
class _Asked:
    """Adapter to Inspect's model, which is called from the thread that plays an episode.

    Attributes:
        generate: Coroutine function that asks the model, on the event loop.
        said: Requests and answers, in order.
        output: Last answer in Inspect's form.
        name: Name of the model for records.
    """

    generate: Callable[[Sequence[Message], Sampling], Coroutine[Any, Any, ModelOutput]]
    said: list[Message] = field(default_factory=list)
    output: ModelOutput | None = None
    name: str = "inspect"

    def answer(self, messages: Sequence[Message], sampling: Sampling) -> Answer:
        """Ask the model and wait for its answer."""
        self.output = output = from_thread.run(self.generate, messages, sampling)
        self.said += [*messages, Message("assistant", output.completion)]
        used = output.usage
        usage = Usage(requests=1, cost=None)
        if used is not None:
            usage += Usage(0, used.input_tokens, used.output_tokens)
        return Answer(output.completion, usage, finish=finish_of(output))


@solver
def play_episode() -> Solver:
    """Play the sample's episode; the model writes the programs of its players."""
    # A Minecraft world is a separate process, so play one episode at a time there.
    turn = threading.Lock()

    async def generated(messages: Sequence[Message], sampling: Sampling) -> ModelOutput:
        config = GenerateConfig(temperature=sampling.temperature, seed=sampling.seed)
        return await get_model().generate(messages_of(messages), config=config)

    def played(sample: dict[str, Any], asked: _Asked) -> dict[str, Any]:
        if sample["world"] == "scripted":
            return _report(sample, asked)
        with turn:
            return _report(sample, asked)

    async def solve(state: TaskState, generate: Generate) -> TaskState:
        asked = _Asked(generated)
        state.metadata["episode"] = await run_sync(played, dict(state.metadata), asked)
        state.messages = messages_of(asked.said)
        if asked.output is not None:
            state.output = asked.output
        return state

    return solve


def _report(sample: dict[str, Any], asked: _Asked) -> dict[str, Any]:
    """Play an episode and return its results as plain values."""
    task = Played.from_mapping(sample["plain"], sample["instance"])
    if sample["order"] == _OMNISCIENT:
        policy: ModelPolicy = OmniscientModelPolicy(asked, 2)
    else:
        policy = ModelPolicy(asked, sample["order"])
    name = f"model:inspect:{sample['order']}"
    policies = dict.fromkeys(sample["players"], policy)
    names = dict.fromkeys(sample["players"], name)
    with Episode(
        task, policies, world=sample["world"], seed=sample["instance"], names=names
    ) as episode:
        episode.play()
        episode_report = told_episode(episode.nest)
        assert episode_report is not None
        branch = episode_report["branches"][episode.branch]
        return {
            "success": episode.success,
            "goal": branch["goal"],
            "measures": episode.measures.row(),
            "rounds": [
                _line(part["round"], done) for part in branch["parts"] for done in part["agents"]
            ],
        }


def _line(number: int, done: Mapping[str, Any]) -> str:
    """Return an agent's program in a round and the reason of its failure, in one line."""
    reason = f": {done['reason']}" if done["reason"] else ""
    deed = done["program"] or "nothing"
    return f"round {number + 1}, {done['agent']}: {deed} ({done['ended']}{reason})"


@scorer(metrics=metrics_by("needs"))
def goal_reached() -> Scorer:
    """Score an episode by its goal; explain when each condition came true, and all rounds."""

    async def score(state: TaskState, target: Target) -> Score:
        episode_metadata = state.metadata["episode"]
        lines = [
            f"{'not to be: ' if never else ''}{condition}: "
            f"{'at no tick' if tick is None else f'at tick {tick}'}"
            for condition, never, tick in episode_metadata["goal"]
        ]
        return score_of(
            ok=episode_metadata["success"],
            answer=state.output.completion,
            lines=[*lines, "", *episode_metadata["rounds"]],
            metadata=episode_metadata["measures"],
        )

    return score
