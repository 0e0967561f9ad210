"""Reading of observations and names: once for each owner, and anew if the past changed."""

import beliefnest as bn

BOX = ((0, 0, 0), (5, 3, 5))


def test_several_owners_are_told_without_reading_anew() -> None:
    world = bn.ScriptedWorld(box=BOX, agents={"ann": (0.5, 1, 0.5), "bob": (3.5, 1, 3.5)})
    nest = bn.Nest(world)
    ann = nest["/ann"].view.observations
    bob = nest["/bob"].view.observations
    assert nest["/ann"].view.observations is ann
    assert nest["/bob"].view.observations is bob


def test_a_branch_of_the_same_name_and_length_is_told_as_it_is() -> None:
    scenario = bn.Scenario.from_mapping(
        {
            "name": "room",
            "box": BOX,
            "blocks": [{"block": "stone", "fill": [[0, 0, 0], [5, 0, 5]]}],
            "agents": {"ann": {"position": [0.5, 1, 0.5]}},
        }
    )
    with bn.Nest.open(scenario, "scripted") as nest:
        said = []
        for words in ("one", "two"):
            nest["/"].switch("trial", at=0)
            nest["/"].run("ann", f"bot.chat('{words}')")
            said.append(str(nest["/"].view.observations))
            nest["/"].switch("main")
            nest["/"].delete("trial")
    assert "one" in said[0]
    assert "two" in said[1]
