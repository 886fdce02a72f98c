(* What is proved here of Intervals.v: sums, products, quotients of real numbers lie in those of intervals that contain them. *)

From Coq Require Import List ZArith Reals Lra Lia.
From Bignums Require Import BigZ.
From Orbitproof Require Import Polynomials Intervals Jets Sound.
Import ListNotations.
Local Open Scope R_scope.
Local Open Scope list_scope.

Section Sound.
Variable prec : bigZ.
Hypothesis prec_nonneg : (0 <= BigZ.to_Z prec)%Z.

Let P : R := two_to prec.
Lemma P_pos : 0 < P.
Proof. apply two_to_pos. Qed.

(* An interval contains a number; None contains all. *)
Definition contains (a : interval) (x : R) : Prop :=
  match a with
  | Some (l, h) => r_ l <= x * P <= r_ h
  | None => True
  end.

Theorem iadd_sound a b x y : contains a x -> contains b y -> contains (iadd a b) (x + y).
Proof. destruct a as [[al ah]|], b as [[bl bh]|]; cbn; try tauto. rewrite !r_add. lra. Qed.
Theorem iopp_sound a x : contains a x -> contains (iopp a) (- x).
Proof. destruct a as [[al ah]|]; cbn; try tauto. rewrite !r_opp. lra. Qed.
Theorem isub_sound a b x y : contains a x -> contains b y -> contains (isub a b) (x - y).
Proof. intros. apply iadd_sound; [assumption|]. apply iopp_sound. assumption. Qed.

Lemma r_min a b : r_ (BigZ.min a b) = Rmin (r_ a) (r_ b).
Proof.
  unfold r_. rewrite BigZ.spec_min. destruct (Z.le_ge_cases (BigZ.to_Z a) (BigZ.to_Z b)) as [H|H].
  - rewrite Z.min_l by assumption. rewrite Rmin_left; [reflexivity | apply IZR_le; assumption].
  - rewrite Z.min_r by assumption. rewrite Rmin_right; [reflexivity | apply IZR_le; assumption].
Qed.
Lemma r_max a b : r_ (BigZ.max a b) = Rmax (r_ a) (r_ b).
Proof.
  unfold r_. rewrite BigZ.spec_max. destruct (Z.le_ge_cases (BigZ.to_Z a) (BigZ.to_Z b)) as [H|H].
  - rewrite Z.max_r by assumption. rewrite Rmax_right; [reflexivity | apply IZR_le; assumption].
  - rewrite Z.max_l by assumption. rewrite Rmax_left; [reflexivity | apply IZR_le; assumption].
Qed.

(* A bilinear function on a rectangle lies between its values at the corners. *)
Lemma between_ends u l h c : l <= u <= h -> Rmin (l * c) (h * c) <= u * c <= Rmax (l * c) (h * c).
Proof.
  intros H. unfold Rmin, Rmax.
  destruct (Rle_dec (l * c) (h * c)); destruct (Rle_dec 0 c) as [C|C]; try (split; nra).
Qed.
Lemma between_corners u v al ah bl bh : al <= u <= ah -> bl <= v <= bh ->
  Rmin (Rmin (al * bl) (al * bh)) (Rmin (ah * bl) (ah * bh)) <= u * v
  <= Rmax (Rmax (al * bl) (al * bh)) (Rmax (ah * bl) (ah * bh)).
Proof.
  intros Hu Hv. pose proof (between_ends u al ah v Hu) as [A B].
  pose proof (between_ends v bl bh al Hv) as [A1 B1]. pose proof (between_ends v bl bh ah Hv) as [A2 B2].
  rewrite !(Rmult_comm _ al) in A1, B1. rewrite !(Rmult_comm _ ah) in A2, B2.
  split.
  - eapply Rle_trans; [|exact A]. apply Rmin_glb.
    + eapply Rle_trans; [apply Rmin_l|]. assumption.
    + eapply Rle_trans; [apply Rmin_r|]. assumption.
  - eapply Rle_trans; [exact B|]. apply Rmax_lub.
    + eapply Rle_trans; [|apply Rmax_l]. assumption.
    + eapply Rle_trans; [|apply Rmax_r]. assumption.
Qed.

