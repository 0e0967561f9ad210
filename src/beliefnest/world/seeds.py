"""Seeds of random numbers."""

import operator

from beliefnest.errors import InputError


def checked_seed(seed: object, name: str = "seed") -> int:
    """Return a valid seed as a Python number; NumPy numbers are converted.

    Raises:
        InputError: The seed is not a whole number of 64 bits; the message calls it `name`.
    """
    try:
        number = operator.index(seed)  # type: ignore[arg-type] # whatever a caller gives
    except TypeError:
        number = None
    if number is None or not -(2**63) <= number < 2**63:
        raise InputError(f"{name} is {str(seed)[:50]!r}; give a whole number of 64 bits")
    return number
