(* The Falkner-Skan equation x' = y, y' = z, z' = b (y^2 - 1) - x z from (0, e, 0), with the equations for the derivatives of its
   solutions by e and b: places 0 to 2 are x, y, z, 3 to 5 their derivatives by e, 6 to 8 by b, 9 to 11 by e twice, 12 to 14 by e
   and b, 15 to 17 by e three times. That solutions of these equations are the derivatives is proved. *)

From Coq Require Import List ZArith Reals Lra Lia.
From Coquelicot Require Import Coquelicot.
From Bignums Require Import BigZ.
From Orbitproof Require Import Polynomials Elements Formats Programs Steps Sound.
From Solutions Require Import Comparison Flow Norms Values Fields CheckedFlow InitialValues Dependence.
Import ListNotations.
Local Open Scope R_scope.
Local Open Scope list_scope.

Definition fs_program : program := Program 19
  [Mul 1 1; Const 1 1; Sub 19 20; Mul 18 21; Mul 0 2; Sub 22 23; Scale 18 2 1; Mul 1 25; Mul 4 26; Mul 2 3; Sub 27 28; Mul 0 5;
   Sub 29 30; Mul 7 26; Add 21 32; Mul 2 6; Sub 33 34; Mul 0 8; Sub 35 36; Mul 4 4; Mul 1 10; Add 38 39; Mul 25 40; Mul 2 9;
   Sub 41 42; Scale 3 2 1; Mul 5 44; Sub 43 45; Mul 0 11; Sub 46 47; Scale 1 2 1; Mul 4 49; Mul 4 7; Mul 1 13; Add 51 52; Mul 25 53;
   Add 50 54; Mul 2 12; Sub 55 56; Mul 3 8; Sub 57 58; Mul 5 6; Sub 59 60; Mul 0 14; Sub 61 62; Scale 4 3 1; Mul 10 64; Mul 1 16;
   Add 65 66; Mul 25 67; Mul 2 15; Sub 68 69; Scale 9 3 1; Mul 5 71; Sub 70 72; Scale 3 3 1; Mul 11 74; Sub 73 75; Mul 0 17;
   Sub 76 77]
  [1; 2; 24; 4; 5; 31; 7; 8; 37; 10; 11; 48; 13; 14; 63; 16; 17; 78]%nat.

Definition fs (b : R) : field := fun v i =>
  match i with
  | 0%nat => v 1%nat | 1%nat => v 2%nat | 2%nat => b * (v 1%nat * v 1%nat - 1) - v 0%nat * v 2%nat
  | 3%nat => v 4%nat | 4%nat => v 5%nat | 5%nat => 2 * b * v 1%nat * v 4%nat - v 3%nat * v 2%nat - v 0%nat * v 5%nat
  | 6%nat => v 7%nat | 7%nat => v 8%nat | 8%nat => v 1%nat * v 1%nat - 1 + 2 * b * v 1%nat * v 7%nat - v 6%nat * v 2%nat - v 0%nat * v 8%nat
  | 9%nat => v 10%nat | 10%nat => v 11%nat | 11%nat => 2 * b * (v 4%nat * v 4%nat + v 1%nat * v 10%nat) - v 9%nat * v 2%nat - 2 * v 3%nat * v 5%nat - v 0%nat * v 11%nat
  | 12%nat => v 13%nat | 13%nat => v 14%nat
  | 14%nat => 2 * v 1%nat * v 4%nat + 2 * b * (v 7%nat * v 4%nat + v 1%nat * v 13%nat) - v 12%nat * v 2%nat - v 3%nat * v 8%nat - v 6%nat * v 5%nat - v 0%nat * v 14%nat
  | 15%nat => v 16%nat | 16%nat => v 17%nat
  | 17%nat => 2 * b * (3 * v 4%nat * v 10%nat + v 1%nat * v 16%nat) - v 15%nat * v 2%nat - 3 * v 9%nat * v 5%nat - 3 * v 3%nat * v 11%nat - v 0%nat * v 17%nat
  | _ => 0
  end.
