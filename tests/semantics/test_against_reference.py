"""The nest against the slow reference, on random stories, every node to depth 3 or 4."""

import pytest
from hypothesis import given
from tests.nest.comparing import everything
from tests.semantics.reference import Path, Reference, paths_to
from tests.semantics.stories import NAMES, REGISTRY, Act, Stage, Stories, Story

DEPTH = 3


class Double:
    """A story played in the nest and in the reference side by side."""

    def __init__(self, story: Story, depth: int) -> None:
        self._paths = list(paths_to(NAMES, depth))
        self.stage = Stage(story)
        start = self.stage.world.snapshot()
        options = story.perception()
        self.reference = Reference(
            start,
            options,
            frozenset(story.static),
            story.initial,
            depth=depth,
            unique=frozenset(story.unique),
        )
        self._bodies = {(): self.stage.world}
        self.stage.world.listen(lambda frame: self.reference.frame((), frame))

    def do(self, act: Act) -> None:
        name, *args = act
        if not self.stage.do(act):
            return
        if name == "switch":
            self._switch(*args)
        elif name == "edit":
            path, blocks, contents, signs = args
            states = {place: REGISTRY.state_id(text) for place, text in blocks.items()}
            self.reference.edit(split(path), states, contents, signs)

    def _switch(self, text: str, branch: str) -> None:
        path = split(text)
        self.reference.switch(path, branch)
        if branch != "follow":
            body = self.stage.nest[text].scripted
            if self._bodies.get(path) is not body:
                self._bodies[path] = body
                body.listen(lambda frame: self.reference.frame(path, frame))

    def check(self) -> None:
        for path in self._paths:
            simulator = self.stage.nest["/" + "/".join(path)]
            expected, found = self.reference.everything(path), everything(simulator.state)
            for part, value in expected.items():
                assert found[part] == value, f"{part} of {simulator.path} at {simulator.tick}"
            assert simulator.tick == self.reference.head(path)


def split(path: str) -> Path:
    return tuple(name for name in path.split("/") if name)


def compare(story: Story, *, each_tick: bool, depth: int = DEPTH) -> None:
    double = Double(story, depth)
    for act in story.acts:
        if each_tick:
            double.check()
        double.do(act)
    double.check()


@given(Stories().story)
def test_every_node_asked_at_the_end(story):
    compare(story, each_tick=False)


@given(Stories(max_acts=8).story)
def test_every_node_asked_at_every_tick(story):
    compare(story, each_tick=True)


@given(Stories(forks=True, max_acts=20).story)
def test_every_node_with_forks_and_edits(story):
    compare(story, each_tick=False)


@given(Stories(forks=True, max_acts=10).story)
def test_every_node_with_forks_and_edits_asked_at_every_tick(story):
    compare(story, each_tick=True)


@given(Stories(claims=True, max_acts=25).story)
def test_every_node_where_something_is_claimed(story):
    compare(story, each_tick=False)


@pytest.mark.long
@given(Stories(claims=True, max_acts=10).story)
def test_every_node_where_something_is_claimed_asked_at_every_tick(story):
    compare(story, each_tick=True, depth=2)


@given(Stories(claims=True, forks=True, max_acts=20).story)
def test_every_node_with_claims_forks_and_edits(story):
    compare(story, each_tick=False)


@pytest.mark.long
@given(Stories(claims=True, max_acts=12).story)
def test_every_node_to_depth_four_where_something_is_claimed(story):
    compare(story, each_tick=False, depth=4)


@given(Stories(signs=True, forks=True, max_acts=20).story)
def test_every_node_where_signs_are_written_on(story):
    compare(story, each_tick=False)


@pytest.mark.long
@given(Stories(signs=True, claims=True, forks=True, max_acts=10).story)
def test_every_node_where_signs_are_written_on_asked_at_every_tick(story):
    compare(story, each_tick=True, depth=2)


@pytest.mark.long
@given(Stories(signs=True, max_acts=12).story)
def test_every_node_to_depth_four_where_signs_are_written_on(story):
    compare(story, each_tick=False, depth=4)


@given(Stories(unique=True, forks=True, max_acts=20).story)
def test_every_node_where_an_item_is_unique(story):
    compare(story, each_tick=False)


@given(Stories(unique=True, claims=True, forks=True, max_acts=12).story)
def test_every_node_where_an_item_is_unique_and_claimed_asked_at_every_tick(story):
    compare(story, each_tick=True, depth=2)


@pytest.mark.long
@given(Stories(unique=True, claims=True, max_acts=12).story)
def test_every_node_to_depth_four_where_an_item_is_unique_and_claimed(story):
    compare(story, each_tick=False, depth=4)


@given(Stories(signs=True, signed=True, claims=True, forks=True, max_acts=16).story)
def test_every_node_where_signs_carry_claims(story):
    compare(story, each_tick=False)


@given(Stories(signs=True, signed=True, claims=True, unique=True, max_acts=10).story)
def test_every_node_where_signs_claim_where_a_unique_item_is_asked_at_every_tick(story):
    compare(story, each_tick=True, depth=2)
