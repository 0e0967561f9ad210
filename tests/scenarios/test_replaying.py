"""Every run of a built-in scenario, under each condition, is found the same when run again."""

import json
from contextlib import contextmanager

import pytest
from tests.profiles import few_by_day

from beliefnest.cli.app import run_command_line
from beliefnest.scenarios.scenario import Scenario
from beliefnest.scenarios.sources import builtin_names
from beliefnest.worlds.by_name import Worlds

pytestmark = pytest.mark.usefixtures("kept_worlds")


@pytest.fixture(scope="module")
def others():
    """Worlds of another process than the runs were played in."""
    with Worlds(2) as opened:

        @contextmanager
        def lend(_):
            yield opened

        yield lend


LATER = sorted({*builtin_names()} - {"sally-anne", "lie"})


@pytest.mark.parametrize("name", few_by_day(["lie", "sally-anne", *LATER]))
def test_a_replay_finds_no_difference(name, others, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("beliefnest.cli.replay.Worlds", others)
    out = tmp_path / "run"
    run_command_line(["run", name, "--out", str(out), "--seed", "2"])
    capsys.readouterr()
    assert run_command_line(["replay", str(out), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["same"]
    conditions = Scenario.load_all(name)
    assert len({row["store"] for row in told["timelines"]}) == len(conditions)
    probes = sum(probe.asks_model for scenario in conditions for probe in scenario.probes)
    assert len(told["timelines"]) >= len(conditions) + probes
    assert all(row["programs"] > 0 for row in told["timelines"])
