"""Reader of the data that inference needs from one node and its timeline."""
