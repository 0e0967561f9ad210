"""Recorded past of a nest, from which any state of any simulator is computed."""
