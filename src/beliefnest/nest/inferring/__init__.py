"""Reading from one node and its timeline what inference needs."""
