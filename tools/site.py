"""Hook of the documentation site: pages written from the code, and those beside `docs/`.

Pages of the reference are made while the site is built, so that they cannot be older than the
code they describe. Papers beside `docs/` become pages below `project/`; links are followed there.
"""

import inspect
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path, PurePosixPath
from types import ModuleType, NoneType
from typing import Any, Literal, get_args, get_origin, get_type_hints
from urllib.parse import urlsplit

import click
import typer
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.exceptions import PluginError
from mkdocs.plugins import event_priority
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

import beliefnest.env
import beliefnest.frames
import beliefnest.llm
import beliefnest.prompts
import beliefnest.testing
from beliefnest import errors
from beliefnest.cli.app import app
from beliefnest.scenarios.json_schema import schema
from beliefnest.world.event_kinds import EventKind

ROOT = Path(__file__).parents[1]
PAPERS = ("CHANGELOG.md", "CONTRIBUTING.md", "SECURITY.md", "LICENSE", "THIRD_PARTY_NOTICES.md")
_HOLE = "Hole"
_PLAIN = {
    "integer": "a whole number",
    "number": "a number",
    "string": "text",
    "boolean": "true or false",
}
NAMES_OF_KINDS = {"class": "Classes", "function": "Functions", "value": "Values"}


@event_priority(100)  # Before plugins look at which pages there are.
def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages that are not in `docs/`."""
    pages: dict[str, Callable[[], str]] = {
        "reference/python.md": python_page,
        "reference/modules.md": modules_page,
        "reference/commands.md": commands_page,
        "reference/scenario.md": scenario_page,
        "reference/events.md": events_page,
        "reference/errors.md": errors_page,
        "about.md": about_page,
    }
    for name, write in pages.items():
        files.append(File.generated(config, name, content=write()))
    for paper in [*(ROOT / each for each in PAPERS), *sorted((ROOT / "design").glob("*.md"))]:
        name = project_page(paper)
        files.append(File.generated(config, name, content=paper.read_text(encoding="utf-8")))
    for example in sorted((ROOT / "examples").rglob("*.*")):
        files.append(File.generated(config, project_page(example), abs_src_path=str(example)))
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Let links between papers, which are relative to the repository, lead to their pages."""
    source = page.file.src_uri
    place = (
        PurePosixPath(source).relative_to("project")
        if source.startswith("project/")
        else PurePosixPath("docs", source)
    )
    here = PurePosixPath(source).parent

    if "\n## " not in markdown:
        # Without headings, the page takes the room of the contents: its tables may be wide.
        page.meta["hide"] = ["toc"]

    def lead(match: re.Match[str]) -> str:
        target, anchor = match[1], match[2] or ""
        if "://" in target or not target:
            return match[0]
        path = (ROOT / place.parent / target).resolve()
        if not path.is_relative_to(ROOT) or not path.exists():
            return match[0]
        inside = path.relative_to(ROOT)
        page_name = (
            inside.relative_to("docs").as_posix()
            if inside.parts[0] == "docs"
            else project_page(path)
        )
        if files.get_file_from_path(page_name) is None:
            # A file of the repository that is no page: its name has to do.
            return f"](#{anchor})" if path.is_dir() else match[0]
        return f"]({_relative(page_name, here)}{anchor})"

    return re.sub(r"\]\(([^)#\s]*)(#[^)\s]*)?\)", lead, markdown)


def on_post_page(output: str, page: Page, config: MkDocsConfig) -> str:
    """Refuse a page that loads anything from elsewhere, or links to what is no address."""
    # A link that only names the page's own address loads nothing.
    loads = (
        r"<(?:script|link(?! rel=.?canonical)|img|iframe)\b[^>]*\b(?:src|href)=\"?https?://[^>]*>"
    )
    if foreign := re.search(loads, output):
        raise PluginError(f"{page.file.src_uri} loads from elsewhere: {foreign[0]}")
    # `make links` checks these addresses.
    for link in re.findall(r"<a\b[^>]*\bhref=\"?(\w+:[^\s\">]*)", output):
        address = urlsplit(link)
        if address.scheme not in {"https", "http"} or "." not in (address.hostname or ""):
            raise PluginError(f"{page.file.src_uri} links to {link}, which is no address")
    return output


def project_page(file: Path) -> str:
    """Return the name of the page of a paper beside `docs/`."""
    name = file.relative_to(ROOT).as_posix()
    return f"project/{name}" if "." in name else f"project/{name}.md"


def _relative(target: str, here: PurePosixPath) -> str:
    up = len(here.parts)
    return "/".join([".."] * up + [target])


def python_page() -> str:
    """Return every public name with its docstring."""
    return "\n".join(
        [
            "# From Python",
            "",
            "`import beliefnest as bn`; everything below is `bn.NAME`, and what rooms such as",
            "`beliefnest.llm` offer has [a page of its own](modules.md). Positions are scenario",
            "coordinates in blocks, y up; angles are Mineflayer's radians; 20 ticks are a second.",
            "Errors have [a page of their own](errors.md). Sections of the semantics are those of",
            "[The rules of belief](../project/design/semantics.md).",
            "",
            *_names(beliefnest, "##"),
        ]
    )


