"""How much longer this machine's processor takes now than when nobody else uses its hardware."""

from time import process_time

_QUIET_S = 0.2
"""Processor time of `_taken` on a quiet machine of two processors, of the kind that runs `.ci/run`."""


def _taken() -> float:
    begin = process_time()
    sum(number & 7 for number in range(3_000_000))
    return process_time() - begin


if __name__ == "__main__":
    print(round(max(1.0, min(_taken() for _ in range(3)) / _QUIET_S), 2))
