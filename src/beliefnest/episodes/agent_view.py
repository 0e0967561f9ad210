"""View of a policy: its agent's own belief, the beliefs below it, and the task."""

from collections.abc import Callable, Collection, Mapping, Sequence
from functools import cached_property
from random import Random
from typing import TYPE_CHECKING, Any, Protocol

import msgspec
from msgspec.structs import replace

from beliefnest.belief.view import State
from beliefnest.episodes.considered import SearchTrace
from beliefnest.episodes.decided import Ended, Spent
from beliefnest.episodes.imagination import Imagination
from beliefnest.errors import ModelError, PathError
from beliefnest.nest.face.shown import ShownSimulator
from beliefnest.prompts.mind_view import MindView
from beliefnest.scenarios.goals import Goal
from beliefnest.world.claims import Claim
from beliefnest.world.values import Position

if TYPE_CHECKING:  # Importing models and tasks takes long.
    from beliefnest.episodes.task import Task
    from beliefnest.llm.messages import Answer, Message, Model, Sampling, Usage
    from beliefnest.minds.inference import Inference
    from beliefnest.minds.mind_model import MindModel


GO_ON = "go on"
"""Text that a policy returns instead of a program to continue its last one, which was cut."""


def utterances(
    chat: Sequence[tuple[int, str, str]], players: Collection[str], start: int
) -> Sequence[tuple[int, str, str]]:
    """Return the utterances that a goal counts: those of players after its episode's first tick."""
    return [line for line in chat if line[0] > start and line[1] in players]


class Brief(msgspec.Struct, frozen=True):
    """Knowledge of one agent about a task; the task's description is not part of it.

    Attributes:
        task: Name of the task.
        agents: Names of all agents, sorted.
        players: Names of the players, whose utterances count for `messages` of a goal.
        goals: Goals that the agent knows: of all agents, or of itself alone.
        possible_goals: Goals that other agents may have, by agent and name; empty where all goals
            are known. Nothing is known of the goal of an agent that is in neither.
        talk: Agents that may speak.
        rounds: Number of rounds.
        round_ticks: Ticks after which programs are cut.
        turns: True if agents act in turn in a round, each for `round_ticks`.
        pace: Ticks per block on foot.
        places: Named places.
        seed: Seed of the random numbers of policies.
    """

    task: str
    agents: tuple[str, ...]
    players: tuple[str, ...]
    goals: Mapping[str, Goal]
    possible_goals: Mapping[str, Mapping[str, Goal]]
    talk: tuple[str, ...]
    rounds: int
    round_ticks: int
    turns: bool
    pace: int
    places: Mapping[str, Position]
    seed: int

    @classmethod
    def of(cls, task: "Task", seed: int, agent: str | None = None) -> "Brief":
        """Return the knowledge of an agent about a task that is played with a seed.

        Args:
            task: The task.
            seed: Seed of the random numbers of policies.
            agent: Name of the agent; None: one that knows all goals.
        """
        if agent is None or task.form.goals_known:
            goals = {name: task.goal_of(name) for name in task.agents}
            possible: Mapping[str, Mapping[str, Goal]] = {}
        else:
            goals = {agent: task.told_goal(agent)}
            possible = {name: goals for name, goals in task.possible_goals.items() if name != agent}
        return cls(
            task=task.name,
            agents=task.agents,
            players=task.players,
            goals=goals,
            possible_goals=possible,
            talk=task.form.speakers,
            rounds=task.form.rounds,
            round_ticks=task.form.round_ticks,
            turns=task.form.play == "turns",
            pace=task.form.pace,
            places=task.scenario.setting.places,
            seed=seed,
        )

    @property
    def whole_round(self) -> int:
        """Return the number of ticks from one round to the next."""
        return self.round_ticks * (len(self.agents) if self.turns else 1)

    @property
    def hides_goals(self) -> bool:
        """True if the agent does not know all goals."""
        return len(self.goals) < len(self.agents)

    @property
    def considered(self) -> Sequence[Goal]:
        """Return all goals that agents have or may have, as far as the agent knows."""
        possible = [goal for goals in self.possible_goals.values() for goal in goals.values()]
        return [*self.goals.values(), *possible]

    def words(self, agent: str) -> str:
        """Return the goal of an agent in words, or those that it may have."""
        if agent in self.goals:
            return str(self.goals[agent])
        possible = self.possible_goals.get(agent, {})
        goals = " or ".join(f"({goal})" for goal in possible.values())
        return f"one of these, it is not known which: {goals}" if goals else "it is not known what"

    def supposing(self, goals: Mapping[str, Goal]) -> "Brief":
        """Return the brief for supposed goals of others that everybody knows.

        Args:
            goals: Supposed goals by agent. An agent whose goal is neither known nor supposed is
                assumed to have none.
        """
        supposed = {name: goals.get(name, Goal()) for name in self.agents} | dict(self.goals)
        helped = {
            name: goal if goal.helps is None else supposed[goal.helps]
            for name, goal in supposed.items()
        }
        return replace(self, goals=helped, possible_goals={})


