(* Which monomials are kept: weights and grades (section 2.1). *)

From Coq Require Import List ZArith.
From Bignums Require Import BigZ.
From Orbitproof Require Import Polynomials Elements.
Import ListNotations.
Local Open Scope bool_scope.
Local Open Scope list_scope.

Definition grade_of (weights exponents : list nat) : nat := fold_right Nat.add O (map2 Nat.mul weights exponents).

Fixpoint exponents_below (top : nat) (weights : list nat) : list (list nat) :=
  match weights with
  | [] => [[]]
  | w :: ws => flat_map (fun e => map (cons e) (exponents_below top ws)) (seq 0 (S (top / w)))
  end.

(* By grade, then in the order of the exponents; the first is the constant. *)
Definition monomials_of (weights : list nat) (top : nat) : list (list nat) :=
  flat_map (fun g => filter (fun e => Nat.eqb (grade_of weights e) g) (exponents_below top weights)) (seq 0 (S top)).

Fixpoint same (a b : list nat) : bool :=
  match a, b with
  | [], [] => true
  | x :: a', y :: b' => Nat.eqb x y && same a' b'
  | _, _ => false
  end.

Definition pairs_of (ms : list (list nat)) : list (list (nat * nat)) :=
  let indexed := combine (seq 0 (length ms)) ms in
  map (fun m =>
    flat_map (fun a => flat_map (fun b =>
      if same (map2 Nat.add (snd a) (snd b)) m then [(fst a, fst b)] else []) indexed) indexed) ms.

(* `degree`: the largest power of theta that is kept. *)
Definition format_of (weights : list nat) (top : nat) (bits grade_bits : bigZ) (degree : nat) (eps : bigZ) : format :=
  let ms := monomials_of weights top in
  Format ms (map (grade_of weights) ms) (pairs_of ms) top bits grade_bits (S degree) eps.

(* A format that is written down is what its weights and numbers say. *)
Fixpoint all_same {A : Type} (eqb : A -> A -> bool) (a b : list A) : bool :=
  match a, b with
  | [], [] => true
  | x :: a', y :: b' => eqb x y && all_same eqb a' b'
  | _, _ => false
  end.
Definition good_format (f : format) (weights : list nat) : bool :=
  let g := format_of weights (top f) (bits f) (grade_bits f) (pred (kept f)) (eps f) in
  all_same same (monomials f) (monomials g) && same (grades f) (grades g)
  && all_same (all_same (fun a b => Nat.eqb (fst a) (fst b) && Nat.eqb (snd a) (snd b))) (pairs f) (pairs g)
  && Nat.leb 1 (kept f) && BigZ.leb 0 (bits f) && BigZ.leb 0 (grade_bits f) && BigZ.leb 0 (eps f).

(* Another degree. *)
Definition of_degree (f : format) (degree : nat) : format :=
  Format (monomials f) (grades f) (pairs f) (top f) (bits f) (grade_bits f) (S degree) (eps f).

(* That of bounds of derivatives: only the centre is known (section 4.2). *)
Definition coarse (f : format) : format :=
  Format [[]] [O] [[(O, O)]] (top f) (BigZ.min 96 (bits f)) 0 (Nat.min 25 (kept f)) (eps f).
