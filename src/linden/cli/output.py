"""``say`` prints a line of a command's output; ``number`` formats a count with its noun."""


def say(line: str) -> None:
    """Print a line."""
    print(line)  # noqa: T201 - what a command says to its user


def number(count: int, noun: str) -> str:
    """Return a count with its noun."""
    return f"{count} {noun}{'' if count == 1 else 's'}"
