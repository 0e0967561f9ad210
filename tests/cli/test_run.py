"""`beliefnest run` with models: a local server that speaks OpenAI's protocol, and its faults."""

import json
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from tests.llm.conftest import FakeOpenAI, fake
from tests.processes import started

from beliefnest.cli.app import run_command_line
from beliefnest.timeline import codec
from beliefnest.timeline.store import Journal

__all__ = ["fake"]

pytestmark = pytest.mark.usefixtures("kept_worlds")

KEY = "sk-a-very-secret-key"
MODEL = "openai:gpt-4o-mini"
ROOM = """\
name: room
box: [[0, 0, 0], [6, 3, 6]]
blocks:
  - {block: stone, fill: [[0, 0, 0], [6, 0, 6]]}
containers:
  - {label: box, at: [3, 1, 3], items: {apple: 1}}
agents:
  ann: {position: [1.5, 1, 1.5]}
static_blocks: [stone]
initial_beliefs:
  - {path: /ann, containers: [{at: [3, 1, 3], items: {apple: 1}}]}
probes:
  - label: fetch
    path: /ann
    acts_in: /ann
    agent: ann
    task: Get an apple from a chest.
    expect: {opens: [3, 1, 3]}
"""
TWO = f"""{ROOM}conditions:
  1: {{description: first}}
  2: {{description: second, probes: {{fetch: {{task: Get one apple from a chest.}}}}}}
"""
GOOD = "```javascript\nawait getItemFromChest(bot, new Vec3(3, 1, 3), {apple: 1});\n```"
BROKEN = "```javascript\nawait getItemFromChest(bot;\n```"
IDLE = "```javascript\nawait doNothing(bot);\n```"
Fault = Callable[..., Any]


@pytest.fixture(autouse=True)
def in_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("room.yaml").write_text(ROOM, encoding="utf-8")
    Path("two.yaml").write_text(TWO, encoding="utf-8")


@pytest.fixture
def server(fake: FakeOpenAI, monkeypatch: pytest.MonkeyPatch) -> FakeOpenAI:
    monkeypatch.setenv("OPENAI_BASE_URL", fake.url)
    monkeypatch.setenv("OPENAI_API_KEY", KEY)
    return fake


def run(*arguments: str, scenario: str = "room.yaml", model: str = MODEL, out: str = "r") -> int:
    return run_command_line(["run", scenario, "--model", model, "--out", out, *arguments])


def report(out: str = "r") -> dict[str, Any]:
    content: dict[str, Any] = json.loads(Path(out, "run.json").read_text(encoding="utf-8"))
    return content


def sent(server: FakeOpenAI, number: int) -> str:
    return str(server.requests[number].body["messages"])


def test_a_model_reads_the_skills_and_the_belief_and_its_usage_is_reported(
    server: FakeOpenAI, capsys: pytest.CaptureFixture[str]
) -> None:
    server.will(server.says(GOOD))
    assert run("--temperature", "0.5", "--seed", "4") == 0
    (request,) = server.requests
    assert (request.body["temperature"], request.body["seed"]) == (0.5, 4)
    assert "getItemFromChest(bot, chestPosition, items)" in sent(server, 0)
    assert "Task: Get an apple from a chest." in sent(server, 0)
    (result,) = report()["runs"]
    assert result["model"] == MODEL
    assert result["usage"]["input_tokens"] == 120
    assert result["usage"]["output_tokens"] == 30
    assert 0 < result["usage"]["cost"] < 0.01
    printed = capsys.readouterr().out
    assert "150" in printed
    assert "$0.0000" in printed
    for file in Path("r").rglob("*"):
        assert file.is_dir() or KEY.encode() not in file.read_bytes(), file


def test_a_program_that_fails_goes_back_with_its_code_and_error(server: FakeOpenAI) -> None:
    server.will(server.says(BROKEN), server.says(GOOD))
    assert run() == 0
    assert len(server.requests) == 2
    assert "No code was executed" in sent(server, 0)
    assert "await getItemFromChest(bot;" in sent(server, 1)
    assert "line 1" in sent(server, 1)
    (probe,) = report()["runs"][0]["probes"]
    assert (probe["attempts"], probe["ok"], probe["error"]) == (2, True, None)
    assert probe["usage"]["input_tokens"] == 240
    assert probe["branch"] != "probe 1"


