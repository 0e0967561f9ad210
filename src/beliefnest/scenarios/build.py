"""Construction of scenarios from checked documents: setting, probes, expectations, warnings."""

import math
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import combinations
from typing import Any

import numpy as np
import numpy.typing as npt

from beliefnest.belief.grounds import InitialBelief
from beliefnest.importing import part
from beliefnest.nest.past.setting import Setting, Step
from beliefnest.nest.past.unique import unique_fault, unique_items
from beliefnest.perception.options import Perception
from beliefnest.prompts.templates import BUILT_IN_TEMPLATES, built_in_template
from beliefnest.scenarios.agent_entries import build_agents
from beliefnest.scenarios.checks import Checks, check_inside
from beliefnest.scenarios.content import Probe, ScenarioContent, ScenarioWarning
from beliefnest.scenarios.document import Document, KeyPath, plain
from beliefnest.scenarios.expected import Expected, expected_fact
from beliefnest.scenarios.expected_answers import Answers
from beliefnest.scenarios.expected_kinds import Infers, read_expected, read_inferred
from beliefnest.scenarios.format import (
    BelievedSignEntry,
    BlockEntry,
    ContainerEntry,
    InitialBeliefEntry,
    ProbeEntry,
    ScenarioFile,
    StepEntry,
)
from beliefnest.scenarios.inferring import Inferring
from beliefnest.scenarios.rules import EpisodeEntry, check_rules
from beliefnest.scenarios.sources import scenario_name
from beliefnest.scenarios.space import (
    UNKNOWN,
    believed_fault,
    build_blocks,
    build_box,
    build_containers,
    build_sign_claims,
    build_signs,
    parts_of,
)
from beliefnest.scenarios.yaml_reading import template_text
from beliefnest.skills.javascript import nodes_below, parsed
from beliefnest.world.frames import Snapshot
from beliefnest.world.limits import AGENT_SLOTS, WORN_SLOTS
from beliefnest.world.paths import parse_pattern
from beliefnest.world.registry import Registry
from beliefnest.world.signs import plain_state, written
from beliefnest.world.texts import quoted
from beliefnest.world.values import Block, Box, Items, Point, Position, block_at
from beliefnest.world.words import listed

_WORKED_IN = ("conditions", "parameters", "constraints", "instances")
"""Keys that are resolved before the scenario is built."""


def build_scenario(
    document: Document,
    file: ScenarioFile,
    condition: int | None,
    conditions: Mapping[int, Mapping[str, Any]],
) -> ScenarioContent:
    """Return the scenario of a document into which the condition is already merged.

    Raises:
        ScenarioError: The content is not consistent; the message names file, line and key.
    """
    if scenario_name(file.name) != file.name:
        raise document.fault(
            ("name",), f"{quoted(file.name)} is no name for a folder; use letters, digits, - and _"
        )
    builder = _Builder(document, file, Registry.load())
    descriptions = {
        number: str(conditions[number].get("description", "")) for number in sorted(conditions)
    }
    probes = tuple(builder.probe(n, entry) for n, entry in enumerate(file.probes))
    return ScenarioContent(
        setting=builder.setting(),
        description=file.description,
        reported_by=file.reported_by,
        condition=condition,
        condition_description=descriptions.get(condition, "") if condition is not None else "",
        conditions=descriptions,
        probes=probes,
        expectations=tuple(
            expected_fact(entry, ("expectations", n), builder.checks)
            for n, entry in enumerate(file.expectations)
        ),
        rules=builder.rules(),
        written=_written(document),
        source=document.source,
        text=document.text,
        warnings=builder.warnings(probes),
        templates={
            entry.template: probe.template
            for entry, probe in zip(file.probes, probes, strict=True)
            if entry.template is not None and probe.template is not None
        },
    )


