(* What the bounds of theory/Elements.v mean when only their sums count. *)

From Coq Require Import List ZArith Reals Lra Lia.
From Bignums Require Import BigZ.
From Orbitproof Require Import Polynomials Elements Sound.
Import ListNotations.
Local Open Scope R_scope.
Local Open Scope list_scope.

(* No entry is negative. *)
Definition sized (n : nat) (a : norm) : Prop := length a = n /\ Forall (fun x => 0 <= r_ x) a.
(* The sum of the entries, as an integer. *)
Definition tot (a : norm) : R := r_ (total a).

Lemma tot_cons x a : tot (x :: a) = r_ x + tot a.
Proof. unfold tot. cbn [total fold_right]. apply r_add. Qed.
Lemma tot_nil : tot [] = 0.
Proof. reflexivity. Qed.
Lemma tot_nonneg a : Forall (fun x => 0 <= r_ x) a -> 0 <= tot a.
Proof. induction 1; [rewrite tot_nil; lra | rewrite tot_cons; lra]. Qed.
Lemma sized_tot n a : sized n a -> 0 <= tot a.
Proof. intros [_ H]. apply tot_nonneg. assumption. Qed.

Lemma length_nadd a : forall b, length (nadd a b) = Nat.min (length a) (length b).
Proof. induction a as [|x a IH]; intros [|y b]; cbn; auto. Qed.
Lemma tot_nadd a : forall b, length a = length b -> tot (nadd a b) = tot a + tot b.
Proof.
  induction a as [|x a IH]; intros [|y b] H; cbn in H; try discriminate; cbn [nadd]; [rewrite tot_nil; lra|].
  rewrite !tot_cons, r_add, IH by congruence. lra.
Qed.
Lemma nonneg_nadd a : forall b, Forall (fun x => 0 <= r_ x) a -> Forall (fun x => 0 <= r_ x) b ->
  Forall (fun x => 0 <= r_ x) (nadd a b).
Proof.
  induction a as [|x a IH]; intros [|y b] Ha Hb; cbn; constructor; inversion Ha; inversion Hb; subst; [rewrite r_add; lra | auto].
Qed.
Lemma sized_nadd n a b : sized n a -> sized n b -> sized n (nadd a b).
Proof.
  intros [La Ha] [Lb Hb]. split; [rewrite length_nadd, La, Lb; apply Nat.min_id | apply nonneg_nadd; assumption].
Qed.
Lemma tot_nadd_sized n a b : sized n a -> sized n b -> tot (nadd a b) = tot a + tot b.
Proof. intros [La _] [Lb _]. apply tot_nadd. congruence. Qed.

(* Maps that enlarge. *)
Lemma tot_map (g : bigZ -> bigZ) c a : (forall x, c * r_ x <= r_ (g x)) -> c * tot a <= tot (map g a).
Proof.
  intros H. induction a as [|x a IH]; [rewrite tot_nil; cbn; rewrite tot_nil; lra|].
  cbn [map]. rewrite !tot_cons. specialize (H x). lra.
Qed.
Lemma sized_map n (g : bigZ -> bigZ) a : (forall x, 0 <= r_ x -> 0 <= r_ (g x)) -> sized n a -> sized n (map g a).
Proof.
  intros H [L P]. split; [rewrite map_length; assumption|]. clear L. induction P; cbn; constructor; auto.
Qed.
Lemma up_nonneg x k : 0 <= r_ x -> 0 <= r_ (up x k).
Proof.
  intros H. pose proof (up_is_above x k) as [_ U]. pose proof (two_to_pos k).
  assert (0 <= r_ x / two_to k) by (apply Rle_mult_inv_pos; lra). lra.
Qed.
Lemma tot_up k a : tot a / two_to k <= tot (map (fun x => up x k) a).
Proof.
  unfold Rdiv. rewrite Rmult_comm. apply tot_map. intros x. pose proof (up_is_above x k) as [_ U]. unfold Rdiv in U. lra.
