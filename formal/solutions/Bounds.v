(* The comparison system of theory/Steps.v: matrices, partial sums of exponentials, as sums of bounds. *)

From Coq Require Import List ZArith Reals Lra Lia.
From Coquelicot Require Import Rcomplements.
From Bignums Require Import BigZ.
From Orbitproof Require Import Polynomials Elements Formats Programs Steps Sound.
From Solutions Require Import Comparison Flow Exponential Norms Values Fields.
Import ListNotations.
Local Open Scope R_scope.
Local Open Scope list_scope.

Lemma sum_first n (g : nat -> R) : sum (S n) g = g O + sum n (fun k => g (S k)).
Proof. rewrite sum_shift. cbn [sum]. ring. Qed.

Lemma less_of_less a b x q : a <= b -> b <= (1 - q) * x -> 0 <= x -> 0 <= q -> a <= x.
Proof. intros. nra. Qed.

Section Bounds.
Variables (f : format) (m : nat).

Notation number := (as_number f).
Definition entry (o : option norm) : R := match o with Some e => number e | None => 0 end.
Definition entry_sized (o : option norm) : Prop := match o with Some e => sized (entries f) e | None => True end.
Definition vector (v : list norm) : Prop := length v = m /\ Forall (sized (entries f)) v.
Definition matrix_sized (a : list (list (option norm))) : Prop :=
  length a = m /\ forall i, (i < m)%nat -> length (nth i a []) = m /\ Forall entry_sized (nth i a []).
Notation at_ v i := (number (nth i v [])).

Lemma number_nonneg e : sized (entries f) e -> 0 <= number e.
Proof. apply as_number_nonneg. Qed.
Lemma vector_sized v i : vector v -> (i < m)%nat -> sized (entries f) (nth i v []).
Proof. intros [L H] Hi. rewrite Forall_forall in H. apply H, nth_In. lia. Qed.
Lemma vector_nonneg v i : vector v -> (i < m)%nat -> 0 <= at_ v i.
Proof. intros H Hi. apply number_nonneg, vector_sized; assumption. Qed.
Lemma entry_nonneg o : entry_sized o -> 0 <= entry o.
Proof. destruct o; cbn; [apply number_nonneg | lra]. Qed.

Lemma apply_row_sized row : forall v, length row = length v -> Forall entry_sized row -> Forall (sized (entries f)) v ->
  sized (entries f) (apply_row f row v) /\
  sum (length row) (fun j => entry (nth j row None) * at_ v j) <= number (apply_row f row v).
Proof.
  induction row as [|o row IH]; intros [|e v] L Hr Hv; try discriminate.
  - split; [apply nothing_entries|]. cbn. rewrite as_number_nothing. lra.
  - cbn [length]. rewrite sum_first. cbn [nth]. unfold apply_row. cbn [combine fold_right fst snd].
    inversion Hr as [|? ? Ho Hr']. inversion Hv as [|? ? He Hv']. subst.
    destruct (IH v ltac:(cbn in L; lia) Hr' Hv') as [S E]. unfold apply_row in S, E.
    destruct o as [o|]; cbn [entry].
    + cbn in Ho. destruct (as_number_conv f o e Ho He) as [Sc Ec]. split; [apply sized_nadd; assumption|].
      rewrite as_number_add by assumption. lra.
    + split; [assumption | lra].
Qed.

Lemma apply_sized a v : matrix_sized a -> vector v -> vector (apply f a v) /\
  forall i, (i < m)%nat -> sum m (fun j => entry (nth j (nth i a []) None) * at_ v j) <= at_ (apply f a v) i.
Proof.
  intros [La Ha] [Lv Hv].
  assert (R : forall i, (i < m)%nat -> sized (entries f) (apply_row f (nth i a []) v) /\
    sum m (fun j => entry (nth j (nth i a []) None) * at_ v j) <= number (apply_row f (nth i a []) v)).
  { intros i Hi. destruct (Ha i Hi) as [Li Hr]. rewrite <- Li. apply apply_row_sized; [lia | assumption | assumption]. }
  unfold apply. split; [split|].
  - rewrite map_length. assumption.
  - apply Forall_forall. intros e He. apply in_map_iff in He. destruct He as [row [<- Hrow]].
    destruct (In_nth _ _ [] Hrow) as [i [Hi <-]]. apply R. lia.
  - intros i Hi. rewrite (nth_map (fun row => apply_row f row v) []) by lia. apply R. assumption.
