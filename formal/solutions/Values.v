(* What the elements of theory/Elements.v mean without variables: a number for each theta in [0, 1], near a polynomial. *)

From Coq Require Import List ZArith Reals Lra Lia.
From Coquelicot Require Import Rcomplements.
From Bignums Require Import BigZ.
From Orbitproof Require Import Polynomials Elements Formats Sound.
From Solutions Require Import Norms.
Import ListNotations.
Local Open Scope R_scope.
Local Open Scope list_scope.

(* There are no variables: the only monomial is the constant. *)
Record plain (f : format) : Prop := Plain {
  plain_grades : grades f = [O];
  plain_pairs : pairs f = [[(O, O)]];
  plain_kept : (1 <= kept f)%nat;
  plain_bits : (0 <= BigZ.to_Z (bits f))%Z
}.

Lemma plain_coarse f : plain f -> plain (coarse f).
Proof.
  intros [G P K B]. split; cbn; [reflexivity | reflexivity | | ].
  - destruct (kept f); lia.
  - rewrite BigZ.spec_min. change (BigZ.to_Z 96%bigZ) with 96%Z. lia.
Qed.

Lemma length_padd p : forall q, length (padd p q) = Nat.max (length p) (length q).
Proof. induction p as [|a p IH]; intros [|b q]; cbn; auto. Qed.
Lemma length_pscale_to n c : forall p, (length (pscale_to n c p) <= n)%nat.
Proof. induction n as [|n IH]; intros [|a p]; cbn; try lia. specialize (IH p). lia. Qed.
Lemma length_pmul n : forall p q, (length (pmul n p q) <= n)%nat.
Proof.
  induction n as [|n IH]; intros [|a p] q; cbn [pmul]; cbn [length]; try lia.
  rewrite length_padd. cbn [length]. pose proof (length_pscale_to (S n) a q). specialize (IH p q). lia.
Qed.

Lemma two_to_div x k : 0 <= x -> 0 <= x / two_to k.
Proof. intros H. apply Rle_mult_inv_pos; [assumption | apply two_to_pos]. Qed.

(* Functions that round by at most a unit. *)
Lemma rounded (g : bigZ -> bigZ) c p t : 0 <= t <= 1 -> (forall x, Rabs (r_ (g x) - c * r_ x) <= 1) ->
  Rabs (eval (map g p) t - c * eval p t) <= INR (length p).
Proof.
  intros Ht H. induction p as [|a p IH].
  - cbn. rewrite Rmult_0_r, Rminus_0_r, Rabs_R0. lra.
  - cbn [map eval length]. rewrite S_INR. specialize (H a).
    replace (r_ (g a) + t * eval (map g p) t - c * (r_ a + t * eval p t))
      with ((r_ (g a) - c * r_ a) + t * (eval (map g p) t - c * eval p t)) by ring.
    eapply Rle_trans; [apply Rabs_triang|]. rewrite Rabs_mult, (Rabs_pos_eq t) by lra.
    pose proof (Rabs_pos (eval (map g p) t - c * eval p t)). pose proof (pos_INR (length p)). nra.
Qed.

Section Values.
Variables (f : format) (theta : R).
Hypothesis f_plain : plain f.
Hypothesis theta_in : 0 <= theta <= 1.

Definition entries : nat := S (S (top f)).
Definition value (a : element) : R := eval (hd [] (known a)) theta / two_to (bits f).
(* A vector of bounds as one number. *)
Definition as_number (e : norm) : R := tot e / two_to (eps f).

Record fine (a : element) : Prop := Fine {
  fine_known : exists p, known a = [p] /\ (length p <= kept f)%nat;
  fine_unknown : sized entries (unknown a);
  fine_size : sized entries (size a);
  fine_value : Rabs (value a) <= as_number (size a)
}.
(* u is one of the numbers that a stands for. *)
Definition holds (a : element) (u : R) : Prop := fine a /\ Rabs (u - value a) <= as_number (unknown a).

Lemma as_number_nonneg e : sized entries e -> 0 <= as_number e.
Proof. intros H. apply two_to_div. apply (sized_tot entries). assumption. Qed.
Lemma as_number_add a b : sized entries a -> sized entries b -> as_number (nadd a b) = as_number a + as_number b.
Proof. intros Ha Hb. unfold as_number. rewrite (tot_nadd_sized entries) by assumption. unfold Rdiv. ring. Qed.
Lemma as_number_nothing : as_number (nothing f) = 0.
Proof. unfold as_number. destruct (nothing_sized f) as [_ E]. rewrite E. unfold Rdiv. ring. Qed.
Lemma nothing_entries : sized entries (nothing f).
Proof. apply nothing_sized. Qed.
Lemma as_number_raise x e : sized entries e -> 0 <= r_ x ->
  sized entries (raise 0 x e) /\ as_number (raise 0 x e) = r_ x / two_to (eps f) + as_number e.
