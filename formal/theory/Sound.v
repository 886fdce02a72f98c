(* What is proved here of the computations of Polynomials.v and Crossings.v: their results are bounds, for real theta. *)

From Coq Require Import List ZArith Reals Lra Lia.
From Bignums Require Import BigZ.
From Orbitproof Require Import Polynomials Elements Crossings.
Import ListNotations.
Local Open Scope R_scope.
Local Open Scope list_scope.

Definition r_ (x : bigZ) : R := IZR (BigZ.to_Z x).
Arguments r_ : simpl never.

(* The value of a polynomial of scale 0. *)
Fixpoint eval (p : poly) (t : R) : R := match p with [] => 0 | a :: p' => r_ a + t * eval p' t end.

Lemma r_add a b : r_ (a + b)%bigZ = r_ a + r_ b.
Proof. unfold r_. rewrite BigZ.spec_add. apply plus_IZR. Qed.
Lemma r_mul a b : r_ (a * b)%bigZ = r_ a * r_ b.
Proof. unfold r_. rewrite BigZ.spec_mul. apply mult_IZR. Qed.
Lemma r_opp a : r_ (- a)%bigZ = - r_ a.
Proof. unfold r_. rewrite BigZ.spec_opp. apply opp_IZR. Qed.
Lemma r_sub a b : r_ (a - b)%bigZ = r_ a - r_ b.
Proof. unfold r_. rewrite BigZ.spec_sub. apply minus_IZR. Qed.
Lemma r_abs a : r_ (BigZ.abs a) = Rabs (r_ a).
Proof. unfold r_. rewrite BigZ.spec_abs. apply abs_IZR. Qed.
Lemma r_0 : r_ 0%bigZ = 0.
Proof. reflexivity. Qed.
Lemma r_1 : r_ 1%bigZ = 1.
Proof. reflexivity. Qed.

Lemma eval_padd p : forall q t, eval (padd p q) t = eval p t + eval q t.
Proof.
  induction p as [|a p IH]; intros [|b q] t; cbn; try lra. rewrite IH, r_add. lra.
Qed.
Lemma eval_pscale c p t : eval (pscale c p) t = r_ c * eval p t.
Proof. induction p as [|a p IH]; cbn; [lra|]. unfold pscale in IH. rewrite IH, r_mul. lra. Qed.
Lemma eval_opp p t : eval (map BigZ.opp p) t = - eval p t.
Proof. induction p as [|a p IH]; cbn; [lra|]. rewrite IH, r_opp. lra. Qed.
Lemma eval_psub p q t : eval (psub p q) t = eval p t - eval q t.
Proof. unfold psub. rewrite eval_padd, eval_opp. lra. Qed.

Lemma l1_cons a p : l1 (a :: p) = (BigZ.abs a + l1 p)%bigZ.
Proof. reflexivity. Qed.

Lemma l1_nonneg p : 0 <= r_ (l1 p).
Proof.
  induction p as [|a p IH]; [cbn; rewrite r_0; lra|]. rewrite l1_cons, r_add, r_abs.
  pose proof (Rabs_pos (r_ a)). lra.
Qed.

(* The sum of the absolute values of the coefficients bounds the values. *)
Theorem l1_is_a_bound p t : 0 <= t <= 1 -> Rabs (eval p t) <= r_ (l1 p).
Proof.
  intros Ht. induction p as [|a p IH].
  - cbn. rewrite Rabs_R0, r_0. lra.
  - cbn [eval]. rewrite l1_cons, r_add, r_abs. eapply Rle_trans; [apply Rabs_triang|].
    rewrite Rabs_mult, (Rabs_pos_eq t) by lra.
    pose proof (l1_nonneg p). pose proof (Rabs_pos (eval p t)). nra.
Qed.
Theorem l1_is_a_bound_around p s : -1 <= s <= 1 -> Rabs (eval p s) <= r_ (l1 p).
Proof.
  intros Hs. induction p as [|a p IH].
  - cbn. rewrite Rabs_R0, r_0. lra.
  - cbn [eval]. rewrite l1_cons, r_add, r_abs. eapply Rle_trans; [apply Rabs_triang|].
    rewrite Rabs_mult. assert (Rabs s <= 1) by (apply Rabs_le; lra).
    pose proof (l1_nonneg p). pose proof (Rabs_pos (eval p s)). pose proof (Rabs_pos s). nra.
Qed.

Lemma eval_pscale_to n c p t : eval (pscale_to n c p) t = r_ c * eval (firstn n p) t.
Proof.
  revert p; induction n as [|n IH]; intros [|a p]; cbn; try lra. rewrite IH, r_mul. lra.
