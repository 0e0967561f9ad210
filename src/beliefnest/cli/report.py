"""What a run reports: the object that `--json` prints, and the table."""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from rich import box
from rich.markup import escape
from rich.table import Table

from beliefnest.belief.entries import Basis
from beliefnest.belief.view import State
from beliefnest.cli.pictures import container_name, point_text
from beliefnest.cli.text import printable
from beliefnest.llm.messages import Usage
from beliefnest.scenarios.content import Arrives, Hears, Holds, Opens
from beliefnest.scenarios.judging import places_of
from beliefnest.scenarios.outcome import ExpectationOutcome, Outcome, ProbeOutcome
from beliefnest.scenarios.scenario import Scenario
from beliefnest.world.values import Point, Position

__all__ = [
    "belief_json",
    "cost_text",
    "outcome_json",
    "outcome_table",
    "place_key",
    "report_json",
    "state_json",
    "usage_json",
]

_WIDEST = 6


def state_json(state: State) -> dict[str, object]:
    """A state as the STATE object of the public surface."""
    return {
        "containers": {
            place_key(place): {
                "items": dict(sorted(container.items.items())),
                "complete": container.complete,
            }
            for place, container in sorted(state.containers.items())
        },
        "agents": {
            name: {"position": _list(agent.position), "current": agent.current}
            for name, agent in sorted(state.agents.items())
        },
        "chat": [list(line) for line in state.chat],
        "addressees": list(state.addressees),
    }


def belief_json(state: State) -> dict[str, object]:
    """All of a state but its blocks: what `state_json` has, and what it rests on."""
    return {
        **state_json(state),
        "containers": {
            place_key(place): {
                "items": dict(sorted(container.items.items())),
                "complete": container.complete,
                "current": container.current,
                **_basis_json(container.basis),
            }
            for place, container in sorted(state.containers.items())
        },
        "agents": {
            name: {
                "position": _list(agent.position),
                "yaw": agent.yaw,
                "pitch": agent.pitch,
                "current": agent.current,
                **_basis_json(agent.basis),
                "equipment": agent.equipment and dict(sorted(agent.equipment.items())),
                "inventory": dict(sorted(agent.inventory.items())),
                "inventory_complete": agent.inventory_complete,
            }
            for name, agent in sorted(state.agents.items())
        },
        "thoughts": [list(line) for line in state.thoughts],
    }


def place_key(place: Position) -> str:
    """A block's position as the key of a JSON object."""
    return ",".join(map(str, place))


def _basis_json(basis: Basis | None) -> dict[str, object]:
    if basis is None:
        return {"observed_at": None, "source": None}
    return {"observed_at": basis.observed_at, "source": basis.source.value}


def outcome_json(
    outcome: Outcome, model: str, run_dir: Path, accounts: Sequence[Mapping[str, object]] = ()
) -> dict[str, object]:
    """What came of one condition.

    Args:
        outcome: What came of it.
        model: Who answered.
        run_dir: Its folder.
        accounts: Further facts of each probe.
    """
    probes = [_probe_json(each) for each in outcome.probes]
    for probe, account in zip(probes, accounts, strict=False):
        probe.update(account)
    return {
        "condition": outcome.scenario.condition,
        "model": model,
        "seed": outcome.seed,
        "ok": outcome.ok,
        "ticks": outcome.ticks,
        "seconds": round(outcome.seconds, 3),
        "reality": state_json(outcome.reality),
        "beliefs": {path: state_json(state) for path, state in outcome.beliefs.items()},
        "expectations": [_expectation_json(each) for each in outcome.expectations],
        "probes": probes,
        "usage": usage_json(outcome.usage),
        "run_dir": str(run_dir),
    }


def usage_json(usage: Usage) -> dict[str, object]:
    """What answers took."""
    return {
        "requests": usage.requests,
        "input_tokens": usage.input_tokens,
        "output_tokens": usage.output_tokens,
        "cost": usage.cost,
    }


