"""The systems in docs/examples: numbers that others have published, a branch of each, all without the files again."""

from __future__ import annotations

import re
import shlex
import shutil
from collections.abc import Callable
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import mpmath
import pytest
from flint import arb, ctx, fmpq
from matplotlib.text import Text
from mpmath import mpf

from orbitproof.explore.__main__ import main as explore_main
from orbitproof.figures.model import read_families
from orbitproof.figures.pictures import draw_family
from orbitproof.figures.style import close, use_style
from orbitproof.shared.formats import load_system, read_candidates
from orbitproof.verify import certify
from orbitproof.verify.__main__ import main as verify_main
from orbitproof.verify.certificate import Certificate
from orbitproof.verify.claim import quadratic_coefficient
from orbitproof.verify.curve import lower_end, upper_end
from orbitproof.verify.evidence import ball_from_json

EXAMPLES = Path(__file__).resolve().parents[2] / "docs" / "examples"
PAGE = (EXAMPLES / "README.md").read_text("utf-8")


def rounded(text: str) -> tuple[Fraction, Fraction]:
    """The numbers that are rounded to a decimal as it is printed."""
    half = Fraction(1, 2 * 10 ** len(text.partition(".")[2]))
    return Fraction(text) - half, Fraction(text) + half


def refine(system: str, words: list[str], output: Path) -> int:
    digits = ["--digits", "35", "--quiet"]
    return explore_main(["refine", "--system", str(EXAMPLES / system), *words, *digits, "-o", str(output)])


@pytest.fixture(scope="module")
def refined_proof(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str, tuple[str, ...]], Certificate]:
    """The proof of a point of an example that the command refines; each once."""

    @cache
    def proof(system: str, words: tuple[str, ...]) -> Certificate:
        output = tmp_path_factory.mktemp("point") / "point.json"
        assert refine(system, list(words), output) == 0
        (found,) = certify(read_candidates(output), quiet=True)
        assert found.proved, found.reason
        return found

    return proof


LOSS = ("-k", "1", "--kind", "reversor_breaking", "--point", "y=0.31187", "vx=-1.38309")
"""Where g loses the rotation by pi, which shifts its orbits by half a period: the other reversor is lost."""
DOUBLED = ("-k", "2", "--point", "p=0.08037041", "v=0.94806332")
"""The same orbit of the quotient by that rotation."""


@pytest.mark.parametrize(
    ("system", "words", "factor", "published"),
    [
        (
            "michelson.py",
            ("-k", "1", "--kind", "fold", "--point", "c=1.26623", "y=1.35911"),
            1,
            (Fraction("1.2662323370670545"), Fraction("1.2662323370713253")),
        ),
        ("henon-heiles.py", ("-k", "2", "--point", "y=-0.45556542", "vx=0"), 6, rounded("0.811715516")),
        ("henon-heiles.py", ("-k", "1", "--point", "y=-0.49311677", "vx=0"), 6, rounded("0.969309")),
        ("henon-heiles.py:T", ("-k", "1", "--point", "x=0", "y=-0.49703478"), 6, rounded("0.986709235")),
        ("hill-g.py", DOUBLED, 1, rounded("4.49999")),
        ("hill-planar.py:turned", LOSS, 1, rounded("4.49999")),
    ],
)
def test_a_published_number_is_confirmed(
    system: str, words: tuple[str, ...], factor: int, published: tuple[Fraction, Fraction], refined_proof: Any
) -> None:
    proof = refined_proof(system, words)
    assert proof.parameter is not None
    ends = factor * lower_end(proof.parameter), factor * upper_end(proof.parameter)
    assert published[0] <= ends[0] <= ends[1] <= published[1]


def test_a_symmetry_that_shifts_orbits_is_lost_where_their_quotient_doubles_its_period(refined_proof: Any) -> None:
    found = []
    for system, words in (("hill-planar.py:turned", LOSS), ("hill-g.py", DOUBLED)):
        proof = refined_proof(system, words)
        assert proof.parameter is not None
        assert proof.side == "below"
        with ctx.workprec(200):
            found.append((lower_end(proof.parameter), upper_end(proof.parameter)))
    (low, high), (other_low, other_high) = found
    assert max(low, other_low) <= min(high, other_high)
    assert max(high, other_high) - min(low, other_low) < Fraction(1, 10**30)


