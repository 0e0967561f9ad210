"""The page over HTTP, live."""
