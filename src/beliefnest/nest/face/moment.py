"""When a nest or a simulator is looked at."""

from beliefnest.nest.past.recording import Recording

__all__ = ["AtMoment"]


class AtMoment:
    """What is read of a recording, at one tick or at the latest of each timeline."""

    _recording: Recording

    def _moment(self) -> int | None:
        """The tick; None: the latest of the timeline that a simulator is on."""
        return None
