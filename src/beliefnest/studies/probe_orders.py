"""Order of Theory of Mind that a probe needs."""

from collections.abc import Mapping
from typing import Any

from beliefnest.world.paths import normalised


def order_of(path: str, expected: Mapping[str, Any] | None) -> int:
    """Return the greatest number of agents in the belief paths of a probe: 0 for the real world.

    The paths are that of the belief which the prompt tells, and those of the beliefs that give the
    right answers: a narrator can ask about any belief.

    Args:
        path: Path of the probed belief.
        expected: Expectations with the keys of scenario files; None: there are none.
    """
    questions = (expected or {}).get("answers", ())
    # Plans have the source of an answer in the place of the answer.
    sources = (each.get("right_from", each["right"]) for each in questions)
    beliefs = [each for each in sources if isinstance(each, Mapping)]
    paths = [path, *(each["path"] for each in beliefs)]
    return max(len(normalised(filter(None, each.split("/")))) for each in paths)
