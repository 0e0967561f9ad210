"""A closed stream loses what would have been shown there, and nothing else."""

import json
import subprocess
import sys
from pathlib import Path

import pytest
from tests.profiles import few_by_day

COMMAND = f"{sys.executable} -m beliefnest"
RUN = f"{COMMAND} run sally-anne --world scripted --condition 1 --out o"


def shell(line, folder):
    """Run a line of bash; return its status, and that of its first command."""
    script = f"{line}; echo ${{PIPESTATUS[0]}} >status"
    subprocess.run(["bash", "-c", script], cwd=folder, check=False, stderr=subprocess.PIPE)
    return int((folder / "status").read_text())


@pytest.mark.parametrize("closed", few_by_day(["<&- >&- 2>&-", "2>&1 | head -c 1"]))
def test_a_run_does_not_need_its_streams(tmp_path, closed):
    assert shell(f"{RUN} {closed}", tmp_path) == 0
    assert json.loads((tmp_path / "o" / "run.json").read_text())["status"] == "done"


@pytest.mark.parametrize(("command", "closed"), [("list", "| true"), ("template paper", ">&-")])
def test_a_command_that_nobody_reads_ends_well(tmp_path, command, closed):
    assert shell(f"{COMMAND} {command} {closed}", tmp_path) == 0


@pytest.mark.parametrize("lost", ["2>&-", "2>/dev/full"])
def test_an_error_that_nobody_reads_keeps_its_status(tmp_path, lost):
    assert shell(f"{COMMAND} run nothing {lost}", tmp_path) == 2


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="the system has no /dev/full")
def test_results_that_a_full_disk_cannot_hold_are_an_error(tmp_path):
    for command in ("template paper", "list"):
        assert shell(f"{COMMAND} {command} >/dev/full 2>told", tmp_path) == 2
        (line,) = (tmp_path / "told").read_text().splitlines()
        assert line.startswith("beliefnest: the standard output: No space left on device")
