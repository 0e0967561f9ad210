"""What a nest computes with: the setting, names of blocks, and how agents see."""

from dataclasses import dataclass

from beliefnest.belief import control
from beliefnest.belief.entries import InitialBelief
from beliefnest.belief.state import BeliefState
from beliefnest.belief.update import update
from beliefnest.nest.setting import Setting
from beliefnest.perception.options import Perception
from beliefnest.perception.sight import Sight
from beliefnest.timeline.journal import Edit, Entry
from beliefnest.world.registry import Registry

__all__ = ["Rules"]


@dataclass(frozen=True, eq=False)
class Rules:
    """The pure functions of one nest, with what they need bound to them.

    Attributes:
        setting: What the nest started from.
        registry: Names and shapes of blocks.
        sight: How agents see.
        agents: All agents, sorted.
    """

    setting: Setting
    registry: Registry
    sight: Sight
    agents: tuple[str, ...]

    @classmethod
    def of(cls, setting: Setting) -> "Rules":
        """The rules of a setting."""
        registry = Registry.load()
        options: Perception = setting.perception
        sight = Sight(
            registry,
            options.max_visible_distance,
            options.field_of_view,
            options.transparent_blocks,
        )
        return cls(setting, registry, sight, tuple(sorted(setting.snapshot.agents)))

    def reality(self) -> BeliefState:
        """The real world at its first tick."""
        return control.reality(self.setting.snapshot, self.agents, self.sight)

    def first_belief(self, path: tuple[str, ...], around: BeliefState) -> BeliefState:
        """A node of the nest at the first tick: priors, then the first perception."""
        initial = next((b for b in self.setting.initial_beliefs if b.path == path), None)
        before = self._prior(initial)
        return update(before, around, path[-1], self.setting.perception, self.registry)

    def after(self, state: BeliefState, entry: Entry, path: tuple[str, ...]) -> BeliefState:
        """A control-mode simulator's state after an entry of its own timeline."""
        if isinstance(entry, Edit):
            if entry.path != path:
                return self.quiet(state)
            return self._edited(state, entry, control_mode=True)
        return control.applied(state, entry)

    def belief_after(
        self, belief: BeliefState, around: BeliefState, entry: Entry, path: tuple[str, ...]
    ) -> BeliefState:
        """A follow-mode node's state after an entry of the timeline it follows.

        An edit changes the edited node; the nodes below it perceive the change.
        """
        if isinstance(entry, Edit):
            if entry.path == path:
                return self._edited(belief, entry, control_mode=False)
            if entry.path != path[: len(entry.path)]:
                return self.quiet(belief)
        return update(belief, around, path[-1], self.setting.perception, self.registry)

    @staticmethod
    def quiet(state: BeliefState) -> BeliefState:
        """The state with its news already told."""
        if not state.news:
            return state
        return BeliefState(
            state.tick,
            state.terrain,
            state.grounds,
            state.containers,
            state.agents,
            state.items,
            state.log,
            (),
        )

    def _prior(self, initial: InitialBelief | None) -> BeliefState:
        return control.prior(
            self.reality(), self.setting.static_blocks, initial, self.registry, self.sight
        )

    def _edited(self, state: BeliefState, edit: Edit, *, control_mode: bool) -> BeliefState:
        return control.edited(
            state, edit.tick, edit.blocks, edit.containers, self.registry, control=control_mode
        )