Lemma fs_is b x i : (i < 18)%nat -> field_of fs_program 18 [b] x i = fs b x i.
Proof.
  intros Hi. unfold field_of. do 18 (destruct i as [|i]; [cbv [fs_program outputs nodes nth all_values node_value app map seq fs]; numbers; field|]). lia.
Qed.
Lemma fs_lipschitz b : locally_lipschitz 18 (fs b).
Proof.
  intros r. destruct (field_of_is_lipschitz fs_program 18 [b] r) as [L [HL H]]. exists L. split; [assumption|].
  intros x y Hx Hy i Hi. rewrite <- !fs_is by assumption. auto.
Qed.

Definition from (e : R) (i : nat) : R := match i with 1%nat => e | 4%nat => 1 | _ => 0 end.
Definition flows (T b e : R) (y : nat -> R -> R) : Prop :=
  (forall i, (i < 18)%nat -> y i 0 = from e i) /\ solves 18 (fs b) T y.

(* The only number with a property. *)
Definition the (P : R -> Prop) : R := real (Lub_Rbar P).
Lemma the_is (P : R -> Prop) u : P u -> (forall v, P v -> v = u) -> the P = u.
Proof.
  intros Hu H. unfold the. rewrite (is_lub_Rbar_unique P (Finite u)); [reflexivity|]. split.
  - intros v Hv. rewrite (H v Hv). cbn. lra.
  - intros v Hv. apply Hv. assumption.
Qed.

(* Which derivatives are there. *)
Definition by_e (i : nat) : nat := match i with 0 => 3 | 1 => 4 | 2 => 5 | 3 => 9 | 4 => 10 | 5 => 11 | 9 => 15 | 10 => 16 | 11 => 17 | _ => 0 end%nat.
Definition by_b (i : nat) : nat := match i with 0 => 6 | 1 => 7 | 2 => 8 | 3 => 12 | 4 => 13 | 5 => 14 | _ => 0 end%nat.

(* Expansions of sums and products of what is expanded. *)
Ltac expand := repeat first
  [ eassumption | apply expands_const | apply expands_minus | apply expands_plus | apply expands_mult ].

Section Flow.
Variables (bc rb ec re T r : R).
Definition in_box (b e : R) : Prop := Rabs (b - bc) <= rb /\ Rabs (e - ec) <= re.
Hypothesis T_pos : 0 < T.
Hypothesis solutions : forall b e, in_box b e -> exists y, flows T b e y /\ forall i t, (i < 18)%nat -> 0 <= t <= T -> Rabs (y i t) <= r.

(* The solution as a function of parameter, beginning and time. *)
Definition st (i : nat) (b e t : R) : R := the (fun u => exists y, flows T b e y /\ y i t = u).
Lemma st_is b e y i t : flows T b e y -> (i < 18)%nat -> 0 <= t <= T -> st i b e t = y i t.
Proof.
  intros Hy Hi Ht. apply the_is; [exists y; auto|]. intros v [z [Hz <-]]. destruct Hy as [Y0 Ys]. destruct Hz as [Z0 Zs].
  apply (unique 18 (fs b) (fs_lipschitz b) T z y); try assumption; [lra|]. intros j Hj. rewrite Z0, Y0 by assumption. reflexivity.
Qed.
Lemma st_bounded b e i t : in_box b e -> (i < 18)%nat -> 0 <= t <= T -> Rabs (st i b e t) <= r.
Proof. intros Hb Hi Ht. destruct (solutions b e Hb) as [y [Hy By]]. rewrite (st_is b e y i t Hy Hi Ht). auto. Qed.
Lemma r_nonneg b e : in_box b e -> 0 <= r.
Proof. intros H. eapply Rle_trans; [apply Rabs_pos | apply (st_bounded b e 0 0 H); [lia | lra]]. Qed.
Lemma fs_ext b x y i : (i < 18)%nat -> (forall j, (j < 18)%nat -> x j = y j) -> fs b x i = fs b y i.
Proof. apply (field_ext 18 (fs b) (fs_lipschitz b)). Qed.
Definition rate (b e t : R) (i : nat) : R := fs b (fun j => st j b e t) i.

