#!/bin/sh
# Has the kernel of Coq check the rows of this folder: sh check.sh [-t | -k] [-j N] [ROW ...]
# -t compiles the theory only, -k takes it as a call with -t has left it.
# Everything is compiled anew; of each row the last line says whether it was checked, statement.txt what was, and on which assumptions.
# Exit codes: 0 all rows are checked, 1 one is not, 2 Coq is missing or a row is not there.

jobs=1
part=all
case $1 in -t | -k) part=$1; shift ;; esac
if [ "$1" = "-j" ]; then jobs=$2; shift 2; fi
unset CDPATH
cd "$(dirname "$0")" || exit 2
HERE=$(pwd -P); export HERE
for tool in find grep head ls sed sh tail tr wc xargs; do
  command -v $tool >/dev/null 2>&1 || { echo "$tool is missing" >&2; exit 2; }
done
if ! command -v coqc >/dev/null 2>&1; then
  echo "coqc is missing; on Debian and Ubuntu: apt install coq libcoq-bignums" >&2; exit 2
fi
theory="Polynomials Elements Formats Programs Steps Crossings Rows Identities Intervals Jets Conclusions Theorems Sound SoundIntervals SoundElements"
[ $# -gt 0 ] || set -- */Conclusion.v
# What is there besides some names: it may hide another theory, or bear the name of a part of Coq.
strange() { (find "$1" -mindepth 1 ! -type f; find "$1" -mindepth 1 | grep -Ev "^$1/($2)\$") | head -n 1; }
compiled='v|vo|vok|vos|vio|glob|aux'
other=$(strange theory "\.?($(echo "$theory" | tr ' ' '|'))\.($compiled)|\.[a-z]+\.cache")
[ ! -h theory ] || other=theory
if [ -n "$other" ]; then
  echo "NOT CHECKED: $other is no file of the theory"; exit 1
fi
if [ $part != -k ]; then
  echo "theory: compiling" >&2
  rm -f theory/*.vo theory/*.vio
  for name in $theory; do
    (cd theory && coqc -q -R . Orbitproof "$name.v") >/dev/null ||
      { echo "theory/$name.v is not accepted (is libcoq-bignums there? apt install coq libcoq-bignums)" >&2; exit 1; }
  done
fi
[ $part != -t ] || exit 0

# One file of the row in this folder; a line of progress; what Coq says stands in a log.
one='n=$0; coqc -q -R "$HERE/theory" Orbitproof -Q . "" "$n.v" >"$n.log" 2>&1 || { echo "$n" >>failed; exit 1; }
     echo "$n" >>done; echo "$ROW: $(wc -l <done | tr -d " ") of $ALL files" >&2'

primitives='int\|add\|addc\|addcarryc\|addmuldiv\|asr\|compare\|compares\|div\|diveucl\|diveucl_21\|divs\|eqb\|head0\|land\|leb\|lesb'
primitives="$primitives\\|lor\\|lsl\\|lsr\\|ltb\\|ltsb\\|lxor\\|mod\\|mods\\|mul\\|mulc\\|sub\\|subc\\|subcarryc\\|tail0"
numbered='(Step|Crossing)[1-9][0-9]*'
failed=0
for row in "$@"; do
  row=${row%/Conclusion.v}; row=${row%/}
  cd "$HERE/$row" 2>/dev/null || { echo "$row: there is no such row" >&2; exit 2; }
  start=$(date +%s)
  other=$(strange . "\.?(Row|Conclusion|Statement|$numbered)\.($compiled|log)|\.[a-z]+\.cache|done|failed|statement\.txt")
  [ ! -h "$HERE/$row" ] || other="the link $row"
  # Nothing is removed of a folder that is none of ours.
  if [ -z "$other" ]; then
    rm -f ./*.vo ./*.vok ./*.vos ./*.vio ./*.glob ./.*.aux ./.*.cache ./*.log done failed Statement.v statement.txt
    other=$(strange . "(Row|Conclusion|$numbered)\.v")
  fi
  if [ -n "$other" ]; then
    echo "$row: NOT CHECKED: $other is no file of a row"; failed=1; continue
  fi
  ROW=$row; ALL=$(ls ./*.v | wc -l | tr -d " "); export ROW ALL
  parts=$(ls ./*.v | sed 's|^\./||; s|\.v$||' | grep -v '^Row$\|^Conclusion$')
  # What is said in the end does not depend on notations or definitions of the files themselves.
  cat >Statement.v <<'END'
Require Orbitproof.Theorems.
Require Row.
Require Conclusion.
Set Printing Width 120.
Set Printing Depth 1000.
Definition statement : Orbitproof.Theorems.checked Conclusion.the_bifurcation := Conclusion.all_checked.
From Coq Require Import List.
From Bignums Require Import BigZ.
From Orbitproof Require Import Rows Conclusions Theorems.
Import ListNotations.
Open Scope bigZ_scope.
(* Field, dimension, section; box; level; R, S, frame of q, crossings of a half orbit; first integral; claim; its own box. *)
Eval vm_compute in
  let t := Conclusion.the_bifurcation in let r := orbits t in
  ((field r, dimension r, section r), (radii (domain r), starts (domain r)),
   match of_level r with Some l => Some (integral l, square l, level_sign l, level_of l) | None => None end,
   (reversor t, symmetry t, kernel_frame t, crossings_of_half t),
   option_map fst (parameter_is t), claimed t, option_map own_domain (own_box t)).
Check statement.
Print Assumptions statement.
(* The last line shows that all before it was written. *)
Eval compute in Coq.Init.Datatypes.tt.
END
  if sh -c "$one" Row && echo "$parts" | xargs -P "$jobs" -n 1 sh -c "$one" && sh -c "$one" Conclusion \
     && coqc -q -R "$HERE/theory" Orbitproof -Q . "" Statement.v >statement.txt 2>&1; then
    # Primitive integers are part of the kernel; any other assumption is one too many. grep ends with 1 if it finds none.
    others=$(sed -n '/^Axioms:/,$p' statement.txt | grep -v "^Axioms:\|^ \|^PrimInt63\.\($primitives\)\( \|$\)")
    if [ $? -eq 1 ] && grep -q '^Axioms:' statement.txt && [ "$(tail -n 2 statement.txt | tr -d ' \n')" = "=tt:unit" ]; then
      echo "$row: checked in $(($(date +%s) - start)) s; assumptions: primitive integers, nothing else"
    else
      echo "$row: NOT CHECKED: it rests on more than primitive integers:"; echo "${others:-statement.txt does not come to its end}"; failed=1
    fi
  else
    echo "$row: NOT CHECKED: $(cat failed 2>/dev/null | tr '\n' ' ')$(tail -n 3 "$(head -n 1 failed 2>/dev/null)".log 2>/dev/null)"; failed=1
  fi
done
exit $failed
