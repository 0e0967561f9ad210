"""Studies: from a design to a folder of results."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from importlib.metadata import version as version_of
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

import msgspec
from msgspec.structs import asdict

from beliefnest.errors import InputError, ModelError, UnknownNameError
from beliefnest.llm.model_settings import AskedForm, ModelSettings
from beliefnest.llm.resolve import check_model, check_structured
from beliefnest.locking import holding
from beliefnest.nest.past.versions import own_versions
from beliefnest.plan.cells import C, Plan
from beliefnest.plan.jobs import OnStudyProgress, run_cells
from beliefnest.plan.scenario_cells import LABEL, Cell
from beliefnest.plan.terms import Terms
from beliefnest.prompts.templates import Template
from beliefnest.scenarios.document import Document, KeyPath
from beliefnest.scenarios.sources import read_document
from beliefnest.skills.manifests import SkillDetail
from beliefnest.studies.allocation import PARTICIPANT
from beliefnest.studies.cells import plan_cells
from beliefnest.studies.checking import StudyKeyError, is_amount, is_whole, several
from beliefnest.studies.design import Constraint, Design, template_named
from beliefnest.studies.episode_cells import EpisodeCell, check_player, plan_episodes
from beliefnest.studies.episode_design import EpisodeDesign, Order, Policies
from beliefnest.studies.file import document_of_study, read_design
from beliefnest.studies.inputs import Inputs
from beliefnest.studies.items.item_set import ItemSet
from beliefnest.studies.items.making import (
    MadeItems,
    made_items,
    played_otherwise,
    with_balanced_items,
)
from beliefnest.studies.items.record import DroppedQuestion, ItemRecord
from beliefnest.studies.items.space import ItemSpace
from beliefnest.studies.kinds import EPISODE_KIND, SCENARIO_KIND
from beliefnest.studies.list_balance import with_balanced_lists
from beliefnest.studies.participants.items import item_name
from beliefnest.studies.participants.playing import OnItem, refuse_claims
from beliefnest.studies.participants.running import (
    Page,
    ShownForm,
    join_answers,
    make_page,
    write_answers,
)
from beliefnest.studies.plainframe import Typed, plain_frame
from beliefnest.studies.power import VariationSource, power_rows
from beliefnest.studies.power_sources import SIZES, assumed_sources
from beliefnest.studies.result import StudyResult
from beliefnest.studies.study_folder import StudyFolder
from beliefnest.studies.study_keys import StudyKeys, design_of
from beliefnest.studies.table import Table, variation_columns
from beliefnest.version import VERSION
from beliefnest.world.texts import quoted
from beliefnest.worlds.minecraft.launching import ahead

if TYPE_CHECKING:  # pandas is optional, and imported when a table is made.
    import pandas


class Study:
    """All combinations of scenarios, conditions, variations, models, templates and repeats.

    A study of episodes combines tasks, policies, models and orders, seeds and repeats. The
    arguments `templates`, `constraints`, `attempts`, `temperature` and `claims_from` are for
    scenarios only; `policies`, `orders`, `seeds` and `help` are for tasks only.

    Args:
        scenarios: Names of built-in scenarios, or paths of files. A mapping with `label` and
            `scenarios` gives several of them a label, in the column `label`.
        models: Names of models, as `beliefnest run --model` takes them; None: `offline`; for
            tasks, no model.
        templates: Built-in prompt templates or paths of files, in place of the scenarios' own.
        repeats: Number of times that each cell is played, each time with another seed.
        seed: Seed of the drawn variations; seeds of cells are derived from it.
        variations: Lists of values by name: a parameter that the scenarios declare, `symmetry`,
            `agents` or `items`; all combinations are played. Or the number of variations to draw
            for each scenario, from its parameters, all symmetries and names. For tasks, lists of
            values of their parameters.
        conditions: Numbers of conditions; None: all.
        constraints: Conditions on a variation's values: expressions, or functions of the values.
        world: Name of the world; None: `embedded`, or `scripted` for tasks.
        attempts: Greatest number of requests to a model for one probe.
        temperature: Sampling temperature; None: the provider's default.
        retry_unread: Number of times that a model is asked again, with the form of an answer said
            once more, after an answer that cannot be read.
        answer: Form of answers to questions with options: `text`, or `structured`, the form that
            the provider has (JSON by a schema, or the call of a tool).
        max_tokens: Token limit of the whole study; None: no limit. The default does not count
            free models.
        max_cost: Cost limit of the whole study in US dollars; None: no limit.
        claims_from: Name of a model that extracts claims from utterances; None: no extraction.
        answer_seconds: Longest silence in an answer of a model; each token starts the count again.
        first_token_seconds: Longest wait for an answer to begin.
        max_output_tokens: Greatest length of an answer; None: the provider's own limit.
        system: File with a system message in place of the built-in ones.
        skills: Detail in which the built-in system message lists the skills: `none`, `names`,
            `signatures` or `full`.
        tasks: Instead of scenarios: names of tasks or scenarios to play as episodes, or paths of
            their files.
        policies: Policies of the players as `beliefnest play` takes them, `search` and
            `infer` for these at each of the orders, mappings from agent to policy, or mappings
            from a name for the table to one such mapping.
        orders: Orders of Theory of Mind of models and search: 0, 1, 2, `omniscient`.
        seeds: Numbers of instances of tasks; a single number n: n instances from `seed` on.
        help: Measure help, which plays further branches.
        design: `crossed`: every variation is played under every condition. `balanced`: under one
            condition; conditions are equally frequent, also for each value of the variations.
            `latin-square`: crossed and divided into lists (column `list`), each of which contains
            every variation once.
        balance: Names of shortcuts, such as `reality` or `first` (docs/items.md): the largest part
            of the scenes is played on which each of them is right as often as a guess.

    Raises:
        InputError: An argument does not have the right form.
        UnknownNameError: A scenario or world does not exist.
        ScenarioError: A scenario's file cannot be read.
        TemplateError: A template's file cannot be read.
    """

    def __init__(
        self,
        scenarios: Sequence[str | Mapping[str, Any]] | str = (),
        models: Sequence[str] | str | None = None,
        templates: Sequence[str] | None = None,
        repeats: int = 1,
        seed: int = 0,
        variations: Mapping[str, Sequence[Any]] | int | None = None,
        conditions: Sequence[int] | None = None,
        *,
        constraints: Sequence[Constraint] = (),
        world: str | None = None,
        attempts: int = 3,
        temperature: float | None = 0.0,
        retry_unread: int = 0,
        answer: AskedForm = "text",
        max_tokens: int | None = 1_000_000,
        max_cost: float | None = 5.0,
        claims_from: str | None = None,
        answer_seconds: float = ModelSettings().answer_seconds,
        first_token_seconds: float = ModelSettings().first_token_seconds,
        max_output_tokens: int | None = None,
        system: str | Path | None = None,
        skills: SkillDetail = "full",
        tasks: Sequence[str] | str = (),
        policies: Sequence[Policies] | Policies = (),
        orders: Sequence[Order] = (),
        seeds: Sequence[int] | int = 1,
        help: bool = False,
        design: str = "crossed",
        balance: Sequence[str] = (),
    ) -> None:
        keys = StudyKeys(
            scenarios=scenarios,
            models=models,
            templates=templates,
            repeats=repeats,
            seed=seed,
            variations=variations,
            conditions=conditions,
            world=world,
            attempts=attempts,
            temperature=temperature,
            retry_unread=retry_unread,
            answer=answer,
            max_tokens=max_tokens,
            max_cost=max_cost,
            claims_from=claims_from,
            answer_seconds=answer_seconds,
            first_token_seconds=first_token_seconds,
            max_output_tokens=max_output_tokens,
            system=None if system is None else str(system),
            skills=skills,
            tasks=tasks or None,
            policies=policies,
            orders=orders,
            seeds=seeds,
            help=help,
            design=design,
            balance=balance,
        )
        self._hold(design_of(keys, _templates(templates), _constraints(constraints)))

    @classmethod
    def load(cls, file: str | Path, claims_from: str | None = None, **requests: Any) -> Self:
        """Return the study that a YAML file describes.

        Args:
            file: The file.
            claims_from: Name of a model that extracts claims from utterances; None: as in the file.
            requests: Settings of requests to models in place of those of the file: the arguments
                of the class from `answer_seconds` to `skills`.

        Raises:
            ScenarioError: The file is wrong; the message names file, line and key.
            InputError: It is a study of tasks, which does not extract claims.
        """
        study = cls.__new__(cls)
        if claims_from is not None:
            requests["claims_from"] = claims_from
        document = document_of_study(Path(file))
        study._hold(read_design(document, requests), document)
        return study

    def _hold(self, design: Design | EpisodeDesign, written: Document | None = None) -> None:
        self._design = design
        # Document of the study's file; None: the study was made in Python.
        self._written = written
        scenarios = design.scenarios if isinstance(design, Design) else ()
        self._kind = SCENARIO_KIND if isinstance(design, Design) else EPISODE_KIND
        self._documents: dict[str, Document] = {name: read_document(name) for name in scenarios}
        self._plan: Plan[Cell] | Plan[EpisodeCell] | None = None
        self._made: MadeItems = {}

    @property
    def design(self) -> Design | EpisodeDesign:
        """Return the design: the values that the study combines."""
        return self._design

    def plan(self, on_item: OnItem | None = None) -> Plan[Cell] | Plan[EpisodeCell]:
        """Return all cells, each checked, and the invalid combinations.

        Args:
            on_item: Function that receives the progress: what is done with variations, the number
                of those done, and of all.

        Raises:
            ScenarioError: A scenario is wrong even without any variation.
            InputError: Two scenarios, or a parameter and a column, have the same name.
            UnknownNameError: A task or policy does not exist.
        """
        if self._plan is None:
            with self._naming():
                self._plan = self._planned(on_item or _say_nothing)
        return self._plan

    def _planned(self, on_item: OnItem, *, lists: bool = True) -> Plan[Cell] | Plan[EpisodeCell]:
        """Return the plan; without `lists`, those of a Latin square are not balanced."""
        design = self._design
        if not isinstance(design, Design):
            for player in design.players:
                with self._naming(player.place):
                    check_player(player)
            return _told_apart(plan_episodes(design), self._kind.table)
        plan = plan_cells(
            design, self._documents, lambda done, total: on_item("checked variations", done, total)
        )
        if lists and design.design == "latin-square":
            plan = with_balanced_lists(plan)
        if design.balance:
            self._made = made_items(plan.cells, self._documents, on_item)
            plan = with_balanced_items(plan, self._made, design.balance, design.seed)
        return _told_apart(plan, self._kind.table)

    @contextmanager
    def _naming(self, path: KeyPath = ()) -> Iterator[None]:
        """Name file, line and key in errors about a value of the study's file, if there is one.

        Args:
            path: Place of the value; empty: errors name it.
        """
        try:
            yield
        except (InputError, UnknownNameError) as error:
            place = error.path if isinstance(error, StudyKeyError) else path
            if self._written is None or not place:
                raise
            raise self._written.fault(place, str(error)) from None

    @property
    def columns(self) -> tuple[str, ...]:
        """Return names of the table's columns, see `StudyResult.frame`; raise as `plan` does."""
        return self._columns(self.plan())

    def _columns(self, plan: Plan[Cell] | Plan[EpisodeCell]) -> tuple[str, ...]:
        varied = variation_columns({"cells": [cell.plain() for cell in plan.cells]})
        return tuple(self._kind.table.kinds(varied))

    def run(
        self,
        folder: str | Path,
        jobs: int = 2,
        backend: str = "loky",
        *,
        shard: tuple[int, int] | None = None,
        record: bool = False,
        on_progress: OnStudyProgress | None = None,
    ) -> StudyResult:
        """Play all cells without a result in the folder, and write each result when it is known.

        An interrupted or enlarged study continues where it was. Failed cells are tried again.

        Args:
            folder: Folder of the study; made if it does not exist.
            jobs: Number of cells to play in parallel.
            backend: `loky` for processes of this machine, or `dask` or `ray` for a cluster, whose
                machines must see the folder at the same path.
            shard: Number of a part, from 1, and number of parts: play only this part.
            record: Record the runs in `runs/` of the folder.
            on_progress: Function that receives the progress.

        Raises:
            InputError: The folder holds something else, another process runs the study, or an
                argument is wrong.
            ScenarioError: A scenario is wrong even without any variation.
            UnknownNameError: A model or backend does not exist, or is not installed.
            ModelError: The key of a model is missing.
            BodyError: A worker process ended unexpectedly; call again to continue.
        """
        place = StudyFolder.open(folder, self._kind)
        plan = self.plan()
        part = plan if shard is None else plan.shard(*checked_shard(shard))
        self._check_valid(plan)
        place.check_subjects(self._plan_json(plan))
        terms = place.terms(self._design.limits, record=record)
        self._check_models(terms, backend)
        with holding(place.path):
            self._write_plan(place, self._plan_json(part))
            say = on_progress or _say_nothing
            run_cells(part.cells, place, terms, jobs, backend, say, ahead)
        return StudyResult(place)

    def participants(
        self,
        folder: str | Path,
        show: ShownForm = "both",
        *,
        instructions: str | Path | None = None,
        ending: str | Path | None = None,
        title: str = "Study",
        post: str | None = None,
        on_item: OnItem | None = None,
    ) -> Page:
        """Write a page on which people see the study's scenes and answer its questions.

        The scenarios are played without any model. The folder is static, needs no network and
        contains no right answers. The same study gives the same bytes.

        Args:
            folder: Folder to write.
            show: `film`, `story` or `both`.
            instructions: Text file with instructions; None: the default ones.
            ending: Text file for the end of the session, such as a code; None: no text.
            title: Title of the browser's tab.
            post: Address to which the page sends the answers as JSON; None: participants save them.
            on_item: Function that receives the progress.

        Raises:
            InputError: An argument is wrong, or the study is one of episodes.
            ScenarioError: No probe asks a question, or a scenario is wrong.
            BeliefNestError: A script failed.
        """
        design, cells = self._scenarios()
        return make_page(
            design,
            cells,
            self._documents,
            Path(folder),
            show,
            None if instructions is None else Path(instructions),
            None if ending is None else Path(ending),
            title,
            post,
            on_item or _say_nothing,
        )

    def read_participants(
        self,
        folder: str | Path,
        files: Sequence[str | Path],
        name: str = "people",
        *,
        pseudonyms: bool = False,
        exclude: str | Path | None = None,
        on_item: OnItem | None = None,
    ) -> tuple[StudyResult, tuple[str, ...]]:
        """Read answers of participants into the study's folder, as rows beside those of models.

        The scenarios are played again for the right answers. Earlier rows of the same name are
        replaced.

        Args:
            folder: Folder of the study; made if it does not exist.
            files: Files of answers, or folders of such files.
            name: Name of the people in the column `model`.
            pseudonyms: Replace ids of participants by `p1`, `p2` and so on, in the order in which
                their sessions began.
            exclude: CSV file of participants whose answers do not count, with the columns
                `participant` and `reason`; None: all count.
            on_item: Function that receives the progress.

        Returns:
            The results of the study, and sentences about what was left out or is unusual.

        Raises:
            InputError: A file does not fit the study; the message names file, row and column.
            BeliefNestError: A script failed.
        """
        design, cells = self._scenarios()
        if PARTICIPANT in self.columns:
            raise InputError(
                f"the parameter {quoted(PARTICIPANT)} has the name of the column of people; give "
                "it another name"
            )
        people = join_answers(
            design,
            cells,
            self._documents,
            [Path(each) for each in files],
            name,
            on_item or _say_nothing,
            pseudonyms=pseudonyms,
            exclude=None if exclude is None else Path(exclude),
        )
        place = StudyFolder.open(folder, self._kind)
        place.check_subjects(self._plan_json(self.plan()))
        with holding(place.path):
            if not place.has_plan:
                self._write_plan(place, self._plan_json(self.plan()))
            place.write_people(name, people.cells, asdict(people.sessions))
            write_answers(place.path / "people.csv", people.answers)
        return StudyResult(place), tuple(people.notes)

    def items(
        self,
        *,
        name: str = "items",
        held_out: float = 0.0,
        version: str = "1.0.0",
        changes: str = "",
        on_item: OnItem | None = None,
    ) -> ItemSet:
        """Return the questions of the study as items of a benchmark, with their right answers.

        The scripts are played in the scripted world, without any model. Questions of which several
        options are right, and those whose story says something else than the nest, are dropped.

        Args:
            name: Name of the set.
            held_out: Share of seeds whose items are held out, from 0 to 1.
            version: Version of the set.
            changes: What changed in this version.
            on_item: Function that receives the progress.

        Raises:
            InputError: An argument is wrong, or the study is one of episodes.
            ScenarioError: No probe asks a question, or a scenario is wrong.
            BeliefNestError: A script failed.
        """
        if not is_amount(held_out) or held_out >= 1:
            raise InputError(f"held_out is {quoted(held_out)}; give a share of at least 0, below 1")
        design, cells = self._scenarios(on_item)
        refuse_claims(design.setting)
        played = self._made or made_items(cells, self._documents, on_item)
        names = dict.fromkeys(map(item_name, cells))
        made = [each for name in names for each in played.get(name, ())]
        return ItemSet(
            name=name,
            items=tuple(each for each in made if isinstance(each, ItemRecord)),
            dropped=tuple(each for each in made if isinstance(each, DroppedQuestion)),
            held_out=held_out,
            version=version,
            changes=changes,
            made_with={
                "beliefnest": VERSION,
                **({"scipy": version_of("scipy")} if design.balance else {}),
            },
        )

    def item_space(self) -> ItemSpace:
        """Return all items that variations of the study can make, for a search among them.

        Raises:
            InputError: The study is one of episodes, or reads claims with a model.
        """
        design = self._design_of_scenarios()
        refuse_claims(design.setting)
        return ItemSpace(design, self._documents)

    def check_items(
        self, items: ItemSet, scenes: int, on_item: OnItem | None = None
    ) -> tuple[int, int, list[str]]:
        """Play some scenes of the study's items in the embedded world; see `played_otherwise`.

        Args:
            items: Items of this study.
            scenes: Number of scenes, chosen by the seed of the study.
            on_item: Function that receives the progress.

        Raises:
            BeliefNestError: A script failed.
        """
        _, cells = self._scenarios()
        say = on_item or _say_nothing
        return played_otherwise(cells, self._documents, items.items, scenes, say)

    def _scenarios(self, on_item: OnItem | None = None) -> tuple[Design, Sequence[Cell]]:
        """Return design and cells; raise InputError if the study plays episodes."""
        design, plan = self._design_of_scenarios(), self.plan(on_item)
        cells = [cell for cell in plan.cells if isinstance(cell, Cell)]
        self._check_valid(plan)
        return design, cells

    def _design_of_scenarios(self) -> Design:
        if not isinstance(self._design, Design):
            raise InputError(
                "this study plays episodes, and questions are those of scenarios; give it to "
                "`beliefnest study`, or to `beliefnest items --functional`"
            )
        return self._design

    def _write_plan(self, place: StudyFolder, plan: Mapping[str, Any]) -> None:
        """Write the inputs of the study and a plan into its folder."""
        inputs = self._inputs(self.plan())
        inputs.write(place.path)
        place.write_plan(
            {**plan, "versions": own_versions(), "inputs": msgspec.to_builtins(inputs.index)}
        )

    def power_sources(
        self,
        accuracy: float = 0.8,
        difference: float = 0.1,
        correlation: float = 0.3,
        between: str | None = None,
    ) -> list[tuple[str, VariationSource]]:
        """Return the groups of planned rows that `power` simulates; raise as `power` does."""
        # Balancing plays every scene, and changes no number of rows.
        with self._naming():
            planned = self._plan or self._planned(_say_nothing, lists=False)
        plan, names = self._plan_json(planned), self._columns(planned)
        rows = list(self._kind.table.planned(plan))
        varied = {name for name in names if len({row[name] for row in rows}) > 1}
        if between is None:
            between = next((name for name in self._kind.table.compared if name in varied), None)
        elif between not in varied:
            raise InputError(
                f"{quoted(between)} does not vary in this study; name a column that does"
            )
        columns = (*self._kind.table.groups, *self._kind.table.further_groups)
        by = [name for name in columns if name in varied]
        paired = None if plan.get("design") == "balanced" else between
        assumed = {"accuracy": accuracy, "difference": difference, "correlation": correlation}
        return list(assumed_sources(rows, by, assumed, between=paired))

    def power(
        self,
        accuracy: float = 0.8,
        difference: float = 0.1,
        correlation: float = 0.3,
        *,
        between: str | None = None,
        sizes: Sequence[int] = SIZES,
        simulations: int = 400,
        seed: int = 0,
    ) -> "pandas.DataFrame":
        """Simulate this study with different numbers of variations; nothing is played.

        Each simulated study has as many rows in each variation and group as this plan. To draw
        from recorded rows instead, see `StudyResult.power`.

        Args:
            accuracy: Assumed accuracy.
            difference: Assumed difference of accuracy between two levels of `between`.
            correlation: Assumed correlation of rows of one variation, see `AssumedRates`.
            between: Column to compare; None: the first of condition, model and template that
                varies, or the policy of episodes.
            sizes: Numbers of variations.
            simulations: Number of simulated studies of each size.
            seed: Seed; the same seed gives the same numbers.

        Returns:
            A row for each number of rows in a variation (`of`) and each size, see `Power`.

        Raises:
            InputError: A number is wrong, or the column does not vary.
            MissingExtraError: pandas is not installed.
        """
        sources = self.power_sources(accuracy, difference, correlation, between)
        rows = power_rows(sources, sizes, simulations, seed)
        return plain_frame({name: Typed([row[name] for row in rows]) for name in rows[0]})

    def _inputs(self, plan: Plan[Cell] | Plan[EpisodeCell]) -> Inputs:
        """Return the texts with which the cells can be played again elsewhere.

        Raises:
            InputError: A file cannot be read.
        """
        inputs = Inputs()
        if self._written is not None:
            inputs.add_study(self._written.text)
        if isinstance(self._design, Design):
            for document in self._documents.values():
                inputs.add_document("scenarios", document.root.value["name"].value, document)
            for template in self._design.templates:
                inputs.add_template(template)
        else:
            for name in self._design.tasks:
                inputs.add_task(name)
        for cell in plan.cells:
            if isinstance(cell, EpisodeCell):
                inputs.add_policies(cell.key.policies.values())
        for name in self._design.asked:
            inputs.add_model(name)
        return inputs

    def take_over(self, folder: str | Path, others: Sequence[str | Path]) -> int:
        """Copy the cells of folders in which other machines ran shards of the study.

        Returns:
            Number of new cells.

        Raises:
            InputError: A folder holds another study, or two hold different results of one cell.
        """
        plan = self.plan()
        planned = {cell.key.name for cell in plan.cells}
        place = StudyFolder.open(folder, self._kind)
        place.check_subjects(self._plan_json(plan))
        with holding(place.path):
            return place.take_over([Path(other) for other in others], planned)

    def _check_models(self, terms: Terms, backend: str) -> None:
        """Refuse unknown models and models without a key, before anything is played.

        A model needs no key if the study's folder has its answers in the cache.
        """
        design = self._design
        is_structured = isinstance(design, Design) and design.settings.answer == "structured"
        for number, name in enumerate(design.asked):
            is_asked = number < len(design.models)
            try:
                with self._naming(("models", number) if is_asked else ("claims_from",)):
                    if is_structured and is_asked:
                        check_structured(name)
                    check_model(name, terms.surroundings, terms.connection())
            except ModelError:
                # Machines of a cluster may have keys that this machine does not have.
                if backend == "loky":
                    raise

    def _check_valid(self, plan: Plan[Cell] | Plan[EpisodeCell]) -> None:
        """Raise InputError if no combination of a plan is valid."""
        if not plan.cells and plan.invalid:
            message = f"no combination is valid; the reason of the first: {plan.invalid[0].why}"
            with self._naming(("variations",)):
                raise InputError(message)

    def _plan_json(self, plan: Plan[Cell] | Plan[EpisodeCell]) -> dict[str, Any]:
        return {
            **self._design.plain(),
            "cells": [cell.plain() for cell in plan.cells],
            "invalid": [
                {
                    "scenario": each.scenario,
                    "condition": each.condition,
                    "variation": dict(each.variation),
                    "why": each.why,
                }
                for each in plan.invalid
            ],
        }


