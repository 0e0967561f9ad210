"""Distribution of the tests among processes."""

from xdist.scheduler import LoadFileScheduling

__all__ = ["ByFile", "rank"]

_LONGEST = (
    "tests/worlds/minecraft/test_node_suite.py::test_javascript[test/tcp/",
    "tests/worlds/servers/test_realtime.py",
    "tests/worlds/minecraft/test_node_suite.py::test_javascript[test/long/",
    # In a new environment the first process compiles the kernels: others meanwhile test what needs
    # none, and find them compiled afterwards.
    "tests/worlds/minecraft/test_node_suite.py",
    "tests/worlds/servers/test_people.py",
    "tests/viewer/page/test_page.py",
    "tests/studies/participants/test_session.py",
    "tests/studies/test_models.py",
    "tests/studies/test_study.py",
    "tests/semantics/test_chunks.py",
    "tests/inspect/",
    "tests/cli/test_pictures.py",
    "tests/cli/test_run.py",
    "tests/nest/acting/test_lives.py",
    "tests/worlds/minecraft/test_percepts.py",
    "tests/semantics/test_against_reference.py",
    "tests/semantics/test_laws.py",
    "tests/worlds/",
    "tests/docs/",
    "tests/cli/",
    "tests/nest/",
    "tests/semantics/",
)
"""Long tests, by the beginnings of names: first those that wait, then those that compute."""

_APART = ("tests/worlds/minecraft/test_node_suite.py", "tests/semantics/test_against_reference.py")
"""Files whose tests have nothing in common, so that each may run anywhere."""


class ByFile(LoadFileScheduling):
    """A file's tests run in one process, since they share what is made for the file."""

    def _split_scope(self, nodeid: str) -> str:
        return nodeid if nodeid.startswith(_APART) else super()._split_scope(nodeid)


def rank(nodeid: str) -> int:
    """Return a test's rank in the order in which tests are begun, from 0."""
    ranks = (place for place, start in enumerate(_LONGEST) if nodeid.startswith(start))
    return next(ranks, len(_LONGEST))
