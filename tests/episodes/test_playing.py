"""Rules of play: turns, budgets, goals that must never come true, what is measured."""

import json
from pathlib import Path
from typing import Any

import pytest

import beliefnest as bn
from beliefnest.cli.app import run_command_line
from beliefnest.episodes.policies import Scripted
from beliefnest.episodes.record import Budget
from beliefnest.episodes.telling import round_rows, told_episode

HALL: dict[str, Any] = {
    "name": "hall",
    "box": [[0, 0, 0], [12, 3, 6]],
    "blocks": [{"block": "stone", "fill": [[0, 0, 0], [12, 0, 6]]}],
    "static_blocks": ["stone"],
    "containers": [{"at": [1, 1, 1], "items": {"apple": 2}}, {"at": [11, 1, 5]}],
    "agents": {"ann": {"position": [4.5, 1, 3.5]}, "bob": {"position": [8.5, 1, 3.5]}},
}
GOAL = {"reach": [{"container": [11, 1, 5], "items": {"apple": 1}}]}


def task(**more: Any) -> bn.Task:
    return bn.Task.from_mapping({"name": "hall", "scenario": HALL, "goal": GOAL, **more})


class Says:
    """Says the same in every round, and notes when it was asked."""

    def __init__(self) -> None:
        self.asked: list[int] = []

    def act(self, view: bn.AgentView) -> str:
        self.asked.append(view.tick)
        return f"await say(bot, 'I am {view.agent}')"


def test_in_turns_one_acts_after_the_other() -> None:
    ann, bob = Says(), Says()
    with bn.Episode(
        task(play="turns", rounds=2, round_ticks=7), {"ann": ann, "bob": bob}
    ) as played:
        played.play()
        assert (ann.asked, bob.asked) == ([0, 14], [7, 21])
        assert [speaker for _, speaker, _ in played.nest["/"].state.chat] == ["ann", "bob"] * 2
        assert (played.rounds, played.nest.tick) == (2, 28)


def test_together_all_are_asked_before_anybody_acts() -> None:
    ann, bob = Says(), Says()
    with bn.Episode(task(rounds=3, round_ticks=7), {"ann": ann, "bob": bob}) as played:
        assert played.play(2).rounds == 2
        assert ann.asked == bob.asked == [0, 7]
        assert played.play().rounds == 3


def test_who_says_too_much_has_failed() -> None:
    goal = {**GOAL, "messages": 3}
    with bn.Episode(task(goal=goal, rounds=6), {"ann": Says(), "bob": Says()}) as played:
        played.play()
        assert (played.success, played.rounds, played.messages) == (False, 2, 4)
        assert played.view("ann").messages == 4
        assert played.why_not == "more than 3 messages"
    with bn.Episode(
        task(goal=goal, players=["ann"], rounds=2), {"ann": Says(), "bob": Says()}
    ) as played:
        assert (played.play().messages, played.view("ann").messages) == (2, 2)


def test_what_was_missed_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    reach = [{"agent": "ann", "items": {"apple": 1}}]
    takes = "await bot.waitForTicks(5)\n"
    takes += "await getItemFromChest(bot, new Vec3(1, 1, 1), {apple: 1})"
    policies = {"ann": Scripted([takes]), "bob": Scripted([""])}
    with bn.Episode(task(goal={"reach": reach}), policies) as played:
        assert played.play().success
        assert played.why_not == ""
        took = played.ticks
    goal: dict[str, Any] = {"reach": reach, "ticks": took - 1}
    with bn.Episode(task(goal=goal), policies) as played:
        assert played.play().conditions == [("ann has 1 apple", played.start + took)]
        assert played.why_not == f"not within {took - 1} ticks; too late: ann has 1 apple"
        assert played.progress["ann"].violated == played.start + took - 1
    (tmp_path / "nothing.txt").write_text("")
    (tmp_path / "hall.json").write_text(json.dumps({**HALL, "episode": {"goal": goal}}))
    idle = [f"{name}=scripted:{tmp_path / 'nothing.txt'}" for name in ("ann", "bob")]
    given = ["play", str(tmp_path / "hall.json"), "--agent", idle[0], "--agent", idle[1]]
    assert run_command_line(given) == 1
    told = f"\nwhy not: not within {took - 1} ticks; not reached: ann has 1 apple\n"
    assert told in capsys.readouterr().out
    never = {"reach": reach, "never": [{"agent": "bob", "at": [8, 1, 3]}]}
    with bn.Episode(task(goal=never), policies) as played:
        assert played.why_not == "not to be: bob within 1 of (8, 1, 3)"


