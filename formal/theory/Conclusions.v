(* The hypotheses of the theorems on bifurcations, from tables of derivatives (sections 8, 9 and 11 of the chapter
   verify/bifurcation). *)

From Coq Require Import List ZArith.
From Bignums Require Import BigZ.
From Orbitproof Require Import Polynomials Elements Formats Programs Steps Rows Intervals Jets.
Import ListNotations.
Local Open Scope bool_scope.
Local Open Scope bigZ_scope.
Local Open Scope list_scope.

(* What is claimed: orbits of multiplicity k branch off; the parameter has an extremum along the branch, or not. *)
Record claim := Claim {
  multiplicity : nat;
  tangential : bool;
  claimed_side : bigZ           (* 1 above, -1 below, 0 both *);
  stated : rational * rational  (* between these is the parameter at the bifurcation point *)
}.

(* The functions q of P, .., P^k, and the first integral if it is the parameter (else the first coordinate is). *)
Record problem := Problem {
  sizes_of_box : list rational;
  middle_of_parameter : rational;
  iterates : list (list function);
  first_integral : option function
}.

Section Conclusions.
Variable prec : bigZ.
Variable pb : problem.
Variable c : claim.

Let k := multiplicity c.
Definition half (r : rational) : interval :=
  match inumber prec (over r) (under r) with Some (_, h) => Some (- h, h) | None => None end.
Definition p_box : list interval := map half (sizes_of_box pb).
Definition p_ (i : nat) : interval := nth i p_box None.
Definition inside_side (i : nat) (x : interval) : bool :=
  let r := nth i (sizes_of_box pb) (Q 0 1) in inside prec x (over r) (under r).
Definition all_inside (from : nat) (xs : list interval) : bool :=
  forallb (fun ix => inside_side (fst ix) (snd ix)) (combine (seq from (length xs)) xs).

Definition iterate (i : nat) : list function := nth (pred i) (iterates pb) [].

(* All tables are there and have finite entries, n of them for each iterate. *)
Definition known_entry (e : index * interval) : bool := match snd e with Some _ => true | None => false end.
Definition is_known (h : function) : bool := forallb known_entry (on_box h) && forallb known_entry (at_centre h).
Definition tables_known : bool :=
  (length (iterates pb) =? k)%nat && (2 <=? length (sizes_of_box pb))%nat
  && forallb (fun hs => (S (length hs) =? length (sizes_of_box pb))%nat && forallb is_known hs) (iterates pb)
  && match first_integral pb with Some h => is_known h | None => true end.

(* Sections 8.1 and 8.2. *)
Definition family_graph : graph := Graph (iterate 1) p_box 1.
Definition has_family : bool :=
  regular prec (matrix_at prec family_graph p_box) && all_inside 1 (image prec family_graph (firstn 1 p_box)).
Definition no_other (i : nat) : bool := regular prec (map (fun h => gradient prec h p_box 1) (iterate i)).

(* Section 8.3: the graph of p_2^H, and the function G. *)
Definition component : function := hd (Function [] []) (iterate k).
Definition reduction : graph := Graph (tl (iterate k)) p_box 2.
Definition over_both (p0 p1 : interval) : list interval := over_ prec reduction [p0; p1].
Definition restricted (h : function) (where_ : list interval) : jet :=
  compose prec 2 3 (derivatives_at prec h where_) (jets_along prec reduction where_ 3).
Definition jet_of_G (where_ : list interval) : jet := restricted component where_.
Definition G_ (j : jet) (a b : nat) : interval := of_jet prec j [a; b].

(* The family: of period-two points for k > 1; of doubly symmetric points, p_1 = 0, for k = 1 (section 8.6). *)
Definition on_family (p0 : interval) : list interval :=
  if (k =? 1)%nat then over_both p0 izero else over_ prec family_graph [p0].
Definition family_jet (where_ : list interval) : interval * interval :=
  if (k =? 1)%nat then (izero, izero) else
  let j := nth 1 (jets_along prec family_graph where_ 2) [] in
  (coefficient j [1%nat], iscale 2 1 (coefficient j [2%nat])).

Definition reduces : bool :=
  regular prec (matrix_at prec reduction p_box)
  && all_inside 2 (image prec reduction (firstn 2 p_box))
  && inside_side 1 (if (k =? 1)%nat then izero else nth 1 (on_family (p_ 0)) None).

(* Section 8.4: the reduced function. *)
Let mul := imul prec.
Let add := iadd.
Definition part_of (n : bigZ) (x : interval) : interval := iscale 1 n x.
Definition crossing_of (where_ : list interval) (p1_slope : interval) : interval :=
  let j := jet_of_G where_ in add (G_ j 1 1) (mul (G_ j 0 2) p1_slope).
Definition g0 : interval :=
  let j := jet_of_G (over_both (p_ 0) (p_ 1)) in
  add (G_ j 1 1) (part_of 2 (mul (G_ j 0 2) (fst (family_jet (on_family (p_ 0)))))).
