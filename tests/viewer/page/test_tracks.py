"""Tracks say at every tick what states, and `false_beliefs`, say."""

import random

import pytest

import beliefnest as bn
from beliefnest.viewer.page.pose_history import PoseBook
from beliefnest.viewer.page.run import About, RunData
from beliefnest.viewer.page.tracks import CURRENT, PLACED, STALE, UNKNOWN, Track, TrackRecorder
from beliefnest.world.paths import paths_below

BOX = ((0, 0, 0), (12, 3, 8))
CHESTS = [(3, 1, 3), (9, 1, 3)]


@pytest.fixture(scope="module")
def story() -> bn.Nest:
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
    recorder = TrackRecorder(nest.reader, info.key, paths, book)
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
