"""Items of a study: its scripts are played without any model, and each question is recorded."""

import json
import random
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from msgspec.structs import replace

from beliefnest.errors import InputError, ScenarioError
from beliefnest.nest.face.nest import Nest
from beliefnest.plan.cells import Plan, digest, variation_id
from beliefnest.plan.scenario_cells import Cell
from beliefnest.scenarios.document import Document
from beliefnest.scenarios.expected_answers import Answers
from beliefnest.scenarios.naming import Naming
from beliefnest.scenarios.probing import naming_for, resolved
from beliefnest.scenarios.prose_check import check_prose
from beliefnest.scenarios.questioning import shuffled
from beliefnest.studies.checking import StudyKeyError
from beliefnest.studies.items.balance import balanced_names
from beliefnest.studies.items.record import DroppedQuestion, ItemRecord, item_id
from beliefnest.studies.items.shortcuts import mentions, names_asked_for, shortcuts
from beliefnest.studies.participants.items import Item, ItemQuestion, item_name, items_of
from beliefnest.studies.participants.playing import STORY, OnItem, played_items
from beliefnest.world.paths import parse_path
from beliefnest.world.words import listed, titled

MadeItems = Mapping[str, Sequence[ItemRecord | DroppedQuestion]]
"""Questions of a study by the name of their scene (`item_name`), in the order of the study."""


def made_items(
    cells: Sequence[Cell], documents: Mapping[str, Document], on_item: OnItem | None = None
) -> MadeItems:
    """Play scripts in the scripted world, and return their questions.

    Args:
        cells: Cells of the study's plan.
        documents: Documents of its scenarios.
        on_item: Function that receives the progress.

    Raises:
        ScenarioError: No probe asks a question.
        BeliefNestError: A script failed; the message names the cell.
    """
    items = items_of(cells, documents)
    played = played_items(items, on_item or (lambda what, done, total: None), "scripted")
    return {
        item.name: [_made(nest, item, each) for each in item.questions] for item, nest, _ in played
    }


def played_otherwise(
    cells: Sequence[Cell],
    documents: Mapping[str, Document],
    items: Iterable[ItemRecord],
    scenes: int,
    on_item: OnItem,
) -> tuple[int, int, list[str]]:
    """Play some scenes of a set in the embedded world, and compare their right answers.

    Args:
        cells: Cells of the study's plan; their first seed chooses the scenes.
        documents: Documents of its scenarios.
        items: Items of the set.
        scenes: Number of scenes to play.
        on_item: Function that receives the progress.

    Returns:
        Numbers of played scenes and of compared items, and a line for each item that has another
        right answer there.

    Raises:
        BeliefNestError: A script failed; the message names the cell.
    """
    items_by_id = {each.id: each for each in items}
    every = items_of(cells, documents)
    chosen = random.Random(cells[0].key.seed).sample(every, min(scenes, len(every)))
    compared, lines = 0, []
    for item, nest, _ in played_items(chosen, on_item, "embedded"):
        for question in item.questions:
            record = items_by_id.get(item_id(item.name, question.id))
            if record is None:
                continue
            compared += 1
            again = _made(nest, item, question)
            there = again.why if isinstance(again, DroppedQuestion) else repr(again.right)
            if there != repr(record.right):
                lines.append(
                    f"{record.scenario}, item {record.id}: right is {record.right!r}, and in the "
                    f"embedded world: {there}"
                )
    return len(chosen), compared, lines


def with_balanced_items(
    plan: Plan[Cell], made: MadeItems, shortcuts: Sequence[str], seed: int
) -> Plan[Cell]:
    """Return the part of a plan on whose scenes shortcuts are right as often as guesses.

    Raises:
        StudyKeyError: There is no such part.
    """
    asked = {
        name: [each for each in questions if isinstance(each, ItemRecord)]
        for name, questions in made.items()
    }
    try:
        names = balanced_names(asked, shortcuts, seed)
    except InputError as error:
        raise StudyKeyError("balance", str(error)) from None
    return replace(plan, cells=tuple(each for each in plan.cells if item_name(each) in names))