Proof.
  intros He Hx. destruct (raise_sized _ x e He Hx) as [S E]. split; [assumption|]. unfold as_number. rewrite E. unfold Rdiv. ring.
Qed.
Lemma as_number_conv a b : sized entries a -> sized entries b ->
  sized entries (conv f a b) /\ as_number a * as_number b <= as_number (conv f a b).
Proof. apply conv_sized. Qed.

Lemma bound_above x s : r_ x / two_to s <= r_ (bound f x s) / two_to (eps f).
Proof.
  unfold bound. pose proof (up_is_above x (s - eps f)) as [_ U]. rewrite two_to_sub in U.
  pose proof (two_to_pos s) as Ps. pose proof (two_to_pos (eps f)) as Pe.
  apply (Rmult_le_reg_r (two_to (eps f))); [assumption|].
  replace (r_ (up x (s - eps f)) / two_to (eps f) * two_to (eps f)) with (r_ (up x (s - eps f))) by (field; lra).
  replace (r_ x / two_to s * two_to (eps f)) with (r_ x / (two_to s / two_to (eps f))) by (field; lra). exact U.
Qed.
Lemma bound_nonneg x s : 0 <= r_ x -> 0 <= r_ (bound f x s).
Proof. intros H. apply up_nonneg. assumption. Qed.
Lemma scale_0 : two_to (scale f 0) = two_to (bits f).
Proof.
  unfold two_to, scale. rewrite BigZ.spec_add, BigZ.spec_mul. change (BigZ.to_Z (BigZ.of_Z (Z.of_nat 0))) with 0%Z.
  rewrite Z.mul_0_l, Z.add_0_r. reflexivity.
Qed.
Lemma r_units : r_ (units f) = INR (kept f).
Proof. unfold r_, units. rewrite BigZ.spec_of_Z, <- INR_IZR_INZ. reflexivity. Qed.
Lemma rounding_above : INR (kept f) / two_to (bits f) <= r_ (rounding f 0) / two_to (eps f).
Proof. rewrite <- r_units, <- scale_0. apply bound_above. Qed.
Lemma rounding_nonneg : 0 <= r_ (rounding f 0).
Proof. apply bound_nonneg. rewrite r_units. apply pos_INR. Qed.

Lemma element_fine p errors : (length p <= kept f)%nat -> sized entries errors -> fine (element_of f [p] errors).
Proof.
  intros Hp He. unfold element_of. rewrite (plain_grades f f_plain). cbn [sizes].
  destruct (as_number_raise (bound f (l1 p) (scale f 0)) (nothing f) nothing_entries) as [S E];
    [apply bound_nonneg, l1_nonneg|].
  split; cbn [known unknown size]; [exists p; auto | assumption | assumption|].
  rewrite E, as_number_nothing, Rplus_0_r. unfold value. cbn [known hd]. eapply Rle_trans; [|apply bound_above].
  rewrite scale_0. unfold Rdiv. rewrite Rabs_mult. rewrite (Rabs_pos_eq (/ _)) by (left; apply Rinv_0_lt_compat, two_to_pos).
  apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat, two_to_pos | apply l1_is_a_bound; assumption].
Qed.
Lemma element_holds p errors u : (length p <= kept f)%nat -> sized entries errors ->
  Rabs (u - eval p theta / two_to (bits f)) <= as_number errors -> holds (element_of f [p] errors) u.
Proof. intros Hp He H. split; [apply element_fine; assumption | exact H]. Qed.

Lemma holds_bounded a u : holds a u -> Rabs u <= as_number (size a) + as_number (unknown a).
Proof.
  intros [[_ _ _ V] H]. pose proof (Rabs_triang (value a) (u - value a)) as T.
  replace (value a + (u - value a)) with u in T by ring. lra.
Qed.

Lemma holds_add a b u v : holds a u -> holds b v -> holds (eadd f a b) (u + v).
Proof.
  intros [[[p [Ep Lp]] Ua Sa _] Ha] [[[q [Eq Lq]] Ub Sb _] Hb]. unfold eadd. unfold value in *. rewrite Ep, Eq in *. cbn [map2 hd] in *.
  apply element_holds; [rewrite length_padd; apply Nat.max_lub; assumption | apply sized_nadd; assumption|].
  rewrite as_number_add, eval_padd by assumption.
  replace (u + v - (eval p theta + eval q theta) / two_to (bits f))
    with ((u - eval p theta / two_to (bits f)) + (v - eval q theta / two_to (bits f))) by (unfold Rdiv; ring).
  eapply Rle_trans; [apply Rabs_triang | lra].
