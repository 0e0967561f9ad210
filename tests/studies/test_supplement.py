"""Supplements: played again without models, damage found, no secrets; and methods paragraphs."""

import json
import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from tests.llm.conftest import FakeOpenAI, serving
from tests.studies.small import small_in, study_in

import beliefnest as bn
from beliefnest.cli.app import run_command_line

STUDY = """\
scenarios: [small.yaml]
models: ['vllm:m']
templates: [mine.txt]
world: scripted
variations: {spot: [[1, 1, 1], [5, 1, 1], [5, 1, 5]], symmetry: [as-written, mirrored]}
"""
LEFT = "```javascript\nawait getItemFromChest(bot, new Vec3(1, 1, 1), {diamond: 1});\n```"
KEY = "sk-a-secret-of-this-machine"


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """Folder of a study whose model answered once for all, and is gone."""
    folder = tmp_path_factory.mktemp("recorded")
    study = study_in(folder, STUDY)
    (folder / "mine.txt").write_text("{{ task }} Chests hold it.", encoding="utf-8")
    with pytest.MonkeyPatch.context() as patch, serving() as server:
        patch.setenv("VLLM_BASE_URL", server.url)
        server.will(FakeOpenAI.says(LEFT))
        assert (
            run_command_line(["study", str(study), "--out", str(folder / "out"), "--jobs", "1"])
            == 1
        )
    # The supplement does not need the original files.
    for file in folder.glob("*.*"):
        file.unlink()
    return folder / "out"


@pytest.fixture
def unpacked(recorded, tmp_path):
    bn.StudyResult.read(recorded).bundle(tmp_path / "s.zip")
    with zipfile.ZipFile(tmp_path / "s.zip") as archive:
        archive.extractall(tmp_path / "s")
    return tmp_path / "s"


def test_equal_bytes_of_a_supplement_that_is_played_again_elsewhere(recorded, unpacked, tmp_path):
    bn.StudyResult.read(recorded).bundle(tmp_path / "again.zip")
    assert (tmp_path / "again.zip").read_bytes() == (tmp_path / "s.zip").read_bytes()
    command = [sys.executable, "-m", "beliefnest", "reproduce", "../s.zip", "--json"]
    done = subprocess.run(command, cwd=unpacked, capture_output=True, text=True, check=True)
    told = json.loads(done.stdout)
    assert (told["equal"], told["cells"], told["rows"]) == (True, 4, 4)
    assert told["other_versions"] == {}
    assert bn.StudyResult.read(unpacked).frame().equals(bn.StudyResult.read(recorded).frame())
    readme = (unpacked / "README.md").read_text("utf-8")
    for name in re.findall(r"^\| `(.*?)`", readme, re.MULTILINE):
        assert (unpacked / name).exists(), name


def damage(folder, pattern, old, new):
    file = sorted(folder.glob(pattern))[0]
    text = file.read_text("utf-8")
    assert old in text
    file.write_text(text.replace(old, new, 1), encoding="utf-8")
    return file.relative_to(folder).as_posix()


@pytest.mark.parametrize(
    ("pattern", "old", "new", "told"),
    [
        ("rows.csv", ",True,", ",False,", r"rows\.csv:\d: ok is 'False', now 'True'"),
        ("cells/*.json", '"ticks": ', '"ticks": 9', r"probe 1: ticks is 9\d+, now"),
        ("answers/*.json", "Vec3(1, 1, 1)", "Vec3(1, 1, 2)", r"cells/.*: program is "),
        pytest.param(
            *("figure.svg", "<svg", "<svg ", r"figure\.svg has changed"),
            marks=pytest.mark.extra("matplotlib"),
        ),
    ],
)
def test_damage_is_found_and_its_place_told(unpacked, capsys, pattern, old, new, told):
    name = damage(unpacked, pattern, old, new)
    assert run_command_line(["reproduce", str(unpacked)]) == 1
    out = capsys.readouterr().out
    assert f"{name} has changed" in out
    assert re.search(told, out), out
    assert "NOT EQUAL" in out


def test_a_missing_answer_and_changed_inputs_are_told(unpacked, capsys):
    next(unpacked.glob("answers/*.json")).unlink()
    assert run_command_line(["reproduce", str(unpacked)]) == 1
    assert "no result now: the cache has no answer of vllm:m" in capsys.readouterr().out
    damage(unpacked, "inputs/templates/*", "Chests", "Boxes")
    assert run_command_line(["reproduce", str(unpacked)]) == 2
    assert "has changed since the cell was played" in capsys.readouterr().err


