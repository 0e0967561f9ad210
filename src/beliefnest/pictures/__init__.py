"""Pictures of simulators: pure functions from values to drawings, and writers of files."""