Qed.
Lemma r_div a b : 0 < r_ b -> r_ (BigZ.div a b) <= r_ a / r_ b < r_ (BigZ.div a b) + 1.
Proof.
  unfold r_. intros Hb. apply lt_IZR in Hb. rewrite BigZ.spec_div.
  set (x := BigZ.to_Z a). set (y := BigZ.to_Z b) in *.
  pose proof (Z.mul_div_le x y Hb) as H1. pose proof (Z.mul_succ_div_gt x y Hb) as H2.
  apply IZR_le in H1. apply IZR_lt in H2. rewrite mult_IZR in H1, H2. rewrite succ_IZR in H2. apply IZR_lt in Hb.
  split.
  - apply (Rmult_le_reg_l (IZR y)); [assumption|]. replace (IZR y * (IZR x / IZR y)) with (IZR x) by (field; lra). assumption.
  - apply (Rmult_lt_reg_l (IZR y)); [assumption|]. replace (IZR y * (IZR x / IZR y)) with (IZR x) by (field; lra). assumption.
Qed.
Lemma quotient_up_above a b : 0 < r_ b -> r_ a / r_ b <= r_ (quotient_up a b).
Proof.
  intros Hb. unfold quotient_up. rewrite r_opp. destruct (r_div (- a)%bigZ b Hb) as [H _]. rewrite r_opp in H.
  unfold Rdiv in *. lra.
Qed.
Lemma quotient_up_nonneg a b : 0 < r_ b -> 0 <= r_ a -> 0 <= r_ (quotient_up a b).
Proof. intros Hb Ha. eapply Rle_trans; [|apply quotient_up_above; assumption]. apply Rle_mult_inv_pos; lra. Qed.

Lemma zeros_sized (b : norm) : sized (length b) (zeros b) /\ tot (zeros b) = 0.
Proof.
  unfold sized, zeros. rewrite map_length. induction b as [|x b [[_ H] E]]; [repeat split; constructor|].
  cbn [map]. rewrite tot_cons, E, r_0. repeat split; [constructor; [rewrite r_0; lra | assumption] | lra].
Qed.
Lemma last_two_sized x a : 0 <= r_ x -> Forall (fun y => 0 <= r_ y) a ->
  tot (last_two x a) = r_ x + tot a /\ Forall (fun y => 0 <= r_ y) (last_two x a) /\ (a <> [] -> length (last_two x a) = length a).
Proof.
  intros Hx Ha. revert x Hx. induction Ha as [|y a Hy Ha IH]; intros x Hx.
  - cbn [last_two]. rewrite tot_cons. repeat split; [constructor; auto | congruence].
  - destruct a as [|z a].
    + cbn [last_two]. rewrite !tot_cons, r_add. repeat split; [apply Rplus_assoc | constructor; [rewrite r_add; lra | constructor]].
    + change (last_two x (y :: z :: a)) with (x :: last_two y (z :: a)). destruct (IH y Hy) as [E [P L]].
      rewrite (tot_cons x), E. repeat split; [rewrite (tot_cons y); reflexivity | constructor; assumption | intros _].
      cbn [length] in *. rewrite L by discriminate. reflexivity.
