(* A step that theory/Steps.v accepts is a solution, within the bound that it has found (Lemma 4.1). *)

From Coq Require Import List ZArith Reals Lra Lia.
From Coquelicot Require Import Coquelicot.
From Bignums Require Import BigZ.
From Orbitproof Require Import Polynomials Elements Formats Programs Steps Sound.
From Solutions Require Import Comparison Flow Exponential Norms Values Fields Bounds.
Import ListNotations.
Local Open Scope R_scope.
Local Open Scope list_scope.

Lemma scaled_le x y k : x <= y -> x / two_to k <= y / two_to k.
Proof. intros H. apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat, two_to_pos | assumption]. Qed.
Lemma scaled_abs x k : Rabs (x / two_to k) = Rabs x / two_to k.
Proof. unfold Rdiv. rewrite Rabs_mult, (Rabs_pos_eq (/ _)); [reflexivity|]. left. apply Rinv_0_lt_compat, two_to_pos. Qed.

Section Tubes.
Variables (f : format) (theta : R).
Hypothesis f_plain : plain f.
Hypothesis theta_in : 0 <= theta <= 1.
Let c : format := coarse f.

Lemma coarsened_holds x wider u : fine f theta x -> sized (entries f) wider ->
  Rabs (u - value f theta x) <= as_number f (unknown x) + as_number f wider -> holds c theta (coarsened f x wider) u.
Proof.
  intros [[p [Ep Lp]] Ux Sx _] Sw H. unfold coarsened, value in *. rewrite Ep in *. cbn [hd] in *. fold c.
  pose proof (plain_coarse f f_plain) as c_plain. fold c in c_plain.
  set (rest := (bound f (l1 (skipn (kept c) p)) (bits f) + rounding c 0)%bigZ).
  assert (Rb : 0 <= r_ (bound f (l1 (skipn (kept c) p)) (bits f))) by (apply bound_nonneg, l1_nonneg).
  assert (Rest : 0 <= r_ rest) by (unfold rest; rewrite r_add; pose proof (rounding_nonneg c); lra).
  assert (S1 : sized (entries f) (nadd (unknown x) wider)) by (apply sized_nadd; assumption).
  assert (S2 : sized (entries f) (0%bigZ :: tl (size x))) by (apply tl_sized; assumption).
  assert (S3 : sized (entries c) (nadd (nadd (unknown x) wider) (0%bigZ :: tl (size x)))) by (apply sized_nadd; assumption).
  destruct (as_number_raise c rest _ S3 Rest) as [S4 E4].
  apply element_holds; try assumption.
  - rewrite map_length. apply firstn_le_length.
  - rewrite E4. change (as_number c) with (as_number f). change (eps c) with (eps f).
    rewrite as_number_add, as_number_add by assumption. pose proof (as_number_nonneg f _ S2) as P2.
    set (q := firstn (kept c) p) in *. set (shift := (bits f - bits c)%bigZ).
    assert (A : Rabs (eval p theta / two_to (bits f) - eval (map (fun a => down a shift) q) theta / two_to (bits c))
                <= r_ rest / two_to (eps f)).
    { pose proof (rounding_is_bounded shift q theta theta_in) as Q. unfold shift in Q at 2. rewrite two_to_sub in Q.
      set (rq := eval (map (fun a => down a shift) q) theta) in *.
      assert (L : INR (length q) <= INR (kept c)) by (apply le_INR, firstn_le_length).
      rewrite (eval_split (kept c) p theta). fold q. pose proof (two_to_pos (bits f)) as Pf. pose proof (two_to_pos (bits c)) as Pc.
      pose proof (l1_is_a_bound (skipn (kept c) p) theta theta_in) as B. pose proof (power_small theta (kept c) theta_in) as W.
      assert (B2 : Rabs (theta ^ kept c * eval (skipn (kept c) p) theta / two_to (bits f)) <= r_ (bound f (l1 (skipn (kept c) p)) (bits f)) / two_to (eps f)).
      { eapply Rle_trans; [|apply bound_above]. rewrite scaled_abs. apply scaled_le. rewrite Rabs_mult, (Rabs_pos_eq (theta ^ _)) by lra.
        pose proof (Rabs_pos (eval (skipn (kept c) p) theta)). nra. }
      pose proof (rounding_above c) as RA. change (eps c) with (eps f) in RA.
      assert (B3 : Rabs (eval q theta / two_to (bits f) - rq / two_to (bits c)) <= INR (kept c) / two_to (bits c)).
      { replace (eval q theta / two_to (bits f) - rq / two_to (bits c))
          with (- ((rq - eval q theta / (two_to (bits f) / two_to (bits c))) / two_to (bits c))) by (field; lra).
        rewrite Rabs_Ropp, scaled_abs. apply scaled_le. lra. }
      replace ((eval q theta + theta ^ kept c * eval (skipn (kept c) p) theta) / two_to (bits f) - rq / two_to (bits c))
        with ((eval q theta / two_to (bits f) - rq / two_to (bits c)) + theta ^ kept c * eval (skipn (kept c) p) theta / two_to (bits f))
        by (unfold Rdiv; ring).
      eapply Rle_trans; [apply Rabs_triang|]. unfold rest. rewrite r_add. unfold Rdiv in *. lra. }
    apply Rabs_le_between in A. apply Rabs_le_between in H. apply Rabs_le. lra.
