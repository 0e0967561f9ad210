"""Who plays whom."""

from collections.abc import Mapping

from beliefnest.episodes.policies import resolve_policy
from beliefnest.episodes.task import Task
from beliefnest.episodes.view import Policy
from beliefnest.errors import InputError

__all__ = ["check_resumable", "chosen", "name_of"]

_OBJECT = "object:"


def chosen(
    task: Task, policies: Mapping[str, "str | Policy"]
) -> tuple[dict[str, str], dict[str, Policy]]:
    """Return policies of all agents of a task, in words and as they act.

    Args:
        task: The task, which says who plays those that are left out.
        policies: By agent.

    Raises:
        InputError: There is a policy for nobody.
        UnknownNameError: There is no such policy.
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
                f"the policy of {agent} is {given!r}; give the name of one, or an object with "
                "act(view)"
            )
        names[agent] = name_of(given)
        chosen[agent] = resolve_policy(given) if isinstance(given, str) else given
    return names, chosen


def name_of(policy: "str | Policy") -> str:
    """What a run calls a policy."""
    return policy if isinstance(policy, str) else f"{_OBJECT}{type(policy).__name__}"


def check_resumable(policies: Mapping[str, "str | Policy"]) -> None:
    """See that all policies that a run names can be made anew.

    Raises:
        InputError: One was an object, which no file holds.
    """
    for agent, policy in policies.items():
        if isinstance(policy, str) and policy.startswith(_OBJECT):
            kind = policy.removeprefix(_OBJECT)
            raise InputError(
                f"{agent} was played by an object of the class {kind}, which no file holds; "
                f"give it again: Episode.resume(store, {{{agent!r}: {kind}(...)}})"
            )
