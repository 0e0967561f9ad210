"""Tasks as environments: joint steps are rounds of an episode, and its rules give the rewards."""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import msgspec

from beliefnest.env.acting import ActionState, JointStep
from beliefnest.env.actions import SPEECH
from beliefnest.episodes.agent_view import GO_ON, AgentView
from beliefnest.episodes.decided import latest_end
from beliefnest.episodes.episode import Episode
from beliefnest.episodes.task import Task
from beliefnest.nest.face.nest import Nest
from beliefnest.scenarios.scenario import Scenario
from beliefnest.skills.calls import Call
from beliefnest.worlds.by_name import Worlds

_MOST_SCENARIOS = 16


@dataclass(frozen=True)
class Instances:
    """Instances of a task, by seed.

    Attributes:
        load: Function that returns the instance of a seed.
        rounds: Number of rounds in place of the task's; None: the task's.
        round_ticks: Ticks of a round in place of the task's; None: the task's.
    """

    load: Callable[[int], Task]
    rounds: int | None = None
    round_ticks: int | None = None
    _scenarios: dict[bytes, Scenario] = field(default_factory=dict, repr=False, compare=False)

    def __reduce__(self) -> tuple[type["Instances"], tuple[object, ...]]:
        """Leave out the scenarios that were read, in copies and files."""
        return Instances, (self.load, self.rounds, self.round_ticks)

    def of(self, seed: int) -> Task:
        """Return the instance of a seed.

        Raises:
            UnknownNameError: A parameter does not exist.
            InputError: A parameter is out of range.
            ScenarioError: No draw keeps the rules of the file's instances.
        """
        task = self.load(seed)
        changes = {"rounds": self.rounds, "round_ticks": self.round_ticks}
        edits = {name: value for name, value in changes.items() if value is not None}
        task = replace(task, form=msgspec.structs.replace(task.form, **edits)) if edits else task
        self._share(task)
        return task

    def _share(self, task: Task) -> None:
        """Let a task have the scenario of an equal one of the latest, which is then not read."""
        content = msgspec.json.encode(task.form.scenario)
        if content in self._scenarios:
            vars(task)["scenario"] = self._scenarios.pop(content)
        self._scenarios[content] = task.scenario
        if len(self._scenarios) > _MOST_SCENARIOS:
            del self._scenarios[next(iter(self._scenarios))]


class Chooser:
    """Policy that acts as the environment was told to.

    Attributes:
        action: Call or program of the round.
    """

    def __init__(self) -> None:
        self.action: Call | str = ""

    def act(self, view: AgentView) -> str:
        """Return the program of the round. A call of nothing continues what was cut."""
        if isinstance(self.action, str):
            return self.action
        if self.action.is_nothing:
            return GO_ON if view.last.how == "cut" else ""
        return self.action.program


class TaskActing:
    """Executor that plays a round of an episode in each joint step.

    Args:
        task: The task.
        learners: Agents whose actions are given; others act by the task's policies.
        world: Name of the world.
        seed: Seed of the episode.
        worlds: Pool that lends the world.
        reads: Paths of the beliefs that are read after each round.
    """

    def __init__(
        self,
        task: Task,
        learners: Sequence[str],
        world: str,
        seed: int,
        worlds: Worlds,
        reads: Sequence[str],
    ) -> None:
        self._choosers = {agent: Chooser() for agent in learners}
        self._task = task
        self._episode = Episode(
            task,
            self._choosers,
            world=world,
            seed=seed,
            worlds=worlds,
            names=dict.fromkeys(learners, "environment"),
            reads=reads,
        )
        self._settled: set[str] = set()
        self._utterances: Counter[str] = Counter()
        self._rewards: dict[str, float] = {}

    @property
    def nest(self) -> Nest:
        """Nest of the episode."""
        return self._episode.nest

    @property
    def is_over(self) -> bool:
        """True if the episode has ended."""
        return self._episode.is_over

    @property
    def is_cut(self) -> bool:
        """True if the episode has ended only because its rounds are over."""
        return self.is_over and not self._episode.is_decided and not self.success

    @property
    def success(self) -> bool:
        """True if the task's goal is reached."""
        return self._episode.success

    def act(self, actions: Mapping[str, Call | str]) -> JointStep:
        """Play a round.

        Raises:
            BodyError: The Minecraft side failed.
        """
        refused = {agent for agent, action in actions.items() if self._is_refused(agent, action)}
        for agent, action in actions.items():
            self._choosers[agent].action = Call("doNothing") if agent in refused else action
        before = len(self.nest["/"].state.chat)
        self._episode.play(1)
        said = self.nest["/"].state.chat[before:]
        self._utterances = Counter(speaker for _, speaker, _ in said)
        self._rewards = {agent: self._earned(agent) for agent in self._choosers}
        deeds = {agent: self._deed(agent, refused) for agent in actions}
        return JointStep(deeds, spoken=bool(said))

    def view(self, agent: str) -> AgentView:
        """Return what an agent's policy would get at the beginning of the next round."""
        return self._episode.view(agent)

    def reward(self, agent: str) -> float:
        """Return what an agent has earned in the latest round."""
        return self._rewards[agent]

    def _is_refused(self, agent: str, action: Call | str) -> bool:
        speaks = isinstance(action, Call) and action.skill in SPEECH
        return speaks and agent not in self._task.form.speakers

    def _deed(self, agent: str, refused: set[str]) -> ActionState:
        if agent in refused:
            return ActionState(f"{agent} may not speak in this task; it did nothing")
        ended = latest_end(self._episode.parts, agent)
        # The program of a call has one line, which is not worth naming.
        is_call = isinstance(self._choosers[agent].action, Call)
        error = ended.error if is_call else ended.message
        return ActionState(error if ended.has_failed else "", busy=ended.how == "cut")

    def _earned(self, agent: str) -> float:
        """Return the reward for the latest round, by the agent's own goal."""
        rewards, progress = self._task.form.rewards, self._episode.progress[agent]
        earned = rewards.each_round + rewards.message * self._utterances[agent]
        if agent not in self._settled:
            if progress.succeeded(over=self.is_over):
                self._settled.add(agent)
                earned += rewards.reached
            elif progress.violated is not None:
                self._settled.add(agent)
                earned += rewards.violated
        return earned
