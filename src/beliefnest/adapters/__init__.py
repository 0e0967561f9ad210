"""Adapters: scenarios, runs and studies in the forms of other libraries."""
