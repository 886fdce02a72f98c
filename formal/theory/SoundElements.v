(* What is proved here of Elements.v: sums, products and multiples of elements contain those of what the elements contain, in any
   algebra with graded norms. That the power series of section 2.1 are such an algebra is left to that section. *)

From Coq Require Import List ZArith Reals Lra Lia.
From Bignums Require Import BigZ.
From Orbitproof Require Import Polynomials Elements Formats Programs Steps Sound.
Import ListNotations.
Local Open Scope R_scope.
Local Open Scope list_scope.

(* Finite sums. *)
Fixpoint sum (n : nat) (f : nat -> R) : R := match n with O => 0 | S n' => sum n' f + f n' end.
Definition ind (b : bool) : R := if b then 1 else 0.

Lemma sum_ext n f g : (forall i, (i < n)%nat -> f i = g i) -> sum n f = sum n g.
Proof. induction n as [|n IH]; intros H; [reflexivity|]. cbn. rewrite IH, H by (intros; try apply H; lia). reflexivity. Qed.
Lemma sum_le n f g : (forall i, (i < n)%nat -> f i <= g i) -> sum n f <= sum n g.
Proof. induction n as [|n IH]; intros H; cbn; [lra|]. apply Rplus_le_compat; [apply IH; intros; apply H; lia | apply H; lia]. Qed.
Lemma sum_add n f g : sum n (fun i => f i + g i) = sum n f + sum n g.
Proof. induction n as [|n IH]; cbn; [lra|]. rewrite IH. lra. Qed.
Lemma sum_scale n c f : sum n (fun i => c * f i) = c * sum n f.
Proof. induction n as [|n IH]; cbn; [lra|]. rewrite IH. lra. Qed.
Lemma sum_zero n f : (forall i, (i < n)%nat -> f i = 0) -> sum n f = 0.
Proof. intros H. rewrite (sum_ext n f (fun _ => 0 * 0)) by (intros; rewrite H by assumption; lra). rewrite sum_scale. lra. Qed.
Lemma sum_nonneg n f : (forall i, (i < n)%nat -> 0 <= f i) -> 0 <= sum n f.
Proof. intros H. rewrite <- (sum_zero n (fun _ => 0)) by reflexivity. apply sum_le. assumption. Qed.
Lemma sum_shift n f : sum (S n) f = f O + sum n (fun i => f (S i)).
Proof. induction n as [|n IH]; [cbn; lra|]. change (sum (S (S n)) f) with (sum (S n) f + f (S n)). rewrite IH. cbn. lra. Qed.
Lemma sum_swap n m f : sum n (fun i => sum m (fun j => f i j)) = sum m (fun j => sum n (fun i => f i j)).
Proof.
  induction n as [|n IH]; cbn.
  - symmetry. apply sum_zero. reflexivity.
  - rewrite IH. rewrite <- sum_add. apply sum_ext. reflexivity.
Qed.
Lemma sum_one n k f : (k < n)%nat -> sum n (fun i => ind (i =? k)%nat * f i) = f k.
Proof.
  induction n as [|n IH]; intros H; [lia|]. cbn. destruct (Nat.eq_dec k n) as [->|E].
  - rewrite Nat.eqb_refl. rewrite sum_zero; [cbn; lra|]. intros i Hi. rewrite (proj2 (Nat.eqb_neq i n)) by lia. cbn. lra.
  - rewrite IH by lia. rewrite (proj2 (Nat.eqb_neq n k)) by lia. cbn. lra.
Qed.
Lemma ind_nonneg b : 0 <= ind b.
Proof. destruct b; cbn; lra. Qed.

(* Entries of a vector of bounds. *)
Definition at_ (e : norm) (g : nat) : R := r_ (nth g e 0%bigZ).

Lemma at_map_mul x b g : at_ (map (BigZ.mul x) b) g = r_ x * at_ b g.
Proof.
  unfold at_. destruct (Nat.lt_ge_cases g (length b)) as [H|H].
  - rewrite (nth_indep _ 0%bigZ (x * 0)%bigZ) by (rewrite map_length; assumption). rewrite map_nth. apply r_mul.
  - rewrite !nth_overflow by (rewrite ?map_length; assumption). rewrite r_0. lra.
Qed.
Lemma at_map phi l : forall g, (g < length l)%nat -> at_ (map phi l) g = r_ (phi (nth g l 0%bigZ)).
Proof.
  induction l as [|x l IH]; intros [|g] H; cbn in H; try lia; [reflexivity|]. exact (IH g ltac:(lia)).
Qed.
Lemma at_nadd a : forall b g, (g < length a)%nat -> (g < length b)%nat -> at_ (nadd a b) g = at_ a g + at_ b g.
Proof.
  induction a as [|x a IH]; intros [|y b] [|g] Ha Hb; cbn in *; try lia.
  - apply r_add.
  - exact (IH b g ltac:(lia) ltac:(lia)).
Qed.
Lemma length_nadd a : forall b, length b = length a -> length (nadd a b) = length a.
Proof. induction a as [|x a IH]; intros [|y b] H; cbn in *; try lia. rewrite IH by lia. reflexivity. Qed.

Lemma length_last_two a : forall x, a <> [] -> length (last_two x a) = length a.
Proof.
  induction a as [|y a IH]; intros x H; [congruence|]. destruct a as [|z a]; [reflexivity|].
  change (S (length (last_two y (z :: a))) = S (length (z :: a))). rewrite IH by congruence. reflexivity.
Qed.
Lemma at_last_two a : forall x g, a <> [] -> (g < length a)%nat ->
  at_ (last_two x a) g = at_ (x :: a) g + ind (S g =? length a)%nat * at_ (x :: a) (length a).
Proof.
  induction a as [|y a IH]; intros x g H Hg; [congruence|]. destruct a as [|z a].
  - cbn in Hg. assert (g = O) as -> by lia. unfold at_. cbn. rewrite r_add. lra.
  - destruct g as [|g].
    + unfold at_. cbn. lra.
    + change (at_ (last_two x (y :: z :: a)) (S g)) with (at_ (last_two y (z :: a)) g).
      rewrite IH by (cbn in *; try congruence; lia). reflexivity.
Qed.
Lemma length_further v : length (further v) = length v.
Proof.
  destruct v as [|x [|y v]]; try reflexivity. cbn [further]. cbn [length]. rewrite length_last_two by congruence. reflexivity. Qed.
Lemma at_further v last g : length v = S last -> (1 <= last)%nat -> (g <= last)%nat ->
  at_ (further v) g = match g with O => 0 | S k => at_ v k + ind (S k =? last)%nat * at_ v last end.
Proof.
  intros Hl H1 Hg. destruct v as [|x [|y v]]; cbn in Hl; try lia. cbn [further]. destruct g as [|k].
  - unfold at_. cbn. apply r_0.
  - change (at_ (0%bigZ :: last_two x (y :: v)) (S k)) with (at_ (last_two x (y :: v)) k).
    rewrite at_last_two by (try congruence; cbn; lia). replace (length (y :: v)) with last by (cbn; lia). reflexivity.
Qed.
Lemma length_products a b : length (products a b) = length b.
Proof.
  induction a as [|x a IH]; cbn; [apply map_length|]. rewrite length_nadd; rewrite map_length; [reflexivity|].
  rewrite length_further. assumption.
Qed.

Lemma at_zeros b : forall g, at_ (zeros b) g = 0.
Proof. induction b as [|x b IH]; intros [|g]; try apply r_0. exact (IH g). Qed.

Lemma at_products last b : length b = S last -> (1 <= last)%nat -> forall a g, (g <= last)%nat ->
  at_ (products a b) g = sum (length a) (fun i => sum (S last) (fun j =>
    ind (Nat.min (i + j) last =? g)%nat * (at_ a i * at_ b j))).
Proof.
  intros Hb H1. induction a as [|x a IH]; intros g Hg.
  - cbn [products length sum]. apply at_zeros.
  - cbn [products].
    assert (L1 : (g < length (map (BigZ.mul x) b))%nat) by (rewrite map_length; apply (Nat.lt_le_trans _ (S last)); [lia | exact (Nat.eq_le_incl _ _ (eq_sym Hb))]).
    assert (L2 : (g < length (further (products a b)))%nat) by (rewrite length_further, length_products; apply (Nat.lt_le_trans _ (S last)); [lia | exact (Nat.eq_le_incl _ _ (eq_sym Hb))]).
    rewrite (at_nadd _ _ _ L1 L2).
    rewrite at_map_mul. rewrite (at_further _ last) by (try lia; rewrite length_products; exact Hb).
    change (length (x :: a)) with (S (length a)). rewrite sum_shift. f_equal.
    + rewrite (sum_ext _ _ (fun j => ind (j =? g)%nat * (r_ x * at_ b j))).
      * rewrite (sum_one _ g (fun j => r_ x * at_ b j)) by lia. reflexivity.
      * intros j Hj. rewrite Nat.min_l by lia. reflexivity.
    + destruct g as [|k].
      * symmetry. apply sum_zero. intros i _. apply sum_zero. intros j _.
        replace (Nat.min (S i + j) last =? 0)%nat with false; [cbn; lra|]. symmetry. apply Nat.eqb_neq. lia.
      * rewrite !IH by lia. rewrite <- sum_scale. rewrite <- sum_add. apply sum_ext. intros i _.
        rewrite <- sum_scale, <- sum_add. apply sum_ext. intros j _.
        change (at_ (x :: a) (S i)) with (at_ a i).
        assert (E : ind (Nat.min (S i + j) last =? S k)%nat
                    = ind (Nat.min (i + j) last =? k)%nat
                      + ind (S k =? last)%nat * ind (Nat.min (i + j) last =? last)%nat).
        { destruct (Nat.eqb_spec (Nat.min (S i + j) last) (S k)); destruct (Nat.eqb_spec (Nat.min (i + j) last) k);
            destruct (Nat.eqb_spec (S k) last); destruct (Nat.eqb_spec (Nat.min (i + j) last) last);
            cbn; try lra; exfalso; lia. }
        rewrite E. ring.
Qed.

(* All products of two graded norms, those of grade last and above in the last place (section 2.1). *)
Definition cv (last : nat) (a b : nat -> R) (g : nat) : R :=
  sum (S last) (fun i => sum (S last) (fun j => ind (Nat.min (i + j) last =? g)%nat * (a i * b j))).