class _Builder:
    """Builder of the snapshot of the first tick, and of all parts that refer to it."""

    def __init__(self, document: Document, file: ScenarioFile, registry: Registry) -> None:
        self._document = document
        self._file = file
        self._registry = registry
        box = build_box(document, file)
        blocks = build_blocks(document, file, box, registry)
        containers = build_containers(document, file.containers, blocks, box, registry)
        signs = build_signs(document, file, blocks, box, registry)
        claims = build_sign_claims(document, file, signs, box)
        agents = build_agents(document, file, blocks, box, registry)
        self._snapshot = Snapshot(
            0, box, blocks, containers, agents, signs=signs, sign_claims=claims
        )
        self.checks = Checks(document, self._snapshot, registry)

    def setting(self) -> Setting:
        """Return the setting from which a nest starts."""
        file = self._file
        for number, static in enumerate(file.static_blocks):
            if isinstance(static, str):
                self.checks.block_name(("static_blocks", number), static)
            else:
                check_inside(self._document, ("static_blocks", number), static, self._snapshot.box)
        for name, place in file.places.items():
            check_inside(self._document, ("places", name), place, self._snapshot.box)
        initial = tuple(
            self._initial_belief(n, entry) for n, entry in enumerate(file.initial_beliefs)
        )
        return Setting(
            name=file.name,
            snapshot=self._snapshot,
            perception=self._perception(file.perception),
            static_blocks=frozenset(file.static_blocks),
            initial_beliefs=initial,
            script=tuple(self._step(n, entry) for n, entry in enumerate(file.script)),
            labels=self._labels(lambda entry: entry.label),
            prompt_labels=self._labels(_prompt_label) if file.labels else {},
            places=dict(file.places),
            people=frozenset(n for n, entry in file.agents.items() if entry.type == "human"),
            unique=self._unique(initial),
        )

    def _labels(self, label: Callable[[ContainerEntry], str | None]) -> dict[Position, str]:
        """Return labels of containers; of two halves of a chest the first that has one counts."""
        labels: dict[Position, str] = {}
        for entry in self._file.containers:
            if text := label(entry):
                labels.setdefault(self.checks.container_at(entry.at), text)
        return labels

    def warnings(self, probes: tuple[Probe, ...]) -> tuple[ScenarioWarning, ...]:
        """Return warnings about the file."""
        of_scene = _scene_warnings(self._document, self._file, self._snapshot, probes)
        return (*of_scene, *map(ScenarioWarning, self._document.notes))

    def _unique(self, initial: Sequence[InitialBelief]) -> frozenset[str]:
        """Return the unique items; refuse those that world or initial beliefs contradict."""
        items = set()
        for number, name in enumerate(self._file.unique):
            path = ("unique", number)
            with self._document.naming(path):
                (item,) = unique_items((name,))
            if fault := unique_fault(item, self._snapshot, initial):
                raise self._document.fault(path, fault)
            items.add(item)
        return frozenset(items)

    def probe(self, number: int, entry: ProbeEntry) -> Probe:
        """Return one probe with the text of its template."""
        path = ("probes", number)
        believers = self.checks.belief_path((*path, "path"), entry.path)
        if entry.infer is not None:
            return self._inferring(path, entry)
        if entry.acts_in is not None:
            self.checks.belief_path((*path, "acts_in"), entry.acts_in)
        if entry.agent is not None:
            self.checks.agent((*path, "agent"), entry.agent)
        expect: tuple[Expected, ...] = ()
        if entry.expect is not None:
            expect = read_expected(entry.expect, (*path, "expect"), self.checks)
        if not expect or any(not isinstance(each, Answers) for each in expect):
            for key in ("acts_in", "agent", "task"):
                if getattr(entry, key) is None:
                    raise self._document.fault(path, f"the key {quoted(key)} is missing")
        probe = Probe(
            path=entry.path,
            acts_in=entry.path if entry.acts_in is None else entry.acts_in,
            agent=(believers[-1] if believers else "") if entry.agent is None else entry.agent,
            task=entry.task or "",
            expect=expect,
            template=self._template((*path, "template"), entry.template),
            label=entry.label,
            timeout_ticks=entry.timeout_ticks,
            senses=entry.senses or self._file.senses,
            intended=entry.intended,
            template_name=entry.template or "template",
            where=self._document.key_at(path),
        )
        with self._document.naming((*path, "template")):
            probe.check_template()
        return probe

    def _inferring(self, path: KeyPath, entry: ProbeEntry) -> Probe:
        """Return a probe that infers in place of asking a model."""
        assert entry.infer is not None
        usual = ProbeEntry(path=entry.path)
        for key in ("acts_in", "agent", "task", "template", "senses", "timeout_ticks", "intended"):
            if getattr(entry, key) != getattr(usual, key):
                raise self._document.fault(
                    (*path, key), "is for probes that ask a model; remove it, or 'infer'"
                )
        place = (*path, "infer")
        infer: Inferring = part("infer_entry")(self._document, place, entry.infer, self._snapshot)
        expect: tuple[Infers, ...] = ()
        if entry.expect is not None:
            place = (*path, "expect")
            expect = read_inferred(entry.expect, place, self.checks, infer.model.factors)
        return Probe(
            path=entry.path,
            acts_in=entry.path,
            agent=infer.model.agent,
            task="",
            expect=expect,
            label=entry.label,
            infer=infer,
        )

    def rules(self) -> EpisodeEntry | None:
        """Return the goals and rules of play, if the scenario has any."""
        rules = self._file.episode
        if rules is not None:
            check_rules(rules, self._snapshot.agents, self.checks, ("episode",))
        return rules

    def _step(self, number: int, entry: StepEntry) -> Step:
        path = ("script", number)
        programs = dict(entry.programs)
        if (entry.agent is None) != (entry.program is None):
            missing = "agent" if entry.agent is None else "program"
            raise self._document.fault(path, f"the key {quoted(missing)} is missing")
        if entry.agent is not None and entry.program is not None:
            if entry.agent in programs:
                raise self._document.fault(path, f"has two programs for {entry.agent}")
            self.checks.agent((*path, "agent"), entry.agent)
            programs[entry.agent] = entry.program
        if not programs:
            raise self._document.fault(path, "has no program; give 'agent' and 'program'")
        for agent in entry.programs:
            self.checks.agent((*path, "programs", agent), agent)
        return Step(
            programs=programs,
            label=entry.label or f"step {number + 1}",
            where=self._document.where(path),
            timeout_ticks=entry.timeout_ticks,
            senses=entry.senses or self._file.senses,
        )

    def _perception(self, options: Perception) -> Perception:
        for number, name in enumerate(options.transparent_blocks):
            self.checks.block_name(("perception", "transparent_blocks", number), name)
        return options

    def _initial_belief(self, number: int, entry: InitialBeliefEntry) -> InitialBelief:
        path = ("initial_beliefs", number)
        with self._document.naming((*path, "path")):
            names = parse_pattern(entry.path, self._snapshot.agents)
        if not names:
            raise self._document.fault((*path, "path"), "'/' is the real world, not a belief")
        earlier = self._file.initial_beliefs[:number]
        if names in [parse_pattern(each.path, self._snapshot.agents) for each in earlier]:
            raise self._document.fault(
                (*path, "path"),
                f"{quoted(entry.path)} has initial beliefs already; put them into one",
            )
        blocks = self._believed_blocks((*path, "blocks"), entry.blocks)
        for index, sign in enumerate(entry.signs):
            blocks[sign.at] = self._believed_sign((*path, "signs", index), sign, blocks)
        place: KeyPath
        contents: dict[Position, tuple[Items, bool]] = {}
        for index, container in enumerate(entry.containers):
            place = (*path, "containers", index)
            whole = self.checks.container((*place, "at"), container.at)
            items, complete = contents.get(whole, ({}, True))
            items = Counter(items)
            items.update(container.items)
            self.checks.contents((*place, "items"), whole, items)
            contents[whole] = dict(items), complete and container.complete
        for agent, items in entry.inventories.items():
            place = (*path, "inventories", agent)
            self.checks.agent(place, agent)
            self.checks.items(place, items, AGENT_SLOTS + WORN_SLOTS, agent)
        return InitialBelief(
            path=names,
            containers=contents,
            blocks=blocks,
            agents=self._believed_places((*path, "agents"), entry.agents),
            inventories={name: dict(items) for name, items in entry.inventories.items()},
        )

    def _believed_blocks(
        self, path: KeyPath, entries: Sequence[BlockEntry]
    ) -> dict[Position, Block]:
        """Return believed blocks by position, those of each entry in order of position."""
        blocks: dict[Position, Block] = {}
        count = 0
        for index, entry in enumerate(entries):
            place = (*path, index)
            state = UNKNOWN
            if entry.block is not None:
                with self._document.naming((*place, "block")):
                    state = self._registry.state_id(entry.block)
            parts = parts_of(self._document, place, entry, self._snapshot.box)
            count += sum(math.prod(part.shape) for part in parts)
            if fault := believed_fault(count):
                raise self._document.fault(place, fault)
            places = (at for part in parts for at in part.positions())
            blocks |= dict.fromkeys(sorted(places) if len(parts) > 1 else places, state)
        return blocks

    def _believed_places(
        self, path: KeyPath, written: Mapping[str, Point] | Sequence[str]
    ) -> dict[str, Point]:
        """Return believed positions of agents; those of names alone are the real ones."""
        if not isinstance(written, Mapping):
            for index, name in enumerate(written):
                self.checks.agent((*path, index), name)
            return {name: self._snapshot.agents[name].position for name in written}
        box = self._snapshot.box
        for agent, feet in written.items():
            self.checks.agent((*path, agent), agent)
            if block_at(feet) not in box:
                raise self._document.fault(
                    (*path, agent),
                    f"{list(feet)} lies outside the box {list(box.low)} to {list(box.high)}",
                )
        return dict(written)

    def _believed_sign(
        self, path: KeyPath, entry: BelievedSignEntry, blocks: Mapping[Position, Block]
    ) -> Block:
        box = self._snapshot.box
        check_inside(self._document, (*path, "at"), entry.at, box)
        if entry.block is not None:
            with self._document.naming((*path, "block")):
                state = self._registry.state_id(entry.block)
        else:
            state = plain_state(blocks.get(entry.at, self._snapshot.block(entry.at)))
        with self._document.naming(path):
            return written(self._registry, state, entry.text)

    def _template(self, path: KeyPath, name: str | None) -> str | None:
        if name is None:
            return None
        if name in BUILT_IN_TEMPLATES and name not in self._document.templates:
            return built_in_template(name).text
        return template_text(self._document, path, name)