def test_a_key_of_this_machine_is_refused(recorded, tmp_path, monkeypatch, capsys):
    folder = Path(shutil.copytree(recorded, tmp_path / "with-key"))
    damage(folder, "inputs/study.yaml", "models", f"# {KEY}\nmodels")
    monkeypatch.setenv("OPENAI_API_KEY", KEY)
    assert run_command_line(["bundle", str(folder), "-o", str(tmp_path / "s.zip")]) == 2
    told = capsys.readouterr().err
    assert "inputs/study.yaml contains a key or password" in told
    assert KEY not in told
    assert not (tmp_path / "s.zip").exists()


def test_the_paragraph_has_recorded_facts_in_markdown_and_latex(recorded, capsys):
    assert run_command_line(["methods", str(recorded)]) == 0
    told = capsys.readouterr().out
    dates = {json.loads(f.read_bytes())["date"] for f in recorded.glob("answers/*.json")}
    for fact in (
        "all valid combinations of `spot` (3 values) and `symmetry` (2 values)",
        "This makes 4 cells and 4 rows; all random numbers derive from seed 0.",
        f"`vllm:m` gave 4 recorded answers on {min(dates)} (UTC).",
        "The answers used 600 tokens and cost 0.00 US dollars.",
        "Excluded were 2 combinations that make no valid scenario or episode.",
        "4 rows of 4 independent variations are judged.",
        f"BeliefNest {bn.__version__}",
    ):
        assert fact in told, (fact, told)
    assert re.search(r"templates? `.*mine\.txt` \(SHA-256 [0-9a-f]{12}\)", told)
    assert run_command_line(["methods", str(recorded), "--format", "latex"]) == 0
    latex = capsys.readouterr().out
    assert r"\texttt{vllm:m}" in latex
    assert not re.search(r"(?<!\\)[%_&#]", latex)


def test_what_is_no_study_or_supplement_is_told(tmp_path, capsys):
    small = small_in(tmp_path)
    out = tmp_path / "run"
    assert run_command_line(["run", small, "--world", "scripted", "--out", str(out)]) == 0
    assert run_command_line(["stats", str(tmp_path)]) == 2
    assert "there is no study at" in capsys.readouterr().err
    assert run_command_line(["reproduce", str(tmp_path / "nothing.zip")]) == 2
    told = capsys.readouterr().err
    assert "there is no file" in told
    assert "Errno" not in told


def test_a_run_is_bundled_and_played_again(tmp_path, capsys):
    small = small_in(tmp_path)
    (tmp_path / "answers.json").write_text(json.dumps(["no", LEFT]), encoding="utf-8")
    model = f"scripted:{tmp_path / 'answers.json'}"
    command = ["run", small, "--world", "scripted", "--model", model, "--out", str(tmp_path / "r")]
    assert run_command_line(command) == 0
    assert run_command_line(["bundle", str(tmp_path / "r"), "-o", str(tmp_path / "r.zip")]) == 0
    Path(small).unlink()
    (tmp_path / "answers.json").unlink()
    capsys.readouterr()
    assert run_command_line(["stats", str(tmp_path / "r"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["summary"][0]["right"] == 1
    assert run_command_line(["reproduce", str(tmp_path / "r.zip"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["rows"] == 1
    damage(tmp_path / "r", "model.jsonl", "Vec3(1, 1, 1)", "Vec3(1, 1, 2)")
    assert run_command_line(["reproduce", str(tmp_path / "r")]) == 1
    assert re.search(r"cells/\w+.json: ok is True, now False", capsys.readouterr().out)


def test_episodes_with_a_program_of_a_file_are_played_again(tmp_path):
    (tmp_path / "go.js").write_text("await wait(bot, 1);", encoding="utf-8")
    program = f"program:{tmp_path / 'go.js'}"
    study = bn.Study(tasks="help-find", policies=["random", program])
    result = study.run(tmp_path / "out", jobs=1)
    (tmp_path / "go.js").unlink()
    found = result.reproduce()
    assert (found.cells, found.differences) == (2, ())


def test_what_is_no_supplement_is_refused(tmp_path, capsys):
    (tmp_path / "x.zip").write_bytes(b"PK no")
    for command, told in (
        (["reproduce", str(tmp_path / "x.zip")], "cannot be unpacked"),
        (["reproduce", str(tmp_path)], "neither a study nor a run"),
        (["bundle", str(tmp_path)], "neither a study nor a run"),
        (["methods", str(tmp_path)], "neither a study nor a run"),
        (["reproduce", str(tmp_path), "--copies", "2"], "leave them out"),
    ):
        assert run_command_line(command) == 2
        assert told in capsys.readouterr().err
