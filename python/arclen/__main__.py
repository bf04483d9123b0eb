"""``python -m arclen`` is the program ``arclen``."""

from ._command import command

if __name__ == "__main__":
    command()