Lemma cv_le last a b a' b' g : (forall i, (i <= last)%nat -> 0 <= a i <= a' i) -> (forall i, (i <= last)%nat -> 0 <= b i <= b' i) ->
  cv last a b g <= cv last a' b' g.
Proof.
  intros Ha Hb. apply sum_le. intros i Hi. apply sum_le. intros j Hj.
  specialize (Ha i ltac:(lia)). specialize (Hb j ltac:(lia)). apply Rmult_le_compat_l; [apply ind_nonneg|]. apply Rmult_le_compat; lra.
Qed.
Lemma cv_scale last a b r s g : cv last (fun i => r * a i) (fun j => s * b j) g = r * s * cv last a b g.
Proof.
  unfold cv. rewrite <- sum_scale. apply sum_ext. intros i _. rewrite <- sum_scale. apply sum_ext. intros j _. ring.
Qed.

Section Algebra.
Variable f : format.
Let last : nat := S (top f).
Let N : nat := length (grades f).
Let P : R := two_to (eps f).
Let grade (i : nat) : nat := nth i (grades f) O.
Hypothesis eps_nonneg : (0 <= BigZ.to_Z (eps f))%Z.
Hypothesis grades_kept : forall i, (i < N)%nat -> (grade i <= top f)%nat.
Hypothesis number_of_pairs : length (pairs f) = N.

(* A commutative algebra with graded norms. *)
Variable A : Type.
Variable zero : A.
Variable plus mult : A -> A -> A.
Variable scal : R -> A -> A.
Hypothesis plus_comm : forall a b, plus a b = plus b a.
Hypothesis plus_assoc : forall a b c, plus a (plus b c) = plus (plus a b) c.
Hypothesis plus_zero : forall a, plus a zero = a.
Hypothesis mult_comm : forall a b, mult a b = mult b a.
Hypothesis mult_plus : forall a b c, mult a (plus b c) = plus (mult a b) (mult a c).
Hypothesis mult_zero : forall a, mult a zero = zero.
Hypothesis scal_plus : forall r a b, scal r (plus a b) = plus (scal r a) (scal r b).
Hypothesis plus_scal : forall r s a, scal (r + s) a = plus (scal r a) (scal s a).
Hypothesis scal_scal : forall r s a, scal r (scal s a) = scal (r * s) a.
Hypothesis scal_zero : forall a, scal 0 a = zero.
Hypothesis zero_scal : forall r, scal r zero = zero.
Hypothesis scal_mult : forall r a b, mult (scal r a) b = scal r (mult a b).
Variable sz : nat -> A -> R.
Hypothesis sz_nonneg : forall g a, 0 <= sz g a.
Hypothesis sz_zero : forall g, sz g zero = 0.
Hypothesis sz_plus : forall g a b, sz g (plus a b) <= sz g a + sz g b.
Hypothesis sz_scal : forall g r a, sz g (scal r a) <= Rabs r * sz g a.
Hypothesis sz_mult : forall g a b, (g <= last)%nat -> sz g (mult a b) <= cv last (fun i => sz i a) (fun j => sz j b) g.

Fixpoint asum (n : nat) (F : nat -> A) : A := match n with O => zero | S n' => plus (asum n' F) (F n') end.
Lemma asum_ext n F G : (forall i, (i < n)%nat -> F i = G i) -> asum n F = asum n G.
Proof. induction n as [|n IH]; intros H; [reflexivity|]. cbn. rewrite IH, H by (intros; try apply H; lia). reflexivity. Qed.
Lemma plus_swap a b c d : plus (plus a b) (plus c d) = plus (plus a c) (plus b d).
Proof. rewrite !plus_assoc. f_equal. rewrite <- !plus_assoc. f_equal. apply plus_comm. Qed.
Lemma asum_plus n F G : asum n (fun i => plus (F i) (G i)) = plus (asum n F) (asum n G).
Proof. induction n as [|n IH]; cbn; [rewrite plus_zero; reflexivity|]. rewrite IH. apply plus_swap. Qed.
Lemma asum_scal n r F : asum n (fun i => scal r (F i)) = scal r (asum n F).
Proof. induction n as [|n IH]; cbn; [rewrite zero_scal; reflexivity|]. rewrite IH, scal_plus. reflexivity. Qed.
Lemma mult_asum n a F : mult a (asum n F) = asum n (fun i => mult a (F i)).
Proof. induction n as [|n IH]; cbn; [apply mult_zero|]. rewrite mult_plus, IH. reflexivity. Qed.
Lemma sz_asum n g F : sz g (asum n F) <= sum n (fun i => sz g (F i)).
Proof. induction n as [|n IH]; cbn; [rewrite sz_zero; lra|]. eapply Rle_trans; [apply sz_plus|]. lra. Qed.

(* The kept monomials, and which products of them are kept: each pair once. *)
Variable mono : nat -> A.
Hypothesis sz_mono : forall g i, (i < N)%nat -> (g <= last)%nat -> sz g (mono i) <= ind (g =? grade i)%nat.
Definition lsum (l : list A) : A := fold_right plus zero l.
Hypothesis pairs_are : forall m i j, (m < N)%nat -> In (i, j) (nth m (pairs f) []) ->
  (i < N)%nat /\ (j < N)%nat /\ (grade i + grade j = grade m)%nat /\ mult (mono i) (mono j) = mono m.
Hypothesis pairs_complete : forall K : nat -> nat -> A,
  (forall i j, (top f < grade i + grade j)%nat -> K i j = zero) ->
  asum N (fun i => asum N (K i)) = asum N (fun m => lsum (map (fun ij => K (fst ij) (snd ij)) (nth m (pairs f) []))).
Hypothesis sz_beyond : forall g i j, (i < N)%nat -> (j < N)%nat -> (top f < grade i + grade j)%nat -> (g <= last)%nat ->
  sz g (mult (mono i) (mono j)) <= ind (g =? last)%nat.

(* What an element stands for at a time. *)
Variable t : R.
Hypothesis t_in : 0 <= t <= 1.

Definition value_of (ps : list poly) (i : nat) : R := eval (nth i ps []) t / two_to (scale f (grade i)).
Definition known_part (ps : list poly) : A := asum N (fun i => scal (value_of ps i) (mono i)).
Definition contains (x : element) (u : A) : Prop :=
  exists d, u = plus (known_part (known x)) d /\ forall g, (g <= last)%nat -> sz g d <= at_ (unknown x) g / P.
Definition good (x : element) : Prop :=
  length (known x) = N /\ length (unknown x) = S last /\ length (size x) = S last /\
  forall g, (g <= last)%nat -> sum N (fun i => ind (g =? grade i)%nat * Rabs (value_of (known x) i)) <= at_ (size x) g / P.

Lemma P_pos : 0 < P.
Proof. apply two_to_pos. Qed.
Lemma sz_terms (c : nat -> R) g : (g <= last)%nat ->
  sz g (asum N (fun i => scal (c i) (mono i))) <= sum N (fun i => ind (g =? grade i)%nat * Rabs (c i)).
Proof.
  intros Hg. eapply Rle_trans; [apply sz_asum|]. apply sum_le. intros i Hi.
  eapply Rle_trans; [apply sz_scal|]. specialize (sz_mono g i Hi Hg). pose proof (Rabs_pos (c i)). nra.
Qed.
Lemma sz_known x g : good x -> (g <= last)%nat -> sz g (known_part (known x)) <= at_ (size x) g / P.
Proof. intros (_ & _ & _ & H) Hg. eapply Rle_trans; [apply sz_terms; assumption|]. apply H. assumption. Qed.

(* Bounds of a number of some scale. *)
Lemma bound_is_above x s : r_ x / two_to s <= r_ (bound f x s) / P.
Proof.
  unfold bound. pose proof (up_is_above x (s - eps f)%bigZ) as [_ U]. rewrite two_to_sub in U. fold P in U.
  pose proof P_pos. pose proof (two_to_pos s).
  replace (r_ x / (two_to s / P)) with (r_ x / two_to s * P) in U by (field; lra).
  apply (Rmult_le_reg_r P); [assumption|]. replace (r_ (up x (s - eps f)%bigZ) / P * P) with (r_ (up x (s - eps f)%bigZ)) by (field; lra).
  assumption.
Qed.

Lemma length_raise g x v : length (raise g x v) = length v.
Proof. revert g; induction v as [|y v IH]; intros [|g]; cbn; try reflexivity. rewrite IH. reflexivity. Qed.
Lemma at_raise g x v k : (g < length v)%nat -> at_ (raise g x v) k = at_ v k + ind (k =? g)%nat * r_ x.
Proof.
  revert g k; induction v as [|y v IH]; intros g k Hg; cbn in Hg; [lia|].
  destruct g as [|g], k as [|k].
  - unfold at_. cbn. rewrite r_add. lra.
  - unfold at_. cbn. lra.
  - unfold at_. cbn. lra.
  - change (at_ (raise g x v) k = at_ v k + ind (k =? g)%nat * r_ x). apply IH. lia.
Qed.
Lemma length_nothing : length (nothing f) = S last.
Proof. unfold nothing. apply repeat_length. Qed.
Lemma at_nothing k : at_ (nothing f) k = 0.
Proof.
  unfold nothing, at_. generalize (S (S (top f))). intros n. revert k. induction n as [|n IH]; intros [|k]; try apply r_0. apply IH.
Qed.

Lemma sizes_are gs : forall ps k, length ps = length gs -> (forall g, In g gs -> (g <= top f)%nat) ->
  length (sizes f gs ps) = S last /\
  at_ (sizes f gs ps) k = sum (length gs) (fun i => ind (k =? nth i gs O)%nat * r_ (bound f (l1 (nth i ps [])) (scale f (nth i gs O)))).
Proof.
  induction gs as [|g gs IH]; intros [|p ps] k Hl Hg; cbn in Hl; try lia.
  - cbn [sizes length sum]. split; [apply length_nothing | apply at_nothing].
  - cbn [sizes]. destruct (IH ps k ltac:(lia) (fun g' Hg' => Hg g' (or_intror Hg'))) as [L E].
    split; [rewrite length_raise; assumption|].
    rewrite at_raise by (rewrite L; pose proof (Hg g (or_introl eq_refl)); unfold last; lia).
    rewrite E. change (length (g :: gs)) with (S (length gs)). rewrite sum_shift. cbn [nth]. lra.
