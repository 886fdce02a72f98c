(* The crossings of the section along an orbit, counted, and the way onto the section (sections 5.1 and 5.2 of the chapter
   verify/poincare). *)

From Coq Require Import List ZArith.
From Bignums Require Import BigZ.
From Orbitproof Require Import Polynomials Elements Formats Programs Steps.
Import ListNotations.
Local Open Scope bool_scope.
Local Open Scope bigZ_scope.
Local Open Scope list_scope.

(* A part of a step, from i / 2^depth to (i + 1) / 2^depth, on which a function has a sign, 1 or -1: the section coordinate (kind
   (a) of section 5.2) or its velocity (kind (b)). *)
Record part := Part { is_side : bool; sign_there : bigZ; place : bigZ; depth : bigZ }.

(* Whether an element of which only the centre is known has the sign on the part. *)
Definition has_sign (c : format) (x : element) (sign i d : bigZ) : bool :=
  let p := hd [] (known x) in
  let q := recentred (2 * i + 1) (d + 1) p in
  let s := bits c + recentred_scale (d + 1) p in
  bound c (l1 (tl q)) s + total (unknown x) <? down (sign * at_zero q) (s - eps c).

(* How often the section was crossed; times are integers over 2^clock_bits. *)
Record counter := Counter {
  crossings : nat;
  side : bigZ            (* the sign of the section coordinate after the last crossing; 0 before it is known *);
  velocity_sign : bigZ   (* the sign of the velocity since the last part of kind (a), 0 if there is no part since *);
  clear : option bigZ    (* the end of the last part of kind (a) *);
  previous : option bigZ (* the end of the last one before the last change of the sign *);
  fresh : bool           (* no part yet *)
}.
Definition no_crossing : counter := Counter 0 0 0 None None true.

Definition moves (c : counter) (sign : bigZ) : option counter :=
  let s := if fresh c then sign else side c in
  if (velocity_sign c =? 0) || (velocity_sign c =? sign)
  then Some (Counter (crossings c) s sign (clear c) (previous c) false)
  else None.
Definition keeps_side (c : counter) (sign until : bigZ) : option counter :=
  if fresh c then None
  else if side c =? sign then Some (Counter (crossings c) sign 0 (Some until) (previous c) false)
  else if velocity_sign c =? sign then Some (Counter (S (crossings c)) sign 0 (Some until) (clear c) false)
  else None.

(* Parts are counted in 2^-14 of the step. *)
Definition finest : bigZ := 14.

Fixpoint cover (c : format) (y dy : element) (clock_bits clock num den : bigZ) (parts : list part) (from : bigZ)
    (n : counter) : option counter :=
  match parts with
  | [] => if from =? BigZ.shiftl 1 finest then Some n else None
  | p :: ps =>
      let d := depth p in let i := place p in let s := sign_there p in
      let until := clock + BigZ.shiftl (num * (i + 1)) (clock_bits - den - d) in
      if (0 <=? d) && (d <=? finest) && (0 <=? clock_bits - den - d) && ((s =? 1) || (s =? -1))
         && (BigZ.shiftl i (finest - d) =? from)
         && has_sign c (if is_side p then y else dy) s i d
      then match (if is_side p then keeps_side n s until else moves n s) with
           | Some n' => cover c y dy clock_bits clock num den ps (BigZ.shiftl (i + 1) (finest - d)) n'
           | None => None
           end
      else None
  end.

(* A function is positive on all of a step. *)
Fixpoint positive_on (c : format) (x : element) (parts : list (bigZ * bigZ)) (from : bigZ) : bool :=
  match parts with
  | [] => from =? BigZ.shiftl 1 finest
  | (i, d) :: ps =>
      (0 <=? d) && (d <=? finest) && (BigZ.shiftl i (finest - d) =? from) && has_sign c x 1 i d
      && positive_on c x ps (BigZ.shiftl (i + 1) (finest - d))
  end.

(* What is known about crossing number n: after which time it is the only zero; whether it has to lie behind. *)
Definition arrival (c : counter) (n : nat) : option (bigZ * bool) :=
  if (S (crossings c) =? n)%nat && ((velocity_sign c =? 0) || (velocity_sign c =? - side c)) then
    match clear c with Some t => Some (t, false) | None => None end
  else if (crossings c =? n)%nat && ((velocity_sign c =? 0) || (velocity_sign c =? side c)) then
    match previous c with Some t => Some (t, velocity_sign c =? 0) | None => None end
  else None.

(* The field with the section coordinate as time: state, elapsed time; parameters, distance. *)
Definition moved (size k : nat) (i : nat) : nat := if (i <? size)%nat then i else if (i <? k)%nat then S i else S (S i).
Definition moved_node (size k : nat) (n : node) : node :=
  let m := moved size k in
  match n with
  | Const a b => Const a b
  | Add i j => Add (m i) (m j)
  | Sub i j => Sub (m i) (m j)
  | Mul i j => Mul (m i) (m j)
  | Scale i a b => Scale (m i) a b
  | Power i p q => Power (m i) p q
  end.
Definition section_field (field : program) (size section : nat) : program :=
  let k := inputs field in
  let outs := map (moved size k) (outputs field) in
  let before := map (moved_node size k) (nodes field) in
  let distance := S k in
  let n := (S (S k) + length before)%nat in
  (* n: 1 / velocity; n + 1: distance / velocity; n + 2: its negative; n + 3: the negative of the distance *)
  let elapsed := (n + 2)%nat in
  let more := [Power (nth section outs O) 1 1; Mul distance n; Scale (n + 1) (-1) 1; Scale distance (-1) 1] in
  let products := map (fun o => Mul elapsed o) outs in
  let slope i := if (i =? section)%nat then (n + 3)%nat else (n + 4 + i)%nat in
  Program (S (S k)) (before ++ more ++ products) (map slope (seq 0 size) ++ [elapsed]).

Definition zero_element (f : format) : element := econst f 0 1.

(* One step after another; the lengths add up to 1 = 2^ones. *)
Fixpoint onto_steps (f : format) (p : program) (ss : list step) (at_ parameters : state) (sum ones : bigZ) : option state :=
  match ss with
  | [] => if sum =? BigZ.shiftl 1 ones then Some at_ else None
  | s :: ss' =>
      if denominator s <=? ones then
        match check_step f p at_ parameters s with
        | Some found =>
            onto_steps f p ss' (at_end f s (errors found)) parameters
              (sum + BigZ.shiftl (numerator s) (ones - denominator s)) ones
        | None => None
        end
      else None
  end.

(* The state on the section, and the time from the state to there. *)
Definition onto_section (f : format) (field : program) (section : nat) (ss : list step) (at_ parameters : state) (ones : bigZ)
    : option (state * element) :=
  let p := section_field field (length at_) section in
  if negb (0 <=? ones) then None else
  let distance := nth section at_ missing in
  match onto_steps f p ss (at_ ++ [zero_element f]) (parameters ++ [distance]) 0 ones with
  | Some found => Some (removelast found, last found missing)
  | None => None
  end.

(* An interval of scale eps that contains the values at all real points of the box of an element without theta. *)
Definition range (f : format) (x : element) : bigZ * bigZ :=
  let c := at_one (hd [] (known x)) in
  let away := total (map (fun gp => bound f (l1 (snd gp)) (scale f (fst gp))) (tl (combine (grades f) (known x)))) in
  let r := away + total (unknown x) in
  (down c (bits f - eps f) - r, up c (bits f - eps f) + r).