Lemma div_P_le a b : a <= b -> a / P <= b / P.
Proof. intros H. pose proof P_pos. unfold Rdiv. apply Rmult_le_compat_r; [|assumption]. left. apply Rinv_0_lt_compat. assumption. Qed.

Theorem imul_sound a b x y : contains a x -> contains b y -> contains (imul prec a b) (x * y).
Proof.
  destruct a as [[al ah]|], b as [[bl bh]|]; cbn; try tauto. intros Hx Hy.
  pose proof (between_corners _ _ _ _ _ _ Hx Hy) as [A B].
  pose proof P_pos as Pp.
  assert (E : x * y * P = x * P * (y * P) / P) by (field; lra).
  rewrite E. unfold min4, max4.
  pose proof (down_is_below (BigZ.min (BigZ.min (al * bl) (al * bh)) (BigZ.min (ah * bl) (ah * bh)))%bigZ prec) as [D _].
  pose proof (up_is_above (BigZ.max (BigZ.max (al * bl) (al * bh)) (BigZ.max (ah * bl) (ah * bh)))%bigZ prec) as [_ U].
  rewrite !r_min, !r_mul in D. rewrite !r_max, !r_mul in U. fold P in D, U.
  split.
  - eapply Rle_trans; [exact D|]. apply div_P_le. assumption.
  - eapply Rle_trans; [|exact U]. apply div_P_le. assumption.
Qed.

Lemma r_div_floor x y : (0 < BigZ.to_Z y)%Z -> r_ (BigZ.div x y) <= r_ x / r_ y.
Proof.
  intros Hy. unfold r_. rewrite BigZ.spec_div.
  assert (0 < IZR (BigZ.to_Z y)) by (apply IZR_lt; assumption).
  pose proof (Z.mul_div_le (BigZ.to_Z x) _ Hy) as H1. apply IZR_le in H1. rewrite mult_IZR in H1.
  apply (Rmult_le_reg_l (IZR (BigZ.to_Z y))); [assumption|].
  replace (IZR (BigZ.to_Z y) * (IZR (BigZ.to_Z x) / IZR (BigZ.to_Z y))) with (IZR (BigZ.to_Z x)) by (field; lra). assumption.
Qed.
Lemma r_div_floor_neg x y : (BigZ.to_Z y < 0)%Z -> r_ (BigZ.div x y) <= r_ x / r_ y.
Proof.
  intros Hy. unfold r_. rewrite BigZ.spec_div.
  rewrite <- (Z.div_opp_opp _ (BigZ.to_Z y)) by lia.
  assert (0 < IZR (- BigZ.to_Z y)) by (apply IZR_lt; lia).
  assert (Hp : (0 < - BigZ.to_Z y)%Z) by lia.
  pose proof (Z.mul_div_le (- BigZ.to_Z x) _ Hp) as H1. apply IZR_le in H1. rewrite mult_IZR in H1.
  rewrite !opp_IZR in *.
  apply (Rmult_le_reg_l (- IZR (BigZ.to_Z y))); [assumption|].
  replace (- IZR (BigZ.to_Z y) * (IZR (BigZ.to_Z x) / IZR (BigZ.to_Z y))) with (- IZR (BigZ.to_Z x)) by (field; lra). assumption.
Qed.
Lemma r_div_below x y : (BigZ.to_Z y <> 0)%Z -> r_ (BigZ.div x y) <= r_ x / r_ y <= r_ (- BigZ.div (- x) y)%bigZ.
Proof.
  intros Hy.
  assert (F : forall z, r_ (BigZ.div z y) <= r_ z / r_ y).
  { intros z. destruct (Z.lt_trichotomy (BigZ.to_Z y) 0) as [H|[H|H]];
      [apply r_div_floor_neg | contradiction | apply r_div_floor]; assumption. }
  split; [apply F|]. rewrite r_opp. specialize (F (- x)%bigZ). rewrite r_opp in F.
  unfold Rdiv in *. rewrite Ropp_mult_distr_l_reverse in F. lra.
Qed.
Lemma r_shift x : r_ (BigZ.shiftl x prec) = r_ x * P.
Proof. destruct (r_shiftl x prec) as [E|E]; [exact E|lia]. Qed.

