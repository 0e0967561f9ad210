"""The channel against processes that break off, fall silent, lie or eat memory."""

import sys
from pathlib import Path

import msgspec
import pytest
from tests.profiles import few_by_day

from beliefnest.errors import BodyError, BodyLostError, InputError
from beliefnest.worlds.minecraft.channel import Channel
from beliefnest.worlds.minecraft.node_files import node_command
from beliefnest.worlds.process_limits import ProcessLimits

START = """
import os, struct, sys, time
channel = int(sys.argv[1])
assert set(os.environ) <= {"TZ", "LC_CTYPE"}, sorted(os.environ)
def take():
    length = struct.unpack(">I", os.read(channel, 4))[0]
    return os.read(channel, length)
def send(body):
    os.write(channel, struct.pack(">I", len(body)) + body)
take()
"""

BOMBS = {
    "heap": "const all = []; for (;;) all.push({ x: Math.random(), y: [1, 2, 3] })",
    "buffers": "const all = []; for (;;) all.push(Buffer.alloc(1 << 24, 1))",
}


def message(content: object) -> str:
    return f"send({msgspec.msgpack.encode(content)!r})\n"


def said(tmp_path: Path, acts: str, silence: float = 60) -> str:
    """Return the error of a request that a process answers as told."""
    script = tmp_path / "acts.py"
    script.write_text(START + acts)
    channel = Channel.start([sys.executable, str(script)], ProcessLimits(silence=silence))
    try:
        with pytest.raises(BodyLostError) as lost:
            channel.request("run", lambda _frame: None)
        assert channel.lost
        with pytest.raises(BodyLostError):
            channel.request("run")
        return str(lost.value)
    finally:
        channel.close()


def test_how_it_ended_and_its_last_words(tmp_path):
    told = said(tmp_path, "sys.stderr.write('I am tired'); sys.exit(7)")
    assert told == "Node ended with status 7 during 'run'; its last words:\nI am tired"


def test_the_tick_it_had_reached(tmp_path):
    acts = message({"beat": 4}) + message({"frame": {"tick": 9}}) + message({"beat": None})
    told = said(tmp_path, acts + "os.kill(os.getpid(), 9)")
    assert told == "Node ended by signal 9 (SIGKILL) during 'run', after tick 9; it said nothing"


def test_silence(tmp_path):
    told = said(tmp_path, "while True: pass", silence=0.3)
    assert (
        told == "Node gave no sign of life for 0.3 s and was killed during 'run'; it said nothing"
    )


def test_a_closed_channel(tmp_path):
    told = said(tmp_path, "os.close(channel)\nwhile True: pass")
    assert told.startswith("Node closed the channel and was killed")


@pytest.mark.parametrize(
    ("acts", "told"),
    [
        (message({"id": 5, "ok": True}), "answered request 5, not 1"),
        (message({"perceive": 3}), "asked for percepts in a request without any"),
        ("send(b'\\xc1')\n", "sent 1 bytes that are no message"),
        ("os.write(channel, b'\\xff' * 4)\n", "announced a message of 4294967295 bytes"),
    ],
)
def test_what_breaks_the_protocol(tmp_path, acts, told):
    assert told in said(tmp_path, acts + "while True: pass")


def test_signs_of_life_are_answered_with_patience(tmp_path):
    script = tmp_path / "acts.py"
    # All together last longer than silence may; a busy machine may be late with each.
    beats = f"for _ in range(10): time.sleep(0.4); {message({'beat': 1})}"
    script.write_text(START + beats + message({"id": 1, "ok": True, "result": "done"}))
    channel = Channel.start([sys.executable, str(script)], ProcessLimits(silence=3))
    assert channel.request("run") == "done"
    channel.close()


def test_an_interrupted_request_ends_the_process(tmp_path):
    script = tmp_path / "acts.py"
    script.write_text(START + message({"frame": {"tick": 1}}) + "while True: pass")
    channel = Channel.start([sys.executable, str(script)])

    def interrupt(_frame: object) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        channel.request("run", interrupt)
    assert channel.lost
    channel.close()
    with pytest.raises(BodyError, match="was closed"):
        channel.request("run")


@pytest.mark.parametrize("kind", few_by_day(BOMBS))
@pytest.mark.skipif(sys.platform != "linux", reason="only Linux limits all memory from outside")
def test_a_bomb_ends_the_process_and_not_the_machine(tmp_path, kind):
    script = tmp_path / "bomb.js"
    script.write_text(BOMBS[kind])
    limits = ProcessLimits(heap=64, memory=2048)
    *options, _bundle = node_command(limits)
    channel = Channel.start([*options, f"--allow-fs-read={script}", str(script)], limits)
    with pytest.raises(
        BodyLostError, match=r"heap out of memory. Make the box smaller|Failed to allocate memory"
    ) as lost:
        channel.request("hello")
    assert "Native stack trace" not in str(lost.value)
    channel.close()


def test_limits_that_leave_nothing_to_live_on_are_refused():
    with pytest.raises(InputError, match="heap is 0"):
        ProcessLimits(heap=0)


def test_half_a_character_in_a_message_is_no_message(tmp_path):
    told = said(tmp_path, "send(b'\\x81\\xa2id\\xa3\\xed\\xa0\\xbd')\n")
    assert told.startswith("Node sent 8 bytes that are no message")


def test_a_message_nested_without_end_is_no_message(tmp_path):
    told = said(tmp_path, "send(b'\\x81\\xa1a' + b'\\x91' * 100_000 + b'\\x90')\n")
    assert "that are no message" in told


def test_half_a_character_in_a_request_is_refused_and_nothing_sent(tmp_path):
    script = tmp_path / "acts.py"
    script.write_text(START + message({"id": 1, "ok": True, "result": 7}))
    channel = Channel.start([sys.executable, str(script)])
    try:
        with pytest.raises(InputError, match=r"'run' contains half a character"):
            channel.request("run", programs={"ann": "\ud83d"})
        assert channel.request("run") == 7
    finally:
        channel.close()
