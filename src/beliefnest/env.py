"""Scenarios as multi-agent environments of PettingZoo (extra `pettingzoo`)."""

from beliefnest.adapters.pettingzoo import parallel_env

__all__ = ["parallel_env"]
