"""Generator of the filter reference, docs/filters.md, from the filters themselves.

`python -m beliefnest.prompts.reference` prints it.
"""

import inspect
import sys
from collections.abc import Mapping
from typing import Any

from beliefnest.prompts.builtin import BUILT_IN
from beliefnest.prompts.example import ExampleBranch, example_branch
from beliefnest.prompts.filterset import PromptFilter
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

_HEAD = '''\
# Prompt filters

<!-- Written by `python -m beliefnest.prompts.reference`; change the docstrings, not this. -->

A prompt template is a Jinja2 text. The variable `branch` is a view of a simulator: its state,
what its owner observed, and the owner's names for things. A filter turns it into text. The
examples on this page show one belief: Sally's at tick 240 (`beliefnest.prompts.example`).
Numbers have at most three decimals.

A filter prints `No data`, `Cannot be seen`, `Not observed`, `No chats`, `No thought` or
`Empty` only if the value is truly unknown or empty. An unknown filter, variable or agent is
an error that names the line. Templates can read a simulator, but cannot call its methods.
Values that a template prints without a filter have control characters and marks of text
direction escaped.

A rendering has at most 10,000,000 steps, and a value in it as many characters and parts of
lists. A printed character is a step, a part of a list that is worked on 3, a turn of a loop
10, a call or a filter of Jinja 50, another filter 550. A template that needs more, or whose
macros call themselves without end, ends with an error that names the line. Jinja's function
`lipsum` is not available.

`$$LAST_CODE$$` and `$$LAST_ERROR$$` stand for the variables `last_code` and `last_error`:
the program of the previous round and its error. If these are not set, the markers print
`No code was executed` and `No error`.

## Built-in templates

`beliefnest template NAME` prints a built-in template, to copy and change. Name it in a probe
(`template: story`), in a study (`templates: [question, story]`) or in
`beliefnest prompt RUN --path /ann --template story`.

@TEMPLATES@

Questions get the variables `question`, `options`, `reason` and `places`; programs get `task`.
`story` and `question` tell what the mind of the probe's `path` observed, and leave it to the
reader what follows. They do not tell who else perceived an event, nor what somebody believes
now; contents that nobody looked at do not appear. With the path `/` a narrator tells
everything: which agents and things each agent could see, and who knew at first what somebody
has. Unless hearing is `global`, `story` says who heard an utterance. Of a unique item it says
that there is only one. With a path such as `/lia/wim` the text tells only what Lia knows that
Wim observed: the nest has worked that out already. To leave it to the reader, take `/lia` or
`/` and ask about Wim in words. `story` has no coordinates in questions; it has them in tasks,
because programs need them. Containers without a `label` are named by their block, and by a
compass direction or a number if there are several (`western chest`, `third chest`, counted from
the west). A mind has names for what it knows alone: behind a wall there may be a second chest,
and the first is `the chest` all the same. Named places are told to it if it knows their cell or
their floor.

`run` and `study` read the narrator's stories back: if the right answer to a question about an
item does not follow from the text alone, for example because it rests on an initial belief that
no narrator tells, they warn with file, line and probe before any model is asked. The reader
judges no stories with several such items, and none under `testimony: informed`.

## Your own filters

```python
import beliefnest as bn
from beliefnest.prompts import BUILT_IN, filter, render

@filter("greeting")
def greeting(branch, word="Hello"):
    return f"{word}, {branch.state.owner}!"

world = bn.ScriptedWorld(box=((0, 0, 0), (8, 4, 8)), agents={"sally": (1.5, 1, 1.5)})
filters = BUILT_IN.extended([greeting])
with bn.Nest(world) as nest:
    print(render('{{ branch | greeting("Hi") }}', nest["/sally"], {}, filters))  # Hi, sally!
```

To replace a built-in filter, write `@filter("chests", override=True)`. To offer the filters
of a package to every template, add entry points of the group `beliefnest.filters`:

```toml
[project.entry-points."beliefnest.filters"]
greeting = "my_package.filters:greeting"
```

To use filters in one nest alone, give it a renderer: `Nest.open(..., renderer=Renderer(filters))`,
with `Renderer` from `beliefnest.prompts`; so with `Nest.resume`. A run does not record it.

## Several simulators in one prompt

Variables of a template may be simulators, too: of other paths, of past ticks (`nest.at`) and of
other branches (`on`), alone or in lists and mappings. Filters take them like `branch`:

```python
import beliefnest as bn

template = """\\
Anne believes:
{{ branch | containers }}

At first she believed:
{{ before | containers }}
{% for name in plans %}
After "{{ name }}" she would say:
{{ plans[name] | chat_log }}
{% endfor %}"""

world = bn.ScriptedWorld(
    box=((0, 0, 0), (8, 4, 8)), agents={"anne": (1.5, 1, 1.5)}, containers={(3, 1, 3): {"bone": 1}}
)
with bn.Nest(world) as nest:
    world.open("anne", (3, 1, 3))
    plans = {"greet": "bot.chat('Hello!')", "ask": "bot.chat('Where is it?')"}
    nest.explore("/anne", "anne", plans, lambda simulator, result: result.ticks)
    anne = nest["/anne"]
    tried = {name: anne.on(f"plan {name}") for name in plans}
    print(anne.render(template, before=nest.at(0)["/anne"], plans=tried))
```

## The built-in filters
'''


def filter_reference() -> str:
    """Return the text of docs/filters.md."""
    branch = example_branch()
    sections = [_section(each, branch) for each in BUILT_IN.filters.values()]
    rows = [f"| `{name}` | {told} |" for name, told in BUILT_IN_TEMPLATES.items()]
    table = "\n".join(["| template | text |", "|---|---|", *rows])
    return "\n".join([_HEAD.replace("@TEMPLATES@", table), *sections])


def _section(described: PromptFilter[Any], branch: ExampleBranch) -> str:
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