def report_json(
    scenario: str,
    settings: Mapping[str, object],
    status: str,
    runs: Iterable[Mapping[str, object]],
    failures: Iterable[Mapping[str, object]],
) -> dict[str, object]:
    """The whole report.

    Args:
        scenario: Its name.
        settings: What was asked for, `world` and `models` among it.
        status: `running`, `done`, `failed` or `interrupted`.
        runs: What came of each condition, as `outcome_json`.
        failures: What has no result because a model failed, and why.
    """
    models = settings["models"]
    assert isinstance(models, Sequence)
    return {
        "scenario": scenario,
        "world": settings["world"],
        "model": ",".join(models),
        "status": status,
        "settings": settings,
        "runs": list(runs),
        "failures": list(failures),
    }


def outcome_table(outcomes: Sequence[Outcome]) -> Table:
    """What is where, what was predicted, whether it is as expected, in each condition.

    One row for each condition, or one column where there is too much to tell for a row.
    """
    if len(_headings(outcomes)) > _WIDEST:
        return _tall_table(outcomes)
    scenario = outcomes[0].scenario
    table = Table(title=scenario.name, title_justify="left", box=box.SIMPLE_HEAVY)
    if scenario.conditions:
        table.add_column("condition", justify="right")
    for heading in _headings(outcomes):
        table.add_column(heading)
    table.add_column(f"as {scenario.reported_by or 'expected'}{_verb(scenario)}")
    asked = any(outcome.usage.requests for outcome in outcomes)
    for heading in ("tokens", "cost") if asked else ():
        table.add_column(heading, justify="right")
    table.add_column("ticks", justify="right")
    table.add_column("seconds", justify="right")
    for outcome in outcomes:
        row = [str(outcome.scenario.condition)] if scenario.conditions else []
        cells = _cells(outcome)
        row += [cells.get(heading, "") for heading in _headings(outcomes)]
        verdict = "[green]yes[/green]" if outcome.ok else "[bold red]NO[/bold red]"
        spent = [f"{outcome.usage.tokens:,}", cost_text(outcome.usage.cost)] if asked else []
        table.add_row(*row, verdict, *spent, str(outcome.ticks), f"{outcome.seconds:.2f}")
    return table


def _tall_table(outcomes: Sequence[Outcome]) -> Table:
    scenario = outcomes[0].scenario
    table = Table(title=scenario.name, title_justify="left", box=box.SIMPLE_HEAVY)
    table.add_column("condition" if scenario.conditions else "")
    for outcome in outcomes:
        number = outcome.scenario.condition
        table.add_column("" if number is None else str(number))
    cells = [_cells(outcome) for outcome in outcomes]
    for heading in _headings(outcomes):
        table.add_row(heading, *(each.get(heading, "") for each in cells))
    verdicts = ["[green]yes[/green]" if each.ok else "[bold red]NO[/bold red]" for each in outcomes]
    table.add_row(f"as {scenario.reported_by or 'expected'}{_verb(scenario)}", *verdicts)
    if any(outcome.usage.requests for outcome in outcomes):
        table.add_row("tokens", *(f"{each.usage.tokens:,}" for each in outcomes))
        table.add_row("cost", *(cost_text(each.usage.cost) for each in outcomes))
    table.add_row("ticks", *(str(each.ticks) for each in outcomes))
    table.add_row("seconds", *(f"{each.seconds:.2f}" for each in outcomes))
    return table


def cost_text(cost: float | None) -> str:
    """US dollars for people."""
    return "not known" if cost is None else f"${cost:.4f}"


def _verb(scenario: Scenario) -> str:
    return " reports" if scenario.reported_by else ""


def _headings(outcomes: Iterable[Outcome]) -> list[str]:
    return list(dict.fromkeys(heading for outcome in outcomes for heading in _cells(outcome)))


