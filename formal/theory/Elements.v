(* Elements of the algebra: functions of theta in [0, 1] with values in power series in xi (sections 2.1 to 2.4 of the
   chapter verify/algebra), known up to a bound for each grade. *)

From Coq Require Import List ZArith.
From Bignums Require Import BigZ.
From Orbitproof Require Import Polynomials.
Import ListNotations.
Local Open Scope bool_scope.
Local Open Scope bigZ_scope.
Local Open Scope list_scope.

(* A vector of bounds has one entry for each grade 0 .. top and, last, one for all above; its scale is `eps`. *)
Definition norm := list bigZ.

Fixpoint nadd (a b : norm) : norm :=
  match a, b with
  | x :: a', y :: b' => (x + y) :: nadd a' b'
  | _, _ => []
  end.
Fixpoint nle (a b : norm) : bool :=
  match a, b with
  | [], [] => true
  | x :: a', y :: b' => (x <=? y) && nle a' b'
  | _, _ => false
  end.
Fixpoint nlt (a b : norm) : bool :=
  match a, b with
  | [], [] => true
  | x :: a', y :: b' => (x <? y) && nlt a' b'
  | _, _ => false
  end.
Definition total (a : norm) : bigZ := fold_right BigZ.add 0 a.

(* One place further, what leaves the last place being added to it. *)
Fixpoint last_two (x : bigZ) (a : norm) : norm :=
  match a with
  | [] => [x]
  | [y] => [x + y]
  | y :: a' => x :: last_two y a'
  end.
Definition further (a : norm) : norm :=
  match a with
  | [] => []
  | [x] => [x]
  | x :: a' => 0 :: last_two x a'
  end.
Definition zeros (a : norm) : norm := map (fun _ => 0) a.
(* All products, those of grade above top in the last place; of the scale 2 eps. *)
Fixpoint products (a b : norm) : norm :=
  match a with
  | [] => zeros b
  | x :: a' => nadd (map (BigZ.mul x) b) (further (products a' b))
  end.

(* weights and top grade; scale of grade 0, further scale for each grade; number of powers of theta that are kept. *)
Record format := Format {
  monomials : list (list nat);
  grades : list nat;
  pairs : list (list (nat * nat));
  top : nat;
  bits : bigZ;
  grade_bits : bigZ;
  kept : nat;
  eps : bigZ
}.

(* Known parts, one polynomial for each monomial; bounds of what is unknown; bounds of the known parts. *)
Record element := Element { known : list poly; unknown : norm; size : norm }.

Definition scale (f : format) (grade : nat) : bigZ := bits f + BigZ.of_Z (Z.of_nat grade) * grade_bits f.
(* A number of scale s as a bound. *)
Definition bound (f : format) (x s : bigZ) : bigZ := up x (s - eps f).
Definition conv (f : format) (a b : norm) : norm := map (fun x => up x (eps f)) (products a b).
Definition nothing (f : format) : norm := repeat 0 (S (S (top f))).

Fixpoint raise (grade : nat) (x : bigZ) (a : norm) : norm :=
  match grade, a with
  | _, [] => []
  | O, y :: a' => (x + y) :: a'
  | S g, y :: a' => y :: raise g x a'
  end.

Fixpoint sizes (f : format) (gs : list nat) (ps : list poly) : norm :=
  match gs, ps with
  | g :: gs', p :: ps' => raise g (bound f (l1 p) (scale f g)) (sizes f gs' ps')
  | _, _ => nothing f
  end.
Definition element_of (f : format) (ps : list poly) (errors : norm) : element :=
  Element ps errors (sizes f (grades f) ps).

Fixpoint map2 {A B C : Type} (op : A -> B -> C) (a : list A) (b : list B) : list C :=
  match a, b with
  | x :: a', y :: b' => op x y :: map2 op a' b'
  | _, _ => []
  end.

Definition eadd (f : format) (a b : element) : element :=
  element_of f (map2 padd (known a) (known b)) (nadd (unknown a) (unknown b)).
Definition esub (f : format) (a b : element) : element :=
  element_of f (map2 psub (known a) (known b)) (nadd (unknown a) (unknown b)).

Definition units (f : format) : bigZ := BigZ.of_Z (Z.of_nat (kept f)).
(* What rounding changes of a polynomial: less than a unit for each coefficient. *)
Definition rounding (f : format) (grade : nat) : bigZ := bound f (units f) (scale f grade).

(* The product with numerator / denominator. *)
Definition escale (f : format) (numerator denominator : bigZ) (a : element) : element :=
  let errors := map (fun e => - BigZ.div (- (BigZ.abs numerator * e)) denominator) (unknown a) in
  if denominator =? 1 then element_of f (map (pscale numerator) (known a)) errors
  else element_of f (map (map (fun c => BigZ.div (numerator * c) denominator)) (known a))
         (fold_right (fun g e => raise g (rounding f g) e) errors (grades f)).

