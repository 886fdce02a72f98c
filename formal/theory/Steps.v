(* One step of the flow: defect, comparison system, tube (sections 3.3, 4.1 to 4.3 of the chapter verify/flow). *)

From Coq Require Import List ZArith.
From Bignums Require Import BigZ.
From Orbitproof Require Import Polynomials Elements Formats Programs.
Import ListNotations.
Local Open Scope bool_scope.
Local Open Scope bigZ_scope.
Local Open Scope list_scope.

(* A time is an integer over 2^denominator. *)
Record step := Step {
  numerator : bigZ;
  denominator : bigZ;
  solution : list (list poly)  (* for each component, for each monomial *);
  powers : guesses             (* about the powers in the field on it *);
  tube : list norm             (* a bound of the errors on the step *);
  terms : nat                  (* of the exponential series *)
}.

(* A state: elements that do not depend on theta. *)
Definition state := list element.

Definition poly_eqb (p q : poly) : bool := forallb (fun c => c =? 0) (psub p q).
Fixpoint polys_eqb (a b : list poly) : bool :=
  match a, b with
  | [], [] => true
  | p :: a', q :: b' => poly_eqb p q && polys_eqb a' b'
  | _, _ => false
  end.

Definition starts_at (f : format) (x : list poly) (from : element) : bool :=
  polys_eqb (map (fun p => [at_zero p]) x) (known from).

Section Step.
Variable f : format.

(* The part of the defect that is known: h f - x', times 2^denominator. *)
Definition known_defect (num den : bigZ) (x value : list poly) : norm :=
  fold_right (fun gpq e => let '(g, (p, q)) := gpq in
    raise g (bound f (l1 (psub (pscale num q) (map (fun c => BigZ.shiftl c den) (pderiv p)))) (scale f g + den)) e)
    (nothing f) (combine (grades f) (combine x value)).
Definition defect (num den : bigZ) (x : list poly) (value : element) : norm :=
  nadd (known_defect num den x (known value)) (map (fun e => up (num * e) den) (unknown value)).

Let c : format := coarse f.

(* Everything but the centre, to 96 bits and degree 24, is a bound. *)
Definition coarsened (x : element) (wider : norm) : element :=
  let centre := hd [] (known x) in
  let shift := bits f - bits c in
  let rest := bound f (l1 (skipn (kept c) centre)) (bits f) + rounding c 0 in
  element_of c [map (fun a => down a shift) (firstn (kept c) centre)]
    (raise 0 rest (nadd (nadd (unknown x) wider) (0 :: tl (size x)))).

Definition coarse_guess (g : list poly) : list poly :=
  [map (fun a => down a (bits f - bits c)) (firstn (kept c) (hd [] g))].

Definition parts : list nat := seq 0 8.

(* A bound by grade on the part (i / 8, (i + 1) / 8) of the step. *)
Definition on_part (x : element) (i : nat) : norm :=
  let p := hd [] (known x) in
  let q := recentred (BigZ.of_Z (Z.of_nat (2 * i + 1))) 4 p in
  raise 0 (bound f (l1 q) (bits c + recentred_scale 4 p)) (unknown x).

Definition slope_on_part (s : slope) (i : nat) : option norm :=
  match s with
  | Zero => None
  | One => Some (on_part (unit_ c) i)
  | Of x => Some (on_part x i)
  end.

(* h / 8 times the bounds of the derivatives, on one part. *)
Definition matrix (num den : bigZ) (rows : list (list slope)) (i : nat) : list (list (option norm)) :=
  map (map (fun s => option_map (map (fun e => up (num * e) (den + 3))) (slope_on_part s i))) rows.

Definition apply_row (row : list (option norm)) (v : list norm) : norm :=
  fold_right (fun mv sum => match fst mv with Some m => nadd (conv f m (snd mv)) sum | None => sum end)
    (nothing f) (combine row v).
Definition apply (m : list (list (option norm))) (v : list norm) : list norm := map (fun row => apply_row row v) m.

(* Terms of exp(M) v from number k on; the sum of those before, and the last one. *)
Fixpoint series (m : list (list (option norm))) (n : nat) (k : bigZ) (term sum : list norm) : list norm * list norm :=
  match n with
  | O => (sum, term)
  | S n' =>
      let next := map (map (fun x => quotient_up x k)) (apply m term) in
      series m n' (k + 1) next (map2 nadd sum term)
  end.
Definition exponential (n : nat) (m : list (list (option norm))) (v : list norm) : option (list norm) :=
  let found := series m n 1 v (map zeros v) in
  if forallb (fun ab => nle (map (fun x => BigZ.shiftl x 40) (fst ab)) (snd ab)) (combine (snd found) v)
  then Some (map (map (fun x => x + up x 39)) (fst found))
  else None.

(* A bound on all of the step, from one of the errors at its beginning with the defects. *)
Definition grown (num den : bigZ) (n : nat) (rows : list (list slope)) (start : list norm) : option (list norm) :=
  fold_left (fun v i => match v with Some v => exponential n (matrix num den rows i) v | None => None end)
    parts (Some start).

(* What is added to all bounds, far below all that matters: the terms of the series do not vanish beside it. *)
Definition least : bigZ := one_at 44.

(* What a step has shown: the errors, and the field on the tube, of which only the centre is known. *)
Record shown := Shown { errors : list norm; velocities : list element }.

Definition check_step (p : program) (from parameters : state) (s : step) : option shown :=
  let num := numerator s in let den := denominator s in
  let m := length from in
  if (0 <? num) && (0 <=? den) && (length (solution s) =? m)%nat && (length (tube s) =? m)%nat && (length (outputs p) =? m)%nat
     && forallb (fits f) (solution s)
     && forallb (fun xa => starts_at f (fst xa) (snd xa)) (combine (solution s) from)
     && forallb (forallb (fun t => 0 <=? t)) (tube s)
     && forallb (fun t => (length t =? S (S (top f)))%nat) (tube s)
  then
    let exact := map (fun x => element_of f x (nothing f)) (solution s) in
    match evaluate f p (powers s) (exact ++ parameters) with
    | Some values =>
        let field := values_at p values in
        let defects := map2 (fun x v => defect num den x v) (solution s) field in
        let start := map2 (fun a d => map (BigZ.add least) (nadd (unknown a) d)) from defects in
        let wide := map2 coarsened exact (tube s) ++ map (fun a => coarsened a (nothing f)) parameters in
        match evaluate c p (map coarse_guess (powers s)) wide with
        | Some values =>
            let rows := slopes_at p (derivatives c p m values) in
            match grown num den (terms s) rows start with
            | Some e =>
                if (length e =? m)%nat && forallb (fun ab => nlt (fst ab) (snd ab)) (combine e (tube s))
                then Some (Shown e (values_at p values)) else None
            | None => None
            end
        | None => None
        end
    | None => None
    end
  else None.

(* The state at the end of the step, and the solution on all of it, with these errors. *)
Definition at_end (s : step) (e : list norm) : state :=
  map2 (fun x errors => element_of f (map (fun p => [at_one p]) x) errors) (solution s) e.
Definition on_step (s : step) (e : list norm) (i : nat) : element :=
  coarsened (element_of f (nth i (solution s) []) (nothing f)) (nth i e []).

End Step.
