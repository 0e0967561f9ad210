"""What users see of a nest: figures, plots of beliefs over time, what a notebook shows."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from beliefnest.belief.view import State
from beliefnest.errors import BeliefNestError, InputError
from beliefnest.nest.explain.comparison import Difference, false_beliefs, value_words
from beliefnest.nest.face.moment import AtMoment
from beliefnest.nest.face.plotting import Followed, plot_of
from beliefnest.nest.past.recording import Recording
from beliefnest.pictures.figure import Figure, figure_of
from beliefnest.pictures.scene import Scene, Wrong, best_height, read_scene
from beliefnest.pictures.words import place_words, state_words
from beliefnest.world.paths import BeliefPath, parse_path, path_text
from beliefnest.world.values import Position

__all__ = ["Looking", "LookingAtOne", "wrong_things"]


@dataclass(frozen=True, slots=True)
class _Node:
    """A simulator at a tick; None: at the latest of its timeline."""

    recording: Recording
    names: BeliefPath
    tick: int | None

    @property
    def path(self) -> str:
        """The belief path."""
        return path_text(self.names)

    @property
    def state(self) -> State:
        """What it holds."""
        return self.recording.state(self.names, self.tick)

    def visible_blocks(self, agent: str) -> npt.NDArray[np.bool_]:
        """Which blocks an agent sees in it."""
        return self.recording.reading(self.names, self.tick).visible_from(agent)


class Looking(AtMoment):
    """Pictures of a nest: live, past, or recorded."""

    def figure(
        self,
        paths: str | Sequence[str] = "/",
        tick: int | None = None,
        against: str | None = None,
        *,
        sight: Sequence[str] | None = None,
        height: int | None = None,
    ) -> Figure:
        """Simulators side by side, each drawn from what it holds itself.

        Args:
            paths: Belief paths; one can stand alone.
            tick: When; None: the latest tick.
            against: The path that they are compared with, to mark what is false; None: reality.
            sight: Agents whose sight is shown in each; None: that of the belief's owner.
            height: The storey, y of what stands on its floor; None: that of most containers, or
                of most agents.

        Raises:
            PathError: A path is malformed or names an unknown agent.
            TickError: The tick is in the future or before the start.
            InputError: There is no path, or the height lies outside the box.
        """
        return figure_of(self.scenes(paths, tick, against, sight=sight, height=height))

    def scenes(
        self,
        paths: str | Sequence[str] = "/",
        tick: int | None = None,
        against: str | None = None,
        *,
        sight: Sequence[str] | None = None,
        height: int | None = None,
    ) -> tuple[Scene, ...]:
        """What `figure` draws, as values; arguments and errors are the same."""
        wanted = [paths] if isinstance(paths, str) else list(paths)
        then = self._moment() if tick is None else tick
        return _scenes(self._recording, wanted, then, against, sight=sight, height=height)

    def plot_beliefs(
        self,
        container: Position | None = None,
        item: str | None = None,
        paths: Sequence[str] = ("/",),
        *,
        agent: str | None = None,
        block: Position | None = None,
    ) -> Figure:
        """What simulators held of a thing over time: a row for each, a band for each value.

        Bands are marked where they are false; above stand the deeds of the real world that
        mattered, and what was claimed of it. Claims that were heard have a balloon above each
        row, struck out where they were not believed. Followed are a container's contents, an
        item wherever it is, a block, an agent's place, or with `agent` and `item`, how much of
        it the agent has with it.

        Args:
            container: Where the container is.
            item: The item to follow, alone in all containers and with all agents; None: all that
                is in the container, or the agent's place.
            paths: Belief paths.
            agent: The agent to follow, in place of a container.
            block: Where the block is that is followed, in place of a container.

        Raises:
            PathError: A path is malformed or names an unknown agent, or there is no such agent.
            PositionError: The container or block lies outside the box.
            InputError: There is no path, not one thing to follow, or never was a container there.
            UnknownNameError: There is no such item.
        """
        followed = Followed(container, item, agent, block)
        return plot_of(self._recording, followed, paths, self._moment())

    def __repr__(self) -> str:
        recording, tick = self._recording, self._moment()
        try:
            with recording.turn:
                state = recording.state((), tick)
                branches = len(recording.journal.timelines())
                words = state_words(state)
        except BeliefNestError as error:
            # Whoever prints a closed nest, or a tick that is not there, wants no further fault.
            return f"<nest of {recording.setting.name}: {error}>"
        shown = f"<nest of {recording.setting.name} at tick {state.tick}"
        return f"{shown}, {branches} timeline{'s' * (branches > 1)}: {words}>"

    def _repr_html_(self) -> str:
        return self.figure()._repr_html_()


class LookingAtOne(AtMoment):
    """Pictures of one simulator."""

    _path: BeliefPath

    def figure(
        self,
        against: str | None = None,
        *,
        sight: Sequence[str] | None = None,
        height: int | None = None,
    ) -> Figure:
        """The simulator, drawn from what it holds itself; as `Nest.figure`."""
        paths, then = [path_text(self._path)], self._moment()
        scenes = _scenes(self._recording, paths, then, against, sight=sight, height=height)
        return figure_of(scenes)

    def __repr__(self) -> str:
        recording, tick = self._recording, self._moment()
        path = path_text(self._path)
        try:
            with recording.turn:
                key = recording.selected.get(self._path)
                state = recording.state(self._path, tick)
                wrong = [
                    _named(each, recording)
                    for each in _wrong(_Node(recording, self._path, tick), ())
                ]
                words = state_words(state)
        except BeliefNestError as error:
            # As for a nest.
            return f"<simulator {path}: {error}>"
        mode = "follow mode" if key is None else f"branch {key.branch}"
        false = f"; false: {', '.join(wrong)}" if wrong else ""
        return f"<simulator {path}, {mode}, tick {state.tick}: {words}{false}>"

    def _repr_html_(self) -> str:
        return self.figure()._repr_html_()


def _scenes(
    recording: Recording,
    paths: Sequence[str],
    tick: int | None,
    against: str | None,
    *,
    sight: Sequence[str] | None,
    height: int | None,
) -> tuple[Scene, ...]:
    if not paths:
        raise InputError("a figure of no simulator is empty; give a belief path")
    with recording.turn:
        other = parse_path("/" if against is None else against, recording.agents)
        nodes = [_Node(recording, parse_path(path, recording.agents), tick) for path in paths]
        for name in sight or ():
            parse_path(path_text((name,)), recording.agents)
        low, high = recording.box.low[1], recording.box.high[1]
        if height is not None and not low <= height <= high:
            raise InputError(f"height {height} lies outside the box; give {low} to {high}")
        # One storey for all of them, so that they can be compared.
        level = best_height([node.state for node in nodes]) if height is None else height
        return tuple(_scene(node, other, sight, level) for node in nodes)


def _scene(node: _Node, against: BeliefPath, sight: Sequence[str] | None, height: int) -> Scene:
    recording = node.recording
    setting = recording.setting
    key = recording.selected.get(node.names)
    # Who is not there at this tick looks from a remembered place: nobody can tell what it sees.
    own = [name for name in node.names[-1:] if node.state.agents[name].current]
    return read_scene(
        node,
        wrong=_wrong(node, against),
        against=path_text(against),
        labels=setting.labels,
        places=setting.places,
        sight=own if sight is None else sight,
        height=height,
        note=f"branch {key.branch}" if key is not None and node.names else "",
    )


def _wrong(node: _Node, against: BeliefPath) -> list[Wrong]:
    """What a simulator holds otherwise than another, at its tick or that one's latest."""
    if node.names == against:
        return []
    tick = node.tick
    if tick is not None:
        tick = min(tick, node.recording.info(against).head)
    found = false_beliefs(node.recording, node.names, node.tick, against, tick)
    return wrong_things(found)


def wrong_things(found: Iterable[Difference]) -> list[Wrong]:
    """Differences (`a` is taken for true) as drawings know them."""
    return [
        Wrong(each.where, value_words(each.b), value_words(each.a), each.kind == "inventory")
        for each in found
    ]


def _named(wrong: Wrong, recording: Recording) -> str:
    """What is false, by the name that people have for it."""
    if isinstance(wrong.where, str):
        return f"what {wrong.where} has" if wrong.is_owned else f"where {wrong.where} is"
    return recording.setting.labels.get(wrong.where, place_words(wrong.where))
