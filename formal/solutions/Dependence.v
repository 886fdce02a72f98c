(* How solutions depend on a parameter: a solution of the equations for the derivative is the derivative, with a bound of the
   rest that is quadratic. No derivative of the field is used, only an expansion of it along the solutions. *)

From Coq Require Import Reals Lra Lia.
From Coquelicot Require Import Coquelicot.
From Solutions Require Import Comparison Existence Flow.
Local Open Scope R_scope.

(* What has such a bound is a derivative. *)
Lemma quadratic_rest f p l K r : 0 < r -> (forall q, Rabs (q - p) <= r -> Rabs (f q - f p - (q - p) * l) <= K * (q - p) ^ 2) -> is_derive f p l.
Proof.
  intros Hr H. apply is_derive_Reals. intros eps He.
  assert (HK : 0 <= K).
  { specialize (H (p + r) ltac:(replace (p + r - p) with r by ring; rewrite Rabs_pos_eq; lra)). replace (p + r - p) with r in H by ring.
    pose proof (Rabs_pos (f (p + r) - f p - r * l)). assert (0 < r ^ 2) by nra. nra. }
  assert (P : 0 < Rmin r (eps / (K + 1))) by (apply Rmin_pos; [assumption | apply Rdiv_lt_0_compat; lra]).
  exists (mkposreal _ P). intros s Hs Hd. cbn in Hd. pose proof (Rmin_l r (eps / (K + 1))). pose proof (Rmin_r r (eps / (K + 1))).
  specialize (H (p + s)). replace (p + s - p) with s in H by ring. specialize (H ltac:(lra)).
  replace ((f (p + s) - f p) / s - l) with ((f (p + s) - f p - s * l) / s) by (field; assumption).
  unfold Rdiv. rewrite Rabs_mult, Rabs_inv. assert (Q : 0 < Rabs s) by (apply Rabs_pos_lt; assumption).
  apply (Rmult_lt_reg_r (Rabs s)); [assumption|]. rewrite Rmult_assoc, Rinv_l, Rmult_1_r by lra.
  rewrite <- (pow2_abs s) in H. eapply Rle_lt_trans; [exact H|].
  assert (X : Rabs s < eps / (K + 1)) by lra. apply (Rmult_lt_compat_r (K + 1)) in X; [|lra].
  unfold Rdiv in X. rewrite Rmult_assoc, Rinv_l in X by lra. replace (K * Rabs s ^ 2) with (K * Rabs s * Rabs s) by ring.
  apply Rmult_lt_compat_r; [assumption|]. nra.
Qed.

(* Errors whose derivatives are at most L times their sum and d are at most a multiple of d. *)
Section Growth.
Variables (n : nat) (h L : R).
Hypothesis L_nonneg : 0 <= L.
Let k : R := INR n * L + L + 1.
Definition growth : R := weight k h.
Lemma k_pos : 0 < k.
Proof. unfold k. pose proof (pos_INR n). nra. Qed.
Lemma growth_pos : 0 < growth.
Proof. apply weight_pos. Qed.

Lemma grown_at_most (e de : nat -> R -> R) C d : 0 <= d ->
  (forall i t, (i < n)%nat -> 0 <= t <= h -> is_derive (e i) t (de i t)) ->
  (forall i t, (i < n)%nat -> 0 <= t <= h -> Rabs (e i t) <= C) ->
  (forall i t, (i < n)%nat -> 0 <= t <= h -> Rabs (de i t) <= L * (sum n (fun j => Rabs (e j t)) + d)) ->
  (forall i, (i < n)%nat -> Rabs (e i 0) <= d) ->
  forall i t, (i < n)%nat -> 0 <= t <= h -> Rabs (e i t) <= growth * d.
