"""Laws of the nest (semantics, section 5), as properties of random stories."""

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace
from tests.nest.comparing import everything, values
from tests.nest.places import wall
from tests.profiles import at_night
from tests.semantics.reference import content_at, paths_to, seen_at
from tests.semantics.reference_rules import Block, Node, Rules
from tests.semantics.reference_testimony import Ear
from tests.semantics.stories import NAMES, REGISTRY, Act, Stage, Stories, Story
from tests.semantics.symmetries import SYMMETRIES, Symmetry, with_directions

from beliefnest.belief.view import State
from beliefnest.world.frames import Frame
from beliefnest.world.values import Event, EventKind

PATHS = ["/" + "/".join(path) for path in paths_to(NAMES, 3)]
BELOW = [path for path in PATHS if path != "/"]


def parent(path: str) -> str:
    return path[: path.rindex("/")] or "/"


def told(story: Story) -> Stage:
    return Stage(story).play()


def states(stage: Stage) -> dict[str, dict[str, Any]]:
    return {path: everything(stage.nest[path].state) for path in PATHS}


# Locality


def node_of(state: State, tick: int) -> Node:
    """Return a state as the reference holds it, with the events of a tick as its news."""
    ear = Ear(tick, dict.fromkeys(state.agents, 0))
    node = Node(tick, {}, dict(state.containers), dict(state.agents), ear)
    for position in state.blocks:
        text, basis = state.blocks[position], state.blocks.basis(position)
        if text is not None and basis is not None:
            block = Block(REGISTRY.state_id(text), basis, state.blocks.current(position))
            node.blocks[position] = block
    spoken = zip(state.chat, state.addressees, strict=True)
    node.news = (
        *(Event(e.kind, e.actor, e.detail) for e in state.events if e.tick == tick),
        *(
            Event(EventKind.CHAT, who, {"text": text} | ({} if to is None else {"to": to}))
            for (at, who, text), to in spoken
            if at == tick
        ),
        *(Event(EventKind.THINK, who, {"text": t}) for at, who, t in state.thoughts if at == tick),
    )
    return node


@given(Stories(max_acts=10).story)
def test_locality_a_node_follows_from_its_parent_s_states_alone(story):
    """Each node computed anew from the past of its parent, as its user sees it."""
    stage = Stage(story)
    frames: list[Frame] = []
    stage.world.listen(frames.append)
    rules = Rules(stage.world.snapshot(), story.perception())
    stage.play()
    for path in BELOW:
        node = node_of(stage.nest.at(stage.start)[path].state, stage.start)
        for tick in [frame.tick for frame in frames if not frame.is_empty]:
            around = node_of(stage.nest.at(tick)[parent(path)].state, tick)
            node = rules.perceive(around, node, path.rsplit("/", 1)[1], happening=True)
        state = stage.nest[path].state
        found = node_of(state, stage.nest.tick)
        now = stage.nest.tick
        contents = {place: content_at(node, place, now) for place in node.containers}
        assert {p: seen_at(b, now) for p, b in node.blocks.items()} == found.blocks, path
        assert contents == found.containers, path
        assert {n: seen_at(a, now) for n, a in node.agents.items()} == found.agents, path


# No leak


@given(Stories(max_acts=12, ticks=False, priors=False).story)
def test_no_leak_a_deeper_belief_holds_only_what_the_shallower_one_held_at_some_tick(story):
    stage = told(story)
    past = range(stage.start, stage.nest.tick + 1)
    for path in BELOW[len(NAMES) :]:
        deep = stage.nest[path].state
        shallow = [stage.nest.at(tick)[parent(path)].state for tick in past]
        for place in deep.blocks:
            if not is_prior(deep.blocks.basis(place)):
                held = {(s.blocks[place], s.blocks.basis(place)) for s in shallow}
                assert (deep.blocks[place], deep.blocks.basis(place)) in held, (path, place)
        for name, agent in deep.agents.items():
            held = {(s.agents[name].position, s.agents[name].basis) for s in shallow}
            assert (agent.position, agent.basis) in held or agent.position is None, (path, name)
        for place, content in deep.containers.items():
            if not is_prior(content.basis):
                known = [s.containers[place] for s in shallow if place in s.containers]
                assert known, (path, place)
                assert any(c.complete for c in known) or not content.complete, (path, place)
        latest = shallow[-1]
        assert is_part(deep.events, latest.events)
        assert is_part(deep.chat, latest.chat)
        assert is_part(deep.thoughts, latest.thoughts)


def is_prior(basis) -> bool:
    return basis is None or basis.source == "prior"


def is_part(some: tuple[Any, ...], of: tuple[Any, ...]) -> bool:
    """Return True if `some` is `of` with entries left out."""
    rest = iter(of)
    return all(entry in rest for entry in some)


