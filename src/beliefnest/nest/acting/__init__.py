"""What acts in a world and is recorded: bodies, programs, trials, replays."""
