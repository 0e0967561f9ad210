"""Runs and studies as pandas data frames (extra `study`), joined by the column `cell`."""

from beliefnest.adapters.dataframes.tables import *  # noqa: F403  # the names are listed there
from beliefnest.adapters.dataframes.tables import __all__  # noqa: F401  # star imports leave it out