Lemma st_derive b e i t : in_box b e -> (i < 18)%nat -> 0 < t < T -> is_derive (st i b e) t (rate b e t i).
Proof.
  intros Hb Hi Ht. destruct (solutions b e Hb) as [y [Hy _]]. unfold rate.
  rewrite (fs_ext b _ (fun j => y j t) i Hi) by (intros; apply st_is; (assumption || lra)).
  apply (is_derive_ext_loc (y i)); [|apply (proj2 Hy); [assumption | lra]].
  assert (P : 0 < Rmin t (T - t)) by (apply Rmin_pos; lra). exists (mkposreal _ P). intros s Hs. change (Rabs (s - t) < Rmin t (T - t)) in Hs.
  pose proof (Rmin_l t (T - t)). pose proof (Rmin_r t (T - t)). apply Rabs_lt_between in Hs. symmetry. apply st_is; [assumption | assumption | lra].
Qed.
Lemma st_in_time b e : in_box b e -> exists K, 0 <= K /\ forall i s t, (i < 18)%nat -> 0 <= s <= T -> 0 <= t <= T ->
  Rabs (st i b e t) <= K /\ Rabs (st i b e t - st i b e s) <= K * Rabs (t - s) /\
  Rabs (st i b e t - st i b e s - (t - s) * rate b e s i) <= K * (t - s) ^ 2.
Proof.
  intros Hb. destruct (solutions b e Hb) as [y [Hy _]]. destruct (solution_in_time 18 (fs b) T y (fs_lipschitz b) ltac:(lra) (proj2 Hy)) as [K [HK H]].
  exists K. split; [assumption|]. intros i s t Hi Hs Ht. destruct (H i s t Hi Hs Ht) as [H1 [_ [H3 H4]]]. unfold rate.
  rewrite (fs_ext b _ (fun j => y j s) i Hi) by (intros; apply st_is; assumption). rewrite !(st_is b e y i) by assumption. auto.
Qed.

Section Derivatives.
Variables b e : R.
Hypothesis here : in_box b e.

(* By the beginning. *)
Definition with_e : Type := {p : R * (nat -> R -> R) | in_box b (fst p) /\ flows T b (fst p) (snd p)}.
Definition e_of (a : with_e) : R := fst (proj1_sig a).
Definition sol_e (a : with_e) (j : nat) (t : R) : R := snd (proj1_sig a) j t.
Definition places_e : list nat := [0; 1; 2; 3; 4; 5; 9; 10; 11]%nat.

