(* What theory/Steps.v checks with integers is a solution of the initial value problem, as a theorem about real functions. *)

From Coq Require Import List ZArith Reals Lra Lia.
From Coquelicot Require Import Coquelicot.
From Bignums Require Import BigZ.
From Orbitproof Require Import Polynomials Elements Formats Programs Steps Sound.
From Solutions Require Import Comparison Flow Norms Values Fields Bounds CheckedSteps.
Import ListNotations.
Local Open Scope R_scope.
Local Open Scope list_scope.

Lemma Forall2_length {A B} (P : A -> B -> Prop) a b : Forall2 P a b -> length a = length b.
Proof. induction 1; cbn; congruence. Qed.
Lemma below {i m l : nat} : (i < m)%nat -> l = m -> (i < l)%nat.
Proof. lia. Qed.
Lemma Forall2_by_nth {A B} (P : A -> B -> Prop) a b da db : length a = length b ->
  (forall i, (i < length a)%nat -> P (nth i a da) (nth i b db)) -> Forall2 P a b.
Proof.
  revert b. induction a as [|x a IH]; intros [|y b] L H; cbn in L; try discriminate; constructor.
  - apply (H O). cbn. lia.
  - apply IH; [lia|]. intros i Hi. apply (H (S i)). cbn. lia.
Qed.

Lemma poly_eqb_same p q t : poly_eqb p q = true -> eval p t = eval q t.
Proof.
  unfold poly_eqb. intros H. assert (Z : forall l, forallb (fun c => (c =? 0)%bigZ) l = true -> eval l t = 0).
  { clear. induction l as [|x l IH]; cbn; intros H; [reflexivity|]. apply andb_prop in H. destruct H as [H1 H2].
    rewrite (IH H2). apply BigZ.eqb_eq in H1. unfold r_. replace (BigZ.to_Z x) with 0%Z by (symmetry; exact H1). lra. }
  specialize (Z _ H). rewrite eval_psub in Z. lra.
Qed.

Lemma scaled_lipschitz m (g : field) k : locally_lipschitz m g -> locally_lipschitz m (fun x i => k * g x i).
Proof.
  intros H r. destruct (H r) as [L [HL HH]]. exists (Rabs k * L). split; [apply Rmult_le_pos; [apply Rabs_pos | assumption]|].
  intros x y Hx Hy i Hi. rewrite <- Rmult_minus_distr_l, Rabs_mult, Rmult_assoc. apply Rmult_le_compat_l; [apply Rabs_pos | auto].
Qed.

Lemma forallb_nth {A} (g : A -> bool) l d i : forallb g l = true -> (i < length l)%nat -> g (nth i l d) = true.
Proof. intros H Hi. rewrite forallb_forall in H. apply H, nth_In. assumption. Qed.
Lemma forallb_nth2 {A B} (g : A * B -> bool) a b da db i : forallb g (combine a b) = true -> length a = length b ->
  (i < length a)%nat -> g (nth i a da, nth i b db) = true.
Proof.
  intros H L Hi. rewrite <- (combine_nth a b i da db L). apply (forallb_nth g); [assumption|]. rewrite combine_length. lia.
Qed.

Lemma sum_unit m i (d : nat -> R) : (i < m)%nat -> sum m (fun j => (if (i =? j)%nat then 1 else 0) * d j) = d i.
Proof.
  induction m as [|m IH]; intros Hi; [lia|]. cbn [sum]. destruct (Nat.eq_dec i m) as [->|Hne].
  - rewrite Nat.eqb_refl. rewrite (sum_ext m _ (fun _ => 0)); [rewrite sum_const; ring|].
    intros j Hj. rewrite (proj2 (Nat.eqb_neq m j)) by lia. ring.
  - rewrite IH by lia. rewrite (proj2 (Nat.eqb_neq i m)) by assumption. ring.
Qed.

(* An element times h / 8, on one part. *)
Lemma entry_above f theta s r k num den : plain f -> 0 <= theta <= 1 -> 0 <= r_ num ->
  slope_holds (coarse f) theta s r -> INR k / 8 <= theta <= (INR k + 1) / 8 ->
  let o := option_map (map (fun e => up (num * e) (den + 3))) (slope_on_part f s k) in
  entry_sized f o /\ r_ num / two_to den / 8 * Rabs r <= entry f o.
