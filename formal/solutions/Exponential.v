(* The supersolution of the comparison system that a partial sum of its exponential gives, and the step with it
   (Lemmas 2 and 4.1 and section 4.3 of the chapter verify/flow). *)

From Coq Require Import Reals Lra Lia.
From Coquelicot Require Import Coquelicot.
From Solutions Require Import Comparison Existence Flow.
Local Open Scope R_scope.

Lemma sum_swap n m (g : nat -> nat -> R) : sum n (fun i => sum m (g i)) = sum m (fun j => sum n (fun i => g i j)).
Proof.
  induction n as [|n IH]; cbn [sum]; [rewrite sum_const; ring|]. rewrite sum_plus, IH. reflexivity.
Qed.
Lemma sum_shift n (g : nat -> R) : sum n (fun k => g (S k)) = sum n g - g O + g n.
Proof. induction n as [|n IH]; cbn [sum]; [ring|]. rewrite IH. ring. Qed.
Lemma sum_derive n (g : nat -> R -> R) (dg : nat -> R) t :
  (forall k, (k < n)%nat -> is_derive (g k) t (dg k)) -> is_derive (fun s => sum n (fun k => g k s)) t (sum n dg).
Proof.
  induction n as [|n IH]; intros H; cbn [sum]; [apply (is_derive_const (V := R_NormedModule))|].
  apply (is_derive_plus (V := R_NormedModule) (fun s => sum n (fun k => g k s))); [apply IH; intros; apply H; lia | apply H; lia].
Qed.
Lemma power_derive k c t : is_derive (fun s => s ^ S k / INR (S k) * c) t (t ^ k * c).
Proof.
  assert (P : INR (S k) <> 0) by (apply not_0_INR; lia).
  auto_derive; [exact I|]. change (match k with O => 1 | S _ => INR k + 1 end) with (INR (S k)). set (a := INR (S k)) in *.
  field. assumption.
Qed.

Section Part.
Variables (n : nat) (f : field) (p dp : nat -> R -> R) (T delta rest : nat -> R) (M : nat -> nat -> R) (x0 : point).
Hypothesis f_lipschitz : locally_lipschitz n f.
Hypothesis p_derive : forall i t, (i < n)%nat -> 0 <= t <= 1 -> is_derive (p i) t (dp i t).
Hypothesis delta_nonneg : forall i, (i < n)%nat -> 0 <= delta i.
Hypothesis rest_nonneg : forall i, (i < n)%nat -> 0 <= rest i.
Hypothesis defect : forall i t, (i < n)%nat -> 0 <= t <= 1 -> Rabs (f (fun j => p j t) i - dp i t) <= delta i.
Hypothesis M_nonneg : forall i j, (i < n)%nat -> (j < n)%nat -> 0 <= M i j.
Hypothesis tube : forall x i t, (i < n)%nat -> 0 <= t <= 1 -> (forall j, (j < n)%nat -> Rabs (x j - p j t) <= T j) ->
  Rabs (f x i - f (fun j => p j t) i) <= sum n (fun j => M i j * Rabs (x j - p j t)).
(* Bounds w k of M^k w_0 / k!, the last of which is small beside w_0; V bounds what they sum up to. *)
Variables (N : nat) (w : nat -> nat -> R) (q : R) (V : nat -> R).
Hypothesis q_small : 0 <= q < 1.
Hypothesis w_nonneg : forall k i, (k <= N)%nat -> (i < n)%nat -> 0 <= w k i.
Hypothesis w_start : forall i, (i < n)%nat -> Rabs (x0 i - p i 0) + delta i + rest i <= w O i.
Hypothesis w_next : forall k i, (k < N)%nat -> (i < n)%nat -> sum n (fun j => M i j * w k j) <= INR (S k) * w (S k) i.
Hypothesis w_last : forall i, (i < n)%nat -> w N i <= q * w O i.
Hypothesis V_above : forall i, (i < n)%nat -> sum N (fun k => w k i) <= (1 - q) * V i.
Hypothesis V_below : forall i, (i < n)%nat -> V i <= T i.

Let S_ (i : nat) (s : R) : R := / (1 - q) * sum N (fun k => s ^ k * w k i).
Let Mw (i k : nat) : R := sum n (fun j => M i j * w k j).
Let G (i : nat) (s : R) : R := / (1 - q) * sum N (fun k => s ^ S k / INR (S k) * Mw i k).
Let dG (i : nat) (s : R) : R := / (1 - q) * sum N (fun k => s ^ k * Mw i k).
Let U (i : nat) (s : R) : R := S_ i s - rest i - (1 - s) * delta i.
Let e0 (i : nat) : R := w O i - rest i - delta i.

Let iq_pos : 0 < / (1 - q).
Proof. apply Rinv_0_lt_compat. lra. Qed.
Lemma Mw_nonneg i k : (i < n)%nat -> (k < N)%nat -> 0 <= Mw i k.
Proof. intros Hi Hk. apply sum_nonneg. intros j Hj. apply Rmult_le_pos; [auto | apply w_nonneg; [lia | assumption]]. Qed.
Lemma power_in k s : 0 <= s <= 1 -> 0 <= s ^ k <= 1.
Proof. intros Hs. split; [apply pow_le; lra|]. rewrite <- (pow1 k). apply pow_incr. lra. Qed.

Lemma dG_is i s : (i < n)%nat -> dG i s = sum n (fun j => M i j * S_ j s).
Proof.
  intros Hi. unfold dG, S_, Mw.
  rewrite (sum_ext N _ (fun k => sum n (fun j => s ^ k * (M i j * w k j)))) by (intros; rewrite sum_scal; reflexivity).
  rewrite sum_swap, <- sum_scal. apply sum_ext. intros j Hj.
  rewrite (sum_ext N _ (fun k => M i j * (s ^ k * w k j))) by (intros; ring). rewrite sum_scal. ring.
