(* All that is checked of one certified bifurcation. *)

From Coq Require Import List ZArith.
From Bignums Require Import BigZ.
From Orbitproof Require Import Polynomials Elements Formats Programs Steps Crossings Rows Identities Intervals Jets Conclusions.
Import ListNotations.
Local Open Scope bool_scope.
Local Open Scope bigZ_scope.
Local Open Scope list_scope.

(* The box of a claim whose level form is checked: in the coordinates of Fix(R); about powers in the first integral on it. *)
Record own := Own { own_domain : box; own_format : format; own_guesses : guesses }.

Record bifurcation := Bifurcation {
  orbits : row;
  reversor : list bigZ             (* signs of the state under R *);
  symmetry : option (list bigZ)    (* those under S, for k = 1 *);
  kernel_frame : list (list rational);
  crossings_of_half : nat          (* m: crossings of a half orbit *);
  parameter_is : option (program * guesses) (* the first integral, where its values on Fix(R) are the parameter *);
  claimed : claim;
  precision : bigZ;
  own_box : option own
}.

(* Parity along a program (section 1.3). *)
Inductive parity := Even | Odd | Both | Neither.
Definition sum_parity (a b : parity) : parity :=
  match a, b with
  | Both, x | x, Both => x
  | Even, Even => Even
  | Odd, Odd => Odd
  | _, _ => Neither
  end.
Definition product_parity (a b : parity) : parity :=
  match a, b with
  | Both, _ | _, Both => Both
  | Neither, _ | _, Neither => Neither
  | Even, x => x
  | Odd, Even => Odd
  | Odd, Odd => Even
  end.
Definition power_parity (p q : nat) (a : parity) : parity :=
  match a with
  | Even => Even
  | Odd => if (q =? 1)%nat then (if Nat.even p then Even else Odd) else Neither
  | _ => Neither
  end.
Definition of_sign (s : bigZ) : parity := if s =? 1 then Even else if s =? -1 then Odd else Neither.
Definition node_parity (found : list parity) (n : node) : parity :=
  let at_ i := nth i found Neither in
  match n with
  | Const a _ => if a =? 0 then Both else Even
  | Add i j | Sub i j => sum_parity (at_ i) (at_ j)
  | Mul i j => product_parity (at_ i) (at_ j)
  | Scale i _ _ => at_ i
  | Power i p q => power_parity p q (at_ i)
  end.
Definition parities (p : program) (signs : list bigZ) : list parity :=
  let given := map of_sign signs ++ map (fun _ => Even) (seq 0 (inputs p - length signs)) in
  let found := fold_left (fun found n => found ++ [node_parity found n]) (nodes p) given in
  map (fun i => nth i found Neither) (outputs p).
Definition is_parity (s : bigZ) (a : parity) : bool :=
  match a with Both => true | Even => s =? 1 | Odd => s =? -1 | Neither => false end.

Definition signs_of (t : bifurcation) : list bigZ := reversor t.
Definition integral_of (t : bifurcation) : option program :=
  match of_level (orbits t), parameter_is t with
  | Some l, _ => Some (integral l)
  | None, Some (p, _) => Some p
  | None, None => None
  end.
Definition all_parities (expected : list bigZ) (found : list parity) : bool :=
  (length expected =? length found)%nat && forallb (fun sa => is_parity (fst sa) (snd sa)) (combine expected found).
Definition symmetries_hold (t : bifurcation) : bool :=
  let p := field (orbits t) in
  let even s := match integral_of t with Some h => all_parities [1] (parities h s) | None => true end in
  well_formed p && (length (reversor t) =? dimension (orbits t))%nat
  && forallb (fun s => (s =? 1) || (s =? -1)) (reversor t)
  && all_parities (map BigZ.opp (reversor t)) (parities p (reversor t)) && even (reversor t)
  && match symmetry t with
     | Some s => (length s =? dimension (orbits t))%nat && forallb (fun s => (s =? 1) || (s =? -1)) s
                 && all_parities s (parities p s) && even s
     | None => true
     end.

(* Determinants of matrices of rational numbers. *)
Definition rmul (a b : rational) : rational := Q (over a * over b) (under a * under b).
Definition radd (a b : rational) : rational := Q (over a * under b + over b * under a) (under a * under b).
Fixpoint without {A : Type} (i : nat) (l : list A) : list A :=
  match i, l with
  | _, [] => []
  | O, _ :: l' => l'
  | S i', x :: l' => x :: without i' l'
  end.