Theorem inumber_sound a b : contains (inumber prec a b) (r_ a / r_ b).
Proof.
  unfold inumber. rewrite BigZ.spec_ltb. destruct (Z.ltb_spec (BigZ.to_Z 0%bigZ) (BigZ.to_Z b)) as [H|H]; [|exact I].
  cbn. change (BigZ.to_Z 0%bigZ) with 0%Z in H.
  pose proof (r_div_below (BigZ.shiftl a prec) b) as D. rewrite r_shift in D.
  assert (r_ a / r_ b * P = r_ a * P / r_ b) as ->; [|apply D; lia].
  assert (0 < r_ b) by (apply (IZR_lt 0); assumption). field. lra.
Qed.

Theorem iscale_sound a b x y : contains x y -> contains (iscale a b x) (r_ a / r_ b * y).
Proof.
  destruct x as [[l h]|]; cbn; [|tauto]. intros H. rewrite BigZ.spec_ltb.
  destruct (Z.ltb_spec (BigZ.to_Z 0%bigZ) (BigZ.to_Z b)) as [Hb|Hb]; [|exact I]. change (BigZ.to_Z 0%bigZ) with 0%Z in Hb.
  cbn. assert (0 < r_ b) by (apply (IZR_lt 0); assumption).
  pose proof (between_ends (y * P) (r_ l) (r_ h) (r_ a) H) as [A B].
  pose proof (r_div_below (BigZ.min (a * l) (a * h))%bigZ b) as [D _]; [lia|].
  pose proof (r_div_below (BigZ.max (a * l) (a * h))%bigZ b) as [_ U]; [lia|].
  rewrite r_min, !r_mul in D. rewrite r_max, !r_mul in U.
  rewrite !(Rmult_comm _ (r_ a)) in A, B.
  replace (r_ a / r_ b * y * P) with (r_ a * (y * P) / r_ b) by (field; lra).
  assert (Q : forall u v, u <= v -> u / r_ b <= v / r_ b)
    by (intros u v Huv; unfold Rdiv; apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat; assumption | assumption]).
  split.
  - eapply Rle_trans; [exact D|]. apply Q. assumption.
  - eapply Rle_trans; [|exact U]. apply Q. assumption.
Qed.

Theorem meet_sound a b x : contains a x -> contains b x -> contains (meet a b) x.
Proof.
  destruct a as [[al ah]|], b as [[bl bh]|]; cbn; try tauto. intros A B.
  destruct (BigZ.max al bl <=? BigZ.min ah bh)%bigZ; [|exact I]. cbn. rewrite r_max, r_min.
  split; [apply Rmax_lub | apply Rmin_glb]; lra.
Qed.
Theorem from_zero_sound a x t : contains a x -> 0 <= t <= 1 -> contains (from_zero a) (t * x).
Proof.
  destruct a as [[l h]|]; cbn; try tauto. intros A T. rewrite r_min, r_max, r_0.
  assert (t * x * P = t * (x * P)) as -> by ring.
  split.
  - destruct (Rle_dec 0 (x * P)); [eapply Rle_trans; [apply Rmin_l|]; nra | eapply Rle_trans; [apply Rmin_r|]; nra].
  - destruct (Rle_dec 0 (x * P)); [eapply Rle_trans; [|apply Rmax_r]; nra | eapply Rle_trans; [|apply Rmax_l]; nra].
Qed.

Theorem positive_sound a x : positive a = true -> contains a x -> 0 < x.
Proof.
  destruct a as [[l h]|]; cbn; [|discriminate]. intros H A. apply r_ltb in H. rewrite r_0 in H. pose proof P_pos. nra.
Qed.
Theorem negative_sound a x : negative a = true -> contains a x -> x < 0.
Proof.
  destruct a as [[l h]|]; cbn; [|discriminate]. intros H A. apply r_ltb in H. rewrite r_0 in H. pose proof P_pos. nra.
Qed.
Theorem nonzero_sound a x : nonzero a = true -> contains a x -> x <> 0.
Proof.
  intros H A. apply Bool.orb_prop in H. destruct H as [H|H].
  - apply (positive_sound _ x) in H; [lra|assumption].
  - apply (negative_sound _ x) in H; [lra|assumption].
Qed.
Theorem inside_sound a x over under : inside prec a over under = true -> contains a x ->
  - (r_ over / r_ under) < x < r_ over / r_ under.
