"""Items of a study: its scripts are played without any model, and each question is recorded.

Shortcuts answer a question by rules that need no belief, or a belief of a lower order only. A study
can be balanced: it plays the variations of which shortcuts are right as often as a guess.
"""

import json
import random
import re
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from msgspec.structs import replace

from beliefnest.errors import InputError, MissingExtraError, ScenarioError
from beliefnest.nest.face.nest import Nest
from beliefnest.plan.cells import Plan, digest, variation_id
from beliefnest.plan.scenario_cells import Cell
from beliefnest.scenarios.believed import Believed
from beliefnest.scenarios.document import Document
from beliefnest.scenarios.expected_answers import Answers
from beliefnest.scenarios.naming import Naming
from beliefnest.scenarios.probing import naming_for, resolved
from beliefnest.scenarios.prose_check import check_prose
from beliefnest.scenarios.prose_reading import story_sentences
from beliefnest.scenarios.questioning import shuffled
from beliefnest.studies.checking import StudyKeyError
from beliefnest.studies.items.record import DroppedQuestion, ItemRecord, item_id
from beliefnest.studies.items.report import FIXED_SOLVERS, OF_BELIEFS
from beliefnest.studies.participants.items import Item, ItemQuestion, item_name, items_of
from beliefnest.studies.participants.playing import STORY, OnItem, played_items
from beliefnest.world.paths import parse_path, path_text
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
    wanted = _names_asked_for(believed, naming)
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


_SAID = re.compile(r"\b(?:said|thought|whispered to [^“]*): “")


def shortcuts(
    nest: Nest, asked: Answers, naming: Naming, options: Sequence[str], text: str
) -> dict[str, str | None]:
    """Return what each shortcut answers, see `ItemRecord.shortcuts`.

    Args:
        nest: The nest at the tick of the question.
        asked: The question with its right answers.
        naming: Names by which answers are given.
        options: Options in the order in which they are asked.
        text: The story.
    """
    return {
        **dict(_lower_orders(nest, asked, naming)),
        **dict(_mentions(options, text)),
        **dict(_events(nest, asked, naming, options, text)),
    }


def _lower_orders(nest: Nest, asked: Answers, naming: Naming) -> Iterator[tuple[str, str | None]]:
    believed = asked.believed
    if believed is None:
        return
    agents = parse_path(believed.path, nest.agents)

    def answer_at(path: Sequence[str]) -> str | None:
        try:
            options = replace(believed, path=path_text(path)).answers(
                lambda each: nest[each].state, naming, asked.options
            )
        except ScenarioError:
            # The belief gives no option, or all.
            return None
        # Of the names of an answer in words, the first is the best.
        return options[0] if len(options) == 1 or (options and not asked.options) else None

    answers = [answer_at(agents[len(agents) - order :]) for order in range(len(agents) or 1)]
    yield "reality", answers[0]
    if agents:
        yield from ((f"order_{order}", answer) for order, answer in enumerate(answers))
        yield "lower_order", answers[-1]
    if len(agents) > 1:
        yield "outermost", answer_at(agents[:1])


def _mentions(options: Sequence[str], text: str) -> Iterator[tuple[str, str | None]]:
    """Yield the options that a text mentions first, last and most often."""
    if not options:
        return
    places = mentions(options, text)
    yield "first", _greatest(places, lambda starts: -starts[0])
    yield "last", _greatest(places, lambda starts: starts[-1])
    yield "most", _greatest(places, len)


def _events(
    nest: Nest, asked: Answers, naming: Naming, options: Sequence[str], text: str
) -> Iterator[tuple[str, str | None]]:
    """Yield the options of events that a story tells: acts, and words about what is asked for."""
    believed = asked.believed
    if not options or believed is None:
        return
    wanted = _names_asked_for(believed, naming)
    events: list[tuple[str, str]] = []
    leavings: list[str | None] = []
    for sentence in story_sentences(text.partition("\n\n")[2]):
        said = _SAID.search(sentence)
        is_about = said is None or any(w in sentence[said.end() :].casefold() for w in wanted)
        if " could no longer see " in sentence:
            leavings.append(events[-1][1] if events else None)
        elif is_about and " could now see " not in sentence:
            named = [*mentions(options, sentence)]
            events += [(sentence, each) for each in named if len(named) == 1]
    every = [option for _, option in events]
    believers = parse_path(believed.path, nest.agents)
    own = [o for s, o in events if believers and s.startswith(f"{titled(believers[-1])} ")]
    yield "first_event", next(iter(every), None)
    yield "last_event", next(reversed(every), None)
    yield "most_event", _greatest({each: [every.count(each)] for each in every}, lambda n: n[0])
    yield "first_leaving", next(iter(leavings), None)
    yield "last_leaving", next(reversed(leavings), None)
    yield "own_event", next(reversed(own), None)


def _names_asked_for(believed: Believed, naming: Naming) -> list[str]:
    """Return the names of the thing that a question is about, in small letters."""
    at = believed.thing
    things = [at] if isinstance(at, str) else [naming.objects.get(at), naming.written.get(at)]
    return [each.replace("_", " ").casefold() for each in things if each]


def _greatest(places: Mapping[str, list[int]], key: Callable[[list[int]], int]) -> str | None:
    """Return the option whose mentions have the greatest key; None: none or several have it."""
    ranked = sorted(places, key=lambda option: -key(places[option]))
    several = [each for each in ranked if key(places[each]) == key(places[ranked[0]])]
    return ranked[0] if len(several) == 1 else None


