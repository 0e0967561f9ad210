"""Version of the package, which runs record."""

__all__ = ["VERSION"]

VERSION = "0.1.0"
