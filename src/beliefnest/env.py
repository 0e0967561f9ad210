"""Scenarios and tasks as environments of PettingZoo and Gymnasium (extra `pettingzoo`)."""

from beliefnest.adapters.pettingzoo import aec_env, parallel_env, vector_env

__all__ = ["aec_env", "parallel_env", "vector_env"]
