(* The fields of theory/Programs.v, as functions of real numbers; what running them on elements shows of them. *)

From Coq Require Import List ZArith Reals Lra Lia.
From Coquelicot Require Import Rcomplements.
From Bignums Require Import BigZ.
From Orbitproof Require Import Polynomials Elements Formats Programs Sound.
From Solutions Require Import Comparison Flow Norms Values.
Import ListNotations.
Local Open Scope R_scope.
Local Open Scope list_scope.

(* What one node computes from the numbers before it. *)
Definition node_value (n : node) (us : list R) : R :=
  match n with
  | Const a b => r_ a / r_ b
  | Add i j => nth i us 0 + nth j us 0
  | Sub i j => nth i us 0 - nth j us 0
  | Mul i j => nth i us 0 * nth j us 0
  | Scale i a b => r_ a / r_ b * nth i us 0
  | Power _ _ _ => 0
  end.
Fixpoint all_values (ns : list node) (us : list R) : list R :=
  match ns with [] => us | n :: ns' => all_values ns' (us ++ [node_value n us]) end.

(* The field of a program: m components of the state, and parameters. *)
Definition field_of (p : program) (m : nat) (parameters : list R) : field :=
  fun x i => nth (nth i (outputs p) O) (all_values (nodes p) (map x (seq 0 m) ++ parameters)) 0.

(* Sums, differences, products and rational numbers, nothing else. *)
Definition is_arithmetic (n : node) : bool :=
  match n with
  | Const _ b | Scale _ _ b => (0 <? b)%bigZ
  | Power _ _ _ => false
  | _ => true
  end.
Definition is_polynomial (p : program) : bool := forallb is_arithmetic (nodes p).

Lemma all_values_begin ns : forall us, exists more, all_values ns us = us ++ more /\ length more = length ns.
Proof.
  induction ns as [|n ns IH]; intros us; cbn [all_values].
  - exists []. rewrite app_nil_r. auto.
  - destruct (IH (us ++ [node_value n us])) as [more [E L]]. exists (node_value n us :: more).
    rewrite E, <- app_assoc. cbn. auto.
Qed.
Lemma node_value_begin n us more k : (length us = k)%nat -> forallb (fun i => (i <? k)%nat) (places_of n) = true ->
  node_value n (us ++ more) = node_value n us.
Proof.
  intros L H. rewrite forallb_forall in H.
  assert (G : forall i, In i (places_of n) -> nth i (us ++ more) 0 = nth i us 0).
  { intros i Hi. specialize (H i Hi). apply Nat.ltb_lt in H. apply app_nth1. lia. }
  destruct n; cbn [node_value]; rewrite ?G by (cbn; auto); reflexivity.
Qed.

(* Every node has the value that its own places say. *)
Fixpoint computes (all : list R) (k : nat) (ns : list node) : Prop :=
  match ns with [] => True | n :: ns' => nth k all 0 = node_value n all /\ computes all (S k) ns' end.
Lemma all_values_computes ns : forall us, well_formed_from (length us) ns = true -> computes (all_values ns us) (length us) ns.
Proof.
  induction ns as [|n ns IH]; intros us W; cbn [well_formed_from computes all_values] in *; [exact I|].
  apply andb_prop in W. destruct W as [W1 W2].
  assert (L : length (us ++ [node_value n us]) = S (length us)) by (rewrite app_length; cbn; lia).
  split.
  - destruct (all_values_begin ns (us ++ [node_value n us])) as [more [E _]]. rewrite E, <- app_assoc.
    rewrite (node_value_begin n us _ (length us) eq_refl W1). rewrite app_nth2, Nat.sub_diag by lia. reflexivity.
  - rewrite <- L. apply IH. rewrite L. assumption.
Qed.