def _written(document: Document) -> Mapping[str, Any]:
    content: Any = plain(document.root)
    return {key: value for key, value in content.items() if key not in _WORKED_IN}


def _prompt_label(entry: ContainerEntry) -> str:
    """Return the label of a container for prompts: its name, and what it seems to contain."""
    looks = f"looks as if it held {entry.looks}" if entry.looks else ""
    return ", ".join(part for part in (entry.label, looks) if part)


_CATCHES = 4.0
"""Blocks from the receiver within which somebody else may catch what is thrown."""

_GIVING = "giveItemToOther"


def _scene_warnings(
    document: Document, file: ScenarioFile, snapshot: Snapshot, probes: tuple[Probe, ...]
) -> tuple[ScenarioWarning, ...]:
    """Return warnings about names, walls, gifts and options of a scenario.

    Args:
        document: The document, with parameters, condition and map resolved.
        file: Its content as typed values.
        snapshot: Its world before the script.
        probes: Its probes.
    """
    faults = [
        *_names(file),
        *_walls(document, file, snapshot),
        *_gifts(file, snapshot),
        *_options(file),
        *_copies(file, snapshot, probes),
    ]
    return tuple(
        ScenarioWarning(f"{document.key_at(path)}{text}", f"{kind} {document.where(path)}")
        for kind, path, text in faults
    )