Qed.
Lemma eval_split n p t : eval p t = eval (firstn n p) t + t ^ n * eval (skipn n p) t.
Proof.
  revert p; induction n as [|n IH]; intros [|a p]; cbn; try lra. rewrite (IH p) at 1. lra.
Qed.
Lemma power_small t n : 0 <= t <= 1 -> 0 <= t ^ n <= 1.
Proof.
  intros Ht. split; [apply pow_le; lra|]. rewrite <- (pow1 n). apply pow_incr. lra.
Qed.

(* What a product of polynomials leaves out is bounded by pmul_rest. *)
Theorem pmul_rest_is_a_bound p : forall n q t, 0 <= t <= 1 ->
  Rabs (eval p t * eval q t - eval (pmul n p q) t) <= r_ (pmul_rest n p q).
Proof.
  induction p as [|a p IH]; intros n q t Ht.
  - destruct n; cbn; rewrite r_0, Rmult_0_l, Rminus_0_r, Rabs_R0; lra.
  - destruct n as [|n].
    + cbn [pmul pmul_rest eval]. rewrite Rminus_0_r, r_mul, Rabs_mult.
      apply Rmult_le_compat; try apply Rabs_pos;
        [exact (l1_is_a_bound (a :: p) t Ht) | exact (l1_is_a_bound q t Ht)].
    + cbn [pmul pmul_rest]. rewrite eval_padd, eval_pscale_to. cbn [eval]. rewrite r_0, r_add, r_mul, r_abs.
      rewrite (eval_split (S n) q t) at 1.
      replace ((r_ a + t * eval p t) * (eval (firstn (S n) q) t + t ^ S n * eval (skipn (S n) q) t)
               - (r_ a * eval (firstn (S n) q) t + (0 + t * eval (pmul n p q) t)))
        with (r_ a * (t ^ S n * eval (skipn (S n) q) t) + t * (eval p t * eval q t - eval (pmul n p q) t))
        by (rewrite (eval_split (S n) q t); ring).
      eapply Rle_trans; [apply Rabs_triang|]. apply Rplus_le_compat.
      * rewrite Rabs_mult, Rabs_mult. apply Rmult_le_compat_l; [apply Rabs_pos|].
        destruct (power_small t (S n) Ht). rewrite (Rabs_pos_eq (t ^ S n)) by assumption.
        pose proof (l1_is_a_bound (skipn (S n) q) t Ht). pose proof (Rabs_pos (eval (skipn (S n) q) t)). nra.
      * rewrite Rabs_mult, (Rabs_pos_eq t) by lra. specialize (IH n q t Ht).
        pose proof (Rabs_pos (eval p t * eval q t - eval (pmul n p q) t)). nra.
Qed.

(* Division by powers of 2. *)
Definition two_to (k : bigZ) : R := powerRZ 2 (BigZ.to_Z k).
Lemma two_to_pos k : 0 < two_to k.
Proof. apply powerRZ_lt. lra. Qed.

Lemma power_of_2 k : (0 <= k)%Z -> powerRZ 2 k = IZR (2 ^ k).
Proof.
  intros Hk. rewrite <- (Z2Nat.id k) by assumption. rewrite <- pow_powerRZ. change 2 with (IZR 2). apply pow_IZR.
Qed.
Lemma power_opp k : powerRZ 2 (- k) = / powerRZ 2 k.
Proof. rewrite powerRZ_neg' by lra. reflexivity. Qed.

Lemma shiftr_floor x k : IZR (Z.shiftr x k) <= IZR x * powerRZ 2 (- k) < IZR (Z.shiftr x k) + 1.
Proof.
  destruct (Z.le_gt_cases 0 k) as [Hk|Hk].
  - rewrite Z.shiftr_div_pow2 by assumption.
    assert (Hp : (0 < 2 ^ k)%Z) by (apply Z.pow_pos_nonneg; lia).
    assert (E : powerRZ 2 (- k) = / IZR (2 ^ k)) by (rewrite power_opp, power_of_2 by assumption; reflexivity).
    rewrite E. assert (Hr : 0 < IZR (2 ^ k)) by (apply IZR_lt; assumption).
    pose proof (Z.mul_div_le x (2 ^ k) Hp) as H1. pose proof (Z.mul_succ_div_gt x (2 ^ k) Hp) as H2.
    apply IZR_le in H1. apply IZR_lt in H2. rewrite mult_IZR in H1, H2. rewrite succ_IZR in H2.
    split.
    + apply (Rmult_le_reg_l (IZR (2 ^ k))); [assumption|]. replace (IZR (2 ^ k) * (IZR x * / IZR (2 ^ k))) with (IZR x)
        by (field; lra). assumption.
    + apply (Rmult_lt_reg_l (IZR (2 ^ k))); [assumption|]. replace (IZR (2 ^ k) * (IZR x * / IZR (2 ^ k))) with (IZR x)
        by (field; lra). assumption.
  - assert (S : Z.shiftr x k = (x * 2 ^ (- k))%Z)
      by (rewrite <- (Z.shiftl_mul_pow2 x (- k)) by lia; rewrite Z.shiftl_opp_r; reflexivity).
    rewrite S, mult_IZR.
    assert (E : powerRZ 2 (- k) = IZR (2 ^ (- k))) by (apply power_of_2; lia).
    rewrite E. lra.
