"""A run over an atlas: its pieces side by side, those that fail split in two, results kept as they come."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from orbitproof.shared.formats import AnyPiece, Atlas, Piece
from orbitproof.verify.atlas.certificate import Result
from orbitproof.verify.atlas.splitting import Plan, interval_of, plan, whole
from orbitproof.verify.atlas.task import RunLimits, attempts_of, prove_task, result_of, task_of
from orbitproof.verify.curve import Interval
from orbitproof.verify.engines import Answer, Display, Engine, Task, Work
from orbitproof.verify.evidence import exact_interval_text
from orbitproof.verify.stability import open_on

_STEPS_AT_FIRST = 16
"""The number of integration steps that progress reckons with before the first result."""

Saved = Callable[[Sequence[Result]], None]
"""Called with all results so far, after each one."""


class AtlasRun:
    """The results of an atlas so far, and what is left to do.

    A piece of which one interval cannot be proved is given up: the rest of it would not make the curve whole.
    """

    def __init__(self, atlas: Atlas, limits: RunLimits, earlier: Sequence[Result] = ()) -> None:
        """`earlier` are results that count already."""
        self.atlas = atlas
        self.limits = limits
        self._attempts = attempts_of(atlas, limits)
        self._results: dict[str, list[Result]] = {piece.id: [] for piece in atlas.pieces}
        for result in earlier:
            self._results[result["piece"]].append(result)
        self._pieces = {piece.id: piece for piece in atlas.pieces}
        self._lacking: dict[int, tuple[Result, str]] = {}
        self._begun: set[tuple[str, Interval, int]] = set()
        self._told: set[str] = set()
        self._plans = {piece.id: self._plan(piece) for piece in atlas.pieces}

    @property
    def results(self) -> list[Result]:
        """All results, by pieces."""
        return [result for results in self._results.values() for result in results]

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
            result = result_of(answer)
            name = answer.task.name
            self._results[name].append(result)
            self._plans[name] = self._plan(self._pieces[name])
            saved(self.results)
            self._tell(display, name, result)

        engine.run(work, self._next, progress, finished)

    def _plan(self, piece: AnyPiece) -> Plan:
        return plan(piece, self._results[piece.id], self._attempts, self.limits.max_splits, self._lacks)

    def _lacks(self, result: Result) -> str:
        """What a list of resonances leaves open on a proved interval."""
        piece = self._pieces[result["piece"]]
        if not self.limits.stability or not isinstance(piece, Piece):
            return ""
        if id(result) not in self._lacking:
            # The result is kept with it, so that its identity is not given to another one.
            self._lacking[id(result)] = (result, open_on(piece, result, self.limits.order))
        return self._lacking[id(result)][1]

    def _next(self) -> Task | None:
        """The first interval along the curve that nobody works on; so halves come before pieces further on."""
        for name, state in self._plans.items():
            if state.is_settled:
                continue
            for interval, attempt in state.missing:
                if (name, interval, attempt) not in self._begun:
                    self._begun.add((name, interval, attempt))
                    settings = self._attempts[attempt]
                    return task_of(self.atlas, self._pieces[name], interval, settings, self.limits, self._steps())
        return None

    def _steps(self) -> int:
        steps = [int(result["computation"].get("steps", 0)) for result in self.results if result["verdict"] == "proved"]
        return max(steps, default=_STEPS_AT_FIRST)

    def _share(self, name: str, fraction: float) -> float:
        """The part of a piece that is done, if an interval of it is done to `fraction`."""
        start, end = whole(self._pieces[name])
        state = self._plans[name]
        done = sum(float(last - first) for first, last in state.proved) / float(end - start)
        longest = max((float(last - first) for (first, last), _ in state.missing), default=0.0) / float(end - start)
        return done + fraction * longest

    def _tell(self, display: Display, name: str, result: Mapping[str, Any]) -> None:
        state = self._plans[name]
        if name in self._told:
            return
        if state.is_settled:
            self._told.add(name)
            results = self._results[name]
            seconds = sum(float(entry["computation"]["seconds"]) for entry in results)
            number = sum(entry["verdict"] == "proved" for entry in results)
            inside = f" in {number} intervals" if number > 1 else ""
            verdict = f"proved{inside}" if state.is_proved else f"not proved: {result['reason']['message']}"
            display.finish(name, f"{verdict}, {seconds:.1f} s")
            return
        if result["verdict"] != "proved":
            start, end = interval_of(result)
            message = result["reason"]["message"]
            again = any(interval == (start, end) for interval, _ in state.missing)
            word = "again with more precision" if again else "split"
            display.message(f"{name}: {word}, not proved for s in {exact_interval_text(start, end)}: {message}")
        display.advance(name, self._share(name, 0.0), "next interval")