Qed.

Lemma on_part_above x u k : holds c theta x u -> INR k / 8 <= theta <= (INR k + 1) / 8 ->
  sized (entries f) (on_part f x k) /\ Rabs u <= as_number f (on_part f x k).
Proof.
  intros [[[p [Ep Lp]] Ux _ _] H] Hk. unfold on_part, value in *. rewrite Ep in *. cbn [hd] in *. fold c.
  set (q := recentred (BigZ.of_Z (Z.of_nat (2 * k + 1))) 4 p). set (s := recentred_scale 4 p).
  destruct (as_number_raise f (bound f (l1 q) (bits c + s)) (unknown x)) as [S E]; [exact Ux | apply bound_nonneg, l1_nonneg|].
  split; [exact S|]. rewrite E.
  assert (T8 : two_to 3%bigZ = 8) by (unfold two_to; change (BigZ.to_Z 3%bigZ) with 3%Z; simpl; lra).
  assert (Rk : r_ (BigZ.of_Z (Z.of_nat k)) = INR k) by (unfold r_; rewrite BigZ.spec_of_Z, <- INR_IZR_INZ; reflexivity).
  destruct (in_part (BigZ.of_Z (Z.of_nat k)) 3%bigZ theta) as [z [Hz Ez]]; [vm_compute; discriminate | rewrite T8, Rk; exact Hk|].
  assert (V : eval q z = two_to s * eval p theta).
  { unfold q, s. rewrite (recentred_is_the_same_function _ 4%bigZ p z) by (vm_compute; discriminate). f_equal. f_equal. rewrite Ez.
    change (3 + 1)%bigZ with 4%bigZ. f_equal. f_equal.
    unfold r_. rewrite BigZ.spec_of_Z, BigZ.spec_add, BigZ.spec_mul, BigZ.spec_of_Z. f_equal. 
    change (BigZ.to_Z 2%bigZ) with 2%Z. change (BigZ.to_Z 1%bigZ) with 1%Z. lia. }
  pose proof (l1_is_a_bound_around q z Hz) as B. rewrite V in B.
  pose proof (bound_above f (l1 q) (bits c + s)%bigZ) as A. rewrite two_to_add in A.
  pose proof (two_to_pos (bits c)) as Pb. pose proof (two_to_pos s) as Ps.
  assert (G : Rabs (eval p theta / two_to (bits c)) <= r_ (l1 q) / (two_to (bits c) * two_to s)).
  { rewrite scaled_abs. rewrite Rabs_mult, (Rabs_pos_eq (two_to s)) in B by lra.
    replace (Rabs (eval p theta) / two_to (bits c)) with (two_to s * Rabs (eval p theta) / (two_to (bits c) * two_to s)) by (field; lra).
    apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat; nra | assumption]. }
  change (as_number c (unknown x)) with (as_number f (unknown x)) in H.
  pose proof (Rabs_triang (eval p theta / two_to (bits c)) (u - eval p theta / two_to (bits c))) as T.
  replace (eval p theta / two_to (bits c) + (u - eval p theta / two_to (bits c))) with u in T by ring. lra.
