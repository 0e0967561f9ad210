"""Replacement of kernels that are not compiled yet; this module imports no numba."""

from collections.abc import Callable
from contextvars import ContextVar
from typing import Any

INSTEAD: ContextVar[Callable[[Any, Any], Callable[..., Any] | None]] = ContextVar("INSTEAD")
"""Function of a kernel and of the types of its arguments, for which no machine code is stored.

It returns what is called this time, or None: the kernel is compiled now.
"""
