"""Tracks say at every tick what states, and `false_beliefs`, say."""

import random
from collections.abc import Iterator

import numpy as np
import pytest

import beliefnest as bn
from beliefnest.viewer.page import runs
from beliefnest.viewer.page.blocks import BlockPalette
from beliefnest.viewer.page.pose_history import PoseBook
from beliefnest.viewer.page.run import About, RunData
from beliefnest.viewer.page.runs import numbers_text
from beliefnest.viewer.page.tracks import CURRENT, PLACED, STALE, UNKNOWN, Track, TrackRecorder
from beliefnest.world import terrain
from beliefnest.world.paths import paths_below

BOX = ((0, 0, 0), (12, 3, 8))
CHESTS = [(3, 1, 3), (9, 1, 3)]


@pytest.fixture(scope="module", params=[terrain.DENSE, 0], ids=["dense", "chunks"])
def story(request: pytest.FixtureRequest) -> Iterator[bn.Nest]:
    """Yield the nest of `_story`, whose nodes hold dense arrays or share chunks."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(terrain, "DENSE", request.param)
        yield _story()


def _story() -> bn.Nest:
    """Return a nest: a door that opens and shuts, two chests, three agents that walk at random."""
    blocks = {(x, 0, z): "stone" for x in range(13) for z in range(9)}
    blocks |= {(6, y, z): "stone" for y in (1, 2) for z in range(9)}
    world = bn.ScriptedWorld(
        box=BOX,
        blocks=blocks,
        agents={"ann": (2.5, 1, 2.5), "bob": (4.5, 1, 5.5), "cat": (10.5, 1, 4.5)},
        inventories={"ann": {"diamond": 3}, "bob": {"emerald": 2}},
        containers={place: {} for place in CHESTS},
    )
    nest = bn.Nest(world, bn.Perception(hearing="sight"), static_blocks=["stone"])
    chance = random.Random(4)
    for _ in range(60):
        with world.tick():
            _act(world, chance)
    belief = nest["/ann"]
    belief.switch("try")
    for _ in range(6):
        with belief.scripted.tick():
            belief.scripted.place_agent("ann", (chance.uniform(1, 5), 1, chance.uniform(1, 7)))
    belief.switch("follow")
    return nest


def _act(world: bn.ScriptedWorld, chance: random.Random) -> None:
    name = chance.choice(["ann", "bob", "cat"])
    near = (1.0, 5.0) if chance.random() < 0.6 else (7.0, 11.0)
    world.place_agent(name, (chance.uniform(*near), 1, chance.uniform(1, 7)), chance.uniform(-3, 3))
    deed = chance.random()
    if deed < 0.3:
        world.set_block((6, 1, 4), chance.choice(["air", "stone"]))
    elif deed < 0.5:
        world.open(name, chance.choice(CHESTS))
    elif deed < 0.6:
        world.say(name, "hm")
    elif deed < 0.75 and world.snapshot().agents["ann"].inventory:
        world.deposit("ann", chance.choice(CHESTS), {"diamond": 1})


def row_at(rows, tick):
    return next((row for row in reversed(rows) if row[0] <= tick), None)


def recorded(nest: bn.Nest, paths) -> tuple[TrackRecorder, PoseBook]:
    info = nest.reader.timelines()[0]
    book = PoseBook(len(nest.agents), info.start, None)
    palette = BlockPalette(nest.reader.history.context)
    recorder = TrackRecorder(nest.reader, info.key, paths, book, palette)
    recorder.advance(info.entries)
    return recorder, book


def assert_agents_as(track: Track, book: PoseBook, state, names) -> None:
    for number, name in enumerate(names):
        believed, row = state.agents[name], row_at(track.agents[number], state.tick)
        if row[1] == UNKNOWN:
            assert believed.position is None
            continue
        pose = (
            row[3]
            if row[1] == PLACED
            else book.at(number, row[2] if row[1] == STALE else state.tick)
        )
        assert tuple(pose) == (*believed.position, believed.yaw, believed.pitch)
        assert believed.current == (row[1] == CURRENT or (row[1] == PLACED and row[5]))
        if row[1] != CURRENT:
            assert row[2] == believed.basis.observed_at


def things(nest: bn.Nest, path: str, tick: int) -> set[str]:
    box = nest.setting.snapshot.box
    _, height, depth = box.shape
    found = set()
    for each in nest.at(tick).false_beliefs(path):
        if isinstance(each.where, str):
            number = nest.agents.index(each.where)
        else:
            i, j, k = box.index(each.where)
            number = (i * height + j) * depth + k
        found.add(f"{each.kind}-{number}")
    return found


def test_tracks_hold_what_states_hold_at_every_tick(story):
    paths = paths_below((), 2, story.agents)
    recorder, book = recorded(story, paths)
    for tick in range(0, story.tick + 1, 3):
        for track in recorder.tracks:
            path = "/" + "/".join(track.path)
            state = story.at(tick)[path].state
            assert_agents_as(track, book, state, story.agents)
            rows = [row_at(rows, tick) for _, rows in sorted(track.contents.items())]
            assert [row[1:4] for row in rows if row is not None and row[1] is not None] == [
                [dict(held.items), held.complete, held.current]
                for held in state.containers.values()
            ]
            row = row_at(track.wrong, tick)
            assert set(row[1] if row else ()) == things(story, path, tick), (path, tick)


@pytest.mark.parametrize("quiet", [0, 3])
def test_what_an_act_shows_is_current_in_its_tick_alone(quiet: int) -> None:
    world = bn.ScriptedWorld(box=BOX, agents={"ann": (2.5, 1, 2.5)}, containers={CHESTS[0]: {}})
    nest = bn.Nest(world)
    world.open("ann", CHESTS[0])
    world.step(quiet)
    world.think("ann", "hm")
    recorder, _ = recorded(nest, [("ann",)])
    (rows,) = recorder.tracks[0].contents.values()
    opened = [row[:4] for row in rows if row[0]]
    assert opened == [[1, {}, True, True], [2, {}, True, False]]


def text_numbers(text: str) -> list[int]:
    """Return the numbers of a text, as the page reads them."""
    numbers, value, shift = [], 0, 0
    for letter in text.encode("ascii"):
        code = runs._DIGITS.index(letter)
        value |= (code & (2**runs._BITS - 1)) << shift
        shift += runs._BITS
        if code < 2**runs._BITS:
            numbers.append(value)
            value = shift = 0
    return numbers


def put_runs(grid, text, first) -> None:
    """Write the blocks of a text into a flat grid, as the page does."""
    numbers, cell = iter(text_numbers(text)), 0
    for gap in numbers:
        begin = cell + gap
        told = next(numbers)
        cell = begin + told // 2
        if told % 2:
            mark = next(numbers) + 1
            grid[begin:cell] = -1 if mark == runs.UNKNOWN else mark - runs.FIRST_STATE
        else:
            grid[begin:cell] = first[begin:cell]


def test_blocks_of_tracks_are_those_of_states_at_every_tick(story):
    paths = paths_below((), 2, story.agents)
    told = RunData(story.reader, About("story"), depth=2).update()
    numbers = {each["text"]: number for number, each in enumerate(told["states"][1])}
    tracks = told["timelines"]["0"]["tracks"]
    cells = story.reader.history.context.cells
    first = np.full(cells, -1)
    put_runs(first, tracks["/"]["grid"], None)
    for path in ("/" + "/".join(path) for path in paths):
        grid = np.full(cells, -1) if path == "/" else first.copy()
        put_runs(grid, tracks[path]["grid"], first)
        changes = tracks[path].get("blocks", [0, []])[1]
        for tick in range(story.tick + 1):
            for _, text in (row for row in changes if row[0] == tick):
                put_runs(grid, text, first)
            blocks = story.at(tick)[path].state.blocks
            held = [
                -1 if text is None else numbers[text] for text in map(blocks.__getitem__, blocks)
            ]
            assert grid.tolist() == held, (path, tick)


@pytest.mark.parametrize("numbers", [[], [0], [31, 32, 33, 0], [2**40, 1, 2**15, 1023, 1024]])
def test_numbers_come_back_from_texts(numbers):
    assert text_numbers(numbers_text(numbers)) == numbers


def test_tracks_tell_which_events_were_perceived(story):
    recorder, _ = recorded(story, paths_below((), 2, story.agents))
    key = recorder.key
    entries = story.reader.entries(key, 0, recorder.position)
    events = [(entry.tick, event.kind) for entry in entries for event in entry.events]
    for track in recorder.tracks:
        view = story["/" + "/".join(track.path)].state
        told = [(e.tick, e.kind.value) for e in view.events]
        told += [(tick, "chat") for tick, _, _ in view.chat]
        heard = [events[number] for number in track.heard]
        assert sorted((tick, kind.value) for tick, kind in heard) == sorted(told)


def test_what_is_new_is_told_once_and_adds_up_to_the_whole(story):
    whole = RunData(story.reader, About("story"), depth=1).update()
    assert whole["head"]["title"] == "story"
    assert [line["facts"]["path"] for line in whole["timelines"].values()] == ["/", "/ann"]
    data = RunData(story.reader, About("story"), depth=1)
    data.update()
    assert data.update() == {}
    data.deepen(story.reader.timelines()[0].key, ("ann", "bob", "ann"))
    [(number, told)] = data.update()["timelines"].items()
    assert number == "0" and list(told["tracks"]) == ["/ann/bob/ann"]


@pytest.mark.parametrize("depth", [0, 1])
def test_lies_are_told_whatever_the_depth(depth):
    world = bn.ScriptedWorld(
        BOX, {}, {"ann": (2.5, 1, 2.5)}, containers={place: {"apple": 1} for place in CHESTS}
    )
    with bn.Nest(world) as nest:
        world.open("ann", CHESTS[0])
        world.say("ann", "It is empty.", claims=[bn.Claim.absent("apple", CHESTS[0])])
        world.say("ann", "So is this.", claims=[bn.Claim.absent("apple", CHESTS[1])])
        page = RunData(nest.reader, About("lies"), depth).update()
    events = page["timelines"]["0"]["events"][1]
    assert [claim[1] for event in events for claim in event.get("claims", [])] == ["a lie", "false"]
