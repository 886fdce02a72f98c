(* Initial value problems: exact rational numbers in, rational bounds out; the statement is about real functions only. *)

From Coq Require Import List ZArith Reals Lra Lia.
From Coquelicot Require Import Coquelicot.
From Bignums Require Import BigZ.
From Orbitproof Require Import Polynomials Elements Formats Programs Steps Sound.
From Solutions Require Import Comparison Flow Norms Values Fields CheckedSteps CheckedFlow.
Import ListNotations.
Local Open Scope R_scope.
Local Open Scope list_scope.

(* One step after the other. *)
Fixpoint flow_along (f : format) (p : program) (parameters from : state) (steps : list step) : option state :=
  match steps with
  | [] => Some from
  | s :: rest =>
      match check_step f p from parameters s with
      | Some found => flow_along f p parameters (at_end f s (errors found)) rest
      | None => None
      end
  end.
Definition total_time (steps : list step) : R := fold_right (fun s t => duration s + t) 0 steps.

Theorem flow_along_sound f p m parameters a steps : plain f -> is_polynomial p = true ->
  (forall theta, 0 <= theta <= 1 -> Forall2 (holds f theta) parameters a) ->
  forall from to x0, length from = m -> (forall i, (i < m)%nat -> holds f 0 (nth i from missing) (x0 i)) ->
  flow_along f p parameters from steps = Some to ->
  length to = m /\ 0 <= total_time steps /\ exists y : nat -> R -> R,
    (forall i, (i < m)%nat -> y i 0 = x0 i) /\ solves m (field_of p m a) (total_time steps) y /\
    (forall i, (i < m)%nat -> holds f 0 (nth i to missing) (y i (total_time steps))).
Proof.
  intros f_plain Hp Ha. pose proof (field_of_is_lipschitz p m a) as Lip.
  induction steps as [|s rest IH]; intros from to x0 L H0 E; cbn [flow_along total_time fold_right] in *.
  - injection E as <-. split; [assumption|]. split; [lra|]. exists (fun i t => x0 i + t * field_of p m a x0 i).
    split; [intros; ring|]. split.
    + intros i t Hi Ht. assert (t = 0) by lra. subst t.
      replace (field_of p m a (fun j => x0 j + 0 * field_of p m a x0 j) i) with (field_of p m a x0 i)
        by (apply (field_ext m _ Lip); [assumption | intros; ring]).
      auto_derive; [exact I | ring].
    + intros i Hi. replace (x0 i + 0 * field_of p m a x0 i) with (x0 i) by ring. auto.
  - destruct (check_step f p from parameters s) as [found|] eqn:C; [|discriminate]. subst m.
    destruct (check_step_sound f p from parameters s found a x0 f_plain Hp Ha H0 C) as [Hh [Le [y [Y0 [Ys [_ Ye]]]]]].
    destruct (IH (at_end f s (errors found)) to (fun i => y i (duration s)) Le) as [Lt [Hr [z [Z0 [Zs Ze]]]]]; [|assumption|].
    { intros i Hi. apply Ye; [assumption | lra]. }
    fold (total_time rest). split; [assumption|]. split; [lra|]. exists (glued (duration s) y z).
    split; [|split].
    + intros i Hi. rewrite glued_before by assumption. auto.
    + apply glued_solves; auto.
    + intros i Hi. rewrite (glued_after (length from) (duration s) y z Z0) by (assumption || lra).
      replace (duration s + total_time rest - duration s) with (total_time rest) by ring. auto.
Qed.

(* Rational numbers, and balls of rational numbers with one denominator. *)
Definition ratio : Type := (bigZ * bigZ)%type.
Definition real_of (q : ratio) : R := r_ (fst q) / r_ (snd q).
Definition is_ratio (q : ratio) : bool := (0 <? snd q)%bigZ.
Definition exactly (f : format) (qs : list ratio) : state := map (fun q => econst f (fst q) (snd q)) qs.

Lemma exactly_holds f qs theta : plain f -> 0 <= theta <= 1 -> forallb is_ratio qs = true ->
  Forall2 (holds f theta) (exactly f qs) (map real_of qs).
Proof.
  intros Hf Ht. induction qs as [|q qs IH]; intros H; cbn in *; constructor; apply andb_prop in H; destruct H as [H1 H2].
  - apply holds_const; try assumption. apply r_ltb in H1. rewrite r_0 in H1. assumption.
  - auto.
