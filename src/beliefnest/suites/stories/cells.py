"""Stories as cells of a plan."""

from collections.abc import Mapping, Sequence
from typing import Any

import msgspec
from msgspec.structs import asdict, replace

from beliefnest.llm.claim_reader import claims_from_model
from beliefnest.llm.messages import Sampling
from beliefnest.llm.model_settings import ModelSettings
from beliefnest.plan.cells import digest
from beliefnest.plan.terms import PlayStage
from beliefnest.studies.suite_cells import SuiteKey, suite_kind
from beliefnest.suites.stories.data import StoryItems
from beliefnest.suites.stories.suite import JudgedAnswer, answer_story, asked_in

STORY_KIND = suite_kind("stories", JudgedAnswer, ("suite", "claims", "order"), is_judged=True)


class StoryCell(msgspec.Struct, frozen=True):
    """Story with its questions, played once and asked afterwards.

    Attributes:
        key: Identity of the cell.
        asked: The story and its questions.
    """

    key: SuiteKey
    asked: StoryItems

    @property
    def world(self) -> str:
        """Return the name of the world."""
        return str(self.key.setting["world"])

    @property
    def is_quick(self) -> bool:
        """Return True if no model is asked."""
        return self.key.setting["claims_from"] is None

    def plain(self) -> dict[str, Any]:
        """Return the cell as plain values for the plan."""
        return self.key.planned(self.key.content, asked_in(self.asked))

    def play(self, stage: PlayStage) -> dict[str, Any]:
        """Play the story, and return the answers as plain values.

        Raises:
            BeliefNestError: The world, a bot, or the model failed.
        """
        asked, name = self.asked, self.key.setting["claims_from"]
        if name is not None:
            model = stage.terms.reader(name, ModelSettings())
            reader = claims_from_model(model, Sampling(seed=self.key.seed))
            asked = replace(asked, knowing=replace(asked.knowing, claims_from=reader))
        judged = answer_story(asked, self.world, self.key.seed)
        return {"error": None, "rows": msgspec.to_builtins(judged)}


def story_cells(
    suite: str, stories: Sequence[StoryItems], setting: Mapping[str, Any]
) -> list[StoryCell]:
    """Return a cell for each story of a suite.

    Args:
        suite: Name of the suite.
        stories: The stories.
        setting: `world`, `seed` and `claims_from` of all cells.
    """
    return [StoryCell(SuiteKey(suite, _content(each), setting), each) for each in stories]


def _content(asked: StoryItems) -> str:
    lines = [[line.place, line.text] for line in asked.story.lines]
    questions = [[each.row, asdict(each.question), each.expected] for each in asked.items]
    return digest([lines, questions, asdict(asked.knowing)])[:16]