Qed.
End Tubes.

(* The defect. *)
Lemma defect_above f num den p value_ v theta : plain f -> 0 <= theta <= 1 -> 0 <= r_ num -> (0 <= BigZ.to_Z den)%Z ->
  holds f theta value_ v ->
  sized (entries f) (defect f num den [p] value_) /\
  Rabs (r_ num / two_to den * v - eval (pderiv p) theta / two_to (bits f)) <= as_number f (defect f num den [p] value_).
Proof.
  intros f_plain Ht Hn Hd [[[q [Eq Lq]] Uv _ _] H]. unfold defect, known_defect, value in *. rewrite Eq, (plain_grades f f_plain) in *.
  cbn [combine fold_right hd] in *.
  set (d := psub (pscale num q) (map (fun c => BigZ.shiftl c den) (pderiv p))).
  destruct (as_number_raise f (bound f (l1 d) (scale f 0 + den)) (nothing f)) as [S1 E1]; [apply nothing_entries | apply bound_nonneg, l1_nonneg|].
  pose proof (two_to_pos den) as Pd. pose proof (two_to_pos (bits f)) as Pb.
  assert (S2 : sized (entries f) (map (fun e => up (num * e) den) (unknown value_))).
  { apply sized_map; [|assumption]. intros x Hx. apply up_nonneg. rewrite r_mul. apply Rmult_le_pos; assumption. }
  split; [apply sized_nadd; assumption|]. rewrite as_number_add, E1, as_number_nothing, Rplus_0_r by assumption.
  assert (A : r_ num / two_to den * as_number f (unknown value_) <= as_number f (map (fun e => up (num * e) den) (unknown value_))).
  { unfold as_number. unfold Rdiv at 2 3. rewrite <- Rmult_assoc. apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat, two_to_pos|].
    apply tot_map. intros x. pose proof (up_is_above (num * x)%bigZ den) as [_ U]. rewrite r_mul in U. unfold Rdiv in *. lra. }
  assert (Sh : forall l t, eval (map (fun c => BigZ.shiftl c den) l) t = two_to den * eval l t).
  { clear -Hd. intros l t. induction l as [|x l IH]; cbn; [ring|]. rewrite IH. destruct (r_shiftl x den) as [E|E]; [rewrite E; ring | lia]. }
  pose proof (l1_is_a_bound d theta Ht) as B. pose proof (bound_above f (l1 d) (scale f 0 + den)%bigZ) as C. rewrite two_to_add, scale_0 in C.
  assert (D : Rabs (r_ num / two_to den * (eval q theta / two_to (bits f)) - eval (pderiv p) theta / two_to (bits f))
              <= r_ (l1 d) / (two_to (bits f) * two_to den)).
  { replace (r_ num / two_to den * (eval q theta / two_to (bits f)) - eval (pderiv p) theta / two_to (bits f))
      with (eval d theta / (two_to (bits f) * two_to den)) by (unfold d; rewrite eval_psub, eval_pscale, Sh; field; lra).
    unfold Rdiv. rewrite Rabs_mult, (Rabs_pos_eq (/ _)); [apply Rmult_le_compat_r; [|assumption]|]; left; apply Rinv_0_lt_compat; nra. }
  assert (G : Rabs (r_ num / two_to den * v - r_ num / two_to den * (eval q theta / two_to (bits f))) <= r_ num / two_to den * as_number f (unknown value_)).
  { rewrite <- Rmult_minus_distr_l, Rabs_mult, (Rabs_pos_eq (r_ num / two_to den)) by (apply Rle_mult_inv_pos; assumption).
    apply Rmult_le_compat_l; [apply Rle_mult_inv_pos; assumption | assumption]. }
  apply Rabs_le_between in D. apply Rabs_le_between in G. apply Rabs_le. lra.
Qed.

Lemma derive_eval p t : is_derive (eval p) t (eval (pderiv p) t).
Proof. apply is_derive_Reals, pderiv_is_the_derivative. Qed.

