"""Carrying out ``orbitproof explore atlas``: tracing or reading the family, covering it, writing the atlas."""

from __future__ import annotations

import argparse
import time
from dataclasses import replace
from fractions import Fraction
from math import inf

from orbitproof.explore.atlases import (
    BEYOND,
    AtlasRequest,
    CoverControl,
    CoverFailure,
    IncompleteAtlas,
    LibrationFailure,
    Source,
    build_atlas,
    check_names,
)
from orbitproof.explore.engines import Reporter
from orbitproof.explore.families import Family, FamilyFailure, Limits, family_of
from orbitproof.explore.names import label_of
from orbitproof.explore.orbits import CorrectionFailure
from orbitproof.explore.records import read_families
from orbitproof.explore.three_body.atlases import doubled_atlas
from orbitproof.explore.three_body.families import branch_of, trace_family, trace_reaching
from orbitproof.explore.three_body.names import given_parameters, name_on, on_branch
from orbitproof.shared.formats import Atlas, InputError, write_atlas
from orbitproof.shared.systems import REGULARISATIONS
from orbitproof.shared.wording import counted


def run_source(source: Source, options: argparse.Namespace) -> int:
    """Cover the curve and write the atlas; returns the exit code. Raises `InputError`."""
    started = time.monotonic()
    with Reporter(options.quiet) as report:
        try:
            family, name, label = _family(source, options, report)
            problem = family.problem
            if options.coordinates == "regularised" and problem.system.name not in REGULARISATIONS:
                raise InputError(f"--coordinates regularised: {problem.system.name} has none; leave it out")
            branch = branch_of(family)
            orbits = f"{on_branch(name, branch)} orbits of the {problem.system.title}"
            title = orbits + (f", mass parameter {label}" if label else "")
            request = AtlasRequest(
                id=options.id or options.preset or f"{name}-{label or family.problem.system.name}",
                title=source.title or title,
                family=family,
                covers=source.covers,
                increasing=source.increasing,
                tube=options.tube,
                control=CoverControl(options.degree, options.decay, options.overlap),
                coordinates=None if options.coordinates == "auto" else options.coordinates,
                arc=options.arc,
                provenance={
                    "family": name,
                    **({"branch": branch} if branch else {}),
                    "degree": options.degree,
                    "decay": options.decay,
                },
            )
            report.stage("covering")
            atlas = (doubled_atlas if source.birth else build_atlas)(request, report.update)
        except IncompleteAtlas as error:
            write_atlas(options.output, error.atlas)
            report.error(f"{error}; {options.output} holds the part up to there: {summary(error.atlas)}")
            return 1
        except (FamilyFailure, CorrectionFailure, CoverFailure, LibrationFailure) as error:
            report.error(f"{error}")
            return 1
        write_atlas(options.output, atlas)
        report.message(f"{options.output}: {summary(atlas)}, {time.monotonic() - started:.0f} s")
    return 0


def summary(atlas: Atlas) -> str:
    """The atlas in one line."""
    pieces = atlas.curve_pieces()
    regularised = sum(piece.coordinates == "regularised" for piece in pieces)
    widths = [float(piece.half_width) for piece in pieces]
    inside = f", {regularised} of them in regularised coordinates" if regularised else ""
    parts = counted(len(pieces), "piece")
    return f"{atlas.claim.kind} of {parts}{inside}, half-widths {min(widths):.2g} to {max(widths):.2g}"


def _family(source: Source, options: argparse.Namespace, report: Reporter) -> tuple[Family, str, str]:
    """The family with its name and the name of its mass, "" without one. Raises `InputError` and failures."""
    if source.path is not None:
        return _read(source)
    assert source.system is not None
    assert source.family is not None
    report.stage("tracing")
    parameters, limits = given_parameters(source.system, source.mass, options.parameter), _limits(source, options)
    covers, named, place = source.covers, (source.system, source.family, parameters), None
    if covers is not None:
        place = covers.coordinate, float(max(covers.start, covers.end, key=abs))
    family, branch = trace_reaching(*named, limits, options.branch, place, progress=report.update)
    if family.outcome != "interrupted" and _begins_beyond(family, limits):
        above = _limits_from_above(source, limits)
        family = trace_family(*named, above, branch=branch, progress=report.update)
    if family.outcome == "interrupted":
        raise KeyboardInterrupt
    name = name_on(source.family, branch)
    report.message(f"{name}: {counted(len(family.orbits), 'orbit')}, {family.reason}")
    return family, name, label_of(source.system, source.mass, options.parameter)


def _limits(source: Source, options: argparse.Namespace) -> Limits:
    """How far the family is traced: to the limits of the options, and a little beyond what has to be covered."""
    limits = Limits(options.max_orbits, integral_min=options.jacobi_min, min_distance=options.min_distance)
    covers, system = source.covers, source.system
    if covers is None or system is None:
        return limits
    margin = 4 * BEYOND
    if covers.coordinate == system.family_parameter:
        low = max(covers.start * (1 - margin), 1 + (covers.start - 1) * Fraction(9, 10))
        return Limits(options.max_orbits, parameter_min=float(low), parameter_max=float(covers.end * (1 + margin)))
    bound = float(max(abs(covers.start), abs(covers.end)) * (1 + margin))
    return Limits(
        options.max_orbits,
        {covers.coordinate: bound},
        integral_min=options.jacobi_min,
        min_distance=options.min_distance,
    )


def _begins_beyond(family: Family, limits: Limits) -> bool:
    """Whether the family has to come down to what is to be covered."""
    names, first = family.problem.system.centre_coordinates, family.orbits[0].unknowns
    return any(abs(first[names.index(name)]) >= bound for name, bound in limits.coordinate_max.items())


def _limits_from_above(source: Source, limits: Limits) -> Limits:
    """Limits of a family along which the coordinate falls."""
    assert source.covers is not None
    lowest = source.covers.start - 4 * BEYOND * abs(source.covers.start)
    return replace(limits, coordinate_max={}, bounds={source.covers.coordinate: (float(lowest), inf)})


def _read(source: Source) -> tuple[Family, str, str]:
    assert source.path is not None
    records = read_families(source.path)
    found = [
        record
        for record in records
        if source.family in (None, record.name)
        and (source.mass is None or record.parameters == given_parameters(record.system, source.mass, None))
    ]
    if len(found) != 1:
        names = ", ".join(" ".join(part for part in (record.label, record.name) if part) for record in records)
        count = "several such families" if found else "no such family"
        raise InputError(f"{source.path}: {count}; choose one with --family and --mass among: {names}")
    family = family_of(found[0])
    check_names(family.problem.system, source.covers, source.increasing)
    return family, found[0].name, found[0].label
