"""The table of promises names tests that exist."""

import re
from pathlib import Path

TOP = Path(__file__).parents[2]
NODE = TOP / "src" / "beliefnest" / "worlds" / "minecraft" / "node"
NAMED = re.compile(r"`((?:tests?/)?[\w./-]+\.(?:test\.js|py))`")


def test_every_file_that_security_names_exists() -> None:
    named = set(NAMED.findall((TOP / "SECURITY.md").read_text(encoding="utf-8")))
    assert len(named) > 10
    known = [
        path
        for top in (TOP / "tests", NODE / "test")
        for path in top.rglob("*")
        if "test" in path.name
    ]
    known += (TOP / "src").rglob("*.py")
    missing = {
        name
        for name in named
        if not (TOP / name).is_file()
        and not any(path.as_posix().endswith(f"/{name}") for path in known)
    }
    assert not missing
