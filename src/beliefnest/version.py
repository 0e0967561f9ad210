"""The version of the package, for what runs record."""

__all__ = ["VERSION"]

VERSION = "0.1.0"