Proof.
  intros Hd De Be Se E0 i t Hi Ht. pose proof k_pos as Hk. pose proof (pos_INR n) as Hn.
  assert (Nk : INR n * L = k - (L + 1)) by (unfold k; ring).
  apply Rle_trans with (d * weight k t).
  - apply (comparison n h (fun _ _ => L) e de (fun _ t => d * weight k t) (fun _ t => INR n * L * d / k * (weight k t - 1))
      (fun _ t => INR n * L * d / k * (k * weight k t)) (fun _ => L * d) (fun _ => d) C); auto; clear i t Hi Ht.
    + intros i t Hi Ht. eapply Rle_trans; [apply Se; assumption|]. rewrite sum_scal. right. ring.
    + intros i t Hi Ht. apply (is_derive_scal (fun t => weight k t - 1)). replace (k * weight k t) with (k * weight k t - 0) by ring.
      apply (is_derive_minus (V := R_NormedModule) (weight k) (fun _ => 1)); [apply weight_derive | apply (is_derive_const (V := R_NormedModule))].
    + intros i t Hi Ht. rewrite sum_scal, sum_const. right. field. lra.
    + intros i Hi. rewrite weight_0. ring.
    + intros i t Hi Ht. pose proof (weight_pos k t). nra.
    + intros i t Hi Ht. assert (W : 1 + k * t <= weight k t) by (unfold weight; apply exp_ineq1_le).
      replace (INR n * L * d / k * (weight k t - 1)) with (d * (weight k t - 1) - d * (L + 1) * ((weight k t - 1) / k)) by (rewrite Nk; field; lra).
      assert (t <= (weight k t - 1) / k) by (apply (Rmult_le_reg_l k); [assumption|]; replace (k * ((weight k t - 1) / k)) with (weight k t - 1) by (field; lra); lra).
      assert (0 <= d * (L + 1)) by nra. nra.
  - unfold growth. rewrite Rmult_comm. apply Rmult_le_compat_r; [assumption|]. apply weight_le; lra.
Qed.
End Growth.

(* Bounds for all places below n at once. *)
Lemma at_once n (P : nat -> R -> Prop) : (forall i K K', P i K -> K <= K' -> P i K') ->
  (forall i, (i < n)%nat -> exists K, 0 <= K /\ P i K) -> exists K, 0 <= K /\ forall i, (i < n)%nat -> P i K.
Proof.
  intros M. induction n as [|n IH]; intros H; [exists 0; split; [lra | intros; lia]|].
  destruct IH as [K [HK P1]]; [intros; apply H; lia|]. destruct (H n) as [K' [HK' P2]]; [lia|].
  exists (K + K'). split; [lra|]. intros i Hi. destruct (Nat.eq_dec i n) as [->|Hne]; [apply (M _ K'); [assumption | lra]|].
  apply (M _ K); [apply P1; lia | lra].
Qed.

(* Functions y, one for each index, and a parameter for each index; around one of them. *)
Section Dependence.
Variables (n : nat) (h : R) (I : Type) (parameter : I -> R) (y dy : I -> nat -> R -> R) (base : I) (v dv : nat -> R -> R).
Notation p0 := (parameter base).
Notation time t := (0 <= t <= h).
Definition away (a : I) : R := parameter a - p0.
Definition apart (a : I) (t : R) : R := sum n (fun j => Rabs (y a j t - y base j t)) + Rabs (away a).
Definition rest (a : I) (t : R) : R := sum n (fun j => Rabs (y a j t - y base j t - away a * v j t)).

(* q is q at the base, and the distance of the parameter times dq, and something quadratic. *)
Definition expands (q : I -> R -> R) (dq : R -> R) : Prop := exists K, 0 <= K /\ forall a t, time t ->
  Rabs (q a t) <= K /\ Rabs (dq t) <= K /\ Rabs (q a t - q base t) <= K * apart a t /\
  Rabs (q a t - q base t - away a * dq t) <= K * (rest a t + apart a t ^ 2).

Lemma apart_nonneg a t : 0 <= apart a t.
Proof. unfold apart. assert (0 <= sum n (fun j => Rabs (y a j t - y base j t))) by (apply sum_nonneg; intros; apply Rabs_pos). pose proof (Rabs_pos (away a)). lra. Qed.
Lemma rest_nonneg a t : 0 <= rest a t.
Proof. apply sum_nonneg. intros. apply Rabs_pos. Qed.
Lemma quadratic_nonneg a t : 0 <= rest a t + apart a t ^ 2.
Proof. pose proof (rest_nonneg a t). pose proof (pow2_ge_0 (apart a t)). lra. Qed.

