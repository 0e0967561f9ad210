"""Whatever stands in a file that a command reads: one line, a documented status, no traceback."""

import errno
import json
import os
import random
import resource
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from tests.profiles import NIGHTLY
from tests.studies.small import study_in

from beliefnest.cli.app import run_command_line

pytestmark = pytest.mark.usefixtures("kept_worlds")

STUDY = "scenarios: [small.yaml]\nworld: scripted\n"
EPISODES = "tasks: [tell-what-is-needed]\npolicies: [random]\nseeds: 1\n"
TRACE = '{"tick": 0, "box": [[0,0,0],[9,3,9]], "agents": {"sally": {"position": [2.5,1,2.5]}}}\n'
RUN = ["run", "sally-anne", "--condition", "3", "--world", "scripted"]
MODEL = [*RUN, "--model"]

BYTES: dict[str, bytes] = {
    "empty": b"",
    "null": b"null",
    "number": b"1",
    "text": b'"x"',
    "list": b"[]",
    "object": b"{}",
    "error only": b'{"error": null}',
    "another shape": b'{"cells": 3, "error": {"x": 1}, "settings": 7, "runs": "x", "form": []}',
    "lists in lists": b"[" * 100_000,
    "half": b'{"error": nu',
    "binary": bytes(range(256)),
    "zeros": bytes(4096),
    "half a character": b'{"error": "\\ud800"}',
    "no text": b'{"error": "\xff\xfe"}',
    "sqlite": b"SQLite format 3\0" + bytes(200),
    "gzip": b"\x1f\x8b" + bytes(50),
}
"""Values that a file may hold in place of the expected one."""


def _folder(path: Path) -> None:
    path.unlink()
    path.mkdir()


def _unreadable(path: Path) -> None:
    path.unlink()
    path.symlink_to(path)


FILMS = json.dumps(
    {
        "worlds": [{"size": [3, 1], "spot1": [1, 1], "spot2": [3, 1], "possible_spot2": ["L"]}],
        "scenarios": [{"id": 1, "true_spot2": "L", "path_xy": [[2, 1]], "ends_with_eat": False}],
    }
)