Qed.
Lemma G_nonneg i s : (i < n)%nat -> 0 <= s <= 1 -> 0 <= G i s.
Proof.
  intros Hi Hs. apply Rmult_le_pos; [lra|]. apply sum_nonneg. intros k Hk. apply Rmult_le_pos; [|apply Mw_nonneg; assumption].
  apply Rdiv_le_0_compat; [apply power_in; assumption | apply lt_0_INR; lia].
Qed.
Lemma S_above i s : (i < n)%nat -> 0 <= s <= 1 -> w O i + G i s <= S_ i s.
Proof.
  intros Hi Hs. unfold G, S_.
  assert (A : sum N (fun k => s ^ S k / INR (S k) * Mw i k) <= sum N (fun k => s ^ S k * w (S k) i)).
  { apply sum_le. intros k Hk. pose proof (w_next k i Hk Hi) as Q. fold (Mw i k) in Q.
    assert (P : 0 < INR (S k)) by (apply lt_0_INR; lia). destruct (power_in (S k) s Hs) as [P1 _].
    unfold Rdiv. rewrite Rmult_assoc. apply Rmult_le_compat_l; [assumption|].
    apply (Rmult_le_reg_l (INR (S k))); [assumption|]. rewrite <- Rmult_assoc, Rinv_r by lra. lra. }
  rewrite (sum_shift N (fun k => s ^ k * w k i)) in A. cbv beta in A.
  replace (s ^ 0 * w O i) with (w O i) in A by (cbn; ring).
  destruct (power_in N s Hs) as [P0 P1]. pose proof (w_nonneg N i (le_n N) Hi). pose proof (w_last i Hi) as E.
  assert (B : s ^ N * w N i <= q * w O i) by nra.
  apply (Rmult_le_reg_l (1 - q)); [lra|]. rewrite Rmult_plus_distr_l, <- !Rmult_assoc, Rinv_r by lra. lra.
Qed.
Lemma S_below i s : (i < n)%nat -> 0 <= s <= 1 -> S_ i s <= V i.
Proof.
  intros Hi Hs. unfold S_. apply (Rmult_le_reg_l (1 - q)); [lra|]. rewrite <- Rmult_assoc, Rinv_r, Rmult_1_l by lra.
  eapply Rle_trans; [|apply V_above; assumption]. apply sum_le. intros k Hk.
  destruct (power_in k s Hs). assert (0 <= w k i) by (apply w_nonneg; [lia | assumption]). nra.
Qed.

Theorem part : exists y : nat -> R -> R,
  (forall i, (i < n)%nat -> y i 0 = x0 i) /\ solves n f 1 y /\
  (forall i t, (i < n)%nat -> 0 <= t <= 1 -> Rabs (y i t - p i t) + rest i <= V i).
Proof.
  assert (He : forall i, (i < n)%nat -> Rabs (x0 i - p i 0) <= e0 i).
  { intros i Hi. unfold e0. pose proof (w_start i Hi). lra. }
  assert (A : forall i t, (i < n)%nat -> 0 <= t <= 1 -> e0 i + delta i * t + G i t <= U i t).
  { intros i t Hi Ht. pose proof (S_above i t Hi Ht). unfold e0, U. lra. }
  assert (P : forall i t, (i < n)%nat -> 0 <= t <= 1 -> 0 <= U i t).
  { intros i t Hi Ht. pose proof (A i t Hi Ht). pose proof (He i Hi). pose proof (Rabs_pos (x0 i - p i 0)).
    pose proof (delta_nonneg i Hi). pose proof (G_nonneg i t Hi Ht). nra. }
  assert (B : forall i t, (i < n)%nat -> 0 <= t <= 1 -> U i t + rest i <= S_ i t).
  { intros i t Hi Ht. unfold U. pose proof (delta_nonneg i Hi). assert (0 <= (1 - t) * delta i) by (apply Rmult_le_pos; lra). lra. }
  assert (BV : forall i t, (i < n)%nat -> 0 <= t <= 1 -> U i t + rest i <= V i).
  { intros i t Hi Ht. pose proof (B i t Hi Ht). pose proof (S_below i t Hi Ht). lra. }
  destruct (step_theorem n f 1 f_lipschitz Rle_0_1 p dp T delta e0 M U G dG x0) as [y [Y0 [Y Q]]]; auto.
  - intros i Hi. pose proof (BV i 0 Hi ltac:(lra)). pose proof (P i 0 Hi ltac:(lra)).
    pose proof (V_below i Hi). pose proof (rest_nonneg i Hi). lra.
  - intros i t Hi Ht. apply (is_derive_scal (fun s => sum N (fun k => s ^ S k / INR (S k) * Mw i k))).
    apply (sum_derive N (fun k s => s ^ S k / INR (S k) * Mw i k)). intros. apply power_derive.
  - intros i t Hi Ht. rewrite dG_is by assumption. apply sum_le. intros j Hj. apply Rmult_le_compat_l; [auto|].
    pose proof (B j t Hj Ht). pose proof (rest_nonneg j Hj). lra.
  - intros i Hi. unfold G. rewrite (sum_ext N _ (fun _ => 0)); [rewrite sum_const; ring|].
    intros k Hk. rewrite pow_i by lia. unfold Rdiv. ring.
  - intros i t Hi Ht. pose proof (BV i t Hi Ht). pose proof (V_below i Hi). pose proof (rest_nonneg i Hi). lra.
  - exists y. split; [assumption|]. split; [assumption|]. intros i t Hi Ht.
    pose proof (Q i t Hi Ht). pose proof (BV i t Hi Ht). lra.
Qed.
End Part.
