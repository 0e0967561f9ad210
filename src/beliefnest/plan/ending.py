"""End of worker processes whose owner has ended."""

import os
import threading
import time

_EVERY_S = 0.5


def end_with(owner: int) -> None:
    """End this process when its owner has ended, in whatever way.

    A killed owner cannot end its workers, and a pool's workers wait minutes for further work.
    Ending them loses nothing: only the owner keeps results.

    Args:
        owner: Id of the process that started this one.
    """
    threading.Thread(target=_watch, args=(owner,), name="owner", daemon=True).start()


def _watch(owner: int) -> None:
    # A process whose parent has ended gets another parent. Poll for it: no notification of it
    # works on all systems.
    while os.getppid() == owner:
        time.sleep(_EVERY_S)
    os._exit(1)