Qed.

Lemma vector_map (g : bigZ -> bigZ) v : (forall x, 0 <= r_ x -> 0 <= r_ (g x)) -> vector v -> vector (map (map g) v).
Proof.
  intros H [L Hv]. split; [rewrite map_length; assumption|]. clear L. induction Hv; cbn; constructor; [apply sized_map; assumption | assumption].
Qed.
Lemma number_map (g : bigZ -> bigZ) c v i : (forall x, c * r_ x <= r_ (g x)) -> (i < length v)%nat ->
  c * at_ v i <= at_ (map (map g) v) i.
Proof.
  intros H Hi. rewrite (nth_map (map g) []) by assumption. unfold as_number.
  pose proof (tot_map g c (nth i v []) H) as T. pose proof (two_to_pos (eps f)) as P. unfold Rdiv.
  rewrite <- Rmult_assoc. apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat; assumption | assumption].
Qed.
Lemma vector_add v w : vector v -> vector w -> vector (map2 nadd v w) /\
  forall i, (i < m)%nat -> at_ (map2 nadd v w) i = at_ v i + at_ w i.
Proof.
  intros Hv Hw. pose proof Hv as [Lv _]. pose proof Hw as [Lw _].
  assert (R : forall i, (i < m)%nat -> nth i (map2 nadd v w) [] = nadd (nth i v []) (nth i w [])) by
    (intros; apply (nth_map2 nadd [] []); lia).
  split; [split|].
  - rewrite length_map2; lia.
  - apply Forall_forall. intros e He. destruct (In_nth _ _ [] He) as [i [Hi <-]]. rewrite length_map2 in Hi by lia.
    rewrite R by lia. apply sized_nadd; apply vector_sized; (assumption || lia).
  - intros i Hi. rewrite R by assumption. apply as_number_add; apply vector_sized; assumption.
Qed.

Lemma series_sound a : matrix_sized a -> forall N K k term start, r_ k = INR (S K) -> vector term -> vector start ->
  exists w : nat -> nat -> R,
    vector (fst (series f a N k term start)) /\ vector (snd (series f a N k term start)) /\
    (forall i, (i < m)%nat -> w O i = at_ term i) /\ (forall i, (i < m)%nat -> w N i = at_ (snd (series f a N k term start)) i) /\
    (forall l i, (i < m)%nat -> (l <= N)%nat -> 0 <= w l i) /\
    (forall l i, (i < m)%nat -> (l < N)%nat ->
       sum m (fun j => entry (nth j (nth i a []) None) * w l j) <= INR (S (K + l)) * w (S l) i) /\
    (forall i, (i < m)%nat -> at_ (fst (series f a N k term start)) i = at_ start i + sum N (fun l => w l i)).
