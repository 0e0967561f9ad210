"""Offline model, a deterministic stand-in for a language model."""

from beliefnest.llm.offline.model import OfflineModel

__all__ = ["OfflineModel"]
