"""What a policy is given: its agent's own belief, what lies below it, and its task."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from beliefnest.belief.view import State
from beliefnest.episodes.decided import Ended
from beliefnest.errors import PathError
from beliefnest.nest.acting.imagination import Imagination
from beliefnest.nest.face.shown import ShownSimulator
from beliefnest.scenarios.goals import Goal
from beliefnest.world.values import Position

if TYPE_CHECKING:  # Models take long to import; tasks are read with YAML.
    from beliefnest.episodes.task import Task
    from beliefnest.llm.messages import Model

__all__ = ["GO_ON", "AgentView", "Brief", "Policy", "RoundFacts"]

GO_ON = "go on"
"""What a policy returns in place of a program to let its last one, which was cut, go on."""


@dataclass(frozen=True, slots=True)
class Brief:
    """What everybody knows of the task; what it is about is not for those who play it.

    Attributes:
        task: Its name.
        goals: What each agent is after.
        talk: Who may speak.
        rounds: How many there are.
        round_ticks: Ticks after which programs are cut.
        turns: Whether agents act one after the other in a round, each for `round_ticks`.
        pace: Ticks that one block on foot takes.
        places: What people call places.
        seed: Drives the random numbers of policies.
    """

    task: str
    goals: Mapping[str, Goal]
    talk: tuple[str, ...]
    rounds: int
    round_ticks: int
    turns: bool
    pace: int
    places: Mapping[str, Position]
    seed: int

    @classmethod
    def of(cls, task: "Task", seed: int) -> "Brief":
        """What everybody knows of a task that is played with a seed."""
        return cls(
            task=task.name,
            goals={agent: task.goal_of(agent) for agent in task.agents},
            talk=tuple(task.form.talk),
            rounds=task.form.rounds,
            round_ticks=task.form.round_ticks,
            turns=task.form.play == "turns",
            pace=task.form.pace,
            places=task.scenario.setting.places,
            seed=seed,
        )

    @property
    def whole_round(self) -> int:
        """Ticks from one round to the next."""
        return self.round_ticks * (len(self.goals) if self.turns else 1)


class AgentView:
    """What an agent knows at the beginning of a round; it reaches its belief and nothing above it.

    Args:
        agent: Whose.
        brief: The task.
        round: The round that begins, from 0.
        last: How the agent's latest program ended.
        own: The simulator of the agent's belief.
        imagine: Gives that as a world of its own, down to a depth.
        noting: Lets requests to a model be kept in the run.
        before: The agent's programs of earlier rounds.

    Attributes:
        agent: Whose view it is.
        brief: The task.
        round: The round that begins, from 0.
        last: How the agent's latest program ended.
        before: The agent's programs of earlier rounds, whoever decided them; empty texts: nothing.
    """

    def __init__(
        self,
        agent: str,
        brief: Brief,
        round: int,
        last: Ended,
        own: ShownSimulator,
        imagine: Callable[[int], Imagination],
        noting: "Callable[[Model], Model]",
        before: Sequence[str],
    ) -> None:
        self.agent = agent
        self.brief = brief
        self.round = round
        self.last = last
        self._own = own
        self._imagine = imagine
        self._noting = noting
        self.before = before

    @property
    def tick(self) -> int:
        """The tick at which the round begins."""
        return self._own.tick

    @property
    def ticks_left(self) -> int:
        """Ticks until the end of the last round, or until the goal is to be reached."""
        rounds, length = self.brief.rounds, self.brief.whole_round
        last = min(rounds * length, self.goal.ticks or rounds * length)
        return max(0, last - self.round * length)

    @property
    def goal(self) -> Goal:
        """What the agent is after."""
        return self.brief.goals[self.agent]

    @property
    def may_speak(self) -> bool:
        """True if what it says is heard."""
        return self.agent in self.brief.talk

    @property
    def state(self) -> State:
        """What the agent believes."""
        return self._own.state

    @property
    def heard(self) -> Sequence[tuple[int, str, str]]:
        """What others said since the agent was asked last: (tick, speaker, text)."""
        since = self.tick - self.brief.whole_round if self.round else -1
        return [
            (tick, speaker, text)
            for tick, speaker, text in self.state.chat
            if tick > since and speaker != self.agent
        ]

    def about(self, *agents: str) -> State:
        """What it believes that another believes, and so on: `about("bob", "anne")`.

        Raises:
            PathError: There is no such agent.
        """
        simulator = self._own
        for agent in agents:
            if agent not in self._own.state.agents:
                raise PathError(f"there is no agent {agent!r} in {sorted(self._own.state.agents)}")
            simulator = simulator.child(agent)
        return simulator.state

    def imagine(self, depth: int = 1) -> Imagination:
        """Its belief as a world of its own, to try courses in; nothing of it is recorded.

        Args:
            depth: How deep below it beliefs are followed.
        """
        return self._imagine(depth)

    def render(self, template: str, depth: int = 0, **variables: object) -> str:
        """Return the text of a prompt template, filled from its belief.

        Args:
            template: Its text. `branch` is the belief, `view` what else is known
                (`RoundFacts`), and `about` has, by text such as `bob` or `bob/anne`, what others
                are believed to believe; the filters take these as they take `branch`.
            depth: How deep `about` goes.
            variables: Further variables.

        Raises:
            TemplateError: The template is wrong.
        """
        about: dict[str, ShownSimulator] = {}
        level: list[tuple[tuple[str, ...], ShownSimulator]] = [((), self._own)]
        for _ in range(depth):
            level = [
                ((*path, name), simulator.child(name))
                for path, simulator in level
                for name in self.brief.goals
                if name != (path[-1] if path else self._own.owner)
            ]
            about |= {"/".join(path): simulator for path, simulator in level}
        return self._own.render(template, view=RoundFacts.of(self), about=about, **variables)

    def noting(self, model: "Model") -> "Model":
        """Return a model whose conversation is kept in the run."""
        return self._noting(model)


@dataclass(frozen=True, slots=True)
class RoundFacts:
    """What templates are told besides the belief.

    Attributes:
        agent: Whose view it is.
        goal: What it is after, in words.
        goals: What everybody is after, in words.
        may_speak: Whether what it says is heard.
        round: The round, from 1.
        rounds: How many there are.
        round_ticks: Ticks after which programs are cut.
        last: How its latest program ended.
    """

    agent: str
    goal: str
    goals: Mapping[str, str]
    may_speak: bool
    round: int
    rounds: int
    round_ticks: int
    last: Ended

    @classmethod
    def of(cls, view: AgentView) -> "RoundFacts":
        """What a view tells."""
        brief = view.brief
        return cls(
            view.agent,
            str(view.goal),
            {name: str(goal) for name, goal in brief.goals.items()},
            view.may_speak,
            view.round + 1,
            brief.rounds,
            brief.round_ticks,
            view.last,
        )


class Policy(Protocol):
    """Who decides what an agent does."""

    def act(self, view: AgentView) -> str:
        """The agent's program for the round; empty: it does nothing; `GO_ON`: its last one goes on.

        Args:
            view: What the agent knows.
        """
