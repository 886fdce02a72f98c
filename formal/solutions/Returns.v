(* Where the solutions of Variations.v cross z = 0: the time of one crossing, what the solutions are there, and the derivatives of
   this by the beginning and by the parameter. *)

From Coq Require Import List ZArith Reals Lra Lia.
From Coquelicot Require Import Coquelicot.
From Solutions Require Import Comparison Flow Dependence Curves Variations Formulas.
Import ListNotations.
Local Open Scope R_scope.
Local Open Scope list_scope.

(* Derivatives of formulas by the beginning and by the parameter: those of the coordinates, and of the time of the crossing. *)
Definition d_by_e (i : nat) : formula := Plus (At (by_e i)) (Times (velocity i) (Over_speed (Minus (Whole 0) (At 5)))).
Definition d_by_b (i : nat) : formula := Plus (At (by_b i)) (Times (velocity i) (Over_speed (Minus (Whole 0) (At 8)))).
Definition De : formula -> formula := derived d_by_e (Whole 0) (speed_derived d_by_e (Whole 0)).
Definition Db : formula -> formula := derived d_by_b (Whole 1) (speed_derived d_by_b (Whole 1)).

Section Return.
Variables (bc rb ec re T r : R).
Hypothesis T_pos : 0 < T.
Hypothesis solutions : forall b e, in_box bc rb ec re b e -> exists y, flows T b e y /\ forall i t, (i < 18)%nat -> 0 <= t <= T -> Rabs (y i t) <= r.
Notation box b e := (in_box bc rb ec re b e).
Notation s i b e t := (st T i b e t).
(* The crossing is between tl and th; sg is 1 if z rises there and -1 if it falls. *)
Variables (tl th sg m M : R).
Hypothesis times : 0 < tl < th /\ th < T.
Hypothesis sign : sg = 1 \/ sg = -1.
Hypothesis m_pos : 0 < m.
Hypothesis z_low : forall b e, box b e -> sg * s 2%nat b e tl < 0.
Hypothesis z_high : forall b e, box b e -> 0 < sg * s 2%nat b e th.
Hypothesis steep : forall b e t, box b e -> tl <= t <= th -> m <= sg * rate T b e t 2 <= M.

Definition tau (b e : R) : R := root (fun t => sg * s 2%nat b e t) tl th.
Lemma z_between b e t u : box b e -> tl <= t <= th -> tl <= u <= th ->
  exists w, tl <= w <= th /\ sg * s 2%nat b e u - sg * s 2%nat b e t = sg * rate T b e w 2 * (u - t).
Proof.
  intros Hb Ht Hu. apply (mean_value_around (fun t => sg * s 2%nat b e t) (fun t => sg * rate T b e t 2) tl th t u); try assumption.
  intros w Hw. apply (is_derive_scal (st T 2 b e)). apply (st_derive bc rb ec re T r T_pos solutions); [assumption | lia | lra].
Qed.
Lemma tau_is b e : box b e -> tl < tau b e < th /\ forall t, tl <= t <= th -> (s 2%nat b e t = 0 <-> t = tau b e).
Proof.
  intros Hb. destruct (steep_root (fun t => sg * s 2%nat b e t) tl th m M) as [H1 H2]; cbv beta; try lra; auto.
  - intros u w Hu Huw Hw. destruct (z_between b e u w Hb ltac:(lra) ltac:(lra)) as [x [Hx ->]]. pose proof (steep b e x Hb Hx).
    split; apply Rmult_le_compat_r; lra.
  - split; [exact H1|]. intros t Ht. specialize (H2 t Ht). cbv beta in H2. fold (tau b e) in H2. split; intros E.
    + apply H2. rewrite E. ring.
    + apply H2 in E. apply Rmult_integral in E. destruct E as [E|E]; [destruct sign; lra | exact E].
Qed.
Definition v (i : nat) (b e : R) : R := s i b e (tau b e).
Lemma tau_in b e : box b e -> tl <= tau b e <= th.
Proof. intros H. destruct (tau_is b e H) as [H1 _]. lra. Qed.
Lemma v_zero b e : box b e -> v 2 b e = 0.
Proof. intros H. unfold v. apply (tau_is b e H); [apply tau_in; assumption | reflexivity]. Qed.
Definition vs (b e : R) : point := fun j => v j b e.
Definition zt (b e : R) : R := fs b (vs b e) 2%nat.

(* In one direction of the plane of b and e. *)
Section Direction.
Variables (B E : R -> R) (p rho : R) (D : nat -> nat) (ok : nat -> Prop).
Hypothesis rho_pos : 0 < rho.
Hypothesis inside : forall q, Rabs (q - p) <= rho -> box (B q) (E q).
Hypothesis ok_z : ok 2%nat.
Hypothesis ok_small : forall i, ok i -> (i < 18)%nat /\ (D i < 18)%nat.
Hypothesis smooth_flow : exists K, 0 <= K /\ forall q i t, Rabs (q - p) <= rho -> ok i -> 0 <= t <= T ->
  Rabs (s i (B q) (E q) t - s i (B p) (E p) t - (q - p) * s (D i) (B p) (E p) t) <= K * (q - p) ^ 2.

