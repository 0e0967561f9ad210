"""Labels of a scenario's things, as long as the things are there."""

from collections.abc import Mapping

from beliefnest.belief.grounds import Source
from beliefnest.belief.view import State
from beliefnest.nest.past.recording import Recording
from beliefnest.prompts.observations import Assumed, Observation, SightChange
from beliefnest.timeline.journal import ForkPoint
from beliefnest.world.frames import Frame
from beliefnest.world.registry import Registry, block_name
from beliefnest.world.signs import plain_state
from beliefnest.world.values import Position


class Labelled:
    """Things that have the labels of a scenario, until they are replaced.

    A label is perceived on its thing. An agent that comes to see another block in that place does
    not know it.

    Args:
        recording: Recording of the nest.
        moment: The moment until which the things are followed.
    """

    def __init__(self, recording: Recording, moment: ForkPoint) -> None:
        setting, registry = recording.setting, Registry.load()
        places = setting.labels.keys() | setting.prompt_labels.keys()
        self._kinds = {
            at: registry.name(plain_state(setting.snapshot.block(at))) for at in sorted(places)
        }
        self._lost: dict[Position, int] = {}
        for stretch in recording.stretches(moment) if places else ():
            key = stretch.timeline
            for entry in recording.journal.entries(key, 0, stretch.entries):
                if not isinstance(entry, Frame) and entry.path != key.path:
                    continue
                for at in entry.blocks.keys() & places:
                    state = plain_state(entry.blocks[at])
                    if state < 0 or registry.name(state) != self._kinds[at]:
                        self._lost.setdefault(at, entry.tick)

    def has(self, at: Position, tick: int) -> bool:
        """Return True if a thing that has a label is still there at a tick."""
        return at in self._kinds and tick < self._lost.get(at, tick + 1)

    def known(
        self, state: State, observations: tuple[Observation, ...], labels: Mapping[Position, str]
    ) -> dict[Position, str]:
        """Return the labels that the owner of a belief knows, by position.

        Args:
            state: The belief.
            observations: Observations of its owner.
            labels: All labels.
        """
        places: set[Position] = set()
        for each in observations:
            if isinstance(each, SightChange):
                places |= {*each.labelled}
            elif isinstance(each, Assumed) and self.has(each.place, each.tick):
                # Whoever takes the content of a thing for granted knows of the thing.
                places.add(each.place)
        return {
            at: label for at, label in labels.items() if at in places or self._believed(at, state)
        }

    def _believed(self, at: Position, state: State) -> bool:
        """Return True if the block with a label is believed, and not from hearsay."""
        block, basis = state.blocks[at], state.blocks.basis(at)
        if block is None or basis is None or basis.source is Source.HEARD:
            return False
        return block_name(block) == self._kinds[at] and self.has(at, basis.observed_at)
