"""Compilation state of a kernel: ready to be called, or still to be compiled."""

import importlib.util
import os

from beliefnest.perception.rays import is_compiled

SOURCE = """
from beliefnest.perception.rays import compiled

@compiled
def twice(number: int) -> int:
    return 2 * number
"""


def loaded(file):
    spec = importlib.util.spec_from_file_location("some_kernels", file)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_a_kernel_is_compiled_once_and_again_when_its_source_changed(tmp_path):
    file = tmp_path / "some_kernels.py"
    file.write_text(SOURCE)
    first = loaded(file)
    assert not is_compiled(first.twice)
    assert first.twice(2) == 4
    assert is_compiled(first.twice)
    assert is_compiled(loaded(file).twice)
    # Installed once more, as it was.
    later = file.stat().st_mtime + 60
    os.utime(file, (later, later))
    assert is_compiled(loaded(file).twice)
    file.write_text(SOURCE.replace("2 * number", "number + number"))
    assert not is_compiled(loaded(file).twice)
