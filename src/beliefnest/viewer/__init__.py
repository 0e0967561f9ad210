"""Pictures of what a nest holds."""
