"""Entry point of `python -m beliefnest`."""

from beliefnest.cli import main

if __name__ == "__main__":
    main()
