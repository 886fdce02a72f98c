(* Inequalities between functions on [0, h] from inequalities between their derivatives. *)

From Coq Require Import Reals Lra Lia ZArith.
From Coquelicot Require Import Coquelicot.
Local Open Scope R_scope.

Fixpoint sum (n : nat) (g : nat -> R) : R := match n with O => 0 | S k => sum k g + g k end.

Lemma sum_le n g k : (forall j, (j < n)%nat -> g j <= k j) -> sum n g <= sum n k.
Proof.
  induction n as [|n IH]; intros H; cbn; [lra|].
  apply Rplus_le_compat; [apply IH; intros; apply H; lia | apply H; lia].
Qed.
Lemma sum_ext n g k : (forall j, (j < n)%nat -> g j = k j) -> sum n g = sum n k.
Proof. intros H. apply Rle_antisym; apply sum_le; intros j Hj; rewrite (H j Hj); lra. Qed.
Lemma sum_const n c : sum n (fun _ => c) = INR n * c.
Proof. induction n as [|n IH]; cbn [sum]; [cbn; lra|]. rewrite IH, S_INR. lra. Qed.
Lemma sum_scal n c g : sum n (fun j => c * g j) = c * sum n g.
Proof. induction n as [|n IH]; cbn; [lra|]. rewrite IH. lra. Qed.
Lemma sum_plus n g k : sum n (fun j => g j + k j) = sum n g + sum n k.
Proof. induction n as [|n IH]; cbn; [lra|]. rewrite IH. lra. Qed.
Lemma sum_nonneg n g : (forall j, (j < n)%nat -> 0 <= g j) -> 0 <= sum n g.
Proof. intros H. rewrite <- (Rmult_0_r (INR n)), <- (sum_const n 0). apply sum_le. assumption. Qed.
Lemma term_le_sum n g i : (forall j, (j < n)%nat -> 0 <= g j) -> (i < n)%nat -> g i <= sum n g.
Proof.
  induction n as [|n IH]; intros H Hi; [lia|]. cbn.
  assert (0 <= sum n g) by (apply sum_nonneg; intros; apply H; lia). assert (0 <= g n) by (apply H; lia).
  destruct (Nat.eq_dec i n) as [->|Hne]; [lra|]. assert (g i <= sum n g) by (apply IH; [intros; apply H; lia | lia]). lra.
Qed.
Lemma abs_sum n g : Rabs (sum n g) <= sum n (fun j => Rabs (g j)).
Proof.
  induction n as [|n IH]; cbn; [rewrite Rabs_R0; lra|]. eapply Rle_trans; [apply Rabs_triang|]. lra.
Qed.

(* Something below C / 2^k for all k is not positive. *)
Lemma two_pow_grows k : INR k < 2 ^ k.
Proof. induction k as [|k IH]; [cbn; lra|]. rewrite S_INR. cbn [pow]. assert (1 <= 2 ^ k) by (apply pow_R1_Rle; lra). lra. Qed.
Lemma halved_for_ever a C : (forall k, a <= C / 2 ^ k) -> a <= 0.
Proof.
  intros H. destruct (Rle_lt_dec a 0) as [|Ha]; [assumption|].
  assert (HC : 0 < C) by (specialize (H O); cbn in H; lra).
  destruct (archimed (C / a)) as [Hup _]. set (z := up (C / a)) in *.
  assert (0 < C / a) by (apply Rdiv_lt_0_compat; lra).
  assert (Hz : (0 <= z)%Z) by (apply le_IZR; lra).
  specialize (H (Z.to_nat z)). pose proof (two_pow_grows (Z.to_nat z)) as G.
  rewrite INR_IZR_INZ, Z2Nat.id in G by assumption.
  assert (P : C / a < 2 ^ Z.to_nat z) by lra.
  assert (Hp : 0 < 2 ^ Z.to_nat z) by lra.
  apply (Rmult_lt_compat_r a) in P; [|assumption]. unfold Rdiv in P. rewrite Rmult_assoc, Rinv_l, Rmult_1_r in P by lra.
  apply (Rmult_le_compat_r (2 ^ Z.to_nat z)) in H; [|lra]. unfold Rdiv in H. rewrite Rmult_assoc, Rinv_l in H by lra. lra.
Qed.