def test_each_condition_of_an_entry_is_told_as_one_to_reach() -> None:
    dishes = {"reach": [{"container": [11, 1, 5], "items": {"apple": 1, "bread": 1}}]}
    never = {"never": [{"agent": "ann", "items": {"apple": 1, "bread": 1}}]}
    with bn.Episode(task(goal=dishes | never), {}) as played:
        told = told_episode(played.nest)
    assert told is not None
    assert [is_never for _, is_never, _ in told["branches"]["main"]["goal"]] == [False] * 2 + [
        True
    ] * 2


def test_what_must_never_be_is_checked_at_every_tick() -> None:
    goal = {"never": [{"agent": "ann", "items": {"apple": 1}}]}
    takes_and_returns = """
    await getItemFromChest(bot, new Vec3(1, 1, 1), {apple: 1})
    await depositItemIntoChest(bot, new Vec3(1, 1, 1), {apple: 1})
    """
    policies: dict[str, Any] = {"bob": Says()}
    with bn.Episode(task(goal=goal, rounds=2), {**policies, "ann": Says()}) as played:
        assert played.play().success
    scripted = Scripted([takes_and_returns])
    with bn.Episode(task(goal=goal, rounds=2), {**policies, "ann": scripted}) as played:
        assert not played.play().success
        assert played.rounds == 1
        assert played.nest["/"].state.agents["ann"].inventory == {}


def test_a_budget_of_ticks_ends_an_episode() -> None:
    policies = {"ann": Says(), "bob": Says()}
    with bn.Episode(task(rounds=9, round_ticks=10), policies, budget=Budget(ticks=25)) as played:
        assert played.play().rounds == 3


def test_who_resumes_can_give_more(tmp_path: Path) -> None:
    policies, store = {"ann": "random", "bob": "random"}, tmp_path / "e.bn"
    with bn.Episode(task(rounds=9), policies, store=store, budget=Budget(ticks=1)) as played:
        assert played.play().rounds == 1
    with bn.Episode.resume(store) as played:
        assert played.play().rounds == 1
    with bn.Episode.resume(store, budget=Budget(ticks=21)) as played:
        assert played.play().rounds == 2


def test_what_was_believed_wrongly_and_acted_on_is_counted() -> None:
    helped = bn.Task.load("help-find", seed=1)
    with bn.Episode(helped, {"anne": "search:0"}) as alone, bn.Episode(helped) as together:
        wrong, right = alone.play().measures, together.play().measures
    assert (wrong.acted_on_false, right.acted_on_false) == (1, 0)
    assert (right.taken_up, right.not_taken_up, right.false_beliefs) == (1, 0, 0)
    assert right.false_beliefs_mean > 0
    # She has learnt it when she has looked, at last.
    assert wrong.false_beliefs_mean > right.false_beliefs_mean


