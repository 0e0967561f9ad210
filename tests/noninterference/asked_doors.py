"""Doors of questions, right answers and policies, and of inference in a mind."""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, field

from tests.noninterference.doors import door
from tests.noninterference.pairs import AGENTS, Played

import beliefnest as bn
from beliefnest.episodes.agent_view import AgentView, Brief
from beliefnest.episodes.decided import Ended
from beliefnest.llm.claim_reader import claims_from_model
from beliefnest.llm.messages import Answer, Message, Sampling
from beliefnest.llm.model_settings import ModelSettings
from beliefnest.minds.imagining.imagining import ImaginationWarning
from beliefnest.prompts import built_in_template
from beliefnest.scenarios.believed import Believed
from beliefnest.scenarios.content import Probe
from beliefnest.scenarios.expected_answers import Answers
from beliefnest.scenarios.goals import Goal
from beliefnest.scenarios.naming import Naming
from beliefnest.scenarios.questioning import ask_question

_GOALS = {"garden": {"at": (4, 1, 1)}, "yard": {"at": (1, 1, 5)}}
_DOUBT = {"here": {"blocks": {(3, 2, 3): "air"}}, "not": {"blocks": {(3, 2, 3): "stone"}}}


@dataclass
class Listener:
    """Model that keeps what it is asked.

    Attributes:
        says: Its answer to everything.
        asked: Texts of the messages.
    """

    says: str = "Answer: none"
    name: str = "listener"
    asked: list[str] = field(default_factory=list)

    def answer(self, messages: Sequence[Message], sampling: Sampling) -> Answer:
        """Answer always the same."""
        self.asked += [message.text for message in messages]
        return Answer(self.says)


@door(every=2)
def questions(world: Played, path: str) -> object:
    """Return the prompts of a question with options."""
    model, asked = Listener(), Answers("Where?", ("here",), ("here", "there"))
    for template in (None, built_in_template("story").text):
        probe = Probe(
            path=path, acts_in=path, agent="ann", task="", expect=(asked,), template=template
        )
        ask_question(world.nest, probe, asked, model, world.seed, Sampling(), ModelSettings())
    return model.asked


@door(every=2)
def right_answers(world: Played, path: str) -> object:
    """Return the right answers about the beliefs of a mind, in its own words."""
    naming = Naming.of(world.nest[path].view, world.nest.setting)
    matters: list[tuple[str, object]] = [("item", name) for name in ("apple", "emerald", "chest")]
    matters += [(kind, at) for at in world.places for kind in ("container", "block")]
    return [
        Believed(path, kind, thing, "unknown", "").answers(
            lambda asked: world.nest[asked].state, naming, ()
        )
        for kind, thing in matters
    ]


@door()
def readings(world: Played, path: str) -> object:
    """Return what readers of claims are given for the words that the owner hears."""
    model = Listener('{"claims": []}')
    heard = [each for each in world.read if each[0] in ("ann", "bob")]
    for speaker, text, nameable in heard:
        claims_from_model(model)(text, speaker, nameable)
    return heard, model.asked


@door(every=8)
def policies(world: Played, path: str) -> object:
    """Return what a policy of the owner reads: its prompts, its memories and its claims."""
    own, nest = world.nest[path], world.nest
    agent = path.rpartition("/")[2]
    brief = Brief(
        *("task", AGENTS, AGENTS, {agent: Goal()}, {}, AGENTS, 3, 60, False, 1),
        places={"yard": (1, 1, 5)},
        seed=0,
    )
    view = AgentView(
        *(agent, brief, 1, Ended(), nest.at(nest.tick)[path]),
        lambda depth, tick: own.imagination(depth, 1, tick),
        own.noting,
        (),
    )
    text = "{% for name in about %}{{ about[name] | story }}{{ about[name] | chests }}{% endfor %}"
    imagined = view.imagine(1)
    happened = imagined.world.snapshot()
    return (
        view.render(text + "{{ branch | story }}{{ view }}", depth=1),
        view.heard,
        sorted(view.spoken.items()),
        view.claims,
        view.ticks_left,
        (happened.containers, happened.agents, happened.signs),
    )


@door(every=10)
def inferences(world: Played, path: str) -> object:
    """Return what is inferred about Bob, predicted of him, and credited to him."""
    model = bn.MindModel("bob", _GOALS, {"garden": 1.0, "yard": 0.5}, _DOUBT)
    own = world.nest[path]
    try:
        inferred = own.infer(model)
    except bn.InputError as error:
        return str(error)
    credence = own.credence("bob", _DOUBT)
    return inferred.posterior().tobytes(), inferred.predict(3), credence


@door(every=10)
def imaginations(world: Played, path: str) -> object:
    """Return the shares of imagined histories."""
    actors = {"bob": {"idle": "", "speaks": "await say(bot, 'hello');"}}
    since = world.nest.tick // 2
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ImaginationWarning)
        try:
            imagined = world.nest[path].imagine(since, actors=actors, n=6, seed=world.seed)
        except bn.InputError as error:
            return str(error)
        return imagined.by_candidate("bob"), imagined.log_evidence, imagined.effective_size


@door(every=10)
def courses(world: Played, path: str) -> object:
    """Return courses of Bob that are drawn, and what evidence changed."""
    model = bn.MindModel("bob", _GOALS, {"garden": [1.0, 9.0], "yard": 5.0}, _DOUBT, step_ticks=2)
    since = world.nest.tick // 2
    own = world.nest[path]
    try:
        inferred = own.infer(model, smooth=True)
    except bn.InputError as error:
        return str(error)
    drawn = [] if inferred.impossible else inferred.sample_paths(4, seed=world.seed)
    told = [(path.hypothesis, path.cells) for path in drawn]
    found = (told, inferred.impossible, inferred.explain(), inferred.marginal("cell"))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ImaginationWarning)
        try:
            imagined = own.imagine(since, actors={"bob": {"walks": model}}, n=3, seed=world.seed)
        except bn.InputError as error:
            return found, str(error)
    walks = [
        (dict(history.hypotheses["bob"]), dict(history.at(tick).state.agents))
        for history in imagined
        for tick in range(since, history.tick + 1)
    ]
    return found, walks, imagined.impossible, imagined.log_evidence
