"""Loading of scenarios: find the document, apply the condition, and check the content."""

from collections.abc import Callable, Mapping

from msgspec.structs import replace

from beliefnest.errors import ScenarioError
from beliefnest.scenarios.build import build_scenario
from beliefnest.scenarios.content import ScenarioContent
from beliefnest.scenarios.document import Document, YamlNode, merged, wrapped
from beliefnest.scenarios.document_form import check_form, check_written
from beliefnest.scenarios.drawn_map import with_map
from beliefnest.scenarios.format import ScenarioFile
from beliefnest.scenarios.older_spellings import respelled
from beliefnest.scenarios.parameters import text_of, with_parameters
from beliefnest.world.texts import quoted

DocumentChange = Callable[[Document], Document]
"""Function from a document to a changed document."""


def condition_number(condition: int | str | None) -> int | None:
    """Return the number of a condition, which may be given as text.

    Raises:
        ScenarioError: `condition` is no number.
    """
    if condition is None or (isinstance(condition, int) and not isinstance(condition, bool)):
        return condition
    if isinstance(condition, str) and condition.strip().isdecimal():
        return int(condition)
    raise ScenarioError(f"{quoted(condition)} is no condition; give its number")


def condition_numbers(document: Document) -> tuple[int | None, ...]:
    """Return the numbers of a document's conditions, in order; only None if it has none.

    Raises:
        ScenarioError: The document does not have the right form.
    """
    return tuple(sorted(check_written(with_parameters(respelled(document), {})).conditions)) or (
        None,
    )


def scenario_in(
    document: Document,
    condition: int | None,
    parameters: Mapping[str, object] | None = None,
    change: DocumentChange | None = None,
) -> ScenarioContent:
    """Return the scenario of a document after applying parameters, a condition, and a change.

    Args:
        document: The document as written.
        condition: Number of a condition; None: the document without overrides.
        parameters: Values of parameters, by name; the others have their defaults.
        change: Function that changes the document after the condition is merged in, for example
            to a mirrored scene; None: no change.

    Raises:
        ScenarioError: The document is wrong, or a condition or parameter does not exist.
    """
    filled = with_parameters(respelled(document), parameters or {}, condition)
    written = check_written(filled)
    chosen = with_map(filled if condition is None else merged(filled, condition))
    if change is None:
        if parameters:
            chosen = replace(chosen, text=text_of(filled.root))
    else:
        about = {
            number: {"description": str(other.get("description", ""))}
            for number, other in written.conditions.items()
        }
        chosen = change(chosen)
        described = YamlNode({**chosen.root.value, "conditions": wrapped(about)})
        chosen = replace(chosen, text=text_of(described))
    same = chosen.root is filled.root
    file = written if same and isinstance(written, ScenarioFile) else check_form(chosen)
    return build_scenario(chosen, file, condition, written.conditions)
