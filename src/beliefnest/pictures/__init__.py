"""Pictures of what simulators hold: pure functions from values to marks, and files of these."""
