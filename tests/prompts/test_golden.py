"""The paper's printed prompt, letter for letter."""

from pathlib import Path

import pytest

from beliefnest.belief.grounds import AgentBelief, Basis, ContainerBelief, PerceivedEvent, Source
from beliefnest.belief.view import FixedState
from beliefnest.prompts import BUILT_IN, built_in_template, render
from beliefnest.prompts.example import ExampleBlocks, example_mind
from beliefnest.world.values import Box, EventKind

GOLDEN = Path(__file__).parents[2] / ".." / "shared" / "golden"
LEFT, RIGHT = (-2, -51, -4), (2, -51, -4)
CHEST = "chest[facing=south,type=single,waterlogged=false]"


def sallys_belief(path=("sally",)):
    """Return the belief that the README beside the golden texts describes."""
    box = Box((-11, -52, -11), (11, -49, 11))
    early = Basis(12, Source.SEEN)
    return example_mind(
        FixedState(
            path=path,
            tick=412,
            box=box,
            blocks=ExampleBlocks(box, {RIGHT: CHEST, LEFT: CHEST, (0, -52, 0): "stone"}),
            containers={
                RIGHT: ContainerBelief({}, False, early, False),
                LEFT: ContainerBelief(
                    {"diamond": 1},
                    False,
                    Basis(69, Source.WITNESSED, EventKind.DEPOSIT_ITEM_INTO_CHEST),
                    False,
                ),
            },
            agents={
                "sally": AgentBelief(
                    position=(-4.5510001, -51.0, -5.871), basis=Basis(412, Source.SEEN)
                ),
                "anne": AgentBelief(
                    position=(2.5, -51.0, -5.5),
                    equipment={"main_hand": "iron_chestplate"},
                    basis=Basis(90, Source.SEEN),
                ),
            },
            items={},
            events=(
                PerceivedEvent(
                    69,
                    EventKind.DEPOSIT_ITEM_INTO_CHEST,
                    "sally",
                    {"position": LEFT, "items": {"diamond": 1}},
                ),
            ),
            chat=(),
            thoughts=(),
            addressees=(),
        )
    )


@pytest.mark.skipif(not GOLDEN.exists(), reason="the golden texts are not beside the repository")
@pytest.mark.parametrize("path", [("sally",), ("observer", "sally")])
def test_golden_prompt_is_reproduced(path):
    expected = (GOLDEN / "paper_prompt.txt").read_text(encoding="utf-8")
    text = render(
        GOLDEN / "template.txt",
        sallys_belief(path),
        {"task": "Get a diamond from a chest."},
        BUILT_IN,
    )
    assert text == expected


@pytest.mark.skipif(not GOLDEN.exists(), reason="the golden texts are not beside the repository")
def test_shipped_paper_template_gives_the_golden_prompt():
    expected = (GOLDEN / "paper_prompt.txt").read_text(encoding="utf-8")
    variables = {"task": "Get a diamond from a chest.", "last_code": None, "last_error": None}
    assert render(built_in_template("paper"), sallys_belief(), variables, BUILT_IN) == expected
