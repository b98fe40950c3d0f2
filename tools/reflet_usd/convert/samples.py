"""Times at which values change: samples, spline knots, and jumps between continuous pieces."""

import itertools
from collections.abc import Callable, Iterable

import numpy as np
from pxr import Usd

from .context import Context
from .scene import Array

# A change by more than this share of a value within one rounding of time is a jump.
JUMP = 1e-7


def value_codes(attribute: Usd.Attribute) -> list[float]:
    """The codes of the attribute's time samples, or of its spline's knots, in order."""
    if attribute.HasSpline():
        return [float(code) for code in attribute.GetSpline().GetKnotsWithInnerLoopsBaked()]
    return list(attribute.GetTimeSamples())


def first_code(attribute: Usd.Attribute) -> float | None:
    """The first of `value_codes`."""
    if attribute.GetNumTimeSamples() == 0 and not attribute.HasSpline():
        return None
    return next(iter(value_codes(attribute)), None)


def warn_extrapolation(context: Context, attribute: Usd.Attribute) -> None:
    """Warn about a spline that goes on beyond its knots, where glTF holds the outermost keys."""
    from pxr import Ts

    spline = attribute.GetSpline()
    modes = (spline.GetPreExtrapolation().mode, spline.GetPostExtrapolation().mode)
    if any(mode != Ts.ExtrapHeld for mode in modes):
        message = f"the spline of '{attribute.GetName()}' is held before and after its knots"
        context.ledger.warn("spline-extrapolation-clamped", attribute.GetPrim(), message)


def before(code: float) -> float:
    """The last representable code before `code`, at which the value before a jump is read."""
    return float(np.nextafter(code, -np.inf))


def is_jump(first: float, last: float) -> bool:
    """Whether two neighboring codes are the two sides of a jump."""
    return first == before(last)


def with_jumps(evaluate: Callable[[float], Array], codes: list[float]) -> list[float]:
    """`codes`, with one more before each code at which the matrix jumps.

    Blocked samples, held segments and knots with two values make jumps.
    """
    found = codes[:1]
    for code in codes[1:]:
        left, right = evaluate(before(code)), evaluate(code)
        size = max(float(np.abs(left).max()), float(np.abs(right).max()))
        if np.abs(left - right).max() > JUMP * size:
            found.append(before(code))
        found.append(code)
    return found


def seconds_of(context: Context, codes: Iterable[float]) -> Array:
    """Seconds of the keys; the sides of a jump are neighbors in single precision."""
    codes = list(codes)
    times = np.array([context.seconds(code) for code in codes])
    for index, (first, last) in enumerate(itertools.pairwise(codes)):
        if is_jump(first, last):
            after = np.float32(times[index + 1])
            if after > times[index + 1]:
                after = np.nextafter(after, np.float32(-np.inf))
            times[index : index + 2] = np.nextafter(after, np.float32(-np.inf)), after
    return times
