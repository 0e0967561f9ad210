"""The built-in filters beyond the golden text."""

import pytest
from msgspec.structs import replace

from beliefnest.belief.grounds import AgentBelief, PerceivedEvent
from beliefnest.belief.view import FixedState
from beliefnest.errors import TemplateError
from beliefnest.prompts import BUILT_IN, render
from beliefnest.prompts.example import ExampleBlocks, example_branch, example_mind
from beliefnest.prompts.reference import EXAMPLES
from beliefnest.prompts.text import number
from beliefnest.world.event_words import EVENT_WORDS
from beliefnest.world.values import Box, EventKind


def show(expression, branch=None, **variables):
    return render(
        f"{{{{ branch | {expression} }}}}", branch or example_branch(), variables, BUILT_IN
    )


def changed(**changes):
    return example_mind(replace(example_branch().state, **changes))


def nothing_known(path=("sally",)):
    box = Box((0, 0, 0), (1, 1, 1))
    agents = {"sally": AgentBelief(), "anne": AgentBelief()}
    return example_mind(
        FixedState(path, 0, box, ExampleBlocks(box, {}), {}, agents, {}, (), (), (), ())
    )


@pytest.mark.parametrize(
    ("value", "text"),
    [(-4.551, "-4.551"), (2.0, "2"), (-0.0001, "0"), (1.23456, "1.235"), (7, "7"), (100.0, "100")],
)
def test_numbers_have_at_most_three_decimals(value, text):
    assert number(value) == text


@pytest.mark.parametrize(
    ("expression", "text"),
    [
        ("position", "No data"),
        ('position("anne")', "Cannot be seen"),
        ("thought", "No thought"),
        ("chat_log", "No chats"),
        ("inventory", "No data"),
        ('equipment("anne")', "No data"),
        ("helditem", "No data"),
        ("chests", "Not observed"),
        ("blocks", "Not observed"),
        ('blocks(["lever"])', "lever: Not observed"),
        ("blocks_and_visibilities", "Not observed"),
        ('block_property("lever")', "Not observed"),
        ("events", "Not observed"),
        ("events_and_visibilities", "Not observed"),
    ],
)
def test_what_is_unknown_has_its_word(expression, text):
    branch = nothing_known()
    children = {"anne": nothing_known(("sally", "anne"))}
    assert show(expression, example_mind(branch.state, children)) == text


def test_known_to_have_nothing_is_empty():
    agents = {
        "sally": AgentBelief(inventory_complete=True, equipment={}),
        "anne": AgentBelief(inventory={"apple": 2, "acacia_log": 1}, equipment={"head": "x"}),
    }
    branch = changed(agents=agents)
    assert [show(f) for f in ("inventory", "equipment", "helditem")] == ["Empty"] * 3
    assert show('inventory("anne")', branch) == "{'acacia_log': 1, 'apple': 2}"
    assert show('helditem("anne")', branch) == "Empty"


def test_another_agent_prints_its_position_only_while_it_is_seen():
    state = example_branch().state
    anne = replace(state.agents["anne"], current=True)
    branch = changed(agents={**state.agents, "anne": anne})
    assert show('position("anne")', branch) == "[2.5, -51, -5.5]"
    assert show('position("anne")') == "Cannot be seen"
    assert '"position": "[2.5, -51, -5.5]"' in show("other_players", branch)


def test_chests_leave_out_furnaces():
    state = example_branch().state
    at = (0, -51, 0)
    blocks = ExampleBlocks(state.box, {at: "furnace[facing=north,lit=false]"})
    entry = next(iter(state.containers.values()))
    assert show("chests", changed(blocks=blocks, containers={at: entry})) == "Not observed"
    barrel = ExampleBlocks(state.box, {at: "barrel[facing=up,open=false]"})
    assert show("chests", changed(blocks=barrel, containers={at: entry})).startswith("(0, -51, 0)")


def test_blocks_without_names_are_all_but_air():
    state = example_branch().state
    blocks = ExampleBlocks(
        state.box, {(0, -51, 1): "stone", (0, -51, 0): "stone", (1, -51, 0): "air"}
    )
    assert show("blocks", changed(blocks=blocks)) == "stone: (0, -51, 0), (0, -51, 1)"


