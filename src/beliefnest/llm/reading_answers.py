"""Reader of answers: which option a model or a person named, or that it cannot be told."""

import re
from bisect import bisect_left
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

from beliefnest.llm.failures import excerpt
from beliefnest.llm.messages import Finish
from beliefnest.llm.naming import NamedOptions, Names, plain_words, sentences
from beliefnest.llm.statements import (
    Statement,
    afterthoughts,
    bare_lines,
    given_reason,
    statements,
    unfenced,
    without_made_up_turns,
)
from beliefnest.llm.thinking import separate_thinking

ReadOutcome = Literal["read", "ambiguous", "unread", "cut"]
"""Outcome of reading. `read`: there is an answer. `ambiguous`: it names several options. `unread`:
it names none. `cut`: it was cut off before its end."""

_CONCLUSION = re.compile(r"\W*(?:so|therefore|thus|hence)\b", re.IGNORECASE)
_REFUSAL = re.compile(
    r"\b(?:i(?: am|'m)? (?:really |very |so )?sorry|sorry|i apologi[sz]e|unfortunately|i regret)\b"
    r"[^\n]{0,80}\b(?:can ?not|can not|unable|not able|will not|do not feel comfortable)\b"
    r"[^\n]{0,40}\b(?:help|assist|answer|comply|provide|do that|fulfil|fulfill|continue|discuss"
    r"|engage|participate|support)\b"
    r"|^\W*i (?:can not|will not|am unable to|am not able to|must decline|decline|refuse)"
    r"\s*(?:to )?(?:help|assist|comply|provide|fulfil|fulfill|engage|participate|continue|do that"
    r"|answer (?:that|this)|discuss|support)?\b[^\n]{0,40}\b(?:help|assist|with that|with this"
    r"|request|question|content|topic|answer)\b"
    r"|\bas an? (?:ai|artificial|large|language)\b[^\n]{0,80}\b(?:can not|unable|not able)\b"
    r"|\b(?:against|violates?) my (?:guidelines|policy|policies|programming)\b",
    re.IGNORECASE,
)
_SIGNS = re.compile(
    r"^(?:\W*\b(?:no|wait|hold on|hmm+|sorry|actually|i mean|rather|or)\b[^\w(]*)+", re.IGNORECASE
)
_UNSURE = re.compile(
    r"\b(?:can not (?:know|say|tell|determine|be determined|answer|decide|infer)|do not know"
    r"|does not say|not sure|unsure|unclear|uncertain|impossible to|not enough information|unable"
    r"|not possible to|no way to|need more|hard to say|it depends|undetermined)\b",
    re.IGNORECASE,
)
_TAKEN_BACK = re.compile(
    r"\W*(?:no|wait|correction|scratch that|i mean|sorry|or rather|oops)\b", re.IGNORECASE
)
_STRONG_SIGNS = ("wait", "no", "correction", "scratch", "i mean", "sorry", "or rather", "oops",
                 "my mistake", "i was wrong", "on second", "never mind", "strike", "i take",
                 "i change", "edit", "hold on")  # fmt: skip


class ReadingOutcome:
    """Outcome of a reading of any kind."""

    __slots__ = ()
    outcome: ReadOutcome
    refused: bool

    @property
    def row_outcome(self) -> str:
        """Outcome in rows: `outcome`, or `refused`."""
        return "refused" if self.refused else self.outcome


@dataclass(frozen=True, slots=True)
class AnswerReading(ReadingOutcome):
    """Result of reading an answer.

    Attributes:
        option: The option that it names, as given; None: none, or more than one.
        outcome: `read`, `ambiguous`, `unread` or `cut`.
        reason: Why there is no option; empty: there is one.
        thinking: What the model thought before it answered.
        said: The statement that counted, in plain letters; empty: there is none.
        refused: True if the model would not answer.
    """

    option: str | None
    outcome: ReadOutcome
    reason: str = ""
    thinking: str = ""
    said: str = ""
    refused: bool = False


def is_refusal(text: str) -> bool:
    """Return True if a text refuses to answer."""
    return _REFUSAL.search(plain_words(text[:1000])) is not None


def withheld(text: str) -> str:
    """Return why an answer with the finish `content_filter` is none."""
    quotation = f": {excerpt(text)}" if text.strip() else ""
    return f"the provider withheld the answer, or the model refused{quotation}"


