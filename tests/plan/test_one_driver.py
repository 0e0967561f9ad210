"""Everything that is played many times is a cell, and only the plan plays cells."""

import ast
from collections import defaultdict
from pathlib import Path

SOURCES = Path(__file__).parents[2] / "src" / "beliefnest"
PLAYERS = {
    # Functions that play once, and the cells that call them. An audit plays a story by other rules.
    "run_scenario": {"plan/scenario_cells.py"},
    "answer_story": {"suites/stories/cells.py", "suites/stories/audit.py"},
    "judge": {"suites/films/cells.py"},
    # One loop over cells, in one process, in several, or on a cluster.
    "Worker": {"plan/jobs.py", "plan/worker.py"},
    "ProcessPoolExecutor": {"plan/processes.py"},
    "Parallel": {"plan/jobs.py"},
    # One ledger, beside the times of cells.
    "SharedBudget": {"plan/terms.py"},
    "append_line": {"plan/spending.py", "studies/study_folder.py"},
    # Commands that play many: a run, a study, both played again, a suite, certificates.
    "run_cells": {
        *("cli/run.py", "studies/study.py", "studies/suite_playing.py"),
        *("cli/supplement.py", "studies/reproducing.py"),
        "studies/items/functional/certifying.py",
    },
}


def test_only_the_plan_plays_cells():
    callers = defaultdict(set)
    for module in SOURCES.rglob("*.py"):
        if "node_modules" not in module.parts:
            text = module.read_text(encoding="utf-8")
            # Parsing all modules takes seconds.
            for node in ast.walk(ast.parse(text)) if any(name in text for name in PLAYERS) else ():
                match node:
                    case ast.Call(func=ast.Name(id=name)) if name in PLAYERS:
                        callers[name].add(module.relative_to(SOURCES).as_posix())
    assert {name: callers[name] for name in PLAYERS} == PLAYERS
