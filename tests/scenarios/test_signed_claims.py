"""Claims on signs in scenario files."""

from pathlib import Path

import pytest

import beliefnest as bn
from beliefnest.errors import ScenarioError

pytestmark = pytest.mark.usefixtures("kept_worlds")

TEXT = """\
name: signed
box: [[0, 0, 0], [9, 4, 8]]
blocks:
  - {block: stone, fill: [[0, 0, 0], [9, 0, 8]]}
  - {block: stone, fill: [[5, 1, 0], [5, 3, 6]]}
containers:
  - {at: [8, 1, 1], items: {diamond: 1}}
  - {at: [8, 1, 4]}
signs:
  - at: [3, 1, 1]
    text: east
    claims:
      - {container: [8, 1, 4], items: {diamond: 1}}
  - {at: [2, 1, 5]}
agents:
  ann: {position: [1.5, 1, 1.5]}
  bob: {position: [8.5, 1, 6.5]}
perception: {testimony: informed}
script:
  - agent: ann
    program: |
      await writeSign(bot, new Vec3(2, 1, 5), ["no", "west"],
        [located("diamond", new Vec3(8, 1, 1))])
      await doNothing(bot)
  - {agent: bob, program: "await goToPosition(bot, new Vec3(4, 1, 7), 0)"}
"""


def load(folder: Path, text: str) -> bn.Scenario:
    file = folder / "signed.yaml"
    file.write_text(text, encoding="utf-8")
    return bn.Scenario.load(str(file))


@pytest.mark.parametrize("world", ["embedded", "scripted"])
def test_signs_are_read_in_every_world(tmp_path: Path, world: str) -> None:
    with bn.Nest.open(load(tmp_path, TEXT), world=world) as nest:
        first = nest["/ann"].state.containers[8, 1, 4]
        assert (dict(first.items), first.basis.source) == ({"diamond": 1}, "heard")
        nest.play()
        written = [claim for claim in nest.claims() if claim.speaker == "ann"]
        assert [(claim.text, claim.sign) for claim in written] == [("no\nwest", (2, 1, 5))]
        (made,) = written
        assert (made.false, made.lie, made.taken_up("/bob")) == (False, True, True)
        assert made.why("/bob").startswith("bob believes what the sign at (2, 1, 5) says")
        assert made.heard_at("/bob") > made.tick


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        (
            ("{diamond: 1}}\n  - {at: [2", "{diamnd: 1}}\n  - {at: [2"),
            r":13: signs\[0\].claims\[0\].*diamnd",
        ),
        ((", items: {diamond: 1}}\n  - {at: [2", "}\n  - {at: [2"), r":13: .*makes no sense"),
        (("container: [8, 1, 4]", "container: [80, 1, 4]"), r":13: .*outside the box"),
        (("container: [8, 1, 4], items: {diamond: 1}", "heard: east"), r":13: .*cannot be claimed"),
        (("    text: east\n", ""), r":12: .*is for signs with a text"),
    ],
)
def test_faults_of_claims_are_named_with_their_line(
    tmp_path: Path, change: tuple[str, str], fault: str
) -> None:
    with pytest.raises(ScenarioError, match=fault):
        load(tmp_path, TEXT.replace(*change))
