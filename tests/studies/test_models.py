"""Studies with models behind a server: slow, rate-limited, wrong, down, and what they may spend."""

import signal
import subprocess
import sys
import threading

import pytest
from tests.llm.conftest import FakeOpenAI, serving
from tests.processes import started
from tests.studies.small import small_in, study_in

import beliefnest as bn
from beliefnest.plan.spending import spent_in

pytestmark = pytest.mark.usefixtures("kept_worlds")

LEFT = "```javascript\nawait getItemFromChest(bot, new Vec3(1, 1, 1), {diamond: 1});\n```"
ANSWER_TOKENS = 150
PLACES = {"spot": [[1, 1, 1], [5, 1, 1]]}


@pytest.fixture
def server(monkeypatch):
    with serving() as served:
        monkeypatch.setenv("VLLM_BASE_URL", served.url)
        yield served


def study(folder, **arguments):
    return bn.Study(small_in(folder), models=["vllm:m"], **arguments)


def test_what_a_model_gets_wrong_is_told_apart(server, tmp_path):
    server.will(FakeOpenAI.says(LEFT))
    result = study(tmp_path, variations=PLACES).run(tmp_path / "out", jobs=1)
    assert [row["outcome"] for row in result.rows] == ["ok", "program_failed"]
    frame = result.frame()
    assert list(frame["tokens"]) == [ANSWER_TOKENS] * 2
    assert list(frame["intended"]) == ["1,1,1", "1,1,1"]


def test_no_program_is_an_unread_answer_and_counts(server, tmp_path):
    server.will(FakeOpenAI.says("I would rather not."))
    result = study(tmp_path, attempts=2).run(tmp_path / "out", jobs=1)
    assert [row["outcome"] for row in result.rows] == ["unread"]
    assert result.rows[0]["tokens"] == 2 * ANSWER_TOKENS
    assert result.rows[0]["asked_again"] == 1
    assert result.summary().loc[0, ["judged", "right", "unread"]].tolist() == [1, 0, 1]
    told = result.methods()
    assert "with at most 2 requests for a program" in told
    assert "1 row without an answer to judge (1 unread) count as not right" in told
    assert "asked again after 1 unreadable answer" in told


def test_the_key_retry_unread_asks_again_and_is_recorded(server, tmp_path):
    server.will(FakeOpenAI.says("Hm."), FakeOpenAI.says(LEFT))
    result = study(tmp_path, attempts=1, retry_unread=1).run(tmp_path / "out", jobs=1)
    assert [(row["outcome"], row["asked_again"]) for row in result.rows] == [("ok", 1)]
    assert "1 further request after an unreadable answer" in result.methods()
    with pytest.raises(bn.InputError, match="retry_unread is -1"):
        study(tmp_path, retry_unread=-1)


def test_who_read_claims_stands_in_methods(server, tmp_path):
    server.will(FakeOpenAI.says(LEFT))
    result = study(tmp_path, claims_from="offline").run(tmp_path / "out", jobs=1)
    assert "with claims read out of what agents said by `offline`" in result.methods()


def test_rate_limits_are_waited_for(server, tmp_path):
    server.will(FakeOpenAI.fails(429, headers=[("retry-after", "0")]), FakeOpenAI.says(LEFT))
    result = study(tmp_path).run(tmp_path / "out", jobs=1)
    assert [row["outcome"] for row in result.rows] == ["ok"]


def test_a_request_that_fails_fails_its_cell_alone_and_is_tried_again(server, tmp_path):
    server.will(FakeOpenAI.says(LEFT), FakeOpenAI.fails(400))
    arguments = {"variations": {"count": [1, 2]}}
    result = study(tmp_path, **arguments).run(tmp_path / "out", jobs=1)
    assert [row["outcome"] for row in result.rows] == ["ok", "no_answer"]
    assert "rejected the request" in result.rows[1]["why_not"]
    assert result.summary().loc[0, ["judged", "right", "no_answer"]].tolist() == [2, 1, 1]
    server.will(FakeOpenAI.says(LEFT))
    asked = len(server.requests)
    result = study(tmp_path, **arguments).run(tmp_path / "out", jobs=1)
    assert [row["outcome"] for row in result.rows] == ["ok", "ok"]
    assert len(server.requests) == asked + 1


def test_a_model_that_cannot_be_asked_stops_the_study_at_once(server, tmp_path):
    server.will(FakeOpenAI.says(LEFT), FakeOpenAI.fails(401))
    arguments = {"variations": {"count": [1, 2, 3, 4]}}
    with pytest.raises(bn.ModelError, match=r"refused the key in VLLM_API_KEY.*; 3 cells left"):
        study(tmp_path, **arguments).run(tmp_path / "out", jobs=1)
    assert len(server.requests) == 2
    server.will(FakeOpenAI.says(LEFT))
    result = study(tmp_path, **arguments).run(tmp_path / "out", jobs=1)
    assert [row["outcome"] for row in result.rows] == ["ok"] * 4
    assert len(server.requests) == 2 + 3


def test_a_server_that_is_not_there_stops_the_study_before_anything(tmp_path, monkeypatch):
    monkeypatch.setenv("VLLM_BASE_URL", "http://127.0.0.1:1/v1")
    with pytest.raises(bn.ModelError, match=r"no server for vllm:m at http://127\.0\.0\.1:1"):
        study(tmp_path).run(tmp_path / "out", jobs=1)


