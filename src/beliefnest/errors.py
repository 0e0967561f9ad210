"""Every error the package raises on purpose.

A message says what was found, where, and what to do about it. `exit_status` is the
process status the command line ends with when the error reaches it.
"""

__all__ = [
    "BeliefNestError",
    "BodyError",
    "BodyLostError",
    "BranchError",
    "ForkedError",
    "InputError",
    "MissingExtraError",
    "ModelError",
    "PathError",
    "PositionError",
    "ProgramError",
    "ScenarioError",
    "StoreError",
    "TemplateError",
    "TickError",
    "UnknownNameError",
    "WorldError",
]


class BeliefNestError(Exception):
    """Base of all errors of the package."""

    exit_status = 2


class InputError(BeliefNestError):
    """An argument is not of the form the call takes."""


class WorldError(BeliefNestError):
    """An act is impossible in the world; nothing was changed."""


class PathError(BeliefNestError):
    """A belief path is malformed or names an agent that is not in the scenario."""


class ForkedError(BeliefNestError):
    """Something is used in another process than the one that opened it."""


class PositionError(BeliefNestError):
    """A position lies outside the box of the scenario."""


class TickError(BeliefNestError):
    """A tick lies in the future or before the start of the timeline."""


class UnknownNameError(BeliefNestError):
    """A block, item, agent, scenario, world, filter or model of that name does not exist."""


class MissingExtraError(UnknownNameError):
    """A package that an extra installs is not there; the message gives the command.

    Args:
        what: What needs it, as a beginning of a sentence.
        extra: Name of the extra.
        instead: What else can be done.
    """

    def __init__(self, what: str, extra: str, instead: str = "") -> None:
        super().__init__(f'{what}: pip install "beliefnest[{extra}]"{instead}')


class ScenarioError(BeliefNestError):
    """A scenario file is wrong; the message names file, line and key."""


class TemplateError(BeliefNestError):
    """A prompt template cannot be rendered; the message names the line."""


class BranchError(BeliefNestError):
    """A branch cannot be selected, forked, renamed or deleted as asked."""


class StoreError(BeliefNestError):
    """A run file is damaged, foreign, newer than this program, or locked by a writer."""


class NotBegunError(StoreError):
    """A run was stopped while it began: there is nothing in its file that could go on."""


class ProgramError(BeliefNestError):
    """An agent program failed where its success was required."""


class BodyError(BeliefNestError):
    """The Minecraft side failed to start, died, or broke the channel's protocol."""

    exit_status = 3


class BodyLostError(BodyError):
    """The process behind a body ended; what was asked of it counts as not having happened."""


class ModelError(BeliefNestError):
    """A language model is not available, refused, or gave no usable answer."""

    exit_status = 3
