"""Enclosure as a number: arithmetic rounded outward, comparisons that are proven or refused, formats."""

from __future__ import annotations

import math
import operator
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from fractions import Fraction
from numbers import Rational
from typing import Any, Callable

import numpy as np

from ._verisq import Enclosure


class Undecided(ValueError):
    """An enclosure proves neither a comparison nor its opposite: ask for a smaller tolerance, or look at lo and hi."""


def _ends(x: Any) -> tuple[float, float] | None:
    """Both ends of an enclosure or of a real number; its neighbours where binary64 does not hold it. None of others."""
    if isinstance(x, Enclosure):
        return x.lo, x.hi
    if isinstance(x, np.integer):
        x = int(x)
    if isinstance(x, np.floating) and x.itemsize <= 8:
        x = float(x)
    if isinstance(x, float):
        return None if math.isnan(x) else (x, x)
    if isinstance(x, bool) or not isinstance(x, (Rational, Decimal)) or (isinstance(x, Decimal) and not x.is_finite()):
        return None
    exact = Fraction(x)
    try:
        near = float(exact)
    except OverflowError:
        near = math.inf if exact > 0 else -math.inf
    return _rounded(near, exact, down=True), _rounded(near, exact, down=False)


def _rounded(near: float, exact: Fraction, *, down: bool) -> float:
    """The binary64 number next to `exact`, on that side. Precondition: `near` is exact rounded, in any way."""
    if math.isinf(near):
        if (near > 0) == down:
            return math.copysign(math.nextafter(math.inf, 0.0), near)
        return near
    if down and Fraction(near) > exact:
        return math.nextafter(near, -math.inf)
    if not down and Fraction(near) < exact:
        return math.nextafter(near, math.inf)
    return near


def _applied(operation: Callable[[Any, Any], Any], a: float, b: float, *, down: bool) -> float:
    """One operation of two ends, of which infinite ones are limits, rounded to that side."""
    value = operation(a, b)
    if math.isnan(value):  # infinity less infinity: nothing is known
        return -math.inf if down else math.inf
    if math.isinf(a) or math.isinf(b):
        return value
    return _rounded(value, operation(Fraction(a), Fraction(b)), down=down)


def _of_all_ends(operation: Callable[[Any, Any], Any], a: tuple[float, float], b: tuple[float, float]) -> Enclosure:
    """The hull of the operation's results for the four pairs of ends: right where it is monotone in each operand."""
    pairs = [(x, y) for x in a for y in b]
    return Enclosure(
        min(_applied(operation, x, y, down=True) for x, y in pairs),
        max(_applied(operation, x, y, down=False) for x, y in pairs),
    )


def _sum(a: tuple[float, float], b: tuple[float, float]) -> Enclosure:
    return Enclosure(
        _applied(operator.add, a[0], b[0], down=True), _applied(operator.add, a[1], b[1], down=False)
    )


def _product(a: tuple[float, float], b: tuple[float, float]) -> Enclosure:
    # 0 times a limit is 0.
    return _of_all_ends(lambda x, y: x * y if x and y else type(x)(0), a, b)


def _quotient(a: tuple[float, float], b: tuple[float, float]) -> Enclosure:
    if b[0] <= 0.0 <= b[1]:
        raise ZeroDivisionError(f"the divisor's enclosure contains 0: [{b[0]}, {b[1]}]")
    return _of_all_ends(operator.truediv, a, b)


def _difference(a: tuple[float, float], b: tuple[float, float]) -> Enclosure:
    return _sum(a, (-b[1], -b[0]))


def _operator(operation: Callable[[Any, Any], Enclosure], *, reflected: bool = False) -> Callable[[Any, Any], Any]:
    def method(self: Enclosure, other: Any) -> Any:
        ends = _ends(other)
        if ends is None:
            return NotImplemented
        return operation(ends, _ends(self)) if reflected else operation(_ends(self), ends)

    return method


def _comparison(sign: str, is_proven: Callable[[Any, Any], bool], is_refuted: Callable[[Any, Any], bool]):
    def method(self: Enclosure, other: Any) -> Any:
        ends = _ends(other)
        if ends is None:
            return NotImplemented
        mine = _ends(self)
        if is_proven(mine, ends):
            return True
        if is_refuted(mine, ends):
            return False
        shown = f"[{ends[0]}, {ends[1]}]" if isinstance(other, Enclosure) else other
        raise Undecided(
            f"undecided: [{self.lo}, {self.hi}] {sign} {shown}; look at lo and hi, or ask for a smaller tolerance"
        )

    return method


def _absolute(self: Enclosure) -> Enclosure:
    if self.lo >= 0.0:
        return Enclosure(self.lo, self.hi)
    if self.hi <= 0.0:
        return Enclosure(-self.hi, -self.lo)
    return Enclosure(0.0, max(-self.lo, self.hi))


def _end_as_text(end: float, spec: str, rounding: str) -> str:
    """`end` as format() writes it, but rounded in that direction: what is shown contains what is enclosed."""
    kind = spec[-1]
    if kind not in "eEfFgG":
        raise ValueError(f"an enclosure is written as e, f or g, as in .3f, not as {spec}")
    if math.isinf(end):
        return format(end, spec)
    _, _, digits = spec[:-1].rpartition(".")
    precision = int(digits) if "." in spec else 6
    if kind in "fF":
        exact = Context(prec=400 + precision, rounding=rounding)  # binary64 has 309 digits before the point
        return format(exact.quantize(Decimal(end), Decimal(1).scaleb(-precision)), spec)
    significant = precision + 1 if kind in "eE" else max(precision, 1)
    return format(Context(prec=significant, rounding=rounding).create_decimal(Decimal(end)), spec)


def _format(self: Enclosure, spec: str) -> str:
    if not spec:
        return repr(self)
    return f"[{_end_as_text(self.lo, spec, ROUND_FLOOR)}, {_end_as_text(self.hi, spec, ROUND_CEILING)}]"


def make_numbers() -> None:
    """Adds all of it to the class, whose ends the compiled part keeps."""
    for name, operation in (("add", _sum), ("sub", _difference), ("mul", _product), ("truediv", _quotient)):
        setattr(Enclosure, f"__{name}__", _operator(operation))
        setattr(Enclosure, f"__r{name}__", _operator(operation, reflected=True))
    Enclosure.__neg__ = lambda self: Enclosure(-self.hi, -self.lo)
    Enclosure.__pos__ = lambda self: self
    Enclosure.__abs__ = _absolute
    Enclosure.__lt__ = _comparison("<", lambda a, b: a[1] < b[0], lambda a, b: a[0] >= b[1])
    Enclosure.__le__ = _comparison("<=", lambda a, b: a[1] <= b[0], lambda a, b: a[0] > b[1])
    Enclosure.__gt__ = _comparison(">", lambda a, b: a[0] > b[1], lambda a, b: a[1] <= b[0])
    Enclosure.__ge__ = _comparison(">=", lambda a, b: a[0] >= b[1], lambda a, b: a[1] < b[0])
    Enclosure.__format__ = _format
    Enclosure.__array_ufunc__ = None  # NumPy's numbers leave the operation to the enclosure
