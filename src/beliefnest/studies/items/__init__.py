"""Benchmark items: the questions of a study with exact right answers, and sets of them."""
