"""Weighted histories: drawn, compared with what was perceived, resampled (a particle filter).

Gordon, Salmond and Smith 1993; systematic resampling after Kitagawa 1996. Histories that go the
same way whatever their seeds share one course, which is run once.
"""

import math
from collections import Counter, deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from random import Random

import msgspec

from beliefnest.minds.imagining.course_agreement import Agreement
from beliefnest.minds.imagining.courses import Candidate, Course, CoursePlan, Glimpse, Seeds
from beliefnest.minds.walking import Draw

OnTick = Callable[[int, int], None]


@dataclass(eq=False)
class Particle:
    """Weighted history at its latest tick.

    Attributes:
        ancestor: Number of the first history from which it was copied.
        course: Its course; histories may share one.
        seeds: Its seeds.
        weight: Its weight; all weights sum to 1.
    """

    ancestor: int
    course: Course
    seeds: Seeds
    weight: float


class Drawn(msgspec.Struct, frozen=True):
    """Draws for one history at its start."""

    alternatives: tuple[int, ...]
    candidates: Mapping[str, Candidate]
    draws: Mapping[str, Draw]


class Lost(msgspec.Struct, frozen=True):
    """Tick from which on no history agrees.

    Attributes:
        tick: The tick.
        text: The percept that the last ones did not explain.
    """

    tick: int
    text: str

    def __str__(self) -> str:
        return f"tick {self.tick}: {self.text}"