Qed.

Theorem down_is_below x k : r_ (down x k) <= r_ x / two_to k < r_ (down x k) + 1.
Proof.
  unfold down, r_, two_to. rewrite BigZ.spec_shiftr. unfold Rdiv.
  replace (/ powerRZ 2 (BigZ.to_Z k)) with (powerRZ 2 (- BigZ.to_Z k)) by apply power_opp.
  apply shiftr_floor.
Qed.
Theorem up_is_above x k : r_ (up x k) - 1 < r_ x / two_to k <= r_ (up x k).
Proof.
  unfold up. pose proof (down_is_below (- x)%bigZ k) as H. unfold down in H. rewrite r_opp in *.
  unfold Rdiv in *. lra.
Qed.

(* Rounding changes the values of a polynomial by at most a unit for each coefficient. *)
Theorem rounding_is_bounded k p t : 0 <= t <= 1 ->
  Rabs (eval (map (fun c => down c k) p) t - eval p t / two_to k) <= INR (length p).
Proof.
  intros Ht. induction p as [|a p IH].
  - cbn. unfold Rdiv. rewrite Rmult_0_l, Rminus_0_r, Rabs_R0. lra.
  - cbn [map eval length]. rewrite S_INR. pose proof (down_is_below a k) as Ha.
    replace (r_ (down a k) + t * eval (map (fun c => down c k) p) t - (r_ a + t * eval p t) / two_to k)
      with ((r_ (down a k) - r_ a / two_to k) + t * (eval (map (fun c => down c k) p) t - eval p t / two_to k))
      by (unfold Rdiv; ring).
    eapply Rle_trans; [apply Rabs_triang|]. rewrite Rabs_mult, (Rabs_pos_eq t) by lra.
    assert (Rabs (r_ (down a k) - r_ a / two_to k) <= 1) by (apply Rabs_le; lra).
    pose proof (Rabs_pos (eval (map (fun c => down c k) p) t - eval p t / two_to k)). pose proof (pos_INR (length p)). nra.
Qed.

(* pderiv is the derivative. *)
Lemma eval_pderiv_from p : forall k t, eval (pderiv_from k p) t = r_ k * eval p t + t * eval (pderiv p) t.
Proof.
  induction p as [|a p IH]; intros k t; [cbn; lra|].
  unfold pderiv. cbn [pderiv_from tl eval]. rewrite (IH (k + 1)%bigZ), (IH 1%bigZ), r_mul, r_add, r_1. ring.
Qed.
Theorem pderiv_is_the_derivative p t : derivable_pt_lim (eval p) t (eval (pderiv p) t).
Proof.
  induction p as [|a p IH].
  - cbn. apply derivable_pt_lim_const.
  - unfold pderiv. cbn [tl]. rewrite eval_pderiv_from, r_1.
    replace (1 * eval p t + t * eval (pderiv p) t) with (0 + (1 * eval p t + t * eval (pderiv p) t)) by ring.
    change (eval (a :: p)) with (fct_cte (r_ a) + id * eval p)%F.
    apply derivable_pt_lim_plus; [apply derivable_pt_lim_const|].
    apply derivable_pt_lim_mult; [apply derivable_pt_lim_id | exact IH].
Qed.

Lemma eval_at_one p : r_ (at_one p) = eval p 1.
Proof. induction p as [|a p IH]; cbn; [reflexivity|]. fold (at_one p). rewrite r_add, IH. lra. Qed.
Lemma eval_at_zero p : r_ (at_zero p) = eval p 0.
Proof. destruct p as [|a p]; cbn; [reflexivity|]. unfold at_zero. cbn. lra. Qed.

(* Recentring. *)
Lemma eval_shifted c p s : eval (shifted c p) s = eval p (r_ c + s).
Proof.
  induction p as [|a p IH]; [reflexivity|]. cbn [shifted eval]. rewrite !eval_padd, eval_pscale. cbn [eval].
  rewrite IH, r_0. ring.
