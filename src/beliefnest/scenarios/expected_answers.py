"""Expectations about probes that are judged by the answer to a question."""

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

from beliefnest.errors import ScenarioError
from beliefnest.nest.past.setting import Setting
from beliefnest.scenarios.believed import Believed, BelievedEntry, Look
from beliefnest.scenarios.checks import Checks
from beliefnest.scenarios.document import KeyPath
from beliefnest.scenarios.expected import (
    Expected,
    ExpectEntry,
    Happened,
    Judgement,
    as_list,
    source_of,
)
from beliefnest.scenarios.naming import Naming
from beliefnest.world.words import listed

__all__ = [
    "Answers",
]

_MOST_OPTIONS = 26
"""Greatest number of options: one for each letter."""


@dataclass(frozen=True, slots=True)
class Answers(Expected):
    """Expectation: the model answers a question, in words or by choosing an option.

    Attributes:
        question: The question.
        right: Right answers. An answer in words is right if it contains one of them as whole
            words, in any case, and none of `wrong`.
        options: Options to choose from, shuffled by the seed; empty: an answer in words.
        wrong: Texts that a right answer in words must not contain.
        reason: True if the model is also asked for a reason.
        believed: The belief that gives the right answers; None: the scenario gives them. `right` is
            empty until the nest has computed them.
    """

    many = True
    ground = "the model's answer to the question"
    question: str
    right: tuple[str, ...]
    options: tuple[str, ...] = ()
    wrong: tuple[str, ...] = ()
    reason: bool = False
    believed: Believed | None = None

    @property
    def paths(self) -> tuple[str, ...]:
        return () if self.believed is None else (self.believed.path,)

    @classmethod
    def read(cls, entry: ExpectEntry, path: KeyPath, checks: Checks) -> Iterator["Answers"]:
        for number, each in enumerate(as_list(entry.answers)):
            place = (*path, "answers", number)
            right: tuple[str, ...] = ()
            believed = None
            if isinstance(each.right, BelievedEntry):
                believed = Believed.read(each.right, (*place, "right"), checks)
            else:
                right = (each.right,) if isinstance(each.right, str) else tuple(each.right)
            found = cls(
                each.question,
                right,
                tuple(each.options),
                tuple(each.wrong),
                each.reason,
                believed,
            )
            for key, message in found._faults():
                raise checks.fault((*place, *key), message)
            yield found

    def _faults(self) -> Iterator[tuple[KeyPath, str]]:
        right, options = self.right, self.options
        given = self.believed is not None or (right and all(each.strip() for each in right))
        if not self.question.strip() or not given:
            yield (), "give a question and at least one right answer"
        missing = [each for each in right if each not in options]
        if options and missing:
            yield ("right",), f"{missing[0]!r} is none of the options"
        if len(options) > _MOST_OPTIONS:
            yield ("options",), f"are more than {_MOST_OPTIONS}"
        if len({each.casefold() for each in options}) < len(options):
            yield ("options",), "has an option twice"
        if options and set(right) == set(options):
            yield ("options",), "are all right; give one that is not"
        letters = [each for each in options if len(each.strip()) == 1 and each.isalpha()]
        if letters:
            yield (
                ("options",),
                f"{letters[0]!r} is a single letter, which names an option; write it out",
            )
        both = [each for each in right if each in self.wrong]
        if both:
            yield ("wrong",), f"{both[0]!r} is right as well"
        if options and self.wrong:
            yield ("wrong",), "is for answers in words, without options"

    def written(self) -> dict[str, Any]:
        asked = {
            "question": self.question,
            "right": self._right,
            "options": list(self.options),
            "wrong": list(self.wrong),
            "reason": self.reason,
        }
        if self.right:
            asked |= source_of("right", self.believed)
        return {"answers": [asked]}

    @property
    def _right(self) -> list[str] | dict[str, Any]:
        if self.believed is not None and not self.right:
            return self.believed.written()
        return list(self.right)

    def resolved(self, look: Look, naming: Naming) -> "Expected":
        if self.believed is None or self.right:
            return self
        found = replace(self, right=self.believed.answers(look, naming, self.options))
        both = [each for each in found.right if each in self.wrong]
        if both:
            raise ScenarioError(
                f"{self.believed.where}the belief gives {both[0]!r}, which 'wrong' names as well"
            )
        return found

    def judge(self, answer: str | None) -> Judgement:
        """Judge the answer to the question; None: there was no answer."""
        if answer is None:
            return Judgement(self, ok=False, why_not="gave no answer", outcome="no_answer")
        if self.options:
            ok = answer in self.right
        else:
            right = self.right if self.believed is None else self.believed.accepted(self.right)
            named = [any(_has(answer, each) for each in all_) for all_ in (right, self.wrong)]
            ok = named == [True, False]
        return self.verdict(ok, f"answered {answer!r}", by_deed=True)

    def told(self, judged: Judgement, outcome: Happened, setting: Setting, *, alone: bool) -> str:
        answers = {each.question: each.answer for each in outcome.replies}
        told = f"answers {answers.get(self.question) or 'nothing'}"
        return told if judged.ok else f"{told}, right is {listed(self.right, 'or')}"

    def account(self, judged: Judgement, outcome: Happened, setting: Setting, agent: str) -> str:
        told = "" if judged.ok else f": {judged.why_not}"
        source = "" if self.believed is None else f" ({self.believed.words}; computed by the nest)"
        right = listed([repr(each) for each in self.right], "or")
        return f"Judged by {self.ground}; right is {right}{source}; that is {judged.words}{told}."


def _has(answer: str, text: str) -> bool:
    """Return True if an answer contains a text as whole words."""
    return re.search(rf"(?<!\w){re.escape(text.casefold())}(?!\w)", answer.casefold()) is not None