def modules_page() -> str:
    """Return every public name of the rooms that users import from."""
    lines = [
        "# From Python: models, prompts, tables, environments",
        "",
        "What is imported from rooms of the package. A model of one's own is any object that is a",
        "`Model`: see [Language models](../models.md).",
        "",
    ]
    rooms = (beliefnest.llm, beliefnest.prompts, beliefnest.frames, beliefnest.env)
    for module in (*rooms, beliefnest.testing):
        lines += [f"## {module.__name__}", "", inspect.getdoc(module) or "", ""]
        lines += _names(module, "###")
    return "\n".join(lines)


def _names(module: ModuleType, heading: str) -> Iterator[str]:
    """Yield the names that a module offers, by kind, each with its docstring."""
    groups: dict[str, list[str]] = {kind: [] for kind in NAMES_OF_KINDS}
    offered = {name: getattr(module, name) for name in sorted(module.__all__)}
    for name, value in offered.items():
        if inspect.isclass(value) and issubclass(value, Exception):
            continue
        is_defined = inspect.isclass(value) or inspect.isfunction(value)
        if is_defined and not inspect.getdoc(value):
            raise PluginError(f"{module.__name__}.{name} is public and has no docstring")
        kind = "value" if not is_defined else "class" if inspect.isclass(value) else "function"
        home = value.__module__ if is_defined else module.__name__
        groups[kind].append(f"::: {home}.{name}")
        if kind == "class":
            groups[kind] += [f"::: {base.__module__}.{base.__qualname__}" for base in _parts(value)]
    for kind, title in NAMES_OF_KINDS.items():
        if groups[kind]:
            yield from (
                f"{heading} {title}",
                "",
                *(f"{each}\n" for each in dict.fromkeys(groups[kind])),
            )


def _parts(value: type) -> Iterator[type]:
    """Bases of a class that tell of attributes and are not offered themselves."""
    for base in value.__mro__[1:]:
        is_ours = base.__module__.startswith("beliefnest.")
        is_hidden = base.__name__.startswith("_") or base.__name__ in beliefnest.__all__
        if is_ours and not is_hidden and "Attributes:" in (base.__doc__ or ""):
            yield base


def commands_page() -> str:
    """Every command with its arguments and options, as the command line itself describes them."""
    command = typer.main.get_command(app)
    lines = [
        "# Commands",
        "",
        "Results go to stdout, progress to stderr. The exit status is 0 if everything was as the",
        "scenario expects, 1 if something was not, 2 for wrong input (one line says what and",
        "where), 3 if a world or a model failed.",
    ]
    subcommands: Mapping[str, click.Command] = getattr(command, "commands", {})
    callbacks = {
        each.name or each.callback.__name__: each.callback
        for each in app.registered_commands
        if each.callback is not None
    }
    for name, sub in sorted(subcommands.items()):
        lines += [
            "",
            f"## {name}",
            "",
            sub.help or "",
            "",
            *_parameters(name, sub, callbacks[name]),
        ]
    return "\n".join(lines)


def _parameters(name: str, command: Any, callback: Callable[..., object]) -> Iterator[str]:
    arguments = [each for each in command.params if each.param_type_name == "argument"]
    usage = " ".join(
        each.name.upper() if each.required else f"[{each.name.upper()}]" for each in arguments
    )
    yield f"`beliefnest {name} {usage} [OPTIONS]`".replace("  ", " ")
    yield ""
    yield "| argument or option | takes | default | meaning |"
    yield "|---|---|---|---|"
    behind = _written_behind(callback)
    for each in command.params:
        is_argument = each.param_type_name == "argument"
        label = each.name.upper() if is_argument else ", ".join([*each.opts, *each.secondary_opts])
        is_left_out = each.default is None or each.default is False or is_argument
        default = "" if is_left_out or each.default in ((), []) else f"`{each.default}`"
        takes = behind.get(each.name if is_argument else each.opts[0], "")
        yield f"| `{label}` | {takes} | {default} | {each.help or ''} |"


def _written_behind(callback: Callable[..., object]) -> dict[str, str]:
    """Return the description of each option of a command, with its bounds, by its first name."""
    found = {}
    for name, hint in get_type_hints(callback, include_extras=True).items():
        if not hasattr(hint, "__metadata__"):
            continue
        kind, info = get_args(hint)[:2]
        first = next(iter(info.param_decls or ()), f"--{name.replace('_', '-')}")
        bounds = [f"from {info.min:g}" if info.min is not None else ""]
        bounds += [f"to {info.max:g}" if info.max is not None else ""]
        found[first if first.startswith("-") else name] = " ".join(
            filter(None, [_words(kind), *bounds])
        )
    return found