Qed.
Lemma two_to_add a b : two_to (a + b)%bigZ = two_to a * two_to b.
Proof. unfold two_to. rewrite BigZ.spec_add. apply powerRZ_add. lra. Qed.
Lemma r_shiftl a k : r_ (BigZ.shiftl a k) = r_ a * two_to k \/ (BigZ.to_Z k < 0)%Z.
Proof.
  destruct (Z.le_gt_cases 0 (BigZ.to_Z k)) as [H|H]; [left|right; assumption].
  unfold r_, two_to. rewrite BigZ.spec_shiftl, Z.shiftl_mul_pow2 by assumption. rewrite mult_IZR. f_equal.
  symmetry. apply power_of_2. assumption.
Qed.

Lemma to_Z_of_nat n : BigZ.to_Z (BigZ.of_Z (Z.of_nat n)) = Z.of_nat n.
Proof. apply BigZ.spec_of_Z. Qed.

Lemma eval_homogeneous e p : forall t, (0 <= BigZ.to_Z e)%Z ->
  eval (homogeneous e p) t = two_to (recentred_scale e p) * eval p (t / two_to e).
Proof.
  induction p as [|a p IH]; intros t He; [cbn; lra|].
  cbn [homogeneous eval]. rewrite IH by assumption. pose proof (two_to_pos e) as Pe.
  destruct (r_shiftl a (e * BigZ.of_Z (Z.of_nat (length p)))%bigZ) as [E|E];
    [|rewrite BigZ.spec_mul, to_Z_of_nat in E; pose proof (Zle_0_nat (length p)); nia].
  rewrite E. unfold recentred_scale. cbn [length pred].
  destruct p as [|b p].
  - cbn. ring.
  - cbn [length pred].
    assert (S : two_to (e * BigZ.of_Z (Z.of_nat (S (length p))))%bigZ
                = two_to e * two_to (e * BigZ.of_Z (Z.of_nat (length p)))%bigZ).
    { unfold two_to. rewrite <- powerRZ_add by lra. f_equal. rewrite !BigZ.spec_mul, !to_Z_of_nat, Nat2Z.inj_succ. ring. }
    rewrite S. field. lra.
Qed.

(* recentred gives the values at (c + s) / 2^e. *)
Theorem recentred_is_the_same_function c e p s : (0 <= BigZ.to_Z e)%Z ->
  eval (recentred c e p) s = two_to (recentred_scale e p) * eval p ((r_ c + s) / two_to e).
Proof. intros He. unfold recentred. rewrite eval_shifted. apply eval_homogeneous. assumption. Qed.

(* A part of [0, 1] by its centre. *)
Lemma in_part i d t : (0 <= BigZ.to_Z d)%Z -> r_ i / two_to d <= t <= (r_ i + 1) / two_to d ->
  exists s, -1 <= s <= 1 /\ t = (r_ (2 * i + 1)%bigZ + s) / two_to (d + 1)%bigZ.
