"""Kernels in the cache are loaded without numba's compiler, and compiled if they are not there."""

import subprocess
import sys

_CODE = """
import sys
import {module} as kernels
assert kernels.twice(21) == 42
print("numba.np.arraymath" in sys.modules)
"""
_KERNEL = """
from beliefnest.perception.rays import {decorator}

@{decorator}
def twice(number):
    return 2 * number
"""


def compiler_is_imported(folder, module):
    ended = subprocess.run(
        [sys.executable, "-c", _CODE.format(module=module)],
        cwd=folder,
        capture_output=True,
        text=True,
        check=True,
    )
    return ended.stdout.strip() == "True"


def test_the_compiler_is_imported_only_to_compile(tmp_path):
    for decorator in ("compiled", "allocating"):
        module = f"kernels_{decorator}"
        (tmp_path / f"{module}.py").write_text(_KERNEL.format(decorator=decorator))
        assert compiler_is_imported(tmp_path, module)
        assert not compiler_is_imported(tmp_path, module)
