(* Solutions from all points of a box at once, with intervals for them on every step: the bounds of CheckedFlow.v hold for every
   beginning and every parameter that the elements of the first state stand for. *)

From Coq Require Import List ZArith Reals Lra Lia.
From Coquelicot Require Import Coquelicot.
From Bignums Require Import BigZ.
From Orbitproof Require Import Polynomials Elements Formats Programs Steps Sound.
From Solutions Require Import Comparison Flow Norms Values Fields CheckedSteps CheckedFlow InitialValues Dependence.
Import ListNotations.
Local Open Scope bool_scope.
Local Open Scope R_scope.
Local Open Scope list_scope.

(* Intervals with ends that are integers over 2^eps, or over another number. *)
Definition ends : Type := (bigZ * bigZ)%type.
Definition no_ends : ends := (0%bigZ, 0%bigZ).
Definition between (d : R) (b : ends) (u : R) : Prop := r_ (fst b) / d <= u <= r_ (snd b) / d.

(* What a polynomial with this error takes on [0, 1], and an element at theta = 0. *)
Definition reach (f : format) (p : poly) (e : norm) : ends :=
  let c := hd 0%bigZ p in let r := l1 (tl p) in
  ((down (c - r) (bits f - eps f) - total e)%bigZ, (up (c + r) (bits f - eps f) + total e)%bigZ).
Definition spot (f : format) (x : element) : ends := reach f [at_zero (hd [] (known x))] (unknown x).

Lemma reach_sound f p e theta u : 0 <= theta <= 1 -> Rabs (u - eval p theta / two_to (bits f)) <= as_number f e ->
  between (two_to (eps f)) (reach f p e) u.
Proof.
  intros Ht H. unfold between, reach. cbn [fst snd]. rewrite r_sub, r_add.
  set (c := hd 0%bigZ p) in *. set (q := tl p) in *.
  assert (E : Rabs (eval p theta - r_ c) <= r_ (l1 q)).
  { destruct p as [|a p]; unfold c, q; cbn [eval hd tl].
    - rewrite r_0, Rminus_0_r, Rabs_R0. apply l1_nonneg.
    - replace (r_ a + theta * eval p theta - r_ a) with (theta * eval p theta) by ring. rewrite Rabs_mult, (Rabs_pos_eq theta) by lra.
      pose proof (l1_is_a_bound p theta Ht). pose proof (Rabs_pos (eval p theta)). nra. }
  pose proof (down_is_below (c - l1 q)%bigZ (bits f - eps f)%bigZ) as D. pose proof (up_is_above (c + l1 q)%bigZ (bits f - eps f)%bigZ) as U.
  rewrite two_to_sub, r_sub in D. rewrite two_to_sub, r_add in U. unfold as_number, tot in H.
  pose proof (two_to_pos (bits f)) as Pb. pose proof (two_to_pos (eps f)) as Pe.
  set (x := r_ (down (c - l1 q)%bigZ (bits f - eps f)%bigZ)) in *. set (y := r_ (up (c + l1 q)%bigZ (bits f - eps f)%bigZ)) in *.
  set (P := two_to (bits f)) in *. set (Q := two_to (eps f)) in *. set (v := eval p theta) in *. set (l := r_ (l1 q)) in *. set (k := r_ c) in *.
  set (t := r_ (total e)) in *.
  assert (X : x / Q <= (k - l) / P).
  { apply (Rmult_le_reg_r Q); [assumption|]. replace (x / Q * Q) with x by (field; lra). replace ((k - l) / P * Q) with ((k - l) / (P / Q)) by (field; lra). lra. }
  assert (Y : (k + l) / P <= y / Q).
  { apply (Rmult_le_reg_r Q); [assumption|]. replace (y / Q * Q) with y by (field; lra). replace ((k + l) / P * Q) with ((k + l) / (P / Q)) by (field; lra). lra. }
  apply Rabs_le_between in E. apply Rabs_le_between in H.
  assert (V1 : (k - l) / P <= v / P) by (apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat; assumption | lra]).
  assert (V2 : v / P <= (k + l) / P) by (apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat; assumption | lra]).
  unfold Rdiv in *. rewrite Rmult_minus_distr_r, Rmult_plus_distr_r. lra.
