"""The end of processes that would outlive the one that they work for."""

import os
import threading
import time

__all__ = ["end_with"]

_EVERY_S = 0.5


def end_with(owner: int) -> None:
    """End this process once the one that started it is gone, however that ended.

    Who is killed ends nobody, and a pool's workers wait for minutes for what is to be done next.
    Nothing is lost: what a worker came to is kept by its owner alone.

    Args:
        owner: Process that started this one.
    """
    threading.Thread(target=_watch, args=(owner,), name="owner", daemon=True).start()


def _watch(owner: int) -> None:
    # A process whose parent ended gets another parent. There is no way to be told of it everywhere.
    while os.getppid() == owner:
        time.sleep(_EVERY_S)
    os._exit(1)
