"""Reader of programs: the JavaScript in an answer, or the reason why there is none."""

import itertools
import re
from collections.abc import Iterator
from dataclasses import dataclass

import msgspec

from beliefnest.llm.failures import excerpt
from beliefnest.llm.messages import Finish
from beliefnest.llm.reading_answers import ReadingOutcome, ReadOutcome, is_refusal, withheld
from beliefnest.llm.thinking import separate_thinking
from beliefnest.skills.javascript import parsed

PLACEHOLDER = "// the body of an async function"
"""Comment in place of a program in our instructions."""


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


_OPENING = re.compile(r"(?P<fence>`{3,}|~{3,})[ \t]*(?P<info>[^\n`]*)")
_JAVASCRIPT = _words(
    "javascript js mjs cjs node nodejs jsx ecmascript typescript ts tsx mineflayer program code "
    "javascript-program es6 es2020 async"
)
_OTHER = _words(
    "python py python3 json json5 yaml yml bash sh shell console text txt plaintext plain "
    "output html xml css java c cpp c++ csharp cs rust go ruby rb php sql lua toml ini markdown "
    "md diff log error math latex kotlin swift r perl csv"
)
_CODE_START = re.compile(
    r"(?:await|async|const|let|var|for|while|if|try|return|function|throw|switch|do)\b"
    r"|//|/\*|\{|[A-Za-z_$][\w$]*(?:\.[\w$]+)*\s*(?:\(|=)"
)
_CODE_END = re.compile(r"[;})]\s*(?://[^\n]*)?\Z")
_CODE_TAG = re.compile(
    r"<(?P<end>/?)(?P<name>program|code|answer|javascript|script)\b[^<>\n]{0,40}>", re.IGNORECASE
)
_FENCE_LINE = re.compile(r"^[ \t>]*(?:`{3,}|~{3,})", re.MULTILINE)
_ANNOUNCING = (":", "\uff1a", "-", "=", ">")
"""Ends of lines that announce a block."""
_QUOTE = re.compile(r"^[ \t]*> ?", re.MULTILINE)
_NO_CODE = "###"
"""Text that is valid in a template literal only."""
_MOST_BLOCKS = 100
_MOST_FENCES = 20
"""Greatest number of fences that are tried as the end of one block."""
_TASK_LINES = re.compile(
    r"^(?:Task: |Code from the last round:|Error from the last round:|<Information>)", re.MULTILINE
)


@dataclass(frozen=True, slots=True)
class ProgramReading(ReadingOutcome):
    """Result of reading a program.

    Attributes:
        program: JavaScript source; None: there is no program.
        outcome: `read`, `ambiguous`, `unread` or `cut`.
        reason: Why there is no program; empty: there is one.
        thinking: What the model thought before it answered.
        refused: True if the model would not answer.
    """

    program: str | None
    outcome: ReadOutcome
    reason: str = ""
    thinking: str = ""
    refused: bool = False


class _Block(msgspec.Struct, frozen=True):
    """Fenced block.

    Attributes:
        language: Word behind the fence, in lower case; empty: none.
        code: Content.
        closed: True if the block has an end.
    """

    language: str
    code: str
    closed: bool


def read_program(text: str, finish: Finish = "stop") -> ProgramReading:  # noqa: PLR0911
    """Read the program of an answer.

    It is the content of a fenced block: of several, the last one marked as JavaScript (or with
    any word that is not another language), else the last one without a mark. Models that correct
    themselves write the correction last; of two alternatives the last one counts as well. A fence
    within a text of the program does not end it. An answer that is code as a whole is a program.
    Thinking holds no program, and neither do repeated instructions and their placeholder.

    An answer that a limit cut off (`finish` is `length`) is always `cut`.

    Args:
        text: Complete text of the answer.
        finish: Reason for the end of the answer.
    """
    said = separate_thinking(text)

    def without(reason: str, *, refused: bool = False) -> ProgramReading:
        return ProgramReading(None, "unread", reason, said.thinking, refused)

    if finish == "length":
        return ProgramReading(None, "cut", "a limit cut the answer off", said.thinking)
    if finish == "content_filter":
        return without(withheld(said.text), refused=True)
    if said.open:
        return without("the answer is a thought without an end")
    if not said.text.strip():
        return without("the answer is only thinking" if said.thinking else "the answer is empty")
    blocks = list(itertools.islice(_blocks(said.text), _MOST_BLOCKS))
    chosen = _chosen(blocks)
    if chosen is not None:
        return _of_block(chosen, said.text, said.thinking)
    bare = _bare_program(said.text)
    if bare is not None and not blocks:
        return ProgramReading(bare, "read", "", said.thinking)
    shown = excerpt(said.text.strip())
    if blocks:
        languages = ", ".join(sorted({each.language or "no language" for each in blocks}))
        return without(f"the answer holds code in {languages} and none in JavaScript: {shown}")
    if PLACEHOLDER in said.text or len(_TASK_LINES.findall(said.text)) > 1:
        return without(f"the answer repeats the prompt: {shown}")
    if is_refusal(said.text):
        return without(f"the model refused: {shown}", refused=True)
    return without(f"the answer holds no program: {shown}")


def _chosen(blocks: list[_Block]) -> _Block | None:
    javascript = [each for each in blocks if each.language in _JAVASCRIPT]
    named = [each for each in blocks if each.language and each.language not in _OTHER]
    plain = [each for each in blocks if not each.language]
    for some in (javascript, named, plain):
        real = [each for each in some if not _is_placeholder(each.code)]
        if real:
            return real[-1]
    placeholders = [each for each in (*plain, *named, *javascript) if _is_placeholder(each.code)]
    return placeholders[-1] if placeholders else None