Proof.
  destruct a as [[l h]|]; cbn; [|discriminate]. intros H A.
  apply Bool.andb_true_iff in H as [H _]. apply Bool.andb_true_iff in H as [H U]. apply Bool.andb_true_iff in H as [H1 H2].
  apply r_ltb in H1, H2, U. rewrite r_0 in U. rewrite r_shift, r_mul in H1, H2. rewrite r_opp in H2.
  pose proof P_pos as Pp.
  assert (E : r_ over / r_ under * (r_ under * P) = r_ over * P) by (field; lra).
  split.
  - apply (Rmult_lt_reg_r (r_ under * P)); [nra|]. rewrite Ropp_mult_distr_l_reverse, E. nra.
  - apply (Rmult_lt_reg_r (r_ under * P)); [nra|]. rewrite E. nra.
Qed.

Lemma inverse_between u v l h : 0 < l \/ h < 0 -> l <= v <= h ->
  Rmin (u / l) (u / h) <= u / v <= Rmax (u / l) (u / h).
Proof.
  intros S H.
  assert (K : / h <= / v <= / l).
  { destruct S as [S|S].
    - split; apply Rinv_le_contravar; lra.
    - split.
      + apply Ropp_le_cancel. rewrite <- !Rinv_opp. apply Rinv_le_contravar; lra.
      + apply Ropp_le_cancel. rewrite <- !Rinv_opp. apply Rinv_le_contravar; lra. }
  unfold Rdiv. unfold Rmin, Rmax.
  destruct (Rle_dec (u * / l) (u * / h)); destruct (Rle_dec 0 u); try (split; nra).
Qed.

