(* Orbits of twice the period branch off in the Falkner-Skan equation: a theorem about real functions, from two lists of steps that
   the kernel has checked.

   Orbits begin in (0, e, 0), a point that the reversor (x, y, z) -> (-x, y, -z) fixes. Where they meet the line x = z = 0 of all such
   points again, after the time T, they are half of a periodic orbit: its period is 2 T. *)

From Coq Require Import List ZArith Reals Lra Lia.
From Coquelicot Require Import Coquelicot.
From Interval Require Import Tactic.
From Bignums Require Import BigZ.
From Orbitproof Require Import Polynomials Elements Formats Programs Steps Sound.
From Solutions Require Import Comparison Existence Flow Norms Values Fields CheckedFlow InitialValues Dependence Boxes Curves Variations Returns.
Import ListNotations.
Local Open Scope R_scope.
Local Open Scope list_scope.

(* From (0, e, 0) back to the line x = z = 0 in the time T. *)
Definition half_orbit (b e T : R) : Prop := exists x y z : R -> R,
  (x 0 = 0 /\ y 0 = e /\ z 0 = 0) /\
  (forall t, 0 <= t <= T -> is_derive x t (y t) /\ is_derive y t (z t) /\ is_derive z t (b * (y t ^ 2 - 1) - x t * z t)) /\
  x T = 0 /\ z T = 0.

Definition b_centre : R := 34018753498914353231 / 100000000000000000.
Definition e_centre : R := 939792756949623004649 / 1000000000000000000000.
Definition J (b : R) : Prop := b_centre - / 1000000000 <= b <= b_centre + / 1000000000.
Definition Y (e : R) : Prop := e_centre - / 10000000000000 <= e <= e_centre + / 10000000000000.
Definition once (b e : R) : Prop := exists T, 943 / 4096 < T < 944 / 4096 /\ half_orbit b e T.
Definition twice (b e : R) : Prop := exists T, 1886 / 4096 < T < 1888 / 4096 /\ half_orbit b e T.

(* Over J x Y, the points with orbits of the first kind are a curve over b, those with orbits of the second kind are this curve and
   another one over e. They cross at one point, (b0, e0), and there b has its only maximum along the second curve: from it two
   points of the second curve branch off, to the side b < b0. *)
Definition period_doubling : Prop := exists (family branch : R -> R) (b0 e0 : R),
  (forall b, J b -> e_centre - / 10000000000000 < family b < e_centre + / 10000000000000) /\
  (forall e, Y e -> b_centre - / 1000000000 < branch e < b_centre + / 1000000000) /\
  (forall b b', J b -> J b' -> Rabs (family b' - family b) <= 4 / 1000000 * Rabs (b' - b)) /\
  (forall e e', Y e -> Y e' -> Rabs (branch e' - branch e) <= 300 * Rabs (e' - e)) /\
  (forall b e, J b -> Y e -> (once b e <-> e = family b)) /\
  (forall b e, J b -> Y e -> (twice b e <-> e = family b \/ b = branch e)) /\
  (b_centre - / 1000000000 < b0 < b_centre + / 1000000000) /\ (e_centre - / 10000000000000 < e0 < e_centre + / 10000000000000) /\
  family b0 = e0 /\ branch e0 = b0 /\
  (forall b e, J b -> Y e -> e = family b -> b = branch e -> b = b0 /\ e = e0) /\
  (forall e e', e_centre - / 10000000000000 <= e -> e < e' -> e' <= e0 -> branch e < branch e') /\
  (forall e e', e0 <= e -> e < e' -> e' <= e_centre + / 10000000000000 -> branch e' < branch e).

(* Three equations only. *)
Definition fs3_program : program := Program 4 [Mul 1 1; Const 1 1; Sub 4 5; Mul 3 6; Mul 0 2; Sub 7 8] [1; 2; 9]%nat.
Lemma fs3_is b x i : (i < 3)%nat -> field_of fs3_program 3 [b] x i = fs b x i.
Proof.
  intros Hi. unfold field_of. do 3 (destruct i as [|i]; [cbv [fs fs3_program outputs nodes nth all_values node_value app map seq]; numbers; field|]). lia.
Qed.
Lemma fs3_lipschitz b : locally_lipschitz 3 (fs b).
Proof.
  intros r. destruct (field_of_is_lipschitz fs3_program 3 [b] r) as [L [HL H]]. exists L. split; [assumption|].
  intros x y Hx Hy i Hi. rewrite <- !fs3_is by assumption. auto.