def test_programs_that_go_on_failing_are_judged_by_what_the_last_did(server: FakeOpenAI) -> None:
    server.will(server.says(BROKEN))
    assert run("--attempts", "2") == 1
    assert len(server.requests) == 2
    (probe,) = report()["runs"][0]["probes"]
    assert probe["ok"] is False
    assert probe["error"]
    assert probe["opened"] == []


def test_a_program_that_acted_is_not_sent_back_with_what_the_world_told_it(
    server: FakeOpenAI,
) -> None:
    greedy = "```javascript\nawait getItemFromChest(bot, new Vec3(3, 1, 3), {diamond: 1});\n```"
    server.will(server.says(greedy))
    assert run() == 0
    assert len(server.requests) == 1
    (probe,) = report()["runs"][0]["probes"]
    assert "diamond" in probe["error"]
    assert probe["opened"] == [[3, 1, 3]]


def test_what_a_program_does_is_judged_and_not_what_it_says(server: FakeOpenAI) -> None:
    server.will(server.says(IDLE))
    assert run() == 1
    assert len(server.requests) == 1


@pytest.mark.parametrize(
    ("behave", "hint", "counted"),
    [
        (lambda fake: fake.fails(401, "bad key"), "OPENAI_API_KEY", "in no rate"),
        (lambda fake: fake.garbles, MODEL, "as not right"),
    ],
    ids=["key", "garbage"],
)
def test_a_model_that_fails_ends_with_3_and_one_line_and_what_was_done_is_kept(
    server: FakeOpenAI, capsys: pytest.CaptureFixture[str], behave: Fault, hint: str, counted: str
) -> None:
    server.will(server.says(GOOD), behave(server))
    assert run("--attempts", "1", scenario="two.yaml") == 3
    errors = capsys.readouterr().err
    line = errors.splitlines()[-1]
    assert line.startswith(f"beliefnest: 1 of 2 cells have no answer, counted {counted}; ")
    assert hint in line
    assert "Traceback" not in errors
    assert KEY not in errors
    content = report()
    assert content["status"] == "failed"
    assert [each["condition"] for each in content["runs"]] == [1]
    assert [each["condition"] for each in content["failures"]] == [2]
    asked = len(server.requests)
    server.will(server.says(GOOD))
    # An answer without a program is an answer, and kept like any other.
    assert run("--attempts", "1", "--cache", "write", scenario="two.yaml") == 0
    assert len(server.requests) == asked + 1
    content = report()
    assert content["status"] == "done"
    assert [each["ok"] for each in content["runs"]] == [True, True]


@pytest.mark.parametrize(
    ("behave", "outcome"),
    [
        (lambda fake: fake.refuses, "refused"),
        (lambda fake: fake.says("I'm sorry, but I can't help with that."), "refused"),
        (lambda fake: fake.says("I would rather not write code."), "unread"),
        (lambda fake: fake.says("```javascript\nawait x("), "unread"),
        (lambda fake: fake.says(""), "unread"),
        (lambda fake: fake.says(GOOD, reason="length"), "cut"),
        (lambda fake: fake.floods, "cut"),
    ],
    ids=["refused", "refusal", "no code", "half", "empty", "cut", "10 MB"],
)
def test_an_answer_without_a_program_is_a_result_that_counts(
    server: FakeOpenAI, capsys: pytest.CaptureFixture[str], behave: Fault, outcome: str
) -> None:
    server.will(server.says(GOOD), behave(server))
    assert run("--attempts", "1", "--repeat", "2") == 1
    out = capsys.readouterr().out
    assert "1 of 2" in out
    assert f"1 {outcome}" in out
    content = report()
    assert content["status"] == "done"
    assert [run["probes"][0]["outcome"] for run in content["runs"]] == ["ok", outcome]
    (score,) = content["scores"]
    assert (score["passed"], score["total"], score["rate"]) == (1, 2, 0.5)
    assert (score["outcomes"]["ok"], score["outcomes"][outcome]) == (1, 1)