# Common knowledge

ALL_SEEN = {
    "max_visible_distance": None,
    "containers": "transparent",
    "transparent_blocks": ["chest", "barrel"],
}


@pytest.mark.parametrize("hearing", ["global", "sight", {"radius": 99}], ids=str)
def test_common_knowledge_all_present_and_seeing_everything_agree(hearing):
    shown = Stories(("glass",), ALL_SEEN | {"hearing": hearing}, priors=False, whispers=False)

    @given(shown.story)
    def all_agree(story):
        stage = told(story)
        real = public(stage.nest["/"].state)
        for path in BELOW:
            found = public(stage.nest[path].state)
            for part, value in real.items():
                assert found[part] == value, f"{part} of {path}"

    all_agree()


def public(state: State) -> dict[str, Any]:
    """Return the common part: without grounds, which tell who acted, possessions and thoughts."""
    return {
        "blocks": {p: (state.blocks[p], state.blocks.current(p)) for p in state.blocks},
        "contents": {p: (c.items, c.complete, c.current) for p, c in state.containers.items()},
        "poses": {n: (a.position, a.yaw, a.pitch, a.current) for n, a in state.agents.items()},
        "events": state.events,
        "chat": state.chat,
    }


# Laziness

asked = st.lists(st.lists(st.sampled_from(PATHS), max_size=3), min_size=15, max_size=15)


@given(Stories(forks=True).story, asked, st.permutations(PATHS))
def test_laziness_it_does_not_matter_when_and_in_what_order_nodes_are_asked_for(
    story, early, order
):
    late = states(told(story))
    stage = Stage(story)
    for act, paths in zip(story.acts, early, strict=False):
        for path in paths:
            _ = stage.nest[path].state
        stage.do(act)
    for path in (*order, *order):
        assert everything(stage.nest[path].state) == late[path], path


@given(Stories(forks=True).story, st.lists(st.sampled_from(PATHS), min_size=1))
def test_laziness_several_nodes_asked_for_at_once_are_what_they_are_one_by_one(story, paths):
    alone = states(told(story))
    for path, state in told(story).nest.states(paths).items():
        assert everything(state) == alone[path], path


@given(Stories(max_acts=8).story, st.randoms(use_true_random=False))
def test_laziness_the_past_equals_what_it_was_live(story, random):
    live: dict[tuple[int, str], dict[str, Any]] = {}
    stage = Stage(story)

    def look() -> None:
        live.update({(stage.nest.tick, path): now for path, now in states(stage).items()})

    stage.play(look)
    other = told(story)
    questions = list(live)
    random.shuffle(questions)
    for tick, path in questions[: at_night(1000, 20)]:
        assert everything(stage.nest.at(tick)[path].state) == live[tick, path], (tick, path)
        assert everything(other.nest.at(tick)[path].state) == live[tick, path], (tick, path)


# Introspection


@given(Stories(max_acts=6).story, st.lists(st.sampled_from(NAMES), min_size=1, max_size=6))
def test_introspection_an_agent_s_belief_about_its_own_belief_is_that_belief(story, names):
    stage = told(story)
    collapsed = [name for k, name in enumerate(names) if k == 0 or names[k - 1] != name]
    asked, same = stage.nest["/" + "/".join(names)], stage.nest["/" + "/".join(collapsed)]
    assert asked.path == same.path
    assert everything(asked.state) == everything(same.state)


# Symmetry


@pytest.mark.parametrize("symmetry", SYMMETRIES, ids=lambda symmetry: symmetry.name)
def test_symmetry_of_everything(symmetry: Symmetry):
    @given(Stories(forks=True, priors=False).story)
    def commutes(story):
        stage, other = told(story), told(symmetry.story(story))
        for path, state in states(stage).items():
            expected = with_directions(symmetry.value(state))
            found = with_directions(everything(other.nest[symmetry.path(path)].state))
            for part, value in expected.items():
                assert found[part] == value, f"{part} of {path}"

    commutes()


# Monotone range


@given(Stories(options={}).story, st.sampled_from([(2, 3), (4, 5.5), (5, 20), (6, None)]))
def test_monotone_range_a_larger_visible_distance_never_loses_a_percept(story, distances):
    """Of what agents themselves perceive; a belief about another may well lose one."""
    options = [{"max_visible_distance": d, "hearing": "sight"} for d in distances]
    near, far = (Stage(with_options(story, chosen)) for chosen in options)
    for act in (None, *story.acts):
        if act is not None:
            near.do(act)
            far.do(act)
        for name in NAMES:
            less, more = near.nest[f"/{name}"].state, far.nest[f"/{name}"].state
            assert all(more.blocks.current(p) for p in less.blocks if less.blocks.current(p))
            assert all(more.agents[n].current for n, a in less.agents.items() if a.current)
            assert all(more.containers[p].current for p, c in less.containers.items() if c.current)
            assert is_part(less.events, more.events)
            assert is_part(less.chat, more.chat)


