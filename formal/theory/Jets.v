(* Tables of derivatives, Taylor forms, jets, interval Newton (sections 6 and 7.2 to 7.4). *)

From Coq Require Import List ZArith.
From Bignums Require Import BigZ.
From Orbitproof Require Import Polynomials Elements Formats Rows Intervals.
Import ListNotations.
Local Open Scope bool_scope.
Local Open Scope bigZ_scope.
Local Open Scope list_scope.

Definition index := list nat.
Definition degree_of (i : index) : nat := fold_right Nat.add O i.
Fixpoint factorial (n : nat) : bigZ := match n with O => 1 | S n' => BigZ.of_Z (Z.of_nat n) * factorial n' end.
Definition index_factorial (i : index) : bigZ := fold_right (fun n x => factorial n * x) 1 i.

Fixpoint of_degree_exactly (variables degree : nat) : list index :=
  match variables with
  | O => match degree with O => [[]] | _ => [] end
  | S v => flat_map (fun first => map (cons first) (of_degree_exactly v (degree - first))) (rev (seq 0 (S degree)))
  end.
Definition up_to_degree (variables degree : nat) : list index :=
  flat_map (of_degree_exactly variables) (seq 0 (S degree)).
Definition plus (a b : index) : index := map2 Nat.add a b.

Definition table := list (index * interval).
Definition lookup (default : interval) (t : table) (i : index) : interval :=
  match find (fun e => same (fst e) i) t with Some e => snd e | None => default end.

(* What is known of a function on the box: its derivatives up to order 3 on the box, and at its centre. *)
Record function := Function { on_box : table; at_centre : table }.

Section Jets.
Variable prec : bigZ.

Let add := iadd.
Let mul := imul prec.
Let number (n : bigZ) : interval := inumber prec n 1.

(* Lemma 4. *)
Definition of_scale (c s : bigZ) : interval := Some (down c (s - prec), up c (s - prec)).
Definition unknown_up_to (e eps : bigZ) : interval := let r := up e (eps - prec) in Some (- r, r).

Definition falling (m a : index) : option bigZ :=
  fold_right (fun na x => match x with
    | Some x => if (snd na <=? fst na)%nat then Some (x * BigZ.div (factorial (fst na)) (factorial (fst na - snd na))) else None
    | None => None
    end) (Some 1) (combine m a).

(* 1 over the product of the scales (4 radius_j)^a_j, as a rational. *)
Definition inverse_scale (radii : list rational) (a : index) : rational :=
  fold_right (fun ra x => Nat.iter (snd ra) (fun x => Q (over x * under (fst ra)) (under x * (4 * over (fst ra)))) x)
    (Q 1 1) (combine radii a).

Definition over_scale (radii : list rational) (a : index) (x : interval) : interval :=
  let s := inverse_scale radii a in iscale (over s) (under s) x.

(* p / 4^n of a number of scale s in either direction. *)
Definition spread (c s : bigZ) (n : nat) : interval :=
  unknown_up_to (BigZ.abs c) (s + 2 * BigZ.of_Z (Z.of_nat n)).

Definition derivative_on_box (f : format) (b : box) (x : element) (a : index) : interval :=
  let known_part := fold_right (fun mgp sum => let '(m, (g, p)) := mgp in
    match falling m a with
    | Some k =>
        let c := k * at_zero p in let n := (degree_of m - degree_of a)%nat in
        add (if (n =? 0)%nat then of_scale c (scale f g) else spread c (scale f g) n) sum
    | None => sum
    end) izero (combine (monomials f) (combine (grades f) (known x))) in
  let g := Nat.min (grade_of (weights b) a) (S (top f)) in
  let rest := total (skipn g (unknown x)) in
  (* times a! (4 / 3)^|a| *)
  let n := degree_of a in
  let r := unknown_up_to (quotient_up (index_factorial a * rest * Nat.iter n (BigZ.mul 4) 1) (Nat.iter n (BigZ.mul 3) 1)) (eps f) in
  over_scale (radii b) a (add known_part r).

