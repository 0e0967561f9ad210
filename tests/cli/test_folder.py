"""A run needs nothing but its folder: what it was asked, and all that it read, is kept in it."""

import json
import random
import shutil
from pathlib import Path

import pytest
from tests.profiles import at_night

import beliefnest as bn
from beliefnest.cli.app import run_command_line

pytestmark = pytest.mark.usefixtures("kept_worlds")

ROOM = """\
name: room
box: [[0, 0, 0], [6, 3, 6]]
blocks:
  - {block: stone, fill: [[0, 0, 0], [6, 0, 6]]}
containers:
  - {label: apple box, at: [3, 1, 3], items: {apple: 1}}
agents:
  ann: {position: [1.5, 1, 1.5]}
  bob: {position: [5.5, 1, 5.5]}
probes:
  - path: /ann/bob
    acts_in: /ann
    agent: bob
    task: Get an apple.
    template: ../texts/short.txt
    expect: {opens: [3, 1, 3]}
"""
TEMPLATE = "{{ branch.state.owner }}: {{ task }}"
TAKE = "```javascript\nawait getItemFromChest(bot, new Vec3(3, 1, 3), {apple: 1})\n```"
STORE = Path("run", "run.bn")
DAMAGED = at_night(2000, 40)


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Make a run that failed half-way, and the same continued; remove their originals."""
    with pytest.MonkeyPatch.context() as patch:
        folder = tmp_path_factory.mktemp("kept")
        patch.chdir(folder)
        Path("texts").mkdir()
        Path("mine").mkdir()
        Path("texts/short.txt").write_text(TEMPLATE, encoding="utf-8")
        Path("mine/room.yaml").write_text(ROOM, encoding="utf-8")
        answers = Path("answers.json")
        command = ["run", "mine/room.yaml", "--model", f"scripted:{answers}", "--out", "done"]
        answers.write_text(json.dumps(["I cannot [/]\x1b[31m."]), encoding="utf-8")
        assert run_command_line([*command, "--cache", "off"]) == 3
        shutil.copytree("done", "failed")
        shutil.rmtree("texts")
        answers.write_text(json.dumps([TAKE]), encoding="utf-8")
        assert run_command_line([*command, "--cache", "off"]) == 0
        shutil.rmtree("mine")
        answers.unlink()
        return folder / "failed", folder / "done"


def test_a_run_goes_on_without_the_template_it_began_with(kept: tuple[Path, Path]) -> None:
    _, done = kept
    with bn.Nest.read(done / STORE) as nest:
        (asked,) = nest.prompts()
    assert asked.messages[-1] == ("user", "bob: Get an apple.")
    assert asked.answer == TAKE


def test_what_a_model_failed_at_is_kept(kept: tuple[Path, Path]) -> None:
    failed, _ = kept
    with bn.Nest.read(failed / STORE) as nest:
        first, second = nest.prompts()
    assert (first.path, first.attempt, first.error) == (("ann", "bob"), 1, None)
    assert (second.attempt, second.answer) == (2, None)
    assert "no answer left" in str(second.error)
    assert first.detail == {"probe": "probe 1", "task": "Get an apple."}


def test_what_was_asked_is_shown(
    kept: tuple[Path, Path], capsys: pytest.CaptureFixture[str]
) -> None:
    failed, done = kept
    assert run_command_line(["show", str(failed), "--path", "/ann/bob"]) == 0
    printed = capsys.readouterr().out
    assert r"I cannot [/]\u001b[31m." in printed
    assert "no answer left" in printed
    assert run_command_line(["show", str(done), "--path", "/ann/bob", "--json"]) == 0
    (asked,) = json.loads(capsys.readouterr().out)["prompts"]
    assert (asked["attempt"], asked["answer"]) == (1, TAKE)
    assert run_command_line(["show", str(done), "--path", "/ann", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["prompts"] == []


def test_a_run_file_alone_is_shown_with_names(
    kept: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    _, done = kept
    alone = shutil.copy(done / STORE, tmp_path / "moved.bn")
    assert run_command_line(["show", str(alone), "--path", "/ann"]) == 0
    assert "apple box" in capsys.readouterr().out
    assert run_command_line(["show", str(alone), "--png", str(tmp_path / "room.png")]) == 0


def test_its_prompt_is_rendered_and_its_programs_are_replayed(
    kept: tuple[Path, Path], capsys: pytest.CaptureFixture[str]
) -> None:
    _, done = kept
    command = ["prompt", str(done), "--path", "/ann/bob", "--var", "task=Get an apple."]
    assert run_command_line(command) == 0
    assert "Task: Get an apple." in capsys.readouterr().out
    own = [*command, "--template", "../texts/short.txt"]
    assert run_command_line(own) == 0
    assert capsys.readouterr().out == "bob: Get an apple.\n"
    assert run_command_line(["replay", str(done)]) == 0


def test_the_scenario_in_its_folder_is_whole(kept: tuple[Path, Path]) -> None:
    _, done = kept
    scenario = bn.Scenario.load(str(done / "scenario.yaml"))
    assert scenario.probes[0].template == TEMPLATE
    assert scenario.text == ROOM


def test_a_run_goes_on_only_with_the_template_it_began_with(
    kept: tuple[Path, Path],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    shutil.copytree(kept[0], "failed")
    Path("texts").mkdir()
    Path("mine").mkdir()
    Path("texts/short.txt").write_text("another one", encoding="utf-8")
    Path("mine/room.yaml").write_text(ROOM, encoding="utf-8")
    Path("answers.json").write_text("[]", encoding="utf-8")
    command = ["run", "mine/room.yaml", "--model", "scripted:answers.json", "--out", "failed"]
    assert run_command_line(command) == 2
    assert "another template" in capsys.readouterr().err


@pytest.mark.parametrize("command", [["methods"], ["run", "x.yaml"]])
def test_the_folder_of_an_earlier_version_is_refused(
    kept: tuple[Path, Path],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    command: list[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    shutil.copytree(kept[0], "failed")
    # Results were in the folders of conditions.
    shutil.rmtree("failed/cells")
    Path("failed/study.json").unlink()
    Path("x.yaml").write_text(ROOM.replace("../texts/short.txt", "default"), encoding="utf-8")
    name, *others = command
    folder = ["--out", "failed"] if name == "run" else ["failed"]
    assert run_command_line([name, *others, *folder]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "failed holds a run of an earlier version; run it again in a new folder" in line


def test_a_run_whose_result_lacks_a_key_is_refused(
    kept: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "done"
    shutil.copytree(kept[1], folder)
    (cell,) = (folder / "cells").iterdir()
    result = json.loads(cell.read_text(encoding="utf-8"))
    del result["condition"]
    cell.write_text(json.dumps(result), encoding="utf-8")
    assert run_command_line(["methods", str(folder)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert f"{cell.name} is damaged" in line
    assert "'condition'" in line


def test_all_that_ran_is_exported_with_its_versions(
    kept: tuple[Path, Path], tmp_path: Path
) -> None:
    _, done = kept
    out = tmp_path / "tables"
    assert run_command_line(["export", str(done), "--out", str(out)]) == 0
    tables = {
        name: [json.loads(line) for line in (out / f"{name}.jsonl").read_text().splitlines()]
        for name in ("run", "programs", "prompts")
    }
    (run,) = tables["run"]
    assert (run["scenario"], run["seed"], run["text"]) == ("room", 0, ROOM)
    assert run["templates"] == {"../texts/short.txt": TEMPLATE}
    (versions,) = run["versions"]
    assert {"beliefnest", "python", "numba", "node", "minecraft", "mineflayer", "flying_squid"} <= (
        versions.keys()
    )
    (program,) = tables["programs"]
    assert (program["path"], program["branch"], program["agent"]) == ("/ann", "probe 1", "bob")
    (prompt,) = tables["prompts"]
    assert (prompt["path"], prompt["timeline_path"]) == ("/ann/bob", "/")


def exported(store: Path, out: Path) -> dict[str, bytes] | None:
    """All tables of a run with two of its beliefs; None if it is refused."""
    paths = [part for path in ("/", "/ann/bob") for part in ("--path", path)]
    if run_command_line(["export", str(store), "--out", str(out), *paths]) != 0:
        assert not out.exists()
        return None
    return {file.name: file.read_bytes() for file in out.iterdir()}


@pytest.fixture(scope="module")
def whole(kept: tuple[Path, Path], tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    tables = exported(kept[1] / STORE, tmp_path_factory.mktemp("whole") / "tables")
    assert tables is not None
    return tables


@pytest.mark.parametrize("seed", range(DAMAGED))
def test_a_damaged_run_is_refused_or_read_as_it_was(
    kept: tuple[Path, Path],
    whole: dict[str, bytes],
    seed: int,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    chance = random.Random(seed)
    data = bytearray((kept[1] / STORE).read_bytes())
    for _ in range(chance.choice((1, 10, 100))):
        data[chance.randrange(len(data))] ^= chance.randrange(1, 256)
    if seed % 4 == 0:
        begin = chance.randrange(len(data))
        data[begin : begin + 512] = bytes(len(data[begin : begin + 512]))
    store = tmp_path / "run.bn"
    store.write_bytes(data)
    found = exported(store, tmp_path / "tables")
    if found is None:
        (line,) = capsys.readouterr().err.splitlines()
        assert str(store) in line
    else:
        assert found == whole


def test_a_run_that_goes_on_prints_the_whole_table(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    room = ROOM.replace("    template: ../texts/short.txt\n", "")
    Path("room.yaml").write_text(
        f"{room}conditions: {{1: {{description: first}}, 2: {{description: second}}}}\n",
        encoding="utf-8",
    )
    answers = Path("answers.json")
    command = ["run", "room.yaml", "--model", f"scripted:{answers}", "--cache", "off"]
    # The file has no answer for the second condition at first.
    answers.write_text(json.dumps([TAKE]), encoding="utf-8")
    assert run_command_line([*command, "--out", "run"]) == 3
    capsys.readouterr()
    assert run_command_line([*command, "--out", "run"]) == 0
    printed = capsys.readouterr().out
    assert "predicted bob opens" in printed
    assert printed.count("apple box") == 2