def test_settings_of_requests_are_part_of_a_cell(tmp_path, server):
    (tmp_path / "system.txt").write_text("Program.", encoding="utf-8")
    settings = [
        {},
        {"answer_seconds": 60},
        {"first_token_seconds": 60.0},
        {"max_output_tokens": 77},
        {"system": tmp_path / "system.txt"},
        {"skills": "names"},
    ]
    names = [study(tmp_path, **each).plan().cells[0].key.name for each in settings]
    assert len(set(names)) == len(names)
    server.will(FakeOpenAI.says(LEFT))
    result = study(tmp_path, system=tmp_path / "system.txt", max_output_tokens=77).run(
        tmp_path / "out", jobs=1
    )
    (request,) = server.requests
    assert request.body["messages"][0]["content"] == "Program."
    assert 77 in (request.body.get("max_tokens"), request.body.get("max_completion_tokens"))
    assert [row["outcome"] for row in result.rows] == ["ok"]


@pytest.mark.parametrize(
    ("lines", "told"),
    [
        ("answer_seconds: 0", r"study\.yaml:3: answer_seconds: answer_seconds is 0"),
        ("max_output_tokens: 0", r"study\.yaml:3: max_output_tokens: .* at least 1"),
        ("skills: some", r"study\.yaml:3: skills: skills is 'some'; give one of none, names"),
        ("system: gone.txt", r"study\.yaml:3: system: the system message .*gone\.txt"),
    ],
)
def test_wrong_settings_of_requests_are_named(tmp_path, lines, told):
    small_in(tmp_path)
    file = study_in(tmp_path, f"scenarios: [small.yaml]\nmodels: [offline]\n{lines}\n")
    with pytest.raises(bn.ScenarioError, match=told):
        bn.Study.load(file)


@pytest.mark.long
def test_an_interrupted_study_keeps_whole_cells(server, tmp_path):
    """It is interrupted in its third cell, which waits for an answer."""
    asked, ended = threading.Event(), threading.Event()

    def never(handler):
        asked.set()
        ended.wait(120)

    server.will(never)
    varied = "scenarios: [small.yaml]\nvariations: {count: [1, 2]}\n"
    file = study_in(tmp_path, f"{varied}models: [offline, 'vllm:m']\n")
    command = [sys.executable, "-m", "beliefnest", "study", str(file), "--out"]
    with started(
        [*command, str(tmp_path / "out"), "--jobs", "1"], stderr=subprocess.PIPE
    ) as process:
        assert asked.wait(120)
        process.send_signal(signal.SIGINT)
        _, told = process.communicate()
    ended.set()
    assert process.returncode == 130
    assert "run the same command to continue" in told
    file.write_text(varied, encoding="utf-8")
    subprocess.run([*command, str(tmp_path / "whole"), "--jobs", "1"], check=True)
    kept, whole = (
        {cell.name: cell.read_bytes() for cell in (tmp_path / each / "cells").iterdir()}
        for each in ("out", "whole")
    )
    assert len(kept) == 2
    assert kept == whole


@pytest.mark.long
def test_slow_answers_are_awaited_side_by_side(server, tmp_path):
    """The first request is answered when the second has come, which needs two jobs at once."""
    second = threading.Event()

    def slow(handler):
        if len(server.requests) == 1:
            assert second.wait(120)
        else:
            second.set()
        FakeOpenAI.says(LEFT)(handler)

    server.will(slow)
    result = study(tmp_path, variations={"count": [1, 2]}).run(tmp_path / "out", jobs=2)
    assert list(result.frame()["count"]) == [1, 2]
    assert result.frame()["ok"].all()


@pytest.mark.long
def test_what_may_be_spent_holds_over_all_jobs_and_runs(server, tmp_path):
    server.will(FakeOpenAI.says(LEFT))
    out, counts = tmp_path / "out", {"count": [1, 2, 3, 4, 5, 6]}
    limited = study(tmp_path, variations=counts, max_tokens=2 * ANSWER_TOKENS)
    result = limited.run(out, jobs=2, record=True)
    # Two requests may be under way when the limit is reached.
    assert len(server.requests) in (2, 3)
    refused = [row for row in result.rows if row["outcome"] == "error"]
    assert len(refused) == 6 - len(server.requests)
    assert all("may use 300; raise the limit" in row["why_not"] for row in refused)
    # No script was played for them, but for one whose other job's answer was then under way.
    answered = {row["cell"] for row in result.rows} - {row["cell"] for row in refused}
    recorded = {file.stem for file in (out / "runs").glob("*.bn")}
    assert answered <= recorded
    assert len(recorded) <= 3
    result = study(tmp_path, variations=counts).run(out, jobs=1)
    assert len(server.requests) == 6
    assert result.frame()["ok"].all()
    assert spent_in(out / "spent.jsonl").tokens == 6 * ANSWER_TOKENS


def test_two_models_are_compared_on_the_same_variations(server, tmp_path):
    server.will(FakeOpenAI.says(LEFT))
    both = bn.Study(small_in(tmp_path), models=["offline", "vllm:m"], variations=PLACES)
    result = both.run(tmp_path / "out", jobs=1)
    assert result.frame().groupby("spot")["seed"].nunique().tolist() == [1, 1]
    (pairs,) = result.differences("model").to_dict("records")
    assert (pairs["one"], pairs["other"], pairs["pairs"]) == ("offline", "vllm:m", 2)
    assert (pairs["both"], pairs["only_one"], pairs["difference"]) == (1, 1, 0.5)
    by_model = result.summary("model").set_index("model")
    assert by_model["accuracy"].to_dict() == {"offline": 1.0, "vllm:m": 0.5}
