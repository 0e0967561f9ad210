"""Code in a supplement: digests first, a list of what would run, and nothing without trust."""

import json
import zipfile
from pathlib import Path

import pytest

from beliefnest.cli.app import run_command_line

pytestmark = pytest.mark.usefixtures("kept_worlds")

POLICY = """\
from pathlib import Path

Path("{mark}").write_text("ran")


class Idle:
    def act(self, view):
        return "await doNothing(bot)"
"""
STUDY = "tasks: [tell-what-is-needed]\npolicies: ['idle.py:Idle']\nseeds: 1\n"


@pytest.fixture(scope="module")
def mark(tmp_path_factory):
    return tmp_path_factory.mktemp("marks") / "ran"


@pytest.fixture(scope="module")
def bundled(tmp_path_factory, mark, kept_worlds):
    """Supplement of episodes that a policy in a file played."""
    folder = tmp_path_factory.mktemp("episodes")
    (folder / "idle.py").write_text(POLICY.format(mark=mark), encoding="utf-8")
    (folder / "study.yaml").write_text(STUDY, encoding="utf-8")
    out = folder / "out"
    command = ["study", str(folder / "study.yaml"), "--jobs", "1", "--out", str(out)]
    assert run_command_line(command) in (0, 1)
    assert run_command_line(["bundle", str(out), "-o", str(folder / "s.zip")]) == 0
    return folder / "s.zip"


@pytest.fixture
def unpacked(bundled, mark, tmp_path):
    mark.unlink(missing_ok=True)
    with zipfile.ZipFile(bundled) as archive:
        archive.extractall(tmp_path / "s")
    return tmp_path / "s"


def test_code_is_listed_and_not_run(bundled, mark, capsys):
    mark.unlink(missing_ok=True)
    assert run_command_line(["reproduce", str(bundled)]) == 2
    told = capsys.readouterr().err
    assert "inputs/policies/idle.py: 8 lines, SHA-256 " in told
    assert "--trust" in told
    assert not mark.exists()


def test_trusted_code_runs_after_the_list(unpacked, capsys):
    assert run_command_line(["reproduce", str(unpacked), "--trust"]) == 0
    told = capsys.readouterr()
    assert "runs Python code: inputs/policies/idle.py: 8 lines" in told.err
    assert told.out.startswith("equal: ")
    assert "\ncompared: " in told.out
    assert "\nnot compared: " in told.out


def test_code_that_is_not_what_was_bundled_never_runs(unpacked, mark, capsys):
    file = unpacked / "inputs" / "policies" / "idle.py"
    file.write_text(file.read_text("utf-8") + "# more\n", encoding="utf-8")
    assert run_command_line(["reproduce", str(unpacked), "--trust"]) == 2
    assert "idle.py has changed" in capsys.readouterr().err
    assert not mark.exists()


def test_a_file_that_was_added_is_told(unpacked, capsys):
    (unpacked / "inputs" / "policies" / "more.py").write_text("", encoding="utf-8")
    assert run_command_line(["reproduce", str(unpacked), "--trust"]) == 2
    assert "more.py is not in the manifest" in capsys.readouterr().err


def changed_plan(folder: Path, change) -> None:
    file = folder / "study.json"
    plan = json.loads(file.read_text("utf-8"))
    change(plan)
    file.write_text(json.dumps(plan), encoding="utf-8")
    (folder / "bundle.json").unlink()


def test_an_input_outside_of_the_supplement_is_refused(unpacked, tmp_path, capsys):
    (tmp_path / "other.py").write_text("", encoding="utf-8")
    changed_plan(
        unpacked, lambda plan: plan["inputs"]["policies"].update({"idle.py:Idle": "../other.py"})
    )
    assert run_command_line(["reproduce", str(unpacked)]) == 2
    assert "not inside of it" in capsys.readouterr().err


def test_a_task_outside_of_the_supplement_is_refused(unpacked, tmp_path, capsys):
    def elsewhere(plan):
        for cell in plan["cells"]:
            cell["key"]["task"] = str(tmp_path / "task.yaml")

    changed_plan(unpacked, elsewhere)
    assert run_command_line(["reproduce", str(unpacked), "--trust"]) == 2
    assert "is not among the inputs" in capsys.readouterr().err


def test_another_kind_of_results_is_refused(unpacked, capsys):
    file = unpacked / "bundle.json"
    manifest = json.loads(file.read_text("utf-8"))
    file.write_text(json.dumps({**manifest, "kind": "run"}), encoding="utf-8")
    assert run_command_line(["reproduce", str(unpacked)]) == 2
    assert "the folder holds a study" in capsys.readouterr().err
