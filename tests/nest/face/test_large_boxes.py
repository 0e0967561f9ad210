"""Runs in boxes whose blocks are in chunks: all that can be read is as without chunks."""

import json
from types import SimpleNamespace

import pytest

import beliefnest as bn
from beliefnest.cli.exchange import export_run, import_run
from beliefnest.episodes.imagination import Performer
from beliefnest.nest.past.percepts import percepts_of
from beliefnest.skills.calls import Call
from beliefnest.world import terrain

BOX = ((-9, 58, -20), (20, 70, 11))
FLOOR = 60
CHEST, DOOR, SIGN, LEVER = (6, 61, 3), (7, 61, -9), (-2, 61, -2), (15, 61, 7)
PATHS = ("/", "/ann", "/bob", "/ann/bob", "/bob/ann")
FILTERS = ("blocks", "mechanisms", "signs", "containers", "blocks_and_visibilities('glass')")


def blocks():
    """Return a floor, and walls that cross borders of chunks, which are 8 blocks apart."""
    (x0, _, z0), (x1, _, z1) = BOX
    floor = {(x, FLOOR, z): "stone" for x in range(x0, x1 + 1) for z in range(z0, z1 + 1)}
    walls = {(7, y, z): "bricks" for y in (61, 62) for z in range(-12, 9) if z not in (-9, -1, -2)}
    door = {
        DOOR: "oak_door[half=lower,facing=east]",
        (7, 62, -9): "oak_door[half=upper,facing=east]",
    }
    things = {SIGN: "oak_sign", LEVER: "lever[face=floor]", (0, 61, -1): "oak_fence"}
    return {**floor, **walls, **door, **things}


def recorded(store):
    """Return a nest with a past, a fork of a belief, and an edit in it."""
    world = bn.ScriptedWorld(
        BOX,
        blocks(),
        {"ann": (2.5, 61.0, -0.5), "bob": (10.5, 61.0, -3.5)},
        {"ann": {"diamond": 1}},
        {CHEST: {"bread": 2}},
        signs={SIGN: "beware"},
    )
    perception = bn.Perception(max_visible_distance=8)
    nest = bn.Nest(world, static_blocks=["stone"], perception=perception, store=store)
    nest.states(PATHS)
    world.open("ann", CHEST)
    world.set_block((7, 61, -9), "air")
    world.place_agent("bob", (6.5, 61.0, -1.5))
    world.set_block((-1, 61, -1), "glass", actor="ann")
    world.step(3)
    world.place_agent("ann", (14.5, 61.0, 6.5))
    world.say("bob", "here")
    world.place_agent("bob", (-3.5, 61.0, -10.5))
    world.set_block((8, 61, 7), "oak_fence")
    world.step(2)
    nest["/ann"].switch("plan")
    nest["/ann"].scripted.set_block((16, 62, 8), "glass")
    nest["/ann"].edit({(7, 60, 7): "bricks", (15, 61, 8): None}, {(0, 62, 0): {"egg": 1}})
    nest["/ann"].step(2)
    return nest


def told(nest):
    """Return what is read of all simulators, as values that compare."""
    found = {}
    cells = [(x, 61, z) for x in (-1, 0, 6, 7, 8, 15) for z in (-10, -2, -1, 6, 7, 8)]
    for path in PATHS:
        simulator = nest[path]
        state = simulator.state
        found[path] = (
            state.blocks.grid.tobytes(),
            state.blocks.terrain.dense().tobytes(),
            [state.blocks[cell] for cell in cells],
            [(state.blocks.current(cell), state.blocks.basis(cell)) for cell in cells],
            state.blocks.named(frozenset(["glass", "oak_door", "chest"])),
            len(state.blocks),
            [simulator.render("{{ branch | " + each + " }}") for each in FILTERS],
            str(simulator.explain(block=(7, 61, 7))),
            [nest[path].state.blocks == nest[other].state.blocks for other in PATHS],
            [
                (moment.tick, moment.timeline, dict(moment.blocks))
                for moment in nest.over_time(path)
            ],
        )
    return found


def with_and_without_chunks(call):
    """Return the results of a call for boxes of one chunk and for boxes in chunks."""
    found = []
    for dense in (terrain.DENSE, 0):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(terrain, "DENSE", dense)
            found.append(call())
    return found


def test_recorded_runs_read_the_same(tmp_path):
    def of_file():
        store = tmp_path / f"{terrain.DENSE}.bn"
        recorded(store).close()
        with bn.Nest.read(store) as nest:
            return told(nest)

    plain, cut = with_and_without_chunks(of_file)
    assert plain == cut
    moments = plain["/ann"][-1]
    assert len(moments) > 3
    assert (7, 61, 2) in moments[0][2]


