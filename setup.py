"""The folders of the checkout as one package: explore/ is `orbitproof.explore`, and so on.

The list of packages is the tree itself. An editable installation gets links inside src/orbitproof, so that one
plain path is all that Python, type checkers and editors need, and a new file is found without installing again.
"""

from pathlib import Path

from setuptools import setup
from setuptools.command.editable_wheel import editable_wheel

ROOT = Path(__file__).resolve().parent
HOUSE = ROOT / "src" / "orbitproof"
ROOMS = ("shared", "explore", "verify", "figures", "formal")


def packages() -> list[str]:
    """Names of the package, its rooms and every sub-package of these."""
    inits = (path for room in ROOMS for path in (ROOT / room).rglob("__init__.py"))
    return ["orbitproof", *sorted(".".join(("orbitproof", *path.relative_to(ROOT).parent.parts)) for path in inits)]


class EditableWheel(editable_wheel):
    """Links the rooms into src/orbitproof; where links are not allowed, setuptools maps the names by itself."""

    def finalize_options(self) -> None:
        try:
            for room in ROOMS:
                link = HOUSE / room
                if not link.exists():
                    link.unlink(missing_ok=True)
                    link.symlink_to(Path("..", "..", room), target_is_directory=True)
            self.distribution.package_dir = {"": "src"}
        except OSError:
            pass
        super().finalize_options()


setup(
    packages=packages(),
    package_dir={"orbitproof": "src/orbitproof", **{f"orbitproof.{room}": room for room in ROOMS}},
    cmdclass={"editable_wheel": EditableWheel},
)
