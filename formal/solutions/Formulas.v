(* Formulas in the parameter and in the coordinates of Variations.v at a crossing of z = 0: their values, their derivatives, and
   intervals that contain their values. *)

From Coq Require Import List Bool ZArith Reals Lra Lia.
From Coquelicot Require Import Coquelicot.
From Bignums Require Import BigZ.
From Orbitproof Require Import Polynomials Intervals Sound SoundIntervals.
From Solutions Require Import Flow Variations.
Import ListNotations.
Local Open Scope R_scope.

Lemma der_mult (f g : R -> R) p df dg : is_derive f p df -> is_derive g p dg -> is_derive (fun q => f q * g q) p (df * g p + f p * dg).
Proof. intros Hf Hg. apply (is_derive_mult f g p df dg Hf Hg). exact Rmult_comm. Qed.
Lemma der_plus (f g : R -> R) p df dg : is_derive f p df -> is_derive g p dg -> is_derive (fun q => f q + g q) p (df + dg).
Proof. apply (is_derive_plus (V := R_NormedModule) f g). Qed.
Lemma der_minus (f g : R -> R) p df dg : is_derive f p df -> is_derive g p dg -> is_derive (fun q => f q - g q) p (df - dg).
Proof. apply (is_derive_minus (V := R_NormedModule) f g). Qed.
Lemma der_const (c p : R) : is_derive (fun _ => c) p 0.
Proof. apply (is_derive_const (V := R_NormedModule)). Qed.
Lemma der_id (p : R) : is_derive (fun q => q) p 1.
Proof. apply (is_derive_id (K := R_AbsRing)). Qed.
Lemma der_eq (f : R -> R) (p l l' : R) : is_derive f p l -> l = l' -> is_derive f p l'.
Proof. intros H <-. exact H. Qed.

(* The speed is that of z. *)
Inductive formula :=
| At (i : nat) | Beta | Whole (n : Z) | Plus (x y : formula) | Minus (x y : formula) | Times (x y : formula) | Over_speed (x : formula).
Fixpoint value (b : R) (w : point) (x : formula) : R :=
  match x with
  | At i => w i
  | Beta => b
  | Whole n => IZR n
  | Plus x y => value b w x + value b w y
  | Minus x y => value b w x - value b w y
  | Times x y => value b w x * value b w y
  | Over_speed x => value b w x / fs b w 2%nat
  end.
Fixpoint places (ok : nat -> bool) (x : formula) : bool :=
  match x with
  | At i => ok i
  | Beta | Whole _ => true
  | Plus x y | Minus x y | Times x y => places ok x && places ok y
  | Over_speed x => places ok x
  end.

Definition two_b : formula := Times (Whole 2) Beta.
Definition speed : formula := Minus (Times Beta (Minus (Times (At 1) (At 1)) (Whole 1))) (Times (At 0) (At 2)).
(* The velocities of the coordinates that occur. *)
Definition velocity (i : nat) : formula :=
  match i with
  | 0%nat => At 1 | 1%nat => At 2 | 2%nat => speed | 3%nat => At 4 | 4%nat => At 5
  | 5%nat => Minus (Minus (Times two_b (Times (At 1) (At 4))) (Times (At 3) (At 2))) (Times (At 0) (At 5))
  | 9%nat => At 10 | 10%nat => At 11
  | 11%nat => Minus (Minus (Minus (Times two_b (Plus (Times (At 4) (At 4)) (Times (At 1) (At 10)))) (Times (At 9) (At 2)))
                (Times (Whole 2) (Times (At 3) (At 5)))) (Times (At 0) (At 11))
  | _ => Whole 0
  end.
Lemma speed_is b w : value b w speed = fs b w 2%nat.
Proof. reflexivity. Qed.
Lemma velocity_is b w i : In i places_e -> value b w (velocity i) = fs b w i.
Proof. intros Hi. cbn in Hi. repeat (destruct Hi as [<-|Hi]; [cbn; ring|]). contradiction. Qed.

(* From the derivatives of the coordinates, of the parameter and of the speed. *)
Fixpoint derived (d : nat -> formula) (db ds : formula) (x : formula) : formula :=
  match x with
  | At i => d i
  | Beta => db
  | Whole _ => Whole 0
  | Plus x y => Plus (derived d db ds x) (derived d db ds y)
  | Minus x y => Minus (derived d db ds x) (derived d db ds y)
  | Times x y => Plus (Times (derived d db ds x) y) (Times x (derived d db ds y))
  | Over_speed x => Over_speed (Minus (derived d db ds x) (Times (Over_speed x) ds))
  end.
Definition speed_derived (d : nat -> formula) (db : formula) : formula :=
  Minus (Plus (Times db (Minus (Times (At 1) (At 1)) (Whole 1))) (Times Beta (Plus (Times (d 1%nat) (At 1)) (Times (At 1) (d 1%nat)))))
    (Plus (Times (d 0%nat) (At 2)) (Times (At 0) (d 2%nat))).

Section Derivation.
Variables (d : nat -> formula) (db : formula) (B : R -> R) (W : R -> point) (p : R) (ok : nat -> bool).
Notation here x := (value (B p) (W p) x).
Hypothesis coordinates : forall i, ok i = true -> is_derive (fun q => W q i) p (here (d i)).
Hypothesis parameter : is_derive B p (here db).
Hypothesis ok_speed : ok 0%nat = true /\ ok 1%nat = true /\ ok 2%nat = true.
Hypothesis moves : fs (B p) (W p) 2%nat <> 0.
Notation ds := (speed_derived d db).

Lemma speed_derive : is_derive (fun q => fs (B q) (W q) 2%nat) p (here ds).
Proof.
  destruct ok_speed as [O0 [O1 O2]]. pose proof (coordinates _ O0) as C0. pose proof (coordinates _ O1) as C1. pose proof (coordinates _ O2) as C2. cbn [value speed_derived].
  apply (der_minus (fun q => B q * (W q 1%nat * W q 1%nat - 1)) (fun q => W q 0%nat * W q 2%nat)); [|apply der_mult; assumption].
  apply (der_mult B (fun q => W q 1%nat * W q 1%nat - 1)); [assumption|].
  eapply der_eq; [apply (der_minus (fun q => W q 1%nat * W q 1%nat) (fun _ => 1)); [apply der_mult; eassumption | apply der_const]|]. cbv beta. ring.
Qed.
Theorem derived_sound x : places ok x = true -> is_derive (fun q => value (B q) (W q) x) p (here (derived d db ds x)).
Proof.
  induction x as [i| |n|x Hx y Hy|x Hx y Hy|x Hx y Hy|x Hx]; cbn [places derived value]; intros O.
  - exact (coordinates i O).
  - exact parameter.
  - exact (der_const (IZR n) p).
  - apply andb_prop in O. destruct O as [O1 O2]. exact (der_plus _ _ p _ _ (Hx O1) (Hy O2)).
  - apply andb_prop in O. destruct O as [O1 O2]. exact (der_minus _ _ p _ _ (Hx O1) (Hy O2)).
  - apply andb_prop in O. destruct O as [O1 O2]. exact (der_mult _ _ p _ _ (Hx O1) (Hy O2)).
  - eapply der_eq; [exact (is_derive_div _ _ p _ _ (Hx O) speed_derive moves)|]. cbv beta. field. exact moves.
Qed.
End Derivation.

(* Intervals. *)
Section Enclosures.
Variable prec : bigZ.
Hypothesis prec_nonneg : (0 <= BigZ.to_Z prec)%Z.
Fixpoint enclosure (b : interval) (w : nat -> interval) (s : interval) (x : formula) : interval :=
  match x with
  | At i => w i
  | Beta => b
  | Whole n => inumber prec (BigZ.of_Z n) 1%bigZ
  | Plus x y => iadd (enclosure b w s x) (enclosure b w s y)
  | Minus x y => isub (enclosure b w s x) (enclosure b w s y)
  | Times x y => imul prec (enclosure b w s x) (enclosure b w s y)
  | Over_speed x => idiv prec (enclosure b w s x) s
  end.
Lemma whole_is n : contains prec (inumber prec (BigZ.of_Z n) 1%bigZ) (IZR n).
Proof. pose proof (inumber_sound prec prec_nonneg (BigZ.of_Z n) 1%bigZ) as H. unfold r_ in H. rewrite BigZ.spec_of_Z in H. change (BigZ.to_Z 1%bigZ) with 1%Z in H. replace (IZR n / 1) with (IZR n) in H by field. exact H. Qed.
Theorem enclosure_sound b w s bi wi x : contains prec bi b -> (forall i, contains prec (wi i) (w i)) -> contains prec s (fs b w 2%nat) ->
  contains prec (enclosure bi wi s x) (value b w x).
Proof.
  intros Hb Hw Hs. induction x as [i| |n|x Hx y Hy|x Hx y Hy|x Hx y Hy|x Hx]; cbn [enclosure value]; auto.
  - apply whole_is.
  - apply iadd_sound; assumption.
  - apply isub_sound; assumption.
  - apply imul_sound; assumption.
  - apply idiv_sound; assumption.
Qed.
End Enclosures.
