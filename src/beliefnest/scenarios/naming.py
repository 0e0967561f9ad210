"""Names of places of a scenario, for people."""

from collections.abc import Mapping

import msgspec

from beliefnest.nest.past.place_names import object_names
from beliefnest.nest.past.setting import Setting
from beliefnest.prompts.mind_view import MindView
from beliefnest.world.near import names_near
from beliefnest.world.texts import on_one_line
from beliefnest.world.values import Point, Position
from beliefnest.world.words import point_text


class Naming(msgspec.Struct, frozen=True):
    """Names of things in the text of a probe.

    Attributes:
        objects: Names of containers, signs, doors and switches that its reader knows.
        places: Named places that its reader knows.
        written: Names of things that the scenario's author knows, for the options of the file.
        labelled: Positions whose name is a label of the scenario.
    """

    objects: Mapping[Position, str]
    places: Mapping[str, Position]
    written: Mapping[Position, str]
    labelled: frozenset[Position] = frozenset()

    @property
    def all(self) -> tuple[str, ...]:
        """All names of things and places, each once."""
        names = (*self.objects.values(), *self.written.values(), *self.places)
        return tuple(dict.fromkeys(names))

    @classmethod
    def of(cls, view: MindView, setting: Setting) -> "Naming":
        """Return the names for a probe that is asked of a simulator."""
        labels = {at: on_one_line(label) for at, label in setting.labels.items()}
        labelled = {at for at, label in labels.items() if view.names.get(at, "").endswith(label)}
        return cls(view.names, view.places, object_names(setting), frozenset(labelled))


def container_name(place: Position, setting: Setting) -> str:
    """Return the label of a container, or its position if it has none."""
    return on_one_line(setting.labels.get(place, f"({', '.join(map(str, place))})"))


def place_name(point: Point, setting: Setting) -> str:
    """Return the name of a place near a point, or its coordinates if none is near."""
    names = names_near(point, {at: name for name, at in setting.places.items()})
    return names[0] if names else point_text(point)
