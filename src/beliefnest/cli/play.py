"""`beliefnest play`: play a task with policies, round after round."""

import json
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import Any

from rich.text import Text

from beliefnest.cli.console import Printed, print_report, progress_on, result_table
from beliefnest.cli.options import PlayOptions, joining_address
from beliefnest.cli.terminal_text import printable, say
from beliefnest.episodes.considered import considered_lines
from beliefnest.episodes.episode import Episode, play_through
from beliefnest.episodes.helping import Help
from beliefnest.episodes.policies import with_query
from beliefnest.episodes.record import Budget
from beliefnest.episodes.task import Task
from beliefnest.episodes.telling import told_episode
from beliefnest.errors import InputError, ModelError, NotBegunError
from beliefnest.files import new_file
from beliefnest.llm.model_settings import query_of
from beliefnest.locking import holding
from beliefnest.scenarios.judging import unanswered_words
from beliefnest.studies.file import naming_other_kinds
from beliefnest.world.words import counted
from beliefnest.worlds.names import check_world

_RUN = "run.bn"


def play_task(options: PlayOptions) -> int:
    """Play, record and print an episode.

    Returns:
        Exit status: 0 if the goal was reached, else 1.

    Raises:
        BeliefNestError: The input is wrong, or a world or model failed. An episode in which a
            model failed is printed first.
    """
    if options.task is None:
        raise InputError(f"name a task: {', '.join(Task.names())}, or a file")
    check_world(options.world, servers=False)
    query = query_of(options.system, options.requests)
    named = _pairs(options.agent or (), "--agent", "NAME=POLICY")
    texts = _pairs(options.set or (), "--set", "NAME=VALUE")
    parameters = {name: _value(text) for name, text in texts.items()}
    with naming_other_kinds(options.task):
        task = Task.load(options.task, options.seed, condition=options.condition, **parameters)
    policies = {
        agent: with_query(policy, query)
        for agent, policy in {**task.form.policies, **named}.items()
    }
    if options.export is not None:
        return _export(task, options.export)
    with (
        nullcontext() if options.out is None else holding(options.out),
        _episode(task, policies, options) as episode,
        progress_on(task.name) as on_progress,
    ):
        play_through(episode, on_progress, rounds=options.rounds, measure_help=options.measure_help)
        report = _report(episode, options)
        lost = episode.model_errors
    print_report(report, _parts(report), as_json=options.json)
    if lost:
        raise ModelError(f"a model did not answer in {counted(len(lost), 'round')}: {lost[0]}")
    return 0 if report["success"] else 1


def _export(task: Task, file: Path) -> int:
    """Write a task as a scenario file, which must be new."""
    with new_file(file) as out:
        out.write(task.text().encode())
    say(f"wrote {file}; play it with `beliefnest play {file}`\n")
    return 0


def _episode(task: Task, policies: Mapping[str, str], options: PlayOptions) -> Episode:
    """Return the episode; if the folder holds its beginning, continue from there."""
    budget = Budget(options.max_ticks, options.max_tokens, options.max_cost)
    asked = Episode(
        task,
        policies,
        world=options.world,
        store=None if options.out is None else options.out / _RUN,
        seed=options.seed,
        budget=budget,
        patience_s=options.patience,
        listen=joining_address(options.listen),
    )
    if options.out is None or not (options.out / _RUN).exists():
        return asked
    try:
        kept = Episode.resume(
            options.out / _RUN,
            budget=budget if budget != Budget() else None,
            patience_s=options.patience,
        )
    except NotBegunError:
        # The episode was stopped before its first entry: the file holds nothing yet.
        for left in options.out.glob(f"{_RUN}*"):
            left.unlink()
        return asked
    for what, of_asked, of_held in (
        ("task", asked.task.name, kept.task.name),
        ("seed", asked.seed, kept.seed),
        ("world", asked.world, kept.world),
        ("instance", asked.task.plain(), kept.task.plain()),
        ("policies", _told(asked.policies), _told(kept.policies)),
    ):
        if of_asked != of_held:
            kept.close()
            other = "another one" if isinstance(of_held, dict) else of_held
            verb = "are" if what == "policies" else "is"
            raise InputError(
                f"{options.out} holds an episode whose {what} {verb} {other}; give the same to "
                "continue it, or name another folder"
            )
    return kept


def _pairs(texts: Sequence[str], option: str, form: str) -> dict[str, str]:
    pairs = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if not equals or not name or not value:
            raise InputError(f"{option} is {text!r}; write {form}")
        if name in pairs:
            raise InputError(f"{option} names {name!r} twice; name it once")
        pairs[name] = value
    return pairs


def _value(text: str) -> Any:
    """Return the value of a parameter: JSON if the text is JSON, else the text."""
    try:
        return json.loads(text)
    except (ValueError, RecursionError):
        return text


def _told(policies: Mapping[str, str]) -> str:
    return ", ".join(f"{agent}={policy}" for agent, policy in policies.items())


