"""Distance to a goal in an imagination, by which planners compare imagined states."""

from collections.abc import Iterable

from beliefnest.episodes.imagination import Imagination
from beliefnest.facts.kinds import StatedFact
from beliefnest.facts.states import ViewFacts
from beliefnest.scenarios.goals import Goal
from beliefnest.world.paths import BeliefPath, normalised
from beliefnest.world.registry import Registry
from beliefnest.world.values import Position
from beliefnest.worlds.scripted.world_facts import WorldFacts


class MindFacts(WorldFacts):
    """Facts of an imagination's own reality at its latest tick, from which a planner acts.

    Make new facts when time has passed.

    Args:
        mind: The imagination.
    """

    def __init__(self, mind: Imagination) -> None:
        super().__init__(mind.world)
        self._mind = mind
        self._reached: dict[tuple[str, Position], bool] = {}

    def block(self, place: Position) -> str | None:
        """Return the text of a block state; None: unknown."""
        text = super().block(place)
        return None if text == "air" and self._mind.is_unknown(place) else text

    def may_reach(self, agent: str, place: Position) -> bool:
        """Return True if an agent may be able to reach a block."""
        asked = (agent, place)
        if asked not in self._reached:
            self._reached[asked] = self._mind.may_reach(agent, place)
        return self._reached[asked]

    @property
    def containers(self) -> Iterable[Position]:
        """Return the positions of known containers."""
        return self._mind.world.containers

    @property
    def agents(self) -> Iterable[str]:
        """Return the agents whose places are known."""
        return self._agents


class BeliefFacts(ViewFacts):
    """Facts of a belief in an imagination at its latest tick.

    Args:
        mind: The imagination.
        path: Path of the belief below the root of the imagination.
    """

    def __init__(self, mind: Imagination, path: BeliefPath) -> None:
        view = mind.view(path)
        super().__init__(view)
        self._box, self._blocks = mind.world.box, view.terrain

    def block(self, place: Position) -> str | None:
        """Return the text of a block state; None: unknown."""
        state = self._blocks[self._box.index(place)]
        return None if state < 0 else Registry.load().text(state)

    def has_heard(self, text: str) -> bool:
        """Return False: an imagination does not keep what was said in it."""
        return False


def is_visible(condition: StatedFact, mind: Imagination) -> bool:
    """Return True if a mind is deep enough to evaluate a condition."""
    return mind.knows(condition.path)


def held(condition: StatedFact, mind: Imagination) -> bool:
    """Return True if a condition that is visible holds in a mind."""
    if normalised((*mind.root, *condition.path)) == mind.root:
        return condition.fact.holds(MindFacts(mind))
    return condition.fact.holds(BeliefFacts(mind, condition.path))


def distance(goal: Goal, mind: Imagination) -> float:
    """Return the distance to a goal in a mind; 0: reached, as far as the mind can tell."""
    facts = MindFacts(mind)
    return sum(_off(each, mind, facts) for each in goal.reach)


def _off(condition: StatedFact, mind: Imagination, facts: MindFacts) -> float:
    if condition.path:
        # A mind that is not deep enough cannot tell: count the condition as open in any case.
        return 0.0 if is_visible(condition, mind) and held(condition, mind) else 1.0
    return 0.0 if condition.fact.holds(facts) else condition.fact.effort(facts)
