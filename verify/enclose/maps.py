"""Flows and Poincare maps by the names of a system's coordinates, with attempts at more precision."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction

from orbitproof.shared.systems import System
from orbitproof.verify.enclose.numbers import Number, exact, positive
from orbitproof.verify.enclose.results import Enclosure, Function, NotEnclosed, Zero
from orbitproof.verify.enclose.sets import Box, Section
from orbitproof.verify.evidence import (
    IntegrationFailure,
    Reason,
    enclose,
    guarded,
    is_below,
    without_result,
)
from orbitproof.verify.maps import (
    Format,
    FramingOracle,
    Image,
    displacement,
    enclose_flow,
    enclose_poincare_map,
    enclose_zeros,
)
from orbitproof.verify.oracle import ORACLE

LEAST_PRECISION = 128
MOST_PRECISION = 1024
MOST_DERIVATIVES = 3
_FARTHER = 1.01
"""More bits are worth while if the integration comes so many times as far."""


def flow(
    system: System,
    box: Box,
    time: Number,
    *,
    derivatives: int = 1,
    precision: int | None = None,
    digits: int = 15,
    degree: int | None = None,
    oracle: FramingOracle = ORACLE,
    progress: Callable[[int], None] | None = None,
) -> Enclosure | NotEnclosed:
    """Enclose the states at a time of all orbits that begin in a box, and their derivatives.

    Shown if an `Enclosure` is returned: all orbits that begin at real points of the box exist up to `time`, and every
    ball contains what it says at every point of the box (sections 2 to 4, 6 and 23.1). Not enclosed: the states on the
    way. `NotEnclosed` says why there is no enclosure; that does not show that orbits do not exist.

    Arguments:
        system: any system, from `shared.load_system` or `shared.define_system`; no symmetry is needed.
        box: from `box`, with a value for each state coordinate and parameter of the system.
        time: exact, in the system's units, of either sign.
        derivatives: largest order of the derivatives by the box's variables, at most 3.
        precision: bits; by default 128, and half as many more until the state at the centre has `digits` digits.
        digits: that are aimed at if no precision is given; an enclosure with fewer is returned if no attempt with up to
            1024 bits has as many.
        degree: of the polynomials in the box's variables that are kept; by default the largest order. More is
            sharper on large boxes.
        oracle: finds approximations; nothing is believed of it.
        progress: called after every step with the number of steps; what it raises passes through.

    Raises `ValueError` for wrong input.

    >>> from orbitproof.shared import define_system
    >>> from orbitproof.verify import enclose
    >>> oscillator = define_system({"name": "oscillator", "state": "x v", "field": {"x": "v", "v": "-x"}})
    >>> quarter = enclose.flow(oscillator, enclose.box({"x": 1, "v": 0}, radii={"x": "1e-3"}), "1/4")
    >>> quarter.centre.value["x"].str(12)
    '[0.968912421711 +/- 3.56e-13]'
    """
    start, length = box.of(system), exact("time", time)
    if not length:
        raise ValueError("time: it is 0; give another one")
    order, told = _order(derivatives), _Progress(progress)
    kept = _degree(order, degree)

    def attempt(bits: int) -> Image:
        return enclose_flow(system.program, start, length, Format(bits, kept), oracle, told)

    found, bits = _attempts(attempt, told, precision, digits)
    return found if isinstance(found, NotEnclosed) else Enclosure(system, box, order, bits, found)


def poincare_map(
    system: System,
    box: Box,
    section: Section,
    *,
    direction: int = 0,
    crossings: int = 1,
    derivatives: int = 1,
    precision: int | None = None,
    digits: int = 15,
    degree: int | None = None,
    oracle: FramingOracle = ORACLE,
    progress: Callable[[int], None] | None = None,
) -> Enclosure | NotEnclosed:
    """Enclose where and when orbits that begin in a box cross a section for the n-th time, with derivatives.

    Shown if an `Enclosure` is returned: every orbit that begins at a real point of the box crosses the section
    transversally at least n times after the start in the direction asked for, the n-th time at the point and the time
    in the balls; no crossing before it was missed, and the orbit is tangent to the section at none of the times up to
    it (sections 5 and 23.3). The whole box has to lie on the section, exactly, and its orbits cross it there, which
    does not count; or else it has to lie on one side of the section. Not enclosed: what happens between crossings.
    Orbits that touch the section, or come so near that enclosures cannot tell, are `NotEnclosed`, whichever direction
    is asked for.

    Arguments: those of `flow` except its time, and
        section: from `section`.
        direction: 1 for crossings at which normal . x increases, -1 where it decreases, 0 for both.
        crossings: n, at least 1.

    Raises `ValueError` for wrong input.

    >>> from orbitproof.shared import define_system
    >>> from orbitproof.verify import enclose
    >>> oscillator = define_system({"name": "oscillator", "state": "x v", "field": {"x": "v", "v": "-x"}})
    >>> ball = enclose.box({"x": 1, "v": 0}, radii={"x": "1e-3"})
    >>> half = enclose.poincare_map(oscillator, ball, enclose.section("v"), direction=1)
    >>> half.centre.time.str(12), half.jacobian["x"][0].str(12)
    ('[3.14159265359 +/- 2.07e-13]', '[-1.00000000000 +/- 1e-30]')
    """
    start, plane = box.of(system), section.of(system)
    if direction not in (-1, 0, 1) or isinstance(direction, bool):
        raise ValueError(f"direction: {direction!r} is none; give 1, -1, or 0 for both")
    number, order, told = positive("crossings", crossings), _order(derivatives), _Progress(progress)
    kept = _degree(order, degree)

    def attempt(bits: int) -> Image:
        return enclose_poincare_map(system.program, start, plane, direction, number, Format(bits, kept), oracle, told)

    found, bits = _attempts(attempt, told, precision, digits)
    return found if isinstance(found, NotEnclosed) else Enclosure(system, box, order, bits, found, section)


def fixed_point_functions(image: Enclosure) -> tuple[Function, ...]:
    """P(x) - x in all state coordinates but one: their common zeros in a box on the section are the points P(x) = x.

    The coordinate that is left out follows from the others, because x and P(x) lie on the section (section 23.4).
    Parameters keep their values along an orbit, so that these may vary over the box too.

    Raises `ValueError` unless `image` is a Poincare map and its box lies on its section.
    """
    if image.section is None:
        raise ValueError("image: it is not on a section; give a Poincare map")
    with guarded(image.precision):
        tables = displacement(image.box.of(image.system), image.section.of(image.system), image.image)
    return tuple(Function(image.box, table, image.precision) for table in tables)


def interval_newton(functions: Sequence[Function]) -> Zero | NotEnclosed:
    """Show that functions on one box have exactly one common zero there, by the interval Newton operator (Lemma 5).

    With fewer functions than variables the first variables are independent: for each value of them there is exactly
    one zero, and it depends smoothly on them. Not shown: anything about points outside the box.

    Raises `ValueError` for functions on different boxes, or more functions than variables.
    """
    if not functions or any(each.box != functions[0].box for each in functions):
        raise ValueError("functions: give at least one, all on one box")
    box, precision = functions[0].box, min(each.precision for each in functions)
    if len(functions) > len(box.radii):
        raise ValueError(f"functions: {len(functions)} for {len(box.radii)} variables; give as many at most")
    try:
        with guarded(precision):
            zeros = enclose_zeros([each.table for each in functions], box.radii)
    except IntegrationFailure as failure:
        return NotEnclosed(failure.reason, precision)
    return Zero(box, len(box.radii) - len(functions), zeros.at, precision, zeros)


def _order(derivatives: int) -> int:
    if positive("derivatives", derivatives, 0) > MOST_DERIVATIVES:
        raise ValueError(f"derivatives: {derivatives} is more than {MOST_DERIVATIVES}")
    return derivatives


def _degree(order: int, degree: int | None) -> int:
    return max(1, order) if degree is None else positive("degree", degree)


def _attempts(
    attempt: Callable[[int], Image], progress: _Progress, precision: int | None, digits: int
) -> tuple[Image | NotEnclosed, int]:
    """What the first attempt with enough bits gives, or else the last one that gives something; and its bits."""
    bits = LEAST_PRECISION if precision is None else positive("precision", precision, 32)
    positive("digits", digits)
    found, before = _once(attempt, progress, bits), None
    while precision is None and not _is_enough(found, digits) and (more := bits + bits // 2) <= MOST_PRECISION:
        if isinstance(found, NotEnclosed):
            reason = found.reason
            stuck = before is not None and reason.reached is not None and abs(reason.reached) <= abs(before) * _FARTHER
            if not reason.needs_precision or stuck:
                break
            before = reason.reached
        now = _once(attempt, progress, more)
        if isinstance(now, NotEnclosed) and not isinstance(found, NotEnclosed):
            break
        found, bits = now, more
    return found, bits


@dataclass
class _Progress:
    """Calls for progress, of which what is raised is kept apart from what integrations raise."""

    call: Callable[[int], None] | None
    raised: BaseException | None = None

    def __call__(self, steps: int) -> None:
        try:
            if self.call is not None:
                self.call(steps)
        except BaseException as error:
            self.raised = error
            raise


def _once(attempt: Callable[[int], Image], progress: _Progress, bits: int) -> Image | NotEnclosed:
    try:
        return attempt(bits)
    except (IntegrationFailure, ArithmeticError, ValueError) as error:
        if error is progress.raised:
            raise
        if isinstance(error, IntegrationFailure):
            return NotEnclosed(error.reason, bits)
        return NotEnclosed(
            Reason("evaluation", without_result(error), "give smaller radii, or more precision", True), bits
        )


def _is_enough(found: Image | NotEnclosed, digits: int) -> bool:
    if isinstance(found, NotEnclosed):
        return False
    zero = next(iter(found.time.centre))
    unit = enclose(Fraction(1, 10**digits))
    values = [table.centre[zero] for table in found.state]
    return all(is_below(value.rad(), unit * (1 + abs(value.mid()))) for value in values)
