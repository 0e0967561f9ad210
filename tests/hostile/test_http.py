"""Hostile requests to the two servers: each is answered, none stops the server or writes a file."""

import http.client
import json
import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from tests.processes import started
from tests.profiles import at_night

import beliefnest as bn

SCENE = """\
name: rooms
map:
  legend: {"#": bricks, a: {agent: ann}}
  floors: |
    #####
    #a..#
    #####
"""
JSON = {"Content-Type": "application/json"}
DEEP = b'{"text": ' + b"[" * 100_000 + b"]" * 100_000 + b"}"
BODIES = (
    *(b"", b"{", b"null", b"[1]", b'"x"', b"\xff\xfe", b"NaN", DEEP, b"9" * 5000),
    *(b'{"text": 1}', b'{"text": null}', b'{"text": "\\ud800"}', b'{"text": ["a"]}'),
    *(json.dumps({"text": text}).encode() for text in ("", "name: [", "&a [*a]", "x: !!int a")),
    *(
        json.dumps({"text": SCENE, **more}).encode()
        for more in (
            {"edits": 3},
            {"edits": [3]},
            {"edits": [{"do": "put"}]},
            {"edits": [{"do": ["put"], "at": [1, 1, 1]}]},
            {"edits": [{"do": "put", "at": [1e308, 1, 1], "thing": "stone"}]},
            {"edits": [{"do": "put", "at": [2**70, 1, 1], "thing": "stone"}]},
            {"edits": [{"do": "put", "at": {}, "thing": []}]},
            {"viewer": ["ann"]},
            {"viewer": "nobody"},
        )
    ),
)
PATHS = (
    *("/", "/nothing", "/../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "/%00", "/" + "a" * 5000),
    *("/api/live?from=x", "/api/live?from=-1", "/api/live?from=1e999"),
    *(
        f"/api/{what}?run={run}&path={path}&tick={tick}&branch={branch}&thing={thing}&viewer={thing}"
        for what in ("explain", "sight", "deepen", "difference")
        for run, path, tick, branch, thing in (
            ("0", "/", "0", "main", "ann"),
            ("x", "%00", "-1", "[", "%ff"),
            ("0", "/ann/ann/ann/nobody", "99999999999999999999", "follow", "x,y,z"),
            ("-1", "/" * 2000, "nan", "a" * 3000, "1,1,1e999"),
        )
    ),
)


@contextmanager
def serving(*arguments: str) -> Iterator[tuple[str, list[str]]]:
    """Start a server; give its address, and at the end the lines that it wrote to stderr."""
    command = [sys.executable, "-m", "beliefnest", "serve", *arguments, "--port", "0"]
    lines: list[str] = []
    with started(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout is not None
        found = re.search(r"http://([^/\s]+)", process.stdout.readline())
        assert found is not None
        try:
            yield found[1], lines
        finally:
            process.terminate()
            _, errors = process.communicate()
            lines += errors.splitlines()


def status(address: str, method: str, path: str, body: bytes = b"", **headers: str) -> int:
    connection = http.client.HTTPConnection(address, timeout=20)
    try:
        connection.request(method, path, body, {**JSON, **headers})
        return connection.getresponse().status
    finally:
        connection.close()


@pytest.fixture(scope="module")
def editor(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, Path]]:
    file = tmp_path_factory.mktemp("editor") / "rooms.yaml"
    file.write_text(SCENE, encoding="utf-8")
    with serving(str(file), "--edit") as (address, lines):
        yield address, file
    assert not [line for line in lines if "Traceback" in line]


@pytest.mark.parametrize("path", ["/api/scene", "/api/save"])
def test_the_editor_answers_each_body_and_saves_no_nonsense(editor, path):
    address, file = editor
    for body in BODIES:
        file.write_text(SCENE, encoding="utf-8")
        answered = status(address, "POST", path, body)
        assert answered in (200, 400), body[:80]
        # The file holds the whole text that was accepted, or what it held before.
        if answered == 200 and path == "/api/save":
            assert file.read_text(encoding="utf-8") == json.loads(body)["text"]
        else:
            assert file.read_text(encoding="utf-8") == SCENE
    file.write_text(SCENE, encoding="utf-8")
    assert status(address, "GET", "/") == 200


@settings(
    max_examples=at_night(500, 30),
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(
    st.recursive(
        st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=20),
        lambda inner: (
            st.lists(inner, max_size=4)
            | st.dictionaries(
                st.sampled_from(["do", "at", "thing", "text", "x"]), inner, max_size=4
            )
        ),
        max_leaves=12,
    )
)
def test_the_editor_answers_any_edits(editor, edits):
    body = json.dumps({"text": SCENE, "edits": edits}).encode()
    assert status(editor[0], "POST", "/api/scene", body) in (200, 400)


def test_the_page_of_a_run_answers_each_request(tmp_path):
    world = bn.ScriptedWorld(((0, 0, 0), (4, 3, 4)), {}, {"ann": (1.5, 0, 1.5)})
    with bn.Nest(world, store=tmp_path / "run.bn"):
        world.say("ann", "hello")
    with serving(str(tmp_path / "run.bn")) as (address, lines):
        for path in PATHS:
            if not path.startswith("/api/live"):
                assert status(address, "GET", path) < 500, path[:120]
        for method in ("POST", "PUT", "DELETE", "OPTIONS", "TRACE"):
            assert status(address, method, "/", b"{}") in (400, 403, 404, 405), method
        assert status(address, "GET", "/", Host="elsewhere.example") in (400, 403, 421)
        assert status(address, "GET", "/") == 200
    assert not [line for line in lines if "Traceback" in line]
