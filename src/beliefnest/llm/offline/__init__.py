"""Offline model, a deterministic stand-in for a language model."""

from beliefnest.llm.offline.offline_model import OfflineModel

__all__ = ["OfflineModel"]
