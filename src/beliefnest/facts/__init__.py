"""Facts: the one language in which files and code say how something is."""
