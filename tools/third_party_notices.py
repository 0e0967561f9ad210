"""Write THIRD_PARTY_NOTICES.md: what the JavaScript bundles contain, and under which licence.

Reads the list of packages that the build writes beside each bundle, and the licence files of
these packages in `node_modules`. Run it with `make notices` after a change of dependencies.
"""

import json
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "src" / "beliefnest"
BUNDLES = {
    SOURCE / "_bundle" / "packages.json": SOURCE / "worlds" / "minecraft" / "node" / "node_modules",
    SOURCE / "_page" / "packages.json": SOURCE / "viewer" / "page" / "web" / "node_modules",
}
NOTICES = ROOT / "THIRD_PARTY_NOTICES.md"

_HEAD = """\
# Third-party notices

BeliefNest's wheel carries a JavaScript bundle made of the npm packages below, facts about
Minecraft's blocks and items from minecraft-data, and the fonts Liberation Sans and Liberation Sans
Bold (copyright Google Corporation and Red Hat, Inc.; SIL Open Font License 1.1, whose text stands
in `src/beliefnest/pictures/fonts/LICENSE.txt`). The documentation carries iframe-worker (copyright
Martin Donath; MIT, `docs/assets/iframe-worker/LICENSE.txt`). Everything else it needs is installed
as a dependency of its own, under its own licence.

"Minecraft" is a trademark of Mojang AB. BeliefNest is not an official Minecraft product and is
not approved by or associated with Mojang or Microsoft. It contains no Mojang code or assets.

This file is written by `make notices`.
"""


def notices() -> str:
    """Return the whole text."""
    packages: dict[str, dict[str, str]] = {}
    folders: dict[str, Path] = {}
    for listed, modules in BUNDLES.items():
        found = json.loads(listed.read_text(encoding="utf-8"))
        packages |= found
        folders |= {name: modules / name for name in found}
    lines = [_HEAD, "| package | version | licence |", "|---|---|---|"]
    lines += [f"| {name} | {p['version']} | {p['license']} |" for name, p in packages.items()]
    by_text: dict[str, list[str]] = {}
    for name in packages:
        by_text.setdefault(_licence(folders[name]), []).append(name)
    for text, names in by_text.items():
        lines += ["", f"## {', '.join(names)}", "", "```text", text, "```"]
    return "\n".join(lines) + "\n"


def _licence(folder: Path) -> str:
    files = sorted(
        path
        for path in folder.iterdir()
        if path.is_file() and path.stem.lower() in {"license", "licence", "copying"}
    )
    if files:
        text = files[0].read_text(encoding="utf-8", errors="replace").replace("\r\n", "\n")
        return "\n".join(line.rstrip() for line in text.strip().splitlines())
    manifest = json.loads((folder / "package.json").read_text(encoding="utf-8"))
    author = manifest.get("author", "its authors")
    holder = author.get("name", "its authors") if isinstance(author, dict) else author
    return f"{manifest.get('license')} licence; the package has no licence file. By {holder}."


if __name__ == "__main__":
    if sys.argv[1:] == ["--check"]:
        sys.exit(NOTICES.read_text(encoding="utf-8") != notices())
    NOTICES.write_text(notices(), encoding="utf-8")