DAMAGES: dict[str, Callable[[Path], object]] = {
    **{
        name: lambda path, content=content: path.write_bytes(content)
        for name, content in BYTES.items()
    },
    "truncated": lambda path: path.write_bytes(path.read_bytes()[: path.stat().st_size // 2]),
    "a folder": _folder,
    "unreadable": _unreadable,
}


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Make a folder with one of each kind of file that a command reads."""
    folder = tmp_path_factory.mktemp("made")
    before = Path.cwd()
    os.chdir(folder)
    try:
        assert run_command_line([*RUN, "--out", "run"]) == 0
        study_in(Path(), STUDY)
        study = ["study", "study.yaml", "--jobs", "1", "--record", "--out", "st"]
        assert run_command_line(study) in (0, 1)
        Path("episodes.yaml").write_text(EPISODES)
        assert run_command_line(["study", "episodes.yaml", "--jobs", "1", "--out", "ep"]) in (0, 1)
        play = ["play", "tell-what-is-needed", "--rounds", "1", "--out", "played"]
        assert run_command_line(play) in (0, 1)
        Path("trace.jsonl").write_text(TRACE)
        Path("answers.json").write_text('["await doNothing(bot)"]')
        Path("model.jsonl").write_text("{}\n")
        Path("program.js").write_text("await doNothing(bot)")
        Path("template.jinja").write_text("{{ task }}")
        Path("place.schem").write_bytes(b"\x1f\x8b")
        Path("stories.json").write_text("[]")
        Path("films.json").write_text(FILMS)
        yield folder
    finally:
        os.chdir(before)


CASES: dict[str, tuple[str, list[str]]] = {
    "scenario": ("small.yaml", ["run", "small.yaml", "--world", "scripted"]),
    "play a scenario": ("small.yaml", ["play", "small.yaml", "--rounds", "1"]),
    "study": ("study.yaml", ["study", "study.yaml", "--jobs", "1", "--out", "other"]),
    "cell": ("st/cells/*.json", ["study", "study.yaml", "--jobs", "1", "--out", "st"]),
    "plan": ("st/study.json", ["study", "study.yaml", "--jobs", "1", "--out", "st"]),
    "seconds": ("st/seconds.jsonl", ["study", "study.yaml", "--jobs", "1", "--out", "st"]),
    "spent": ("st/spent.jsonl", ["study", "study.yaml", "--jobs", "1", "--out", "st"]),
    "episode cell": ("ep/cells/*.json", ["study", "episodes.yaml", "--jobs", "1", "--out", "ep"]),
    "episode plan": ("ep/study.json", ["study", "episodes.yaml", "--jobs", "1", "--out", "ep"]),
    "merged cell": (
        "st/cells/*.json",
        ["study", "study.yaml", "--jobs", "1", "--out", "merged", "--merge", "st"],
    ),
    "replayed study": ("st/runs/*.bn", ["replay", "st"]),
    "plan of a run": ("run/study.json", [*RUN, "--out", "run"]),
    "result": ("run/cells/*.json", [*RUN, "--out", "run"]),
    "kept scenario": ("run/scenario.yaml", [*RUN, "--out", "run"]),
    "show": ("run/condition-3/run.bn", ["show", "run"]),
    "page": ("run/condition-3/run.bn", ["show", "run", "--html", "page.html"]),
    "page of a report": ("run/run.json", ["show", "run", "--html", "page.html"]),
    "branches": ("run/condition-3/run.bn", ["branches", "run"]),
    "replay": ("run/condition-3/run.bn", ["replay", "run"]),
    "export": ("run/condition-3/run.bn", ["export", "run", "--out", "tables"]),
    "prompt": ("run/condition-3/run.bn", ["prompt", "run", "--path", "/anne"]),
    "serve": ("run/condition-3/run.bn", ["serve", "run/condition-3/run.bn", "--port", "99999999"]),
    "template": (
        "template.jinja",
        ["prompt", "run", "--path", "/anne", "--template", "template.jinja", "--var", "task=x"],
    ),
    "import": ("trace.jsonl", ["import", "trace.jsonl", "--out", "new.bn"]),
    "scripted answers": ("answers.json", [*MODEL, "scripted:answers.json"]),
    "recorded answers": ("model.jsonl", [*MODEL, "replay:model.jsonl"]),
    "program": (
        "program.js",
        ["play", "tell-what-is-needed", "--agent", "anne=program:program.js", "--rounds", "1"],
    ),
    "episode": (
        "played/*.bn",
        ["play", "tell-what-is-needed", "--rounds", "2", "--out", "played"],
    ),
    "place": ("place.schem", ["capture", "place.schem", "-o", "place.yaml"]),
    "stories": ("stories.json", ["suite", "stories", "--data", "stories.json"]),
    "hi-tom": ("stories.json", ["suite", "hi-tom", "--data", "stories.json"]),
    "films": ("films.json", ["suite", "food-trucks", "--data", "films.json", "--out", "films"]),
}
"""The file that is damaged, and a command that reads it."""

MAY_PASS = {
    "kept scenario",
    "program",
    "template",
    "page of a report",
    "spent",
    "seconds",
    "stories",
    "hi-tom",
}
"""Cases in which some damage is as good as any other content, or the file is not needed."""


def told_in_one_line(
    arguments: list[str], capfd: pytest.CaptureFixture[str], *, may_pass: bool
) -> None:
    """Run a command that has to end with a documented status and, if not with 0, with one line."""
    capfd.readouterr()
    status = run_command_line(arguments)
    told = capfd.readouterr().err
    assert "Traceback" not in told
    assert status in ((0, 1, 2, 3) if may_pass else (1, 2, 3)), told
    if status > 1:
        last = told.strip().splitlines()[-1]
        assert last.startswith("beliefnest: "), told
        assert "Error(" not in last, told


@pytest.mark.parametrize("case", CASES)
def test_damaged_files_are_refused_in_one_line(
    made: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
    case: str,
) -> None:
    pattern, command = CASES[case]
    dice = random.Random(case)
    slow = case in ("place", "replayed study", "replay", "study", "cell", "plan")
    names = sorted(DAMAGES)
    for name in names if NIGHTLY else dice.sample(names, 2 if slow else 4):
        folder = tmp_path / name.replace(" ", "-")
        shutil.copytree(made, folder, symlinks=True)
        monkeypatch.chdir(folder)
        path = next(iter(sorted(Path().glob(pattern))), Path(pattern))
        if not path.exists():
            path.write_bytes(b"{}")
        DAMAGES[name](path)
        told_in_one_line(command, capfd, may_pass=case in MAY_PASS)


def _changed(value: Any, dice: random.Random) -> Any:
    """Plain values with one of them, anywhere, replaced or taken away."""
    other = dice.choice([None, 1, -1.5, "x", [], {}, [[]], {"x": None}, True, 1e400])
    if isinstance(value, dict) and value and dice.random() < 0.9:
        key = dice.choice(sorted(value))
        if dice.random() < 0.25:
            return {name: each for name, each in value.items() if name != key}
        return {**value, key: _changed(value[key], dice)}
    if isinstance(value, list) and value and dice.random() < 0.9:
        index = dice.randrange(len(value))
        return [*value[:index], _changed(value[index], dice), *value[index + 1 :]]
    return other


@pytest.mark.parametrize(
    "case", ["cell", "plan", "episode cell", "episode plan", "plan of a run", "result", "seconds"]
)
def test_files_of_a_slightly_other_form_are_read_or_refused(
    made: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
    case: str,
) -> None:
    pattern, command = CASES[case]
    dice = random.Random(case)
    folder = tmp_path / "copy"
    shutil.copytree(made, folder)
    monkeypatch.chdir(folder)
    path = next(iter(sorted(Path().glob(pattern))))
    if case == "result":
        plan = json.loads(Path("run/study.json").read_text())
        Path("run/study.json").write_text(json.dumps({**plan, "status": "running"}))
    sound, plan = path.read_text(), Path("run/study.json").read_text()
    for _ in range(200 if NIGHTLY else 4):
        changed = json.dumps(
            _changed(json.loads(sound.splitlines()[0] if case == "seconds" else sound), dice)
        )
        path.write_text(changed + "\n")
        told_in_one_line(command, capfd, may_pass=True)
        path.write_text(sound)
        Path("run/study.json").write_text(plan)


@pytest.mark.parametrize("case", ["cell", "episode cell"])
def test_a_cell_without_its_seed_is_refused(
    made: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
    case: str,
) -> None:
    pattern, command = CASES[case]
    folder = tmp_path / "copy"
    shutil.copytree(made, folder)
    monkeypatch.chdir(folder)
    path = next(iter(sorted(Path().glob(pattern))))
    cell = json.loads(path.read_text())
    del cell["seed"]
    path.write_text(json.dumps(cell))
    assert run_command_line(command) == 2
    assert "delete it to run it again" in capfd.readouterr().err


@contextmanager
def _limited(size: int) -> Iterator[None]:
    """Let no file become larger, as on a full disk."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


@pytest.mark.parametrize(
    ("case", "size"),
    [
        *(
            (case, 0)
            for case in ("run", "study", "play", "export", "import", "show", "new", "films")
        ),
        *((case, 40_000) for case in ("run", "study")),
    ],
)
def test_a_full_disk_is_told_in_one_line(
    made: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    case: str,
    size: int,
) -> None:
    folder = tmp_path / "copy"
    shutil.copytree(made, folder)
    commands = {
        "run": [*RUN, "--out", "out"],
        "study": ["study", "study.yaml", "--jobs", "1", "--record", "--out", "out"],
        "play": ["play", "tell-what-is-needed", "--rounds", "1", "--out", "out"],
        "export": ["export", "run", "--out", "out"],
        "import": ["import", "trace.jsonl", "--out", "out.bn"],
        "show": ["show", "run", "--html", "out.html"],
        "films": ["suite", "food-trucks", "--data", "films.json", "--out", "out"],
        "new": ["new", "mine"],
    }
    monkeypatch.chdir(folder)
    with _limited(size):
        status = run_command_line(commands[case])
    said = capsys.readouterr().err
    assert "Traceback" not in said
    assert status in (0, 1, 2, 3), said
    if size == 0:
        assert status == 2, said
        assert said.strip().splitlines()[-1].startswith("beliefnest: "), said


def test_what_the_system_refuses_is_told_with_what_to_do(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), "there/file")

    monkeypatch.setattr("beliefnest.cli.listing.print_installed", full)
    assert run_command_line(["list"]) == 2
    assert capsys.readouterr().err == (
        "beliefnest: there/file: No space left on device; free some space or give another folder, "
        "and run the same command again: it continues with what is already there\n"
    )


HUGE = str(10**400)
ODD = ["", "x", "-1", HUGE, "nan", "\0", "../../nothing", "\u202e", "[" * 9000, "=1+1", "\ud800"]


@pytest.mark.parametrize(
    "arguments",
    [
        ["run", "sally-anne", "--seed", "?"],
        ["run", "sally-anne", "--condition", "?"],
        ["run", "sally-anne", "--world", "?"],
        ["run", "sally-anne", "--model", "?"],
        ["run", "sally-anne", "--models", "?"],
        ["run", "sally-anne", "--claims-from", "?"],
        ["run", "sally-anne", "--listen", "?", "--realtime"],
        ["run", "sally-anne", "--embody", "?"],
        ["run", "sally-anne", "--repeat", "?"],
        ["run", "sally-anne", "--max-tokens", "?"],
        ["show", "run", "--path", "?"],
        ["show", "run", "--tick", "?"],
        ["show", "run", "--branch", "?"],
        ["show", "run", "--depth", "?", "--claims"],
        ["show", "run", "--height", "?", "--svg", "new.svg"],
        ["show", "run", "--against", "?", "--svg", "new.svg"],
        ["show", "?"],
        ["branches", "?"],
        ["prompt", "run", "--path", "?"],
        ["prompt", "run", "--path", "/anne", "--template", "?"],
        ["prompt", "run", "--path", "/anne", "--var", "?"],
        ["export", "run", "--out", "tables", "--path", "?"],
        ["export", "run", "--out", "tables", "--format", "?"],
        ["study", "?"],
        ["study", "study.yaml", "--shard", "?"],
        ["study", "study.yaml", "--backend", "?"],
        ["study", "study.yaml", "--merge", "?", "--out", "new"],
        ["play", "?"],
        ["play", "tell-what-is-needed", "--agent", "?"],
        ["play", "tell-what-is-needed", "--agent", "anne=?"],
        ["play", "tell-what-is-needed", "--set", "agents=?"],
        ["play", "tell-what-is-needed", "--world", "?"],
        ["play", "tell-what-is-needed", "--rounds", "0", "--seed", "?"],
        ["suite", "?", "--data", "stories.json"],
        ["suite", "stories", "--data", "?"],
        ["suite", "hi-tom", "--data", "stories.json", "--rows", "?"],
        ["suite", "food-trucks", "--data", "films.json", "--rows", "?"],
        ["suite", "food-trucks", "--data", "?"],
        ["suite", "stories", "--data", "stories.json", "--out", "?"],
        ["capture", "?", "-o", "new.yaml"],
        ["new", "?"],
        ["replay", "?"],
        ["serve", "run", "--port", "-5", "--address", "?"],
        ["import", "?", "--out", "new.bn"],
        ["bench", "?"],
    ],
    ids=" ".join,
)
def test_odd_arguments_are_refused_in_one_line(
    made: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
    arguments: list[str],
) -> None:
    folder = tmp_path / "copy"
    shutil.copytree(made, folder)
    monkeypatch.chdir(folder)
    dice = random.Random(" ".join(arguments))
    for odd in ODD if NIGHTLY else dice.sample(ODD, 4):
        given = [part.replace("?", odd) for part in arguments]
        if given in (["bench", ""], ["run", "sally-anne", "--embody", ""]):
            continue
        told_in_one_line(given, capfd, may_pass=True)
