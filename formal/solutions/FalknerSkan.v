(* Orbits of k times the period branch off in the Falkner-Skan equation: the theorems of Statements.v, from numbers and two lists of
   steps that the kernel has checked: around the box, and from its centre. *)

From Coq Require Import List Bool ZArith Reals Lra Lia.
From Coquelicot Require Import Coquelicot.
From Bignums Require Import BigZ.
From Orbitproof Require Import Polynomials Intervals Elements Formats Programs Steps Sound SoundIntervals.
From Solutions Require Import Comparison Existence Flow Norms Values Fields CheckedFlow InitialValues Dependence Boxes Curves Variations Formulas Returns.
From Solutions Require Import Statements HalfOrbits.
Import ListNotations.
Local Open Scope R_scope.
Local Open Scope list_scope.

(* What is claimed of one return: a sign; in the box all coordinates while it takes place, and z before and after it; a short time
   in which it takes place from the centre, and the same there. Intervals over 2^digits. *)
Record passage := Passage {
  sign_of : Z;
  ends_of : list ends; before : ends; after : ends;
  fine_time : bigZ; fine_ends : list ends; fine_before : ends; fine_after : ends
}.
Record case := Case {
  order : nat;
  parameter : ratio; beginning : ratio; wide_b : ratio; wide_e : ratio; near_b : ratio; near_e : ratio; slope_b : ratio; slope_e : ratio;
  side : Z; clock : bigZ; first : bigZ; last_time : bigZ; fine : bigZ; digits : bigZ; form : format;
  passages : list passage
}.
Definition no_passage : passage := Passage 0 [] no_ends no_ends 0%bigZ [] no_ends no_ends.
Definition passage_of (c : case) (j : nat) : passage := nth j (passages c) no_passage.
Definition times (n : nat) (x : bigZ) : bigZ := (BigZ.of_Z (Z.of_nat n) * x)%bigZ.

Definition exactly_zero : ratio * ratio := ((0, 1), (0, 1))%bigZ.
Definition exactly_one : ratio * ratio := ((1, 1), (0, 1))%bigZ.

Definition loose (c : case) : ends := let l := BigZ.shiftl 1 (digits c + 100)%bigZ in ((- l)%bigZ, l).
Definition only_z (c : case) (e : ends) : list ends := [loose c; loose c; e] ++ repeat (loose c) 15.
Definition claims_of (c : case) (fine : bool) : list claim :=
  flat_map (fun j => let p := passage_of c j in
    [Claim true (13 * j + 12) (if fine then fine_ends p else ends_of p);
     Claim false (13 * j + 12) (only_z c (if fine then fine_before p else before p));
     Claim false (13 * j + 13) (only_z c (if fine then fine_after p else after p))]) (seq 0 (order c)).
Definition box_of (c : case) (fine : bool) (steps : list step) : box_problem :=
  BoxProblem fs_program [(parameter c, if fine then (0, 1)%bigZ else wide_b c)]
    ([exactly_zero; (beginning c, if fine then (0, 1)%bigZ else wide_e c); exactly_zero; exactly_zero; exactly_one] ++ repeat exactly_zero 13)
    (form c) steps (BigZ.shiftl 1 (digits c)) (claims_of c fine).

(* After k steps it is the time n / 2^d. *)
Definition is_time (steps : list step) (d : bigZ) (k : nat) (n : bigZ) : bool :=
  ((0 <=? d) && (finest (firstn k steps) <=? d) && (clock_of d (firstn k steps) =? n))%bigZ%bool.
Definition good_around (c : case) (steps : list step) : bool :=
  box_solved (box_of c false steps) && (length steps =? 13 * order c + 1)%nat && is_time steps (clock c) (13 * order c + 1) (last_time c)
  && forallb (fun j => is_time steps (clock c) (13 * j + 12) (times (S j) (first c)) && is_time steps (clock c) (13 * j + 13) (times (S j) (first c + 1))) (seq 0 (order c)).
Definition good_centre (c : case) (steps : list step) : bool :=
  box_solved (box_of c true steps) && (length steps =? 13 * order c)%nat
  && forallb (fun j => is_time steps (fine c) (13 * j + 12) (fine_time (passage_of c j)) && is_time steps (fine c) (13 * j + 13) (fine_time (passage_of c j) + 3)%bigZ)
       (seq 0 (order c)).

(* Intervals of the numbers. *)
Definition around0 (a : interval) : interval := option_map (fun x => (- snd x, snd x)%bigZ) a.
Definition lowest (a : interval) : interval := option_map (fun x => (fst x, fst x)) a.
Definition largest (a : interval) : interval := option_map (fun x => let m := BigZ.max (- fst x)%bigZ (snd x) in (m, m)) a.
Definition known (a : interval) : bool := match a with Some _ => true | None => false end.
Section Numbers.
Variable c : case.
Notation p := (digits c).
Definition number_of (q : ratio) : interval := inumber p (fst q) (snd q).
Definition times_number (q : ratio) : interval -> interval := iscale (fst q) (snd q).
Definition parameters (fine : bool) : interval := if fine then number_of (parameter c) else iadd (number_of (parameter c)) (around0 (number_of (wide_b c))).
Definition on_the_way_of (fine : bool) (j i : nat) : interval :=
  if (i <? 18)%nat then Some (nth i (if fine then fine_ends (passage_of c j) else ends_of (passage_of c j)) no_ends) else None.
Definition at_return (fine : bool) (j i : nat) : interval := if (i =? 2)%nat then Some (0, 0)%bigZ else on_the_way_of fine j i.
Definition of_formula (fine : bool) (j : nat) (x : formula) : interval :=
  let b := parameters fine in let w := at_return fine j in enclosure p b w (enclosure p b w None speed) x.
Definition upwards (j : nat) : Z := if Nat.even j then 1 else (-1).
Definition steepness (j : nat) : interval := enclosure p (parameters false) (on_the_way_of false j) None (Times (Whole (upwards j)) speed).
Definition z_is (j : nat) (e : ends) : interval := enclosure p None (fun i => if (i =? 2)%nat then Some e else None) None (Times (Whole (upwards j)) (At 2)).
(* x at a return, with the sign. *)
Definition x_of (j : nat) : formula := Times (Whole (sign_of (passage_of c j))) (At 0).
Definition last_of : nat := pred (order c).
Definition oriented (x : formula) : formula := Times (Whole (side c)) x.

Definition good_passage (j : nat) : bool :=
  let q := passage_of c j in
  negb (sign_of q =? 0)%Z && positive (steepness j)
  && negative (z_is j (before q)) && positive (z_is j (after q)) && negative (z_is j (fine_before q)) && positive (z_is j (fine_after q))
  && (BigZ.shiftl (times (S j) (first c)) (fine c - clock c) <=? fine_time q)%bigZ
  && (fine_time q + 3 <=? BigZ.shiftl (times (S j) (first c + 1)) (fine c - clock c))%bigZ
  && ((S j =? order c)%nat || positive (of_formula false j (De (x_of j)))).
Definition smaller (q q' : ratio) : bool := ((0 <? fst q) && (0 <? snd q) && (0 <? snd q') && (fst q * snd q' <? fst q' * snd q))%bigZ.
Definition good_numbers : bool :=
  let n := last_of in
  let nb := number_of (near_b c) in let ne := number_of (near_e c) in
  let Fe := of_formula false 0 (De (x_of 0)) in let Fb := of_formula false 0 (Db (x_of 0)) in
  let Gbe := of_formula false n (Db (De (x_of n))) in let Gee := of_formula false n (De (De (x_of n))) in
  let F := of_formula true 0 (x_of 0) in let Ge := of_formula true n (De (x_of n)) in
  let room := isub (lowest Gbe) (times_number (slope_b c) (largest Gee)) in
  (2 <=? order c)%nat && (0 <=? p)%bigZ && (0 <? first c)%bigZ && (clock c <=? fine c)%bigZ && (times (order c) (first c + 1) <? last_time c)%bigZ
  && smaller (near_b c) (wide_b c) && smaller (near_e c) (wide_e c) && (0 <? snd (parameter c))%bigZ && (0 <? snd (beginning c))%bigZ
  && ((side c =? 1) || (side c =? -1))%Z
  && forallb good_passage (seq 0 (order c))
  && positive (isub (times_number (slope_b c) (lowest Fe)) Fb) && positive (iadd (times_number (slope_b c) (lowest Fe)) Fb)
  && negative (iadd F (iadd (imul p Fb (around0 nb)) (imul p Fe (iopp ne)))) && positive (iadd F (iadd (imul p Fb (around0 nb)) (imul p Fe ne)))
  && positive Gbe && known Gee && positive room && positive (isub (times_number (slope_e c) room) (largest Gee))
  && negative (iadd Ge (iadd (imul p Gee (around0 ne)) (imul p Gbe (iopp nb)))) && positive (iadd Ge (iadd (imul p Gee (around0 ne)) (imul p Gbe nb)))
  && (if Nat.even (order c)
      then positive (of_formula false n (oriented (De (De (De (x_of n)))))) && known (of_formula false n (De (At 1))) && known (of_formula false n (Db (At 1)))
      else negative (of_formula false n (oriented (De (De (x_of n)))))).
End Numbers.

Lemma is_time_sound steps d k n : is_time steps d k n = true -> time_of steps k = r_ n / two_to d.
Proof.
  intros H. unfold is_time in H. apply andb_prop in H. destruct H as [H H3]. apply andb_prop in H. destruct H as [_ H2].
  rewrite BigZ.spec_leb in H2. apply Z.leb_le in H2. apply BigZ.eqb_eq in H3.
  assert (E : r_ (clock_of d (firstn k steps)) = r_ n) by (unfold r_; f_equal; exact H3).
  rewrite clock_is in E by (intros s Hs; pose proof (finest_above _ _ Hs); lia). unfold time_of. rewrite <- E. pose proof (two_to_pos d). field. lra.
