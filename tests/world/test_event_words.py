"""Announcements of events to programs."""

import pytest

from beliefnest.world.event_kinds import EventKind, Sense, Traits
from beliefnest.world.event_words import announced
from beliefnest.world.values import Event

SAID = Event(EventKind.CHAT, "sally", {"text": "hi {to}"})
WHISPERED = Event(EventKind.CHAT, "sally", {"text": "psst", "to": "anne"})
MINED = Event(EventKind.MINE_BLOCK, "sally", {"position": (1, 2, 3), "block": "dirt"})


def test_speech_has_the_events_of_a_bot() -> None:
    assert announced([SAID, WHISPERED], "anne") == (
        ("chat", "sally", "hi {to}"),
        ("messagestr", "<sally> hi {to}"),
        ("whisper", "sally", "psst"),
        ("messagestr", "sally whispers to you: psst"),
    )
    assert announced([WHISPERED], "sally") == (("messagestr", "You whisper to anne: psst"),)


def test_what_is_perceived_by_a_further_sense_is_announced_in_words(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert announced([MINED], "anne") == ()
    monkeypatch.setattr(EventKind.MINE_BLOCK, "traits", Traits(("position",), Sense.HEARING))
    assert announced([MINED], "anne") == (("mine_block", "sally", "sally mines dirt at (1, 2, 3)"),)