Qed.

Lemma good_element_of ps e : length ps = N -> length e = S last -> good (element_of f ps e).
Proof.
  intros Hp He. unfold element_of, good. cbn [known unknown size].
  assert (G : forall g, In g (grades f) -> (g <= top f)%nat).
  { intros g Hin. apply (In_nth _ _ O) in Hin as (i & Hi & <-). apply (grades_kept i Hi). }
  assert (S : forall k, length (sizes f (grades f) ps) = S last /\ at_ (sizes f (grades f) ps) k = _)
    by (intros k; apply (sizes_are (grades f) ps k Hp G)).
  repeat split; try assumption; [apply (S O)|].
  intros g Hg. destruct (S g) as [_ ->]. unfold Rdiv. rewrite Rmult_comm, <- sum_scale. apply sum_le. intros i Hi.
  replace (/ P * (ind (g =? nth i (grades f) 0)%nat * r_ (bound f (l1 (nth i ps [])) (scale f (nth i (grades f) 0%nat)))))
    with (ind (g =? grade i)%nat * (r_ (bound f (l1 (nth i ps [])) (scale f (grade i))) / P)) by (unfold Rdiv, grade; ring).
  apply Rmult_le_compat_l; [apply ind_nonneg|].
  pose proof (bound_is_above (l1 (nth i ps [])) (scale f (grade i))) as B. unfold value_of.
  eapply Rle_trans; [|exact B]. unfold Rdiv. rewrite Rabs_mult.
  pose proof (two_to_pos (scale f (grade i))) as Q. rewrite (Rabs_pos_eq (/ _)) by (left; apply Rinv_0_lt_compat; assumption).
  apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat; assumption | apply l1_is_a_bound; assumption].
Qed.

Lemma nth_map2_padd a : forall b i, length a = length b -> nth i (map2 padd a b) [] = padd (nth i a []) (nth i b []).
Proof.
  induction a as [|p a IH]; intros [|q b] i H; cbn in H; try lia; [destruct i; reflexivity|].
  destruct i as [|i]; [reflexivity|]. cbn. apply IH. lia.
Qed.
Lemma length_map2 {X Y Z : Type} (op : X -> Y -> Z) a : forall b, length a = length b -> length (map2 op a b) = length a.
Proof. induction a as [|p a IH]; intros [|q b] H; cbn in *; try lia. rewrite IH by lia. reflexivity. Qed.

Theorem eadd_sound x y u v : good x -> good y -> contains x u -> contains y v ->
  good (eadd f x y) /\ contains (eadd f x y) (plus u v).
Proof.
  intros (Lx & Ex & _ & _) (Ly & Ey & _ & _) (d & -> & Hd) (d' & -> & Hd').
  assert (K : length (known x) = length (known y)) by (rewrite Lx, Ly; reflexivity).
  assert (U : length (nadd (unknown x) (unknown y)) = S last) by (rewrite length_nadd; [exact Ex | rewrite Ex; exact Ey]).
  unfold eadd. split; [apply good_element_of; [rewrite length_map2; assumption | exact U]|].
  exists (plus d d'). split.
  - rewrite plus_swap. f_equal. unfold known_part. cbn [known element_of]. rewrite <- asum_plus. apply asum_ext.
    intros i _. rewrite <- plus_scal. f_equal. unfold value_of. rewrite nth_map2_padd by exact K. rewrite eval_padd.
    unfold Rdiv. ring.
  - intros g Hg. cbn [unknown element_of].
    rewrite at_nadd by (apply (Nat.lt_le_trans _ (S last)); [lia | apply Nat.eq_le_incl; symmetry; assumption]).
    specialize (Hd g Hg). specialize (Hd' g Hg). eapply Rle_trans; [apply sz_plus|]. unfold Rdiv in *. lra.
Qed.

Lemma at_conv a b g : length a = S last -> length b = S last -> (g <= last)%nat ->
  cv last (fun i => at_ a i / P) (fun j => at_ b j / P) g <= at_ (conv f a b) g / P.
Proof.
  intros Ha Hb Hg. pose proof P_pos as Pp.
  unfold conv. rewrite at_map by (rewrite length_products; apply (Nat.lt_le_trans _ (S last));
    [lia | apply Nat.eq_le_incl; symmetry; exact Hb]).
  pose proof (up_is_above (nth g (products a b) 0%bigZ) (eps f)) as [_ U]. fold P in U.
  change (r_ (nth g (products a b) 0%bigZ)) with (at_ (products a b) g) in U.
  rewrite (at_products last b Hb) in U by (try exact Hg; unfold last; lia).
  assert (E : length a = S last) by exact Ha. rewrite E in U.
  replace (cv last (fun i => at_ a i / P) (fun j => at_ b j / P) g) with (cv last (at_ a) (at_ b) g / P / P).
  - unfold Rdiv at 1 3. apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat; assumption|]. exact U.
  - unfold cv. unfold Rdiv. rewrite Rmult_assoc, Rmult_comm, <- sum_scale. apply sum_ext. intros i _.
    rewrite <- sum_scale. apply sum_ext. intros j _. ring.
Qed.

Fixpoint rsum (l : list R) : R := match l with [] => 0 | x :: l' => x + rsum l' end.

Lemma length_pscale_to n c p : (length (pscale_to n c p) <= n)%nat.
Proof. revert p; induction n as [|n IH]; intros [|a p]; cbn; try lia. specialize (IH p). lia. Qed.
Lemma length_padd p : forall q, length (padd p q) = Nat.max (length p) (length q).
Proof. induction p as [|a p IH]; intros [|b q]; cbn; try reflexivity. rewrite IH. reflexivity. Qed.
Lemma length_pmul n : forall p q, (length (pmul n p q) <= n)%nat.
Proof.
  induction n as [|n IH]; intros [|a p] q; cbn [pmul length]; try lia. rewrite length_padd.
  pose proof (length_pscale_to (S n) a q). cbn [length]. specialize (IH p q). lia.
Qed.

Lemma monomial_product_is a b l :
  (length (fst (monomial_product f a b l)) <= kept f)%nat /\
  Rabs (rsum (map (fun ij => eval (nth (fst ij) a []) t * eval (nth (snd ij) b []) t) l)
        - eval (fst (monomial_product f a b l)) t) <= r_ (snd (monomial_product f a b l)).
Proof.
  induction l as [|[i j] l [IL IH]]; unfold monomial_product in *.
  - cbn. split; [lia|]. rewrite r_0, Rminus_0_r, Rabs_R0. lra.
  - cbn [fold_right fst snd map rsum] in *. split.
    + rewrite length_padd. apply Nat.max_lub; [apply length_pmul | exact IL].
    + rewrite eval_padd, r_add. pose proof (pmul_rest_is_a_bound (nth i a []) (kept f) (nth j b []) t t_in) as M.
      match goal with |- Rabs (?x + ?y - (?z + ?w)) <= _ => replace (x + y - (z + w)) with ((x - z) + (y - w)) by ring end.
      eapply Rle_trans; [apply Rabs_triang|]. apply Rplus_le_compat; [exact M | exact IH].
Qed.

Lemma rounded_are gs : forall ms k, length ms = length gs -> (forall g, In g gs -> (g <= top f)%nat) ->
  length (snd (rounded_products f gs ms)) = S last /\ length (fst (rounded_products f gs ms)) = length gs /\
  (forall m, (m < length gs)%nat ->
    nth m (fst (rounded_products f gs ms)) [] = map (fun c => down c (bits f)) (fst (nth m ms ([], 0%bigZ)))) /\
  at_ (snd (rounded_products f gs ms)) k = sum (length gs) (fun m => ind (k =? nth m gs O)%nat *
    r_ (rounding f (nth m gs O) + bound f (snd (nth m ms ([], 0%bigZ))) (scale f (nth m gs O) + bits f))%bigZ).
Proof.
  induction gs as [|g gs IH]; intros [|p ms] k Hl Hg; cbn in Hl; try lia.
  - cbn [rounded_products length sum fst snd]. repeat split; [apply length_nothing | intros m Hm; lia | apply at_nothing].
  - cbn [rounded_products fst snd]. destruct (IH ms k ltac:(lia) (fun g' Hg' => Hg g' (or_intror Hg'))) as (L & F & M & E).
    repeat split.
    + rewrite length_raise. assumption.
    + cbn [length]. rewrite F. reflexivity.
    + intros [|m] Hm; [reflexivity|]. cbn [nth]. apply M. cbn in Hm. lia.
    + rewrite at_raise by (rewrite L; pose proof (Hg g (or_introl eq_refl)); unfold last; lia).
      rewrite E. change (length (g :: gs)) with (S (length gs)). rewrite sum_shift. cbn [nth]. lra.
Qed.

Lemma scale_mult i j m : (i + j = m)%nat -> two_to (scale f i) * two_to (scale f j) = two_to (scale f m) * two_to (bits f).
Proof.
  intros <-. rewrite <- !two_to_add. unfold two_to, scale. f_equal.
  rewrite !BigZ.spec_add, !BigZ.spec_mul, !to_Z_of_nat, Nat2Z.inj_add. ring.
Qed.

Lemma rsum_scale c l : rsum (map (Rmult c) l) = c * rsum l.
Proof. induction l as [|x l IH]; cbn; [lra|]. rewrite IH. lra. Qed.

(* One monomial of a product, rounded. *)
Lemma one_monomial a b m : (m < N)%nat ->
  let mp := monomial_product f a b (nth m (pairs f) []) in
  Rabs (rsum (map (fun ij => value_of a (fst ij) * value_of b (snd ij)) (nth m (pairs f) []))
        - eval (map (fun c => down c (bits f)) (fst mp)) t / two_to (scale f (grade m)))
  <= r_ (rounding f (grade m) + bound f (snd mp) (scale f (grade m) + bits f))%bigZ / P.
