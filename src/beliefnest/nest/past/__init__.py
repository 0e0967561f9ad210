"""What was recorded, and any state of any simulator from it."""
