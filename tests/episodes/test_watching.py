"""Goals of an episode: tested where something changes that they read, true at each tick."""

from collections.abc import Sequence
from pathlib import Path

import pytest

import beliefnest as bn
from beliefnest.episodes.policies import Scripted
from beliefnest.facts.states import Look, StateFacts
from beliefnest.scenarios.goals import Goal, Progress

MEETING = """\
name: meeting
box: [[0, 0, 0], [14, 3, 6]]
blocks:
  - {block: stone, fill: [[0, 0, 0], [14, 0, 6]]}
  - {block: "lever[face=floor,facing=north,powered=false]", at: [12, 1, 3]}
containers: [{at: [4, 1, 5], items: {apple: 2}}]
agents:
  ann: {position: [2.5, 1, 3.5], facing: east}
  bob: {position: [12.5, 1, 1.5], facing: west}
episode:
  goal: {reach: [{agent: ann, at: [13, 1, 3], within: 2}], messages: 1}
  goals:
    ann: {reach: [{agent: ann, items: {apple: 1}}], never: [{agent: bob, at: [12, 1, 5]}]}
    bob:
      reach:
        - {block: [12, 1, 3], state: "lever[powered=true]"}
        - {container: [4, 1, 5], items: {}}
  players: [ann, bob]
  rounds: 12
  round_ticks: 10
"""


def every_tick(episode: bn.Episode) -> dict[str, Progress]:
    """Progress of all goals, tested after each entry."""
    nest, task = episode.nest, episode.task
    goals = {"": task.goal, **{agent: task.goal_of(agent) for agent in task.agents}}
    progress = {name: Progress(goal, episode.start) for name, goal in goals.items()}
    paths = sorted({(), *(path for goal in goals.values() for path in goal.paths)})
    for entry, states in nest.each_entry(paths, episode.start - 1, nest.tick):
        facts = {path: StateFacts(state) for path, state in states().items()}
        said = [event for event in getattr(entry, "events", ()) if event.kind == "chat"]
        for each in progress.values():
            each.feed(entry.tick, each.goal.met(facts.__getitem__), len(said))
    return progress


WAYS = {
    "ann": (
        "await getItemFromChest(bot, new Vec3(4, 1, 5), {apple: 2})",
        "bot.chat('I have them')",
        *["await goToPosition(bot, new Vec3(13, 1, 3))"] * 3,
    ),
    "bob": (
        "await turnOnLever(bot, new Vec3(12, 1, 3))",
        "await goToPosition(bot, new Vec3(12, 1, 5))",
    ),
}


def playing(folder: Path, text: str, **ways: tuple[str, ...]) -> bn.Episode:
    file = folder / "meeting.yaml"
    file.write_text(text, encoding="utf-8")
    policies = {name: Scripted(programs) for name, programs in ways.items()}
    return bn.Episode(bn.Task.load(str(file)), policies)


def test_goals_are_as_if_tested_after_every_entry(tmp_path: Path) -> None:
    with playing(tmp_path, MEETING, **WAYS) as episode:
        episode.play()
        progress, again = episode.progress, every_tick(episode)
        assert progress == {name: again[name] for name in progress}
        assert episode.conditions == again[""].came_true()
    ann, bob = progress["ann"], progress["bob"]
    assert ann.reached is not None
    assert ann.violated is None
    assert bob.reached is not None
    assert again[""].reached is not None


def test_steps_cost_no_test_of_goals_about_things(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tests, met = [], Goal.met

    def noted(goal: Goal, look: Look) -> Sequence[bool]:
        tests.append(goal)
        return met(goal, look)

    monkeypatch.setattr(Goal, "met", noted)
    goal = "{reach: [{container: [4, 1, 5], items: {}}, {agent: bob, items: {apple: 1}}]}"
    text = f"{MEETING[: MEETING.index('  goal:')]}  goal: {goal}\n  players: [ann, bob]\n"
    with playing(tmp_path, text, **WAYS) as episode:
        episode.play(3)
        assert [tick is not None for _, tick in episode.conditions] == [True, False]
        assert episode.ticks > 20
        # At the start, the first time that each one moves, and when the chest is opened,
        # emptied and closed, the lever is moved, and something is said.
        assert len(tests) < 10


@pytest.mark.parametrize("wait", [4, 10])
def test_an_utterance_counts_once(tmp_path: Path, wait: int) -> None:
    # The entry by which all look around has the tick of the last words of a round.
    late = (f"await bot.waitForTicks({wait - 1})\nbot.chat('here')",)
    with playing(tmp_path, MEETING, ann=late, bob=()) as episode:
        episode.play(2)
        assert [tick for tick, _, _ in episode.nest["/"].state.chat] == [episode.start + wait]
        assert not episode.is_decided
        assert episode.messages == 1
