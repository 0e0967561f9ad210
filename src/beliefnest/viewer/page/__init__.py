"""The page: a nest over time, as data that a browser plays back, and the page around it."""
