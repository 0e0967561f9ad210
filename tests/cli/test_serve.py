"""`beliefnest serve`: where it listens, and how it ends."""

import re
import signal
import socket
import subprocess
import sys
import urllib.request
from pathlib import Path

import pytest
from tests.processes import started

import beliefnest as bn
from beliefnest.cli.app import run_command_line
from beliefnest.cli.options import ServeOptions
from beliefnest.cli.serve import listening


def test_the_address_can_be_connected_to_as_soon_as_it_is_known() -> None:
    options = ServeOptions(what="run", port=0)
    with listening(options) as listener:
        socket.create_connection(listener.getsockname(), timeout=120).close()


@pytest.mark.parametrize("address", ["[" * 9000, "\u202e", "a..b"])
def test_an_address_that_is_no_host_name_is_refused(
    address: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_command_line(["serve", "run", "--port", "-5", "--address", address]) == 2
    told = capsys.readouterr().err
    assert "is no host name; give an address of this machine with --address" in told


def test_ctrl_c_ends_it_without_complaint_while_a_page_listens(tmp_path: Path) -> None:
    store = tmp_path / "run.bn"
    world = bn.ScriptedWorld(((0, 0, 0), (4, 2, 4)), {}, {"ann": (1.5, 0, 1.5)})
    with bn.Nest(world, store=store):
        world.step(3)
    command = [sys.executable, "-m", "beliefnest", "serve", str(store), "--port", "0"]
    with started(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as server:
        assert server.stdout is not None
        address = re.search(r"http://\S+", server.stdout.readline())
        assert address is not None
        with urllib.request.urlopen(f"{address[0]}api/live?from=0", timeout=120) as live:
            assert live.readline().startswith(b"id: 1")
            server.send_signal(signal.SIGINT)
            live.read()
        said, complaints = server.communicate(timeout=120)
    assert (server.returncode, said, complaints) == (0, "", "")


def test_what_cannot_be_shown_is_refused_before_anything_is_served(
    capsys: pytest.CaptureFixture[str],
) -> None:
    for options, told in (
        (["--condition", "9"], "there is no condition 9; conditions are 1, 2, 3"),
        (["--depth", "9"], "depth is 9; give 0 to 4"),
    ):
        assert run_command_line(["serve", "sally-anne", "--port", "0", *options]) == 2
        assert told in capsys.readouterr().err


def test_a_file_that_cannot_be_read_is_named(tmp_path: Path) -> None:
    (tmp_path / "run.bn").write_text("no run", encoding="utf-8")
    command = [sys.executable, "-m", "beliefnest", "serve", str(tmp_path), "--port", "0"]
    with started(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as it:
        assert it.stdout is not None
        assert it.stdout.readline().startswith("The page is at")
        it.send_signal(signal.SIGINT)
        _, complaints = it.communicate(timeout=120)
    assert f"{tmp_path / 'run.bn'} is not a run file" in complaints


@pytest.mark.long
def test_a_file_of_the_user_hides_no_module_from_the_run_that_is_served(tmp_path: Path) -> None:
    (tmp_path / "random.py").write_text("raise SystemExit('mine')\n", encoding="utf-8")
    beliefnest = Path(sys.executable).with_name("beliefnest")
    command = [str(beliefnest), "serve", "sally-anne", "--condition", "1"]
    with started(
        [*command, "--port", "0", "--out", "out"],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    ) as server:
        assert server.stdout is not None
        address = re.search(r"http://\S+", server.stdout.readline())
        assert address is not None
        # The child writes the run file in its time; the page tells of it when it is there.
        with urllib.request.urlopen(f"{address[0]}api/live?from=0", timeout=120) as live:
            assert any(b"sally" in line for line in live)
            server.send_signal(signal.SIGINT)
            live.read()
        _, errors = server.communicate()
    assert "mine" not in errors
