"""Check of how docstrings and JSDoc begin: with a verb in the imperative, or with a noun.

Usage: `python tools/openers.py [FOLDER ...]`; without folders, all sources of the project. The
check prints each comment that begins with a question word and ends with status 1 if there is one.
Ruff's D401 checks the verbs of Python functions; this check also covers modules, classes, fields
and JavaScript.
"""

import ast
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parent.parent
FOLDERS = ("src", "tests", "benchmarks", "packages", "tools", "examples")
SKIPPED = {"node_modules", "_bundle", "_page"}

QUESTION_WORD = re.compile(r"(What|Who|Whom|Whose|Where|Whether|How|That|Which|Why|When)\b")
JSDOC = re.compile(r"/\*\*(.*?)\*/", re.DOTALL)

EXCEPTIONS: dict[str, str] = {}
"""First lines that may begin so, each with the reason."""


class Opener(NamedTuple):
    """First line of a docstring or a JSDoc comment.

    Attributes:
        path: The file.
        line: Its line, from 1.
        text: The words.
    """

    path: Path
    line: int
    text: str

    @property
    def is_question(self) -> bool:
        """True if it begins with a question word and is no exception."""
        return QUESTION_WORD.match(self.text) is not None and self.text not in EXCEPTIONS


def python_openers(path: Path) -> Iterator[Opener]:
    """Yield the openers of all docstrings of a Python file, those of fields included."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        body = getattr(node, "body", None)
        if not isinstance(body, list):
            continue
        is_documented = isinstance(
            node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef
        )
        for place, statement in enumerate(body):
            is_field = place > 0 and isinstance(body[place - 1], ast.Assign | ast.AnnAssign)
            if (is_documented and place == 0) or is_field:
                match statement:
                    case ast.Expr(value=ast.Constant(value=str(text))):
                        yield Opener(path, statement.lineno, first_line(text))


def javascript_openers(path: Path) -> Iterator[Opener]:
    """Yield the openers of all JSDoc comments of a JavaScript file."""
    source = path.read_text(encoding="utf-8")
    for comment in JSDOC.finditer(source):
        line = source.count("\n", 0, comment.start()) + 1
        yield Opener(path, line, first_line(re.sub(r"^\s*\*", "", comment[1], flags=re.MULTILINE)))


def first_line(text: str) -> str:
    """Return the first line of a comment without the space around it."""
    return text.strip().partition("\n")[0].strip()


def openers(folder: Path) -> Iterator[Opener]:
    """Yield the openers of all sources in a folder."""
    for path in sorted(folder.rglob("*")):
        if SKIPPED.isdisjoint(path.parts):
            if path.suffix == ".py":
                yield from python_openers(path)
            elif path.suffix in {".js", ".mjs"}:
                yield from javascript_openers(path)


def main() -> int:
    """Print the comments that begin with a question word; return the exit status."""
    folders = [Path(name) for name in sys.argv[1:]] or [ROOT / name for name in FOLDERS]
    found = [opener for folder in folders for opener in openers(folder)]
    questions = [opener for opener in found if opener.is_question]
    for path, line, text in questions:
        sys.stdout.write(f"{path}:{line}: begins with a question word: {text}\n")
    sys.stdout.write(f"{len(questions)} of {len(found)} openers are question words\n")
    return 1 if questions else 0


if __name__ == "__main__":
    sys.exit(main())
