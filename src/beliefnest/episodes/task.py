"""Tasks: a scenario, what its agents are after, and the rules of play."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path as FilePath
from typing import Any, Self

import msgspec

from beliefnest.episodes.form import TaskForm, goal_of
from beliefnest.episodes.goals import Goal
from beliefnest.episodes.tasks import builtin_tasks, generated
from beliefnest.errors import InputError, ScenarioError, UnknownNameError
from beliefnest.scenarios.document import plain
from beliefnest.scenarios.reading import read_yaml
from beliefnest.scenarios.scenario import Scenario

__all__ = ["Task"]


@dataclass(frozen=True)
class Task:
    """What agents are to do together, or against each other, round after round.

    Attributes:
        form: All of it as plain values, as in a task file.
        seed: What it was generated from; None: from a file or in code.
    """

    form: TaskForm
    seed: int | None = None

    @staticmethod
    def names() -> tuple[str, ...]:
        """Names of the built-in tasks, sorted."""
        return tuple(sorted(builtin_tasks()))

    @classmethod
    def load(cls, name_or_path: str, seed: int = 0, **parameters: int) -> Self:
        """A built-in task, or one in a file.

        Args:
            name_or_path: Name of a built-in task, or path of a YAML file.
            seed: Which instance of a built-in task.
            parameters: Its size, as `agents=3`; each task has its own.

        Raises:
            UnknownNameError: There is no such task and no such file, or no such parameter.
            InputError: A parameter is out of range.
            ScenarioError: The file is wrong.
        """
        if name_or_path in builtin_tasks():
            return cls.from_mapping(generated(name_or_path, seed, parameters), seed)
        file = FilePath(name_or_path)
        if not file.is_file():
            raise UnknownNameError(
                f"no task {name_or_path!r}, and no such file; there are {', '.join(cls.names())}"
            )
        if parameters:
            raise InputError(f"{name_or_path} is a file and takes no {', '.join(parameters)}")
        return cls.from_mapping(_mapping(plain(read_yaml(file).root), name_or_path))

    @classmethod
    def from_mapping(cls, content: Mapping[str, Any], seed: int | None = None) -> Self:
        """A task built in code: what a file holds, as dicts, lists and scalars.

        Raises:
            ScenarioError: The content is wrong.
        """
        try:
            form = msgspec.convert(content, TaskForm)
        except msgspec.ValidationError as fault:
            raise ScenarioError(f"task: {fault}") from None
        task = cls(form, seed)
        task.check()
        return task

    def check(self) -> None:
        """See that all of it makes sense.

        Raises:
            ScenarioError: It does not.
        """
        agents = self.agents
        named = {*self.form.players, *self.form.goals, *self.form.policies, *self.form.talk}
        for name in sorted(named - set(agents)):
            raise ScenarioError(f"task {self.name}: {name!r} is none of its agents {agents}")
        for name in agents:
            self.goal_of(name)
            if (name in self.players) == (name in self.form.policies):
                raise ScenarioError(
                    f"task {self.name}: {name} is to be one of `players` or to have a policy in "
                    "`policies`"
                )

    @property
    def name(self) -> str:
        """Its short name."""
        return self.form.name

    @property
    def order(self) -> int:
        """The order of Theory of Mind that it needs."""
        return self.form.order

    @cached_property
    def scenario(self) -> Scenario:
        """Where it is played, and what happens before the first round."""
        return Scenario.from_mapping(self.form.scenario, source=f"task {self.name}")

    @property
    def agents(self) -> tuple[str, ...]:
        """All agents, sorted."""
        return tuple(sorted(self.form.scenario["agents"]))

    @property
    def players(self) -> tuple[str, ...]:
        """The agents whose policies are put to the test."""
        return tuple(self.form.players) or tuple(
            name for name in self.agents if name not in self.form.policies
        )

    @property
    def goal(self) -> Goal:
        """What makes an episode a success."""
        return goal_of(self.form.goal, self.form.scenario["agents"])

    def goal_of(self, agent: str) -> Goal:
        """What an agent is after."""
        entry = self.form.goals.get(agent, self.form.goal)
        return goal_of(entry, self.form.scenario["agents"])

    def at_pace(self, pace: int) -> "Task":
        """The same with as much longer rounds as it takes longer to walk a block.

        Args:
            pace: Ticks that one block on foot takes: 1 in the scripted world, about 5 in Minecraft.
        """
        ticks = self.form.round_ticks * pace // self.form.pace
        return replace(self, form=msgspec.structs.replace(self.form, pace=pace, round_ticks=ticks))

    def plain(self) -> dict[str, Any]:
        """As plain values; `from_mapping` is the inverse."""
        plain: dict[str, Any] = msgspec.to_builtins(self.form)
        return plain


def _mapping(value: object, source: str) -> Mapping[str, Any]:
    if not isinstance(value, dict):
        raise ScenarioError(f"{source} is no mapping; see docs/episodes.md")
    return value