_Found = Iterator[tuple[str, KeyPath, str]]


def _names(file: ScenarioFile) -> _Found:
    """Yield names that differ from an earlier one only in case."""
    named: list[tuple[KeyPath, str]] = [(("agents", name), name) for name in file.agents]
    named += [
        (("containers", number, "label"), entry.label)
        for number, entry in enumerate(file.containers)
        if entry.label
    ]
    named += [(("places", name), name) for name in file.places]
    first: dict[str, str] = {}
    for path, name in named:
        other = first.setdefault(name.casefold(), name)
        if other != name:
            yield (
                "names",
                path,
                f"{quoted(name)} differs from {quoted(other)} only in case; rename one of them",
            )


def _walls(document: Document, file: ScenarioFile, snapshot: Snapshot) -> _Found:
    """Yield a wall inside of the scene if all such walls are one block high."""
    box, terrain, registry = snapshot.box, snapshot.blocks, Registry.load()
    if not terrain.is_dense or len(snapshot.agents) < 2:  # Landscapes have hills, not walls.
        return
    clear = frozenset(file.perception.transparent_blocks)
    grid = terrain.chunks[terrain.rows[0]]
    states, numbers = np.unique(grid, return_inverse=True)
    hiding = [
        registry.is_full(state)
        and not registry.default_transparent[state]
        and not registry.is_container(registry.name(state))
        and registry.name(state) not in clear
        for state in states.tolist()
    ]
    hides = np.array(hiding)[numbers.reshape(grid.shape)]
    for level in sorted({int(agent.position[1]) for agent in snapshot.agents.values()}):
        y = level - box.low[1]
        if not 0 <= y < box.shape[1]:
            continue
        low = hides[:, y]
        inner = _inner(low)
        above = hides[:, y + 1] if y + 1 < box.shape[1] else np.zeros_like(low)
        if inner.any() and not above[inner].any():
            x, z = (int(each[0]) for each in np.nonzero(inner))
            at = (x + box.low[0], level, z + box.low[2])
            yield (
                "walls",
                _block_path(document, file, at, box),
                f"the wall at {list(at)} is one block high, and so are all walls between rooms: "
                "agents see each other over them; make them 2 or more blocks high (`height: 3`)",
            )


