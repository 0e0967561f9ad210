"""Text stories of the ToMi and Hi-ToM kind: parse them, play them, and answer questions.

Answers come from the nest after the story has been played, never from the text.
"""

from beliefnest.suites.stories.floor_plan import FloorPlan, lay_out
from beliefnest.suites.stories.played_story import PlayedStory, StoryAnswer
from beliefnest.suites.stories.questions import Question, parse_question
from beliefnest.suites.stories.story import Story, read_story

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
