"""Kernels are compiled once for a user, wherever their sources are, and again when they change."""

import gc
import importlib.util
import os
import shutil
import subprocess
import sys

import numba
import numba.core.event
import pytest

from beliefnest.perception.compiling import KernelWarning, is_compiled, kernel_folder

STEPS = """
from beliefnest.perception.compiling import inlined

STEP = 2

@inlined
def more(number: int) -> int:
    return number + STEP
"""
KERNEL = """
from beliefnest.perception.compiling import {decorator}
from steps import more

@{decorator}
def twice(number: int) -> int:
    return 2 * more(number)
"""
PROCESS = """
import sys
import kernels
assert kernels.twice(19) == 42
print("numba.np.arraymath" in sys.modules)
"""


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    kept = tmp_path / "kept"
    monkeypatch.setattr(numba.config, "CACHE_DIR", os.fspath(kept))
    monkeypatch.setenv("NUMBA_CACHE_DIR", os.fspath(kept))
    return kept


def installed(place, decorator="compiled", step=2):
    place.mkdir()
    (place / "steps.py").write_text(STEPS.replace("2", str(step)))
    (place / "kernels.py").write_text(KERNEL.format(decorator=decorator))
    return place


def loaded(place, monkeypatch):
    for name in ("steps", "kernels"):
        spec = importlib.util.spec_from_file_location(name, place / f"{name}.py")
        module = importlib.util.module_from_spec(spec)
        monkeypatch.setitem(sys.modules, name, module)
        spec.loader.exec_module(module)
    return module.twice


def test_a_kernel_is_compiled_once_for_all_environments(tmp_path, folder, monkeypatch):
    first = loaded(installed(tmp_path / "first"), monkeypatch)
    assert not is_compiled(first)
    assert first(2) == 8
    assert is_compiled(first)
    assert kernel_folder(first) == folder / "beliefnest" / f"numba-{numba.__version__}"
    assert is_compiled(loaded(installed(tmp_path / "second"), monkeypatch))


def test_a_kernel_is_compiled_again_when_one_that_it_calls_changed(tmp_path, monkeypatch):
    first = loaded(installed(tmp_path / "first"), monkeypatch)
    assert first(2) == 8
    changed = loaded(installed(tmp_path / "second", step=3), monkeypatch)
    assert not is_compiled(changed)
    assert changed(2) == 10
    # The versions lie beside each other.
    assert is_compiled(loaded(tmp_path / "first", monkeypatch))
    assert is_compiled(loaded(tmp_path / "second", monkeypatch))


def test_a_kernel_that_stands_below_its_caller_counts(tmp_path, monkeypatch):
    below = KERNEL.replace("from steps import more\n", "")
    for number, step in enumerate((2, 3)):
        place = installed(tmp_path / str(number))
        code = STEPS.replace("2", str(step)).replace("from beliefnest", "\nfrom beliefnest")
        (place / "kernels.py").write_text(below.format(decorator="compiled") + code)
        kernel = loaded(place, monkeypatch)
        assert not is_compiled(kernel)
        assert kernel(2) == 2 * (2 + step)


def test_damaged_files_are_compiled_and_written_again(tmp_path, folder, monkeypatch):
    assert loaded(installed(tmp_path / "first"), monkeypatch)(2) == 8
    for content in (b"", b"no machine code", b"cbeliefnest.perception.codes\nNoSuchType\n."):
        for file in folder.rglob("*.nb?"):
            file.write_bytes(content)
        with pytest.warns(KernelWarning, match="damaged and are compiled again"):
            assert loaded(tmp_path / "first", monkeypatch)(2) == 8
        again = loaded(tmp_path / "first", monkeypatch)
        assert is_compiled(again)
        assert again(2) == 8


def test_kernels_work_where_no_folder_is_writable(tmp_path, folder, monkeypatch):
    # A file where the folder would be, since these tests may run as a user who can write anywhere.
    folder.write_bytes(b"")
    monkeypatch.setenv("HOME", os.fspath(folder))
    monkeypatch.setenv("XDG_CACHE_HOME", os.fspath(folder))
    place = installed(tmp_path / "first")
    (place / "__pycache__").write_bytes(b"")
    kernel = loaded(place, monkeypatch)
    assert kernel_folder(kernel) is None
    assert not is_compiled(kernel)
    with pytest.warns(KernelWarning, match=r"no folder .* set NUMBA_CACHE_DIR"):
        assert kernel(2) == 8
    # One that cannot be written later costs no more than compiling.
    (place / "__pycache__").unlink()
    beside = loaded(place, monkeypatch)
    assert kernel_folder(beside) == place / "__pycache__"
    shutil.rmtree(place / "__pycache__")
    (place / "__pycache__").write_bytes(b"")
    assert beside(2) == 8


def test_the_compiler_is_imported_only_to_compile(tmp_path):
    for decorator in ("compiled", "allocating"):
        place = installed(tmp_path / decorator, decorator)
        assert compiler_is_imported(place)
        assert not compiler_is_imported(place)


def compiler_is_imported(place):
    ended = subprocess.run(
        [sys.executable, "-c", PROCESS], cwd=place, capture_output=True, text=True, check=True
    )
    return ended.stdout.strip() == "True"


def test_garbage_is_not_collected_while_a_kernel_is_compiled(tmp_path, monkeypatch):
    found = []
    with numba.core.event.install_listener("numba:compile", Watcher(found)):
        assert loaded(installed(tmp_path / "first"), monkeypatch)(2) == 8
    assert found
    assert not any(found)
    assert gc.isenabled()


class Watcher(numba.core.event.Listener):
    """Listener that notes at each compilation if the garbage collector is on."""

    def __init__(self, found):
        self.found = found

    def on_start(self, event):
        self.found.append(gc.isenabled())

    def on_end(self, event):
        """Do nothing."""


def test_processes_that_begin_together_compile_a_kernel_once(tmp_path):
    place = installed(tmp_path / "first")
    command = [sys.executable, "-c", PROCESS]
    begun = [
        subprocess.Popen(command, cwd=place, stdout=subprocess.PIPE, text=True) for _ in range(3)
    ]
    compiled = [process.communicate()[0].strip() for process in begun]
    assert sorted(compiled) == ["False", "False", "True"]
    assert not list((tmp_path / "kept").rglob("*-lock*"))


def test_kernels_run_as_python_where_compilation_is_switched_off(tmp_path, folder):
    place = installed(tmp_path / "first")
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1"}
    ended = subprocess.run(
        [sys.executable, "-c", PROCESS], cwd=place, env=environment, check=True, capture_output=True
    )
    assert not ended.stderr
    assert not folder.exists()
