"""Assignment of policies to agents."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

from beliefnest.episodes.agent_view import Policy
from beliefnest.episodes.policies import resolve_policy
from beliefnest.episodes.record import Budget
from beliefnest.episodes.task import Task
from beliefnest.errors import InputError
from beliefnest.world.texts import quoted

if TYPE_CHECKING:  # Models take long to import, and few policies ask one.
    from beliefnest.llm.resolve import Connection

_OBJECT = "object:"


def chosen(
    task: Task, policies: Mapping[str, "str | Policy"], budget: Budget
) -> tuple[dict[str, str], dict[str, Policy]]:
    """Return the policies of all agents of a task: their names, and the policies themselves.

    Args:
        task: The task, with policies for agents that `policies` leaves out.
        policies: Policies by agent.
        budget: Limits of the episode, which its models share.

    Raises:
        InputError: A policy is for an unknown agent, or an agent has none.
        UnknownNameError: A policy does not exist.
    """
    if not isinstance(policies, Mapping):
        raise InputError(f"policies is {quoted(policies)}; give a mapping from agents to policies")
    for agent in policies:
        if agent not in task.agents:
            raise InputError(f"{quoted(agent)} is none of the agents: {', '.join(task.agents)}")
    check_played(task, policies)
    connection = None
    names: dict[str, str] = {}
    chosen: dict[str, Policy] = {}
    for agent in task.agents:
        by_itself = f"search:{task.order}"
        if task.form.scenario["agents"][agent].get("type") == "human":
            by_itself = "person"
        own = task.form.policies.get(agent, by_itself)
        policy = policies.get(agent, own)
        if not isinstance(policy, str) and not callable(getattr(policy, "act", None)):
            raise InputError(
                f"the policy of {agent} is {quoted(policy)}; give the name of a policy, or an "
                "object with act(view)"
            )
        names[agent] = name_of(policy)
        if isinstance(policy, str):
            if policy.startswith("model:"):
                connection = connection or _connection(budget)
            chosen[agent] = resolve_policy(policy, None, connection)
        else:
            chosen[agent] = policy
    return names, chosen


def check_played(task: Task, policies: Mapping[str, object]) -> None:
    """Raise InputError if an agent is no player, and neither task nor caller give it a policy."""
    form = task.form
    for agent in sorted({*task.agents} - {*task.players, *form.policies, *policies}):
        if form.scenario["agents"][agent].get("type") != "human":
            raise InputError(
                f"{agent} is no player and has no policy; give it one in the file, under "
                f"`policies`, or with --agent {agent}=POLICY"
            )


def _connection(budget: Budget) -> "Connection":
    """Return the connection of an episode's models; where it sets no limit, the usual one holds."""
    from beliefnest.llm.budget import RunLimits, RunSpending
    from beliefnest.llm.resolve import Connection

    usual = RunLimits()
    tokens = usual.tokens if budget.tokens is None else budget.tokens
    cost = usual.cost if budget.cost is None else budget.cost
    return Connection(budget=RunSpending(RunLimits(tokens, cost)))


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
                f"give it again: Episode.resume(store, {{{quoted(agent)}: {kind}(...)}})"
            )
