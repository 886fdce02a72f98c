(* The orbits of a box, from its points to the crossings of the section, step by step (sections 5 and 6). *)

From Coq Require Import List ZArith.
From Bignums Require Import BigZ.
From Orbitproof Require Import Polynomials Elements Formats Programs Steps Crossings.
Import ListNotations.
Local Open Scope bool_scope.
Local Open Scope bigZ_scope.
Local Open Scope list_scope.

(* A rational number. *)
Record rational := Q { over : bigZ; under : bigZ }.

(* Where orbits begin: an input of the field is centre + sum of row_j p_j, |p_j| <= radius_j; or the coordinate that follows from
   the level of the first integral, sign * ((level - A) / b)^(1/2), A the first integral with 0 in its place. *)
Inductive initial :=
| Affine (centre : rational) (row : list rational)
| OfLevel.

Record box := Box {
  weights : list nat;
  radii : list rational;
  starts : list initial    (* one for each input of the field: state, then parameters *)
}.

Record level := Level {
  integral : program         (* of the inputs of the field *);
  square : rational          (* 1 / b *);
  level_sign : bigZ;
  level_of : initial         (* the level: an affine function on the box *);
  level_guesses : guesses    (* for A, then about ((level - A) / b)^(-1/2) *)
}.

Record row := Row {
  field : program;
  dimension : nat                 (* of the state *);
  section : nat                   (* the coordinate that is 0 on the section *);
  domain : box;
  of_level : option level;
  row_format : format;
  onto_degree : nat;
  clock_bits : bigZ
}.

Definition exact_over (f : format) (x : rational) (s : bigZ) : bigZ := BigZ.div (BigZ.shiftl (over x) s) (under x).
Definition is_exact (f : format) (x : rational) (s : bigZ) : bool :=
  exact_over f x s * under x =? BigZ.shiftl (over x) s.

Definition unit_exponent (n j : nat) : list nat := map (fun i => if (i =? j)%nat then 1%nat else O) (seq 0 n).

(* An affine function of p, p_j = 4 radius_j xi_j. *)
Definition times4 (a b : rational) : rational := Q (4 * over a * over b) (under a * under b).
Definition coefficient (f : format) (b : box) (centre : rational) (r : list rational) (m : list nat) : rational :=
  if forallb (fun e => (e =? 0)%nat) m then centre
  else fold_right (fun j found =>
    if same m (unit_exponent (length (radii b)) j) then times4 (nth j r (Q 0 1)) (nth j (radii b) (Q 0 1)) else found)
    (Q 0 1) (seq 0 (length (radii b))).
Definition affine (f : format) (b : box) (centre : rational) (r : list rational) : element :=
  let cs := map (fun m => coefficient f b centre r m) (monomials f) in
  element_of f
    (map2 (fun g c => if over c =? 0 then [] else [exact_over f c (scale f g)]) (grades f) cs)
    (fold_right (fun gc e => if is_exact f (snd gc) (scale f (fst gc)) then e
                             else raise (fst gc) (bound f 1 (scale f (fst gc))) e) (nothing f) (combine (grades f) cs)).

(* All weights are at most the top grade, so that no p_j is lost; all numbers are numbers. *)
Definition is_number (x : rational) : bool := 0 <? under x.
Definition good_box (f : format) (b : box) : bool :=
  forallb (fun w => (1 <=? w)%nat && (w <=? top f)%nat) (weights b)
  && (length (weights b) =? length (radii b))%nat
  && forallb (fun r => is_number r && (0 <? over r)) (radii b)
  && forallb (fun s => match s with
                       | Affine c r => is_number c && forallb is_number r && (length r =? length (radii b))%nat
                       | OfLevel => true
                       end) (starts b).

Definition input_of (f : format) (b : box) (s : initial) : element :=
  match s with
  | Affine c r => affine f b c r
  | OfLevel => zero_element f
  end.

(* ((h - A) / b)^(1/2) times the sign, on elements that do not depend on theta. *)
Definition from_level (f : format) (b : box) (l : level) (given : list element) : option element :=
  let flat := of_degree f 0 in
  match evaluate flat (integral l) (removelast (level_guesses l)) given with
  | Some values =>
      match values_at (integral l) values with
      | [a] =>
          let h := input_of flat b (level_of l) in
          let base := escale flat (over (square l)) (under (square l)) (esub flat h a) in
          match epower flat 1 2 (last (level_guesses l) []) base with
          | Some s => Some (escale flat (level_sign l) 1 (emul flat base s))
          | None => None
          end
      | _ => None
      end
  | None => None
  end.

