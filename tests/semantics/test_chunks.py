"""Beliefs in boxes whose cells are in chunks: as the slow reference says, and as without chunks."""

import pytest
from hypothesis import HealthCheck, given, settings
from msgspec.structs import replace
from tests.profiles import at_night, few_by_day
from tests.semantics.stories import NAMES, Stage, Stories, Story
from tests.semantics.test_against_reference import compare

from beliefnest.belief.view import State
from beliefnest.world import terrain

PATHS = ["/", *(f"/{a}" for a in NAMES), *(f"/{a}/{b}" for a in NAMES for b in NAMES if a != b)]
few = settings(
    max_examples=at_night(200, 2), suppress_health_check=[HealthCheck.function_scoped_fixture]
)


@pytest.fixture
def chunks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let nodes of every box share chunks."""
    monkeypatch.setattr(terrain, "DENSE", 0)


@pytest.mark.usefixtures("chunks")
@pytest.mark.parametrize("each_tick", few_by_day([False, True]))
@few
@given(story=Stories(forks=True, max_acts=10).story)
def test_every_node_across_borders_of_chunks(story: Story, each_tick: bool):
    compare(replace(story, box="straddling"), each_tick=each_tick, depth=2)


@pytest.mark.usefixtures("chunks")
@few
@given(story=Stories(signs=True, signed=True, claims=True, forks=True, max_acts=12).story)
def test_every_node_with_signs_and_claims_in_few_chunks(story: Story):
    compare(story, each_tick=False, depth=2)


@pytest.mark.usefixtures("chunks")
@few
@given(story=Stories(unique=True, claims=True, forks=True, max_acts=12).story)
def test_every_node_with_a_unique_item_in_few_chunks(story: Story):
    compare(story, each_tick=False, depth=2)


def beliefs(story: Story, monkeypatch: pytest.MonkeyPatch, dense: int) -> list[object]:
    """Return all that nodes hold after each act."""
    with monkeypatch.context() as patch:
        patch.setattr(terrain, "DENSE", dense)
        stage, told = Stage(story), []
        stage.play(lambda: told.append([held(stage.nest[path].state) for path in PATHS]))
    return told


def held(state: State) -> object:
    """Return what a state shows, the grounds of its blocks left out."""
    parts = (dict(state.containers), dict(state.agents), dict(state.items), dict(state.signs))
    return (state.blocks.grid.tobytes(), *parts, state.events, tuple(state.chat))


@few
@given(story=Stories(("stone", "oak_slab", "oak_fence"), forks=True, claims=True, max_acts=6).story)
def test_many_chunks_and_none_give_the_same_beliefs(monkeypatch: pytest.MonkeyPatch, story: Story):
    big = replace(story, box="large")
    assert beliefs(big, monkeypatch, 0) == beliefs(big, monkeypatch, 10**9)
