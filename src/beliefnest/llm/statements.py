"""Statements of an answer in a text: behind marks such as `Answer:`, in JSON, on lines alone."""

import ast
import json
import re
from bisect import bisect_left
from collections.abc import Iterator
from typing import Any, Literal

import msgspec

from beliefnest.llm.naming import plain_words

StatementKind = Literal["mark", "line", "prose"]

_SPACE = r"(?:[^\w\n]|_)"
_NOUN = (
    r"(?:answer|ans|choice|response|selection|conclusion|verdict|result|prediction|solution"
    r"|decision|option|pick|guess)"
)
_LEAD = (
    r"(?:(?:so|thus|therefore|hence|then|ok|okay|well|now|and|finally|overall|in short|in summary"
    r"|in conclusion|to conclude|my|the|your|his|her|a|an|this|final|correct|best|right|short"
    r"|direct|full|most likely|likely|chosen|selected|official|actual|predicted|probable"
    rf"|step \d+|question \d+|q\d+|\d+|[^\W\d_]{{3,20}}'s){_SPACE}+)*"
)
_TO = r"(?:\s+(?:to|for|of|here|based on|according to|given|after)\b[^:.?!\n]{0,100}?)?"
_SEPARATOR = (
    rf"(?:{_SPACE}*?(?:\bis\b|\bwould be\b|\bshould be\b|\bmust be\b|\bwill be\b|[:=>~\u2013\u2014]"
    r"|-{1,2}(?=\s|>))(?:\s*[:=>])*)"
)
_MARK = re.compile(
    rf"^{_SPACE}*{_LEAD}{_NOUN}s?{_TO}"
    rf"(?:(?:{_SPACE}*\([^()\n]{{0,30}}\))?{_SEPARATOR}(?P<rest>.*)|{_SPACE}*$)",
    re.IGNORECASE,
)
_SIMPLE = re.compile(
    rf"^{_SPACE}*{_LEAD}answer{_SPACE}+(?P<rest>[(\[]?[A-Z][)\].]?{_SPACE}*)$", re.IGNORECASE
)
_INLINE = re.compile(
    r"\b(?:final |my |the |correct )*(?:answer|conclusion|choice)[\s*_`\"']{0,4}[:=]"
    r"(?P<rest>[^\n]*)",
    re.IGNORECASE,
)
_PROSE = re.compile(
    rf"\b(?:{_NOUN}{_TO}\s+(?:is|would be|must be|should be|will be|has to be)"
    r"|(?:i|we)(?:\s+(?:would|will|'d|'ll|must|have to|am going to))?\s+"
    r"(?:choose|chose|pick|select|go with|going with|opt for|vote for|answer|conclude|say)"
    r"|(?:i|we)'(?:d|ll)\s+(?:choose|pick|select|go with|opt for|vote for|answer|say))\b"
    r"(?!\s+(?:right|correct|wrong|based|clear|not clear|obvious|simple|given|explained))"
    r"(?P<rest>[^\n]*)",
    re.IGNORECASE,
)
_POST = re.compile(
    r"\s+(?:is|must be|should be|=)\s+"
    r"(?:(?:the|my)\s+(?:final |correct |right |best )*(?:answer|choice|option|one)"
    r"|correct|right)\b(?!\s+(?:box|chest|room|barrel))",
    re.IGNORECASE,
)
_SO = re.compile(
    r"(?:^|[.!?;:,]\s+|\n\s*)(?:so|therefore|thus|hence|consequently|accordingly|as a result"
    r"|in conclusion|to conclude|conclusion|that is why|that's why|this means|which means"
    r"|in short|in summary|overall)\b(?!\s+(?:far|that|much|many|early|late|long|quickly))"
    r"[,:]?(?P<rest>[^\n]*)",
    re.IGNORECASE,
)
_CONDITION = re.compile(r"\b(?:if|unless|whether|had (?:he|she|they|it)|suppos)", re.IGNORECASE)
_BOXED = re.compile(r"\\(?:boxed|fbox|framebox)\s*")
_TAG = re.compile(
    r"<\s*(?P<name>(?:final[_ -]?)?answer|final|ans|choice|response|output|result|solution|option)"
    r"\b[^<>\n]{0,60}>(?P<rest>.*?)(?:<\s*/\s*(?P=name)\s*>|$)",
    re.IGNORECASE | re.DOTALL,
)
_CHECKED = re.compile(
    rf"^{_SPACE}*?(?:\[[xX\u2713\u2714]\]|\u2611|\u2705|\u2714)(?P<rest>.*)", re.IGNORECASE
)
_UNCHECKED = re.compile(r"^\s*(?:[-*]\s*)?(?:\[ ?\]|\u2610|\u274c)")
_VERDICT = re.compile(
    r"\W*(?:right|correct|wrong|incorrect|clear|obvious|simple|easy)\b\W*$", re.IGNORECASE
)
"""Rest of sentences such as `the answer is clear`, which is no answer."""
_FENCE = re.compile(r"^\s*(?:`{3,}|~{3,})[^\n`]*$", re.MULTILINE)
_REASON_LINE = re.compile(
    rf"^{_SPACE}*(?:my |the |brief |short )*(?:reason|reasons|reasoning|explanation|rationale"
    rf"|justification|because|why|note|evidence|analysis|thought|thoughts|confidence)"
    rf"{_SPACE}*?(?::|=|\u2014)",
    re.IGNORECASE,
)
_REASON = re.compile(
    r"^[ \t>*_#-]*reason[ \t*_]*:[ \t*_]*(.*)", re.IGNORECASE | re.MULTILINE | re.DOTALL
)
_MADE_UP = re.compile(
    r"^\s*[#>*_ ]*(?:question|q|user|human|task|story|example|input|problem)"
    r"\s*\d*[*_ ]*(?::|\n|$)|^\s*---+\s*$",
    re.IGNORECASE,
)
_KEYS = (
    "answer", "finalanswer", "final", "choice", "option", "selected", "selection", "response",
    "result", "prediction", "selectedoption", "chosen", "correctanswer", "correctoption",
    "myanswer", "output", "decision", "label", "chosenoption", "selectedanswer", "location",
    "place", "letter", "value", "text", "name", "id", "key",
)  # fmt: skip
_INNER = ("answer", "option", "choice", "letter", "label", "text", "value", "name", "id", "key")
_LONGEST_LINE = 2000
_LONGEST_PARAGRAPH = 10_000
_MOST_TURNS = 20
_GAP = re.compile(r"\s{2,}")
_AFTER = re.compile(
    r"(?:[.!?;>\n\u2014)-]\s*|\s-\s|,\s+(?=no,|no wait|wait))"
    r"(?P<sign>wait|hold on|no,|no\.|no wait|correction|scratch that|"
    r"on second thoughts?|hmm+|sorry|i mean|or rather|oops|my mistake|let me (?:re|correct|think)|"
    r"actually|on reflection|i was wrong|that is wrong|that's wrong|or maybe|or perhaps|"
    r"alternatively|never mind|strike that|i take that back|i change my mind|edit:|or:)"
    r"(?P<rest>[^\n]*(?:\n.*)?)",
    re.IGNORECASE | re.DOTALL,
)


