"""`beliefnest replay`, `export` and `import`, and plans tried in branches."""

import json

import pytest
from msgspec.structs import replace

import beliefnest as bn
from beliefnest.cli.app import run_command_line
from beliefnest.timeline.journal import TimelineKey
from beliefnest.timeline.store import Journal

TRACE = """\
{"tick": 0, "box": [[0,0,0],[9,3,9]], "fills": [[[0,0,0],[9,0,9],"stone"]], \
"blocks": [[3,1,3,"chest"]], "containers": [[3,1,3,{"diamond":1}]], \
"agents": {"sally": {"position": [2.5,1,2.5]}, "anne": null}}
{"tick": 4, "agents": {"anne": {"position": [4.5,1,2.5], "yaw": 1.57}}}
{"tick": 9, "events": [{"kind": "chat", "actor": "anne", "detail": {"text": "mine"}}]}
"""
WALKS = [f"await goToPosition(bot, new Vec3({x}, -51, 5), 0)" for x in (0, 4)]


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """Record a run with plans, an edit and quiet ticks."""
    store = tmp_path_factory.mktemp("recorded") / "run.bn"
    with bn.Nest.open(bn.Scenario.load("sally-anne", 3), store=store, seed=4) as nest:
        nest.play()
        nest["/"].step(7)
        attempts = nest.explore(
            "/observer", "sally", WALKS, lambda there, _: there.state.agents["sally"].position[0]
        )
        assert nest["/observer"].mode == "follow"
        assert [attempt.branch for attempt in attempts] == ["plan 1", "plan 2"]
        assert all(attempt.result.ok for attempt in attempts)
        assert [int(attempt.score) for attempt in attempts] == [0, 4]
        nest["/observer"].switch("plan 2")
        nest["/observer"].edit(blocks={(0, -51, 0): "stone"}, containers={})
        nest["/observer"].run("sally", WALKS[0])
    return store


