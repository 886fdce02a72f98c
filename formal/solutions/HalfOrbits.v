(* Half orbits of the Falkner-Skan equation: where they are on the line x = z = 0 again, and the way back. *)

From Coq Require Import List ZArith Reals Lra Lia.
From Coquelicot Require Import Coquelicot.
From Bignums Require Import BigZ.
From Orbitproof Require Import Programs.
From Solutions Require Import Comparison Flow Fields InitialValues Statements Variations.
Import ListNotations.
Local Open Scope R_scope.
Local Open Scope list_scope.

(* Three equations only. *)
Definition fs3_program : program := Program 4 [Mul 1 1; Const 1 1; Sub 4 5; Mul 3 6; Mul 0 2; Sub 7 8] [1; 2; 9]%nat.
Lemma fs3_is b x i : (i < 3)%nat -> field_of fs3_program 3 [b] x i = fs b x i.
Proof.
  intros Hi. unfold field_of. do 3 (destruct i as [|i]; [cbv [fs fs3_program outputs nodes nth all_values node_value app map seq]; numbers; field|]). lia.
Qed.
Lemma fs3_lipschitz b : locally_lipschitz 3 (fs b).
Proof.
  intros r. destruct (field_of_is_lipschitz fs3_program 3 [b] r) as [L [HL H]]. exists L. split; [assumption|].
  intros x y Hx Hy i Hi. rewrite <- !fs3_is by assumption. auto.