def test_a_rate_limit_is_waited_for(server: FakeOpenAI) -> None:
    limited = server.fails(429, "slow down", headers=[("Retry-After", "0")])
    server.will(limited, server.says(GOOD))
    assert run() == 0
    assert len(server.requests) == 2


@pytest.mark.parametrize(
    ("limit", "hint"),
    [(("--max-tokens", "100"), "may use 100"), (("--max-cost", "0.00001"), "may cost 0.00")],
)
def test_a_run_may_not_spend_more_than_it_is_allowed(
    server: FakeOpenAI, capsys: pytest.CaptureFixture[str], limit: tuple[str, str], hint: str
) -> None:
    server.will(server.says(GOOD))
    assert run(*limit, scenario="two.yaml") == 3
    assert hint in capsys.readouterr().err
    assert len(server.requests) == 1
    assert run(*limit, scenario="two.yaml") == 3
    assert len(server.requests) == 1
    assert run("--max-tokens", "1000", scenario="two.yaml") == 0


def comparable(out: str) -> dict[str, bytes]:
    """Return the recorded facts of a run, without its folder and its durations."""
    found = {}
    for file in sorted(Path(out).rglob("probe-*/*")):
        found[str(file.relative_to(out))] = file.read_bytes()
    for file in sorted(Path(out, "cells").iterdir()):
        result = json.loads(file.read_text(encoding="utf-8"))
        del result["seconds"], result["key"]
        for each in (result, *result["probes"]):
            each.pop("run_dir")
        found[result["run"]] = json.dumps(result).encode()
    for file in sorted(Path(out).rglob("run.bn")):
        with Journal.read(file) as journal:
            for info in journal.timelines():
                entries = journal.entries(info.key, 0, info.entries)
                name = f"{file.relative_to(out)} {info.key}"
                found[name] = b"".join(codec.encode_entry(entry) for entry in entries)
    return found


def test_a_run_is_repeated_from_its_answers_with_the_server_gone(
    server: FakeOpenAI, monkeypatch: pytest.MonkeyPatch
) -> None:
    server.will(server.says(BROKEN), server.says(GOOD))
    assert run(scenario="two.yaml") == 0
    asked = len(server.requests)
    # The discard port has no listener.
    monkeypatch.setenv("OPENAI_BASE_URL", "http://127.0.0.1:9/v1")
    assert run("--answers", "r/answers", scenario="two.yaml", out="again") == 0
    assert len(server.requests) == asked
    assert len(comparable("r")) > 8
    assert comparable("again") == comparable("r")
    replayed = run(scenario="two.yaml", model="replay:r/model.jsonl", out="replayed")
    assert replayed == 0


def test_without_a_cache_every_run_asks(server: FakeOpenAI) -> None:
    server.will(server.says(GOOD))
    assert run("--cache", "off") == 0
    assert not Path("r/answers").exists()
    assert run("--cache", "write", "--answers", "kept", out="s") == 0
    assert run("--cache", "write", "--answers", "kept", out="t") == 0
    assert len(server.requests) == 3
    assert len(list(Path("kept").iterdir())) == 1


def test_answers_from_a_script(capsys: pytest.CaptureFixture[str]) -> None:
    Path("answers.json").write_text(json.dumps([BROKEN, GOOD]), encoding="utf-8")
    assert run(model="scripted:answers.json") == 0
    assert report()["runs"][0]["probes"][0]["attempts"] == 2
    assert run(model="scripted:nothing.json", out="s") == 3
    assert "nothing.json" in capsys.readouterr().err
    Path("damaged.json").write_text('{"a": 1', encoding="utf-8")
    for model in ("scripted:damaged.json", "replay:damaged.json"):
        assert run(model=model, out="s") == 2
        assert "beliefnest: damaged.json" in capsys.readouterr().err
    assert not Path("s").exists()


