"""Tables of the episodes of runs."""

import json
from pathlib import Path

import beliefnest as bn
from beliefnest import frames
from beliefnest.cli.app import run_command_line


def test_rounds_and_goals_are_exported_and_tables(tmp_path: Path) -> None:
    store = tmp_path / "e.bn"
    with bn.Episode(bn.Task.load("help-find", seed=1), store=store) as episode:
        episode.play()
        episode.at(1).fork(anne="random").play(1)
        count = episode.rounds
    assert run_command_line(["export", str(store), "--out", str(tmp_path / "out")]) == 0
    lines = (tmp_path / "out" / "rounds.jsonl").read_text("utf-8").splitlines()
    rows = [json.loads(line) for line in lines]
    # Two agents in each round; the branch has the rounds before it as well.
    assert len(rows) == 2 * count + 2 * 2
    assert {(row["branch"], row["policy"]) for row in rows if row["agent"] == "anne"} == {
        ("main", "search:1"),
        ("fork 1", "random"),
    }
    assert (rows[0]["round"], rows[0]["tick"], rows[0]["ended"]) == (0, 0, "ok")
    goals = (tmp_path / "out" / "goals.jsonl").read_text("utf-8").splitlines()
    ticks = [json.loads(line)["tick"] for line in goals]
    # Three things on each branch.
    assert len(ticks) == 6
    assert all(ticks[:3]) and ticks[3:] == [None] * 3
    table = frames.rounds_df(store)
    assert list(table["program"]) == [row["program"] for row in rows]
    assert not table.duplicated(["cell", "branch", "round", "agent"]).any()


def test_a_replay_is_the_same_bytes_in_every_table(tmp_path: Path) -> None:
    with bn.Episode(bn.Task.load("help-find", seed=1), store=tmp_path / "played.bn") as episode:
        episode.play()
    with bn.Episode.replay(tmp_path / "played.bn", store=tmp_path / "replayed.bn") as episode:
        episode.play()
    written = []
    for name in ("played", "replayed"):
        command = ["export", str(tmp_path / f"{name}.bn"), "--out", str(tmp_path / name)]
        assert run_command_line(command) == 0
        files = sorted((tmp_path / name).iterdir())
        written.append({file.name: file.read_bytes() for file in files})
    assert written[0] == written[1]
    assert written[0]["rounds.jsonl"]