Qed.
Lemma spot_sound f x u : holds f 0 x u -> between (two_to (eps f)) (spot f x) u.
Proof.
  intros [_ H]. unfold spot. apply (reach_sound f _ _ 0); [lra|]. unfold value in H. cbn [eval]. rewrite Rmult_0_l, Rplus_0_r, eval_at_zero. exact H.
Qed.

(* Where the solutions are when a step begins, and on all of it; last, where they end. *)
Record stage := Stage { at_start : list ends; within_step : list ends }.
Fixpoint stages (f : format) (p : program) (parameters from : state) (steps : list step) : option (list stage) :=
  match steps with
  | [] => Some [Stage (map (spot f) from) []]
  | s :: rest =>
      match check_step f p from parameters s with
      | Some found =>
          match stages f p parameters (at_end f s (errors found)) rest with
          | Some more => Some (Stage (map (spot f) from) (map2 (fun x e => reach f (hd [] x) e) (solution s) (errors found)) :: more)
          | None => None
          end
      | None => None
      end
  end.
Fixpoint passes (f : format) (m : nat) (steps : list step) (gs : list stage) (t : R) (y : nat -> R -> R) : Prop :=
  match gs with
  | [] => False
  | g :: gs' =>
      (forall i, (i < m)%nat -> between (two_to (eps f)) (nth i (at_start g) no_ends) (y i t)) /\
      match steps with
      | [] => True
      | s :: rest =>
          (forall i u, (i < m)%nat -> t <= u <= t + duration s -> between (two_to (eps f)) (nth i (within_step g) no_ends) (y i u)) /\
          passes f m rest gs' (t + duration s) y
      end
  end.
Definition forward (steps : list step) : Prop := List.Forall (fun s => 0 <= duration s) steps.
Lemma forward_total steps : forward steps -> 0 <= total_time steps.
Proof. induction 1 as [|s l Hs Hl IH]; cbn; [lra|]. unfold total_time in IH. lra. Qed.

Lemma passes_moved f m y y' c steps : forward steps -> forall gs t, passes f m steps gs t y ->
  (forall i u, (i < m)%nat -> t <= u <= t + total_time steps -> y' i (c + u) = y i u) -> passes f m steps gs (c + t) y'.
Proof.
  induction 1 as [|s rest Hs Hrest IH]; intros [|g gs] t H E; cbn [passes] in *; try assumption.
  - destruct H as [H _]. split; [|exact I]. intros i Hi. rewrite E by (assumption || (cbn; lra)). auto.
  - destruct H as [H1 [H2 H3]]. pose proof (forward_total rest Hrest) as P.
    assert (T : total_time (s :: rest) = duration s + total_time rest) by reflexivity. split; [|split].
    + intros i Hi. rewrite E by (assumption || lra). auto.
    + intros i u Hi Hu. replace u with (c + (u - c)) by ring. rewrite E by (assumption || lra). apply H2; [assumption | lra].
    + rewrite Rplus_assoc. apply IH; [assumption|]. intros i u Hi Hu. apply E; [assumption | lra].
Qed.

Lemma length_shorter {A B C} (op : A -> B -> C) l : forall l', length (map2 op l l') = Nat.min (length l) (length l').
Proof. induction l as [|x l IH]; intros [|z l']; cbn; auto. Qed.
Lemma nth_shorter {A B C} (op : A -> B -> C) da db dc l : forall l' i, (i < Nat.min (length l) (length l'))%nat ->
  nth i (map2 op l l') dc = op (nth i l da) (nth i l' db).
