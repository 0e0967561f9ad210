"""One public type has one name, and no other type has the same."""

import ast
import re
from collections import defaultdict
from pathlib import Path

TOP = Path(__file__).parents[2]
SOURCES = TOP / "src" / "beliefnest"


def types_of(module):
    """Yield the names of the public types that a module defines."""
    for node in ast.parse(module.read_text(encoding="utf-8")).body:
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
    for module in SOURCES.rglob("*.py"):
        if "node_modules" not in module.parts:
            for name in types_of(module):
                homes[name].append(str(module.relative_to(SOURCES)))
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