Definition derivative_at_centre (f : format) (b : box) (x : element) (a : index) : interval :=
  let known_part := fold_right (fun mgp found => let '(m, (g, p)) := mgp in
    if same m a then of_scale (index_factorial a * at_zero p) (scale f g) else found) izero
    (combine (monomials f) (combine (grades f) (known x))) in
  let g := Nat.min (grade_of (weights b) a) (S (top f)) in
  over_scale (radii b) a (add known_part (unknown_up_to (index_factorial a * nth g (unknown x) 0) (eps f))).

Definition constant_in_time (x : element) : bool := forallb (fun p => (length p <=? 1)%nat) (known x).

Definition function_of (f : format) (b : box) (x : element) : function :=
  let is := up_to_degree (length (radii b)) 3 in
  Function (map (fun a => (a, derivative_on_box f b x a)) is) (map (fun a => (a, derivative_at_centre f b x a)) is).

(* Section 7.2: a derivative at all points of a part of the box. *)
Definition term (d : interval) (where_ : list interval) (shift : index) : interval :=
  fold_left mul (flat_map (fun wn => repeat (fst wn) (snd wn)) (combine where_ shift))
    (iscale 1 (index_factorial shift) d).
Definition terms (t : table) (a : index) (where_ : list interval) (degree : nat) : interval :=
  isum (map (fun s => term (lookup None t (plus a s)) where_ s) (of_degree_exactly (length a) degree)).
Definition derivative (h : function) (where_ : list interval) (a : index) : interval :=
  snd (fold_left (fun acc d =>
    let below := add (fst acc) (terms (at_centre h) a where_ (pred d)) in
    (below, meet (snd acc) (add below (terms (on_box h) a where_ d))))
    (seq 1 (3 - degree_of a)) (izero, lookup None (on_box h) a)).
Definition derivatives_at (h : function) (where_ : list interval) : table :=
  map (fun a => (a, derivative h where_ a)) (up_to_degree (length where_) 3).
Definition value (h : function) (where_ : list interval) : interval :=
  derivative h where_ (map (fun _ => O) where_).
Definition unit_index (n j : nat) : index := unit_exponent n j.
Definition gradient (h : function) (where_ : list interval) (from : nat) : list interval :=
  let n := length where_ in map (fun j => derivative h where_ (unit_index n j)) (seq from (n - from)).

(* Section 7.3: Taylor coefficients up to a degree; what is not there is 0. *)
Definition jet := table.
Definition coefficient (j : jet) (i : index) : interval := lookup izero j i.
Definition of_jet (j : jet) (i : index) : interval := mul (coefficient j i) (number (index_factorial i)).

Definition jadd (v order : nat) (a b : jet) : jet :=
  map (fun i => (i, add (coefficient a i) (coefficient b i))) (up_to_degree v order).
Definition minus (a b : index) : index := map2 Nat.sub a b.
Fixpoint below (a b : index) : bool :=
  match a, b with
  | x :: a', y :: b' => (x <=? y)%nat && below a' b'
  | _, _ => true
  end.
Definition jmul (v order : nat) (a b : jet) : jet :=
  map (fun i => (i, isum (map (fun k => mul (coefficient a k) (coefficient b (minus i k)))
    (filter (fun k => below k i) (up_to_degree v (degree_of i)))))) (up_to_degree v order).
Definition jone (v : nat) : jet := [(map (fun _ => O) (seq 0 v), number 1)].
Definition jscale (x : interval) (a : jet) : jet := map (fun e => (fst e, mul (snd e) x)) a.
Definition jpower (v order : nat) (a : jet) (n : nat) : jet := Nat.iter n (fun p => jmul v order p a) (jone v).
Definition increment (v j : nat) : jet := [(unit_exponent v j, number 1)].

(* The jet of F(x + u), u jets without constant term. *)
Definition compose (v order : nat) (derivatives : table) (us : list jet) : jet :=
  fold_right (fun i sum =>
    let c := iscale 1 (index_factorial i) (lookup None derivatives i) in
    let monomial := fold_left (fun p un => match snd un with O => p | n => jmul v order p (jpower v order (fst un) n) end)
                      (combine us i) (jone v) in
    jadd v order (jscale c monomial) sum) [] (up_to_degree (length us) order).

