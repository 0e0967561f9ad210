"""Plan of a study of scenarios: one cell for each combination."""

import dataclasses
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path

from msgspec.structs import replace

from beliefnest.errors import BeliefNestError, InputError
from beliefnest.plan.cells import Invalid, Plan
from beliefnest.plan.scenario_cells import Cell, CellKey, content_of
from beliefnest.prompts.templates import BUILT_IN_TEMPLATES, Template
from beliefnest.scenarios.document import Document, KeyPath
from beliefnest.scenarios.loading import condition_numbers
from beliefnest.scenarios.parameters import declared_in
from beliefnest.scenarios.scenario import Scenario
from beliefnest.studies.allocation import balanced, latin_lists
from beliefnest.studies.checking import StudyKeyError
from beliefnest.studies.design import Design
from beliefnest.studies.random_variations import drawn_variations
from beliefnest.studies.variation import CHANGES, Variation, listed_variations
from beliefnest.world.texts import quoted
from beliefnest.world.words import nearest_or_all


def plan_cells(
    design: Design,
    documents: Mapping[str, Document],
    on_variation: Callable[[int, int], None] = lambda done, total: None,
) -> Plan[Cell]:
    """Return the plan of a study.

    Args:
        design: Design of the study.
        documents: Documents of its scenarios, by name or path.
        on_variation: Function that receives the number of checked variations of a scenario, and
            the number of all.

    Raises:
        ScenarioError: A scenario is wrong even without any variation.
        InputError: Two scenarios have the same name, or no scenario declares a parameter.
    """
    _check_names(design, documents)
    cells: list[Cell] = []
    invalid: list[Invalid] = []
    called: dict[str, str] = {}
    for name in design.scenarios:
        document = documents[name]
        conditions = _conditions(design, document)
        if design.design != "crossed" and len(conditions) < 2:
            raise StudyKeyError(
                "design",
                f"{name} has one condition, and design {quoted(design.design)} allocates several; "
                "give the scenario conditions, or leave `design` out",
            )
        invalid += _unknown_conditions(design, name, document)
        cells_by_variation: list[dict[int, list[Cell]]] = []
        variations = _variations(design, document) if conditions else ()
        for done, variation in enumerate(variations):
            on_variation(done, len(variations))
            cells_by_variation.append({})
            for number, condition in enumerate(conditions):
                try:
                    scenario = _scenario(design, document, condition, variation)
                    asked = _by_template(design, document, scenario, variation)
                except BeliefNestError as error:
                    invalid.append(Invalid(name, condition, variation.values, str(error)))
                    continue
                check_called(called, scenario.name, name)
                cells_by_variation[-1][number] = list(_cells(design, document, asked, variation))
        allocated = _allocated(design, variations, cells_by_variation, len(conditions))
        label = design.labels.get(name, "")
        cells += [replace(cell, label=label) for cell in allocated]
    order = {model: number for number, model in enumerate(design.models)}
    # Order cells in rounds, so that the cells played first form a smaller study of this design.
    cells.sort(key=lambda cell: (cell.key.repeat, cell.list_number or 0, order[cell.key.model]))
    return Plan(tuple(cells), tuple(invalid))


def _check_names(design: Design, documents: Mapping[str, Document]) -> None:
    """Raise StudyKeyError if no scenario declares a parameter that a design names."""
    declared = {name for each in documents.values() for name in declared_in(each)}
    names = (*sorted(declared), *CHANGES)
    varied = [] if isinstance(design.variations, int) else list(design.variations)
    places: list[tuple[KeyPath, str]] = [(("variations", name), name) for name in varied]
    for number, named in design.constrained():
        places += [(("constraints", number), name) for name in sorted(named)]
    for place, name in places:
        if name not in names:
            message = f"there is no parameter {quoted(name)}{nearest_or_all(name, names)}"
            raise StudyKeyError(place, message)


def _allocated(
    design: Design,
    variations: Sequence[Variation],
    plans: Sequence[Mapping[int, Sequence[Cell]]],
    conditions: int,
) -> Iterator[Cell]:
    """Yield the cells of a scenario that belong to the design, with their lists.

    Args:
        design: Design of the study.
        variations: Variations of the scenario.
        plans: Valid cells of each variation by the number of the condition, from 0.
        conditions: Number of conditions.
    """
    if design.design == "crossed":
        yield from (cell for each in plans for cells in each.values() for cell in cells)
    elif design.design == "balanced":
        values = [{k: json.dumps(v) for k, v in each.values.items()} for each in variations]
        names = [cell.key.scenario for each in plans for cells in each.values() for cell in cells]
        seed = f"{design.seed} {''.join(names[:1])}"
        chosen = balanced(values, [list(each) for each in plans], conditions, seed)
        for each, condition in zip(plans, chosen, strict=True):
            yield from () if condition is None else each[condition]
    else:
        steps = _steps(design, variations)
        for each, step in zip(plans, steps, strict=True):
            lists = latin_lists(step, conditions)
            for condition, cells in each.items():
                yield from (replace(cell, list_number=lists[condition]) for cell in cells)