Lemma grows (f df : R -> R) (h : R) :
  (forall t, 0 <= t <= h -> is_derive f t (df t)) -> (forall t, 0 <= t <= h -> 0 <= df t) ->
  forall t, 0 <= t <= h -> f 0 <= f t.
Proof.
  intros D P t Ht.
  destruct (MVT_gen f 0 t df) as [c [Hc E]].
  - intros x Hx. rewrite Rmin_left, Rmax_right in Hx by lra. apply D. lra.
  - intros x Hx. rewrite Rmin_left, Rmax_right in Hx by lra.
    apply continuity_pt_filterlim. apply (ex_derive_continuous f x). exists (df x). apply D. lra.
  - rewrite Rmin_left, Rmax_right in Hc by lra. assert (0 <= df c) by (apply P; lra). nra.
Qed.

Lemma dominated (f df g dg : R -> R) (h : R) :
  (forall t, 0 <= t <= h -> is_derive f t (df t)) -> (forall t, 0 <= t <= h -> is_derive g t (dg t)) ->
  (forall t, 0 <= t <= h -> Rabs (df t) <= dg t) ->
  forall t, 0 <= t <= h -> Rabs (f t - f 0) <= g t - g 0.
Proof.
  intros Df Dg B t Ht.
  assert (A : g 0 - f 0 <= g t - f t).
  { apply (grows (fun s => g s - f s) (fun s => dg s - df s) h); [| |assumption].
    - intros s Hs. apply (is_derive_minus (V := R_NormedModule) g f); auto.
    - intros s Hs. specialize (B s Hs). apply Rabs_le_between in B. lra. }
  assert (A' : g 0 + f 0 <= g t + f t).
  { apply (grows (fun s => g s + f s) (fun s => dg s + df s) h); [| |assumption].
    - intros s Hs. apply (is_derive_plus (V := R_NormedModule) g f); auto.
    - intros s Hs. specialize (B s Hs). apply Rabs_le_between in B. lra. }
  apply Rabs_le. lra.
Qed.

(* c e^(K t) *)
Definition weight (K t : R) : R := exp (K * t).
Lemma weight_pos K t : 0 < weight K t.
Proof. apply exp_pos. Qed.
Lemma weight_0 K : weight K 0 = 1.
Proof. unfold weight. rewrite Rmult_0_r. apply exp_0. Qed.
Lemma weight_derive K t : is_derive (weight K) t (K * weight K t).
Proof. unfold weight. auto_derive; [exact I|]. ring. Qed.
Lemma weight_le K h t : 0 <= K -> 0 <= t <= h -> weight K t <= weight K h.
Proof.
  intros HK Ht. unfold weight. destruct (Rle_lt_or_eq_dec (K * t) (K * h)) as [H|H]; [nra| |rewrite H; lra].
  left. apply exp_increasing. assumption.
Qed.

Section Comparison.
(* The error e of n components, the matrix M of the comparison system, and a supersolution U of it. *)
Variables (n : nat) (h : R) (M : nat -> nat -> R) (e de U G dG : nat -> R -> R) (delta e0 : nat -> R) (C : R).
Hypothesis M_nonneg : forall i j, (i < n)%nat -> (j < n)%nat -> 0 <= M i j.
Hypothesis e_derive : forall i t, (i < n)%nat -> 0 <= t <= h -> is_derive (e i) t (de i t).
Hypothesis e_bounded : forall i t, (i < n)%nat -> 0 <= t <= h -> Rabs (e i t) <= C.
Hypothesis e_slope : forall i t, (i < n)%nat -> 0 <= t <= h ->
  Rabs (de i t) <= delta i + sum n (fun j => M i j * Rabs (e j t)).
Hypothesis e_start : forall i, (i < n)%nat -> Rabs (e i 0) <= e0 i.
Hypothesis G_derive : forall i t, (i < n)%nat -> 0 <= t <= h -> is_derive (G i) t (dG i t).
Hypothesis G_slope : forall i t, (i < n)%nat -> 0 <= t <= h -> sum n (fun j => M i j * U j t) <= dG i t.
Hypothesis G_start : forall i, (i < n)%nat -> G i 0 = 0.
Hypothesis U_nonneg : forall i t, (i < n)%nat -> 0 <= t <= h -> 0 <= U i t.
Hypothesis U_above : forall i t, (i < n)%nat -> 0 <= t <= h -> e0 i + delta i * t + G i t <= U i t.

Let K : R := 2 * sum n (fun i => sum n (M i)) + 1.

Lemma K_pos : 0 < K.
Proof.
  unfold K. assert (0 <= sum n (fun i => sum n (M i))); [|lra].
  apply sum_nonneg. intros. apply sum_nonneg. intros. auto.
Qed.
Lemma row_sum i : (i < n)%nat -> 2 * sum n (M i) <= K.
Proof.
  intros Hi. unfold K.
  assert (sum n (M i) <= sum n (fun i => sum n (M i))); [|lra].
  apply (term_le_sum n (fun i => sum n (M i)) i); [|assumption]. intros. apply sum_nonneg. auto.
Qed.

Lemma halved c : 0 <= c ->
  (forall i t, (i < n)%nat -> 0 <= t <= h -> Rabs (e i t) - U i t <= c * weight K t) ->
  forall i t, (i < n)%nat -> 0 <= t <= h -> Rabs (e i t) - U i t <= c / 2 * weight K t.
Proof.
  intros Hc H i t Hi Ht.
  assert (D : Rabs (e i t - e i 0) <=
    (delta i * t + G i t + c / 2 * weight K t) - (delta i * 0 + G i 0 + c / 2 * weight K 0)).
  { apply (dominated (e i) (de i) (fun s => delta i * s + G i s + c / 2 * weight K s)
      (fun s => delta i * 1 + dG i s + c / 2 * (K * weight K s)) h); [auto| | |assumption].
    - intros s Hs. apply (is_derive_plus (V := R_NormedModule) (fun s => delta i * s + G i s)).
      + apply (is_derive_plus (V := R_NormedModule) (fun s => delta i * s)); [|auto].
        apply (is_derive_scal (fun s => s)). apply (is_derive_id (K := R_AbsRing)).
      + apply (is_derive_scal (weight K)). apply weight_derive.
    - intros s Hs. eapply Rle_trans; [apply e_slope; assumption|].
      pose proof (G_slope i s Hi Hs) as S1. pose proof (row_sum i Hi) as S2. pose proof (weight_pos K s) as W.
      assert (S3 : sum n (fun j => M i j * Rabs (e j s)) <= sum n (fun j => M i j * U j s + c * weight K s * M i j)).
      { apply sum_le. intros j Hj. specialize (H j s Hj Hs). pose proof (M_nonneg i j Hi Hj). nra. }
      rewrite sum_plus, sum_scal in S3.
      assert (c * weight K s * sum n (M i) <= c / 2 * (K * weight K s)).
      { replace (c / 2 * (K * weight K s)) with (c * weight K s * (K / 2)) by field.
        apply Rmult_le_compat_l; [nra | lra]. }
      lra. }
  rewrite (G_start i Hi), weight_0 in D. pose proof (U_above i t Hi Ht). pose proof (e_start i Hi).
  pose proof (Rabs_triang_inv (e i t) (e i 0)). lra.
Qed.

Theorem comparison i t : (i < n)%nat -> 0 <= t <= h -> Rabs (e i t) <= U i t.
Proof.
  intros Hi Ht. pose proof K_pos as HK.
  assert (HC : 0 <= C) by (eapply Rle_trans; [apply Rabs_pos | apply (e_bounded i t Hi Ht)]).
  assert (A : forall k, forall i t, (i < n)%nat -> 0 <= t <= h -> Rabs (e i t) - U i t <= C / 2 ^ k * weight K t).
  { induction k as [|k IH].
    - intros i' t' Hi' Ht'. pose proof (e_bounded i' t' Hi' Ht'). pose proof (U_nonneg i' t' Hi' Ht').
      assert (1 <= weight K t') by (rewrite <- (weight_0 K); apply weight_le; lra). cbn [pow].
      replace (C / 1) with C by field. nra.
    - intros i' t' Hi' Ht'. replace (C / 2 ^ S k) with (C / 2 ^ k / 2).
      + apply halved; try assumption. apply Rdiv_le_0_compat; [assumption | apply pow_lt; lra].
      + cbn [pow]. field. apply pow_nonzero. lra. }
  assert (Rabs (e i t) - U i t <= 0); [|lra].
  apply (halved_for_ever _ (C * weight K t)). intros k. specialize (A k i t Hi Ht).
  replace (C * weight K t / 2 ^ k) with (C / 2 ^ k * weight K t); [assumption|]. field. apply pow_nonzero. lra.
Qed.
End Comparison.
