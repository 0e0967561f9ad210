"""Skills as models read of them and as worlds run them."""

from beliefnest.skills import skills
from beliefnest.worlds.scripted.skills import SKILLS


def test_every_skill_has_a_signature_and_an_example_that_calls_it() -> None:
    found = skills()
    assert {"goToPosition", "getItemFromChest", "giveItemToOther", "say"} <= {
        skill.name for skill in found
    }
    for skill in found:
        assert skill.signature.startswith(f"{skill.name}(")
        assert f"{skill.name}(" in skill.example
        assert skill.description.endswith(".")


def test_skills_that_work_in_the_scripted_world_have_a_twin_there() -> None:
    assert {skill.name for skill in skills() if skill.scripted} == {*SKILLS}
