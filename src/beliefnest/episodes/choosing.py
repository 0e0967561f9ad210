"""Assignment of policies to agents."""

from collections.abc import Mapping

from beliefnest.episodes.agent_view import Policy
from beliefnest.episodes.policies import resolve_policy
from beliefnest.episodes.task import Task
from beliefnest.errors import InputError

__all__ = ["check_resumable", "chosen", "name_of"]

_OBJECT = "object:"


def chosen(
    task: Task, policies: Mapping[str, "str | Policy"]
) -> tuple[dict[str, str], dict[str, Policy]]:
    """Return the policies of all agents of a task: their names, and the policies themselves.

    Args:
        task: The task, with policies for agents that `policies` leaves out.
        policies: Policies by agent.

    Raises:
        InputError: A policy is for an unknown agent.
        UnknownNameError: A policy does not exist.
    """
    if not isinstance(policies, Mapping):
        raise InputError(f"policies is {policies!r}; give a mapping from agents to policies")
    for agent in policies:
        if agent not in task.agents:
            raise InputError(f"{agent!r} is none of the agents: {', '.join(task.agents)}")
    names: dict[str, str] = {}
    chosen: dict[str, Policy] = {}
    for agent in task.agents:
        by_itself = f"search:{task.order}"
        if task.form.scenario["agents"][agent].get("type") == "human":
            by_itself = "person"
        own = task.form.policies.get(agent, by_itself)
        given = policies.get(agent, own)
        if not isinstance(given, str) and not callable(getattr(given, "act", None)):
            raise InputError(
                f"the policy of {agent} is {given!r}; give the name of a policy, or an object with "
                "act(view)"
            )
        names[agent] = name_of(given)
        chosen[agent] = resolve_policy(given) if isinstance(given, str) else given
    return names, chosen


def name_of(policy: "str | Policy") -> str:
    """Return the name of a policy in runs."""
    return policy if isinstance(policy, str) else f"{_OBJECT}{type(policy).__name__}"


def check_resumable(policies: Mapping[str, "str | Policy"]) -> None:
    """Check that all policies of a run can be created from their names.

    Raises:
        InputError: A policy was an object, which the run cannot hold.
    """
    for agent, policy in policies.items():
        if isinstance(policy, str) and policy.startswith(_OBJECT):
            kind = policy.removeprefix(_OBJECT)
            raise InputError(
                f"{agent} was played by an object of the class {kind}, which is not in the file; "
                f"give it again: Episode.resume(store, {{{agent!r}: {kind}(...)}})"
            )
