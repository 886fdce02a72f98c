(* Two curves of zeros that cross at one point, from bounds of derivatives: sections 8.1 to 8.5 and 9.2 of the chapter
   verify/bifurcation, for one unknown e and one parameter b. Nothing is used but mean and intermediate values. *)

From Coq Require Import Reals Lra Lia Ranalysis5.
From Coquelicot Require Import Coquelicot.
From Solutions Require Import Existence.
Local Open Scope R_scope.

Lemma mean_value f df x y : x < y -> (forall u, x <= u <= y -> is_derive f u (df u)) ->
  exists u, x < u < y /\ f y - f x = df u * (y - x).
Proof.
  intros H D. destruct (MVT_cor2 f df x y H) as [u [E Hu]]; [intros v Hv; apply is_derive_Reals, D; assumption|]. exists u. auto.
Qed.
Lemma mean_value_around f df l h x y : (forall u, l <= u <= h -> is_derive f u (df u)) -> l <= x <= h -> l <= y <= h ->
  exists u, l <= u <= h /\ f y - f x = df u * (y - x).
Proof.
  intros D Hx Hy. destruct (Rtotal_order x y) as [H|[->|H]].
  - destruct (mean_value f df x y H) as [u [Hu E]]; [intros; apply D; lra|]. exists u. split; [lra | exact E].
  - exists y. split; [assumption | ring].
  - destruct (mean_value f df y x H) as [u [Hu E]]; [intros; apply D; lra|]. exists u. split; lra.
Qed.

(* The zero of an increasing function on [x, y]. *)
Definition root (f : R -> R) (x y : R) : R := real (Lub_Rbar (fun e => x <= e <= y /\ f e <= 0)).
Lemma root_is f x y a : x <= a <= y -> f a = 0 -> (forall e, a < e <= y -> 0 < f e) -> root f x y = a.
Proof.
  intros Ha Fa P. unfold root. rewrite (is_lub_Rbar_unique _ (Finite a)); [reflexivity|]. split.
  - intros e [He Fe]. cbn. destruct (Rle_lt_dec e a) as [|L]; [assumption|]. specialize (P e ltac:(lra)). lra.
  - intros u Hu. apply (Hu a). split; [assumption | lra].
Qed.
Lemma steep_root f x y c C : x < y -> 0 < c -> (forall u v, x <= u -> u <= v -> v <= y -> c * (v - u) <= f v - f u <= C * (v - u)) ->
  f x < 0 -> 0 < f y -> x < root f x y < y /\ forall e, x <= e <= y -> (f e = 0 <-> e = root f x y).
Proof.
  intros Hxy Hc S Fx Fy. set (g := fun e => f (clamp x y e)).
  assert (G : forall e, x <= e <= y -> g e = f e) by (intros e He; unfold g; rewrite clamp_id by assumption; reflexivity).
  assert (I : forall u v, x <= u -> u < v -> v <= y -> f u < f v) by (intros u v Hu Huv Hv; specialize (S u v Hu ltac:(lra) Hv); nra).
  destruct (IVT_interv g x y) as [a [Ha Ga]]; try assumption; [| rewrite G; lra | rewrite G; lra |].
  - intros e _. apply continuity_pt_filterlim, (lipschitz_continuous g C e). intros u. unfold g.
    assert (HC : 0 <= C) by (specialize (S x y); nra).
    apply Rle_trans with (C * Rabs (clamp x y u - clamp x y e)); [|apply Rmult_le_compat_l; [assumption | apply clamp_lipschitz]].
    pose proof (clamp_in x y u ltac:(lra)) as Ku. pose proof (clamp_in x y e ltac:(lra)) as Ke.
    set (p := clamp x y u) in *. set (q := clamp x y e) in *. destruct (Rle_lt_dec p q) as [L|L].
    + specialize (S p q ltac:(lra) L ltac:(lra)). rewrite (Rabs_left1 (p - q)) by lra. apply Rabs_le. nra.
    + specialize (S q p ltac:(lra) ltac:(lra) ltac:(lra)). rewrite (Rabs_pos_eq (p - q)) by lra. apply Rabs_le. nra.
  - rewrite G in Ga by assumption. rewrite (root_is f x y a Ha Ga) by (intros e He; rewrite <- Ga; apply I; lra).
    assert (x <> a) by (intros <-; lra). assert (a <> y) by (intros ->; lra). split; [lra|]. intros e He. split; [|intros ->; assumption].
    intros Fe. destruct (Rtotal_order e a) as [L|[E|L]]; [|assumption|]; [pose proof (I e a) | pose proof (I a e)]; lra.
Qed.

(* A function with a maximum between any two points has it where it has the same value at two points that are close by. *)
Section Peak.
Variables (f : R -> R) (l h p N K rho : R).
Hypothesis p_in : l < p < h.
Hypothesis peaks : forall x y z b, l <= x -> x < y -> y < z -> z <= h -> b <= f x -> b <= f z -> b < f y.
Hypothesis flat : forall x, l <= x <= h -> Rabs (f x - f p) <= K * Rabs (x - p).
Hypothesis rho_pos : 0 < rho.
Hypothesis N_nonneg : 0 <= N.
Hypothesis partner : forall x, Rabs (x - p) <= rho -> x <> p -> exists y, y <> x /\ Rabs (y - p) <= N * Rabs (x - p) /\ f y = f x.

