(* What is proved of the Falkner-Skan equation, in full: theorems about real functions. INR j is j as a real number. *)

From Coq Require Import Reals.
From Coquelicot Require Import Coquelicot.
Local Open Scope R_scope.

(* Orbits begin in (0, e, 0), a point that the reversor (x, y, z) -> (-x, y, -z) fixes. Where they meet the line x = z = 0 of all such
   points again, after the time T, they are half of a periodic orbit: its period is 2 T. *)
Definition half_orbit (b e T : R) : Prop := exists x y z : R -> R,
  (x 0 = 0 /\ y 0 = e /\ z 0 = 0) /\
  (forall t, 0 <= t <= T -> is_derive x t (y t) /\ is_derive y t (z t) /\ is_derive z t (b * (y t ^ 2 - 1) - x t * z t)) /\
  x T = 0 /\ z T = 0.

Definition rises (f : R -> R) (l h : R) : Prop := forall u v, l <= u -> u < v -> v <= h -> f u < f v.
Definition falls (f : R -> R) (l h : R) : Prop := forall u v, l <= u -> u < v -> v <= h -> f v < f u.

Section Statement.
(* Parameters b between bl and bh, beginnings e between el and eh. *)
Variables bl bh el eh : R.
Definition J (b : R) : Prop := bl <= b <= bh.
Definition Y (e : R) : Prop := el <= e <= eh.
(* Back on the line x = z = 0 after a time between j tl and j th. *)
Variables tl th : R.
Definition comes_back (j : nat) (b e : R) : Prop := exists T, INR j * tl < T < INR j * th /\ half_orbit b e T.

(* The points that are back after a time between j tl and j th are a curve over b, the same for all j < k. For j = k they are this curve
   and another one over e. The two curves meet in one point, (b0, e0). *)
Definition two_curves (k : nat) (A D : R) (family branch : R -> R) (b0 e0 : R) : Prop :=
  (forall b, J b -> el < family b < eh) /\
  (forall e, Y e -> bl < branch e < bh) /\
  (forall b b', J b -> J b' -> Rabs (family b' - family b) <= A * Rabs (b' - b)) /\
  (forall e e', Y e -> Y e' -> Rabs (branch e' - branch e) <= D * Rabs (e' - e)) /\
  (forall j b e, (1 <= j < k)%nat -> J b -> Y e -> (comes_back j b e <-> e = family b)) /\
  (forall b e, J b -> Y e -> (comes_back k b e <-> e = family b \/ b = branch e)) /\
  bl < b0 < bh /\ el < e0 < eh /\ family b0 = e0 /\ branch e0 = b0 /\
  (forall b e, J b -> Y e -> e = family b -> b = branch e -> b = b0 /\ e = e0).
End Statement.

(* In the box around (b, e) with the radii rb and re, and how the parameter goes along the second curve. *)
Definition bifurcation (k : nat) (b e rb re tl th A D : R) (along : (R -> R) -> R -> R -> R -> Prop) : Prop :=
  exists (family branch : R -> R) (b0 e0 : R),
    two_curves (b - rb) (b + rb) (e - re) (e + re) tl th k A D family branch b0 e0 /\ along branch (e - re) e0 (e + re).

(* The parameter rises along the second curve up to the crossing, and falls after it: it has its only maximum there. *)
Definition period_doubling : Prop :=
  bifurcation 2 (34018753498914353231 / 100000000000000000) (939792756949623004649 / 1000000000000000000000) (1 / 1000000000) (1 / 10000000000000)
    (943 / 4096) (944 / 4096) (1 / 250000) 300 (fun branch el e0 eh => rises branch el e0 /\ falls branch e0 eh).
(* It rises all along: touch-and-go. *)
Definition period_tripling : Prop :=
  bifurcation 3 (45344258682138482263 / 100000000000000000) (939848585715971576541 / 1000000000000000000000) (1 / 1000000000) (1 / 10000000000000)
    (3267 / 16384) (3268 / 16384) (1 / 250000) 8000 (fun branch el _ eh => rises branch el eh).
(* It falls up to the crossing, and rises after it: it has its only minimum there. *)
Definition period_quadrupling : Prop :=
  bifurcation 4 (67995415507296894513 / 100000000000000000) (939904499164097608213 / 1000000000000000000000) (1 / 100000000000) (1 / 1000000000000000)
    (2667 / 16384) (2668 / 16384) (1 / 250000) 600 (fun branch el e0 eh => falls branch el e0 /\ rises branch e0 eh).
