(* Polynomials in theta with integer coefficients, lowest power first (section 2.2 of the chapter verify/algebra).

   An integer c of scale s stands for the number c / 2^s. *)

From Coq Require Import List ZArith.
From Bignums Require Import BigZ.
Import ListNotations.
Local Open Scope bool_scope.
Local Open Scope bigZ_scope.
Local Open Scope list_scope.

Definition poly := list bigZ.

(* x / 2^k, rounded down; x / 2^k, rounded up. k may be negative: then both are exact. *)
Definition down (x k : bigZ) : bigZ := BigZ.shiftr x k.
Definition up (x k : bigZ) : bigZ := - BigZ.shiftr (- x) k.

Fixpoint padd (p q : poly) : poly :=
  match p, q with
  | [], _ => q
  | _, [] => p
  | a :: p', b :: q' => (a + b) :: padd p' q'
  end.

Definition pscale (c : bigZ) (p : poly) : poly := map (BigZ.mul c) p.
Definition psub (p q : poly) : poly := padd p (map BigZ.opp q).

(* The first n coefficients of a product. *)
Fixpoint pscale_to (n : nat) (c : bigZ) (p : poly) : poly :=
  match n, p with
  | S n', a :: p' => c * a :: pscale_to n' c p'
  | _, _ => []
  end.

Fixpoint pmul (n : nat) (p q : poly) : poly :=
  match n, p with
  | S n', a :: p' => padd (pscale_to n a q) (0 :: pmul n' p' q)
  | _, _ => []
  end.

(* The sum of the absolute values of the coefficients: it bounds the values on [0, 1]. *)
Definition l1 (p : poly) : bigZ := fold_right (fun a s => BigZ.abs a + s) 0 p.

(* What pmul leaves out: a bound for the sum of the absolute values of the coefficients from n on. *)
Fixpoint pmul_rest (n : nat) (p q : poly) : bigZ :=
  match p with
  | [] => 0
  | a :: p' => match n with
               | S n' => BigZ.abs a * l1 (skipn n q) + pmul_rest n' p' q
               | O => l1 p * l1 q
               end
  end.

(* The derivative of a polynomial whose first coefficient is that of theta^k, k = 0 for all of it. *)
Fixpoint pderiv_from (k : bigZ) (p : poly) : poly :=
  match p with
  | [] => []
  | a :: p' => k * a :: pderiv_from (k + 1) p'
  end.
Definition pderiv (p : poly) : poly := pderiv_from 1 (tl p).

(* The value at theta = 1, and at theta = 0. *)
Definition at_one (p : poly) : bigZ := fold_right BigZ.add 0 p.
Definition at_zero (p : poly) : bigZ := hd 0 p.

(* p of degree d at (c + s) / 2^e, times 2^(e d), as a polynomial in s. *)
Fixpoint homogeneous (e : bigZ) (p : poly) : poly :=
  match p with
  | [] => []
  | a :: p' => BigZ.shiftl a (e * BigZ.of_Z (Z.of_nat (length p'))) :: homogeneous e p'
  end.
Fixpoint shifted (c : bigZ) (p : poly) : poly :=
  match p with
  | [] => []
  | a :: p' => let q := shifted c p' in padd [a] (padd (pscale c q) (0 :: q))
  end.
Definition recentred (c e : bigZ) (p : poly) : poly := shifted c (homogeneous e p).

(* Up to which power of 2 the values of recentred have been multiplied. *)
Definition recentred_scale (e : bigZ) (p : poly) : bigZ := e * BigZ.of_Z (Z.of_nat (pred (length p))).
