"""Python code that playing a supplement again would run: policies, and functions that judge."""

import hashlib
from collections.abc import Iterable, Iterator

import msgspec

from beliefnest.errors import InputError
from beliefnest.importing import is_object_name, text_of_object
from beliefnest.scenarios.document import YamlNode
from beliefnest.world.texts import shortened


class Code(msgspec.Struct, frozen=True):
    """Code that would run.

    Attributes:
        name: Name of the object that would be imported.
        file: File of the code; empty: it is looked for on Python's path.
        lines: Number of lines; None: there is no text.
        digest: SHA-256 of the text; empty: there is none.
    """

    name: str
    file: str
    lines: int | None
    digest: str

    @property
    def text(self) -> str:
        """Return a line for people."""
        if self.lines is None:
            return f"{shortened(self.name)}: a module on Python's path"
        where = shortened(self.file or self.name)
        return f"{where}: {self.lines} lines, SHA-256 {self.digest}"


def code_of(name: str, file: str = "", shown: str = "") -> Code:
    """Return the code behind the name of a Python object.

    Args:
        name: Name, as for `importing.imported_object`.
        file: File of the code as users know it.
        shown: Name to show; empty: `name`.

    Raises:
        InputError: The file cannot be read.
    """
    text = text_of_object(name)
    digest = hashlib.sha256(text.encode()).hexdigest() if text else ""
    return Code(shown or name, file, len(text.splitlines()) if text else None, digest)


def functions_in(node: YamlNode) -> Iterator[str]:
    """Yield the names of Python functions that a scenario names: values of the key `function`."""
    if isinstance(node.value, dict):
        for key, child in node.value.items():
            if key == "function" and isinstance(child.value, str) and is_object_name(child.value):
                yield child.value
            yield from functions_in(child)
    elif isinstance(node.value, list):
        for child in node.value:
            yield from functions_in(child)


def check_trust(codes: Iterable[Code], *, trust: bool) -> None:
    """Refuse to run code of others without trust.

    Raises:
        InputError: There is code, and `trust` is False; the message lists it.
    """
    texts = sorted({code.text for code in codes})
    if texts and not trust:
        raise InputError(
            f"playing this again would run Python code of its makers: {'; '.join(texts)}. Read it, "
            "and run it with --trust (trust=True in Python); nothing was run"
        )
