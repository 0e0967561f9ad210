"""Worker processes of this machine, which take the cells of a plan from a common supply.

This module imports little, because a worker process imports it first: it launches Node, and then
imports everything else while Node loads the world.
"""

import os
import threading
from collections import deque
from collections.abc import Iterator, Sequence
from concurrent.futures import Future
from contextlib import ExitStack, contextmanager
from queue import SimpleQueue
from typing import TYPE_CHECKING, Any, NamedTuple

from beliefnest.plan.ending import end_with

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from beliefnest.plan.cells import Keyed
    from beliefnest.plan.terms import Terms
    from beliefnest.plan.worker import Ahead, CellResult

_AHEAD = 2
"""Cells that a process has: the one that it plays, and the next one."""


class Supply:
    """Cells that are left to play, and the results that worker processes have sent.

    Args:
        cells: The cells.
        terms: Terms of the plan for the processes.
    """

    def __init__(self, cells: "Sequence[Keyed]", terms: "Terms") -> None:
        self._left = deque(cells)
        self._terms = terms
        self._lock = threading.Lock()
        self._ended: SimpleQueue[Future[Any]] = SimpleQueue()
        self._sent = 0
        self._received = 0

    def take(self) -> "Keyed | None":
        """Take a cell to play it in this process; None: none is left."""
        with self._lock:
            return self._left.popleft() if self._left else None

    def results(self, *, wait: bool) -> "Iterator[CellResult]":
        """Yield the results that have come, or, with `wait`, those of all cells that are left.

        Raises:
            BrokenProcessPool: A process ended unexpectedly.
        """
        while not self._ended.empty() or (wait and self._is_open):
            self._received += 1
            yield self._ended.get().result()

    @contextmanager
    def played_by(self, crew: "Crew") -> Iterator[None]:
        """Send cells to processes that are ready for them, until the end."""
        try:
            for each in crew.ready:
                each.add_done_callback(lambda ended: self._feed(crew.pool, ended))
            yield
        finally:
            with self._lock:
                self._left.clear()

    def _feed(self, pool: "Executor", ready: "Future[None]") -> None:
        if ready.cancelled():
            return
        if ready.exception() is not None:
            self._ended.put(ready)
            return
        for _ in range(_AHEAD):
            self._send(pool)

    @property
    def _is_open(self) -> bool:
        with self._lock:
            return bool(self._left) or self._sent > self._received

    def _send(self, pool: "Executor") -> None:
        from beliefnest.plan.worker import play_in_process

        with self._lock:
            if not self._left:
                return
            cell = self._left.popleft()
            self._sent += 1
        try:
            future = pool.submit(play_in_process, cell, self._terms)
        except Exception as error:  # noqa: BLE001 - raised again where results are read
            failed: Future[Any] = Future()
            failed.set_exception(error)
            self._ended.put(failed)
            return
        future.add_done_callback(lambda ended: self._receive(pool, ended))

    def _receive(self, pool: "Executor", ended: "Future[CellResult]") -> None:
        if ended.cancelled():
            return
        self._ended.put(ended)
        if ended.exception() is None:
            self._send(pool)


class Crew(NamedTuple):
    """Worker processes, which may play the cells of several supplies, one after the other.

    Attributes:
        pool: The processes.
        ready: Moments from which each of them plays.
    """

    pool: "Executor"
    ready: "Sequence[Future[None]]"


@contextmanager
def processes(count: int, world: str, ahead: "Ahead") -> Iterator[Crew]:
    """Start worker processes; kill them at the end.

    Args:
        count: Number of processes.
        world: Name of the world that each of them needs; empty: it depends on the cell.
        ahead: Function that launches that world.
    """
    from joblib.externals.loky import ProcessPoolExecutor

    pool = ProcessPoolExecutor(max_workers=count)
    try:
        yield Crew(pool, [pool.submit(_prepare, os.getpid(), world, ahead) for _ in range(count)])
    finally:
        # A worker may be in the middle of a long cell, and its worlds are open.
        pool.shutdown(wait=True, kill_workers=True)


def _prepare(owner: int, world: str, ahead: "Ahead") -> None:
    """Prepare this worker process: start its world, and import what it needs."""
    end_with(owner)
    # The worker ends with its process, which takes its worlds along.
    stack = ExitStack()
    launch = stack.enter_context(ahead(world, 0))
    from beliefnest.plan.worker import keep_worker

    keep_worker(stack, launch)
