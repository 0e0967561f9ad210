"""The offline model."""

from beliefnest.llm.offline.model import OfflineModel

__all__ = ["OfflineModel"]