(* One monomial of a product, of twice the scale, and a bound of what is left out. *)
Definition monomial_product (f : format) (a b : list poly) (of_pairs : list (nat * nat)) : poly * bigZ :=
  fold_right (fun ij sum =>
    let p := nth (fst ij) a [] in let q := nth (snd ij) b [] in
    (padd (pmul (kept f) p q) (fst sum), pmul_rest (kept f) p q + snd sum)) ([], 0) of_pairs.

Fixpoint rounded_products (f : format) (gs : list nat) (ms : list (poly * bigZ)) : list poly * norm :=
  match gs, ms with
  | g :: gs', m :: ms' =>
      let rest := rounded_products f gs' ms' in
      (map (fun c => down c (bits f)) (fst m) :: fst rest,
       raise g (rounding f g + bound f (snd m) (scale f g + bits f)) (snd rest))
  | _, _ => ([], nothing f)
  end.

Definition only_last (a : norm) : norm := repeat 0 (pred (length a)) ++ [last a 0].

Definition emul (f : format) (a b : element) : element :=
  let found := rounded_products f (grades f) (map (monomial_product f (known a) (known b)) (pairs f)) in
  let overflow := only_last (conv f (size a) (size b)) in
  let mixed := nadd (conv f (size a) (unknown b)) (conv f (unknown a) (nadd (size b) (unknown b))) in
  element_of f (fst found) (nadd (snd found) (nadd overflow mixed)).

(* A number, rounded down. *)
Definition econst (f : format) (numerator denominator : bigZ) : element :=
  let c := BigZ.div (BigZ.shiftl numerator (bits f)) denominator in
  let exact := c * denominator =? BigZ.shiftl numerator (bits f) in
  element_of f (map (fun g => match g with O => [c] | _ => [] end) (grades f))
    (raise O (if exact then 0 else bound f 1 (bits f)) (nothing f)).

(* It has all monomials, and no powers that are not kept. *)
Definition fits (f : format) (ps : list poly) : bool :=
  (length ps =? length (grades f))%nat && forallb (fun p => (length p <=? kept f)%nat) ps.

(* Bounds for the sum of all powers of something from the first on, none unless its total is below 1/2. *)
Definition one_at (e : bigZ) : bigZ := BigZ.shiftl 1 e.
Definition quotient_up (a b : bigZ) : bigZ := - BigZ.div (- a) b.

Fixpoint dot_rev (a b : list bigZ) : bigZ :=
  match a, b with
  | x :: a', y :: b' => x * y + dot_rev a' b'
  | _, _ => 0
  end.
(* `found` has the bounds of lower grades, the highest first; `rest` those of E that are still to come. *)
Fixpoint geometric_from (f : format) (inner : list bigZ) (den : bigZ) (found rest : list bigZ) (k : nat) : list bigZ :=
  match k, rest with
  | S k', e :: rest' =>
      let mixed := dot_rev inner found in
      let value := quotient_up (BigZ.shiftl e (eps f) + mixed) den in
      geometric_from f inner den (value :: found) rest' k'
  | _, _ => found
  end.
Definition geometric (f : format) (e : norm) : option norm :=
  let one := one_at (eps f) in
  let all := total e in
  if 2 * all <? one then
    let inner := tl e in
    let low := rev (geometric_from f inner (one - hd 0 e) [] e (S (top f))) in
    (* All that is missing in the last place: E_> (1 + F_0 + ..) + sum of E_i F_j with i + j > top. *)
    let above := last (products (0 :: tl (removelast e) ++ [0]) (low ++ [0])) 0 in
    let over := last e 0 * (one + total low) + above in
    Some (low ++ [quotient_up over (one - all)])
  else None.

(* E - 1, for the distance of a product from 1. *)
Definition less_one (f : format) (a : element) : element :=
  match known a with
  | p :: ps => element_of f (padd p [- one_at (bits f)] :: ps) (unknown a)
  | [] => a
  end.

Fixpoint times (f : format) (n : nat) (a b : element) : element :=
  match n with
  | O => b
  | S n' => emul f (times f n' a b) a
  end.
Definition first_of (a : element) : bigZ := at_zero (hd [] (known a)).

(* base^(- p / q) from anything that is about this power (section 2.4); p, q > 0. *)
Definition epower (f : format) (p q : nat) (guess : list poly) (base : element) : option element :=
  let s := element_of f guess (nothing f) in
  let mixed := emul f s base in
  let shared := Nat.min p q in
  let product := times f (q - shared) s (times f (p - shared) base (times f (pred shared) mixed mixed)) in
  let distance := less_one f product in
  let positive := (q =? 1)%nat || ((0 <? first_of s) && (0 <? first_of base)) in
  if positive && fits f guess then
    match geometric f (nadd (size distance) (unknown distance)) with
    | Some series =>
        let relative := map (fun x => quotient_up x (BigZ.of_Z (Z.of_nat q))) series in
        Some (Element (known s) (nadd (unknown s) (conv f (nadd (size s) (unknown s)) relative)) (size s))
    | None => None
    end
  else None.
