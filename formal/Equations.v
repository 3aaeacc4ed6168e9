(** The equations of a cycle of the egg at [alpha = 2/25] as formulas, in polar coordinates. *)

From Coquelicot Require Import Coquelicot.
From Coq Require Import Reals ZArith List Lra Lia Psatz.
From Pinball Require Import Newton Jets Bounce Generated Cascade.
Open Scope R_scope.

Definition shape : R := 2 / 25.

Definition shape_ : formula := Div (Int 2) (Int 25).
Definition thrice (b : formula) : formula := Mul (Int 3) b.
Definition rho_ (b : formula) : formula := Add (Mul shape_ (Cos (thrice b))) (Int 1).
Definition slope_ (b : formula) : formula := Mul (Mul (Int (-3)) shape_) (Sin (thrice b)).
Definition bend_ (b : formula) : formula := Mul (Mul (Int (-9)) shape_) (Cos (thrice b)).
Definition normal_ (b c : formula) : formula :=
  Add (Mul (rho_ c) (Sub (Mul (slope_ b) (Sin (Sub c b))) (Mul (rho_ b) (Cos (Sub c b))))) (Mul (rho_ b) (rho_ b)).
Definition tangential_ (b c : formula) : formula :=
  Sub (Mul (rho_ c) (Add (Mul (slope_ b) (Cos (Sub c b))) (Mul (rho_ b) (Sin (Sub c b))))) (Mul (rho_ b) (slope_ b)).
Definition square_ (b c : formula) : formula :=
  Sub (Add (Mul (rho_ b) (rho_ b)) (Mul (rho_ c) (rho_ c))) (Mul (Mul (Int 2) (Mul (rho_ b) (rho_ c))) (Cos (Sub c b))).
Definition turning_ (b : formula) : formula :=
  Div (Sub (Add (Mul (rho_ b) (rho_ b)) (Mul (Int 2) (Mul (slope_ b) (slope_ b)))) (Mul (rho_ b) (bend_ b)))
      (Add (Mul (rho_ b) (rho_ b)) (Mul (slope_ b) (slope_ b))).
Definition law_ (a b c lam : formula) : formula :=
  Add (Atan (Div (tangential_ b c) (normal_ b c))) (Mul lam (Atan (Div (tangential_ b a) (normal_ b a)))).
Definition moves_ (a b c lam va vb vc : formula) : formula :=
  Add (Add (Mul (Div (normal_ c b) (square_ b c)) vc)
           (Mul (Add (Sub (Div (normal_ b c) (square_ b c)) (Mul (Add (Int 1) lam) (turning_ b)))
                     (Mul lam (Div (normal_ b a) (square_ b a)))) vb))
      (Mul (Mul lam (Div (normal_ a b) (square_ a b))) va).

Lemma radius_pos b : 0 < shape * cos (3 * b) + 1.
Proof. unfold shape. generalize (COS_bound (3 * b)). lra. Qed.

Lemma value_normal x b c : value x (normal_ b c) = normal shape (value x b) (value x c).
Proof.
  unfold normal, normal_, rho_, slope_, thrice, shape_, X1, Y1, egg_x, egg_y; cbn [value]. fold shape.
  rewrite cos_minus, sin_minus. assert (one := sin2_cos2 (value x b)). unfold Rsqr in one.
  set (cb := cos (value x b)) in *. set (sb := sin (value x b)) in *.
  set (rb := shape * cos (3 * value x b)). set (r1 := shape * sin (3 * value x b)). clearbody cb sb.
  apply Rminus_diag_uniq. transitivity ((rb + 1) ^ 2 * (1 - (sb * sb + cb * cb))); [unfold rb, r1; ring | rewrite one; ring].
Qed.

Lemma value_tangential x b c : value x (tangential_ b c) = tangential shape (value x b) (value x c).
Proof.
  unfold tangential, tangential_, rho_, slope_, thrice, shape_, X1, Y1, egg_x, egg_y; cbn [value]. fold shape.
  rewrite cos_minus, sin_minus. assert (one := sin2_cos2 (value x b)). unfold Rsqr in one.
  set (cb := cos (value x b)) in *. set (sb := sin (value x b)) in *. clearbody cb sb.
  apply Rminus_diag_uniq.
  transitivity ((shape * cos (3 * value x b) + 1) * (-3 * shape * sin (3 * value x b)) * ((sb * sb + cb * cb) - 1));
    [ring | rewrite one; ring].
