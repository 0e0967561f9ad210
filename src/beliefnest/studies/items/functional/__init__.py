"""Functional items: episodes that only an agent with beliefs of their order wins."""
