"""Episodes: agents that live by what they believe, round after round."""
