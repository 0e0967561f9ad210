"""Figures and plots that nests and simulators return, as values for `pictures`."""
