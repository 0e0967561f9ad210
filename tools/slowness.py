"""Slowness of the processors now: 1 as when nobody else uses the hardware, 2: twice as slow."""

import sys
from time import process_time

_QUIET_S = 0.2
"""Processor time of `_taken` on a quiet machine of the kind that runs `.ci/run`."""


def _taken() -> float:
    begin = process_time()
    sum(number & 7 for number in range(3_000_000))
    return process_time() - begin


if __name__ == "__main__":
    sys.stdout.write(f"{max(1.0, min(_taken() for _ in range(3)) / _QUIET_S):.2f}\n")
