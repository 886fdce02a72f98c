(* Solutions of y' = f(y) for a locally Lipschitz field f on R^n: they are unique, they can be joined, and one exists near
   an approximation if a supersolution of the comparison system stays in the tube (chapter verify/flow, section 4).

   A point of R^n is a function nat -> R of which only the places 0 .. n - 1 count. *)

From Coq Require Import Reals Lra Lia.
From Coquelicot Require Import Coquelicot.
From Solutions Require Import Comparison Existence.
Local Open Scope R_scope.

Definition point : Type := nat -> R.
Definition field : Type := point -> point.

(* On every bounded set there is a Lipschitz constant. *)
Definition locally_lipschitz (n : nat) (f : field) : Prop :=
  forall r, exists L, 0 <= L /\ forall x y,
    (forall j, (j < n)%nat -> Rabs (x j) <= r) -> (forall j, (j < n)%nat -> Rabs (y j) <= r) ->
    forall i, (i < n)%nat -> Rabs (f x i - f y i) <= L * sum n (fun j => Rabs (x j - y j)).

(* y is a solution on [0, h]: at every time t in it the derivative of y is f(y(t)), from both sides. *)
Definition solves (n : nat) (f : field) (h : R) (y : nat -> R -> R) : Prop :=
  forall i t, (i < n)%nat -> 0 <= t <= h -> is_derive (y i) t (f (fun j => y j t) i).

Section Fields.
Variables (n : nat) (f : field).
Hypothesis f_lipschitz : locally_lipschitz n f.

Lemma field_ext x y i : (i < n)%nat -> (forall j, (j < n)%nat -> x j = y j) -> f x i = f y i.
Proof.
  intros Hi E. destruct (f_lipschitz (sum n (fun j => Rabs (x j)))) as [L [HL H]].
  assert (Bx : forall j, (j < n)%nat -> Rabs (x j) <= sum n (fun j => Rabs (x j))).
  { intros j Hj. apply (term_le_sum n (fun j => Rabs (x j))); [intros; apply Rabs_pos | assumption]. }
  specialize (H x y Bx). assert (By : forall j, (j < n)%nat -> Rabs (y j) <= sum n (fun j => Rabs (x j))).
  { intros j Hj. rewrite <- (E j Hj). apply Bx. assumption. }
  specialize (H By i Hi). rewrite (sum_ext n _ (fun _ => 0)), sum_const in H.
  2:{ intros j Hj. rewrite (E j Hj), Rminus_eq_0. apply Rabs_R0. }
  pose proof (Rabs_pos (f x i - f y i)) as P. assert (Z : Rabs (f x i - f y i) = 0) by lra.
  apply Rabs_eq_0 in Z. lra.
Qed.

Lemma sum_continuous m (g : nat -> R -> R) t :
  (forall j, (j < m)%nat -> continuous (g j) t) -> continuous (fun s => sum m (fun j => g j s)) t.
Proof.
  induction m as [|m IH]; intros H; cbn [sum]; [apply continuous_const|].
  apply (continuous_plus (V := R_NormedModule) (fun s => sum m (fun j => g j s))); [apply IH; intros; apply H; lia | apply H; lia].
Qed.

Lemma field_continuous (w : nat -> R -> R) r t i : (i < n)%nat ->
  (forall j s, (j < n)%nat -> Rabs (w j s) <= r) -> (forall j, (j < n)%nat -> continuous (w j) t) ->
  continuous (fun s => f (fun j => w j s) i) t.
Proof.
  intros Hi Hr Hc. destruct (f_lipschitz r) as [L [HL H]].
  set (g := fun s => L * sum n (fun j => Rabs (w j s - w j t))).
  assert (Cg : continuous g t).
  { apply (continuous_scal_r (K := R_AbsRing) (V := R_NormedModule) L (fun s => sum n (fun j => Rabs (w j s - w j t)))).
    apply (sum_continuous n (fun j s => Rabs (w j s - w j t))). intros j Hj.
    apply (continuous_comp (fun s => w j s - w j t) Rabs); [|apply continuous_Rabs].
    apply (continuous_minus (V := R_NormedModule) (w j)); [apply Hc; assumption | apply continuous_const]. }
  assert (g0 : g t = 0).
  { unfold g. rewrite (sum_ext n _ (fun _ => 0)); [rewrite sum_const; ring|]. intros. rewrite Rminus_eq_0. apply Rabs_R0. }
  apply filterlim_locally. intros eps. apply filterlim_locally with (eps := eps) in Cg.
  revert Cg. apply filter_imp. intros s Hs. change (Rabs (g s - g t) < eps) in Hs. rewrite g0, Rminus_0_r in Hs.
  change (Rabs (f (fun j => w j s) i - f (fun j => w j t) i) < eps). eapply Rle_lt_trans; [apply H; auto|].
  change (g s < eps). pose proof (Rle_abs (g s)). lra.
