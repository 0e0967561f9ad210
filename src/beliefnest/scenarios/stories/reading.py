"""Claims that a model reads out of what is told in a story, whose things have names of its own."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from beliefnest.scenarios.stories.plan import FloorPlan
from beliefnest.scenarios.stories.story import Story, Tell
from beliefnest.world.claims import Claim
from beliefnest.world.nameable import Nameable

if TYPE_CHECKING:  # Models take long to import.
    from beliefnest.llm.hearsay import ClaimsFromModel
    from beliefnest.llm.messages import Model

__all__ = ["StoryReader", "in_words_alone"]


@dataclass(frozen=True, slots=True)
class StoryReader:
    """Asks a model what a text claims, by the names that things and containers have in a story.

    Attributes:
        reader: Who is asked.
        plan: What stands for what.
    """

    reader: "ClaimsFromModel"
    plan: FloorPlan

    @property
    def name(self) -> str:
        """Name of the model."""
        return self.reader.name

    def through(self, wrap: "Callable[[Model], Model]") -> "StoryReader":
        """Return the same, asking through what `wrap` puts around the model."""
        return replace(self, reader=self.reader.through(wrap))

    def __call__(self, text: str, speaker: str, nameable: Nameable) -> Iterable[Claim]:
        """What the text claims; errors as those of the reader."""
        called = {item: thing for thing, item in self.plan.items.items()}
        containers = {
            at: f"{place.container} of the {place.room}" for place, at in self.plan.places.items()
        }
        return self.reader(text, speaker, replace(nameable, called=called, containers=containers))


def in_words_alone(story: Story) -> Story:
    """The story with its claims in the words of those who make them, and not beside these."""
    acts = (replace(act, is_claimed=False) if isinstance(act, Tell) else act for act in story.acts)
    return replace(story, acts=tuple(acts))