def with_options(story: Story, options: dict[str, Any]) -> Story:
    return replace(story, options=options)


# Order-freedom

WEST, EAST = range(4), range(5, 8)
DIVIDED = wall(range(8), x=4) | {(4, 3, z): "stone" for z in range(8)}


def acts_on_one_side(name: str, columns: range, chest: tuple[int, int, int]):
    """Acts of an agent that stays on its side of the wall, and what it can do there."""
    feet = st.tuples(st.sampled_from(columns), st.integers(0, 7))
    place = feet.map(lambda cell: ("place_agent", name, (cell[0] + 0.5, 0.0, cell[1] + 0.5)))
    block = st.tuples(
        st.just("set_block"),
        st.tuples(st.sampled_from(columns), st.integers(0, 1), st.integers(0, 7)),
        st.sampled_from(["glass", "air", "oak_slab"]),
    )
    move = st.tuples(st.sampled_from(["deposit", "withdraw"]), st.just(name), st.just(chest), items)
    rest = st.sampled_from([("open", name, chest), ("say", name, "hi"), ("think", name, "hm")])
    return st.lists(st.one_of(place, block, move, rest), max_size=6)


items = st.sampled_from([{"diamond": 1}, {"emerald": 1}])


def interleaved(one: list[Act], two: list[Act], order: list[bool]) -> tuple[Act, ...]:
    """Both lists, each in its own order, taken from in turns."""
    first, second = list(one), list(two)
    acts: list[Act] = []
    for from_first in order:
        acts.append((first if from_first else second).pop(0))
    return tuple(acts)


@given(
    acts_on_one_side("ann", WEST, (2, 0, 3)),
    acts_on_one_side("bob", EAST, (5, 0, 4)),
    st.data(),
)
def test_order_freedom_of_agents_that_perceive_nothing_of_each_other(anns, bobs, data):
    feet = {"ann": (1.5, 0.0, 1.5), "cat": (1.5, 0.0, 6.5), "bob": (6.5, 0.0, 1.5)}
    orders = [data.draw(st.permutations([True] * len(anns) + [False] * len(bobs))) for _ in "ab"]
    one, two = (
        told(Story(DIVIDED, feet, {"hearing": "sight"}, interleaved(anns, bobs, order)))
        for order in orders
    )
    for path in PATHS[1:]:
        assert timeless(one.nest[path].state) == timeless(two.nest[path].state), path


def timeless(state: State) -> dict[str, Any]:
    """Return the content of a state without ticks."""
    return {
        "blocks": {p: state.blocks[p] for p in state.blocks},
        "containers": {p: (c.items, c.complete) for p, c in state.containers.items()},
        "agents": {n: (a.position, dict(a.inventory)) for n, a in state.agents.items()},
        "events": [(e.kind, e.actor, e.detail) for e in state.events],
        "chat": [(who, text) for _, who, text in state.chat],
        "thoughts": [(who, text) for _, who, text in state.thoughts],
    }


# Testimony


def weighing(story: Story, testimony: str) -> Story:
    return replace(story, options={**story.options, "testimony": testimony, "grace": 1})


@given(Stories(max_acts=10).story)
def test_where_nothing_is_claimed_it_is_nothing_how_hearers_take_claims(story):
    told = [states(Stage(weighing(story, how)).play()) for how in ("none", "accept", "informed")]
    assert told[0] == told[1] == told[2]


@given(Stories(max_acts=10, claims=True).story)
def test_a_speaker_s_own_belief_is_what_it_would_be_without_its_words(story):
    """A lie changes nothing of what the liar believes, nor anything that was not heard."""
    acts = tuple(act for act in story.acts if len(act) < 4 or act[0] not in ("say", "whisper"))
    silent = Stage(replace(story, acts=acts)).play()
    mute = {name for name in NAMES if not _is_told(story, name)}
    spoken = Stage(story).play()
    for name in mute:
        ours, theirs = (values(stage.nest[f"/{name}"].state) for stage in (spoken, silent))
        assert (ours["blocks"], ours["containers"]) == (theirs["blocks"], theirs["containers"])


def _is_told(story: Story, name: str) -> bool:
    """Return True if another agent says or whispers a claim that an agent might hear."""
    told = [act for act in story.acts if act[0] in ("say", "whisper") and len(act) >= 4]
    inner = [each for act in story.acts if act[0] == "tick" for each in act[1:]]
    told += [act for act in inner if act[0] in ("say", "whisper") and len(act) >= 4]
    return any(act[1] != name and (act[0] == "say" or act[2] == name) for act in told)
