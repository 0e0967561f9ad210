"""Prompt templates: a text with a name that messages can quote, and the ones we ship."""

from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from pathlib import Path

from beliefnest.errors import TemplateError
from beliefnest.files import read_regular_text
from beliefnest.prompts.text import nearest

__all__ = ["BUILT_IN_TEMPLATES", "Template", "built_in_template", "load_template"]

BUILT_IN_TEMPLATES = ("answering", "default", "instructions", "paper", "question")
"""`default`: our own, complete; `instructions`: its part on how to answer, which serves as
a system message beside other templates; `paper`: the one of the paper's appendix; `question`: a
question and what is known, with `answering`, on how to answer one, as its system message."""


@dataclass(frozen=True, slots=True)
class Template:
    """A prompt template.

    Attributes:
        name: What messages call it: the name of a built-in one, or a file.
        text: Jinja2 source.
    """

    name: str
    text: str


@cache
def built_in_template(name: str) -> Template:
    """Return a template that comes with the package, which is read once.

    Raises:
        TemplateError: There is none of that name.
    """
    if name not in BUILT_IN_TEMPLATES:
        raise TemplateError(f"no built-in template {name!r}{nearest(name, BUILT_IN_TEMPLATES)}")
    source = files("beliefnest.prompts") / "texts" / f"{name}.txt"
    return Template(name, source.read_text(encoding="utf-8"))


def load_template(path: Path) -> Template:
    """Return a template from a file (UTF-8).

    Raises:
        TemplateError: The file cannot be read.
    """
    try:
        return Template(str(path), read_regular_text(path))
    except FileNotFoundError:
        raise TemplateError(
            f"there is no template file {path}; give a file, or the name of a built-in template: "
            f"{', '.join(BUILT_IN_TEMPLATES)}"
        ) from None
    except (OSError, UnicodeDecodeError) as error:
        raise TemplateError(f"template {path} cannot be read: {error}") from None
