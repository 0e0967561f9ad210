"""Prompt templates: named Jinja2 texts, built-in or from files."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from pathlib import Path
from types import MappingProxyType

from beliefnest.errors import TemplateError
from beliefnest.files import read_regular_text
from beliefnest.world.texts import quoted

BUILT_IN_TEMPLATES: Mapping[str, str] = MappingProxyType(
    {
        "answering": "the system message for questions: the form of the answer",
        "default": "a complete prompt for a program, with everything that the simulator believes",
        "instructions": "the part of `default` about the form of the answer, a system message",
        "paper": "the prompt of the paper's appendix; for programs if no template is named",
        "question": "a question and what its mind observed, as a table; for questions if no "
        "template is named",
        "story": "a question or task after what its mind observed, as prose in the past tense",
    }
)
"""Descriptions of the built-in templates, by name."""


@dataclass(frozen=True, slots=True)
class Template:
    """A prompt template.

    Attributes:
        name: Name in messages: that of a built-in template, or a file.
        text: Jinja2 source.
    """

    name: str
    text: str


@cache
def built_in_template(name: str) -> Template:
    """Return a built-in template; each is read once.

    Raises:
        TemplateError: There is no built-in template of that name.
    """
    if name not in BUILT_IN_TEMPLATES:
        raise TemplateError(
            f"there is no built-in template {quoted(name)}; there are "
            f"{', '.join(BUILT_IN_TEMPLATES)}"
        )
    source = files("beliefnest.prompts") / "texts" / f"{name}.txt"
    return Template(name, source.read_text(encoding="utf-8"))


def load_template(path: Path) -> Template:
    """Load a template from a UTF-8 file.

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
