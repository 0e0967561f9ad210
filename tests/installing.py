"""Packages of others, installed in a folder as pip would, without pip."""

from pathlib import Path

__all__ = ["install"]


def install(site: Path, name: str, entry_points: str) -> None:
    """Write the metadata of a package with entry points, as the text of `entry_points.txt`."""
    info = site / f"{name.replace('-', '_')}-1.dist-info"
    info.mkdir(parents=True)
    metadata = f"Metadata-Version: 2.1\nName: {name}\nVersion: 1\n"
    (info / "METADATA").write_text(metadata, encoding="utf-8")
    (info / "entry_points.txt").write_text(entry_points, encoding="utf-8")