Qed.
Lemma flows_shorter T T' b e y : T' <= T -> flows T b e y -> solves 3 (fs b) T' y.
Proof. intros H [_ S] i t Hi Ht. apply S; [lia | lra]. Qed.
Lemma half_orbit_is T b e y T' : 0 <= T' <= T -> flows T b e y -> (half_orbit b e T' <-> y 0%nat T' = 0 /\ y 2%nat T' = 0).
Proof.
  intros HT F. split.
  - intros [x1 [y1 [z1 [[X0 [Y0 Z0]] [D [XT ZT]]]]]].
    pose (u := fun i : nat => match i with 0%nat => x1 | 1%nat => y1 | _ => z1 end).
    assert (S : solves 3 (fs b) T' u).
    { intros i t Hi Ht. destruct (D t Ht) as [D1 [D2 D3]]. destruct i as [|[|[|i]]]; [exact D1 | exact D2 | | lia]. cbn [fs u].
      replace (b * (y1 t * y1 t - 1) - x1 t * z1 t) with (b * (y1 t ^ 2 - 1) - x1 t * z1 t) by ring. exact D3. }
    assert (E : forall i t, (i < 3)%nat -> 0 <= t <= T' -> u i t = y i t).
    { apply (unique 3 (fs b) (fs3_lipschitz b) T'); [lra | assumption | apply (flows_shorter T T' b e y); [lra | assumption]|].
      intros i Hi. destruct F as [F0 _]. rewrite F0 by lia. destruct i as [|[|[|i]]]; [exact X0 | exact Y0 | exact Z0 | lia]. }
    split; [rewrite <- (E 0%nat) | rewrite <- (E 2%nat)]; (assumption || lia || lra).
  - intros [E1 E2]. exists (y 0%nat), (y 1%nat), (y 2%nat). destruct F as [F0 S]. rewrite !F0 by lia. split; [cbn; auto|]. split; [|auto].
    intros t Ht. split; [|split].
    + apply (S 0%nat); [lia | lra].
    + apply (S 1%nat); [lia | lra].
    + replace (b * (y 1%nat t ^ 2 - 1) - y 0%nat t * y 2%nat t) with (b * (y 1%nat t * y 1%nat t - 1) - y 0%nat t * y 2%nat t) by ring.
      apply (S 2%nat); [lia | lra].
Qed.

(* The way back. *)
Definition mirrored (i : nat) (u : R) : R := match i with 1%nat => u | _ => - u end.
Lemma backwards T b e y s : flows T b e y -> 0 <= s <= T -> solves 3 (fs b) s (fun i t => mirrored i (y i (s - t))).
Proof.
  intros [F0 S] Hs i t Hi Ht.
  assert (D : forall j, (j < 3)%nat -> is_derive (fun t => y j (s - t)) t (- fs b (fun k => y k (s - t)) j)).
  { intros j Hj. replace (- fs b (fun k => y k (s - t)) j) with (scal (-1) (fs b (fun k => y k (s - t)) j)) by (unfold scal; cbn; unfold mult; cbn; ring).
    apply (is_derive_comp (V := R_NormedModule) (y j) (fun t => s - t)); [apply S; [lia | lra]|]. auto_derive; [exact I | ring]. }
  pose proof (D i Hi) as Di. destruct i as [|[|[|i]]]; [| | | lia]; cbn [fs mirrored] in *.
  - apply (is_derive_opp (V := R_NormedModule)) in Di. replace (y 1%nat (s - t)) with (opp (- y 1%nat (s - t))) by (unfold opp; cbn; ring). exact Di.
  - exact Di.
  - apply (is_derive_opp (V := R_NormedModule)) in Di.
    match type of Di with is_derive _ _ ?l => match goal with |- is_derive _ _ ?k => replace k with l by (unfold opp; cbn; ring) end end. exact Di.
Qed.
Lemma mirrored_solution T b e y s : flows T b e y -> 0 <= s -> 2 * s <= T -> y 0%nat s = 0 -> y 2%nat s = 0 ->
  y 0%nat (2 * s) = 0 /\ y 1%nat (2 * s) = e /\ y 2%nat (2 * s) = 0.
Proof.
  intros Fl Hs HT X Z. pose proof Fl as [F0 S].
  assert (E : forall i t, (i < 3)%nat -> 0 <= t <= s -> y i (s + t) = mirrored i (y i (s - t))).
  { apply (unique 3 (fs b) (fs3_lipschitz b) s (fun i t => y i (s + t)) (fun i t => mirrored i (y i (s - t)))); [lra | | |].
    - intros i t Hi Ht. replace (fs b (fun j => y j (s + t)) i) with (scal 1 (fs b (fun j => y j (s + t)) i)) by (unfold scal; cbn; unfold mult; cbn; ring).
      apply (is_derive_comp (V := R_NormedModule) (y i) (fun t => s + t)); [apply S; [lia | lra]|]. auto_derive; [exact I | ring].
    - apply (backwards T b e); [assumption | lra].
    - intros i Hi. rewrite Rplus_0_r, Rminus_0_r. destruct i as [|[|[|i]]]; [| reflexivity | | lia]; cbn [mirrored]; [rewrite X | rewrite Z]; ring. }
  assert (E' : forall i, (i < 3)%nat -> y i (2 * s) = mirrored i (from e i)).
  { intros i Hi. pose proof (E i s Hi ltac:(lra)) as Q. rewrite Rminus_eq_0, F0 in Q by lia. replace (s + s) with (2 * s) in Q by ring. exact Q. }
  rewrite !E' by lia. cbn. repeat split; ring.
Qed.
(* From where an orbit meets the line it goes the same way back. *)
Lemma other_end T b e y s y' : flows T b e y -> 0 <= s <= T -> y 0%nat s = 0 -> y 2%nat s = 0 -> flows T b (y 1%nat s) y' ->
  forall i t, (i < 3)%nat -> 0 <= t <= s -> y' i t = mirrored i (y i (s - t)).
Proof.
  intros Fl Hs X Z [F0' S']. apply (unique 3 (fs b) (fs3_lipschitz b) s y' (fun i t => mirrored i (y i (s - t)))); [lra | | |].
  - intros i t Hi Ht. apply S'; [lia | lra].
  - apply (backwards T b e); assumption.
  - intros i Hi. rewrite F0', Rminus_0_r by lia. destruct i as [|[|[|i]]]; [| reflexivity | | lia]; cbn [mirrored from]; [rewrite X | rewrite Z]; ring.
Qed.

(* What the kernel computes. *)
Definition b_ratio : ratio := (34018753498914353231, 100000000000000000)%bigZ.
Definition e_ratio : ratio := (939792756949623004649, 1000000000000000000000)%bigZ.
Definition exactly_zero : ratio * ratio := ((0, 1), (0, 1))%bigZ.
Definition exactly_one : ratio * ratio := ((1, 1), (0, 1))%bigZ.
Definition fs_format : format := format_of [] 0 128 0 30 188.
Definition box_of (steps : list step) (rb re : ratio) (d : bigZ) (claims : list claim) : box_problem :=
  BoxProblem fs_program [(b_ratio, rb)]
    ([exactly_zero; (e_ratio, re); exactly_zero; exactly_zero; exactly_one] ++ repeat exactly_zero 13) fs_format steps d claims.

(* x, y, z and their derivatives at the first and at the second return, over 10^12 and, for the centre, over 10^18. *)
Definition around_once : list ends := [(-421691646, 571355776); (-1993908962929, -1993828500594); (-290064709834, 214084320795);
   (1892577626404, 1892628412351); (-135124670427, 183081592101); (-638930020762503, -638861378555621);
   (-676744985, -676710450); (-112975016, 58156305); (342468119742, 343996814432);
   (31692838726946, 31895170863220); (402240180134014, 407627008106251); (-10885635305693072, -10612362555143477);
   (-2837378479, -2729347509); (-217036552705, -216542773794); (-1028697188768, -882573214070);
   (793894653796593, 804062867032378); (20411480890778951, 20417966808338575);
   (-16531163994585189, -2777219018001590)]%bigZ.
Definition around_twice : list ends := [(-538607068, 397521325); (939786275948, 939799014098); (-16807419091, 22771915534); (-423147995, 573272405);
   (-1000106978138, -999896624517); (-270562038249, 366553317997); (636763073, 636773095); (-10085384, 16753114);
   (-26970388973, -26851895178); (-188798754246, -155486603800); (-33426278942520, -33411818969091);
   (-1374959555999, 19247709099747); (-438322952, -432336451); (5786932934, 6072815455);
   (-287235060597, -285285750006); (80968808736113, 81473567997255); (464130579109718, 519013864732834);
   (54762571593468847, 55153337400606780)]%bigZ.
Definition centre_once : list ends := [(-2094, 8745); (-1993869444668199168, -1993869444668199166); (-4439308, 1062840);
   (1892603469345987593, 1892603469345987594); (-670839, 2801981);
   (-638896307830828262220, -638896307830828262168); (-676728504560544, -676728504560543);
   (-14525352819047, -14525352817180); (343345207939017017, 343345207939033299);
   (31809194814959328809, 31809194814961527695); (404529787529936367569, 404529787529994907038);
   (-10769514584797558426369, -10769514584794588606262); (-2791500014703066, -2791500014701887);
   (-216825322940166571, -216825322940161435); (-944639104163366227, -944639104161773257);
   (799744940006355390586, 799744940006466356326); (20414342107934967541215, 20414342107935025674131);
   (-10688621809361732897786, -10688621809211861929384)]%bigZ.
Definition centre_twice : list ends := [(-4020, 1089); (939792756949623003, 939792756949623007); (-46067, 169976); (-1172, 4290);
   (-1000000000000000307, -999999999999999716); (-748462, 2741972); (636768258031839, 636768258031841);
   (1313532387098, 1313532387245); (-26919797171408559, -26919797171407918);
   (-174651161306505956, -174651161306318854); (-33418436453732095096, -33418436453731923668);
   (7383492783758630393, 7383492783874391910); (-434885398955396, -434885398955360);
   (5908392238804336, 5908392238805981); (-286117519211455342, -286117519211442771);
   (81258241692039324912, 81258241692043130027); (495698564826724080224, 495698564827050174573);
   (54986767087572510225425, 54986767087575293397433)]%bigZ.
Definition loose : ends := (-1000000000000000000000000000000, 1000000000000000000000000000000)%bigZ.
Definition only_z (l h : bigZ) : list ends := [loose; loose; (l, h)] ++ repeat loose 15.
Definition around_claims : list claim :=
  [Claim true 12 around_once; Claim true 25 around_twice;
   Claim false 12 (only_z (-40000000000) (-30000000000)); Claim false 13 (only_z 200000000000 220000000000);
   Claim false 25 (only_z 2000000000 4000000000); Claim false 26 (only_z (-17000000000) (-15000000000))]%bigZ.
Definition centre_claims : list claim :=
  [Claim true 12 centre_once; Claim true 25 centre_twice;
   Claim false 12 (only_z (-2000000) (-1)); Claim false 13 (only_z 1 2000000);
   Claim false 25 (only_z 1 2000000); Claim false 26 (only_z (-2000000) (-1))]%bigZ.
Definition around_box (steps : list step) : box_problem := box_of steps (2, 1000000000)%bigZ (2, 10000000000000)%bigZ 1000000000000 around_claims.
Definition centre_box (steps : list step) : box_problem := box_of steps (0, 1)%bigZ (0, 1)%bigZ 1000000000000000000 centre_claims.

(* After k steps it is the time n / 2^d. *)
Definition is_time (steps : list step) (d : bigZ) (k : nat) (n : bigZ) : bool :=
  ((0 <=? d) && (finest (firstn k steps) <=? d) && (clock_of d (firstn k steps) =? n))%bigZ%bool.
Lemma is_time_sound steps d k n : is_time steps d k n = true -> time_of steps k = r_ n / two_to d.
Proof.
  intros H. unfold is_time in H. apply andb_prop in H. destruct H as [H H3]. apply andb_prop in H. destruct H as [_ H2].
  rewrite BigZ.spec_leb in H2. apply Z.leb_le in H2. apply BigZ.eqb_eq in H3.
  assert (E : r_ (clock_of d (firstn k steps)) = r_ n) by (unfold r_; f_equal; exact H3).
  rewrite clock_is in E by (intros s Hs; pose proof (finest_above _ _ Hs); lia). unfold time_of. rewrite <- E. pose proof (two_to_pos d). field. lra.
Qed.
Definition good_around (steps : list step) : bool :=
  (box_solved (around_box steps) && (length steps =? 27)%nat && is_time steps 12 12 943 && is_time steps 12 13 944
   && is_time steps 12 25 1886 && is_time steps 12 26 1888 && is_time steps 12 27 1889)%bigZ%bool.
Definition good_centre (steps : list step) : bool :=
  (box_solved (centre_box steps) && (length steps =? 26)%nat && is_time steps 50 12 259252122487674 && is_time steps 50 13 259252122487677
   && is_time steps 50 25 518504244975350 && is_time steps 50 26 518504244975353)%bigZ%bool.

Lemma zero_in_wide : in_wide exactly_zero 0.
Proof. unfold in_wide, exactly_zero, real_of. cbn [fst snd]. rewrite r_0, r_1. replace (0 - 0 / 1) with 0 by field. rewrite Rabs_R0. lra. Qed.
Lemma one_in_wide : in_wide exactly_one 1.
Proof. unfold in_wide, exactly_one, real_of. cbn [fst snd]. rewrite r_0, r_1. replace (1 - 1 / 1) with 0 by field. rewrite Rabs_R0. lra. Qed.

Lemma box_flows steps rb re d claims : box_solved (box_of steps rb re d claims) = true ->
  (forall k l, (k <= l)%nat -> time_of steps k <= time_of steps l) /\ exists r, 0 <= r /\
  forall b e, Rabs (b - real_of b_ratio) <= real_of rb -> Rabs (e - real_of e_ratio) <= real_of re ->
  exists y, flows (time_of steps (length steps)) b e y /\
    (forall i t, (i < 18)%nat -> 0 <= t <= time_of steps (length steps) -> Rabs (y i t) <= r) /\
    List.Forall (claim_holds (box_of steps rb re d claims) y) claims.
Proof.
  intros H. destruct (box_solved_sound _ H) as [Mono [r [Hr S]]]. split; [exact Mono|]. exists r. split; [assumption|].
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

Lemma two_to_12 : two_to 12%bigZ = 4096.
Proof. unfold two_to. change (BigZ.to_Z 12%bigZ) with 12%Z. rewrite power_of_2 by lia. reflexivity. Qed.
Lemma two_to_50 : two_to 50%bigZ = 1125899906842624.
Proof. unfold two_to. change (BigZ.to_Z 50%bigZ) with 50%Z. rewrite power_of_2 by lia. reflexivity. Qed.

Ltac numbers_in E := repeat match type of E with
  context [r_ ?c] => let n := eval vm_compute in (BigZ.to_Z c) in change (r_ c) with (IZR n) in E end.
(* The interval of place i. *)
Ltac interval_of H i E := pose proof (H i ltac:(lia)) as E; unfold between in E; cbn [nth fst snd around_once around_twice centre_once centre_twice] in E; numbers_in E.
Ltac all_intervals H :=
  let E0 := fresh "E" in interval_of H 0%nat E0; let E1 := fresh "E" in interval_of H 1%nat E1;
  let E2 := fresh "E" in interval_of H 2%nat E2; let E3 := fresh "E" in interval_of H 3%nat E3;
  let E4 := fresh "E" in interval_of H 4%nat E4; let E5 := fresh "E" in interval_of H 5%nat E5;
  let E6 := fresh "E" in interval_of H 6%nat E6; let E7 := fresh "E" in interval_of H 7%nat E7;
  let E8 := fresh "E" in interval_of H 8%nat E8; let E9 := fresh "E" in interval_of H 9%nat E9;
  let E10 := fresh "E" in interval_of H 10%nat E10; let E11 := fresh "E" in interval_of H 11%nat E11;
  let E12 := fresh "E" in interval_of H 12%nat E12; let E13 := fresh "E" in interval_of H 13%nat E13;
  let E14 := fresh "E" in interval_of H 14%nat E14; let E15 := fresh "E" in interval_of H 15%nat E15;
  let E16 := fresh "E" in interval_of H 16%nat E16; let E17 := fresh "E" in interval_of H 17%nat E17;
  repeat match goal with E : _ <= v ?T ?tl ?th ?sg ?i ?b ?e <= _ |- _ => let x := fresh "x" in set (x := v T tl th sg i b e) in *; clearbody x end.

Section Proof.
Variables around centre : list step.
Hypothesis around_good : good_around around = true.
Hypothesis centre_good : good_centre centre = true.
Definition T_end : R := 1889 / 4096.
Definition rb : R := 2 / 1000000000.
Definition re : R := 2 / 10000000000000.
Notation box b e := (in_box b_centre rb e_centre re b e).

Lemma T_end_pos : 0 < T_end.
Proof. unfold T_end. lra. Qed.
Lemma b_ratio_is : real_of b_ratio = b_centre.
Proof. unfold real_of, b_ratio, b_centre. cbn [fst snd]. numbers. reflexivity. Qed.
Lemma e_ratio_is : real_of e_ratio = e_centre.
Proof. unfold real_of, e_ratio, e_centre. cbn [fst snd]. numbers. reflexivity. Qed.

Lemma around_is : box_solved (around_box around) = true /\ length around = 27%nat /\
  time_of around 12 = 943 / 4096 /\ time_of around 13 = 944 / 4096 /\ time_of around 25 = 1886 / 4096 /\ time_of around 26 = 1888 / 4096 /\ time_of around 27 = T_end.
Proof.
  pose proof around_good as H. unfold good_around in H. apply andb_prop in H. destruct H as [H Q27]. apply andb_prop in H. destruct H as [H Q26]. apply andb_prop in H. destruct H as [H Q25].
  apply andb_prop in H. destruct H as [H Q13]. apply andb_prop in H. destruct H as [H Q12]. apply andb_prop in H. destruct H as [H QL].
  apply is_time_sound in Q12, Q13, Q25, Q26, Q27. rewrite two_to_12 in Q12, Q13, Q25, Q26, Q27. apply Nat.eqb_eq in QL.
  split; [exact H|]. split; [exact QL|]. split; [exact Q12|]. split; [exact Q13|]. split; [exact Q25|]. split; [exact Q26 | exact Q27].
Qed.
Lemma centre_is : box_solved (centre_box centre) = true /\ length centre = 26%nat /\
  time_of centre 12 = 259252122487674 / 1125899906842624 /\ time_of centre 13 = 259252122487677 / 1125899906842624 /\
  time_of centre 25 = 518504244975350 / 1125899906842624 /\ time_of centre 26 = 518504244975353 / 1125899906842624.
Proof.
  pose proof centre_good as H. unfold good_centre in H. apply andb_prop in H. destruct H as [H Q26]. apply andb_prop in H. destruct H as [H Q25].
  apply andb_prop in H. destruct H as [H Q13]. apply andb_prop in H. destruct H as [H Q12]. apply andb_prop in H. destruct H as [H QL].
  apply is_time_sound in Q12, Q13, Q25, Q26. rewrite two_to_50 in Q12, Q13, Q25, Q26. apply Nat.eqb_eq in QL.
  split; [exact H|]. split; [exact QL|]. split; [exact Q12|]. split; [exact Q13|]. split; [exact Q25 | exact Q26].
Qed.

Variable r : R.
Hypothesis run : forall b e, box b e -> exists y, flows T_end b e y /\
  (forall i t, (i < 18)%nat -> 0 <= t <= T_end -> Rabs (y i t) <= r) /\ List.Forall (claim_holds (around_box around) y) around_claims.
Variable y_centre : nat -> R -> R.
Definition T_centre : R := 518504244975353 / 1125899906842624.
Hypothesis centre_flows : flows T_centre b_centre e_centre y_centre.
Hypothesis centre_claimed : List.Forall (claim_holds (centre_box centre) y_centre) centre_claims.

Lemma solutions b e : box b e -> exists y, flows T_end b e y /\ forall i t, (i < 18)%nat -> 0 <= t <= T_end -> Rabs (y i t) <= r.
Proof. intros H. destruct (run b e H) as [y [H1 [H2 _]]]. exists y. auto. Qed.
Notation s i b e t := (st T_end i b e t).

Lemma st_claim c b e i t : In c around_claims -> box b e -> (i < 18)%nat -> 0 <= t <= T_end ->
  (if on_the_step c then time_of around (number c) <= t <= time_of around (S (number c)) else t = time_of around (number c)) ->
  between (r_ 1000000000000%bigZ) (nth i (intervals c) no_ends) (s i b e t).
Proof.
  intros Hc Hb Hi Ht Hk. destruct (run b e Hb) as [y [Hy [_ C]]]. rewrite (st_is T_end T_end_pos b e y i t Hy Hi Ht).
  rewrite List.Forall_forall in C. exact (C c Hc i t Hi Hk).
Qed.
Lemma once_enclosed b e i t : box b e -> (i < 18)%nat -> 943 / 4096 <= t <= 944 / 4096 -> between (r_ 1000000000000%bigZ) (nth i around_once no_ends) (s i b e t).
Proof.
  intros Hb Hi Ht. destruct around_is as [_ [_ [E12 [E13 _]]]].
  apply (st_claim (Claim true 12 around_once)); [left; reflexivity | assumption | assumption | unfold T_end; lra | cbn [on_the_step number]; rewrite E12, E13; assumption].
Qed.
Lemma twice_enclosed b e i t : box b e -> (i < 18)%nat -> 1886 / 4096 <= t <= 1888 / 4096 -> between (r_ 1000000000000%bigZ) (nth i around_twice no_ends) (s i b e t).
Proof.
  intros Hb Hi Ht. destruct around_is as [_ [_ [_ [_ [E25 [E26 _]]]]]].
  apply (st_claim (Claim true 25 around_twice)); [do 1 right; left; reflexivity | assumption | assumption | unfold T_end; lra | cbn [on_the_step number]; rewrite E25, E26; assumption].
Qed.
Lemma once_low b e : box b e -> 1 * s 2%nat b e (943 / 4096) < 0.
Proof.
  intros Hb. destruct around_is as [_ [_ [E12 _]]].
  pose proof (st_claim (Claim false 12 (only_z (-40000000000) (-30000000000))%bigZ) b e 2 (943 / 4096) ltac:(do 2 right; left; reflexivity) Hb ltac:(lia) ltac:(unfold T_end; lra)
    ltac:(cbn [on_the_step number]; symmetry; exact E12)) as E.
  unfold between in E. cbn [intervals only_z nth app fst snd] in E. numbers_in E. lra.
Qed.
Lemma once_high b e : box b e -> 0 < 1 * s 2%nat b e (944 / 4096).
Proof.
  intros Hb. destruct around_is as [_ [_ [_ [E13 _]]]].
  pose proof (st_claim (Claim false 13 (only_z 200000000000 220000000000)%bigZ) b e 2 (944 / 4096) ltac:(do 3 right; left; reflexivity) Hb ltac:(lia) ltac:(unfold T_end; lra)
    ltac:(cbn [on_the_step number]; symmetry; exact E13)) as E.
  unfold between in E. cbn [intervals only_z nth app fst snd] in E. numbers_in E. lra.
Qed.
Lemma twice_low b e : box b e -> -1 * s 2%nat b e (1886 / 4096) < 0.
Proof.
  intros Hb. destruct around_is as [_ [_ [_ [_ [E25 _]]]]].
  pose proof (st_claim (Claim false 25 (only_z 2000000000 4000000000)%bigZ) b e 2 (1886 / 4096) ltac:(do 4 right; left; reflexivity) Hb ltac:(lia) ltac:(unfold T_end; lra)
    ltac:(cbn [on_the_step number]; symmetry; exact E25)) as E.
  unfold between in E. cbn [intervals only_z nth app fst snd] in E. numbers_in E. lra.
Qed.
Lemma twice_high b e : box b e -> 0 < -1 * s 2%nat b e (1888 / 4096).
Proof.
  intros Hb. destruct around_is as [_ [_ [_ [_ [_ [E26 _]]]]]].
  pose proof (st_claim (Claim false 26 (only_z (-17000000000) (-15000000000))%bigZ) b e 2 (1888 / 4096) ltac:(do 5 right; left; reflexivity) Hb ltac:(lia) ltac:(unfold T_end; lra)
    ltac:(cbn [on_the_step number]; symmetry; exact E26)) as E.
  unfold between in E. cbn [intervals only_z nth app fst snd] in E. numbers_in E. lra.
Qed.
Lemma b_near b e : box b e -> 3401875 / 10000 <= b <= 3401876 / 10000.
Proof. intros [H _]. unfold rb, b_centre in H. apply Rabs_le_between in H. lra. Qed.
Ltac intervals_of_flow H b e t :=
  let E0 := fresh "E" in interval_of H 0%nat E0; let E1 := fresh "E" in interval_of H 1%nat E1;
  let E2 := fresh "E" in interval_of H 2%nat E2;
  set (x0 := s 0%nat b e t) in *; set (x1 := s 1%nat b e t) in *; set (x2 := s 2%nat b e t) in *; clearbody x0 x1 x2.
Lemma once_steep b e t : box b e -> 943 / 4096 <= t <= 944 / 4096 -> 1012 <= 1 * rate T_end b e t 2 <= 1013.
Proof.
  intros Hb Ht. pose proof (b_near b e Hb) as Eb. assert (H : forall i, (i < 18)%nat -> between (r_ 1000000000000%bigZ) (nth i around_once no_ends) (s i b e t))
    by (intros; apply once_enclosed; assumption).
  unfold rate. cbn [fs]. intervals_of_flow H b e t. clear H. split; interval with (i_prec 80).
Qed.
Lemma twice_steep b e t : box b e -> 1886 / 4096 <= t <= 1888 / 4096 -> 39 <= -1 * rate T_end b e t 2 <= 40.
Proof.
  intros Hb Ht. pose proof (b_near b e Hb) as Eb. assert (H : forall i, (i < 18)%nat -> between (r_ 1000000000000%bigZ) (nth i around_twice no_ends) (s i b e t))
    by (intros; apply twice_enclosed; assumption).
  unfold rate. cbn [fs]. intervals_of_flow H b e t. clear H. split; interval with (i_prec 80).
Qed.
Lemma once_times : 0 < 943 / 4096 < 944 / 4096 /\ 944 / 4096 < T_end.
Proof. unfold T_end. lra. Qed.
Lemma twice_times : 0 < 1886 / 4096 < 1888 / 4096 /\ 1888 / 4096 < T_end.
Proof. unfold T_end. lra. Qed.
Lemma rises : 1 = 1 \/ 1 = -1.
Proof. left. reflexivity. Qed.
Lemma falls : -1 = 1 \/ -1 = -1.
Proof. right. reflexivity. Qed.
Lemma m_once : 0 < 1012.
Proof. lra. Qed.
Lemma m_twice : 0 < 39.
Proof. lra. Qed.

(* The two returns: the time, all coordinates, x and its derivatives. *)
Notation tau1 := (tau T_end (943 / 4096) (944 / 4096) 1).
Notation tau2 := (tau T_end (1886 / 4096) (1888 / 4096) (-1)).
Notation v1 := (v T_end (943 / 4096) (944 / 4096) 1).
Notation v2 := (v T_end (1886 / 4096) (1888 / 4096) (-1)).
Notation F := (G T_end (943 / 4096) (944 / 4096) 1).
Notation Fe := (Ge T_end (943 / 4096) (944 / 4096) 1).
Notation Fb := (Gb T_end (943 / 4096) (944 / 4096) 1).
Notation H := (G T_end (1886 / 4096) (1888 / 4096) (-1)).
Notation He := (Ge T_end (1886 / 4096) (1888 / 4096) (-1)).
Notation Hee := (Gee T_end (1886 / 4096) (1888 / 4096) (-1)).
Notation Heee := (Geee T_end (1886 / 4096) (1888 / 4096) (-1)).
Notation Hbe := (Gbe T_end (1886 / 4096) (1888 / 4096) (-1)).
Definition tau_once := tau_is b_centre rb e_centre re T_end r T_end_pos solutions (943 / 4096) (944 / 4096) 1 1012 1013
  once_times rises m_once once_low once_high once_steep.
Definition tau_twice := tau_is b_centre rb e_centre re T_end r T_end_pos solutions (1886 / 4096) (1888 / 4096) (-1) 39 40
  twice_times falls m_twice twice_low twice_high twice_steep.

Lemma v1_enclosed b e i : box b e -> (i < 18)%nat -> between (r_ 1000000000000%bigZ) (nth i around_once no_ends) (v1 i b e).
Proof. intros Hb Hi. destruct (tau_once b e Hb) as [Ht _]. unfold v. apply once_enclosed; [assumption | assumption | lra]. Qed.
Lemma v2_enclosed b e i : box b e -> (i < 18)%nat -> between (r_ 1000000000000%bigZ) (nth i around_twice no_ends) (v2 i b e).
Proof. intros Hb Hi. destruct (tau_twice b e Hb) as [Ht _]. unfold v. apply twice_enclosed; [assumption | assumption | lra]. Qed.

Lemma numbers_once b e : box b e -> 633 / 1000 <= Fe b e <= 635 / 1000 /\ Rabs (Fb b e) <= 24 / 10000000.
Proof.
  intros Hb. pose proof (b_near b e Hb) as Eb. pose proof (fun i => v1_enclosed b e i Hb) as Q.
  unfold Ge, Gb, te, tb, zt, vs. cbn [fs]. all_intervals Q. clear Q. repeat split; interval with (i_prec 80).
Qed.
Lemma numbers_twice b e : box b e -> 36 / 10000 <= Hbe b e <= 39 / 10000 /\ Rabs (Hee b e) <= 1.
Proof.
  intros Hb. pose proof (b_near b e Hb) as Eb. pose proof (fun i => v2_enclosed b e i Hb) as Q.
  unfold Gbe, Gee, te_b, te_e, zt_b, zt_e, d_b, d_e, te, tb, zt, vs. cbn [fs by_e by_b]. all_intervals Q. clear Q. repeat split; interval with (i_prec 80).
Qed.
Lemma more_numbers_twice b e : box b e ->
  0 < Heee b e /\ Rabs (d_e T_end (1886 / 4096) (1888 / 4096) (-1) 1 b e) <= 2 /\ Rabs (d_b T_end (1886 / 4096) (1888 / 4096) (-1) 1 b e) <= 2.
Proof.
  intros Hb. pose proof (b_near b e Hb) as Eb. pose proof (fun i => v2_enclosed b e i Hb) as Q.
  unfold Geee, te_ee, te_over_e, te_over, zt_ee, d_ee, f_e, f5_e, te_e, zt_e, d_b, d_e, te, tb, zt, vs. cbn [fs by_e by_b]. all_intervals Q. clear Q.
  repeat split; interval with (i_prec 80).
Qed.

(* At the centre. *)
Lemma in_the_centre : box b_centre e_centre.
Proof. split; rewrite Rminus_eq_0, Rabs_R0; unfold rb, re; lra. Qed.
Lemma T_centre_within : 0 <= T_centre <= T_end.
Proof. unfold T_centre, T_end. lra. Qed.
Lemma centre_st i t : (i < 18)%nat -> 0 <= t <= T_centre -> s i b_centre e_centre t = y_centre i t.
Proof.
  intros Hi Ht. destruct (run _ _ in_the_centre) as [y [Hy _]]. pose proof T_centre_within. rewrite (st_is T_end T_end_pos _ _ y i t Hy Hi) by lra.
  destruct Hy as [Y0 Ys]. destruct centre_flows as [C0 Cs].
  apply (unique 18 (fs b_centre) (fs_lipschitz b_centre) T_centre y y_centre); try assumption; [lra | | ].
  - intros j u Hj Hu. apply Ys; [assumption | lra].
  - intros j Hj. rewrite Y0, C0 by assumption. reflexivity.
Qed.
Lemma centre_claim c i t : In c centre_claims -> (i < 18)%nat -> 0 <= t <= T_centre ->
  (if on_the_step c then time_of centre (number c) <= t <= time_of centre (S (number c)) else t = time_of centre (number c)) ->
  between (r_ 1000000000000000000%bigZ) (nth i (intervals c) no_ends) (s i b_centre e_centre t).
Proof.
  intros Hc Hi Ht Hk. rewrite centre_st by assumption. pose proof centre_claimed as C. rewrite List.Forall_forall in C. exact (C c Hc i t Hi Hk).
Qed.
Lemma centre_once_in : 259252122487674 / 1125899906842624 <= tau1 b_centre e_centre <= 259252122487677 / 1125899906842624.
Proof.
  pose proof in_the_centre as Hc. destruct centre_is as [_ [_ [E12 [E13 _]]]]. destruct (tau_once _ _ Hc) as [Ht Hz].
  pose proof (proj2 (Hz (tau1 b_centre e_centre) ltac:(lra)) eq_refl) as Z.
  assert (B : forall t, 943 / 4096 <= t <= 944 / 4096 -> exists k, 0 < k /\ s 2%nat b_centre e_centre t = k * (t - tau1 b_centre e_centre)).
  { intros t Hu. destruct (z_between b_centre rb e_centre re T_end r T_end_pos solutions (943 / 4096) (944 / 4096) 1 once_times
      b_centre e_centre (tau1 b_centre e_centre) t Hc ltac:(lra) Hu) as [w [Hw W]].
    pose proof (once_steep _ _ w Hc Hw). exists (1 * rate T_end b_centre e_centre w 2). split; [lra|]. rewrite Z in W. lra. }
  pose proof (centre_claim (Claim false 12 (only_z (-2000000) (-1))%bigZ) 2 (259252122487674 / 1125899906842624) ltac:(do 2 right; left; reflexivity) ltac:(lia)
    ltac:(unfold T_centre; lra) ltac:(cbn [on_the_step number]; symmetry; exact E12)) as E.
  pose proof (centre_claim (Claim false 13 (only_z 1 2000000)%bigZ) 2 (259252122487677 / 1125899906842624) ltac:(do 3 right; left; reflexivity) ltac:(lia)
    ltac:(unfold T_centre; lra) ltac:(cbn [on_the_step number]; symmetry; exact E13)) as E'.
  unfold between in E, E'. cbn [intervals only_z nth app fst snd] in E, E'. numbers_in E. numbers_in E'.
  destruct (B (259252122487674 / 1125899906842624) ltac:(lra)) as [k [K1 K2]]. destruct (B (259252122487677 / 1125899906842624) ltac:(lra)) as [k' [K1' K2']].
  rewrite K2 in E. rewrite K2' in E'. split; [apply Rnot_lt_le; intros L | apply Rnot_lt_le; intros L]; nra.
Qed.
Lemma centre_twice_in : 518504244975350 / 1125899906842624 <= tau2 b_centre e_centre <= 518504244975353 / 1125899906842624.
Proof.
  pose proof in_the_centre as Hc. destruct centre_is as [_ [_ [_ [_ [E25 E26]]]]]. destruct (tau_twice _ _ Hc) as [Ht Hz].
  pose proof (proj2 (Hz (tau2 b_centre e_centre) ltac:(lra)) eq_refl) as Z.
  assert (B : forall t, 1886 / 4096 <= t <= 1888 / 4096 -> exists k, 0 < k /\ s 2%nat b_centre e_centre t = - k * (t - tau2 b_centre e_centre)).
  { intros t Hu. destruct (z_between b_centre rb e_centre re T_end r T_end_pos solutions (1886 / 4096) (1888 / 4096) (-1) twice_times
      b_centre e_centre (tau2 b_centre e_centre) t Hc ltac:(lra) Hu) as [w [Hw W]].
    pose proof (twice_steep _ _ w Hc Hw). exists (-1 * rate T_end b_centre e_centre w 2). split; [lra|]. rewrite Z in W. lra. }
  pose proof (centre_claim (Claim false 25 (only_z 1 2000000)%bigZ) 2 (518504244975350 / 1125899906842624) ltac:(do 4 right; left; reflexivity) ltac:(lia)
    ltac:(unfold T_centre; lra) ltac:(cbn [on_the_step number]; symmetry; exact E25)) as E.
  pose proof (centre_claim (Claim false 26 (only_z (-2000000) (-1))%bigZ) 2 (518504244975353 / 1125899906842624) ltac:(do 5 right; left; reflexivity) ltac:(lia)
    ltac:(unfold T_centre; lra) ltac:(cbn [on_the_step number]; symmetry; exact E26)) as E'.
  unfold between in E, E'. cbn [intervals only_z nth app fst snd] in E, E'. numbers_in E. numbers_in E'.
  destruct (B (518504244975350 / 1125899906842624) ltac:(lra)) as [k [K1 K2]]. destruct (B (518504244975353 / 1125899906842624) ltac:(lra)) as [k' [K1' K2']].
  rewrite K2 in E. rewrite K2' in E'. split; [apply Rnot_lt_le; intros L | apply Rnot_lt_le; intros L]; nra.
Qed.
Lemma F_centre : Rabs (F b_centre e_centre) <= 2 / 100000000000000.
Proof.
  destruct centre_is as [_ [_ [E12 [E13 _]]]]. pose proof centre_once_in as Ht.
  pose proof (centre_claim (Claim true 12 centre_once) 0 (tau1 b_centre e_centre) ltac:(left; reflexivity) ltac:(lia) ltac:(unfold T_centre; lra)
    ltac:(cbn [on_the_step number]; rewrite E12, E13; exact Ht)) as E.
  unfold between in E. cbn [intervals centre_once nth fst snd] in E. numbers_in E. change (F b_centre e_centre) with (s 0%nat b_centre e_centre (tau1 b_centre e_centre)).
  apply Rabs_le. lra.
Qed.
Lemma centre_bound b (w : point) : 3401875 / 10000 <= b <= 3401876 / 10000 ->
  (forall i, (i < 18)%nat -> between (r_ 1000000000000000000%bigZ) (nth i centre_twice no_ends) (w i)) ->
  Rabs (w 3%nat + w 1%nat * (- w 5%nat / fs b w 2%nat)) <= 1 / 1000000000000.
Proof.
  intros Eb Q. cbn [fs]. all_intervals Q. clear Q.
  repeat match goal with E : _ <= w ?i <= _ |- _ => let x := fresh "x" in set (x := w i) in *; clearbody x end. interval with (i_prec 100).
Qed.
Lemma He_centre : Rabs (He b_centre e_centre) <= 1 / 1000000000000.
Proof.
  destruct centre_is as [_ [_ [_ [_ [E25 E26]]]]]. pose proof centre_twice_in as Ht. pose proof (b_near _ _ in_the_centre) as Eb.
  assert (Q : forall i, (i < 18)%nat -> between (r_ 1000000000000000000%bigZ) (nth i centre_twice no_ends) (v2 i b_centre e_centre)).
  { intros i Hi. apply (centre_claim (Claim true 25 centre_twice) i (tau2 b_centre e_centre)); [do 1 right; left; reflexivity | assumption | unfold T_centre; lra|].
    cbn [on_the_step number]. rewrite E25, E26. exact Ht. }
  exact (centre_bound b_centre (vs T_end (1886 / 4096) (1888 / 4096) (-1) b_centre e_centre) Eb Q).
Qed.

(* The box of the theorem lies inside. *)
Lemma room_inside b e : J b -> Y e -> room b_centre rb e_centre re b e.
Proof.
  intros Hb He. unfold J, Y in *. exists (/ 10000000000000). split; [lra|]. split; intros q Hq; apply Rabs_le_between in Hq; split; apply Rabs_le; unfold rb, re; lra.
Qed.
Lemma inside_box b e : J b -> Y e -> box b e.
Proof. intros Hb He. unfold J, Y in *. split; apply Rabs_le; unfold rb, re; lra. Qed.
Ltac once_by L := refine (L b_centre rb e_centre re T_end r T_end_pos solutions (943 / 4096) (944 / 4096) 1 1012 1013 once_times rises m_once once_low once_high once_steep _ _ _).
Ltac twice_by L := refine (L b_centre rb e_centre re T_end r T_end_pos solutions (1886 / 4096) (1888 / 4096) (-1) 39 40 twice_times falls m_twice twice_low twice_high twice_steep _ _ _).
Lemma F_by_e b e : J b -> Y e -> is_derive (fun e => F b e) e (Fe b e).
Proof. intros Hb He. once_by G_by_e. apply room_inside; assumption. Qed.
Lemma F_by_b b e : J b -> Y e -> is_derive (fun b => F b e) b (Fb b e).
Proof. intros Hb He. once_by G_by_b. apply room_inside; assumption. Qed.
Lemma H_by_e b e : J b -> Y e -> is_derive (fun e => H b e) e (He b e).
Proof. intros Hb Hy. twice_by G_by_e. apply room_inside; assumption. Qed.
Lemma He_by_e b e : J b -> Y e -> is_derive (fun e => He b e) e (Hee b e).
Proof. intros Hb Hy. twice_by Ge_by_e. apply room_inside; assumption. Qed.
Lemma He_by_b b e : J b -> Y e -> is_derive (fun b => He b e) b (Hbe b e).
Proof. intros Hb Hy. twice_by Ge_by_b. apply room_inside; assumption. Qed.

Notation bl := (b_centre - / 1000000000).
Notation bh := (b_centre + / 1000000000).
Notation el := (e_centre - / 10000000000000).
Notation eh := (e_centre + / 10000000000000).
Lemma J_centre : J b_centre.
Proof. unfold J. lra. Qed.
Lemma Y_centre : Y e_centre.
Proof. unfold Y. lra. Qed.
Lemma F_near b e : J b -> Y e -> exists k, 633 / 1000 <= k <= 635 / 1000 /\ Rabs (F b e - k * (e - e_centre)) <= 3 / 100000000000000.
Proof.
  intros Hb Hy. destruct (mean_value_around (fun e => F b e) (fun e => Fe b e) el eh e_centre e) as [u [Hu E]]; [intros; apply F_by_e; assumption | apply Y_centre | exact Hy|].
  destruct (mean_value_around (fun b => F b e_centre) (fun b => Fb b e_centre) bl bh b_centre b) as [w [Hw E']]; [intros x Hx; exact (F_by_b x e_centre Hx Y_centre) | apply J_centre | exact Hb|].
  destruct (numbers_once b u (inside_box b u Hb Hu)) as [N _]. destruct (numbers_once w e_centre (inside_box w e_centre Hw Y_centre)) as [_ N'].
  exists (Fe b u). split; [assumption|]. pose proof F_centre as C.
  assert (X : Rabs (Fb w e_centre * (b - b_centre)) <= 24 / 10000000 * / 1000000000).
  { rewrite Rabs_mult. apply Rmult_le_compat; try apply Rabs_pos; [assumption|]. apply Rabs_le. unfold J in Hb. lra. }
  cbv beta in E, E'. apply Rabs_le_between in X, C. apply Rabs_le. lra.
Qed.
Lemma He_near b e : J b -> Y e -> exists k, 36 / 10000 <= k <= 39 / 10000 /\ Rabs (He b e - k * (b - b_centre)) <= 2 / 1000000000000.
Proof.
  intros Hb Hy. destruct (mean_value_around (fun b => He b e) (fun b => Hbe b e) bl bh b_centre b) as [w [Hw E']]; [intros x Hx; exact (He_by_b x e Hx Hy) | apply J_centre | exact Hb|].
  destruct (mean_value_around (fun e => He b_centre e) (fun e => Hee b_centre e) el eh e_centre e) as [u [Hu E]]; [intros x Hx; exact (He_by_e b_centre x J_centre Hx) | apply Y_centre | exact Hy|].
  destruct (numbers_twice w e (inside_box w e Hw Hy)) as [N _]. destruct (numbers_twice b_centre u (inside_box b_centre u J_centre Hu)) as [_ N'].
  exists (Hbe w e). split; [assumption|]. pose proof He_centre as C.
  assert (X : Rabs (Hee b_centre u * (e - e_centre)) <= 1 * / 10000000000000).
  { rewrite Rabs_mult. apply Rmult_le_compat; try apply Rabs_pos; [assumption|]. apply Rabs_le. unfold Y in Hy. lra. }
  cbv beta in E, E'. apply Rabs_le_between in X, C. apply Rabs_le. lra.
Qed.

(* Orbits and zeros. *)
Lemma once_is b e : J b -> Y e -> (once b e <-> F b e = 0).
Proof.
  intros Hb Hy. pose proof (inside_box b e Hb Hy) as Q. destruct (run b e Q) as [y [Fl _]]. destruct (tau_once b e Q) as [Ht Hz].
  assert (S0 : forall i t, (i < 18)%nat -> 0 <= t <= T_end -> s i b e t = y i t) by (intros; apply (st_is T_end T_end_pos); assumption).
  assert (TE : 944 / 4096 < T_end) by (unfold T_end; lra). change (F b e) with (s 0%nat b e (tau1 b e)). split.
  - intros [t [Hin Ho]]. apply (half_orbit_is T_end b e y t) in Ho; [|lra | assumption]. destruct Ho as [X Z].
    assert (E : t = tau1 b e) by (apply Hz; [lra | rewrite S0; [assumption | lia | lra]]). rewrite <- E, S0; [assumption | lia | lra].
  - intros E. exists (tau1 b e). split; [assumption|]. apply (half_orbit_is T_end b e y); [lra | assumption|].
    rewrite <- !S0 by (lia || lra). split; [assumption|]. apply Hz; [lra | reflexivity].
Qed.
Lemma twice_is b e : J b -> Y e -> (twice b e <-> H b e = 0).
Proof.
  intros Hb Hy. pose proof (inside_box b e Hb Hy) as Q. destruct (run b e Q) as [y [Fl _]]. destruct (tau_twice b e Q) as [Ht Hz].
  assert (S0 : forall i t, (i < 18)%nat -> 0 <= t <= T_end -> s i b e t = y i t) by (intros; apply (st_is T_end T_end_pos); assumption).
  assert (TE : 1888 / 4096 < T_end) by (unfold T_end; lra). change (H b e) with (s 0%nat b e (tau2 b e)). split.
  - intros [t [Hin Ho]]. apply (half_orbit_is T_end b e y t) in Ho; [|lra | assumption]. destruct Ho as [X Z].
    assert (E : t = tau2 b e) by (apply Hz; [lra | rewrite S0; [assumption | lia | lra]]). rewrite <- E, S0; [assumption | lia | lra].
  - intros E. exists (tau2 b e). split; [assumption|]. apply (half_orbit_is T_end b e y); [lra | assumption|].
    rewrite <- !S0 by (lia || lra). split; [assumption|]. apply Hz; [lra | reflexivity].
Qed.
Lemma H_vanishes b e : J b -> Y e -> F b e = 0 -> H b e = 0.
Proof.
  intros Hb Hy E. apply twice_is; [assumption | assumption|]. pose proof (inside_box b e Hb Hy) as Q. destruct (run b e Q) as [y [Fl _]].
  destruct (tau_once b e Q) as [Ht Hz]. assert (TE : 1888 / 4096 < T_end) by (unfold T_end; lra).
  assert (S0 : forall i t, (i < 18)%nat -> 0 <= t <= T_end -> s i b e t = y i t) by (intros; apply (st_is T_end T_end_pos); assumption).
  change (F b e) with (s 0%nat b e (tau1 b e)) in E.
  assert (Z : s 2%nat b e (tau1 b e) = 0) by (apply Hz; [lra | reflexivity]). rewrite S0 in E, Z by (lia || lra).
  destruct (mirrored_solution T_end b e y (tau1 b e) Fl ltac:(lra) ltac:(lra) E Z) as [X2 [_ Z2]].
  exists (2 * tau1 b e). split; [lra|]. apply (half_orbit_is T_end b e y); [lra | assumption | split; assumption].
Qed.

(* The other point of an orbit that has both ends on the line. *)
Notation other b e := (v2 1%nat b e).
Lemma Hee_by_e b e : J b -> Y e -> is_derive (fun e => Hee b e) e (Heee b e).
Proof. intros Hb Hy. twice_by Gee_by_e. apply room_inside; assumption. Qed.
Lemma other_lipschitz b e b' e' : J b -> Y e -> J b' -> Y e' -> Rabs (other b' e' - other b e) <= 2 * (Rabs (b' - b) + Rabs (e' - e)).
Proof.
  intros Hb Hy Hb' Hy'.
  destruct (mean_value_around (fun e => other b' e) (fun e => d_e T_end (1886 / 4096) (1888 / 4096) (-1) 1 b' e) el eh e e') as [u [Hu E]]; [ | exact Hy | exact Hy' |].
  { intros x Hx. refine (v_by_e b_centre rb e_centre re T_end r T_end_pos solutions (1886 / 4096) (1888 / 4096) (-1) 39 40 twice_times falls m_twice
      twice_low twice_high twice_steep 1 b' x _ _); [apply room_inside; assumption | cbn; tauto]. }
  destruct (mean_value_around (fun b => other b e) (fun b => d_b T_end (1886 / 4096) (1888 / 4096) (-1) 1 b e) bl bh b b') as [w [Hw E']]; [ | exact Hb | exact Hb' |].
  { intros x Hx. refine (v_by_b b_centre rb e_centre re T_end r T_end_pos solutions (1886 / 4096) (1888 / 4096) (-1) 39 40 twice_times falls m_twice
      twice_low twice_high twice_steep 1 x e _ _); [apply room_inside; assumption | lia]. }
  destruct (more_numbers_twice b' u (inside_box b' u Hb' Hu)) as [_ [N _]]. destruct (more_numbers_twice w e (inside_box w e Hw Hy)) as [_ [_ N']].
  replace (other b' e' - other b e) with ((other b' e' - other b' e) + (other b' e - other b e)) by ring.
  eapply Rle_trans; [apply Rabs_triang|]. rewrite E, E', !Rabs_mult. pose proof (Rabs_pos (e' - e)). pose proof (Rabs_pos (b' - b)). nra.
Qed.
Lemma other_of_family b e : J b -> Y e -> F b e = 0 -> other b e = e.
Proof.
  intros Hb Hy E. pose proof (inside_box b e Hb Hy) as Q. destruct (run b e Q) as [y [Fl _]].
  destruct (tau_once b e Q) as [Ht Hz]. destruct (tau_twice b e Q) as [Ht' Hz']. assert (TE : 1888 / 4096 < T_end) by (unfold T_end; lra).
  assert (S0 : forall i t, (i < 18)%nat -> 0 <= t <= T_end -> s i b e t = y i t) by (intros; apply (st_is T_end T_end_pos); assumption).
  change (F b e) with (s 0%nat b e (tau1 b e)) in E.
  assert (Z : s 2%nat b e (tau1 b e) = 0) by (apply Hz; [lra | reflexivity]). rewrite S0 in E, Z by (lia || lra).
  destruct (mirrored_solution T_end b e y (tau1 b e) Fl ltac:(lra) ltac:(lra) E Z) as [_ [Y2 Z2]].
  assert (W : 2 * tau1 b e = tau2 b e) by (apply Hz'; [lra | rewrite S0 by (lia || lra); exact Z2]).
  change (other b e) with (s 1%nat b e (tau2 b e)). rewrite <- W, S0 by (lia || lra). exact Y2.
Qed.
Lemma other_is_on_the_branch b e : J b -> Y e -> H b e = 0 -> F b e <> 0 -> Y (other b e) ->
  other b e <> e /\ F b (other b e) <> 0 /\ H b (other b e) = 0.
Proof.
  intros Hb Hy E NF Hy'. pose proof (inside_box b e Hb Hy) as Q. destruct (run b e Q) as [y [Fl _]].
  pose proof (inside_box b _ Hb Hy') as Q'. destruct (run b _ Q') as [y' [Fl' _]].
  destruct (tau_once b e Q) as [Ht Hz]. destruct (tau_twice b e Q) as [Ht' Hz']. destruct (tau_twice b _ Q') as [Ht2 Hz2].
  assert (TE : 1888 / 4096 < T_end) by (unfold T_end; lra).
  assert (S0 : forall i t, (i < 18)%nat -> 0 <= t <= T_end -> s i b e t = y i t) by (intros; apply (st_is T_end T_end_pos); assumption).
  assert (S1 : forall i t, (i < 18)%nat -> 0 <= t <= T_end -> s i b (other b e) t = y' i t) by (intros; apply (st_is T_end T_end_pos); assumption).
  change (H b e) with (s 0%nat b e (tau2 b e)) in E.
  assert (Z : s 2%nat b e (tau2 b e) = 0) by (apply Hz'; [lra | reflexivity]). rewrite S0 in E, Z by (lia || lra).
  assert (O : other b e = y 1%nat (tau2 b e)) by (change (other b e) with (s 1%nat b e (tau2 b e)); rewrite S0; [reflexivity | lia | lra]).
  rewrite O in Fl'. pose proof (other_end T_end b e y (tau2 b e) y' Fl ltac:(lra) E Z Fl') as M. rewrite <- O in Fl'.
  pose proof Fl as [F0 _].
  assert (M' : forall i, (i < 3)%nat -> y' i (tau2 b e) = mirrored i (from e i)).
  { intros i Hi. rewrite (M i (tau2 b e) Hi) by lra. rewrite Rminus_eq_0, F0 by lia. reflexivity. }
  assert (W : tau2 b e = tau2 b (other b e)) by (apply Hz2; [lra | rewrite S1 by (lia || lra); rewrite M' by lia; cbn; ring]).
  assert (Back : other b (other b e) = e).
  { change (other b (other b e)) with (s 1%nat b (other b e) (tau2 b (other b e))). rewrite <- W, S1, M' by (lia || lra). reflexivity. }
  assert (Ne : other b e <> e).
  { intros X. apply NF. apply once_is; [assumption | assumption|]. exists (tau2 b e / 2). split; [lra|].
    apply (half_orbit_is T_end b e y); [lra | assumption|].
    assert (Same : forall i t, (i < 3)%nat -> 0 <= t <= T_end -> y' i t = y i t) by (intros i t Hi Hs; rewrite <- S1, <- S0 by (lia || lra); rewrite X; reflexivity).
    assert (Half : forall i, (i < 3)%nat -> y i (tau2 b e / 2) = mirrored i (y i (tau2 b e / 2))).
    { intros i Hi. rewrite <- (Same i (tau2 b e / 2) Hi) at 1 by lra. rewrite (M i (tau2 b e / 2) Hi) by lra. f_equal. f_equal. field. }
    pose proof (Half 0%nat ltac:(lia)) as A0. pose proof (Half 2%nat ltac:(lia)) as A2. cbn [mirrored] in A0, A2. lra. }
  split; [assumption|]. split.
  - intros X. apply Ne. rewrite <- Back at 2. symmetry. apply other_of_family; assumption.
  - change (H b (other b e)) with (s 0%nat b (other b e) (tau2 b (other b e))). rewrite <- W, S1, M' by (lia || lra). cbn. ring.
Qed.

Theorem doubling_here : period_doubling.
Proof.
  destruct (pitchfork bl bh el eh ltac:(lra) ltac:(lra) F Fe Fb F_by_e F_by_b (633 / 1000) (635 / 1000) (4 / 1000000))
    with (G := H) (Ge := He) (Gee := Hee) (Gbe := Hbe) (c := 36 / 10000) (C := 39 / 10000) (B := 1)
      (Geee := Heee) (partner := fun b e => v2 1%nat b e) (L := 2)
    as [family [branch [b0 [e0 [A1 [A2 [A3 [A4 [A5 [A6 [A7 [A8 A9]]]]]]]]]]]].
  - lra.
  - intros b e Hb Hy. apply numbers_once, inside_box; assumption.
  - intros b e Hb Hy. destruct (numbers_once b e (inside_box b e Hb Hy)) as [_ N]. lra.
  - intros b Hb. destruct (F_near b el Hb ltac:(unfold Y; lra)) as [k [Hk N]]. apply Rabs_le_between in N.
    replace (el - e_centre) with (- / 10000000000000) in N by ring. lra.
  - intros b Hb. destruct (F_near b eh Hb ltac:(unfold Y; lra)) as [k [Hk N]]. apply Rabs_le_between in N.
    replace (eh - e_centre) with (/ 10000000000000) in N by ring. lra.
  - exact H_by_e.
  - exact He_by_e.
  - exact He_by_b.
  - exact H_vanishes.
  - intros b e Hb Hy. apply numbers_twice, inside_box; assumption.
  - intros b e Hb Hy. apply numbers_twice, inside_box; assumption.
  - lra.
  - intros e Hy. destruct (He_near bl e ltac:(unfold J; lra) Hy) as [k [Hk N]]. apply Rabs_le_between in N.
    replace (bl - b_centre) with (- / 1000000000) in N by ring. lra.
  - intros e Hy. destruct (He_near bh e ltac:(unfold J; lra) Hy) as [k [Hk N]]. apply Rabs_le_between in N.
    replace (bh - b_centre) with (/ 1000000000) in N by ring. lra.
  - exact Hee_by_e.
  - intros b e Hb Hy. apply more_numbers_twice, inside_box; assumption.
  - lra.
  - exact other_lipschitz.
  - exact other_of_family.
  - exact other_is_on_the_branch.
  - exists family, branch, b0, e0. split; [exact A1|]. split; [exact A2|]. split; [exact A3|]. split.
    + intros e e' Hy Hy'. eapply Rle_trans; [apply A4; assumption|]. apply Rmult_le_compat_r; [apply Rabs_pos|].
      apply Rle_div_l; lra.
    + split; [intros b e Hb Hy; rewrite (once_is b e Hb Hy); apply A5; assumption|].
      split; [intros b e Hb Hy; rewrite (twice_is b e Hb Hy); apply A6; assumption|]. split; [exact A7|]. split; [exact A8 | exact A9].
Qed.
End Proof.

(* From two lists of steps to the theorem. *)
Theorem doubling around centre : good_around around = true -> good_centre centre = true -> period_doubling.
Proof.
  intros Ha Hc. destruct (around_is around Ha) as [Ba [La [_ [_ [_ [_ Ta]]]]]]. destruct (centre_is centre Hc) as [Bc [Lc [_ [_ [_ Tc]]]]].
  destruct (box_flows _ _ _ _ _ Ba) as [_ [r [_ Ra]]]. rewrite La, Ta in Ra. destruct (box_flows _ _ _ _ _ Bc) as [_ [r' [_ Rc]]]. rewrite Lc, Tc in Rc.
  destruct (Rc b_centre e_centre) as [y [Fy [_ Cy]]].
  - rewrite b_ratio_is, Rminus_eq_0, Rabs_R0. unfold real_of. cbn [fst snd]. numbers. lra.
  - rewrite e_ratio_is, Rminus_eq_0, Rabs_R0. unfold real_of. cbn [fst snd]. numbers. lra.
  - apply (doubling_here around centre Ha Hc r) with (y_centre := y); [|exact Fy | exact Cy].
    intros b e [Hb He]. apply Ra; [rewrite b_ratio_is | rewrite e_ratio_is]; unfold real_of; cbn [fst snd]; numbers; assumption.
Qed.