Definition square_of (x : interval) : interval :=
  match mul x x with
  | Some (l, h) => match x with
                   | Some (a, b) => if (a <=? 0) && (0 <=? b) then Some (0, BigZ.max 0 (up (BigZ.max (a * a) (b * b)) prec))
                                    else Some (l, h)
                   | None => None
                   end
  | None => None
  end.
Definition g_at_centre : interval :=
  let foot := on_family izero in
  let at_foot := jet_of_G foot in
  let across := jet_of_G (over_both izero (p_ 1)) in
  let d := isub (p_ 1) (nth 1 foot None) in
  let v := G_ at_foot 0 1 in
  meet (add v (part_of 2 (mul (G_ across 0 2) d)))
       (add (add v (part_of 2 (mul (G_ at_foot 0 2) d))) (part_of 6 (mul (G_ across 0 3) (square_of d)))).
Definition has_branch : bool :=
  nonzero g0 && inside_side 0 (idiv prec (iopp g_at_centre) g0).

(* Section 8.5. *)
Definition cross_once : bool :=
  let where_ := on_family (p_ 0) in nonzero (crossing_of where_ (fst (family_jet where_))).

(* Section 8.7: the point. *)
Definition narrower (p0 : interval) : interval :=
  let m := middle p0 in
  if inside_side 0 m then
    let value := G_ (jet_of_G (on_family m)) 0 1 in
    let where_ := on_family p0 in
    meet p0 (isub m (idiv prec value (crossing_of where_ (fst (family_jet where_)))))
  else p0.
Definition point (steps : nat) : list interval := on_family (Nat.iter steps narrower (p_ 0)).

Definition between (x : interval) : bool :=
  match x with
  | Some (l, h) =>
      let '(a, b) := stated c in
      (0 <? under a) && (0 <? under b)
      && (BigZ.shiftl (over a) prec <? l * under a) && (h * under b <? BigZ.shiftl (over b) prec)
  | None => false
  end.
Definition side_holds (second : interval) : bool :=
  if claimed_side c =? 1 then positive second else if claimed_side c =? -1 then negative second else false.

(* Sections 9.1 and 9.2: maps with a parameter. *)
Definition conclude_for_maps (where_ : list interval) : bool :=
  let j := jet_of_G where_ in
  let m := inumber prec (over (middle_of_parameter pb)) (under (middle_of_parameter pb)) in
  between (add m (nth 0 where_ None)) &&
  if tangential c then
    let mixed := meet (G_ j 1 1) (crossing_of where_ (fst (family_jet where_))) in
    let third := G_ j 0 3 in
    nonzero mixed && nonzero third && side_holds (iopp (idiv prec third mixed))
  else nonzero (G_ j 0 2) && (claimed_side c =? 0).

(* Sections 9.3 and 9.4: the level of the first integral as parameter. *)
Definition conclude_for_levels (h : function) (where_ : list interval) : bool :=
  let j := jet_of_G where_ in
  let l := restricted h where_ in
  let '(slope, curvature) := family_jet where_ in
  let k0 := G_ l 1 0 in let k1 := G_ l 0 1 in
  let h_fp := add k0 (mul k1 slope) in
  let at_point := add (G_ j 1 1) (part_of 2 (mul (G_ j 0 2) slope)) in
  let g1 := part_of 2 (G_ j 0 2) in
  nonzero (hd None (gradient prec h where_ 0)) && nonzero h_fp && between (value prec h where_) &&
  if tangential c then
    let s := if (k =? 1)%nat then izero
             else meet (idiv prec (iopp g1) at_point) (idiv prec (iopp k1) k0) in
    let g11 := part_of 3 (G_ j 0 3) in
    let g01 := add (part_of 2 (G_ j 1 2)) (part_of 6 (mul (G_ j 0 3) slope)) in
    let g00 := add (add (G_ j 2 1) (mul (G_ j 1 2) slope))
                   (add (part_of 3 (mul (mul (G_ j 0 3) slope) slope)) (part_of 2 (mul (G_ j 0 2) curvature))) in
    let bent := idiv prec (iopp (add (add (mul (mul g00 s) s) (iscale 2 1 (mul g01 s))) g11)) at_point in
    let h_b := add (add (mul (mul (G_ l 2 0) s) s) (iscale 2 1 (mul (G_ l 1 1) s)))
                   (add (G_ l 0 2) (mul k0 bent)) in
    nonzero h_b && side_holds h_b
  else
    nonzero (add (mul k0 (idiv prec (iopp g1) at_point)) k1) && (claimed_side c =? 0).

Definition steps_to_point : nat := 5.

Definition concluded : bool :=
  tables_known
  && ((k =? 1)%nat || (has_family && forallb no_other (seq 1 (pred k))))
  && reduces && has_branch && cross_once
  && let where_ := point steps_to_point in
     all_inside 0 where_ &&
     match first_integral pb with
     | None => conclude_for_maps where_
     | Some h => conclude_for_levels h where_
     end.

(* How far it holds, for whoever looks for a failure. *)
Definition hypotheses_hold : list bool :=
  [tables_known; (k =? 1)%nat || has_family; (k =? 1)%nat || forallb no_other (seq 1 (pred k)); reduces; has_branch; cross_once;
   all_inside 0 (point steps_to_point)].
End Conclusions.
