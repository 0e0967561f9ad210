"""Requests to policies; a policy that fails or is slow loses only its own round."""

import threading
import traceback
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import msgspec

from beliefnest.episodes.agent_view import GO_ON, AgentView, Policy
from beliefnest.episodes.decided import Decision, RoundPart, Spent
from beliefnest.errors import InputError, ModelError
from beliefnest.llm.asking import NoUsableProgramError
from beliefnest.llm.failures import UnavailableModelError, UnusableAnswerError
from beliefnest.world.texts import is_well_formed

_LONGEST = 100_000
"""Greatest length of a program in characters."""
_OF_ANSWERS = (NoUsableProgramError, UnusableAnswerError)
"""Errors about an answer that came: it is the model's result."""


class ReplayedPolicy(msgspec.Struct, frozen=True):
    """Policy that repeats recorded decisions, round by round."""

    decisions: Sequence[Decision]

    def act(self, view: AgentView) -> str:
        """Return the program of the round."""
        return self.decisions[view.round].program


def replayed(parts: Sequence[RoundPart], agents: Iterable[str]) -> dict[str, Policy]:
    """Return policies of agents that repeat recorded decisions."""
    return {
        agent: ReplayedPolicy([part.decisions[agent] for part in parts if agent in part.decisions])
        for agent in agents
    }


@dataclass
class _Answer:
    decision: Decision | None = None
    unavailable: UnavailableModelError | None = None


class Asker:
    """Asker of the policies of one episode.

    Args:
        policies: Policies by agent.
        patience_s: Seconds after which a policy loses its round; None: no limit.

    Attributes:
        model_errors: Errors of requests to which no answer came.

    Raises:
        InputError: `patience_s` is not above 0.
    """

    def __init__(self, policies: Mapping[str, Policy], patience_s: float | None) -> None:
        if patience_s is not None and not patience_s > 0:
            raise InputError(f"patience is {patience_s!r} s; give more than 0, or None to wait")
        self._policies = policies
        self._patience_s = patience_s
        self._waiting: dict[str, threading.Thread] = {}
        self._late: dict[str, _Answer] = {}
        self.model_errors: list[ModelError] = []

    def ask(self, view: AgentView) -> Decision:
        """Return the program of a round; a policy that is too late gives none.

        Raises:
            UnavailableModelError: The policy's model cannot be asked at all.
        """
        agent = view.agent
        policy = self._policies[agent]
        if isinstance(policy, ReplayedPolicy):
            return policy.decisions[view.round]
        if self._patience_s is None:
            return _decided(policy, view, self.model_errors)
        thread = self._waiting.get(agent)
        if thread is not None and thread.is_alive():
            return Decision(fault="it is still at an earlier round")
        # Count the cost of late answers as well.
        late = self._late.pop(agent, _Answer()).decision
        before = Spent() if late is None else late.spent
        answer = _Answer()

        def decide() -> None:
            try:
                answer.decision = _decided(policy, view, self.model_errors)
            except UnavailableModelError as error:
                answer.unavailable = error

        # A daemon thread: a policy that never returns must not keep the process from ending.
        thread = threading.Thread(target=decide, name=f"policy of {agent}", daemon=True)
        self._waiting[agent] = thread
        thread.start()
        thread.join(self._patience_s)
        decision = answer.decision
        if answer.unavailable is not None:
            raise answer.unavailable
        if decision is None:
            self._late[agent] = answer
            return Decision(fault=f"it took more than {self._patience_s:g} s", spent=before)
        return msgspec.structs.replace(decision, spent=before + decision.spent)


def slots_of(agents: tuple[str, ...], *, turns: bool) -> tuple[tuple[str, ...], ...]:
    """Return the agents that act together in each part of a round, in order."""
    return tuple((agent,) for agent in agents) if turns else (agents,)


def _decided(policy: Policy, view: AgentView, model_errors: list[ModelError]) -> Decision:
    """Return the decision of a policy, with the number of times that it asked a model again.

    Args:
        policy: The policy.
        view: Its view.
        model_errors: List to which an error is added if no answer came of a model.
    """
    before = _asked_again(policy)
    decision = _decision(policy, view, model_errors)
    return msgspec.structs.replace(decision, asked_again=_asked_again(policy) - before)


def _asked_again(policy: Policy) -> int:
    asked = getattr(policy, "asked_again", 0)
    return asked if isinstance(asked, int) else 0


def _outcome(error: BaseException) -> str:
    """Return the outcome of a model's answer that gave no program; empty: there was none."""
    match error:
        case NoUsableProgramError():
            return error.outcome
        case ModelError():
            return "no_answer"
        case _:
            return ""


def _decision(policy: Policy, view: AgentView, model_errors: list[ModelError]) -> Decision:
    own = _spent(policy)

    def spent_by_now() -> Spent:
        return view.spent + (_spent(policy) - own)

    try:
        program: object = policy.act(view)
    except UnavailableModelError:
        raise
    except (Exception, SystemExit) as error:  # noqa: BLE001 - a policy may be anybody's, and raise anything
        if isinstance(error, ModelError) and not isinstance(error, _OF_ANSWERS):
            model_errors.append(error)
        fault = f"{_place_of(error)}{type(error).__name__}: {error}"
        return Decision(fault=fault[:1000], spent=spent_by_now(), outcome=_outcome(error))
    spent = spent_by_now()
    fault = ""
    if program is None:
        program = ""
    if not isinstance(program, str):
        fault = f"it gave no text, but {type(program).__name__}"
    elif len(program) > _LONGEST:
        fault = f"it gave {len(program)} characters; a program has at most {_LONGEST}"
    elif not is_well_formed(program):
        fault = "its program has half of a character in it"
    if fault or not isinstance(program, str):
        return Decision(fault=fault, spent=spent)
    if program.strip() == GO_ON:
        if view.last.how != "cut":
            return Decision(fault="it has no interrupted program to continue")
        return Decision(view.last.program, spent=spent, goes_on=True, considered=view.considered)
    return Decision(program if program.strip() else "", spent=spent, considered=view.considered)


def _place_of(error: BaseException) -> str:
    """Return the line of a policy's own file at which it failed, such as `mine.py:7: `.

    A run has only the name of the file, so that it does not depend on the folder.
    """
    frames = traceback.extract_tb(error.__traceback__)[1:]
    own = [frame for frame in frames if frame.filename == frames[0].filename]
    return f"{Path(own[-1].filename).name}:{own[-1].lineno}: " if own else ""


def _spent(policy: Policy) -> Spent:
    """Return what a policy says that it spent on models that it asks without `view.noting`."""
    spent = getattr(policy, "spent", None)
    return spent if isinstance(spent, Spent) else Spent()