class AgentView:
    """Knowledge of an agent at the beginning of a round: its own belief and the beliefs below.

    Args:
        agent: Name of the agent.
        brief: Common knowledge about the task.
        round: Number of the round that begins, from 0.
        last: End of the agent's latest program.
        own: Simulator of the agent's belief.
        imagine: Function that returns the belief at a tick as a separate world, down to a depth.
        noting: Function that wraps a model so that the run records its requests.
        before: The agent's programs of earlier rounds.
        memo: Cache that the policies of a round share; None: the view has its own. It may contain
            only results of pure functions, with everything that they depend on as keys.
        check: Function that raises ModelError if the policy may spend no more than it has in this
            round; None: no limit.

    Attributes:
        agent: Name of the agent.
        brief: Common knowledge about the task.
        round: Number of the round that begins, from 0.
        last: End of the agent's latest program.
        before: The agent's programs of earlier rounds, of any policy; an empty text: no program.
        memo: Cache that the policies of a round share.
        considered: Courses that the policy noted for the record of the run; None: none.
        spent: Spending on the models that the policy asked through `noting`.
    """

    def __init__(
        self,
        agent: str,
        brief: Brief,
        round: int,
        last: Ended,
        own: ShownSimulator,
        imagine: Callable[[int, int | None], Imagination],
        noting: "Callable[[Model], Model]",
        before: Sequence[str],
        memo: dict[object, Any] | None = None,
        check: Callable[[Spent], None] | None = None,
    ) -> None:
        self.agent = agent
        self.brief = brief
        self.round = round
        self.last = last
        self._own = own
        self._imagine = imagine
        self._noting = noting
        self._check = check or _allow
        self.before = before
        self.memo = {} if memo is None else memo
        self.considered: SearchTrace | None = None
        self.spent = Spent()

    @cached_property
    def random(self) -> Random:
        """Random numbers of the policy in this round; equal seeds of episodes give equal ones."""
        return Random(f"{self.brief.seed} {self.agent} {self.round}")

    @property
    def tick(self) -> int:
        """Tick at which the round begins."""
        return self._own.tick

    @property
    def ticks_left(self) -> int:
        """Return the ticks until the end of the last round or the deadline of the goal."""
        return self.ticks_left_for(self.goal)

    def ticks_left_for(self, goal: Goal) -> int:
        """Return the ticks until the end of the last round or the deadline of a goal."""
        rounds, length = self.brief.rounds, self.brief.whole_round
        last = min(rounds * length, goal.ticks or rounds * length)
        return max(0, last - self.round * length)

    @property
    def goal(self) -> Goal:
        """Goal of the agent."""
        return self.brief.goals[self.agent]

    @property
    def may_speak(self) -> bool:
        """True if others can hear what the agent says."""
        return self.agent in self.brief.talk

    @property
    def state(self) -> State:
        """Return the belief of the agent."""
        return self._own.state

    @property
    def heard(self) -> Sequence[tuple[int, str, str]]:
        """Return utterances of others since the agent's last decision: (tick, speaker, text)."""
        since = self.tick - self.brief.whole_round if self.round else -1
        return [
            (tick, speaker, text)
            for tick, speaker, text in self.state.chat
            if tick > since and speaker != self.agent
        ]

    @property
    def messages(self) -> int:
        """Return the number of utterances that count for a goal, as far as the agent heard them."""
        start = self.tick - self.round * self.brief.whole_round
        return len(utterances(self.state.chat, self.brief.players, start))

    @property
    def spoken(self) -> Mapping[str, frozenset[str]]:
        """Return all texts that the agent heard so far, its own too, by speaker."""
        texts_of: dict[str, set[str]] = {}
        for _, speaker, text in self.state.chat:
            texts_of.setdefault(speaker, set()).add(text)
        return {speaker: frozenset(texts) for speaker, texts in texts_of.items()}

    @property
    def claims(self) -> Sequence[tuple[int, str, Claim]]:
        """Claims that others made in its hearing, oldest first: tick, speaker, claim."""
        return [each for each in self._own.heard_claims if each[1] != self.agent]

    def infer(self, model: "MindModel", *agents: str) -> "Inference":
        """Infer an agent's goals from its course as the agent of the view perceived it.

        Args:
            model: The hypotheses.
            agents: Whose belief is read in place of its own: `infer(model, "bob")` plans as one
                does who believes what Bob is believed to believe.

        Raises:
            InputError: The model does not fit its percepts.
            PathError: There is no such agent.
        """
        return self._below(agents).infer(model)

    def about(self, *agents: str) -> State:
        """Return a belief below the agent's own, such as `about("bob", "anne")`.

        Raises:
            PathError: An agent does not exist.
        """
        return self._below(agents).state

    def _below(self, agents: Sequence[str]) -> ShownSimulator:
        simulator = self._own
        for agent in agents:
            if agent not in self._own.state.agents:
                raise PathError(f"there is no agent {agent!r} in {sorted(self._own.state.agents)}")
            simulator = simulator.child(agent)
        return simulator

    def imagine(self, depth: int = 1, tick: int | None = None) -> Imagination:
        """Return the agent's belief as a separate world for trying plans; it is not recorded.

        Args:
            depth: Depth down to which beliefs are tracked in it.
            tick: A past tick, as the agent knew it then; 0: the first; None: now.

        Raises:
            TickError: The tick is in the future or before the start.
        """
        return self._imagine(depth, tick)

    def render(self, template: str, depth: int = 0, **variables: object) -> str:
        """Return the text of a prompt template, filled from its belief.

        Args:
            template: Text of the template. `branch` is the belief, `view` the other facts
                (`RoundFacts`). `about` maps texts such as `bob` or `bob/anne` to the beliefs of
                others as the agent believes them; filters accept these like `branch`.
            depth: Greatest depth of `about`.
            variables: Further variables.

        Raises:
            TemplateError: The template is wrong.
        """
        about: dict[str, MindView] = {}
        level: list[tuple[tuple[str, ...], MindView]] = [((), self._own.view)]
        for _ in range(depth):
            level = [
                ((*path, name), view.child(name))
                for path, view in level
                for name in self.brief.agents
                if name != (path[-1] if path else self._own.owner)
            ]
            about |= {"/".join(path): view for path, view in level}
        return self._own.render(template, view=RoundFacts.of(self), about=about, **variables)

    def note_considered(self, trace: SearchTrace) -> None:
        """Record the courses that the policy considered for this round, for readers of the run."""
        self.considered = trace

    def noting(self, model: "Model") -> "Model":
        """Return a model whose conversation the run records and whose spending it counts.

        The measures of the episode contain its requests, tokens and cost, and the limits of the
        episode hold for it.

        Args:
            model: Any model, also one of your own.
        """
        return _CountedModel(self._noting(model), self._allowed, self._spend)

    def _spend(self, spent: Spent) -> None:
        self.spent += spent

    def _allowed(self) -> None:
        self._check(self.spent)


