"""Editor of a scenario file: `beliefnest serve FILE --edit`."""

import dataclasses
from pathlib import Path
from threading import Lock
from typing import Any

from msgspec.structs import replace

from beliefnest.cli.scenario_editing import drawn_starter, edited
from beliefnest.errors import BeliefNestError, InputError
from beliefnest.files import os_errors_of, read_regular_text, replace_file
from beliefnest.nest.face.nest import Nest
from beliefnest.scenarios.document import Document
from beliefnest.scenarios.scenario import Scenario
from beliefnest.scenarios.sources import builtin_names, scenario_name
from beliefnest.scenarios.yaml_reading import parse_yaml
from beliefnest.viewer.page.run import About, RunData
from beliefnest.world.registry import Registry
from beliefnest.world.texts import is_well_formed

_SUFFIXES = (".yaml", ".yml")
_LARGEST = 200_000
"""Greatest number of blocks of a scene that is edited."""


class FileEditor:
    """Editor of one scenario file, which need not exist before it is saved.

    Args:
        file: The file.

    Raises:
        InputError: The file is no YAML file, or cannot be read.
    """

    def __init__(self, file: Path) -> None:
        if file.suffix not in _SUFFIXES or str(file) in builtin_names():
            raise InputError(f"{file} cannot be edited; give a .yaml file, which may be new")
        self._file = file
        self._turn = Lock()
        self._saved = self._on_disk()
        if self._saved is None and not file.parent.is_dir():
            raise InputError(f"the folder of {file} does not exist; create it first")

    @property
    def title(self) -> str:
        """Name of the file."""
        return self._file.name

    def begin(self) -> dict[str, Any]:
        """Return the text of the file, and what the page needs before the first edit."""
        with self._turn:
            self._saved = self._on_disk()
            name = scenario_name(self._file.stem)
            text = drawn_starter(name) if self._saved is None else self._saved
        registry = Registry.load()
        return {
            "file": self._file.name,
            "is_new": self._saved is None,
            "text": text,
            "blocks": sorted(registry.block_names),
            "items": sorted(registry.item_names),
        }

    def shown(self, request: dict[str, Any]) -> dict[str, Any]:
        """Return the text after edits, with its scene or what is wrong with it.

        Args:
            request: `text`, `edits` (see `edited`), and `viewer`: the agent whose sight is shown,
                or None.

        Raises:
            InputError: The request has a wrong form.
        """
        text, edits, viewer = _text(request), request.get("edits", []), request.get("viewer")
        if not isinstance(edits, list) or not all(isinstance(each, dict) for each in edits):
            raise InputError("edits is no list of objects")
        if not isinstance(viewer, str | None):
            raise InputError("viewer is no name of an agent")
        try:
            for edit in edits:
                text = edited(text, edit)
        except BeliefNestError as error:
            return {"text": _text(request), "refused": str(error)}
        try:
            return {"text": text, "scene": self._scene(text, viewer)}
        except BeliefNestError as error:
            return {"text": text, "problem": str(error)}

    def save(self, request: dict[str, Any]) -> dict[str, Any]:
        """Write a text into the file, if no other program has changed it.

        Raises:
            InputError: Another program has changed the file, or it cannot be written.
        """
        text = _text(request)
        if not is_well_formed(text):
            raise InputError("the text has half a character in it; write whole ones")
        with self._turn:
            if self._on_disk() != self._saved:
                raise InputError(
                    f"{self._file} was changed by another program; copy your text and load anew"
                )
            with os_errors_of(self._file, "written"):
                replace_file(self._file, text)
            self._saved = text
        return {"saved": self._file.name}

    def _on_disk(self) -> str | None:
        """Return the text of the file; None if there is no file."""
        try:
            return read_regular_text(self._file)
        except FileNotFoundError:
            return None
        except (OSError, ValueError) as error:
            raise InputError(f"{self._file} cannot be read: {error}") from None

    def _scene(self, text: str, viewer: str | None) -> dict[str, Any]:
        """Return the first tick of a scenario as data of the page, and who sees what in it."""
        source = Scenario.varied(self._document(text), None)
        snapshot = source.setting.snapshot
        if snapshot.blocks.size > _LARGEST:
            raise InputError(
                f"the box has {snapshot.blocks.size:,} blocks; the editor shows up to "
                f"{_LARGEST:,}: edit the file as text, or a smaller box"
            )
        # Nobody joins here: people stand where the file puts them.
        alone = dataclasses.replace(source, setting=replace(source.setting, people=frozenset()))
        with Nest.open(alone, world="scripted") as nest:
            about = About(title=source.name, labels=source.labels)
            scene = RunData(nest.reader, about, 0).update()
            sees = {name: self._seen_by(nest, name) for name in nest.agents}
            seen = nest["/"].visible_blocks(viewer) if viewer in sees else None
        return {
            "run": scene,
            "sees": sees,
            "seen": None if seen is None else [int(each) for each in seen.ravel()],
            "drawn": "map" in self._document(text).root.value,
        }

    def _seen_by(self, nest: Nest, viewer: str) -> list[str]:
        """Return what an agent sees at the first tick: agents, and cells of containers."""
        box = nest.reader.setting.snapshot.box
        state, mask = nest[f"/{viewer}"].state, nest["/"].visible_blocks(viewer)
        names = nest.reader.agents
        seen_names = [
            f"agent-{names.index(name)}"
            for name, believed in state.agents.items()
            if name != viewer and believed.current
        ]
        _, height, depth = box.shape
        for place in nest.reader.setting.snapshot.containers:
            i, j, k = box.index(place)
            if mask[i, j, k]:
                seen_names.append(f"container-{(i * height + j) * depth + k}")
        return seen_names

    def _document(self, text: str) -> Document:
        # Templates of prompts that the file names stand beside it.
        return replace(parse_yaml(text, self._file.name), folder=self._file.parent)


def _text(request: dict[str, Any]) -> str:
    text = request.get("text")
    if not isinstance(text, str):
        raise InputError("the request lacks the text of the file")
    return text
