"""Append-only logs of facts, and the run files that store them."""
