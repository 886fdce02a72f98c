(* Picard's iteration: a field that is bounded and Lipschitz everywhere has solutions on [0, h]. *)

From Coq Require Import Reals Lra Lia ZArith.
From Coquelicot Require Import Coquelicot.
From Solutions Require Import Comparison.
Local Open Scope R_scope.

Lemma lipschitz_continuous (g : R -> R) (B t : R) : (forall s, Rabs (g s - g t) <= B * Rabs (s - t)) -> continuous g t.
Proof.
  intros H. assert (HB : 0 <= B).
  { specialize (H (t + 1)). replace (t + 1 - t) with 1 in H by ring. rewrite Rabs_R1 in H.
    pose proof (Rabs_pos (g (t + 1) - g t)). lra. }
  apply filterlim_locally. intros eps. assert (P : 0 < eps / (B + 1)) by (apply Rdiv_lt_0_compat; [apply cond_pos | lra]).
  exists (mkposreal _ P). intros s Hs. change (Rabs (s - t) < eps / (B + 1)) in Hs. change (Rabs (g s - g t) < eps).
  eapply Rle_lt_trans; [apply H|]. pose proof (Rabs_pos (s - t)).
  apply (Rmult_lt_compat_r (B + 1)) in Hs; [|lra]. unfold Rdiv in Hs. rewrite Rmult_assoc, Rinv_l in Hs by lra. nra.
Qed.

Lemma primitive (g : R -> R) (a t : R) : (forall s, continuous g s) -> is_derive (fun s => a + RInt g 0 s) t (g t).
Proof.
  intros H. replace (g t) with (0 + g t) by ring.
  apply (is_derive_plus (V := R_NormedModule) (fun _ => a)); [apply (is_derive_const (V := R_NormedModule))|].
  apply (is_derive_RInt g (RInt g 0) 0 t); [|apply H].
  apply filter_forall. intros s. apply (RInt_correct (V := R_CompleteNormedModule)).
  apply (ex_RInt_continuous (V := R_CompleteNormedModule)). intros. apply H.
Qed.

Lemma small_power A eps : 0 < eps -> exists N, A / 2 ^ N < eps.
Proof.
  intros He. destruct (archimed (A / eps)) as [Hup _].
  exists (Z.to_nat (Z.max 0 (up (A / eps)))). set (N := Z.to_nat _).
  assert (G : A / eps < 2 ^ N).
  { apply Rlt_trans with (IZR (up (A / eps))); [lra|]. eapply Rle_lt_trans; [|apply two_pow_grows].
    unfold N. rewrite INR_IZR_INZ, Z2Nat.id by lia. apply IZR_le. lia. }
  assert (P : 0 < 2 ^ N) by (apply pow_lt; lra).
  apply (Rmult_lt_compat_r eps) in G; [|assumption]. unfold Rdiv in G. rewrite Rmult_assoc, Rinv_l in G by lra.
  apply (Rmult_lt_reg_r (2 ^ N)); [assumption|]. unfold Rdiv. rewrite Rmult_assoc, Rinv_l by lra. lra.
Qed.

(* t, or the end of [0, h] that is next to it. *)
Definition clamp (a b t : R) : R := Rmax a (Rmin b t).
Lemma clamp_in a b t : a <= b -> a <= clamp a b t <= b.
Proof. intros H. unfold clamp, Rmax, Rmin. repeat destruct Rle_dec; lra. Qed.
Lemma clamp_id a b t : a <= t <= b -> clamp a b t = t.
Proof. intros H. unfold clamp, Rmax, Rmin. repeat destruct Rle_dec; lra. Qed.
Lemma clamp_lipschitz a b s t : Rabs (clamp a b s - clamp a b t) <= Rabs (s - t).
Proof.
  unfold clamp, Rmax, Rmin. repeat destruct Rle_dec; unfold Rabs; repeat destruct Rcase_abs; lra.
Qed.
Lemma clamp_continuous a b t : continuous (clamp a b) t.
Proof. apply (lipschitz_continuous _ 1). intros s. rewrite Rmult_1_l. apply clamp_lipschitz. Qed.

Section Picard.
Variables (n : nat) (h L B : R) (F : R -> (nat -> R) -> nat -> R) (x0 : nat -> R).
Hypothesis h_nonneg : 0 <= h.
Hypothesis L_nonneg : 0 <= L.
Hypothesis F_lipschitz : forall t x y i, 0 <= t <= h -> (i < n)%nat ->
  Rabs (F t x i - F t y i) <= L * sum n (fun j => Rabs (x j - y j)).
Hypothesis F_bounded : forall t x i, 0 <= t <= h -> (i < n)%nat -> Rabs (F t x i) <= B.
Hypothesis F_continuous : forall (c : R -> R) (y : nat -> R -> R),
  (forall t, 0 <= c t <= h) -> (forall t, continuous c t) -> (forall j t, (j < n)%nat -> continuous (y j) t) ->
  forall i t, (i < n)%nat -> continuous (fun s => F (c s) (fun j => y j s) i) t.

Let c : R -> R := clamp 0 h.
Let c_in t : 0 <= c t <= h.
Proof. apply clamp_in. assumption. Qed.

Definition along (y : nat -> R -> R) (i : nat) (s : R) : R := F (c s) (fun j => y j (c s)) i.

Lemma along_continuous y : (forall j t, (j < n)%nat -> continuous (fun s => y j (c s)) t) ->
  forall i t, (i < n)%nat -> continuous (along y i) t.
Proof.
  intros H i t Hi. apply (F_continuous c (fun j s => y j (c s))); auto. intros. apply clamp_continuous.
Qed.

Fixpoint iterate (k : nat) : nat -> R -> R :=
  match k with
  | O => fun i _ => x0 i
  | S k' => fun i t => x0 i + RInt (along (iterate k') i) 0 t
  end.