Qed.

Lemma value_square x b c : value x (square_ b c) = square shape (value x b) (value x c).
Proof.
  unfold square, square_, rho_, thrice, shape_, egg_x, egg_y; cbn [value]. fold shape.
  rewrite cos_minus. assert (oneb := sin2_cos2 (value x b)). assert (onec := sin2_cos2 (value x c)).
  unfold Rsqr in oneb, onec.
  set (rb := shape * cos (3 * value x b) + 1). set (rc := shape * cos (3 * value x c) + 1).
  apply Rminus_diag_uniq.
  transitivity (rb ^ 2 * (1 - (sin (value x b) * sin (value x b) + cos (value x b) * cos (value x b)))
    + rc ^ 2 * (1 - (sin (value x c) * sin (value x c) + cos (value x c) * cos (value x c)))); [ring |].
  rewrite oneb, onec. ring.
Qed.

Lemma speed_squared u : X1 shape u ^ 2 + Y1 shape u ^ 2 = (shape * cos (3 * u) + 1) ^ 2 + (-3 * shape * sin (3 * u)) ^ 2.
Proof.
  unfold X1, Y1. assert (one := sin2_cos2 u). unfold Rsqr in one.
  apply Rminus_diag_uniq.
  transitivity (((shape * cos (3 * u) + 1) ^ 2 + (-3 * shape * sin (3 * u)) ^ 2) * ((sin u * sin u + cos u * cos u) - 1));
    [ring | rewrite one; ring].
Qed.

Lemma speed_pos u : 0 < speed shape u.
Proof. unfold speed. apply sqrt_lt_R0. rewrite speed_squared. generalize (radius_pos u). nra. Qed.

Lemma value_turning x b : value x (turning_ b) = - (egg_curvature shape (value x b) * speed shape (value x b)).
Proof.
  set (u := value x b). assert (pos := speed_pos u).
  assert (two : speed shape u ^ 2 = (shape * cos (3 * u) + 1) ^ 2 + (-3 * shape * sin (3 * u)) ^ 2).
  { unfold speed. rewrite pow2_sqrt; [apply speed_squared |]. rewrite speed_squared. generalize (radius_pos u). nra. }
  unfold egg_curvature.
  replace (- (- (X1 shape u * Y2 shape u - Y1 shape u * X2 shape u) / speed shape u ^ 3 * speed shape u))
    with ((X1 shape u * Y2 shape u - Y1 shape u * X2 shape u) / speed shape u ^ 2) by (field; lra).
  rewrite two. unfold turning_, rho_, slope_, bend_, thrice, shape_; cbn [value]. fold shape. fold u.
  replace ((shape * cos (3 * u) + 1) * (shape * cos (3 * u) + 1) + -3 * shape * sin (3 * u) * (-3 * shape * sin (3 * u)))
    with ((shape * cos (3 * u) + 1) ^ 2 + (-3 * shape * sin (3 * u)) ^ 2) by ring.
  f_equal. unfold X1, Y1, X2, Y2. assert (one := sin2_cos2 u). unfold Rsqr in one.
  set (s := sin u) in *. set (c := cos u) in *. set (p := sin (3 * u)). set (q := cos (3 * u)). clearbody s c p q.
  apply Rminus_diag_uniq.
  transitivity (((shape * q + 1) ^ 2 + 2 * (-3 * shape * p) ^ 2 + 9 * shape * q * (shape * q + 1)) * (1 - (s * s + c * c)));
    [ring | rewrite one; ring].
Qed.

Lemma value_law x a b c lam :
  value x (law_ a b c lam) = angle shape (value x b) (value x c) + value x lam * angle shape (value x b) (value x a).
Proof.
  unfold law_. cbn [value]. rewrite !value_normal, !value_tangential. reflexivity.
Qed.

Lemma value_moves x a b c lam va vb vc :
  value x (moves_ a b c lam va vb vc) = 0 <->
  moves_along shape (value x lam) (value x a) (value x b) (value x c) (value x va) (value x vb) (value x vc).
Proof.
  unfold moves_, moves_along. cbn [value]. rewrite !value_normal, !value_square, value_turning.
  match goal with |- ?l = 0 <-> ?r = 0 => replace l with r by ring end. reflexivity.
Qed.
