"""Search in two rooms: it tells what others do not know, and records what it considered."""

import json
from pathlib import Path

import pytest

import beliefnest as bn
from beliefnest.cli.app import run_command_line

DOOR = """
name: door
box: [[0, 0, 0], [16, 3, 10]]
parameters:
  gem: {default: [2, 1, 2]}
  lure: {default: [12, 1, 2]}
  start: {default: [3, 1, 6]}
instances:
  gem: {within: [[1, 1, 1], [7, 1, 9]], apart: 3, hidden_from: [bob, carl]}
  lure: {within: [[9, 1, 1], [15, 1, 9]], apart: 3}
  start: {within: [[2, 1, 2], [6, 1, 8]], apart: 2}
blocks:
  - {block: stone, fill: [[0, 0, 0], [16, 0, 10]]}
  - {block: bricks, fill: [[8, 1, 0], [8, 3, 10]]}
  - {block: "oak_door[half=lower,facing=east,open=false]", at: [8, 1, 5]}
  - {block: "oak_door[half=upper,facing=east,open=false]", at: [8, 2, 5]}
containers:
  - {label: chest, at: "${gem}", block: chest, items: {diamond: 1}}
  - {label: barrel, at: "${lure}", block: barrel}
agents:
  ann: {position: ["${start[0] + 0.5}", 1, "${start[2] + 0.5}"], facing: east}
  bob: {position: [12.5, 1, 6.5], facing: south}
  carl: {position: [14.5, 1, 3.5], facing: south}
static_blocks: [stone, bricks, oak_door]
perception: {max_visible_distance: 64, testimony: accept, hearing: global}
initial_beliefs:
  - {path: /ann, containers: [{at: "${gem}", items: {diamond: 1}}]}
episode:
  goal: {reach: [{agent: bob, items: {diamond: 1}}]}
  talk: [ann, bob, carl]
  order: 1
  rounds: 8
  round_ticks: 10
"""
FORBIDDEN = """
name: forbidden
box: [[0, 0, 0], [6, 3, 6]]
blocks:
  - {block: stone, fill: [[0, 0, 0], [6, 0, 6]]}
containers:
  - {label: chest, at: [3, 1, 3], items: {apple: 1}}
agents:
  ann: {position: [1.5, 1, 1.5], facing: south}
initial_beliefs:
  - {path: /ann, containers: [{at: [3, 1, 3], items: {apple: 1}}]}
episode:
  goal: {reach: [{agent: ann, items: {apple: 1}}], never: [{agent: ann, items: {apple: 1}}]}
  rounds: 1
"""
POLICIES = dict.fromkeys(("ann", "bob", "carl"), "search:1")


@pytest.fixture
def door(tmp_path: Path) -> str:
    file = tmp_path / "door.yaml"
    file.write_text(DOOR, encoding="utf-8")
    return str(file)


@pytest.mark.parametrize("seed", range(5))
def test_who_knows_the_place_tells_agents_behind_a_door(door: str, seed: int) -> None:
    with bn.Episode(bn.Task.load(door, seed), POLICIES) as episode:
        assert episode.play().success
        said = [speaker for _, speaker, _ in episode.nest["/"].state.chat]
        assert said == ["ann"]


def test_order_0_does_not_tell(door: str) -> None:
    with bn.Episode(bn.Task.load(door, 0), dict.fromkeys(POLICIES, "search:0")) as episode:
        assert not episode.play().success
        assert not episode.nest["/"].state.chat


def test_a_trace_has_courses_scores_and_what_others_were_expected_to_do(
    door: str, tmp_path: Path
) -> None:
    store = tmp_path / "run.bn"
    with bn.Episode(bn.Task.load(door, 2), POLICIES, store=store) as episode:
        episode.play()
    with bn.Episode.resume(store) as episode:
        told = episode.search_trace("ann", 0)
        assert told.reason.startswith("somebody does not know this")
        went = episode.search_trace("bob", 1)
        best, other = went.courses
        assert (best.outcome, best.program) == (
            "reached",
            episode.parts[1].decisions["bob"].program,
        )
        assert (other.outcome, other.program) == ("reached", "")  # Carl would do it for him
        assert best.score < other.score
        assert "giveItemToOther" in went.others["carl"]
        for wrong, message in (
            (("eve", 0), "there is no agent 'eve'; agents are ann, bob, carl"),
            (("ann", 99), "round 99 was not played"),
            (("ann", -1), "round -1 was not played"),
        ):
            with pytest.raises(bn.InputError, match=message):
                episode.search_trace(*wrong)


def test_a_course_that_violates_the_goal_is_worse_than_one_that_leaves_it_open(
    tmp_path: Path,
) -> None:
    file = tmp_path / "forbidden.yaml"
    file.write_text(FORBIDDEN, encoding="utf-8")
    with bn.Episode(bn.Task.load(str(file), 0), {"ann": "search:0"}) as episode:
        episode.play()
        courses = episode.search_trace("ann", 0).courses
    assert {course.outcome: course.score[0] for course in courses} == {"open": 1, "violated": 2}
    assert not episode.parts[0].decisions["ann"].program


def test_other_policies_record_no_courses(door: str) -> None:
    with bn.Episode(bn.Task.load(door, 0), dict.fromkeys(POLICIES, "random")) as episode:
        episode.play(1)
        with pytest.raises(bn.InputError, match="the policy of bob recorded no courses"):
            episode.search_trace("bob", 0)


def test_play_explains(door: str, capsys: pytest.CaptureFixture[str]) -> None:
    command = ["play", door, "--seed", "2", "--agent", "ann=search:1", "--rounds", "1"]
    command += ["--agent", "bob=random", "--explain"]
    assert run_command_line(command) == 1
    printed = capsys.readouterr().out
    assert "round 1, ann tried 2 courses" in printed
    assert "decided otherwise: somebody does not know this" in printed
    assert run_command_line([*command, "--json"]) == 1
    agents = json.loads(capsys.readouterr().out)["rounds"][0]["agents"]
    assert agents["bob"]["considered"] is None
    assert len(agents["ann"]["considered"]["courses"]) == 2
