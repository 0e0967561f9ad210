"""Script of a scenario, played in the real world step by step."""

from collections.abc import Callable, Iterable

from beliefnest.errors import BodyError, ProgramError
from beliefnest.nest.acting.engine import Engine
from beliefnest.nest.past.setting import Step
from beliefnest.timeline.journal import TimelineKey
from beliefnest.timeline.run_records import ProgramRecord
from beliefnest.timeline.store import Journal
from beliefnest.worlds.protocol import ProgramResult

OnProgress = Callable[[str, int, int], None]
"""Function of a description of the present step, the number of steps done, and of all steps."""


def play_script(engine: Engine, on_progress: OnProgress | None = None) -> None:
    """Play the script in the real world, from the first step that was not played.

    Raises:
        ProgramError: A program failed.
        BodyError: The process behind the world ended at every attempt of a step, or a bot failed
            without a fault of its program.
    """
    recording = engine.recording
    script = recording.setting.script
    programs = recording.records.programs()
    played = steps_played(recording.journal, recording.controller(()), programs)
    for number, step in enumerate(script[played:], start=played):
        if on_progress is not None:
            on_progress(step.label or f"step {number + 1}", number, len(script))
        with recording.turn:
            _play_step(engine, number, step)
    if on_progress is not None:
        on_progress("script played", len(script), len(script))


def steps_played(journal: Journal, key: TimelineKey, programs: Iterable[ProgramRecord]) -> int:
    """Return the number of steps of the script that lie in the past of a timeline's head.

    A step counts if its program failed, because it has happened. It does not count if nothing of it
    was kept.
    """
    ends = [
        (TimelineKey(program.path, program.branch), program.tick + program.ticks, program.step + 1)
        for program in programs
        if program.kept and program.step is not None
    ]
    played = 0
    for place, until in journal.lineage(key):
        reached = [count for on, end, count in ends if on == place and end <= until]
        played = max([played, *reached])
    return played


def _play_step(engine: Engine, number: int, step: Step) -> None:
    results = engine.run((), step.programs, step.timeout_ticks, number, step.senses)
    for agent, result in results.items():
        if not result.ok:
            label = f" ({step.label})" if step.label else ""
            where = f"{step.where}: " if step.where else ""
            # A bot fails, for example, if its connection is lost.
            by_bot = result.error is not None and result.error.kind == "bot"
            fault = BodyError if result.killed or by_bot else ProgramError
            raise fault(
                f"{where}step {number + 1}{label}: the program of {agent} failed: {result.error}"
                f"{_unfilled(step.programs[agent], result)}"
            )


def _unfilled(program: str, result: ProgramResult) -> str:
    """Return a hint if the program is no JavaScript because of a hole that nothing filled."""
    if result.error is None or result.error.kind != "syntax" or "${" not in program:
        return ""
    name = program.partition("${")[2].partition("}")[0]
    return f"; '${{{name}}}' names no parameter of the scenario"