Qed.
Lemma r_times m x : r_ (times m x) = INR m * r_ x.
Proof. unfold times. rewrite r_mul. f_equal. unfold r_. rewrite BigZ.spec_of_Z. symmetry. apply INR_IZR_INZ. Qed.
Lemma zero_in_wide : in_wide exactly_zero 0.
Proof. unfold in_wide, exactly_zero, real_of. cbn [fst snd]. rewrite r_0, r_1. replace (0 - 0 / 1) with 0 by field. rewrite Rabs_R0. lra. Qed.
Lemma one_in_wide : in_wide exactly_one 1.
Proof. unfold in_wide, exactly_one, real_of. cbn [fst snd]. rewrite r_0, r_1. replace (1 - 1 / 1) with 0 by field. rewrite Rabs_R0. lra. Qed.
Lemma box_flows c fine steps : box_solved (box_of c fine steps) = true ->
  exists r, 0 <= r /\
  forall b e, Rabs (b - real_of (parameter c)) <= real_of (if fine then (0, 1)%bigZ else wide_b c) ->
    Rabs (e - real_of (beginning c)) <= real_of (if fine then (0, 1)%bigZ else wide_e c) ->
  exists y, flows (time_of steps (length steps)) b e y /\
    (forall i t, (i < 18)%nat -> 0 <= t <= time_of steps (length steps) -> Rabs (y i t) <= r) /\
    List.Forall (claim_holds (box_of c fine steps) y) (claims_of c fine).
Proof.
  intros H. destruct (box_solved_sound _ H) as [_ [r [Hr S]]]. exists r. split; [assumption|].
  intros b e Hb He. destruct (S [b] (map (from e) (seq 0 18))) as [y [Y0 [Ys [Yb Yc]]]].
  - apply Forall2_cons; [exact Hb | apply Forall2_nil].
  - cbn [box_start box_of map seq from repeat app].
    repeat (apply Forall2_cons; [first [exact zero_in_wide | exact one_in_wide | exact He]|]). apply Forall2_nil.
  - exists y. split; [split|split].
    + intros i Hi. rewrite (Y0 i Hi). do 18 (destruct i as [|i]; [reflexivity|]). lia.
    + intros i t Hi Ht. rewrite <- fs_is by assumption. apply Ys; assumption.
    + exact Yb.
    + exact Yc.
Qed.

(* Intervals. *)
Section Contained.
Variable p : bigZ.
Hypothesis p_nonneg : (0 <= BigZ.to_Z p)%Z.
Notation within a x := (contains p a x).
Definition low (a : interval) : R := match a with Some (l, _) => r_ l / two_to p | None => 0 end.
Definition high (a : interval) : R := match a with Some (_, h) => r_ h / two_to p | None => 0 end.
Definition bound (a : interval) : R := match a with Some (l, h) => r_ (BigZ.max (- l)%bigZ h) / two_to p | None => 0 end.
Lemma scaled u : r_ u / two_to p * two_to p = r_ u.
Proof. pose proof (two_to_pos p). field. lra. Qed.
Lemma between_contains e u : between (two_to p) e u -> within (Some e) u.
Proof.
  intros [H1 H2]. destruct e as [l h]. cbn [contains fst snd] in *. pose proof (two_to_pos p) as P.
  apply (Rmult_le_compat_r (two_to p)) in H1; [|lra]. apply (Rmult_le_compat_r (two_to p)) in H2; [|lra]. rewrite scaled in H1, H2. auto.
Qed.
Lemma low_high a x : known a = true -> within a x -> low a <= x <= high a.
Proof.
  destruct a as [[l h]|]; [|discriminate]. intros _ [H1 H2]. pose proof (two_to_pos p) as P. cbn [low high].
  split; apply (Rmult_le_reg_r (two_to p)); try assumption; rewrite scaled; assumption.
Qed.
Lemma positive_known a : positive a = true -> known a = true /\ 0 < low a.
Proof.
  destruct a as [[l h]|]; [|discriminate]. cbn. intros H. split; [reflexivity|]. apply r_ltb in H. rewrite r_0 in H. apply Rdiv_lt_0_compat; [exact H | apply two_to_pos].
Qed.
Lemma lowest_sound a : within (lowest a) (low a).
Proof. destruct a as [[l h]|]; cbn; [|exact I]. rewrite scaled. lra. Qed.
Lemma largest_sound a : within (largest a) (bound a).
Proof. destruct a as [[l h]|]; cbn; [|exact I]. rewrite scaled. lra. Qed.
Lemma bound_is a x : known a = true -> within a x -> Rabs x <= bound a.
Proof.
  destruct a as [[l h]|]; [|discriminate]. intros _ [H1 H2]. cbn [bound]. pose proof (two_to_pos p) as P. apply (Rmult_le_reg_r (two_to p)); [assumption|].
  rewrite scaled, r_max, r_opp, <- (Rabs_pos_eq (two_to p)) at 1 by lra. rewrite <- Rabs_mult. pose proof (Rmax_l (- r_ l) (r_ h)). pose proof (Rmax_r (- r_ l) (r_ h)).
  apply Rabs_le. lra.
Qed.
Lemma around0_sound a r x : within a r -> Rabs x <= r -> within (around0 a) x.
Proof.
  destruct a as [[l h]|]; cbn; [|auto]. intros [_ H] Hx. rewrite r_opp. apply Rabs_le_between in Hx. pose proof (two_to_pos p) as P.
  assert (r * two_to p <= r_ h) by exact H. split; nra.
Qed.
Lemma number_sound (q : ratio) : within (inumber p (fst q) (snd q)) (real_of q).
Proof. apply inumber_sound. assumption. Qed.
End Contained.

(* Which derivatives are formulas. *)
Section Places.
Variable s : Z.
Notation x := (Times (Whole s) (At 0)).
Lemma places_0 : places ok_e x = true /\ places ok_b x = true. Proof. split; reflexivity. Qed.
Lemma places_1 : places ok_e (De x) = true /\ places ok_b (De x) = true. Proof. split; reflexivity. Qed.
Lemma places_2 : places ok_e (De (De x)) = true. Proof. reflexivity. Qed.
End Places.

Lemma upwards_cases j : IZR (upwards j) = 1 \/ IZR (upwards j) = -1.
Proof. unfold upwards. destruct (Nat.even j); [left | right]; reflexivity. Qed.

