"""People in a nest whose real world runs in real time: waiting for them, pauses, takeovers."""

import sys

from beliefnest.errors import InputError, UnknownNameError, WorldError
from beliefnest.nest.acting.script import Progress
from beliefnest.nest.face.turns import in_turn
from beliefnest.nest.face.waiting import Waiting
from beliefnest.worlds.by_name import joined_of, realtime_of
from beliefnest.worlds.servers.realtime import RealtimeWorld

__all__ = ["Joining"]

_PATIENCE_S = 600.0


class Joining(Waiting):
    """The part of `Nest` that deals with people."""

    @property
    def address(self) -> str | None:
        """The address at which Minecraft clients join, `HOST:PORT`; None if people cannot join."""
        host = joined_of(self._engine.world)
        return None if host is None else host.address

    @property
    @in_turn
    def people(self) -> frozenset[str]:
        """The names of the people who are joined now."""
        host = joined_of(self._engine.world)
        return frozenset() if host is None else host.here()

    def wait_for_people(
        self, timeout_s: float = _PATIENCE_S, on_progress: Progress | None = None
    ) -> None:
        """Wait until all people of the scenario have joined. Time passes meanwhile.

        Args:
            timeout_s: Greatest number of seconds to wait.
            on_progress: Function called with a line that says who has to join, where and how; None:
                print the line to stderr.

        Raises:
            InputError: The time is below 0, or longer than a day.
            WorldError: A person did not join.
        """
        host = joined_of(self._engine.world)
        if host is None or not host.invited:
            return
        shown: frozenset[str] | None = None

        def all_here() -> bool:
            nonlocal shown
            awaited = host.invited - self.people
            if awaited and awaited != shown:
                _tell(_line(host, awaited), len(host.invited - awaited), len(host.invited))
            shown = awaited
            return not awaited

        def _tell(line: str, done: int, total: int) -> None:
            if on_progress is None:
                sys.stderr.write(f"{line}\n")
            else:
                on_progress(line, done, total)

        if not self.wait(all_here, timeout_s):
            awaited = host.invited - self.people
            raise WorldError(
                f"{_names(awaited)} did not join within {timeout_s:g} s; {_line(host, awaited)}; "
                "or let programs act instead, with nest.take_over(NAME)"
            )

    @in_turn
    def take_over(self, name: str) -> None:
        """Let programs act for a person until `hand_back`. Disconnect the person if joined.

        Raises:
            UnknownNameError: The scenario has no person of that name.
        """
        host = self._host_of_person(name)
        host.invite(host.invited - {name})

    @in_turn
    def hand_back(self, name: str) -> None:
        """Let a person join again after `take_over`. The agent stands still until then.

        Raises:
            UnknownNameError: The scenario has no person of that name.
        """
        host = self._host_of_person(name)
        host.invite(host.invited | {name})

    @in_turn
    def pause(self) -> None:
        """Stop the real world until `go_on`.

        No tick passes. Acts and utterances of people have no effect, and people see a message.
        Beliefs can be read, forked and acted in meanwhile. A pause is not recorded, because no time
        passes in it.

        Raises:
            WorldError: The world does not run in real time, or is on a server elsewhere.
        """
        self._real_time_world().pause(paused=True)

    @in_turn
    def go_on(self) -> None:
        """Let the real world run again after `pause`. Do nothing if it runs.

        Raises:
            WorldError: The world does not run in real time, or is on a server elsewhere.
        """
        self._real_time_world().pause(paused=False)

    def _real_time_world(self) -> RealtimeWorld:
        world = realtime_of(self._engine.world)
        if world is None:
            raise WorldError(
                "this world does not run in real time, so there is nothing to pause: no time "
                "passes between calls"
            )
        return world

    def _host_of_person(self, name: str) -> RealtimeWorld:
        people = self._recording.setting.people
        if name not in people:
            known = ", ".join(sorted(people)) or "none"
            raise UnknownNameError(f"this scenario has no person {name!r}; its people are {known}")
        host = joined_of(self._engine.world)
        if host is None:
            raise InputError(
                f"{name} is a person, and people cannot join this world; open it with "
                "realtime=True, listen=25565"
            )
        return host


def _names(people: frozenset[str]) -> str:
    return " and ".join(sorted(people))


def _line(host: RealtimeWorld, awaited: frozenset[str]) -> str:
    return (
        f"join as {' or '.join(sorted(awaited))}: "
        f"Minecraft Java edition {host.minecraft}, Multiplayer, Direct Connection, {host.address}"
    )