def _of_block(block: _Block, text: str, thinking: str) -> ProgramReading:
    shown = excerpt(text.strip())
    code = block.code
    reason = ""
    if not code.strip():
        reason = f"the answer's code block is empty: {shown}"
    elif _is_placeholder(code):
        reason = f"the program is the placeholder of the instructions: {shown}"
    elif not _has_code(code):
        reason = f"the program holds comments only: {shown}"
    elif not block.closed and not _is_whole(code):
        reason = f"the answer's code block is not closed, and its program has no end: {shown}"
    if reason:
        return ProgramReading(None, "unread", reason, thinking)
    return ProgramReading(code, "read", "", thinking)


def _is_placeholder(code: str) -> bool:
    lines = [line.strip() for line in code.strip().splitlines()]
    return lines == [PLACEHOLDER]


def _blocks(text: str) -> Iterator[_Block]:
    """Yield the fenced blocks of a text, and programs in tags."""
    at = 0
    has_fence = False
    while opening := _next_opening(text, at):
        has_fence = True
        fence = opening["fence"]
        info = opening["info"].strip()
        language = re.split(r"[\s,{:;]", info, maxsplit=1)[0].lower() if info else ""
        start = opening.end()
        code_on_line = _on_one_line(text, start, info)
        if code_on_line is not None:
            language, code, at = code_on_line
            yield _Block(language, code, closed=True)
            continue
        end, at = _end_of_block(text, start, fence, language)
        code = text[start : at if end is None else end]
        if text[: opening.start()].rsplit("\n", 1)[-1].strip() == ">":
            code = _QUOTE.sub("", code)
        yield _Block(language, code.strip("\n"), closed=end is not None)
    if not has_fence:
        yield from _tagged(text)


def _tagged(text: str) -> Iterator[_Block]:
    """Yield the programs in tags, from each opening tag to the next closing one of its name."""
    closing: dict[str, re.Match[str]] = {}
    pairs: list[tuple[re.Match[str], re.Match[str]]] = []
    for tag in reversed(list(_CODE_TAG.finditer(text))):
        name = tag["name"].lower()
        if tag["end"]:
            closing[name] = tag
        elif name in closing:
            pairs.append((tag, closing[name]))
    at = 0
    for tag, end in reversed(pairs):
        if tag.start() < at:
            continue
        at = end.end()
        code = text[tag.end() : end.start()].strip("\n")
        if code.lstrip().startswith("<"):
            yield from _tagged(code)
        elif tag["name"].lower() in ("program", "javascript", "script") or _is_whole(code):
            yield _Block("javascript", code, closed=True)


def _next_opening(text: str, at: int) -> re.Match[str] | None:
    """Return the next opening fence: on a line of its own, or behind words such as `Program:`."""
    for opening in _OPENING.finditer(text, at):
        line = text[text.rfind("\n", 0, opening.start()) + 1 : opening.start()]
        # Three backticks in the middle of a sentence are quoted code, not a block.
        if not line.strip(" \t>*#.-0123456789") or line.rstrip().endswith(_ANNOUNCING):
            return opening
    return None


def _on_one_line(text: str, start: int, info: str) -> tuple[str, str, int] | None:
    """Return language, code and end of a block whose code begins on the line of its fence."""
    line_end = text.find("\n", start)
    line_end = len(text) if line_end < 0 else line_end
    closing = re.search(r"`{3,}|~{3,}", text[start:line_end])
    if closing is None:
        return None
    words = (info + text[start : start + closing.start()]).strip()
    first, _, rest = words.partition(" ")
    if first.lower() in _JAVASCRIPT | _OTHER and rest:
        return first.lower(), rest.strip(), start + closing.end()
    return "", words, start + closing.end()


def _end_of_block(text: str, start: int, fence: str, language: str) -> tuple[int | None, int]:
    """Return the end of a block's code, None if it has none, and the place behind its fence.

    Of several fences that could close it, the first one does behind which the code is JavaScript
    without an error, if fences in it are texts: a fence within a template literal is a part of the
    program. If there is none, the first fence closes the block, unless another block begins
    before it.
    """
    fences = re.compile(
        rf"(?P<lead>^[ \t>]*)?{re.escape(fence[0])}{{{len(fence)},}}(?P<rest>[^\n]*)$", re.MULTILINE
    )
    first: tuple[int | None, int] | None = None
    for match in itertools.islice(fences.finditer(text, start), _MOST_FENCES):
        end, behind = match.start(), match.end() - len(match["rest"])
        if match["lead"] is not None and match["rest"].strip():
            first = first or (None, end)
            continue
        first = first or (end, behind)
        if language in _OTHER:
            break
        if _is_whole(_FENCE_LINE.sub(_NO_CODE, text[start:end])):
            return end, behind
    return first or (None, len(text))


def _is_whole(code: str) -> bool:
    """Return True if code is JavaScript without an error, and with an end."""
    return bool(code.strip()) and not parsed(code.encode()).has_error


def _has_code(code: str) -> bool:
    """Return True if code has more than comments."""
    return any(child.type != "comment" for child in parsed(code.encode()).children)


def _bare_program(text: str) -> str | None:
    """Return a text that is code as a whole; None: it is not."""
    code = text.strip()
    if not (_CODE_START.match(code) and _CODE_END.search(code) and _is_whole(code)):
        return None
    return None if _is_placeholder(code) or not _has_code(code) else code
