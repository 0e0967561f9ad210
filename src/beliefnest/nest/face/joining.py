"""People in a nest whose real world goes on in real time: who is awaited, who has joined."""

import sys

from beliefnest.bodies.realtime import RealtimeWorld
from beliefnest.bodies.worlds import joined_of, realtime_of
from beliefnest.errors import InputError, UnknownNameError, WorldError
from beliefnest.nest.acting.script import Progress
from beliefnest.nest.face.turns import in_turn
from beliefnest.nest.face.waiting import Waiting

__all__ = ["Joining"]

_PATIENCE_S = 600.0


class Joining(Waiting):
    """What a nest offers about people; a part of `Nest`."""

    @property
    def address(self) -> str | None:
        """Where a Minecraft client joins, `HOST:PORT`; None where people cannot."""
        host = joined_of(self._engine.world)
        return None if host is None else host.address

    @property
    @in_turn
    def people(self) -> frozenset[str]:
        """Names of the people who have joined and not left."""
        host = joined_of(self._engine.world)
        return frozenset() if host is None else host.here()

    def wait_for_people(
        self, timeout_s: float = _PATIENCE_S, on_progress: Progress | None = None
    ) -> None:
        """Wait until all people of the scenario have joined; time passes meanwhile.

        Args:
            timeout_s: Seconds after which nobody is waited for any more.
            on_progress: Called with who has to join, where and how; None: a line on stderr says so.

        Raises:
            InputError: The time is below 0, or longer than a day.
            WorldError: Somebody did not come.
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
                f"{_names(awaited)} did not come within {timeout_s:g} s; {_line(host, awaited)}; "
                "or let programs act instead: nest.take_over(NAME)"
            )

    @in_turn
    def take_over(self, name: str) -> None:
        """Let programs act for a person, who is sent away if joined, until `hand_back`.

        Raises:
            UnknownNameError: The scenario has no person of that name.
        """
        host = self._host_of_person(name)
        host.invite(host.invited - {name})

    @in_turn
    def hand_back(self, name: str) -> None:
        """Let a person who was taken over join again; until then the agent stands still.

        Raises:
            UnknownNameError: The scenario has no person of that name.
        """
        host = self._host_of_person(name)
        host.invite(host.invited | {name})

    @in_turn
    def pause(self) -> None:
        """Let the real world stand still until `go_on`.

        No tick passes, and nothing that people do or say is done; they see a message. Beliefs can
        be looked at, forked and acted in meanwhile. It is not recorded: no time passes.

        Raises:
            WorldError: It is not in real time, or on a server elsewhere.
        """
        self._real_time_world().pause(paused=True)

    @in_turn
    def go_on(self) -> None:
        """Let the real world go on after `pause`; nothing changes if it does already.

        Raises:
            WorldError: It is not in real time, or on a server elsewhere.
        """
        self._real_time_world().pause(paused=False)

    def _real_time_world(self) -> RealtimeWorld:
        world = realtime_of(self._engine.world)
        if world is None:
            raise WorldError(
                "this world is not in real time: no time passes between calls that could be paused"
            )
        return world

    def _host_of_person(self, name: str) -> RealtimeWorld:
        people = self._recording.setting.people
        if name not in people:
            known = ", ".join(sorted(people)) or "none"
            raise UnknownNameError(
                f"there is no person {name!r} in this scenario; there are: {known}"
            )
        host = joined_of(self._engine.world)
        if host is None:
            raise InputError(f"{name} is a person, and nobody can join this world")
        return host


def _names(people: frozenset[str]) -> str:
    return " and ".join(sorted(people))


def _line(host: RealtimeWorld, awaited: frozenset[str]) -> str:
    return (
        f"join as {' or '.join(sorted(awaited))}: "
        f"Minecraft Java edition {host.minecraft}, Multiplayer, Direct Connection, {host.address}"
    )