Proof.
  intros f_plain Ht Hn H Hk. cbv zeta.
  assert (T8 : two_to 3%bigZ = 8) by (unfold two_to; change (BigZ.to_Z 3%bigZ) with 3%Z; simpl; lra).
  assert (G : forall x u, holds (coarse f) theta x u ->
    entry_sized f (option_map (map (fun e => up (num * e) (den + 3))) (Some (on_part f x k))) /\
    r_ num / two_to den / 8 * Rabs u <= entry f (option_map (map (fun e => up (num * e) (den + 3))) (Some (on_part f x k)))).
  { intros x u Hx. destruct (on_part_above f theta x u k Hx Hk) as [S B]. cbn [option_map entry_sized entry].
    split; [apply sized_map; [intros y Hy; apply up_nonneg; rewrite r_mul; apply Rmult_le_pos; assumption | assumption]|].
    pose proof (two_to_pos den) as Pd. pose proof (two_to_pos (eps f)) as Pe.
    apply Rle_trans with (r_ num / two_to den / 8 * as_number f (on_part f x k)).
    - apply Rmult_le_compat_l; [|assumption]. apply Rle_mult_inv_pos; [|lra]. apply Rle_mult_inv_pos; assumption.
    - unfold as_number. unfold Rdiv at 3 4. rewrite <- Rmult_assoc. apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat; assumption|].
      apply tot_map. intros y. pose proof (up_is_above (num * y)%bigZ (den + 3)%bigZ) as [_ U]. rewrite r_mul, two_to_add, T8 in U.
      replace (r_ num / two_to den / 8 * r_ y) with (r_ num * r_ y / (two_to den * 8)) by (field; lra). exact U. }
  destruct s as [| |x]; cbn [slope_holds slope_on_part] in *.
  - subst r. cbn. rewrite Rabs_R0, Rmult_0_r. split; [exact I | lra].
  - subst r. apply G. unfold unit_. replace 1 with (r_ 1%bigZ / r_ 1%bigZ) by (rewrite r_1; field).
    apply holds_const; [apply plain_coarse; assumption | assumption | rewrite r_1; lra].
  - apply G. assumption.
Qed.

(* The length of a step. *)
Definition duration (s : step) : R := r_ (numerator s) / two_to (denominator s).
(* The approximation, as a function of theta. *)
Definition approximation (f : format) (s : step) (i : nat) (theta : R) : R :=
  eval (hd [] (nth i (solution s) [])) theta / two_to (bits f).

Section CheckedStep.
Variables (f : format) (p : program) (from parameters : state) (s : step) (found : shown) (a : list R) (x0 : point).
Let m : nat := length from.
Let c : format := coarse f.
Let F : field := field_of p m a.
Let h : R := duration s.
Let P : nat -> R -> R := approximation f s.
Hypothesis f_plain : plain f.
Hypothesis p_polynomial : is_polynomial p = true.
Hypothesis parameters_hold : forall theta, 0 <= theta <= 1 -> Forall2 (holds f theta) parameters a.
Hypothesis x0_held : forall i, (i < m)%nat -> holds f 0 (nth i from missing) (x0 i).
Hypothesis checked_ : check_step f p from parameters s = Some found.

Theorem check_step_sound : 0 <= h /\ length (at_end f s (errors found)) = m /\ exists y : nat -> R -> R,
  (forall i, (i < m)%nat -> y i 0 = x0 i) /\ solves m F h y /\
  (forall i t, (i < m)%nat -> 0 <= t <= h -> Rabs (y i t - P i (t / h)) <= as_number f (nth i (errors found) [])) /\
  (forall i theta, (i < m)%nat -> 0 <= theta <= 1 -> holds f theta (nth i (at_end f s (errors found)) missing) (y i h)).
