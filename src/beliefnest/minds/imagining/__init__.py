"""Possible courses of unseen events, drawn as weighted histories; see docs/imagine.md."""