def mentions(options: Sequence[str], text: str) -> dict[str, list[int]]:
    """Return where a text mentions options, as numbers of characters, by option.

    Where one option is part of another, such as `chest` of `left chest`, the longest counts.
    """
    ordered = sorted(options, key=len, reverse=True)
    any_option = "|".join(re.escape(each).replace("_", "[ _]") for each in ordered)
    starts: dict[str, list[int]] = {}
    for match in re.finditer(rf"(?<!\w)(?:{any_option})(?!\w)", text, re.IGNORECASE):
        name = match[0].replace(" ", "_").casefold()
        option = next(each for each in ordered if each.replace(" ", "_").casefold() == name)
        starts.setdefault(option, []).append(match.start())
    return starts


_EXACT = 1e-6
_SLACK = 0.005
"""Share of the questions of an order by which right answers may differ from those of guesses. With
many shortcuts, to find a part with none can take for ever; in fewer than 67 questions it is less
than a third of an answer, so that there is none."""
_GAP = 0.05
"""Share by which the chosen part may be smaller than the largest: to prove that none is larger can
take for ever."""
_MOST_NODES = 2000
"""Greatest number of branches that are searched for a part, whatever time that takes."""
_MOST_TOLD = 5
_Excess = tuple[float, ...]
"""Number of right answers above what guesses have, for each shortcut and order."""


def balanced_names(
    made: Mapping[str, Sequence[ItemRecord]], names: Sequence[str], seed: int
) -> frozenset[str]:
    """Return the names of nearly the most scenes on which shortcuts are right as often as guesses.

    Each shortcut is balanced within each order, to half a percent of the questions.

    Args:
        made: Items by the name of their scene: variation and condition.
        names: Names of shortcuts.
        seed: Seed of the choice among equal scenes.

    Raises:
        InputError: No such scenes were found; the message has the numbers.
        MissingExtraError: SciPy is not installed.
    """
    orders = sorted({each.order for items in made.values() for each in items})
    dimensions = [(name, order) for name in names for order in orders]
    scenes: dict[_Excess, list[str]] = defaultdict(list)
    for scene, items in made.items():
        scenes[tuple(_excess(items, *dimension) for dimension in dimensions)].append(scene)
    kinds = sorted(scenes)
    asked = Counter(each.order for items in made.values() for each in items)
    slack = [_SLACK * asked[order] + _EXACT for _, order in dimensions]
    counts = _largest(kinds, [len(scenes[kind]) for kind in kinds], slack)
    if counts is None or not counts.any():
        raise InputError(_impossible(made, dimensions))
    chosen: set[str] = set()
    for kind, count in zip(kinds, counts, strict=True):
        chosen.update(random.Random(f"{seed} {kind}").sample(sorted(scenes[kind]), int(count)))
    return frozenset(chosen)


def _excess(items: Sequence[ItemRecord], name: str, order: int) -> float:
    """Return how many more answers of a shortcut are right than those of guesses."""
    return sum(
        float(answer == each.right) - (each.chance or 0.0)
        for each, answer in _answers(items, name, order)
    )


def _answers(
    items: Iterable[ItemRecord], name: str, order: int
) -> Iterator[tuple[ItemRecord, str]]:
    """Yield the questions of an order that a shortcut answers, with its answers."""
    for each in items:
        if each.order == order and each.options and (each.chain or name not in OF_BELIEFS):
            answer = FIXED_SOLVERS[name](each)
            if answer is not None:
                yield each, answer


def _largest(kinds: Sequence[_Excess], counts: Sequence[int], slack: Sequence[float]) -> Any:
    """Return how many scenes of each kind to take, so that excesses nearly add up to 0.

    Args:
        kinds: Excess of each kind of scene.
        counts: Number of scenes of each kind.
        slack: Greatest sum of each excess.

    Returns:
        The numbers; None: no such part is known.
    """
    try:
        from scipy.optimize import Bounds, LinearConstraint, milp
    except ImportError:
        raise MissingExtraError("balanced items need scipy", "stats") from None
    solution = milp(
        -np.ones(len(kinds)),
        integrality=np.ones(len(kinds)),
        bounds=Bounds(0, counts),
        constraints=LinearConstraint(np.array(kinds).T, -np.array(slack), slack),
        options={"mip_rel_gap": _GAP, "node_limit": _MOST_NODES},
    )
    return None if solution.x is None else np.rint(solution.x).astype(int)


def _impossible(
    made: Mapping[str, Sequence[ItemRecord]], dimensions: Sequence[tuple[str, int]]
) -> str:
    every = [each for items in made.values() for each in items]
    families: dict[str, list[ItemRecord]] = defaultdict(list)
    for each in every:
        families[each.family].append(each)
    totals = {each: total for each in dimensions if abs(total := _excess(every, *each)) > _EXACT}
    rates = []
    for name, order in sorted(totals, key=lambda each: -abs(totals[each]))[:_MOST_TOLD]:
        excess = {of: _excess(items, name, order) for of, items in families.items()}
        # The family that has most of the excess, in its direction.
        worst = max(excess, key=lambda of: excess[of] * totals[name, order])
        answers = list(_answers(families[worst], name, order))
        right = sum(answer == each.right for each, answer in answers)
        rates.append(f"{name}: {right} of {len(answers)} at order {order} in {worst}")
    return (
        "no part of the variations has these shortcuts at chance; right answers where they are "
        f"furthest off: {'; '.join(rates)}"
        "; draw more variations, vary what the answers depend on, add conditions, or name fewer"
    )