Qed.

(* Functions that have derivatives on [0, h] are bounded there. *)
Lemma bounded_on h m (y dy : nat -> R -> R) : 0 <= h ->
  (forall i t, (i < m)%nat -> 0 <= t <= h -> is_derive (y i) t (dy i t)) ->
  exists r, 0 <= r /\ forall i t, (i < m)%nat -> 0 <= t <= h -> Rabs (y i t) <= r.
Proof.
  intros Hh. induction m as [|m IH]; intros D.
  - exists 0. split; [lra | intros; lia].
  - destruct IH as [r [Hr H]]; [intros; apply D; [lia | assumption]|].
    destruct (continuity_ab_maj (fun t => Rabs (y m t)) 0 h Hh) as [u [Hu _]].
    { intros t Ht. apply continuity_pt_filterlim. apply (continuous_comp (y m) Rabs); [|apply continuous_Rabs].
      apply (ex_derive_continuous (y m)). exists (dy m t). apply D; [lia | assumption]. }
    exists (r + Rabs (y m u)). pose proof (Rabs_pos (y m u)). split; [lra|]. intros i t Hi Ht.
    destruct (Nat.eq_dec i m) as [->|Hne]; [specialize (Hu t Ht); cbn in Hu; lra|].
    specialize (H i t ltac:(lia) Ht). lra.
Qed.

Theorem unique h (y z : nat -> R -> R) : 0 <= h -> solves n f h y -> solves n f h z ->
  (forall i, (i < n)%nat -> y i 0 = z i 0) -> forall i t, (i < n)%nat -> 0 <= t <= h -> y i t = z i t.
