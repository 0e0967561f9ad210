"""The same answers of a model give the same rate and counts, whoever asks for them."""

import json
from collections import Counter

import pytest
from tests.llm.conftest import FakeOpenAI, serving

import beliefnest as bn
from beliefnest.cli.app import run_command_line
from beliefnest.scenarios.judging import NOT_ANSWERED, OUTCOMES

pytestmark = pytest.mark.usefixtures("kept_worlds")

ROOM = """\
name: room
box: [[0, 0, 0], [6, 3, 6]]
blocks:
  - {block: stone, fill: [[0, 0, 0], [6, 0, 6]]}
agents:
  ann: {position: [1.5, 1, 1.5]}
probes:
  - path: /ann
    acts_in: /ann
    agent: ann
    expect:
      answers:
        - question: "Where is the apple?"
          options: [red box, blue box]
          right: red box
"""
SAID = {
    "ok": FakeOpenAI.says("Answer: red box"),
    "wrong": FakeOpenAI.says("Answer: blue box"),
    "ambiguous": FakeOpenAI.says("Answer: red box or blue box"),
    "unread": FakeOpenAI.says("Let me think about it."),
    "cut": FakeOpenAI.says("Answer: red", reason="length"),
    "refused": FakeOpenAI.refuses,
    "no_answer": FakeOpenAI.fails(400),
}
ONCE_EACH = {name: int(name in SAID) for name in OUTCOMES}
TOLD = "1 ambiguous, 1 unread, 1 cut, 1 refused, 1 no answer"


@pytest.fixture
def server(monkeypatch):
    with serving() as served:
        monkeypatch.setenv("VLLM_BASE_URL", served.url)
        yield served


@pytest.fixture
def room(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "room.yaml"
    file.write_text(ROOM, encoding="utf-8")
    return file


def test_runs_and_what_is_written_about_them(server, room, capsys):
    server.will(*SAID.values())
    command = ["run", str(room), "--model", "vllm:m", "--world", "scripted", "--repeat", "7"]
    assert run_command_line([*command, "--out", "out"]) == 3
    printed = " ".join(capsys.readouterr().out.split())
    assert "1 of 7 14%" in printed
    report = json.loads((room.parent / "out" / "run.json").read_text(encoding="utf-8"))
    assert report["outcomes"] == ONCE_EACH
    (score,) = report["scores"]
    assert (score["passed"], score["total"]) == (1, 7)
    assert run_command_line(["methods", "out"]) == 0
    assert f"5 rows without an answer to judge ({TOLD})" in capsys.readouterr().out


def test_studies_their_tables_pages_and_statistics(server, room, capsys, monkeypatch):
    server.will(*SAID.values())
    study = bn.Study(str(room), models=["vllm:m"], repeats=7, world="scripted")
    result = study.run("out", jobs=1)
    assert Counter(row["outcome"] for row in result.rows) == Counter(list(SAID))
    (group,) = result.counted(["model"])
    assert {name: group[name] for name in OUTCOMES} == ONCE_EACH
    assert (group["right"], group["judged"]) == (1, 7)
    assert f"5 rows without an answer to judge ({TOLD})" in result.methods()
    page = result.write_page("page.html").read_text(encoding="utf-8")
    assert "1 of 7" in page
    for name in NOT_ANSWERED:
        assert f"<th>{name.replace('_', ' ')}</th>" in page
    monkeypatch.setenv("COLUMNS", "100")
    assert run_command_line(["stats", "out"]) == 0
    printed = " ".join(capsys.readouterr().out.split())
    assert "judged 7 right 1 accuracy 0.143" in printed
    assert "ambiguous 1 unread 1 cut 1 refused 1 no answer 1" in printed


def test_statistics_name_only_what_occurred(server, room, capsys):
    server.will(SAID["ok"], SAID["unread"])
    study = bn.Study(str(room), models=["vllm:m"], repeats=2, world="scripted")
    study.run("out", jobs=1)
    assert run_command_line(["stats", "out"]) == 0
    printed = capsys.readouterr().out
    assert "unread" in printed
    assert "refused" not in printed


@pytest.mark.extra("matplotlib")
@pytest.mark.parametrize(
    ("outcomes", "told"),
    [
        (tuple(SAID), f"not answered, of 7: {TOLD}"),
        (("ok", "unread"), "not answered, of 2: 1 unread"),
    ],
)
def test_figures_of_studies(server, room, outcomes, told):
    server.will(*(SAID[each] for each in outcomes))
    study = bn.Study(str(room), models=["vllm:m"], repeats=len(outcomes), world="scripted")
    assert told in study.run("out", jobs=1).plot().axes[0].get_xlabel()


def test_episodes_tell_in_which_rounds_a_model_gave_no_program(server, room, capsys):
    # A model is asked again once after an answer without a program.
    twice = ("unread", "cut", "refused")
    behaviours = [SAID[name] for name in twice for _ in range(2)]
    server.will(*behaviours, SAID["no_answer"])
    command = ["play", "help-find", "--agent", "anne=model:vllm:m:0", "--rounds", "4"]
    assert run_command_line([*command, "--world", "scripted", "--out", "out"]) == 3
    printed = capsys.readouterr()
    assert "rounds without a program of a model: 1 unread, 1 cut, 1 refused, 1 no answer" in (
        printed.out
    )
    assert "models were asked again 3 times" in printed.out
    lines = printed.out.splitlines()
    for number, name in enumerate((*twice, "no answer"), start=1):
        (line,) = [line for line in lines if line.split()[:2] == [str(number), "anne"]]
        assert line.rstrip().endswith(name)
    idle = FakeOpenAI.says("```js\nawait doNothing(bot);\n```")
    server.will(*behaviours, idle)
    server.requests.clear()
    policies = [{"anne": "model:vllm:m:0"}]
    study = bn.Study(tasks=["help-find"], policies=policies, world="scripted", seeds=[0])
    result = study.run("study", jobs=1)
    (row,) = result.rows
    assert json.loads(row["not_answered"]) == list(twice)
    told = "Models gave no program in 3 rounds (1 unread, 1 cut, 1 refused)."
    assert told in result.methods()
