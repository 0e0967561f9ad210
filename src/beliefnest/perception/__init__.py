"""Pure functions from a scene to what one agent perceives of it."""