Lemma iterate_continuous k : forall i t, (i < n)%nat -> continuous (iterate k i) t.
Proof.
  induction k as [|k IH]; intros i t Hi; cbn [iterate]; [apply continuous_const|].
  apply (ex_derive_continuous (fun t => x0 i + RInt (along (iterate k) i) 0 t)).
  exists (along (iterate k) i t). apply primitive. intros s. apply along_continuous; [|assumption].
  intros j u Hj. apply (continuous_comp c (iterate k j)); [apply clamp_continuous | apply IH; assumption].
Qed.
Lemma iterate_derive k i t : (i < n)%nat -> is_derive (iterate (S k) i) t (along (iterate k) i t).
Proof.
  intros Hi. cbn [iterate]. apply primitive. intros s. apply along_continuous; [|assumption].
  intros j u Hj. apply (continuous_comp c (iterate k j)); [apply clamp_continuous | apply iterate_continuous; assumption].
Qed.
Lemma iterate_start k i : iterate k i 0 = x0 i.
Proof. destruct k; cbn [iterate]; [reflexivity|]. rewrite RInt_point. unfold zero; cbn. ring. Qed.

Lemma B_nonneg i : (i < n)%nat -> 0 <= B.
Proof. intros Hi. eapply Rle_trans; [apply Rabs_pos | apply (F_bounded 0 x0 i); [lra | assumption]]. Qed.

Let K : R := 2 * (L * INR n) + 1.
Let W : R := weight K h.
Lemma K_is_pos : 0 < K.
Proof. unfold K. pose proof (pos_INR n). nra. Qed.

(* The error of the field for functions that are near each other. *)
Lemma along_near y z d t i : (i < n)%nat -> (forall j, (j < n)%nat -> Rabs (y j (c t) - z j (c t)) <= d) ->
  Rabs (along y i t - along z i t) <= L * INR n * d.
Proof.
  intros Hi H. unfold along. eapply Rle_trans; [apply F_lipschitz; auto|]. rewrite Rmult_assoc.
  apply Rmult_le_compat_l; [assumption|]. rewrite <- sum_const. apply sum_le. assumption.
Qed.

Lemma successive k : forall i t, (i < n)%nat -> 0 <= t <= h ->
  Rabs (iterate (S k) i t - iterate k i t) <= B * h / 2 ^ k * weight K t.
