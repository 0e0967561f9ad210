"""The page about studies leads from its scenario to its figure, as it says."""

import re
from pathlib import Path

import pytest

import beliefnest as bn
from beliefnest.cli.app import run_command_line

pytestmark = pytest.mark.usefixtures("kept_worlds")

PAGE = (Path(__file__).parents[2] / "docs" / "studies.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
SCENARIO, STUDY, LABELLED, EPISODES = re.findall(r"```yaml\n(.*?)```", PAGE, re.DOTALL)


@pytest.mark.extra("matplotlib")
def test_from_the_scenario_to_the_figure_and_by_command(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("fetch.yaml").write_text(SCENARIO, encoding="utf-8")
    Path("study.yaml").write_text(STUDY, encoding="utf-8")
    names: dict[str, object] = {"__name__": "example"}
    for example in EXAMPLES:
        exec(compile(example, "example", "exec"), names)
        claims = re.findall(r"print\(.*\)  # (.*)", example)
        assert capsys.readouterr().out.splitlines() == claims
    assert "<svg" in Path("fetch.svg").read_text(encoding="utf-8")
    page = Path("fetch.html").read_text(encoding="utf-8")
    assert "<svg" in page
    assert not re.search(r'(src|href)="(?!#)', page)
    # The same cells: nothing is left to play.
    assert run_command_line(["study", "study.yaml", "--out", "fetch-study", "--jobs", "1"]) == 0
    assert "(4/4)" in capsys.readouterr().err.splitlines()[-1]


@pytest.mark.long
def test_the_study_of_episodes_is_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    goal = "episode: {goal: {reach: [{agent: ann, items: {diamond: 1}}]}}"
    Path("mine.yaml").write_text(f"{SCENARIO}\n{goal}\n", encoding="utf-8")
    Path("mine.js").write_text("", encoding="utf-8")
    few = EPISODES.replace("seeds: 50", "seeds: 5")
    assert few != EPISODES
    Path("minds.yaml").write_text(few, encoding="utf-8")
    plan = bn.Study.load("minds.yaml").plan()
    players = {cell.key.player for cell in plan.cells}
    assert players == {"search", "random", "model:offline", "anne=program:mine.js"}
    # The scenario is of one size.
    assert {each.scenario for each in plan.invalid} == {"mine.yaml"}
    assert len(plan.cells) == 2 * 5 * 2 * (4 + 1 + 4 + 1)


def test_groups_of_scenarios_have_labels(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name in re.findall(r"\w+\.yaml", LABELLED):
        text = SCENARIO.replace("name: fetch", f"name: {name.removesuffix('.yaml')}")
        Path(name).write_text(text, encoding="utf-8")
    Path("study.yaml").write_text(LABELLED, encoding="utf-8")
    labels = {cell.label for cell in bn.Study.load("study.yaml").plan().cells}
    assert labels == {"false belief", "true belief"}
