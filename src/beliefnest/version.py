"""Version of the package, which runs record."""

VERSION = "0.1.0"
