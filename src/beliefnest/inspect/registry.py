"""Entry point for Inspect: all tasks under `beliefnest/`, and our models."""

import os
import threading
from collections.abc import Mapping
from contextlib import nullcontext
from dataclasses import replace
from typing import Any

from anyio.to_thread import run_sync
from inspect_ai import Task, task
from inspect_ai.model import (
    ChatMessage,
    GenerateConfig,
    ModelAPI,
    ModelOutput,
    ModelUsage,
    StopReason,
    modelapi,
)
from inspect_ai.tool import ToolChoice, ToolInfo

from beliefnest.episodes.tasks import task_names
from beliefnest.errors import InputError
from beliefnest.inspect.episodes import episode_task
from beliefnest.inspect.minds import (
    course_in_words,
    films_task,
    like_inference,
    minds_task,
)
from beliefnest.inspect.stories import suite_task
from beliefnest.inspect.tasks import belief_prompt, in_the_belief, scenario_task
from beliefnest.llm.messages import Answer, Finish, Message, Sampling
from beliefnest.llm.resolve import Connection, is_of_provider, open_model
from beliefnest.scenarios.scenario import Scenario
from beliefnest.scenarios.sources import builtin_names

__all__ = [
    "belief_prompt",
    "course_in_words",
    "episode",
    "films",
    "hi_tom",
    "in_the_belief",
    "like_inference",
    "minds",
    "scenario",
    "stories",
    "tomi",
]


@task
def scenario(
    file: str | list[str],
    conditions: int | list[int] | None = None,
    variations: int | None = None,
    world: str = "embedded",
    seed: int = 0,
) -> Task:
    """Return the task of your own scenario files; arguments as for built-in scenarios."""
    return scenario_task(file, conditions=conditions, variations=variations, world=world, seed=seed)


@task
def hi_tom(file: str | list[str], stories: int | None = None) -> Task:
    """Return the task of stories in Hi-ToM's form; `stories` limits their number."""
    return suite_task("hi-tom", file, stories)


@task
def tomi(file: str | list[str], stories: int | None = None) -> Task:
    """Return the task of stories in ToMi's form; `stories` limits their number."""
    return suite_task("tomi", file, stories)


@task
def stories(file: str | list[str], stories: int | None = None) -> Task:
    """Return the task of your own stories, JSON lines; `stories` limits their number."""
    return suite_task("stories", file, stories)


@task
def minds(
    file: str | list[str] = "food-trucks",
    conditions: int | list[int] | None = None,
    world: str = "scripted",
    seed: int = 0,
) -> Task:
    """Return a task of the probes of a scenario that infer; the model rates instead."""
    return minds_task(file, conditions=conditions, world=world, seed=seed)


@task
def films(file: str | list[str], films: int | None = None) -> Task:
    """Return a task of the films in `file`; `films` limits their number."""
    return films_task(file, films)


@task
def episode(
    file: str | list[str],
    order: int | str | None = None,
    seeds: int = 1,
    seed: int = 0,
    world: str = "scripted",
    condition: int | None = None,
    players: str | list[str] | None = None,
) -> Task:
    """Return the task of your own episode files; arguments as for built-in tasks."""
    return episode_task(
        file,
        order=order,
        seeds=seeds,
        seed=seed,
        world=world,
        condition=condition,
        players=players,
        parameters={},
    )


def _register_episodes(name: str) -> None:
    """Register a built-in task; hyphens of its name become underscores."""

    @task(name=name.replace("-", "_"))
    def builtin(
        order: int | str | None = None,
        seeds: int = 10,
        seed: int = 0,
        world: str = "scripted",
        players: str | list[str] | None = None,
        **parameters: int,
    ) -> Task:
        return episode_task(
            name,
            order=order,
            seeds=seeds,
            seed=seed,
            world=world,
            condition=None,
            players=players,
            parameters=parameters,
        )


def _register(name: str) -> None:
    """Register a built-in scenario; hyphens of its name become underscores."""

    @task(name=name.replace("-", "_"))
    def builtin(
        conditions: int | list[int] | None = None,
        variations: int | None = None,
        world: str = "embedded",
        seed: int = 0,
    ) -> Task:
        return scenario_task(
            name, conditions=conditions, variations=variations, world=world, seed=seed
        )


for _name in builtin_names():
    # A scenario that asks no model has nothing to score.
    if any(probe.asks_model for probe in Scenario.load(_name).probes):
        _register(_name)
for _name in task_names():
    _register_episodes(_name)


@modelapi(name="beliefnest")
class BeliefNestAPI(ModelAPI):
    """Models of `beliefnest run --model`, as `beliefnest/NAME`.

    `beliefnest/offline`, `beliefnest/chance` and `beliefnest/replay:FILE` need no network and no
    key; `beliefnest/PROVIDER:MODEL` asks a provider, with the keys of the environment.
    """

    def __init__(
        self,
        model_name: str,
        base_url: str | None = None,
        api_key: str | None = None,
        config: GenerateConfig = GenerateConfig(),  # noqa: B008 - as Inspect's own providers
        **model_args: Any,
    ) -> None:
        super().__init__(model_name, base_url, api_key, [], config)
        self._name = model_name.removeprefix("beliefnest/")
        if base_url is not None or api_key is not None or model_args:
            raise InputError(
                f"beliefnest/{self._name} takes no base URL, key or arguments; set the variables "
                "of the provider instead"
            )
        self._model = open_model(self._name, os.environ, Connection())
        # Models in this process answer one request at a time.
        self._turn = nullcontext() if is_of_provider(self._name) else threading.Lock()

    async def generate(
        self,
        input: list[ChatMessage],
        tools: list[ToolInfo],
        tool_choice: ToolChoice,
        config: GenerateConfig,
    ) -> ModelOutput:
        """Answer a conversation; tools are ignored."""
        messages = [
            Message(each.role, each.text)
            for each in input
            if each.role in ("system", "user", "assistant")
        ]
        answer = await run_sync(self._answer, messages, _sampling(config))
        return _output(f"beliefnest/{self._name}", answer)

    def _answer(self, messages: list[Message], sampling: Sampling) -> Answer:
        with self._turn:
            return self._model.answer(messages, sampling)


def _sampling(config: GenerateConfig) -> Sampling:
    sampling = Sampling(seed=config.seed, max_output_tokens=config.max_tokens)
    if config.temperature is None:
        return sampling
    return replace(sampling, temperature=config.temperature)


_STOP_REASONS: Mapping[Finish, StopReason] = {
    "stop": "stop",
    "length": "max_tokens",
    "content_filter": "content_filter",
}


def _output(model: str, answer: Answer) -> ModelOutput:
    output = ModelOutput.from_content(model, answer.text, stop_reason=_STOP_REASONS[answer.finish])
    used = answer.usage
    output.usage = ModelUsage(
        input_tokens=used.input_tokens,
        output_tokens=used.output_tokens,
        total_tokens=used.input_tokens + used.output_tokens,
    )
    return output
