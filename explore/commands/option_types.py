"""The types of the command line's options; what does not fit one is an `argparse.ArgumentTypeError`."""

from __future__ import annotations

import argparse
from math import isfinite

MAX_MULTIPLICITY = 1000
DIGITS = (15, 400)


def positive(text: str) -> float:
    """A positive finite number."""
    value = float(text)
    if not isfinite(value) or value <= 0:
        raise argparse.ArgumentTypeError(f"{text!r} is not a positive number")
    return value


def number(text: str) -> float:
    """A finite number."""
    value = float(text)
    if not isfinite(value):
        raise argparse.ArgumentTypeError(f"{text!r} is not a finite number")
    return value


def count(text: str) -> int:
    """A number of orbits."""
    value = int(text)
    if not 2 <= value <= 1_000_000:
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number from 2 to 1000000")
    return value


def index(text: str) -> int:
    """A place in a list, counted from 1."""
    value = int(text)
    if not 1 <= value <= 1_000_000:
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number from 1 to 1000000")
    return value


def jobs(text: str) -> int:
    """A number of processes."""
    value = int(text)
    if not 1 <= value <= 1024:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number of processes from 1 to 1024")
    return value


def multiplicity(text: str) -> int:
    """The k of a 1:k resonance."""
    value = int(text)
    if not 1 <= value <= MAX_MULTIPLICITY:
        raise argparse.ArgumentTypeError(f"{text!r} is not a multiplicity from 1 to {MAX_MULTIPLICITY}")
    return value


def digits(text: str) -> int:
    """A number of decimal digits."""
    value = int(text)
    if not DIGITS[0] <= value <= DIGITS[1]:
        raise argparse.ArgumentTypeError(f"{text!r} digits: choose {DIGITS[0]} to {DIGITS[1]}")
    return value


# argparse names the type in its message about text that is no number at all.
for _type in (positive, number):
    _type.__name__ = "number"
for _type in (count, index, jobs, multiplicity, digits):
    _type.__name__ = "whole number"
