"""Append-only logs of facts, and the file they are kept in."""