def _allow(spent: Spent) -> None:
    """Set no limit."""


class RoundFacts(msgspec.Struct, frozen=True):
    """Facts for templates besides the belief.

    Attributes:
        agent: Name of the agent.
        goal: Goal of the agent, in words.
        goals: Goals of all agents, known or possible, in words.
        may_speak: True if others can hear what the agent says.
        round: Number of the round, from 1.
        rounds: Number of rounds.
        round_ticks: Ticks after which programs are cut.
        last: End of the agent's latest program.
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
        """Return the facts of a view."""
        brief = view.brief
        return cls(
            view.agent,
            str(view.goal),
            {name: brief.words(name) for name in brief.agents},
            view.may_speak,
            view.round + 1,
            brief.rounds,
            brief.round_ticks,
            view.last,
        )


class Policy(Protocol):
    """Protocol of policies, which decide what an agent does."""

    def act(self, view: AgentView) -> str | None:
        """Return the agent's program for the round.

        An empty text or None means that the agent does nothing; `GO_ON` continues its last program.

        Args:
            view: Knowledge of the agent.
        """


class _CountedModel(msgspec.Struct, frozen=True):
    """Model wrapper that reports the usage of each answer, even of unusable ones.

    Attributes:
        model: The model to ask.
        check: Function that raises ModelError if nothing more may be spent.
        spend: Function that receives the spending of a request.
    """

    model: "Model"
    check: Callable[[], None]
    spend: Callable[[Spent], None]

    @property
    def name(self) -> str:
        """Name of the wrapped model."""
        return self.model.name

    def answer(self, messages: "Sequence[Message]", sampling: "Sampling") -> "Answer":
        """Ask the model.

        Raises:
            ModelError: The model failed, or a limit of the episode is reached.
        """
        self.check()
        try:
            answer = self.model.answer(messages, sampling)
        except ModelError as error:
            usage: Usage | None = getattr(error, "usage", None)
            if usage is not None:
                self.spend(_spent(usage))
            raise
        self.spend(_spent(answer.usage))
        return answer


def _spent(usage: "Usage") -> Spent:
    return Spent(usage.requests, usage.tokens, usage.cost)
