"""Suites: batteries of text stories and of films, each scored as a whole."""