def _cells(outcome: Outcome) -> dict[str, str]:
    """Heading to text, for everything that is expected or asked."""
    cells: dict[str, list[str]] = {}
    for each in outcome.expectations:
        state = outcome.state(each.expectation.path)
        heading, text = _found(each, state, outcome.scenario)
        cells.setdefault(heading, []).append(text)
    for probe in outcome.probes:
        heading, text = _acted(probe, outcome.scenario)
        if len(outcome.probes) > 1 and probe.probe.label:
            text = f"{escape(printable(probe.probe.label))}: {text}"
        cells.setdefault(heading, []).append(text)
    return {heading: "\n".join(lines) for heading, lines in cells.items()}


def _found(outcome: ExpectationOutcome, state: State, scenario: Scenario) -> tuple[str, str]:
    content = outcome.expectation.content
    if isinstance(content, Holds) and content.items:
        names = [
            escape(container_name(place, scenario)) for place in places_of(content.items, state)
        ]
        what, found = ", ".join(content.items), " and ".join(names) or "nowhere"
    elif isinstance(content, Holds):
        held = state.containers.get(content.container)
        what, found = escape(container_name(content.container, scenario)), "nothing"
        if held is not None and held.items:
            found = ", ".join(f"{count} {name}" for name, count in sorted(held.items.items()))
    elif isinstance(content, Hears):
        heard = any(content.text in text for _, _, text in state.chat)
        what, found = f"{content.text!r}", "heard" if heard else "not heard"
    else:
        position = state.agents[content.agent].position
        what, found = content.agent, "unknown" if position is None else point_text(position)
    path = outcome.expectation.path
    return f"{what} in {'reality' if path == '/' else path}", _marked(found, outcome.ok)


def _acted(outcome: ProbeOutcome, scenario: Scenario) -> tuple[str, str]:
    probe = outcome.probe
    if isinstance(probe.expect, Arrives):
        where = "nowhere" if outcome.arrived is None else point_text(outcome.arrived)
        return f"predicted {probe.agent} arrives at", _marked(where, outcome.ok)
    opened = escape(container_name(outcome.opened[0], scenario)) if outcome.opened else "nothing"
    heading = f"predicted {probe.agent} opens"
    if isinstance(probe.expect, Opens):
        return heading, _marked(opened, outcome.ok)
    return heading, opened


def _marked(text: str, ok: bool | None) -> str:
    return text if ok is not False else f"[bold red]{text}[/bold red]"


def _list(point: Point | None) -> list[float] | None:
    return None if point is None else list(point)


def _expectation_json(outcome: ExpectationOutcome) -> dict[str, object]:
    expectation = outcome.expectation
    content = expectation.content
    expected: dict[str, object]
    if isinstance(content, Holds):
        expected = {"container": list(content.container), "items": dict(content.items)}
    elif isinstance(content, Hears):
        expected = {"heard" if content.ever else "not_heard": content.text}
    else:
        expected = {"agent": content.agent, "position": _list(content.place)}
    return {
        "path": expectation.path,
        "label": expectation.label,
        "expected": expected,
        "ok": outcome.ok,
    }


def _probe_json(outcome: ProbeOutcome) -> dict[str, object]:
    probe = outcome.probe
    expected: dict[str, object] | None = None
    if isinstance(probe.expect, Opens):
        expected = {"opens": list(probe.expect.container)}
    elif isinstance(probe.expect, Arrives):
        expected = {"arrives": list(probe.expect.place), "within": probe.expect.within}
    return {
        "label": probe.label,
        "path": probe.path,
        "acts_in": probe.acts_in,
        "agent": probe.agent,
        "task": probe.task,
        "program": outcome.program,
        "attempts": outcome.attempts,
        "usage": usage_json(outcome.usage),
        "error": None if outcome.result.error is None else str(outcome.result.error),
        "said": [list(line) for line in outcome.result.said],
        "lines": list(outcome.result.lines),
        "log": list(outcome.result.log),
        "unfinished": [str(each) for each in outcome.result.unfinished],
        "branch": outcome.branch,
        "opened": [list(place) for place in outcome.opened],
        "arrived": _list(outcome.arrived),
        "expected": expected,
        "ok": outcome.ok,
    }
