"""Command line of the verifier: hands over to that for rows, branches, catalogues, webs, indices, or second proofs."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from orbitproof.shared.interrupts import run_command


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code."""
    words = sys.argv[1:] if arguments is None else list(arguments)
    # Each only when it is asked for: they take a moment to load.
    if words[:1] == ["atlas"]:
        from orbitproof.verify.run.branch_command import main as verify_branch

        return verify_branch(words[1:])
    if words[:1] == ["catalogue"]:
        from orbitproof.verify.run.catalogue_command import main as verify_catalogue

        return verify_catalogue(words[1:])
    if words[:1] == ["web"]:
        from orbitproof.verify.run.web_command import main as verify_web

        return verify_web(words[1:])
    if words[:1] == ["index"]:
        from orbitproof.verify.run.index_command import main as verify_index

        return verify_index(words[1:])
    if "--second-proof" in words:
        from orbitproof.verify.run.second_proofs import main as prove_again

        return prove_again([word for word in words if word != "--second-proof"])
    from orbitproof.verify.run.row_command import main as verify_rows

    return verify_rows(words)


if __name__ == "__main__":
    sys.exit(run_command(main))
