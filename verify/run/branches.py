"""A run over an atlas: its pieces side by side, those that fail split in two, results kept as they come."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import cast

from orbitproof.shared.formats import (
    AnyAtlas,
    AnyPiece,
    ArgumentError,
    Atlas,
    InputError,
    Piece,
    check_writable,
)
from orbitproof.shared.systems import UNLISTED
from orbitproof.verify.branches import (
    Lines,
    Result,
    conclusion_of,
    condition_of,
    covers,
    kind_of,
    make_atlas_certificate,
)
from orbitproof.verify.branches.interval_proof import prove_task
from orbitproof.verify.certificate import Certificate, read_certificate, write_certificate
from orbitproof.verify.curve import SINGULAR, Interval, is_born_at_doubling
from orbitproof.verify.evidence import exact_interval_text
from orbitproof.verify.lasting import (
    LEAST_ORDER,
    CurveIntervalResult,
    exceptions_to_sharpen,
    is_known_of,
    twist_open_on,
)
from orbitproof.verify.run import Answer, Display, Engine, Task, Work, Workplace
from orbitproof.verify.run.branch_checks import checked_side_by_side, watching
from orbitproof.verify.run.branch_tasks import (
    HALVED_FOR_LASTING,
    RunLimits,
    all_attempts_of,
    attempts_of,
    for_slopes_of,
    in_vain,
    result_of,
    reusable,
    task_of,
)
from orbitproof.verify.run.piece_order import longest_first
from orbitproof.verify.run.splitting import UNFINISHED, Plan, full_interval, made_with, plan, with_closer_looks
from orbitproof.verify.stability import open_on

_STEPS_AT_FIRST = 16
"""The number of integration steps that progress reckons with before the first result."""

Saved = Callable[[Sequence[Result]], None]
"""Called with all results so far, after each one."""


class AtlasRun:
    """The results of an atlas so far, and what is left to do.

    A piece of which one interval cannot be proved is given up: the rest of it would not make the curve whole.
    """

    def __init__(
        self,
        atlas: AnyAtlas,
        limits: RunLimits,
        earlier: Sequence[Result] = (),
        output: Path | None = None,
        proved: Path | None = None,
    ) -> None:
        """`earlier` are results that count already; `output` is the file that keeps them.

        `proved` is a file that holds a proof, which stays until this run has one: then it is written there.
        """
        self.atlas = atlas
        self.limits = limits
        self.output, self.proved = output, proved
        self._attempts = attempts_of(atlas, limits)
        self._all_attempts = all_attempts_of(atlas, limits)
        self._results: dict[str, list[Result]] = {piece.id: [] for piece in atlas.pieces}
        self._pieces = {piece.id: piece for piece in atlas.pieces}
        # The result is kept with what is found of it, so that its identity is not given to another one.
        self._lacking: dict[int, tuple[Result, str]] = {}
        self._to_sharpen: dict[int, tuple[Result, Sequence[Interval]]] = {}
        self._begun: set[tuple[str, Interval, int]] = set()
        self._told: set[str] = set()
        self._plans: dict[str, Plan] = {}
        for piece in atlas.pieces:
            self._add(piece.id, [result for result in earlier if result.piece == piece.id])
        self._order = longest_first(atlas, self._attempts[0])
        self.kept = frozenset(self._plans) - frozenset(self.pending)
        """Ids of the pieces that an earlier run had settled."""

    @property
    def results(self) -> list[Result]:
        """All results, by pieces, of each in the order of its intervals, of these as they came."""
        ordered = [sorted(results, key=lambda each: each.interval) for results in self._results.values()]
        return [result for results in ordered for result in results]

    @property
    def pending(self) -> list[str]:
        """Ids of the pieces of which something is to be tried yet."""
        return [name for name, state in self._plans.items() if not state.is_settled]

    def plan_of(self, piece: str) -> Plan:
        """What is left to do for a piece."""
        return self._plans[piece]

    def results_of(self, piece: str) -> Sequence[Result]:
        """The results of a piece."""
        return self._results[piece]

    def run(self, engine: Engine, display: Display, saved: Saved, work: Work = prove_task) -> None:
        """Prove what is left; what `saved` raises ends the run."""

        def progress(name: str, fraction: float, label: str) -> None:
            display.advance(name, self._share(name, fraction), label)

        def finished(answer: Answer) -> None:
            name = answer.task.name
            result = result_of(answer, self._pieces[name], kind_of(self.atlas))
            self._add(name, [result])
            saved(self.results)
            self._tell(display, name, result)

        engine.run(work, self._next, progress, finished)

    def _add(self, piece: str, found: Sequence[Result]) -> None:
        """Take results of a piece, in whatever order they come."""
        self._results[piece] += [self._as_it_counts(result) for result in found]
        self._plans[piece] = self._plan(self._pieces[piece])

    def _as_it_counts(self, result: Result) -> Result:
        """A result; in vain if it decides less: over the same s that of the shortest interval counts (18.5)."""
        return in_vain(result) if self._is_look(result) and result.is_proved and self._lacks(result) else result

    def _is_look(self, result: Result) -> bool:
        return self.limits.lasting and made_with(result, self._all_attempts[-1])

    def _plan(self, piece: AnyPiece) -> Plan:
        results, lasting = self._results[piece.id], self.limits.lasting
        state = plan(
            piece,
            results,
            self._attempts,
            # A piece of a birth is proved on intervals about its middle, and no half of one is shorter (16.12).
            self.limits.max_splits if piece.can_be_halved else 0,
            self._lacks,
            HALVED_FOR_LASTING if lasting else 0,
            for_slopes_of(self._attempts),
        )
        return with_closer_looks(state, results, self._rough, self._all_attempts) if lasting else state

    def _rough(self, result: Result) -> Sequence[Interval]:
        """Intervals about exceptions that a result knows, and less well than is wanted."""
        piece = self._pieces[result.piece]
        if not piece.is_of_curve or self._lacks(result):
            return ()
        if id(result) not in self._to_sharpen:
            self._to_sharpen[id(result)] = (result, exceptions_to_sharpen(cast(Piece, piece), _listed(result)))
        return self._to_sharpen[id(result)][1]

    def _lacks(self, result: Result) -> str:
        """What a list of resonances leaves open on a proved interval."""
        piece = self._pieces[result.piece]
        if not (self.limits.stability and piece.is_of_curve):
            return ""
        if id(result) not in self._lacking:
            of_curve, known = cast(Piece, piece), _listed(result)
            lacks = open_on(of_curve, known, self.limits.order)
            if not lacks and self.limits.lasting:
                lacks = twist_open_on(of_curve, known)
            self._lacking[id(result)] = (result, lacks)
        return self._lacking[id(result)][1]

    def left_out(self, name: str) -> str:
        """What of a proved piece was not looked at to the end because a task came to no end; empty for nothing."""
        results = self._results[name] if self._plans[name].is_proved else ()
        proved = [result for result in results if result.is_proved]
        enough = [result.interval for result in proved if not self._lacks(result)]
        looks = [result.interval for result in proved if self._is_look(result)]
        lost = [
            result.interval
            for result in results
            if condition_of(result) in UNFINISHED
            and not (result.interval in looks if self._is_look(result) else covers(enough, result.interval))
        ]
        places = ", ".join(exact_interval_text(*interval) for interval in lost)
        return f"not looked at to the end, for want of time or memory: s in {places}" if lost else ""

    def _next(self) -> Task | None:
        """An interval that nobody works on, of the first such piece; so halves come before the pieces after it."""
        for name in self._order:
            state = self._plans[name]
            if state.is_settled:
                continue
            for interval, attempt in state.missing:
                if (name, interval, attempt) not in self._begun:
                    self._begun.add((name, interval, attempt))
                    settings = self._all_attempts[attempt]
                    return task_of(self.atlas, self._pieces[name], interval, settings, self.limits, self._steps())
        return None

    def _steps(self) -> int:
        steps = [result.computation.steps or 0 for result in self.results if result.is_proved]
        return max(steps, default=_STEPS_AT_FIRST)

    def _share(self, name: str, fraction: float) -> float:
        """The part of a piece that is done, if an interval of it is done to `fraction`."""
        start, end = full_interval(self._pieces[name])
        state = self._plans[name]
        done = sum(float(last - first) for first, last in state.proved) / float(end - start)
        longest = max((float(last - first) for (first, last), _ in state.missing), default=0.0) / float(end - start)
        return done + fraction * longest

    def _place(self, name: str, interval: Interval) -> str:
        """Where the middle of an interval is, in words, if its piece is one of a curve."""
        piece = self._pieces[name]
        if not piece.is_of_curve:
            return ""
        start, end = interval
        values = zip(
            kind_of(self.atlas).coordinates(self.atlas), cast(Piece, piece).point((start + end) / 2), strict=True
        )
        return ", near " + ", ".join(f"{coordinate} = {float(value):.6g}" for coordinate, value in values)

    def _tell(self, display: Display, name: str, result: Result) -> None:
        state = self._plans[name]
        if name in self._told:
            return
        if state.is_settled:
            self._told.add(name)
            results = self._results[name]
            seconds = sum(entry.computation.seconds for entry in results)
            number = sum(entry.is_proved for entry in results)
            inside = f" in {number} intervals" if number > 1 else ""
            message, place = "", ""
            if result.reason is not None:
                message, place = result.reason.message, self._place(name, result.interval)
                if result.reason.condition == SINGULAR:
                    message += f"; {result.reason.remedy}"
            verdict = f"proved{inside}" if state.is_proved else f"not proved{place}: {message}"
            verdict += f"; {left}" if (left := self.left_out(name)) else ""
            display.finish(name, f"{verdict}, {seconds:.1f} s")
            return
        if result.reason is not None:
            start, end = result.interval
            again = [attempt for interval, attempt in state.missing if interval == (start, end)]
            how = "more precision" if again[:1] < [len(self._attempts)] else "second derivatives"
            word = f"again with {how}" if again else "a closer look" if self._is_look(result) else "split"
            place = self._place(name, (start, end))
            display.message(
                f"{name}: {word}, not proved for s in {exact_interval_text(start, end)}{place}: {result.reason.message}"
            )
        display.advance(name, self._share(name, 0.0), "next interval")


def _listed(result: Result) -> CurveIntervalResult:
    """A result about a piece of a curve."""
    return cast(CurveIntervalResult, result)


def limits_of(
    atlas: AnyAtlas,
    complete: int | None = None,
    max_splits: int = RunLimits.max_splits,
    timeout: float | None = None,
    combinations: bool = False,
    lasting: bool = False,
    **integrator: int | None,
) -> RunLimits:
    """How to prove the pieces of an atlas.

    Args:
        complete: with it, all resonances up to this order are wanted too.
        combinations: with it and `complete`, combination resonances of linearly stable orbits are wanted too.
        lasting: whether it is wanted which orbits are stable for ever.
        integrator: precision, order, width, top for the first attempt, if not the default.

    Raises `InputError` for what cannot be asked of this atlas, `ValueError` for a limit that makes no sense.
    """
    if complete is not None and not kind_of(atlas).holds_points:
        raise ArgumentError(
            "{complete}: lists what is on a curve of symmetric orbits, and this atlas is about {0}; leave it out",
            kind_of(atlas).about,
        )
    if complete is not None and any(atlas.system is known for known in UNLISTED):
        raise ArgumentError("{complete}: no list is made of period doublings over the mass; leave it out")
    if complete is not None and is_born_at_doubling(cast(Atlas, atlas)):
        raise ArgumentError(
            "{complete}: no list is made of a curve with a piece of a birth; leave it out, or that piece"
        )
    if combinations and (complete is None or len(atlas.curve_pieces()[0].tube) != 2):
        raise ArgumentError(
            "{combinations}: belongs to {complete}, for curves with two stability parameters; leave it out"
        )
    if lasting and (complete is None or complete < LEAST_ORDER):
        raise ArgumentError(
            "{lasting=True:--lasting}: orbits in resonance 1:1 to 1:4 are exceptions; give {complete} at least {0}",
            LEAST_ORDER,
        )
    if lasting and not is_known_of(cast(Atlas, atlas).system):
        raise ArgumentError(
            "{lasting=True:--lasting}: is known for systems with one coordinate that R negates on the section, and "
            "without a level that is held; leave it out"
        )
    given = {name: value for name, value in integrator.items() if value is not None}
    order = 1 if complete is None else complete
    limits = RunLimits(given, timeout, max_splits, complete is not None, order, combinations, lasting)
    try:
        attempts_of(atlas, limits)
    except ValueError as error:
        raise ArgumentError("{precision}, {order}, {width}, {top}: {0}; give larger numbers", error) from None
    return limits


def started(atlas: AnyAtlas, limits: RunLimits, output: Path | None = None, fresh: bool = False) -> AtlasRun:
    """A run that keeps its results in a file, and begins with what an earlier one left there unless `fresh`.

    A file that holds a proof is not written before there is a new one; until then results stand beside it. Raises
    `InputError` if a file cannot be written, or holds something else: nothing of it is overwritten.
    """
    if output is None:
        return AtlasRun(atlas, limits)
    check_writable(output)
    beside = output.with_name(f"{output.name}.unfinished")
    stored = [_earlier(path, atlas, fresh) for path in (output, beside)]
    attempts = all_attempts_of(atlas, limits)
    found = [reusable(each, atlas, attempts, limits.stability, limits.lasting) for each in stored if each and not fresh]
    earlier = max(found, key=len, default=[])
    if stored[0] is None or not stored[0].proved:
        return AtlasRun(atlas, limits, earlier, output)
    check_writable(beside)
    return AtlasRun(atlas, limits, earlier, beside, output)


def _earlier(path: Path, atlas: AnyAtlas, fresh: bool) -> Certificate | None:
    """What an earlier run of an atlas left in a file; `None` if there is no file.

    For a file of anything else it raises `InputError`; with `fresh` it is `None`.
    """
    if not path.is_file():
        return None
    try:
        before = read_certificate(path, "atlas-certificate")
    except InputError as error:
        if fresh:
            return None
        raise ArgumentError("{0}; or replace the file with {fresh=True:--fresh}", error) from None
    if before.atlas.id == atlas.id:
        return before
    if fresh:
        return None
    raise ArgumentError(
        "{0}: holds the certificate of another atlas ({1!r}); choose another output, or replace the file with "
        "{fresh=True:--fresh}",
        path,
        before.atlas.id,
    )


def prove_pieces(run: AtlasRun, workplace: Workplace, work: Work = prove_task) -> None:
    """Prove what is left. What ends it, an interrupt too, leaves the results so far in the run and in its file."""
    display = Display(dict.fromkeys(run.pending, 1.0), workplace.quiet)
    if run.kept:
        count = f"{len(run.kept)} of {len(run.atlas.pieces)}"
        display.message(f"{count} pieces settled already, kept; a fresh run proves them again")
    if run.proved is not None and run.pending:
        display.message(f"{run.proved}: holds a proof, and stays until there is a new one; results: {run.output}")

    lines = Lines()

    def saved(results: Sequence[Result]) -> None:
        if run.output is not None:
            write_certificate(run.output, make_atlas_certificate(run.atlas, results, None, (), lines.entry), lines)

    with workplace.engine(workplace.timeout) as engine, display.shown():
        run.run(engine, display, saved, work)


def conclude_run(run: AtlasRun, bifurcations: Sequence[Certificate], workplace: Workplace) -> Certificate:
    """What the results give together, as a certificate, in the run's file too.

    The certificates of bifurcations are checked again first, side by side, and looked for on the curve.
    """
    conclusion = conclusion_of(
        run.atlas,
        run.results,
        bifurcations,
        lambda entries: checked_side_by_side(entries, False, workplace),
        run.limits.order if run.limits.stability else None,
        watching(workplace.quiet),
        run.limits.combinations,
    )
    certificate = make_atlas_certificate(run.atlas, run.results, conclusion, bifurcations)
    if run.output is not None and run.proved is not None and certificate["verdict"] == "proved":
        write_certificate(run.proved, certificate)
        run.output.unlink(missing_ok=True)
    elif run.output is not None:
        write_certificate(run.output, certificate)
    return Certificate(certificate)
