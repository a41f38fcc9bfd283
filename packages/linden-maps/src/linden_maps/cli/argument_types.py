"""Types of arguments on the command line; argparse prints what a wrong one raises."""

import argparse
import math


def positive(text: str) -> float:
    """Read a positive number."""
    value = float(text)
    if not 0.0 < value < math.inf:
        raise argparse.ArgumentTypeError(f"{text} is not a positive number")
    return value


def not_negative(text: str) -> float:
    """Read 0 or a positive number."""
    value = float(text)
    if not 0.0 <= value < math.inf:
        raise argparse.ArgumentTypeError(f"{text} is neither 0 nor a positive number")
    return value


def angle(text: str) -> float:
    """Read an angle from -90 to 90 degrees."""
    value = float(text)
    if not abs(value) <= 90.0:
        raise argparse.ArgumentTypeError(f"{text} is not between -90 and 90 degrees")
    return value


def count(text: str) -> int:
    """Read a whole number from 1."""
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError(f"{text} is less than 1")
    return value