def _made(nest: Nest, item: Item, question: ItemQuestion) -> ItemRecord | DroppedQuestion:
    key, probe = item.cell.key, item.probe(question)
    place = question.asked.question
    name = probe.label or question.id
    is_unanswerable = False
    try:
        probe = resolved(nest, probe)
        (asked,) = (each for each in probe.questions if each.question == place)
        verdict, reason = check_prose(nest, probe, asked)
        fault = reason if verdict == "differs" else ""
        if asked.options and len(asked.right) > 1:
            fault = f"several options are right: {listed([repr(each) for each in asked.right])}"
        fault = fault or _contested(nest, asked, naming_for(nest, probe))
    except ScenarioError as error:
        fault, is_unanswerable = str(error), True
    if fault:
        return DroppedQuestion(
            scenario=key.scenario,
            condition=key.condition,
            factors=_factors(key.variation),
            probe=name,
            question=place,
            why=fault,
            is_unanswerable=is_unanswerable,
        )
    naming, believed = naming_for(nest, probe), asked.believed
    path = probe.path if believed is None else believed.path
    chain = parse_path(path, nest.agents)
    text, options = nest[probe.path].render(STORY), shuffled(asked, key.seed)
    return ItemRecord(
        id=item_id(item.name, question.id),
        text=text,
        question=place,
        options=options,
        right=asked.right[0],
        kind="given" if believed is None else believed.kind,
        order=max(len(chain), len(parse_path(probe.path, nest.agents))),
        path=path,
        told_by=probe.path,
        chain=chain,
        chance=1 / len(options) if options else None,
        family=item.cell.label or key.scenario,
        scenario=key.scenario,
        condition=key.condition,
        variation=variation_id(key.scenario, dict(key.variation)),
        factors=_factors(key.variation),
        probe=name,
        seed=key.seed,
        tick=nest.tick,
        skeleton=_skeleton(f"{text}\n{place}", nest, asked, naming),
        checked=verdict,
        shortcuts=shortcuts(nest, asked, naming, options, text),
    )


def _contested(nest: Nest, asked: Answers, naming: Naming) -> str:
    """Return why words that an agent of the chain heard leave the answer open; empty: none do.

    Words without a claim, and all words where testimony is none, change no belief; readers may
    think so.
    """
    believed = asked.believed
    if believed is None:
        return ""
    is_container = believed.kind == "container"
    options = asked.options or (tuple(_items(nest)) if is_container else naming.all)
    wanted = names_asked_for(believed, naming)
    for name in parse_path(believed.path, nest.agents):
        hearer = nest[f"/{name}"]
        claimed = {(tick, speaker) for tick, speaker, _ in hearer.heard_claims}
        if nest.setting.perception.testimony == "none":
            claimed = set()
        for tick, speaker, words in hearer.state.chat:
            is_plain = (tick, speaker) not in claimed
            if is_plain and mentions(wanted, words) and mentions(options, words):
                return (
                    f"{titled(name)} heard {titled(speaker)} say {words!r}, which changes no "
                    "belief, but may for readers; give the utterance a claim and the scenario "
                    "another `testimony` than none, or leave it out"
                )
    return ""


def _factors(values: Mapping[str, Any]) -> dict[str, str]:
    return {n: v if isinstance(v, str) else json.dumps(v) for n, v in values.items()}


def _skeleton(text: str, nest: Nest, asked: Answers, naming: Naming) -> str:
    """Return a digest of a text whose names are replaced by their order of appearance."""
    names = {*map(titled, nest.agents), *naming.all, *asked.options, *asked.right, *_items(nest)}
    wanted = sorted((each for each in names if each), key=lambda each: (-len(each), each))
    numbers: dict[str, int] = {}

    def number(match: re.Match[str]) -> str:
        return f"<{numbers.setdefault(match[0].casefold(), len(numbers))}>"

    # "a bone" and "an apple" are told alike.
    text = re.sub(r"\ban\b", "a", text)
    any_name = "|".join(map(re.escape, wanted))
    return digest(re.sub(rf"(?<!\w)(?:{any_name})(?!\w)", number, text, flags=re.IGNORECASE))[:16]


def _items(nest: Nest) -> Iterable[str]:
    """Yield the names of all items, as stories write them."""
    state = nest["/"].state
    inside = [each.items for each in state.containers.values()]
    inventories = (*inside, *(each.inventory for each in state.agents.values()))
    yield from (name.replace("_", " ") for names in inventories for name in names)