Proof.
  intros Ha. induction N as [|N IH]; intros K k term start Hk Ht Hs; cbn [series].
  - exists (fun _ i => at_ term i). cbn [fst snd sum]. repeat split; try apply Hs; try apply Ht; auto; try (intros; lia).
    + intros l i Hi _. apply vector_nonneg; assumption.
    + intros. ring.
  - destruct (apply_sized a term Ha Ht) as [Va Ea].
    assert (Pk : 0 < r_ k) by (rewrite Hk; apply lt_0_INR; lia).
    set (next := map (map (fun x => quotient_up x k)) (apply f a term)) in *.
    assert (Vn : vector next) by (apply vector_map; [intros x Hx; apply quotient_up_nonneg; assumption | assumption]).
    destruct (vector_add start term Hs Ht) as [Vs Es].
    destruct (IH (S K) (k + 1)%bigZ next (map2 nadd start term)) as [w [F1 [F2 [W0 [WN [Wp [Wn Ws]]]]]]]; [|assumption|assumption|].
    { rewrite r_add, r_1, Hk, (S_INR (S K)). reflexivity. }
    exists (fun l => match l with O => fun i => at_ term i | S l' => w l' end). repeat split; try apply F1; try apply F2; auto.
    + intros [|l] i Hi Hl; [apply vector_nonneg; assumption | apply Wp; [assumption | lia]].
    + intros [|l] i Hi Hl.
      * rewrite Nat.add_0_r, W0 by assumption. specialize (Ea i Hi).
        assert (Q : / r_ k * at_ (apply f a term) i <= at_ next i).
        { apply number_map; [intros x; pose proof (quotient_up_above x k Pk); unfold Rdiv in *; lra|].
          destruct Va as [L _]. exact (eq_ind_r (fun z => (i < z)%nat) Hi L). }
        apply (Rmult_le_compat_l (r_ k)) in Q; [|lra]. rewrite <- Rmult_assoc, Rinv_r, Rmult_1_l, Hk in Q by lra. exact (Rle_trans _ _ _ Ea Q).
      * rewrite <- Nat.add_succ_comm. apply Wn; [assumption | lia].
    + intros i Hi. rewrite Ws, Es, sum_first by assumption. ring.
Qed.

(* The partial sum of an exponential, with what is needed to step with it. *)
Lemma exponential_sound a N v V : matrix_sized a -> vector v -> exponential f N a v = Some V -> vector V /\
  (forall i, (i < m)%nat -> at_ v i <= at_ V i) /\
  exists w : nat -> nat -> R, exists q, 0 <= q < 1 /\
    (forall l i, (l <= N)%nat -> (i < m)%nat -> 0 <= w l i) /\ (forall i, (i < m)%nat -> w O i = at_ v i) /\
    (forall l i, (l < N)%nat -> (i < m)%nat ->
      sum m (fun j => entry (nth j (nth i a []) None) * w l j) <= INR (S l) * w (S l) i) /\
    (forall i, (i < m)%nat -> w N i <= q * w O i) /\
    (forall i, (i < m)%nat -> sum N (fun l => w l i) <= (1 - q) * at_ V i).