Theorem idiv_sound a b x y : contains a x -> contains b y -> contains (idiv prec a b) (x / y).
Proof.
  destruct a as [[al ah]|], b as [[bl bh]|]; cbn; try tauto. intros Hx Hy.
  destruct (orb (0 <? bl)%bigZ (bh <? 0)%bigZ) eqn:S; [|exact I]. cbn.
  pose proof P_pos as Pp.
  assert (S' : 0 < r_ bl \/ r_ bh < 0).
  { apply Bool.orb_prop in S. destruct S as [S|S]; apply r_ltb in S; rewrite r_0 in S; [left|right]; assumption. }
  assert (Nz : y <> 0) by (intros ->; rewrite Rmult_0_l in Hy; lra).
  assert (Zl : (BigZ.to_Z bl <> 0)%Z).
  { intros Z0. assert (r_ bl = 0) by (unfold r_; rewrite Z0; reflexivity).
    assert (r_ bl <= r_ bh) by lra. lra. }
  assert (Zh : (BigZ.to_Z bh <> 0)%Z).
  { intros Z0. assert (r_ bh = 0) by (unfold r_; rewrite Z0; reflexivity).
    assert (r_ bl <= r_ bh) by lra. lra. }
  assert (E : x / y * P = x * P * P / (y * P)) by (field; split; [lra | assumption]).
  rewrite E.
  pose proof (inverse_between (x * P * P) (y * P) (r_ bl) (r_ bh) S' Hy) as [A B].
  assert (Nl : r_ bl <> 0) by (destruct S'; lra). assert (Nh : r_ bh <> 0) by (destruct S'; lra).
  assert (C : forall v, v <> 0 -> Rmin (r_ al * P / v) (r_ ah * P / v) <= x * P * P / v
                        <= Rmax (r_ al * P / v) (r_ ah * P / v)).
  { intros v Hv. pose proof (between_ends (x * P) (r_ al) (r_ ah) (P / v) Hx) as K.
    unfold Rdiv in *. rewrite !Rmult_assoc in *. exact K. }
  pose proof (C _ Nl) as [Cl1 Cl2]. pose proof (C _ Nh) as [Ch1 Ch2].
  unfold min4, max4. rewrite !r_min, !r_max.
  pose proof (r_div_below (BigZ.shiftl al prec) bl Zl) as [D1 U1]. pose proof (r_div_below (BigZ.shiftl al prec) bh Zh) as [D2 U2].
  pose proof (r_div_below (BigZ.shiftl ah prec) bl Zl) as [D3 U3]. pose proof (r_div_below (BigZ.shiftl ah prec) bh Zh) as [D4 U4].
  rewrite r_shift in D1, D2, D3, D4, U1, U2, U3, U4.
  split.
  - eapply Rle_trans; [|exact A]. apply Rmin_glb.
    + eapply Rle_trans; [|exact Cl1]. apply Rmin_glb.
      * eapply Rle_trans; [apply Rmin_l|]. eapply Rle_trans; [apply Rmin_l|]. assumption.
      * eapply Rle_trans; [apply Rmin_r|]. eapply Rle_trans; [apply Rmin_l|]. assumption.
    + eapply Rle_trans; [|exact Ch1]. apply Rmin_glb.
      * eapply Rle_trans; [apply Rmin_l|]. eapply Rle_trans; [apply Rmin_r|]. assumption.
      * eapply Rle_trans; [apply Rmin_r|]. eapply Rle_trans; [apply Rmin_r|]. assumption.
  - eapply Rle_trans; [exact B|]. apply Rmax_lub.
    + eapply Rle_trans; [exact Cl2|]. apply Rmax_lub.
      * eapply Rle_trans; [|apply Rmax_l]. eapply Rle_trans; [|apply Rmax_l]. assumption.
      * eapply Rle_trans; [|apply Rmax_r]. eapply Rle_trans; [|apply Rmax_l]. assumption.
    + eapply Rle_trans; [exact Ch2|]. apply Rmax_lub.
      * eapply Rle_trans; [|apply Rmax_l]. eapply Rle_trans; [|apply Rmax_r]. assumption.
      * eapply Rle_trans; [|apply Rmax_r]. eapply Rle_trans; [|apply Rmax_r]. assumption.
Qed.

(* Matrices of one or two rows: all of an interval matrix are regular, and solutions lie in what solve finds. *)
Definition contains2 (m : matrix2) (x : R * R * R * R) : Prop :=
  let '(a, b, c, d) := m in let '(a', b', c', d') := x in contains a a' /\ contains b b' /\ contains c c' /\ contains d d'.
Definition times2 (x y : R * R * R * R) : R * R * R * R :=
  let '(a, b, c, d) := x in let '(a', b', c', d') := y in
  (a * a' + b * c', a * b' + b * d', c * a' + d * c', c * b' + d * d').

Lemma mul2_sound m n x y : contains2 m x -> contains2 n y -> contains2 (mul2 prec m n) (times2 x y).
Proof.
  destruct m as [[[a b] c] d], n as [[[e f] g] h], x as [[[a' b'] c'] d'], y as [[[e' f'] g'] h']. cbn.
  intros (A & B & C & D) (E & F & G & H).
  repeat split; apply iadd_sound; apply imul_sound; assumption.
Qed.
Lemma det2_sound m a b c d : contains2 m (a, b, c, d) -> contains (det2 prec m) (a * d - b * c).
Proof.
  destruct m as [[[a' b'] c'] d']. cbn. intros (A & B & C & D). apply isub_sound; apply imul_sound; assumption.
Qed.

(* Every interval that is a result of `middle` holds a number. *)
Lemma about_inverse_sound m : exists x, contains2 (about_inverse prec m) x.
Proof.
  destruct m as [[[a b] c] d]. unfold about_inverse. cbv zeta.
  assert (K : forall i, exists x, contains (middle i) x).
  { intros [[l h]|]; cbn; [|exists 0; exact I]. exists (r_ (down (l + h) 1) / P). pose proof P_pos.
    replace (r_ (down (l + h) 1) / P * P) with (r_ (down (l + h) 1)) by (field; lra). lra. }
  assert (L : forall i j k l, exists x, contains2 (middle i, middle j, middle k, middle l) x).
  { intros i j k l. destruct (K i) as [p Hp], (K j) as [q Hq], (K k) as [r Hr], (K l) as [s Hs].
    exists (p, q, r, s). cbn. auto. }
  apply L.
Qed.

Theorem regular_sound_1 i x : regular prec [[i]] = true -> contains i x -> x <> 0.
Proof. cbn. apply nonzero_sound. Qed.
Theorem regular_sound_2 i11 i12 i21 i22 a b c d : regular prec [[i11; i12]; [i21; i22]] = true ->
  contains2 (i11, i12, i21, i22) (a, b, c, d) -> a * d - b * c <> 0.
Proof.
  cbn [regular]. intros H M. set (m := (i11, i12, i21, i22)) in *.
  destruct (about_inverse_sound m) as [[[[p q] r] s] Hx].
  pose proof (mul2_sound _ _ _ _ Hx M) as Hp. cbn [times2] in Hp.
  pose proof (det2_sound _ _ _ _ _ Hp) as D. apply (nonzero_sound _ _ H) in D. intros E. apply D.
  replace ((p * a + q * c) * (r * b + s * d) - (p * b + q * d) * (r * a + s * c))
    with ((p * s - q * r) * (a * d - b * c)) by ring. rewrite E. ring.
Qed.

Theorem solve_sound_2 i11 i12 i21 i22 j1 j2 a b c d y1 y2 x1 x2 : 
  contains2 (i11, i12, i21, i22) (a, b, c, d) -> contains j1 y1 -> contains j2 y2 ->
  a * x1 + b * x2 = y1 -> c * x1 + d * x2 = y2 ->
  match solve prec [[i11; i12]; [i21; i22]] [j1; j2] with
  | [k1; k2] => contains k1 x1 /\ contains k2 x2
  | _ => False
  end.
Proof.
  intros M H1 H2 E1 E2. cbn [solve]. set (m := (i11, i12, i21, i22)) in *.
  destruct (about_inverse_sound m) as [[[[p q] r] s] Hx].
  destruct (about_inverse prec m) as [[[n11 n12] n21] n22] eqn:N.
  pose proof (mul2_sound _ _ _ _ Hx M) as Hp. cbn in Hp, Hx.
  destruct Hx as (X1 & X2 & X3 & X4). destruct Hp as (P1 & P2 & P3 & P4).
  assert (D : contains (det2 prec (mul2 prec (n11, n12, n21, n22) m))
                ((p * a + q * c) * (r * b + s * d) - (p * b + q * d) * (r * a + s * c)))
    by (apply det2_sound; cbn; auto).
  cbn in D |- *.
  assert (Z1 : contains (iadd (imul prec n11 j1) (imul prec n12 j2)) (p * y1 + q * y2))
    by (apply iadd_sound; apply imul_sound; assumption).
  assert (Z2 : contains (iadd (imul prec n21 j1) (imul prec n22 j2)) (r * y1 + s * y2))
    by (apply iadd_sound; apply imul_sound; assumption).
  assert (Q : forall i u v w, contains i u -> contains
    (isub (imul prec (iadd (imul prec n11 i11) (imul prec n12 i21)) (iadd (imul prec n21 i12) (imul prec n22 i22)))
          (imul prec (iadd (imul prec n11 i12) (imul prec n12 i22)) (iadd (imul prec n21 i11) (imul prec n22 i21)))) w ->
    u = w * v -> contains (idiv prec i
    (isub (imul prec (iadd (imul prec n11 i11) (imul prec n12 i21)) (iadd (imul prec n21 i12) (imul prec n22 i22)))
          (imul prec (iadd (imul prec n11 i12) (imul prec n12 i22)) (iadd (imul prec n21 i11) (imul prec n22 i21))))) v).
  { intros i u v w Hi Hw Huv. destruct (Req_dec w 0) as [W|W].
    - rewrite W in Hw. destruct i as [[l h]|]; [|exact I].
      destruct (isub _ _) as [[l' h']|] eqn:S; [|exact I]. cbn in Hw |- *.
      destruct (orb (0 <? l')%bigZ (h' <? 0)%bigZ) eqn:O; [|exact I].
      exfalso. apply Bool.orb_prop in O. destruct O as [O|O]; apply r_ltb in O; rewrite r_0 in O; rewrite Rmult_0_l in Hw; lra.
    - replace v with (u / w) by (rewrite Huv; field; assumption). apply idiv_sound; assumption. }
  split.
  - eapply Q; [apply isub_sound; apply imul_sound; [exact P4 | exact Z1 | exact P2 | exact Z2] | exact D |].
    rewrite <- E1, <- E2. ring.
  - eapply Q; [apply isub_sound; apply imul_sound; [exact P1 | exact Z2 | exact P3 | exact Z1] | exact D |].
    rewrite <- E1, <- E2. ring.
Qed.
End Sound.
