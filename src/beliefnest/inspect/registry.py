"""Tasks of Inspect AI, as programs import them."""

from beliefnest.adapters.inspect_ai.registry import (
    belief_prompt,
    course_in_words,
    episode,
    films,
    hi_tom,
    in_the_belief,
    like_inference,
    minds,
    scenario,
    stories,
)

__all__ = [
    "belief_prompt",
    "course_in_words",
    "episode",
    "films",
    "hi_tom",
    "in_the_belief",
    "like_inference",
    "minds",
    "scenario",
    "stories",
]
