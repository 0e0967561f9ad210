"""`beliefnest play --baselines`: a table of tasks by policies, and its Markdown page."""

from collections.abc import Mapping, Sequence
from datetime import date
from functools import partial
from pathlib import Path
from typing import Any

import msgspec

from beliefnest.cli.console import print_report, result_table
from beliefnest.cli.options import PlayOptions
from beliefnest.cli.playing import playing
from beliefnest.episodes.episode import Episode
from beliefnest.episodes.shortcuts import policy_of, rules_of, trained_rule
from beliefnest.episodes.task import Task
from beliefnest.episodes.tasks import parameters_of, source_of
from beliefnest.errors import InputError, ModelError
from beliefnest.files import replace_file, replacing
from beliefnest.studies.accuracy_figure import plot_accuracy
from beliefnest.studies.study import Study
from beliefnest.version import VERSION

_POLICIES_OF: Mapping[bool, tuple[tuple[str, ...], tuple[int, ...]]] = {
    True: (("random", "search", "omniscient:search"), (0, 1, 2)),
    False: (("random", "search", "infer", "omniscient:search"), (0, 1)),
}
"""Policies and orders of the players, by whether goals are known; all others follow the script."""
_BY = ("task", "needs", "policy")
_TRAINED, _TRAINING = 10_000, 6
"""First instance on which linear rules are tried, apart from those of the table; their number."""
_SHORTCUT = 0.5
"""Success above which a rule without beliefs is a shortcut, if its whole interval lies above."""

_COLUMNS = ("task", "order", "policy", "success", "95 %", "ticks", "messages", "false beliefs")

_INCHES = 12.0, 3.2
"""Size of the figure: as wide as a page can show it with readable text."""

Group = Mapping[str, Any]
"""A row of a study's summary."""


class PlayedTask(msgspec.Struct, frozen=True):
    """Baselines of a task.

    Attributes:
        task: Its first instance.
        plain: Rows of policies that are no rules.
        ruled: Rows of rules without beliefs, by rule.
        chance: The rule that draws.
    """

    task: Task
    plain: Sequence[Group]
    ruled: Mapping[str, Group]
    chance: str

    @property
    def groups(self) -> list[Group]:
        """Return all rows."""
        return [*self.plain, *self.ruled.values()]

    @property
    def is_as_claimed(self) -> bool:
        """Return True if the task needs exactly the order that it states, and no rule wins it."""
        hides_goals = not self.task.form.goals_known
        # A task without instances has one only, which a rule wins or not.
        is_single = self.task.seed is None
        return all(_is_as_claimed(each, hides_goals) for each in self.plain) and not any(
            _is_shortcut(each, is_single=is_single) for each in self.ruled.values()
        )


def run_baselines(options: PlayOptions) -> int:
    """Play the baselines, print the table, and write the page.

    Returns:
        Exit status: 0 if every task needs exactly the order that it states, else 1. A task needs
        order n if `search:n` reaches the goal in all episodes and `search:n-1` in none.
        If goals are hidden, `infer:n` reaches it in all, and `search:n` not in all. No rule
        without beliefs may reach it in clearly more than half of the episodes.

    Raises:
        BeliefNestError: The input is wrong, or episodes have no result.
    """
    if options.seeds < 1:
        raise InputError(f"--seeds is {options.seeds}; give at least 1")
    for option in ("agent", "set", "condition", "rounds"):
        if getattr(options, option) is not None:
            raise InputError(
                f"--{option} has no effect on --baselines; leave it out, or run a study"
            )
    names = Task.names() if options.task is None else (options.task,)
    if options.page is not None and not set(names) <= set(Task.names()):
        raise InputError(f"--page is for built-in tasks, and {options.task} is none; leave it out")
    played = [_played(name, options) for name in names]
    groups = [group for each in played for group in each.groups]
    if options.page is not None:
        _draw(played, options.page.parent / "img")
        replace_file(options.page, page_of(played, options.seeds))
    table = result_table(*_COLUMNS, title="baselines")
    for each in groups:
        table.add_row(*_cells(each))
    content = {"seeds": options.seeds, "baselines": groups}
    print_report(content, [table], as_json=options.json)
    return 0 if all(each.is_as_claimed for each in played) else 1


def _played(name: str, options: PlayOptions) -> PlayedTask:
    task, last = Task.load(name), _TRAINED + min(_TRAINING, options.seeds)
    trained = trained_rule(partial(Task.load, name), range(_TRAINED, last))
    policies, orders = _POLICIES_OF[task.form.goals_known]
    *keys, chance = rules_of(task)
    rules = {policy_of(rule): rule for rule in (*keys, chance, trained)}
    study = Study(tasks=[name], policies=(*policies, *rules), orders=orders, seeds=options.seeds)
    groups = _summary(study, options, task.name)
    ruled = {rules[each["policy"]]: each for each in groups if each["policy"] in rules}
    plain = [each for each in groups if each["policy"] not in rules]
    return PlayedTask(task, plain, ruled, chance)


def _summary(study: Study, options: PlayOptions, part: str) -> list[dict[str, Any]]:
    """Return the summary of one study, in a folder of its own."""
    own = None if options.out is None else options.out / part
    with playing("baselines", own) as (folder, on_progress):
        result = study.run(folder, options.jobs, on_progress=on_progress)
        failed = [row["why_not"] for row in result.rows if row["outcome"] == "error"]
        if failed:
            raise ModelError(f"{len(failed)} episodes have no result; the first: {failed[0]}")
        return result.counted(_BY)


