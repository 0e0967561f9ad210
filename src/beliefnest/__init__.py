"""BeliefNest: nested belief simulators for embodied agents with a Theory of Mind.

`__all__` lists the public surface. Each name is imported on first use, so that `import
beliefnest` is fast.
"""

import importlib
from typing import TYPE_CHECKING

from beliefnest.version import VERSION

if TYPE_CHECKING:  # Each name is imported when it is first used.
    from beliefnest.belief.entries import InitialBelief
    from beliefnest.bodies.limits import ProcessLimits
    from beliefnest.bodies.protocol import ProgramResult
    from beliefnest.episodes.episode import Episode
    from beliefnest.episodes.record import Budget
    from beliefnest.episodes.task import Task
    from beliefnest.episodes.view import GO_ON, AgentView
    from beliefnest.errors import (
        BeliefNestError,
        BodyError,
        BranchError,
        ForkedError,
        InputError,
        ModelError,
        PathError,
        PositionError,
        ProgramError,
        ScenarioError,
        StoreError,
        TemplateError,
        TickError,
        UnknownNameError,
        WorldError,
    )
    from beliefnest.minds.inference import Inference
    from beliefnest.minds.model import MindModel, simplex_grid
    from beliefnest.nest.explain.comparison import Difference, Pose
    from beliefnest.nest.explain.explanation import Explanation
    from beliefnest.nest.explain.parts import Contents
    from beliefnest.nest.face.exploration import Attempt
    from beliefnest.nest.face.imagining import History, ImaginationWarning, Imagined
    from beliefnest.nest.face.nest import Nest
    from beliefnest.nest.face.simulator import Simulator
    from beliefnest.perception.options import Perception, Radius
    from beliefnest.scenarios import Scenario
    from beliefnest.studies.result import StudyResult
    from beliefnest.studies.study import Study
    from beliefnest.world.claims import Claim, ClaimKind
    from beliefnest.world.scripted import ScriptedWorld

__version__ = VERSION

__all__ = [
    "GO_ON",
    "AgentView",
    "Attempt",
    "BeliefNestError",
    "BodyError",
    "BranchError",
    "Budget",
    "Claim",
    "ClaimKind",
    "Contents",
    "Difference",
    "Episode",
    "Explanation",
    "ForkedError",
    "History",
    "ImaginationWarning",
    "Imagined",
    "Inference",
    "InitialBelief",
    "InputError",
    "MindModel",
    "ModelError",
    "Nest",
    "PathError",
    "Perception",
    "Pose",
    "PositionError",
    "ProcessLimits",
    "ProgramError",
    "ProgramResult",
    "Radius",
    "Scenario",
    "ScenarioError",
    "ScriptedWorld",
    "Simulator",
    "StoreError",
    "Study",
    "StudyResult",
    "Task",
    "TemplateError",
    "TickError",
    "UnknownNameError",
    "WorldError",
    "__version__",
    "simplex_grid",
]

_HOMES = {
    "GO_ON": "beliefnest.episodes.view",
    "AgentView": "beliefnest.episodes.view",
    "Attempt": "beliefnest.nest.face.exploration",
    "Budget": "beliefnest.episodes.record",
    "Claim": "beliefnest.world.claims",
    "ClaimKind": "beliefnest.world.claims",
    "Contents": "beliefnest.nest.explain.parts",
    "Difference": "beliefnest.nest.explain.comparison",
    "Episode": "beliefnest.episodes.episode",
    "Explanation": "beliefnest.nest.explain.explanation",
    "History": "beliefnest.nest.face.imagining",
    "ImaginationWarning": "beliefnest.nest.face.imagining",
    "Imagined": "beliefnest.nest.face.imagining",
    "Inference": "beliefnest.minds.inference",
    "InitialBelief": "beliefnest.belief.entries",
    "MindModel": "beliefnest.minds.model",
    "Nest": "beliefnest.nest.face.nest",
    "Perception": "beliefnest.perception.options",
    "Pose": "beliefnest.nest.explain.comparison",
    "ProcessLimits": "beliefnest.bodies.limits",
    "ProgramResult": "beliefnest.bodies.protocol",
    "Radius": "beliefnest.perception.options",
    "Scenario": "beliefnest.scenarios",
    "ScriptedWorld": "beliefnest.world.scripted",
    "Simulator": "beliefnest.nest.face.simulator",
    "Study": "beliefnest.studies.study",
    "StudyResult": "beliefnest.studies.result",
    "Task": "beliefnest.episodes.task",
    "simplex_grid": "beliefnest.minds.model",
}


def __getattr__(name: str) -> object:
    if name not in __all__:
        raise AttributeError(f"beliefnest has no {name!r}; it has {', '.join(__all__)}")
    return getattr(importlib.import_module(_HOMES.get(name, "beliefnest.errors")), name)


def __dir__() -> list[str]:
    return __all__
