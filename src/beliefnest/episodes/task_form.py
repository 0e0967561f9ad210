"""Form of a task: a scenario with goals and rules of play, from a file or a generator."""

from typing import Annotated, Any

import msgspec

from beliefnest.scenarios.rules import EpisodeEntry, GoalEntry


class TaskForm(EpisodeEntry, frozen=True, kw_only=True):
    """A task: a scenario, the goals of its agents, and the rules of play."""

    name: Annotated[str, msgspec.Meta(description="Short name, for tables and folders.")]
    scenario: Annotated[dict[str, Any], msgspec.Meta(description="As in a scenario file.")]
    goal: Annotated[
        GoalEntry, msgspec.Meta(description="Goal of the players; reaching it is success.")
    ]
    description: Annotated[
        str, msgspec.Meta(description="Description for people; it need not name the players.")
    ] = ""
    pace: Annotated[
        int, msgspec.Meta(ge=1, le=100, description="Ticks that an agent needs to walk one block.")
    ] = 1
