(* Identities between programs, as polynomials in their inputs and symbols for roots (section 1.4), and first integrals that are
   quadratic in a coordinate (section 12.1). *)

From Coq Require Import List ZArith.
From Bignums Require Import BigZ.
From Orbitproof Require Import Polynomials Elements Formats Programs Rows.
Import ListNotations.
Local Open Scope bool_scope.
Local Open Scope bigZ_scope.
Local Open Scope list_scope.

(* Polynomials in several variables: terms in falling order of their exponents, all of the same length. *)
Definition mpoly := list (list nat * rational).

Fixpoint compare_exponents (a b : list nat) : comparison :=
  match a, b with
  | x :: a', y :: b' => match Nat.compare x y with Eq => compare_exponents a' b' | c => c end
  | _, _ => Eq
  end.
Definition sum_of (a b : rational) : rational :=
  if under a =? under b then Q (over a + over b) (under a) else Q (over a * under b + over b * under a) (under a * under b).
Definition product_of (a b : rational) : rational := Q (over a * over b) (under a * under b).

Fixpoint madd (p : mpoly) : mpoly -> mpoly :=
  fix go (q : mpoly) : mpoly :=
    match p, q with
    | [], _ => q
    | _, [] => p
    | (m, a) :: p', (n, b) :: q' =>
        match compare_exponents m n with
        | Gt => (m, a) :: madd p' q
        | Lt => (n, b) :: go q'
        | Eq => let c := sum_of a b in if over c =? 0 then madd p' q' else (m, c) :: madd p' q'
        end
    end.
Definition times_term (t : list nat * rational) (p : mpoly) : mpoly :=
  map (fun u => (map2 Nat.add (fst t) (fst u), product_of (snd t) (snd u))) p.
Definition mmul (p q : mpoly) : mpoly := fold_right (fun t sum => madd (times_term t q) sum) [] p.
Definition mscale (a : rational) (p : mpoly) : mpoly :=
  if over a =? 0 then [] else map (fun t => (fst t, product_of a (snd t))) p.
Definition mpower (one p : mpoly) (n : nat) : mpoly := Nat.iter n (mmul p) one.
Definition msub (p q : mpoly) : mpoly := madd p (mscale (Q (-1) 1) q).
Definition is_nothing (p : mpoly) : bool := match p with [] => true | _ => false end.

Section Ring.
Variable variables : nat.  (* inputs, then symbols for roots *)
Variable given : nat.      (* inputs *)

Definition variable (i : nat) : mpoly := [(unit_exponent variables i, Q 1 1)].
Definition number (a : rational) : mpoly := if over a =? 0 then [] else [(map (fun _ => O) (seq 0 variables), a)].

(* Symbol j stands for base^(-1 / q). *)
Definition roots := list (mpoly * nat).
Fixpoint find_root (rs : roots) (base : mpoly) (q j : nat) : option nat :=
  match rs with
  | [] => None
  | (b, r) :: rs' => if (r =? q)%nat && is_nothing (msub b base) then Some j else find_root rs' base q (S j)
  end.

(* The values of all nodes and their derivatives along a field, with the roots so far; `may` says whether there may be others. *)
Record ring_values := Values { found : list mpoly; rates : list mpoly; known_roots : roots }.
Definition node_in_ring (may : bool) (v : ring_values) (n : node) : option ring_values :=
  let at_ i := nth i (found v) [] in
  let rate i := nth i (rates v) [] in
  let go x dx rs := Some (Values (found v ++ [x]) (rates v ++ [dx]) rs) in
  match n with
  | Const a b => if 0 <? b then go (number (Q a b)) [] (known_roots v) else None
  | Add i j => go (madd (at_ i) (at_ j)) (madd (rate i) (rate j)) (known_roots v)
  | Sub i j => go (msub (at_ i) (at_ j)) (msub (rate i) (rate j)) (known_roots v)
  | Mul i j => go (mmul (at_ i) (at_ j)) (madd (mmul (rate i) (at_ j)) (mmul (at_ i) (rate j))) (known_roots v)
  | Scale i a b => if 0 <? b then go (mscale (Q a b) (at_ i)) (mscale (Q a b) (rate i)) (known_roots v) else None
  | Power i p q =>
      let put j rs :=
        let s := variable (given + j) in
        (* base^(-p / q) = s^p, and its derivative is -(p / q) s^(p + q) times that of the base. *)
        go (mpower (number (Q 1 1)) s p)
           (mscale (Q (- BigZ.of_Z (Z.of_nat p)) (BigZ.of_Z (Z.of_nat q)))
              (mmul (mpower (number (Q 1 1)) s (p + q)) (rate i))) rs in
      match p, q with
      | S _, S _ =>
          match find_root (known_roots v) (at_ i) q 0 with
          | Some j => put j (known_roots v)
          | None => if may && (given + length (known_roots v) <? variables)%nat
                    then put (length (known_roots v)) (known_roots v ++ [(at_ i, q)]) else None
          end
      | _, _ => None
      end
  end.
