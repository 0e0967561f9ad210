"""Runs and studies as pandas data frames (extra `study`), joined by the column `cell`."""

from beliefnest.adapters.dataframes.tables import (
    beliefs_df,
    cells_df,
    claims_df,
    episodes_df,
    events_df,
    probes_df,
    requests_df,
    rounds_df,
)

__all__ = [
    "beliefs_df",
    "cells_df",
    "claims_df",
    "episodes_df",
    "events_df",
    "probes_df",
    "requests_df",
    "rounds_df",
]