Proof. induction l as [|x l IH]; intros [|z l'] [|i] H; cbn in *; try lia; [reflexivity | apply IH; lia]. Qed.

Theorem stages_sound f p m parameters steps : plain f -> is_polynomial p = true ->
  forall from gs, length from = m -> stages f p parameters from steps = Some gs ->
  (exists u x, Forall2 (holds f 0) parameters u /\ forall i, (i < m)%nat -> holds f 0 (nth i from missing) (x i)) ->
  (forall a, Forall2 (holds f 0) parameters a -> forall theta, 0 <= theta <= 1 -> Forall2 (holds f theta) parameters a) ->
  forward steps /\ exists r, 0 <= r /\ forall a x0, Forall2 (holds f 0) parameters a -> (forall i, (i < m)%nat -> holds f 0 (nth i from missing) (x0 i)) ->
  exists y : nat -> R -> R, (forall i, (i < m)%nat -> y i 0 = x0 i) /\ solves m (field_of p m a) (total_time steps) y /\
    (forall i t, (i < m)%nat -> 0 <= t <= total_time steps -> Rabs (y i t) <= r) /\ passes f m steps gs 0 y.
Proof.
  intros f_plain Hp. pose proof (fun a => field_of_is_lipschitz p m a) as Lip.
  induction steps as [|s rest IH]; intros from gs L E [u0 [x1 [Hu0 Hx1]]] Const; cbn [stages] in E.
  - injection E as <-. split; [constructor|].
    destruct (at_once m (fun i K => forall x, holds f 0 (nth i from missing) x -> Rabs x <= K)) as [r [Hr Br]].
    { intros i K K' H Hk x Hx. specialize (H x Hx). lra. }
    { intros i Hi. exists (as_number f (size (nth i from missing)) + as_number f (unknown (nth i from missing))). split.
      - destruct (Hx1 i Hi) as [[_ Hu Hs _] _]. pose proof (as_number_nonneg f _ Hu). pose proof (as_number_nonneg f _ Hs). lra.
      - intros x Hx. apply (holds_bounded f 0). assumption. }
    exists r. split; [assumption|]. intros a x0 Ha Hx0. exists (fun i t => x0 i + t * field_of p m a x0 i). split; [intros; ring|]. split; [|split].
    + intros i t Hi Ht. cbn in Ht. assert (t = 0) by lra. subst t.
      replace (field_of p m a (fun j => x0 j + 0 * field_of p m a x0 j) i) with (field_of p m a x0 i)
        by (apply (field_ext m _ (Lip a)); [assumption | intros; ring]).
      auto_derive; [exact I | ring].
    + intros i t Hi Ht. cbn in Ht. assert (t = 0) by lra. subst t. rewrite Rmult_0_l, Rplus_0_r. apply (Br i Hi); auto.
    + cbn [passes at_start]. split; [|exact I]. intros i Hi. rewrite Rmult_0_l, Rplus_0_r.
      rewrite (nth_map (spot f) missing) by lia. apply spot_sound. auto.
  - destruct (check_step f p from parameters s) as [found|] eqn:C; [|discriminate].
    destruct (stages f p parameters (at_end f s (errors found)) rest) as [more|] eqn:E'; [|discriminate]. injection E as <-. subst m.
    set (m := length from) in *.
    pose proof (fun a x0 Ha Hx => check_step_sound f p from parameters s found a x0 f_plain Hp (Const a Ha) Hx C) as Step.
    destruct (Step u0 x1 Hu0 Hx1) as [Hh [Le [y1 [_ [_ [_ Y1]]]]]].
    destruct (IH (at_end f s (errors found)) more Le E') as [Fr [r [Hr IH']]].
    { exists u0, (fun i => y1 i (duration s)). split; [assumption|]. intros i Hi. apply Y1; [assumption | lra]. }
    { assumption. }
    assert (Fs : forward (s :: rest)) by (constructor; assumption). split; [assumption|].
    assert (Ls : (forall i, (i < m)%nat -> nth i (map2 (fun x e => reach f (hd [] x) e) (solution s) (errors found)) no_ends
                 = reach f (hd [] (nth i (solution s) [])) (nth i (errors found) []))).
    { intros i Hi. apply (nth_shorter (fun x e => reach f (hd [] x) e) [] ([] : norm)). unfold at_end in Le. rewrite length_shorter in Le. exact (eq_ind_r (fun z => (i < z)%nat) Hi Le). }
    set (d := fun i => as_number f (nth i (errors found) [])).
    destruct (at_once m (fun i K => forall theta x, 0 <= theta <= 1 -> Rabs (x - approximation f s i theta) <= d i -> Rabs x <= K)) as [r' [Hr' Br']].
    { intros i K K' H Hk theta x Ht Hx. specialize (H theta x Ht Hx). lra. }
    { intros i Hi. set (q := hd [] (nth i (solution s) [])).
      assert (B : forall theta x, 0 <= theta <= 1 -> Rabs (x - approximation f s i theta) <= d i -> Rabs x <= r_ (l1 q) / two_to (bits f) + d i).
      { intros theta x Ht Hx. unfold approximation in Hx. fold q in Hx.
        assert (V : Rabs (eval q theta / two_to (bits f)) <= r_ (l1 q) / two_to (bits f)) by (rewrite scaled_abs; apply scaled_le, l1_is_a_bound; assumption).
        apply Rabs_le_between in V, Hx. apply Rabs_le. lra. }
      exists (Rabs (r_ (l1 q) / two_to (bits f) + d i)). split; [apply Rabs_pos|].
      intros theta x Ht Hx. eapply Rle_trans; [apply (B theta x Ht Hx) | apply Rle_abs]. }
    exists (r + r'). split; [lra|]. intros a x0 Ha Hx0. destruct (Step a x0 Ha Hx0) as [_ [_ [y [Y0 [Ys [Yd Ye]]]]]].
    destruct (IH' a (fun i => y i (duration s)) Ha) as [z [Z0 [Zs [Zb Zp]]]]; [intros i Hi; apply Ye; [assumption | lra]|].
    pose proof (forward_total rest Fr) as Tr.
    assert (T : total_time (s :: rest) = duration s + total_time rest) by reflexivity.
    assert (Theta : forall t, 0 <= t <= duration s -> exists theta, 0 <= theta <= 1 /\ forall i, (i < m)%nat -> Rabs (y i t - approximation f s i theta) <= d i).
    { intros t Ht. exists (t / duration s). split; [|intros i Hi; apply Yd; assumption].
      destruct (Req_dec (duration s) 0) as [Z|Z].
      - rewrite Z. unfold Rdiv. replace t with 0 by lra. rewrite Rmult_0_l. lra.
      - split; [apply Rle_mult_inv_pos; lra|]. apply (Rmult_le_reg_r (duration s)); [lra|]. unfold Rdiv. rewrite Rmult_assoc, Rinv_l by assumption. lra. }
    exists (glued (duration s) y z). split; [|split; [|split]].
    + intros i Hi. rewrite glued_before by assumption. auto.
    + rewrite T. apply glued_solves; auto.
    + intros i t Hi Ht. rewrite T in Ht. destruct (Rle_lt_dec t (duration s)) as [Hs|Hs].
      * rewrite glued_before by assumption. destruct (Theta t ltac:(lra)) as [theta [Th D]]. specialize (Br' i Hi theta _ Th (D i Hi)). lra.
      * rewrite (glued_after m (duration s) y z Z0) by (assumption || lra). specialize (Zb i (t - duration s) Hi ltac:(lra)). lra.
    + cbn [passes at_start within_step]. split; [|split].
      * intros i Hi. rewrite glued_before by assumption. rewrite Y0 by assumption. rewrite (nth_map (spot f) missing) by assumption. apply spot_sound. auto.
      * intros i u Hi Hu. rewrite Rplus_0_l in Hu. rewrite glued_before by lra. rewrite Ls by assumption. destruct (Theta u Hu) as [theta [Th D]].
        apply (reach_sound f _ _ theta); [assumption|]. exact (D i Hi).
      * rewrite Rplus_comm. apply (passes_moved f m z); [assumption | assumption|]. intros i u Hi Hu.
        rewrite (glued_after m (duration s) y z Z0) by (assumption || lra). f_equal. ring.
Qed.

(* A box: exact centres and radii. *)
Definition wide (f : format) (centre radius : ratio) : element :=
  let x := econst f (fst centre) (snd centre) in
  element_of f (known x) (raise 0 (quotient_up (BigZ.shiftl (fst radius) (eps f)) (snd radius)) (unknown x)).
Definition is_wide (b : ratio * ratio) : bool := is_ratio (fst b) && is_ratio (snd b) && (0 <=? fst (snd b))%bigZ.
Definition in_wide (b : ratio * ratio) (u : R) : Prop := Rabs (u - real_of (fst b)) <= real_of (snd b).

Lemma wide_holds f theta b u : plain f -> (0 <= BigZ.to_Z (eps f))%Z -> 0 <= theta <= 1 -> is_wide b = true -> in_wide b u ->
  holds f theta (wide f (fst b) (snd b)) u.
Proof.
  intros Hf He Ht W H. destruct b as [[n d] [rn rd]]. unfold is_wide, is_ratio, in_wide, real_of in *. cbn [fst snd] in *.
  apply andb_prop in W. destruct W as [W W3]. apply andb_prop in W. destruct W as [W1 W2]. apply r_ltb in W1, W2. apply r_leb in W3. rewrite r_0 in *.
  destruct (holds_const f theta Hf Ht n d W1) as [[[p [Ep Lp]] Ux _ _] V]. unfold wide. cbn [fst snd]. rewrite Ep.
  assert (Q : 0 <= r_ (BigZ.shiftl rn (eps f))) by (destruct (r_shiftl rn (eps f)) as [S|S]; [rewrite S; apply Rmult_le_pos; [assumption | left; apply two_to_pos] | lia]).
  set (k := quotient_up (BigZ.shiftl rn (eps f)) rd).
  destruct (as_number_raise f k _ Ux) as [S N]; [apply quotient_up_nonneg; assumption|].
  apply element_holds; [assumption.. | rewrite N]. unfold value in V. rewrite Ep in V. cbn [hd] in V.
  assert (R : r_ rn / r_ rd <= r_ k / two_to (eps f)).
  { pose proof (quotient_up_above (BigZ.shiftl rn (eps f)) rd W2) as Q'. fold k in Q'. destruct (r_shiftl rn (eps f)) as [E|E]; [rewrite E in Q' | lia].
    pose proof (two_to_pos (eps f)) as P. apply (Rmult_le_reg_r (two_to (eps f))); [assumption|].
    replace (r_ k / two_to (eps f) * two_to (eps f)) with (r_ k) by (field; lra).
    replace (r_ rn / r_ rd * two_to (eps f)) with (r_ rn * two_to (eps f) / r_ rd) by (field; lra). exact Q'. }
  apply Rabs_le_between in V, H. apply Rabs_le. lra.
Qed.

(* A claim: in which intervals, over a common denominator, the solutions are when step number k begins, or on all of it. *)
Record claim := Claim { on_the_step : bool; number : nat; intervals : list ends }.
Record box_problem := BoxProblem {
  box_field : program;
  box_parameters : list (ratio * ratio);
  box_start : list (ratio * ratio);
  box_format : format;
  box_steps : list step;
  box_denominator : bigZ;
  box_claims : list claim
}.
Definition inside (f : format) (d : bigZ) (found claimed : ends) : bool :=
  ((BigZ.shiftl (fst claimed) (eps f) <=? fst found * d) && (snd found * d <=? BigZ.shiftl (snd claimed) (eps f)))%bigZ.
Definition stage_ends (gs : list stage) (c : claim) : list ends :=
  let g := nth (number c) gs (Stage [] []) in if on_the_step c then within_step g else at_start g.
Definition claim_checked (f : format) (d : bigZ) (n m : nat) (gs : list stage) (c : claim) : bool :=
  (if on_the_step c then number c <? n else number c <=? n)%nat && (length (intervals c) =? m)%nat && (length (stage_ends gs c) =? m)%nat
  && forallb (fun fc => inside f d (fst fc) (snd fc)) (combine (stage_ends gs c) (intervals c)).
Definition box_solved (q : box_problem) : bool :=
  let f := box_format q in let m := length (box_start q) in
  is_plain f && is_polynomial (box_field q) && forallb is_wide (box_parameters q) && forallb is_wide (box_start q)
  && (0 <? box_denominator q)%bigZ
  && match stages f (box_field q) (map (fun b => wide f (fst b) (snd b)) (box_parameters q)) (map (fun b => wide f (fst b) (snd b)) (box_start q)) (box_steps q) with
     | Some gs => forallb (claim_checked f (box_denominator q) (length (box_steps q)) m gs) (box_claims q)
     | None => false
     end.

Definition time_of (steps : list step) (k : nat) : R := total_time (firstn k steps).
Definition claim_holds (q : box_problem) (y : nat -> R -> R) (c : claim) : Prop :=
  forall i t, (i < length (box_start q))%nat ->
    (if on_the_step c then time_of (box_steps q) (number c) <= t <= time_of (box_steps q) (S (number c)) else t = time_of (box_steps q) (number c)) ->
    between (r_ (box_denominator q)) (nth i (intervals c) no_ends) (y i t).

Lemma inside_sound f d found claimed u : (0 <= BigZ.to_Z (eps f))%Z -> 0 < r_ d -> inside f d found claimed = true ->
  between (two_to (eps f)) found u -> between (r_ d) claimed u.
Proof.
  intros He Hd H [B1 B2]. unfold inside in H. apply andb_prop in H. destruct H as [H1 H2]. apply r_leb in H1, H2. rewrite r_mul in H1, H2.
  destruct (r_shiftl (fst claimed) (eps f)) as [E1|E1]; [rewrite E1 in H1 | lia]. destruct (r_shiftl (snd claimed) (eps f)) as [E2|E2]; [rewrite E2 in H2 | lia].
  pose proof (two_to_pos (eps f)) as P. set (Q := two_to (eps f)) in *. set (D := r_ d) in *. split.
  - eapply Rle_trans; [|exact B1]. apply (Rmult_le_reg_r (Q * D)); [nra|].
    replace (r_ (fst claimed) / D * (Q * D)) with (r_ (fst claimed) * Q) by (field; lra). replace (r_ (fst found) / Q * (Q * D)) with (r_ (fst found) * D) by (field; lra). exact H1.
  - eapply Rle_trans; [exact B2|]. apply (Rmult_le_reg_r (Q * D)); [nra|].
    replace (r_ (snd claimed) / D * (Q * D)) with (r_ (snd claimed) * Q) by (field; lra). replace (r_ (snd found) / Q * (Q * D)) with (r_ (snd found) * D) by (field; lra). exact H2.
Qed.
Lemma passes_at f m y steps : forall gs t k, passes f m steps gs t y -> (k <= length steps)%nat ->
  (forall i, (i < m)%nat -> between (two_to (eps f)) (nth i (at_start (nth k gs (Stage [] []))) no_ends) (y i (t + time_of steps k))) /\
  ((k < length steps)%nat -> forall i u, (i < m)%nat -> t + time_of steps k <= u <= t + time_of steps (S k) ->
    between (two_to (eps f)) (nth i (within_step (nth k gs (Stage [] []))) no_ends) (y i u)).
Proof.
  induction steps as [|s rest IH]; intros [|g gs] t k H Hk; cbn [passes] in H; try contradiction.
  - cbn in Hk. assert (k = O) as -> by lia. destruct H as [H _]. cbn. split; [|intros; lia]. intros i Hi. rewrite Rplus_0_r. auto.
  - destruct H as [H1 [H2 H3]]. destruct k as [|k].
    + cbn. split; [intros i Hi; rewrite Rplus_0_r; auto|]. intros _ i u Hi Hu. apply H2; [assumption | lra].
    + cbn [length] in Hk. destruct (IH gs (t + duration s) k H3 ltac:(lia)) as [I1 I2].
      assert (E : forall j, time_of (s :: rest) (S j) = duration s + time_of rest j) by reflexivity. cbn [nth]. split.
      * intros i Hi. rewrite E, <- Rplus_assoc. auto.
      * intros Hk' i u Hi Hu. apply I2; [cbn in Hk'; lia | assumption | rewrite !E in Hu; lra].
Qed.

Theorem box_solved_sound q : box_solved q = true ->
  let m := length (box_start q) in let T := time_of (box_steps q) (length (box_steps q)) in
  (forall k l, (k <= l)%nat -> time_of (box_steps q) k <= time_of (box_steps q) l) /\
  exists r, 0 <= r /\ forall a x0, Forall2 in_wide (box_parameters q) a -> Forall2 in_wide (box_start q) x0 ->
  exists y : nat -> R -> R, (forall i, (i < m)%nat -> y i 0 = nth i x0 0) /\ solves m (field_of (box_field q) m a) T y /\
    (forall i t, (i < m)%nat -> 0 <= t <= T -> Rabs (y i t) <= r) /\ List.Forall (claim_holds q y) (box_claims q).
Proof.
  unfold box_solved. intros H. cbv zeta in *. set (T := time_of (box_steps q) (length (box_steps q))). set (m := length (box_start q)) in *. set (f := box_format q) in *.
  apply andb_prop in H; destruct H as [H H6]. apply andb_prop in H; destruct H as [H H5].
  apply andb_prop in H; destruct H as [H H4]. apply andb_prop in H; destruct H as [H H3]. apply andb_prop in H; destruct H as [H1 H2].
  destruct (is_plain_sound _ H1) as [f_plain He]. apply r_ltb in H5. rewrite r_0 in H5.
  match type of H6 with match ?s with _ => _ end = _ => destruct s as [gs|] eqn:E; [|discriminate] end.
  set (P := map (fun b => wide f (fst b) (snd b)) (box_parameters q)) in *. set (S0 := map (fun b => wide f (fst b) (snd b)) (box_start q)) in *.
  assert (W : forall bs us theta, forallb is_wide bs = true -> 0 <= theta <= 1 -> Forall2 in_wide bs us -> Forall2 (holds f theta) (map (fun b => wide f (fst b) (snd b)) bs) us).
  { intros bs us theta Hb Ht Hu. revert Hb. induction Hu as [|b u bs us Hbu Hu IH]; intros Hb; cbn in *; constructor; apply andb_prop in Hb; destruct Hb as [Hb1 Hb2].
    - apply wide_holds; assumption.
    - auto. }
  assert (Mid : forall bs, forallb is_wide bs = true -> Forall2 in_wide bs (map (fun b => real_of (fst b)) bs)).
  { intros bs. induction bs as [|b bs IH]; intros Hb; cbn in *; constructor; apply andb_prop in Hb; destruct Hb as [Hb1 Hb2]; [|auto].
    unfold in_wide. rewrite Rminus_eq_0, Rabs_R0. unfold is_wide, is_ratio in Hb1. apply andb_prop in Hb1. destruct Hb1 as [Hb1 B3]. apply andb_prop in Hb1. destruct Hb1 as [_ B2].
    apply r_ltb in B2. apply r_leb in B3. rewrite r_0 in *. apply Rle_mult_inv_pos; assumption. }
  assert (LS : length S0 = m) by (unfold S0; apply map_length).
  assert (Nth : forall x0 theta, Forall2 (holds f theta) S0 x0 -> forall i, (i < m)%nat -> holds f theta (nth i S0 missing) (nth i x0 0)).
  { intros x0 theta Hx i Hi. apply Forall2_nth; [assumption | lia]. }
  destruct (stages_sound f (box_field q) m P (box_steps q) f_plain H2 S0 gs LS E) as [Fr [r [Hr Sol]]].
  { exists (map (fun b => real_of (fst b)) (box_parameters q)), (fun i => nth i (map (fun b => real_of (fst b)) (box_start q)) 0). split.
    - apply W; [assumption | lra | auto].
    - apply Nth. apply W; [assumption | lra | auto]. }
  { intros a Ha theta Ht. unfold P in *. clear -Ha Ht f_plain. remember (map (fun b => wide f (fst b) (snd b)) (box_parameters q)) as l eqn:El.
    assert (C : List.Forall (fun e => exists c, known e = [[c]]) l).
    { subst l. clear -f_plain. induction (box_parameters q) as [|b bs IH]; cbn; constructor; [|assumption]. unfold wide, element_of, econst. cbn [known element_of].
      rewrite (plain_grades f f_plain). cbn. eexists. reflexivity. }
    clear El. induction Ha as [|e u l us [He1 He2] Hl IH]; constructor; inversion C as [|? ? [c Ec] C']; subst; [|auto].
    destruct He1 as [Kn Un Sz V]. unfold value in *. rewrite Ec in *. cbn [hd eval] in *. rewrite !Rmult_0_r in *.
    split; [split; try assumption; [rewrite Ec; assumption|] |]; unfold value; rewrite Ec; cbn [hd eval]; rewrite Rmult_0_r; assumption. }
  assert (TT : T = total_time (box_steps q)) by (unfold T, time_of; rewrite firstn_all; reflexivity).
  split.
  - intros k l. clear -Fr. revert k l. induction Fr as [|s rest Hs Hl IH]; intros [|k] [|l] Hkl; try lia; try (cbn; lra).
    + assert (X : time_of (s :: rest) 0 = 0) by reflexivity. assert (Y : time_of (s :: rest) (S l) = duration s + time_of rest l) by reflexivity.
      specialize (IH O l ltac:(lia)). assert (Z : time_of rest 0 = 0) by reflexivity. lra.
    + assert (X : forall j, time_of (s :: rest) (S j) = duration s + time_of rest j) by reflexivity. rewrite !X. specialize (IH k l ltac:(lia)). lra.
  - exists r. split; [assumption|]. intros a x0 Ha Hx0. destruct (Sol a (fun i => nth i x0 0)) as [y [Y0 [Ys [Yb Yp]]]].
    + apply W; [assumption | lra | assumption].
    + apply Nth. apply W; [assumption | lra | assumption].
    + exists y. rewrite TT. split; [assumption|]. split; [assumption|]. split; [assumption|]. apply Forall_forall. intros c Hc.
      rewrite forallb_forall in H6. specialize (H6 c Hc). unfold claim_checked in H6.
      apply andb_prop in H6. destruct H6 as [H6 Q4]. apply andb_prop in H6. destruct H6 as [H6 Q3]. apply andb_prop in H6. destruct H6 as [Q1 Q2].
      apply Nat.eqb_eq in Q2, Q3. intros i t Hi Ht.
      assert (B : between (two_to (eps f)) (nth i (stage_ends gs c) no_ends) (y i t)).
      { unfold stage_ends. destruct (on_the_step c).
        - apply Nat.ltb_lt in Q1. destruct (passes_at f m y (box_steps q) gs 0 (number c) Yp) as [_ P2]; [lia|]. apply P2; [assumption | assumption|]. rewrite !Rplus_0_l. assumption.
        - apply Nat.leb_le in Q1. destruct (passes_at f m y (box_steps q) gs 0 (number c) Yp) as [P1 _]; [lia|]. subst t. specialize (P1 i Hi). rewrite Rplus_0_l in P1. exact P1. }
      pose proof (forallb_nth2 _ _ _ no_ends no_ends i Q4 (eq_trans Q3 (eq_sym Q2)) ltac:(rewrite Q3; exact Hi)) as I. cbn [fst snd] in I.
      exact (inside_sound f (box_denominator q) _ _ _ He H5 I B).
Qed.
