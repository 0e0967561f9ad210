"""Plan of cells: the only way to play many things, in this process, in several, or on a cluster.

A cell says how it is played (`Keyed`); scenarios are played by `scenario_cells.Cell`. `run_cells`
plays the cells that have no result yet, and writes each result as soon as it is known.
"""
