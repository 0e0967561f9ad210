"""Claims of a recorded run, as a table and as plain data."""

from collections.abc import Collection, Sequence

from rich import box
from rich.console import Console
from rich.measure import Measurement
from rich.table import Table
from rich.text import Text

from beliefnest.belief.context import BeliefContext
from beliefnest.belief.node_memory import paths_with_room
from beliefnest.cli.console import folded
from beliefnest.cli.terminal_text import printable
from beliefnest.nest.explain.made_claims import MadeClaim
from beliefnest.scenarios.naming import container_name, place_name
from beliefnest.scenarios.scenario import Scenario
from beliefnest.world.claims import Claim, ClaimKind
from beliefnest.world.paths import parse_path, path_text


def claims_json(claims: Sequence[MadeClaim], paths: Collection[str]) -> list[dict[str, object]]:
    """Return claims as plain data.

    Args:
        claims: The claims.
        paths: Beliefs; the result says for each if and why it took up each claim.
    """
    return [
        {
            "tick": claim.tick,
            "speaker": claim.speaker,
            "addressee": claim.addressee,
            "text": claim.text,
            "claim": claim.claim.plain(),
            "claims_from": claim.claims_from,
            "hearers": list(claim.hearers),
            "false": claim.false,
            "lie": claim.lie,
            "beliefs": {
                path: {"taken_up": claim.taken_up(path), "why": claim.why(path)} for path in paths
            },
        }
        for claim in claims
    ]


def claims_table(claims: Sequence[MadeClaim], path: str, scenario: Scenario) -> Table:
    """Return a table of claims, their hearers, and the verdict of one belief.

    Args:
        claims: The claims; not empty.
        path: Path of the simulator that is shown.
        scenario: Scenario with the names of containers and places.
    """
    table = _begun()
    table.add_column("heard by")
    # The world in which a claim is made is no belief, and has no verdict on it.
    is_belief = claims[0].made_in != path
    if is_belief:
        table.add_column(f"in {path}")
    for claim in claims:
        hearers = printable(", ".join(claim.hearers))
        why = [claim.why(path)] if is_belief else []
        table.add_row(*map(Text, (*_cells(claim, scenario), hearers, *why)))
    return table


def print_claims(
    console: Console, claims: Sequence[MadeClaim], paths: Sequence[str], scenario: Scenario
) -> None:
    """Print every claim, and if and why each of the given beliefs took it up.

    The table has a column for each belief. If the console is too narrow for it, each claim is
    printed on a line, followed by a line for each verdict with the beliefs that reached it.
    """
    table = _begun()
    for path in paths:
        table.add_column(path)
    for made in claims:
        table.add_row(
            *map(Text, (*_cells(made, scenario), *(_verdict(made, path) for path in paths)))
        )
    # Rich limits the measured width to `max_width`.
    least = Measurement.get(console, console.options.update(max_width=10_000), table).minimum
    if least <= console.width:
        console.print(table)
        return
    for made in claims:
        tick, speaker, claim, kind = _cells(made, scenario)
        suffix = f" ({kind})" if kind else ""
        console.print(Text(f"tick {tick}, {speaker}: {claim}{suffix}"))
        console.print(folded(_by_verdict(made, paths)))


def _by_verdict(claim: MadeClaim, paths: Sequence[str]) -> Table:
    """Return a table with a row for each verdict on a claim and the beliefs that reached it."""
    paths_by_verdict: dict[str, list[str]] = {}
    for path in paths:
        taken = _verdict(claim, path).replace("yes", "taken up").replace("no (", "not taken up (")
        paths_by_verdict.setdefault(taken, []).append(path)
    table = Table(box=None, show_header=False, padding=(0, 0, 0, 2))
    for verdict in sorted(paths_by_verdict):
        table.add_row(verdict, Text(", ".join(paths_by_verdict[verdict])))
    return table


def paths_of_beliefs(claims: Sequence[MadeClaim], context: BeliefContext, depth: int) -> list[str]:
    """Return the paths of all beliefs below the world in which claims were made.

    Args:
        claims: The claims; not empty.
        context: The part that all simulators share.
        depth: Greatest number of names in a path below that world.

    Returns:
        The paths, shallow ones first.

    Raises:
        InputError: The depth is so great that memory has no room for the beliefs.
    """
    world = parse_path(claims[0].made_in, context.agents)
    return [path_text(path) for path in paths_with_room(context, world, depth)[1:]]


def _begun() -> Table:
    return Table("tick", "speaker", "claim", "", box=box.SIMPLE, title_justify="left")


def _cells(claim: MadeClaim, scenario: Scenario) -> list[str]:
    to = "" if claim.addressee is None else f" to {claim.addressee}"
    kind = "a lie" if claim.lie else "false" if claim.false else ""
    row = (str(claim.tick), f"{claim.speaker or 'a sign'}{to}", _words(claim.about, scenario), kind)
    return [printable(cell) for cell in row]


def _words(claim: Claim, scenario: Scenario) -> str:
    """Return a claim in words, with the scenario's names of containers and places."""
    if claim.kind is ClaimKind.POSITION:
        x, y, z = claim.place
        return claim.about(place_name((x, y, z), scenario.setting))
    return claim.about(container_name(claim.cell, scenario.setting))


def _verdict(claim: MadeClaim, path: str) -> str:
    condition = claim.condition(path)
    why = "" if condition is None else f" ({condition})"
    if claim.taken_up(path):
        return f"yes{why}"
    return f"no{why}" if why or claim.is_heard(path) else "not heard"
