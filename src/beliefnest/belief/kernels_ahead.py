"""Import of the compiled kernels in a thread, while Node works and Python would wait."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress


@contextmanager
def kernels_ahead() -> Iterator[None]:
    """Import the kernels of belief beside the block; wait for the import at the end.

    Numba takes longer to import than anything else here, and a simulator needs it only when its
    first belief is computed. A failure is not told here: the code that needs a kernel imports it
    again and tells it.
    """
    thread = threading.Thread(target=_import, name="import of the kernels", daemon=True)
    thread.start()
    try:
        yield
    finally:
        thread.join()


def _import() -> None:
    with suppress(ImportError):
        from beliefnest.belief import kernel  # noqa: F401 # only to have it loaded