def page_of(played: Sequence[PlayedTask], seeds: int) -> str:
    """Return the page about the tasks, as Markdown."""
    lines = [
        "# Tasks",
        "",
        f"{len(played)} built-in tasks for agents that act round after round"
        " ([episodes](episodes.md)).",
        "Each instance comes from a seed. Tests check that `search` solves a task with the order",
        "that the task needs, and does not solve it with one order less. If goals are hidden,",
        "`infer` of that order solves the task; `search` succeeds only by chance.",
        f"`beliefnest play --baselines --seeds {seeds} --page docs/tasks.md` writes this page.",
        "",
        f"The table shows {seeds} seeds in the scripted world, with BeliefNest {VERSION}, on",
        f"{date.today()}. Agents without a policy follow the task's script. Success has a 95 %",
        "Wilson interval. Ticks are the mean over successful episodes. Messages (of players) and",
        "false beliefs (of all agents, over the rounds) are means over all episodes. Intervals of",
        "means are 95 % bootstrap intervals.",
        "",
        "![Success by task and policy, with intervals](img/baselines.png)",
        "",
        f"| {' | '.join(_COLUMNS)} |",
        "|" + "---|" * len(_COLUMNS),
        *(f"| {' | '.join(_cells(each))} |" for row in played for each in row.plain),
        "",
        "## Rules without beliefs",
        "",
        "A task that needs Theory of Mind must not be won by a rule that reads no belief about",
        "others. A [rule](episodes.md#policies) takes the nearest place, the farthest one from an",
        "agent, the first, the last, the one looked at last, goes where its partner goes, says one",
        "true thing or all of them and then acts as `search:0` does, or is linear over the",
        f"features of places (the best of 16 on {_TRAINING} other instances). Chance is the rule",
        "that draws among the same places. Numbers are instances won; intervals are as above.",
        "",
        "| task | chance | best rule | success | others |",
        "|---|---|---|---|---|",
        *map(_rule_line, played),
    ]
    for each in played:
        name, task = each.task.name, each.task
        first, _, rest = source_of(name).partition("\n\n")
        sizes = ", ".join(
            f"`{key}` {low} to {high} ({default})"
            for key, (default, low, high) in parameters_of(name).items()
        )
        lines += ["", f"## {name}", "", f"**{first}**", "", rest, ""]
        goals = "" if task.form.goals_known else " Goals are hidden."
        lines += [f"Order {task.order}.{goals} Sizes: {sizes}.", ""]
        lines += [f"`beliefnest play {name}`", "", f"![An instance of {name}](img/task-{name}.png)"]
    return "\n".join(lines) + "\n"


def _draw(played: Sequence[PlayedTask], folder: Path) -> None:
    folder.mkdir(exist_ok=True)
    plain = [group for each in played for group in each.plain]
    figure = plot_accuracy(plain, ("task", "policy"))
    figure.set_size_inches(*_INCHES)
    with replacing(folder / "baselines.png") as out:
        figure.savefig(out, format="png", dpi=150)
    for each in played:
        with Episode(each.task) as episode:
            episode.nest.figure(["/"]).save(str(folder / f"task-{each.task.name}.png"))


def _cells(group: Group) -> tuple[str, ...]:
    interval = f"{group['low']:.2f} to {group['high']:.2f}"
    means = [_mean(group, name) for name in ("ticks", "messages", "false_beliefs_mean")]
    rate = f"{group['right']}/{group['judged']}"
    return (group["task"], str(group["needs"]), group["policy"], rate, interval, *means)


def _mean(group: Group, name: str) -> str:
    mean, low, high = (group[f"{name}{end}"] for end in ("", "_low", "_high"))
    if mean is None:
        return ""
    return f"{mean:.1f}" if low is None else f"{mean:.1f} ({low:.1f} to {high:.1f})"


def _is_as_claimed(group: Group, hides_goals: bool) -> bool:
    needs, is_solved = group["needs"], bool(group["right"] == group["judged"])
    if hides_goals:
        if group["policy"] == f"search:{needs}":
            return not is_solved
        return is_solved or group["policy"] != f"infer:{needs}"
    if group["policy"] == f"search:{needs}":
        return is_solved
    return bool(group["policy"] != f"search:{needs - 1}" or group["right"] == 0)


def _is_shortcut(group: Group, *, is_single: bool) -> bool:
    """Return True if a rule without beliefs wins clearly more than half of the instances."""
    if is_single:
        return bool(group["needs"] and group["right"] == group["judged"])
    return bool(group["low"] > _SHORTCUT)


def _rule_line(played: PlayedTask) -> str:
    """Return the line of a task about rules without beliefs: chance, and the best rules."""
    level = played.ruled[played.chance]
    ranked = sorted(played.ruled.items(), key=lambda each: -each[1]["right"])
    _, best = ranked[0]
    others = ", ".join(f"`{rule}` {row['right']}" for rule, row in ranked[1:])
    cells = (played.task.name, _rate(level), f"`{best['policy']}`", _rate(best), others)
    return f"| {' | '.join(cells)} |"


def _rate(group: Group) -> str:
    return f"{group['right']}/{group['judged']} ({group['low']:.2f} to {group['high']:.2f})"
