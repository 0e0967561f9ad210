"""Coverage-guided search for inputs that a reader does not refuse well.

Run `python -m tests.hostile.fuzz`. It needs Atheris, which has wheels for some systems only and is
no dependency: pip install atheris. Each reader of `test_readers.py` is tried for some seconds. An
input that raises anything but an error of the package is written into the current folder, and the
search ends with status 1.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

__all__ = ["main"]

_SECONDS = 120
_READING = ("beliefnest.files", "beliefnest.scenarios", "beliefnest.timeline", "ruamel.yaml")
"""Packages whose branches guide the search; to instrument all takes minutes."""


def main(arguments: list[str]) -> int:
    """Fuzz all readers, each in a process of its own, or the one that is named."""
    if arguments:
        _fuzz(arguments[0], int(arguments[1]))
        return 0
    from tests.hostile.test_readers import READERS

    failed = [
        name
        for name in READERS
        if subprocess.run(
            [sys.executable, "-m", "tests.hostile.fuzz", name, str(_SECONDS)], check=False
        ).returncode
    ]
    sys.stderr.write(f"failed: {', '.join(failed) or 'none'}\n")
    return 1 if failed else 0


def _fuzz(name: str, seconds: int) -> None:
    import atheris

    with atheris.instrument_imports(include=list(_READING)):
        from tests.hostile.test_readers import READERS

        from beliefnest.errors import BeliefNestError
    file, sound, read = READERS[name]
    with tempfile.TemporaryDirectory() as scratch:
        path, corpus = Path(scratch) / file, Path(scratch) / "corpus"
        corpus.mkdir()
        (corpus / "sound").write_bytes(sound)

        def once(content: bytes) -> None:
            path.write_bytes(content)
            try:
                read(path)
            except BeliefNestError:
                return

        limits = [f"-max_total_time={seconds}", "-timeout=10", "-rss_limit_mb=1500"]
        found = f"-artifact_prefix=hostile-{name.replace(' ', '-')}-"
        atheris.Setup([sys.argv[0], str(corpus), *limits, found], once)
        atheris.Fuzz()


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
