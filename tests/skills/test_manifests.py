"""What models read of the skills."""

import re
from pathlib import Path

import beliefnest
from beliefnest.programs import skills

FOLDER = Path(beliefnest.__file__).parent / "skills" / "code"


def test_every_skill_has_a_signature_and_an_example_that_calls_it() -> None:
    found = skills()
    assert {"goToPosition", "getItemFromChest", "giveItemToOther", "say"} <= {
        skill.name for skill in found
    }
    for skill in found:
        assert skill.signature.startswith(f"{skill.name}(")
        assert f"{skill.name}(" in skill.example
        assert skill.description.endswith(".")


def test_every_skill_is_written_in_a_file_of_its_name() -> None:
    index = (FOLDER / "index.js").read_text(encoding="utf-8")
    for skill in skills():
        assert re.search(rf"\b{skill.name}\b", index) or (FOLDER / f"{skill.name}.js").is_file()
