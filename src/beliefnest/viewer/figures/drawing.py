"""Scenes and figures of simulators, for `pictures`."""

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from msgspec.structs import replace

from beliefnest.belief.view import State
from beliefnest.errors import InputError
from beliefnest.nest.explain.comparison import Difference, value_words
from beliefnest.nest.face.shown import ShownSimulator
from beliefnest.nest.past.labelled import Labelled
from beliefnest.nest.past.recording import Recording
from beliefnest.pictures.figure import Figure, figure_of
from beliefnest.pictures.scene import Scene, Wrong, best_height, read_scene
from beliefnest.prompts.naming import known_places
from beliefnest.world.paths import BeliefPath, parse_path, path_text
from beliefnest.world.words import counted

if TYPE_CHECKING:
    from beliefnest.minds.inference import Inference


def figure_with(
    scenes: Sequence[Scene], inference: "Inference | None", steps: int, tick: int | None
) -> Figure:
    """Return a figure of scenes, with a posterior at their tick or, before that, at its last."""
    if inference is None:
        return figure_of(scenes)
    # Imported here because inference takes long to import, and few figures show one.
    from beliefnest.minds.charts import bars_of, heat_of

    then = None if tick is None or tick >= inference.until else tick
    heat = heat_of(inference, steps, then)
    actions = counted(steps, "action")
    words = f"where {inference.model.agent} will be after {actions}"
    tinted = [replace(scene, heat=heat, heat_words=words) for scene in scenes]
    return figure_of(tinted, bars_of(inference, then))


def figure_of_state(state: State) -> Figure:
    """Return a figure of a state alone."""
    return figure_of([read_scene(state)])


def scenes_of(
    recording: Recording,
    shown: Sequence[ShownSimulator],
    against: str | None,
    sight: Sequence[str] | None,
    height: int | None,
) -> tuple[Scene, ...]:
    """Return the scenes of simulators, all of one storey, as `Nest.scenes` describes them."""
    if not shown:
        raise InputError("a figure needs at least one simulator; give a belief path")
    other = parse_path("/" if against is None else against, recording.agents)
    for name in sight or ():
        parse_path(path_text((name,)), recording.agents)
    low, high = recording.box.low[1], recording.box.high[1]
    if height is not None and not low <= height <= high:
        raise InputError(
            f"height {height} lies outside the box; give a height from {low} to {high}"
        )
    # Draw the same storey of all simulators, so that they can be compared.
    level = best_height([each.state for each in shown]) if height is None else height
    return tuple(_scene(recording, each, other, sight, level) for each in shown)


def _scene(
    recording: Recording,
    shown: ShownSimulator,
    against: BeliefPath,
    sight: Sequence[str] | None,
    height: int,
) -> Scene:
    path, state = parse_path(shown.path, recording.agents), shown.state
    # An agent that is not perceived now is drawn at a remembered place. What it sees now is
    # unknown, so its sight is not drawn.
    own = [name for name in path[-1:] if state.agents[name].current]
    seen = {name: shown.visible_blocks(name) for name in (own if sight is None else sight)}
    setting, key = recording.setting, recording.selected.get(path)
    labels, places = setting.labels, setting.places
    if path:
        labelled = Labelled(recording, recording.moment(path, state.tick))
        labels, places = labelled.known(state, (), labels), known_places(state, places)
    return read_scene(
        state,
        wrong=wrong_things(shown.otherwise(against)),
        against=path_text(against),
        labels=labels,
        places=places,
        sight=seen,
        height=height,
        note=f"branch {key.branch}" if key is not None and path else "",
    )


def wrong_things(differences: Iterable[Difference]) -> list[Wrong]:
    """Return differences, of which `a` is true, as drawings mark them."""
    return [
        Wrong(each.where, value_words(each.b), value_words(each.a), each.kind == "inventory")
        for each in differences
    ]
