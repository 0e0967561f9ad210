"""Types of arrays that several rooms use."""

import numpy as np
import numpy.typing as npt

Cells = npt.NDArray[np.int64]
"""Cells of a grid: their numbers, shape (n,), or their indices, shape (n, 3)."""
Codes = npt.NDArray[np.uint16]
"""Codes of shapes."""
Flags = npt.NDArray[np.bool_]
Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int32]
States = npt.NDArray[np.int16]
"""Block states; -1: unknown."""
