"""Runs and studies as pandas data frames (extra `study`)."""
