"""Extraction of the program from a model's answer."""

import re

from beliefnest.errors import ModelError
from beliefnest.llm.failures import excerpt

__all__ = ["NoProgramError", "extract_program"]

_FENCE = re.compile(r"^[ \t]*(```+|~~~+)[ \t]*([\w+-]*)[^\n]*$", re.MULTILINE)
_JAVASCRIPT = frozenset({"javascript", "js", "mjs", "node", "jsx", "ecmascript"})
_CODE_START = re.compile(
    r"(?:await|async|const|let|var|for|while|if|try|return|function|throw|switch|do)\b"
    r"|//|/\*|\{|[A-Za-z_$][\w$]*(?:\.[\w$]+)*\s*(?:\(|=)"
)
_CODE_END = re.compile(r"[;})]\s*(?://[^\n]*)?\Z")


class NoProgramError(ModelError):
    """An answer contains no program."""


def extract_program(answer: str) -> str:
    """Return the program in an answer: the content of a fenced block, or a bare program.

    If there are several blocks, take the last one marked as JavaScript, else the last one
    without a mark: models that correct themselves write the correction last.

    Raises:
        NoProgramError: There is no program, or its block is not closed.
    """
    blocks = _blocks(answer)
    for wanted in (_JAVASCRIPT, frozenset({""})):
        programs = [code for language, code in blocks if language in wanted]
        if programs:
            return _not_blank(programs[-1], answer)
    text = answer.strip()
    if not blocks and _CODE_START.match(text) and _CODE_END.search(text):
        return text
    raise NoProgramError(_reason(answer, blocks))


def _blocks(answer: str) -> list[tuple[str, str]]:
    """Return the language and the content of every fenced block.

    Raises:
        NoProgramError: The last block is not closed, so its content is incomplete.
    """
    blocks: list[tuple[str, str]] = []
    opening: re.Match[str] | None = None
    for fence in _FENCE.finditer(answer):
        if opening is None:
            opening = fence
        elif fence[1].startswith(opening[1]) and not fence[2]:
            content = answer[opening.end() : fence.start()].strip("\n")
            blocks.append((opening[2].lower(), content))
            opening = None
    if opening is not None:
        raise NoProgramError(
            f"the answer's code block is not closed, so it is cut off: {excerpt(answer)}"
        )
    return blocks


def _not_blank(program: str, answer: str) -> str:
    if not program.strip():
        raise NoProgramError(f"the answer's code block is empty: {excerpt(answer)}")
    return program


def _reason(answer: str, blocks: list[tuple[str, str]]) -> str:
    if not answer.strip():
        return "the answer is empty"
    if blocks:
        languages = ", ".join(sorted({language for language, _ in blocks}))
        return f"the answer holds code in {languages} and none in JavaScript: {excerpt(answer)}"
    return f"the answer holds no program: {excerpt(answer)}"
