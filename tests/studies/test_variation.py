"""Parameters, and copies of scenes: everything moves and is renamed, or it is refused."""

import json
from pathlib import Path

import pytest
from jsonschema import Draft202012Validator
from ruamel.yaml import YAML
from tests.studies.small import SMALL, small_in

import beliefnest as bn
from beliefnest.errors import InputError, ScenarioError
from beliefnest.facts.kinds import FactEntry
from beliefnest.scenarios.document import plain
from beliefnest.scenarios.expected import ExpectationEntry, ExpectEntry
from beliefnest.scenarios.expressions import evaluate
from beliefnest.scenarios.format import (
    AgentEntry,
    BelievedSignEntry,
    ContainerEntry,
    InferEntry,
    InitialBeliefEntry,
    ProbeEntry,
    ScenarioFile,
    SignEntry,
    StepEntry,
)
from beliefnest.scenarios.rules import EpisodeEntry, GoalEntry
from beliefnest.scenarios.sources import builtin_names, read_document
from beliefnest.studies.program_rewriting import Rewriting, rewritten
from beliefnest.studies.random_variations import drawn_variations
from beliefnest.studies.scene_changes import _SHAPE
from beliefnest.studies.symmetry import SYMMETRIES, Placing
from beliefnest.studies.variation import Variation


def varied(name, condition=None, **values):
    variation = Variation(values)
    document = read_document(name)
    return bn.Scenario.varied(document, condition, variation.parameters, variation.scene)


def test_a_value_takes_the_place_of_its_name_whole_or_within_a_text(tmp_path):
    scenario = bn.Scenario.load(small_in(tmp_path), parameters={"spot": [5, 1, 1], "item": "bone"})
    assert scenario.setting.snapshot.containers == {(5, 1, 1): {"bone": 1}}
    assert scenario.probes[0].task == "Get a bone from a chest."
    assert bn.Scenario.kept(scenario.text, {}, None, "kept").probes == scenario.probes


def test_javascripts_own_holes_stay_in_programs(tmp_path):
    program = "script: [{agent: ann, program: 'say(bot, `${bot.health} ${count + 1}`)'}]\n"
    scenario = bn.Scenario.load(small_in(tmp_path, SMALL + program), parameters={"count": 4})
    assert scenario.setting.script[0].programs["ann"] == "say(bot, `${bot.health} 5`)"


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ('at: "${spot}"', 'at: "${sopt}"', "small.yaml:11: containers[0].at: 'sopt' names 'sopt'"),
        ("default: diamond, ", "", "parameters.item: the key 'default' is missing"),
        ("range: [1, 64]", "range: [64, 1]", "parameters.count.range: ends below its beginning"),
        ("spot[0] + spot[2] < 10", "spot.x < 3", "is not allowed in an expression"),
        ("spot[0] + spot[2] < 10", "spot[0] > 3", "'spot[0] > 3' does not hold for spot [1, 1, 1]"),
    ],
)
def test_what_is_wrong_with_parameters_is_told_with_its_line(tmp_path, old, new, told):
    file = small_in(tmp_path, SMALL.replace(old, new))
    with pytest.raises(ScenarioError) as caught:
        bn.Scenario.load(file)
    assert told in str(caught.value)


def test_an_undeclared_parameter_is_refused(tmp_path):
    with pytest.raises(ScenarioError, match="no parameter 'spto'; did you mean 'spot'"):
        bn.Scenario.load(small_in(tmp_path), parameters={"spto": 1})


FAR = """
conditions:
  1: {description: As declared.}
  2: {parameters: {spot: {default: [5, 1, 1]}}, constraints: ["spot[0] > 3"]}
"""


def test_a_condition_has_defaults_and_constraints_of_its_own(tmp_path):
    file = small_in(tmp_path, SMALL + FAR)
    places = [
        list(bn.Scenario.load(file, number).setting.snapshot.containers) for number in (1, 2, None)
    ]
    assert places == [[(1, 1, 1)], [(5, 1, 1)], [(1, 1, 1)]]
    kept = bn.Scenario.load(file, 2, parameters={"count": 3})
    assert kept.setting.snapshot.containers == {(5, 1, 1): {"diamond": 3}}
    assert bn.Scenario.kept(kept.text, {}, 2, "kept").probes == kept.probes
    with pytest.raises(ScenarioError, match=r"'spot\[0\] > 3' does not hold for spot \[1, 1, 5\]"):
        bn.Scenario.load(file, 2, parameters={"spot": [1, 1, 5]})
    plan = bn.Study(file, variations={"spot": [[1, 1, 5], [5, 1, 1]]}).plan()
    assert [(each.condition, each.variation["spot"]) for each in plan.invalid] == [(2, [1, 1, 5])]