def orbit_proof(system: str, words: list[str], folder: Path) -> dict[str, Any]:
    """The results of the certificate of an orbit."""
    output = folder / "orbit.json"
    assert explore_main(["orbit", "--system", str(EXAMPLES / system), *words, "--quiet", "-o", str(output)]) == 0
    (proof,) = certify(read_candidates(output), quiet=True)
    assert proof.proved, proof.reason
    results: dict[str, Any] = proof.to_json()["results"]
    return results


def test_the_moon_without_eccentricity_moves_as_hill_and_newton_say(tmp_path: Path) -> None:
    month = "0.08084893380831164*3.14159265358979323846264338328"
    moon = orbit_proof("hill-g.py", ["--start", "p=0.031", "v=0.783", "--period", month], tmp_path)
    with ctx.workdps(60):
        low, high = (arb(fmpq(end.numerator, end.denominator)).cos_pi() for end in rounded("1.071583277416012"))
        assert low < ball_from_json(moon["stability_parameters"][0]["real"]) < high
        syzygies, quadratures = (abs(ball_from_json(moon[at]["p"])).sqrt() for at in ("point", "other_point"))
        assert abs(syzygies / (quadratures - syzygies) - 69) < 0.5


def elliptic_wave(speed: int) -> tuple[mpf, dict[str, mpf], mpf]:
    """Half period, values at the ends and H of u = a + b y + 840 y^2, y'^2 = 4 y^3 - g2 y - g3, for P = `speed`."""
    b = mpf(140 * speed) / 13

    def constant(g2: mpf) -> mpf:
        return mpf(1) / 2 - 84 * g2 - mpf(31 * speed**2) / 1014

    def remaining(g2: mpf, g3: mpf) -> tuple[mpf, mpf]:
        a = constant(g2)
        first = -100800 * g3 - 18 * g2 * b - 2520 * speed * g2 + b - 2 * a * b
        return first, 1260 * g2**2 - 12 * g3 * b - speed * (b * g2 / 2 + 1680 * g3) + a - a**2

    g2, g3 = mpmath.findroot(remaining, (mpf("0.0069"), mpf("-0.000055") * speed))
    length = mpmath.sqrt(g2 / 3)
    angle = mpmath.acos(3 * g3 / (g2 * length))
    low, middle, high = sorted(length * mpmath.cos((angle + 2 * mpmath.pi * i) / 3) for i in range(3))
    half = mpmath.ellipk((middle - low) / (high - low)) / mpmath.sqrt(high - low)

    def values(y: mpf) -> tuple[mpf, mpf]:
        return constant(g2) + b * y + 840 * y**2, b * (6 * y**2 - g2 / 2) + 840 * (20 * y**3 - 3 * g2 * y - 2 * g3)

    (u, u2), (v, v2) = values(low), values(middle)
    return half, {"u": u, "u2": u2, "other u": v, "other u2": v2}, u**2 / 2 - u**3 / 3 - u2**2 / 2


def test_a_periodic_wave_in_elliptic_functions_is_the_certified_one(tmp_path: Path) -> None:
    with mpmath.workdps(60):
        half, ends, level = elliptic_wave(-1)
        start = ["--start", f"u={mpmath.nstr(ends['u'], 7)}", f"u2={mpmath.nstr(ends['u2'], 7)}"]
        words = ["--parameter", "P=-1", *start, "--at", f"u={mpmath.nstr(ends['u'], 48)}"]
        wave = orbit_proof("beam.py", words, tmp_path)
        found = {**wave["point"], **{f"other {name}": ball for name, ball in wave["other_point"].items()}}
        with ctx.workdps(60):
            pairs = [(found[name], value) for name, value in ends.items()]
            for ball, value in [*pairs, (wave["half_period"], half), (wave["level"], level)]:
                assert abs(ball_from_json(ball) - arb(mpmath.nstr(value, 55))) < 1e-37