def test_replaying_finds_no_difference(run, capsys):
    assert run_command_line(["replay", str(run), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["same"]
    assert [row["programs"] for row in told["timelines"]] == [3, 1, 2]


def test_replaying_lets_programs_read_what_they_read_then(tmp_path, capsys):
    """Anne's knowledge decides where she goes; with the whole world she would go elsewhere."""
    store = tmp_path / "run.bn"
    look = """
      const chests = bot.findBlocks({ matching: block => block.name === 'chest', count: 9 })
      await goToPosition(bot, chests.at(-1) ?? new Vec3(0, -51, 5), 2)
      const sally = bot.players.sally.entity
      bot.chat(`${chests.length} ${sally === null}`)"""
    with bn.Nest.open(bn.Scenario.load("sally-anne", 3), store=store, seed=4) as nest:
        nest.play()
        nest["/"].run("anne", look, senses="percepts")
        nest["/"].edit(blocks={(0, -51, 0): "stone"})
        nest["/observer"].switch("try")
        nest["/observer"].run("sally", look, senses="percepts")
    assert run_command_line(["replay", str(store), "--json"]) == 0
    with Journal.read(store) as journal:
        assert [p.senses for p in journal.records.programs()][-2:] == ["percepts", "percepts"]


def test_replaying_names_the_first_tick_and_field_that_differ(run, tmp_path, capsys):
    other = tmp_path / "run.bn"
    other.write_bytes(run.read_bytes())
    key = TimelineKey(("observer",), "plan 1")
    with Journal.open(other) as journal, journal.together():
        info = journal.info(key)
        entries = list(journal.entries(key, 0, info.entries))
        programs = [p for p in journal.records.programs() if p.branch == "plan 1"]
        journal.delete(key)
        journal.create(key, info.base, info.start)
        frame = entries[3]
        x, y, z = frame.agents["sally"].position
        moved = replace(frame.agents["sally"], position=(x + 1, y, z))
        entries[3] = replace(frame, agents={**frame.agents, "sally": moved})
        journal.append(key, entries, info.head)
        for program in programs:
            journal.records.add_program(program)
    assert run_command_line(["replay", str(other)]) == 1
    told = capsys.readouterr().out
    assert f"differs at tick {frame.tick}, agents.sally.position.0" in told


def test_replaying_runs_the_recorded_programs(run, tmp_path, capsys):
    """A program that is not the one that was recorded shows, at its first tick."""
    other = tmp_path / "run.bn"
    other.write_bytes(run.read_bytes())
    key = TimelineKey(("observer",), "plan 1")
    with Journal.open(other) as journal, journal.together():
        info = journal.info(key)
        entries = list(journal.entries(key, 0, info.entries))
        (program,) = [p for p in journal.records.programs() if p.branch == "plan 1"]
        journal.delete(key)
        journal.create(key, info.base, info.start)
        journal.append(key, entries, info.head)
        journal.records.add_program(replace(program, code="bot.chat('no')"))
    assert run_command_line(["replay", str(other), "--json"]) == 1
    told = json.loads(capsys.readouterr().out)
    (difference,) = [row["difference"] for row in told["timelines"] if row["difference"]]
    assert (difference["entry"], difference["tick"]) == (0, entries[0].tick)


DRAW = "bot.chat('' + Math.random()); await bot.waitForTicks(2); bot.chat('' + Date.now())"


def scripted_run(store, told="mine"):
    """Record a run in the scripted world: programs, a branch, an edit, and telling."""
    with bn.Nest.open(bn.Scenario.load("sally-anne", 3), "scripted", store, seed=4) as nest:
        nest.play()
        world = nest.scripted_world
        world.say("anne", told)
        world.step(3)
        world.place_agent("anne", (1.5, -51, 1.5))
        nest["/"].run("anne", DRAW)
        nest["/"].edit(blocks={(0, -51, 0): "stone"})
        world.think("sally", "hm")
        nest["/"].run_all({"sally": DRAW, "anne": WALKS[0]}, senses="percepts")
        nest["/observer"].switch("try")
        nest["/observer"].scripted.say("sally", "not so")
        nest["/observer"].run("sally", DRAW)
    return store


def test_a_run_of_the_scripted_world_is_replayed_with_what_a_user_told_it(tmp_path, capsys):
    store = scripted_run(tmp_path / "run.bn")
    assert run_command_line(["replay", str(store), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert [row["programs"] for row in told["timelines"]] == [6, 1]
    with Journal.open(store) as journal, journal.together():
        key = TimelineKey(("observer",), "try")
        info = journal.info(key)
        entries = list(journal.entries(key, 0, info.entries))
        (program,) = [p for p in journal.records.programs() if p.branch == "try"]
        journal.delete(key)
        journal.create(key, info.base, info.start)
        journal.append(key, entries, info.head)
        journal.records.add_program(replace(program, code=DRAW.replace("2", "3")))
    assert run_command_line(["replay", str(store), "--json"]) == 1
    told = json.loads(capsys.readouterr().out)["timelines"]
    assert [row["difference"] is None for row in told] == [True, False]


def test_a_run_is_exported_with_beliefs(run, tmp_path, capsys):
    out = tmp_path / "tables"
    command = ["export", str(run), "--path", "/observer/sally", "--out", str(out)]
    assert run_command_line(command) == 0
    assert "timelines: 3" in capsys.readouterr().out
    last = json.loads((out / "beliefs.jsonl").read_text().splitlines()[-1])
    assert last["state"]["containers"]["-2,-51,-4"]["items"] == {"diamond": 1}
    assert run_command_line([*command, "--format", "csv"]) == 2


def test_a_trace_says_what_its_agents_perceive(tmp_path, capsys):
    trace, store = tmp_path / "told.jsonl", tmp_path / "run.bn"
    first, *others = TRACE.splitlines(keepends=True)
    senses = {"perception": {"hearing": {"radius": 3}, "containers": "transparent"}}
    told = {**json.loads(first), **senses, "static_blocks": ["stone"]}
    trace.write_text("".join([json.dumps(told) + "\n", *others]))
    assert run_command_line(["import", str(trace), "--out", str(store)]) == 0
    with bn.Nest.read(store) as nest:
        assert nest.setting.perception == bn.Perception(
            hearing=bn.Radius(3.0), containers="transparent"
        )
        assert nest["/sally"].state.containers[(3, 1, 3)].complete
        assert nest["/sally"].state.blocks[(9, 0, 9)] == "stone"
    for wrong in ({"perception": {"sight": 3}}, {"static_blocks": ["ston"]}):
        trace.write_text(json.dumps({**told, **wrong}) + "\n")
        assert run_command_line(["import", str(trace), "--out", str(tmp_path / "no.bn")]) == 2
        assert "line 1, the first state" in capsys.readouterr().err


def test_a_trace_becomes_a_run(tmp_path, capsys):
    trace, store = tmp_path / "told.jsonl", tmp_path / "run.bn"
    trace.write_text(TRACE)
    assert run_command_line(["import", str(trace), "--out", str(store)]) == 0
    capsys.readouterr()
    assert run_command_line(["show", str(store), "--path", "/sally/anne", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["chat"] == [[9, "anne", "mine"]]
    with bn.Nest.resume(store) as nest:
        nest.scripted_world.open("sally", (3, 1, 3))
        assert nest["/anne/sally"].state.containers[(3, 1, 3)].complete is False
        assert nest["/sally"].state.containers[(3, 1, 3)].items == {"diamond": 1}
    assert run_command_line(["replay", str(store)]) == 2
    assert "come from the user" in capsys.readouterr().err