Lemma v_derive i : ok i -> is_derive (fun q => v i (B q) (E q)) p
  (v (D i) (B p) (E p) + fs (B p) (vs (B p) (E p)) i * (- v (D 2%nat) (B p) (E p) / zt (B p) (E p))).
Proof.
  intros Hi. assert (Hp : box (B p) (E p)) by (apply inside; rewrite Rminus_eq_0, Rabs_R0; lra).
  destruct smooth_flow as [K1 [HK1 H1]]. destruct (st_in_time bc rb ec re T r T_pos solutions (B p) (E p) Hp) as [K2 [HK2 H2]].
  assert (Tau : forall q, Rabs (q - p) <= rho -> 0 <= tau (B q) (E q) <= T) by (intros q Hq; pose proof (tau_in _ _ (inside q Hq)); lra).
  assert (S : forall j, ok j -> smooth p rho (K1 + K2) (fun q => tau (B q) (E q)) (fun q t => s j (B q) (E q) t) (fun t => s (D j) (B p) (E p) t)
    (rate T (B p) (E p) (tau (B p) (E p)) j)).
  { intros j Hj q Hq. destruct (ok_small j Hj) as [Lj Ldj]. pose proof (Tau q Hq) as Tq. pose proof (Tau p ltac:(rewrite Rminus_eq_0, Rabs_R0; lra)) as Tp.
    pose proof (H1 q j (tau (B q) (E q)) Hq Hj Tq) as A1. destruct (H2 j (tau (B p) (E p)) (tau (B q) (E q)) Lj Tp Tq) as [_ [_ A2]].
    destruct (H2 (D j) (tau (B p) (E p)) (tau (B q) (E q)) Ldj Tp Tq) as [A3 [A4 _]].
    pose proof (pow2_ge_0 (q - p)). pose proof (pow2_ge_0 (tau (B q) (E q) - tau (B p) (E p))). pose proof (Rabs_pos (tau (B q) (E q) - tau (B p) (E p))).
    split; [|split; [|split]]; nra. }
  assert (Z0 : forall q, Rabs (q - p) <= rho -> s 2%nat (B q) (E q) (tau (B q) (E q)) = 0) by (intros q Hq; apply v_zero; auto).
  assert (Zs : forall q, Rabs (q - p) <= rho -> m * Rabs (tau (B q) (E q) - tau (B p) (E p)) <=
    Rabs (s 2%nat (B p) (E p) (tau (B q) (E q)) - s 2%nat (B p) (E p) (tau (B p) (E p)))).
  { intros q Hq. destruct (z_between (B p) (E p) (tau (B p) (E p)) (tau (B q) (E q)) Hp (tau_in _ _ Hp) (tau_in _ _ (inside q Hq))) as [w [Hw W]].
    pose proof (steep (B p) (E p) w Hp Hw) as Q. set (x := s 2%nat (B p) (E p) (tau (B q) (E q))) in *. set (y := s 2%nat (B p) (E p) (tau (B p) (E p))) in *.
    assert (A : Rabs (x - y) = Rabs (sg * (x - y))) by (rewrite Rabs_mult; destruct sign as [-> | ->]; [rewrite Rabs_R1 | rewrite Rabs_m1]; ring).
    rewrite A. replace (sg * (x - y)) with (sg * rate T (B p) (E p) w 2 * (tau (B q) (E q) - tau (B p) (E p))) by lra.
    rewrite Rabs_mult. apply Rmult_le_compat_r; [apply Rabs_pos|]. rewrite Rabs_pos_eq; lra. }
  assert (Zl : m <= Rabs (rate T (B p) (E p) (tau (B p) (E p)) 2)).
  { pose proof (steep (B p) (E p) (tau (B p) (E p)) Hp (tau_in _ _ Hp)) as Q.
    destruct sign as [E1|E1]; rewrite E1 in Q; unfold Rabs; destruct Rcase_abs; lra. }
  exact (derive_at_crossing p rho m (K1 + K2) (fun q => tau (B q) (E q)) rho_pos m_pos (Rplus_le_le_0_compat _ _ HK1 HK2)
    (fun q t => s 2%nat (B q) (E q) t) (fun t => s (D 2%nat) (B p) (E p) t) (rate T (B p) (E p) (tau (B p) (E p)) 2) (S 2%nat ok_z) Z0 Zs Zl
    (fun q t => s i (B q) (E q) t) (fun t => s (D i) (B p) (E p) t) (rate T (B p) (E p) (tau (B p) (E p)) i) (S i Hi)).
Qed.
End Direction.

Lemma zt_nonzero b e : box b e -> zt b e <> 0.
Proof. intros H E. pose proof (steep b e (tau b e) H (tau_in b e H)) as Q. change (rate T b e (tau b e) 2) with (zt b e) in Q. rewrite E in Q. lra. Qed.

