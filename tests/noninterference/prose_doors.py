"""Doors of prose: templates, filters, captions and observations."""

from tests.noninterference.doors import door
from tests.noninterference.pairs import Played

from beliefnest.prompts import BUILT_IN, built_in_template
from beliefnest.prompts.story_filters import captions
from beliefnest.prompts.templates import BUILT_IN_TEMPLATES

_ARGUMENTS = {"block_property": "('chest')"}
"""Arguments of the filters that need one."""


@door()
def templates(world: Played, path: str) -> object:
    """Return the text of every built-in template."""
    asked = {"question": "Where?", "options": ("a", "b"), "reason": True, "instructed": True}
    return {
        name: world.nest[path].render(built_in_template(name), task="Go.", **asked)
        for name in BUILT_IN_TEMPLATES
        if name != "instructions"
    }


@door()
def plain_story(world: Played, path: str) -> object:
    """Return the prose of a question, without positions."""
    return world.nest[path].render("{{ branch | beginning }}\n{{ branch | story }}")


@door(every=2)
def earlier_story(world: Played, path: str) -> object:
    """Return the prose at an earlier tick."""
    then = world.nest.at(world.nest.tick // 2)[path]
    return then.render("{{ branch | beginning }}\n{{ branch | story(narrated=true) }}")


@door(every=2)
def filters(world: Played, path: str) -> object:
    """Return the text of every built-in filter."""
    told = {}
    for name in BUILT_IN.filters:
        source = "{{ branch | " + name + _ARGUMENTS.get(name, "") + " }}"
        told[name] = world.nest[path].render(source)
    return told


@door()
def sentences(world: Played, path: str) -> object:
    """Return the captions of a film."""
    return captions(world.nest[path].view)


@door()
def names(world: Played, path: str) -> object:
    """Return the names, labels and places that templates may read."""
    source = "{{ branch.names }} {{ branch.labels }} {{ branch.places }} {{ branch.observations }}"
    return world.nest[path].render(source)