Fixpoint determinant (n : nat) (m : list (list rational)) : rational :=
  match n, m with
  | S n', first :: rest =>
      fold_right radd (Q 0 1) (map (fun j => rmul (Q (if Nat.even j then 1 else -1) 1)
        (rmul (nth j first (Q 0 1)) (determinant n' (map (without j) rest)))) (seq 0 (length first)))
  | _, _ => Q 1 1
  end.
Definition is_regular (m : list (list rational)) : bool :=
  forallb (fun r => (length r =? length m)%nat && forallb is_number r) m && negb (over (determinant (length m) m) =? 0).

Definition is_zero (x : rational) : bool := over x =? 0.
Definition row_of (s : initial) : list rational := match s with Affine _ r => r | OfLevel => [] end.
Definition centre_of (s : initial) : rational := match s with Affine c _ => c | OfLevel => Q 0 1 end.
Definition varies (s : initial) : bool := negb (forallb is_zero (row_of s)).
Definition frame (t : bifurcation) : list (list rational) :=
  match of_level (orbits t) with Some l => [row_of (level_of l)] | None => [] end
  ++ map row_of (filter varies (starts (domain (orbits t)))).

(* Fix(R) has one dimension more where the level of a first integral is the parameter. *)
Definition has_integral (t : bifurcation) : bool :=
  match integral_of t with Some _ => true | None => false end.

(* The box lies in Fix(R); frames are regular (section 7.1). *)
Definition kernel (t : bifurcation) : list nat :=
  map fst (filter (fun is => (snd is =? -1) && negb (fst is =? section (orbits t))%nat)
    (combine (seq 0 (length (reversor t))) (reversor t))).
Definition in_fixed_set (t : bifurcation) : bool :=
  let b := domain (orbits t) in
  forallb (fun ss => match snd ss with
                     | Affine c r => (fst ss =? 1) || (is_zero c && forallb is_zero r)
                     | OfLevel => fst ss =? 1
                     end) (combine (reversor t) (starts b))
  && (nth (section (orbits t)) (reversor t) 0 =? -1)
  && (length (kernel t) =? pred (length (radii b)))%nat
  && (length (reversor t) =? 2 * length (radii b) - (if has_integral t then 0 else 1))%nat.
Definition frames_hold (t : bifurcation) : bool :=
  in_fixed_set t
  && match of_level (orbits t) with
     | Some l => is_number (centre_of (level_of l)) && (length (row_of (level_of l)) =? length (radii (domain (orbits t))))%nat
     | None => true
     end
  && (length (frame t) =? length (radii (domain (orbits t))))%nat && is_regular (frame t)
  && (length (kernel_frame t) =? length (kernel t))%nat && is_regular (kernel_frame t).

(* Frames that S acts on by signs (section 8.6). *)
Definition adapted_row (s : bigZ) (r : list rational) : bool :=
  forallb (fun jx => is_zero (snd jx) || (if (fst jx =? 1)%nat then s =? -1 else s =? 1)) (combine (seq 0 (length r)) r).
Definition adapted (t : bifurcation) : bool :=
  match symmetry t with
  | None => negb (multiplicity (claimed t) =? 1)%nat
  | Some s =>
      forallb (fun si => match snd si with
        | Affine c r => ((fst si =? 1) || is_zero c) && adapted_row (fst si) r
        | OfLevel => fst si =? 1
        end) (combine s (starts (domain (orbits t))))
      && forallb (fun s => adapted_row 1 (row_of s)) (skipn (dimension (orbits t)) (starts (domain (orbits t))))
      && match of_level (orbits t) with Some l => adapted_row 1 (row_of (level_of l)) | None => true end
      && forallb (fun jr => forallb (fun ix => is_zero (snd ix) ||
           (nth (fst ix) s 0 =? (if (fst jr =? 0)%nat then -1 else 1))) (combine (kernel t) (snd jr)))
         (combine (seq 0 (length (kernel_frame t))) (kernel_frame t))
  end.

(* The coordinates q of a crossing, in their frame. *)
Definition kernel_components (t : bifurcation) (s : state) : list element :=
  let f := row_format (orbits t) in
  let parts := map (fun i => nth i s missing) (kernel t) in
  map (fun r => match fold_right (fun rx sum => match sum with
                  | Some y => Some (eadd f (escale f (over (fst rx)) (under (fst rx)) (snd rx)) y)
                  | None => Some (escale f (over (fst rx)) (under (fst rx)) (snd rx))
                  end) None (combine r parts) with Some x => x | None => missing end) (kernel_frame t).

Definition functions_at (t : bifurcation) (s : state) : list function :=
  map (function_of (precision t) (row_format (orbits t)) (domain (orbits t))) (kernel_components t s).

(* Of every m-th crossing. *)
Definition every (m : nat) (images : list state) : list state :=
  map snd (filter (fun ni => (Nat.modulo (S (fst ni)) m =? 0)%nat) (combine (seq 0 (length images)) images)).
Definition before_half (m : nat) (images : list state) : list state := firstn (pred m) images.

(* The values of the first integral on the box. *)
Definition integral_on_box (t : bifurcation) (p : program) (gs : guesses) : option function :=
  let flat := of_degree (row_format (orbits t)) 0 in
  match begin (orbits t) with
  | Some given =>
      match evaluate flat p gs given with
      | Some values => match values_at p values with
                       | [h] => Some (function_of (precision t) flat (domain (orbits t)) h)
                       | _ => None
                       end
      | None => None
      end
  | None => None
  end.

Definition middle_of (t : bifurcation) : rational :=
  match of_level (orbits t) with
  | Some l => match level_of l with Affine c _ => c | OfLevel => Q 0 1 end
  | None => match filter varies (skipn (dimension (orbits t)) (starts (domain (orbits t)))) with
            | [Affine c _] => c
            | _ => Q 0 1
            end
  end.

(* The parameter is the first coordinate: its row of the frame is (1, 0, ..). *)
Definition first_row (r : list rational) : bool :=
  match r with
  | a :: r' => (over a =? under a) && forallb is_zero r'
  | [] => false
  end.
Definition parameter_first (t : bifurcation) : bool :=
  match of_level (orbits t), parameter_is t with
  | Some l, None => first_row (row_of (level_of l))
                    && forallb (fun s => negb (varies s)) (skipn (dimension (orbits t)) (starts (domain (orbits t))))
  | None, None => match filter varies (skipn (dimension (orbits t)) (starts (domain (orbits t)))) with
                  | [s] => first_row (row_of s)
                  | _ => false
                  end
  | None, Some _ => forallb (fun s => negb (varies s)) (skipn (dimension (orbits t)) (starts (domain (orbits t))))
  | Some _, Some _ => false
  end.

Definition problem_of (t : bifurcation) (images : list state) : option problem :=
  let fs := map (functions_at t) (every (crossings_of_half t) images) in
  let rs := radii (domain (orbits t)) in
  match parameter_is t with
  | None => Some (Problem rs (middle_of t) fs None)
  | Some (p, gs) => match integral_on_box t p gs with
                    | Some h => Some (Problem rs (Q 0 1) fs (Some h))
                    | None => None
                    end
  end.

(* No point of the box is mapped into Fix(R) before its half orbit ends (section 8.8). *)
Definition half_orbit_holds (t : bifurcation) (images : list state) : bool :=
  let zero := map (fun _ => O) (radii (domain (orbits t))) in
  forallb (fun s => existsb (fun h => nonzero (lookup None (on_box h) zero)) (functions_at t s))
    (before_half (crossings_of_half t) images).

(* The first integral is one, and the level coordinate follows from it (sections 1.4 and 12.1). *)
Definition integrals_hold (t : bifurcation) : bool :=
  match integral_of t with
  | Some h => first_integral_holds (field (orbits t)) h (dimension (orbits t))
  | None => true
  end
  && match of_level (orbits t) with
     | Some l =>
         match filter (fun i => match nth i (starts (domain (orbits t))) (Affine (Q 0 1) []) with OfLevel => true | _ => false end)
                 (seq 0 (length (starts (domain (orbits t))))) with
         | [w] => (w <? dimension (orbits t))%nat && level_form_holds (integral l) w (square l)
         | _ => false
         end
     | None => true
     end.

Definition exact_hypotheses (t : bifurcation) : bool :=
  symmetries_hold t && integrals_hold t && frames_hold t && adapted t && parameter_first t
  && (0 <=? precision t) && (1 <=? multiplicity (claimed t))%nat && (1 <=? crossings_of_half t)%nat
  && (if tangential (claimed t) then true else (multiplicity (claimed t) =? 3)%nat)
  && (if tangential (claimed t)
      then (multiplicity (claimed t) =? 1)%nat || Nat.even (multiplicity (claimed t)) || (5 <=? multiplicity (claimed t))%nat
      else true).

(* The inverse of a regular matrix, by its minors. *)
Definition minor (m : list (list rational)) (i j : nat) : rational :=
  let sign := if Nat.even (i + j) then 1 else -1 in
  rmul (Q sign 1) (determinant (pred (length m)) (map (without j) (without i m))).
Definition rdiv (a b : rational) : rational :=
  if 0 <? over b then Q (over a * under b) (under a * over b) else Q (- over a * under b) (under a * - over b).
Definition inverse (m : list (list rational)) : list (list rational) :=
  let d := determinant (length m) m in
  map (fun i => map (fun j => rdiv (minor m j i) d) (seq 0 (length m))) (seq 0 (length m)).

Definition same_number (a b : rational) : bool := over a * under b =? over b * under a.
Definition rabs (a : rational) : rational := Q (BigZ.abs (over a)) (under a).
Definition rless (a b : rational) : bool := over a * under b <? over b * under a.
Definition rdot (a b : list rational) : rational := fold_right radd (Q 0 1) (map2 rmul a b).

(* Programs on intervals, with roots. *)
Section Ranges.
Variable prec : bigZ.
Definition isqrt (a : interval) : interval :=
  match a with
  | Some (l, h) =>
      if 0 <? l then
        let up_root x := let r := BigZ.sqrt x in if r * r =? x then r else r + 1 in
        Some (BigZ.sqrt (BigZ.shiftl l prec), up_root (BigZ.shiftl h prec))
      else None
  | None => None
  end.
Definition inverse_power (p q : nat) (a : interval) : interval :=
  match q with
  | S O => idiv prec (inumber prec 1 1) (ipower prec a p)
  | S (S O) => idiv prec (inumber prec 1 1) (ipower prec (isqrt a) p)
  | _ => None
  end.
Definition node_range (found : list interval) (n : node) : interval :=
  let at_ i := nth i found None in
  match n with
  | Const a b => inumber prec a b
  | Add i j => iadd (at_ i) (at_ j)
  | Sub i j => isub (at_ i) (at_ j)
  | Mul i j => imul prec (at_ i) (at_ j)
  | Scale i a b => iscale a b (at_ i)
  | Power i p q => inverse_power p q (at_ i)
  end.
Definition ranges (p : program) (given : list interval) : list interval :=
  let found := fold_left (fun found n => found ++ [node_range found n]) (nodes p) given in
  map (fun i => nth i found None) (outputs p).
Definition of_rational (a : rational) : interval := inumber prec (over a) (under a).
Definition at_point (where_ : list interval) (s : initial) : interval :=
  match s with
  | Affine c r => iadd (of_rational c) (isum (map2 (fun a x => iscale (over a) (under a) x) r where_))
  | OfLevel => izero
  end.
End Ranges.

(* The box of the level form contains the claim's own box, on which the level coordinate has its sign (section 12.3). *)
Definition own_box_inside (t : bifurcation) (l : level) (o : own) : bool :=
  let prec := precision t in
  let b := own_domain o in
  let form := starts (domain (orbits t)) in
  let indices := seq 0 (length form) in
  let kept := filter (fun i => varies (nth i form OfLevel)) indices in
  let dropped := filter (fun i => match nth i form (Affine (Q 0 1) []) with OfLevel => true | _ => false end) indices in
  let flat := of_degree (own_format o) 0 in
  good_format (own_format o) (weights b) && good_box flat b && (length (starts b) =? length form)%nat && (length (radii b) =? length (radii (domain (orbits t))))%nat
  && forallb (fun so => match fst so, snd so with
                        | Affine c r, Affine c' r' => same_number c c' && (varies (fst so) || negb (varies (snd so)))
                        | OfLevel, Affine c r =>
                            rless (fold_right radd (Q 0 1) (map2 (fun a x => rmul (rabs a) x) r (radii b)))
                                  (rmul (Q (level_sign l) 1) c)
                        | _, OfLevel => false
                        end) (combine form (starts b))
  && (length dropped =? 1)%nat
  && match evaluate flat (integral l) (own_guesses o) (map (input_of flat b) (starts b)) with
     | Some values =>
         match values_at (integral l) values with
         | [h] =>
             let table := function_of prec flat b h in
             let n := length (radii b) in
             let sides := map (fun r => match of_rational prec r with Some (_, x) => Some (- x, x) | None => None end) (radii b) in
             let second := isum (flat_map (fun i => map (fun j =>
               iscale 1 2 (imul prec (imul prec
                 (lookup None (on_box table) (plus (unit_exponent n i) (unit_exponent n j))) (nth i sides None)) (nth j sides None)))
               (seq 0 n)) (seq 0 n)) in
             let offset := iadd (isub (lookup None (at_centre table) (map (fun _ => O) sides))
                                      (of_rational prec (centre_of (level_of l)))) second in
             let rows := inverse (frame t) in
             let image r :=
               let first := hd (Q 0 1) r in
               iadd (iscale (over first) (under first) offset)
                 (isum (map (fun j =>
                    let direct := fold_right radd (Q 0 1)
                      (map2 (fun a i => rmul a (nth j (row_of (nth i (starts b) OfLevel)) (Q 0 1))) (tl r) kept) in
                    imul prec (iadd (iscale (over first) (under first) (lookup None (at_centre table) (unit_exponent n j)))
                                    (of_rational prec direct)) (nth j sides None)) (seq 0 n))) in
             forallb (fun ri => inside prec (image (fst ri)) (over (snd ri)) (under (snd ri)))
               (combine rows (radii (domain (orbits t))))
         | _ => false
         end
     | None => false
     end.

(* The bifurcation point, known by its coordinates in the box of the level form, lies in the claim's own box. *)
Definition point_in_own_box (t : bifurcation) (l : level) (o : own) (where_ : list interval) : bool :=
  let prec := precision t in
  let form := starts (domain (orbits t)) in
  let b := own_domain o in
  let given := map (at_point prec where_) form in
  let h := at_point prec where_ (level_of l) in
  match ranges prec (integral l) given with
  | [a] =>
      let w := iscale (level_sign l) 1 (isqrt prec (iscale (over (square l)) (under (square l)) (isub h a))) in
      let chosen := filter (fun i => match nth i form (Affine (Q 0 1) []) with OfLevel => true | s => varies s end)
                      (seq 0 (length form)) in
      let distance i :=
        let x := match nth i form OfLevel with OfLevel => w | _ => nth i given None end in
        isub x (of_rational prec (centre_of (nth i (starts b) OfLevel))) in
      let own_frame := map (fun i => row_of (nth i (starts b) OfLevel)) chosen in
      let ds := map distance chosen in
      let ps := map (fun r => isum (map2 (fun a x => iscale (over a) (under a) x) r ds)) (inverse own_frame) in
      is_regular own_frame && (length ps =? length (radii b))%nat
      && forallb (fun pr => inside prec (fst pr) (over (snd pr)) (under (snd pr))) (combine ps (radii b))
  | _ => false
  end.

Definition own_box_holds (t : bifurcation) (where_ : list interval) : bool :=
  match of_level (orbits t), own_box t with
  | Some l, Some o => own_box_inside t l o && point_in_own_box t l o where_
  | _, None => true
  | None, Some _ => false
  end.

Definition conclusion_holds (t : bifurcation) (images : list state) : bool :=
  (length images =? crossings_of_half t * multiplicity (claimed t))%nat
  && forallb (forallb constant_in_time) images
  && half_orbit_holds t images
  && match problem_of t images with
     | Some pb => concluded (precision t) pb (claimed t)
                  && own_box_holds t (point (precision t) pb (claimed t) steps_to_point)
     | None => false
     end.

(* What the files of a row show. *)
Definition checked (t : bifurcation) : Prop :=
  exists p images, follows (orbits t) p images /\ exact_hypotheses t = true /\ conclusion_holds t images = true.