Qed.

(* All numbers of an element are within radius / denominator of centre / denominator. *)
Definition within (f : format) (denominator : bigZ) (e : element) (ball : bigZ * bigZ) : bool :=
  let q := at_zero (hd [] (known e)) in
  (BigZ.shiftl (BigZ.abs (q * denominator - BigZ.shiftl (fst ball) (bits f))) (eps f)
   + BigZ.shiftl (total (unknown e) * denominator) (bits f) <=? BigZ.shiftl (snd ball) (bits f + eps f))%bigZ.

Lemma within_sound f d e ball u : plain f -> (0 <= BigZ.to_Z (eps f))%Z -> 0 < r_ d -> holds f 0 e u ->
  within f d e ball = true -> Rabs (u - r_ (fst ball) / r_ d) <= r_ (snd ball) / r_ d.
Proof.
  intros f_plain He Hd [_ H] W. unfold within in W. apply r_leb in W. pose proof (plain_bits f f_plain) as Hb.
  assert (Sh : forall x k, (0 <= BigZ.to_Z k)%Z -> r_ (BigZ.shiftl x k) = r_ x * two_to k).
  { intros x k Hk. destruct (r_shiftl x k) as [E|E]; [exact E | lia]. }
  rewrite r_add, !Sh in W by (try rewrite BigZ.spec_add; lia). rewrite r_abs, r_sub, !r_mul, Sh, two_to_add in W by assumption.
  unfold value in H. rewrite <- eval_at_zero in H. unfold as_number, tot in H.
  set (q := r_ (at_zero (hd [] (known e)))) in *. set (U := r_ (total (unknown e))) in *.
  pose proof (two_to_pos (bits f)) as PB. pose proof (two_to_pos (eps f)) as PE.
  set (B := two_to (bits f)) in *. set (E := two_to (eps f)) in *. set (D := r_ d) in *. set (C := r_ (fst ball)) in *.
  assert (A : Rabs (q / B - C / D) = Rabs (q * D - C * B) / (B * D)).
  { replace (q / B - C / D) with ((q * D - C * B) / (B * D)) by (field; lra). unfold Rdiv.
    rewrite Rabs_mult, (Rabs_pos_eq (/ (B * D))); [reflexivity|]. left. apply Rinv_0_lt_compat. nra. }
  pose proof (Rabs_triang (u - q / B) (q / B - C / D)) as T. replace (u - q / B + (q / B - C / D)) with (u - C / D) in T by ring.
  eapply Rle_trans; [exact T|]. rewrite A. apply Rle_trans with (U / E + Rabs (q * D - C * B) / (B * D)); [lra|].
  apply (Rmult_le_reg_l (B * E * D)); [apply Rmult_lt_0_compat; [apply Rmult_lt_0_compat|]; assumption|].
  replace (B * E * D * (U / E + Rabs (q * D - C * B) / (B * D))) with (Rabs (q * D - C * B) * E + U * D * B) by (field; lra).
  replace (B * E * D * (r_ (snd ball) / D)) with (r_ (snd ball) * (B * E)) by (field; lra). exact W.
Qed.

(* A problem with its solution as it is written down; nothing is believed of the steps. *)
Record problem := Problem {
  the_field : program;
  the_parameters : list ratio;
  the_start : list ratio;
  the_time : ratio;
  the_balls : list (bigZ * bigZ) * bigZ  (* centres and radii, and their denominator *);
  the_format : format;
  the_steps : list step
}.

Definition is_plain (f : format) : bool :=
  match grades f, pairs f with
  | [O], [[(O, O)]] => (1 <=? kept f)%nat && (0 <=? bits f)%bigZ && (0 <=? eps f)%bigZ
  | _, _ => false
  end.
(* The sum of the lengths of the steps, over 2^k. *)
Definition clock_of (k : bigZ) (steps : list step) : bigZ :=
  fold_right (fun s t => (BigZ.shiftl (numerator s) (k - denominator s) + t)%bigZ) 0%bigZ steps.
Definition finest (steps : list step) : bigZ := fold_right (fun s k => BigZ.max (denominator s) k) 0%bigZ steps.

