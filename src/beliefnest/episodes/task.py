"""Tasks: a scenario, the goals of its agents, and the rules of play."""

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path as FilePath
from typing import Any, Self, cast

import msgspec
from msgspec.structs import replace

from beliefnest.episodes.task_form import TaskForm
from beliefnest.episodes.tasks import generated, is_task, task_names
from beliefnest.errors import BeliefNestError, InputError, ScenarioError, UnknownNameError
from beliefnest.facts.reading import PlainScene
from beliefnest.scenarios.document import Document, YamlNode, plain
from beliefnest.scenarios.document_form import check_rules_form
from beliefnest.scenarios.goals import Goal
from beliefnest.scenarios.instances import drawn_instance, has_instances
from beliefnest.scenarios.loading import DocumentChange, condition_number
from beliefnest.scenarios.rules import EpisodeEntry, GoalEntry, check_rules, goal_of
from beliefnest.scenarios.scenario import Scenario, warn_of_values
from beliefnest.scenarios.sources import builtin_names, read_document
from beliefnest.scenarios.writing import content_text
from beliefnest.version import VERSION
from beliefnest.world.texts import quoted
from beliefnest.world.values import Box, Position

_NO_RULES = ("name", "description", "scenario", "pace")
"""Keys of a task that are not keys of `episode` in a scenario."""


