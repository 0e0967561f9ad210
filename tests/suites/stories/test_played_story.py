"""Beliefs of agents after a story, read from the nest; by hand, and at random."""

from itertools import pairwise, product

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.suites.stories.texts import COMING_BACK, SHARED_SECRET

import beliefnest as bn
from beliefnest.suites.stories import PlayedStory, Question, parse_question, read_story

SECRET = {
    "Where is the lantern really?": "grey_trunk",
    "Where was the lantern at the beginning?": "grey_trunk",
    "Where does Nora really think the lantern is?": "tin_box",
    "Where does Tom really think the lantern is?": "oak_cabinet",
    "Where does Ida really think the lantern is?": "grey_trunk",
    "Where does Ida think Tom thinks the lantern is?": "oak_cabinet",
    "Where does Ida think Tom thinks Nora thinks the lantern is?": "tin_box",
    "Where does Ida think Tom thinks Ida thinks the lantern is?": "oak_cabinet",
    "Where does Nora think Tom thinks Ida thinks Tom thinks the lantern is?": "tin_box",
    "Where is the compass really?": "tin_box",
    "Where does Ida really think the compass is?": "crate",
    "Where does Nora think Ida thinks the compass is?": "crate",
    "Where will Tom look for the compass?": None,
    "Where does Nora think that Tom searches for the compass?": None,
}
RETURN = {
    "Where is the apple really?": "basket",
    "Where was the apple at the beginning?": "basket",
    "Where will Bo look for the apple?": "drawer",
    "Where will Cy look for the apple?": "basket",
    "Where does Bo think that Cy searches for the apple?": "drawer",
    "Where does Cy think that Bo searches for the apple?": "drawer",
}


@pytest.mark.parametrize("world", ["scripted", "embedded"])
@pytest.mark.parametrize(("text", "expected"), [(SHARED_SECRET, SECRET), (COMING_BACK, RETURN)])
def test_the_nest_knows_who_believes_what(world, text, expected):
    with PlayedStory.play(read_story(text), world) as played:
        answers = played.answer_all(parse_question(question) for question in expected)
    assert {q: a.text for q, a in zip(expected, answers, strict=True)} == expected


def test_a_line_is_a_tick_of_the_scripted_world():
    story = read_story(SHARED_SECRET)
    with PlayedStory.play(story) as played:
        assert played.line_ends == tuple(range(1, len(story.lines) + 1))
        together = played.nest.at(1)["/Nora"].state.agents
        assert all(together[name].current for name in ("Nora", "Tom", "Ida"))


def test_in_the_waiting_room_nobody_sees_anyone():
    with PlayedStory.play(read_story(SHARED_SECRET)) as played:
        agents = played.nest["/Nora"].state.agents
        assert [name for name in agents if agents[name].current] == ["Nora"]


@pytest.mark.parametrize(
    ("question", "what"),
    [
        ("Where will Zoe look for the lantern?", "Zoe is not in the story"),
        ("Where is the anchor really?", "no line says where the anchor is"),
    ],
)
def test_what_is_not_in_the_story_cannot_be_asked_for(question, what):
    with PlayedStory.play(read_story(COMING_BACK + "Ed likes the anchor.")) as played:
        asked = parse_question(question.replace("lantern", "apple"))
        with pytest.raises(bn.InputError, match=what):
            played.answer(asked)


AGENTS = ("Ann", "Bob", "Cid", "Dot")
ROOMS = ("den", "hall")
BOXES = ("box", "jar", "tin")
THINGS = {"pear": "den", "fig": "hall"}


class Telling:
    """Writes a story line by line, and keeps what the rules say each chain knows.

    The rules, in words: a chain of believers learns where a thing is whenever all its
    members are in the thing's room. It shares no code with what it is held against.
    """

    def __init__(self):
        self.lines = ["Ann entered the hall."]
        self.room = dict.fromkeys(AGENTS)
        self.room["Ann"] = "hall"
        self.place = dict.fromkeys(THINGS, "box")
        self.chains = [
            chain
            for depth in range(1, 5)
            for chain in product(AGENTS, repeat=depth)
            if all(a != b for a, b in pairwise(chain))
        ]
        self.known = {}
        self.look()
        self.add("Bob entered the den.", Bob="den")
        self.lines.insert(1, "The fig is in the box.")
        self.lines.append("The pear is in the box.")

    def add(self, line, **rooms):
        self.lines.append(line)
        self.room.update(rooms)
        self.look()

    def look(self):
        for chain in self.chains:
            rooms = {self.room[agent] for agent in chain}
            for thing, room in THINGS.items():
                if rooms == {room}:
                    self.known[chain, thing] = self.place[thing]

    def step(self, act, agents, room, box):
        if act == "enter":
            self.add(f"{' and '.join(agents)} entered the {room}.", **dict.fromkeys(agents, room))
            return
        agent = agents[0]
        here = self.room[agent]
        if act == "wait":
            self.add(f"{agent} entered the waiting_room.", **{agent: None})
        elif act == "exit" and here:
            self.add(f"{agent} exited the {here}.", **{agent: None})
        elif act == "move" and here:
            thing = next(name for name, where in THINGS.items() if where == here)
            self.place[thing] = box
            self.add(f"{agent} moved the {thing} to the {box}.")


STEPS = st.lists(
    st.tuples(
        st.sampled_from(["enter", "exit", "move", "move", "wait"]),
        st.lists(st.sampled_from(AGENTS), min_size=1, max_size=3, unique=True),
        st.sampled_from(ROOMS),
        st.sampled_from(BOXES),
    ),
    max_size=14,
)


@given(STEPS, st.data())
def test_every_chain_knows_what_the_rules_say(steps, data):
    telling = Telling()
    for agents in AGENTS:
        telling.step("enter", [agents], "den", "box")
    for step in steps:
        telling.step(*step)
    asked = data.draw(st.lists(st.sampled_from(telling.chains), min_size=1, max_size=12))
    with PlayedStory.play(read_story("\n".join(telling.lines))) as played:
        for chain in asked:
            for thing in THINGS:
                found = played.answer(Question(chain, thing, False, ""))
                assert found.text == telling.known.get((chain, thing)), (chain, thing)
        for thing in THINGS:
            assert played.answer(Question((), thing, False, "")).text == telling.place[thing]
