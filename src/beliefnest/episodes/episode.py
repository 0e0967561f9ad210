"""An episode: a task played round after round, recorded, gone on with, replayed, branched."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import Self

from beliefnest.bodies.worlds import Worlds
from beliefnest.episodes.choosing import check_resumable, chosen, name_of
from beliefnest.episodes.decided import (
    Failure,
    Part,
    Spent,
    failures_in,
    latest_end,
    programs_of,
    spent_in,
)
from beliefnest.episodes.helping import Help, help_in
from beliefnest.episodes.measures import Measures, false_beliefs, measured
from beliefnest.episodes.people import check_repeats, people_in, played_by_people, world_of_people
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
)
from beliefnest.episodes.round_start import RoundStart
from beliefnest.episodes.rounds import Asker, replayed, slots_of
from beliefnest.episodes.task import Task
from beliefnest.episodes.view import AgentView, Brief, Policy
from beliefnest.episodes.watching import Watch
from beliefnest.errors import InputError
from beliefnest.nest.face.nest import Nest
from beliefnest.nest.past.setting import MAIN
from beliefnest.scenarios.goals import Progress
from beliefnest.scenarios.scenario import Scenario
from beliefnest.world.paths import path_text

__all__ = ["Budget", "Episode", "RoundStart"]

_ON_FOOT = 5
"""Ticks that Minecraft's players take for a block, 4.3 blocks a second, rounded up."""


