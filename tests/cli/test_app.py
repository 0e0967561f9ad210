"""The command line: what it prints, writes, and ends with."""

import json
import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from PIL import Image
from tests.profiles import few_by_day
from tests.servers import GameServer

from beliefnest.cli.app import app, run_command_line
from beliefnest.cli.folder import store_in
from beliefnest.errors import InputError
from beliefnest.timeline.store import Journal

pytestmark = pytest.mark.usefixtures("kept_worlds")

SECONDS = 120

ROOM = """\
name: room
box: [[0, 0, 0], [6, 3, 6]]
blocks:
  - {block: stone, fill: [[0, 0, 0], [6, 0, 6]]}
containers:
  - {label: box, at: [3, 1, 3], items: {apple: 1}}
agents:
  ann: {position: [1.5, 1, 1.5]}
script:
  - label: ann takes the apple
    agent: ann
    program: |
      await getItemFromChest(bot, new Vec3(3, 1, 3), {apple: 1});
expectations:
  - {path: /ann, container: [3, 1, 3], items: {}}
"""


@pytest.fixture(autouse=True)
def in_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def scenario(text: str) -> str:
    Path("room.yaml").write_text(text, encoding="utf-8")
    return "room.yaml"


def test_run_writes_a_folder_and_prints_the_report(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    status = run_command_line(["run", "sally-anne", "--condition", "3", "--out", "r", "--json"])
    printed = capsys.readouterr()
    report = json.loads(printed.out)
    assert status == 0
    assert "condition 3" in printed.err
    assert (report["scenario"], report["world"], report["model"]) == (
        "sally-anne",
        "embedded",
        "offline",
    )
    (run,) = report["runs"]
    assert (run["condition"], run["seed"], run["ok"]) == (3, 0, True)
    assert run["reality"]["containers"]["2,-51,-4"]["items"] == {"diamond": 1}
    assert run["reality"]["agents"]["sally"]["current"] is True
    assert set(run["beliefs"]) == {"/observer", "/sally", "/observer/sally"}
    assert run["beliefs"]["/observer/sally"]["containers"]["-2,-51,-4"] == {
        "items": {"diamond": 1},
        "complete": False,
    }
    assert run["beliefs"]["/observer"]["agents"]["sally"]["current"] is False
    (probe,) = run["probes"]
    assert (probe["path"], probe["acts_in"], probe["agent"]) == (
        "/observer/sally",
        "/observer",
        "sally",
    )
    assert probe["opened"] == [[-2, -51, -4]]
    assert probe["ok"] is True
    folder = tmp_path / run["run_dir"]
    (cell,) = Path("r/cells").iterdir()
    result = json.loads(cell.read_text())
    assert {**run, "key": result["key"], "error": None, "run": "condition-3/run.bn"} == result
    assert json.loads(Path("r/run.json").read_text()) == report
    assert probe["program"] == (folder / "probe-1" / "program.js").read_text()
    assert "Get a diamond" in (folder / "probe-1" / "prompt.txt").read_text()
    with Image.open(folder / "picture.png") as picture:
        assert picture.width > 1000
    with Journal.read(folder / "run.bn") as journal:
        branches = {(info.key.path, info.key.branch) for info in journal.timelines()}
    assert (("observer",), "probe 1") in branches


def test_run_prints_a_table(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command_line(["run", scenario(ROOM), "--out", "r"]) == 0
    printed = capsys.readouterr().out
    assert "as expected" in printed
    assert "nothing" in printed
    assert Path("r/summary.txt").read_text() == printed
    assert Path("r/run/picture.png").is_file()
    assert Path("r/scenario.yaml").read_text() == ROOM


def test_an_expectation_that_does_not_hold_ends_with_1(capsys: pytest.CaptureFixture[str]) -> None:
    wrong = ROOM.replace("items: {}}", "items: {apple: 1}}")
    assert run_command_line(["run", scenario(wrong), "--out", "r"]) == 1
    assert "NO: /ann: " in capsys.readouterr().out
    assert json.loads(Path("r/run.json").read_text())["runs"][0]["ok"] is False


@pytest.mark.parametrize(
    ("arguments", "hints"),
    [
        (["run", "sally-ann"], ["sally-anne"]),
        (["run", "missing.yaml"], ["missing.yaml", "No such file"]),
        (["run", "sally-anne", "--condition", "9"], ["condition 9", "1, 2, 3"]),
        (["run", "sally-anne", "--condition", "one"], ["--condition"]),
        (["run", "sally-anne", "--world", "flat"], ["flat", "embedded"]),
        (["run", "sally-anne", "--model", "oracle"], ["oracle", "offline"]),
        (["run"], ["scenario"]),
        (["jump"], ["jump"]),
        (["run", "sally-anne", "--jump"], ["--jump"]),
        (["run", str(Path(__file__).parent)], ["is a folder", ".yaml"]),
        (["bench", "nothing"], ["nothing", "sally-anne"]),
        (["study", "study.yaml", "--jobs", "0"], ["--jobs"]),
        (["study", "study.yaml", "--shard", "9/4"], ["shard 9 of 4"]),
    ],
)
def test_wrong_usage_is_one_line_and_2(
    capsys: pytest.CaptureFixture[str], arguments: list[str], hints: list[str]
) -> None:
    assert run_command_line(arguments) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    (line,) = printed.err.splitlines()
    assert line.startswith("beliefnest: ")
    for hint in hints:
        assert hint in line
    assert not Path("runs").exists()


@pytest.mark.parametrize(
    ("old", "new", "hints"),
    [
        ("block: stone", "block: stoen", ["room.yaml:4:", "stone"]),
        ("at: [3, 1, 3]", "at: [3, 1, 7]", ["room.yaml:6:", "outside"]),
        ("[1.5, 1, 1.5]", "[3.5, 1, 3.5]", ["room.yaml:8:", "chest"]),
        ("agent: ann\n", "agent: anna\n", ["room.yaml:11:", "ann"]),
        ("agents:\n", "agents: [\n", ["room.yaml:", "broken YAML"]),
    ],
)
def test_a_wrong_scenario_is_one_line_and_2(
    capsys: pytest.CaptureFixture[str], old: str, new: str, hints: list[str]
) -> None:
    assert run_command_line(["run", scenario(ROOM.replace(old, new))]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    for hint in hints:
        assert hint in line
    assert not Path("runs").exists()


@pytest.mark.parametrize(
    ("program", "hint"),
    [
        ("await getItemFromChest(bot, new Vec3(3, 1, 3), {diamond: 1});", "diamond"),
        ("\n      await nowhere(bot);", "line 2"),
        ("await goToPosition(bot;", "line 1"),
    ],
)
def test_a_script_whose_program_fails_names_step_place_and_line(
    capsys: pytest.CaptureFixture[str], program: str, hint: str
) -> None:
    failing = ROOM.replace("await getItemFromChest(bot, new Vec3(3, 1, 3), {apple: 1});", program)
    assert run_command_line(["run", scenario(failing), "--out", "r"]) == 2
    line = capsys.readouterr().err.splitlines()[-1]
    assert line.startswith("beliefnest: room.yaml:10: step 1 (ann takes the apple)")
    assert hint in line
    assert json.loads(Path("r/run.json").read_text())["status"] == "failed"


def test_a_run_folder_that_is_in_use_is_left_alone(capsys: pytest.CaptureFixture[str]) -> None:
    Path("r").mkdir()
    Path("r/mine.txt").write_text("mine")
    assert run_command_line(["run", scenario(ROOM), "--out", "r"]) == 2
    assert "not empty" in capsys.readouterr().err
    assert [path.name for path in Path("r").iterdir()] == ["mine.txt"]


def test_the_store_of_a_run_is_found_in_its_folders(tmp_path: Path) -> None:
    for folder in ("one", "two"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "run.bn").touch()
    assert store_in(tmp_path / "one") == tmp_path / "one" / "run.bn"
    assert store_in(tmp_path / "one" / "run.bn") == tmp_path / "one" / "run.bn"
    with pytest.raises(InputError, match="several runs"):
        store_in(tmp_path)
    with pytest.raises(InputError, match="no run at"):
        store_in(tmp_path / "three")


def test_list_names_what_there_is(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command_line(["list", "--json"]) == 0
    listed = json.loads(capsys.readouterr().out)
    assert "sally-anne" in [each["name"] for each in listed["scenarios"]]
    assert "embedded" in listed["worlds"]
    assert "offline" in listed["models"]
    assert "watchman" in listed["tasks"]
    assert "hi-tom" in listed["suites"]
    assert "default" in listed["templates"]


def test_doctor_finds_everything_in_order(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command_line(["doctor"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[1] for line in lines] == [
        "Python:",
        "Node:",
        "bundle:",
        "sight:",
        "kernels:",
        "world:",
        "model:",
        "limits:",
        "folder:",
        "modules:",
        "routes:",
    ]
    assert all(line.startswith("ok") for line in lines)


@pytest.mark.long
def test_doctor_checks_a_server(capsys: pytest.CaptureFixture[str]) -> None:
    with GameServer() as server:
        assert run_command_line(["doctor", server.address(patience=5)]) == 0
        lines = capsys.readouterr().out.splitlines()
        assert lines[-2].startswith("ok    server: 127.0.0.1:")
        assert lines[-1].startswith("ok    place there: a floor and a chest")
        server.type("deop BeliefNest")
        assert run_command_line(["doctor", server.address(patience=3)]) == 3
        lines = capsys.readouterr().out.splitlines()
        assert lines[-2].startswith("FAIL  server: on the server")
        assert "op BeliefNest" in lines[-2]
    assert run_command_line(["doctor", "localhost"]) == 2


def test_doctor_compiles_what_the_first_belief_would_wait_for(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert run_command_line(["doctor", "--warm"]) == 0
    printed = capsys.readouterr()
    assert "ok    kernels: compiled, kept in /" in printed.out
    assert "compiling" in printed.err


def test_doctor_says_what_to_do_about_a_missing_bundle(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr("beliefnest.worlds.minecraft.node_files._BUNDLE", tmp_path)
    assert run_command_line(["doctor"]) == 3
    failed = [line for line in capsys.readouterr().out.splitlines() if line.startswith("FAIL")]
    assert failed
    assert all("pip install" in line for line in failed)


@pytest.mark.parametrize("whole_group", few_by_day([True, False]))
def test_an_interrupt_ends_everything_and_leaves_a_readable_folder(whole_group: bool) -> None:
    endless = ROOM.replace(
        "await getItemFromChest(bot, new Vec3(3, 1, 3), {apple: 1});",
        "while (true) await bot.waitForTicks(1);",
    ).replace("    agent: ann\n", "    agent: ann\n    timeout_ticks: 10000000\n")
    command = [sys.executable, "-m", "beliefnest", "run", scenario(endless), "--out", "r"]
    with subprocess.Popen(
        command, stderr=subprocess.PIPE, text=True, start_new_session=True
    ) as process:
        try:
            assert process.stderr is not None
            assert "ann takes the apple" in process.stderr.readline()
            (os.killpg if whole_group else os.kill)(process.pid, signal.SIGINT)
            _, errors = process.communicate(timeout=SECONDS)
        finally:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
    assert process.returncode == 130
    assert errors.splitlines()[-1] == "beliefnest: interrupted"
    assert "Traceback" not in errors
    assert json.loads(Path("r/run.json").read_text())["status"] == "interrupted"
    with Journal.read(Path("r/run/run.bn")) as journal:
        assert journal.timelines()
    with pytest.raises(ProcessLookupError):
        os.killpg(process.pid, 0)


COMMANDS = [command.name or command.callback.__name__ for command in app.registered_commands]


@pytest.mark.parametrize("command", [[], *([name] for name in COMMANDS)])
def test_every_command_takes_h_for_help(
    command: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_command_line([*command, "-h"]) == 0
    assert "-h, --help" in capsys.readouterr().out


def test_the_help_lists_each_command_once_in_a_panel(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command_line([]) == 0
    listed = capsys.readouterr().out.partition("Play:\n")[2]
    assert "Other commands" not in listed
    assert sorted(re.findall(r"^  ([\w-]+)  ", listed, re.MULTILINE)) == sorted(COMMANDS)