Lemma expands_const c : expands (fun _ _ => c) (fun _ => 0).
Proof.
  exists (Rabs c). split; [apply Rabs_pos|]. intros a t Ht. pose proof (Rabs_pos c). pose proof (apart_nonneg a t). pose proof (quadratic_nonneg a t).
  replace (c - c - away a * 0) with 0 by ring. rewrite Rminus_eq_0, Rabs_R0. repeat split; try lra; apply Rmult_le_pos; assumption.
Qed.
Lemma expands_parameter r : (forall a, Rabs (parameter a) <= r) -> expands (fun a _ => parameter a) (fun _ => 1).
Proof.
  intros Hr. exists (r + 1). assert (0 <= r) by (eapply Rle_trans; [apply Rabs_pos | apply (Hr base)]). split; [lra|].
  intros a t Ht. specialize (Hr a). pose proof (apart_nonneg a t). pose proof (quadratic_nonneg a t).
  replace (parameter a - p0 - away a * 1) with 0 by (unfold away; ring). rewrite Rabs_R0, Rabs_R1. repeat split; try lra; [|nra].
  change (Rabs (away a) <= (r + 1) * apart a t).
  assert (Rabs (away a) <= apart a t).
  { unfold apart. assert (0 <= sum n (fun j => Rabs (y a j t - y base j t))) by (apply sum_nonneg; intros; apply Rabs_pos). lra. }
  nra.
Qed.
Lemma expands_component r j : (j < n)%nat -> (forall a t, time t -> Rabs (y a j t) <= r /\ Rabs (v j t) <= r) -> expands (fun a t => y a j t) (v j).
Proof.
  intros Hj Hr. exists (Rabs r + 1). pose proof (Rabs_pos r). pose proof (Rle_abs r). split; [lra|].
  intros a t Ht. destruct (Hr a t Ht) as [H1 H2]. split; [lra|]. split; [lra|]. split.
  - assert (Rabs (y a j t - y base j t) <= apart a t).
    { unfold apart. pose proof (term_le_sum n (fun j => Rabs (y a j t - y base j t)) j (fun _ _ => Rabs_pos _) Hj) as Q. cbv beta in Q. pose proof (Rabs_pos (away a)). lra. }
    pose proof (apart_nonneg a t). nra.
  - pose proof (term_le_sum n (fun j => Rabs (y a j t - y base j t - away a * v j t)) j (fun _ _ => Rabs_pos _) Hj) as Q. cbv beta in Q. fold (rest a t) in Q.
    pose proof (pow2_ge_0 (apart a t)). pose proof (quadratic_nonneg a t). nra.