Qed.
Lemma further_sized n a : sized n a -> sized n (further a) /\ tot (further a) = tot a.
Proof.
  intros [L P]. destruct a as [|x [|y a]]; [repeat split; assumption | repeat split; assumption|].
  change (further (x :: y :: a)) with (0%bigZ :: last_two x (y :: a)). inversion P as [|? ? Hx Ha]; subst.
  destruct (last_two_sized x (y :: a) Hx Ha) as [E [Q L']]. unfold sized. rewrite !tot_cons, E, tot_cons, r_0. cbn [length].
  rewrite L' by discriminate. repeat split; [constructor; [rewrite r_0; lra | assumption] | lra].
Qed.
Lemma products_sized n a b : sized n b -> Forall (fun x => 0 <= r_ x) a -> sized n (products a b) /\ tot (products a b) = tot a * tot b.
Proof.
  intros Sb Ha. induction Ha as [|x a Hx Ha [IS IT]].
  - cbn [products]. destruct (zeros_sized b) as [Z E]. destruct Sb as [L _]. rewrite L in Z. rewrite E, tot_nil. split; [assumption | lra].
  - cbn [products]. destruct (further_sized n _ IS) as [FS FT].
    assert (S1 : sized n (map (BigZ.mul x) b)) by (apply sized_map; [intros y Hy; rewrite r_mul; apply Rmult_le_pos; assumption | assumption]).
    split; [apply sized_nadd; assumption|]. rewrite (tot_nadd_sized n) by assumption. rewrite FT, IT, tot_cons.
    assert (T1 : tot (map (BigZ.mul x) b) = r_ x * tot b).
    { clear. induction b as [|y b IH]; [symmetry; apply Rmult_0_r|].
      change (tot ((x * y)%bigZ :: map (BigZ.mul x) b) = r_ x * tot (y :: b)).
      rewrite (tot_cons (x * y)%bigZ), (tot_cons y), r_mul, IH. symmetry. apply Rmult_plus_distr_l. }
    rewrite T1. lra.
Qed.
Lemma conv_sized n f a b : sized n a -> sized n b -> sized n (conv f a b) /\
  tot a / two_to (eps f) * (tot b / two_to (eps f)) <= tot (conv f a b) / two_to (eps f).
Proof.
  intros [_ Ha] Sb. destruct (products_sized n a b Sb Ha) as [S E]. unfold conv. split.
  - apply sized_map; [|assumption]. intros. apply up_nonneg. assumption.
  - pose proof (tot_up (eps f) (products a b)) as U. rewrite E in U. pose proof (two_to_pos (eps f)) as P.
    replace (tot a / two_to (eps f) * (tot b / two_to (eps f))) with (tot a * tot b / two_to (eps f) / two_to (eps f)) by (field; lra).
    apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat; assumption | assumption].
Qed.

Lemma nothing_sized f : sized (S (S (top f))) (nothing f) /\ tot (nothing f) = 0.
Proof.
  unfold nothing, sized. rewrite repeat_length. generalize (S (S (top f))). induction n as [|n [[_ H] E]]; [repeat split; constructor|].
  cbn [repeat]. rewrite tot_cons, E, r_0. repeat split; [constructor; [rewrite r_0; lra | assumption] | lra].
Qed.
Lemma raise_sized n x a : sized (S n) a -> 0 <= r_ x -> sized (S n) (raise 0 x a) /\ tot (raise 0 x a) = r_ x + tot a.
Proof.
  intros [L P] Hx. destruct a as [|y a]; [discriminate|]. cbn [raise]. rewrite !tot_cons, r_add. inversion P; subst.
  repeat split; [assumption | constructor; [rewrite r_add; lra | assumption] | lra].
Qed.
Lemma only_last_sized n a : sized (S n) a -> sized (S n) (only_last a).
Proof.
  intros [L P]. unfold only_last. split; [rewrite app_length, repeat_length, L; cbn; lia|].
  apply Forall_app. split.
  - clear. induction (pred (length a)); cbn; constructor; [rewrite r_0; lra | assumption].
  - constructor; [|constructor]. assert (H : a <> []) by (destruct a; [discriminate | discriminate]).
    rewrite Forall_forall in P. apply P. destruct (exists_last H) as [b [z E]]. rewrite E, last_last. apply in_or_app. right. left. reflexivity.
Qed.
Lemma tl_sized n a : sized (S n) a -> sized (S n) (0%bigZ :: tl a).
Proof.
  intros [L P]. destruct a as [|x a]; [discriminate|]. cbn [tl length] in *. inversion P; subst.
  split; [cbn; assumption | constructor; [rewrite r_0; lra | assumption]].
Qed.

Lemma nle_tot a : forall b, nle a b = true -> tot a <= tot b /\ length a = length b.
Proof.
  induction a as [|x a IH]; intros [|y b] H; cbn in H; try discriminate; [split; [lra | reflexivity]|].
  apply andb_prop in H. destruct H as [H1 H2]. apply r_leb in H1. destruct (IH b H2) as [E L]. rewrite !tot_cons. cbn [length]. split; [lra | congruence].
Qed.
Lemma nlt_tot a : forall b, nlt a b = true -> tot a <= tot b /\ length a = length b.
Proof.
  induction a as [|x a IH]; intros [|y b] H; cbn in H; try discriminate; [split; [lra | reflexivity]|].
  apply andb_prop in H. destruct H as [H1 H2]. apply r_ltb in H1. destruct (IH b H2) as [E L]. rewrite !tot_cons. cbn [length]. split; [lra | congruence].
Qed.