def test_a_condition_declares_no_parameter(tmp_path):
    file = small_in(tmp_path, SMALL + FAR.replace("{spot:", "{sopt:"))
    with pytest.raises(ScenarioError, match=r"conditions\[2\]\.parameters\.sopt: is not declared"):
        bn.Scenario.load(file, 2)


def problems(content):
    """Return the errors that an editor finds in a scenario file."""
    file = Path(__file__).parents[2] / "docs" / "scenario.schema.json"
    schema = json.loads(file.read_text(encoding="utf-8"))
    # JSON's keys are texts.
    return list(Draft202012Validator(schema).iter_errors(json.loads(json.dumps(content))))


@pytest.mark.parametrize(
    ("old", "new", "count"),
    [
        ("", "", 0),
        ("[0, 0, 0], [6, 3, 6]", '[0, "${spot[1] - 1}", 0], "${far}"', 0),
        ("[3.5, 1, 3.5]}", '["${x}", 1, 3.5], yaw: "${turn}", health: "${well}"}', 0),
        ('at: "${spot}"', "at: spot", 2),
        ("[3.5, 1, 3.5]", '"at ${spot}"', 1),
        ("range: [1, 64]", 'range: "${spot}"', 1),
    ],
)
def test_editors_admit_holes_where_anything_but_text_is_asked_for(old, new, count):
    assert len(problems(YAML(typ="safe").load(SMALL.replace(old, new)))) == count


def test_editors_find_nothing_wrong_in_the_built_in_scenarios():
    for name in builtin_names():
        assert problems(plain(read_document(name).root)) == [], name


@pytest.mark.parametrize(
    "text", ["__import__('os')", "'a' * 9**9", "[1] * 9", "2 ** 99", "x.y", "(lambda: 1)()", "1 +"]
)
def test_expressions_compute_with_values_alone(text):
    with pytest.raises(InputError):
        evaluate(text, {"x": 1})


def test_a_turned_scene_has_all_of_it_turned():
    written, turned = (
        varied("sally-anne", 2, symmetry=name) for name in ("as-written", "turned-90")
    )
    # The box is 23 wide from -11: x' = -z - 0.5 + 0.5, z' = x for blocks.
    assert set(turned.setting.snapshot.containers) == {
        (-z, y, x) for x, y, z in written.setting.snapshot.containers
    }
    assert turned.setting.script[1].programs == {
        "sally": "await goToPosition(bot, new Vec3(6, -51, 6), 1);"
    }
    sally, before = (s.setting.snapshot.agents["sally"] for s in (turned, written))
    assert sally.position == (1 - before.position[2], -51, before.position[0])
    assert sally.yaw == pytest.approx(-1.5707963)
    assert turned.probes[0].expect[0].container == (4, -51, 2)


def test_names_change_in_programs_texts_and_paths():
    scenario = varied(
        "help-sally", agents={"sally": "anne", "anne": "ed"}, items={"diamond": "apple"}
    )
    assert (
        scenario.setting.script[3]
        .programs["anne"]
        .endswith('await say(bot, "I want to get an apple from a chest.");\n')
    )
    assert "{apple: 1}" in scenario.setting.script[2].programs["ed"]
    assert [probe.path for probe in scenario.probes] == ["/ed/anne", "/ed", "/ed"]
    assert scenario.probes[1].task == "Help Anne."
    assert scenario.expectations[3].fact.text == "an apple"