def read_answer(  # noqa: PLR0911 - each end of an answer has its own reason
    text: str, options: Sequence[str], finish: Finish = "stop"
) -> AnswerReading:
    """Read which of the options an answer names.

    The last statement counts: behind `Answer:` or `Final answer`, in a box, in JSON, in tags, on
    a line alone, or in a sentence that concludes. An option is named by its text, by its letter,
    or by what tells it from the others (`the blue one`). What a statement rules out or gives as
    grounds is not named. Thinking is never the answer.

    An answer that a limit cut off (`finish` is `length`) is always `cut`: what it names may be
    half of a thought.

    Args:
        text: Complete text of the answer.
        options: Texts of the options, in the order of their letters.
        finish: Reason for the end of the answer.
    """
    said = separate_thinking(text)
    if finish == "length":
        return AnswerReading(None, "cut", "a limit cut the answer off", said.thinking)
    if finish == "content_filter":
        fault = withheld(said.text)
        return AnswerReading(None, "unread", fault, said.thinking, refused=True)
    if said.open:
        fault = "the answer is a thought without an end"
        return AnswerReading(None, "unread", fault, said.thinking)
    if not said.text.strip():
        fault = "the answer is only thinking" if said.thinking else "the answer is empty"
        return AnswerReading(None, "unread", fault, said.thinking)
    reading = _Reader(options).read(said.text)
    chosen, ambiguous, statement = reading
    if len(chosen) == 1 and not ambiguous:
        return AnswerReading(options[chosen.pop()], "read", "", said.thinking, statement)
    fault = excerpt(statement or said.text.strip())
    if chosen or ambiguous:
        names = " and ".join(repr(options[each]) for each in sorted(chosen))
        reason = f"it names {names or 'no option clearly'}: {fault}"
        return AnswerReading(None, "ambiguous", reason, said.thinking, statement)
    if grounds := given_reason(said.text):
        fault = f"{fault} ({excerpt(grounds)})"
    refused = is_refusal(said.text)
    reason = f"the model refused: {fault}" if refused else f"it names none of the options: {fault}"
    return AnswerReading(None, "unread", reason, said.thinking, statement, refused)


_Found = tuple[set[int], bool, str]
"""Numbers of options, True if it is not clear which, and the statement."""


