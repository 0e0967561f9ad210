"""Courses that a policy considered before it decided, as a run records them."""

from collections.abc import Mapping, Sequence
from typing import Any, Literal

import msgspec

_COURSES_SHOWN = 5

CourseOutcome = Literal["reached", "open", "violated", "expected"]
"""Imagined end of a course; `expected`: the mean over possible goals of others."""


class TriedCourse(msgspec.Struct, frozen=True):
    """Course that a policy tried in imagination.

    Attributes:
        program: Program of the course; empty: the agent does nothing.
        outcome: Imagined end.
        score: Numbers by which courses are compared from left to right; less is better. The first
            is 0 if the goal is reached, 1 if it stays open, 2 if it is violated. The cost of a
            course is its ticks plus 0.5 for each call and 2 for each utterance. After 0 follows
            the cost until then; after 1 the remaining distance to the goal and the cost; after 2
            minus the tick of the violation and the cost.
    """

    program: str
    outcome: CourseOutcome
    score: tuple[float, ...]

    @property
    def words(self) -> str:
        """Return the imagined end in words."""
        numbers = [f"{number:g}" for number in self.score[1:]]
        match self.outcome:
            case "reached":
                return f"reaches the goal, cost {numbers[0]}" if numbers else "reaches the goal"
            case "open":
                return f"leaves the goal open, distance {numbers[0]}"
            case "violated":
                return f"breaks the goal at tick {-self.score[1]:g}"
            case "expected":
                return f"expected outcome {self.score[0]:g}, cost {', '.join(numbers)}"


class SearchTrace(msgspec.Struct, frozen=True):
    """Courses that a policy considered for one round.

    Attributes:
        courses: The best courses, best first; the course of doing nothing is always among them.
        others: Programs that the agent reckoned the others would run, by name; empty: nothing.
        tried: Number of all courses that were tried, those of imagined others included.
        reason: Reason for a decision that is none of the courses; empty: it is the best of them.
    """

    courses: tuple[TriedCourse, ...]
    others: Mapping[str, str] = {}
    tried: int = 0
    reason: str = ""


def told_trace(trace: SearchTrace) -> dict[str, Any]:
    """Return a trace as plain values: courses as pairs of program and end in words."""
    return {
        "courses": [[course.program, course.words] for course in trace.courses],
        "others": dict(trace.others),
        "tried": trace.tried,
        "reason": trace.reason,
    }


def considered_lines(considered: Mapping[str, Any]) -> Sequence[str]:
    """Return a result of `told_trace` as lines: expected acts of others, then the best courses."""
    lines = [
        f"expects that {name} does: {_flat(program) or 'nothing'}"
        for name, program in considered["others"].items()
    ]
    lines += [
        f"{number}. {words}: {_flat(program) or 'nothing'}"
        for number, (program, words) in enumerate(considered["courses"][:_COURSES_SHOWN], 1)
    ]
    if considered["reason"]:
        lines.append(f"decided otherwise: {considered['reason']}")
    return lines


def _flat(program: str) -> str:
    return "; ".join(line.strip() for line in program.splitlines())