Proof.
  pose proof (plain_coarse f f_plain) as c_plain. fold c in c_plain.
  pose proof checked_ as H. unfold check_step in H. cbv zeta in H. fold m in H.
  match type of H with (if ?b then _ else _) = _ => destruct b eqn:B; [|discriminate] end.
  apply andb_prop in B; destruct B as [B B8]. apply andb_prop in B; destruct B as [B B7].
  apply andb_prop in B; destruct B as [B B6]. apply andb_prop in B; destruct B as [B B5].
  apply andb_prop in B; destruct B as [B B4]. apply andb_prop in B; destruct B as [B B3].
  apply andb_prop in B; destruct B as [B B2]. apply andb_prop in B; destruct B as [B0 B1].
  apply Nat.eqb_eq in B2. apply Nat.eqb_eq in B3. apply Nat.eqb_eq in B4.
  apply r_ltb in B0. rewrite r_0 in B0. rewrite BigZ.spec_leb in B1. apply Z.leb_le in B1. change (BigZ.to_Z 0%bigZ) with 0%Z in B1.
  set (num := numerator s) in *. set (den := denominator s) in *.
  pose proof (two_to_pos den) as Pd. pose proof (two_to_pos (bits f)) as Pb.
  assert (Hh : 0 < h) by (apply Rdiv_lt_0_compat; assumption).
  set (q := fun i => hd [] (nth i (solution s) [])).
  assert (Sol : forall i, (i < m)%nat -> nth i (solution s) [] = [q i] /\ (length (q i) <= kept f)%nat).
  { intros i Hi. pose proof (forallb_nth _ _ [] i B5 (below Hi B2)) as Q. unfold fits in Q. rewrite (plain_grades f f_plain) in Q.
    unfold q. destruct (nth i (solution s) []) as [|z [|z' l]]; cbn in Q; try discriminate. apply andb_prop in Q. destruct Q as [Q _].
    split; [reflexivity | apply Nat.leb_le; assumption]. }
  assert (Tub : forall i, (i < m)%nat -> sized (entries f) (nth i (tube s) [])).
  { intros i Hi. pose proof (forallb_nth _ _ [] i B8 (below Hi B3)) as Q8.
    pose proof (forallb_nth _ _ [] i B7 (below Hi B3)) as Q7. apply Nat.eqb_eq in Q8. split; [exact Q8|].
    apply Forall_forall. intros z Hz. rewrite forallb_forall in Q7. specialize (Q7 z Hz). apply r_leb in Q7. rewrite r_0 in Q7. assumption. }
  set (exact := map (fun x => element_of f x (nothing f)) (solution s)) in *.
  assert (Lex : length exact = m) by (unfold exact; rewrite map_length; assumption).
  assert (Ex : forall i theta, (i < m)%nat -> 0 <= theta <= 1 ->
    nth i exact missing = element_of f [q i] (nothing f) /\ holds f theta (element_of f [q i] (nothing f)) (P i theta)).
  { intros i theta Hi Ht. destruct (Sol i Hi) as [E L]. split.
    - unfold exact. rewrite (nth_map _ []) by exact (below Hi B2). rewrite E. reflexivity.
    - apply element_holds; try assumption; [apply nothing_entries|]. unfold P, approximation. fold (q i).
      rewrite Rminus_eq_0, Rabs_R0, as_number_nothing. lra. }
  destruct (evaluate f p (powers s) (exact ++ parameters)) as [values|] eqn:E1; [|discriminate].
  unfold evaluate in E1. destruct (well_formed p && (length (exact ++ parameters) =? inputs p)%nat)%bool eqn:W; [|discriminate].
  apply andb_prop in W. destruct W as [W Lin]. apply Nat.eqb_eq in Lin. pose proof W as W'. unfold well_formed in W'.
  apply andb_prop in W'. destruct W' as [Wn Wo].
  assert (Lpar : forall theta, 0 <= theta <= 1 -> length parameters = length a) by (intros; exact (Forall2_length _ _ _ (parameters_hold theta ltac:(assumption)))).
  specialize (Lpar 0 ltac:(lra)). rewrite app_length, Lex in Lin.
  assert (Out : forall i, (i < m)%nat -> (nth i (outputs p) O < inputs p + length (nodes p))%nat).
  { intros i Hi. pose proof (forallb_nth _ _ O i Wo (below Hi B4)) as Q. apply Nat.ltb_lt in Q. assumption. }
  set (args := fun x : point => map x (seq 0 m) ++ a).
  assert (Largs : forall x, length (args x) = inputs p) by (intros x; unfold args; rewrite app_length, map_length, seq_length; lia).
  assert (Lall : forall x, length (all_values (nodes p) (args x)) = (inputs p + length (nodes p))%nat).
  { intros x. destruct (all_values_begin (nodes p) (args x)) as [more [E L]]. rewrite E, app_length, Largs, L. reflexivity. }
  (* The field along the approximation. *)
  assert (Val : forall i theta, (i < m)%nat -> 0 <= theta <= 1 ->
    holds f theta (nth i (values_at p values) missing) (F (fun j => P j theta) i)).
  { intros i theta Hi Ht. unfold values_at. rewrite (nth_map _ O) by exact (below Hi B4).
    assert (Q : Forall2 (holds f theta) values (all_values (nodes p) (args (fun j => P j theta)))).
    { apply (run_sound f theta f_plain Ht (nodes p) (exact ++ parameters) _ (powers s)); try assumption.
      - apply Forall2_app; [|apply parameters_hold; assumption]. apply (Forall2_by_nth _ _ _ missing 0).
        + rewrite Lex, map_length, seq_length. reflexivity.
        + intros j Hj. rewrite Lex in Hj. destruct (Ex j theta Hj Ht) as [-> Q].
          rewrite (nth_map _ O) by (rewrite seq_length; assumption). rewrite seq_nth by assumption. exact Q.
      - rewrite app_length, Lex, Lin. assumption. }
    apply Forall2_nth; [assumption|]. rewrite (Forall2_length _ _ _ Q), Lall. apply Out. assumption. }
  set (defects := map2 (fun x v => defect f num den x v) (solution s) (values_at p values)) in *.
  assert (Lval : length (values_at p values) = m) by (unfold values_at; rewrite map_length; assumption).
  assert (Def : forall i, (i < m)%nat -> nth i defects [] = defect f num den [q i] (nth i (values_at p values) missing)).
  { intros i Hi. unfold defects. rewrite (nth_map2 _ [] missing) by (rewrite B2; lia). destruct (Sol i Hi) as [-> _]. reflexivity. }
  assert (Def2 : forall i theta, (i < m)%nat -> 0 <= theta <= 1 -> sized (entries f) (nth i defects []) /\
    Rabs (h * F (fun j => P j theta) i - eval (pderiv (q i)) theta / two_to (bits f)) <= as_number f (nth i defects [])).
  { intros i theta Hi Ht. rewrite (Def i Hi). apply defect_above; auto; lra. }
  assert (Ldef : length defects = m) by (unfold defects; rewrite length_map2; lia).
  set (start := map2 (fun a d => map (BigZ.add least) (nadd (unknown a) d)) from defects) in *.
  assert (Least : 0 <= r_ least) by (unfold r_; apply IZR_le; vm_compute; discriminate).
  assert (Start : forall i, (i < m)%nat -> nth i start [] = map (BigZ.add least) (nadd (unknown (nth i from missing)) (nth i defects []))).
  { intros i Hi. exact (nth_map2 (fun a d => map (BigZ.add least) (nadd (unknown a) d)) missing ([] : norm) ([] : norm) from defects i
      (eq_sym Ldef) Hi). }
  assert (St : forall i, (i < m)%nat -> sized (entries f) (nth i start []) /\
    as_number f (unknown (nth i from missing)) + as_number f (nth i defects []) <= as_number f (nth i start [])).
  { intros i Hi. rewrite (Start i Hi).
    destruct (x0_held i Hi) as [[_ Uf _ _] _]. destruct (Def2 i 0 Hi ltac:(lra)) as [Sd _].
    pose proof (sized_nadd _ _ _ Uf Sd) as Sn. split.
    - apply sized_map; [intros z Hz; rewrite r_add; lra | assumption].
    - rewrite <- as_number_add by assumption. apply scaled_le. rewrite <- (Rmult_1_l (tot _)). apply tot_map. intros z. rewrite r_add. lra. }
  assert (Vs : vector f m start).
  { assert (L : length start = m) by (unfold start; rewrite length_map2; fold m; lia). split; [exact L|].
    apply Forall_forall. intros z Hz. destruct (In_nth _ _ [] Hz) as [i [Hi <-]]. apply St. rewrite <- L. assumption. }
  set (wide := map2 (coarsened f) exact (tube s) ++ map (fun a => coarsened f a (nothing f)) parameters) in *.
  destruct (evaluate (coarse f) p (map (coarse_guess f) (powers s)) wide) as [around|] eqn:E2; [|discriminate].
  unfold evaluate in E2. destruct (well_formed p && (length wide =? inputs p)%nat)%bool; [|discriminate].
  set (rows := slopes_at p (derivatives (coarse f) p m around)) in *.
  set (T := fun i => as_number f (nth i (tube s) [])).
  assert (Lw : length wide = inputs p) by (unfold wide; rewrite app_length, length_map2, map_length by lia; lia).
  (* The values on the tube. *)
  assert (Wid : forall theta x, 0 <= theta <= 1 -> (forall j, (j < m)%nat -> Rabs (x j - P j theta) <= T j) ->
    Forall2 (holds c theta) around (all_values (nodes p) (args x))).
  { intros theta x Ht Hx. apply (run_sound c theta c_plain Ht (nodes p) wide _ (map (coarse_guess f) (powers s))); try assumption.
    2:{ rewrite Lw. assumption. }
    apply Forall2_app.
    - apply (Forall2_by_nth _ _ _ missing 0); [rewrite length_map2, map_length, seq_length; lia|].
      intros j Hj. rewrite length_map2, Lex in Hj by lia. rewrite (nth_map2 _ missing ([] : norm)) by lia.
      rewrite (nth_map _ O) by (rewrite seq_length; assumption). rewrite seq_nth by assumption.
      destruct (Ex j theta Hj Ht) as [-> [Q1 Q2]]. apply coarsened_holds; auto.
      specialize (Hx j Hj). unfold value, element_of. cbn [known unknown hd]. rewrite as_number_nothing, Rplus_0_l. exact Hx.
    - pose proof (parameters_hold theta Ht) as Q. clear -Q f_plain Ht. induction Q as [|e u l l' [H1 H2] Q IH]; cbn; constructor; [|assumption].
      apply coarsened_holds; auto; [apply nothing_entries|]. rewrite as_number_nothing, Rplus_0_r. assumption. }
  assert (Lrows : length rows = m) by (unfold rows, slopes_at; rewrite map_length; assumption).
  assert (Slo : forall theta x i, 0 <= theta <= 1 -> (i < m)%nat -> (0 < m)%nat -> (forall j, (j < m)%nat -> Rabs (x j - P j theta) <= T j) ->
    exists rs, row_holds c theta m (nth i rows []) rs /\ F x i - F (fun j => P j theta) i = sum m (fun j => rs j * (x j - P j theta))).
  { intros theta x i Ht Hi Hm Hx. pose proof (Wid theta x Ht Hx) as Wx.
    assert (Hz : forall j, (j < m)%nat -> Rabs (P j theta - P j theta) <= T j).
    { intros j Hj. rewrite Rminus_eq_0, Rabs_R0. apply as_number_nonneg. apply Tub. assumption. }
    pose proof (Wid theta (fun j => P j theta) Ht Hz) as Wp.
    assert (La : length around = (inputs p + length (nodes p))%nat) by (rewrite (Forall2_length _ _ _ Wx); apply Lall).
    destruct (slopes_sound c theta c_plain Ht m around (all_values (nodes p) (args x)) (all_values (nodes p) (args (fun j => P j theta)))
      (fun j => x j - P j theta) Wx Wp (nodes p) (inputs p) (map (unit_row m) (seq 0 (inputs p)))) as [S L]; try assumption.
    - lia.
    - rewrite map_length, seq_length. reflexivity.
    - lia.
    - rewrite <- (Largs x). apply all_values_computes. rewrite Largs. assumption.
    - rewrite <- (Largs (fun j => P j theta)). apply all_values_computes. rewrite Largs. assumption.
    - intros k Hk. rewrite map_length, seq_length in Hk. rewrite (nth_map _ O) by (rewrite seq_length; assumption).
      rewrite seq_nth by assumption. cbn [Nat.add]. exists (fun j => if (k =? j)%nat then 1 else 0). split.
      + unfold unit_row. split; [rewrite map_length, seq_length; reflexivity|]. intros j Hj.
        rewrite (nth_map _ O) by (rewrite seq_length; assumption). rewrite seq_nth by assumption. cbn [Nat.add].
        destruct (k =? j)%nat; reflexivity.
      + assert (Beg : forall z : point, nth k (all_values (nodes p) (args z)) 0 = nth k (args z) 0).
        { intros z. destruct (all_values_begin (nodes p) (args z)) as [more [E _]]. rewrite E. apply app_nth1. rewrite Largs. assumption. }
        rewrite !Beg. unfold args. destruct (Nat.lt_ge_cases k m) as [Hkm|Hkm].
        * rewrite !nth_inputs by assumption. rewrite sum_unit by assumption. reflexivity.
        * rewrite !nth_parameters by assumption. rewrite (sum_ext m _ (fun _ => 0)); [rewrite sum_const; ring|].
          intros j Hj. rewrite (proj2 (Nat.eqb_neq k j)) by lia. ring.
    - unfold rows, slopes_at. rewrite (nth_map _ O) by exact (below Hi B4). apply S. rewrite L. apply Out. assumption. }
  destruct (grown f num den (terms s) rows start) as [e|] eqn:G; [|discriminate].
  match type of H with (if ?b then _ else _) = _ => destruct b eqn:B9; [|discriminate] end. injection H as <-. cbn [errors].
  apply andb_prop in B9. destruct B9 as [Le Lt]. apply Nat.eqb_eq in Le.
  set (mats := fun k => matrix f num den rows k).
  assert (Part : forall k, (k < 8)%nat -> 0 <= INR k / 8 <= 1).
  { intros k Hk. pose proof (pos_INR k). assert (INR k <= INR 8) by (apply le_INR; lia). cbn in H0. lra. }
  assert (Mat : forall k i j, (i < m)%nat -> (j < m)%nat -> length (nth i rows []) = m ->
    nth j (nth i (mats k) []) None = option_map (map (fun e => up (num * e) (den + 3))) (slope_on_part f (nth j (nth i rows []) Zero) k)).
  { intros k i j Hi Hj Li. unfold mats, matrix. rewrite (nth_map _ []) by lia. rewrite (nth_map _ Zero) by lia. reflexivity. }
  assert (Msized : forall k, (k < 8)%nat -> matrix_sized f m (mats k)).
  { intros k Hk. split; [unfold mats, matrix; rewrite map_length; assumption|]. intros i Hi.
    destruct (Slo (INR k / 8) (fun j => P j (INR k / 8)) i (Part k Hk) Hi ltac:(lia)) as [rs [[Lr Hr] _]].
    { intros j Hj. rewrite Rminus_eq_0, Rabs_R0. apply as_number_nonneg. apply Tub. assumption. }
    assert (Lm : length (nth i (mats k) []) = m) by (unfold mats, matrix; rewrite (nth_map _ []) by lia; rewrite map_length; assumption).
    split; [assumption|]. apply Forall_forall. intros o Ho. destruct (In_nth _ _ None Ho) as [j [Hj <-]]. rewrite Lm in Hj.
    rewrite (Mat k i j Hi Hj Lr). apply (entry_above f (INR k / 8) _ (rs j) k); auto; lra. }
  set (g := fun (x : point) i => h / 8 * F x i).
  destruct (parts_sound f m g P (fun i t => eval (pderiv (q i)) t / two_to (bits f)) (fun i => as_number f (nth i defects [])) T (terms s) mats)
    with (r := 8%nat) (k := 0%nat) (v := start) (e := e) (x0 := x0) as [y [Y0 [Ys Yb]]]; auto.
  - apply scaled_lipschitz. apply field_of_is_lipschitz.
  - intros i t Hi Ht. unfold P, approximation. fold (q i).
    apply (is_derive_ext (fun t => / two_to (bits f) * eval (q i) t)); [intros; unfold Rdiv; apply Rmult_comm|].
    unfold Rdiv. rewrite Rmult_comm. apply (is_derive_scal (eval (q i))). apply derive_eval.
  - intros i Hi. apply as_number_nonneg. apply (Def2 i 0 Hi). lra.
  - intros i t Hi Ht. destruct (Def2 i t Hi Ht) as [_ Q]. unfold g.
    replace (h / 8 * F (fun j => P j t) i - eval (pderiv (q i)) t / two_to (bits f) / 8)
      with ((h * F (fun j => P j t) i - eval (pderiv (q i)) t / two_to (bits f)) / 8) by (field; lra).
    unfold Rdiv at 1. rewrite Rabs_mult, (Rabs_pos_eq (/ 8)) by lra. apply Rmult_le_compat_r; [lra | assumption].
  - intros k x i t Hk Hi Ht Hx. assert (Ht1 : 0 <= t <= 1).
    { pose proof (Part k Hk). assert (INR k + 1 <= 8) by (rewrite <- S_INR; replace 8 with (INR 8) by (cbn; lra); apply le_INR; lia). lra. }
    destruct (Slo t x i Ht1 Hi ltac:(lia) Hx) as [rs [[Lr Hr] Q]]. unfold g. rewrite <- Rmult_minus_distr_l, Q, <- sum_scal.
    eapply Rle_trans; [apply abs_sum|]. apply sum_le. intros j Hj. rewrite (Mat k i j Hi Hj Lr), <- Rmult_assoc, Rabs_mult.
    apply Rmult_le_compat_r; [apply Rabs_pos|]. rewrite Rabs_mult, (Rabs_pos_eq (h / 8)) by lra.
    apply (entry_above f t _ (rs j) k); auto; lra.
  - intros i Hi. pose proof (forallb_nth2 _ _ _ ([] : norm) ([] : norm) i Lt (eq_trans Le (eq_sym B3)) (below Hi Le)) as Q. cbn [fst snd] in Q. apply nlt_tot in Q.
    destruct Q as [Q _]. apply scaled_le. assumption.
  - intros i Hi. destruct (St i Hi) as [_ Q]. destruct (x0_held i Hi) as [[[z [Ez _]] _ _ _] X].
    assert (Z : value f 0 (nth i from missing) = P i 0).
    { pose proof (forallb_nth2 _ _ _ [] missing i B6 B2 (below Hi B2)) as R. cbn [fst snd] in R. unfold starts_at in R.
      rewrite Ez in R. destruct (Sol i Hi) as [ES _]. rewrite ES in R. cbn [map polys_eqb] in R. rewrite Bool.andb_true_r in R.
      apply (poly_eqb_same _ _ 0) in R. unfold value, P, approximation. rewrite Ez. fold (q i). cbn [hd]. rewrite <- R.
      cbn [eval]. rewrite eval_at_zero. f_equal. ring. }
    rewrite Z in X. replace (INR 0 / 8) with 0 by (cbn; field). replace (INR 8 / 8) with 1 by (cbn; field).
    rewrite Rmult_1_l. exact (Rle_trans _ _ _ (Rplus_le_compat_r _ _ _ X) Q).
  - split; [lra|]. assert (Lend : length (at_end f s e) = m) by (unfold at_end; rewrite length_map2; [exact B2 | exact (eq_trans B2 (eq_sym Le))]). split; [assumption|].
    assert (Eh : h / 8 * INR 8 = h) by (cbn; field).
    exists (fun i t => y i (t / (h / 8))).
    assert (Bd : forall i t, (i < m)%nat -> 0 <= t <= h -> Rabs (y i (t / (h / 8)) - P i (t / h)) <= as_number f (nth i e [])).
    { intros i t Hi Ht. assert (Q : 0 <= t / (h / 8) <= INR 8).
      { split; [apply Rle_mult_inv_pos; lra|]. apply (Rmult_le_reg_l (h / 8)); [lra|]. rewrite Eh.
        replace (h / 8 * (t / (h / 8))) with t by (field; lra). lra. }
      specialize (Yb i _ Hi Q). replace ((INR 0 + t / (h / 8)) / 8) with (t / h) in Yb by (cbn; field; lra). exact Yb. }
    split; [|split; [|split]].
    + intros i Hi. replace (0 / (h / 8)) with 0 by (field; lra). auto.
    + rewrite <- Eh at 1. apply solves_rescaled; [lra | exact Ys].
    + exact Bd.
    + intros i theta Hi Ht. unfold at_end. rewrite (nth_map2 _ [] ([] : norm)) by (first [exact (eq_trans B2 (eq_sym Le)) | exact (below Hi B2)]). destruct (Sol i Hi) as [-> _]. cbn [map].
      destruct (grown_grows f m (terms s) mats Msized (seq 0 8) start e) as [[_ Sv] _]; [intros l Hl; apply in_seq in Hl; lia | assumption | exact G|].
      apply element_holds; [assumption | assumption | cbn; apply (plain_kept f f_plain) | |].
      * rewrite Forall_forall in Sv. apply Sv, nth_In. exact (below Hi Le).
      * specialize (Bd i h Hi ltac:(lra)). replace (h / h) with 1 in Bd by (field; lra). unfold P, approximation in Bd. fold (q i) in Bd.
        cbn [eval]. rewrite Rmult_0_r, Rplus_0_r, eval_at_one. exact Bd.
Qed.
End CheckedStep.