Definition in_ring (may : bool) (p : program) (rates_of_inputs : list mpoly) (rs : roots) : option ring_values :=
  if (inputs p =? given)%nat && well_formed p then
    fold_left (fun v n => match v with Some v => node_in_ring may v n | None => None end) (nodes p)
      (Some (Values (map variable (seq 0 given)) rates_of_inputs rs))
  else None.

(* base s^q = 1, times a power of the base: no power of s is q or more then. *)
Definition without_root (j : nat) (r : mpoly * nat) (p : mpoly) : mpoly :=
  let place := (given + j)%nat in
  let q := snd r in
  let most := fold_right (fun t m => Nat.max (Nat.div (nth place (fst t) O) q) m) O p in
  fold_right (fun t sum =>
    let n := nth place (fst t) O in
    let rest := map (fun ie => if (fst ie =? place)%nat then Nat.modulo n q else snd ie)
                  (combine (seq 0 variables) (fst t)) in
    madd (mmul [(rest, snd t)] (mpower (number (Q 1 1)) (fst r) (most - Nat.div n q))) sum) [] p.
Definition reduced (rs : roots) (p : mpoly) : mpoly :=
  fold_left (fun p jr => without_root (fst jr) (snd jr) p) (rev (combine (seq 0 (length rs)) rs)) p.

(* The first integral is constant along the field: its powers are of bases of which the field takes powers. *)
Definition is_first_integral (field integral : program) (dimension : nat) : bool :=
  match in_ring true field (map (fun _ => []) (seq 0 given)) [] with
  | Some f =>
      let rate i := if (i <? dimension)%nat then nth (nth i (outputs field) O) (found f) [] else [] in
      (length (outputs field) =? dimension)%nat &&
      match in_ring false integral (map rate (seq 0 given)) (known_roots f) with
      | Some h => match outputs integral with
                  | [o] => is_nothing (reduced (known_roots f) (nth o (rates h) []))
                  | _ => false
                  end
      | None => false
      end
  | None => false
  end.

(* It is A + b w^2 with 1 / b = `inverse`, and neither A nor any base depends on w, the input with this place. *)
Definition depends_on (w : nat) (p : mpoly) : bool := existsb (fun t => negb (nth w (fst t) O =? 0)%nat) p.
Definition is_quadratic (integral : program) (w : nat) (inverse : rational) : bool :=
  match in_ring true integral (map (fun _ => []) (seq 0 given)) [] with
  | Some h =>
      forallb (fun r => negb (depends_on w (fst r))) (known_roots h) &&
      match outputs integral with
      | [o] =>
          let square := map (fun e => (2 * e)%nat) (unit_exponent variables w) in
          let value := nth o (found h) [] in
          forallb (fun t => (nth w (fst t) O =? 0)%nat || same (fst t) square) value
          && existsb (fun t => same (fst t) square && (over (snd t) * over inverse =? under (snd t) * under inverse)) value
      | _ => false
      end
  | None => false
  end.
End Ring.

Definition number_of_powers (p : program) : nat :=
  length (filter (fun n => match n with Power _ _ _ => true | _ => false end) (nodes p)).

Definition first_integral_holds (field integral : program) (dimension : nat) : bool :=
  is_first_integral (inputs field + number_of_powers field) (inputs field) field integral dimension.
Definition level_form_holds (integral : program) (w : nat) (inverse : rational) : bool :=
  is_quadratic (inputs integral + number_of_powers integral) (inputs integral) integral w inverse.
