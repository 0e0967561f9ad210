"""Help that was needed, given, superfluous: by what would have been without it."""

from dataclasses import dataclass
from typing import Any

import beliefnest as bn
from beliefnest.episodes.policies import Scripted, resolve_policy
from beliefnest.episodes.shares import Share
from beliefnest.facts.kinds import FactEntry
from beliefnest.facts.reading import conditions_of
from beliefnest.scenarios.goals import Goal, Progress


class TalksTwice:
    """Says what search would say, and in the next round that all is well."""

    def __init__(self) -> None:
        self._search = resolve_policy("search:1")

    def act(self, view: bn.AgentView) -> str:
        if view.round == 0:
            return self._search.act(view)
        return "await say(bot, 'All is well.')" if view.round == 1 else ""


def test_help_is_what_somebody_would_have_been_worse_off_without() -> None:
    content = bn.Task.load("help-find", seed=1).plain()
    # She may talk as much as she likes.
    content["goal"] = {"reach": content["goal"]["reach"]}
    with bn.Episode(bn.Task.from_mapping(content), {"anne": TalksTwice()}) as episode:
        assert episode.play().success
        assert episode.measures.help_needed is None
        before = [info.key for info in episode.nest["/"].branches()]
        found = episode.help()
        assert [info.key for info in episode.nest["/"].branches()] == before
        assert (found.needed, found.given) == (("sally",), ("sally",))
        assert [(act.first, act.worse) for act in found.acts] == [(0, ("sally",)), (1, ())]
        row = episode.measures
        assert (row.help_needed, row.help_given, row.help_superfluous) == (1, 1, 1)


def test_help_that_was_not_given_was_needed_all_the_same() -> None:
    with bn.Episode(bn.Task.load("help-find", seed=1), {"anne": Scripted([])}) as episode:
        found = episode.play().help()
        assert (found.needed, found.given, found.acts) == (("sally",), (), ())


def test_a_lie_helps_nobody_but_its_speaker_and_is_not_superfluous() -> None:
    # To somebody who believes what he is told.
    policies = {"eve": "search:1", "bob": "search:0"}
    with bn.Episode(bn.Task.load("hide-and-seek", seed=1), policies) as episode:
        found = episode.play().help()
        assert found.needed == ()
        assert [(act.worse, act.helped) for act in found.acts] == [(("eve",), ())]
        assert (episode.measures.lies, episode.measures.true_claims) == (1, 0)


def test_false_beliefs_are_counted_by_agent_over_time() -> None:
    with bn.Episode(bn.Task.load("help-find", seed=1)) as episode:
        series = episode.play().false_beliefs
        assert series[0] == (episode.start, {"anne": 0, "sally": 1})
        assert series[-1] == (episode.nest.tick, {"anne": 0, "sally": 0})
        row = episode.measures
        assert row.false_beliefs_over_time == tuple(sum(each.values()) for _, each in series)


HALL: dict[str, Any] = {
    "name": "hall",
    "box": [[0, 0, 0], [16, 3, 8]],
    "blocks": [{"block": "stone", "fill": [[0, 0, 0], [16, 0, 8]]}],
    "static_blocks": ["stone"],
    "containers": [
        {"at": [8, 1, 1], "items": {"apple": 1}},
        {"at": [8, 1, 7], "items": {"bread": 1}},
        {"at": [8, 1, 4]},
    ],
    "initial_beliefs": [
        {"path": "/ann", "containers": [{"at": [8, 1, 1], "items": {"apple": 1}}]},
    ],
    "perception": {"testimony": "accept"},
    "agents": {
        "ann": {"position": [2.5, 1, 4.5]},
        "bob": {"position": [8.5, 1, 3.5]},
        "cid": {"position": [8.5, 1, 5.5]},
    },
}


@dataclass
class Does:
    """Policy that runs programs in rounds that are named."""

    programs: dict[int, str]

    def act(self, view: bn.AgentView) -> str:
        return self.programs.get(view.round, "")


@dataclass
class Fetches:
    """Policy that fetches an apple it believes to be somewhere; it looks for one in a late round.

    Attributes:
        patience: The round in which it goes and looks by itself.
    """

    patience: int

    def act(self, view: bn.AgentView) -> str:
        if view.state.agents["bob"].inventory.get("apple"):
            return ""
        places = [place for place, held in view.state.containers.items() if "apple" in held.items]
        if not places and view.round == self.patience:
            places = [(8, 1, 1)]
        if not places:
            return ""
        return f"await getItemFromChest(bot, new Vec3{places[0]}, {{apple: 1}})"


