"""Files with the quick tests: most rules, and nothing that starts Node or takes long.

`pytest -m quick` reads only these files. A file belongs here while its tests take less than 0.1 s
of processor time on average and the whole stays below a minute on two processors.
"""

from pathlib import Path

import pytest

__all__ = ["add_quick", "is_left_out"]

QUICK = (
    *(f"tests/{room}/" for room in ("belief", "facts", "llm", "nest/explain", "skills")),
    *(f"tests/minds/test_{name}.py" for name in ("infer", "rules")),
    "tests/packaging/test_size.py",
    *(f"tests/perception/test_{name}.py" for name in ("percept", "sight")),
    *(f"tests/pictures/test_{name}.py" for name in ("figure", "plot")),
    *(f"tests/prompts/test_{name}.py" for name in ("builtin", "story")),
    *(
        f"tests/scenarios/test_{name}.py"
        for name in ("believed", "expected", "goals", "loading", "running")
    ),
    *(
        f"tests/semantics/test_{name}.py"
        for name in ("agents", "containers", "edits", "events", "hearing", "modes", "presence")
    ),
    *(f"tests/semantics/test_{name}.py" for name in ("priors", "sally_anne", "signs", "unique")),
    *(f"tests/studies/test_{name}.py" for name in ("counting", "sheets", "variation")),
    *(
        f"tests/timeline/test_{name}.py"
        for name in ("codec", "compare", "export", "journal", "trace")
    ),
    *(
        f"tests/world/test_{name}.py"
        for name in ("claims", "compression", "event_words", "registry", "terrain", "texts")
    ),
    *(f"tests/worlds/test_{name}.py" for name in ("double_chests", "same_deeds")),
    "tests/worlds/scripted/test_world.py",
)
"""Files, and folders with a slash at their end."""


def add_quick(item: pytest.Item) -> None:
    """Give the mark `quick` to a test of these files that runs by day."""
    if item.nodeid.startswith(QUICK) and not item.get_closest_marker("ci"):
        item.add_marker("quick")


def is_left_out(file: Path, config: pytest.Config) -> bool:
    """Return True if nobody asked for the tests of a file: only quick ones are wanted."""
    if config.getoption("markexpr") != "quick" or not file.name.startswith("test_"):
        return False
    return not file.relative_to(config.rootpath).as_posix().startswith(QUICK)
