"""Acting in worlds, and recording of it: bodies, programs, edits, speculation and replays."""
