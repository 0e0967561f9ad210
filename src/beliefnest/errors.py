"""Errors that the package raises.

A message says what is wrong, where, and what to do. `exit_status` is the exit status of the
command line after the error.
"""


class BeliefNestError(Exception):
    """Base of all errors of the package."""

    exit_status = 2


class InputError(BeliefNestError):
    """An argument has a wrong form or value."""


class TooLargeError(InputError):
    """An answer needs more memory or time than there is; nothing of it was computed."""


class WorldError(BeliefNestError):
    """An act is impossible in the world; it changed nothing."""


class PathError(BeliefNestError):
    """A belief path is malformed or names an agent that is not in the scenario."""


class ForkedError(BeliefNestError):
    """An object is used in another process than the one that opened it."""


class PositionError(BeliefNestError):
    """A position lies outside the box of the scenario."""


class TickError(BeliefNestError):
    """A tick lies in the future or before the start of the timeline."""


class UnknownNameError(BeliefNestError):
    """A block, item, agent, scenario, world, filter or model of that name does not exist."""


class MissingExtraError(UnknownNameError):
    """A package that belongs to an extra is missing; the message has the command to install it.

    Args:
        what: Beginning of the message: the feature that needs the package.
        extra: Name of the extra.
        instead: End of the message: an alternative.
    """

    def __init__(self, what: str, extra: str, instead: str = "") -> None:
        super().__init__(f'{what}: pip install "beliefnest[{extra}]"{instead}')


class ScenarioError(BeliefNestError):
    """A scenario file is invalid; the message names file, line and key."""


class TemplateError(BeliefNestError):
    """A prompt template cannot be rendered; the message names the line."""


class BranchError(BeliefNestError):
    """A branch cannot be selected, forked, renamed or deleted."""


class StoreError(BeliefNestError):
    """A run file is damaged, foreign, of another format, or locked by a writer."""


class NotBegunError(StoreError):
    """A run was stopped before its first tick was stored, so there is nothing to continue."""


class ProgramError(BeliefNestError):
    """An agent program failed where it had to succeed."""


class BodyError(BeliefNestError):
    """The Minecraft process failed to start, died, or broke the protocol of the channel."""

    exit_status = 3


class BodyLostError(BodyError):
    """The process of a body died; the requested acts count as not done."""


class WorkerError(BeliefNestError):
    """A process that works for this one has ended unexpectedly."""

    exit_status = 3


class ModelError(BeliefNestError):
    """A language model is not available, refused, or gave no usable answer."""

    exit_status = 3