Proof.
  pose proof K_is_pos as HK.
  induction k as [|k IH]; intros i t Hi Ht.
  - assert (D : Rabs (iterate 1 i t - iterate 1 i 0) <= B * t - B * 0).
    { apply (dominated (iterate 1 i) (along (iterate 0) i) (fun s => B * s) (fun s => B * 1) h); [| | |assumption].
      - intros s Hs. apply iterate_derive. assumption.
      - intros s Hs. apply (is_derive_scal (fun s => s)). apply (is_derive_id (K := R_AbsRing)).
      - intros s Hs. rewrite Rmult_1_r. apply F_bounded; auto. }
    rewrite iterate_start in D. change (iterate 0 i t) with (x0 i).
    assert (1 <= weight K t) by (rewrite <- (weight_0 K); apply weight_le; lra).
    pose proof (B_nonneg i Hi). cbn [pow]. replace (B * h / 1) with (B * h) by field.
    assert (B * t <= B * h) by nra. assert (0 <= B * h) by nra. nra.
  - set (a := B * h / 2 ^ k) in *.
    assert (Ha : 0 <= a).
    { unfold a. pose proof (B_nonneg i Hi). apply Rdiv_le_0_compat; [nra | apply pow_lt; lra]. }
    assert (D : Rabs ((iterate (S (S k)) i t - iterate (S k) i t) - (iterate (S (S k)) i 0 - iterate (S k) i 0))
                <= a / 2 * weight K t - a / 2 * weight K 0).
    { apply (dominated (fun s => iterate (S (S k)) i s - iterate (S k) i s)
        (fun s => along (iterate (S k)) i s - along (iterate k) i s)
        (fun s => a / 2 * weight K s) (fun s => a / 2 * (K * weight K s)) h); [| | |assumption].
      - intros s Hs. apply (is_derive_minus (V := R_NormedModule) (iterate (S (S k)) i)); apply iterate_derive; assumption.
      - intros s Hs. apply (is_derive_scal (weight K)). apply weight_derive.
      - intros s Hs. eapply Rle_trans; [apply (along_near _ _ (a * weight K s)); [assumption|]|].
        + intros j Hj. unfold c. rewrite (clamp_id 0 h s Hs). apply IH; assumption.
        + pose proof (weight_pos K s). replace (a / 2 * (K * weight K s)) with (K / 2 * (a * weight K s)) by field.
          apply Rmult_le_compat_r; [nra|]. unfold K. lra. }
    rewrite !iterate_start in D. replace (x0 i - x0 i) with 0 in D by ring. rewrite Rminus_0_r, weight_0 in D.
    replace (B * h / 2 ^ S k) with (a / 2); [lra|]. unfold a. cbn [pow]. field. apply pow_nonzero. lra.
Qed.

Let A : R := B * h * W.

Lemma successive_uniform k i t : (i < n)%nat -> 0 <= t <= h -> Rabs (iterate (S k) i t - iterate k i t) <= A / 2 ^ k.
Proof.
  intros Hi Ht. eapply Rle_trans; [apply successive; assumption|]. pose proof K_is_pos.
  assert (weight K t <= W) by (apply weight_le; lra). pose proof (B_nonneg i Hi).
  assert (P : 0 < / 2 ^ k) by (apply Rinv_0_lt_compat, pow_lt; lra). unfold A, Rdiv.
  replace (B * h * W * / 2 ^ k) with (B * h * / 2 ^ k * W) by ring. apply Rmult_le_compat_l; [|assumption].
  apply Rmult_le_pos; [nra | lra].
Qed.
Lemma far k m i t : (i < n)%nat -> 0 <= t <= h -> Rabs (iterate (k + m) i t - iterate k i t) <= 2 * A / 2 ^ k.
Proof.
  intros Hi Ht.
  assert (H : Rabs (iterate (k + m) i t - iterate k i t) <= 2 * A / 2 ^ k - 2 * A / 2 ^ (k + m)).
  { induction m as [|m IH].
    - rewrite Nat.add_0_r. rewrite !Rminus_eq_0, Rabs_R0. lra.
    - replace (k + S m)%nat with (S (k + m)) by lia.
      replace (iterate (S (k + m)) i t - iterate k i t) with
        ((iterate (S (k + m)) i t - iterate (k + m) i t) + (iterate (k + m) i t - iterate k i t)) by ring.
      eapply Rle_trans; [apply Rabs_triang|]. pose proof (successive_uniform (k + m) i t Hi Ht).
      replace (2 * A / 2 ^ S (k + m)) with (A / 2 ^ (k + m)) by (cbn [pow]; field; apply pow_nonzero; lra). 
      replace (2 * A / 2 ^ (k + m)) with (A / 2 ^ (k + m) + A / 2 ^ (k + m)) in IH by (field; apply pow_nonzero; lra).
      lra. }
  eapply Rle_trans; [exact H|].
  assert (0 <= 2 * A / 2 ^ (k + m)); [|lra]. apply Rdiv_le_0_compat; [|apply pow_lt; lra].
  unfold A, W. pose proof (B_nonneg i Hi). pose proof (weight_pos K h). assert (0 <= B * h) by nra. nra.
