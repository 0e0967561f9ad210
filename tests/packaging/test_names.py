"""One public type has one name, and no other type has the same."""

import ast
import re
from collections import defaultdict
from functools import cache
from pathlib import Path

TOP = Path(__file__).parents[2]
SOURCES = TOP / "src" / "beliefnest"


@cache
def trees():
    """Return the syntax trees of all modules, by path."""
    modules = (each for each in SOURCES.rglob("*.py") if "node_modules" not in each.parts)
    return {
        str(module.relative_to(SOURCES)): ast.parse(module.read_text(encoding="utf-8"))
        for module in modules
    }


def types_of(tree):
    """Yield the names of the public types that a module defines."""
    for node in tree.body:
        match node:
            case ast.ClassDef(name=name):
                yield name
            case ast.Assign(targets=[ast.Name(id=name)]) | ast.AnnAssign(target=ast.Name(id=name)):
                # Aliases and type variables are written like classes, constants in capitals.
                if name[0].isupper() and not name.isupper():
                    yield name


def homes_of_types():
    """Return the files that define each type."""
    homes = defaultdict(list)
    for module, tree in trees().items():
        for name in types_of(tree):
            homes[name].append(module)
    return homes


def test_a_public_type_is_defined_once():
    homes = homes_of_types()
    assert len(homes) > 500
    assert {n: sorted(at) for n, at in homes.items() if len(at) > 1 and n[0] != "_"} == {}


def test_the_glossary_names_types_that_are_there():
    guide = (TOP / "CONTRIBUTING.md").read_text(encoding="utf-8")
    (words,) = re.findall(r"## Words of the code\n(.*?)\n## ", guide, re.DOTALL)
    named = set(re.findall(r"`([A-Z]\w+)`", words))
    assert len(named) > 20
    assert named - homes_of_types().keys() == set()


def test_only_what_users_import_lists_its_names():
    listing = {
        str(module.relative_to(SOURCES))
        for module in SOURCES.rglob("*.py")
        if "node_modules" not in module.parts
        and module.name != "__init__.py"
        and re.search(r"^__all__ = \[", module.read_text(encoding="utf-8"), re.MULTILINE)
    }
    assert listing <= {"inspect/registry.py", "testing.py"}


def named_by_participles():
    """Yield where variables and parameters are named by participles that say nothing of a value."""
    participles = {"found", "told", "held", "known", "given"}
    for module, tree in trees().items():
        nodes = list(ast.walk(tree))
        classes = (part.body for part in nodes if isinstance(part, ast.ClassDef))
        fields = {
            each.target for body in classes for each in body if isinstance(each, ast.AnnAssign)
        }
        for node in nodes:
            match node:
                case ast.Name(id=name, ctx=ast.Store()) | ast.arg(arg=name) if (
                    name in participles and node not in fields
                ):
                    yield f"{module}:{node.lineno}: {name}"


def test_nouns_say_what_variables_are():
    assert list(named_by_participles()) == []
