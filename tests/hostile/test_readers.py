"""One corpus of hostile inputs for each reader, in this process; and one process for each reader.

Each reader has a sound input. Hypothesis changes it, byte by byte and value by value: the reader
refuses the result with an error of the package, or reads it.
"""

import gzip
import io
import json
import tempfile
import zipfile
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from tests.hostile.limits import ends_well
from tests.profiles import at_night, few_by_day

from beliefnest.cli.scenario_editing import edited
from beliefnest.errors import BeliefNestError
from beliefnest.llm.stored_exchange import decode_exchange
from beliefnest.scenarios.scenario import Scenario
from beliefnest.scenarios.yaml_reading import read_yaml
from beliefnest.studies.archive import damaged_files, unpack, write_zip
from beliefnest.studies.bundling import opened
from beliefnest.studies.participants.answers import read_answers
from beliefnest.studies.participants.exclusions import read_exclusions
from beliefnest.studies.plainframe import read_csv_rows
from beliefnest.suites.stories.data import read_items
from beliefnest.timeline import codec
from beliefnest.timeline.journal import TimelineKey
from beliefnest.timeline.store import Journal
from beliefnest.timeline.trace import load_trace
from beliefnest.world.frames import Frame
from beliefnest.world.registry import Registry
from beliefnest.world.values import AgentState, Event, EventKind

SCENARIO = b"""\
name: room
parameters: {spot: {default: [1, 1, 1]}}
box: [[0, 0, 0], [5, 3, 5]]
blocks: [&b {block: stone, fill: [[0, 0, 0], [5, 0, 5]]}]
agents: {ann: {position: [2.5, 1, 2.5]}}
containers: [{at: "${spot}", items: {bread: 2}}]
perception: {hearing: {radius: 3}, field_of_view: 120}
script: [{label: a, agent: ann, program: "await say(bot, 'hi')"}]
conditions: {1: {containers: []}, 2: {blocks: [*b]}}
"""
TRACE = (
    b'{"tick": 0, "box": [[0,0,0],[9,3,9]], "agents": {"ann": {"position": [2.5,1,2.5]}}, '
    b'"fills": [[[0,0,0],[9,0,9],"stone"]], "containers": [], "unique": ["bread"]}\n'
    b'{"tick": 1, "agents": {"ann": {"position": [3.5,1,2.5], "yaw": 1}}, '
    b'"events": [{"kind": "chat", "actor": "ann", "detail": {"text": "hi"}}]}\n'
)
STORIES = json.dumps(
    [{"story": "1 Ann entered the hall.", "question": "Where is Ann?", "answer": "hall"}]
).encode()
EXCHANGE = b'{"model":"m","messages":[["user","hi"]],"sampling":{},"answer":"x"}'
PEOPLE = (
    b"participant,cell,question,options,response,reason,study,started,trial_type\n"
    b'p1,c0ffee00c0ffee00,1.1,"[""a"", ""b""]",a,so,s,2026-01-01T10:00:00Z,beliefnest-question\n'
)
PEOPLE_JSON = json.dumps(
    [
        {"participant": "p1", "cell": "c", "question": "1.1", "options": ["a", "b"]}
        | {"response": "a", "reason": "", "study": "s", "started": "2026-01-01T10:00:00Z"}
    ]
).encode()
FRAMES = [
    Frame(
        tick,
        {"ann": AgentState((2.5, 1.0, tick / 2), yaw=0.5)},
        {(1, 1, tick): tick},
        {(3, 1, 3): {"bread": tick}},
        events=(Event(EventKind.CHAT, "ann", {"text": "hé"}),),
    )
    for tick in range(1, 9)
]
SUPPLEMENT = {
    "study.json": b'{"form": "beliefnest study 3", "kind": "scenarios", "cells": []}',
    "cells/a.json": b"{}",
}


def zipped(files: dict[str, bytes]) -> bytes:
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return out.getvalue()


def scenario(path: Path) -> None:
    Scenario.varied(read_yaml(path), None)
    edited(path.read_text(encoding="utf-8"), {"do": "put", "at": [2, 1, 3], "thing": "stone"})


def supplement(path: Path) -> None:
    folder = unpack(path, path.with_name(f"unpacked-{len(list(path.parent.iterdir()))}"))
    damaged_files(folder, "study")
    opened(folder)


def entries(path: Path) -> None:
    for entry in codec.split(path.read_bytes()):
        codec.decode_entry(entry)


def run_file(path: Path) -> None:
    with Journal.read(path) as journal:
        for info in journal.timelines():
            list(journal.entries(info.key, 0, info.entries))
        journal.records.run()


