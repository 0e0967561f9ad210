"""Generator of the filter reference, docs/filters.md, from `texts/filters.md` and the filters.

`python -m beliefnest.prompts.reference` prints it.
"""

import inspect
import sys
from collections.abc import Mapping
from importlib.resources import files
from typing import Any

from beliefnest.prompts.builtin import BUILT_IN
from beliefnest.prompts.example import example_branch
from beliefnest.prompts.filterset import PromptFilter
from beliefnest.prompts.mind_view import MindView
from beliefnest.prompts.rendering import render
from beliefnest.prompts.templates import BUILT_IN_TEMPLATES

EXAMPLES: Mapping[str, tuple[str, ...]] = {
    "beginning": ("{{ branch | beginning }}", "{{ branch | beginning(narrated=true) }}"),
    "block_property": ('{{ branch | block_property("lever") }}',),
    "blocks": ('{{ branch | blocks(["chest", "furnace"]) }}',),
    "blocks_and_visibilities": (
        '{{ branch | blocks_and_visibilities(["chest", "furnace"]) }}',
        '{{ branch | blocks_and_visibilities(["lever"], others=["anne"]) }}',
    ),
    "chat_log": ("{{ branch | chat_log }}",),
    "chests": ("{{ branch | chests }}",),
    "containers": ("{{ branch | containers }}",),
    "equipment": ("{{ branch | equipment }}", '{{ branch | equipment("anne") }}'),
    "events": ("{{ branch | events }}",),
    "events_and_visibilities": (
        "{{ branch | events_and_visibilities }}",
        '{{ branch | events_and_visibilities(me="anne") }}',
    ),
    "mechanisms": ("{{ branch | mechanisms }}",),
    "helditem": ("{{ branch | helditem }}", '{{ branch | helditem("anne") }}'),
    "inventory": ("{{ branch | inventory }}", '{{ branch | inventory("anne") }}'),
    "observations": ("{{ branch | observations }}",),
    "other_players": ("{{ branch | other_players }}",),
    "position": ("{{ branch | position }}", '{{ branch | position("anne") }}'),
    "whereabouts": ("{{ branch | whereabouts }}",),
    "story": ("{{ branch | story }}", "{{ branch | story(coordinates=true) }}"),
    "signs": ("{{ branch | signs }}",),
    "thought": ("{{ branch | thought }}",),
}
"""Example templates for each filter."""


def filter_reference() -> str:
    """Return the text of docs/filters.md."""
    branch = example_branch()
    sections = [_section(each, branch) for each in BUILT_IN.filters.values()]
    rows = [f"| `{name}` | {description} |" for name, description in BUILT_IN_TEMPLATES.items()]
    table = "\n".join(["| template | text |", "|---|---|", *rows])
    head = (files("beliefnest.prompts") / "texts" / "filters.md").read_text(encoding="utf-8")
    return "\n".join([head.replace("@TEMPLATES@", table), *sections])


def _section(described: PromptFilter[Any], branch: MindView) -> str:
    parameters = list(inspect.signature(described.function).parameters.values())[1:]
    arguments = ", ".join(str(each.replace(annotation=each.empty)) for each in parameters)
    title = f"{described.name}({arguments})" if arguments else described.name
    examples = "\n".join(
        f"```jinja\n{template}\n```\n\n```text\n{render(template, branch, {}, BUILT_IN)}\n```\n"
        for template in EXAMPLES[described.name]
    )
    return f"### `{title}`\n\n{inspect.getdoc(described.function)}\n\n{examples}"


if __name__ == "__main__":
    sys.stdout.write(filter_reference())
