"""Sets of prompt filters: built-in, installed and user-defined ones."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from types import MappingProxyType
from typing import Any, Generic, ParamSpec

from beliefnest.errors import InputError
from beliefnest.importing import installed_entries, load, told_entry

FILTER_GROUP = "beliefnest.filters"
"""Group of entry points for installed filters. Each entry point is a `PromptFilter`; it is
loaded when a prompt is rendered."""


P = ParamSpec("P")


@dataclass(frozen=True)
class PromptFilter(Generic[P]):
    """A function that templates can call by name.

    Attributes:
        name: Name in templates.
        function: Function that receives the value before the bar and the arguments in brackets,
            and returns the text to print.
        override: True if it may replace a filter of the same name.
    """

    name: str
    function: Callable[P, str]
    override: bool = False

    def __call__(self, *args: P.args, **kwargs: P.kwargs) -> str:
        """Call the function."""
        return self.function(*args, **kwargs)


def filter(name: str, *, override: bool = False) -> Callable[[Callable[P, str]], PromptFilter[P]]:
    """Decorate a function to make it a prompt filter.

    Args:
        name: Name in templates: letters, digits and `_`.
        override: True if it may replace a filter of the same name.

    Raises:
        InputError: The name is not valid in a template.
    """
    if not name.isidentifier():
        raise InputError(f"{name!r} is not a valid name of a filter; use letters, digits and _")
    return lambda function: PromptFilter(name, function, override)


@dataclass(frozen=True)
class FilterSet:
    """Immutable set of filters, so that two nests can have different filters.

    Attributes:
        filters: Filters by name, in order of names.
    """

    filters: Mapping[str, PromptFilter[Any]]

    @staticmethod
    def of(filters: Iterable[PromptFilter[Any]]) -> "FilterSet":
        """Return a set with exactly these filters.

        Raises:
            InputError: Two filters have the same name.
        """
        return FilterSet(MappingProxyType({})).extended(filters)

    def extended(self, filters: Iterable[PromptFilter[Any]]) -> "FilterSet":
        """Return this set with further filters added.

        Raises:
            InputError: A name is in use and the new filter lacks `override=True`, or an element
                is not a filter.
        """
        merged = dict(self.filters)
        for added in filters:
            if not isinstance(added, PromptFilter):
                raise InputError(
                    f"{added!r} is not a prompt filter; decorate the function with @filter(NAME)"
                )
            if added.name in merged and not added.override:
                raise InputError(
                    f"there is a filter {added.name!r} already; choose another name, or write "
                    f'@filter("{added.name}", override=True) to replace it'
                )
            merged[added.name] = added
        return FilterSet(MappingProxyType(dict(sorted(merged.items()))))


def installed_filters(built_in: FilterSet) -> FilterSet:
    """Return the built-in filters and those of installed packages.

    A filter that cannot be imported is one that raises InputError when a template calls it.

    Raises:
        InputError: An installed filter is none, or its name is in use.
    """
    filters = built_in
    for entry in installed_entries(FILTER_GROUP):
        try:
            added = load(entry, "filter")
        except InputError as fault:
            added = PromptFilter(entry.name, partial(_refuse, str(fault)))
        try:
            filters = filters.extended([added])
        except InputError as error:
            raise InputError(f"{told_entry(entry, 'filter')} cannot be used: {error}") from error
    return filters


def _refuse(fault: str, *_args: object, **_options: object) -> str:
    raise InputError(fault)