class Statement(msgspec.Struct, frozen=True):
    """Statement of an answer.

    Attributes:
        start: Place in the text.
        end: End of it, exclusive.
        text: The statement; it may be empty.
        kind: `mark`: a mark announces it. `line`: it is a line alone. `prose`: a sentence implies
            it.
        alone: True if the statement is one structured value, with nothing else around it.
    """

    start: int
    end: int
    text: str
    kind: StatementKind = "mark"
    alone: bool = False


def statements(text: str) -> list[Statement]:
    """Return all statements of a text, in their order; later ones count more."""
    candidates = [*_boxed(text), *_tagged(text), *_json(text), *_lines(text), *_sentences(text)]
    # A mark inside of another one's value is that value.
    candidates.sort(key=lambda each: (each.start, -each.end))
    kept: list[Statement] = []
    for each in candidates:
        # No kept statement lies within another one, so their ends are sorted as well.
        outer = bisect_left(kept, each.end, key=lambda k: k.end)
        if outer == len(kept):
            kept.append(each)
        elif each.alone and not kept[outer].alone:
            kept[outer] = each
    return sorted(kept, key=lambda each: each.start)


def _boxed(text: str) -> Iterator[Statement]:
    at = 0
    while box := _BOXED.search(text, at):
        depth, at = 0, box.end()
        while at < len(text):
            depth += (text[at] == "{") - (text[at] == "}")
            at += 1
            if depth <= 0:
                break
        yield Statement(box.start(), at, text[box.end() : at], alone=True)