Qed.
Lemma flows_shorter T T' b e y : T' <= T -> flows T b e y -> solves 3 (fs b) T' y.
Proof. intros H [_ S] i t Hi Ht. apply S; [lia | lra]. Qed.
Lemma half_orbit_is T b e y T' : 0 <= T' <= T -> flows T b e y -> (half_orbit b e T' <-> y 0%nat T' = 0 /\ y 2%nat T' = 0).
Proof.
  intros HT F. split.
  - intros [x1 [y1 [z1 [[X0 [Y0 Z0]] [D [XT ZT]]]]]].
    pose (u := fun i : nat => match i with 0%nat => x1 | 1%nat => y1 | _ => z1 end).
    assert (S : solves 3 (fs b) T' u).
    { intros i t Hi Ht. destruct (D t Ht) as [D1 [D2 D3]]. destruct i as [|[|[|i]]]; [exact D1 | exact D2 | | lia]. cbn [fs u].
      replace (b * (y1 t * y1 t - 1) - x1 t * z1 t) with (b * (y1 t ^ 2 - 1) - x1 t * z1 t) by ring. exact D3. }
    assert (E : forall i t, (i < 3)%nat -> 0 <= t <= T' -> u i t = y i t).
    { apply (unique 3 (fs b) (fs3_lipschitz b) T'); [lra | assumption | apply (flows_shorter T T' b e y); [lra | assumption]|].
      intros i Hi. destruct F as [F0 _]. rewrite F0 by lia. destruct i as [|[|[|i]]]; [exact X0 | exact Y0 | exact Z0 | lia]. }
    split; [rewrite <- (E 0%nat) | rewrite <- (E 2%nat)]; (assumption || lia || lra).
  - intros [E1 E2]. exists (y 0%nat), (y 1%nat), (y 2%nat). destruct F as [F0 S]. rewrite !F0 by lia. split; [cbn; auto|]. split; [|auto].
    intros t Ht. split; [|split].
    + apply (S 0%nat); [lia | lra].
    + apply (S 1%nat); [lia | lra].
    + replace (b * (y 1%nat t ^ 2 - 1) - y 0%nat t * y 2%nat t) with (b * (y 1%nat t * y 1%nat t - 1) - y 0%nat t * y 2%nat t) by ring.
      apply (S 2%nat); [lia | lra].
Qed.

(* The way back. *)
Definition mirrored (i : nat) (u : R) : R := match i with 1%nat => u | _ => - u end.
Lemma backwards T b e y s : flows T b e y -> 0 <= s <= T -> solves 3 (fs b) s (fun i t => mirrored i (y i (s - t))).
Proof.
  intros [F0 S] Hs i t Hi Ht.
  assert (D : forall j, (j < 3)%nat -> is_derive (fun t => y j (s - t)) t (- fs b (fun k => y k (s - t)) j)).
  { intros j Hj. replace (- fs b (fun k => y k (s - t)) j) with (scal (-1) (fs b (fun k => y k (s - t)) j)) by (unfold scal; cbn; unfold mult; cbn; ring).
    apply (is_derive_comp (V := R_NormedModule) (y j) (fun t => s - t)); [apply S; [lia | lra]|]. auto_derive; [exact I | ring]. }
  pose proof (D i Hi) as Di. destruct i as [|[|[|i]]]; [| | | lia]; cbn [fs mirrored] in *.
  - apply (is_derive_opp (V := R_NormedModule)) in Di. replace (y 1%nat (s - t)) with (opp (- y 1%nat (s - t))) by (unfold opp; cbn; ring). exact Di.
  - exact Di.
  - apply (is_derive_opp (V := R_NormedModule)) in Di.
    match type of Di with is_derive _ _ ?l => match goal with |- is_derive _ _ ?k => replace k with l by (unfold opp; cbn; ring) end end. exact Di.
Qed.
Lemma mirrored_solution T b e y s : flows T b e y -> 0 <= s -> 2 * s <= T -> y 0%nat s = 0 -> y 2%nat s = 0 ->
  y 0%nat (2 * s) = 0 /\ y 1%nat (2 * s) = e /\ y 2%nat (2 * s) = 0.
Proof.
  intros Fl Hs HT X Z. pose proof Fl as [F0 S].
  assert (E : forall i t, (i < 3)%nat -> 0 <= t <= s -> y i (s + t) = mirrored i (y i (s - t))).
  { apply (unique 3 (fs b) (fs3_lipschitz b) s (fun i t => y i (s + t)) (fun i t => mirrored i (y i (s - t)))); [lra | | |].
    - intros i t Hi Ht. replace (fs b (fun j => y j (s + t)) i) with (scal 1 (fs b (fun j => y j (s + t)) i)) by (unfold scal; cbn; unfold mult; cbn; ring).
      apply (is_derive_comp (V := R_NormedModule) (y i) (fun t => s + t)); [apply S; [lia | lra]|]. auto_derive; [exact I | ring].
    - apply (backwards T b e); [assumption | lra].
    - intros i Hi. rewrite Rplus_0_r, Rminus_0_r. destruct i as [|[|[|i]]]; [| reflexivity | | lia]; cbn [mirrored]; [rewrite X | rewrite Z]; ring. }
  assert (E' : forall i, (i < 3)%nat -> y i (2 * s) = mirrored i (from e i)).
  { intros i Hi. pose proof (E i s Hi ltac:(lra)) as Q. rewrite Rminus_eq_0, F0 in Q by lia. replace (s + s) with (2 * s) in Q by ring. exact Q. }
  rewrite !E' by lia. cbn. repeat split; ring.
Qed.
(* From where an orbit meets the line it goes the same way back. *)
Lemma other_end T b e y s y' : flows T b e y -> 0 <= s <= T -> y 0%nat s = 0 -> y 2%nat s = 0 -> flows T b (y 1%nat s) y' ->
  forall i t, (i < 3)%nat -> 0 <= t <= s -> y' i t = mirrored i (y i (s - t)).
Proof.
  intros Fl Hs X Z [F0' S']. apply (unique 3 (fs b) (fs3_lipschitz b) s y' (fun i t => mirrored i (y i (s - t)))); [lra | | |].
  - intros i t Hi Ht. apply S'; [lia | lra].
  - apply (backwards T b e); assumption.
  - intros i Hi. rewrite F0', Rminus_0_r by lia. destruct i as [|[|[|i]]]; [| reflexivity | | lia]; cbn [mirrored from]; [rewrite X | rewrite Z]; ring.
Qed.
(* After twice the time all is as before, and so the orbit is on the line after each multiple. *)
Lemma multiples T b e y s : flows T b e y -> 0 <= s -> y 0%nat s = 0 -> y 2%nat s = 0 ->
  forall j, INR j * s <= T -> y 0%nat (INR j * s) = 0 /\ y 2%nat (INR j * s) = 0 /\ (Nat.even j = true -> y 1%nat (INR j * s) = e).
Proof.
  intros Fl Hs X Z. pose proof Fl as [F0 Sol].
  enough (P : forall j, (INR j * s <= T -> y 0%nat (INR j * s) = 0 /\ y 2%nat (INR j * s) = 0 /\ (Nat.even j = true -> y 1%nat (INR j * s) = e)) /\
    (INR (S j) * s <= T -> y 0%nat (INR (S j) * s) = 0 /\ y 2%nat (INR (S j) * s) = 0 /\ (Nat.even (S j) = true -> y 1%nat (INR (S j) * s) = e))) by (intros j; apply P).
  induction j as [|j [I0 I1]].
  - split; intros _; [rewrite Rmult_0_l, !F0 by lia; cbn; auto|]. change (INR 1) with 1. rewrite Rmult_1_l. cbn. repeat split; [assumption | assumption | discriminate].
  - split; [exact I1|]. intros HT. rewrite !S_INR in HT. rewrite !S_INR in *. pose proof (pos_INR j) as Pj.
    assert (Q : 0 <= INR j * s) by (apply Rmult_le_pos; assumption).
    destruct (mirrored_solution T b e y s Fl Hs ltac:(lra) X Z) as [X2 [Y2 Z2]].
    assert (E : forall i t, (i < 3)%nat -> 0 <= t <= INR j * s -> y i (2 * s + t) = y i t).
    { apply (unique 3 (fs b) (fs3_lipschitz b) (INR j * s) (fun i t => y i (2 * s + t)) y); [assumption | | |].
      - intros i t Hi Ht. replace (fs b (fun j => y j (2 * s + t)) i) with (scal 1 (fs b (fun j => y j (2 * s + t)) i)) by (unfold scal; cbn; unfold mult; cbn; ring).
        apply (is_derive_comp (V := R_NormedModule) (y i) (fun t => 2 * s + t)); [apply Sol; [lia | lra]|]. auto_derive; [exact I | ring].
      - apply (flows_shorter T _ b e); [lra | assumption].
      - intros i Hi. rewrite Rplus_0_r, F0 by lia. destruct i as [|[|[|i]]]; [exact X2 | exact Y2 | exact Z2 | lia]. }
    replace ((INR j + 1 + 1) * s) with (2 * s + INR j * s) by ring. rewrite !E by (lia || lra). specialize (I0 ltac:(lra)). exact I0.
Qed.