Qed.

Definition limit (i : nat) (t : R) : R := real (Lim_seq (fun k => iterate k i t)).

Lemma limit_is i t : (i < n)%nat -> 0 <= t <= h -> is_lim_seq (fun k => iterate k i t) (limit i t).
Proof.
  intros Hi Ht. apply Lim_seq_correct'. apply ex_lim_seq_cauchy_corr. intros eps.
  destruct (small_power (2 * A) (eps / 2)) as [N HN]; [pose proof (cond_pos eps); lra|].
  exists N. intros a b Ha Hb.
  replace a with (N + (a - N))%nat by lia. replace b with (N + (b - N))%nat by lia.
  pose proof (far N (a - N) i t Hi Ht) as Fa. pose proof (far N (b - N) i t Hi Ht) as Fb.
  apply Rabs_le_between in Fa. apply Rabs_le_between in Fb. apply Rabs_lt_between. lra.
Qed.
Lemma limit_near k i t : (i < n)%nat -> 0 <= t <= h -> Rabs (limit i t - iterate k i t) <= 2 * A / 2 ^ k.
Proof.
  intros Hi Ht.
  assert (L1 : is_lim_seq (fun m => iterate (m + k) i t) (limit i t)) by (apply (is_lim_seq_incr_n (fun m => iterate m i t) k), limit_is; assumption).
  assert (L2 : is_lim_seq (fun m => Rabs (iterate (m + k) i t - iterate k i t)) (Rabs (limit i t - iterate k i t))).
  { apply (is_lim_seq_abs _ (Finite (limit i t - iterate k i t))). apply is_lim_seq_minus'; [assumption | apply is_lim_seq_const]. }
  apply (is_lim_seq_le _ (fun _ => 2 * A / 2 ^ k) _ (2 * A / 2 ^ k)) in L2; [exact L2 | | apply is_lim_seq_const].
  intros m. rewrite Nat.add_comm. apply far; assumption.
Qed.

Lemma iterate_lipschitz k i s t : (i < n)%nat -> Rabs (iterate k i t - iterate k i s) <= B * Rabs (t - s).
Proof.
  intros Hi. pose proof (B_nonneg i Hi) as HB. destruct k as [|k].
  - cbn [iterate]. rewrite Rminus_eq_0, Rabs_R0. pose proof (Rabs_pos (t - s)). nra.
  - destruct (MVT_gen (iterate (S k) i) s t (along (iterate k) i)) as [u [_ E]].
    + intros. apply iterate_derive. assumption.
    + intros. apply continuity_pt_filterlim, iterate_continuous. assumption.
    + rewrite E, Rabs_mult. apply Rmult_le_compat_r; [apply Rabs_pos|]. apply F_bounded; auto.
Qed.
Lemma limit_lipschitz i s t : (i < n)%nat -> 0 <= s <= h -> 0 <= t <= h -> Rabs (limit i t - limit i s) <= B * Rabs (t - s).
Proof.
  intros Hi Hs Ht. assert (Rabs (limit i t - limit i s) - B * Rabs (t - s) <= 0); [|lra].
  apply (halved_for_ever _ (2 * (2 * A))). intros k.
  pose proof (limit_near k i s Hi Hs) as Ns. pose proof (limit_near k i t Hi Ht) as Nt.
  pose proof (iterate_lipschitz k i s t Hi) as I.
  replace (2 * (2 * A) / 2 ^ k) with (2 * A / 2 ^ k + 2 * A / 2 ^ k) by (field; apply pow_nonzero; lra).
  assert (Rabs (limit i t - limit i s) <= B * Rabs (t - s) + (2 * A / 2 ^ k + 2 * A / 2 ^ k)); [|lra].
  apply Rabs_le_between in Ns. apply Rabs_le_between in Nt. apply Rabs_le_between in I. apply Rabs_le. lra.
Qed.
Lemma limit_continuous i t : (i < n)%nat -> continuous (fun s => limit i (c s)) t.
Proof.
  intros Hi. apply (lipschitz_continuous _ B). intros s. eapply Rle_trans; [apply limit_lipschitz; auto|].
  apply Rmult_le_compat_l; [apply (B_nonneg i); assumption | apply clamp_lipschitz].
Qed.

Theorem picard : exists y : nat -> R -> R,
  (forall i, (i < n)%nat -> y i 0 = x0 i) /\
  (forall i t, (i < n)%nat -> 0 <= t <= h -> is_derive (y i) t (F t (fun j => y j t) i)).
Proof.
  set (y := fun i t => x0 i + RInt (along limit i) 0 t).
  assert (D : forall i t, (i < n)%nat -> is_derive (y i) t (along limit i t)).
  { intros i t Hi. apply primitive. intros s. apply along_continuous; [|assumption]. intros. apply limit_continuous. assumption. }
  assert (Y0 : forall i, y i 0 = x0 i) by (intros i; unfold y; rewrite RInt_point; unfold zero; cbn; ring).
  assert (E : forall i t, (i < n)%nat -> 0 <= t <= h -> y i t = limit i t).
  { intros i t Hi Ht. assert (Rabs (y i t - limit i t) <= 0).
    2:{ pose proof (Rabs_pos (y i t - limit i t)). assert (Z : Rabs (y i t - limit i t) = 0) by lra. 
        apply Rabs_eq_0 in Z. lra. }
    apply (halved_for_ever _ (L * INR n * (2 * A) * h + A)). intros k.
    assert (N : Rabs ((iterate (S k) i t - y i t) - (iterate (S k) i 0 - y i 0))
                <= L * INR n * (2 * A / 2 ^ k) * t - L * INR n * (2 * A / 2 ^ k) * 0).
    { apply (dominated (fun s => iterate (S k) i s - y i s) (fun s => along (iterate k) i s - along limit i s)
        (fun s => L * INR n * (2 * A / 2 ^ k) * s) (fun s => L * INR n * (2 * A / 2 ^ k) * 1) h); [| | |assumption].
      - intros s Hs. apply (is_derive_minus (V := R_NormedModule) (iterate (S k) i)); [apply iterate_derive | apply D]; assumption.
      - intros s Hs. apply (is_derive_scal (fun s => s)). apply (is_derive_id (K := R_AbsRing)).
      - intros s Hs. rewrite Rmult_1_r. apply along_near; [assumption|]. intros j Hj.
        rewrite Rabs_minus_sym. apply limit_near; auto. }
    rewrite iterate_start, Y0, Rminus_eq_0, !Rminus_0_r, Rmult_0_r, Rminus_0_r in N.
    pose proof (limit_near (S k) i t Hi Ht) as P.
    replace (2 * A / 2 ^ S k) with (A / 2 ^ k) in P by (cbn [pow]; field; apply pow_nonzero; lra).
    assert (Q : L * INR n * (2 * A / 2 ^ k) * t <= L * INR n * (2 * A / 2 ^ k) * h).
    { apply Rmult_le_compat_l; [|lra]. apply Rmult_le_pos; [apply Rmult_le_pos; [assumption | apply pos_INR]|].
      eapply Rle_trans; [apply Rabs_pos | apply (limit_near k i t Hi Ht)]. }
    replace ((L * INR n * (2 * A) * h + A) / 2 ^ k) with (L * INR n * (2 * A / 2 ^ k) * h + A / 2 ^ k)
      by (field; apply pow_nonzero; lra).
    apply Rabs_le_between in N. apply Rabs_le_between in P. apply Rabs_le. lra. }
  exists y. split; [intros; apply Y0|]. intros i t Hi Ht.
  replace (F t (fun j => y j t) i) with (along limit i t); [apply D; assumption|].
  unfold along, c. rewrite (clamp_id 0 h t Ht).
  assert (Z : Rabs (F t (fun j => limit j t) i - F t (fun j => y j t) i) <= 0).
  { eapply Rle_trans; [apply F_lipschitz; assumption|].
    rewrite (sum_ext n _ (fun _ => 0)); [rewrite sum_const; lra|].
    intros j Hj. rewrite (E j t Hj Ht), Rminus_eq_0. apply Rabs_R0. }
  pose proof (Rabs_pos (F t (fun j => limit j t) i - F t (fun j => y j t) i)) as P.
  assert (Z' : Rabs (F t (fun j => limit j t) i - F t (fun j => y j t) i) = 0) by lra. apply Rabs_eq_0 in Z'. lra.
Qed.
End Picard.
