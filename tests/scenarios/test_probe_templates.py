"""Templates of probes: their variables are checked before anything is played."""

import pytest

import beliefnest as bn
from beliefnest.llm.offline import OfflineModel
from beliefnest.scenarios.content import PROGRAM_VARIABLES, QUESTION_VARIABLES
from beliefnest.scenarios.running import run_scenario

SCENE = """\
name: room
box: [[0, 0, 0], [4, 3, 4]]
agents: {ann: {position: [1.5, 1, 1.5]}}
probes:
- {path: /ann, agent: ann, acts_in: /, template: own.txt, PROBE}
"""
PROGRAM = "task: Rest."
QUESTION = "expect: {answers: {question: Why?, right: so}}"
ALWAYS = ["branch", "last_code", "last_error"]


def load(tmp_path, template, probe=PROGRAM):
    (tmp_path / "own.txt").write_text(template, encoding="utf-8")
    (tmp_path / "room.yaml").write_text(SCENE.replace("PROBE", probe), encoding="utf-8")
    return bn.Scenario.load(str(tmp_path / "room.yaml"))


@pytest.mark.parametrize(
    ("template", "told"),
    [
        ("Hm.\n{{ tsak }}", r"own\.txt, line 2: there is no variable 'tsak'; did you mean task"),
        ("{% if bramch %}x{% endif %}", "line 1: .*'bramch'; did you mean branch"),
        ("{% for one in option %}{{ one }}{% endfor %}", "no variable 'option'"),
        ("{{ question }}", "no variable 'question'"),
        ("{{ branch", "own.txt, line 1: unexpected end"),
    ],
)
def test_a_template_with_an_unknown_variable_is_refused(tmp_path, template, told):
    with pytest.raises(bn.ScenarioError, match=rf"room\.yaml:5: probes\[0\]\.template: .*{told}"):
        load(tmp_path, template)


@pytest.mark.parametrize(
    "template",
    [
        "{{ nobody | default('x') }}{% if nothing is defined %}{{ nothing }}{% endif %}",
        "{% if task %}{% set one = 1 %}{% endif %}{{ one }}{% macro a(b) %}{{ b }}{% endmacro %}",
        "{{ range(3) | list }} $$LAST_CODE$$ {% include 'instructions' %}",
        "{{ branch | filter_of_a_nest }}",
    ],
)
def test_variables_that_may_be_missing_or_are_set_inside_are_accepted(tmp_path, template):
    load(tmp_path, template)


@pytest.mark.parametrize(
    ("probe", "names"), [(PROGRAM, PROGRAM_VARIABLES), (QUESTION, QUESTION_VARIABLES)]
)
def test_every_accepted_variable_has_a_value_in_prompts(tmp_path, probe, names):
    scenario = load(tmp_path, " ".join(f"{{{{ {name} }}}}" for name in (*names, *ALWAYS)), probe)
    with bn.Nest.open(scenario, world="scripted") as nest:
        found = run_scenario(nest, scenario, OfflineModel(), 0, 0.0, lambda *_: None)
    prompts = [found.probes[0].prompt, *(each.prompt for each in found.probes[0].replies)]
    assert any("Rest." in prompt or "Why?" in prompt for prompt in prompts)
