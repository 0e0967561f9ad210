"""Episodes: play a task round after round; record, resume, replay and branch it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Self

from beliefnest.episodes.agent_view import AgentView, Brief, Policy
from beliefnest.episodes.choosing import check_resumable, chosen, name_of
from beliefnest.episodes.considered import SearchTrace
from beliefnest.episodes.decided import (
    Failure,
    RoundPart,
    Spent,
    failures_in,
    latest_end,
    programs_of,
    spent_in,
)
from beliefnest.episodes.helping import Help, help_in
from beliefnest.episodes.live_people import (
    check_repeats,
    people_in,
    played_by_people,
    world_of_people,
)
from beliefnest.episodes.measures import Measures, false_beliefs, measured
from beliefnest.episodes.playing import look_around, play_part, play_part_with_people
from beliefnest.episodes.record import (
    Branch,
    Budget,
    EpisodeStart,
    branch_of,
    keep_begins,
    keep_branch,
    keep_start,
    kept_in,
    played_last,
)
from beliefnest.episodes.rounds import Asker, replayed, slots_of
from beliefnest.episodes.task import Task
from beliefnest.episodes.watching import Watch
from beliefnest.errors import InputError, ModelError
from beliefnest.nest.acting.script import OnProgress
from beliefnest.nest.face.nest import Nest
from beliefnest.nest.past.setting import MAIN
from beliefnest.scenarios.goals import Progress
from beliefnest.scenarios.scenario import Scenario
from beliefnest.world.paths import path_text
from beliefnest.worlds.by_name import Worlds

_ON_FOOT = 4
"""Ticks per block for Minecraft's players, who run 5.6 blocks a second; rounded up."""