def _steps(design: Design, variations: Sequence[Variation]) -> list[int]:
    """Return the rotation of each variation in a Latin square."""
    lists = design.variations
    if isinstance(lists, int):
        return list(range(len(variations)))
    places = {
        name: {json.dumps(value): number for number, value in enumerate(values)}
        for name, values in lists.items()
    }
    return [
        sum(places[name][json.dumps(value)] for name, value in each.values.items())
        for each in variations
    ]


def check_called(called: dict[str, str], name: str, source: str) -> None:
    """Note the name of the scenario or task in a file; raise InputError if the name is taken."""
    other = called.setdefault(name, source)
    if other != source:
        raise InputError(
            f"{other} and {source} are both called {quoted(name)}, so that their rows would be "
            "indistinguishable; give one another name"
        )


def _variations(design: Design, document: Document) -> Sequence[Variation]:
    # An error without any variation is an error of the file, not an invalid combination.
    for condition in _conditions(design, document):
        Scenario.varied(document, condition)
    if isinstance(design.variations, int):
        conditions = _conditions(design, document)

        def keeps(variation: Variation) -> bool:
            broken = (design.broken_constraint(document, each, variation) for each in conditions)
            return any(fault is None for fault in broken)

        # The folder changes nothing: a study that somebody else was given draws the same.
        seed = f"{design.seed} {Path(document.source).name}"
        return drawn_variations(document, design.variations, seed, keeps)
    return listed_variations(design.variations)


def _conditions(design: Design, document: Document) -> Sequence[int | None]:
    numbers = condition_numbers(document)
    if design.conditions is None or numbers == (None,):
        return numbers
    return [number for number in numbers if number in design.conditions]


def _unknown_conditions(design: Design, name: str, document: Document) -> Iterator[Invalid]:
    """Yield the wanted conditions that a scenario with conditions does not have."""
    numbers = condition_numbers(document)
    for number in design.conditions or () if numbers != (None,) else ():
        if number not in numbers:
            there = ", ".join(map(str, numbers))
            why = f"{document.source}: there is no condition {number}; conditions are {there}"
            yield Invalid(name, number, {}, why)


def _scenario(
    design: Design, document: Document, condition: int | None, variation: Variation
) -> Scenario:
    broken = design.broken_constraint(document, condition, variation)
    if broken is not None:
        raise broken
    return variation.scenario(document, condition)


def _by_template(
    design: Design, document: Document, scenario: Scenario, variation: Variation
) -> list[tuple[Template | None, Scenario]]:
    """Return the scenario once for each template of the study, in place of its own template."""
    if not design.templates:
        return [(None, scenario)]
    return [
        (each, _with_template(scenario, each, variation, document)) for each in design.templates
    ]


def _with_template(
    scenario: Scenario, template: Template, variation: Variation, document: Document
) -> Scenario:
    text = template.text
    if template.name not in BUILT_IN_TEMPLATES:
        text = variation.template(text, document)
    probes = tuple(
        dataclasses.replace(probe, template=text, template_name=template.name)
        for probe in scenario.probes
    )
    for probe in probes:
        probe.check_template()
    return dataclasses.replace(scenario, probes=probes)


def planned_cell(key: CellKey, document: Document, template: Template | None) -> Cell:
    """Return the cell of a recorded key, made from a document and a template.

    The key of the cell has the hash of these, which differs from the recorded one if they are not
    those that the cell was played with.

    Raises:
        BeliefNestError: They make no scenario.
    """
    variation = Variation(key.variation)
    scenario = variation.scenario(document, key.condition)
    if template is None:
        return Cell(
            dataclasses.replace(key, content=content_of(document.text, scenario, None)), scenario
        )
    asked = _with_template(scenario, template, variation, document)
    return Cell(dataclasses.replace(key, content=content_of(document.text, asked, template)), asked)


def _cells(
    design: Design,
    document: Document,
    asked: Sequence[tuple[Template | None, Scenario]],
    variation: Variation,
) -> Iterator[Cell]:
    for template, scenario in asked:
        content = content_of(document.text, scenario, template)
        for model in design.models:
            for repeat in range(1, design.repeats + 1):
                key = CellKey(
                    scenario=scenario.name,
                    content=content,
                    condition=scenario.condition,
                    variation=variation.values,
                    model=model,
                    template="" if template is None else template.name,
                    repeat=repeat,
                    setting=design.setting,
                )
                yield Cell(key, scenario)