(* All eight parts of a step, one after the other. *)
Section Parts.
Variables (f : format) (m : nat) (g : field) (P dP : nat -> R -> R) (delta T : nat -> R) (N : nat).
Variable mats : nat -> list (list (option norm)).
Notation number := (as_number f).
Notation at_ v i := (number (nth i v [])).
Hypothesis g_lipschitz : locally_lipschitz m g.
(* g is the field for a unit of time of which the step has eight; P is a function of theta. *)
Hypothesis P_derive : forall i t, (i < m)%nat -> 0 <= t <= 1 -> is_derive (P i) t (dP i t).
Hypothesis delta_nonneg : forall i, (i < m)%nat -> 0 <= delta i.
Hypothesis defect_ : forall i t, (i < m)%nat -> 0 <= t <= 1 -> Rabs (g (fun j => P j t) i - dP i t / 8) <= delta i / 8.
Hypothesis mats_sized : forall k, (k < 8)%nat -> matrix_sized f m (mats k).
Hypothesis tube_ : forall k x i t, (k < 8)%nat -> (i < m)%nat -> INR k / 8 <= t <= (INR k + 1) / 8 ->
  (forall j, (j < m)%nat -> Rabs (x j - P j t) <= T j) ->
  Rabs (g x i - g (fun j => P j t) i) <= sum m (fun j => entry f (nth j (nth i (mats k) []) None) * Rabs (x j - P j t)).

Definition grown_from (v : option (list norm)) (ks : list nat) : option (list norm) :=
  fold_left (fun v i => match v with Some v => exponential f N (mats i) v | None => None end) ks v.
Lemma grown_none ks : grown_from None ks = None.
Proof. induction ks; [reflexivity | assumption]. Qed.

Lemma grown_grows ks : forall v e, (forall k, In k ks -> (k < 8)%nat) -> vector f m v -> grown_from (Some v) ks = Some e ->
  vector f m e /\ forall i, (i < m)%nat -> at_ v i <= at_ e i.
Proof.
  induction ks as [|k ks IH]; intros v e Hk Hv E.
  - cbn in E. injection E as <-. split; [assumption | intros; lra].
  - unfold grown_from in E. cbn [fold_left] in E. fold (grown_from (exponential f N (mats k) v) ks) in E.
    destruct (exponential f N (mats k) v) as [V|] eqn:X; [|rewrite grown_none in E; discriminate].
    destruct (exponential_sound f m (mats k) N v V (mats_sized k ltac:(apply Hk; left; reflexivity)) Hv X) as [HV [Up _]].
    destruct (IH V e ltac:(intros; apply Hk; right; assumption) HV E) as [A B]. split; [assumption|].
    intros i Hi. specialize (Up i Hi). specialize (B i Hi). lra.
Qed.

Lemma parts_sound r : forall k v e x0, (k + r = 8)%nat -> vector f m v -> grown_from (Some v) (seq k r) = Some e ->
  (forall i, (i < m)%nat -> at_ e i <= T i) ->
  (forall i, (i < m)%nat -> Rabs (x0 i - P i (INR k / 8)) + INR r / 8 * delta i <= at_ v i) ->
  exists y, (forall i, (i < m)%nat -> y i 0 = x0 i) /\ solves m g (INR r) y /\
    forall i t, (i < m)%nat -> 0 <= t <= INR r -> Rabs (y i t - P i ((INR k + t) / 8)) <= at_ e i.
