"""Views of simulators for everything that speaks or shows in somebody's name."""

from beliefnest.errors import PathError
from beliefnest.nest.past.labelled import Labelled
from beliefnest.nest.past.observing import observations_of
from beliefnest.nest.past.place_names import object_names
from beliefnest.nest.past.recording import Recording
from beliefnest.prompts.mind_view import MindView, ToldMind
from beliefnest.prompts.naming import believed_names, known_places
from beliefnest.world.paths import BeliefPath, normalised

_KEPT = 8


def mind_view(recording: Recording, path: BeliefPath, tick: int | None) -> MindView:
    """Return the view of a simulator, now or at a past tick.

    Names and labels of the real world are those of the scenario. In a belief they follow from its
    state and the percepts of its owner.
    """

    def below(agent: str) -> MindView:
        if agent not in recording.agents:
            raise PathError(
                f"there is no agent {agent!r}; the agents are {', '.join(recording.agents)}"
            )
        return mind_view(recording, normalised((*path, agent)), tick)

    return MindView(recording.state(path, tick), lambda: _told(recording, path, tick), below)


def _told(recording: Recording, path: BeliefPath, tick: int | None) -> ToldMind:
    """Return what a simulator's owner is told; the latest few are kept, for the next questions."""
    kept = recording.told
    of = path, recording.moment(path, tick), recording.history.generation
    if of not in kept:
        mind = _read(recording, path, tick)
        if len(kept) == _KEPT:
            del kept[next(iter(kept))]
        kept[of] = mind
    return kept[of]


def _read(recording: Recording, path: BeliefPath, tick: int | None) -> ToldMind:
    setting = recording.setting
    observations = observations_of(recording, path, tick)
    if not path:
        names, labels = object_names(setting), setting.prompt_labels
        return ToldMind(observations, names, labels, setting.places, setting.unique)
    state = recording.state(path, tick)
    labelled = Labelled(recording, recording.moment(path, tick))
    known_names = labelled.known(state, observations, setting.labels)
    return ToldMind(
        observations,
        believed_names(state, observations, known_names),
        labelled.known(state, observations, setting.prompt_labels),
        known_places(state, setting.places),
        setting.unique,
    )