class Episode:
    """Episode of a task, played by policies, one for each agent.

    The world starts when the episode is first played or read. Close the episode, or use it in a
    `with` block.

    Args:
        task: A task, or a scenario, which is played by its own rules. In Minecraft worlds, rounds
            are longer, in proportion to the time that walking takes.
        policies: Policies by agent: names as on the command line, or objects with `act`. Other
            agents have the task's own policies, other players `search` of the task's order.
        world: Name of the world.
        store: Run file; None: memory.
        seed: Seed of every random number.
        budget: Limits of the episode.
        patience_s: Seconds after which a policy loses its round; None: no limit.
        worlds: Pool that lends the world to one episode after the other; None: start a world.
        listen: Address at which people join to play agents, as for `Nest.open`.
        names: Names in runs for policies that are objects, by agent.
        reads: Paths of beliefs that the caller reads between rounds; they are folded together.

    Raises:
        InputError: A policy is for an unknown agent.
        UnknownNameError: A policy does not exist.
    """

    def __init__(
        self,
        task: Task | Scenario,
        policies: Mapping[str, "str | Policy"] | None = None,
        *,
        world: str = "scripted",
        store: str | Path | None = None,
        seed: int = 0,
        budget: Budget | None = None,
        patience_s: float | None = None,
        worlds: Worlds | None = None,
        names: Mapping[str, str] | None = None,
        listen: int | str | None = None,
        reads: Sequence[str] = (),
    ) -> None:
        if isinstance(task, Scenario):
            task = Task.of(task)
        if world != "scripted" and task.form.pace == 1:
            task = task.at_pace(_ON_FOOT)
        self.seed = seed
        self._budget = budget or Budget()
        self._names, self._policies = chosen(task, policies or {}, self._budget)
        self._people = people_in(self._policies)
        self.task = played_by_people(task, self._people)
        world = world_of_people(world, listen, self._people)
        self._names |= names or {}
        self._world, self._store, self._worlds = world, store, worlds
        self._patience_s, self._reads = patience_s, reads
        self._asker = Asker(self._policies, patience_s)
        self._branch = MAIN
        self._nest: Nest | None = None
        self._lobby: Nest | None = None
        self._owns_nest = True
        self._start = 0
        self._parts: list[RoundPart] = []
        self._memo: dict[object, Any] = {}
        self._watching = Watch(task, 0)
        self._help: Help | None = None

    @classmethod
    def resume(
        cls,
        store: str | Path,
        policies: Mapping[str, "str | Policy"] | None = None,
        *,
        branch: str | None = None,
        budget: Budget | None = None,
        patience_s: float | None = None,
    ) -> Self:
        """Continue a recorded episode where it ended.

        Args:
            store: The run file.
            policies: New policies by agent; other agents keep their policies.
            branch: Branch to continue; None: the one that was played last.
            budget: New limits, which include what was used before; None: the limits as before.
            patience_s: As for the class.

        Raises:
            StoreError: The run does not exist, or holds no episode.
            InputError: An earlier policy was an object, which the file cannot hold.
            BranchError: The branch does not exist.
        """
        nest = Nest.resume(store)
        try:
            kept, branches = kept_in(nest)
            branch = branch or played_last(nest) or nest["/"].branch
            recorded = branch_of(branches, branch)
            nest["/"].switch(branch)
            chosen = {**recorded.policies, **(policies or {})}
            check_resumable(chosen)
            task = Task.from_mapping(kept.task, kept.task_seed)
            episode = cls(
                task,
                chosen,
                world=kept.world,
                store=store,
                seed=kept.seed,
                budget=budget or kept.budget,
                patience_s=patience_s,
            )
            episode._take(nest, branch, kept.start, recorded.parts)
        except BaseException:
            nest.close()
            raise
        return episode

    @classmethod
    def replay(
        cls, recorded: str | Path, store: str | Path | None = None, *, branch: str | None = None
    ) -> Self:
        """Play the recorded decisions of an episode again, without asking any policy.

        Args:
            recorded: Run file of the episode.
            store: Run file of the replay; None: memory.
            branch: Branch to replay; None: the one that was played last.

        Raises:
            StoreError: The run does not exist, or holds no episode.
            BranchError: The branch does not exist.
        """
        nest = Nest.read(recorded)
        with nest:
            kept, branches = kept_in(nest)
            decided = branch_of(branches, branch or played_last(nest) or nest.branch("/"))
        check_repeats(kept.world, "replayed")
        policies = replayed(decided.parts, decided.policies)
        task = Task.from_mapping(kept.task, kept.task_seed)
        episode = cls(
            task, policies, world=kept.world, store=store, seed=kept.seed, budget=kept.budget
        )
        # The replay is the same episode, so it records the same names of policies.
        episode._names = dict(decided.policies)
        return episode

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End the world and close the store; forks end with their origin."""
        nest = self._nest or self._lobby
        if nest is not None and self._owns_nest:
            nest.close()
        self._nest = self._lobby = None

    @property
    def nest(self) -> Nest:
        """Nest of the episode, on the episode's branch; opened at first use."""
        nest = self._opened()
        if nest["/"].branch != self._branch:
            nest["/"].switch(self._branch)
        return nest

    @property
    def address(self) -> str | None:
        """Address HOST:PORT for Minecraft clients of people; None if people cannot join."""
        return (self._nest or self._entered()).address

    @property
    def world(self) -> str:
        """Name of the world of the episode."""
        return self._world

    @property
    def branch(self) -> str:
        """Branch of the real world on which the episode plays."""
        return self._branch

    @property
    def policies(self) -> Mapping[str, str]:
        """Policies by agent, as text."""
        return dict(self._names)

    @property
    def rounds(self) -> int:
        """Number of rounds played."""
        return -(-len(self._parts) // len(self._slots))

    @property
    def beginnings(self) -> Sequence[int]:
        """Ticks at which the played rounds began."""
        if self._people:
            return [part.began for part in self._parts if part.began is not None]
        return range(self._start, self.nest.tick, Brief.of(self.task, self.seed).whole_round)

    @property
    def ticks(self) -> int:
        """Number of ticks from the first round until success or now."""
        goal = self._watching.progress[""]
        if goal.reached is not None:
            return goal.reached - self._start
        return 0 if self._nest is None else self.nest.tick - self._start

    @property
    def is_over(self) -> bool:
        """True if the episode has ended."""
        if self._nest is None:
            return False
        is_last = len(self._parts) >= self.task.form.rounds * len(self._slots)
        if self.is_decided or is_last:
            return True
        # Sum up what all rounds have spent only if there is a limit.
        limits, ticks = self._budget, self.nest.tick - self._start
        return limits != Budget() and limits.is_spent(ticks, self.spent)

    @property
    def is_decided(self) -> bool:
        """True if the goal is reached, or can no longer be reached."""
        progress = self._watch()
        return progress.reached is not None or progress.violated is not None

    @property
    def success(self) -> bool:
        """True if the task's goal is reached."""
        return self._nest is not None and self._watch().succeeded(over=self.is_over)

    @property
    def why_not(self) -> str:
        """Conditions and limits for which the goal is not reached, in words; empty: it is."""
        self._opened()
        return "" if self.success else self._watch().why_not()

    @property
    def messages(self) -> int:
        """Number of utterances of players since the first round began."""
        return self.measures.messages

    @property
    def conditions(self) -> Sequence[tuple[str, int | None]]:
        """Conditions of the goal in words, each with the tick at which it first came true."""
        self._opened()
        return self._watch().came_true()

    @property
    def measures(self) -> Measures:
        """Return the measures of the episode."""
        measures = measured(self)
        if self._help is None:
            return measures
        return replace(
            measures,
            help_needed=len(self._help.needed),
            help_given=len(self._help.given),
            help_superfluous=len(self._help.superfluous),
        )

    @property
    def false_beliefs(self) -> Sequence[tuple[int, Mapping[str, int]]]:
        """Return the number of false beliefs of each agent at each round's beginning and now."""
        return false_beliefs(self)

    def help(self) -> Help:
        """Measure which agents needed and got help, and which help was superfluous.

        The method plays branches of a copy in memory: one for each agent, with the other players
        idle, and one for each program in which a player says or gives something, without it.
        Policies are asked again. With models this takes time and tokens, which the episode does not
        count. Afterwards `measures` contains the results.
        """
        check_repeats(self._world, "played again to measure help")
        if self._help is None:
            replays = replayed(self._parts, self.task.agents)
            with Episode(self.task, replays, world=self._world, seed=self.seed) as copy:
                copy.play(self.rounds)
                self._help = help_in(copy, self._policies)
                self._asker.model_errors += copy._asker.model_errors
        return self._help

    @property
    def progress(self) -> Mapping[str, Progress]:
        """Return the progress of each agent's goal."""
        self._opened()
        self._watch()
        return {agent: self._watching.progress[agent] for agent in self.task.agents}

    @property
    def spent(self) -> Spent:
        """Spending of policies on models."""
        return spent_in(self._parts)

    @property
    def model_errors(self) -> Sequence[ModelError]:
        """Errors of requests of policies to which no answer came, since the episode was opened."""
        return tuple(self._asker.model_errors)

    @property
    def parts(self) -> Sequence[RoundPart]:
        """Decisions in each part of each round, and their results."""
        return tuple(self._parts)

    @property
    def failures(self) -> Sequence[Failure]:
        """Programs that failed, and rounds in which a policy gave none, with the reasons."""
        return failures_in(self._parts, len(self._slots))

    def search_trace(self, agent: str, round: int) -> SearchTrace:
        """Return the courses that an agent's policy considered before a round.

        `search` and `infer` record the best courses with their scores, and what they reckoned the
        others would do. Other policies record what they give to `AgentView.note_considered`.

        Args:
            agent: Name of the agent.
            round: Number of the round, from 0.

        Raises:
            InputError: The round was not played, there is no such agent, or its policy recorded
                nothing.
        """
        if agent not in self.task.agents:
            names = ", ".join(self.task.agents)
            raise InputError(f"there is no agent {agent!r}; agents are {names}")
        width = len(self._slots)
        decided = [
            part.decisions[agent]
            for part in self._parts[max(0, round) * width : (round + 1) * width]
            if agent in part.decisions
        ]
        if not decided:
            raise InputError(f"round {round!r} was not played; there are {self.rounds}")
        if decided[0].considered is None:
            raise InputError(
                f"the policy of {agent} recorded no courses for round {round}: "
                f"{self.policies[agent]}; search and infer record them"
            )
        return decided[0].considered

    @property
    def start(self) -> int:
        """Tick at which the first round began."""
        self._opened()
        return self._start

    def play(self, rounds: int | None = None) -> Self:
        """Play until the goal is reached, can no longer be reached, or rounds are over.

        Args:
            rounds: Greatest number of rounds to play now; None: as many as the task has.

        Raises:
            InputError: The number of rounds is below 0.
            BodyError: The Minecraft side failed.
            ModelError: The model of a policy cannot be asked at all: no server, a wrong key, no
                credit. Other failures of policies lose only their own round.
        """
        if rounds is not None and rounds < 0:
            raise InputError(f"{rounds} rounds cannot be played; give 0 or more")
        self._opened()
        self._help = None
        self._finish_part()
        last = self.task.form.rounds if rounds is None else self.rounds + rounds
        while not self.is_over and len(self._parts) < last * len(self._slots):
            self._decide()
            self._finish_part()
        return self

    def view(self, agent: str) -> AgentView:
        """Return the view that an agent's policy would get now."""
        nest = self.nest
        policy = self._policies[agent]
        # Policies that are upper bounds may read the whole nest; no other policy can.
        sees_all = getattr(policy, "sees_all", False)
        path = "/" if sees_all else path_text((agent,))
        own = nest[path]
        return AgentView(
            agent,
            Brief.of(self.task, self.seed, None if sees_all else agent),
            len(self._parts) // len(self._slots),
            latest_end(self._parts, agent),
            nest.at(nest.tick)[path],
            lambda depth, tick: own.imagination(depth, self.task.form.pace, tick),
            own.noting,
            programs_of(self._parts, agent),
            self._memo,
            self._check_spending,
        )

    def _check_spending(self, spent: Spent) -> None:
        """Raise ModelError if a policy that has spent something in this round may spend no more."""
        fault = self._budget.fault(self.spent + spent)
        if fault is not None:
            raise ModelError(f"{fault}; raise the limit of the episode to go on")

    def at(self, round: int) -> "RoundStart":
        """Return the beginning of a played round.

        Raises:
            InputError: The round was not played.
        """
        if round not in range(len(self._parts) // len(self._slots) + 1):
            raise InputError(f"round {round!r} was not played; there are {self.rounds}")
        return RoundStart(self, round)

    def forked(self, round: int, policies: Mapping[str, "str | Policy"]) -> Self:
        """Return a branch of the episode, see `RoundStart.fork`."""
        nest = self.nest
        beginnings = [*self.beginnings, nest.tick]
        whole = Brief.of(self.task, self.seed).whole_round
        tick = beginnings[round] if self._people else self._start + round * whole
        taken = {info.key.branch for info in nest["/"].branches()}
        number = next(n for n in range(1, len(taken) + 2) if f"fork {n}" not in taken)
        chosen: dict[str, str | Policy] = {**self._policies, **policies}
        fork = type(self)(
            self.task,
            chosen,
            world=self._world,
            seed=self.seed,
            budget=self._budget,
            patience_s=self._patience_s,
        )
        fork._asker.model_errors = self._asker.model_errors
        fork._names = {**self._names, **{a: name_of(p) for a, p in policies.items()}}
        nest["/"].switch(f"fork {number}", at=tick)
        before = self._parts[: round * len(self._slots)]
        fork._take(nest, f"fork {number}", self._start, list(before))
        fork._owns_nest = False
        fork._watch()
        fork._keep()
        return fork

    @property
    def _slots(self) -> tuple[tuple[str, ...], ...]:
        return slots_of(self.task.agents, turns=self.task.form.play == "turns")

    def _opened(self) -> Nest:
        if self._nest is None:
            nest = self._entered()
            try:
                keep_begins(nest)
                nest.play()
                if self._reads:
                    # Forests are begun one for each node that is asked for alone.
                    nest.states([*self._reads, *map(path_text, self._watching.paths)])
                if not self._people:
                    look_around(nest)
                plain, task_seed = self.task.plain(), self.task.seed
                begun = nest.tick
                keep_start(
                    nest,
                    EpisodeStart(plain, self.seed, task_seed, self._world, begun, self._budget),
                )
                self._take(nest, nest["/"].branch, begun, [])
                self._watching.up_to_now(nest)
                self._keep()
            except BaseException:
                self._nest = self._lobby = None
                nest.close()
                raise
        return self._nest or self._opened()

    def _entered(self) -> Nest:
        """Return a new nest, in which nothing has happened yet and which people may join."""
        if self._lobby is None:
            self._lobby = Nest.open(
                self.task.scenario, self._world, self._store, self.seed, self._worlds
            )
        return self._lobby

    def _take(self, nest: Nest, branch: str, start: int, parts: list[RoundPart]) -> None:
        self._nest, self._branch, self._start = nest, branch, start
        self._parts = parts
        self._watching = Watch(self.task, start)

    def _keep(self) -> None:
        goal = self._watching.progress[""]
        branch = Branch(
            self._names, self._parts, list(goal.came_true()), goal.reached, goal.violated
        )
        keep_branch(self._opened(), self._branch, branch)

    def _decide(self) -> None:
        """Ask for the programs of a part, and record them before they run."""
        slot = self._slots[len(self._parts) % len(self._slots)]
        self._memo.clear()
        self._parts.append(RoundPart({agent: self._asker.ask(self.view(agent)) for agent in slot}))
        self._keep()

    def _finish_part(self) -> None:
        """Play the last part to the end of its ticks, if that is not done yet."""
        nest, ticks = self.nest, self.task.form.round_ticks
        talk = self.task.form.talk
        mute = set() if talk is None else {*self.task.agents} - {*talk}
        if self._people:
            if self._parts and not self._parts[-1].ended:
                self._parts[-1] = play_part_with_people(
                    nest, self._parts, ticks, self._policies, lambda: self.is_decided, mute
                )
                self._watch()
                self._keep()
            return
        end = self._start + len(self._parts) * ticks
        if not self._parts or nest.tick >= end:
            return
        with nest.together():
            self._parts[-1] = play_part(nest, self._parts, ticks, end, mute)
            self._watch()
            self._keep()

    def _watch(self) -> Progress:
        """Return the progress of the task's goal."""
        return self._watching.up_to_now(self.nest)[""]


@dataclass(frozen=True, slots=True)
class RoundStart:
    """Beginning of a round of an episode, from which it can be branched.

    Attributes:
        episode: The episode.
        round: Number of the round, from 0.
    """

    episode: Episode
    round: int

    def fork(self, **policies: "str | Policy") -> Episode:
        """Return the episode from here on, on a new branch with other policies.

        Args:
            policies: New policies by agent; other agents keep their policies.

        Raises:
            InputError: A policy is for an unknown agent.
            UnknownNameError: A policy does not exist.
        """
        return self.episode.forked(self.round, policies)


def play_through(
    episode: Episode, on_progress: OnProgress, *, rounds: int | None, measure_help: bool
) -> None:
    """Play an episode, also one that was interrupted, to its end.

    Args:
        episode: The episode.
        on_progress: Function that is called before each round and at the end; it may raise.
        rounds: Limit of all its rounds; None: the task's.
        measure_help: Whether to measure help then.
    """
    limit = episode.task.form.rounds if rounds is None else rounds
    # A round that was interrupted counts as played, so it is finished first.
    episode.play(0)
    while episode.rounds < limit and not episode.is_over:
        on_progress(f"round {episode.rounds + 1}", episode.rounds, limit)
        episode.play(1)
    if measure_help:
        on_progress("playing branches without help", limit, limit)
        episode.help()
    on_progress("over", limit, limit)