HALL = """\
name: hall
box: [[0, 0, 0], [9, 3, 19]]
blocks: [{block: stone, fill: [[0, 0, 0], [9, 0, 19]]}]
containers: [{at: [1, 1, 2], items: {diamond: 1}}, {at: [8, 1, 2]}]
signs:
  - at: [4, 1, 9]
    block: oak_sign[rotation=4]
    text: it is in the other one
    claims:
      - {container: [8, 1, 2], items: {diamond: 1}}
      - {agent: cid, at: [7.5, 1, 3.5]}
      - {block: [6, 1, 4], state: "oak_stairs[facing=east]"}
unique: [diamond]
perception: {max_visible_distance: 6, testimony: accept}
initial_beliefs: [{path: /bob, containers: [{at: [1, 1, 2], items: {diamond: 1}}]}]
agents:
  ann: {position: [2.5, 1, 4.5]}
  bob: {position: [5.5, 1, 11.5]}
  cid: {position: [8.5, 1, 18.5]}
"""


@pytest.mark.parametrize("symmetry", SYMMETRIES, ids=lambda symmetry: symmetry.name)
def test_unique_items_and_what_signs_claim_move_with_the_scene(tmp_path, symmetry):
    path = small_in(tmp_path, HALL)
    written = bn.Scenario.load(path)
    placing = Placing(symmetry, written.setting.snapshot.box)
    with bn.Nest.open(varied(path, symmetry=symmetry.name), world="scripted") as nest:
        belief = nest["/bob"].state
        place = placing.block((8, 1, 2))
        # A unique item is believed in one place, no longer where the initial belief put it.
        assert {at: dict(held.items) for at, held in belief.containers.items() if held.items} == {
            place: {"diamond": 1}
        }
        assert belief.agents["cid"].position == placing.point((7.5, 1, 3.5))
        stairs = belief.blocks[placing.block((6, 1, 4))]
        assert f"facing={symmetry.direction('east')}" in stairs
        sign = placing.block((4, 1, 9))
        assert {claim.sign for claim in nest.claims()} == {sign}
        assert f"the sign at {sign} at tick 0 that diamond is in {place}" in str(
            nest["/bob"].explain(container=place)
        )


def test_unique_items_and_what_signs_claim_are_renamed(tmp_path):
    names = {"agents": {"bob": "ed", "cid": "flo"}, "items": {"diamond": "apple"}}
    with bn.Nest.open(varied(small_in(tmp_path, HALL), **names), world="scripted") as nest:
        assert nest["/ed"].state.containers[8, 1, 2].items == {"apple": 1}
        assert nest["/ed"].state.containers[1, 1, 2].items == {}
        told = [str(claim.claim) for claim in nest.claims()]
        assert told[:2] == ["apple is in (8, 1, 2)", "flo is at (7.5, 1, 3.5)"]


def test_two_agents_cannot_get_one_name():
    with pytest.raises(InputError, match="two agents would be called 'anne'"):
        varied("help-sally", agents={"sally": "anne"})


MOVED = Rewriting(lambda place, _: (-place[0], place[1], place[2]), str, str)


@pytest.mark.parametrize(
    ("program", "why"),
    [
        (
            "const at = 3;\nawait goToPosition(bot, new Vec3(at, 1, 2));",
            "line 2 .*computes a position",
        ),
        ("bot.entity.position.x > 3", "computes with 'x'"),
        ("for (const [x, z] of [[1, 0]]) {}", "which may be a position"),
        ("say(bot, 'go north')", "names a direction"),
        ("await (", "is not valid JavaScript"),
        ("bot.pathfinder.goto(new goals.GoalXZ(1, 2))", "holds positions by 'goals'"),
    ],
)
def test_what_cannot_be_moved_for_certain_is_refused(program, why):
    with pytest.raises(InputError, match=why):
        rewritten(program, MOVED)


def test_positions_in_comments_and_strings_are_no_code():
    program = "// new Vec3(1, 2, 3)\nawait lookAt(bot, new Vec3(1.5, 2, -3));"
    moved = "// new Vec3(1, 2, 3)\nawait lookAt(bot, new Vec3(-1.5, 2, -3));"
    assert rewritten(program, MOVED) == moved


def test_a_task_that_names_a_side_is_refused_with_its_line(tmp_path):
    file = small_in(tmp_path, SMALL.replace("Get a ${item} from a", "Open the left"))
    with pytest.raises(ScenarioError, match=r"small.yaml:21: probes\[0\].task: says 'left'"):
        varied(file, symmetry="mirrored")


def test_draws_keep_constraints_differ_and_begin_alike(tmp_path):
    document = read_document(small_in(tmp_path))
    few, many = (drawn_variations(document, count, "seed") for count in (5, 40))
    assert many[:5] == few
    assert len({each.key for each in many}) == 40
    assert all(each.values["spot"] != [5, 1, 5] for each in many)
    assert drawn_variations(document, 5, "other") != few