Definition begin (r : row) : option state :=
  let f := row_format r in
  let b := domain r in
  let given := map (input_of f b) (starts b) in
  if good_format f (weights b) && good_box f b && (length (starts b) =? inputs (field r))%nat then
    match of_level r with
    | None => if forallb (fun s => match s with OfLevel => false | _ => true end) (starts b) then Some given else None
    | Some l =>
        if ((level_sign l =? 1) || (level_sign l =? -1)) && is_number (square l) && negb (over (square l) =? 0) then
          match from_level f b l given with
          | Some w => Some (map2 (fun s x => match s with OfLevel => w | _ => x end) (starts b) given)
          | None => None
          end
        else None
    end
  else None.

(* Where the orbits are. *)
Record position := Position { here : state; clock : bigZ; count : counter }.

Definition element_eqb (a b : element) : bool :=
  polys_eqb (known a) (known b) && polys_eqb [unknown a] [unknown b]
  && (length (unknown a) =? length (unknown b))%nat
  && polys_eqb [size a] [size b] && (length (size a) =? length (size b))%nat.
Fixpoint state_eqb (a b : state) : bool :=
  match a, b with
  | [], [] => true
  | x :: a', y :: b' => element_eqb x y && state_eqb a' b'
  | _, _ => false
  end.
Definition maybe_eqb (a b : option bigZ) : bool :=
  match a, b with
  | Some x, Some y => x =? y
  | None, None => true
  | _, _ => false
  end.
Definition counter_eqb (a b : counter) : bool :=
  (crossings a =? crossings b)%nat && (side a =? side b) && (velocity_sign a =? velocity_sign b)
  && maybe_eqb (clear a) (clear b) && maybe_eqb (previous a) (previous b) && Bool.eqb (fresh a) (fresh b).
Definition position_eqb (a b : position) : bool :=
  state_eqb (here a) (here b) && (clock a =? clock b) && counter_eqb (count a) (count b).

(* A state is written down by its known parts, integers, and the bounds of the rest. *)
Definition written (r : row) (known_parts : list (list poly)) (bounds : list norm) : state :=
  map2 (element_of (row_format r)) known_parts bounds.

Definition constants (r : row) : option (list element) :=
  match begin r with
  | Some given => Some (skipn (dimension r) given)
  | None => None
  end.

(* The orbits begin on the section, exactly. *)
Definition on_section (r : row) (s : state) : bool :=
  let y := nth (section r) s missing in
  forallb (fun p => poly_eqb p []) (known y) && polys_eqb [unknown y] [[]].
Definition begins_at (r : row) (p : position) : bool :=
  match begin r with
  | Some given =>
      let s := firstn (dimension r) given in
      on_section r s && position_eqb p (Position s 0 no_crossing)
  | None => false
  end.

(* One step of the flow leads from a position to another. *)
Definition goes (r : row) (from : position) (s : step) (parts : list part) (to : position) : bool :=
  let f := row_format r in
  match constants r with
  | Some parameters =>
      match check_step f (field r) (here from) parameters s with
      | Some found =>
          let y := on_step f s (errors found) (section r) in
          let dy := nth (section r) (velocities found) missing in
          match cover (coarse f) y dy (clock_bits r) (clock from) (numerator s) (denominator s) parts 0 (count from) with
          | Some n =>
              position_eqb to (Position (at_end f s (errors found))
                (clock from + BigZ.shiftl (numerator s) (clock_bits r - denominator s)) n)
              && (denominator s <=? clock_bits r)
          | None => false
          end
      | None => false
      end
  | None => false
  end.

(* From a position, crossing number n of the section is reached at the points `image`. *)
Definition crosses (r : row) (from : position) (n : nat) (ss : list step) (ones : bigZ) (image : state) : bool :=
  let f := of_degree (row_format r) (onto_degree r) in
  match constants r, arrival (count from) n with
  | Some parameters, Some (since, behind) =>
      match onto_section f (field r) (section r) ss (here from) parameters ones with
      | Some (found, delay) =>
          let '(low, high) := range f delay in
          state_eqb image found
          && (0 <? BigZ.shiftl (clock from - since) (eps f) + BigZ.shiftl low (clock_bits r))
          && (negb behind || (high <? 0))
      | None => false
      end
  | _, _ => false
  end.

(* What all steps and crossings of a row show together. *)
Inductive follows (r : row) : position -> list state -> Prop :=
| at_the_start p : begins_at r p = true -> follows r p []
| after_a_step p images s parts q : follows r p images -> goes r p s parts q = true -> follows r q images
| at_a_crossing p images ss ones image :
    follows r p images -> crosses r p (S (length images)) ss ones image = true -> follows r p (images ++ [image]).