Qed.
Lemma holds_sub a b u v : holds a u -> holds b v -> holds (esub f a b) (u - v).
Proof.
  intros [[[p [Ep Lp]] Ua Sa _] Ha] [[[q [Eq Lq]] Ub Sb _] Hb]. unfold esub. unfold value in *. rewrite Ep, Eq in *. cbn [map2 hd] in *.
  apply element_holds; [unfold psub; rewrite length_padd, map_length; apply Nat.max_lub; assumption | apply sized_nadd; assumption|].
  rewrite as_number_add, eval_psub by assumption.
  replace (u - v - (eval p theta - eval q theta) / two_to (bits f))
    with ((u - eval p theta / two_to (bits f)) - (v - eval q theta / two_to (bits f))) by (unfold Rdiv; ring).
  apply Rabs_le_between in Ha. apply Rabs_le_between in Hb. apply Rabs_le. lra.
Qed.

Lemma emul_is a b p q : known a = [p] -> known b = [q] ->
  emul f a b = element_of f [map (fun c => down c (bits f)) (padd (pmul (kept f) p q) [])]
    (nadd (raise 0 (rounding f 0 + bound f (pmul_rest (kept f) p q + 0) (scale f 0 + bits f))%bigZ (nothing f))
      (nadd (only_last (conv f (size a) (size b)))
        (nadd (conv f (size a) (unknown b)) (conv f (unknown a) (nadd (size b) (unknown b)))))).
Proof.
  intros Ea Eb. unfold emul. rewrite (plain_grades f f_plain), (plain_pairs f f_plain), Ea, Eb. reflexivity.
Qed.
Lemma padd_nil p : padd p [] = p.
Proof. destruct p; reflexivity. Qed.
Lemma rest_nonneg n p q : 0 <= r_ (pmul_rest n p q).
Proof.
  eapply Rle_trans; [apply Rabs_pos | apply (pmul_rest_is_a_bound p n q 0)]. lra.
Qed.

