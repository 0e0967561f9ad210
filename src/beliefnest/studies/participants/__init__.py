"""People as participants of a study: a page with films and questions, and rows of their answers."""