Proof.
  intros Ha Hv E. unfold exponential in E.
  assert (Z : vector (map zeros v) /\ forall i, (i < m)%nat -> at_ (map zeros v) i = 0).
  { pose proof Hv as [Lv Sv]. split; [split; [rewrite map_length; assumption|]|].
    - clear -Sv. induction Sv as [|e v [Le He] Sv IH]; cbn; constructor; [|assumption].
      destruct (zeros_sized e) as [Se _]. rewrite Le in Se. exact Se.
    - intros i Hi. rewrite (nth_map zeros []) by lia. unfold as_number. destruct (zeros_sized (nth i v [])) as [_ T]. rewrite T.
      unfold Rdiv. ring. }
  destruct Z as [Vz Ez].
  destruct (series_sound a Ha N O 1%bigZ v (map zeros v) ltac:(rewrite r_1; reflexivity) Hv Vz)
    as [w [F1 [F2 [W0 [WN [Wp [Wn Ws]]]]]]].
  set (found := series f a N 1%bigZ v (map zeros v)) in *. cbv zeta in E.
  match type of E with (if ?b then _ else _) = _ => destruct b eqn:B; [|discriminate] end. injection E as <-.
  set (q := / two_to 40%bigZ).
  assert (T40 : two_to 40%bigZ = 2 * two_to 39%bigZ).
  { change 40%bigZ with (39 + 1)%bigZ. rewrite (two_to_add 39%bigZ 1%bigZ). change (two_to 1%bigZ) with (2 * 1). ring. }
  assert (T39 : 1 <= two_to 39%bigZ).
  { unfold two_to. change (BigZ.to_Z 39%bigZ) with 39%Z. rewrite power_of_2 by lia. apply IZR_le. vm_compute. discriminate. }
  assert (Q : 0 < q < 1).
  { unfold q. rewrite T40. split; [apply Rinv_0_lt_compat; lra|]. rewrite <- Rinv_1. apply Rinv_lt_contravar; lra. }
  assert (Q2 : 1 <= (1 - q) * (1 + / two_to 39%bigZ)).
  { replace (/ two_to 39%bigZ) with (2 * q) by (unfold q; rewrite T40; field; lra).
    assert (q <= / 2); [|nra]. unfold q. rewrite T40. apply Rinv_le_contravar; lra. }
  set (V := map (map (fun x => x + up x 39)%bigZ) (fst found)).
  assert (VV : vector V) by (apply vector_map; [intros x Hx; rewrite r_add; pose proof (up_nonneg x 39 Hx); lra | assumption]).
  assert (Vsum : forall i, (i < m)%nat -> sum N (fun l => w l i) <= (1 - q) * at_ V i).
  { intros i Hi. pose proof (Ws i Hi) as S1. rewrite (Ez i Hi), Rplus_0_l in S1.
    assert (G : (1 + / two_to 39%bigZ) * at_ (fst found) i <= at_ V i).
    { apply number_map; [intros x; rewrite r_add; pose proof (up_is_above x 39); unfold Rdiv in *; lra|].
      destruct F1 as [L _]. exact (eq_ind_r (fun z => (i < z)%nat) Hi L). }
    pose proof (vector_nonneg (fst found) i F1 Hi) as P. rewrite S1 in *.
    apply Rle_trans with ((1 - q) * ((1 + / two_to 39%bigZ) * sum N (fun l => w l i))); [|apply Rmult_le_compat_l; lra].
    rewrite <- Rmult_assoc. rewrite <- (Rmult_1_l (sum N _)) at 1. apply Rmult_le_compat_r; assumption. }
  assert (Last : forall i, (i < m)%nat -> w N i <= q * w O i).
  { intros i Hi. rewrite (WN i Hi), (W0 i Hi). rewrite forallb_forall in B.
    assert (I : In (nth i (snd found) [], nth i v []) (combine (snd found) v)).
    { rewrite <- (combine_nth (snd found) v i [] []) by (destruct F2 as [L2 _]; destruct Hv as [Lv _]; congruence).
      apply nth_In. rewrite combine_length. destruct F2 as [L2 _]. destruct Hv as [Lv _]. lia. }
    specialize (B _ I). cbn [fst snd] in B. apply nle_tot in B. destruct B as [B _].
    assert (G : two_to 40%bigZ * tot (nth i (snd found) []) <= tot (map (fun x => BigZ.shiftl x 40) (nth i (snd found) []))).
    { apply tot_map. intros x. destruct (r_shiftl x 40%bigZ) as [H|H]; [rewrite H; lra|].
      change (BigZ.to_Z 40%bigZ) with 40%Z in H. lia. }
    unfold as_number, q. pose proof (two_to_pos (eps f)) as P.
    assert (G2 : tot (nth i (snd found) []) <= / two_to 40%bigZ * tot (nth i v [])).
    { apply (Rmult_le_reg_l (two_to 40%bigZ)); [lra|]. rewrite <- Rmult_assoc, Rinv_r by lra. lra. }
    unfold Rdiv. rewrite <- Rmult_assoc. apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat; assumption | assumption]. }
  split; [assumption|]. split.
  - intros i Hi. pose proof (Vsum i Hi) as S1. pose proof (vector_nonneg V i VV Hi) as P. pose proof (W0 i Hi) as E0.
    destruct N as [|N].
    + specialize (Last i Hi). pose proof (vector_nonneg v i Hv Hi). rewrite E0 in Last. nra.
    + assert (w O i <= sum (S N) (fun l => w l i)).
      { apply (term_le_sum (S N) (fun l => w l i)); [intros; apply Wp; [assumption | lia] | lia]. }
      rewrite <- E0. exact (less_of_less _ _ _ q H S1 P ltac:(lra)).
  - exists w, q. split; [lra|]. split; [intros; apply Wp; assumption|]. split; [exact W0|].
    split; [intros l i Hl Hi; exact (Wn l i Hi Hl)|]. split; [exact Last | exact Vsum].
Qed.
End Bounds.
