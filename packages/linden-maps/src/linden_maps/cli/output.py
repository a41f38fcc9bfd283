"""Print a line of a command's output, or which of its steps begins; format a count with its noun."""

import sys


def say(line: str) -> None:
    """Print a line."""
    print(line)  # noqa: T201 - what a command says to its user


def say_step(number: int, total: int, what: str) -> None:
    """Print on standard error which step of a long command begins, so that a user sees how many are left."""
    print(f"step {number} of {total}: {what}", file=sys.stderr, flush=True)  # noqa: T201 - as above


def number(count: int, noun: str) -> str:
    """Return a count with its noun."""
    return f"{count} {noun}{'' if count == 1 else 's'}"