def test_the_command_plays_and_goes_on(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["play", "help-find", "--seed", "1", "--out", str(tmp_path / "run")]
    assert run_command_line([*arguments, "--rounds", "2"]) == 1
    assert run_command_line(arguments) == 0
    printed = capsys.readouterr().out
    assert "goal reached after 75 ticks, 15 rounds, 1 message\n" in printed
    assert "[located(" in printed
    assert run_command_line(["play", "help-find", "--agent", "anne=search:0", "--seed", "1"]) == 1
    assert run_command_line(["show", str(tmp_path / "run" / "run.bn"), "--path", "/anne"]) == 0
    assert run_command_line([*arguments, "--measure-help"]) == 0
    told = "help: needed by sally; given to sally; superfluous: 0 of 1 program in which "
    assert told in capsys.readouterr().out
    for wrong in (
        ["play"],
        ["play", "x"],
        ["play", "help-find", "--seed", "-1"],
        ["play", "sally-anne"],
        ["play", "help-find", "--agent", "anne"],
        ["play", "help-find", "--agent", "anne=random", "--agent", "anne=search:1"],
        ["play", "help-find", "--set", "agents=two"],
        ["play", "help-find", "--patience", "0"],
    ):
        assert run_command_line(wrong) == 2, wrong


def test_the_command_finishes_an_interrupted_last_round(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["play", "help-find", "--seed", "1", "--rounds", "1"]
    assert run_command_line(arguments) == 1
    whole = capsys.readouterr().out
    arguments += ["--out", str(tmp_path / "run")]
    with monkeypatch.context() as patch:
        # Decisions are recorded, and then the process is interrupted.
        patch.setattr("beliefnest.episodes.episode.play_part", _interrupted)
        assert run_command_line(arguments) == 130
    assert run_command_line(arguments) == 1
    assert capsys.readouterr().out == whole


def _interrupted(*_: object) -> None:
    raise KeyboardInterrupt


def test_the_command_tells_if_a_task_is_not_what_it_claims(
    capsys: pytest.CaptureFixture[str],
) -> None:
    command = ["play", "watchman", "--baselines", "--seeds", "1", "--json"]
    assert run_command_line(command) == 0
    told = capsys.readouterr().out
    assert '"policy": "search:2"' in told


def test_the_baselines_of_a_file_have_a_table(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "mine.yaml"
    goal = {"reach": [{"agent": "ann", "at": [11, 1, 3], "within": 1}]}
    others = {"players": ["ann"], "policies": {"bob": "random"}}
    rules = {"goal": goal, **others, "rounds": 2, "order": 1}
    file.write_text(json.dumps({**HALL, "episode": rules}), encoding="utf-8")
    command = ["play", str(file), "--baselines", "--seeds", "1"]
    # The file states order 1, but the task needs no Theory of Mind.
    assert run_command_line([*command, "--json"]) == 1
    found = json.loads(capsys.readouterr().out)["baselines"]
    assert {each["policy"]: each["right"] for each in found}["search:0"] == 1
    assert {each["task"] for each in found} == {"hall"}
    assert run_command_line([*command, "--page", str(tmp_path / "page.md")]) == 2
    assert "--page is for built-in tasks" in capsys.readouterr().err
    assert run_command_line([*command, "--rounds", "2"]) == 2
    assert "--rounds has no effect on --baselines" in capsys.readouterr().err


def test_the_same_courses_in_further_rounds_are_told_once(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "shut.yaml"
    rules = {"goal": {"reach": [{"agent": "ann", "items": {"diamond": 1}}]}, "rounds": 3}
    empty = [{"at": at, "items": {}} for at in ([1, 1, 1], [11, 1, 5])]
    known = [{"path": "/**", "containers": empty}]
    file.write_text(json.dumps({**HALL, "initial_beliefs": known, "episode": rules}))
    assert run_command_line(["play", str(file), "--explain"]) == 1
    lines = capsys.readouterr().out.splitlines()
    for agent in ("ann", "bob"):
        assert sum(line.startswith(f"round 1, {agent} tried") for line in lines) == 1
        for number in (2, 3):
            assert f"round {number}, {agent} considered the same as in round 1" in lines


def test_the_command_goes_on_with_no_other_episode(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = ["--out", str(tmp_path / "run")]
    assert run_command_line(["play", "help-find", "--seed", "1", "--rounds", "1", *out]) == 1
    before = (tmp_path / "run" / "run.bn").read_bytes()
    for other, found in (
        (["recipe", "--seed", "1"], "whose task is help-find"),
        (["help-find"], "whose seed is 1"),
        (["help-find", "--seed", "1", "--world", "embedded"], "whose world is scripted"),
        (["help-find", "--seed", "1", "--set", "chests=5"], "whose instance is another one"),
        (
            ["help-find", "--seed", "1", "--agent", "anne=random"],
            "whose policies are anne=search:1",
        ),
    ):
        assert run_command_line(["play", *other, *out]) == 2
        assert found in " ".join(capsys.readouterr().err.split())
    assert (tmp_path / "run" / "run.bn").read_bytes() == before


PULLS = "await say(bot, 'Now!')\nawait turnOnLever(bot, new Vec3(5, 1, 1))"
WHY = "line 2: turnOnLever: there is no lever at (5, 1, 1), but air. Give the position of a lever."


def test_why_a_program_failed_is_told_to_readers_and_not_to_its_agent(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "pull.js").write_text(PULLS)
    (tmp_path / "lever.yaml").write_text(json.dumps({"scenario": HALL, "name": "x", "goal": GOAL}))
    command = ["play", str(tmp_path / "lever.yaml"), "--agent", f"ann=program:{tmp_path}/pull.js"]
    command += ["--agent", "bob=random", "--rounds", "1"]
    assert run_command_line([*command, "--out", str(tmp_path / "out")]) == 1
    assert f"failed in round 1, ann: {WHY}\n" in capsys.readouterr().out
    assert run_command_line([*command, "--json"]) == 1
    report = json.loads(capsys.readouterr().out)
    assert report["rounds"][0]["agents"]["ann"]["reason"] == WHY
    assert report["rounds"][0]["round"] == 1
    assert report["measures"]["failures"] == [f"round 1, ann: {WHY}"]
    with bn.Episode.resume(tmp_path / "out" / "run.bn") as episode:
        (failure,) = episode.failures
        assert (failure.round, failure.agent, failure.ended) == (0, "ann", "failed")
        assert failure.reason == WHY
        assert episode.view("ann").last.message == "line 2: turnOnLever did not work"
    (row,) = [row for row in _rounds_of(tmp_path / "out" / "run.bn") if row["agent"] == "ann"]
    assert (row["message"], row["reason"]) == ("line 2: turnOnLever did not work", WHY)


def test_rounds_lost_by_a_policy_are_told_with_the_reason() -> None:
    class Breaks:
        def act(self, view: bn.AgentView) -> str:
            raise RuntimeError("no answer today")

    with bn.Episode(task(rounds=2), {"ann": Breaks(), "bob": Says()}) as played:
        failures = [str(each) for each in played.play().failures]
    line = Breaks.act.__code__.co_firstlineno + 1
    why = f"ann: test_playing.py:{line}: RuntimeError: no answer today"
    assert failures == [f"round 1, {why}", f"round 2, {why}"]


def test_in_turns_a_round_is_one_however_many_act_in_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    content = {"name": "hall", "scenario": HALL, "goal": GOAL, "play": "turns", "rounds": 2}
    (tmp_path / "turns.yaml").write_text(json.dumps(content))
    command = [
        "play",
        str(tmp_path / "turns.yaml"),
        "--agent",
        "ann=random",
        "--agent",
        "bob=random",
    ]
    run_command_line([*command, "--json"])
    report = json.loads(capsys.readouterr().out)
    assert [part["round"] for part in report["rounds"]] == [1, 1, 2, 2]


def _rounds_of(store: Path) -> list[dict[str, Any]]:
    with bn.Nest.read(store) as nest:
        told = told_episode(nest)
    assert told is not None
    return list(round_rows(told))


def test_conditions_that_come_true_after_the_goal_is_lost_are_told() -> None:
    takes = "await getItemFromChest(bot, new Vec3(1, 1, 1), {apple: 1})"
    puts = "await depositItemIntoChest(bot, new Vec3(11, 1, 5), {apple: 1})"
    never = [{"agent": "ann", "items": {"apple": 1}}]
    policies: dict[str, Any] = {"ann": Scripted([f"{takes}\n{puts}"]), "bob": Scripted([])}
    with bn.Episode(task(goal={**GOAL, "never": never}, rounds=1), policies) as played:
        assert not played.play().success
        (_, put), (_, taken) = played.conditions
        assert taken is not None and put is not None and put > taken


def test_what_is_so_at_the_start_is_kept_at_once_and_in_a_branch(tmp_path: Path) -> None:
    goal = {"reach": [{"container": [1, 1, 1], "items": {"apple": 1}}, *GOAL["reach"]]}
    policies: dict[str, Any] = {"ann": Scripted([]), "bob": Scripted([])}
    with bn.Episode(task(goal=goal), policies, store=tmp_path / "run.bn") as played:
        assert played.rounds == 0
        start = played.start
        kept = told_episode(played.nest)
        assert kept is not None
        assert [tick for _, _, tick in kept["branches"]["main"]["goal"]] == [start, None]
        played.play(1).at(1).fork(ann=Scripted([]))
        kept = told_episode(played.nest)
        assert kept is not None
        assert [tick for _, _, tick in kept["branches"]["fork 1"]["goal"]] == [start, None]