(* Such fields are locally Lipschitz. *)
Definition near (L B D u v : R) : Prop := Rabs u <= B /\ Rabs v <= B /\ Rabs (u - v) <= L * D.
Lemma near_more L B L' B' D u v : 0 <= D -> L <= L' -> B <= B' -> near L B D u v -> near L' B' D u v.
Proof. intros HD HL HB [H1 [H2 H3]]. repeat split; try lra. eapply Rle_trans; [exact H3|]. apply Rmult_le_compat_r; assumption. Qed.

Lemma node_near n L B : 0 <= L -> 0 <= B -> exists L' B', L <= L' /\ B <= B' /\ forall D us vs, 0 <= D ->
  (forall i, near L B D (nth i us 0) (nth i vs 0)) -> near L' B' D (node_value n us) (node_value n vs).
Proof.
  intros HL HB. destruct n as [a b|i j|i j|i j|i a b|i p q].
  - exists L, (B + Rabs (r_ a / r_ b)). pose proof (Rabs_pos (r_ a / r_ b)). repeat split; try lra; cbn; try lra.
    rewrite Rminus_eq_0, Rabs_R0. apply Rmult_le_pos; assumption.
  - exists (2 * L), (2 * B). repeat split; try lra; cbn;
      destruct (H0 i) as [I1 [I2 I3]]; destruct (H0 j) as [J1 [J2 J3]];
      apply Rabs_le_between in I1; apply Rabs_le_between in I2; apply Rabs_le_between in I3;
      apply Rabs_le_between in J1; apply Rabs_le_between in J2; apply Rabs_le_between in J3; apply Rabs_le; lra.
  - exists (2 * L), (2 * B). repeat split; try lra; cbn;
      destruct (H0 i) as [I1 [I2 I3]]; destruct (H0 j) as [J1 [J2 J3]];
      apply Rabs_le_between in I1; apply Rabs_le_between in I2; apply Rabs_le_between in I3;
      apply Rabs_le_between in J1; apply Rabs_le_between in J2; apply Rabs_le_between in J3; apply Rabs_le; lra.
  - exists (L + 2 * (B * L)), (B + B * B).
    assert (0 <= B * L) by (apply Rmult_le_pos; assumption). assert (0 <= B * B) by (apply Rmult_le_pos; assumption).
    split; [lra|]. split; [lra|]. intros D us vs HD H1. cbn.
    destruct (H1 i) as [I1 [I2 I3]]; destruct (H1 j) as [J1 [J2 J3]]. set (u := nth i us 0) in *. set (v := nth j us 0) in *.
    set (u' := nth i vs 0) in *. set (v' := nth j vs 0) in *. split; [|split].
    + rewrite Rabs_mult. assert (Rabs u * Rabs v <= B * B) by (apply Rmult_le_compat; try apply Rabs_pos; assumption). lra.
    + rewrite Rabs_mult. assert (Rabs u' * Rabs v' <= B * B) by (apply Rmult_le_compat; try apply Rabs_pos; assumption). lra.
    + replace (u * v - u' * v') with (u * (v - v') + v' * (u - u')) by ring. eapply Rle_trans; [apply Rabs_triang|].
      rewrite !Rabs_mult.
      assert (Rabs u * Rabs (v - v') <= B * (L * D)) by (apply Rmult_le_compat; try apply Rabs_pos; assumption).
      assert (Rabs v' * Rabs (u - u') <= B * (L * D)) by (apply Rmult_le_compat; try apply Rabs_pos; assumption).
      assert (0 <= L * D) by (apply Rmult_le_pos; assumption). lra.
  - set (c := r_ a / r_ b). pose proof (Rabs_pos c) as Pc. exists (L + Rabs c * L), (B + Rabs c * B).
    assert (0 <= Rabs c * L) by (apply Rmult_le_pos; assumption). assert (0 <= Rabs c * B) by (apply Rmult_le_pos; assumption).
    split; [lra|]. split; [lra|]. intros D us vs HD H1. cbn. fold c. destruct (H1 i) as [I1 [I2 I3]]. split; [|split].
    + rewrite Rabs_mult. assert (Rabs c * Rabs (nth i us 0) <= Rabs c * B) by (apply Rmult_le_compat_l; assumption). lra.
    + rewrite Rabs_mult. assert (Rabs c * Rabs (nth i vs 0) <= Rabs c * B) by (apply Rmult_le_compat_l; assumption). lra.
    + rewrite <- Rmult_minus_distr_l, Rabs_mult.
      assert (Rabs c * Rabs (nth i us 0 - nth i vs 0) <= Rabs c * (L * D)) by (apply Rmult_le_compat_l; assumption).
      assert (0 <= L * D) by (apply Rmult_le_pos; assumption). lra.
  - exists L, B. repeat split; try lra; cbn; rewrite ?Rminus_eq_0, Rabs_R0; try lra. apply Rmult_le_pos; assumption.
Qed.

Lemma all_near ns : forall L B, 0 <= L -> 0 <= B -> exists L' B', L <= L' /\ forall D us vs, 0 <= D -> length us = length vs ->
  (forall i, near L B D (nth i us 0) (nth i vs 0)) ->
  forall i, near L' B' D (nth i (all_values ns us) 0) (nth i (all_values ns vs) 0).
Proof.
  induction ns as [|n ns IH]; intros L B HL HB.
  - exists L, B. split; [lra|]. intros D us vs _ _ H. exact H.
  - destruct (node_near n L B HL HB) as [L1 [B1 [HL1 [HB1 H1]]]].
    destruct (IH L1 B1) as [L2 [B2 [HL2 H2]]]; try lra. exists L2, B2. split; [lra|]. intros D us vs HD Hl H. cbn [all_values].
    apply H2; [assumption | rewrite !app_length; cbn; lia|]. intros i. destruct (Nat.lt_trichotomy i (length us)) as [Hi|[Hi|Hi]].
    + rewrite !app_nth1 by lia. apply (near_more L B); auto.
    + rewrite !app_nth2 by lia. rewrite Hi, <- Hl, Nat.sub_diag. cbn [nth]. apply H1; assumption.
    + rewrite !nth_overflow by (rewrite app_length; cbn; lia). repeat split; rewrite ?Rminus_eq_0, Rabs_R0; try lra.
      apply Rmult_le_pos; lra.
Qed.

Lemma nth_inputs (x : point) m a j : (j < m)%nat -> nth j (map x (seq 0 m) ++ a) 0 = x j.
Proof.
  intros Hj. rewrite app_nth1 by (rewrite map_length, seq_length; assumption).
  rewrite (nth_indep _ 0 (x O)) by (rewrite map_length, seq_length; assumption). rewrite map_nth, seq_nth by assumption. reflexivity.
Qed.
Lemma nth_parameters (x : point) m a j : (m <= j)%nat -> nth j (map x (seq 0 m) ++ a) 0 = nth (j - m) a 0.
Proof. intros Hj. rewrite app_nth2; rewrite map_length, seq_length; [reflexivity | assumption]. Qed.

Theorem field_of_is_lipschitz p m a : locally_lipschitz m (field_of p m a).
Proof.
  intros r. set (B := Rabs r + fold_right (fun u s => Rabs u + s) 0 a).
  assert (Ba : forall j, Rabs (nth j a 0) <= fold_right (fun u s => Rabs u + s) 0 a).
  { clear. induction a as [|u a IH]; intros [|j]; cbn; rewrite ?Rabs_R0; try lra.
    - specialize (IH (length a)). rewrite nth_overflow, Rabs_R0 in IH by lia. lra.
    - specialize (IH j). pose proof (Rabs_pos u). lra. }
  pose proof (Rabs_pos r). pose proof (Rle_abs r).
  assert (A0 : 0 <= fold_right (fun u s => Rabs u + s) 0 a) by (eapply Rle_trans; [apply Rabs_pos | apply (Ba O)]).
  destruct (all_near (nodes p) 1 B) as [L [B' [HL Hn]]]; [lra | unfold B; lra|].
  exists L. split; [lra|]. intros x y Hx Hy i Hi. unfold field_of.
  assert (HD : 0 <= sum m (fun j => Rabs (x j - y j))) by (apply sum_nonneg; intros; apply Rabs_pos).
  apply (Hn _ (map x (seq 0 m) ++ a) (map y (seq 0 m) ++ a) HD); [rewrite !app_length, !map_length; reflexivity|].
  intros j. destruct (Nat.lt_ge_cases j m) as [Hj|Hj].
  - rewrite !nth_inputs by assumption. specialize (Hx j Hj). specialize (Hy j Hj).
    repeat split; [unfold B; lra | unfold B; lra|]. rewrite Rmult_1_l.
    apply (term_le_sum m (fun j => Rabs (x j - y j))); [intros; apply Rabs_pos | assumption].
  - rewrite !nth_parameters by assumption. specialize (Ba (j - m)%nat).
    repeat split; [unfold B; lra | unfold B; lra|]. rewrite Rminus_eq_0, Rabs_R0. lra.
Qed.

Lemma Forall2_nth {A B} (P : A -> B -> Prop) a b da db i : Forall2 P a b -> (i < length a)%nat -> P (nth i a da) (nth i b db).
Proof.
  intros H. revert i. induction H as [|x y a b Hxy H IH]; intros [|i] Hi; cbn in *; try lia; [assumption | apply IH; lia].
Qed.

Section Running.
Variables (f : format) (theta : R).
Hypothesis f_plain : plain f.
Hypothesis theta_in : 0 <= theta <= 1.

Lemma run_sound ns : forall values us gs found, Forall2 (holds f theta) values us ->
  well_formed_from (length values) ns = true -> forallb is_arithmetic ns = true -> run f ns values gs = Some found ->
  Forall2 (holds f theta) found (all_values ns us).
Proof.
  induction ns as [|n ns IH]; intros values us gs found H W A R.
  - cbn in R. injection R as <-. exact H.
  - cbn [well_formed_from forallb all_values] in *. apply andb_prop in W. destruct W as [W1 W2]. apply andb_prop in A.
    destruct A as [A1 A2].
    assert (go : forall x, holds f theta x (node_value n us) -> run f ns (values ++ [x]) gs = Some found ->
      Forall2 (holds f theta) found (all_values ns (us ++ [node_value n us]))).
    { intros x Hx Hr. apply (IH (values ++ [x]) _ gs); [apply Forall2_app; auto | | assumption | assumption].
      rewrite app_length. cbn [length]. rewrite Nat.add_1_r. assumption. }
    assert (at_ : forall i, (i <? length values)%nat = true -> holds f theta (nth i values missing) (nth i us 0)).
    { intros i Hi. apply Nat.ltb_lt in Hi. apply Forall2_nth; assumption. }
    destruct n as [a b|i j|i j|i j|i a b|i p q]; cbn [run places_of forallb is_arithmetic] in *.
    + rewrite A1 in R. apply (go _ ltac:(apply holds_const; [assumption..|]; apply r_ltb in A1; rewrite r_0 in A1; exact A1) R).
    + apply andb_prop in W1. destruct W1 as [Wi Wj]. apply andb_prop in Wj. destruct Wj as [Wj _].
      refine (go _ _ R). apply holds_add; auto.
    + apply andb_prop in W1. destruct W1 as [Wi Wj]. apply andb_prop in Wj. destruct Wj as [Wj _].
      refine (go _ _ R). apply holds_sub; auto.
    + apply andb_prop in W1. destruct W1 as [Wi Wj]. apply andb_prop in Wj. destruct Wj as [Wj _].
      refine (go _ _ R). apply holds_mul; auto.
    + rewrite A1 in R. apply andb_prop in W1. destruct W1 as [Wi _]. refine (go _ _ R).
      apply holds_scale; auto. apply r_ltb in A1. rewrite r_0 in A1. exact A1.
    + discriminate.
Qed.

(* Derivatives: what is found is a divided difference between any two points that the elements stand for. *)
Definition slope_holds (s : slope) (r : R) : Prop :=
  match s with Zero => r = 0 | One => r = 1 | Of x => holds f theta x r end.

Lemma as_element_holds s r : slope_holds s r -> holds f theta (as_element f s) r.
Proof.
  assert (P : 0 < r_ 1%bigZ) by (rewrite r_1; lra). destruct s; cbn; intros H; [subst r | subst r | assumption].
  - replace 0 with (r_ 0%bigZ / r_ 1%bigZ) by (rewrite r_0; unfold Rdiv; ring). apply holds_const; assumption.
  - unfold unit_. replace 1 with (r_ 1%bigZ / r_ 1%bigZ) by (rewrite r_1; field). apply holds_const; assumption.
Qed.
Lemma slope_add_holds a b r s : slope_holds a r -> slope_holds b s -> slope_holds (slope_add f a b) (r + s).
Proof.
  intros Ha Hb. pose proof (holds_add f theta f_plain theta_in _ _ _ _ (as_element_holds a r Ha) (as_element_holds b s Hb)) as H.
  destruct a; cbn in Ha; [subst r; cbn; rewrite Rplus_0_l; exact Hb | |];
    (destruct b; cbn in Hb; [subst s; cbn; rewrite Rplus_0_r; exact Ha | |]); exact H.
Qed.
Lemma slope_scale_holds n d a r : 0 < r_ d -> slope_holds a r -> slope_holds (slope_scale f n d a) (r_ n / r_ d * r).
Proof.
  intros Hd Ha. pose proof (holds_scale f theta f_plain theta_in n d _ _ Hd (as_element_holds a r Ha)) as H.
  assert (E : forall s, (if ((n =? 1)%bigZ && (d =? 1)%bigZ)%bool then a else Of (escale f n d (as_element f a))) = s ->
    slope_holds s (r_ n / r_ d * r)).
  { intros s <-. destruct ((n =? 1)%bigZ && (d =? 1)%bigZ)%bool eqn:Q; [|exact H]. apply andb_prop in Q. destruct Q as [Q1 Q2].
    apply BigZ.eqb_eq in Q1. apply BigZ.eqb_eq in Q2.
    assert (N : r_ n = 1) by (unfold r_; replace (BigZ.to_Z n) with (BigZ.to_Z 1%bigZ) by (symmetry; exact Q1); reflexivity).
    assert (D : r_ d = 1) by (unfold r_; replace (BigZ.to_Z d) with (BigZ.to_Z 1%bigZ) by (symmetry; exact Q2); reflexivity).
    rewrite N, D. replace (1 / 1 * r) with r by field. exact Ha. }
  destruct a; [cbn in *; subst r; ring | |]; apply E; reflexivity.
Qed.
Lemma slope_mul_holds a r x u : slope_holds a r -> holds f theta x u -> slope_holds (slope_mul f a x) (r * u).
Proof.
  intros Ha Hx. destruct a; cbn in *; [subst r; ring | subst r; rewrite Rmult_1_l; exact Hx | apply holds_mul; assumption].
Qed.

Variable m : nat.
Definition row_holds (row : list slope) (rs : nat -> R) : Prop :=
  length row = m /\ forall j, (j < m)%nat -> slope_holds (nth j row Zero) (rs j).

Lemma length_map2 {A B C} (op : A -> B -> C) a : forall b, length a = length b -> length (map2 op a b) = length a.
Proof. induction a as [|x a IH]; intros [|y b] H; cbn in *; try discriminate; auto. Qed.
Lemma nth_map2 {A B C} (op : A -> B -> C) da db dc a : forall b i, length a = length b -> (i < length a)%nat ->
  nth i (map2 op a b) dc = op (nth i a da) (nth i b db).
Proof.
  induction a as [|x a IH]; intros [|y b] [|i] H Hi; cbn in *; try discriminate; try lia; [reflexivity | apply IH; lia].
Qed.
Lemma nth_map {A B} (g : A -> B) da db a i : (i < length a)%nat -> nth i (map g a) db = g (nth i a da).
Proof. intros H. rewrite (nth_indep _ db (g da)) by (rewrite map_length; assumption). apply map_nth. Qed.

Lemma row_add a b rs ss : row_holds a rs -> row_holds b ss -> row_holds (map2 (slope_add f) a b) (fun j => rs j + ss j).
Proof.
  intros [La Ha] [Lb Hb]. split; [rewrite length_map2; lia|]. intros j Hj.
  rewrite (nth_map2 _ Zero Zero) by lia. apply slope_add_holds; auto.
Qed.
Lemma row_scale n d a rs : 0 < r_ d -> row_holds a rs -> row_holds (map (slope_scale f n d) a) (fun j => r_ n / r_ d * rs j).
Proof.
  intros Hd [La Ha]. split; [rewrite map_length; assumption|]. intros j Hj. rewrite (nth_map _ Zero) by lia.
  apply slope_scale_holds; auto.
Qed.
Lemma row_mul a rs x u : row_holds a rs -> holds f theta x u -> row_holds (map (fun s => slope_mul f s x) a) (fun j => rs j * u).
Proof.
  intros [La Ha] Hx. split; [rewrite map_length; assumption|]. intros j Hj. rewrite (nth_map _ Zero) by lia.
  apply slope_mul_holds; auto.
Qed.

(* Two points, and all values on the way to the field at them. *)
Variables (values : list element) (us vs : list R) (d : nat -> R).
Hypothesis us_held : Forall2 (holds f theta) values us.
Hypothesis vs_held : Forall2 (holds f theta) values vs.

Definition found_holds (found : list (list slope)) : Prop := forall i, (i < length found)%nat ->
  exists rs, row_holds (nth i found []) rs /\ nth i us 0 - nth i vs 0 = sum m (fun j => rs j * d j).

Lemma slopes_sound ns : forall k found, (0 < k)%nat -> length found = k -> (k + length ns <= length values)%nat ->
  well_formed_from k ns = true -> forallb is_arithmetic ns = true -> computes us k ns -> computes vs k ns ->
  found_holds found -> found_holds (slopes f ns values k found) /\ length (slopes f ns values k found) = (k + length ns)%nat.
Proof.
  induction ns as [|n ns IH]; intros k found Hk Lf Lv W A Cu Cv H; cbn [slopes].
  - cbn [length]. split; [assumption | lia].
  - cbn [well_formed_from forallb computes length] in *. apply andb_prop in W. destruct W as [W1 W2].
    apply andb_prop in A. destruct A as [A1 A2]. destruct Cu as [Cu Cu']. destruct Cv as [Cv Cv'].
    assert (go : forall x rs, row_holds x rs -> node_value n us - node_value n vs = sum m (fun j => rs j * d j) ->
      found_holds (slopes f ns values (S k) (found ++ [x])) /\
      length (slopes f ns values (S k) (found ++ [x])) = (k + S (length ns))%nat).
    { intros x rs Hx E. rewrite Nat.add_succ_r, <- Nat.add_succ_l. apply IH; try assumption; try lia.
      - rewrite app_length. cbn. lia.
      - intros i Hi. rewrite app_length in Hi. cbn in Hi. destruct (Nat.eq_dec i k) as [->|Hne].
        + rewrite app_nth2 by lia. rewrite Lf, Nat.sub_diag. cbn [nth]. exists rs. rewrite Cu, Cv. auto.
        + rewrite app_nth1 by lia. apply H. lia. }
    assert (hu : forall i, (i <? k)%nat = true -> holds f theta (nth i values missing) (nth i us 0)).
    { intros i Hi. apply Nat.ltb_lt in Hi. apply Forall2_nth; [assumption | lia]. }
    assert (hv : forall i, (i <? k)%nat = true -> holds f theta (nth i values missing) (nth i vs 0)).
    { intros i Hi. apply Nat.ltb_lt in Hi. apply Forall2_nth; [assumption | lia]. }
    assert (hd_ : forall i, (i <? k)%nat = true -> exists rs, row_holds (nth i found []) rs /\
      nth i us 0 - nth i vs 0 = sum m (fun j => rs j * d j)).
    { intros i Hi. apply Nat.ltb_lt in Hi. apply H. lia. }
    destruct n as [a b|i j|i j|i j|i a b|i p q]; cbn [places_of forallb is_arithmetic node_value] in *.
    + destruct (hd_ 0%nat) as [rs [[L _] _]]; [apply Nat.ltb_lt; assumption|].
      apply (go _ (fun _ => 0)).
      * destruct found as [|row found]; [cbn in Lf; lia|]. cbn [nth hd] in *. split; [rewrite map_length; assumption|].
        intros j Hj. rewrite (nth_map _ Zero) by lia. reflexivity.
      * rewrite (sum_ext m _ (fun _ => 0)) by (intros; ring). rewrite sum_const. ring.
    + apply andb_prop in W1. destruct W1 as [Wi Wj]. apply andb_prop in Wj. destruct Wj as [Wj _].
      destruct (hd_ i Wi) as [rs [Hr Er]]. destruct (hd_ j Wj) as [ss [Hs Es]].
      apply (go _ _ (row_add _ _ _ _ Hr Hs)). rewrite (sum_ext m _ (fun l => rs l * d l + ss l * d l)) by (intros; ring).
      rewrite sum_plus, <- Er, <- Es. ring.
    + apply andb_prop in W1. destruct W1 as [Wi Wj]. apply andb_prop in Wj. destruct Wj as [Wj _].
      destruct (hd_ i Wi) as [rs [Hr Er]]. destruct (hd_ j Wj) as [ss [Hs Es]].
      assert (P : 0 < r_ 1%bigZ) by (rewrite r_1; lra).
      apply (go _ _ (row_add _ _ _ _ Hr (row_scale (-1)%bigZ 1%bigZ _ _ P Hs))).
      change (r_ (-1)%bigZ) with (-1). rewrite r_1.
      rewrite (sum_ext m _ (fun l => rs l * d l + (-1) * (ss l * d l))) by (intros; field).
      rewrite sum_plus, sum_scal, <- Er, <- Es. ring.
    + apply andb_prop in W1. destruct W1 as [Wi Wj]. apply andb_prop in Wj. destruct Wj as [Wj _].
      destruct (hd_ i Wi) as [rs [Hr Er]]. destruct (hd_ j Wj) as [ss [Hs Es]].
      destruct (i =? j)%nat eqn:Q.
      * apply Nat.eqb_eq in Q. subst j.
        apply (go _ _ (row_add _ _ _ _ (row_mul _ _ _ _ Hr (hu i Wi)) (row_mul _ _ _ _ Hr (hv i Wi)))).
        rewrite (sum_ext m _ (fun l => (nth i us 0 + nth i vs 0) * (rs l * d l))) by (intros; ring).
        rewrite sum_scal, <- Er. ring.
      * apply (go _ _ (row_add _ _ _ _ (row_mul _ _ _ _ Hr (hu j Wj)) (row_mul _ _ _ _ Hs (hv i Wi)))).
        rewrite (sum_ext m _ (fun l => nth j us 0 * (rs l * d l) + nth i vs 0 * (ss l * d l))) by (intros; ring).
        rewrite sum_plus, !sum_scal, <- Er, <- Es. ring.
    + apply andb_prop in W1. destruct W1 as [Wi _]. destruct (hd_ i Wi) as [rs [Hr Er]].
      assert (P : 0 < r_ b) by (apply r_ltb in A1; rewrite r_0 in A1; exact A1).
      apply (go _ _ (row_scale a b _ _ P Hr)).
      rewrite (sum_ext m _ (fun l => r_ a / r_ b * (rs l * d l))) by (intros; ring). rewrite sum_scal, <- Er. ring.
    + discriminate.
Qed.
End Running.
