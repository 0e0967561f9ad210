"""Sources of scenarios: the documents that are built in, and those in files."""

import re
from importlib.resources import files
from pathlib import Path

from msgspec.structs import replace

from beliefnest.errors import UnknownNameError
from beliefnest.scenarios.document import Document
from beliefnest.scenarios.yaml_reading import read_yaml
from beliefnest.world.texts import quoted

_SUFFIXES = (".yaml", ".yml")
_NOT_IN_NAMES = re.compile(r"[^A-Za-z0-9_-]+")
_LONGEST_NAME = 64


def scenario_name(text: str) -> str:
    """Return a text as a scenario's name; a name, of which a folder can be called, stays as it is.

    Other texts get `-` for the characters that names cannot have.
    """
    return _NOT_IN_NAMES.sub("-", text)[:_LONGEST_NAME] or "scenario"


def builtin_names() -> list[str]:
    """Return the names of the built-in scenarios."""
    folder = files("beliefnest.scenarios") / "builtin"
    names = (entry.name for entry in folder.iterdir())
    return sorted(name.removesuffix(".yaml") for name in names if name.endswith(".yaml"))


def builtin_file(name: str) -> Path:
    """Return the file of a built-in scenario."""
    return Path(str(files("beliefnest.scenarios") / "builtin")) / f"{name}.yaml"


def read_document(name_or_path: str) -> Document:
    """Return the document of a built-in scenario, or of one in a file.

    Raises:
        UnknownNameError: There is neither a built-in scenario nor a file of that name.
        ScenarioError: The file cannot be read, or is not a single YAML mapping.
    """
    names = builtin_names()
    if name_or_path in names:
        document = read_yaml(builtin_file(name_or_path))
        return replace(document, source=f"{name_or_path}.yaml")
    path = Path(name_or_path)
    looks_like_path = path.suffix in _SUFFIXES or len(path.parts) > 1
    if not path.name or (not looks_like_path and not path.exists()):
        raise UnknownNameError(
            f"there is no scenario {quoted(name_or_path)}; built in are {', '.join(names)}, "
            "or give the path of a .yaml file"
        )
    return read_yaml(path)
