"""Goals: conditions on reality and on beliefs, and the ticks at which they came true."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import msgspec

from beliefnest.facts.kinds import StatedFact
from beliefnest.facts.states import Look
from beliefnest.world.paths import BeliefPath
from beliefnest.world.words import counted


class Goal(msgspec.Struct, frozen=True):
    """Goal of an agent or of a task.

    Attributes:
        reach: Conditions that must hold at the same tick. Without any, the goal is reached at the
            end of the episode.
        never: Conditions that must not hold at any tick until then.
        messages: Greatest number of utterances of all players until then; None: no limit.
        ticks: Greatest number of ticks until then, from the start of the first round; None: no
            limit.
        helps: Agent whose goal this agent shares. If set, all other attributes are unset. None: the
            agent does not help.
    """

    reach: tuple[StatedFact, ...] = ()
    never: tuple[StatedFact, ...] = ()
    messages: int | None = None
    ticks: int | None = None
    helps: str | None = None

    @property
    def conditions(self) -> tuple[StatedFact, ...]:
        """Return all conditions of the goal."""
        return (*self.reach, *self.never)

    def met(self, look: Look) -> Sequence[bool]:
        """Return for each condition whether it holds."""
        return [condition.holds(look) for condition in self.conditions]

    def differs(self, other: "Goal") -> bool:
        """Return True if each of the two goals contains a condition that the other does not."""
        mine, theirs = self._wanted, other._wanted
        return not (mine <= theirs or theirs <= mine)

    @property
    def _wanted(self) -> frozenset[tuple[bool, StatedFact]]:
        wanted = [(True, each) for each in self.reach] + [(False, each) for each in self.never]
        return frozenset(wanted)

    @property
    def paths(self) -> frozenset[BeliefPath]:
        """Return the belief paths of all conditions."""
        return frozenset(each.path for each in self.conditions)

    def __str__(self) -> str:
        parts = [str(each) for each in self.reach]
        parts += [f"never: {each}" for each in self.never]
        if self.messages is not None:
            parts.append(f"at most {self.messages} messages")
        if self.ticks is not None:
            parts.append(f"within {self.ticks} ticks")
        if self.helps is not None:
            parts.append(f"what {self.helps} is after")
        return "; ".join(parts) or "nothing"


@dataclass(slots=True)
class Progress:
    """Progress of a goal, updated tick by tick.

    Attributes:
        goal: The goal.
        start: Tick at which the first round begins.
        first: Tick at which each condition first came true, by number of the condition.
        reached: Tick at which the goal was reached; None: not yet.
        violated: Tick at which the goal was violated, such as the last one of its limit of ticks;
            None: it was not.
        messages: Number of utterances of players so far; not counted if the goal does not limit it.
    """

    goal: Goal
    start: int
    first: dict[int, int] = field(default_factory=dict)
    reached: int | None = None
    violated: int | None = None
    messages: int = 0

    def feed(self, tick: int, are_met: Sequence[bool], messages: int) -> None:
        """Update the progress with a tick; after a violation, update `first` only.

        Args:
            tick: The tick.
            are_met: Whether each condition of the goal holds at the tick.
            messages: Number of utterances of players in the tick, if the goal limits it.
        """
        if self.reached is not None:
            return
        for number, holds in enumerate(are_met):
            if holds:
                self.first.setdefault(number, tick)
        self.end_tick(tick - 1)
        if self.violated is not None:
            return
        self.messages += messages
        count = len(self.goal.reach)
        if any(are_met[count:]) or self._says_too_much:
            self.violated = tick
        elif count and all(are_met[:count]):
            self.reached = tick

    def end_tick(self, tick: int) -> None:
        """Note that nothing more happens in a tick: with the last one, a limit of ticks is over."""
        is_open = self.reached is None and self.violated is None
        if is_open and self.goal.ticks is not None and tick - self.start >= self.goal.ticks:
            self.violated = self.start + self.goal.ticks

    @property
    def _says_too_much(self) -> bool:
        return self.goal.messages is not None and self.messages > self.goal.messages

    def why_not(self) -> str:
        """Return in words what the goal lacks, if it is not reached."""
        goal, texts = self.goal, list(map(str, self.goal.conditions))
        count, end = len(goal.reach), self.violated
        # Conditions come true after a violation, too.
        met = {number for number, tick in self.first.items() if end is None or tick <= end}
        broken = [f"not to be: {texts[number]}" for number in sorted(met) if number >= count]
        if self._says_too_much:
            broken.append(f"more than {counted(goal.messages or 0, 'message')}")
        if broken:
            return "; ".join(broken)
        if not goal.reach:
            return "the rounds are not over"
        late = [] if end is None else [f"not within {counted(goal.ticks or 0, 'tick')}"]
        lacking = [
            f"{'too late' if number in self.first else 'not reached'}: {texts[number]}"
            for number in range(count)
            if number not in met
        ]
        return "; ".join([*late, *(lacking or ["never all of it at one and the same tick"])])

    def succeeded(self, *, over: bool) -> bool:
        """Return True if the goal is reached; `over` is True if the episode has ended."""
        if self.violated is not None:
            return False
        return self.reached is not None or (over and not self.goal.reach)

    def came_true(self) -> Sequence[tuple[str, int | None]]:
        """Return all conditions in words, each with the tick at which it first came true."""
        return [
            (str(each), self.first.get(number)) for number, each in enumerate(self.goal.conditions)
        ]