Proof.
  intros Hh Sy Sz E i t Hi Ht.
  destruct (bounded_on h n y (fun i t => f (fun j => y j t) i) Hh Sy) as [ry [Hry By]].
  destruct (bounded_on h n z (fun i t => f (fun j => z j t) i) Hh Sz) as [rz [Hrz Bz]].
  destruct (f_lipschitz (ry + rz)) as [L [HL Lip]].
  assert (Z : Rabs (y i t - z i t) <= 0).
  { apply (comparison n h (fun _ _ => L) (fun i t => y i t - z i t)
      (fun i t => f (fun j => y j t) i - f (fun j => z j t) i) (fun _ _ => 0) (fun _ _ => 0) (fun _ _ => 0)
      (fun _ => 0) (fun _ => 0) (ry + rz)); try assumption; try (intros; lra).
    - intros. apply (is_derive_minus (V := R_NormedModule) (y i0)); [apply Sy | apply Sz]; assumption.
    - intros k s Hk Hs. eapply Rle_trans; [apply (Rabs_triang (y k s) (- z k s))|]. rewrite Rabs_Ropp.
      apply Rplus_le_compat; auto.
    - intros k s Hk Hs. rewrite Rplus_0_l, sum_scal.
      apply Lip; [| |assumption]; intros j Hj; [specialize (By j s Hj Hs) | specialize (Bz j s Hj Hs)]; lra.
    - intros k Hk. rewrite (E k Hk), Rminus_eq_0, Rabs_R0. lra.
    - intros. apply (is_derive_const (V := R_NormedModule)).
    - intros. rewrite (sum_ext n _ (fun _ => 0)); [rewrite sum_const; lra | intros; ring]. }
  pose proof (Rabs_pos (y i t - z i t)). assert (Z' : Rabs (y i t - z i t) = 0) by lra. apply Rabs_eq_0 in Z'. lra.
Qed.
End Fields.

Section Step.
Variables (n : nat) (f : field) (h : R).
Hypothesis f_lipschitz : locally_lipschitz n f.
Hypothesis h_nonneg : 0 <= h.
(* The approximation, the tube around it, the bound of the defect, the matrix of the comparison system, a supersolution. *)
Variables (p dp : nat -> R -> R) (T delta e0 : nat -> R) (M : nat -> nat -> R) (U G dG : nat -> R -> R) (x0 : point).
Hypothesis p_derive : forall i t, (i < n)%nat -> 0 <= t <= h -> is_derive (p i) t (dp i t).
Hypothesis T_nonneg : forall i, (i < n)%nat -> 0 <= T i.
Hypothesis start : forall i, (i < n)%nat -> Rabs (x0 i - p i 0) <= e0 i.
Hypothesis defect : forall i t, (i < n)%nat -> 0 <= t <= h -> Rabs (f (fun j => p j t) i - dp i t) <= delta i.
Hypothesis M_nonneg : forall i j, (i < n)%nat -> (j < n)%nat -> 0 <= M i j.
Hypothesis tube : forall x i t, (i < n)%nat -> 0 <= t <= h -> (forall j, (j < n)%nat -> Rabs (x j - p j t) <= T j) ->
  Rabs (f x i - f (fun j => p j t) i) <= sum n (fun j => M i j * Rabs (x j - p j t)).
Hypothesis G_derive : forall i t, (i < n)%nat -> 0 <= t <= h -> is_derive (G i) t (dG i t).
Hypothesis G_slope : forall i t, (i < n)%nat -> 0 <= t <= h -> sum n (fun j => M i j * U j t) <= dG i t.
Hypothesis G_start : forall i, (i < n)%nat -> G i 0 = 0.
Hypothesis U_nonneg : forall i t, (i < n)%nat -> 0 <= t <= h -> 0 <= U i t.
Hypothesis U_above : forall i t, (i < n)%nat -> 0 <= t <= h -> e0 i + delta i * t + G i t <= U i t.
Hypothesis U_below : forall i t, (i < n)%nat -> 0 <= t <= h -> U i t <= T i.

(* The point of the tube at time t that is next to x. *)
Definition into_tube (t : R) (x : point) : point := fun j => p j t + clamp (- T j) (T j) (x j - p j t).
Lemma into_tube_near t x j : into_tube t x j - p j t = clamp (- T j) (T j) (x j - p j t).
Proof. unfold into_tube. ring. Qed.
Definition clamped (t : R) (x : point) : point := f (into_tube t x).

Lemma clamp_small j v : (j < n)%nat -> Rabs (clamp (- T j) (T j) v) <= Rabs v /\ Rabs (clamp (- T j) (T j) v) <= T j.
Proof.
  intros Hj. pose proof (T_nonneg j Hj). unfold clamp, Rmax, Rmin.
  repeat destruct Rle_dec; unfold Rabs; repeat destruct Rcase_abs; lra.
Qed.

Theorem step_theorem : exists y : nat -> R -> R,
  (forall i, (i < n)%nat -> y i 0 = x0 i) /\ solves n f h y /\
  (forall i t, (i < n)%nat -> 0 <= t <= h -> Rabs (y i t - p i t) <= U i t).
Proof.
  destruct (bounded_on h n p dp h_nonneg p_derive) as [rp [Hrp Bp]].
  set (r := rp + sum n T).
  assert (HT : 0 <= sum n T) by (apply sum_nonneg; assumption).
  assert (Hr : forall t x j, 0 <= t <= h -> (j < n)%nat -> Rabs (into_tube t x j) <= r).
  { intros t x j Ht Hj. unfold into_tube, r. eapply Rle_trans; [apply Rabs_triang|].
    pose proof (Bp j t Hj Ht). destruct (clamp_small j (x j - p j t) Hj) as [_ Q].
    pose proof (term_le_sum n T j T_nonneg Hj). lra. }
  destruct (f_lipschitz r) as [L [HL Lip]].
  assert (B : forall t x i, 0 <= t <= h -> (i < n)%nat ->
    Rabs (clamped t x i) <= sum n (fun i => Rabs (f (fun _ => 0) i)) + L * (INR n * r)).
  { intros t x i Ht Hi. unfold clamped.
    assert (D : Rabs (f (into_tube t x) i - f (fun _ => 0) i) <= L * (INR n * r)).
    { eapply Rle_trans; [apply Lip; auto; intros; rewrite Rabs_R0; unfold r; lra|].
      apply Rmult_le_compat_l; [assumption|]. rewrite <- sum_const. apply sum_le. intros j Hj. rewrite Rminus_0_r. auto. }
    pose proof (term_le_sum n (fun i => Rabs (f (fun _ => 0) i)) i (fun j _ => Rabs_pos _) Hi).
    pose proof (Rabs_triang_inv (f (into_tube t x) i) (f (fun _ => 0) i)). cbv beta in *. lra. }
  destruct (picard n h L (sum n (fun i => Rabs (f (fun _ => 0) i)) + L * (INR n * r)) clamped x0) as [y [Y0 Y]]; try assumption.
  - intros t x z i Ht Hi. unfold clamped. eapply Rle_trans; [apply Lip; auto|].
    apply Rmult_le_compat_l; [assumption|]. apply sum_le. intros j Hj. unfold into_tube.
    match goal with |- Rabs (?a + ?b - (?a + ?c)) <= _ => replace (a + b - (a + c)) with (b - c) by ring end.
    eapply Rle_trans; [apply clamp_lipschitz|]. right. f_equal. ring.
  - intros c z Hc Cc Cz i t Hi. unfold clamped.
    apply (field_continuous n f f_lipschitz (fun j s => into_tube (c s) (fun j => z j s) j) r); auto.
    intros j Hj. unfold into_tube.
    assert (Cp : continuous (fun s => p j (c s)) t).
    { apply (continuous_comp c (p j)); [apply Cc|]. apply (ex_derive_continuous (p j)). exists (dp j (c t)). apply p_derive; auto. }
    apply (continuous_plus (V := R_NormedModule) (fun s => p j (c s))); [assumption|].
    apply (continuous_comp (fun s => z j s - p j (c s)) (clamp (- T j) (T j))); [|apply clamp_continuous].
    apply (continuous_minus (V := R_NormedModule) (z j)); [apply Cz | ]; assumption.
  - assert (D : forall i t, (i < n)%nat -> 0 <= t <= h ->
      is_derive (fun t => y i t - p i t) t (clamped t (fun j => y j t) i - dp i t)).
    { intros. apply (is_derive_minus (V := R_NormedModule) (y i)); auto. }
    destruct (bounded_on h n _ _ h_nonneg D) as [re [_ Be]].
    assert (E : forall i t, (i < n)%nat -> 0 <= t <= h -> Rabs (y i t - p i t) <= U i t).
    { apply (comparison n h M (fun i t => y i t - p i t) (fun i t => clamped t (fun j => y j t) i - dp i t)
        U G dG delta e0 re); auto.
      - intros i t Hi Ht. pose proof (defect i t Hi Ht) as Q.
        assert (P : Rabs (clamped t (fun j => y j t) i - f (fun j => p j t) i)
                    <= sum n (fun j => M i j * Rabs (y j t - p j t))).
        { unfold clamped. eapply Rle_trans; [apply tube; auto|].
          - intros j Hj. rewrite into_tube_near. apply clamp_small. assumption.
          - apply sum_le. intros j Hj. apply Rmult_le_compat_l; [auto|]. rewrite into_tube_near.
            apply clamp_small. assumption. }
        apply Rabs_le_between in P. apply Rabs_le_between in Q. apply Rabs_le. lra.
      - intros i Hi. rewrite (Y0 i Hi). auto. }
    exists y. split; [assumption|]. split; [|assumption]. intros i t Hi Ht.
    replace (f (fun j => y j t) i) with (clamped t (fun j => y j t) i); [auto|].
    unfold clamped. apply (field_ext n f f_lipschitz); [assumption|]. intros j Hj. unfold into_tube.
    rewrite clamp_id; [ring|]. pose proof (E j t Hj Ht) as Q. pose proof (U_below j t Hj Ht).
    apply Rabs_le_between in Q. lra.
Qed.
End Step.

(* Joining solutions. *)
Lemma derive_glued (f g : R -> R) a l : f a = g a -> is_derive f a l -> is_derive g a l ->
  is_derive (fun t => if Rle_dec t a then f t else g t) a l.
Proof.
  intros E Df Dg. apply is_derive_Reals in Df. apply is_derive_Reals in Dg. apply is_derive_Reals.
  intros eps He. destruct (Df eps He) as [d1 H1]. destruct (Dg eps He) as [d2 H2].
  assert (P : 0 < Rmin d1 d2) by (apply Rmin_pos; apply cond_pos).
  exists (mkposreal _ P). intros s Hs Hd. cbn in Hd. pose proof (Rmin_l d1 d2). pose proof (Rmin_r d1 d2).
  destruct (Rle_dec a a) as [_|F]; [|exfalso; lra].
  destruct (Rle_dec (a + s) a); [apply H1; [assumption | lra]|]. rewrite E. apply H2; [assumption | lra].
Qed.

Definition glued (h1 : R) (y z : nat -> R -> R) (i : nat) (t : R) : R := if Rle_dec t h1 then y i t else z i (t - h1).

Section Joining.
Variables (n : nat) (f : field) (h1 h2 : R) (y z : nat -> R -> R).
Hypothesis f_lipschitz : locally_lipschitz n f.
Hypothesis y_solves : solves n f h1 y.
Hypothesis z_solves : solves n f h2 z.
Hypothesis h1_nonneg : 0 <= h1.
Hypothesis h2_nonneg : 0 <= h2.
Hypothesis meet : forall i, (i < n)%nat -> z i 0 = y i h1.

Lemma glued_before i t : t <= h1 -> glued h1 y z i t = y i t.
Proof. intros H. unfold glued. destruct Rle_dec; [reflexivity | lra]. Qed.
Lemma glued_after i t : (i < n)%nat -> h1 <= t -> glued h1 y z i t = z i (t - h1).
Proof.
  intros Hi H. unfold glued. destruct Rle_dec; [|reflexivity].
  replace t with h1 by lra. rewrite Rminus_eq_0. symmetry. apply meet. assumption.
Qed.

Lemma derive_later (g : R -> R) t l : is_derive g (t - h1) l -> is_derive (fun s => g (s - h1)) t l.
Proof.
  intros D. replace l with (scal 1 l) by (unfold scal; cbn; unfold mult; cbn; ring).
  apply (is_derive_comp (V := R_NormedModule) g (fun s => s - h1)); [assumption|]. auto_derive; [exact I | ring].
Qed.

Theorem glued_solves : solves n f (h1 + h2) (glued h1 y z).
Proof.
  intros i t Hi Ht. destruct (Rtotal_order t h1) as [H|[H|H]].
  - rewrite (field_ext n f f_lipschitz _ (fun j => y j t) i Hi) by (intros; apply glued_before; lra).
    apply (is_derive_ext_loc (y i)); [|apply y_solves; [assumption | lra]].
    assert (P : 0 < h1 - t) by lra. exists (mkposreal _ P). intros s Hs. change (Rabs (s - t) < h1 - t) in Hs.
    symmetry. apply glued_before. apply Rabs_lt_between in Hs. lra.
  - subst t. rewrite (field_ext n f f_lipschitz _ (fun j => y j h1) i Hi) by (intros; apply glued_before; lra).
    apply (derive_glued (y i) (fun s => z i (s - h1))).
    + rewrite Rminus_eq_0. symmetry. apply meet. assumption.
    + apply y_solves; [assumption | lra].
    + apply derive_later. rewrite Rminus_eq_0.
      rewrite (field_ext n f f_lipschitz _ (fun j => z j 0) i Hi) by (intros; symmetry; apply meet; assumption).
      apply z_solves; [assumption | lra].
  - rewrite (field_ext n f f_lipschitz _ (fun j => z j (t - h1)) i Hi) by (intros; apply glued_after; [assumption | lra]).
    apply (is_derive_ext_loc (fun s => z i (s - h1))).
    + assert (P : 0 < t - h1) by lra. exists (mkposreal _ P). intros s Hs. change (Rabs (s - t) < t - h1) in Hs.
      symmetry. apply glued_after; [assumption|]. apply Rabs_lt_between in Hs. lra.
    + apply derive_later. apply z_solves; [assumption | lra].
Qed.
End Joining.

(* Another unit of time. *)
Lemma solves_rescaled n (f : field) c k y : 0 < c ->
  solves n (fun x i => c * f x i) k y -> solves n f (c * k) (fun i t => y i (t / c)).
Proof.
  intros Hc S i t Hi Ht. assert (Ht' : 0 <= t / c <= k).
  { split; [apply Rdiv_le_0_compat; lra|]. apply (Rmult_le_reg_l c); [assumption|].
    replace (c * (t / c)) with t by (field; lra). lra. }
  specialize (S i (t / c) Hi Ht').
  replace (f (fun j => y j (t / c)) i) with (scal (/ c) (c * f (fun j => y j (t / c)) i))
    by (unfold scal; cbn; unfold mult; cbn; field; lra).
  apply (is_derive_comp (V := R_NormedModule) (y i) (fun s => s / c)); [assumption|]. auto_derive; [exact I | field; lra].
Qed.