@dataclass(frozen=True)
class Task:
    """Task that agents play together, or against each other, round after round.

    Attributes:
        form: Content of the task, as in a task file.
        seed: Number of the instance; None: the task has no instances.
    """

    form: TaskForm
    seed: int | None = None

    @staticmethod
    def names() -> tuple[str, ...]:
        """Return names of the installed tasks, sorted."""
        return tuple(sorted(task_names()))

    @classmethod
    def load(
        cls,
        name_or_path: str,
        seed: int = 0,
        *,
        condition: int | str | None = None,
        **parameters: Any,
    ) -> Self:
        """Return a built-in task, one in a file, or a scenario.

        Args:
            name_or_path: Name of a built-in task or scenario, or path of a YAML file of either.
            seed: Number of the instance of a built-in task, or of a scenario with `instances`.
            condition: Number of a scenario's condition; None: the scenario as written.
            parameters: Parameters of the task or scenario, such as `agents=3`.

        Raises:
            UnknownNameError: The task, file or parameter does not exist.
            InputError: A parameter is out of range.
            ScenarioError: The file is wrong.
        """
        if is_task(name_or_path):
            _check_no_condition(name_or_path, condition)
            return cls.from_mapping(generated(name_or_path, seed, parameters), seed)
        document = _written(name_or_path)
        if _is_scenario(document):
            number = condition_number(condition)
            task = cls.instance_of(document, seed, number, parameters)
            warn_of_values(document, number, parameters)
            return task
        _check_no_condition(name_or_path, condition)
        if parameters:
            raise InputError(f"{name_or_path} is a task and takes no {', '.join(parameters)}")
        _check_by_line(document)
        try:
            return cls.from_mapping(cast(dict[str, Any], plain(document.root)))
        except ScenarioError as fault:
            raise ScenarioError(f"{name_or_path}: {fault}") from None

    @classmethod
    def instance_of(
        cls,
        document: Document,
        seed: int,
        condition: int | None,
        parameters: Mapping[str, object],
        change: DocumentChange | None = None,
    ) -> Self:
        """Return an instance of a scenario; without `instances`, the scenario itself.

        Args:
            document: Document of the scenario.
            seed: Number of the instance.
            condition: Number of a condition; None: the scenario as written.
            parameters: Values of parameters, which are not drawn.
            change: Function that changes the document to another scene; None: no change.

        Raises:
            ScenarioError: The scenario is wrong, or no draw keeps the rules of its instances.
        """
        if not has_instances(document):
            return cls.of(Scenario.varied(document, condition, parameters, change))
        values = drawn_instance(document, seed, parameters)
        return dataclasses.replace(
            cls.of(Scenario.varied(document, condition, values, change)), seed=seed
        )

    @staticmethod
    def scenario_document(name_or_path: str) -> Document | None:
        """Return the document of a scenario; None: the name is that of a task.

        Raises:
            UnknownNameError: There is neither a task nor a file of that name.
            ScenarioError: The file cannot be read.
        """
        if is_task(name_or_path):
            return None
        document = _written(name_or_path)
        return document if _is_scenario(document) else None

    @classmethod
    def of(cls, scenario: Scenario, **rules: Any) -> Self:
        """Return a scenario as a task, played by the rules under its key `episode`.

        Args:
            scenario: The scenario; its probes and expectations are ignored.
            rules: Rules that replace those under `episode`: `goal`, `rounds`, ...

        Raises:
            ScenarioError: The rules are not consistent.
            InputError: Only the setting of the scenario is known.
        """
        if not scenario.written:
            raise InputError(f"{scenario.source} has only a setting; load the whole scenario")
        check_rules_form({key: rule for key, rule in rules.items() if key not in _NO_RULES})
        left_out = ("probes", "expectations", "episode")
        content = {key: v for key, v in scenario.written.items() if key not in left_out}
        return cls.from_mapping(
            {
                "name": scenario.name,
                "description": scenario.description,
                "scenario": content,
                **msgspec.to_builtins(scenario.rules or EpisodeEntry()),
                "goal": msgspec.to_builtins((scenario.rules or EpisodeEntry()).goal),
                **rules,
            }
        )

    @classmethod
    def from_mapping(cls, content: Mapping[str, Any], seed: int | None = None) -> Self:
        """Build a task from a file's content as dicts, lists and scalars.

        Raises:
            ScenarioError: The content is wrong.
        """
        try:
            form = msgspec.convert(content, TaskForm)
        except msgspec.ValidationError as fault:
            raise ScenarioError(f"task: {fault}") from None
        if "map" in form.scenario:
            drawn = Scenario.from_mapping(form.scenario, source=f"task {form.name}: scenario")
            form = msgspec.structs.replace(form, scenario=dict(drawn.written))
        try:
            scene = msgspec.convert(form.scenario, _Scene)
        except msgspec.ValidationError as fault:
            raise ScenarioError(f"task {form.name}: scenario: {fault}") from None
        task = cls(form, seed)
        task.check(scene.box)
        return task

    def check(self, box: tuple[Position, Position]) -> None:
        """Check that the task is consistent.

        Args:
            box: Box of its scenario.

        Raises:
            ScenarioError: The task is not consistent.
        """
        if self.form.goal == GoalEntry():
            raise ScenarioError(
                f"task {self.name}: there is no goal; give conditions under `reach` or `never` "
                "(in a scenario under `episode`); `beliefnest run` plays scenarios without"
            )
        try:
            check_rules(self.form, self.agents, PlainScene(self.agents, Box.between(*box)))
        except BeliefNestError as fault:
            raise ScenarioError(f"task {self.name}: {fault}") from None

    @property
    def name(self) -> str:
        """Short name of the task."""
        return self.form.name

    @property
    def order(self) -> int:
        """Order of Theory of Mind that the task needs."""
        return self.form.order

    @cached_property
    def scenario(self) -> Scenario:
        """Scenario of the task; its script runs before the first round."""
        return Scenario.from_mapping(self.form.scenario, source=f"task {self.name}")

    @cached_property
    def agents(self) -> tuple[str, ...]:
        """Names of all agents, sorted."""
        return tuple(sorted(self.form.scenario["agents"]))

    @property
    def players(self) -> tuple[str, ...]:
        """Names of the players: the agents whose policies are tested."""
        return tuple(self.form.players) or tuple(
            name for name in self.agents if name not in self.form.policies
        )

    @cached_property
    def goal(self) -> Goal:
        """Goal that makes an episode a success."""
        return goal_of(self.form.goal, self.form.scenario["agents"])

    def goal_of(self, agent: str) -> Goal:
        """Return the goal of an agent; if it helps another agent, that agent's goal."""
        own = self.told_goal(agent)
        return own if own.helps is None else self.told_goal(own.helps)

    def told_goal(self, agent: str) -> Goal:
        """Return the goal of an agent as the agent is told it."""
        return self._told_goals.get(agent, self.goal)

    @cached_property
    def _told_goals(self) -> Mapping[str, Goal]:
        agents = self.form.scenario["agents"]
        return {agent: goal_of(entry, agents) for agent, entry in self.form.goals.items()}

    @cached_property
    def possible_goals(self) -> Mapping[str, Mapping[str, Goal]]:
        """By agent and name the goals that it may have, as far as the others know.

        Empty where all goals are known.
        """
        agents = self.form.scenario["agents"]
        return {
            agent: {name: goal_of(entry, agents) for name, entry in possible.items()}
            for agent, possible in self.form.possible_goals.items()
        }

    def at_pace(self, pace: int) -> "Task":
        """Return the task with rounds, speech and deadlines scaled to the pace of walking.

        Args:
            pace: Ticks per block on foot: 1 in the scripted world, about 4 in Minecraft.
        """
        ticks = self.form.round_ticks * pace // self.form.pace
        scenario = dict(self.form.scenario)
        if speech := (scenario.get("perception") or {}).get("speech_ticks"):
            slower = speech * pace // self.form.pace
            scenario["perception"] = {**scenario["perception"], "speech_ticks": slower}
        form = msgspec.structs.replace(
            self.form,
            pace=pace,
            round_ticks=ticks,
            scenario=scenario,
            goal=self._slower(self.form.goal, pace),
            goals={name: self._slower(goal, pace) for name, goal in self.form.goals.items()},
            possible_goals={
                agent: {name: self._slower(goal, pace) for name, goal in possible.items()}
                for agent, possible in self.form.possible_goals.items()
            },
        )
        return dataclasses.replace(self, form=form)

    def _slower(self, goal: GoalEntry, pace: int) -> GoalEntry:
        if goal.ticks is None:
            return goal
        return msgspec.structs.replace(goal, ticks=goal.ticks * pace // self.form.pace)

    def text(self) -> str:
        """Return the task as the text of a scenario file with an `episode`.

        Raises:
            InputError: The task's pace is not that of a scenario file.
        """
        if self.form.pace != 1:
            raise InputError(f"task {self.name} has the pace of another world; write it before")
        rules = {
            key: value
            for key, value in self.plain().items()
            if key not in _NO_RULES and key in EpisodeEntry.__struct_fields__
        }
        about: dict[str, Any] = {"name": self.name, "description": self.form.description or None}
        scene = {key: value for key, value in self.form.scenario.items() if key not in about}
        content = {key: value for key, value in about.items() if value is not None}
        content |= {**scene, "episode": rules}
        instance = "" if self.seed is None else f", instance {self.seed}"
        return content_text(content, f"{self.name}{instance}, of BeliefNest {VERSION}")

    def plain(self) -> dict[str, Any]:
        """Return the task as plain values; `from_mapping` is the inverse."""
        plain: dict[str, Any] = msgspec.to_builtins(self.form)
        return plain


class _Scene(msgspec.Struct):
    """Parts of a scenario that are needed before it is built."""

    box: tuple[Position, Position]
    agents: dict[str, Any]


def _check_by_line(document: Document) -> None:
    """Check a task's file as a scenario with the rules under `episode`.

    Raises:
        ScenarioError: The file is wrong; the message names file, line and key.
    """
    scenario, keys = document.root.value["scenario"], document.root.value
    if not isinstance(scenario.value, dict):
        raise document.fault(("scenario",), "is not a mapping of keys to values")
    rules = {key: node for key, node in keys.items() if key not in _NO_RULES}
    episode = YamlNode(rules, document.root.line)
    whole = YamlNode({**scenario.value, "episode": episode}, document.root.line)
    Scenario.varied(replace(document, root=whole), None)


def _written(name_or_path: str) -> Document:
    """Return the document of a scenario's or task's file.

    Raises:
        UnknownNameError: There is no such file.
    """
    if name_or_path not in builtin_names() and not FilePath(name_or_path).is_file():
        raise UnknownNameError(
            f"no task {quoted(name_or_path)}, and no such file; there are "
            f"{', '.join(Task.names())}, and of scenarios {', '.join(builtin_names())}"
        )
    return read_document(name_or_path)


def _is_scenario(document: Document) -> bool:
    return "scenario" not in document.root.value


def _check_no_condition(name: str, condition: int | str | None) -> None:
    if condition is not None:
        raise InputError(f"{name} is a task and has no conditions; leave the condition out")