(* At points around which there is room in the box. *)
Definition room (b e : R) : Prop := exists rho, 0 < rho /\ (forall q, Rabs (q - e) <= rho -> box b q) /\ (forall q, Rabs (q - b) <= rho -> box q e).
Definition te (b e : R) : R := - v 5 b e / zt b e.
Definition tb (b e : R) : R := - v 8 b e / zt b e.
Definition d_e (i : nat) (b e : R) : R := v (by_e i) b e + fs b (vs b e) i * te b e.
Definition d_b (i : nat) (b e : R) : R := v (by_b i) b e + fs b (vs b e) i * tb b e.
Lemma room_box b e : room b e -> box b e.
Proof. intros [rho [P [H _]]]. apply H. rewrite Rminus_eq_0, Rabs_R0. lra. Qed.

Lemma v_by_e i b e : room b e -> In i places_e -> is_derive (fun q => v i b q) e (d_e i b e).
Proof.
  intros Hr Hi. pose proof (room_box b e Hr) as Hb. destruct Hr as [rho [P [H1 _]]].
  assert (A1 : In 2%nat places_e) by (cbn; tauto).
  assert (A2 : forall j, In j places_e -> (j < 18)%nat /\ (by_e j < 18)%nat).
  { intros j Hj. cbn in Hj. repeat (destruct Hj as [<-|Hj]; [cbn; lia|]). contradiction. }
  assert (A3 : exists K, 0 <= K /\ forall q j t, Rabs (q - e) <= rho -> In j places_e -> 0 <= t <= T ->
    Rabs (s j b q t - s j b e t - (q - e) * s (by_e j) b e t) <= K * (q - e) ^ 2).
  { destruct (st_by_e bc rb ec re T r T_pos solutions b e Hb) as [K [HK H]]. exists K. split; [assumption|]. intros q j t Hq Hj Ht. apply H; auto. }
  exact (v_derive (fun _ => b) (fun q => q) e rho by_e (fun i => In i places_e) P H1 A1 A2 A3 i Hi).
Qed.
Lemma v_by_b i b e : room b e -> (i < 6)%nat -> is_derive (fun q => v i q e) b (d_b i b e).
Proof.
  intros Hr Hi. pose proof (room_box b e Hr) as Hb. destruct Hr as [rho [P [_ H1]]].
  assert (A1 : (2 < 6)%nat) by lia.
  assert (A2 : forall j, (j < 6)%nat -> (j < 18)%nat /\ (by_b j < 18)%nat) by (intros j Hj; do 6 (destruct j as [|j]; [cbn; lia|]); lia).
  assert (A3 : exists K, 0 <= K /\ forall q j t, Rabs (q - b) <= rho -> (j < 6)%nat -> 0 <= t <= T ->
    Rabs (s j q e t - s j b e t - (q - b) * s (by_b j) b e t) <= K * (q - b) ^ 2).
  { destruct (st_by_b bc rb ec re T r T_pos solutions b e Hb) as [K [HK H]]. exists K. split; [assumption|]. intros q j t Hq Hj Ht. apply H; auto. }
  exact (v_derive (fun q => q) (fun _ => e) b rho by_b (fun i => (i < 6)%nat) P H1 A1 A2 A3 i Hi).
Qed.

(* Formulas at the crossing have derivatives that are formulas. *)
Definition ok_e (i : nat) : bool := existsb (Nat.eqb i) places_e.
Definition ok_b (i : nat) : bool := (i <? 6)%nat.
Lemma by_e_sound x b e : room b e -> places ok_e x = true -> is_derive (fun q => value b (vs b q) x) e (value b (vs b e) (De x)).
Proof.
  intros Hr Hx. apply (derived_sound d_by_e (Whole 0) (fun _ => b) (fun q => vs b q) e ok_e).
  - intros i Hi. apply existsb_exists in Hi. destruct Hi as [j [Hj E]]. apply Nat.eqb_eq in E. subst j.
    eapply der_eq; [exact (v_by_e i b e Hr Hj)|]. unfold d_e, d_by_e, te, zt. cbn [value]. rewrite (velocity_is b (vs b e) i Hj). unfold vs, Rdiv. ring.
  - exact (der_const b e).
  - repeat split.
  - exact (zt_nonzero b e (room_box b e Hr)).
  - exact Hx.
Qed.
Lemma by_b_sound x b e : room b e -> places ok_b x = true -> is_derive (fun q => value q (vs q e) x) b (value b (vs b e) (Db x)).
Proof.
  intros Hr Hx. apply (derived_sound d_by_b (Whole 1) (fun q => q) (fun q => vs q e) b ok_b).
  - intros i Hi. unfold ok_b in Hi. apply Nat.ltb_lt in Hi. assert (Hj : In i places_e) by (do 6 (destruct i as [|i]; [cbn; tauto|]); lia).
    eapply der_eq; [exact (v_by_b i b e Hr Hi)|]. unfold d_b, d_by_b, tb, zt. cbn [value]. rewrite (velocity_is b (vs b e) i Hj). unfold vs, Rdiv. ring.
  - exact (der_id b).
  - repeat split.
  - exact (zt_nonzero b e (room_box b e Hr)).
  - exact Hx.
Qed.
End Return.
