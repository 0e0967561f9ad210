"""The built-in tasks: their instances are solved at the order they need, and at none below."""

import pytest
from tests.profiles import at_night, few_by_day

import beliefnest as bn
from beliefnest.episodes.tasks import parameters_of, source_of

SEEDS = at_night(50, 2)
KNOWN = [name for name in bn.Task.names() if bn.Task.load(name).form.goals_known]
"""Tasks whose goals are common knowledge; `policies/test_infer.py` tries the others."""


def played(task: bn.Task, order: int) -> bool:
    with bn.Episode(task, dict.fromkeys(task.players, f"search:{order}")) as episode:
        return episode.play().success


@pytest.mark.parametrize("seed", few_by_day(range(SEEDS)))
@pytest.mark.parametrize("name", KNOWN)
def test_a_task_is_solved_at_its_order_and_not_below(name: str, seed: int) -> None:
    task = bn.Task.load(name, seed=seed)
    assert task.order > 0
    assert played(task, task.order)
    assert not played(task, task.order - 1)


@pytest.mark.parametrize("name", bn.Task.names())
def test_an_instance_depends_on_its_seed_alone(name: str) -> None:
    one, same = bn.Task.load(name, seed=5), bn.Task.load(name, seed=5)
    assert one.plain() == same.plain()
    assert any(bn.Task.load(name, seed=seed).plain() != one.plain() for seed in range(6, 12))
    assert bn.Task.from_mapping(one.plain()).plain() == one.plain()


@pytest.mark.parametrize(
    ("name", "key", "value"),
    [
        (name, key, value)
        for name in bn.Task.names()
        for key, (_, low, high) in parameters_of(name).items()
        for value in sorted({low, high})
    ],
)
def test_a_task_of_any_size_makes_sense(name: str, key: str, value: int) -> None:
    task = bn.Task.load(name, seed=1, **{key: value})
    # No goal is reached before the first deed.
    with bn.Episode(task, dict.fromkeys(task.agents, "random")) as episode:
        episode.play(0)
        assert not episode.success


@pytest.mark.long
@pytest.mark.parametrize("name", KNOWN)
def test_a_task_of_another_size_needs_its_order_too(name: str) -> None:
    # One size of each, the smallest, at night all of them.
    sizes = [
        {key: value}
        for key, (usual, low, high) in parameters_of(name).items()
        for value in (low, high)
        if value != usual
    ]
    for size in sizes[: at_night(len(sizes), 1)]:
        task = bn.Task.load(name, seed=1, **size)
        assert played(task, task.order), size
        assert not played(task, task.order - 1), size


@pytest.mark.long
@pytest.mark.parametrize("name", KNOWN[:: at_night(1, 2)])
def test_a_task_of_more_agents_needs_its_order_too(name: str) -> None:
    for seed in range(at_night(10, 1)):
        task = bn.Task.load(name, seed=seed, agents=3)
        assert len(task.agents) == 3
        assert played(task, task.order), seed
        assert not played(task, task.order - 1), seed


@pytest.mark.parametrize("name", bn.Task.names())
def test_a_task_names_its_source(name: str) -> None:
    first = source_of(name).splitlines()[0]
    assert any(year in first for year in map(str, range(1970, 2026)))


def test_a_task_is_read_from_a_file(tmp_path) -> None:
    file = tmp_path / "mine.yaml"
    file.write_text(
        """
name: mine
scenario:
  name: mine
  box: [[0, 0, 0], [6, 3, 6]]
  blocks: [{block: stone, fill: [[0, 0, 0], [6, 0, 6]]}]
  containers: [{at: [5, 1, 5], items: {apple: 1}}]
  agents: {ann: {position: [1.5, 1, 1.5]}}
goal:
  reach: [{agent: ann, items: {apple: 1}}]
"""
    )
    task = bn.Task.load(str(file))
    with bn.Episode(task, {"ann": "search:0"}) as episode:
        # She looks into the chest, then knows and takes.
        assert episode.play().success
    file.write_text(file.read_text().replace("reach", "raech"))
    with pytest.raises(bn.ScenarioError, match=r"mine.yaml:10: .*raech"):
        bn.Task.load(str(file))


def test_a_goal_that_speaks_of_nobody_is_refused() -> None:
    plain = bn.Task.load("help-find").plain()
    plain["goal"] = {"reach": [{"agent": "zoe", "items": {"apple": 1}}]}
    with pytest.raises(bn.ScenarioError, match="zoe"):
        bn.Task.from_mapping(plain)
    plain["goal"] = {"reach": [{"items": {"apple": 1}}]}
    with pytest.raises(bn.ScenarioError, match="container and items"):
        bn.Task.from_mapping(plain)
    plain["goal"] = {}
    with pytest.raises(bn.ScenarioError, match="there is no goal"):
        bn.Task.from_mapping(plain)
    with pytest.raises(bn.ScenarioError, match="missing required field `box`"):
        bn.Task.from_mapping({"name": "mine", "scenario": {}, "goal": {}})


def test_a_liar_is_counted() -> None:
    # To somebody who believes what he is told.
    task = bn.Task.load("hide-and-seek", seed=1)
    with bn.Episode(task, {"eve": "search:1", "bob": "search:0"}) as episode:
        measures = episode.play().measures
    assert measures.success
    assert measures.claims == measures.false_claims == measures.lies == measures.messages > 0
    assert measures.taken_up >= 1


def test_who_is_seen_through_bluffs_by_the_truth() -> None:
    task = bn.Task.load("hide-and-seek", seed=1)
    with bn.Episode(task, {"eve": "search:1"}) as seen_through:
        lying = seen_through.play().measures
    assert not lying.success
    assert lying.lies > 0
    with bn.Episode(task, {"eve": "search:2"}) as bluff:
        honest = bluff.play().measures
    assert (honest.success, honest.claims, honest.lies) == (True, 1, 0)


def test_a_task_is_played_in_minecraft_as_in_the_scripted_world() -> None:
    # Whom the other hears, what it then walks to and takes, with programs that read percepts.
    task = bn.Task.load("help-find", seed=1)
    with bn.Episode(task, world="embedded") as helped:
        measures = helped.play().measures
    assert (measures.success, measures.messages, measures.taken_up) == (True, 1, 1)
    with bn.Episode(task, {"anne": "search:0"}, world="embedded") as idle:
        # Without help Sally is too late there, too.
        assert not idle.play().success


class Teller:
    """Says so many things, those first that Max does not know, and then fetches the book."""

    def __init__(self, things: int) -> None:
        self._things = things

    def act(self, view: bn.AgentView) -> str:
        mine, known = view.state.containers, view.about("max").containers
        places = {item: at for at, content in sorted(mine.items()) for item in content.items}
        book = places.pop("book")
        left = self._things - len(view.state.chat)
        told = sorted(
            places.items(), key=lambda each: each[1] in known and each[0] in known[each[1]].items
        )
        calls = [
            f"await say(bot, 'look', [located('{item}', new Vec3{at})])"
            for item, at in told[: max(0, left)]
        ]
        return "\n".join([*calls, f"await getItemFromChest(bot, new Vec3{book}, {{book: 1}})"])


def test_talk_costs_ticks() -> None:
    task = bn.Task.load("tell-what-is-needed", seed=2)
    succeeded = []
    for things in (1, 2):
        with bn.Episode(task, {"nora": Teller(things)}) as episode:
            succeeded.append(episode.play().success)
            assert episode.messages == things
    # One more than what he does not know is too much.
    assert succeeded == [True, False]