Definition solved (q : problem) : bool :=
  let f := the_format q in
  is_plain f && is_polynomial (the_field q) && forallb is_ratio (the_parameters q) && forallb is_ratio (the_start q)
  && is_ratio (the_time q) && (0 <? snd (the_balls q))%bigZ
  && (clock_of (finest (the_steps q)) (the_steps q) * snd (the_time q)
      =? BigZ.shiftl (fst (the_time q)) (finest (the_steps q)))%bigZ
  && match flow_along f (the_field q) (exactly f (the_parameters q)) (exactly f (the_start q)) (the_steps q) with
     | Some to => (length (fst (the_balls q)) =? length to)%nat
                  && forallb (fun eb => within f (snd (the_balls q)) (fst eb) (snd eb)) (combine to (fst (the_balls q)))
     | None => false
     end.

Lemma is_plain_sound f : is_plain f = true -> plain f /\ (0 <= BigZ.to_Z (eps f))%Z.
Proof.
  unfold is_plain. intros H. destruct (grades f) as [|[|g] [|g' gs]] eqn:G; try discriminate.
  destruct (pairs f) as [|[|[[|a] [|b]] [|c l]] [|l' ls]] eqn:P; try discriminate.
  apply andb_prop in H. destruct H as [H H3]. apply andb_prop in H. destruct H as [H1 H2].
  apply Nat.leb_le in H1. rewrite BigZ.spec_leb in H2, H3. apply Z.leb_le in H2. apply Z.leb_le in H3.
  change (BigZ.to_Z 0%bigZ) with 0%Z in *. split; [split; assumption | assumption].
Qed.
Lemma finest_above steps s : In s steps -> (BigZ.to_Z (denominator s) <= BigZ.to_Z (finest steps))%Z.
Proof.
  induction steps as [|t steps IH]; intros H; [destruct H|]. cbn [finest fold_right]. rewrite BigZ.spec_max.
  destruct H as [->|H]; [lia|]. specialize (IH H). unfold finest in IH. lia.
Qed.
Lemma clock_is k steps : (forall s, In s steps -> (BigZ.to_Z (denominator s) <= BigZ.to_Z k)%Z) ->
  r_ (clock_of k steps) = two_to k * total_time steps.
Proof.
  induction steps as [|s steps IH]; intros H; cbn [clock_of total_time fold_right]; [rewrite r_0; ring|].
  fold (clock_of k steps) (total_time steps). rewrite r_add, IH by (intros; apply H; right; assumption).
  specialize (H s (or_introl eq_refl)). destruct (r_shiftl (numerator s) (k - denominator s)) as [E|E].
  - rewrite E, two_to_sub. unfold duration. pose proof (two_to_pos (denominator s)). field. lra.
  - rewrite BigZ.spec_sub in E. lia.
Qed.

(* What is solved: y' = f(y), y(0) given, on [0, T], and where y(T) is. *)
Definition has_a_solution (q : problem) : Prop :=
  let m := length (the_start q) in
  let f := field_of (the_field q) m (map real_of (the_parameters q)) in
  let T := real_of (the_time q) in
  exists y : nat -> R -> R,
    (forall i, (i < m)%nat -> y i 0 = nth i (map real_of (the_start q)) 0) /\
    (forall i t, (i < m)%nat -> 0 <= t <= T -> is_derive (y i) t (f (fun j => y j t) i)) /\
    (forall i, (i < m)%nat ->
       let ball := nth i (fst (the_balls q)) (0%bigZ, 0%bigZ) in
       let D := r_ (snd (the_balls q)) in Rabs (y i T - r_ (fst ball) / D) <= r_ (snd ball) / D) /\
    (forall z : nat -> R -> R, (forall i, (i < m)%nat -> z i 0 = y i 0) ->
       (forall i t, (i < m)%nat -> 0 <= t <= T -> is_derive (z i) t (f (fun j => z j t) i)) ->
       forall i t, (i < m)%nat -> 0 <= t <= T -> z i t = y i t).

Theorem solved_sound q : solved q = true -> has_a_solution q.
Proof.
  unfold solved, has_a_solution. cbv zeta. intros H.
  apply andb_prop in H; destruct H as [H H8]. apply andb_prop in H; destruct H as [H H7].
  apply andb_prop in H; destruct H as [H H6]. apply andb_prop in H; destruct H as [H H5].
  apply andb_prop in H; destruct H as [H H4]. apply andb_prop in H; destruct H as [H H3].
  apply andb_prop in H; destruct H as [H1 H2].
  destruct (is_plain_sound _ H1) as [f_plain He]. set (f := the_format q) in *.
  apply r_ltb in H6. rewrite r_0 in H6. unfold is_ratio in H5. apply r_ltb in H5. rewrite r_0 in H5.
  assert (Time : total_time (the_steps q) = real_of (the_time q)).
  { apply BigZ.eqb_eq in H7. set (k := finest (the_steps q)) in *.
    assert (E : r_ (clock_of k (the_steps q) * snd (the_time q))%bigZ = r_ (BigZ.shiftl (fst (the_time q)) k)) by (unfold r_; f_equal; exact H7).
    rewrite r_mul, (clock_is k (the_steps q) (finest_above (the_steps q))) in E. pose proof (two_to_pos k) as Pk.
    assert (Hk : (0 <= BigZ.to_Z k)%Z).
    { unfold k. clear. induction (the_steps q) as [|s l IH]; cbn [finest fold_right]; [cbn; lia|]. rewrite BigZ.spec_max. unfold finest in IH. lia. }
    destruct (r_shiftl (fst (the_time q)) k) as [S|S]; [rewrite S in E | lia]. unfold real_of.
    apply (Rmult_eq_reg_l (two_to k * r_ (snd (the_time q)))); [|apply Rgt_not_eq, Rmult_lt_0_compat; assumption].
    transitivity (two_to k * total_time (the_steps q) * r_ (snd (the_time q))); [ring|]. rewrite E. field. lra. }
  destruct (flow_along f (the_field q) (exactly f (the_parameters q)) (exactly f (the_start q)) (the_steps q)) as [to|] eqn:E; [|discriminate].
  apply andb_prop in H8. destruct H8 as [L8 H8]. apply Nat.eqb_eq in L8.
  set (m := length (the_start q)) in *. set (x0 := fun i => nth i (map real_of (the_start q)) 0).
  assert (Lm : length (exactly f (the_start q)) = m) by (unfold exactly; apply map_length).
  destruct (flow_along_sound f (the_field q) m (exactly f (the_parameters q)) (map real_of (the_parameters q)) (the_steps q) f_plain H2
    (fun theta Ht => exactly_holds f _ theta f_plain Ht H3) (exactly f (the_start q)) to x0 Lm) as [Lt [Ht [y [Y0 [Ys Yb]]]]]; [|assumption|].
  { intros i Hi. apply Forall2_nth; [apply exactly_holds; try assumption; lra | rewrite Lm; assumption]. }
  rewrite Time in *. exists y. split; [exact Y0|]. split; [exact Ys|]. split.
  - intros i Hi.
    assert (W : within f (snd (the_balls q)) (nth i to missing) (nth i (fst (the_balls q)) (0%bigZ, 0%bigZ)) = true).
    { apply (forallb_nth2 _ _ _ missing (0%bigZ, 0%bigZ) i H8); [symmetry; exact L8 | exact (below Hi Lt)]. }
    apply (within_sound f _ (nth i to missing)); auto.
  - intros z Z0 Zs i t Hi Hit. apply (unique m _ (field_of_is_lipschitz (the_field q) m (map real_of (the_parameters q))) (real_of (the_time q)) z y);
      try assumption; lra.
Qed.

(* For statements in formulas: integers are written as such, and fields of programs as sums and products. *)
Ltac numbers := repeat match goal with
  |- context [r_ ?c] => let n := eval vm_compute in (BigZ.to_Z c) in change (r_ c) with (IZR n) end.
Ltac in_formulas := cbn -[r_ real_of Rplus Rminus Rmult Rdiv Rinv Ropp Rabs Rle]; unfold real_of; cbn [fst snd]; numbers.
Ltac same_number := in_formulas; field.
(* From what is known of a solution y, component by component. *)
Ltac derivative H :=
  match type of H with is_derive ?u ?s ?l =>
    match goal with |- is_derive _ _ ?k =>
      let E := fresh in assert (E : @eq R l k) by same_number; exact (eq_rect l (fun z => is_derive u s z) H k E)
    end end.