def test_exported_tables_are_the_same(tmp_path):
    def tables():
        folder = tmp_path / str(terrain.DENSE)
        folder.mkdir()
        recorded(folder / "run.bn").close()
        options = SimpleNamespace(
            format="jsonl", run=folder / "run.bn", path=PATHS[1:], out=folder / "tables"
        )
        export_run(options)
        return {each.name: each.read_text() for each in (folder / "tables").iterdir()}

    plain, cut = with_and_without_chunks(tables)
    assert plain == cut
    rows = [json.loads(line) for line in plain["blocks.jsonl"].splitlines()]
    first = [row for row in rows if row["entry"] == -1 and row["path"] == "/"]
    assert {(row["x"], row["y"], row["z"]) for row in first} == {*blocks(), CHEST}


def test_traces_are_the_same(tmp_path):
    low, high = BOX
    lines = [
        {
            "box": BOX,
            "agents": {"ann": {"position": (2.5, 61.0, -0.5)}},
            "fills": [
                (low, (high[0], FLOOR, high[2]), "stone"),
                ((6, 60, -2), (8, 64, 9), "bricks"),
            ],
            "blocks": [(*CHEST, "chest"), (*SIGN, "oak_sign")],
            "signs": [(*SIGN, "beware")],
            "containers": [(*CHEST, {"bread": 2})],
        },
        {"tick": 3, "blocks": [(7, 63, -1, "air"), (20, 70, 11, "glass")]},
        {"tick": 5, "containers": [(*CHEST, {})]},
    ]
    trace = tmp_path / "trace.jsonl"
    trace.write_text("\n".join(map(json.dumps, lines)))

    def read():
        store = tmp_path / f"{terrain.DENSE}.bn"
        import_run(trace, store)
        with bn.Nest.read(store) as nest:
            return told_of(nest["/"].state), told_of(nest["/ann"].state)

    plain, cut = with_and_without_chunks(read)
    assert plain == cut
    assert plain[0][1] == {(20, 70, 11): "glass"}


def told_of(state):
    return state.blocks.grid.tobytes(), state.blocks.named(frozenset(["glass"])), state.containers


def test_percepts_are_the_same(tmp_path):
    def percepts():
        nest = recorded(tmp_path / f"{terrain.DENSE}.bn")
        recording = nest._engine.recording
        found = []
        for path in (("bob",), ("bob", "ann")):
            first, last = recording.moment(path, 0), recording.moment(path)
            for percept, held in percepts_of(recording, path, first, last):
                parts = (percept.tick, percept.cells.tolist(), percept.states.tolist())
                found.append((*parts, percept.contents, held.dense().tobytes()))
        nest.close()
        return found

    plain, cut = with_and_without_chunks(percepts)
    assert plain == cut
    assert any(cells for _, cells, *_ in plain)


def test_imaginations_are_the_same(tmp_path):
    def imagined():
        nest = recorded(tmp_path / f"{terrain.DENSE}.bn")
        mind = nest["/bob"].imagination(1)
        forks = [mind.fork() for _ in range(4)]
        forks[1].play({"bob": Performer([Call("goToPosition", ((2, 61, -16),))])}, 60)
        for each in forks[2:]:
            each.world.set_block((8, 61, 8), "glass")
        forks[3].world.set_block((8, 61, 8), "oak_fence")
        forks[3].world.set_block((8, 61, 8), "glass")
        for each in forks:
            each.world.step(5 - each.tick % 5)
        keys = [each.print_of("bob", 1) for each in forks]
        cells = [(x, 61, z) for x in range(-9, 21) for z in range(-20, 12)]
        nest.close()
        return (
            [[one == other for other in keys] for one in keys],
            [each.world.agents["bob"].position for each in forks],
            [mind.is_unknown(cell) for cell in cells],
            [mind.may_reach("bob", cell) for cell in cells],
            [sorted(each.seen_by("bob")) for each in forks],
        )

    plain, cut = with_and_without_chunks(imagined)
    assert plain == cut
    equal, feet, unknown, _, _ = plain
    assert equal[2][3]
    assert not equal[0][2]
    assert feet[1] != feet[0]
    assert True in unknown
    assert False in unknown


def test_imagined_histories_are_the_same(tmp_path):
    def imagined():
        world = bn.ScriptedWorld(
            BOX,
            blocks(),
            {"ann": (-7.5, 61.0, -17.5), "bob": (5.5, 61.0, 2.5)},
            containers={CHEST: {"bread": 2}},
        )
        known = bn.InitialBelief(
            ("ann",), {CHEST: ({"bread": 2}, True)}, {}, {"bob": (5.5, 61.0, 2.5)}
        )
        perception = bn.Perception(max_visible_distance=12)
        with bn.Nest(
            world,
            static_blocks=["stone"],
            initial_beliefs=[known],
            perception=perception,
            store=tmp_path / f"{terrain.DENSE}.bn",
        ) as nest:
            world.step(20)
            world.withdraw("bob", CHEST, {"bread": 1})
            world.place_agent("ann", (5.5, 61.0, 3.5))
            world.open("ann", CHEST)
            take = f"await getItemFromChest(bot, new Vec3{CHEST}, {{bread: 1}})"
            found = nest["/ann"].imagine(0, actors={"bob": {"take": take, "idle": ""}}, n=8)
            return found.by_candidate("bob")

    plain, cut = with_and_without_chunks(imagined)
    assert plain == cut
    assert plain["take"] > plain["idle"]