def test_as_many_are_drawn_as_asked_for_or_it_is_told_how_many_there_are(tmp_path):
    # Three places, two items, one count, eight symmetries; Ann is named in the task.
    text = SMALL.replace("range: [1, 64]", "values: [1]").replace("Get a", "As ann get a")
    document = read_document(small_in(tmp_path, text))
    every = drawn_variations(document, 48, "seed")
    assert len({each.key for each in every}) == 48
    assert every[:20] == drawn_variations(document, 20, "seed")
    told = (
        r"small.yaml: variations is 60, and there are 48 different ones: all combinations of spot "
        r"\(3\), item \(2\), count \(1\), symmetry \(8\) that keep the constraints; ask for 48"
    )
    with pytest.raises(InputError, match=told):
        drawn_variations(document, 60, "seed")
    with pytest.raises(InputError, match=told):
        bn.Study(small_in(tmp_path, text), variations=60).plan()


def test_names_are_drawn_beside_parameters_but_for_those_that_parameters_have(tmp_path):
    document = read_document(small_in(tmp_path, SMALL.replace("range: [1, 64]", "values: [1]")))
    many = drawn_variations(document, 60, "seed")
    assert len({each.key for each in many}) == 60
    assert len({each.values["agents"]["ann"] for each in many}) > 5
    assert all("items" not in each.values for each in many)
    plan = bn.Study(small_in(tmp_path), variations=60).plan()
    assert len(plan.cells) == 60 and not plan.invalid
    who = SMALL.replace("parameters:\n", "parameters:\n  who: {default: ann, values: [ann]}\n")
    named = drawn_variations(read_document(small_in(tmp_path, who)), 9, "seed")
    assert all(each.values["who"] == "ann" and "agents" not in each.values for each in named)


DRAWN = """
name: drawn
map:
  legend:
    c: {container: chest, items: {bone: 1}}
    a: {agent: ann, inventory: {"${item}": 1}}
    b: {agent: bob}
  floors: |
    c...
    .a.b
parameters: {item: {default: diamond, values: [diamond, apple]}}
"""


def test_what_a_map_draws_is_renamed_as_if_it_were_written(tmp_path):
    file = tmp_path / "drawn.yaml"
    file.write_text(DRAWN)
    many = drawn_variations(read_document(str(file)), 30, "seed")
    assert len({each.values["agents"]["bob"] for each in many}) > 5
    assert {tuple(each.values["items"]) for each in many} == {("bone",)}
    assert {each.values["item"] for each in many} == {"diamond", "apple"}
    plan = bn.Study(str(file), variations=30).plan()
    assert len(plan.cells) == 30 and not plan.invalid


def test_more_variations_than_there_can_be_are_refused_at_once(tmp_path):
    document = read_document(small_in(tmp_path, SMALL.replace("range: [1, 64]", "values: [1]")))
    with pytest.raises(InputError, match=r"variations is 40,000,000, and there are at most 1,152"):
        drawn_variations(document, 40_000_000, "seed")


def test_a_study_s_constraints_take_no_variation_from_those_asked_for(tmp_path):
    study = bn.Study(small_in(tmp_path), variations=20, constraints=["count > 32"])
    plan = study.plan()
    assert len(plan.cells) == 20 and not plan.invalid
    assert all(cell.key.variation["count"] > 32 for cell in plan.cells)


TOLD = """
static_blocks: [stone, [4, 0, 2]]
labels: true
expectations: [{path: /, block: [5, 1, 1], state: "oak_stairs[facing=west]"}]
"""


def test_blocks_that_are_expected_and_known_move_with_the_scene(tmp_path):
    stairs = '\n  - {block: "oak_stairs[facing=west]", at: [5, 1, 1]}\nparameters:'
    file = small_in(tmp_path, SMALL.replace("\nparameters:", stairs) + TOLD)
    scenario = varied(file, symmetry="mirrored")
    assert scenario.setting.static_blocks == {"stone", (2, 0, 2)}
    expected = scenario.expectations[0].fact
    assert expected.place == (1, 1, 1)
    assert expected.state.startswith("oak_stairs[facing=east")
    labelled = small_in(tmp_path, SMALL.replace("label: box", "label: left box") + TOLD)
    with pytest.raises(ScenarioError, match=r"containers\[0\].label: says 'left'"):
        varied(labelled, symmetry="mirrored")


