"""Kernels that are not compiled yet run as Python, with the same results, for a short time."""

import importlib
import io
import os
import pickle
import subprocess
import sys

import numba
import numpy as np
import pytest

import beliefnest as bn
from beliefnest.belief import kernel
from beliefnest.cli.kernels_ahead import StandIns, compile_all
from beliefnest.perception.compiling import is_compiled
from beliefnest.perception.instead import INSTEAD

COUNTING = """
from beliefnest.perception.compiling import compiled, inner

@inner
def one(number: int) -> int:
    return 1

@compiled
def count(row, rounds: int) -> float:
    for number in range(rounds):
        row[0] += 1
        row[1] = 1.0 / (rounds - 2)
        row[0] += one(number)
    return row[0]
"""
LONG = 1000.0


@pytest.fixture
def count(tmp_path, monkeypatch):
    (tmp_path / "counting.py").write_text(COUNTING)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(numba.config, "CACHE_DIR", os.fspath(tmp_path / "kept"))
    yield importlib.import_module("counting").count
    del sys.modules["counting"]


@pytest.mark.parametrize(
    ("seconds", "rounds", "compiles"), [(LONG, 1, False), (1e-9, 1, True), (LONG, 2, True)]
)
def test_a_call_that_fails_in_python_leaves_no_trace(count, seconds, rounds, compiles):
    stand_ins = StandIns(seconds)
    token = INSTEAD.set(stand_ins.find)
    try:
        assert count(np.array([40.0, 0.0]), rounds) == 40 + 2 * rounds
    finally:
        INSTEAD.reset(token)
        stand_ins.close()
    assert bool(count.signatures) == compiles


def test_beliefs_are_the_same_in_python(monkeypatch):
    before = beliefs()
    stand_ins = StandIns(LONG)
    monkeypatch.setattr(stand_ins, "_compile", lambda *kernel: None)
    called = []

    def fold(*args):
        called.append(args)
        return stand_ins.find(compiled, ())(*args)

    compiled = kernel.fold
    monkeypatch.setattr(kernel, "fold", fold)
    assert beliefs() == before
    assert called


def beliefs():
    scenario = bn.Scenario.load("sally-anne", condition=3)
    with bn.Nest.open(scenario, world="scripted") as nest:
        nest.play()
        return [nest[path].state for path in ("/sally", "/observer/sally", "/anne/observer/sally")]


def test_the_compiler_compiles_what_it_is_asked_for(count):
    types = (numba.types.Array(numba.types.float64, 1, "C"), numba.types.int64)
    compile_all(io.BytesIO(pickle.dumps(("counting", "count", types))))
    assert is_compiled(count)


ASKED = """
import os

class kernel:
    @staticmethod
    def compile(path):
        with open(path, "w") as file:
            file.write(str(os.nice(0)))
"""


def test_the_compiler_gives_way_to_commands(tmp_path):
    (tmp_path / "asked.py").write_text(ASKED)
    told = tmp_path / "told"
    subprocess.run(
        [sys.executable, "-m", "beliefnest.cli.kernels_ahead"],
        cwd=tmp_path,
        input=pickle.dumps(("asked", "kernel", str(told))),
        check=True,
    )
    assert int(told.read_text()) > os.nice(0)
