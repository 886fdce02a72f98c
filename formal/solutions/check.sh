#!/bin/sh
# Has the kernel of Coq check the theorems of this folder, and files of initial value problems: sh check.sh [FILE.v ...]
# It needs coq, libcoq-bignums and libcoq-coquelicot.
# Exit codes: 0 all are checked, 1 one is not, 2 Coq is missing.

unset CDPATH
for tool in cp grep mkdir mktemp rm sed sort tail tr; do
  command -v $tool >/dev/null 2>&1 || { echo "$tool is missing" >&2; exit 2; }
done
here=$(cd "$(dirname "$0")" && pwd) || exit 2
if ! command -v coqc >/dev/null 2>&1; then
  echo "coqc is missing; on Debian and Ubuntu: apt install coq libcoq-bignums libcoq-coquelicot" >&2; exit 2
fi
theory="Polynomials Elements Formats Programs Steps Crossings Sound"; more=""
if [ $# -eq 0 ] || grep -q FalknerSkan "$@"; then
  theory="$theory Rows Intervals Jets SoundIntervals"
  more="Dependence Boxes Curves Statements Variations Formulas Returns HalfOrbits FalknerSkan"
fi
# In a folder of its own: what others have compiled before, or compile at the same time, is not read.
built=$(mktemp -d) || exit 2
trap 'rm -rf "$built"' EXIT
trap 'exit 1' HUP INT TERM
mkdir "$built/theory" "$built/solutions" && cp "$here"/../theory/*.v "$built/theory" && cp "$here"/*.v "$built/solutions" || exit 2
for name in $theory; do
  echo "theory/$name.v" >&2
  (cd "$built/theory" && coqc -q -w none -R . Orbitproof "$name.v") || { echo "theory/$name.v: NOT CHECKED"; exit 1; }
done
for name in Comparison Existence Flow Exponential Norms Values Fields Bounds CheckedSteps CheckedFlow InitialValues $more; do
  echo "solutions/$name.v" >&2
  (cd "$built/solutions" && coqc -q -w none -R ../theory Orbitproof -R . Solutions "$name.v") || { echo "solutions/$name.v: NOT CHECKED"; exit 1; }
done
# The axioms of the real numbers, primitive integers and what specifies these; any other is one too many.
ops='add\|addc\|addcarryc\|addmuldiv\|compare\|div\|diveucl\|diveucl_21\|eqb\|head0\|land\|leb\|lor\|lsl\|lsr\|ltb\|lxor\|mod\|mul\|mulc\|sub'
ops="$ops\\|subc\\|subcarryc\\|tail0"
known="Axioms\\|PrimInt63\.int\\|PrimInt63\.\($ops\)\\|Uint63\.\($ops\)\(_def\)\{0,1\}_spec\\|Uint63\.\(of_to_Z\|eqb_correct\|eqb_refl\)"
known="$known\\|ClassicalDedekindReals\.sig_\(not_dec\|forall_dec\)\\|Classical_Prop\.classic"
known="$known\\|FunctionalExtensionality\.functional_extensionality_dep"
for file in "$@"; do
  # A module or file may bear the name of one of Coq's, and axioms in it would look like those.
  case $(basename "$file") in PrimInt63.v | Uint63.v | Classical*.v | FunctionalExt*.v) echo "$file: NOT CHECKED: give it another name"; exit 1 ;; esac
  if grep -Eq '(^|[^A-Za-z_])(Module|Axioms?|Variables?|Hypothes[ei]s|Context|Parameters?|Conjectures?|Declare|Load|Unset|Register|Primitive)([^A-Za-z_]|$)' "$file"; then
    echo "$file: NOT CHECKED: it declares what it should prove, or modules"; exit 1
  fi
  start=$(date +%s)
  # Alone in a new folder, and what it proves, and on what, is printed by a file of our own.
  work=$(mktemp -d) || exit 2
  cp "$file" "$work/Problem.v" || { echo "$file: NOT CHECKED: there is no such file"; exit 1; }
  said="Check Problem.solution."; claim="what $file.log states"
  if grep -q FalknerSkan "$file"; then
    which=$(sed -n 's/^Theorem solution : \(period_[a-z]*\)\.$/\1/p' "$file" | tail -n 1)
    claim="$which of Statements.v"
    said="From Solutions Require Statements. Check (Problem.solution : Statements.$which)."
    for word in $which bifurcation two_curves comes_back half_orbit J Y rises falls; do said="$said Print Statements.$word."; done
  fi
  cat >"$work/Statement.v" <<END
From Coq Require Import Reals.
From Coquelicot Require Import Coquelicot.
Require Problem.
Set Printing Width 120.
Set Printing Depth 1000.
Open Scope R_scope.
$said
Print Assumptions Problem.solution.
(* The last line shows that all before it was written. *)
Eval compute in Coq.Init.Datatypes.tt.
END
  for name in Problem Statement; do
    (cd "$work" && coqc -q -w none -R "$built/theory" Orbitproof -R "$built/solutions" Solutions -Q . "" "$name.v") >"$file.log" 2>&1 \
      || { tail -n 5 "$file.log"; echo "$file: NOT CHECKED"; rm -rf "$work"; exit 1; }
  done
  rm -rf "$work"
  others=$(sed -n '/^Axioms:/,$p' "$file.log" | grep -v '^ ' | sed 's/^Axioms:$/Axioms/; s/ :.*$//' | grep -vx "$known" | sort -u)
  { [ -z "$others" ] && grep -q '^Axioms:' "$file.log" && [ "$(tail -n 2 "$file.log" | tr -d ' \n')" = "=tt:unit" ]; } || { echo "$file: NOT CHECKED: it rests on $others"; exit 1; }
  echo "$file: checked in $(($(date +%s) - start)) s: $claim; assumptions: the real numbers, classical logic, extensionality and primitive integers, nothing else"
done