def _tagged(text: str) -> Iterator[Statement]:
    for tag in _TAG.finditer(text):
        yield Statement(tag.start(), tag.end(), tag["rest"], alone=True)


def _json(text: str) -> Iterator[Statement]:
    """Yield the answers in JSON objects, also nested ones."""
    at = 0
    for _ in range(200):
        at = text.find("{", at)
        if at < 0:
            return
        value, end = _object_at(text, at)
        if value is None:
            at += 1
            continue
        answers = list(_answers_in(value))
        if answers:
            yield Statement(at, end, " ; ".join(answers), alone=True)
        at = end


def _object_at(text: str, at: int) -> tuple[dict[str, Any] | None, int]:
    try:
        value, end = json.JSONDecoder(strict=False).raw_decode(text, at)
        return (value, end) if isinstance(value, dict) else (None, at)
    except (ValueError, RecursionError):
        pass
    end = text.find("}", at) + 1
    part = text[at:end]
    if not end or len(part) > _LONGEST_LINE:
        return None, at
    try:
        value = ast.literal_eval(re.sub(r",\s*}", "}", part))
    except (ValueError, SyntaxError, RecursionError, MemoryError):
        quoted = re.fullmatch(
            r"\{\s*[\"']?(\w+)[\"']?\s*:\s*[\"']?([^\"'{}:,]+)[\"']?\s*,?\s*\}", part
        )
        return ({quoted[1]: quoted[2]}, end) if quoted else (None, at)
    return (value, end) if isinstance(value, dict) else (None, at)


def _answers_in(value: dict[Any, Any]) -> Iterator[str]:
    keys = {re.sub(r"[\W_]", "", str(key)).lower(): key for key in value}
    strong = [key for key in _KEYS if key in keys]
    for key in strong[:1]:
        yield from _values(value[keys[key]])
        # A letter beside a text names the same option, or makes the answer ambiguous.
        if key in _INNER:
            for other in _INNER:
                if other in keys and other != key:
                    yield from _values(value[keys[other]])
    if not strong:
        for inner in value.values():
            if isinstance(inner, dict):
                yield from _answers_in(inner)


def _values(value: Any) -> Iterator[str]:
    match value:
        case bool() | None:
            return
        case str() | int() | float():
            yield str(value)
        case list():
            for each in value:
                yield from _values(each)
        case dict():
            answers = list(_answers_in(value))
            yield from answers or (str(each) for each in value.values() if isinstance(each, str))


def _lines(text: str) -> Iterator[Statement]:
    """Yield what stands behind marks on lines, and in the paragraph after a mark alone."""
    at = 0
    for line in text.split("\n"):
        start, at = at, at + len(line) + 1
        short = line[:_LONGEST_LINE]
        mark = _MARK.match(short) or _SIMPLE.match(short)
        if mark is None:
            checked = _CHECKED.match(short)
            if checked:
                yield Statement(start, start + len(line), checked["rest"])
            else:
                for inline in _INLINE.finditer(short):
                    yield Statement(start + inline.start(), start + len(line), inline["rest"])
            continue
        rest = mark["rest"] or ""
        if _VERDICT.match(rest) and not re.search(r"[:=]", short[: mark.start("rest")]):
            continue
        if re.search(r"\w", rest):
            yield Statement(start, start + len(line), rest)
            continue
        behind = text[at : at + _LONGEST_PARAGRAPH]
        following = behind.lstrip("\n \t")
        skipped = len(behind) - len(following)
        following = re.sub(r"\A(?:`{3,}|~{3,})[^\n]*\n", "", following)
        paragraph = re.split(r"\n\s*\n|\n\s*(?:`{3,}|~{3,})", following, maxsplit=1)[0]
        paragraph = _until_reason(paragraph)
        end = at + skipped + len(paragraph)
        yield Statement(start, min(end, len(text)), paragraph)


