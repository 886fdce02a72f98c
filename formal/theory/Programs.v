(* Straight-line programs on elements, and their derivatives (sections 2.4, 3.3 and 4.2). *)

From Coq Require Import List ZArith.
From Bignums Require Import BigZ.
From Orbitproof Require Import Polynomials Elements.
Import ListNotations.
Local Open Scope bool_scope.
Local Open Scope bigZ_scope.
Local Open Scope list_scope.

(* A node names earlier ones by their places, the inputs being the first. *)
Inductive node :=
| Const (numerator denominator : bigZ)
| Add (i j : nat)
| Sub (i j : nat)
| Mul (i j : nat)
| Scale (i : nat) (numerator denominator : bigZ)
| Power (i p q : nat) (* base^(- p / q) *).

Record program := Program { inputs : nat; nodes : list node; outputs : list nat }.

(* About the powers of a program, in their order: nothing is believed of them. *)
Definition guesses := list (list poly).

Section Evaluation.
Variable f : format.

Definition missing : element := Element [] [] [].

Fixpoint run (ns : list node) (values : list element) (gs : guesses) : option (list element) :=
  match ns with
  | [] => Some values
  | n :: ns' =>
      let at_ i := nth i values missing in
      let go x := run ns' (values ++ [x]) gs in
      match n with
      | Const a b => if 0 <? b then go (econst f a b) else None
      | Add i j => go (eadd f (at_ i) (at_ j))
      | Sub i j => go (esub f (at_ i) (at_ j))
      | Mul i j => go (emul f (at_ i) (at_ j))
      | Scale i a b => if 0 <? b then go (escale f a b (at_ i)) else None
      | Power i p q =>
          match gs with
          | g :: gs' =>
              match p, q with
              | S _, S _ =>
                  match epower f p q g (at_ i) with
                  | Some x => run ns' (values ++ [x]) gs'
                  | None => None
                  end
              | _, _ => None
              end
          | [] => None
          end
      end
  end.

(* All earlier places are earlier, and what is given has as many entries as there are inputs. *)
Definition places_of (n : node) : list nat :=
  match n with
  | Const _ _ => []
  | Add i j | Sub i j | Mul i j => [i; j]
  | Scale i _ _ | Power i _ _ => [i]
  end.
Fixpoint well_formed_from (k : nat) (ns : list node) : bool :=
  match ns with
  | [] => true
  | n :: ns' => forallb (fun i => (i <? k)%nat) (places_of n) && well_formed_from (S k) ns'
  end.
Definition well_formed (p : program) : bool :=
  well_formed_from (inputs p) (nodes p)
  && forallb (fun i => (i <? inputs p + length (nodes p))%nat) (outputs p).

Definition evaluate (p : program) (gs : guesses) (given : list element) : option (list element) :=
  if well_formed p && (length given =? inputs p)%nat then run (nodes p) given gs else None.

Definition values_at (p : program) (values : list element) : list element :=
  map (fun i => nth i values missing) (outputs p).

(* Derivatives: 0, 1 or an element. *)
Inductive slope := Zero | One | Of (x : element).

Definition unit_ : element := econst f 1 1.
Definition as_element (s : slope) : element :=
  match s with
  | Zero => econst f 0 1
  | One => unit_
  | Of x => x
  end.
Definition slope_add (a b : slope) : slope :=
  match a, b with
  | Zero, _ => b
  | _, Zero => a
  | _, _ => Of (eadd f (as_element a) (as_element b))
  end.
Definition slope_scale (n d : bigZ) (a : slope) : slope :=
  match a with
  | Zero => Zero
  | _ => if (n =? 1) && (d =? 1) then a else Of (escale f n d (as_element a))
  end.
Definition slope_mul (a : slope) (x : element) : slope :=
  match a with
  | Zero => Zero
  | One => Of x
  | Of y => Of (emul f y x)
  end.

(* 1 / base is guess^q base^(p - 1) where guess = base^(- p / q). *)
Definition reciprocal (p q : nat) (power base : element) : element :=
  times f (pred q) power (times f (pred p) base power).

Fixpoint slopes (ns : list node) (values : list element) (k : nat) (found : list (list slope)) : list (list slope) :=
  match ns with
  | [] => found
  | n :: ns' =>
      let at_ i := nth i values missing in
      let d i := nth i found [] in
      let go x := slopes ns' values (S k) (found ++ [x]) in
      match n with
      | Const _ _ => go (map (fun _ => Zero) (hd [] found))
      | Add i j => go (map2 slope_add (d i) (d j))
      | Sub i j => go (map2 slope_add (d i) (map (slope_scale (-1) 1) (d j)))
      | Mul i j =>
          go (if (i =? j)%nat then let half := map (fun s => slope_mul s (at_ i)) (d i) in map2 slope_add half half
              else map2 slope_add (map (fun s => slope_mul s (at_ j)) (d i)) (map (fun s => slope_mul s (at_ i)) (d j)))
      | Scale i a b => go (map (slope_scale a b) (d i))
      | Power i p q =>
          let power := at_ k in
          let outer := escale f (- BigZ.of_Z (Z.of_nat p)) (BigZ.of_Z (Z.of_nat q))
                         (emul f power (reciprocal p q power (at_ i))) in
          go (map (fun s => slope_mul s outer) (d i))
      end
  end.

(* Row i of the identity of size m. *)
Definition unit_row (m i : nat) : list slope := map (fun j => if (i =? j)%nat then One else Zero) (seq 0 m).

(* The derivatives of all nodes by the first m inputs. *)
Definition derivatives (p : program) (m : nat) (values : list element) : list (list slope) :=
  slopes (nodes p) values (inputs p) (map (unit_row m) (seq 0 (inputs p))).

Definition slopes_at (p : program) (found : list (list slope)) : list (list slope) :=
  map (fun i => nth i found []) (outputs p).

End Evaluation.