def shared(**more: Any) -> bn.Task:
    """Bob is to have the apple and Cid the bread; Ann alone knows where the apple is."""
    goal = {
        "reach": [{"agent": "bob", "items": {"apple": 1}}, {"agent": "cid", "items": {"bread": 1}}]
    }
    content = {"name": "hall", "scenario": HALL, "goal": goal, "rounds": 8, "round_ticks": 12}
    return bn.Task.from_mapping({**content, **more})


WHISPERS = "await whisper(bot, 'bob', 'There.', [located('apple', new Vec3(8, 1, 1))])"
TAKES_BREAD = "await getItemFromChest(bot, new Vec3(8, 1, 7), {bread: 1})"


def test_a_decisive_whisper_helps_its_addressee_and_not_all_who_share_the_goal() -> None:
    policies: dict[str, Any] = {
        "ann": Does({0: WHISPERS}),
        "bob": Fetches(patience=99),
        "cid": Does({1: TAKES_BREAD}),
    }
    with bn.Episode(shared(), policies) as episode:
        found = episode.play().help()
        assert episode.success
        assert (found.needed, found.given) == (("bob",), ("bob",))
        assert [(act.agent, act.worse, act.helped) for act in found.acts] == [
            ("ann", ("bob",), ("bob",))
        ]


def test_a_whisper_helps_where_the_goal_waits_for_another_anyway() -> None:
    # Without it Bob has the apple later, though still before Cid has the bread.
    policies: dict[str, Any] = {
        "ann": Does({0: WHISPERS}),
        "bob": Fetches(patience=3),
        "cid": Does({5: TAKES_BREAD}),
    }
    with bn.Episode(shared(), policies) as episode:
        found = episode.play().help()
        assert episode.success
        assert found.needed == ()
        assert [(act.agent, act.helped) for act in found.acts] == [("ann", ("bob",))]
        assert found.superfluous == ()


def test_who_puts_something_somewhere_has_done_that_share_of_the_goal() -> None:
    reach = [
        {"container": [8, 1, 4], "items": {"apple": 1}},
        {"container": [8, 1, 4], "items": {"bread": 1}},
    ]
    puts = "await depositItemIntoChest(bot, new Vec3(8, 1, 4), {%s: 1})"

    class Brings(Fetches):
        def act(self, view: bn.AgentView) -> str:
            has = view.state.agents["bob"].inventory.get("apple")
            return puts % "apple" if has else super().act(view)

    policies: dict[str, Any] = {
        "ann": Does({0: WHISPERS, 2: "await whisper(bot, 'cid', 'Go on!')"}),
        "bob": Brings(patience=99),
        "cid": Does({1: TAKES_BREAD, 3: puts % "bread"}),
    }
    with bn.Episode(shared(goal={"reach": reach}), policies) as episode:
        found = episode.play().help()
        assert episode.success
        assert (found.needed, found.given) == (("bob",), ("bob",))
        assert [(act.first, act.helped) for act in found.acts] == [(0, ("bob",)), (2, ())]
        assert [act.first for act in found.superfluous] == [2]


def test_who_is_given_what_it_is_to_have_is_helped() -> None:
    takes = "await getItemFromChest(bot, new Vec3(8, 1, 1), {apple: 1})"
    policies: dict[str, Any] = {
        "ann": Does({0: takes, 1: "await giveItemToOther(bot, 'bob', 'apple', 1)"}),
        "bob": Does({1: "await receiveItemFromOther(bot, 'ann', 'apple', 1)"}),
        "cid": Does({0: TAKES_BREAD}),
    }
    with bn.Episode(shared(), policies) as episode:
        found = episode.play().help()
        assert episode.success
        assert found.needed == ("bob",)
        assert [(act.agent, act.first, act.helped) for act in found.acts] == [("ann", 1, ("bob",))]


def test_of_a_goal_that_nobody_came_near_all_who_are_after_it_needed_help() -> None:
    reach = [{"container": [8, 1, 4], "items": {"apple": 1}}]
    idle = dict.fromkeys(("ann", "bob", "cid"), Does({}))
    task = shared(goal={"reach": reach}, goals={"cid": {}})
    with bn.Episode(task, idle) as episode:
        found = episode.play().help()
        assert (found.needed, found.given) == (("ann", "bob"), ())


def test_a_share_that_came_true_after_the_deadline_never_did() -> None:
    facts = conditions_of(FactEntry(agent="ann", items={"apple": 1}), ("ann",))
    early, late = (Progress(Goal(tuple(facts), ticks=9), 0) for _ in range(2))
    early.feed(9, [True], 0)
    late.feed(10, [True], 0)
    assert [Share((0,), ()).done_at(each) for each in (early, late)] == [9, float("inf")]
