#!/bin/sh
# Has the kernel of Coq check the theorems of this folder, and files of initial value problems: sh check.sh [FILE.v ...]
# It needs coq, libcoq-bignums and libcoq-coquelicot. Exit codes: 0 all are checked, 1 one is not, 2 Coq is missing.

here=$(cd "$(dirname "$0")" && pwd) || exit 2
if ! command -v coqc >/dev/null 2>&1; then
  echo "coqc is missing; on Debian and Ubuntu: apt install coq libcoq-bignums libcoq-coquelicot" >&2; exit 2
fi
for name in Polynomials Elements Formats Programs Steps Crossings Sound; do
  echo "theory/$name.v" >&2
  (cd "$here/../theory" && coqc -q -w none -R . Orbitproof "$name.v") || { echo "theory/$name.v: NOT CHECKED"; exit 1; }
done
for name in Comparison Existence Flow Exponential Norms Values Fields Bounds CheckedSteps CheckedFlow InitialValues; do
  echo "solutions/$name.v" >&2
  (cd "$here" && coqc -q -w none -R ../theory Orbitproof -R . Solutions "$name.v") || { echo "solutions/$name.v: NOT CHECKED"; exit 1; }
done
for file in "$@"; do
  start=$(date +%s)
  coqc -q -w none -R "$here/../theory" Orbitproof -R "$here" Solutions "$file" >"$file.log" 2>&1 || { tail -n 5 "$file.log"; echo "$file: NOT CHECKED"; exit 1; }
  # The axioms of the real numbers, and primitive integers; any other is one too many.
  others=$(sed -n 's/^\([A-Za-z_0-9.]*\)\( :.*\)\{0,1\}$/\1/p' "$file.log" | grep -v '^Axioms\|^PrimInt63\.\|^Uint63\.\|^ClassicalDedekindReals\.sig_\|^FunctionalExtensionality\.functional_extensionality_dep$\|^Classical_Prop\.classic$' | sort -u)
  [ -z "$others" ] && grep -q '^Axioms:' "$file.log" || { echo "$file: NOT CHECKED: it rests on $others"; exit 1; }
  echo "$file: checked in $(($(date +%s) - start)) s; assumptions: the real numbers and primitive integers, nothing else"
done