class _Reader:
    """Reader of one text.

    Args:
        options: Texts of the options.
    """

    def __init__(self, options: Sequence[str]) -> None:
        self._options = options
        self._names = Names(options)

    def read(self, text: str) -> _Found:
        text = self._without_echo(unfenced(text))
        answered: _Found | None = None
        # After an answer, a further question is one that the model made up.
        kept = ""
        for part in without_made_up_turns(text):
            kept = f"{kept}\n{part}" if kept else part
            reading = self._part(kept)
            if reading[0] or reading[1]:
                return reading
            answered = reading
        return answered or (set(), False, "")

    def _part(self, text: str) -> _Found:
        marks = statements(text)
        parts = sorted([*marks, *self._alone(text, marks)], key=lambda each: each.start)
        ruled_out: set[int] = set()
        for place in range(len(parts) - 1, -1, -1):
            each = parts[place]
            reading = self._statement(each)
            if reading is None:
                continue
            if not reading.yes and not reading.unsure:
                if reading.no and each.kind == "prose":
                    ruled_out |= reading.no
                    continue
                if each.kind == "prose":
                    continue
                return set(), False, plain_words(each.text).strip()
            chosen = reading.yes | reading.unsure
            if each.kind == "line" and place:
                # Lines one below the other are a list.
                before = parts[place - 1]
                named = self._statement(before)
                if named is not None and not text[before.end : each.start].strip():
                    chosen |= named.yes
            unclear = bool(reading.unsure) or bool(chosen & ruled_out) or len(chosen) > 1
            return self._reconsidered(chosen, unclear, each, text)
        return self._prose(text)

    def _alone(self, text: str, marks: Sequence[Statement]) -> Iterator[Statement]:
        """Yield the lines that hold nothing but an option, and are no part of another statement."""
        at = 0
        kept = dict(bare_lines(text))
        for number, line in enumerate(text.split("\n")):
            start, at = at, at + len(line) + 1
            plain = kept.get(number, "")
            end = start + len(line)
            # A mark before such a line has it as its value already.
            mark = bisect_left(marks, end, key=lambda each: each.end)
            if mark < len(marks) and marks[mark].start <= start:
                continue
            if plain and len(plain) < 300 and self._is_bare(plain):
                yield Statement(start, end, line, "line")

    def _is_bare(self, plain: str) -> bool:
        named = self._names.named(plain)
        return named.bare and bool(named.yes) and not plain.endswith("?")

    def _statement(self, statement: Statement) -> NamedOptions | None:
        """Return what a statement names; None: it is a question."""
        plain = plain_words(statement.text.replace("\\\\", " ")).strip()
        labelled = self._names.label_first(plain)
        if labelled is not None:
            return self._labelled(plain, *labelled)
        whole = NamedOptions()
        parts = sentences(plain) or [""]
        if statement.kind == "mark":
            stated = [e for e in parts if not e.endswith("?") or re.match(r"\W*or\b", e, re.I)]
            parts = stated or parts
        for number, sentence in enumerate(parts):
            named = self._names.named(_concluded(sentence, self._names))
            if named.yes and number == 0 and (named.bare or _is_headed(sentence, self._names)):
                # Further sentences explain it; `_reconsidered` looks for second thoughts.
                others = [self._names.named(each) for each in parts[1:]]
                for other in others:
                    named.yes |= other.yes if other.bare else other.maybe
                return named
            if named.yes and _CONCLUSION.match(sentence):
                whole = named
                continue
            whole.yes |= named.yes
            whole.no |= named.no
            whole.unsure |= named.unsure
            whole.aside |= named.aside
            whole.either |= named.either
        if not whole.yes and len(whole.either) > 1 and statement.kind != "prose":
            whole.unsure |= whole.either
        return whole

    def _labelled(self, plain: str, number: int, rest: str) -> NamedOptions:
        """Return what a letter with a text behind it names: both must name the same."""
        head = sentences(rest)[:1] or [""]
        if _TAKEN_BACK.match(rest):
            other = self._names.named(_SIGNS.sub("", rest))
            if other.bare and len(other.yes) == 1:
                return other
        named = self._names.named(head[0])
        first = re.split(r"[,;(\u2014]|\s-\s|\b(?:because|since|as|so)\b", head[0])[0]
        lead = self._names.named(first)
        whole = NamedOptions({number})
        if lead.bare or (named.bare and named.yes):
            whole.yes |= lead.yes | (named.yes if named.bare else set())
        # A list of options after the mark names all of them.
        for line in plain.split("\n")[1:]:
            if self._is_bare(line):
                whole.yes |= self._names.named(line).yes
        for sentence in sentences(rest):
            whole.yes |= self._names.named(sentence).maybe
            inner = re.findall(r"(?<!\w)\(?([A-Z])\)\s", sentence)
            if inner:
                whole.yes |= self._names.named(sentence).yes
        whole.yes |= named.either
        whole.no |= named.no - whole.yes
        if number in named.no:
            whole.unsure.add(number)
        alternative = re.search(r"\b(?:or|and|/)\s+", first) or re.search(r",\s*then\b", head[0])
        if alternative:
            whole.yes |= named.yes | named.unsure
        return whole

    def _reconsidered(
        self, chosen: set[int], unclear: bool, statement: Statement, text: str
    ) -> _Found:
        """Return what a statement says after the second thoughts that follow it."""
        plain = plain_words(statement.text).strip()
        after_head = f"{text[statement.start : statement.end]}\n{text[statement.end :]}"
        again = afterthoughts(plain_words(after_head))
        if again is None:
            return chosen, unclear, plain
        sign, rest = again[0], _SIGNS.sub("", again[1])
        parts = [each for each in sentences(rest) if self._names.named(each).any]
        if not parts:
            # Doubts without another answer leave none.
            weak = sign.startswith(("actually", "hmm", "on reflection"))
            return (chosen, unclear, plain) if weak else (chosen, True, plain)
        named = NamedOptions()
        for each in parts:
            other = self._names.named(each.lstrip(" ,:;-\u2014"))
            named.yes |= other.yes
            named.unsure |= other.unsure
            named.no |= other.no
            named.bare = other.bare if each is parts[0] else named.bare and other.bare
        if not named.yes and not named.unsure:
            return chosen, unclear or bool(named.no & chosen), plain
        if named.yes == chosen and not named.unsure:
            return chosen, unclear, plain
        strong = sign.startswith(_STRONG_SIGNS)
        if strong and named.bare and len(named.yes) == 1 and not named.unsure:
            return named.yes, False, plain_words(rest).strip()
        return chosen | named.yes, True, plain

    def _prose(self, text: str) -> _Found:
        """Return what a text without any statement names, if it says one thing only."""
        plain = plain_words(text)
        whole = NamedOptions()
        is_stated = False
        for sentence in sentences(plain):
            if sentence.endswith("?") and not re.match(r"\W*or\b", sentence, re.IGNORECASE):
                continue
            named = self._names.named(sentence)
            whole.yes |= named.yes
            whole.unsure |= named.unsure
            whole.either |= named.either if len(named.either) > 1 else set()
            is_stated |= bool(named.yes) and (named.told or _is_headed(sentence, self._names))
        chosen = whole.yes | whole.unsure
        if len(chosen) > 1 and (taken_back := afterthoughts(plain)) is not None:
            other = self._names.named(_SIGNS.sub("", taken_back[1]))
            if taken_back[0].startswith(_STRONG_SIGNS) and other.bare and len(other.yes) == 1:
                return other.yes, False, plain.strip()
        if len(chosen) > 1 or whole.unsure or (whole.either and not chosen):
            return chosen or whole.either, True, plain.strip()
        doubts = _UNSURE.search(self._names_removed(plain))
        if not chosen or not is_stated or doubts:
            return set(), False, plain.strip()
        again = afterthoughts(plain)
        if again is not None and not again[0].startswith(("actually", "sorry", "no")):
            rest = self._names.named(again[1])
            if not rest.yes:
                return set(), False, plain.strip()
        return chosen, False, plain.strip()

    def _names_removed(self, plain: str) -> str:
        """Return a text without the options in it, which may hold any words."""
        for option in self._options:
            words = re.escape(plain_words(option).strip().casefold())
            plain = re.sub(words, " ", plain.casefold())
        return plain

    def _without_echo(self, text: str) -> str:
        """Return a text without a list of all options in their order, which repeats the prompt."""
        lines = text.split("\n")
        filled = [number for number, line in enumerate(lines) if line.strip()]
        count = len(self._options)
        for at in range(len(filled) - count + 1):
            run = filled[at : at + count]
            if count > 1 and all(
                self._lists(lines[number], option) for option, number in enumerate(run)
            ):
                # A list alone answers nothing, but must not look like an answer.
                for number in run:
                    lines[number] = ""
        return "\n".join(lines)

    def _lists(self, line: str, option: int) -> bool:
        plain = plain_words(line).strip()
        named = self._names.named(plain)
        return named.bare and named.yes == {option}


