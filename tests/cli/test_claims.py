"""`beliefnest run --claims-from`: a model reads what is said in a scenario."""

import json
from pathlib import Path

import pytest
from tests.llm.conftest import FakeOpenAI, fake

import beliefnest as bn
from beliefnest.cli.app import run_command_line

__all__ = ["fake"]

ROOM = """\
name: room
box: [[0, 0, 0], [6, 3, 6]]
blocks:
  - {block: stone, fill: [[0, 0, 0], [6, 0, 6]]}
containers:
  - {label: box, at: [3, 1, 3]}
agents:
  ann: {position: [1.5, 1, 1.5]}
  bob: {position: [2.5, 1, 1.5]}
perception: {testimony: accept}
script:
  - {agent: bob, program: "await say(bot, 'An apple is in the box.')"}
expectations:
  - {path: /ann, container: [3, 1, 3], items: {apple: 1}}
"""
FOUND = {"claims": [{"kind": "located", "item": "apple", "place": [3, 1, 3]}]}


@pytest.fixture(autouse=True)
def in_a_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("room.yaml").write_text(ROOM, encoding="utf-8")
    Path("found.json").write_text(json.dumps([json.dumps(FOUND)]), encoding="utf-8")


def test_what_a_model_reads_is_believed_and_recorded(capsys: pytest.CaptureFixture[str]) -> None:
    run = ["run", "room.yaml", "--world", "scripted", "--out"]
    assert run_command_line([*run, "without"]) == 1
    assert run_command_line([*run, "with", "--claims-from", "scripted:found.json"]) == 0
    capsys.readouterr()
    settings = [
        json.loads(Path(out, "run.json").read_text())["settings"] for out in ("without", "with")
    ]
    assert [each.get("claims_from") for each in settings] == [None, "scripted:found.json"]
    with bn.Nest.read("with/run/run.bn") as recorded:
        (told,) = recorded.claims()
        assert told.claims_from == "scripted:found.json"
        (asked,) = recorded.prompts()
        assert asked.detail["speaker"] == "bob"
        assert "[3, 1, 3]: box" in asked.messages[1][1]


def test_what_reading_takes_counts_as_spent(
    fake: FakeOpenAI, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("OPENAI_BASE_URL", fake.url)
    monkeypatch.setenv("OPENAI_API_KEY", "sk-secret")
    fake.will(fake.says("I see an apple."))
    run = ["run", "room.yaml", "--world", "scripted", "--claims-from", "openai:gpt-4o-mini"]
    assert run_command_line([*run, "--out", "r"]) == 1
    (result,) = json.loads(Path("r", "run.json").read_text())["runs"]
    assert (result["usage"]["requests"], result["usage"]["input_tokens"]) == (1, 120)
    assert (result["readings"]["asked"], result["readings"]["failed"]) == (1, 1)
    summary = Path("r", "summary.txt").read_text()
    assert "1 of 1 utterances could not be read for claims" in summary
    assert "gave no claims" in summary


def test_a_model_that_is_not_there_is_told_before_anything_is_run(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert run_command_line(["run", "room.yaml", "--claims-from", "openay:x", "--out", "r"]) != 0
    assert "no model 'openay:x'; did you mean openai" in capsys.readouterr().err
    assert not Path("r").exists()


def test_a_study_lets_a_model_read_in_every_cell() -> None:
    asks = [{"path": "/ann", "acts_in": "/ann", "agent": "ann", "task": "Get the apple."}]
    scenario = f"{ROOM}probes: {json.dumps(asks)}\n"
    Path("room.yaml").write_text(scenario, encoding="utf-8")
    study = "scenarios: [room.yaml]\nworld: scripted\nclaims_from: scripted:found.json\n"
    Path("study.yaml").write_text(study, encoding="utf-8")
    plain = "scenarios: [room.yaml]\nworld: scripted\n"
    Path("plain.yaml").write_text(plain, encoding="utf-8")
    result = bn.Study.load("study.yaml").run("with", jobs=1)
    assert [each["ok"] for each in told_in("with")] == [True]
    bn.Study("room.yaml", world="scripted").run("without", jobs=1)
    assert [each["ok"] for each in told_in("without")] == [False]
    assert len(result.frame()) == 1
    for name, status in (("scripted:found.json", 0), ("nobody:x", 2)):
        asked = ["study", "plain.yaml", "--jobs", "1", "--claims-from", name, "--out", name[0]]
        assert run_command_line(asked) == status
    assert [each["ok"] for each in told_in("s")] == [True]
    with pytest.raises(bn.BeliefNestError, match="nobody"):
        bn.Study("room.yaml", claims_from="nobody:x").run("never", jobs=1)


def told_in(folder: str) -> list[dict[str, bool]]:
    """Return the expectations about the belief in the cells of a study."""
    cells = sorted(Path(folder, "cells").glob("*.json"))
    return [each for cell in cells for each in json.loads(cell.read_text())["expectations"]]
