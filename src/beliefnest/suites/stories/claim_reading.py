"""Extraction of claims from a story's utterances by a model, with the story's own names."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from beliefnest.suites.stories.floor_plan import FloorPlan
from beliefnest.suites.stories.story import Story, Tell
from beliefnest.world.claims import Claim
from beliefnest.world.nameable import Nameable

if TYPE_CHECKING:  # Importing models takes long.
    from beliefnest.llm.claim_reader import ClaimsFromModel
    from beliefnest.llm.messages import Model


@dataclass(frozen=True, slots=True)
class StoryReader:
    """Extractor of claims that gives the model the story's names of things and containers.

    Attributes:
        reader: Extractor that asks the model.
        plan: Floor plan with the items and places of the story.
    """

    reader: "ClaimsFromModel"
    plan: FloorPlan

    @property
    def name(self) -> str:
        """Return the name of the model."""
        return self.reader.name

    def through(self, wrap: "Callable[[Model], Model]") -> "StoryReader":
        """Return the same extractor with its model wrapped by a function."""
        return replace(self, reader=self.reader.through(wrap))

    def __call__(self, text: str, speaker: str, nameable: Nameable) -> Iterable[Claim]:
        """Return the claims in a text; raise errors as the inner extractor does."""
        called = {item: thing for thing, item in self.plan.items.items()}
        at = self.plan.place_at
        containers = {p: f"{at(p).container} of the {at(p).room}" for p in nameable.containers}
        return self.reader(text, speaker, replace(nameable, called=called, containers=containers))


def in_words_alone(story: Story) -> Story:
    """Return the story without the claims beside utterances, so that only the words remain."""
    acts = (replace(act, is_claimed=False) if isinstance(act, Tell) else act for act in story.acts)
    return replace(story, acts=tuple(acts))
