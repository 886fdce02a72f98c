"""Bifurcations of periodic orbits from a command to a theorem: those of the documents, found, refined and proved."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from orbitproof.explore.__main__ import main as explore
from orbitproof.verify.__main__ import main as verify

pytestmark = pytest.mark.slow

ROOT = Path(__file__).resolve().parents[2]
ROESSLER = """\
name = "roessler"
state = "x y z"
parameters = "a b c"


def field(x, y, z, a, b, c):
    return -y - z, x + a * y, b + z * (x - c)
"""
LORENZ = """\
name = "lorenz"
state = "x y z"
parameters = "sigma rho beta"


def field(x, y, z, sigma, rho, beta):
    return sigma * (y - x), rho * x - y - x * z, x * y - beta * z
"""
CIRCUIT = """\
name = "circuit"
state = "x y z"
parameters = "nu beta gamma r a b e"


def field(x, y, z, nu, beta, gamma, r, a, b, e):
    c = b * (y - x) ** 3
    return (beta * y - (beta + nu) * x - a * x**3 + c) / r, beta * x - (beta + gamma) * y - z - c, y + e
"""
CHUA = """\
name = "chua"
state = "x y z"
parameters = "alpha b c"
field = {"x": "alpha*(y - x**3 - c*x)", "y": "x - y + z", "z": "-b*y"}
"""
LURE = """\
name = "lure"
state = "x y z"
parameters = "alpha beta"
field = {"x": "y", "y": "z", "z": "-alpha*z - beta*y - x + x**2"}
"""
OF_CIRCUIT = "nu=-0.595 beta=0.5 gamma=-0.6 r=0.6 a=0.32858 b=0.93358 e=0.001"


@pytest.mark.parametrize(
    ("name", "text", "words", "proved"),
    [
        (
            "roessler",
            ROESSLER,
            "--parameter a=1/5 b=1/5 c=5/2 --start x=3 y=0 z=0 --transient 300 --along c 5/2 21/5 --generations 2",
            {"doubling-1": "c = 2.8324450278", "doubling-2": "c = 3.8373581684", "doubling-3": "c = 4.1242147320"},
        ),
        (
            "lorenz",
            LORENZ,
            "--parameter sigma=10 rho=350 beta=8/3 --start x=1 y=2 z=300 --transient 50 --along rho 210 360 "
            "--generations 1",
            {"pitchfork-1": "rho = 312.973532984", "doubling-1": "rho = 229.406708561"},
        ),
        (
            "lorenz",
            LORENZ,
            "--parameter sigma=10 rho=160 beta=8/3 --start x=1 y=2 z=150 --transient 50 --returns 4 "
            "--along rho 147 170 --generations 1",
            {
                "pitchfork-1": "rho = 154.43635088",
                "fold-1": "rho = 166.061492103",
                "doubling-1": "rho = 148.430392",
            },
        ),
        (
            "chua",
            CHUA,
            "--parameter alpha=8.45 b=100/7 c=-1/7 --start x=0.5 y=0.1 z=-0.3 --transient 200 --returns 2 "
            "--along alpha 8.3 8.75 --generations 2",
            {
                "doubling-1": "alpha = 8.49373024657",
                "doubling-2": "alpha = 8.69743370484",
                "doubling-3": "alpha = 8.740645",
            },
        ),
        (
            "lure",
            LURE,
            "--parameter alpha=0.7 beta=1 --start x=0.1 y=0 z=0 --transient 300 --along alpha 0.56 0.75 "
            "--generations 3",
            {
                "doubling-1": "alpha = 0.6303020061",
                "doubling-2": "alpha = 0.5796298408",
                "doubling-3": "alpha = 0.569222719",
                "doubling-4": "alpha = 0.56701856770",
            },
        ),
        (
            "circuit",
            CIRCUIT,
            f"--parameter {OF_CIRCUIT} --start x=-0.0949 y=-0.001 z=-0.148 --period 8.85 --along nu -0.62 -0.58",
            {
                "fold-1": "nu = -0.584492842",
                "torus-1": "nu = -0.595750552",
                "doubling-1": "nu = -0.614681676",
                "hopf-1": "nu = -0.58928558100",
            },
        ),
        (
            "henon-heiles",
            (ROOT / "docs/examples/henon-heiles.py").read_text(),
            "--start x=0 y=0 vx=0 vy=1/2 --period 7 --along level 0.12 0.1663",
            {
                "doubling-1": "energy = 0.135285919",
                "doubling-2": "energy = 0.152535735",
                "pitchfork-1": "energy = 0.161551515",
                "pitchfork-2": "energy = 0.164451539",
                "doubling-3": "energy = 0.165835500",
            },
        ),
        (
            "michelson",
            (ROOT / "docs/examples/michelson.py").read_text(),
            "--parameter c=1/10 --start x=0 y=1/5 z=0 --period 6.3 --along c 0.05 1.4",
            {
                "doubling-1": "c = 0.319378643",
                "doubling-2": "c = 0.340493134",
                "doubling-3": "c = 0.579430540",
                "fold-1": "c = 1.266232337",
                "doubling-4": "c = 1.265823351",
            },
        ),
        (
            "cr3bp",
            "",
            "--parameter mu=0x18e267d713713fp-59 --start x=0.8234 y=0 z=0 vx=0 vy=0.1263 vz=0 --period 2.743 "
            "--along level 3.165 3.18",
            {"pitchfork-1": "3.174351944268834742257350354"},
        ),
    ],
)
def test_what_is_found_on_the_way_is_proved(
    name: str, text: str, words: str, proved: dict[str, str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    system, claims, certificates = tmp_path / f"{name}.py", tmp_path / "claims.json", tmp_path / "certificates.json"
    if text:
        system.write_text(text)
    assert (
        explore(["periodic", "--system", str(system) if text else name, *words.split(), "-o", str(claims), "--quiet"])
        == 0
    )
    capsys.readouterr()
    assert verify([str(claims), "-o", str(certificates)]) == 0
    blocks = re.findall(rf"^({name}-[\w-]+): (.*\n(?:  .*\n)*)", capsys.readouterr().out, re.MULTILINE)
    found = {id_: " ".join(text.split()) for id_, text in blocks}
    assert set(found) == {f"{name}-{each}" for each in proved}
    for each, value in proved.items():
        kind = each.rsplit("-", 1)[0]
        assert any(value in row for id_, row in found.items() if id_.startswith(f"{name}-{kind}-"))