def _words(kind: Any) -> str:
    if get_origin(kind) is Literal:
        return " or ".join(f"`{each}`" for each in get_args(kind))
    inside = [each for each in get_args(kind) if each is not NoneType]
    if inside:
        several = "; may be repeated" if get_origin(kind) is list else ""
        return " or ".join(_words(each) for each in inside) + several
    return {bool: "", int: "a whole number", float: "a number", Path: "a path"}.get(kind, "text")


def scenario_page() -> str:
    """Return every key of a scenario file, from its schema."""
    defs = schema()["$defs"]
    lines = [
        "# Keys of a scenario file",
        "",
        "The same as [the JSON schema](../scenario.schema.json), to read. How the keys are used is",
        "shown in [Writing a scenario](../scenarios.md). Positions are blocks, x, y up and z.",
        "Anything but text may also be `${...}`: a parameter, or an expression of parameters.",
    ]
    for name, entry in defs.items():
        if name.endswith("Override") or name == _HOLE:
            continue
        lines += ["", f"## {_title(name)}", "", entry.get("description", ""), ""]
        lines += ["| key | type | default | meaning |", "|---|---|---|---|"]
        required = set(entry.get("required", ()))
        for key, value in entry.get("properties", {}).items():
            default = "required" if key in required else _short(value.get("default"))
            lines.append(
                f"| `{key}` | {_type(value)} | {default} | {value.get('description', '')} |"
            )
    return "\n".join(lines)


def _title(name: str) -> str:
    words = re.findall(r"[A-Z][a-z]*", name)
    return " ".join(words[:-1] if words[-1] in ("Entry", "File") else words) or name


def _short(default: object) -> str:
    if default in ("", [], {}):
        return "none"
    return "none" if default is None else "" if isinstance(default, dict) else f"`{default}`"


def _type(value: Mapping[str, Any]) -> str:
    """Return the form of a value in words, without saying that it may be null or a parameter."""
    if "$ref" in value:
        name = value["$ref"].rsplit("/", 1)[-1]
        title = _title(name.removesuffix("Override"))
        link = f"[{title}](#{title.lower().replace(' ', '-')})"
        return f"any keys of {link}" if name.endswith("Override") else link
    if "anyOf" in value:
        forms = [each for each in value["anyOf"] if not _goes_without_saying(each)]
        return " or ".join(dict.fromkeys(_type(each) for each in forms))
    if "enum" in value:
        return " or ".join(f"`{each}`" for each in value["enum"])
    if "prefixItems" in value:
        return _several([_type(each) for each in value["prefixItems"]])
    inside = value.get("items") or value.get("additionalProperties")
    if isinstance(inside, dict):
        form = _type(inside)
        return f"list of {form}" if "items" in value else f"mapping of names to {form}"
    plain: str = value.get("type", "anything")
    return _PLAIN.get(plain, plain)


def _goes_without_saying(form: Mapping[str, Any]) -> bool:
    return form.get("type") == "null" or form.get("$ref", "").endswith(f"/{_HOLE}")


def _several(forms: Sequence[str]) -> str:
    """Return a list of so many values, with x, y and z for three numbers."""
    if len(set(forms)) > 1:
        return f"[{', '.join(forms)}]"
    if len(forms) == 3 and forms[0] in _PLAIN.values():
        return f"[x, y, z], each {forms[0]}"
    return f"list of {len(forms)}, each {forms[0]}"


def events_page() -> str:
    """Return every kind of event, with the names that prompts use."""
    from beliefnest.world.event_words import EVENT_WORDS

    lines = [
        "# Events",
        "",
        "What can happen during a tick (`state.events`, `result.events`, exported tables).",
        "",
        "| kind | in prompts |",
        "|---|---|",
    ]
    lines += [f"| `{kind.value}` | `{EVENT_WORDS[kind].skill}` |" for kind in EventKind]
    return "\n".join([*lines, "", "::: beliefnest.world.values.Event", ""])


def about_page() -> str:
    """Limits, the paper, how to cite and the licence: the last sections of the README."""
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    text = readme[readme.index("\n## Limits") :].replace("](CITATION.cff)", "](#citationcff)")
    text = re.sub(r"\]\((?!#|https?:)", "](../", text)
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    return f"# Limits, citing, licence\n{text}\n## CITATION.cff\n\n```yaml\n{citation}```\n"


def errors_page() -> str:
    """Return every error that is raised on purpose."""
    lines = [
        "# Errors",
        "",
        "All derive from `bn.BeliefNestError`. A message says what was found, where, and what to",
        "do. The status is what the command line ends with.",
        "",
        "| error | status | when |",
        "|---|---|---|",
    ]
    for name in filter(re.compile(r"\w+Error").fullmatch, sorted(vars(errors))):
        error = getattr(errors, name)
        when = " ".join((inspect.getdoc(error) or "").partition("\n\n")[0].split())
        home = "bn" if hasattr(beliefnest, name) else "bn.errors"
        lines.append(f"| `{home}.{name}` | {error.exit_status} | {when} |")
    return "\n".join(lines)