@dataclass(eq=False)
class HistoryDraws:
    """Histories being drawn.

    Args:
        plan: The part that all courses share.
        drawn: Draws for each history.
        agreement: Comparison with percepts; None: percepts do not count.
        seed: Seed of all random numbers.

    Attributes:
        particles: The histories that agree. If none is left: those that agreed longest.
        log_evidence: Natural logarithm of the probability of the percepts.
        lost: Tick from which on no history agrees; None: some agree.
    """

    plan: CoursePlan
    drawn: Sequence[Drawn]
    agreement: Agreement | None
    seed: int
    particles: list[Particle] = field(default_factory=list)
    log_evidence: float = 0.0
    lost: Lost | None = None
    _windows: dict[Course, deque[Glimpse]] = field(default_factory=dict)

    def run(self, until: int, on_tick: OnTick) -> None:
        """Draw all histories up to a tick."""
        self._begin()
        first = self.particles[0].course.tick
        glimpses = {course: course.glimpse() for course in self._courses()}
        self._compare(glimpses, first, until)
        for tick in range(first + 1, until + 1):
            if self.lost is not None:
                return
            on_tick(tick - first, until - first)
            glimpses = {course: course.step() for course in self._courses()}
            self._split(glimpses)
            self._compare(glimpses, tick, until)

    @property
    def effective_size(self) -> float:
        """Effective number of ancestors (Kish): square of the sum of weights / sum of squares."""
        return _effective(self.particles)

    def _courses(self) -> list[Course]:
        return list(dict.fromkeys(particle.course for particle in self.particles))

    def _begin(self) -> None:
        shared: dict[object, Course] = {}
        weight = 1 / len(self.drawn)
        for number, drawn in enumerate(self.drawn):
            seeds: Seeds = ((-1, f"{self.seed} {number}"),)
            key = (drawn.alternatives, tuple(each.name for each in drawn.candidates.values()))
            course = shared.get(key)
            if course is None or not course.is_fixed or course.numbers_drawn:
                course = Course(self.plan, drawn.alternatives, drawn.candidates, drawn.draws, seeds)
                shared[key] = course
            self.particles.append(Particle(number, course, seeds, weight))

    def _split(self, glimpses: dict[Course, Glimpse]) -> None:
        """Give each history of a course its own course if a program has drawn a random number."""
        sharing = Counter(particle.course for particle in self.particles)
        split = {
            course
            for course, count in sharing.items()
            if count > 1 and course.numbers_drawn > course.shared_from
        }
        for particle in self.particles:
            course = particle.course
            if course not in split or sharing[course] < 2 or particle.seeds == course.seeds:
                continue
            sharing[course] -= 1
            particle.course = Course(
                self.plan, course.drawn, course.candidates, course.draws, particle.seeds
            )
            particle.course.run_to(course.tick - 1)
            particle.course.reseed()
            glimpses[particle.course] = particle.course.step()
            if course in self._windows:
                self._windows[particle.course] = self._windows[course].copy()

    def _compare(self, glimpses: Mapping[Course, Glimpse], tick: int, until: int) -> None:
        agreement = self.agreement
        if agreement is None:
            return
        ticks = agreement.witness.tolerance.ticks
        if ticks == 0:
            self._keep({c: agreement.misfit(c, g) for c, g in glimpses.items()}, tick)
            return
        for course, glimpse in glimpses.items():
            self._windows.setdefault(course, deque(maxlen=2 * ticks + 1)).append(glimpse)
        last = until if tick == until else tick - ticks
        for moment in range(tick - ticks, last + 1):
            if self.lost is not None or not agreement.is_due(moment):
                continue
            self._keep(
                {
                    course: agreement.misfit_within(
                        course,
                        [g for g in self._windows[course] if abs(g.tick - moment) <= ticks],
                        moment,
                    )
                    for course in self._courses()
                },
                tick,
            )

    def _keep(self, misfits: Mapping[Course, str | None], tick: int) -> None:
        """Keep the histories that agree; resample if they have too few ancestors."""
        kept = [particle for particle in self.particles if misfits[particle.course] is None]
        if not kept:
            self.lost = self._lost(misfits, tick)
            return
        if len(kept) == len(self.particles):
            return
        total = math.fsum(particle.weight for particle in kept)
        self.log_evidence += math.log(total)
        for particle in kept:
            particle.weight /= total
        self.particles = kept
        if self.effective_size < len(self.drawn) / 2:
            self._resample(tick)

    def _lost(self, misfits: Mapping[Course, str | None], tick: int) -> Lost:
        """Return the most frequent contradiction within histories, or else misfit with percepts."""
        last = [each.course for each in self.particles]
        faults = [course.contradiction for course in last if course.contradiction is not None]
        if faults:
            return Lost(tick, Counter(faults).most_common(1)[0][0])
        why = Counter(misfits[course] for course in last).most_common(1)[0][0]
        many = "the last history" if len(last) == 1 else f"the last {len(last)} histories"
        return Lost(tick, f"{why} in {many} differ from what was perceived")

    def _resample(self, tick: int) -> None:
        count = len(self.drawn)
        chance = Random(f"{self.seed} resampling at {tick}")
        weights = [particle.weight for particle in self.particles]
        chosen: list[Particle] = []
        copies: Counter[int] = Counter()
        for number in spread(weights, count, chance):
            particle = self.particles[number]
            copies[number] += 1
            if copies[number] == 1:
                particle.weight = 1 / count
                chosen.append(particle)
                continue
            seeds = (*particle.seeds, (tick, f"{particle.seeds[-1][1]} {tick}.{copies[number]}"))
            course = particle.course
            if course.is_fixed:
                course.shared_from = course.numbers_drawn
            else:
                window = self._windows.get(course)
                course = course.again(seeds)
                if window is not None:
                    self._windows[course] = window.copy()
            chosen.append(Particle(particle.ancestor, course, seeds, 1 / count))
        self.particles = chosen


def spread(weights: Sequence[float], count: int, chance: Random) -> list[int]:
    """Return indices of weights by systematic sampling.

    The count of each index differs from its expected count by less than 1.

    Args:
        weights: Weights from 0, with a sum above 0.
        count: Number of indices.
        chance: Generator of the single random number.
    """
    total = math.fsum(weights)
    start, number, reached = chance.random(), 0, weights[0] / total
    numbers = []
    for each in range(count):
        wanted = (each + start) / count
        while wanted > reached and number + 1 < len(weights):
            number += 1
            reached += weights[number] / total
        numbers.append(number)
    return numbers


def _effective(particles: Sequence[Particle]) -> float:
    shares: dict[int, float] = {}
    for particle in particles:
        shares[particle.ancestor] = shares.get(particle.ancestor, 0.0) + particle.weight
    total = math.fsum(shares.values())
    if total <= 0:
        return 0.0
    return total**2 / math.fsum(share**2 for share in shares.values())