Proof.
  intros Hm mp. destruct (monomial_product_is a b (nth m (pairs f) [])) as [L E]. fold mp in L, E.
  pose proof (rounding_is_bounded (bits f) (fst mp) t t_in) as D.
  pose proof (two_to_pos (scale f (grade m))) as Ps. pose proof (two_to_pos (bits f)) as Pb. pose proof P_pos as Pp.
  set (s := two_to (scale f (grade m))) in *. set (w := two_to (bits f)) in *.
  assert (C : rsum (map (fun ij => value_of a (fst ij) * value_of b (snd ij)) (nth m (pairs f) []))
              = / (s * w) * rsum (map (fun ij => eval (nth (fst ij) a []) t * eval (nth (snd ij) b []) t) (nth m (pairs f) []))).
  { rewrite <- rsum_scale, map_map. f_equal. apply map_ext_in. intros [i j] Hij. cbn [fst snd].
    destruct (pairs_are m i j Hm Hij) as (_ & _ & G & _). unfold value_of. unfold s, w. rewrite <- (scale_mult _ _ _ G).
    pose proof (two_to_pos (scale f (grade i))). pose proof (two_to_pos (scale f (grade j))). field. split; lra. }
  rewrite C. set (T := rsum _) in *. set (V := eval (fst mp) t) in *. set (W := eval (map _ (fst mp)) t) in *.
  rewrite r_add. unfold Rdiv at 2. rewrite Rmult_plus_distr_r.
  pose proof (bound_is_above (snd mp) (scale f (grade m) + bits f)%bigZ) as B2. rewrite two_to_add in B2. fold s w in B2.
  pose proof (bound_is_above (units f) (scale f (grade m))) as B1. fold s in B1.
  assert (Un : r_ (units f) = INR (kept f)) by (unfold units, r_; rewrite to_Z_of_nat; symmetry; apply INR_IZR_INZ).
  rewrite Un in B1. unfold rounding.
  replace (/ (s * w) * T - W / s) with ((T - V) * / (s * w) + (V / w - W) * / s) by (unfold Rdiv; field; split; lra).
  eapply Rle_trans; [apply Rabs_triang|]. rewrite !Rabs_mult.
  assert (Iw : 0 < / (s * w)) by (apply Rinv_0_lt_compat; nra). assert (Is : 0 < / s) by (apply Rinv_0_lt_compat; assumption).
  rewrite (Rabs_pos_eq (/ (s * w))), (Rabs_pos_eq (/ s)) by lra. rewrite (Rabs_minus_sym (V / w)).
  assert (K : INR (length (fst mp)) <= INR (kept f)) by (apply le_INR; assumption).
  unfold Rdiv in *. rewrite Rplus_comm. apply Rplus_le_compat.
  - eapply Rle_trans; [|exact B1]. apply Rmult_le_compat_r; lra.
  - eapply Rle_trans; [|exact B2]. apply Rmult_le_compat_r; lra.
Qed.

Lemma sum_product n m F G : sum n F * sum m G = sum n (fun i => sum m (fun j => F i * G j)).
Proof. rewrite Rmult_comm, <- sum_scale. apply sum_ext. intros i _. rewrite Rmult_comm, <- sum_scale. apply sum_ext. intros j _. ring. Qed.

(* Sums over grades of sums over monomials of a grade. *)
Lemma by_grade L n (gr : nat -> nat) (w : nat -> nat -> R) a b : (forall i, (i < n)%nat -> (gr i < L)%nat) ->
  sum L (fun g => sum L (fun h => w g h * (sum n (fun i => ind (g =? gr i)%nat * a i) * sum n (fun j => ind (h =? gr j)%nat * b j))))
  = sum n (fun i => sum n (fun j => w (gr i) (gr j) * (a i * b j))).
Proof.
  intros H.
  transitivity (sum L (fun g => sum L (fun h => sum n (fun i => sum n (fun j =>
    ind (g =? gr i)%nat * (ind (h =? gr j)%nat * (w g h * (a i * b j)))))))).
  { apply sum_ext. intros g _. apply sum_ext. intros h _. rewrite sum_product, <- sum_scale. apply sum_ext. intros i _.
    rewrite <- sum_scale. apply sum_ext. intros j _. ring. }
  transitivity (sum n (fun i => sum n (fun j => sum L (fun g => sum L (fun h =>
    ind (g =? gr i)%nat * (ind (h =? gr j)%nat * (w g h * (a i * b j)))))))).
  { transitivity (sum L (fun g => sum n (fun i => sum n (fun j => sum L (fun h =>
      ind (g =? gr i)%nat * (ind (h =? gr j)%nat * (w g h * (a i * b j)))))))).
    - apply sum_ext. intros g _. rewrite sum_swap. apply sum_ext. intros i _. apply sum_swap.
    - rewrite sum_swap. apply sum_ext. intros i _. apply sum_swap. }
  apply sum_ext. intros i Hi. apply sum_ext. intros j Hj.
  rewrite (sum_ext L _ (fun g => ind (g =? gr i)%nat * (w g (gr j) * (a i * b j)))).
  - apply (sum_one L (gr i) (fun g => w g (gr j) * (a i * b j))). apply H. assumption.
  - intros g _. rewrite sum_scale. f_equal. apply (sum_one L (gr j) (fun h => w g h * (a i * b j))). apply H. assumption.
Qed.

Lemma scal_mult_scal r s a b : mult (scal r a) (scal s b) = scal (r * s) (mult a b).
Proof. rewrite scal_mult, mult_comm, scal_mult, scal_scal, mult_comm. reflexivity. Qed.
Lemma product_of_terms c d :
  mult (asum N (fun i => scal (c i) (mono i))) (asum N (fun j => scal (d j) (mono j)))
  = asum N (fun i => asum N (fun j => scal (c i * d j) (mult (mono i) (mono j)))).
Proof.
  rewrite mult_comm, mult_asum. apply asum_ext. intros i _. rewrite mult_comm, mult_asum. apply asum_ext. intros j _.
  apply scal_mult_scal.
Qed.

(* What is kept of a product of known parts, and what lies beyond the top grade. *)
Definition beyond (c d : nat -> R) : A := asum N (fun i => asum N (fun j =>
  if (top f <? grade i + grade j)%nat then scal (c i * d j) (mult (mono i) (mono j)) else zero)).

Lemma kept_and_beyond c d :
  mult (asum N (fun i => scal (c i) (mono i))) (asum N (fun j => scal (d j) (mono j)))
  = plus (asum N (fun m => scal (rsum (map (fun ij => c (fst ij) * d (snd ij)) (nth m (pairs f) []))) (mono m))) (beyond c d).
Proof.
  rewrite product_of_terms. unfold beyond.
  set (K := fun i j => if (top f <? grade i + grade j)%nat then zero else scal (c i * d j) (mult (mono i) (mono j))).
  assert (S : asum N (fun m => scal (rsum (map (fun ij => c (fst ij) * d (snd ij)) (nth m (pairs f) []))) (mono m))
              = asum N (fun i => asum N (K i))).
  { rewrite pairs_complete.
    - apply asum_ext. intros m Hm.
      assert (G : forall l, (forall ij, In ij l -> In ij (nth m (pairs f) [])) ->
                scal (rsum (map (fun ij => c (fst ij) * d (snd ij)) l)) (mono m) = lsum (map (fun ij => K (fst ij) (snd ij)) l)).
      { induction l as [|[i j] l IH]; intros Hl; cbn; [apply scal_zero|].
        rewrite plus_scal. f_equal; [|apply IH; intros ij Hij; apply Hl; right; assumption].
        destruct (pairs_are m i j Hm (Hl (i, j) (or_introl eq_refl))) as (Hi & Hj & E & M). unfold K.
        replace (top f <? grade i + grade j)%nat with false; [rewrite M; reflexivity|].
        symmetry. apply Nat.ltb_ge. rewrite E. apply grades_kept. assumption. }
      apply G. trivial.
    - intros i j H. unfold K. apply Nat.ltb_lt in H. rewrite H. reflexivity. }
  rewrite S, <- asum_plus. apply asum_ext. intros i _. rewrite <- asum_plus. apply asum_ext. intros j _. unfold K.
  destruct (top f <? grade i + grade j)%nat; [rewrite plus_comm; symmetry; apply plus_zero | symmetry; apply plus_zero].
Qed.

Lemma sz_beyond_is c d g : (g <= last)%nat ->
  sz g (beyond c d) <= ind (g =? last)%nat * cv last (fun g => sum N (fun i => ind (g =? grade i)%nat * Rabs (c i)))
                                                   (fun g => sum N (fun i => ind (g =? grade i)%nat * Rabs (d i))) last.
Proof.
  intros Hg. unfold cv.
  rewrite (by_grade (S last) N grade (fun g h => ind (Nat.min (g + h) last =? last)%nat) (fun i => Rabs (c i)) (fun j => Rabs (d j)))
    by (intros i Hi; specialize (grades_kept i Hi); unfold last; lia).
  rewrite <- sum_scale. eapply Rle_trans; [apply sz_asum|]. apply sum_le. intros i Hi.
  rewrite <- sum_scale. eapply Rle_trans; [apply sz_asum|]. apply sum_le. intros j Hj. cbn beta.
  destruct (Nat.ltb_spec (top f) (grade i + grade j)) as [B|B].
  - eapply Rle_trans; [apply sz_scal|]. specialize (sz_beyond g i j Hi Hj B Hg).
    replace (Nat.min (grade i + grade j) last =? last)%nat with true by (symmetry; apply Nat.eqb_eq; unfold last; lia).
    rewrite Rabs_mult. cbn [ind].
    pose proof (Rabs_pos (c i)). pose proof (Rabs_pos (d j)).
    replace (ind (g =? last)%nat * (1 * (Rabs (c i) * Rabs (d j)))) with (Rabs (c i) * Rabs (d j) * ind (g =? last)%nat) by ring.
    apply Rmult_le_compat_l; [nra | assumption].
  - rewrite sz_zero. repeat apply Rmult_le_pos; try apply ind_nonneg; apply Rabs_pos.
Qed.

Lemma at_only_last v g : length v = S last -> (g <= last)%nat -> at_ (only_last v) g = ind (g =? last)%nat * at_ v last.
Proof.
  intros Hv Hg. unfold only_last. unfold at_ at 1.
  assert (E : pred (length v) = last) by (rewrite Hv; reflexivity). rewrite E.
  destruct (Nat.eqb_spec g last) as [->|H].
  - rewrite app_nth2 by (rewrite repeat_length; lia). rewrite repeat_length, Nat.sub_diag. cbn [nth ind].
    rewrite Rmult_1_l. unfold at_. f_equal.
    assert (G : forall l n, length l = S n -> List.last l 0%bigZ = nth n l 0%bigZ).
    { induction l as [|x l IH]; intros n Hn; cbn in Hn; [lia|]. destruct l as [|y l]; [cbn in Hn; assert (n = O) as -> by lia; reflexivity|].
      destruct n as [|n]; [cbn in Hn; lia|]. exact (IH n ltac:(cbn in *; lia)). }
    apply G. exact Hv.
  - rewrite app_nth1 by (rewrite repeat_length; lia). rewrite nth_repeat. cbn [ind]. rewrite r_0. lra.
