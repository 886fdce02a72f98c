(* Intervals of real numbers with ends c / 2^prec, rounded outwards; None: nothing is known (section 7.1). *)

From Coq Require Import List ZArith.
From Bignums Require Import BigZ.
From Orbitproof Require Import Polynomials.
Import ListNotations.
Local Open Scope bool_scope.
Local Open Scope bigZ_scope.
Local Open Scope list_scope.

Definition interval := option (bigZ * bigZ).

Section Intervals.
Variable prec : bigZ.

Definition lift (op : bigZ * bigZ -> bigZ * bigZ -> interval) (a b : interval) : interval :=
  match a, b with
  | Some x, Some y => op x y
  | _, _ => None
  end.
Definition iadd : interval -> interval -> interval := lift (fun x y => Some (fst x + fst y, snd x + snd y)).
Definition iopp (a : interval) : interval := option_map (fun x => (- snd x, - fst x)) a.
Definition isub (a b : interval) : interval := iadd a (iopp b).

Definition min4 (a b c d : bigZ) : bigZ := BigZ.min (BigZ.min a b) (BigZ.min c d).
Definition max4 (a b c d : bigZ) : bigZ := BigZ.max (BigZ.max a b) (BigZ.max c d).
Definition imul : interval -> interval -> interval := lift (fun x y =>
  let a := fst x * fst y in let b := fst x * snd y in let c := snd x * fst y in let d := snd x * snd y in
  Some (down (min4 a b c d) prec, up (max4 a b c d) prec)).

Definition inumber (over under : bigZ) : interval :=
  if 0 <? under
  then Some (BigZ.div (BigZ.shiftl over prec) under, - BigZ.div (- BigZ.shiftl over prec) under)
  else None.
(* The product with over / under, under > 0. *)
Definition iscale (over under : bigZ) (a : interval) : interval :=
  match a with
  | Some (l, h) =>
      if 0 <? under then
        let x := over * l in let y := over * h in
        Some (BigZ.div (BigZ.min x y) under, - BigZ.div (- BigZ.max x y) under)
      else None
  | None => None
  end.
Definition izero : interval := Some (0, 0).

Definition positive (a : interval) : bool := match a with Some (l, _) => 0 <? l | None => false end.
Definition negative (a : interval) : bool := match a with Some (_, h) => h <? 0 | None => false end.
Definition nonzero (a : interval) : bool := positive a || negative a.

Definition idiv : interval -> interval -> interval := lift (fun x y =>
  if (0 <? fst y) || (snd y <? 0) then
    let q u v := BigZ.div (BigZ.shiftl u prec) v in
    let r u v := - BigZ.div (- BigZ.shiftl u prec) v in
    Some (min4 (q (fst x) (fst y)) (q (fst x) (snd y)) (q (snd x) (fst y)) (q (snd x) (snd y)),
          max4 (r (fst x) (fst y)) (r (fst x) (snd y)) (r (snd x) (fst y)) (r (snd x) (snd y)))
  else None).

(* The numbers of both; both contain the one that is meant. *)
Definition meet (a b : interval) : interval :=
  match a, b with
  | Some (l, h), Some (l', h') =>
      let a := BigZ.max l l' in let b := BigZ.min h h' in if a <=? b then Some (a, b) else None
  | None, _ => b
  | _, None => a
  end.
(* It contains the numbers between 0 and those of an interval. *)
Definition from_zero (a : interval) : interval :=
  match a with Some (l, h) => Some (BigZ.min 0 l, BigZ.max 0 h) | None => None end.

(* Inside (- over / under, over / under). *)
Definition inside (a : interval) (over under : bigZ) : bool :=
  match a with
  | Some (l, h) =>
      let r := BigZ.shiftl over prec in (h * under <? r) && (- l * under <? r) && (0 <? under) && (l <=? h)
  | None => false
  end.

Definition isum (l : list interval) : interval := fold_right iadd izero l.
Fixpoint ipower (a : interval) (n : nat) : interval :=
  match n with
  | O => inumber 1 1
  | S O => a
  | S n' => imul (ipower a n') a
  end.
Definition middle (a : interval) : interval := option_map (fun x => let m := down (fst x + snd x) 1 in (m, m)) a.

End Intervals.
