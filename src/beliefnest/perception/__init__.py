"""Pure functions from a scene to the percepts of one agent."""
