"""Live page over HTTP."""
