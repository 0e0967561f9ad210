"""A scenario with questions for people, and answers as its page writes them."""

import base64
import json
import zlib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

TRANSFER = """\
name: transfer
description: Sally puts something into the left box and goes away; Anne moves it.
box: [[-6, -1, -6], [6, 2, 6]]
blocks:
  - {block: smooth_stone, fill: [[-6, -1, -6], [6, -1, 6]]}
  - {block: stone_bricks, fill: [[2, 0, 1], [6, 2, 1]]}
parameters:
  item: {default: diamond, values: [diamond, apple, bone]}
containers:
  - {label: left box, at: [-2, 0, -4], block: "chest[facing=south]"}
  - {at: [2, 0, -4], block: "chest[facing=south]"}
agents:
  sally: {position: [-0.5, 0, 3.5], facing: north, inventory: {"${item}": 1}}
  anne: {position: [0.5, 0, -0.5], facing: west}
perception: {max_visible_distance: 20}
script:
  - label: Sally puts it into the left box
    agent: sally
    program: |
      await goToPosition(bot, new Vec3(-2, 0, -3), 0);
      await depositItemIntoChest(bot, new Vec3(-2, 0, -4), {${item}: 1});
  - label: Sally goes away
    agent: sally
    program: await goToPosition(bot, new Vec3(5, 0, 4), 0);
  - label: Anne moves it
    agent: anne
    program: |
      await goToPosition(bot, new Vec3(-2, 0, -3), 0);
      await getItemFromChest(bot, new Vec3(-2, 0, -4), {${item}: 1});
      await goToPosition(bot, new Vec3(2, 0, -3), 0);
      await depositItemIntoChest(bot, new Vec3(2, 0, -4), {${item}: 1});
probes:
  - label: belief
    path: /
    expect:
      answers:
        question: Where will Sally look for the ${item}?
        options: [left box, chest]
        right: {path: /sally, item: "${item}"}
        reason: true
  - label: own
    path: /sally
    expect:
      answers:
        - {question: "Where is the ${item}?", right: {path: /sally, item: "${item}"}}
        - {question: "Who is there?", options: [anne, nobody], right: anne}
  - label: act
    path: /sally
    acts_in: /
    agent: sally
    task: Get the ${item}.
    expect: {opens: [-2, 0, -4]}
conditions:
  1: {description: Sally goes behind a wall.}
  2:
    description: Sally stays in the room.
    script:
      Sally goes away: {program: "await goToPosition(bot, new Vec3(5, 0, -5), 0);"}
"""

STUDY = """\
scenarios: [transfer.yaml]
models: [offline]
world: scripted
design: latin-square
variations: {item: [diamond, apple]}
"""


def transfer_in(folder: Path, study: str = STUDY, scenario: str = TRANSFER) -> Path:
    """Path of a study's file, the scenario beside it."""
    (folder / "transfer.yaml").write_text(scenario, encoding="utf-8")
    file = folder / "study.yaml"
    file.write_text(study, encoding="utf-8")
    return file


def content_of(page: Path) -> dict[str, Any]:
    """Return what a page contains, unpacked."""
    text = (page / "stimuli.js").read_text(encoding="utf-8")
    packed = json.loads(text.partition("=")[2])
    found: dict[str, Any] = json.loads(zlib.decompress(base64.b64decode(packed)))
    return found


def answers_of(
    page: Mapping[str, Any],
    participant: str,
    number: int,
    *,
    right: bool = True,
    place: str = "chest",
) -> Iterator[dict[str, Any]]:
    """Yield a participant's answers to all questions of a list, in the form of the page.

    Args:
        page: Content of the page.
        participant: Id of the participant.
        number: Number of the list, from 1.
        right: False: Sally is taken to know everything.
        place: Container in which the item is at the end.
    """
    for at in page["lists"][number - 1]:
        item = page["items"][at]
        knows = item["condition"] == 2 or not right
        where = place if knows else "left box"
        for view in item["views"]:
            for asked in view["questions"]:
                said = "anne" if asked["options"][:1] == ["anne"] else where
                yield {
                    "study": page["study"],
                    "participant": participant,
                    "list": number,
                    "shown": page["shown"],
                    "started": f"2026-11-23T10:00:0{number}.000Z",
                    "cell": item["cell"],
                    "question": asked["id"],
                    "response": said,
                    "position": asked["options"].index(said) + 1 if asked["options"] else None,
                    "reason": "",
                    "options": asked["options"],
                    "rt": 1234,
                    "trial_type": "beliefnest-question",
                }