Proof.
  intros Hd [Hl Hh]. pose proof (two_to_pos d) as Pd.
  exists (2 * (t * two_to d) - (2 * r_ i + 1)).
  assert (D : two_to (d + 1)%bigZ = two_to d * 2).
  { rewrite two_to_add. f_equal. change (powerRZ 2 1 = 2). simpl. lra. }
  assert (Hl' : r_ i <= t * two_to d).
  { apply (Rmult_le_compat_r (two_to d)) in Hl; [|lra]. unfold Rdiv in Hl.
    rewrite Rmult_assoc, Rinv_l in Hl by lra. lra. }
  assert (Hh' : t * two_to d <= r_ i + 1).
  { apply (Rmult_le_compat_r (two_to d)) in Hh; [|lra]. unfold Rdiv in Hh.
    rewrite Rmult_assoc, Rinv_l in Hh by lra. lra. }
  split; [lra|]. rewrite r_add, r_mul, r_1, D. change (r_ 2%bigZ) with 2. field. lra.
Qed.

Lemma r_leb a b : (a <=? b)%bigZ = true -> r_ a <= r_ b.
Proof. rewrite BigZ.spec_leb. intros H. apply IZR_le. apply Z.leb_le. assumption. Qed.
Lemma r_ltb a b : (a <? b)%bigZ = true -> r_ a < r_ b.
Proof. rewrite BigZ.spec_ltb. intros H. apply IZR_lt. apply Z.ltb_lt. assumption. Qed.
Lemma two_to_sub a b : two_to (a - b)%bigZ = two_to a / two_to b.
Proof.
  unfold two_to. rewrite BigZ.spec_sub. unfold Z.sub. rewrite powerRZ_add by lra. rewrite power_opp. reflexivity.
Qed.

(* Where has_sign answers, the polynomial of the centre has the sign on the whole part, by more than all that is unknown. *)
Theorem has_sign_is_right (c : format) (x : element) sign i d t :
  (0 <= BigZ.to_Z d)%Z -> has_sign c x sign i d = true -> r_ i / two_to d <= t <= (r_ i + 1) / two_to d ->
  (sign = 1 \/ sign = -1)%bigZ ->
  r_ (total (unknown x)) / two_to (eps c) < r_ sign * (eval (hd [] (known x)) t / two_to (bits c)).
Proof.
  intros Hd H Ht Hs. unfold has_sign in H. set (p := hd [] (known x)) in *.
  set (q := recentred (2 * i + 1)%bigZ (d + 1)%bigZ p) in *. set (m := recentred_scale (d + 1)%bigZ p) in *.
  apply r_ltb in H. rewrite r_add in H.
  destruct (in_part i d t Hd Ht) as [s [Hs1 Et]].
  assert (Hd1 : (0 <= BigZ.to_Z (d + 1)%bigZ)%Z) by (rewrite BigZ.spec_add; change (BigZ.to_Z 1%bigZ) with 1%Z; lia).
  pose proof (recentred_is_the_same_function (2 * i + 1)%bigZ (d + 1)%bigZ p s Hd1) as E. fold q m in E. rewrite <- Et in E.
  assert (Q : eval q s = r_ (at_zero q) + s * eval (tl q) s).
  { destruct q; [unfold at_zero; cbn; rewrite r_0; lra | reflexivity]. }
  pose proof (l1_is_a_bound_around (tl q) s Hs1) as L.
  pose proof (up_is_above (l1 (tl q)) (bits c + m - eps c)%bigZ) as U. unfold bound in H. cbv zeta in H.
  pose proof (down_is_below (sign * at_zero q)%bigZ (bits c + m - eps c)%bigZ) as D. rewrite r_mul in D.
  rewrite two_to_sub, two_to_add in U, D.
  pose proof (two_to_pos (bits c)) as Pb. pose proof (two_to_pos m) as Pm. pose proof (two_to_pos (eps c)) as Pe.
  set (B := two_to (bits c)) in *. set (M := two_to m) in *. set (P := two_to (eps c)) in *.
  set (T := r_ (total (unknown x))) in *.
  assert (K : r_ (l1 (tl q)) * P / (B * M) + T < r_ sign * r_ (at_zero q) * P / (B * M)).
  { replace (r_ (l1 (tl q)) * P / (B * M)) with (r_ (l1 (tl q)) / (B * M / P)) by (field; lra).
    replace (r_ sign * r_ (at_zero q) * P / (B * M)) with (r_ sign * r_ (at_zero q) / (B * M / P)) by (field; lra). lra. }
  assert (S1 : - (r_ (l1 (tl q))) <= r_ sign * (s * eval (tl q) s)).
  { assert (A : Rabs (r_ sign * (s * eval (tl q) s)) <= r_ (l1 (tl q))).
    { rewrite !Rabs_mult. replace (Rabs (r_ sign)) with 1.
      2:{ destruct Hs as [->| ->]; [rewrite r_1, Rabs_R1; reflexivity|].
          change (r_ (-1)%bigZ) with (-1). rewrite Rabs_left; lra. }
      assert (Rabs s <= 1) by (apply Rabs_le; lra). pose proof (Rabs_pos s). pose proof (Rabs_pos (eval (tl q) s)). nra. }
    unfold Rabs in A. destruct (Rcase_abs (r_ sign * (s * eval (tl q) s))); lra. }
  assert (V : eval p t = eval q s / M) by (rewrite E; field; lra).
  apply (Rmult_lt_reg_l (P)); [assumption|].
  replace (P * (T / P)) with T by (field; lra).
  replace (P * (r_ sign * (eval p t / B))) with (r_ sign * eval q s * P / (B * M)) by (rewrite V; field; lra).
  rewrite Q.
  replace (r_ sign * (r_ (at_zero q) + s * eval (tl q) s) * P / (B * M))
    with (r_ sign * r_ (at_zero q) * P / (B * M) + r_ sign * (s * eval (tl q) s) * (P / (B * M))) by (field; lra).
  assert (F : 0 < P / (B * M)) by (apply Rdiv_lt_0_compat; nra).
  replace (r_ (l1 (tl q)) * P / (B * M)) with (r_ (l1 (tl q)) * (P / (B * M))) in K by (field; lra).
  nra.
Qed.
