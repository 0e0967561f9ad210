"""Episodes that were stopped before they began, and what is gone on with by its branch."""

from pathlib import Path

import pytest

import beliefnest as bn
from beliefnest.cli.app import run_command_line
from beliefnest.episodes.policies import Scripted
from beliefnest.episodes.record import keep_begins

TASK = bn.Task.load("help-find", seed=1)
PLAY = ["play", "help-find", "--seed", "1"]


def test_what_was_stopped_while_it_began_is_begun_anew(tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    (tmp_path / "empty" / "run.bn").touch()
    with bn.Nest.open(TASK.scenario, "scripted", _made(tmp_path / "begun")) as nest:
        keep_begins(nest)
    for name in ("empty", "begun"):
        assert run_command_line([*PLAY, "--out", str(tmp_path / name), "--rounds", "1"]) == 1
        with bn.Episode.resume(tmp_path / name / "run.bn") as episode:
            assert episode.rounds == 1


def test_a_run_of_another_command_stays_as_it_is(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    store = _made(tmp_path / "other")
    bn.Nest.open(TASK.scenario, "scripted", store).close()
    before = store.read_bytes()
    assert run_command_line([*PLAY, "--out", str(store.parent)]) == 2
    assert "there is no episode in this run" in capsys.readouterr().err
    assert store.read_bytes() == before


def test_an_object_has_to_be_given_again(tmp_path: Path) -> None:
    with bn.Episode(TASK, {"anne": Scripted([])}, store=tmp_path / "e.bn") as episode:
        episode.play(1)
    with pytest.raises(bn.InputError, match=r"Episode.resume\(store, {'anne': Scripted"):
        bn.Episode.resume(tmp_path / "e.bn")
    with bn.Episode.resume(tmp_path / "e.bn", {"anne": "search:1"}) as episode:
        assert episode.policies["anne"] == "search:1"


def test_any_branch_is_gone_on_with_and_replayed(tmp_path: Path) -> None:
    with bn.Episode(TASK, {"anne": Scripted([])}, store=tmp_path / "e.bn") as episode:
        assert not episode.play().success
        assert episode.at(0).fork(anne="search:1").play(2).branch == "fork 1"
        assert episode.measures.rounds == 17  # reading another branch plays nothing
    with bn.Episode.resume(tmp_path / "e.bn") as episode:
        assert episode.branch == "fork 1"
    with bn.Episode.resume(tmp_path / "e.bn", branch="fork 1") as episode:
        assert (episode.rounds, episode.play().success) == (2, True)
    for branch, success in (("main", False), ("fork 1", True)):
        with bn.Episode.replay(tmp_path / "e.bn", branch=branch) as episode:
            assert episode.play().success is success
    with pytest.raises(bn.BranchError, match="no branch 'fork 2'; it has main, fork 1"):
        bn.Episode.replay(tmp_path / "e.bn", branch="fork 2")


def _made(folder: Path) -> Path:
    folder.mkdir()
    return folder / "run.bn"