(* Linear systems of one or two equations; of two, multiplied by about the inverse. *)
Definition matrix2 := (interval * interval * interval * interval)%type.
Definition mul2 (a b : matrix2) : matrix2 :=
  let '(a11, a12, a21, a22) := a in let '(b11, b12, b21, b22) := b in
  (add (mul a11 b11) (mul a12 b21), add (mul a11 b12) (mul a12 b22),
   add (mul a21 b11) (mul a22 b21), add (mul a21 b12) (mul a22 b22)).
Definition det2 (a : matrix2) : interval :=
  let '(a11, a12, a21, a22) := a in isub (mul a11 a22) (mul a12 a21).
Definition about_inverse (a : matrix2) : matrix2 :=
  let '(a11, a12, a21, a22) := a in
  let m := middle in
  let d := middle (isub (mul (m a11) (m a22)) (mul (m a12) (m a21))) in
  let q x := middle (idiv prec x d) in
  (q (m a22), q (iopp (m a12)), q (iopp (m a21)), q (m a11)).

(* Every matrix in it is regular. *)
Definition regular (a : list (list interval)) : bool :=
  match a with
  | [] => true
  | [[x]] => nonzero x
  | [[a11; a12]; [a21; a22]] => let m := (a11, a12, a21, a22) in nonzero (det2 (mul2 (about_inverse m) m))
  | _ => false
  end.

(* What contains the x with A x = b, for all A and b; nothing is known if a matrix may be singular. *)
Definition solve (a : list (list interval)) (b : list interval) : list interval :=
  match a, b with
  | [], [] => []
  | [[x]], [y] => [idiv prec y x]
  | [[a11; a12]; [a21; a22]], [y1; y2] =>
      let m := (a11, a12, a21, a22) in
      let i := about_inverse m in
      let '(i11, i12, i21, i22) := i in
      let p := mul2 i m in
      let '(p11, p12, p21, p22) := p in
      let z1 := add (mul i11 y1) (mul i12 y2) in
      let z2 := add (mul i21 y1) (mul i22 y2) in
      let d := det2 p in
      [idiv prec (isub (mul p22 z1) (mul p12 z2)) d; idiv prec (isub (mul p11 z2) (mul p21 z1)) d]
  | _, _ => map (fun _ => None) b
  end.

(* The zeros of functions in the box as a graph over its first coordinates (section 7.4). *)
Record graph := Graph { components : list function; sides : list interval; independent : nat }.

Definition matrix_at (g : graph) (where_ : list interval) : list (list interval) :=
  map (fun h => gradient h where_ (independent g)) (components g).
Definition image_of (g : graph) (x within : list interval) : list interval :=
  let zero := map (fun _ => izero) within in
  solve (matrix_at g (x ++ within)) (map (fun h => iopp (value h (x ++ zero))) (components g)).
Definition image (g : graph) (x : list interval) : list interval := image_of g x (skipn (independent g) (sides g)).
Definition over_ (g : graph) (x : list interval) : list interval :=
  let y := map2 meet (skipn (independent g) (sides g)) (image g x) in
  let second := image_of g x (map from_zero y) in
  x ++ map2 meet y second.

(* The jets of all coordinates less their base point, along the graph. *)
Definition implicit (derivatives : list table) (independent order : nat) : list jet :=
  let n := length derivatives in
  let xs := map (increment independent) (seq 0 independent) in
  let m := map (fun t => map (fun j => lookup None t (unit_exponent (independent + n) (independent + j))) (seq 0 n)) derivatives in
  xs ++ fold_left (fun ys degree =>
    let residuals := map (fun t => compose independent order t (xs ++ ys)) derivatives in
    let found := map (fun i => (i, solve m (map (fun r => iopp (coefficient r i)) residuals)))
                   (of_degree_exactly independent degree) in
    map2 (fun y k => y ++ map (fun is => (fst is, nth k (snd is) None)) found) ys (seq 0 n))
    (seq 1 order) (map (fun _ => []) (seq 0 n)).
Definition jets_along (g : graph) (where_ : list interval) (order : nat) : list jet :=
  implicit (map (fun h => derivatives_at h where_) (components g)) (independent g) order.

End Jets.
