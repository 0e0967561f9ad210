"""Limits of the shell that are too low are named, with what to do."""

import resource
import subprocess
import sys

import pytest

from beliefnest.world.shell_limits import low_limits

ASK = "from beliefnest.world.shell_limits import low_limits; print(low_limits())"


def under(option: str, value: int) -> str:
    line = f"ulimit {option} {value} && exec {sys.executable} -c '{ASK}'"
    ended = subprocess.run(["bash", "-c", line], capture_output=True, text=True, check=True)
    return ended.stdout.strip()


@pytest.mark.parametrize(
    ("option", "value"), [("-v", 1_000_000), ("-d", 800_000), ("-n", 40), ("-u", 40)]
)
def test_a_low_limit_is_named_with_its_value(option: str, value: int) -> None:
    told = under(option, value)
    assert told.startswith(f"'ulimit {option}' is {value:,}, and about ")
    assert told.endswith("raise the limit in this shell, or ask who set it")


@pytest.mark.skipif(
    resource.getrlimit(resource.RLIMIT_AS)[0] != resource.RLIM_INFINITY,
    reason="the shell of these tests has a limit itself",
)
def test_usual_limits_are_not_named() -> None:
    assert low_limits() is None


def test_a_run_under_a_limit_ends_with_its_name_and_no_traceback(tmp_path) -> None:
    line = f"ulimit -d 800000 && exec {sys.executable} -m beliefnest run sally-anne --condition 1"
    ended = subprocess.run(
        ["bash", "-c", line], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert ended.returncode == 3
    assert "'ulimit -d' is 800,000" in ended.stderr.splitlines()[-1]
    assert "Traceback" not in ended.stderr