def _report(episode: Episode, options: PlayOptions) -> dict[str, Any]:
    episode_report = told_episode(episode.nest)
    assert episode_report is not None
    branch = episode_report["branches"][episode.branch]
    report: dict[str, Any] = {
        "task": episode.task.name,
        "world": episode.world,
        "success": episode.success,
        "why_not": episode.why_not,
        "start": episode_report["start"],
        "goal": [
            {"condition": text, "never": never, "tick": tick}
            for text, never, tick in branch["goal"]
        ],
        "measures": episode.measures.row(),
        "rounds": [
            {
                "round": part["round"] + 1,
                "tick": part["t"],
                "agents": {
                    done["agent"]: {
                        "program": done["program"],
                        "fault": done["fault"],
                        "outcome": done["outcome"],
                        "ended": done["ended"] or "none",
                        "reason": done["reason"],
                        **({"considered": done["considered"]} if options.explain else {}),
                    }
                    for done in part["agents"]
                },
            }
            for part in branch["parts"]
        ],
    }
    if options.measure_help:
        report["help"] = _help(episode.help())
    return report


def _help(help_report: Help) -> dict[str, Any]:
    return {
        "needed": list(help_report.needed),
        "given": list(help_report.given),
        "acts": [
            {
                "agent": act.agent,
                "rounds": [act.first + 1, act.last + 1],
                "helped": list(act.helped),
                "worse": list(act.worse),
            }
            for act in help_report.acts
        ],
    }


def _parts(report: Mapping[str, Any]) -> Iterator[Printed]:
    headings = ("round", "agent", "program", "ended")
    table = result_table(*headings, title=report["task"], right=("round",))
    for part in report["rounds"]:
        for agent, turn in part["agents"].items():
            ended = (turn["outcome"] or turn["ended"]).replace("_", " ")
            cells = (str(part["round"]), agent, turn["program"].strip(), ended)
            table.add_row(*(Text(printable(cell)) for cell in cells))
    yield table
    yield from _considered_lines(report["rounds"])
    yield from (f"failed in {failure}" for failure in report["measures"]["failures"])
    yield from _asked_lines(report["measures"])
    yield from map(_goal_line, report["goal"])
    if "help" in report:
        yield from _help_lines(report["help"], report["measures"])
    if report["why_not"]:
        yield f"why not: {report['why_not']}"
    measures = report["measures"]
    verdict = "reached" if report["success"] else "not reached"
    # Conditions have ticks of the world; the ticks of the goal count from the first round.
    start = f" of play, which began at tick {report['start']}" if report["start"] else ""
    yield (
        f"goal {verdict} after {counted(measures['ticks'], 'tick')}{start}, "
        f"{counted(measures['rounds'], 'round')}, {counted(measures['messages'], 'message')}"
    )


def _considered_lines(rounds: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """Yield the courses that policies considered, round by round, as far as they are reported.

    If an agent considered the same as in its round before, the line only names that round.
    """
    latest: dict[str, tuple[int, object]] = {}
    for part in rounds:
        for agent, turn in part["agents"].items():
            considered = turn.get("considered")
            if considered is None:
                continue
            first, before = latest.get(agent, (0, None))
            if considered == before:
                yield f"round {part['round']}, {agent} considered the same as in round {first}"
                continue
            latest[agent] = part["round"], considered
            yield f"round {part['round']}, {agent} tried {counted(considered['tried'], 'course')}"
            yield from (f"  {line}" for line in considered_lines(considered))


def _asked_lines(measures: Mapping[str, Any]) -> Iterator[str]:
    """Yield lines about models' answers without a program, if there were any."""
    reasons = unanswered_words(Counter(measures["not_answered"]))
    if reasons:
        yield f"rounds without a program of a model: {reasons}"
    if measures["asked_again"]:
        yield f"models were asked again {counted(measures['asked_again'], 'time')}"


def _goal_line(condition: Mapping[str, Any]) -> str:
    when = "at no tick" if condition["tick"] is None else f"at tick {condition['tick']}"
    kind = "not to be: " if condition["never"] else ""
    return f"{kind}{condition['condition']}: {when}"


def _help_lines(help_report: Mapping[str, Any], measures: Mapping[str, Any]) -> list[str]:
    """Return a line for each agent that needed help, and for each help that was given."""
    needed, givers = (", ".join(help_report[key]) or "nobody" for key in ("needed", "given"))
    lines = [
        f"help: needed by {needed}; given to {givers}; superfluous: {measures['help_superfluous']} "
        f"of {counted(len(help_report['acts']), 'program')} in which something was said or given"
    ]
    for act in help_report["acts"]:
        first, last = act["rounds"]
        when = f"round {first}" if first == last else f"rounds {first} to {last}"
        does = f"helped {', '.join(act['helped'])}" if act["helped"] else "helped nobody else"
        lines.append(f"  {act['agent']} in {when}: {does}")
    return lines
