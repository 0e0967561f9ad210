"""Expectations about probes that are judged by the answer to a question."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

from beliefnest.errors import ScenarioError
from beliefnest.llm.reading_answers import named_in_words
from beliefnest.nest.past.setting import Setting
from beliefnest.scenarios.believed import Believed, BelievedEntry, StateOf
from beliefnest.scenarios.checks import Checks
from beliefnest.scenarios.document import KeyPath
from beliefnest.scenarios.expected import (
    Answered,
    Expected,
    ExpectEntry,
    Judgement,
    ProbeFacts,
    as_list,
    source_of,
)
from beliefnest.scenarios.naming import Naming
from beliefnest.world.texts import quoted
from beliefnest.world.words import listed

_MOST_OPTIONS = 26
"""Greatest number of options: one for each letter."""


@dataclass(frozen=True, slots=True)
class Answers(Expected):
    """Expectation: the model answers a question, in words or by choosing an option.

    Attributes:
        question: The question.
        right: Right answers. An answer in words is right if it names one of them, and nothing of
            `wrong` or `known` (see `named_in_words`).
        options: Options to choose from, shuffled by the seed; empty: an answer in words.
        wrong: Texts that a right answer in words must not contain.
        reason: True if the model is also asked for a reason.
        known: Other names of the scene, which an answer in words tells from the right one.
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
    known: tuple[str, ...] = ()

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
            expected = cls(
                each.question, right, tuple(each.options), tuple(each.wrong), each.reason, believed
            )
            for key, message in expected._faults():
                raise checks.fault((*place, *key), message)
            yield expected

    def _faults(self) -> Iterator[tuple[KeyPath, str]]:
        right, options = self.right, self.options
        is_complete = self.believed is not None or (right and all(each.strip() for each in right))
        if not self.question.strip() or not is_complete:
            yield (), "give a question and at least one right answer"
        missing = [each for each in right if each not in options]
        if options and missing:
            yield ("right",), f"{quoted(missing[0])} is none of the options"
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
                f"{quoted(letters[0])} is a single letter, which names an option; write it out",
            )
        both = [each for each in right if each in self.wrong]
        if both:
            yield ("wrong",), f"{quoted(both[0])} is right as well"
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

    def resolved(self, look: StateOf, naming: Naming) -> "Expected":
        names = () if self.options else naming.all
        if self.believed is None or self.right:
            return replace(self, known=names)
        made = replace(self, known=names, right=self.believed.answers(look, naming, self.options))
        both = [each for each in made.right if each in self.wrong]
        if both:
            raise ScenarioError(
                f"{self.believed.where}the belief gives {quoted(both[0])}, which 'wrong' names as "
                "well"
            )
        return made

    def judge(self, reply: Answered) -> Judgement:
        """Judge the reply to the question."""
        if reply.answer is None:
            why = reply.why_not or "gave no answer"
            return Judgement(self, ok=False, why_not=why, outcome=reply.outcome)
        return self.judge_text(reply.answer)

    def judge_text(self, answer: str) -> Judgement:
        """Judge an answer: one of the options if there are any, else an answer in words."""
        if self.options:
            return self.verdict(answer in self.right, f"answered {quoted(answer)}", by_deed=True)
        return self._judge_words(answer)

    def _judge_words(self, answer: str) -> Judgement:
        """Judge an answer in words: it must name a right answer and nothing else that is known."""
        right = self.right if self.believed is None else self.believed.accepted(self.right)
        names = list(dict.fromkeys([*right, *self.wrong, *self.known]))
        named = named_in_words(answer, names)
        chosen = {names[number] for number in named.yes}
        answer_words = f"answered {quoted(answer)}"
        other = bool(chosen - set(right)) or named.alternative
        if named.unsure or (chosen & set(right) and other):
            answer_words += ", which is ambiguous"
            return Judgement(self, ok=False, why_not=answer_words, outcome="ambiguous")
        if not chosen and named.any:
            answer_words += ", which names no answer"
            return Judgement(self, ok=False, why_not=answer_words, outcome="unread")
        return self.verdict(bool(chosen & set(right)), answer_words, by_deed=True)

    def told(self, judged: Judgement, outcome: ProbeFacts, setting: Setting, *, alone: bool) -> str:
        answers = {each.question: each.answer for each in outcome.replies}
        answer_words = f"answers {answers.get(self.question) or 'nothing'}"
        return answer_words if judged.ok else f"{answer_words}, right is {listed(self.right, 'or')}"

    def account(self, judged: Judgement, outcome: ProbeFacts, setting: Setting, agent: str) -> str:
        reason = "" if judged.ok else f": {judged.why_not}"
        source = "" if self.believed is None else f" ({self.believed.words}; computed by the nest)"
        right = listed([repr(each) for each in self.right], "or")
        return f"Judged by {self.ground}; right is {right}{source}; that is {judged.words}{reason}."