Proof.
  induction r as [|r IH]; intros k v e x0 Hk Hv E HT H0.
  - cbn in E. injection E as <-.
    exists (fun i t => x0 i + t * g x0 i). split; [intros; ring|]. split.
    + intros i t Hi Ht. cbn in Ht. assert (t = 0) by lra. subst t.
      replace (g (fun j => x0 j + 0 * g x0 j) i) with (g x0 i) by (apply (field_ext m g g_lipschitz); [assumption | intros; ring]).
      auto_derive; [exact I | ring].
    + intros i t Hi Ht. cbn in Ht. assert (t = 0) by lra. subst t. specialize (H0 i Hi). cbn [INR] in H0.
      rewrite Rplus_0_r, Rmult_0_l, Rplus_0_r. replace (0 / 8 * delta i) with 0 in H0 by field. lra.
  - cbn [seq] in E. unfold grown_from in E. cbn [fold_left] in E. fold (grown_from (exponential f N (mats k) v) (seq (S k) r)) in E.
    destruct (exponential f N (mats k) v) as [V|] eqn:X; [|rewrite grown_none in E; discriminate].
    destruct (exponential_sound f m (mats k) N v V (mats_sized k ltac:(lia)) Hv X) as [HV [Up [w [q [Hq [Wp [W0 [Wn [Wl Ws]]]]]]]]].
    destruct (grown_grows (seq (S k) r) V e) as [He Ve]; [intros l Hl; apply in_seq in Hl; lia | assumption | assumption|].
    assert (Tk : forall s, 0 <= s <= 1 -> 0 <= (INR k + s) / 8 <= 1).
    { intros s Hs. assert (INR k + 1 <= 8) by (rewrite <- S_INR; replace 8 with (INR 8) by (cbn; lra); apply le_INR; lia).
      pose proof (pos_INR k). lra. }
    destruct (part m g (fun i s => P i ((INR k + s) / 8)) (fun i s => dP i ((INR k + s) / 8) / 8) T (fun i => delta i / 8)
      (fun i => INR r / 8 * delta i) (fun i j => entry f (nth j (nth i (mats k) []) None)) x0 g_lipschitz)
      with (N := N) (w := w) (q := q) (V := fun i => at_ V i) as [y [Y0 [Ys Yb]]]; auto.
    + intros i s Hi Hs. replace (dP i ((INR k + s) / 8) / 8) with (scal (/ 8) (dP i ((INR k + s) / 8)))
        by (unfold scal; cbn; unfold mult; cbn; field).
      apply (is_derive_comp (V := R_NormedModule) (P i) (fun s => (INR k + s) / 8)); [apply P_derive; auto|].
      auto_derive; [exact I | field].
    + intros i Hi. pose proof (delta_nonneg i Hi). lra.
    + intros i Hi. pose proof (delta_nonneg i Hi). apply Rmult_le_pos; [|assumption]. pose proof (pos_INR r). lra.
    + intros i j Hi Hj. apply entry_nonneg. destruct (mats_sized k ltac:(lia)) as [_ Ms]. destruct (Ms i Hi) as [Ml Mf].
      rewrite Forall_forall in Mf. apply Mf, nth_In. lia.
    + intros x i s Hi Hs Hx. apply tube_; [lia | assumption | lra | assumption].
    + intros i Hi. rewrite W0 by assumption. replace ((INR k + 0) / 8) with (INR k / 8) by (f_equal; ring).
      specialize (H0 i Hi). rewrite S_INR in H0. lra.
    + intros i Hi. specialize (Ve i Hi). specialize (HT i Hi). lra.
    + destruct (IH (S k) V e (fun j => y j 1) ltac:(lia) HV E HT) as [z [Z0 [Zs Zb]]].
      { intros i Hi. rewrite S_INR. apply Yb; [assumption | lra]. }
      exists (glued 1 y z). rewrite S_INR, Rplus_comm.
      assert (Meet : forall i, (i < m)%nat -> z i 0 = y i 1) by auto.
      split; [|split].
      * intros i Hi. rewrite glued_before by lra. auto.
      * apply glued_solves; auto; [lra | apply pos_INR].
      * intros i t Hi Ht. destruct (Rle_dec t 1) as [L|L].
        -- rewrite glued_before by assumption. specialize (Yb i t Hi ltac:(lra)). specialize (Ve i Hi).
           assert (0 <= INR r / 8 * delta i) by (apply Rmult_le_pos; [pose proof (pos_INR r); lra | auto]). lra.
        -- rewrite (glued_after m 1 y z Meet) by (assumption || lra). specialize (Zb i (t - 1) Hi ltac:(lra)). rewrite S_INR in Zb.
           replace ((INR k + t) / 8) with ((INR k + 1 + (t - 1)) / 8) by (f_equal; ring). assumption.
Qed.
End Parts.