def _inner(walls: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    """Return the cells of walls that stand between free cells, shape as the given one."""
    inner = np.zeros_like(walls)
    middle = walls[1:-1, 1:-1]
    beside_x, beside_z = (walls[:-2, 1:-1], walls[2:, 1:-1]), (walls[1:-1, :-2], walls[1:-1, 2:])
    for along, across in ((beside_x, beside_z), (beside_z, beside_x)):
        inner[1:-1, 1:-1] |= middle & along[0] & along[1] & ~across[0] & ~across[1]
    return inner


def _block_path(document: Document, file: ScenarioFile, at: Position, box: Box) -> KeyPath:
    """Return the path of the last entry that puts a block at a position."""
    for number, entry in reversed([*enumerate(file.blocks)]):
        path: KeyPath = ("blocks", number)
        if any(at in part for part in parts_of(document, path, entry, box)):
            return path
    return ("blocks",)


def _gifts(file: ScenarioFile, snapshot: Snapshot) -> _Found:
    """Yield gifts to agents near whom others stand at first, or since an earlier gift."""
    near = {
        frozenset(pair)
        for pair in combinations(snapshot.agents, 2)
        if math.dist(*(snapshot.agents[name].position for name in pair)) <= _CATCHES
    }
    met: set[frozenset[str]] = set()
    for number, step in enumerate(file.script):
        programs: Mapping[str, str] = dict(step.programs)
        if step.agent is not None and step.program is not None:
            programs = {**programs, step.agent: step.program}
        for giver, program in programs.items():
            for receiver in _receivers(program):
                others = [
                    name
                    for name in snapshot.agents
                    if name not in (giver, receiver)
                    and (
                        frozenset((name, receiver)) in near | met or frozenset((name, giver)) in met
                    )
                ]
                met.add(frozenset((giver, receiver)))
                if others:
                    verb = "stands" if len(others) == 1 else "stand"
                    yield (
                        "gifts",
                        ("script", number),
                        f"{giver} throws a gift to {receiver}, and {listed(others)} {verb} so near "
                        "that they may catch it; let others go away first, or use a container",
                    )


def _receivers(program: str) -> Iterator[str]:
    """Yield the agent of each gift of a program, of those gifts whose agent it names as a text."""
    for node in nodes_below(parsed(program.encode())) if _GIVING in program else ():
        if node.type == "arguments" and node.parent.children[0].text == _GIVING.encode():
            texts = [each for each in node.named_children if each.type != "comment"][1:2]
            strings = ("string", "template_string")
            yield from (each.text.decode()[1:-1] for each in texts if each.type in strings)


def _options(file: ScenarioFile) -> _Found:
    """Yield options that differ by no word from another one."""
    for number, probe in enumerate(file.probes):
        answers = [] if probe.expect is None else probe.expect.answers
        for place, asked in enumerate(answers if isinstance(answers, list) else [answers]):
            options = () if asked is None else asked.options
            bare = sorted((each.casefold().split() for each in options), key=len)
            for one, other in combinations(bare, 2):
                if any(other[at : at + len(one)] == one for at in range(len(other))):
                    yield (
                        "options",
                        ("probes", number, "expect", "answers", place, "options"),
                        f"{quoted(' '.join(one))} is contained in {quoted(' '.join(other))}, so "
                        "that an answer may name both; give options without a common name",
                    )


def _copies(file: ScenarioFile, snapshot: Snapshot, probes: tuple[Probe, ...]) -> _Found:
    """Yield questions where an item is of which there are several, in several places."""
    for number, probe in enumerate(probes):
        asked = {
            str(question.believed.thing)
            for question in probe.questions
            if question.believed is not None and question.believed.kind == "item"
        }
        for item in sorted(asked):
            holders = [name for name, each in snapshot.agents.items() if each.inventory.get(item)]
            holders += [str(list(at)) for at, has in snapshot.containers.items() if has.get(item)]
            if len(holders) > 1:
                yield (
                    "copies",
                    ("probes", number),
                    f"asks where the {item} is, and there are several: {listed(holders)} have one; "
                    "ask for an item of which there is one",
                )