def test_every_key_of_a_scenario_is_known_in_another_scene():
    shape = _SHAPE["initial_beliefs"].shape
    for entry, known in {
        ScenarioFile: {*_SHAPE, "parameters", "constraints", "instances", "conditions"},
        ContainerEntry: _SHAPE["containers"].shape,
        SignEntry: _SHAPE["signs"].shape,
        AgentEntry: _SHAPE["agents"].shape,
        StepEntry: _SHAPE["script"].shape,
        ProbeEntry: _SHAPE["probes"].shape,
        # The values that a function judges are unknown.
        ExpectEntry: {*_SHAPE["probes"].shape["expect"], "function"},
        InferEntry: _SHAPE["probes"].shape["infer"],
        ExpectationEntry: _SHAPE["expectations"].shape,
        FactEntry: _SHAPE["episode"]["goal"]["reach"].shape,
        EpisodeEntry: _SHAPE["episode"],
        GoalEntry: _SHAPE["episode"]["goal"],
        InitialBeliefEntry: shape,
        BelievedSignEntry: shape["signs"].shape,
    }.items():
        assert set(entry.__struct_fields__) <= set(known), entry


def test_rules_of_play_and_agents_at_their_places_move_and_get_new_names(tmp_path):
    rules = """
initial_beliefs: [{path: "/**", agents: [ann, bob]}]
agents: {ann: {position: [0.5, 1, 0.5]}, bob: {position: [2.5, 1, 1.5]}}
episode:
  goal: {reach: [{agent: bob, at: [0, 1, 2]}]}
  goals: {ann: {helps: bob}}
  goals_known: false
  possible_goals: {bob: {near: {reach: [{agent: bob, at: [0, 1, 2]}]}}}
  rewards: {message: -0.5}
"""
    floor = "blocks: [{block: stone, fill: [[0, 0, 0], [4, 0, 4]]}]"
    head = f"name: hall\nbox: [[0, 0, 0], [4, 3, 4]]\n{floor}"
    file = tmp_path / "hall.yaml"
    file.write_text(head + rules, encoding="utf-8")
    moved = varied(str(file), symmetry="mirrored", agents={"bob": "tom"})
    (belief,) = moved.setting.initial_beliefs
    assert belief.agents == {"ann": (4.5, 1.0, 0.5), "tom": (2.5, 1.0, 1.5)}
    (near,) = (moved.rules.possible_goals["tom"]["near"].reach[0],)
    assert (near.agent, near.at) == ("tom", (4, 1, 2))
    assert moved.rules.goals["ann"].helps == "tom"
    assert moved.rules.rewards.message == -0.5


TEMPLATE = (
    "You are ann. {{ branch | position('ann') }} {{ branch | chests }} Task: {{ task }} "
    "{% if ann is defined %}!{% endif %}"
)


def test_templates_name_agents_and_items_anew(tmp_path):
    (tmp_path / "mine.txt").write_text(TEMPLATE, "utf-8")
    file = small_in(tmp_path, SMALL.replace("agent: ann\n", "agent: ann\n    template: mine.txt\n"))
    names = {"agents": [{"ann": "mia"}], "items": [{"diamond": "apple"}]}
    new = TEMPLATE.replace("are ann", "are mia").replace("'ann'", "'mia'")
    assert varied(file, agents={"ann": "mia"}).probes[0].template == new
    alone = bn.Study(small_in(tmp_path), templates=[str(tmp_path / "mine.txt")], variations=names)
    assert alone.plan().cells[0].scenario.probes[0].template == new


@pytest.mark.parametrize(
    ("items", "told"),
    [
        ({"diamnod": "apple"}, "there is no item 'diamnod' to rename; items are bone, diamond"),
        ({"diamond": "bone"}, "two items would be called 'bone'"),
    ],
)
def test_items_that_are_not_there_or_would_be_one_are_refused(tmp_path, items, told):
    held = "ann: {inventory: {bone: 1}, "
    with pytest.raises(InputError, match=told):
        varied(small_in(tmp_path, SMALL.replace("ann: {", held)), items=items)