BRANCHES = {
    "michelson": (["c=0.12", "y=0.235"], ["c", "0.11", "0.14"]),
    "henon-heiles": (["y=-0.25", "vx=0"], ["y", "-0.28", "-0.22"]),
    "hill-g": (["p=0.08", "v=0.947"], ["p", "0.078", "0.082"]),
    "beam-level": (["P=1.9", "u=-0.2446"], ["P", "1.88", "1.92"]),
    "relativistic-levels": (["e=1.5", "y=0.6"], ["e", "1.47", "1.53"]),
    "swift-hohenberg": (["xi=2", "x=0.467", "--half-period", "6.5058"], ["x", "0.45", "0.65"]),
    "beam": (["u=-0.224", "u2=1.60069"], ["u", "-0.25", "-0.2"]),
}


QUICK_BRANCHES = ("michelson", "henon-heiles", "beam-level")
"""A parameter, a first integral, and levels that are held fixed. The others go the same ways and take longer."""


@pytest.mark.parametrize(
    "system",
    [pytest.param(name, marks=() if name in QUICK_BRANCHES else pytest.mark.slow) for name in BRANCHES],
)
def test_a_branch_is_proved_and_checked_again_without_the_file(system: str, tmp_path: Path) -> None:
    file = tmp_path / f"{system}.py"
    shutil.copy(EXAMPLES / file.name, file)
    start, (name, low, high) = BRANCHES[system]
    family, atlas, certificate = (tmp_path / f"{part}.json" for part in ("family", "atlas", "certificate"))
    fixed = ["--parameter", "P=7/3"] if system == "beam" else []
    limits = ["--parameter-min", name, low, "--parameter-max", name, high]
    words = ["family", "--system", str(file), *fixed, "--start", *start, *limits, "--jobs", "1", "--quiet"]
    assert explore_main([*words, "-o", str(family)]) == 0
    file.unlink()
    words = ["atlas", "--from-family", str(family), "--covers", name, low, high, "--increasing", name, "--quiet"]
    assert explore_main([*words, "-o", str(atlas)]) == 0
    assert verify_main(["atlas", str(atlas), "-o", str(certificate), "--jobs", "1", "--quiet"]) == 0
    # In a worker, which never saw the file.
    assert verify_main(["atlas", "--recheck", str(certificate), "--quiet"]) == 0


@pytest.mark.parametrize(
    ("system", "coefficient"),
    [("beam", "-1/2"), ("beam-level", "-1/2"), ("hill", "-1"), ("hill-planar", "-1"), ("swift-hohenberg", "-1/2")],
)
def test_the_level_coordinate_of_an_example_is_shown_to_be_one(system: str, coefficient: str) -> None:
    assert quadratic_coefficient(load_system(EXAMPLES / f"{system}.py")) == Fraction(coefficient)


def test_a_picture_of_a_plane_shows_no_primaries(tmp_path: Path) -> None:
    words = ["family", "--system", str(EXAMPLES / "hill-g.py"), "--start", *BRANCHES["hill-g"][0], "--max-orbits", "4"]
    assert explore_main([*words, "--jobs", "1", "--quiet", "-o", str(tmp_path / "family.json")]) == 0
    (family,) = read_families(tmp_path / "family.json")
    with use_style():
        figure = draw_family(family.refined(), [])
        words = [text.get_text() for text in figure.findobj(Text)]
        close(figure)
    assert "(c)  orbits" in words
    assert not any("primaries" in word for word in words)
    assert all(axes.name != "3d" for axes in figure.axes)


def test_what_the_page_names_is_there_and_what_is_there_is_named() -> None:
    files = {path.name for path in EXAMPLES.glob("*.py")}
    commands = [shlex.split(line) for line in re.findall(r"^    (orbitproof .*)$", PAGE, re.MULTILINE)]
    used = {words[words.index("--system") + 1].partition(":")[0] for words in commands if "--system" in words}
    assert used == files == set(re.findall(r"^\| `([\w-]+\.py)` \|", PAGE, re.MULTILINE))
    for room in (["verify", "atlas"], ["figures", "family"], ["explore", "atlas"]):
        assert sum(words[1:3] == room for words in commands) >= 4