Lemma holds_mul a b u v : holds a u -> holds b v -> holds (emul f a b) (u * v).
Proof.
  intros Ha Hb. pose proof (holds_bounded b v Hb) as Bv.
  destruct Ha as [[[p [Ep Lp]] Ua Sa Va] Ha]. destruct Hb as [[[q [Eq Lq]] Ub Sb Vb] Hb].
  rewrite (emul_is a b p q Ep Eq), padd_nil. unfold value in *. rewrite Ep, Eq in *. cbn [hd] in *.
  set (rest := (rounding f 0 + bound f (pmul_rest (kept f) p q + 0) (scale f 0 + bits f))%bigZ).
  assert (R0 : 0 <= r_ rest).
  { unfold rest. rewrite r_add. pose proof rounding_nonneg.
    assert (0 <= r_ (bound f (pmul_rest (kept f) p q + 0)%bigZ (scale f 0 + bits f)%bigZ))
      by (apply bound_nonneg; rewrite (r_add _ 0%bigZ), r_0, Rplus_0_r; apply rest_nonneg). apply Rplus_le_le_0_compat; assumption. }
  destruct (as_number_raise rest (nothing f) nothing_entries R0) as [S1 E1].
  destruct (as_number_conv _ _ Sa Sb) as [S2 _]. apply only_last_sized in S2. destruct (as_number_conv _ _ Sa Ub) as [S3 E3].
  pose proof (sized_nadd _ _ _ Sb Ub) as Sv. destruct (as_number_conv _ _ Ua Sv) as [S4 E4].
  pose proof (sized_nadd _ _ _ S3 S4) as S5. pose proof (sized_nadd _ _ _ S2 S5) as S6.
  pose proof (length_pmul (kept f) p q) as Lpq.
  apply element_holds; [rewrite map_length; assumption | apply sized_nadd; assumption|].
  rewrite !as_number_add, E1, as_number_nothing by assumption. pose proof (as_number_nonneg _ S2) as P2.
  rewrite as_number_add in E4 by assumption.
  assert (R1 : INR (kept f) / two_to (bits f) + r_ (pmul_rest (kept f) p q) / (two_to (bits f) * two_to (bits f))
               <= r_ rest / two_to (eps f)).
  { unfold rest. rewrite r_add. pose proof rounding_above as Q1.
    pose proof (bound_above (pmul_rest (kept f) p q + 0)%bigZ (scale f 0 + bits f)%bigZ) as Q2.
    rewrite two_to_add, scale_0 in Q2. rewrite (r_add _ 0%bigZ), r_0, Rplus_0_r in Q2. unfold Rdiv in *. lra. }
  pose proof (pmul_rest_is_a_bound p (kept f) q theta theta_in) as D.
  pose proof (rounding_is_bounded (bits f) (pmul (kept f) p q) theta theta_in) as Q.
  apply le_INR in Lpq. pose proof (two_to_pos (bits f)) as Pb.
  set (B := two_to (bits f)) in *. set (P := eval p theta) in *. set (Qv := eval q theta) in *.
  set (m := eval (pmul (kept f) p q) theta) in *. set (rm := eval (map (fun c => down c (bits f)) (pmul (kept f) p q)) theta) in *.
  assert (T1 : Rabs (P / B * (Qv / B) - rm / B) <= INR (kept f) / B + r_ (pmul_rest (kept f) p q) / (B * B)).
  { replace (P / B * (Qv / B) - rm / B) with ((P * Qv - m) * / (B * B) - (rm - m / B) * / B) by (field; lra).
    assert (I1 : 0 < / B) by (apply Rinv_0_lt_compat; assumption). assert (I2 : 0 < / (B * B)) by (apply Rinv_0_lt_compat; nra).
    apply Rabs_le_between in D. apply Rabs_le_between in Q. unfold Rdiv in *. apply Rabs_le.
    set (dd := P * Qv - m) in *. set (qq := rm - m * / B) in *. set (ib := / B) in *. set (ibb := / (B * B)) in *.
    split; nra. }
  assert (T2 : Rabs (u * v - P / B * (Qv / B)) <= as_number (size a) * as_number (unknown b)
               + as_number (unknown a) * (as_number (size b) + as_number (unknown b))).
  { replace (u * v - P / B * (Qv / B)) with (P / B * (v - Qv / B) + (u - P / B) * v) by ring.
    eapply Rle_trans; [apply Rabs_triang|]. rewrite !Rabs_mult.
    apply Rplus_le_compat; apply Rmult_le_compat; try apply Rabs_pos; assumption. }
  pose proof (Rabs_triang (u * v - P / B * (Qv / B)) (P / B * (Qv / B) - rm / B)) as T3.
  replace (u * v - P / B * (Qv / B) + (P / B * (Qv / B) - rm / B)) with (u * v - rm / B) in T3 by ring. lra.
Qed.

