"""Minds read from behaviour: models of what agents want and believe, and posteriors over them."""