def journal() -> bytes:
    """Return a run file with the frames on a timeline."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.bn"
        with Journal.create_file(path) as made:
            made.create(TimelineKey((), "main"), None, 0)
            made.append(TimelineKey((), "main"), FRAMES, len(FRAMES))
        return path.read_bytes()


def exchange(path: Path) -> None:
    try:
        decode_exchange(path.read_bytes())
    except ValueError as fault:  # of msgspec: the callers say in which file and line
        raise BeliefNestError(str(fault)) from fault


READERS: dict[str, tuple[str, bytes, Callable[[Path], object]]] = {
    "scenario": ("scenario.yaml", SCENARIO, scenario),
    "trace": ("trace.jsonl", TRACE, lambda path: load_trace(path, Registry.load())),
    "stories": ("stories.json", STORIES, read_items),
    "supplement": ("s.zip", zipped(SUPPLEMENT), supplement),
    "table": ("rows.csv", b'a,b\n1,"x\ny"\n', lambda path: read_csv_rows(path, {})),
    "answer": ("model.jsonl", EXCHANGE, exchange),
    "run file": ("run.bn", b"SQLite format 3\0" + bytes(200), run_file),
}
READERS["entries"] = ("entries", codec.join(map(codec.encode_entry, FRAMES)), entries)
READERS["journal"] = ("run.bn", journal(), run_file)
READERS["people"] = ("people.csv", PEOPLE, read_answers)
READERS["people as JSON"] = ("people.json", PEOPLE_JSON, read_answers)
READERS["exclusions"] = (
    "out.csv",
    b"participant,reason\np1,asleep\n",
    lambda path: read_exclusions(path, ()),
)

PIECES = st.sampled_from(
    [
        *(b"", b"\0", b"\xff\xfe", b"\xed\xa0\x80", b"\xef\xbb\xbf", b"\x1b]0;x\x07", b"\r"),
        *(b"[" * 2000, b"{a: " * 200, b'"', b"'", b"&a ", b"*a", b"<<: *b", b"!!bool abc"),
        *(b'"\\UFFFFFFFF"', b'"\\ud800"', b"!!int x", b"!!set {a}", b".nan", b"1e999", b"9" * 5000),
        *(b"-1", b"null", b"true", b"[]", b"{}", b"__proto__", b"${spot}", b"${spot[9]}", b"=1+1"),
        *(b"x" * 100_000, b"2147483648", b"9223372036854775808", b"NaN", b"Infinity", b"../../x"),
    ]
)
CHANGES = st.lists(
    st.tuples(st.integers(0, 10_000), st.integers(0, 12), st.one_of(PIECES, st.binary(max_size=4))),
    min_size=1,
    max_size=4,
)


def changed(sound: bytes, changes: list[tuple[int, int, bytes]]) -> bytes:
    for place, length, piece in changes:
        at = place % (len(sound) + 1)
        sound = sound[:at] + piece + sound[at + length :]
    return sound


@pytest.mark.parametrize("name", READERS)
@settings(
    max_examples=at_night(3000, 15),
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
@given(changes=CHANGES)
def test_what_cannot_be_read_is_refused(name, changes, tmp_path):
    file, sound, read = READERS[name]
    path = tmp_path / file
    path.write_bytes(changed(sound, changes))
    try:
        read(path)
    except BeliefNestError as fault:
        assert fault.exit_status == 2


BOMB = b"x" * 100_000
YAML = {
    "a merge key that is its own alias": b"name: x\nbox: &a\n  <<: *a\n",
    "a boolean that is none": b"name: !!bool abc\n",
    "an escape of no character": b'name: "\\UFFFFFFFF"\n',
    "a text inserted 20,000 times": b'name: x\ndescription: &t "'
    + BOMB
    + b'"\nscript:\n'
    + b"  - *t\n" * 20_000,
    "a parameter inserted 5,000 times": b"name: x\nparameters: {t: {default: " + BOMB + b"}}\n"
    b"box: [[0,0,0],[5,3,5]]\nagents: {ann: {position: [1,1,1]}}\nscript:\n"
    + b'  - {label: "${t}", agent: ann, program: "1"}\n'
    * 5000,
    "a value of 100,000 characters": b"name: x\nbox: [[0,0,0],[5,3,5]]\nblocks: [{block: "
    + BOMB
    + b", at: [1,1,1]}]\nagents: {ann: {position: [1,1,1]}}\n",
    "lists in lists": b"name: " + b"[" * 100_000,
}


@pytest.mark.parametrize("content", YAML.values(), ids=YAML)
def test_a_scenario_that_grows_or_is_no_yaml_is_refused(tmp_path, content):
    path = tmp_path / "scenario.yaml"
    path.write_bytes(content)
    with pytest.raises(BeliefNestError) as fault:
        Scenario.varied(read_yaml(path), None)
    assert len(str(fault.value).replace(str(path), "")) < 400
    assert "\n" not in str(fault.value)


TABLES = {
    "columns without end": ",".join(f"a{n}" for n in range(300_000)),
    "cells without end": "a," * 9_000_000,
    "many rows of one cell": ",".join(f"a{n}" for n in range(5000)) + "\nx" * 5000,
    "a cell of 200,000 characters": "a,b\n" + "x" * 200_000 + ",y",
    "a column twice": "a,b,a\n1,2,3",
    "a column of 100,000 characters twice": f"{'x' * 100_000},{'x' * 100_000}",
    "a quote that does not end": 'a,b\n"x' + "\n" * 100_000,
    "a separator of its own": "sep=x\n" + "x" * 100_000,
}


@pytest.mark.parametrize("text", TABLES.values(), ids=TABLES)
def test_a_table_that_grows_or_is_none_is_refused_or_read(tmp_path, text):
    path = tmp_path / "people.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(BeliefNestError) as fault:
        read_answers(path)
    assert len(str(fault.value).replace(str(path), "")) < 400
    with suppress(BeliefNestError):
        read_csv_rows(path, {})


def test_an_answer_of_any_length_is_cut_in_messages(tmp_path):
    path = tmp_path / "people.json"
    for changes in (
        {"response": ["x" * 100_000]},
        {"options": "x" * 100_000},
        {"cell": "1" + "0" * 9999},
    ):
        path.write_text(json.dumps([{**json.loads(PEOPLE_JSON)[0], **changes}]), encoding="utf-8")
        with pytest.raises(BeliefNestError) as fault:
            read_answers(path)
        assert len(str(fault.value).replace(str(path), "")) < 400


def entry(name: str, mode: int = 0o644, size: int | None = None) -> bytes:
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        info = zipfile.ZipInfo(name)
        info.external_attr = mode << 16
        archive.writestr(info, b"x" if size is None else bytes(size), zipfile.ZIP_DEFLATED)
    return out.getvalue()


def broken() -> bytes:
    body = bytearray(zipped({"study.json": b""}))
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("study.json", bytes(range(256)) * 50)
    body = bytearray(out.getvalue())
    body[60:90] = b"\xff" * 30
    return bytes(body)


ZIPS: dict[str, Callable[[], bytes]] = {
    "a path upwards": lambda: entry("../out.txt"),
    "an absolute path": lambda: entry("/tmp/out.txt"),
    "a path of another system": lambda: entry("..\\out.txt"),
    "a drive": lambda: entry("C:out.txt"),
    "a symbolic link": lambda: entry("study.json", 0o120777),
    "a file twice": lambda: zipped({"Study.json": b"", "study.json": b""}),
    "a damaged file": broken,
    "much more than its size": lambda: entry("study.json", size=2**28 + 1),
    "a long list of files": lambda: zipped({f"{number:065000}": b"" for number in range(130)}),
    "half a file": lambda: zipped(SUPPLEMENT)[:80],
    "no archive": lambda: gzip.compress(b"x"),
}


@pytest.mark.parametrize("content", ZIPS.values(), ids=ZIPS)
def test_a_supplement_that_is_none_is_refused(tmp_path: Path, content: Callable[[], bytes]) -> None:
    path = tmp_path / "inner" / "s.zip"
    path.parent.mkdir()
    path.write_bytes(content())
    with pytest.raises(BeliefNestError, match=r"s\.zip"):
        unpack(path, tmp_path / "inner" / "out")
    assert {each.name for each in tmp_path.iterdir()} == {"inner"}


def test_files_are_counted_before_they_are_unpacked(tmp_path, monkeypatch):
    monkeypatch.setattr("beliefnest.studies.archive._MOST_FILES", 2)
    path, out = tmp_path / "s.zip", tmp_path / "out"
    with pytest.raises(BeliefNestError, match=r"s\.zip would hold 3 files; .* at most 2: bundle"):
        write_zip(dict.fromkeys("abc", b""), path)
    path.write_bytes(zipped(dict.fromkeys("abc", b"")))
    with pytest.raises(BeliefNestError, match=r"s\.zip would unpack to 3 files .* at most 2 files"):
        unpack(path, out)
    assert not out.exists()


# A structure of one block, whose number is an empty compound.
PLACE = (
    b"\n\0\0\t\0\4size\3\0\0\0\3" + b"\0\0\0\1" * 3 + b"\t\0\7palette\n\0\0\0\0"
    b"\t\0\6blocks\n\0\0\0\1\t\0\3pos\3\0\0\0\3" + bytes(12) + b"\n\0\5state\0\0\0"
)


@pytest.mark.parametrize(
    ("file", "content", "command"),
    few_by_day(
        [
            ("s.yaml", YAML["a text inserted 20,000 times"], ["run", "s.yaml", "--out", "o"]),
            ("t.jsonl", TRACE.replace(b"3.5", b"1e999"), ["import", "t.jsonl", "--out", "t.bn"]),
            ("s.zip", broken(), ["reproduce", "s.zip"]),
            ("r.bn", b"SQLite format 3\0" + bytes(200), ["show", "r.bn"]),
            ("d.json", b"[" * 100_000, ["suite", "stories", "--data", "d.json"]),
            ("p.nbt", PLACE, ["capture", "p.nbt", "-o", "p.yaml"]),
            ("s.yaml", f"scenarios: [{'x' * 3000}]".encode(), ["study", "s.yaml", "--out", "o"]),
        ],
        2,
    ),
    ids=["yaml", "jsonl", "zip", "run", "json", "place", "study"],
)
def test_a_command_ends_well(tmp_path, file, content, command):
    (tmp_path / file).write_bytes(content)
    assert ends_well(command, tmp_path)
