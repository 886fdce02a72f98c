"""The part of plotly's script that pictures of lines in space need.

The script that plotly hands on draws some fifty kinds of traces. It is a bundle of parts, each
``var NAME=W((..)=>{..})`` and run when its name is first called; the last one names the kinds of traces. With one kind
left there, what no part calls any more can go. Local names are not told from those of parts: too much is kept, not too
little.
"""

from __future__ import annotations

import re

_PART = re.compile(r"(?<=;)var ([\w$]+)=W\((?:\(|[\w$]+=>)")
"""Where a part begins."""
_LAZY = re.compile(r"(?<![\w$.])([\w$]+)=(?:W\((?:\(|[\w$]+=>)|Ea\(\(\)=>)")
"""Names that parts are called by: more than one in a part that was a module of another kind."""
_CALLED = re.compile(r"(?<![\w$.])([A-Za-z_$][\w$]*)\(\)")
_TRACES = re.compile(r"(?<=\.register\(\[)(?:[\w$]+\(\),)+[\w$]+\(\)(?=\]\))")
_WANTED = '"scatter3d"'


def for_lines_in_space(script: str) -> str:
    """The script with what ``scatter3d`` needs; as it is where it is not made as expected."""
    starts = [match.start() for match in _PART.finditer(script)]
    if not starts:
        return script
    parts = [script[a:b] for a, b in zip(starts, [*starts[1:], len(script)], strict=True)]
    registered = _TRACES.findall(parts[-1])
    owner = {name: place for place, part in enumerate(parts) for name in _LAZY.findall(part)}
    if len(registered) != 1:
        return script
    traces = [call.removesuffix("()") for call in registered[0].split(",")]
    wanted = [name for name in traces if name in owner and _is_wanted(parts, owner, name)]
    if len(wanted) != 1:
        return script
    parts[-1] = _TRACES.sub(lambda _: f"{wanted[0]}()", parts[-1])
    kept = _reached(parts, owner)
    return script[: starts[0]] + "".join(part for place, part in enumerate(parts) if place in kept)


def _is_wanted(parts: list[str], owner: dict[str, int], name: str) -> bool:
    """Whether this trace is that of lines in space: it says so, or the one part that it hands on does."""
    text = parts[owner[name]]
    if f"name:{_WANTED}" in text:
        return True
    passed = re.search(r"\.exports=([\w$]+)\(\)", text)
    return passed is not None and passed[1] in owner and f"name:{_WANTED}" in parts[owner[passed[1]]]


def _reached(parts: list[str], owner: dict[str, int]) -> set[int]:
    """The parts that the last one calls, directly or not."""
    reached, open_parts = {len(parts) - 1}, [len(parts) - 1]
    while open_parts:
        called = {owner[name] for name in _CALLED.findall(parts[open_parts.pop()]) if name in owner}
        open_parts += called - reached
        reached |= called
    return reached
