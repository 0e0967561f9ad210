"""Waiting for what happens in the real world, and hearing what is said in it."""

from collections.abc import Callable

from beliefnest.errors import InputError
from beliefnest.nest.acting.engine import Engine
from beliefnest.nest.acting.frame_recorder import ChatListener
from beliefnest.nest.face.base import NestBase
from beliefnest.nest.face.turns import in_turn
from beliefnest.world.values import TICKS_PER_SECOND

__all__ = ["Waiting"]

_LONGEST_S = 24 * 60 * 60


class Waiting(NestBase):
    """What a nest offers those who wait; a part of `Nest`."""

    _engine: Engine

    def wait(self, until: Callable[[], bool] | None = None, timeout_s: float = 60.0) -> bool:
        """Let time pass in the real world, tick by tick, and record what happens in it.

        On a server time passes by itself: what has happened since the last call is recorded
        first. In the embedded and the scripted world it passes as fast as it can.

        Args:
            until: Asked after every tick whether it is enough; None: wait for the whole time.
            timeout_s: Seconds of the world's time, of 20 ticks each, after which it is.

        Returns:
            Whether `until` held; True if there is none.

        Raises:
            InputError: The time is below 0, or longer than a day.
            BodyError: The Minecraft side failed, or the server does not go on.
        """
        if not 0 <= timeout_s <= _LONGEST_S:
            raise InputError(f"timeout_s is {timeout_s!r}; give seconds, at most {_LONGEST_S}")
        self._pass(0)
        last = self._head() + round(timeout_s * TICKS_PER_SECOND)
        while until is None or not until():
            if self._head() >= last:
                return until is None
            self._pass(1)
        return True

    def on_chat(self, callback: ChatListener) -> None:
        """Let a function be called on what is said, or whispered, in the real world from now on.

        It is called with tick, speaker and text, in the thread and at the end of the call of the
        nest that records it; in it the nest can be used.

        Raises:
            InputError: It is no function.
        """
        if not callable(callback):
            raise InputError(
                f"on_chat is given {callback!r}; give a function of tick, speaker, text"
            )
        self._engine.bodies.chat_listeners.append(callback)

    @in_turn
    def _pass(self, ticks: int) -> None:
        self._engine.step((), ticks)

    @in_turn
    def _head(self) -> int:
        return self._recording.info(()).head
