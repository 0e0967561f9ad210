"""Running and judging scenarios of a user's own, with models of the test's own."""

import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

import beliefnest as bn
from beliefnest.llm.messages import Answer, Message, Sampling
from beliefnest.scenarios.outcome import Outcome
from beliefnest.scenarios.running import run_scenario
from beliefnest.scenarios.trial import opened_by
from beliefnest.world.values import Event, EventKind

BLUE, RED = (1, 1, 5), (7, 1, 5)
pytestmark = pytest.mark.usefixtures("kept_worlds")

ROOM: dict[str, Any] = {
    "name": "room",
    "box": [[0, 0, 0], [8, 3, 8]],
    "blocks": [{"block": "stone", "fill": [[0, 0, 0], [8, 0, 8]]}],
    "containers": [
        {"label": "blue", "at": list(BLUE), "items": {"apple": 1}},
        {"label": "red", "at": list(RED)},
    ],
    "agents": {"ann": {"position": [4.5, 1, 4.5]}, "bob": {"position": [4.5, 1, 7.5]}},
    "static_blocks": ["stone"],
}


class Parrot:
    """Answers every prompt with one program, and remembers what it was asked."""

    name = "parrot"

    def __init__(self, program: str) -> None:
        self.program = program
        self.asked: list[Sequence[Message]] = []

    def answer(self, messages: Sequence[Message], sampling: Sampling) -> Answer:
        self.asked.append(messages)
        return Answer(f"Here you are:\n```javascript\n{self.program}\n```")


def run(model: Parrot, folder: Path | None = None, **changes: Any) -> Outcome:
    scenario = bn.Scenario.from_mapping({**ROOM, **changes})
    with bn.Nest.open(scenario) as nest:
        return run_scenario(
            nest, scenario, model, 0, time.perf_counter(), lambda what, done, total: None
        )


def probe(**changes: Any) -> dict[str, Any]:
    return {"path": "/ann/bob", "acts_in": "/ann", "agent": "bob", "task": "Go.", **changes}


@pytest.mark.parametrize(("target", "ok"), [((2, 1, 2), True), ((6, 1, 6), False)])
def test_arriving_is_judged_by_where_the_agent_stands(
    target: tuple[int, int, int], ok: bool
) -> None:
    model = Parrot(f"await goToPosition(bot, new Vec3{target}, 0);")
    outcome = run(model, probes=[probe(expect={"arrives": [2.5, 1, 2.5], "within": 1})])
    (result,) = outcome.probes
    assert result.ok is ok
    assert outcome.ok is ok
    assert result.arrived == pytest.approx((target[0] + 0.5, 1, target[2] + 0.5), abs=0.5)
    assert result.opened == ()
    assert outcome.reality.agents["bob"].position == (4.5, 1, 7.5)


def test_opening_is_judged_by_the_first_container() -> None:
    look = "await (await bot.openContainer(bot.blockAt(new Vec3{}))).close();"
    program = f"{look.format(RED)}\n{look.format(BLUE)}"
    outcome = run(Parrot(program), probes=[probe(expect={"opens": list(BLUE)})])
    assert outcome.probes[0].opened == (RED, BLUE)
    assert outcome.probes[0].ok is False
    outcome = run(Parrot(program), probes=[probe(expect={"opens": list(RED)})])
    assert outcome.probes[0].ok is True


def test_what_others_open_does_not_count() -> None:
    def opening(actor: str, place: tuple[int, int, int]) -> Event:
        return Event(EventKind.OPEN_CONTAINER, actor, {"position": place})

    events = [opening("ann", BLUE), opening("bob", RED), Event(EventKind.CHAT, "bob", {"text": ""})]
    assert opened_by("bob", events) == (RED,)


def test_a_probe_without_expectation_is_only_recorded() -> None:
    outcome = run(Parrot("await nowhere(bot);"), probes=[probe()])
    (result,) = outcome.probes
    assert result.ok is None
    assert not result.result.ok
    assert "nowhere" in str(result.result.error)
    assert outcome.ok


