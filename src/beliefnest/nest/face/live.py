"""What the parts of a nest or a simulator that act have in common."""

from beliefnest.nest.acting.engine import Engine
from beliefnest.nest.past.recording import Recording

__all__ = ["Live"]


class Live:
    """What acts through an engine, and reads what that records."""

    _engine: Engine
    _recording: Recording
