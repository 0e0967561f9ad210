"""Expected states of simulators: facts, each with a label for tables."""

from dataclasses import dataclass
from typing import Annotated, Any

from beliefnest.facts.kinds import Fact, FactEntry
from beliefnest.facts.reading import check_entry, fact_in
from beliefnest.scenarios.checks import Checks
from beliefnest.scenarios.document import KeyPath
from beliefnest.world.forms import note


class ExpectationEntry(FactEntry, frozen=True, kw_only=True):
    """An expected fact about a simulator."""

    path: Annotated[str, note("Belief path; / is the real world.", "path")]
    label: Annotated[str, note("A name for tables and overrides.", "keep")] = ""


@dataclass(frozen=True, slots=True)
class Expectation:
    """Expectation about a simulator after the script.

    Attributes:
        path: Path of the simulator.
        fact: Expected fact.
        label: Name for tables.
    """

    path: str
    fact: Fact
    label: str = ""

    @classmethod
    def read(cls, entry: ExpectationEntry, path: KeyPath, checks: Checks) -> "Expectation":
        """Return the expectation of an entry.

        Raises:
            ScenarioError: The entry is no expectation, or names something that does not exist.
        """
        return cls(entry.path, fact_in(check_entry(entry, path, checks)), entry.label)

    def written(self) -> dict[str, Any]:
        """Return plain values: path, label, and the fact with the keys of scenario files."""
        return {"path": self.path, "label": self.label, "expected": self.fact.written()}

    @property
    def where(self) -> str:
        """Return the simulator for people: `reality`, or its path."""
        return "reality" if self.path == "/" else self.path