def test_models_and_repeats_make_a_table(
    server: FakeOpenAI, capsys: pytest.CaptureFixture[str]
) -> None:
    server.will(server.says(GOOD), server.says(IDLE))
    arguments = ["run", "two.yaml", "--models", f"{MODEL},offline", "--repeat", "2", "--out", "r"]
    assert run_command_line(arguments) == 1
    printed = capsys.readouterr().out
    assert "95 % interval" in printed
    scores = {(each["condition"], each["model"]): each for each in report()["scores"]}
    assert set(scores) == {(1, MODEL), (2, MODEL), (1, "offline"), (2, "offline")}
    assert (scores[1, MODEL]["passed"], scores[1, MODEL]["total"]) == (1, 2)
    assert (scores[2, MODEL]["passed"], scores[2, MODEL]["total"]) == (0, 2)
    assert scores[1, "offline"]["rate"] == 1.0
    assert scores[1, "offline"]["interval"][0] == pytest.approx(0.342, abs=1e-3)
    assert scores[1, MODEL]["tokens"] == 300
    assert [each["seed"] for each in report()["runs"]] == [0, 0, 0, 0, 1, 1, 1, 1]
    assert [request.body["seed"] for request in server.requests] == [0, 0, 1, 1]


def test_an_interrupted_run_goes_on_where_it_was(
    server: FakeOpenAI, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupt(*arguments: Any) -> None:
        raise KeyboardInterrupt

    server.will(server.says(GOOD))
    with monkeypatch.context() as patched:
        patched.setattr("beliefnest.cli.run_cells.read_condition", interrupt)
        assert run(scenario="two.yaml") == 130
    assert report()["status"] == "interrupted"
    assert run(scenario="two.yaml") == 0
    # The first answer was kept although its condition had not ended.
    assert len(server.requests) == 2
    assert [each["ok"] for each in report()["runs"]] == [True, True]


@pytest.mark.parametrize(
    ("arguments", "hint"),
    [
        (["--seed", "1"], "another seed"),
        (["--repeat", "2"], "another repeat"),
        (["--temperature", "1"], "another temperature"),
    ],
)
def test_a_run_goes_on_only_as_it_began(
    server: FakeOpenAI, capsys: pytest.CaptureFixture[str], arguments: list[str], hint: str
) -> None:
    server.will(server.fails(401, "bad key"))
    assert run() == 3
    capsys.readouterr()
    assert run(*arguments) == 2
    assert hint in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "hint"),
    [
        (["--repeat", "0"], "--repeat is 0"),
        (["--attempts", "0"], "--attempts is 0"),
        (["--models", "offline,offline"], "named twice"),
        (["--models", "offline,oracle"], "oracle"),
        (["--cache", "maybe"], "maybe"),
    ],
)
def test_wrong_options_are_one_line(
    capsys: pytest.CaptureFixture[str], arguments: list[str], hint: str
) -> None:
    assert run_command_line(["run", "room.yaml", "--out", "r", *arguments]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert hint in line
    assert not Path("r").exists()


def test_a_folder_in_use_is_refused_and_the_first_run_loses_nothing(
    server: FakeOpenAI, capsys: pytest.CaptureFixture[str]
) -> None:
    asked, goes_on = threading.Event(), threading.Event()

    def answers_when_told(handler: Any) -> None:
        asked.set()
        goes_on.wait()
        FakeOpenAI.says(GOOD)(handler)

    server.will(answers_when_told)
    command = ["run", "room.yaml", "--world", "scripted", "--model", MODEL, "--out", "o"]
    with started([sys.executable, "-m", "beliefnest", *command], stderr=subprocess.PIPE) as first:
        try:
            while not asked.wait(timeout=1):
                assert first.poll() is None, first.communicate()
            assert run_command_line(command) == 2
            assert f"in use by process {first.pid}" in capsys.readouterr().err
        finally:
            goes_on.set()
        _, told = first.communicate()
        assert first.returncode == 0, told
    assert len(server.requests) == 1
    assert json.loads(Path("o", "run.json").read_text(encoding="utf-8"))["status"] == "done"


def test_a_call_without_await_is_told_at_the_end(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    script = '  - {agent: ann, program: "goToPosition(bot, new Vec3(5, 1, 5), 0);"}'
    text = f"{ROOM.partition('probes:')[0]}script:\n{script}\n"
    (tmp_path / "room.yaml").write_text(text, encoding="utf-8")
    command = ["run", str(tmp_path / "room.yaml"), "--world", "scripted"]
    assert run_command_line([*command, "--out", str(tmp_path / "out")]) == 0
    line = (
        "1 call stopped at the end of programs, perhaps for lack of `await`; the first: ann: goTo"
    )
    assert line in capsys.readouterr().out
