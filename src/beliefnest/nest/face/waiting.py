"""Waiting for events of the real world, and callbacks for its utterances."""

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
    """The part of `Nest` that waits and calls back."""

    _engine: Engine

    def wait(self, until: Callable[[], bool] | None = None, timeout_s: float = 60.0) -> bool:
        """Let time pass in the real world, tick by tick, and record what happens in it.

        On a server time passes by itself, so everything since the last call is recorded first. In
        the embedded and the scripted world time passes as fast as it can.

        Args:
            until: Function called after every tick; True ends the wait. None: wait for the whole
                time.
            timeout_s: Greatest time to wait, in seconds of the world's time (20 ticks each).

        Returns:
            True if `until` held, or if there is none.

        Raises:
            InputError: The time is below 0, or longer than a day.
            BodyError: The Minecraft side failed, or the server has stopped.
        """
        if not 0 <= timeout_s <= _LONGEST_S:
            raise InputError(
                f"timeout_s is {timeout_s!r}; give a number of seconds from 0 to {_LONGEST_S}"
            )
        self._pass(0)
        last = self._head() + round(timeout_s * TICKS_PER_SECOND)
        while until is None or not until():
            if self._head() >= last:
                return until is None
            self._pass(1)
        return True

    def on_chat(self, callback: ChatListener) -> None:
        """Call a function with each utterance and whisper in the real world from now on.

        Its arguments are tick, speaker and text. It is called in the thread, and at the end, of the
        call of the nest that records the utterance. It may use the nest.

        Raises:
            InputError: The callback is not a function.
        """
        if not callable(callback):
            raise InputError(
                f"on_chat() was given {callback!r}; give a function of tick, speaker and text"
            )
        self._engine.bodies.chat_listeners.append(callback)

    @in_turn
    def _pass(self, ticks: int) -> None:
        self._engine.step((), ticks)

    @in_turn
    def _head(self) -> int:
        return self._recording.info(()).head