def _concluded(sentence: str, names: Names) -> str:
    """Return the part of a sentence after its `so` or `therefore`, if that names something."""
    parts = re.split(
        r"[,;]\s*(?:and\s+)?(?:so|therefore|thus|hence)\b(?!\s+that)"
        r"|\b(?:so|therefore|thus|hence)\s+(?=(?:he|she|they|it|i|we)\b)",
        sentence,
        flags=re.IGNORECASE,
    )
    last = parts[-1].strip(" ,")
    return last if len(parts) > 1 and names.named(last).yes else sentence


def _is_headed(sentence: str, names: Names) -> bool:
    """Return True if a sentence begins with an option alone, before its grounds."""
    head = re.split(
        r"[,;:(\u2014\u2013]|\s-\s|\b(?:because|since|as|although|though|while|when|where|after"
        r"|before|even|given|due)\b",
        sentence,
    )[0]
    named = names.named(head)
    return named.bare and bool(named.yes)


def read_words(text: str, finish: Finish = "stop") -> AnswerReading:
    """Read an answer in words: the last statement, or the whole text if it is one line.

    Returns:
        Reading without an option; `said` is the answer.
    """
    reading = read_answer(text, (), finish)
    if reading.outcome == "cut" or reading.refused or not text.strip():
        return reading
    said = separate_thinking(text)
    if said.open or not said.text.strip():
        return reading
    marked = [each for each in statements(unfenced(said.text)) if each.kind == "mark"]
    lines = [line for line in unfenced(said.text).split("\n") if line.strip()]
    answer = marked[-1].text if marked else lines[0] if len(lines) == 1 else ""
    answer = answer.strip(" \t\n*_`\"'\u201c\u201d\u2018\u2019").rstrip(".").strip("*_` ")
    if not plain_words(answer).strip():
        reason = f"it states no answer: {excerpt(said.text.strip())}"
        return AnswerReading(None, "unread", reason, said.thinking)
    return AnswerReading(None, "read", "", said.thinking, answer)


@dataclass(slots=True)
class NamedInWords(NamedOptions):
    """Names in an answer in words.

    Attributes:
        alternative: True if the answer offers an alternative, also an unknown one: `or`.
    """

    alternative: bool = False


def named_in_words(answer: str, options: Sequence[str]) -> NamedInWords:
    """Return which known names an answer in words of a model or a person names, and which not.

    A name counts as whole words, in any case; a longer name before a shorter one within it. The
    part that tells two names apart is enough: `blue` for `blue box` beside `red box`. What
    follows `not` is ruled out.

    Args:
        answer: The answer.
        options: Names, right and wrong ones.
    """
    names = Names(options, lettered=False)
    named_words = NamedInWords()
    plain = plain_words(answer)
    for sentence in sentences(plain):
        named = names.named(_concluded(sentence, names))
        named_words.yes |= named.yes
        named_words.no |= named.no
        named_words.unsure |= named.unsure
        named_words.aside |= named.aside
        offered = re.search(r"\bor\b|\beither\b|\w\s*/\s*\w", names.without(sentence))
        named_words.alternative |= bool(named.yes) and offered is not None
    if len(named_words.yes) > 1:
        named_words.alternative = False
    return named_words
