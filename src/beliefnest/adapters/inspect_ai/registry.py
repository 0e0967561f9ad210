"""Entry point for Inspect: all tasks under `beliefnest/`, and the offline model."""

from typing import Any

from inspect_ai import Task, task
from inspect_ai.model import (
    ChatMessage,
    GenerateConfig,
    ModelAPI,
    ModelOutput,
    modelapi,
)
from inspect_ai.tool import ToolChoice, ToolInfo

from beliefnest.adapters.inspect_ai.episodes import episode_task
from beliefnest.adapters.inspect_ai.minds import (
    course_in_words,
    films_task,
    like_inference,
    minds_task,
)
from beliefnest.adapters.inspect_ai.stories import suite_task
from beliefnest.adapters.inspect_ai.tasks import belief_prompt, in_the_belief, scenario_task
from beliefnest.episodes.tasks import builtin_tasks
from beliefnest.errors import UnknownNameError
from beliefnest.llm.messages import Message, Sampling
from beliefnest.llm.offline import OfflineModel
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
]


@task
def scenario(
    file: str,
    conditions: int | list[int] | None = None,
    variations: int | None = None,
    world: str = "embedded",
    seed: int = 0,
) -> Task:
    """Return the task of your own scenario `file`; arguments as for built-in scenarios."""
    return scenario_task(file, conditions=conditions, variations=variations, world=world, seed=seed)


@task
def hi_tom(file: str, stories: int | None = None) -> Task:
    """Return the task of stories in Hi-ToM's form; `stories` limits their number."""
    return suite_task("hi-tom", file, stories)


@task
def stories(file: str, stories: int | None = None) -> Task:
    """Return the task of your own stories, JSON lines; `stories` limits their number."""
    return suite_task("stories", file, stories)


@task
def minds(
    file: str = "food-trucks",
    conditions: int | list[int] | None = None,
    world: str = "scripted",
    seed: int = 0,
) -> Task:
    """Return a task of the probes of a scenario that infer; the model rates instead."""
    return minds_task(file, conditions=conditions, world=world, seed=seed)


@task
def films(file: str, films: int | None = None) -> Task:
    """Return a task of the films in `file`; `films` limits their number."""
    return films_task(file, films)


@task
def episode(
    file: str,
    order: int | str | None = None,
    seeds: int = 1,
    seed: int = 0,
    world: str = "scripted",
    condition: int | None = None,
    players: str | list[str] | None = None,
) -> Task:
    """Return the task of your own episode `file`; arguments as for built-in tasks."""
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
for _name in builtin_tasks():
    _register_episodes(_name)


@modelapi(name="beliefnest")
class OfflineAPI(ModelAPI):
    """Offline model as `beliefnest/offline`; it needs no network and no key."""

    def __init__(
        self,
        model_name: str,
        base_url: str | None = None,
        api_key: str | None = None,
        config: GenerateConfig = GenerateConfig(),  # noqa: B008 - as Inspect's own providers
        **model_args: Any,
    ) -> None:
        super().__init__(model_name, base_url, api_key, [], config)
        if model_name.rpartition("/")[2] != "offline":
            raise UnknownNameError(f"there is no model {model_name!r}; use beliefnest/offline")
        self._model = OfflineModel()

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
        answer = self._model.answer(messages, Sampling())
        return ModelOutput.from_content("beliefnest/offline", answer.text)