Qed.
Lemma expands_ext q dq dq' : expands q dq -> (forall t, time t -> dq t = dq' t) -> expands q dq'.
Proof. intros [K [HK H]] E. exists K. split; [assumption|]. intros a t Ht. rewrite <- (E t Ht). auto. Qed.
Lemma expands_plus q r dq dr : expands q dq -> expands r dr -> expands (fun a t => q a t + r a t) (fun t => dq t + dr t).
Proof.
  intros [K [HK H]] [L [HL H']]. exists (K + L). split; [lra|]. intros a t Ht.
  destruct (H a t Ht) as [A1 [A2 [A3 A4]]]. destruct (H' a t Ht) as [B1 [B2 [B3 B4]]].
  apply Rabs_le_between in A1, A2, A3, A4, B1, B2, B3, B4. split; [|split; [|split]]; apply Rabs_le; lra.
Qed.
Lemma expands_minus q r dq dr : expands q dq -> expands r dr -> expands (fun a t => q a t - r a t) (fun t => dq t - dr t).
Proof.
  intros [K [HK H]] [L [HL H']]. exists (K + L). split; [lra|]. intros a t Ht.
  destruct (H a t Ht) as [A1 [A2 [A3 A4]]]. destruct (H' a t Ht) as [B1 [B2 [B3 B4]]].
  apply Rabs_le_between in A1, A2, A3, A4, B1, B2, B3, B4. split; [|split; [|split]]; apply Rabs_le; lra.
Qed.
Lemma expands_mult q r dq dr : expands q dq -> expands r dr -> expands (fun a t => q a t * r a t) (fun t => dq t * r base t + q base t * dr t).
Proof.
  intros [K [HK H]] [L [HL H']]. exists (3 * (K * L)). assert (KL : 0 <= K * L) by (apply Rmult_le_pos; assumption). split; [lra|]. intros a t Ht.
  destruct (H a t Ht) as [A1 [A2 [A3 A4]]]. destruct (H' a t Ht) as [B1 [B2 [B3 B4]]].
  destruct (H base t Ht) as [A0 _]. destruct (H' base t Ht) as [B0 _]. pose proof (apart_nonneg a t) as D0. pose proof (quadratic_nonneg a t) as Q0.
  pose proof (rest_nonneg a t) as R0.
  set (q1 := q a t) in *. set (q0 := q base t) in *. set (r1 := r a t) in *. set (r0 := r base t) in *. set (D := apart a t) in *. set (X := rest a t + D ^ 2) in *.
  assert (M : forall x z Kx Kz, Rabs x <= Kx -> Rabs z <= Kz -> Rabs (x * z) <= Kx * Kz).
  { intros. rewrite Rabs_mult. apply Rmult_le_compat; try apply Rabs_pos; assumption. }
  split; [|split; [|split]].
  - eapply Rle_trans; [apply (M _ _ K L); assumption|]. lra.
  - eapply Rle_trans; [apply Rabs_triang|]. pose proof (M _ _ K L A2 B0). pose proof (M _ _ K L A0 B2). lra.
  - replace (q1 * r1 - q0 * r0) with ((q1 - q0) * r1 + q0 * (r1 - r0)) by ring. eapply Rle_trans; [apply Rabs_triang|].
    pose proof (M _ _ (K * D) L A3 B1). pose proof (M _ _ K (L * D) A0 B3). assert (0 <= K * L * D) by (apply Rmult_le_pos; assumption). lra.
  - replace (q1 * r1 - q0 * r0 - away a * (dq t * r0 + q0 * dr t))
      with ((q1 - q0) * (r1 - r0) + (q1 - q0 - away a * dq t) * r0 + q0 * (r1 - r0 - away a * dr t)) by ring.
    eapply Rle_trans; [apply Rabs_triang|]. pose proof (Rabs_triang ((q1 - q0) * (r1 - r0)) ((q1 - q0 - away a * dq t) * r0)) as T.
    pose proof (M _ _ (K * D) (L * D) A3 B3). pose proof (M _ _ (K * X) L A4 B0). pose proof (M _ _ K (L * X) A0 B4).
    assert (K * L * D ^ 2 <= K * L * X) by (apply Rmult_le_compat_l; [assumption | unfold X; lra]). lra.
Qed.

Hypothesis y_derive : forall a i t, (i < n)%nat -> time t -> is_derive (y a i) t (dy a i t).
Hypothesis v_derive : forall i t, (i < n)%nat -> time t -> is_derive (v i) t (dv i t).
Hypothesis bounded : exists r, 0 <= r /\ forall a i t, (i < n)%nat -> time t -> Rabs (y a i t) <= r /\ Rabs (v i t) <= r.
Hypothesis parameters_bounded : exists r, forall a, Rabs (away a) <= r.
Hypothesis slopes_expand : forall i, (i < n)%nat -> expands (fun a t => dy a i t) (dv i).
Hypothesis start : forall a i, (i < n)%nat -> y a i 0 - y base i 0 = away a * v i 0.

Theorem depends : exists K, 0 <= K /\ forall a i t, (i < n)%nat -> time t ->
  Rabs (y a i t - y base i t) <= K * Rabs (away a) /\ Rabs (y a i t - y base i t - away a * v i t) <= K * away a ^ 2.
Proof.
  destruct (Rle_lt_dec 0 h) as [Hh|Hh]; [|exists 0; split; [lra | intros; lra]].
  destruct bounded as [r [Hr Br]]. destruct parameters_bounded as [rho Hrho].
  destruct (at_once n (fun i K => forall a t, time t -> Rabs (dy a i t - dy base i t) <= K * apart a t /\
    Rabs (dy a i t - dy base i t - away a * dv i t) <= K * (rest a t + apart a t ^ 2))) as [L [HL S]].
  { intros i K K' H L a t Ht. destruct (H a t Ht) as [H1 H2]. pose proof (apart_nonneg a t). pose proof (quadratic_nonneg a t). split; nra. }
  { intros i Hi. destruct (slopes_expand i Hi) as [K [HK H]]. exists K. split; [assumption|]. intros a t Ht. destruct (H a t Ht) as [_ [_ H']]. exact H'. }
  pose proof (growth_pos n h L) as Wp. set (W := growth n h L) in *.
  set (K1 := W * (1 + r)). set (K2 := INR n * K1 + 1). pose proof (pos_INR n) as Hn.
  assert (HK1 : 0 <= K1) by (unfold K1; nra).
  assert (A : forall a i t, (i < n)%nat -> time t -> Rabs (y a i t - y base i t) <= K1 * Rabs (away a)).
  { intros a i t Hi Ht. unfold K1. rewrite Rmult_assoc. pose proof (Rabs_pos (away a)) as P.
    apply (grown_at_most n h L HL (fun i t => y a i t - y base i t) (fun i t => dy a i t - dy base i t) (2 * r)); try assumption.
    - apply Rmult_le_pos; lra.
    - intros j s Hj Hs. apply (is_derive_minus (V := R_NormedModule) (y a j)); apply y_derive; assumption.
    - intros j s Hj Hs. destruct (Br a j s Hj Hs) as [B1 _]. destruct (Br base j s Hj Hs) as [B2 _].
      apply Rabs_le_between in B1, B2. apply Rabs_le. lra.
    - intros j s Hj Hs. destruct (S j Hj a s Hs) as [S1 _]. eapply Rle_trans; [exact S1|]. apply Rmult_le_compat_l; [assumption|].
      unfold apart. apply Rplus_le_compat_l. nra.
    - intros j Hj. rewrite (start a j Hj), Rabs_mult. destruct (Br a j 0 Hj ltac:(lra)) as [_ B1]. nra. }
  assert (B : forall a t, time t -> apart a t <= K2 * Rabs (away a)).
  { intros a t Ht. unfold apart, K2. assert (X : sum n (fun j => Rabs (y a j t - y base j t)) <= INR n * (K1 * Rabs (away a))).
    { rewrite <- sum_const. apply sum_le. intros j Hj. apply A; assumption. } lra. }
  assert (HK2 : 0 <= K2) by (unfold K2; nra).
  exists (K1 + W * K2 ^ 2). assert (0 <= W * K2 ^ 2) by (apply Rmult_le_pos; [lra | apply pow2_ge_0]). split; [lra|].
  intros a i t Hi Ht. split.
  - specialize (A a i t Hi Ht). pose proof (Rabs_pos (away a)). nra.
  - apply Rle_trans with (W * (K2 ^ 2 * away a ^ 2)).
    2:{ pose proof (pow2_ge_0 (away a)). nra. }
    apply (grown_at_most n h L HL (fun i t => y a i t - y base i t - away a * v i t) (fun i t => dy a i t - dy base i t - away a * dv i t) (2 * r + rho * r)); try assumption.
    + apply Rmult_le_pos; apply pow2_ge_0.
    + intros j s Hj Hs. apply (is_derive_minus (V := R_NormedModule) (fun t => y a j t - y base j t)).
      * apply (is_derive_minus (V := R_NormedModule) (y a j)); apply y_derive; assumption.
      * apply (is_derive_scal (v j)). apply v_derive; assumption.
    + intros j s Hj Hs. destruct (Br a j s Hj Hs) as [B1 B3]. destruct (Br base j s Hj Hs) as [B2 _]. specialize (Hrho a).
      assert (X : Rabs (away a * v j s) <= rho * r) by (rewrite Rabs_mult; apply Rmult_le_compat; try apply Rabs_pos; assumption).
      apply Rabs_le_between in B1, B2, X. apply Rabs_le. lra.
    + intros j s Hj Hs. destruct (S j Hj a s Hs) as [_ S2]. eapply Rle_trans; [exact S2|]. apply Rmult_le_compat_l; [assumption|].
      apply Rplus_le_compat_l. rewrite <- (pow2_abs (away a)), <- Rpow_mult_distr. apply pow_incr. split; [apply apart_nonneg | apply B; assumption].
    + intros j Hj. rewrite (start a j Hj). rewrite Rminus_eq_0, Rabs_R0. apply Rmult_le_pos; apply pow2_ge_0.
Qed.
End Dependence.

(* In time. *)
Lemma solution_in_time n f h y : locally_lipschitz n f -> 0 <= h -> solves n f h y ->
  exists K, 0 <= K /\ forall i s t, (i < n)%nat -> 0 <= s <= h -> 0 <= t <= h ->
    Rabs (y i t) <= K /\ Rabs (f (fun j => y j t) i) <= K /\ Rabs (y i t - y i s) <= K * Rabs (t - s) /\
    Rabs (y i t - y i s - (t - s) * f (fun j => y j s) i) <= K * (t - s) ^ 2.
Proof.
  intros Lip Hh S. destruct (bounded_on h n y _ Hh S) as [r [Hr Br]]. destruct (Lip r) as [L [HL H]].
  assert (F0 : exists M, 0 <= M /\ forall i, (i < n)%nat -> Rabs (f (fun _ => 0) i) <= M).
  { apply (at_once n (fun i M => Rabs (f (fun _ => 0) i) <= M)); [intros; lra|]. intros i Hi. exists (Rabs (f (fun _ => 0) i)). split; [apply Rabs_pos | lra]. }
  destruct F0 as [M [HM F0]]. set (V := M + L * (INR n * r)). pose proof (pos_INR n) as Hn.
  assert (HV : 0 <= L * (INR n * r)) by (apply Rmult_le_pos; [assumption | nra]).
  assert (A : forall i t, (i < n)%nat -> 0 <= t <= h -> Rabs (f (fun j => y j t) i) <= V).
  { intros i t Hi Ht. assert (D : Rabs (f (fun j => y j t) i - f (fun _ => 0) i) <= L * (INR n * r)).
    { eapply Rle_trans; [apply H; auto; intros; rewrite Rabs_R0; assumption|]. apply Rmult_le_compat_l; [assumption|].
      rewrite <- sum_const. apply sum_le. intros j Hj. rewrite Rminus_0_r. auto. }
    specialize (F0 i Hi). apply Rabs_le_between in D, F0. unfold V. apply Rabs_le. lra. }
  assert (B : forall i s t, (i < n)%nat -> 0 <= s <= h -> 0 <= t <= h -> exists u, Rmin s t <= u <= Rmax s t /\ y i t - y i s = f (fun j => y j u) i * (t - s)).
  { intros i s t Hi Hs Ht. destruct (MVT_gen (y i) s t (fun t => f (fun j => y j t) i)) as [u [Hu E]]; [| |exists u; auto].
    - intros u Hu. apply S; [assumption|]. unfold Rmin, Rmax in Hu. destruct Rle_dec in Hu; lra.
    - intros u Hu. apply continuity_pt_filterlim, (ex_derive_continuous (y i)). eexists. apply S; [assumption|]. unfold Rmin, Rmax in Hu. destruct Rle_dec in Hu; lra. }
  assert (C : forall i s t, (i < n)%nat -> 0 <= s <= h -> 0 <= t <= h -> Rabs (y i t - y i s) <= V * Rabs (t - s)).
  { intros i s t Hi Hs Ht. destruct (B i s t Hi Hs Ht) as [u [Hu E]]. rewrite E, Rabs_mult. apply Rmult_le_compat_r; [apply Rabs_pos|].
    apply A; [assumption|]. unfold Rmin, Rmax in Hu. destruct Rle_dec in Hu; lra. }
  set (Q := L * (INR n * V)). assert (HVn : 0 <= INR n * V) by (apply Rmult_le_pos; unfold V; lra).
  assert (HQ : 0 <= Q) by (unfold Q; apply Rmult_le_pos; assumption).
  exists (r + V + Q). split; [unfold V; lra|]. intros i s t Hi Hs Ht. split; [|split; [|split]].
  - specialize (Br i t Hi Ht). unfold V. lra.
  - specialize (A i t Hi Ht). lra.
  - specialize (C i s t Hi Hs Ht). pose proof (Rabs_pos (t - s)). nra.
  - destruct (B i s t Hi Hs Ht) as [u [Hu E]]. rewrite E.
    assert (Hu' : 0 <= u <= h) by (unfold Rmin, Rmax in Hu; destruct Rle_dec in Hu; lra).
    assert (Us : Rabs (u - s) <= Rabs (t - s)).
    { unfold Rmin, Rmax in Hu. destruct Rle_dec in Hu; unfold Rabs; repeat destruct Rcase_abs; lra. }
    replace (f (fun j => y j u) i * (t - s) - (t - s) * f (fun j => y j s) i) with ((f (fun j => y j u) i - f (fun j => y j s) i) * (t - s)) by ring.
    rewrite Rabs_mult. assert (X : Rabs (f (fun j => y j u) i - f (fun j => y j s) i) <= Q * Rabs (t - s)).
    { eapply Rle_trans; [apply H; auto|]. unfold Q. rewrite (Rmult_assoc L). apply Rmult_le_compat_l; [assumption|]. rewrite Rmult_assoc, <- sum_const.
      apply sum_le. intros j Hj. eapply Rle_trans; [apply C; assumption|]. apply Rmult_le_compat_l; [unfold V; lra | assumption]. }
    rewrite <- (pow2_abs (t - s)). pose proof (Rabs_pos (t - s)) as P. pose proof (pow2_ge_0 (Rabs (t - s))).
    apply Rle_trans with (Q * Rabs (t - s) ^ 2); [|unfold V; nra]. replace (Q * Rabs (t - s) ^ 2) with (Q * Rabs (t - s) * Rabs (t - s)) by ring.
    apply Rmult_le_compat_r; assumption.
Qed.

(* Values where one of the functions, z, is 0: derivatives by the parameter. Everything has rests that are quadratic. *)
Section Crossing.
Variables (p r m K : R) (tau : R -> R).
Hypothesis r_pos : 0 < r.
Hypothesis m_pos : 0 < m.
Hypothesis K_nonneg : 0 <= K.
Notation near q := (Rabs (q - p) <= r).

(* s, with slopes sp by the parameter and st by time, at times between those of the crossings. *)
Definition smooth (s : R -> R -> R) (sp : R -> R) (st : R) : Prop := forall q, near q ->
  Rabs (s q (tau q) - s p (tau q) - (q - p) * sp (tau q)) <= K * (q - p) ^ 2 /\
  Rabs (s p (tau q) - s p (tau p) - (tau q - tau p) * st) <= K * (tau q - tau p) ^ 2 /\
  Rabs (sp (tau q)) <= K /\ Rabs (sp (tau q) - sp (tau p)) <= K * Rabs (tau q - tau p).

Variables (z : R -> R -> R) (zp : R -> R) (zt : R).
Hypothesis z_smooth : smooth z zp zt.
Hypothesis z_zero : forall q, near q -> z q (tau q) = 0.
Hypothesis z_steep : forall q, near q -> m * Rabs (tau q - tau p) <= Rabs (z p (tau q) - z p (tau p)).
Hypothesis zt_large : m <= Rabs zt.

Lemma near_base : near p.
Proof. rewrite Rminus_eq_0, Rabs_R0. lra. Qed.
Let C : R := K * (1 + r) / m.
Lemma C_nonneg : 0 <= C.
Proof. unfold C. apply Rmult_le_pos; [nra | left; apply Rinv_0_lt_compat; assumption]. Qed.
Lemma crossing_near q : near q -> Rabs (tau q - tau p) <= C * Rabs (q - p).
Proof.
  intros Hq. destruct (z_smooth q Hq) as [H1 [_ [H3 _]]]. pose proof (z_steep q Hq) as H4. rewrite (z_zero q Hq) in H1. rewrite (z_zero p near_base) in H4.
  apply (Rmult_le_reg_l m); [assumption|]. replace (m * (C * Rabs (q - p))) with (K * (1 + r) * Rabs (q - p)) by (unfold C; field; lra).
  eapply Rle_trans; [exact H4|]. rewrite Rminus_0_r.
  assert (X : Rabs ((q - p) * zp (tau q)) <= Rabs (q - p) * K) by (rewrite Rabs_mult; apply Rmult_le_compat_l; [apply Rabs_pos | assumption]).
  rewrite <- (pow2_abs (q - p)) in H1. pose proof (Rabs_pos (q - p)).
  assert (K * Rabs (q - p) ^ 2 <= K * (r * Rabs (q - p))) by (apply Rmult_le_compat_l; [assumption | nra]).
  apply Rabs_le_between in X, H1. apply Rabs_le. lra.
Qed.
Lemma smooth_at_crossing s sp st q : smooth s sp st -> near q ->
  Rabs (s q (tau q) - s p (tau p) - (q - p) * sp (tau p) - (tau q - tau p) * st) <= K * (1 + C + C ^ 2) * (q - p) ^ 2.
Proof.
  intros S Hq. destruct (S q Hq) as [H1 [H2 [_ H4]]]. pose proof (crossing_near q Hq) as N. pose proof C_nonneg as HC.
  set (d := q - p) in *. set (e := tau q - tau p) in *. pose proof (Rabs_pos d) as Pd. pose proof (Rabs_pos e) as Pe.
  assert (E2 : e ^ 2 <= C ^ 2 * d ^ 2) by (rewrite <- (pow2_abs e), <- (pow2_abs d), <- Rpow_mult_distr; apply pow_incr; lra).
  assert (X : Rabs (d * (sp (tau q) - sp (tau p))) <= K * C * d ^ 2).
  { rewrite Rabs_mult, <- (pow2_abs d). apply Rle_trans with (Rabs d * (K * (C * Rabs d))); [|right; ring].
    apply Rmult_le_compat_l; [assumption|]. eapply Rle_trans; [exact H4|]. apply Rmult_le_compat_l; assumption. }
  assert (K * e ^ 2 <= K * (C ^ 2 * d ^ 2)) by (apply Rmult_le_compat_l; assumption).
  apply Rabs_le_between in H1, H2, X. apply Rabs_le. lra.
Qed.
Lemma zt_nonzero : zt <> 0.
Proof. intros E. rewrite E, Rabs_R0 in zt_large. lra. Qed.
Lemma crossing_expands q : near q -> Rabs (tau q - tau p - (q - p) * (- zp (tau p) / zt)) <= K * (1 + C + C ^ 2) / m * (q - p) ^ 2.
Proof.
  intros Hq. pose proof (smooth_at_crossing z zp zt q z_smooth Hq) as H. rewrite (z_zero q Hq), (z_zero p near_base) in H.
  pose proof zt_nonzero. apply (Rmult_le_reg_l m); [assumption|].
  replace (m * (K * (1 + C + C ^ 2) / m * (q - p) ^ 2)) with (K * (1 + C + C ^ 2) * (q - p) ^ 2) by (field; lra).
  eapply Rle_trans; [|exact H]. eapply Rle_trans; [apply Rmult_le_compat_r; [apply Rabs_pos | exact zt_large]|].
  rewrite <- Rabs_mult, <- Rabs_Ropp. right. f_equal. field. assumption.
Qed.

Theorem crossing_derive : is_derive tau p (- zp (tau p) / zt).
Proof. apply (quadratic_rest _ _ _ (K * (1 + C + C ^ 2) / m) r r_pos). exact crossing_expands. Qed.
Theorem derive_at_crossing s sp st : smooth s sp st -> is_derive (fun q => s q (tau q)) p (sp (tau p) + st * (- zp (tau p) / zt)).
Proof.
  intros S. apply (quadratic_rest _ _ _ (K * (1 + C + C ^ 2) + Rabs st * (K * (1 + C + C ^ 2) / m)) r r_pos). intros q Hq.
  pose proof (smooth_at_crossing s sp st q S Hq) as H1. pose proof (crossing_expands q Hq) as H2.
  assert (X : Rabs (st * (tau q - tau p - (q - p) * (- zp (tau p) / zt))) <= Rabs st * (K * (1 + C + C ^ 2) / m) * (q - p) ^ 2).
  { rewrite Rabs_mult, Rmult_assoc. apply Rmult_le_compat_l; [apply Rabs_pos | assumption]. }
  apply Rabs_le_between in H1, X. apply Rabs_le. lra.
Qed.
End Crossing.