Lemma peak_left x : l <= x < p -> f x < f p.
Proof.
  intros Hx. destruct (Rlt_le_dec (f x) (f p)) as [|Bad]; [assumption|]. exfalso.
  set (y := (x + p) / 2). assert (Hy : x < y < p) by (unfold y; lra). assert (Fy : f p < f y) by (apply (peaks x y p); lra).
  assert (HK : 0 <= K).
  { pose proof (flat l ltac:(lra)) as Q. pose proof (Rabs_pos (f l - f p)). assert (0 < Rabs (l - p)) by (apply Rabs_pos_lt; lra). nra. }
  set (d := Rmin rho (Rmin ((p - y) / (N + 2)) (Rmin ((h - p) / (N + 2)) ((f y - f p) / (K + 1) / 2)))).
  assert (Hd : 0 < d).
  { unfold d. repeat apply Rmin_pos; try assumption; try (apply Rdiv_lt_0_compat; lra). apply Rdiv_lt_0_compat; [apply Rdiv_lt_0_compat; lra | lra]. }
  assert (D : d <= rho /\ d <= (p - y) / (N + 2) /\ d <= (h - p) / (N + 2) /\ d <= (f y - f p) / (K + 1) / 2).
  { unfold d. pose proof (Rmin_l rho (Rmin ((p - y) / (N + 2)) (Rmin ((h - p) / (N + 2)) ((f y - f p) / (K + 1) / 2)))).
    pose proof (Rmin_r rho (Rmin ((p - y) / (N + 2)) (Rmin ((h - p) / (N + 2)) ((f y - f p) / (K + 1) / 2)))).
    pose proof (Rmin_l ((p - y) / (N + 2)) (Rmin ((h - p) / (N + 2)) ((f y - f p) / (K + 1) / 2))).
    pose proof (Rmin_r ((p - y) / (N + 2)) (Rmin ((h - p) / (N + 2)) ((f y - f p) / (K + 1) / 2))).
    pose proof (Rmin_l ((h - p) / (N + 2)) ((f y - f p) / (K + 1) / 2)). pose proof (Rmin_r ((h - p) / (N + 2)) ((f y - f p) / (K + 1) / 2)).
    repeat split; lra. }
  destruct D as [D1 [D2 [D3 D4]]].
  assert (M : forall u k, 0 < k -> d <= u / k -> k * d <= u).
  { intros u k Hk Q. apply (Rmult_le_compat_l k) in Q; [|lra]. replace (k * (u / k)) with u in Q by (field; lra). exact Q. }
  apply M in D2; [|lra]. apply M in D3; [|lra].
  assert (D5 : (K + 1) * (2 * d) <= f y - f p) by (apply (M ((f y - f p) / (K + 1)) 2) in D4; [|lra]; apply (Rmult_le_compat_l (K + 1)) in D4; [|lra];
    replace ((K + 1) * ((f y - f p) / (K + 1))) with (f y - f p) in D4 by (field; lra); exact D4).
  clear D4. set (u := p - d). assert (Au : Rabs (u - p) = d) by (unfold u; rewrite Rabs_left1; lra).
  destruct (partner u ltac:(lra) ltac:(unfold u; lra)) as [w [Wu [Wp Wf]]]. rewrite Au in Wp. apply Rabs_le_between in Wp.
  assert (Nd : 0 <= N * d) by (apply Rmult_le_pos; lra).
  assert (Hu : y < u < p) by (unfold u; lra). assert (Hw : y < w <= h) by lra.
  pose proof (flat u ltac:(lra)) as Fu. rewrite Au in Fu. apply Rabs_le_between in Fu.
  assert (Fu' : f u < f y) by nra. assert (Up : f p < f u) by (apply (peaks x u p); lra).
  destruct (Rtotal_order w p) as [L|[E|L]].
  - destruct (Rtotal_order u w) as [L'|[E|L']]; [|congruence|].
    + pose proof (peaks y u w (f u) ltac:(lra) ltac:(lra) L' ltac:(lra) ltac:(lra) ltac:(lra)). lra.
    + pose proof (peaks y w u (f u) ltac:(lra) ltac:(lra) L' ltac:(lra) ltac:(lra) ltac:(lra)). lra.
  - rewrite E in Wf. lra.
  - pose proof (peaks x p w (f p) ltac:(lra) ltac:(lra) L ltac:(lra) ltac:(lra) ltac:(lra)). lra.
Qed.
End Peak.

Section Curves.
Variables bl bh el eh : R.
Hypothesis J_proper : bl < bh.
Hypothesis Y_proper : el < eh.
Definition in_J b := bl <= b <= bh.
Definition in_Y e := el <= e <= eh.

(* The zeros of F are a curve over b. *)
Variables F Fe Fb : R -> R -> R.
Hypothesis F_e : forall b e, in_J b -> in_Y e -> is_derive (fun e => F b e) e (Fe b e).
Hypothesis F_b : forall b e, in_J b -> in_Y e -> is_derive (fun b => F b e) b (Fb b e).
Variables k K A : R.
Hypothesis k_pos : 0 < k.
Hypothesis Fe_bounds : forall b e, in_J b -> in_Y e -> k <= Fe b e <= K.
Hypothesis Fb_bound : forall b e, in_J b -> in_Y e -> Rabs (Fb b e) <= A * k.
Hypothesis F_low : forall b, in_J b -> F b el < 0.
Hypothesis F_high : forall b, in_J b -> 0 < F b eh.

Definition family (b : R) : R := root (F b) el eh.
Lemma family_is b : in_J b -> el < family b < eh /\ forall e, in_Y e -> (F b e = 0 <-> e = family b).
Proof.
  intros Hb. apply (steep_root (F b) el eh k K); auto. intros u v Hu Huv Hv.
  destruct (mean_value_around (F b) (Fe b) el eh u v) as [w [Hw E]]; try lra; [intros; apply F_e; assumption|].
  rewrite E. specialize (Fe_bounds b w Hb Hw). split; apply Rmult_le_compat_r; lra.
Qed.
Lemma family_in b : in_J b -> in_Y (family b).
Proof. intros Hb. destruct (family_is b Hb) as [H _]. unfold in_Y. lra. Qed.
Lemma family_zero b : in_J b -> F b (family b) = 0.
Proof. intros Hb. apply (family_is b Hb); [apply family_in; assumption | reflexivity]. Qed.
Lemma A_nonneg : 0 <= A.
Proof.
  assert (Hb : in_J bl) by (unfold in_J; lra). assert (He : in_Y el) by (unfold in_Y; lra).
  pose proof (Fb_bound bl el Hb He). pose proof (Rabs_pos (Fb bl el)). nra.
Qed.
Lemma family_lipschitz b b' : in_J b -> in_J b' -> Rabs (family b' - family b) <= A * Rabs (b' - b).
Proof.
  intros Hb Hb'. pose proof (family_in b Hb) as Ha. pose proof (family_in b' Hb') as Ha'.
  destruct (mean_value_around (F b') (Fe b') el eh (family b) (family b')) as [w [Hw E]]; try assumption; [intros; apply F_e; assumption|].
  destruct (mean_value_around (fun b1 => F b1 (family b)) (fun b1 => Fb b1 (family b)) bl bh b b') as [v [Hv E']]; try assumption; [intros u Hu; exact (F_b u _ Hu Ha)|].
  rewrite family_zero in E by assumption. rewrite (family_zero b Hb) in E'.
  pose proof (Fe_bounds b' w Hb' Hw) as P. pose proof (Fb_bound v (family b) Hv Ha) as Q.
  assert (X : Rabs (Fe b' w * (family b' - family b)) = Rabs (Fb v (family b) * (b' - b))) by (rewrite <- Rabs_Ropp; f_equal; lra).
  rewrite !Rabs_mult, (Rabs_pos_eq (Fe b' w)) in X by lra.
  pose proof (Rabs_pos (family b' - family b)). pose proof (Rabs_pos (b' - b)). apply (Rmult_le_reg_l k); [assumption|]. nra.
Qed.

(* G vanishes on this curve; what else? *)
Variables G Ge Gee Gbe : R -> R -> R.
Hypothesis G_e : forall b e, in_J b -> in_Y e -> is_derive (fun e => G b e) e (Ge b e).
Hypothesis Ge_e : forall b e, in_J b -> in_Y e -> is_derive (fun e => Ge b e) e (Gee b e).
Hypothesis Ge_b : forall b e, in_J b -> in_Y e -> is_derive (fun b => Ge b e) b (Gbe b e).
Hypothesis G_vanishes : forall b e, in_J b -> in_Y e -> F b e = 0 -> G b e = 0.
Variables c C B : R.
Hypothesis Gbe_bounds : forall b e, in_J b -> in_Y e -> c <= Gbe b e <= C.
Hypothesis Gee_bound : forall b e, in_J b -> in_Y e -> Rabs (Gee b e) <= B.
Hypothesis transversal : A * B < c.
Hypothesis Ge_low : forall e, in_Y e -> Ge bl e < 0.
Hypothesis Ge_high : forall e, in_Y e -> 0 < Ge bh e.

(* The reduced function: G b e = (e - family b) * reduced b e. *)
Definition reduced (b e : R) : R := if Req_EM_T e (family b) then Ge b e else G b e / (e - family b).
Definition on_the_way (b e t : R) : R := family b + t * (e - family b).
Lemma on_the_way_in b e t : in_J b -> in_Y e -> 0 <= t <= 1 -> in_Y (on_the_way b e t).
Proof. intros Hb He Ht. pose proof (family_in b Hb). unfold on_the_way, in_Y in *. nra. Qed.
Lemma factor b e : in_J b -> in_Y e -> G b e = (e - family b) * reduced b e.
Proof.
  intros Hb He. unfold reduced. destruct Req_EM_T as [E|E]; [|field; lra]. rewrite E.
  rewrite (G_vanishes b (family b) Hb (family_in b Hb) (family_zero b Hb)). ring.
Qed.
(* It is the integral of Ge b (on_the_way b e t) over t in [0, 1]. *)
Lemma primitive_of b e : in_J b -> in_Y e -> exists p : R -> R, p 0 = 0 /\ p 1 = reduced b e /\
  forall t, 0 <= t <= 1 -> is_derive p t (Ge b (on_the_way b e t)).
Proof.
  intros Hb He. pose proof (family_in b Hb) as Ha. unfold reduced. destruct Req_EM_T as [E|E].
  - exists (fun t => t * Ge b e). split; [ring|]. split; [ring|]. intros t Ht.
    unfold on_the_way. rewrite <- E. replace (e + t * (e - e)) with e by ring. auto_derive; [exact I | ring].
  - exists (fun t => G b (on_the_way b e t) / (e - family b)). split; [|split].
    + unfold on_the_way. replace (family b + 0 * (e - family b)) with (family b) by ring.
      rewrite (G_vanishes b (family b) Hb Ha (family_zero b Hb)). field. lra.
    + unfold on_the_way. replace (family b + 1 * (e - family b)) with e by ring. reflexivity.
    + intros t Ht. pose proof (on_the_way_in b e t Hb He Ht) as Hw.
      replace (Ge b (on_the_way b e t)) with (/ (e - family b) * ((e - family b) * Ge b (on_the_way b e t))) by (field; lra).
      apply (is_derive_ext (fun t => / (e - family b) * G b (on_the_way b e t))); [intros; unfold Rdiv; apply Rmult_comm|].
      apply (is_derive_scal (fun t => G b (on_the_way b e t))).
      apply (is_derive_comp (V := R_NormedModule) (fun e => G b e) (on_the_way b e)); [apply G_e; assumption|].
      unfold on_the_way. auto_derive; [exact I | ring].
Qed.
Lemma reduced_is_a_value b e : in_J b -> in_Y e -> exists u, in_Y u /\ reduced b e = Ge b u.
Proof.
  intros Hb He. destruct (primitive_of b e Hb He) as [p [P0 [P1 D]]].
  destruct (mean_value p (fun t => Ge b (on_the_way b e t)) 0 1) as [t [Ht E]]; [lra | intros; apply D; lra|].
  exists (on_the_way b e t). split; [apply on_the_way_in; lra || assumption | lra].
Qed.
Lemma reduced_differs b e b' e' : in_J b -> in_Y e -> in_J b' -> in_Y e' -> exists t, 0 < t < 1 /\
  reduced b' e' - reduced b e = Ge b' (on_the_way b' e' t) - Ge b (on_the_way b e t).
Proof.
  intros Hb He Hb' He'. destruct (primitive_of b e Hb He) as [p [P0 [P1 D]]]. destruct (primitive_of b' e' Hb' He') as [q [Q0 [Q1 D']]].
  destruct (mean_value (fun t => q t - p t) (fun t => Ge b' (on_the_way b' e' t) - Ge b (on_the_way b e t)) 0 1) as [t [Ht E]]; [lra | |].
  - intros t Ht. apply (is_derive_minus (V := R_NormedModule) q p); auto.
  - exists t. split; [assumption | lra].
Qed.
Lemma Ge_differs b e b' e' : in_J b -> in_Y e -> in_J b' -> in_Y e' -> b <= b' ->
  c * (b' - b) - B * Rabs (e' - e) <= Ge b' e' - Ge b e <= C * (b' - b) + B * Rabs (e' - e).
Proof.
  intros Hb He Hb' He' L.
  destruct (mean_value_around (fun b => Ge b e') (fun b => Gbe b e') bl bh b b') as [v [Hv E]]; try assumption; [intros u Hu; exact (Ge_b u _ Hu He')|].
  destruct (mean_value_around (Ge b) (Gee b) el eh e e') as [w [Hw E']]; try assumption; [intros; apply Ge_e; assumption|].
  pose proof (Gbe_bounds v e' Hv He') as P. pose proof (Gee_bound b w Hb Hw) as Q.
  assert (X : Rabs (Gee b w * (e' - e)) <= B * Rabs (e' - e)) by (rewrite Rabs_mult; apply Rmult_le_compat_r; [apply Rabs_pos | assumption]).
  apply Rabs_le_between in X. cbv beta in E. split; nra.
Qed.
Lemma B_nonneg : 0 <= B.
Proof.
  assert (Hb : in_J bl) by (unfold in_J; lra). assert (He : in_Y el) by (unfold in_Y; lra).
  pose proof (Gee_bound bl el Hb He). pose proof (Rabs_pos (Gee bl el)). lra.
Qed.
Lemma reduced_rises b b' e : in_J b -> in_J b' -> in_Y e -> b <= b' ->
  (c - A * B) * (b' - b) <= reduced b' e - reduced b e <= (C + A * B) * (b' - b).
Proof.
  intros Hb Hb' He L. destruct (reduced_differs b e b' e Hb He Hb' He) as [t [Ht ->]].
  pose proof (Ge_differs b (on_the_way b e t) b' (on_the_way b' e t) Hb (on_the_way_in b e t Hb He ltac:(lra)) Hb'
    (on_the_way_in b' e t Hb' He ltac:(lra)) L) as D.
  assert (X : Rabs (on_the_way b' e t - on_the_way b e t) <= A * (b' - b)).
  { unfold on_the_way. replace (family b' + t * (e - family b') - (family b + t * (e - family b))) with ((1 - t) * (family b' - family b)) by ring.
    rewrite Rabs_mult, (Rabs_pos_eq (1 - t)) by lra. pose proof (family_lipschitz b b' Hb Hb') as Y. rewrite (Rabs_pos_eq (b' - b)) in Y by lra.
    pose proof (Rabs_pos (family b' - family b)). nra. }
  pose proof B_nonneg. pose proof (Rabs_pos (on_the_way b' e t - on_the_way b e t)).
  assert (B * Rabs (on_the_way b' e t - on_the_way b e t) <= B * (A * (b' - b))) by (apply Rmult_le_compat_l; assumption). split; lra.
Qed.
Lemma reduced_flat b e e' : in_J b -> in_Y e -> in_Y e' -> Rabs (reduced b e' - reduced b e) <= B * Rabs (e' - e).
Proof.
  intros Hb He He'. destruct (reduced_differs b e b e' Hb He Hb He') as [t [Ht ->]].
  pose proof (Ge_differs b (on_the_way b e t) b (on_the_way b e' t) Hb (on_the_way_in b e t Hb He ltac:(lra)) Hb
    (on_the_way_in b e' t Hb He' ltac:(lra)) ltac:(lra)) as D.
  assert (X : Rabs (on_the_way b e' t - on_the_way b e t) <= Rabs (e' - e)).
  { unfold on_the_way. replace (family b + t * (e' - family b) - (family b + t * (e - family b))) with (t * (e' - e)) by ring.
    rewrite Rabs_mult, (Rabs_pos_eq t) by lra. pose proof (Rabs_pos (e' - e)). nra. }
  pose proof B_nonneg. assert (B * Rabs (on_the_way b e' t - on_the_way b e t) <= B * Rabs (e' - e)) by (apply Rmult_le_compat_l; assumption).
  apply Rabs_le. lra.
Qed.

(* The second curve, over e. *)
Definition branch (e : R) : R := root (fun b => reduced b e) bl bh.
Lemma branch_is e : in_Y e -> bl < branch e < bh /\ forall b, in_J b -> (reduced b e = 0 <-> b = branch e).
Proof.
  intros He. apply (steep_root (fun b => reduced b e) bl bh (c - A * B) (C + A * B)); try assumption; try lra.
  - intros u v Hu Huv Hv. apply reduced_rises; unfold in_J; (assumption || lra).
  - destruct (reduced_is_a_value bl e) as [u [Hu ->]]; [unfold in_J; lra | assumption | auto].
  - destruct (reduced_is_a_value bh e) as [u [Hu ->]]; [unfold in_J; lra | assumption | auto].
Qed.
Lemma branch_in e : in_Y e -> in_J (branch e).
Proof. intros He. destruct (branch_is e He) as [H _]. unfold in_J. lra. Qed.
Lemma branch_zero e : in_Y e -> reduced (branch e) e = 0.
Proof. intros He. apply (branch_is e He); [apply branch_in; assumption | reflexivity]. Qed.
Lemma branch_lipschitz e e' : in_Y e -> in_Y e' -> Rabs (branch e' - branch e) <= B / (c - A * B) * Rabs (e' - e).
Proof.
  intros He He'. pose proof (reduced_flat (branch e') e e' (branch_in e' He') He He') as X. rewrite (branch_zero e' He') in X.
  pose proof (branch_zero e He) as Z. set (d := c - A * B) in *.
  assert (Y : d * Rabs (branch e' - branch e) <= Rabs (reduced (branch e') e)).
  { destruct (Rle_lt_dec (branch e) (branch e')) as [L|L].
    - pose proof (reduced_rises (branch e) (branch e') e (branch_in e He) (branch_in e' He') He L) as Q. fold d in Q.
      rewrite (Rabs_pos_eq (branch e' - branch e)) by lra. pose proof (Rle_abs (reduced (branch e') e)). lra.
    - pose proof (reduced_rises (branch e') (branch e) e (branch_in e' He') (branch_in e He) He ltac:(lra)) as Q. fold d in Q.
      rewrite (Rabs_left1 (branch e' - branch e)) by lra. rewrite <- Rabs_Ropp. pose proof (Rle_abs (- reduced (branch e') e)). lra. }
  rewrite Rminus_0_l, Rabs_Ropp in X. apply (Rmult_le_reg_l d); [unfold d; lra|].
  replace (d * (B / d * Rabs (e' - e))) with (B * Rabs (e' - e)) by (field; unfold d; lra). lra.
Qed.
Lemma zeros_are b e : in_J b -> in_Y e -> (G b e = 0 <-> e = family b \/ b = branch e).
Proof.
  intros Hb He. rewrite (factor b e Hb He). destruct (branch_is e He) as [_ H]. split.
  - intros Z. apply Rmult_integral in Z. destruct Z as [Z|Z]; [left; lra | right; apply H; assumption].
  - intros [->|Z]; [ring|]. apply H in Z; [rewrite Z; ring | assumption].
Qed.

Lemma over_the_branch b u : in_J b -> in_Y u ->
  (b <= branch u -> reduced b u <= 0) /\ (branch u <= b -> 0 <= reduced b u) /\ (reduced b u < 0 -> b < branch u) /\ (0 < reduced b u -> branch u < b).
Proof.
  intros Hb Hu. pose proof (branch_in u Hu) as Jb. pose proof (branch_zero u Hu) as Z.
  assert (Low : b <= branch u -> reduced b u <= 0).
  { intros L. pose proof (reduced_rises b (branch u) u Hb Jb Hu L). assert (0 <= (c - A * B) * (branch u - b)) by (apply Rmult_le_pos; lra). lra. }
  assert (High : branch u <= b -> 0 <= reduced b u).
  { intros L. pose proof (reduced_rises (branch u) b u Jb Hb Hu L). assert (0 <= (c - A * B) * (b - branch u)) by (apply Rmult_le_pos; lra). lra. }
  split; [exact Low|]. split; [exact High|]. split; intros N; apply Rnot_le_lt; intros L; [specialize (High L) | specialize (Low L)]; lra.
Qed.

(* They cross once. *)
Lemma crossing : exists b0, bl < b0 < bh /\ branch (family b0) = b0 /\
  forall b, in_J b -> branch (family b) = b -> b = b0.
Proof.
  set (g := fun b => Ge b (family b)).
  assert (R0 : forall b, in_J b -> reduced b (family b) = g b).
  { intros b Hb. unfold reduced. destruct Req_EM_T; [reflexivity | congruence]. }
  destruct (steep_root g bl bh (c - A * B) (C + A * B)) as [H1 H2]; try assumption; try lra.
  - intros u v Hu Huv Hv. assert (Ju : in_J u) by (unfold in_J; lra). assert (Jv : in_J v) by (unfold in_J; lra).
    pose proof (Ge_differs u (family u) v (family v) Ju (family_in u Ju) Jv (family_in v Jv) Huv) as D.
    pose proof (family_lipschitz u v Ju Jv) as X. rewrite (Rabs_pos_eq (v - u)) in X by lra. pose proof B_nonneg.
    assert (B * Rabs (family v - family u) <= B * (A * (v - u))) by (apply Rmult_le_compat_l; assumption). unfold g. split; lra.
  - apply Ge_low, family_in. unfold in_J. lra.
  - apply Ge_high, family_in. unfold in_J. lra.
  - exists (root g bl bh). assert (J0 : in_J (root g bl bh)) by (unfold in_J; lra). split; [assumption|]. split.
    + symmetry. apply (branch_is _ (family_in _ J0)); [assumption|]. rewrite (R0 _ J0). apply (H2 _ J0). reflexivity.
    + intros b Hb E. apply (H2 b Hb). rewrite <- (R0 b Hb). apply (branch_is _ (family_in b Hb)); [assumption | congruence].
Qed.

(* Over J and Y the zeros of F are the curve e = family b, those of G this curve and b = branch e; the two cross at one point. *)
Definition cross (over_b over_e : R -> R) (b0 e0 : R) : Prop :=
  (forall b, in_J b -> el < over_b b < eh) /\ (forall e, in_Y e -> bl < over_e e < bh) /\
  (forall b b', in_J b -> in_J b' -> Rabs (over_b b' - over_b b) <= A * Rabs (b' - b)) /\
  (forall e e', in_Y e -> in_Y e' -> Rabs (over_e e' - over_e e) <= B / (c - A * B) * Rabs (e' - e)) /\
  (forall b e, in_J b -> in_Y e -> (F b e = 0 <-> e = over_b b)) /\
  (forall b e, in_J b -> in_Y e -> (G b e = 0 <-> e = over_b b \/ b = over_e e)) /\
  bl < b0 < bh /\ el < e0 < eh /\ over_b b0 = e0 /\ over_e e0 = b0 /\
  (forall b e, in_J b -> in_Y e -> e = over_b b -> b = over_e e -> b = b0 /\ e = e0).
Theorem two_curves_cross : exists b0, cross family branch b0 (family b0).
Proof.
  destruct crossing as [b0 [H0 [E0 U]]]. assert (J0 : in_J b0) by (unfold in_J; lra). exists b0.
  split; [intros b Hb; apply (family_is b Hb)|]. split; [intros e He; apply (branch_is e He)|].
  split; [intros; apply family_lipschitz; assumption|]. split; [intros; apply branch_lipschitz; assumption|].
  split; [intros b e Hb; apply (family_is b Hb)|]. split; [exact zeros_are|]. split; [assumption|].
  split; [apply (family_is b0 J0)|]. split; [reflexivity|]. split; [exact E0|]. intros b e Hb He E1 E2.
  assert (b = b0) as -> by (apply U; [assumption | rewrite <- E1; congruence]). auto.
Qed.

(* Which way the parameter goes along the second curve: o is 1 or -1. *)
Variable o : R.
Hypothesis orientation : o = 1 \/ o = -1.

(* If Gee has a sign it goes one way (9.1). *)
Theorem touch_and_go : (forall b e, in_J b -> in_Y e -> o * Gee b e < 0) ->
  forall e e', el <= e -> e < e' -> e' <= eh -> o * branch e < o * branch e'.
Proof.
  intros S e e' He Hee He'. assert (Ye : in_Y e) by (unfold in_Y; lra). assert (Ye' : in_Y e') by (unfold in_Y; lra). pose proof (branch_in e Ye) as Jb.
  assert (D : o * reduced (branch e) e' < 0).
  { pose proof (branch_zero e Ye) as Z. destruct (reduced_differs (branch e) e (branch e) e' Jb Ye Jb Ye') as [t [Ht E]]. rewrite Z, Rminus_0_r in E. rewrite E.
    pose proof (on_the_way_in (branch e) e t Jb Ye ltac:(lra)) as W. pose proof (on_the_way_in (branch e) e' t Jb Ye' ltac:(lra)) as W'.
    destruct (mean_value_around (Ge (branch e)) (Gee (branch e)) el eh (on_the_way (branch e) e t) (on_the_way (branch e) e' t)) as [u [Hu M]]; try assumption;
      [intros; apply Ge_e; assumption|].
    rewrite M. replace (on_the_way (branch e) e' t - on_the_way (branch e) e t) with (t * (e' - e)) by (unfold on_the_way; ring).
    specialize (S (branch e) u Jb Hu). assert (0 < t * (e' - e)) by (apply Rmult_lt_0_compat; lra). nra. }
  destruct (over_the_branch (branch e) e' Jb Ye') as [_ [_ [P1 P2]]]. destruct orientation as [-> | ->]; [specialize (P1 ltac:(lra)) | specialize (P2 ltac:(lra))]; lra.
Qed.

(* If o Ge is convex in e, and orbits of the second curve have partners, this curve turns at the crossing (9.2). *)
Variable Geee : R -> R -> R.
Hypothesis Gee_e : forall b e, in_J b -> in_Y e -> is_derive (fun e => Gee b e) e (Geee b e).
Hypothesis Geee_positive : forall b e, in_J b -> in_Y e -> 0 < o * Geee b e.

Lemma Ge_convex b u w q : in_J b -> in_Y u -> in_Y w -> u < w -> 0 < q < 1 -> o * Ge b ((1 - q) * u + q * w) < o * ((1 - q) * Ge b u + q * Ge b w).
Proof.
  intros Hb Hu Hw Huw Hk. unfold in_Y in *. set (x := (1 - q) * u + q * w). assert (Hx : u < x < w) by (unfold x; nra).
  destruct (mean_value (Ge b) (Gee b) u x) as [y1 [Y1 E1]]; [lra | intros; apply Ge_e; unfold in_Y; (assumption || lra)|].
  destruct (mean_value (Ge b) (Gee b) x w) as [y2 [Y2 E2]]; [lra | intros; apply Ge_e; unfold in_Y; (assumption || lra)|].
  destruct (mean_value (Gee b) (Geee b) y1 y2) as [y [Y3 E3]]; [lra | intros; apply Gee_e; unfold in_Y; (assumption || lra)|].
  assert (P : 0 < o * Geee b y) by (apply Geee_positive; unfold in_Y; (assumption || lra)).
  assert (Q : 0 < o * (Gee b y2 - Gee b y1)) by (rewrite E3, <- Rmult_assoc; apply Rmult_lt_0_compat; lra).
  replace (x - u) with (q * (w - u)) in E1 by (unfold x; ring). replace (w - x) with ((1 - q) * (w - u)) in E2 by (unfold x; ring).
  assert (Z : 0 < q * (1 - q) * (w - u) * (o * (Gee b y2 - Gee b y1))) by (apply Rmult_lt_0_compat; [repeat apply Rmult_lt_0_compat; lra | assumption]).
  replace (q * (1 - q) * (w - u) * (o * (Gee b y2 - Gee b y1))) with (o * (q * (Gee b y2 * ((1 - q) * (w - u))) - (1 - q) * (Gee b y1 * (q * (w - u))))) in Z by ring.
  rewrite <- E1, <- E2 in Z. destruct orientation as [-> | ->]; lra.
Qed.
Lemma reduced_convex b u w q : in_J b -> in_Y u -> in_Y w -> u < w -> 0 < q < 1 ->
  o * reduced b ((1 - q) * u + q * w) < o * ((1 - q) * reduced b u + q * reduced b w).
Proof.
  intros Hb Hu Hw Huw Hk. set (x := (1 - q) * u + q * w). assert (Hx : in_Y x) by (unfold x, in_Y in *; nra).
  destruct (primitive_of b u Hb Hu) as [p1 [A1 [B1 D1]]]. destruct (primitive_of b x Hb Hx) as [p2 [A2 [B2 D2]]].
  destruct (primitive_of b w Hb Hw) as [p3 [A3 [B3 D3]]].
  destruct (mean_value (fun t => (1 - q) * p1 t + q * p3 t - p2 t)
    (fun t => (1 - q) * Ge b (on_the_way b u t) + q * Ge b (on_the_way b w t) - Ge b (on_the_way b x t)) 0 1) as [t [Ht E]]; [lra | |].
  - intros t Ht. apply (is_derive_minus (V := R_NormedModule) (fun t => (1 - q) * p1 t + q * p3 t)); [|auto].
    apply (is_derive_plus (V := R_NormedModule) (fun t => (1 - q) * p1 t)); [apply (is_derive_scal p1) | apply (is_derive_scal p3)]; auto.
  - assert (C0 : o * Ge b (on_the_way b x t) < o * ((1 - q) * Ge b (on_the_way b u t) + q * Ge b (on_the_way b w t))).
    { replace (on_the_way b x t) with ((1 - q) * on_the_way b u t + q * on_the_way b w t) by (unfold on_the_way, x; ring).
      apply Ge_convex; try assumption; try (apply on_the_way_in; (assumption || lra)). unfold on_the_way. nra. }
    rewrite A1, A2, A3, B1, B2, B3 in E. destruct orientation as [-> | ->]; lra.
Qed.
Lemma branch_peaks x y z b : el <= x -> x < y -> y < z -> z <= eh -> b <= o * branch x -> b <= o * branch z -> b < o * branch y.
Proof.
  intros Hx Hxy Hyz Hz Bx Bz. assert (Yx : in_Y x) by (unfold in_Y; lra). assert (Yy : in_Y y) by (unfold in_Y; lra). assert (Yz : in_Y z) by (unfold in_Y; lra).
  destruct (branch_is x Yx) as [Ix _]. destruct (branch_is y Yy) as [Iy _].
  assert (Hk : 0 < (y - x) / (z - x) < 1).
  { split; [apply Rdiv_lt_0_compat; lra|]. apply (Rmult_lt_reg_r (z - x)); [lra|]. unfold Rdiv. rewrite Rmult_assoc, Rinv_l by lra. lra. }
  set (q := (y - x) / (z - x)) in *.
  assert (Between : forall b', in_J b' -> o * reduced b' x <= 0 -> o * reduced b' z <= 0 -> o * reduced b' y < 0).
  { intros b' Jb Nx Nz. pose proof (reduced_convex b' x z q Jb Yx Yz ltac:(lra) Hk) as Q.
    replace ((1 - q) * x + q * z) with y in Q by (unfold q; field; lra).
    assert (0 <= (1 - q) * - (o * reduced b' x)) by (apply Rmult_le_pos; lra). assert (0 <= q * - (o * reduced b' z)) by (apply Rmult_le_pos; lra). lra. }
  destruct orientation as [-> | ->].
  - destruct (Rlt_le_dec b bl) as [|Hb]; [lra|]. assert (Jb : in_J b) by (unfold in_J; lra).
    destruct (over_the_branch b x Jb Yx) as [Nx _]. destruct (over_the_branch b z Jb Yz) as [Nz _]. destruct (over_the_branch b y Jb Yy) as [_ [_ [Ny _]]].
    specialize (Nx ltac:(lra)). specialize (Nz ltac:(lra)). specialize (Between b Jb ltac:(lra) ltac:(lra)). specialize (Ny ltac:(lra)). lra.
  - destruct (Rlt_le_dec bh (- b)) as [|Hb]; [lra|]. assert (Jb : in_J (- b)) by (unfold in_J; lra).
    destruct (over_the_branch (- b) x Jb Yx) as [_ [Nx _]]. destruct (over_the_branch (- b) z Jb Yz) as [_ [Nz _]]. destruct (over_the_branch (- b) y Jb Yy) as [_ [_ [_ Ny]]].
    specialize (Nx ltac:(lra)). specialize (Nz ltac:(lra)). specialize (Between (- b) Jb ltac:(lra) ltac:(lra)). specialize (Ny ltac:(lra)). lra.
Qed.

(* The partner of a point: the other one of its orbit. *)
Variables (partner : R -> R -> R) (L : R).
Hypothesis L_nonneg : 0 <= L.
Hypothesis partner_lipschitz : forall b e b' e', in_J b -> in_Y e -> in_J b' -> in_Y e' ->
  Rabs (partner b' e' - partner b e) <= L * (Rabs (b' - b) + Rabs (e' - e)).
Hypothesis partner_of_family : forall b e, in_J b -> in_Y e -> F b e = 0 -> partner b e = e.
Hypothesis partner_of_branch : forall b e, in_J b -> in_Y e -> G b e = 0 -> F b e <> 0 -> in_Y (partner b e) ->
  partner b e <> e /\ F b (partner b e) <> 0 /\ G b (partner b e) = 0.

Theorem pitchfork b0 : cross family branch b0 (family b0) ->
  (forall e e', el <= e -> e < e' -> e' <= family b0 -> o * branch e < o * branch e') /\
  (forall e e', family b0 <= e -> e < e' -> e' <= eh -> o * branch e' < o * branch e).
Proof.
  intros [_ [_ [_ [_ [_ [_ [H0 [He0 [_ [E0 Only]]]]]]]]]]. assert (J0 : in_J b0) by (unfold in_J; lra). pose proof (family_in b0 J0) as Y0.
  set (e0 := family b0) in *.
  set (Kb := B / (c - A * B)). assert (HKb : 0 <= Kb) by (unfold Kb; apply Rdiv_le_0_compat; [apply B_nonneg | lra]).
  set (N := L * (Kb + 1)). assert (HN : 0 <= N) by (unfold N; apply Rmult_le_pos; lra).
  set (rho := Rmin (e0 - el) (eh - e0) / (N + 1)).
  assert (Pm : 0 < Rmin (e0 - el) (eh - e0)) by (apply Rmin_pos; lra).
  assert (Hrho : 0 < rho) by (unfold rho; apply Rdiv_lt_0_compat; lra).
  assert (Rho : (N + 1) * rho = Rmin (e0 - el) (eh - e0)) by (unfold rho; field; lra).
  pose proof (Rmin_l (e0 - el) (eh - e0)) as M1. pose proof (Rmin_r (e0 - el) (eh - e0)) as M2.
  assert (Flat : forall e, in_Y e -> Rabs (branch e - branch e0) <= Kb * Rabs (e - e0)) by (intros e He; apply branch_lipschitz; assumption).
  assert (Part : forall e, Rabs (e - e0) <= rho -> e <> e0 -> exists w, w <> e /\ Rabs (w - e0) <= N * Rabs (e - e0) /\ branch w = branch e).
  { intros e He Ne. assert (Nr : 0 <= N * rho) by (apply Rmult_le_pos; lra).
    assert (Ye : in_Y e) by (apply Rabs_le_between in He; unfold in_Y; lra). pose proof (branch_in e Ye) as Jb.
    assert (Z : G (branch e) e = 0) by (apply zeros_are; auto).
    assert (NF : F (branch e) e <> 0).
    { intros Q. apply (family_is (branch e) Jb) in Q; [|assumption]. apply Ne. apply (Only (branch e) e); auto. }
    assert (W : Rabs (partner (branch e) e - e0) <= N * Rabs (e - e0)).
    { rewrite <- (partner_of_family b0 e0 J0 Y0) at 1 by (apply family_zero; assumption).
      eapply Rle_trans; [apply partner_lipschitz; assumption|]. unfold N. rewrite Rmult_assoc. apply Rmult_le_compat_l; [assumption|].
      pose proof (Flat e Ye) as Q. rewrite E0 in Q. lra. }
    assert (Yw : in_Y (partner (branch e) e)).
    { assert (N * Rabs (e - e0) <= N * rho) by (apply Rmult_le_compat_l; assumption). apply Rabs_le_between in W. unfold in_Y. lra. }
    destruct (partner_of_branch (branch e) e Jb Ye Z NF Yw) as [P1 [P2 P3]]. exists (partner (branch e) e). split; [assumption|]. split; [assumption|].
    apply (zeros_are (branch e) _ Jb Yw) in P3. destruct P3 as [P3|P3]; [|symmetry; assumption].
    exfalso. apply P2. apply (family_is (branch e) Jb); assumption. }
  assert (Flat' : forall e, el <= e <= eh -> Rabs (o * branch e - o * branch e0) <= Kb * Rabs (e - e0)).
  { intros e He. rewrite <- Rmult_minus_distr_l, Rabs_mult. replace (Rabs o) with 1 by (destruct orientation as [-> | ->]; [rewrite Rabs_R1 | rewrite Rabs_m1]; reflexivity).
    rewrite Rmult_1_l. apply Flat. exact He. }
  assert (Part' : forall e, Rabs (e - e0) <= rho -> e <> e0 -> exists w, w <> e /\ Rabs (w - e0) <= N * Rabs (e - e0) /\ o * branch w = o * branch e).
  { intros e He Ne. destruct (Part e He Ne) as [w [W1 [W2 W3]]]. exists w. rewrite W3. auto. }
  assert (Left : forall e, el <= e < e0 -> o * branch e < o * branch e0).
  { apply (peak_left (fun e => o * branch e) el eh e0 N Kb rho); try assumption. exact branch_peaks. }
  assert (Right : forall e, e0 < e <= eh -> o * branch e < o * branch e0).
  { intros e He. rewrite <- (Ropp_involutive e), <- (Ropp_involutive e0).
    apply (peak_left (fun x => o * branch (- x)) (- eh) (- el) (- e0) N Kb rho); try assumption; try lra.
    - intros x y z b Hx Hxy Hyz Hz Bx Bz. apply (branch_peaks (- z) (- y) (- x)); lra || assumption.
    - intros x Hx. rewrite Ropp_involutive. replace (x - - e0) with (- (- x - e0)) by ring. rewrite Rabs_Ropp. apply Flat'. lra.
    - intros x Hx Nx. replace (x - - e0) with (- (- x - e0)) in * by ring. rewrite Rabs_Ropp in *.
      destruct (Part' (- x)) as [w [W1 [W2 W3]]]; [assumption | lra|]. exists (- w). rewrite Ropp_involutive.
      replace (- w - - e0) with (- (w - e0)) by ring. rewrite Rabs_Ropp. repeat split; [lra | assumption | assumption]. }
  split.
  - intros e e' He Hee He'. destruct (Rle_lt_or_eq_dec e' e0 He') as [Q| ->]; [|apply Left; lra].
    apply (branch_peaks e e' e0); try lra. left. apply Left. lra.
  - intros e e' He Hee He'. destruct (Rle_lt_or_eq_dec e0 e He) as [Q|<-]; [|apply Right; lra].
    apply (branch_peaks e0 e e'); try lra. left. apply Right. lra.
Qed.
End Curves.
