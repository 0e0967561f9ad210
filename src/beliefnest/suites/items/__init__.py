"""Sets of items as suites: models answer them, and weaknesses of a model are looked for."""
