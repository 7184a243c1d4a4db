"""The one place that words an input error: the thing, the rule, what came, what to do."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from typing import Any, NoReturn

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flowtree.errors import InputError


def fail(thing: str, rule: str, got: object, remedy: str) -> NoReturn:
    """Raises the one-line error: ``thing: rule, but got …; remedy.``.

    Args:
        thing: what is wrong, as the user knows it (a file's name, a parameter's name).
        rule: what must hold, starting with a verb ("must be …", "needs …").
        got: what came.
        remedy: what to do, as an imperative.

    Raises:
        InputError: always.
    """
    raise InputError(one_line(f"{thing}: {rule}, but got {got}; {remedy}"))


def require(holds: bool, thing: str, rule: str, got: object, remedy: str) -> None:
    """Raises the error of `fail` unless the rule holds."""
    if not holds:
        fail(thing, rule, got, remedy)


def array(
    value: ArrayLike,
    thing: str,
    *,
    shape: tuple[int | None, ...],
    dtype: type[np.generic] = np.float32,
    low: float | None = None,
    high: float | None = None,
) -> NDArray[Any]:
    """A finite array of the wanted shape, as ``dtype``.

    Args:
        value: what came.
        thing: its name in the error.
        shape: the length of each axis; None for any.
        dtype: the type of the result.
        low: smallest value allowed.
        high: largest value allowed.

    Raises:
        InputError: no array, wrong number of axes or length, NaN or infinity, a value out of range.
    """
    try:
        result = np.asarray(value)
    except ValueError:
        fail(thing, "must be an array", "rows of different lengths", "pass rows of one length")
    fits = result.ndim == len(shape) and all(
        n is None or n == m for n, m in zip(shape, result.shape, strict=True)
    )
    wanted = "(" + ", ".join("any" if n is None else str(n) for n in shape) + ")"
    require(fits, thing, f"must have shape {wanted}", result.shape, "pass an array of that shape")
    numeric = np.issubdtype(result.dtype, np.number) or result.dtype == np.bool_
    require(numeric, thing, "must hold numbers", result.dtype, "pass an array of numbers")
    finite = bool(np.isfinite(result).all())
    require(finite, thing, "must be finite", "NaN or infinity", "replace those values")
    if result.size:
        least, most = float(result.min()), float(result.max())
        if low is not None:
            require(least >= low, thing, f"must be at least {low:g}", f"{least:g}", "raise those values")
        if high is not None:
            require(most <= high, thing, f"must be at most {high:g}", f"{most:g}", "lower those values")
    return np.ascontiguousarray(result, dtype=dtype)


def nearest_name(name: str, known: Iterable[str]) -> str:
    """The remedy for an unknown name: the known one that looks most like it."""
    names = sorted(known)
    close = difflib.get_close_matches(name, names, n=1, cutoff=0.5)
    return f"did you mean {close[0]!r}?" if close else f"use one of {', '.join(names)}"


def one_line(text: str) -> str:
    """The text without line breaks, so that an error stays one line."""
    return " ".join(text.split())