Qed.

Lemma div_P_pos x : 0 <= x / P -> 0 <= x.
Proof.
  intros H. pose proof P_pos. replace x with (x / P * P) by (field; lra). apply Rmult_le_pos; lra.
Qed.
Lemma below_length {X : Type} (l : list X) g : length l = S last -> (g <= last)%nat -> (g < length l)%nat.
Proof. intros -> H. lia. Qed.

Theorem emul_sound x y u v : good x -> good y -> contains x u -> contains y v ->
  good (emul f x y) /\ contains (emul f x y) (mult u v).
Proof.
  intros Gx Gy (d & -> & Hd) (d' & -> & Hd'). pose proof Gx as (Lx & Ex & Sx & Bx). pose proof Gy as (Ly & Ey & Sy & By).
  pose proof P_pos as Pp.
  unfold emul. set (ms := map (monomial_product f (known x) (known y)) (pairs f)).
  set (found := rounded_products f (grades f) ms).
  assert (Lm : length ms = length (grades f)) by (unfold ms; rewrite map_length; exact number_of_pairs).
  assert (GK : forall g, In g (grades f) -> (g <= top f)%nat).
  { intros g Hin. apply (In_nth _ _ O) in Hin as (i & Hi & <-). apply (grades_kept i Hi). }
  destruct (rounded_are (grades f) ms O Lm GK) as (L1 & L2 & M & _).
  fold found in L1, L2, M.
  set (overflow := only_last (conv f (size x) (size y))).
  set (mixed := nadd (conv f (size x) (unknown y)) (conv f (unknown x) (nadd (size y) (unknown y)))).
  assert (Lc : forall a b, length b = S last -> length (conv f a b) = S last)
    by (intros a b Hb; unfold conv; rewrite map_length, length_products; exact Hb).
  assert (Lsum : length (nadd (size y) (unknown y)) = S last) by (rewrite length_nadd; [exact Sy | rewrite Sy; exact Ey]).
  assert (Lmix : length mixed = S last).
  { unfold mixed. rewrite length_nadd; [apply Lc; exact Ey | rewrite !Lc by assumption; reflexivity]. }
  assert (Lov : length overflow = S last).
  { unfold overflow, only_last. rewrite app_length, repeat_length. rewrite Lc by exact Sy. cbn. lia. }
  assert (Lom : length (nadd overflow mixed) = S last) by (rewrite length_nadd; [exact Lov | rewrite Lov; exact Lmix]).
  assert (Lall : length (nadd (snd found) (nadd overflow mixed)) = S last)
    by (rewrite length_nadd; [exact L1 | rewrite L1; exact Lom]).
  split; [apply good_element_of; [exact L2 | exact Lall]|].
  set (c := value_of (known x)). set (e := value_of (known y)).
  set (C := fun m => rsum (map (fun ij => c (fst ij) * e (snd ij)) (nth m (pairs f) []))).
  set (V := value_of (fst found)).
  set (X := known_part (known x)) in *. set (Y := known_part (known y)) in *.
  exists (plus (plus (asum N (fun m => scal (C m - V m) (mono m))) (beyond c e)) (plus (mult X d') (mult d (plus Y d')))).
  split.
  - cbn [known element_of].
    assert (E1 : mult (plus X d) (plus Y d') = plus (mult X Y) (plus (mult X d') (mult d (plus Y d')))).
    { rewrite (mult_comm (plus X d)), mult_plus, (mult_comm (plus Y d') X), (mult_comm (plus Y d') d), mult_plus.
      symmetry. apply plus_assoc. }
    rewrite E1. rewrite (plus_assoc (known_part (fst found))). f_equal.
    unfold X, Y, known_part. rewrite kept_and_beyond.
    rewrite (plus_assoc (asum N (fun i => scal (value_of (fst found) i) (mono i)))). f_equal.
    rewrite <- asum_plus. apply asum_ext. intros m _. rewrite <- plus_scal. f_equal. unfold C, V, c, e. lra.
  - intros g Hg. cbn [unknown element_of].
    rewrite at_nadd by (apply below_length; assumption). rewrite (at_nadd overflow) by (apply below_length; assumption).
    assert (Q1 : sz g (asum N (fun m => scal (C m - V m) (mono m))) <= at_ (snd found) g / P).
    { eapply Rle_trans; [apply sz_terms; assumption|]. destruct (rounded_are (grades f) ms g Lm GK) as (_ & _ & _ & E).
      fold found in E. rewrite E. unfold Rdiv. rewrite Rmult_comm, <- sum_scale. apply sum_le. intros m Hm.
      replace (/ P * (ind (g =? nth m (grades f) 0)%nat * r_ (rounding f (nth m (grades f) 0%nat)
                 + bound f (snd (nth m ms ([], 0%bigZ))) (scale f (nth m (grades f) 0%nat) + bits f))%bigZ))
        with (ind (g =? grade m)%nat * (r_ (rounding f (grade m)
                 + bound f (snd (nth m ms ([], 0%bigZ))) (scale f (grade m) + bits f))%bigZ / P)) by (unfold Rdiv, grade; ring).
      apply Rmult_le_compat_l; [apply ind_nonneg|].
      assert (Em : nth m ms ([], 0%bigZ) = monomial_product f (known x) (known y) (nth m (pairs f) [])).
      { unfold ms. rewrite (nth_indep _ _ (monomial_product f (known x) (known y) []))
          by (rewrite map_length, number_of_pairs; exact Hm). apply map_nth. }
      pose proof (one_monomial (known x) (known y) m Hm) as O. cbv zeta in O. rewrite Em.
      unfold C, V. change (value_of (fst found) m) with (eval (nth m (fst found) []) t / two_to (scale f (grade m))).
      rewrite (M m Hm), Em. exact O. }
    assert (Q2 : sz g (beyond c e) <= at_ overflow g / P).
    { eapply Rle_trans; [apply sz_beyond_is; assumption|]. unfold overflow.
      rewrite at_only_last by (try apply Lc; assumption). unfold Rdiv. rewrite Rmult_assoc.
      apply Rmult_le_compat_l; [apply ind_nonneg|].
      eapply Rle_trans; [|apply (at_conv (size x) (size y) last Sx Sy (le_n _))].
      apply cv_le; intros i Hi; (split; [apply sum_nonneg; intros; apply Rmult_le_pos; [apply ind_nonneg | apply Rabs_pos]|]);
        [apply Bx | apply By]; assumption. }
    assert (Q3 : sz g (mult X d') <= at_ (conv f (size x) (unknown y)) g / P).
    { eapply Rle_trans; [apply sz_mult; assumption|].
      eapply Rle_trans; [|apply (at_conv (size x) (unknown y) g Sx Ey Hg)].
      apply cv_le; intros i Hi; (split; [apply sz_nonneg|]); [apply sz_known; assumption | apply Hd'; assumption]. }
    assert (Q4 : sz g (mult d (plus Y d')) <= at_ (conv f (unknown x) (nadd (size y) (unknown y))) g / P).
    { eapply Rle_trans; [apply sz_mult; assumption|].
      eapply Rle_trans; [|apply (at_conv (unknown x) (nadd (size y) (unknown y)) g Ex Lsum Hg)].
      apply cv_le; intros i Hi; (split; [apply sz_nonneg|]); [apply Hd; assumption|].
      rewrite at_nadd by (apply below_length; assumption). eapply Rle_trans; [apply sz_plus|].
      pose proof (sz_known y i Gy Hi). pose proof (Hd' i Hi). unfold Rdiv in *. fold Y in H. lra. }
    assert (Emix : at_ mixed g = at_ (conv f (size x) (unknown y)) g + at_ (conv f (unknown x) (nadd (size y) (unknown y))) g)
      by (apply at_nadd; apply below_length; try apply Lc; assumption).
    rewrite Emix. eapply Rle_trans; [apply sz_plus|]. 
    pose proof (sz_plus g (asum N (fun m => scal (C m - V m) (mono m))) (beyond c e)).
    pose proof (sz_plus g (mult X d') (mult d (plus Y d'))). unfold Rdiv in *. lra.
Qed.

(* No polynomial of an element has powers that are not kept. *)
Definition short (x : element) : Prop := forall i, (length (nth i (known x) []) <= kept f)%nat.

Lemma short_eadd x y : good x -> good y -> short x -> short y -> short (eadd f x y).
Proof.
  intros (Lx & _) (Ly & _) Hx Hy i. unfold eadd. cbn [known element_of].
  rewrite nth_map2_padd by (rewrite Lx, Ly; reflexivity). rewrite length_padd. apply Nat.max_lub; [apply Hx | apply Hy].
Qed.
Lemma short_emul x y : short (emul f x y).
Proof.
  intros i. unfold emul. cbn [known element_of]. set (ms := map (monomial_product f (known x) (known y)) (pairs f)).
  assert (Lm : length ms = length (grades f)) by (unfold ms; rewrite map_length; exact number_of_pairs).
  assert (GK : forall g, In g (grades f) -> (g <= top f)%nat).
  { intros g Hin. apply (In_nth _ _ O) in Hin as (j & Hj & <-). apply (grades_kept j Hj). }
  destruct (rounded_are (grades f) ms O Lm GK) as (_ & L2 & M & _).
  destruct (Nat.lt_ge_cases i (length (grades f))) as [Hi|Hi].
  - rewrite (M i Hi), map_length. unfold ms.
    rewrite (nth_indep _ _ (monomial_product f (known x) (known y) [])) by (rewrite map_length, number_of_pairs; exact Hi).
    rewrite map_nth. apply monomial_product_is.
  - rewrite nth_overflow by (rewrite L2; exact Hi). cbn. lia.
Qed.

Lemma eval_map_opp p : eval (map BigZ.opp p) t = -1 * eval p t.
Proof. rewrite eval_opp. lra. Qed.
Lemma nth_map2_psub a : forall b i, length a = length b -> nth i (map2 psub a b) [] = psub (nth i a []) (nth i b []).
Proof.
  induction a as [|p a IH]; intros [|q b] i H; cbn in H; try lia; [destruct i; reflexivity|].
  destruct i as [|i]; [reflexivity|]. cbn. apply IH. lia.
Qed.
Theorem esub_sound x y u v : good x -> good y -> contains x u -> contains y v ->
  good (esub f x y) /\ contains (esub f x y) (plus u (scal (-1) v)).
Proof.
  intros (Lx & Ex & _ & _) (Ly & Ey & _ & _) (d & -> & Hd) (d' & -> & Hd').
  assert (K : length (known x) = length (known y)) by (rewrite Lx, Ly; reflexivity).
  assert (U : length (nadd (unknown x) (unknown y)) = S last) by (rewrite length_nadd; [exact Ex | rewrite Ex; exact Ey]).
  unfold esub. split; [apply good_element_of; [rewrite length_map2; assumption | exact U]|].
  exists (plus d (scal (-1) d')). split.
  - rewrite scal_plus, plus_swap. f_equal. unfold known_part. cbn [known element_of]. rewrite <- asum_scal, <- asum_plus.
    apply asum_ext. intros i _. rewrite scal_scal, <- plus_scal. f_equal. unfold value_of. rewrite nth_map2_psub by exact K.
    rewrite eval_psub. unfold Rdiv. ring.
  - intros g Hg. cbn [unknown element_of].
    rewrite at_nadd by (apply below_length; assumption).
    specialize (Hd g Hg). specialize (Hd' g Hg). eapply Rle_trans; [apply sz_plus|].
    pose proof (sz_scal g (-1) d') as Q. replace (Rabs (-1)) with 1 in Q by (rewrite Rabs_left; lra). unfold Rdiv in *. lra.
Qed.

(* Multiples by rational numbers. *)
Lemma rational_up a b : (0 < BigZ.to_Z b)%Z -> r_ a / r_ b <= r_ (- BigZ.div (- a) b)%bigZ.
Proof.
  intros Hb. rewrite r_opp. unfold r_. rewrite BigZ.spec_div, BigZ.spec_opp.
  assert (0 < IZR (BigZ.to_Z b)) by (apply IZR_lt; assumption).
  pose proof (Z.mul_div_le (- BigZ.to_Z a) _ Hb) as H1. apply IZR_le in H1. rewrite mult_IZR, opp_IZR in H1.
  apply (Rmult_le_reg_l (IZR (BigZ.to_Z b))); [assumption|].
  replace (IZR (BigZ.to_Z b) * (IZR (BigZ.to_Z a) / IZR (BigZ.to_Z b))) with (IZR (BigZ.to_Z a)) by (field; lra). lra.
Qed.
Lemma rational_floor a b : (0 < BigZ.to_Z b)%Z -> r_ (BigZ.div a b) <= r_ a / r_ b < r_ (BigZ.div a b) + 1.
Proof.
  intros Hb. unfold r_. rewrite BigZ.spec_div. assert (0 < IZR (BigZ.to_Z b)) by (apply IZR_lt; assumption).
  pose proof (Z.mul_div_le (BigZ.to_Z a) _ Hb) as H1. pose proof (Z.mul_succ_div_gt (BigZ.to_Z a) _ Hb) as H2.
  apply IZR_le in H1. apply IZR_lt in H2. rewrite mult_IZR in H1, H2. rewrite succ_IZR in H2.
  split.
  - apply (Rmult_le_reg_l (IZR (BigZ.to_Z b))); [assumption|].
    replace (IZR (BigZ.to_Z b) * (IZR (BigZ.to_Z a) / IZR (BigZ.to_Z b))) with (IZR (BigZ.to_Z a)) by (field; lra). lra.
  - apply (Rmult_lt_reg_l (IZR (BigZ.to_Z b))); [assumption|].
    replace (IZR (BigZ.to_Z b) * (IZR (BigZ.to_Z a) / IZR (BigZ.to_Z b))) with (IZR (BigZ.to_Z a)) by (field; lra). lra.
Qed.
Lemma eval_divided n d p : (0 < BigZ.to_Z d)%Z ->
  Rabs (eval (map (fun c => BigZ.div (n * c) d) p) t - r_ n / r_ d * eval p t) <= INR (length p).
Proof.
  intros Hd. induction p as [|a p IH].
  - cbn. rewrite Rmult_0_r, Rminus_0_r, Rabs_R0. lra.
  - cbn [map eval length]. rewrite S_INR. pose proof (rational_floor (n * a)%bigZ d Hd) as Ha. rewrite r_mul in Ha.
    replace (r_ (BigZ.div (n * a) d) + t * eval (map (fun c => BigZ.div (n * c) d) p) t - r_ n / r_ d * (r_ a + t * eval p t))
      with ((r_ (BigZ.div (n * a) d) - r_ n * r_ a / r_ d)
            + t * (eval (map (fun c => BigZ.div (n * c) d) p) t - r_ n / r_ d * eval p t)) by (unfold Rdiv; ring).
    eapply Rle_trans; [apply Rabs_triang|]. rewrite Rabs_mult, (Rabs_pos_eq t) by lra.
    assert (Rabs (r_ (BigZ.div (n * a) d) - r_ n * r_ a / r_ d) <= 1) by (apply Rabs_le; lra).
    pose proof (Rabs_pos (eval (map (fun c => BigZ.div (n * c) d) p) t - r_ n / r_ d * eval p t)). pose proof (pos_INR (length p)). nra.
Qed.
Lemma nth_map_poly (phi : poly -> poly) l i : phi [] = [] -> nth i (map phi l) [] = phi (nth i l []).
Proof. intros H. rewrite <- H at 1. apply map_nth. Qed.

Lemma raised_are gs (h : nat -> bigZ) e k : length e = S last -> (forall g, In g gs -> (g <= top f)%nat) ->
  length (fold_right (fun g e => raise g (h g) e) e gs) = S last /\
  at_ (fold_right (fun g e => raise g (h g) e) e gs) k
  = at_ e k + sum (length gs) (fun i => ind (k =? nth i gs O)%nat * r_ (h (nth i gs O))).
Proof.
  intros He. induction gs as [|g gs IH]; intros Hg.
  - cbn. split; [exact He | lra].
  - cbn [fold_right]. destruct (IH (fun g' Hg' => Hg g' (or_intror Hg'))) as [L E].
    split; [rewrite length_raise; exact L|].
    rewrite at_raise by (rewrite L; pose proof (Hg g (or_introl eq_refl)); unfold last; lia).
    rewrite E. change (length (g :: gs)) with (S (length gs)). rewrite sum_shift. cbn [nth]. lra.
Qed.

Theorem escale_sound n d x u : (0 < BigZ.to_Z d)%Z -> good x -> short x -> contains x u ->
  good (escale f n d x) /\ short (escale f n d x) /\ contains (escale f n d x) (scal (r_ n / r_ d) u).
Proof.
  intros Pd (Lx & Ex & _ & _) Hs (z & -> & Hz). pose proof P_pos as Pp.
  assert (Rd : 0 < r_ d) by (unfold r_; apply IZR_lt; assumption).
  set (errors := map (fun e => (- BigZ.div (- (BigZ.abs n * e)) d)%bigZ) (unknown x)).
  assert (Le : length errors = S last) by (unfold errors; rewrite map_length; exact Ex).
  assert (Q : forall g, (g <= last)%nat -> sz g (scal (r_ n / r_ d) z) <= at_ errors g / P).
  { intros g Hg. unfold errors. rewrite at_map by (apply below_length; assumption).
    pose proof (rational_up (BigZ.abs n * nth g (unknown x) 0)%bigZ d Pd) as U. rewrite r_mul, r_abs in U.
    eapply Rle_trans; [apply sz_scal|]. unfold Rdiv at 1. rewrite Rabs_mult, (Rabs_pos_eq (/ r_ d)) by (left; apply Rinv_0_lt_compat; assumption).
    specialize (Hz g Hg). unfold at_ in Hz. pose proof (Rabs_pos (r_ n)). pose proof (sz_nonneg g z).
    assert (I1 : 0 < / r_ d) by (apply Rinv_0_lt_compat; assumption). assert (I2 : 0 < / P) by (apply Rinv_0_lt_compat; assumption).
    apply (Rle_trans _ (Rabs (r_ n) * / r_ d * (r_ (nth g (unknown x) 0%bigZ) / P))).
    - apply Rmult_le_compat_l; [nra | assumption].
    - unfold Rdiv in *. replace (Rabs (r_ n) * / r_ d * (r_ (nth g (unknown x) 0%bigZ) * / P))
        with (Rabs (r_ n) * r_ (nth g (unknown x) 0%bigZ) * / r_ d * / P) by ring.
      apply Rmult_le_compat_r; [lra|]. exact U. }
  unfold escale. fold errors. rewrite BigZ.spec_eqb. destruct (Z.eqb_spec (BigZ.to_Z d) (BigZ.to_Z 1%bigZ)) as [E1|E1].
  - assert (D1 : r_ d = 1) by (unfold r_; rewrite E1; reflexivity).
    split; [apply good_element_of; [rewrite map_length; exact Lx | exact Le]|]. split.
    + intros i. cbn [known element_of]. rewrite nth_map_poly by reflexivity. unfold pscale. rewrite map_length. apply Hs.
    + exists (scal (r_ n / r_ d) z). split; [|exact Q]. rewrite scal_plus. f_equal. unfold known_part. cbn [known element_of].
      rewrite <- asum_scal. apply asum_ext. intros i _. rewrite scal_scal. f_equal. unfold value_of.
      rewrite nth_map_poly by reflexivity. rewrite eval_pscale, D1. unfold Rdiv. rewrite Rinv_1. ring.
  - assert (GK : forall g, In g (grades f) -> (g <= top f)%nat).
    { intros g Hin. apply (In_nth _ _ O) in Hin as (j & Hj & <-). apply (grades_kept j Hj). }
    destruct (raised_are (grades f) (rounding f) errors O Le GK) as [L _].
    split; [apply good_element_of; [rewrite map_length; exact Lx | exact L]|]. split.
    + intros i. cbn [known element_of]. rewrite nth_map_poly by reflexivity. rewrite map_length. apply Hs.
    + set (V := fun i => value_of (map (map (fun c => BigZ.div (n * c) d)) (known x)) i).
      set (W := fun i => r_ n / r_ d * value_of (known x) i).
      exists (plus (asum N (fun i => scal (W i - V i) (mono i))) (scal (r_ n / r_ d) z)). split.
      * rewrite scal_plus, plus_assoc. f_equal. unfold known_part. cbn [known element_of]. rewrite <- asum_scal, <- asum_plus.
        apply asum_ext. intros i _. rewrite scal_scal, <- plus_scal. f_equal. unfold V, W. lra.
      * intros g Hg. cbn [unknown element_of]. destruct (raised_are (grades f) (rounding f) errors g Le GK) as [_ E]. rewrite E.
        assert (Ed : forall a b, (a + b) / P = b / P + a / P) by (intros; unfold Rdiv; ring).
        assert (Es : forall a, a / P = / P * a) by (intros; unfold Rdiv; ring).
        rewrite Ed. eapply Rle_trans; [apply sz_plus|].
        apply Rplus_le_compat; [|exact (Q g Hg)].
        eapply Rle_trans; [apply sz_terms; assumption|]. rewrite Es, <- sum_scale. apply sum_le. intros i Hi.
        replace (/ P * (ind (g =? nth i (grades f) 0)%nat * r_ (rounding f (nth i (grades f) 0%nat))))
          with (ind (g =? grade i)%nat * (r_ (rounding f (grade i)) / P)) by (unfold Rdiv, grade; ring).
        apply Rmult_le_compat_l; [apply ind_nonneg|]. unfold rounding.
        pose proof (bound_is_above (units f) (scale f (grade i))) as B.
        eapply Rle_trans; [|exact B].
        assert (Un : r_ (units f) = INR (kept f)) by (unfold units, r_; rewrite to_Z_of_nat; symmetry; apply INR_IZR_INZ).
        rewrite Un. unfold V, W, value_of. rewrite nth_map_poly by reflexivity.
        pose proof (two_to_pos (scale f (grade i))) as Ps.
        pose proof (eval_divided n d (nth i (known x) []) Pd) as D. pose proof (le_INR _ _ (Hs i)) as K.
        assert (I3 : 0 < / two_to (scale f (grade i))) by (apply Rinv_0_lt_compat; assumption).
        replace (r_ n / r_ d * (eval (nth i (known x) []) t / two_to (scale f (grade i)))
                 - eval (map (fun c => BigZ.div (n * c) d) (nth i (known x) [])) t / two_to (scale f (grade i)))
          with ((r_ n / r_ d * eval (nth i (known x) []) t - eval (map (fun c => BigZ.div (n * c) d) (nth i (known x) [])) t)
                * / two_to (scale f (grade i))) by (unfold Rdiv; ring).
        rewrite Rabs_mult, (Rabs_pos_eq (/ _)) by lra. rewrite Rabs_minus_sym.
        apply Rmult_le_compat_r; [lra|]. eapply Rle_trans; [exact D | exact K].
Qed.

(* Numbers. The first monomial is the unit, and the only one of grade 0. *)
Variable unit : A.
Hypothesis N_pos : (0 < N)%nat.
Hypothesis mono_unit : mono O = unit.
Hypothesis grade_unit : forall i, (i < N)%nat -> (grade i = O <-> i = O).
Hypothesis bits_nonneg : (0 <= BigZ.to_Z (bits f))%Z.
Hypothesis kept_pos : (1 <= kept f)%nat.

Lemma nth_map_in {X Y : Type} (phi : X -> Y) l dx dy : forall i, (i < length l)%nat -> nth i (map phi l) dy = phi (nth i l dx).
Proof. induction l as [|x l IH]; intros [|i] H; cbn in *; try lia; [reflexivity|]. apply IH. lia. Qed.
Lemma nth_of_grade (c : poly) i : nth i (map (fun g => match g with O => c | _ => [] end) (grades f)) [] =
  if (i <? N)%nat then match grade i with O => c | _ => [] end else [].
Proof.
  destruct (Nat.ltb_spec i N) as [H|H].
  - rewrite (nth_map_in _ _ O) by exact H. reflexivity.
  - apply nth_overflow. rewrite map_length. exact H.
Qed.
Lemma asum_first n c F : (0 < n)%nat -> (forall i, (i < n)%nat -> i <> O -> F i = zero) -> F O = c -> asum n F = c.
Proof.
  intros Hn HF H0. induction n as [|n IH]; [lia|]. destruct n as [|n].
  - cbn. rewrite H0, plus_comm. apply plus_zero.
  - change (asum (S (S n)) F) with (plus (asum (S n) F) (F (S n))). rewrite (HF (S n)) by lia. rewrite plus_zero.
    apply IH; [lia|]. intros i Hi. apply HF. lia.
Qed.

Theorem econst_sound a b : (0 < BigZ.to_Z b)%Z ->
  good (econst f a b) /\ short (econst f a b) /\ contains (econst f a b) (scal (r_ a / r_ b) unit).
Proof.
  intros Pb. pose proof P_pos as Pp. pose proof (two_to_pos (bits f)) as Pw.
  assert (Rb : 0 < r_ b) by (unfold r_; apply IZR_lt; assumption).
  unfold econst. set (c := BigZ.div (BigZ.shiftl a (bits f)) b).
  set (e := if (c * b =? BigZ.shiftl a (bits f))%bigZ then 0%bigZ else bound f 1 (bits f)).
  set (ps := map (fun g => match g with O => [c] | _ => [] end) (grades f)).
  assert (Le : length (raise O e (nothing f)) = S last) by (rewrite length_raise; apply length_nothing).
  assert (S : r_ (BigZ.shiftl a (bits f)) = r_ a * two_to (bits f)) by (destruct (r_shiftl a (bits f)) as [E|E]; [exact E | lia]).
  split; [apply good_element_of; [unfold ps; rewrite map_length; reflexivity | exact Le]|]. split.
  - intros i. cbn [known element_of]. unfold ps. rewrite nth_of_grade. destruct (i <? N)%nat; [|cbn; lia].
    destruct (grade i); cbn; lia.
  - set (r := r_ a / r_ b - r_ c / two_to (bits f)).
    assert (Kp : known_part ps = scal (r_ c / two_to (bits f)) unit).
    { unfold known_part. apply asum_first; [exact N_pos | |].
      - intros i Hi Hi0. unfold value_of, ps. rewrite nth_of_grade. rewrite (proj2 (Nat.ltb_lt i N) Hi).
        destruct (grade i) eqn:G; [exfalso; apply Hi0; exact (proj1 (grade_unit i Hi) G)|]. cbn. unfold Rdiv. rewrite Rmult_0_l. apply scal_zero.
      - unfold value_of, ps. rewrite nth_of_grade. rewrite (proj2 (Nat.ltb_lt O N) N_pos).
        rewrite (proj2 (grade_unit O N_pos) eq_refl). rewrite mono_unit. f_equal. cbn [eval]. rewrite Rmult_0_r, Rplus_0_r.
        f_equal. unfold two_to, scale. f_equal. rewrite BigZ.spec_add, BigZ.spec_mul, to_Z_of_nat. cbn. lia. }
    exists (scal r unit). split.
    + cbn [known element_of]. rewrite Kp, <- plus_scal. f_equal. unfold r. lra.
    + intros g Hg. cbn [unknown element_of]. rewrite at_raise by (rewrite length_nothing; lia). rewrite at_nothing, Rplus_0_l.
      eapply Rle_trans; [apply sz_scal|].
      assert (U : sz g unit <= ind (g =? 0)%nat).
      { rewrite <- mono_unit. eapply Rle_trans; [apply sz_mono; assumption|]. rewrite (proj2 (grade_unit O N_pos) eq_refl). lra. }
      assert (B : Rabs r <= r_ e / P).
      { pose proof (rational_floor (BigZ.shiftl a (bits f)) b Pb) as F. fold c in F. rewrite S in F.
        assert (Er : r = (r_ a * two_to (bits f) / r_ b - r_ c) / two_to (bits f)) by (unfold r; field; lra).
        unfold e. destruct (c * b =? BigZ.shiftl a (bits f))%bigZ eqn:X.
        - rewrite BigZ.spec_eqb in X. apply Z.eqb_eq in X.
          assert (X' : r_ c * r_ b = r_ a * two_to (bits f)) by (rewrite <- r_mul, <- S; unfold r_; rewrite X; reflexivity).
          rewrite Er, <- X'. replace (r_ c * r_ b / r_ b - r_ c) with 0 by (field; lra). unfold Rdiv. rewrite Rmult_0_l, Rabs_R0, r_0. lra.
        - pose proof (bound_is_above 1%bigZ (bits f)) as Q. rewrite r_1 in Q. eapply Rle_trans; [|exact Q].
          rewrite Er. unfold Rdiv. rewrite Rabs_mult, (Rabs_pos_eq (/ _)) by (left; apply Rinv_0_lt_compat; assumption).
          apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat; assumption|]. apply Rabs_le. unfold Rdiv in F. lra. }
      pose proof (Rabs_pos r). pose proof (sz_nonneg g unit). pose proof (ind_nonneg (g =? 0)%nat).
      apply (Rle_trans _ (Rabs r * ind (g =? 0)%nat)); [apply Rmult_le_compat_l; assumption|].
      unfold Rdiv in *. rewrite (Rmult_comm (Rabs r)), Rmult_assoc. apply Rmult_le_compat_l; assumption.
Qed.

(* Programs without powers. *)
Definition node_in (values : list A) (n : node) : A :=
  let v i := nth i values zero in
  match n with
  | Const a b => scal (r_ a / r_ b) unit
  | Add i j => plus (v i) (v j)
  | Sub i j => plus (v i) (scal (-1) (v j))
  | Mul i j => mult (v i) (v j)
  | Scale i a b => scal (r_ a / r_ b) (v i)
  | Power _ _ _ => zero
  end.
Definition run_in (ns : list node) (values : list A) : list A := fold_left (fun vs n => vs ++ [node_in vs n]) ns values.
Definition no_power (n : node) : Prop := match n with Power _ _ _ => False | _ => True end.
Definition right_ (x : element) (u : A) : Prop := good x /\ short x /\ contains x u.

Lemma short_esub x y : good x -> good y -> short x -> short y -> short (esub f x y).
Proof.
  intros (Lx & _) (Ly & _) Hx Hy i. unfold esub. cbn [known element_of].
  rewrite nth_map2_psub by (rewrite Lx, Ly; reflexivity). unfold psub. rewrite length_padd, map_length. apply Nat.max_lub; [apply Hx | apply Hy].
Qed.
Lemma right_nth xs us i : Forall2 right_ xs us -> (i < length xs)%nat -> right_ (nth i xs missing) (nth i us zero).
Proof.
  intros H. revert i. induction H as [|x u xs us Hx H IH]; intros [|i] Hi; cbn in *; try lia; [exact Hx|]. apply IH. lia.
Qed.

Theorem run_sound ns : forall xs us gs out, Forall no_power ns -> well_formed_from (length xs) ns = true ->
  Forall2 right_ xs us -> run f ns xs gs = Some out -> Forall2 right_ out (run_in ns us).
Proof.
  induction ns as [|n ns IH]; intros xs us gs out Hn Hw Hr Hrun.
  - cbn in Hrun. injection Hrun as <-. exact Hr.
  - cbn [well_formed_from] in Hw. apply Bool.andb_true_iff in Hw as [Hp Hw]. inversion Hn as [|n' ns' Hn1 Hn2]; subst n' ns'.
    assert (Place : forall i, In i (places_of n) -> right_ (nth i xs missing) (nth i us zero)).
    { intros i Hi. apply right_nth; [exact Hr|]. rewrite forallb_forall in Hp. apply Nat.ltb_lt. apply Hp. exact Hi. }
    assert (Next : forall x, right_ x (node_in us n) -> run f ns (xs ++ [x]) gs = Some out -> Forall2 right_ out (run_in (n :: ns) us)).
    { intros x Hx Hgo. cbn [run_in fold_left]. eapply IH; [exact Hn2 | | | exact Hgo].
      - rewrite app_length. cbn. rewrite Nat.add_1_r. exact Hw.
      - apply Forall2_app; [exact Hr|]. constructor; [exact Hx | constructor]. }
    destruct n as [a b | i j | i j | i j | i a b | i p q]; cbn [run] in Hrun; cbn [places_of] in Place.
    + destruct (0 <? b)%bigZ eqn:B; [|discriminate]. apply (Next _ (econst_sound a b ltac:(apply BigZ.ltb_lt in B; exact B)) Hrun).
    + destruct (Place i) as (G1 & S1 & C1); [cbn; tauto|]. destruct (Place j) as (G2 & S2 & C2); [cbn; tauto|].
      destruct (eadd_sound _ _ _ _ G1 G2 C1 C2) as [G C].
      apply (Next _ (conj G (conj (short_eadd _ _ G1 G2 S1 S2) C)) Hrun).
    + destruct (Place i) as (G1 & S1 & C1); [cbn; tauto|]. destruct (Place j) as (G2 & S2 & C2); [cbn; tauto|].
      destruct (esub_sound _ _ _ _ G1 G2 C1 C2) as [G C].
      apply (Next _ (conj G (conj (short_esub _ _ G1 G2 S1 S2) C)) Hrun).
    + destruct (Place i) as (G1 & S1 & C1); [cbn; tauto|]. destruct (Place j) as (G2 & S2 & C2); [cbn; tauto|].
      destruct (emul_sound _ _ _ _ G1 G2 C1 C2) as [G C]. apply (Next _ (conj G (conj (short_emul _ _) C)) Hrun).
    + destruct (0 <? b)%bigZ eqn:B; [|discriminate]. destruct (Place i) as (G1 & S1 & C1); [cbn; tauto|].
      apply (Next _ (escale_sound a b _ _ ltac:(apply BigZ.ltb_lt in B; exact B) G1 S1 C1) Hrun).
    + contradiction.
Qed.

(* The defect of an approximate solution x, one component of it, where `value` contains that component of the field on x. *)
Lemma defects_are gs num den : forall xs vs k, length xs = length gs -> length vs = length gs ->
  (forall g, In g gs -> (g <= top f)%nat) ->
  let term := fun i => bound f (l1 (psub (pscale num (nth i vs [])) (map (fun c => BigZ.shiftl c den) (pderiv (nth i xs [])))))
                         (scale f (nth i gs O) + den)%bigZ in
  let e := fold_right (fun gpq e => let '(g, (p, q)) := gpq in
    raise g (bound f (l1 (psub (pscale num q) (map (fun c => BigZ.shiftl c den) (pderiv p)))) (scale f g + den)%bigZ) e)
    (nothing f) (combine gs (combine xs vs)) in
  length e = S last /\ at_ e k = sum (length gs) (fun i => ind (k =? nth i gs O)%nat * r_ (term i)).
Proof.
  induction gs as [|g gs IH]; intros [|p xs] [|q vs] k Hx Hv Hg; cbn in Hx, Hv; try lia.
  - cbn [fold_right combine length sum]. cbv zeta. split; [apply length_nothing | apply at_nothing].
  - cbn [combine fold_right]. cbv zeta.
    destruct (IH xs vs k ltac:(lia) ltac:(lia) (fun g' Hg' => Hg g' (or_intror Hg'))) as [L E].
    split; [rewrite length_raise; exact L|].
    rewrite at_raise by (rewrite L; pose proof (Hg g (or_introl eq_refl)); unfold last; lia).
    rewrite E. change (length (g :: gs)) with (S (length gs)). rewrite sum_shift. cbn [nth]. lra.
Qed.
Lemma eval_shiftl den p : (0 <= BigZ.to_Z den)%Z -> eval (map (fun c => BigZ.shiftl c den) p) t = two_to den * eval p t.
Proof.
  intros H. induction p as [|a p IH]; cbn [map eval]; [lra|]. rewrite IH. destruct (r_shiftl a den) as [E|E]; [rewrite E; ring | lia].
Qed.

Definition rate_of (xs : list poly) : A :=
  asum N (fun i => scal (eval (pderiv (nth i xs [])) t / two_to (scale f (grade i))) (mono i)).

Theorem defect_is_bounded num den xs value F g :
  (0 <= BigZ.to_Z num)%Z -> (0 <= BigZ.to_Z den)%Z -> length xs = N -> good value -> contains value F -> (g <= last)%nat ->
  sz g (plus (scal (r_ num / two_to den) F) (scal (-1) (rate_of xs))) <= at_ (defect f num den xs value) g / P.
Proof.
  intros Hn Hd Lx (Lv & Ev & _ & _) (d & -> & Hz) Hg. pose proof P_pos as Pp. pose proof (two_to_pos den) as Pd.
  assert (GK : forall g, In g (grades f) -> (g <= top f)%nat).
  { intros g' Hin. apply (In_nth _ _ O) in Hin as (j & Hj & <-). apply (grades_kept j Hj). }
  destruct (defects_are (grades f) num den xs (known value) g Lx Lv GK) as [L E]. cbv zeta in L, E.
  unfold defect. set (known_e := known_defect f num den xs (known value)).
  assert (L' : length known_e = S last) by exact L.
  assert (E' := E : at_ known_e g = _). clearbody known_e.
  rewrite at_nadd by (apply below_length; [first [exact L' | rewrite map_length; exact Ev] | exact Hg]).
  set (h := r_ num / two_to den).
  set (v := value_of (known value)).
  set (x' := fun i => eval (pderiv (nth i xs [])) t / two_to (scale f (grade i))).
  assert (S : plus (scal h (plus (known_part (known value)) d)) (scal (-1) (rate_of xs))
              = plus (asum N (fun i => scal (h * v i - x' i) (mono i))) (scal h d)).
  { rewrite scal_plus, <- plus_assoc, (plus_comm (scal h d)), plus_assoc. f_equal.
    unfold known_part, rate_of. rewrite <- !asum_scal, <- asum_plus. apply asum_ext. intros i _.
    rewrite !scal_scal, <- plus_scal. f_equal. unfold v, x'. lra. }
  rewrite S. assert (Ed : forall a b, (a + b) / P = a / P + b / P) by (intros; unfold Rdiv; ring).
  rewrite Ed. eapply Rle_trans; [apply sz_plus|]. apply Rplus_le_compat.
  - eapply Rle_trans; [apply sz_terms; assumption|]. rewrite E'.
    assert (Es : forall a, a / P = / P * a) by (intros; unfold Rdiv; ring). rewrite Es, <- sum_scale. apply sum_le. intros i Hi.
    match goal with |- _ <= / P * (ind ?c * r_ ?b) => replace (/ P * (ind c * r_ b)) with (ind c * (r_ b / P)) by (unfold Rdiv; ring) end.
    apply Rmult_le_compat_l; [apply ind_nonneg|].
    set (q := nth i (known value) []). set (p := pderiv (nth i xs [])).
    set (w := psub (pscale num q) (map (fun c => BigZ.shiftl c den) p)).
    pose proof (bound_is_above (l1 w) (scale f (grade i) + den)%bigZ) as B. rewrite two_to_add in B.
    eapply Rle_trans; [|exact B]. pose proof (two_to_pos (scale f (grade i))) as Ps.
    assert (W : h * v i - x' i = eval w t / (two_to (scale f (grade i)) * two_to den)).
    { unfold w. rewrite eval_psub, eval_pscale, eval_shiftl by exact Hd. unfold h, v, x', value_of. fold q p. field. split; lra. }
    rewrite W. unfold Rdiv. rewrite Rabs_mult, (Rabs_pos_eq (/ _)) by (left; apply Rinv_0_lt_compat; nra).
    apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat; nra | apply l1_is_a_bound; exact t_in].
  - rewrite at_map by (apply below_length; assumption).
    pose proof (up_is_above (num * nth g (unknown value) 0)%bigZ den) as [_ U]. rewrite r_mul in U.
    assert (Hr : 0 <= r_ num) by (unfold r_; apply IZR_le; assumption).
    assert (Hh : 0 <= h) by (unfold h; apply Rmult_le_pos; [assumption | left; apply Rinv_0_lt_compat; assumption]).
    eapply Rle_trans; [apply sz_scal|]. rewrite Rabs_pos_eq by assumption. specialize (Hz g Hg). unfold at_ in Hz.
    apply (Rle_trans _ (h * (r_ (nth g (unknown value) 0%bigZ) / P))); [apply Rmult_le_compat_l; assumption|].
    replace (h * (r_ (nth g (unknown value) 0%bigZ) / P)) with (r_ num * r_ (nth g (unknown value) 0%bigZ) / two_to den / P)
      by (unfold h; field; split; lra).
    unfold Rdiv at 1 3. apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat; assumption | exact U].
Qed.
End Algebra.