def _told_apart(plan: Plan[C], table: Table) -> Plan[C]:
    """Return the plan; raise InputError if a parameter has the name of a column of the table."""
    columns = {*table.kinds(()), LABEL}
    varied = {name for cell in plan.cells for name in cell.plain()["key"]["variation"]}
    for name in sorted(varied):
        if name in columns:
            raise InputError(
                f"the parameter {quoted(name)} has the name of a column of the table; "
                "give it another name"
            )
    return plan


def _templates(names: Sequence[str] | None) -> tuple[Template, ...]:
    if names is None:
        return ()
    return tuple(template_named(name) for name in several("templates", names))


def _constraints(constraints: Sequence[Constraint]) -> tuple[Constraint, ...]:
    if isinstance(constraints, str) or callable(constraints):
        return (constraints,)
    listed: Sequence[object] = constraints
    for each in listed:
        if not isinstance(each, str) and not callable(each):
            message = f"constraints has {quoted(each)}; give expressions, or functions of values"
            raise StudyKeyError("constraints", message)
    return tuple(constraints)


def checked_shard(shard: tuple[int, int]) -> tuple[int, int]:
    """Return a shard's number and count if they are valid.

    Raises:
        InputError: The shard does not exist.
    """
    number, count = _two(shard)
    if not 1 <= number <= count:
        raise InputError(
            f"there is no shard {number} of {count}; give 1/{count} to {count}/{count}"
        )
    return number, count


def _two(shard: object) -> tuple[int, int]:
    if isinstance(shard, tuple | list) and len(shard) == 2 and all(map(is_whole, shard)):
        return shard[0], shard[1]
    raise InputError(
        f"shard is {quoted(shard)}; give its number and the number of shards, such as (1, 4)"
    )


def _say_nothing(*_: object) -> None:
    """Ignore progress."""
