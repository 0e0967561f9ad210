"""Slowness of the machine now: 1 as when nobody else uses the hardware, 2: twice as slow."""

import random
import sys
from collections.abc import Callable
from time import process_time

_QUIET_SUM_S = 0.2
_QUIET_LOOK_S = 0.36
"""Processor times of the two samples on a quiet machine of the kind that runs `.ci/run`.

The second is estimated: two thirds of 0.54 s, which it took on a machine whose tests took one and a
half times as long."""
_ENTRIES = 500_000


def _taken(act: Callable[[], object]) -> float:
    begin = process_time()
    act()
    return process_time() - begin


def _slowness() -> float:
    """Return the slowness of what computes or of what waits for memory, whichever is greater."""
    texts = {number: str(number) for number in range(_ENTRIES)}
    order = random.Random(1).sample(range(_ENTRIES), _ENTRIES)
    summed = min(_taken(lambda: sum(number & 7 for number in range(3_000_000))) for _ in range(3))
    looked_up = min(_taken(lambda: sum(len(texts[each]) for each in order)) for _ in range(3))
    return max(1.0, summed / _QUIET_SUM_S, looked_up / _QUIET_LOOK_S)


if __name__ == "__main__":
    sys.stdout.write(f"{_slowness():.2f}\n")
