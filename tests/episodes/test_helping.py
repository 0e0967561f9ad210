"""Help that was needed, given, superfluous: by what would have been without it."""

import beliefnest as bn
from beliefnest.episodes.policies import Scripted, resolve_policy


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
        assert [(act.first, act.worse) for act in found.acts] == [(0, ("anne", "sally")), (1, ())]
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
        assert [act.worse for act in found.acts] == [("eve",)]
        assert (episode.measures.lies, episode.measures.true_claims) == (1, 0)


def test_false_beliefs_are_counted_by_agent_over_time() -> None:
    with bn.Episode(bn.Task.load("help-find", seed=1)) as episode:
        series = episode.play().false_beliefs
        assert series[0] == (episode.start, {"anne": 0, "sally": 1})
        assert series[-1] == (episode.nest.tick, {"anne": 0, "sally": 0})
        row = episode.measures
        assert row.false_beliefs_over_time == tuple(sum(each.values()) for _, each in series)
