"""Conversion of simulators' states into values that `pictures` draws."""

from collections.abc import Iterable, Mapping

import numpy as np
import numpy.typing as npt

from beliefnest.belief.view import State
from beliefnest.nest.explain.comparison import Difference, value_words
from beliefnest.nest.past.labelled import Labelled
from beliefnest.nest.past.recording import Recording
from beliefnest.pictures.scene import Scene, Wrong, read_scene
from beliefnest.prompts.naming import known_places
from beliefnest.world.paths import BeliefPath, path_text


def scene_of(
    recording: Recording,
    path: BeliefPath,
    state: State,
    otherwise: Iterable[Difference],
    against: BeliefPath,
    sight: Mapping[str, npt.NDArray[np.bool_]],
    height: int,
) -> Scene:
    """Return the scene of a simulator's state.

    Args:
        recording: Recording of the nest.
        path: Path of the simulator.
        state: Its state.
        otherwise: Its false beliefs.
        against: Path against which they are false.
        sight: Masks of visible blocks, by agent whose sight is drawn.
        height: Storey to draw, as the y of blocks on its floor.
    """
    setting, key = recording.setting, recording.selected.get(path)
    labels, places = setting.labels, setting.places
    if path:
        labelled = Labelled(recording, recording.moment(path, state.tick))
        labels, places = labelled.known(state, (), labels), known_places(state, places)
    return read_scene(
        state,
        wrong=wrong_things(otherwise),
        against=path_text(against),
        labels=labels,
        places=places,
        sight=sight,
        height=height,
        note=f"branch {key.branch}" if key is not None and path else "",
    )


def wrong_things(found: Iterable[Difference]) -> list[Wrong]:
    """Return differences, of which `a` is true, as drawings mark them."""
    return [
        Wrong(each.where, value_words(each.b), value_words(each.a), each.kind == "inventory")
        for each in found
    ]
