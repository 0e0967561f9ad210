"""The page days/benchmark.md: from its files to a set that is made again."""

import re
import shlex
from pathlib import Path

import pytest
from tests.profiles import NIGHTLY

from beliefnest.cli.app import run_command_line

PAGE = (Path(__file__).parents[2] / "docs" / "days" / "benchmark.md").read_text(encoding="utf-8")
SCENARIO, STUDY = re.findall(r"```yaml\n(.*?)```", PAGE, re.DOTALL)
FEWER = STUDY.replace("variations: 80", "variations: 10").partition("balance:")[0]
"""The study with few scenes, of which none is left out."""
(CODE,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)


@pytest.mark.extra("scipy")
def test_the_page_leads_to_a_released_set(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("walks-out.yaml").write_text(SCENARIO, encoding="utf-8")
    Path("study.yaml").write_text(STUDY, encoding="utf-8")
    commands = re.findall(r"^\$ beliefnest (.*)$", PAGE, re.MULTILINE)
    assert len(commands) == 5
    trial, *later = map(shlex.split, commands)
    assert run_command_line(trial) == 0
    if not NIGHTLY:
        # The trial needs all scenes; the commands after it make smaller sets again.
        Path("study.yaml").write_text(FEWER, encoding="utf-8")
        later = [each for each in later if "--verify" not in each]
    for command in later:
        assert run_command_line(command) == 0
    printed = capsys.readouterr().out
    assert ("made again with the same bytes" in printed) is NIGHTLY
    (fault,) = (line.split()[0] for line in printed.splitlines() if line.split()[-1:] == ["NO"])
    assert fault == "most_event"
    exec(compile(CODE, "benchmark.md", "exec"), {"__name__": "example"})
    assert " thinks that the " in capsys.readouterr().out
