"""Studies: play many variations of scenarios with several models; tabulate with intervals."""