Lemma holds_scale n d a u : 0 < r_ d -> holds a u -> holds (escale f n d a) (r_ n / r_ d * u).
Proof.
  intros Hd [[[p [Ep Lp]] Ua Sa _] Ha]. unfold escale, value in *. rewrite Ep in *. cbn [hd map] in *.
  set (errors := map (fun e => (- BigZ.div (- (BigZ.abs n * e)) d)%bigZ) (unknown a)).
  assert (Se : sized entries errors).
  { apply sized_map; [|assumption]. intros x Hx. apply (quotient_up_nonneg (BigZ.abs n * x)%bigZ d Hd). rewrite r_mul, r_abs.
    apply Rmult_le_pos; [apply Rabs_pos | assumption]. }
  assert (Ee : Rabs (r_ n / r_ d) * as_number (unknown a) <= as_number errors).
  { unfold as_number. assert (T : Rabs (r_ n) / r_ d * tot (unknown a) <= tot errors).
    { apply (tot_map (fun e => (- BigZ.div (- (BigZ.abs n * e)) d)%bigZ)). intros x.
      pose proof (quotient_up_above (BigZ.abs n * x)%bigZ d Hd) as Q. unfold quotient_up in Q. rewrite r_mul, r_abs in Q.
      unfold Rdiv in *. lra. }
    unfold Rdiv in *. rewrite Rabs_mult, (Rabs_pos_eq (/ r_ d)) by (left; apply Rinv_0_lt_compat; assumption).
    rewrite <- Rmult_assoc. apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat, two_to_pos | assumption]. }
  assert (T : Rabs (r_ n / r_ d * u - r_ n / r_ d * (eval p theta / two_to (bits f))) <= as_number errors).
  { rewrite <- Rmult_minus_distr_l, Rabs_mult. eapply Rle_trans; [|exact Ee]. apply Rmult_le_compat_l; [apply Rabs_pos | assumption]. }
  destruct (d =? 1)%bigZ eqn:E1.
  - apply BigZ.eqb_eq in E1. assert (D1 : r_ d = 1).
    { unfold r_. change (BigZ.eq d 1%bigZ) with (BigZ.to_Z d = BigZ.to_Z 1%bigZ) in E1. rewrite E1. reflexivity. }
    apply element_holds; [unfold pscale; rewrite map_length; assumption | assumption|].
    rewrite eval_pscale. rewrite D1 in *. replace (r_ n * eval p theta / two_to (bits f)) with (r_ n / 1 * (eval p theta / two_to (bits f)))
      by (field; pose proof (two_to_pos (bits f)); lra). exact T.
  - rewrite (plain_grades f f_plain). cbn [fold_right].
    destruct (as_number_raise (rounding f 0) errors Se rounding_nonneg) as [S2 E2].
    apply element_holds; [rewrite map_length; assumption | assumption|]. rewrite E2.
    assert (Q : Rabs (eval (map (fun c => BigZ.div (n * c) d) p) theta - r_ n / r_ d * eval p theta) <= INR (length p)).
    { apply rounded; [assumption|]. intros x. pose proof (r_div (n * x)%bigZ d Hd) as H. rewrite r_mul in H.
      replace (r_ n / r_ d * r_ x) with (r_ n * r_ x / r_ d) by (unfold Rdiv; ring). apply Rabs_le. lra. }
    pose proof rounding_above as RA. apply le_INR in Lp. pose proof (two_to_pos (bits f)) as Pb.
    set (rp := eval (map (fun c => BigZ.div (n * c) d) p) theta) in *. set (B := two_to (bits f)) in *.
    assert (Q2 : Rabs (r_ n / r_ d * (eval p theta / B) - rp / B) <= INR (kept f) / B).
    { replace (r_ n / r_ d * (eval p theta / B) - rp / B) with (- ((rp - r_ n / r_ d * eval p theta) / B)) by (field; lra).
      rewrite Rabs_Ropp. unfold Rdiv at 1. rewrite Rabs_mult, (Rabs_pos_eq (/ B)) by (left; apply Rinv_0_lt_compat; assumption).
      apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat; assumption | lra]. }
    apply Rabs_le_between in T. apply Rabs_le_between in Q2. apply Rabs_le. lra.
Qed.

Lemma holds_const n d : 0 < r_ d -> holds (econst f n d) (r_ n / r_ d).
Proof.
  intros Hd. unfold econst. rewrite (plain_grades f f_plain). cbn [map].
  set (c := BigZ.div (BigZ.shiftl n (bits f)) d). set (exact := (c * d =? BigZ.shiftl n (bits f))%bigZ).
  assert (Sh : r_ (BigZ.shiftl n (bits f)) = r_ n * two_to (bits f)).
  { destruct (r_shiftl n (bits f)) as [H|H]; [assumption|]. pose proof (plain_bits f f_plain). lia. }
  pose proof (r_div (BigZ.shiftl n (bits f)) d Hd) as D. fold c in D. rewrite Sh in D. pose proof (two_to_pos (bits f)) as Pb.
  assert (B0 : 0 <= r_ (if exact then 0%bigZ else bound f 1 (bits f))).
  { destruct exact; [rewrite r_0; lra | apply bound_nonneg; rewrite r_1; lra]. }
  destruct (as_number_raise _ (nothing f) nothing_entries B0) as [S E].
  apply element_holds; [cbn; apply (plain_kept f f_plain) | assumption|].
  rewrite E, as_number_nothing, Rplus_0_r. cbn [eval]. rewrite Rmult_0_r, Rplus_0_r.
  destruct exact eqn:X.
  - unfold exact in X. apply BigZ.eqb_eq in X. assert (Y : r_ (c * d)%bigZ = r_ (BigZ.shiftl n (bits f))).
    { unfold r_. f_equal. exact X. }
    rewrite r_mul, Sh in Y. replace (r_ n / r_ d - r_ c / two_to (bits f)) with 0; [rewrite Rabs_R0, r_0; unfold Rdiv; lra|].
    replace (r_ n) with (r_ c * r_ d / two_to (bits f)) by (rewrite Y; field; lra). field. lra.
  - eapply Rle_trans; [|apply bound_above]. rewrite r_1.
    replace (r_ n / r_ d - r_ c / two_to (bits f)) with ((r_ n * two_to (bits f) / r_ d - r_ c) / two_to (bits f)) by (field; lra).
    unfold Rdiv at 1. rewrite Rabs_mult, (Rabs_pos_eq (/ two_to _)) by (left; apply Rinv_0_lt_compat; assumption).
    apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat; assumption|]. apply Rabs_le. lra.
Qed.
End Values.
