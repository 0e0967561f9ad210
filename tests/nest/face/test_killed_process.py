"""A killed process leaves the effects of every call that returned, and no half of one."""

import random
import signal
import subprocess
import sys
from itertools import islice
from pathlib import Path

import pytest
from tests.nest.comparing import everything
from tests.nest.face.acting_nest import OFTEN, PATHS, calls, nest_in
from tests.profiles import at_night, few_by_day

import beliefnest as bn

ACTING = Path(__file__).with_name("acting_nest.py")
KILLS = at_night(200, 4)
LONGEST = 120


def held(nest):
    simulators = [nest[path] for path in PATHS]
    return (
        [(each.branch, each.tick, everything(each.state)) for each in simulators],
        [each.branches() for each in simulators],
        nest.prompts(),
    )


def acted_until_killed(store, seed, least):
    """Let a process make at least that many calls, kill it; how many returned."""
    command = [sys.executable, str(ACTING), str(store), str(seed)]
    with subprocess.Popen(command, stdout=subprocess.PIPE) as process:
        try:
            told = process.stdout.read(least)
        finally:
            process.send_signal(signal.SIGKILL)
        told += process.stdout.read()
    assert process.returncode == -signal.SIGKILL
    return len(told)


@pytest.mark.parametrize("seed", few_by_day(range(KILLS)))
def test_a_killed_nest_is_resumed_where_it_was(tmp_path, seed):
    store = tmp_path / "run.bn"
    returned = acted_until_killed(store, seed, random.Random(seed).randrange(1, LONGEST))
    with nest_in(None) as model:
        going = calls(model, seed)
        assert sum(1 for _ in islice(going, returned)) == returned
        before = held(model)
        next(going)
        after = held(model)
        with OFTEN:
            nest = bn.Nest.resume(store)
        with nest:
            found = held(nest)
            assert found in (before, after)
