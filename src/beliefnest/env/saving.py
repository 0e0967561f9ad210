"""Episodes as values: the seed and what was chosen, from which the same episode comes again."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import msgspec

from beliefnest.errors import InputError
from beliefnest.skills.calls import Call

_OF_TESTS = "options"
"""Name of the option that PettingZoo's own tests give to every environment."""


@dataclass(frozen=True, slots=True)
class Choice:
    """Beginning of an agent's joint step.

    Attributes:
        action: Call or program.
        fault: Error message if the agent's action stood for nothing that it knows.
    """

    action: Call | str
    fault: str = ""


class SavedEpisode(msgspec.Struct, frozen=True):
    """Episode up to a joint step.

    Attributes:
        scenario: Name of the scenario or task.
        origin: Digest of what the episode began from: the instance, and the options that change
            what happens.
        seed: Seed of the episode.
        steps: Choices by agent in each joint step.
    """

    scenario: str
    origin: str
    seed: int
    steps: tuple[Mapping[str, Choice], ...]


def check_no_options(options: Mapping[str, Any] | None) -> None:
    """Raise InputError if an option is given to `reset`, which has none."""
    unknown = sorted(str(name) for name in options or () if name != _OF_TESTS)
    if unknown:
        raise InputError(
            f"reset was given {', '.join(unknown)}, and has no such option; parameters of "
            "tasks are given to the environment, as parameters={...}"
        )
