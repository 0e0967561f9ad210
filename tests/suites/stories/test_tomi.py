"""Files of ToMi: read by lines; what cannot be read is named, and the rest is answered."""

import json

import pytest

import beliefnest as bn
from beliefnest.cli.app import run_command_line
from beliefnest.suites.stories.tomi import read_tomi

GOOD = """\
1 Cy entered the study.
2 Bo entered the study.
3 The plum is in the drawer.
4 Bo exited the study.
5 Cy moved it to the bag.
6 Where will Bo look for the plum?\tdrawer\t1
7 Where is the plum really?\tbag\t1
"""


@pytest.fixture
def file(tmp_path):
    def write(text):
        path = tmp_path / "test.txt"
        path.write_text(text)
        return path

    return write


def run(capsys, *arguments):
    status = run_command_line(["suite", "tomi", *map(str, arguments)])
    return status, *capsys.readouterr()


def test_questions_follow_their_story(file, capsys):
    status, out, _ = run(capsys, "--data", file(GOOD), "--json")
    report = json.loads(out)
    assert status == 0
    assert (report["all"]["right"], report["unread_items"]) == (2, 0)


@pytest.mark.parametrize(
    ("text", "place", "what"),
    [
        (GOOD.replace("exited", "juggled"), "line 11", "no sentence of a story"),
        (GOOD.replace("exited the study", "exited the hall"), "line 11", "Bo is in the study"),
        (GOOD.replace("Where will Bo look for", "Who has"), "line 13", "no question"),
        (GOOD.replace("drawer\t1", "\t1"), "line 13", "has no answer"),
        (GOOD + "8 Cy exited the study.\n", "line 15", "after a question"),
        ("1 Cy entered the study.\n", "line 8", "has no question"),
    ],
)
def test_what_cannot_be_read_is_named_with_the_line_of_the_file(file, capsys, text, place, what):
    path = file(GOOD + text)
    status, out, _ = run(capsys, "--data", path, "--json")
    report = json.loads(out)
    ((fault,),) = (each["faults"] for each in report["not_read"])
    assert status == 1
    assert fault.startswith(f"{path}, {place}")
    assert what in fault
    assert report["unread_items"] >= 1
    assert report["all"]["questions"] >= 2
    status, _, err = run(capsys, "--data", path, "--strict")
    assert status == 2
    assert f"{path}, {place}" in err


def test_rows_are_lines_of_questions(file):
    (told,) = read_tomi(file(GOOD), {7}).whole()
    assert [item.row for item in told.items] == [7]
    with pytest.raises(bn.InputError, match="line 3: there is no question"):
        read_tomi(file(GOOD), {3})


def test_a_file_that_is_no_text_is_refused_with_its_line(tmp_path):
    (tmp_path / "test.txt").write_bytes(b"1 Cy entered the study.\n2 \xff\n")
    with pytest.raises(bn.InputError, match=r"test\.txt, line 2: .*UTF-8"):
        read_tomi(tmp_path / "test.txt")