def _until_reason(paragraph: str) -> str:
    lines = paragraph.split("\n")
    for number, line in enumerate(lines[1:], 1):
        if _REASON_LINE.match(line) or _MARK.match(line[:_LONGEST_LINE]):
            return "\n".join(lines[:number])
    return paragraph


def _sentences(text: str) -> Iterator[Statement]:
    """Yield statements that sentences imply, outside of reasons."""
    at = 0
    for line in text.split("\n"):
        start, at = at, at + len(line) + 1
        if _REASON_LINE.match(line):
            continue
        short = line[:_LONGEST_LINE]
        for pattern in (_PROSE, _SO):
            for match in pattern.finditer(short):
                sentence = _first_sentence(match["rest"])
                whole = _last_sentence(short[: match.start("rest")]) + sentence
                if not (sentence.rstrip().endswith("?") or _CONDITION.search(whole)):
                    end = start + match.start("rest") + len(sentence)
                    yield Statement(start + match.start(), end, sentence, "prose")
        clause = 0
        for match in _POST.finditer(short):
            clause = max(clause, *(short.rfind(mark, 0, match.start()) + 1 for mark in ".!?;,"))
            rest = short[clause : match.start()]
            whole = _last_sentence(short[: match.end()]) + _first_sentence(short[match.end() :])
            if not _CONDITION.search(whole):
                yield Statement(start + clause, start + match.end(), rest, "prose")
            clause = match.end()


def _last_sentence(text: str) -> str:
    return re.split(r"(?<=[^\s(\[*]{2})[.!?]\s", text)[-1]


def _first_sentence(text: str) -> str:
    match = re.search(r"(?<=[^\s(\[*]{2})[.!?](?=\s|$)", text)
    return text if match is None else text[: match.end()]


def afterthoughts(text: str) -> tuple[str, str] | None:
    """Return the last sign that takes a statement back, and what follows it; None: no sign."""
    kept = "\n".join(
        line for line in text.split("\n") if not _REASON_LINE.match(line[:_LONGEST_LINE])
    )
    afterthought = None
    at = 0
    while match := _AFTER.search(kept, at):
        afterthought = match["sign"].lower(), match["rest"]
        at = match.end("sign")
    return afterthought


def without_made_up_turns(text: str) -> list[str]:
    """Split a text before each of the first lines that begin another question or task."""
    parts: list[list[str]] = [[]]
    for line in text.split("\n"):
        is_turn = len(parts) <= _MOST_TURNS and _MADE_UP.match(line)
        if is_turn and any(each.strip() for each in parts[-1]):
            parts.append([])
        parts[-1].append(line)
    return ["\n".join(each) for each in parts]


def given_reason(text: str) -> str:
    """Return the text after the last `Reason:`; empty: there is none."""
    match = _REASON.search(text)
    return match[1].strip() if match else ""


def unfenced(text: str) -> str:
    """Return a text without lines of fences, unchecked lines of a list, and long gaps."""
    # A model that repeats itself writes gaps of any length, on which patterns would take hours.
    lines = _FENCE.sub("", _GAP.sub(_shorter, text)).split("\n")
    return "\n".join("" if _UNCHECKED.match(line) else line for line in lines)


def _shorter(gap: re.Match[str]) -> str:
    return "\n" * min(2, gap[0].count("\n")) or " "


def bare_lines(text: str) -> list[tuple[int, str]]:
    """Return the plain text of each line that is no reason, with its number."""
    return [
        (number, plain_words(line).strip())
        for number, line in enumerate(text.split("\n"))
        if line.strip() and not _REASON_LINE.match(line[:_LONGEST_LINE])
    ]
