"""Studies: many variations of scenarios with several models, to one table with intervals."""
