"""Reader of a nest for viewers: timelines, nodes over time, explanations and looks."""

from collections.abc import Sequence

from beliefnest.belief.forest import Forest
from beliefnest.nest.explain.chain import element_of, explain
from beliefnest.nest.explain.explanation import Explanation
from beliefnest.nest.explain.parts import Element, Sighting
from beliefnest.nest.explain.sightings import sighting_of_agent, sighting_of_block
from beliefnest.nest.past.recording import Recording
from beliefnest.nest.past.views import VisiblePart, visible_part
from beliefnest.timeline.journal import Entry, TimelineInfo, TimelineKey
from beliefnest.timeline.run_records import ProgramRecord, PromptRecord
from beliefnest.world.paths import BeliefPath
from beliefnest.world.values import Position


class Reader:
    """Reader of one nest, live or recorded, on any of its timelines. It changes nothing.

    Attributes:
        history: History that computes nodes from the journal.
        setting: Setting from which the nest started.
        agents: Names of all agents, sorted.
        seed: Seed of every random number.
    """

    def __init__(self, recording: Recording) -> None:
        self._recording = recording
        self.history = recording.history
        self.setting = recording.setting
        self.agents = recording.agents
        self.seed = recording.seed

    def timelines(self) -> Sequence[TimelineInfo]:
        """Return all timelines, in order of creation."""
        with self._recording.turn:
            return tuple(self._recording.journal.timelines())

    def selected(self) -> set[TimelineKey]:
        """Return the timelines that are selected for simulators in control mode."""
        with self._recording.turn:
            return set(self._recording.selected.values())

    def programs(self) -> Sequence[ProgramRecord]:
        """Return all programs that ran, in order of their end."""
        with self._recording.turn:
            return tuple(self._recording.records.programs())

    def prompts(self) -> Sequence[PromptRecord]:
        """Return all requests to models with their outcomes, in order."""
        with self._recording.turn:
            return tuple(self._recording.records.prompts())

    def entries(self, key: TimelineKey, start: int, stop: int) -> Sequence[Entry]:
        """Return entries of a timeline, from number `start` to before `stop`."""
        with self._recording.turn:
            return tuple(self._recording.journal.entries(key, start, stop))

    def entries_until(self, key: TimelineKey, tick: int) -> int:
        """Return the number of entries of a timeline up to a tick, this tick included."""
        with self._recording.turn:
            return self._recording.journal.entries_until(key, tick)

    def walk(self, key: TimelineKey, paths: Sequence[BeliefPath]) -> Forest:
        """Return a forest with nodes at a timeline's beginning. `advance` folds entries into it."""
        with self._recording.turn:
            return self.history.walk(key, paths)

    def advance(self, key: TimelineKey, forest: Forest, position: int) -> None:
        """Fold entries into a forest of `walk` until it has folded `position` of them."""
        with self._recording.turn:
            self.history.advance(key, forest, position)

    def element(
        self,
        *,
        container: Position | None = None,
        agent: str | None = None,
        block: Position | None = None,
    ) -> Element:
        """Return an element for `explain`; raises as `ShownSimulator.explain` does."""
        return element_of(self._recording, container, agent, block)

    def explain(
        self, key: TimelineKey, path: BeliefPath, asked: Sequence[tuple[int, Element]]
    ) -> Sequence[Explanation]:
        """Return explanations of a node's beliefs about elements at ticks."""
        with self._recording.turn:
            return explain(self._recording.on(key), path, asked)

    def look(
        self, key: TimelineKey, path: BeliefPath, tick: int, viewer: str, target: str | Position
    ) -> Sighting | None:
        """Return the look of an agent at another or at a block in a simulator.

        None: the position of the viewer is unknown there.
        """
        with self._recording.turn:
            reading = self._recording.on(key).state(path, tick)
            if reading.agents[viewer].position is None:
                return None
            box = self._recording.box
            if isinstance(target, str):
                return sighting_of_agent(reading, box, viewer, target)
            return sighting_of_block(reading, box, viewer, target)

    def visible_part(
        self, key: TimelineKey, path: BeliefPath, tick: int, viewer: str
    ) -> VisiblePart | None:
        """Return the blocks that an agent sees in a simulator.

        None: its position is unknown there, or it sees nothing of the box.
        """
        with self._recording.turn:
            reading = self._recording.on(key).state(path, tick)
            return visible_part(reading, self.history.context.sight, viewer)