Lemma st_by_e : exists K, 0 <= K /\ forall e' i t, in_box b e' -> In i places_e -> 0 <= t <= T ->
  Rabs (st i b e' t - st i b e t - (e' - e) * st (by_e i) b e t) <= K * (e' - e) ^ 2.
Proof.
  destruct (solutions b e here) as [y0 [F0 _]]. pose (base := exist _ (e, y0) (conj here F0) : with_e).
  set (p := fun j => nth j places_e 0%nat). set (q := fun j => by_e (p j)).
  assert (Hp : forall j, (j < 9)%nat -> (p j < 18)%nat) by (intros j Hj; do 9 (destruct j as [|j]; [cbn; lia|]); lia).
  assert (Hq : forall j, (j < 9)%nat -> (q j < 18)%nat) by (intros j Hj; do 9 (destruct j as [|j]; [cbn; lia|]); lia).
  assert (Bd : forall (a : with_e) i t, (i < 18)%nat -> 0 <= t <= T -> Rabs (sol_e a i t) <= r).
  { intros [[e1 y1] [Hb1 Hf1]] i t Hi Ht. unfold sol_e. cbn [proj1_sig fst snd] in *. rewrite <- (st_is b e1 y1 i t Hf1 Hi Ht). apply st_bounded; assumption. }
  destruct (depends 9 T with_e e_of (fun a j t => sol_e a (p j) t) (fun a i t => fs b (fun j => sol_e a j t) (p i)) base
    (fun j t => sol_e base (q j) t) (fun i t => fs b (fun j => sol_e base j t) (q i))) as [K [HK H]].
  - intros [[e1 y1] [Hb1 Hf1]] i t Hi Ht. apply (proj2 Hf1); auto.
  - intros i t Hi Ht. apply (proj2 F0); auto.
  - exists r. split; [apply (r_nonneg b e here)|]. intros a i t Hi Ht. auto.
  - exists (2 * re). intros a. destruct a as [[e1 y1] [Hb1 Hf1]]. unfold away, e_of. cbn [proj1_sig fst base].
    destruct Hb1 as [_ B1]. pose proof here as [_ B2]. cbn [fst] in B1. apply Rabs_le_between in B1, B2. apply Rabs_le. lra.
  - assert (C : forall j, (j < 9)%nat -> expands 9 T with_e e_of (fun a j t => sol_e a (p j) t) base (fun j t => sol_e base (q j) t)
      (fun a t => sol_e a (p j) t) (fun t => sol_e base (q j) t)).
    { intros j Hj. apply (expands_component 9 T with_e e_of (fun a j t => sol_e a (p j) t) base (fun j t => sol_e base (q j) t) r j Hj). intros a t Ht. auto. }
    pose proof (C 0 ltac:(lia))%nat as C0. pose proof (C 1 ltac:(lia))%nat as C1. pose proof (C 2 ltac:(lia))%nat as C2.
    pose proof (C 3 ltac:(lia))%nat as C3. pose proof (C 4 ltac:(lia))%nat as C4. pose proof (C 5 ltac:(lia))%nat as C5.
    pose proof (C 6 ltac:(lia))%nat as C6. pose proof (C 7 ltac:(lia))%nat as C7. pose proof (C 8 ltac:(lia))%nat as C8. clear C.
    unfold q, p in *. cbn [places_e nth by_e] in C0, C1, C2, C3, C4, C5, C6, C7, C8.
    intros i Hi. do 9 (destruct i as [|i]; [cbn [fs places_e nth by_e]; eapply expands_ext; [expand | intros t Ht; cbv beta; ring]|]). lia.
  - intros [[e1 y1] [[Hb1 Hb2] [Y1 S1]]] i Hi. unfold sol_e, away, e_of. cbn [proj1_sig fst snd base] in *. pose proof F0 as [Y0 _].
    rewrite !Y1, !Y0 by auto. unfold q, p. do 9 (destruct i as [|i]; [cbn; ring|]). lia.
  - exists K. split; [assumption|]. intros e' i t He' Hi Ht. destruct (solutions b e' He') as [y1 [F1 _]].
    destruct (In_nth _ _ 0%nat Hi) as [j [Hj E]]. cbn in Hj.
    destruct (H (exist _ (e', y1) (conj He' F1)) j t Hj Ht) as [_ Q]. unfold away, e_of, sol_e in Q. cbn [proj1_sig fst snd base] in Q.
    unfold q, p in Q. rewrite E in Q. rewrite (st_is b e' y1), (st_is b e y0 i), (st_is b e y0 (by_e i)); try assumption.
    + specialize (Hq j Hj). unfold q, p in Hq. rewrite E in Hq. exact Hq.
    + specialize (Hp j Hj). unfold p in Hp. rewrite E in Hp. exact Hp.
    + specialize (Hp j Hj). unfold p in Hp. rewrite E in Hp. exact Hp.
Qed.

(* By the parameter. *)
Definition with_b : Type := {p : R * (nat -> R -> R) | in_box (fst p) e /\ flows T (fst p) e (snd p)}.
Definition b_of (a : with_b) : R := fst (proj1_sig a).
Definition sol_b (a : with_b) (j : nat) (t : R) : R := snd (proj1_sig a) j t.

Lemma st_by_b : exists K, 0 <= K /\ forall b' i t, in_box b' e -> (i < 6)%nat -> 0 <= t <= T ->
  Rabs (st i b' e t - st i b e t - (b' - b) * st (by_b i) b e t) <= K * (b' - b) ^ 2.
Proof.
  destruct (solutions b e here) as [y0 [F0 _]]. pose (base := exist _ (b, y0) (conj here F0) : with_b).
  assert (Hq : forall j, (j < 6)%nat -> (by_b j < 18)%nat) by (intros j Hj; do 6 (destruct j as [|j]; [cbn; lia|]); lia).
  assert (Bd : forall (a : with_b) i t, (i < 18)%nat -> 0 <= t <= T -> Rabs (sol_b a i t) <= r).
  { intros [[b1 y1] [Hb1 Hf1]] i t Hi Ht. unfold sol_b. cbn [proj1_sig fst snd] in *. rewrite <- (st_is b1 e y1 i t Hf1 Hi Ht). apply st_bounded; assumption. }
  destruct (depends 6 T with_b b_of sol_b (fun a i t => fs (b_of a) (fun j => sol_b a j t) i) base
    (fun j t => sol_b base (by_b j) t) (fun i t => fs b (fun j => sol_b base j t) (by_b i))) as [K [HK H]].
  - intros [[b1 y1] [Hb1 Hf1]] i t Hi Ht. apply (proj2 Hf1); [lia | assumption].
  - intros i t Hi Ht. apply (proj2 F0); auto.
  - exists r. split; [apply (r_nonneg b e here)|]. intros a i t Hi Ht. split; [apply Bd; [lia | assumption] | auto].
  - exists (2 * rb). intros a. destruct a as [[b1 y1] [Hb1 Hf1]]. unfold away, b_of. cbn [proj1_sig fst base].
    destruct Hb1 as [B1 _]. pose proof here as [B2 _]. cbn [fst] in B1. apply Rabs_le_between in B1, B2. apply Rabs_le. lra.
  - assert (C : forall j, (j < 6)%nat -> expands 6 T with_b b_of sol_b base (fun j t => sol_b base (by_b j) t)
      (fun a t => sol_b a j t) (fun t => sol_b base (by_b j) t)).
    { intros j Hj. apply (expands_component 6 T with_b b_of sol_b base (fun j t => sol_b base (by_b j) t) r j Hj). intros a t Ht.
      split; [apply Bd; [lia | assumption] | auto]. }
    pose proof (C 0 ltac:(lia))%nat as C0. pose proof (C 1 ltac:(lia))%nat as C1. pose proof (C 2 ltac:(lia))%nat as C2.
    pose proof (C 3 ltac:(lia))%nat as C3. pose proof (C 4 ltac:(lia))%nat as C4. pose proof (C 5 ltac:(lia))%nat as C5. clear C.
    assert (P : expands 6 T with_b b_of sol_b base (fun j t => sol_b base (by_b j) t) (fun a t => b_of a) (fun _ => 1)).
    { apply (expands_parameter 6 T with_b b_of sol_b base (fun j t => sol_b base (by_b j) t) (Rabs bc + rb)). intros [[b1 y1] [[B1 B2] Hf1]]. unfold b_of. cbn [proj1_sig fst] in *.
      pose proof (Rabs_triang (b1 - bc) bc) as Q. replace (b1 - bc + bc) with b1 in Q by ring. lra. }
    cbn [by_b] in *. assert (Eb : b_of base = b) by reflexivity.
    intros i Hi. do 6 (destruct i as [|i]; [cbn [fs by_b]; eapply expands_ext; [expand | intros t Ht; cbv beta; rewrite ?Eb; ring]|]). lia.
  - intros [[b1 y1] [[Hb1 Hb2] [Y1 S1]]] i Hi. unfold sol_b, away, b_of. cbn [proj1_sig fst snd base] in *. pose proof F0 as [Y0 _].
    rewrite Y1, !Y0 by (auto; lia). do 6 (destruct i as [|i]; [cbn; ring|]). lia.
  - exists K. split; [assumption|]. intros b' i t Hb' Hi Ht. destruct (solutions b' e Hb') as [y1 [F1 _]].
    destruct (H (exist _ (b', y1) (conj Hb' F1)) i t Hi Ht) as [_ Q]. unfold away, b_of, sol_b in Q. cbn [proj1_sig fst snd base] in Q.
    rewrite (st_is b' e y1), (st_is b e y0 i), (st_is b e y0 (by_b i)); try assumption; auto; lia.
Qed.
End Derivatives.
End Flow.
