"""The page about a day of a psychologist: from its files to the reproduced supplement."""

import json
import re
import shlex
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.profiles import NIGHTLY

import beliefnest as bn
from beliefnest.cli.app import run_command_line

pytestmark = pytest.mark.usefixtures("kept_worlds")

ROOT = Path(__file__).parents[2]
FILE = ROOT / "docs" / "days" / "psychologist.md"
PAGE = FILE.read_text(encoding="utf-8")
SCENARIO, STUDY = re.findall(r"```yaml\n(.*?)```", PAGE, re.DOTALL)
(EXAMPLE,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
(REASONS,) = re.findall(r"```text\n(.*?)```", PAGE, re.DOTALL)

LATER = ("reproduce", "participants")
"""Commands that play all cells of the study once more: at night only, as their own tests do so."""


def commands() -> Iterator[tuple[list[str], list[str]]]:
    """Yield the arguments of each command, and the lines that the page shows of its output."""
    for block in re.findall(r"```console\n(.*?)```", PAGE, re.DOTALL):
        for part in block.split("$ beliefnest ")[1:]:
            command, *shown = part.splitlines()
            yield (
                shlex.split(command),
                [" ".join(line.split()) for line in shown if "━" not in line],
            )


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "160")
    Path("window.yaml").write_text(SCENARIO, encoding="utf-8")
    Path("study.yaml").write_text(STUDY, encoding="utf-8")
    return tmp_path


def test_conditions_differ_in_the_beliefs_of_the_idea(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (run, table), *_ = commands()
    assert run_command_line(run) == 1
    printed = " ".join(capsys.readouterr().out.split())
    assert all(line in printed for line in table if "right is" in line)
    report = json.loads(Path("first/run.json").read_text(encoding="utf-8"))
    right = [
        [probe["expected"]["answers"][0]["right"][0].split()[0] for probe in each["probes"]]
        for each in report["runs"]
    ]
    assert right == [["blue"] * 3, ["blue", "red", "red"], ["blue", "blue", "red"]]
    drawn = Path("first/condition-3/picture.svg").read_text(encoding="utf-8")
    assert "right:" in drawn
    exec(compile(EXAMPLE, "example", "exec"), {"__name__": "example"})
    assert capsys.readouterr().out == REASONS


def test_a_small_study_has_each_variation_under_every_condition(folder: Path) -> None:
    Path("study.yaml").write_text(STUDY.replace("variations: 40", "variations: 3"))
    result = bn.Study.load("study.yaml").run("out", jobs=1)
    rows = result.rows
    assert len(rows) == 3 * 3 * 2 * 3
    assert len({(row["variation"], row["condition"]) for row in rows}) == 9
    realist = {
        (row["condition"], row["order"]): row["ok"] for row in rows if row["model"] == "offline"
    }
    methods = result.methods()
    assert "3 drawn variations of each scenario (in `agents`" in methods
    assert "Right answers were computed from the beliefs of the simulated agents." in methods
    assert [pair for pair, ok in sorted(realist.items()) if not ok] == [(2, 1), (2, 2), (3, 2)]


@pytest.mark.extra("matplotlib", "statsmodels")
def test_every_command_prints_what_the_page_shows(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for arguments, shown in commands():
        if arguments[0] in LATER and not NIGHTLY:
            continue
        status = run_command_line(arguments)
        assert status == (1 if arguments[0] in ("run", "study") else 0), arguments
        printed = [" ".join(line.split()) for line in capsys.readouterr().out.splitlines()]
        missing = [line for line in shown if not any(line in each for each in printed)]
        assert not missing, (arguments, printed)
    assert Path("accuracy.png").stat().st_size > 10_000


def test_links_and_pictures_lead_somewhere() -> None:
    for target in re.findall(r"\]\(([^)#]+)", PAGE):
        assert (FILE.parent / target).exists(), target
    pictures = re.findall(r"!\[.*?\]\((.*?)\)", PAGE)
    assert len(pictures) == 2
    assert all((FILE.parent / each).stat().st_size < 150_000 for each in pictures)