def test_a_model_gets_the_prompt_of_the_belief_and_how_to_answer() -> None:
    model = Parrot("await doNothing(bot);")
    outcome = run(model, probes=[probe(task="Fetch an apple.")])
    ((system, user),) = model.asked
    assert (system.role, user.role) == ("system", "user")
    assert "javascript" in system.text
    assert "Task: Fetch an apple." in user.text
    assert outcome.probes[0].prompt == user.text
    assert outcome.probes[0].program == model.program


def test_every_probe_starts_from_the_end_of_the_script() -> None:
    take = "await getItemFromChest(bot, new Vec3(1, 1, 5), {apple: 1});"
    look = "await (await bot.openContainer(bot.blockAt(new Vec3(1, 1, 5)))).close();"
    outcome = run(
        Parrot(take),
        script=[{"agent": "ann", "program": look}],
        probes=[probe(agent="ann", path="/ann", label="same")] * 2,
    )
    assert [result.result.ok for result in outcome.probes] == [True, True]
    assert len({result.branch for result in outcome.probes}) == 2
    assert outcome.state("/ann").containers[BLUE].items == {"apple": 1}


def test_a_template_beside_the_scenario_is_used(tmp_path: Path) -> None:
    (tmp_path / "short.txt").write_text("{{ branch.state.owner }}: {{ task }}", encoding="utf-8")
    text = """\
name: short
box: [[0, 0, 0], [4, 3, 4]]
agents: {ann: {position: [2.5, 1, 2.5]}}
probes:
  - {path: /ann, acts_in: /ann, agent: ann, task: Rest., template: short.txt}
"""
    (tmp_path / "short.yaml").write_text(text, encoding="utf-8")
    scenario = bn.Scenario.load(str(tmp_path / "short.yaml"))
    model = Parrot("await doNothing(bot);")
    with bn.Nest.open(scenario) as nest:
        run_scenario(nest, scenario, model, 0, 0.0, lambda what, done, total: None)
    assert model.asked[0][-1].text == "ann: Rest."
    (tmp_path / "short.yaml").write_text(text.replace("short.txt", "shirt.txt"), encoding="utf-8")
    with pytest.raises(
        bn.ScenarioError, match=r"short\.yaml:5: .*no template 'shirt\.txt'; .* story"
    ):
        bn.Scenario.load(str(tmp_path / "short.yaml"))


@pytest.mark.parametrize(
    ("expectation", "ok"),
    [
        ({"path": "/ann", "agent": "bob", "at": [4.5, 1, 7.5], "within": 0.5}, True),
        ({"path": "/ann", "agent": "bob", "at": [4.5, 1, 7.5], "within": 0}, True),
        ({"path": "/ann", "agent": "bob", "at": [4.5, 1, 5.5], "within": 0.5}, False),
        ({"path": "/", "container": list(BLUE), "items": {"apple": 1}}, True),
        ({"path": "/ann", "container": list(BLUE), "items": {"apple": 1}}, False),
        ({"path": "/ann", "container": list(BLUE), "items": {}}, True),
        ({"path": "/ann/ann/bob/", "container": list(RED), "items": {}}, True),
    ],
)
def test_expectations_are_held_against_the_belief(expectation: dict[str, Any], ok: bool) -> None:
    outcome = run(Parrot(""), expectations=[expectation])
    assert [each.ok for each in outcome.expectations] == [ok]
    assert outcome.ok is ok


def test_a_script_that_fails_ends_the_run() -> None:
    script = [{"label": "oops", "agent": "ann", "program": "\nawait bot.jumpOverTheMoon();"}]
    with pytest.raises(bn.ProgramError, match=r"step 1 \(oops\).*ann.*line 2"):
        run(Parrot(""), script=script)


def test_a_hole_that_names_no_parameter_is_told_with_the_error_of_the_program() -> None:
    content = {
        "name": "hole",
        "box": [[0, 0, 0], [4, 3, 4]],
        "parameters": {"item": {"default": "apple"}},
        "agents": {"ann": {"position": [2.5, 1, 2.5], "inventory": {"apple": 1}}},
        "script": [{"agent": "ann", "program": "await say(bot, `${itm}`, {);"}],
    }
    with (
        bn.Nest.open(bn.Scenario.from_mapping(content), "scripted") as nest,
        pytest.raises(bn.ProgramError, match=r"SyntaxError.*'\$\{itm\}' names no parameter"),
    ):
        nest.play()
