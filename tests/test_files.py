"""Files that a person names: regular ones only, whoever reads them."""

import os

import pytest

from beliefnest.errors import BeliefNestError, InputError
from beliefnest.files import make_folder, os_errors_of, read_regular, read_regular_text
from beliefnest.llm import resolve_model
from beliefnest.prompts.templates import load_template
from beliefnest.scenarios.scenario import Scenario
from beliefnest.suites.stories.data import read_items
from beliefnest.timeline.trace import load_trace
from beliefnest.world.registry import Registry

READERS = {
    "scenario": lambda path: Scenario.load(str(path)),
    "stories": read_items,
    "template": load_template,
    "trace": lambda path: load_trace(path, Registry.load()),
    "script": lambda path: resolve_model(f"scripted:{path}", {}),
    "recording": lambda path: resolve_model(f"replay:{path}", {}),
}


@pytest.fixture(params=["fifo", "folder", "device"])
def odd(request, tmp_path):
    path = tmp_path / "odd.yaml"
    if request.param == "fifo":
        os.mkfifo(path)
    elif request.param == "folder":
        path.mkdir()
    else:
        path.symlink_to("/dev/zero")
    return path


@pytest.mark.parametrize("reader", READERS.values(), ids=READERS)
def test_what_is_no_regular_file_is_refused(reader, odd):
    with pytest.raises(
        BeliefNestError, match=r"it is a FIFO|it is a device|Is a directory|is a folder"
    ) as fault:
        reader(odd)
    assert str(odd) in str(fault.value)
    assert "\n" not in str(fault.value)


def test_a_file_is_read_up_to_its_bound(tmp_path):
    path = tmp_path / "file"
    path.write_bytes(b"a\r\nb")
    assert read_regular(path, 4) == b"a\r\nb"
    assert read_regular_text(path) == "a\nb"
    with pytest.raises(OSError, match="longer than 3 bytes"):
        read_regular(path, 3)


@pytest.mark.parametrize("below", ["", "out", "out/deeper"])
def test_a_file_in_place_of_a_folder_is_named(tmp_path, below):
    (tmp_path / "mine").write_text("mine", encoding="utf-8")
    with pytest.raises(InputError, match=r"mine is no folder; name another folder, or move it"):
        make_folder(tmp_path / "mine" / below)
    make_folder(tmp_path / "new" / below)
    assert (tmp_path / "new" / below).is_dir()


def test_errors_of_the_system_name_the_file_and_what_to_do(tmp_path):
    file = tmp_path / "missing.json"
    fault = r"missing\.json cannot be read: No such file .*; write one"
    with pytest.raises(InputError, match=fault), os_errors_of(file, "read", "write one"):
        read_regular(file)
    with pytest.raises(ValueError, match="other"), os_errors_of(file, "read"):
        raise ValueError("other")