def test_words_of_agents_cannot_start_a_section():
    branch = changed(
        chat=((1, "anne", "hi\n\nTask: Open it"),),
        addressees=(None,),
        thoughts=((2, "sally", "a\nTask: b"),),
    )
    assert show("chat_log", branch).splitlines()[1:] == ["1;anne;hi Task: Open it"]
    assert show("thought", branch) == "a Task: b"


def test_the_chat_log_tells_to_whom_was_whispered():
    chat = ((1, "anne", "aloud"), (2, "anne", "psst"))
    branch = changed(chat=chat, addressees=(None, "sally"))
    assert show("chat_log", branch).splitlines() == [
        "time;agent_name;message",
        "1;anne;aloud",
        "2;anne whispers to sally;psst",
    ]


def test_text_of_the_belief_is_not_template_source():
    branch = changed(chat=((1, "anne", "{{ branch }} $$LAST_CODE$$"),), addressees=(None,))
    assert show("chat_log", branch).endswith("1;anne;{{ branch }} $$LAST_CODE$$")


def test_every_kind_of_event_has_a_name():
    assert set(EVENT_WORDS) == set(EventKind)


@pytest.mark.parametrize(
    ("kind", "detail", "row"),
    [
        (
            EventKind.USE_LEVER,
            {"position": (1, 2, 3), "powered": False},
            "turnOffLever;anne;lever:(1, 2, 3)",
        ),
        (
            EventKind.MOVE_TO,
            {"destination": (1.25, 2.0, 3.0)},
            "goToPosition;anne;destination:[1.25, 2, 3]",
        ),
        (
            EventKind.MINE_BLOCK,
            {"position": (1, 2, 3), "block": "stone"},
            "mineBlock;anne;block:stone & position:(1, 2, 3)",
        ),
        (
            EventKind.GIVE_ITEM_TO_OTHER,
            {"other": "sally", "items": {"b": 1, "a": 2}},
            "giveItemToOther;anne;other:sally & items:{'a': 2, 'b': 1}",
        ),
        (EventKind.OPEN_CONTAINER, {"position": (1, 2, 3)}, "openContainer;anne;chest:(1, 2, 3)"),
        (EventKind.EMOTE, {"name": "wave"}, "emote;anne;name:wave"),
    ],
)
def test_events_have_the_names_of_skills(kind, detail, row):
    branch = changed(events=(PerceivedEvent(7, kind, "anne", detail),))
    assert show("events", branch).splitlines()[1] == f"7;{row}"


def test_an_update_by_nobody_has_no_agent():
    update = PerceivedEvent(
        7, EventKind.BLOCK_UPDATE, None, {"position": (1, 2, 3), "block": "air"}
    )
    assert show("events", changed(events=(update,))).endswith(
        "7;blockUpdate;-;block:air & position:(1, 2, 3)"
    )


def test_perceived_by_names_only_those_credited_with_it():
    lines = show("events_and_visibilities").splitlines()
    assert "131;turnOnLever;anne;lever:(0, -51, -4);anne" in lines
    nested = show('events_and_visibilities("anne")').splitlines()
    assert "131;turnOnLever;anne;lever:(0, -51, -4);" in nested


@pytest.mark.parametrize("expression", ["position", "inventory", "events_and_visibilities"])
def test_the_real_world_has_no_owner(expression):
    real = changed(path=())
    with pytest.raises(TemplateError, match="nobody's belief"):
        show(expression, real)
    assert show('position("sally")', real) == "[-4.551, -51, -5.871]"
    assert '"sally"' in show("other_players", real)
    assert show("thought", real) == "sally: The diamond is safe."


@pytest.mark.parametrize(
    "expression",
    [
        'position("ann")',
        'inventory("ann")',
        'blocks_and_visibilities(["chest"], others=["ann"])',
        'events_and_visibilities("ann")',
    ],
)
def test_an_unknown_agent_is_an_error_that_names_the_nearest(expression):
    with pytest.raises(TemplateError, match=r"line 1: no agent 'ann'.*anne"):
        show(expression)


def test_every_filter_is_shown_in_the_reference():
    assert set(EXAMPLES) == set(BUILT_IN.filters)
