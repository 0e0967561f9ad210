"""Text stories of the ToMi and Hi-ToM kind: parse them, play them, and answer questions.

Answers come from the nest after the story has been played, never from the text.
"""

from beliefnest.scenarios.stories.plan import FloorPlan, lay_out
from beliefnest.scenarios.stories.playing import PlayedStory, StoryAnswer
from beliefnest.scenarios.stories.questions import Question, parse_question
from beliefnest.scenarios.stories.story import Story, read_story

__all__ = [
    "FloorPlan",
    "PlayedStory",
    "Question",
    "Story",
    "StoryAnswer",
    "lay_out",
    "parse_question",
    "read_story",
]