Section Proof.
Variable c : case.
Variables around centre : list step.
Hypothesis around_good : good_around c around = true.
Hypothesis centre_good : good_centre c centre = true.
Hypothesis numbers_good : good_numbers c = true.
Notation k := (order c).
Notation p := (digits c).
Notation n := (last_of c).
Definition bc : R := real_of (parameter c).
Definition ec : R := real_of (beginning c).
Definition rb : R := real_of (wide_b c).
Definition re : R := real_of (wide_e c).
Definition nb : R := real_of (near_b c).
Definition ne : R := real_of (near_e c).
Definition A : R := real_of (slope_b c).
Definition D : R := real_of (slope_e c).
Definition T_end : R := r_ (last_time c) / two_to (clock c).
Definition tl : R := r_ (first c) / two_to (clock c).
Definition th : R := r_ (first c + 1)%bigZ / two_to (clock c).
Definition lo (j : nat) : R := INR (S j) * tl.
Definition hi (j : nat) : R := INR (S j) * th.
Definition sg (j : nat) : R := IZR (upwards j).
Notation box b e := (in_box bc rb ec re b e).
Notation Fe' := (of_formula c false 0 (De (x_of c 0))).
Notation Fb' := (of_formula c false 0 (Db (x_of c 0))).
Notation Gbe' := (of_formula c false n (Db (De (x_of c n)))).
Notation Gee' := (of_formula c false n (De (De (x_of c n)))).
Notation F' := (of_formula c true 0 (x_of c 0)).
Notation Ge' := (of_formula c true n (De (x_of c n))).
Notation nb' := (number_of c (near_b c)).
Notation ne' := (number_of c (near_e c)).
Notation room' := (isub (lowest Gbe') (times_number (slope_b c) (largest Gee'))).

Record checked_numbers : Prop := {
  n_order : (2 <= k)%nat; n_digits : (0 <= BigZ.to_Z p)%Z; n_first : 0 < r_ (first c); n_fine : (BigZ.to_Z (clock c) <= BigZ.to_Z (fine c))%Z;
  n_last : INR k * r_ (first c + 1)%bigZ < r_ (last_time c);
  n_b : 0 < nb < rb; n_e : 0 < ne < re;
  n_side : IZR (side c) = 1 \/ IZR (side c) = -1;
  n_passages : forall j, (j < k)%nat -> good_passage c j = true;
  n_A1 : positive (isub (times_number (slope_b c) (lowest Fe')) Fb') = true; n_A2 : positive (iadd (times_number (slope_b c) (lowest Fe')) Fb') = true;
  n_F1 : negative (iadd F' (iadd (imul p Fb' (around0 nb')) (imul p Fe' (iopp ne')))) = true;
  n_F2 : positive (iadd F' (iadd (imul p Fb' (around0 nb')) (imul p Fe' ne'))) = true;
  n_Gbe : positive Gbe' = true; n_Gee : known Gee' = true; n_room : positive room' = true;
  n_D : positive (isub (times_number (slope_e c) room') (largest Gee')) = true;
  n_G1 : negative (iadd Ge' (iadd (imul p Gee' (around0 ne')) (imul p Gbe' (iopp nb')))) = true;
  n_G2 : positive (iadd Ge' (iadd (imul p Gee' (around0 ne')) (imul p Gbe' nb'))) = true;
  n_even : Nat.even k = true -> positive (of_formula c false n (oriented c (De (De (De (x_of c n)))))) = true /\
    known (of_formula c false n (De (At 1))) = true /\ known (of_formula c false n (Db (At 1))) = true;
  n_odd : Nat.even k = false -> negative (of_formula c false n (oriented c (De (De (x_of c n))))) = true
}.
Lemma smaller_sound q q' : smaller q q' = true -> 0 < real_of q < real_of q'.
Proof.
  intros H. unfold smaller in H. apply andb_prop in H. destruct H as [H H4]. apply andb_prop in H. destruct H as [H H3]. apply andb_prop in H. destruct H as [H1 H2].
  apply r_ltb in H1, H2, H3, H4. rewrite r_0 in H1, H2, H3. rewrite !r_mul in H4. unfold real_of. split; [apply Rdiv_lt_0_compat; assumption|].
  apply (Rmult_lt_reg_r (r_ (snd q) * r_ (snd q'))); [apply Rmult_lt_0_compat; assumption|].
  replace (r_ (fst q) / r_ (snd q) * (r_ (snd q) * r_ (snd q'))) with (r_ (fst q) * r_ (snd q')) by (field; lra).
  replace (r_ (fst q') / r_ (snd q') * (r_ (snd q) * r_ (snd q'))) with (r_ (fst q') * r_ (snd q)) by (field; lra). assumption.
Qed.
Ltac last_of_both H Q := apply andb_prop in H; destruct H as [H Q].
Lemma numbers_are : checked_numbers.
Proof.
  pose proof numbers_good as H. unfold good_numbers in H. cbv zeta in H.
  last_of_both H Q22. last_of_both H Q21. last_of_both H Q20. last_of_both H Q19. last_of_both H Q18. last_of_both H Q17. last_of_both H Q16.
  last_of_both H Q15. last_of_both H Q14. last_of_both H Q13. last_of_both H Q12. last_of_both H Q11. last_of_both H Q10. last_of_both H Q9. last_of_both H Q8.
  last_of_both H Q7. last_of_both H Q6. last_of_both H Q5. last_of_both H Q4. last_of_both H Q3. last_of_both H Q2.
  split.
  - apply Nat.leb_le. exact H.
  - rewrite BigZ.spec_leb in Q2. apply Z.leb_le in Q2. exact Q2.
  - apply r_ltb in Q3. rewrite r_0 in Q3. exact Q3.
  - rewrite BigZ.spec_leb in Q4. apply Z.leb_le in Q4. exact Q4.
  - apply r_ltb in Q5. rewrite r_times in Q5. exact Q5.
  - exact (smaller_sound _ _ Q6).
  - exact (smaller_sound _ _ Q7).
  - apply orb_prop in Q10. destruct Q10 as [Q|Q]; apply Z.eqb_eq in Q; rewrite Q; [left | right]; reflexivity.
  - intros j Hj. rewrite forallb_forall in Q11. apply Q11, in_seq. lia.
  - exact Q12.
  - exact Q13.
  - exact Q14.
  - exact Q15.
  - exact Q16.
  - exact Q17.
  - exact Q18.
  - exact Q19.
  - exact Q20.
  - exact Q21.
  - intros E. rewrite E in Q22. last_of_both Q22 Q24. last_of_both Q22 Q23. split; [exact Q22|]. split; [exact Q23 | exact Q24].
  - intros E. rewrite E in Q22. exact Q22.
Qed.
Lemma p_nonneg : (0 <= BigZ.to_Z p)%Z. Proof. exact (n_digits numbers_are). Qed.
Lemma unit_is : r_ (BigZ.shiftl 1 p) = two_to p.
Proof. destruct (r_shiftl 1 p) as [E|E]; [rewrite E, r_1; ring | pose proof p_nonneg; lia]. Qed.
Lemma n_below : (n < k)%nat. Proof. pose proof (n_order numbers_are). unfold last_of. lia. Qed.
Lemma k_is : k = S n. Proof. pose proof (n_order numbers_are). unfold last_of. lia. Qed.
Lemma first_below : (0 < k)%nat. Proof. pose proof (n_order numbers_are). lia. Qed.

Record checked_passage (j : nat) : Prop := {
  j_sign : IZR (sign_of (passage_of c j)) <> 0; j_steep : positive (steepness c j) = true;
  j_before : negative (z_is c j (before (passage_of c j))) = true; j_after : positive (z_is c j (after (passage_of c j))) = true;
  j_fine_before : negative (z_is c j (fine_before (passage_of c j))) = true; j_fine_after : positive (z_is c j (fine_after (passage_of c j))) = true;
  j_fine1 : lo j <= r_ (fine_time (passage_of c j)) / two_to (fine c); j_fine2 : r_ (fine_time (passage_of c j) + 3)%bigZ / two_to (fine c) <= hi j;
  j_rises : (S j < k)%nat -> positive (of_formula c false j (De (x_of c j))) = true
}.
Lemma finer x : r_ (BigZ.shiftl x (fine c - clock c)) = r_ x * (two_to (fine c) / two_to (clock c)).
Proof.
  destruct (r_shiftl x (fine c - clock c)%bigZ) as [E|E]; [rewrite E, two_to_sub; reflexivity|]. rewrite BigZ.spec_sub in E. pose proof (n_fine numbers_are). lia.
Qed.
Lemma passage_is j : (j < k)%nat -> checked_passage j.
Proof.
  intros Hj. pose proof (n_passages numbers_are j Hj) as H. unfold good_passage in H. cbv zeta in H.
  last_of_both H Q9. last_of_both H Q8. last_of_both H Q7. last_of_both H Q6. last_of_both H Q5. last_of_both H Q4. last_of_both H Q3. last_of_both H Q2.
  pose proof (two_to_pos (fine c)) as P1. pose proof (two_to_pos (clock c)) as P2.
  split; try assumption.
  - apply negb_true_iff, Z.eqb_neq in H. apply not_0_IZR. exact H.
  - apply r_leb in Q7. rewrite finer, r_times in Q7. apply (Rmult_le_reg_r (two_to (fine c))); [assumption|]. rewrite scaled. unfold lo, tl.
    replace (INR (S j) * (r_ (first c) / two_to (clock c)) * two_to (fine c)) with (INR (S j) * r_ (first c) * (two_to (fine c) / two_to (clock c))) by (field; lra). exact Q7.
  - apply r_leb in Q8. rewrite finer, r_times in Q8. apply (Rmult_le_reg_r (two_to (fine c))); [assumption|]. rewrite scaled. unfold hi, th.
    replace (INR (S j) * (r_ (first c + 1)%bigZ / two_to (clock c)) * two_to (fine c)) with (INR (S j) * r_ (first c + 1)%bigZ * (two_to (fine c) / two_to (clock c))) by (field; lra). exact Q8.
  - intros L. apply orb_prop in Q9. destruct Q9 as [Q|Q]; [apply Nat.eqb_eq in Q; lia | exact Q].
Qed.

(* Times. *)
Lemma times_are : 0 < tl < th.
Proof.
  pose proof (n_first numbers_are) as H. pose proof (two_to_pos (clock c)) as P. unfold tl, th. rewrite r_add, r_1. split; [apply Rdiv_lt_0_compat; assumption|].
  apply (Rmult_lt_reg_r (two_to (clock c))); [assumption|]. unfold Rdiv. rewrite !Rmult_assoc, Rinv_l by lra. lra.
Qed.
Lemma in_k j : (j < k)%nat -> 1 <= INR (S j) <= INR k.
Proof. intros H. split; [change 1 with (INR 1) | ]; apply le_INR; lia. Qed.
Lemma return_times j : (j < k)%nat -> 0 < lo j < hi j /\ hi j < T_end.
Proof.
  intros Hj. pose proof times_are as T. pose proof (in_k j Hj) as I. pose proof (n_last numbers_are) as L. pose proof (two_to_pos (clock c)) as P. unfold lo, hi.
  split; [split; [apply Rmult_lt_0_compat; lra | apply Rmult_lt_compat_l; lra]|]. apply Rle_lt_trans with (INR k * th); [apply Rmult_le_compat_r; lra|].
  unfold th, T_end. apply (Rmult_lt_reg_r (two_to (clock c))); [assumption|]. rewrite Rmult_assoc, !scaled. exact L.
Qed.
Lemma T_end_pos : 0 < T_end.
Proof. pose proof (return_times 0 first_below). lra. Qed.
Lemma around_is : box_solved (box_of c false around) = true /\ time_of around (length around) = T_end /\
  forall j, (j < k)%nat -> time_of around (13 * j + 12) = lo j /\ time_of around (13 * j + 13) = hi j.
Proof.
  pose proof around_good as H. unfold good_around in H. last_of_both H Q4. last_of_both H Q3. last_of_both H Q2.
  split; [exact H|]. apply Nat.eqb_eq in Q2. split; [rewrite Q2; apply is_time_sound; exact Q3|]. intros j Hj. rewrite forallb_forall in Q4.
  specialize (Q4 j ltac:(apply in_seq; lia)). last_of_both Q4 Q5. apply is_time_sound in Q4, Q5. rewrite r_times in Q4, Q5. unfold lo, hi, tl, th, Rdiv in *.
  rewrite <- !Rmult_assoc. auto.
Qed.
Definition fine_lo (j : nat) : R := r_ (fine_time (passage_of c j)) / two_to (fine c).
Definition fine_hi (j : nat) : R := r_ (fine_time (passage_of c j) + 3)%bigZ / two_to (fine c).
Definition T_centre : R := time_of centre (length centre).
Lemma centre_is : box_solved (box_of c true centre) = true /\ T_centre = fine_hi n /\
  forall j, (j < k)%nat -> time_of centre (13 * j + 12) = fine_lo j /\ time_of centre (13 * j + 13) = fine_hi j.
Proof.
  pose proof centre_good as H. unfold good_centre in H. last_of_both H Q3. last_of_both H Q2. apply Nat.eqb_eq in Q2.
  assert (E : forall j, (j < k)%nat -> time_of centre (13 * j + 12) = fine_lo j /\ time_of centre (13 * j + 13) = fine_hi j).
  { intros j Hj. rewrite forallb_forall in Q3. specialize (Q3 j ltac:(apply in_seq; lia)). last_of_both Q3 Q5. apply is_time_sound in Q3, Q5. auto. }
  split; [exact H|]. split; [|exact E]. unfold T_centre. rewrite Q2, k_is. replace (13 * S n)%nat with (13 * n + 13)%nat by lia. apply E, n_below.
Qed.

Variable r : R.
Hypothesis run : forall b e, box b e -> exists y, flows T_end b e y /\
  (forall i t, (i < 18)%nat -> 0 <= t <= T_end -> Rabs (y i t) <= r) /\ List.Forall (claim_holds (box_of c false around) y) (claims_of c false).
Variable y_centre : nat -> R -> R.
Hypothesis centre_flows : flows T_centre bc ec y_centre.
Hypothesis centre_claimed : List.Forall (claim_holds (box_of c true centre) y_centre) (claims_of c true).
Hypothesis forwards : forall i j, (i <= j)%nat -> time_of centre i <= time_of centre j.

Lemma solutions b e : box b e -> exists y, flows T_end b e y /\ forall i t, (i < 18)%nat -> 0 <= t <= T_end -> Rabs (y i t) <= r.
Proof. intros H. destruct (run b e H) as [y [H1 [H2 _]]]. exists y. auto. Qed.
Notation s i b e t := (st T_end i b e t).

Lemma parameters_sound b e : box b e -> contains p (parameters c false) b.
Proof.
  intros [H _]. unfold parameters. replace b with (bc + (b - bc)) by ring. apply iadd_sound; [apply number_sound, p_nonneg|].
  apply (around0_sound p _ rb); [apply number_sound, p_nonneg | exact H].
Qed.
Lemma st_claim cl b e i t : In cl (claims_of c false) -> box b e -> (i < 18)%nat -> 0 <= t <= T_end ->
  (if on_the_step cl then time_of around (number cl) <= t <= time_of around (S (number cl)) else t = time_of around (number cl)) ->
  contains p (Some (nth i (intervals cl) no_ends)) (s i b e t).
Proof.
  intros Hc Hb Hi Ht Hk. destruct (run b e Hb) as [y [Hy [_ C]]]. rewrite (st_is T_end T_end_pos b e y i t Hy Hi Ht).
  rewrite List.Forall_forall in C. apply between_contains. rewrite <- unit_is. exact (C cl Hc i t Hi Hk).
Qed.
Lemma claim_in (fine : bool) (j : nat) (cl : claim) : (j < k)%nat ->
  In cl (let q := passage_of c j in
    [Claim true (13 * j + 12) (if fine then fine_ends q else ends_of q);
     Claim false (13 * j + 12) (only_z c (if fine then fine_before q else before q));
     Claim false (13 * j + 13) (only_z c (if fine then fine_after q else after q))]) -> In cl (claims_of c fine).
Proof. intros Hj H. apply in_flat_map. exists j. split; [apply in_seq; lia | exact H]. Qed.
Lemma on_window j b e t : (j < k)%nat -> box b e -> lo j <= t <= hi j -> forall i, contains p (on_the_way_of c false j i) (s i b e t).
Proof.
  intros Hj Hb Ht i. unfold on_the_way_of. destruct (Nat.ltb_spec i 18) as [Hi|Hi]; [|exact I].
  pose proof (return_times j Hj) as RT. destruct around_is as [_ [_ E]]. destruct (E j Hj) as [E1 E2].
  apply (st_claim (Claim true (13 * j + 12) (ends_of (passage_of c j)))); [|assumption|assumption| lra |].
  - apply (claim_in false j); [assumption|]. cbn. auto.
  - cbn [on_the_step number]. replace (S (13 * j + 12)) with (13 * j + 13)%nat by lia. rewrite E1, E2. exact Ht.
Qed.
Lemma z_is_sound j e u : contains p (Some e) u -> contains p (z_is c j e) (sg j * u).
Proof.
  intros H. unfold z_is. apply (enclosure_sound p p_nonneg 0 (fun _ => u) None None _ (Times (Whole (upwards j)) (At 2))); [exact I | | exact I].
  intros i. destruct (i =? 2)%nat; [exact H | exact I].
Qed.
Lemma z_low j : (j < k)%nat -> forall b e, box b e -> sg j * s 2%nat b e (lo j) < 0.
Proof.
  intros Hj b e Hb. pose proof (return_times j Hj) as RT. destruct around_is as [_ [_ E]]. destruct (E j Hj) as [E1 E2].
  apply (negative_sound p _ _ (j_before j (passage_is j Hj))), z_is_sound.
  apply (st_claim (Claim false (13 * j + 12) (only_z c (before (passage_of c j)))) b e 2); [|assumption| lia | lra | cbn [on_the_step number]; symmetry; exact E1].
  apply (claim_in false j); [assumption|]. cbn. auto.
Qed.
Lemma z_high j : (j < k)%nat -> forall b e, box b e -> 0 < sg j * s 2%nat b e (hi j).
Proof.
  intros Hj b e Hb. pose proof (return_times j Hj) as RT. destruct around_is as [_ [_ E]]. destruct (E j Hj) as [E1 E2].
  apply (positive_sound p _ _ (j_after j (passage_is j Hj))), z_is_sound.
  apply (st_claim (Claim false (13 * j + 13) (only_z c (after (passage_of c j)))) b e 2); [|assumption| lia | lra | cbn [on_the_step number]; symmetry; exact E2].
  apply (claim_in false j); [assumption|]. cbn. auto.
Qed.
Definition m (j : nat) : R := low p (steepness c j).
Definition M (j : nat) : R := high p (steepness c j).
Lemma m_pos j : (j < k)%nat -> 0 < m j.
Proof. intros Hj. apply positive_known, (j_steep j (passage_is j Hj)). Qed.
Lemma steep j : (j < k)%nat -> forall b e t, box b e -> lo j <= t <= hi j -> m j <= sg j * rate T_end b e t 2 <= M j.
Proof.
  intros Hj b e t Hb Ht. apply low_high; [apply (positive_known p), (j_steep j (passage_is j Hj))|]. unfold steepness.
  apply (enclosure_sound p p_nonneg b (fun i => s i b e t) None (parameters c false) _ (Times (Whole (upwards j)) speed));
    [exact (parameters_sound b e Hb) | intros i; apply on_window; assumption | exact I].
Qed.

(* Returns: the time, all coordinates, and formulas in them. *)
Notation tau j b e := (tau T_end (lo j) (hi j) (sg j) b e).
Notation vs j b e := (vs T_end (lo j) (hi j) (sg j) b e).
Notation X j x b e := (value b (vs j b e) x).
Ltac at_return L j Hj := refine (L bc rb ec re T_end r T_end_pos solutions (lo j) (hi j) (sg j) (m j) (M j)
  (return_times j Hj) (upwards_cases j) (m_pos j Hj) (z_low j Hj) (z_high j Hj) (steep j Hj) _ _).
Lemma tau_of j : (j < k)%nat -> forall b e, box b e -> lo j < tau j b e < hi j /\ forall t, lo j <= t <= hi j -> (s 2%nat b e t = 0 <-> t = tau j b e).
Proof. intros Hj b e. at_return tau_is j Hj. Qed.
Lemma zero_of j : (j < k)%nat -> forall b e, box b e -> vs j b e 2%nat = 0.
Proof. intros Hj b e. at_return v_zero j Hj. Qed.
Lemma by_e_of j x : (j < k)%nat -> places ok_e x = true -> forall b e, room bc rb ec re b e -> is_derive (fun q => X j x b q) e (X j (De x) b e).
Proof.
  intros Hj Hx b e Hr. exact (by_e_sound bc rb ec re T_end r T_end_pos solutions (lo j) (hi j) (sg j) (m j) (M j)
    (return_times j Hj) (upwards_cases j) (m_pos j Hj) (z_low j Hj) (z_high j Hj) (steep j Hj) x b e Hr Hx).
Qed.
Lemma by_b_of j x : (j < k)%nat -> places ok_b x = true -> forall b e, room bc rb ec re b e -> is_derive (fun q => X j x q e) b (X j (Db x) b e).
Proof.
  intros Hj Hx b e Hr. exact (by_b_sound bc rb ec re T_end r T_end_pos solutions (lo j) (hi j) (sg j) (m j) (M j)
    (return_times j Hj) (upwards_cases j) (m_pos j Hj) (z_low j Hj) (z_high j Hj) (steep j Hj) x b e Hr Hx).
Qed.
Lemma enclosed fine j x b (w : point) : contains p (parameters c fine) b -> (forall i, contains p (on_the_way_of c fine j i) (w i)) -> w 2%nat = 0 ->
  contains p (of_formula c fine j x) (value b w x).
Proof.
  intros Hb Hw Hz. assert (Q : forall i, contains p (at_return c fine j i) (w i)).
  { intros i. unfold at_return. destruct (Nat.eqb_spec i 2) as [->|_]; [rewrite Hz; cbn; rewrite r_0; lra | apply Hw]. }
  unfold of_formula. cbv zeta. apply (enclosure_sound p p_nonneg); [exact Hb | exact Q|]. rewrite <- speed_is.
  apply (enclosure_sound p p_nonneg); [exact Hb | exact Q | exact I].
Qed.
Lemma in_formula j x b e : (j < k)%nat -> box b e -> contains p (of_formula c false j x) (X j x b e).
Proof.
  intros Hj Hb. apply enclosed; [exact (parameters_sound b e Hb) | | apply zero_of; assumption].
  intros i. apply on_window; [assumption | assumption|]. destruct (tau_of j Hj b e Hb) as [Ht _]. lra.
Qed.

(* At the centre. *)
Lemma in_the_centre : box bc ec.
Proof. pose proof (n_b numbers_are). pose proof (n_e numbers_are). split; rewrite Rminus_eq_0, Rabs_R0; lra. Qed.
Lemma fine_is j : (j < k)%nat -> lo j <= fine_lo j < fine_hi j /\ fine_hi j <= hi j /\ fine_hi j <= T_centre.
Proof.
  intros Hj. pose proof (passage_is j Hj) as P. pose proof (two_to_pos (fine c)) as Pf. split; [split; [exact (j_fine1 j P)|]|split; [exact (j_fine2 j P)|]].
  - unfold fine_lo, fine_hi. rewrite r_add. apply (Rmult_lt_reg_r (two_to (fine c))); [assumption|]. unfold Rdiv. rewrite !Rmult_assoc, Rinv_l by lra.
    assert (0 < r_ 3%bigZ) by (unfold r_; change (BigZ.to_Z 3%bigZ) with 3%Z; lra). lra.
  - destruct centre_is as [_ [E1 E2]]. rewrite E1. destruct (E2 j Hj) as [_ <-]. destruct (E2 n n_below) as [_ <-]. apply forwards. pose proof k_is. lia.
Qed.
Lemma T_centre_within : 0 < T_centre < T_end.
Proof.
  pose proof (fine_is n n_below) as Q. pose proof (return_times n n_below) as Q'. destruct centre_is as [_ [E _]]. lra.
Qed.
Lemma centre_st i t : (i < 18)%nat -> 0 <= t <= T_centre -> s i bc ec t = y_centre i t.
Proof.
  intros Hi Ht. destruct (run _ _ in_the_centre) as [y [Hy _]]. pose proof T_centre_within. rewrite (st_is T_end T_end_pos _ _ y i t Hy Hi) by lra.
  destruct Hy as [Y0 Ys]. destruct centre_flows as [C0 Cs].
  apply (unique 18 (fs bc) (fs_lipschitz bc) T_centre y y_centre); try assumption; [lra | | ].
  - intros j u Hj Hu. apply Ys; [assumption | lra].
  - intros j Hj. rewrite Y0, C0 by assumption. reflexivity.
Qed.
Lemma centre_claim cl i t : In cl (claims_of c true) -> (i < 18)%nat -> 0 <= t <= T_centre ->
  (if on_the_step cl then time_of centre (number cl) <= t <= time_of centre (S (number cl)) else t = time_of centre (number cl)) ->
  contains p (Some (nth i (intervals cl) no_ends)) (s i bc ec t).
Proof.
  intros Hc Hi Ht Hk. rewrite centre_st by assumption. pose proof centre_claimed as C. rewrite List.Forall_forall in C. apply between_contains. rewrite <- unit_is. exact (C cl Hc i t Hi Hk).
Qed.
Lemma centre_in j : (j < k)%nat -> fine_lo j <= tau j bc ec <= fine_hi j.
Proof.
  intros Hj. pose proof in_the_centre as Hc. destruct centre_is as [_ [_ E]]. destruct (E j Hj) as [E1 E2]. pose proof (fine_is j Hj) as Fi. pose proof (return_times j Hj) as RT.
  destruct (tau_of j Hj _ _ Hc) as [Ht Hz]. pose proof (proj2 (Hz (tau j bc ec) ltac:(lra)) eq_refl) as Z. pose proof (m_pos j Hj) as Pm.
  assert (B : forall t, lo j <= t <= hi j -> exists q, 0 < q /\ sg j * s 2%nat bc ec t = q * (t - tau j bc ec)).
  { intros t Hu. destruct (z_between bc rb ec re T_end r T_end_pos solutions (lo j) (hi j) (sg j) RT bc ec (tau j bc ec) t Hc ltac:(lra) Hu) as [w [Hw W]].
    pose proof (steep j Hj _ _ w Hc Hw). exists (sg j * rate T_end bc ec w 2). split; [lra|]. rewrite Z in W. lra. }
  pose proof (centre_claim (Claim false (13 * j + 12) (only_z c (fine_before (passage_of c j)))) 2 (fine_lo j)
    ltac:(apply (claim_in true j); [assumption|]; cbn; auto) ltac:(lia) ltac:(lra) ltac:(cbn [on_the_step number]; symmetry; exact E1)) as C1.
  pose proof (centre_claim (Claim false (13 * j + 13) (only_z c (fine_after (passage_of c j)))) 2 (fine_hi j)
    ltac:(apply (claim_in true j); [assumption|]; cbn; auto) ltac:(lia) ltac:(lra) ltac:(cbn [on_the_step number]; symmetry; exact E2)) as C2.
  apply (z_is_sound j) in C1, C2. apply (negative_sound p _ _ (j_fine_before j (passage_is j Hj))) in C1. apply (positive_sound p _ _ (j_fine_after j (passage_is j Hj))) in C2.
  destruct (B (fine_lo j) ltac:(lra)) as [q [K1 K2]]. destruct (B (fine_hi j) ltac:(lra)) as [q' [K1' K2']]. rewrite K2 in C1. rewrite K2' in C2.
  split; apply Rnot_lt_le; intros L; nra.
Qed.
Lemma in_formula_centre j x : (j < k)%nat -> contains p (of_formula c true j x) (X j x bc ec).
Proof.
  intros Hj. apply enclosed; [apply number_sound, p_nonneg | | apply zero_of; [assumption | exact in_the_centre]].
  intros i. unfold on_the_way_of. destruct (Nat.ltb_spec i 18) as [Hi|Hi]; [|exact I]. destruct centre_is as [_ [_ E]]. destruct (E j Hj) as [E1 E2].
  pose proof (fine_is j Hj) as Fi. pose proof (return_times j Hj) as RT. pose proof (centre_in j Hj) as Ct.
  apply (centre_claim (Claim true (13 * j + 12) (fine_ends (passage_of c j)))); [|assumption| lra |].
  - apply (claim_in true j); [assumption|]. cbn. auto.
  - cbn [on_the_step number]. replace (S (13 * j + 12)) with (13 * j + 13)%nat by lia. rewrite E1, E2. exact Ct.
Qed.

(* The box of the theorem lies inside. *)
Notation bl := (bc - nb).
Notation bh := (bc + nb).
Notation el := (ec - ne).
Notation eh := (ec + ne).
Notation inJ b := (J bl bh b).
Notation inY e := (Y el eh e).
Lemma room_inside b e : inJ b -> inY e -> room bc rb ec re b e.
Proof.
  intros Hb He. unfold J, Y in *. pose proof (n_b numbers_are) as Pb. pose proof (n_e numbers_are) as Pe.
  exists (Rmin (rb - nb) (re - ne)). pose proof (Rmin_l (rb - nb) (re - ne)). pose proof (Rmin_r (rb - nb) (re - ne)).
  split; [apply Rmin_pos; lra|]. split; intros q Hq; apply Rabs_le_between in Hq; split; apply Rabs_le; lra.
Qed.
Lemma inside_box b e : inJ b -> inY e -> box b e.
Proof. intros Hb He. unfold J, Y in *. pose proof (n_b numbers_are) as Pb. pose proof (n_e numbers_are) as Pe. split; apply Rabs_le; lra. Qed.
Lemma by_e j x b e : (j < k)%nat -> places ok_e x = true -> inJ b -> inY e -> is_derive (fun q => X j x b q) e (X j (De x) b e).
Proof. intros Hj Hx Hb He. apply by_e_of; [assumption | assumption | apply room_inside; assumption]. Qed.
Lemma by_b j x b e : (j < k)%nat -> places ok_b x = true -> inJ b -> inY e -> is_derive (fun q => X j x q e) b (X j (Db x) b e).
Proof. intros Hj Hx Hb He. apply by_b_of; [assumption | assumption | apply room_inside; assumption]. Qed.
Lemma J_centre : inJ bc.
Proof. pose proof (n_b numbers_are). unfold J. lra. Qed.
Lemma Y_centre : inY ec.
Proof. pose proof (n_e numbers_are). unfold Y. lra. Qed.
Lemma from_centre j x b e : (j < k)%nat -> places ok_e x = true -> places ok_b x = true -> inJ b -> inY e -> exists u v,
  box u e /\ box bc v /\ X j x b e = X j x bc ec + (X j (Db x) u e * (b - bc) + X j (De x) bc v * (e - ec)).
Proof.
  intros Hj He Hb Jb Ye.
  destruct (mean_value_around (fun b => X j x b e) (fun b => X j (Db x) b e) bl bh bc b) as [u [Hu E]]; [intros q Hq; exact (by_b j x q e Hj Hb Hq Ye) | exact J_centre | exact Jb|].
  destruct (mean_value_around (fun e => X j x bc e) (fun e => X j (De x) bc e) el eh ec e) as [v [Hv E']]; [intros q Hq; exact (by_e j x bc q Hj He J_centre Hq) | exact Y_centre | exact Ye|].
  exists u, v. split; [apply inside_box; assumption|]. split; [apply inside_box; [exact J_centre | exact Hv]|]. cbv beta in E, E'. lra.
Qed.
Lemma near_sound (q : ratio) u : Rabs u <= real_of q -> contains p (around0 (number_of c q)) u.
Proof. intros H. apply (around0_sound p _ (real_of q)); [apply number_sound, p_nonneg | exact H]. Qed.
Lemma b_near b : inJ b -> Rabs (b - bc) <= nb.
Proof. intros H. unfold J in H. apply Rabs_le. lra. Qed.
Lemma e_near e : inY e -> Rabs (e - ec) <= ne.
Proof. intros H. unfold Y in H. apply Rabs_le. lra. Qed.
Lemma el_in : inY el. Proof. pose proof (n_e numbers_are). unfold Y. lra. Qed.
Lemma eh_in : inY eh. Proof. pose proof (n_e numbers_are). unfold Y. lra. Qed.
Lemma bl_in : inJ bl. Proof. pose proof (n_b numbers_are). unfold J. lra. Qed.
Lemma bh_in : inJ bh. Proof. pose proof (n_b numbers_are). unfold J. lra. Qed.

(* The family. *)
Notation F b e := (X 0%nat (x_of c 0) b e).
Notation Fe b e := (X 0%nat (De (x_of c 0)) b e).
Notation Fb b e := (X 0%nat (Db (x_of c 0)) b e).
Notation G b e := (X n (x_of c n) b e).
Notation Ge b e := (X n (De (x_of c n)) b e).
Notation Gee b e := (X n (De (De (x_of c n))) b e).
Notation Gbe b e := (X n (Db (De (x_of c n))) b e).
Notation Geee b e := (X n (De (De (De (x_of c n)))) b e).
Lemma rises_at j b e : (S j < k)%nat -> inJ b -> inY e -> 0 < X j (De (x_of c j)) b e.
Proof.
  intros Hj Hb He. assert (Hj' : (j < k)%nat) by lia.
  exact (positive_sound p _ _ (j_rises j (passage_is j Hj') Hj) (in_formula j _ b e Hj' (inside_box b e Hb He))).
Qed.
Lemma Fe_known : known Fe' = true /\ 0 < low p Fe'.
Proof. apply positive_known, (j_rises 0 (passage_is 0 first_below)). pose proof (n_order numbers_are). lia. Qed.
Lemma Fe_bounds b e : inJ b -> inY e -> low p Fe' <= Fe b e <= high p Fe'.
Proof. intros Hb He. exact (low_high p _ _ (proj1 Fe_known) (in_formula 0 _ b e first_below (inside_box b e Hb He))). Qed.
Lemma Fb_bound b e : inJ b -> inY e -> Rabs (Fb b e) <= A * low p Fe'.
Proof.
  intros Hb He. pose proof (in_formula 0 (Db (x_of c 0)) b e first_below (inside_box b e Hb He)) as Q.
  pose proof (iscale_sound p (fst (slope_b c)) (snd (slope_b c)) _ _ (lowest_sound p Fe')) as L. change (r_ (fst (slope_b c)) / r_ (snd (slope_b c))) with A in L.
  pose proof (positive_sound p _ _ (n_A1 numbers_are) (isub_sound p _ _ _ _ L Q)) as H1. pose proof (positive_sound p _ _ (n_A2 numbers_are) (iadd_sound p _ _ _ _ L Q)) as H2.
  apply Rabs_le. lra.
Qed.
Lemma F_low b : inJ b -> F b el < 0.
Proof.
  intros Hb. destruct (from_centre 0 (x_of c 0) b el first_below ltac:(apply places_0) ltac:(apply places_0) Hb el_in) as [u [v [Hu [Hv ->]]]].
  replace (el - ec) with (- ne) by ring. apply (negative_sound p _ _ (n_F1 numbers_are)). apply iadd_sound; [apply in_formula_centre, first_below|].
  apply iadd_sound; apply imul_sound; [apply (in_formula 0); [exact first_below | exact Hu] | apply near_sound, b_near, Hb | apply (in_formula 0); [exact first_below | exact Hv] |].
  apply iopp_sound, number_sound, p_nonneg.
Qed.
Lemma F_high b : inJ b -> 0 < F b eh.
Proof.
  intros Hb. destruct (from_centre 0 (x_of c 0) b eh first_below ltac:(apply places_0) ltac:(apply places_0) Hb eh_in) as [u [v [Hu [Hv ->]]]].
  replace (eh - ec) with ne by ring. apply (positive_sound p _ _ (n_F2 numbers_are)). apply iadd_sound; [apply in_formula_centre, first_below|].
  apply iadd_sound; apply imul_sound; [apply (in_formula 0); [exact first_below | exact Hu] | apply near_sound, b_near, Hb | apply (in_formula 0); [exact first_below | exact Hv] |].
  apply number_sound, p_nonneg.
Qed.
Lemma Gbe_bounds b e : inJ b -> inY e -> low p Gbe' <= Gbe b e <= high p Gbe'.
Proof. intros Hb He. exact (low_high p _ _ (proj1 (positive_known p _ (n_Gbe numbers_are))) (in_formula n _ b e n_below (inside_box b e Hb He))). Qed.
Lemma Gee_bound b e : inJ b -> inY e -> Rabs (Gee b e) <= bound p Gee'.
Proof. intros Hb He. exact (bound_is p _ _ (n_Gee numbers_are) (in_formula n _ b e n_below (inside_box b e Hb He))). Qed.
Lemma room_sound : contains p room' (low p Gbe' - A * bound p Gee').
Proof. apply isub_sound; [apply lowest_sound|]. apply (iscale_sound p (fst (slope_b c)) (snd (slope_b c))), largest_sound. Qed.
Lemma transversal : 0 < low p Gbe' - A * bound p Gee'.
Proof. exact (positive_sound p _ _ (n_room numbers_are) room_sound). Qed.
Lemma D_is : bound p Gee' / (low p Gbe' - A * bound p Gee') <= D.
Proof.
  pose proof transversal as T. pose proof (positive_sound p _ _ (n_D numbers_are) (isub_sound p _ _ _ _ (iscale_sound p (fst (slope_e c)) (snd (slope_e c)) _ _ room_sound) (largest_sound p Gee'))) as Q.
  change (r_ (fst (slope_e c)) / r_ (snd (slope_e c))) with D in Q. apply Rle_div_l; lra.
Qed.
Lemma Ge_low e : inY e -> Ge bl e < 0.
Proof.
  intros He. destruct (from_centre n (De (x_of c n)) bl e n_below ltac:(apply places_1) ltac:(apply places_1) bl_in He) as [u [v [Hu [Hv ->]]]].
  replace (bl - bc) with (- nb) by ring. rewrite (Rplus_comm (_ * - nb)). apply (negative_sound p _ _ (n_G1 numbers_are)). apply iadd_sound; [apply in_formula_centre, n_below|].
  apply iadd_sound; apply imul_sound; [apply in_formula; [exact n_below | exact Hv] | apply near_sound, e_near, He | apply in_formula; [exact n_below | exact Hu] |].
  apply iopp_sound, number_sound, p_nonneg.
Qed.
Lemma Ge_high e : inY e -> 0 < Ge bh e.
Proof.
  intros He. destruct (from_centre n (De (x_of c n)) bh e n_below ltac:(apply places_1) ltac:(apply places_1) bh_in He) as [u [v [Hu [Hv ->]]]].
  replace (bh - bc) with nb by ring. rewrite (Rplus_comm (_ * nb)). apply (positive_sound p _ _ (n_G2 numbers_are)). apply iadd_sound; [apply in_formula_centre, n_below|].
  apply iadd_sound; apply imul_sound; [apply in_formula; [exact n_below | exact Hv] | apply near_sound, e_near, He | apply in_formula; [exact n_below | exact Hu] |].
  apply number_sound, p_nonneg.
Qed.

(* Orbits and zeros. *)
Lemma x_zero j b e : (j < k)%nat -> (X j (x_of c j) b e = 0 <-> s 0%nat b e (tau j b e) = 0).
Proof.
  intros Hj. change (X j (x_of c j) b e) with (IZR (sign_of (passage_of c j)) * s 0%nat b e (tau j b e)). pose proof (j_sign j (passage_is j Hj)) as N.
  split; intros E; [|rewrite E; ring]. apply Rmult_integral in E. destruct E as [E|E]; [contradiction | exact E].
Qed.
Lemma orbit_of b e : inJ b -> inY e -> exists y, flows T_end b e y /\ forall i t, (i < 18)%nat -> 0 <= t <= T_end -> s i b e t = y i t.
Proof.
  intros Hb He. destruct (run b e (inside_box b e Hb He)) as [y [Fl _]]. exists y. split; [exact Fl|]. intros. apply (st_is T_end T_end_pos); assumption.
Qed.
Lemma return_is j b e : (j < k)%nat -> inJ b -> inY e -> (comes_back tl th (S j) b e <-> X j (x_of c j) b e = 0).
Proof.
  intros Hj Hb He. rewrite (x_zero j b e Hj). destruct (orbit_of b e Hb He) as [y [Fl S0]]. destruct (tau_of j Hj b e (inside_box b e Hb He)) as [Ht Hz].
  pose proof (return_times j Hj) as RT. split.
  - intros [t [Hin Ho]]. fold (lo j) (hi j) in Hin. apply (half_orbit_is T_end b e y t) in Ho; [|lra | assumption]. destruct Ho as [E Z].
    assert (E' : t = tau j b e) by (apply Hz; [lra | rewrite S0; [assumption | lia | lra]]). rewrite <- E', S0; [assumption | lia | lra].
  - intros E. exists (tau j b e). fold (lo j) (hi j). split; [assumption|]. apply (half_orbit_is T_end b e y); [lra | assumption|].
    rewrite <- !S0 by (lia || lra). split; [assumption|]. apply Hz; [lra | reflexivity].
Qed.
(* The family comes back again and again. *)
Lemma family_returns j b e : (j < k)%nat -> inJ b -> inY e -> F b e = 0 ->
  X j (x_of c j) b e = 0 /\ tau j b e = INR (S j) * tau 0%nat b e /\ (Nat.even (S j) = true -> vs j b e 1%nat = e).
Proof.
  intros Hj Hb He E. apply (x_zero 0 b e first_below) in E. destruct (orbit_of b e Hb He) as [y [Fl S0]].
  destruct (tau_of 0 first_below b e (inside_box b e Hb He)) as [Ht Hz]. destruct (tau_of j Hj b e (inside_box b e Hb He)) as [Htj Hzj].
  pose proof (return_times 0 first_below) as RT. pose proof (return_times j Hj) as RTj.
  assert (Z : s 2%nat b e (tau 0%nat b e) = 0) by (apply Hz; [lra | reflexivity]). rewrite S0 in E, Z by (lia || lra).
  assert (In : lo j < INR (S j) * tau 0%nat b e < hi j).
  { pose proof (in_k j Hj) as Ij. set (t0 := tau 0%nat b e) in *. clearbody t0. clear -Ht Ij. unfold lo, hi in *. change (INR 1) with 1 in *. rewrite !Rmult_1_l in Ht. split; apply Rmult_lt_compat_l; lra. }
  destruct (multiples T_end b e y (tau 0%nat b e) Fl ltac:(lra) E Z (S j) ltac:(lra)) as [X2 [Z2 Y2]].
  assert (W : tau j b e = INR (S j) * tau 0%nat b e) by (symmetry; apply Hzj; [lra | rewrite S0 by (lia || lra); exact Z2]).
  split; [apply (x_zero j b e Hj); rewrite W, S0 by (lia || lra); exact X2|]. split; [exact W|]. intros Ev.
  change (vs j b e 1%nat) with (s 1%nat b e (tau j b e)). rewrite W, S0 by (lia || lra). exact (Y2 Ev).
Qed.

(* The other point of an orbit that has both ends on the line. *)
Notation other b e := (vs n b e 1%nat).
Lemma other_of_family b e : Nat.even k = true -> inJ b -> inY e -> F b e = 0 -> other b e = e.
Proof. intros Ev Hb He E. destruct (family_returns n b e n_below Hb He E) as [_ [_ Q]]. apply Q. rewrite <- k_is. exact Ev. Qed.
Lemma other_lipschitz b e b' e' : Nat.even k = true -> inJ b -> inY e -> inJ b' -> inY e' ->
  Rabs (other b' e' - other b e) <= (bound p (of_formula c false n (De (At 1))) + bound p (of_formula c false n (Db (At 1)))) * (Rabs (b' - b) + Rabs (e' - e)).
Proof.
  intros Ev Hb He Hb' He'. destruct (n_even numbers_are Ev) as [_ [K1 K2]].
  destruct (mean_value_around (fun e => X n (At 1) b' e) (fun e => X n (De (At 1)) b' e) el eh e e') as [u [Hu E]]; [intros q Hq; exact (by_e n (At 1) b' q n_below eq_refl Hb' Hq) | exact He | exact He' |].
  destruct (mean_value_around (fun b => X n (At 1) b e) (fun b => X n (Db (At 1)) b e) bl bh b b') as [w [Hw E']]; [intros q Hq; exact (by_b n (At 1) q e n_below eq_refl Hq He) | exact Hb | exact Hb' |].
  pose proof (bound_is p _ _ K1 (in_formula n (De (At 1)) b' u n_below (inside_box b' u Hb' Hu))) as B1.
  pose proof (bound_is p _ _ K2 (in_formula n (Db (At 1)) w e n_below (inside_box w e Hw He))) as B2.
  change (Rabs (X n (At 1) b' e' - X n (At 1) b e) <= (bound p (of_formula c false n (De (At 1))) + bound p (of_formula c false n (Db (At 1)))) * (Rabs (b' - b) + Rabs (e' - e))).
  replace (X n (At 1) b' e' - X n (At 1) b e) with ((X n (At 1) b' e' - X n (At 1) b' e) + (X n (At 1) b' e - X n (At 1) b e)) by ring.
  eapply Rle_trans; [apply Rabs_triang|]. cbv beta in E, E'. rewrite E, E', !Rabs_mult. pose proof (Rabs_pos (e' - e)). pose proof (Rabs_pos (b' - b)).
  set (x1 := bound p (of_formula c false n (De (At 1)))) in *. set (x2 := bound p (of_formula c false n (Db (At 1)))) in *.
  set (d1 := Rabs (X n (De (At 1)) b' u)) in *. set (d2 := Rabs (X n (Db (At 1)) w e)) in *. assert (0 <= d1) by apply Rabs_pos. assert (0 <= d2) by apply Rabs_pos.
  clearbody x1 x2 d1 d2. nra.
Qed.
(* Zeros at the returns before the last are points of the family. *)
Lemma only_family j b e e' : (S j < k)%nat -> inJ b -> inY e -> inY e' -> F b e' = 0 -> X j (x_of c j) b e = 0 -> e = e'.
Proof.
  intros Hj Hb He He' E0 Ej. assert (Hj' : (j < k)%nat) by lia. destruct (family_returns j b e' Hj' Hb He' E0) as [E1 _].
  destruct (mean_value_around (fun e => X j (x_of c j) b e) (fun e => X j (De (x_of c j)) b e) el eh e e') as [u [Hu E]];
    [intros q Hq; exact (by_e j (x_of c j) b q Hj' (proj1 (places_0 _)) Hb Hq) | exact He | exact He' |].
  cbv beta in E. rewrite E1, Ej in E. pose proof (rises_at j b u Hj Hb Hu) as P. assert (Q : X j (De (x_of c j)) b u * (e' - e) = 0) by lra.
  apply Rmult_integral in Q. destruct Q; lra.
Qed.
Lemma other_is_on_the_branch b e : Nat.even k = true -> inJ b -> inY e -> (exists e', inY e' /\ F b e' = 0) -> G b e = 0 -> F b e <> 0 -> inY (other b e) ->
  other b e <> e /\ F b (other b e) <> 0 /\ G b (other b e) = 0.
Proof.
  intros Ev Hb He [ef [Hef Eef]] E NF He'. apply (x_zero n b e n_below) in E.
  destruct (orbit_of b e Hb He) as [y [Fl S0]]. destruct (orbit_of b _ Hb He') as [y' [Fl' S1]].
  destruct (tau_of n n_below b e (inside_box b e Hb He)) as [Ht Hz]. destruct (tau_of n n_below b _ (inside_box b _ Hb He')) as [Ht2 Hz2].
  pose proof (return_times n n_below) as RT. set (t1 := tau n b e) in *.
  assert (Z : s 2%nat b e t1 = 0) by (apply Hz; [lra | reflexivity]). rewrite S0 in E, Z by (lia || lra).
  assert (O : other b e = y 1%nat t1) by (change (other b e) with (s 1%nat b e t1); rewrite S0; [reflexivity | lia | lra]).
  rewrite O in Fl'. pose proof (other_end T_end b e y t1 y' Fl ltac:(lra) E Z Fl') as Back. rewrite <- O in Fl'. pose proof Fl as [F0 _].
  assert (M' : forall i, (i < 3)%nat -> y' i t1 = mirrored i (from e i)).
  { intros i Hi. rewrite (Back i t1 Hi) by lra. rewrite Rminus_eq_0, F0 by lia. reflexivity. }
  assert (W : t1 = tau n b (other b e)) by (apply Hz2; [lra | rewrite S1 by (lia || lra); rewrite M' by lia; cbn; ring]).
  assert (Again : other b (other b e) = e).
  { change (other b (other b e)) with (s 1%nat b (other b e) (tau n b (other b e))). rewrite <- W, S1, M' by (lia || lra). reflexivity. }
  assert (Ne : other b e <> e).
  { intros Q. apply NF. apply Nat.even_spec in Ev. destruct Ev as [h Eh]. pose proof (n_order numbers_are) as K2. destruct h as [|j]; [lia|].
    assert (Hj : (S j < k)%nat) by lia. assert (Hj' : (j < k)%nat) by lia.
    assert (Half : comes_back tl th (S j) b e).
    { exists (t1 / 2). assert (Q2 : INR (S n) = 2 * INR (S j)) by (rewrite <- k_is, Eh, mult_INR; reflexivity).
      assert (L1 : lo n = 2 * (INR (S j) * tl)) by (unfold lo; rewrite Q2; ring). assert (L2 : hi n = 2 * (INR (S j) * th)) by (unfold hi; rewrite Q2; ring).
      split; [lra|]. apply (half_orbit_is T_end b e y); [lra | assumption|].
      assert (Same : forall i t, (i < 3)%nat -> 0 <= t <= T_end -> y' i t = y i t) by (intros i t Hi Hs; rewrite <- S1, <- S0 by (lia || lra); rewrite Q; reflexivity).
      assert (Mid : forall i, (i < 3)%nat -> y i (t1 / 2) = mirrored i (y i (t1 / 2))).
      { intros i Hi. rewrite <- (Same i (t1 / 2) Hi) at 1 by lra. rewrite (Back i (t1 / 2) Hi) by lra. f_equal. f_equal. field. }
      pose proof (Mid 0%nat ltac:(lia)) as A0. pose proof (Mid 2%nat ltac:(lia)) as A2. cbn [mirrored] in A0, A2. lra. }
    apply (return_is j b e Hj' Hb He) in Half. rewrite (only_family j b e ef Hj Hb He Hef Eef Half). exact Eef. }
  split; [assumption|]. split.
  - intros Q. apply Ne. rewrite <- Again at 2. symmetry. apply other_of_family; assumption.
  - apply (x_zero n _ _ n_below). rewrite <- W, S1, M' by (lia || lra). cbn. ring.
Qed.

Definition along (branch : R -> R) (l e0 h : R) : Prop :=
  if Nat.even k then rises (fun e => IZR (side c) * branch e) l e0 /\ falls (fun e => IZR (side c) * branch e) e0 h
  else rises (fun e => IZR (side c) * branch e) l h.
Theorem tupling_here : bifurcation k bc ec nb ne tl th A D along.
Proof.
  pose proof (n_b numbers_are) as Pb. pose proof (n_e numbers_are) as Pe. pose proof (n_order numbers_are) as K2.
  assert (Hbl : bl < bh) by lra. assert (Hel : el < eh) by lra.
  pose proof (fun b e Hb He => by_e 0 (x_of c 0) b e first_below (proj1 (places_0 _)) Hb He) as F_e.
  pose proof (fun b e Hb He => by_b 0 (x_of c 0) b e first_below (proj2 (places_0 _)) Hb He) as F_b.
  pose proof (fun b e Hb He => by_e n (x_of c n) b e n_below (proj1 (places_0 _)) Hb He) as G_e.
  pose proof (fun b e Hb He => by_e n (De (x_of c n)) b e n_below (proj1 (places_1 _)) Hb He) as Ge_e.
  pose proof (fun b e Hb He => by_b n (De (x_of c n)) b e n_below (proj2 (places_1 _)) Hb He) as Ge_b.
  pose proof (fun b e Hb He => by_e n (De (De (x_of c n))) b e n_below (places_2 _) Hb He) as Gee_e.
  assert (Vanishes : forall b e, inJ b -> inY e -> F b e = 0 -> G b e = 0) by (intros b e Hb He E; apply (family_returns n b e n_below Hb He E)).
  assert (T : A * bound p Gee' < low p Gbe') by (pose proof transversal; lra).
  destruct (two_curves_cross bl bh el eh Hbl Hel (fun b e => F b e) (fun b e => Fe b e) (fun b e => Fb b e) F_e F_b _ _ A (proj2 Fe_known) Fe_bounds Fb_bound F_low F_high
    (fun b e => G b e) (fun b e => Ge b e) (fun b e => Gee b e) (fun b e => Gbe b e) G_e Ge_e Ge_b Vanishes _ _ _ Gbe_bounds Gee_bound T Ge_low Ge_high) as [b0 Cross].
  pose proof (touch_and_go bl bh el eh Hbl Hel (fun b e => F b e) (fun b e => Fe b e) (fun b e => Fb b e) F_e F_b _ _ A (proj2 Fe_known) Fe_bounds Fb_bound F_low F_high
    (fun b e => G b e) (fun b e => Ge b e) (fun b e => Gee b e) (fun b e => Gbe b e) G_e Ge_e Ge_b Vanishes _ _ _ Gbe_bounds Gee_bound T Ge_low Ge_high
    (IZR (side c)) (n_side numbers_are)) as Touch.
  pose proof (pitchfork bl bh el eh Hbl Hel (fun b e => F b e) (fun b e => Fe b e) (fun b e => Fb b e) F_e F_b _ _ A (proj2 Fe_known) Fe_bounds Fb_bound F_low F_high
    (fun b e => G b e) (fun b e => Ge b e) (fun b e => Gee b e) (fun b e => Gbe b e) G_e Ge_e Ge_b Vanishes _ _ _ Gbe_bounds Gee_bound T Ge_low Ge_high
    (IZR (side c)) (n_side numbers_are) (fun b e => Geee b e) Gee_e) as Fork.
  set (fam := family el eh (fun b e => F b e)) in *. set (br := branch bl bh el eh (fun b e => F b e) (fun b e => G b e) (fun b e => Ge b e)) in *.
  pose proof Cross as [C1 [C2 [C3 [C4 [C5 [C6 [C7 [C8 [C9 [C10 C11]]]]]]]]]].
  assert (Fam : forall b, inJ b -> inY (fam b) /\ F b (fam b) = 0).
  { intros b Hb. assert (Q : inY (fam b)) by (specialize (C1 b Hb); unfold Y; lra). split; [exact Q|]. apply (C5 b (fam b) Hb Q). reflexivity. }
  exists fam, br, b0, (fam b0). split.
  - split; [exact C1|]. split; [exact C2|]. split; [exact C3|]. split.
    { intros e e' He He'. eapply Rle_trans; [apply C4; assumption|]. apply Rmult_le_compat_r; [apply Rabs_pos | exact D_is]. }
    split.
    { intros j b e Hj Hb He. destruct j as [|j]; [lia|]. assert (Hj' : (j < k)%nat) by lia. rewrite (return_is j b e Hj' Hb He). destruct (Fam b Hb) as [Yf Ef]. split.
      - intros E. exact (only_family j b e (fam b) ltac:(lia) Hb He Yf Ef E).
      - intros ->. exact (proj1 (family_returns j b (fam b) Hj' Hb Yf Ef)). }
    split; [intros b e Hb He; rewrite k_is; rewrite (return_is n b e n_below Hb He); apply C6; assumption|].
    split; [exact C7|]. split; [exact C8|]. split; [exact C9|]. split; [exact C10 | exact C11].
  - unfold along. destruct (Nat.even k) eqn:Ev.
    + destruct (n_even numbers_are Ev) as [P3 _]. unfold rises, falls.
      apply (Fork ltac:(intros b e Hb He; exact (positive_sound p _ _ P3 (in_formula n (oriented c (De (De (De (x_of c n))))) b e n_below (inside_box b e Hb He))))
        (fun b e => other b e) (bound p (of_formula c false n (De (At 1))) + bound p (of_formula c false n (Db (At 1))))).
      * destruct (n_even numbers_are Ev) as [_ [K3 K4]]. pose proof (bound_is p _ _ K3 (in_formula n (De (At 1)) bc ec n_below in_the_centre)) as B1.
        pose proof (bound_is p _ _ K4 (in_formula n (Db (At 1)) bc ec n_below in_the_centre)) as B2.
        pose proof (Rabs_pos (X n (De (At 1)) bc ec)). pose proof (Rabs_pos (X n (Db (At 1)) bc ec)). lra.
      * intros b e b' e'. exact (other_lipschitz b e b' e' Ev).
      * intros b e. exact (other_of_family b e Ev).
      * intros b e Hb He. exact (other_is_on_the_branch b e Ev Hb He (ex_intro _ (fam b) (Fam b Hb))).
      * exact Cross.
    + pose proof (n_odd numbers_are Ev) as P2. unfold rises.
      exact (Touch ltac:(intros b e Hb He; exact (negative_sound p _ _ P2 (in_formula n (oriented c (De (De (x_of c n)))) b e n_below (inside_box b e Hb He))))).
Qed.
End Proof.

(* From numbers and two lists of steps to the theorem. *)
Theorem tupling c around centre : good_around c around = true -> good_centre c centre = true -> good_numbers c = true ->
  bifurcation (order c) (real_of (parameter c)) (real_of (beginning c)) (real_of (near_b c)) (real_of (near_e c))
    (r_ (first c) / two_to (clock c)) (r_ (first c + 1)%bigZ / two_to (clock c)) (real_of (slope_b c)) (real_of (slope_e c)) (along c).
Proof.
  intros Ha Hc Hn. destruct (around_is c around Ha) as [Ba [Ta _]]. destruct (centre_is c centre Hc Hn) as [Bc _].
  destruct (box_flows c false around Ba) as [r [_ Ra]]. rewrite Ta in Ra. destruct (box_flows c true centre Bc) as [r' [_ Rc]].
  destruct (box_solved_sound _ Bc) as [Forwards _].
  destruct (Rc (bc c) (ec c)) as [y [Fy [_ Cy]]].
  - unfold bc. rewrite Rminus_eq_0, Rabs_R0. unfold real_of. cbn [fst snd]. rewrite r_0, r_1. lra.
  - unfold ec. rewrite Rminus_eq_0, Rabs_R0. unfold real_of. cbn [fst snd]. rewrite r_0, r_1. lra.
  - exact (tupling_here c around centre Ha Hc Hn r (fun b e H => Ra b e (proj1 H) (proj2 H)) y Fy Cy Forwards).
Qed.

(* What the theorems of Statements.v name, as whole numbers. *)
Definition named (c : case) : nat * list ratio * (Z * bigZ * bigZ) :=
  (order c, [parameter c; beginning c; near_b c; near_e c; slope_b c; slope_e c], (side c, clock c, first c)).
Lemma two_to_12 : two_to 12%bigZ = 4096.
Proof. unfold two_to. change (BigZ.to_Z 12%bigZ) with 12%Z. rewrite power_of_2 by lia. reflexivity. Qed.
Lemma two_to_14 : two_to 14%bigZ = 16384.
Proof. unfold two_to. change (BigZ.to_Z 14%bigZ) with 14%Z. rewrite power_of_2 by lia. reflexivity. Qed.
Lemma over_1 x : x / 1 = x.
Proof. field. Qed.
Lemma same_along k b e rb re tl th A D (one other : (R -> R) -> R -> R -> R -> Prop) :
  (forall f l p h, one f l p h -> other f l p h) -> bifurcation k b e rb re tl th A D one -> bifurcation k b e rb re tl th A D other.
Proof. intros H [f [g [b0 [e0 [H1 H2]]]]]. exists f, g, b0, e0. auto. Qed.
Ltac with_these_numbers c E H := unfold named in E; injection E; clear E; intros; revert H; unfold along;
  repeat match goal with Q : _ c = _ |- _ => rewrite Q; clear Q end; rewrite ?two_to_12, ?two_to_14; unfold real_of; cbn [fst snd]; numbers; rewrite ?over_1;
  apply same_along; cbn [Nat.even]; unfold rises, falls; intros f l q h.

Theorem period_doubling_proved c : named c =
    (2%nat, [(34018753498914353231, 100000000000000000); (939792756949623004649, 1000000000000000000000); (1, 1000000000); (1, 10000000000000);
      (1, 250000); (300, 1)]%bigZ, (1%Z, 12, 943)%bigZ) ->
  forall around centre, good_around c around = true -> good_centre c centre = true -> good_numbers c = true -> period_doubling.
Proof.
  intros E around centre Ha Hc Hn. pose proof (tupling c around centre Ha Hc Hn) as H. with_these_numbers c E H.
  intros [P Q]. split; intros u w Hu Huw Hw; [specialize (P u w Hu Huw Hw) | specialize (Q u w Hu Huw Hw)]; lra.
Qed.
Theorem period_tripling_proved c : named c =
    (3%nat, [(45344258682138482263, 100000000000000000); (939848585715971576541, 1000000000000000000000); (1, 1000000000); (1, 10000000000000);
      (1, 250000); (8000, 1)]%bigZ, (1%Z, 14, 3267)%bigZ) ->
  forall around centre, good_around c around = true -> good_centre c centre = true -> good_numbers c = true -> period_tripling.
Proof.
  intros E around centre Ha Hc Hn. pose proof (tupling c around centre Ha Hc Hn) as H. with_these_numbers c E H.
  intros P u w Hu Huw Hw. specialize (P u w Hu Huw Hw). lra.
Qed.
Theorem period_quadrupling_proved c : named c =
    (4%nat, [(67995415507296894513, 100000000000000000); (939904499164097608213, 1000000000000000000000); (1, 100000000000); (1, 1000000000000000);
      (1, 250000); (600, 1)]%bigZ, ((-1)%Z, 14, 2667)%bigZ) ->
  forall around centre, good_around c around = true -> good_centre c centre = true -> good_numbers c = true -> period_quadrupling.
Proof.
  intros E around centre Ha Hc Hn. pose proof (tupling c around centre Ha Hc Hn) as H. with_these_numbers c E H.
  intros [P Q]. split; intros u w Hu Huw Hw; [specialize (P u w Hu Huw Hw) | specialize (Q u w Hu Huw Hw)]; lra.
Qed.
