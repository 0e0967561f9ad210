"""Offline model: answers from the prompt's text alone, without network or key."""

import re
from collections.abc import Sequence

from beliefnest.llm.messages import Answer, Message, Sampling
from beliefnest.llm.offline.answering import answer_question
from beliefnest.llm.offline.planning import plan
from beliefnest.llm.offline.program_texts import fenced
from beliefnest.llm.offline.prompt_reading import read_prompt

_QUESTION = re.compile(r"^Question: *(.+)$", re.MULTILINE)


class OfflineModel:
    """A deterministic stand-in for a language model.

    It reads the same messages as a language model and nothing else. It understands the sections
    of the paper's prompt and a few kinds of tasks (see `planning`), and answers in the same
    form.
    """

    name = "offline"

    def answer(self, messages: Sequence[Message], sampling: Sampling) -> Answer:
        """Return a program for the task in the messages, or an answer to their question.

        The sampling parameters are ignored.
        """
        text = "\n".join(message.text for message in messages if message.role != "assistant")
        reading = read_prompt(text)
        asked = _QUESTION.findall(text)
        if asked and not reading.task:
            return Answer(answer_question(asked[-1], text, reading))
        return Answer(fenced(plan(reading)))