class Episode:
    """A task that is played by policies, one for each agent.

    Nothing is started before it is first played or looked at. It is played in the scripted world
    unless another one is named. Close it, or use it in a `with` block.

    Args:
        task: What is played, or a scenario, played by its own rules; where one walks as people
            do, rounds are as much longer.
        policies: By agent, as on the command line or any object with `act`; who is left out is
            played by the task's own policy, a player by `search` of the task's order.
        world: Where it is played.
        store: File to record in; None: memory.
        seed: Drives every random number.
        budget: What it may take.
        patience_s: Seconds after which a policy has lost its round; None: it is waited for.
        worlds: Lends the world, to one episode after the other; None: one is started.
        listen: Where people join who play agents, as for `Nest.open`.
        names: What runs call policies that are objects, by agent.

    Raises:
        InputError: There is a policy for nobody.
        UnknownNameError: There is no such policy.
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
    ) -> None:
        if isinstance(task, Scenario):
            task = Task.of(task)
        if world != "scripted" and task.form.pace == 1:
            task = task.at_pace(_ON_FOOT)
        self.seed = seed
        self._names, self._policies = chosen(task, policies or {})
        self._people = people_in(self._policies)
        self.task = played_by_people(task, self._people)
        world = world_of_people(world, listen, self._people)
        self._names |= names or {}
        self._world, self._store, self._worlds = world, store, worlds
        self._budget = budget or Budget()
        self._patience_s = patience_s
        self._asker = Asker(self._policies, patience_s)
        self._branch = MAIN
        self._nest: Nest | None = None
        self._lobby: Nest | None = None
        self._owns_nest = True
        self._start = 0
        self._parts: list[Part] = []
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
        """Go on with a recorded episode where it was.

        Args:
            store: The run file.
            policies: By agent; those who are left out are played as before.
            branch: Which one is gone on with; None: the one that was played last.
            budget: What it may take, with what it has taken; None: as much as before.
            patience_s: As for the class.

        Raises:
            StoreError: There is no such run, or no episode in it.
            InputError: A policy of before was an object, which no file holds.
            BranchError: The episode has no such branch.
        """
        nest = Nest.resume(store)
        try:
            kept, branches = kept_in(nest)
            branch = branch or nest["/"].branch
            known = branch_of(branches, branch)
            nest["/"].switch(branch)
            given = {**known.policies, **(policies or {})}
            check_resumable(given)
            task = Task.from_mapping(kept.task, kept.task_seed)
            episode = cls(
                task,
                given,
                world=kept.world,
                store=store,
                seed=kept.seed,
                budget=budget or kept.budget,
                patience_s=patience_s,
            )
            episode._take(nest, branch, kept.start, known.parts)
        except BaseException:
            nest.close()
            raise
        return episode

    @classmethod
    def replay(
        cls,
        recorded: str | Path,
        store: str | Path | None = None,
        *,
        branch: str | None = None,
    ) -> Self:
        """Play what was decided in a recorded episode once more, without asking anybody.

        Args:
            recorded: Its run file.
            store: File to record the replay in; None: memory.
            branch: Which one; None: the one that was played last.

        Raises:
            StoreError: There is no such run, or no episode in it.
            BranchError: The episode has no such branch.
        """
        nest = Nest.read(recorded)
        with nest:
            kept, branches = kept_in(nest)
            decided = branch_of(branches, branch or nest.branch("/"))
        check_repeats(kept.world, "replayed")
        policies = replayed(decided.parts, decided.policies)
        task = Task.from_mapping(kept.task, kept.task_seed)
        episode = cls(
            task, policies, world=kept.world, store=store, seed=kept.seed, budget=kept.budget
        )
        # It is the same episode, and is recorded as it was.
        episode._names = dict(decided.policies)
        return episode

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """End the world and close the store; forks end with what they were forked from."""
        nest = self._nest or self._lobby
        if nest is not None and self._owns_nest:
            nest.close()
        self._nest = self._lobby = None

    @property
    def nest(self) -> Nest:
        """The nest that it is played in, on its branch; opened when it is first asked for."""
        nest = self._opened()
        if nest["/"].branch != self._branch:
            nest["/"].switch(self._branch)
        return nest

    @property
    def address(self) -> str | None:
        """Where people join with a Minecraft client, HOST:PORT; None if nobody can."""
        return (self._nest or self._entered()).address

    @property
    def world(self) -> str:
        """Name of the world that it is played in."""
        return self._world

    @property
    def branch(self) -> str:
        """The branch of the real world that it is played on."""
        return self._branch

    @property
    def policies(self) -> Mapping[str, str]:
        """By agent, who plays it, in words."""
        return dict(self._names)

    @property
    def rounds(self) -> int:
        """Rounds played."""
        return -(-len(self._parts) // len(self._slots))

    @property
    def beginnings(self) -> Sequence[int]:
        """The ticks at which the rounds began that were played."""
        if self._people:
            return [part.began for part in self._parts if part.began is not None]
        return range(self._start, self.nest.tick, self._brief.whole_round)

    @property
    def ticks(self) -> int:
        """Ticks since the first round began; until success, if there was one."""
        goal = self._watching.progress[""]
        if goal.reached is not None:
            return goal.reached - self._start
        return 0 if self._nest is None else self.nest.tick - self._start

    @property
    def is_over(self) -> bool:
        """True if there is nothing more to play."""
        if self._nest is None:
            return False
        return self._is_decided or self._is_at_end

    @property
    def _is_decided(self) -> bool:
        """True if the goal was reached, or cannot be any more."""
        progress = self._watch()
        return progress.reached is not None or progress.violated is not None

    @property
    def _is_at_end(self) -> bool:
        return len(self._parts) >= self.task.form.rounds * len(self._slots) or self._is_spent()

    @property
    def success(self) -> bool:
        """True if the task's goal was reached."""
        return self._nest is not None and self._watch().succeeded(over=self.is_over)

    @property
    def messages(self) -> int:
        """Utterances of players since the first round began."""
        return self.measures.messages

    @property
    def conditions(self) -> Sequence[tuple[str, int | None]]:
        """The goal's conditions in words, each with the tick at which it came true first."""
        self._opened()
        return self._watch().came_true()

    @property
    def measures(self) -> Measures:
        """What it came to, as one row."""
        found = measured(self)
        if self._help is None:
            return found
        return replace(
            found,
            help_needed=len(self._help.needed),
            help_given=len(self._help.given),
            help_superfluous=len(self._help.superfluous),
        )

    @property
    def false_beliefs(self) -> Sequence[tuple[int, Mapping[str, int]]]:
        """How many things each agent held wrongly as each round began and now, with the ticks."""
        return false_beliefs(self)

    def help(self) -> Help:
        """Measure who needed help and got it, who helped whom, and what was superfluous.

        Branches of a copy in memory are played: one for each agent, with the other players idle,
        and one for each thing that a player said or gave, without it. Policies are asked again,
        which with models takes time and tokens that are not counted here. `measures` tells of
        it from then on.
        """
        check_repeats(self._world, "played again without somebody's help")
        if self._help is None:
            told = replayed(self._parts, self.task.agents)
            with Episode(self.task, told, world=self._world, seed=self.seed) as copy:
                copy.play(self.rounds)
                self._help = help_in(copy, self._policies)
        return self._help

    @property
    def progress(self) -> Mapping[str, Progress]:
        """How far each agent's goal has come by now."""
        self._opened()
        self._watch()
        return {agent: self._watching.progress[agent] for agent in self.task.agents}

    @property
    def spent(self) -> Spent:
        """What policies have spent on models."""
        return spent_in(self._parts)

    @property
    def parts(self) -> Sequence[Part]:
        """What was decided in each part of each round, and how it ended."""
        return tuple(self._parts)

    @property
    def failures(self) -> Sequence[Failure]:
        """Programs that failed, and rounds in which a policy gave none, with the reasons."""
        return failures_in(self._parts, len(self._slots))

    @property
    def start(self) -> int:
        """The tick at which the first round began."""
        self._opened()
        return self._start

    def play(self, rounds: int | None = None) -> Self:
        """Play until the task's goal is reached or cannot be any more, or rounds are over.

        Args:
            rounds: Most rounds to play now; None: as many as the task has.

        Raises:
            InputError: The number of rounds is below 0.
            BodyError: The Minecraft side failed.
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
        """What the policy of an agent would be given now."""
        nest = self.nest
        policy = self._policies[agent]
        # An upper bound may see everything; nobody else can.
        path = "/" if getattr(policy, "sees_all", False) else path_text((agent,))
        own = nest[path]
        return AgentView(
            agent,
            self._brief,
            len(self._parts) // len(self._slots),
            latest_end(self._parts, agent),
            nest.at(nest.tick)[path],
            lambda depth: own.imagine(depth, self.task.form.pace),
            own.noting,
            programs_of(self._parts, agent),
        )

    def at(self, round: int) -> "RoundStart[Self]":
        """Return the beginning of a round that was played.

        Raises:
            InputError: There is no such round.
        """
        if round not in range(len(self._parts) // len(self._slots) + 1):
            raise InputError(f"round {round!r} was not played; there are {self.rounds}")
        return RoundStart(self, round)

    def forked(self, round: int, policies: Mapping[str, "str | Policy"]) -> Self:
        """See `RoundStart.fork`."""
        nest = self.nest
        beginnings = [*self.beginnings, nest.tick]
        tick = beginnings[round] if self._people else self._start + round * self._brief.whole_round
        taken = {info.key.branch for info in nest["/"].branches()}
        number = next(n for n in range(1, len(taken) + 2) if f"fork {n}" not in taken)
        given: dict[str, str | Policy] = {**self._policies, **policies}
        fork = type(self)(
            self.task,
            given,
            world=self._world,
            seed=self.seed,
            budget=self._budget,
            patience_s=self._patience_s,
        )
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

    @property
    def _brief(self) -> Brief:
        return Brief.of(self.task, self.seed)

    def _opened(self) -> Nest:
        if self._nest is None:
            nest = self._entered()
            try:
                keep_begins(nest)
                nest.play()
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
        """Return the nest before anything has happened in it, which people may join."""
        if self._lobby is None:
            self._lobby = Nest.open(
                self.task.scenario, self._world, self._store, self.seed, self._worlds
            )
        return self._lobby

    def _take(self, nest: Nest, branch: str, start: int, parts: list[Part]) -> None:
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
        """Ask for a part's programs, and keep them before they are run."""
        slot = self._slots[len(self._parts) % len(self._slots)]
        self._parts.append(Part({agent: self._asker.ask(self.view(agent)) for agent in slot}))
        self._keep()

    def _finish_part(self) -> None:
        """Do what was decided last, if it is not done yet, up to the end of its ticks."""
        nest, ticks = self.nest, self.task.form.round_ticks
        if self._people:
            if self._parts and not self._parts[-1].ended:
                self._parts[-1] = play_part_with_people(
                    nest, self._parts, ticks, self._policies, lambda: self._is_decided
                )
                self._watch()
                self._keep()
            return
        end = self._start + len(self._parts) * ticks
        if not self._parts or nest.tick >= end:
            return
        with nest.together():
            self._parts[-1] = play_part(nest, self._parts, ticks, end)
            self._watch()
            self._keep()

    def _is_spent(self) -> bool:
        return self._budget.is_spent(self.nest.tick - self._start, self.spent)

    def _watch(self) -> Progress:
        """How far the task's goal has come by now."""
        return self._watching.up_to_now(self.nest)[""]
