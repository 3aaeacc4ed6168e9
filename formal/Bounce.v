(** One flight and one reflection: the derivative matrix, by implicit differentiation. Paper: section 2.1.

    The boundary enters by the Frenet equations alone, [X' = cos psi], [Y' = sin psi], [psi' = -K], at the two
    bounces: [psi] is the direction of the tangent, and [K] the curvature in the paper's sign, negative where the
    boundary focuses. A particle leaves [s0] with exit angle [phi], in the direction [psi0 + PI/2 - phi], flies a
    length [t], and lands at [s1] with incidence angle [eta = psi1 - direction - PI/2]. The law is [-lam*eta]. *)

From Coq Require Import Reals Lra.
From Coquelicot Require Import Coquelicot.
Open Scope R_scope.

Record matrix := Matrix { a11 : R; a12 : R; a21 : R; a22 : R }.

Definition identity : matrix := Matrix 1 0 0 1.

Definition product (m n : matrix) : matrix :=
  Matrix (a11 m * a11 n + a12 m * a21 n) (a11 m * a12 n + a12 m * a22 n)
         (a21 m * a11 n + a22 m * a21 n) (a21 m * a12 n + a22 m * a22 n).

Definition trace (m : matrix) : R := a11 m + a22 m.
Definition det (m : matrix) : R := a11 m * a22 m - a12 m * a21 m.
Definition discriminant (m : matrix) : R := trace m ^ 2 - 4 * det m.

(** The characteristic polynomial; its roots are the multipliers. *)
Definition characteristic (m : matrix) (mu : R) : R := mu ^ 2 - trace m * mu + det m.

(** The matrix of eq. (derivative_of_map), in the paper's letters. *)
Definition bounce (K0 K1 t cos_phi0 cos_eta1 lam : R) : matrix :=
  let A := (t * K0 + cos_phi0) / cos_eta1 in
  let B := t / cos_eta1 in
  Matrix (- A) (- B) (- (lam * (K1 * A + K0))) (- (lam * (K1 * B + 1))).

Lemma bounce_det K0 K1 t cos_phi0 cos_eta1 lam :
  cos_eta1 <> 0 -> det (bounce K0 K1 t cos_phi0 cos_eta1 lam) = lam * cos_phi0 / cos_eta1.
Proof. intros nonzero. unfold det, bounce; simpl. field. exact nonzero. Qed.

(** Writes the derivative that a hypothesis knows in the place of [Derive]. *)
Ltac known found :=
  match type of found with
  | is_derive ?f ?x ?l => replace (Derive (fun y : R => f y) x) with l by (symmetry; exact (is_derive_unique _ _ _ found))
  end.

Section Flight.

Variables X0 Y0 psi0 X1 Y1 psi1 : R -> R.  (* the two components that the flight joins *)
Variables s0 phi s1 : R -> R.  (* a curve of starting points, and where they land *)
Variables u K0 K1 t lam ds0 dphi ds1 : R.

Definition direction (v : R) : R := psi0 (s0 v) + PI / 2 - phi v.
Definition eta (v : R) : R := psi1 (s1 v) - direction v - PI / 2.

(** The flight equation: the chord is parallel to the direction. *)
Definition flight_equation (v : R) : R :=
  (X1 (s1 v) - X0 (s0 v)) * sin (direction v) - (Y1 (s1 v) - Y0 (s0 v)) * cos (direction v).

Hypothesis frenet_X0 : is_derive X0 (s0 u) (cos (psi0 (s0 u))).
Hypothesis frenet_Y0 : is_derive Y0 (s0 u) (sin (psi0 (s0 u))).
Hypothesis frenet_psi0 : is_derive psi0 (s0 u) (- K0).
Hypothesis frenet_X1 : is_derive X1 (s1 u) (cos (psi1 (s1 u))).
Hypothesis frenet_Y1 : is_derive Y1 (s1 u) (sin (psi1 (s1 u))).
Hypothesis frenet_psi1 : is_derive psi1 (s1 u) (- K1).
Hypothesis start_moves : is_derive s0 u ds0.
Hypothesis angle_moves : is_derive phi u dphi.
Hypothesis landing_moves : is_derive s1 u ds1.
Hypothesis flies : locally u (fun v => flight_equation v = 0).
Hypothesis lands_X : X1 (s1 u) = X0 (s0 u) + t * cos (direction u).
Hypothesis lands_Y : Y1 (s1 u) = Y0 (s0 u) + t * sin (direction u).
Hypothesis not_grazing : cos (eta u) <> 0.

Lemma direction_moves : is_derive direction u (- K0 * ds0 - dphi).
Proof.
  unfold direction.
  auto_derive.
  - repeat split; eexists; eauto.
  - known frenet_psi0. known start_moves. known angle_moves. ring.
Qed.

Lemma eta_moves : is_derive eta u (- K1 * ds1 + K0 * ds0 + dphi).
Proof.
  unfold eta.
  pose proof direction_moves as moved.
  auto_derive.
  - repeat split; eexists; eauto.
  - known frenet_psi1. known landing_moves. known moved. ring.
Qed.

Lemma landing_equation : cos (eta u) * ds1 = - (t * (K0 * ds0 + dphi) + cos (phi u) * ds0).
Proof.
  pose proof direction_moves as moved.
  assert (slope : is_derive flight_equation u
    ((cos (psi1 (s1 u)) * ds1 - cos (psi0 (s0 u)) * ds0) * sin (direction u)
     + (X1 (s1 u) - X0 (s0 u)) * (cos (direction u) * (- K0 * ds0 - dphi))
     - (sin (psi1 (s1 u)) * ds1 - sin (psi0 (s0 u)) * ds0) * cos (direction u)
     + (Y1 (s1 u) - Y0 (s0 u)) * (sin (direction u) * (- K0 * ds0 - dphi)))).
  { unfold flight_equation.
    auto_derive.
    - repeat split; eexists; eauto.
    - known frenet_X0. known frenet_Y0. known frenet_X1. known frenet_Y1.
      known start_moves. known landing_moves. known moved. ring. }
  assert (still : is_derive flight_equation u 0).
  { apply (is_derive_ext_loc (fun _ => 0)).
    - revert flies. apply filter_imp. intros v zero. now symmetry.
    - auto_derive; trivial. }
  assert (sum := eq_trans (eq_sym (is_derive_unique _ _ _ slope)) (is_derive_unique _ _ _ still)).
  replace (X1 (s1 u) - X0 (s0 u)) with (t * cos (direction u)) in sum by lra.
  replace (Y1 (s1 u) - Y0 (s0 u)) with (t * sin (direction u)) in sum by lra.
  assert (circle := sin2_cos2 (direction u)). unfold Rsqr in circle.
  assert (leaving : cos (phi u) = cos (psi0 (s0 u)) * sin (direction u) - sin (psi0 (s0 u)) * cos (direction u)).
  { replace (phi u) with (PI / 2 - (direction u - psi0 (s0 u))) by (unfold direction; lra).
    rewrite cos_shift, sin_minus. ring. }
  assert (arriving : cos (eta u) = sin (psi1 (s1 u)) * cos (direction u) - cos (psi1 (s1 u)) * sin (direction u)).
  { unfold eta. replace (psi1 (s1 u) - direction u - PI / 2) with (- (PI / 2 - (psi1 (s1 u) - direction u))) by lra.
    rewrite cos_neg, cos_shift, sin_minus. ring. }
  rewrite leaving, arriving.
  replace (t * (K0 * ds0 + dphi)) with
    (t * (K0 * ds0 + dphi) * (sin (direction u) * sin (direction u) + cos (direction u) * cos (direction u)))
    by (rewrite circle; ring).
  lra.
Qed.

(** The paper's matrix is the derivative: it takes the motion of the start to the motion of the landing. *)
Theorem derivative_matrix :
  let m := bounce K0 K1 t (cos (phi u)) (cos (eta u)) lam in
  ds1 = a11 m * ds0 + a12 m * dphi
  /\ is_derive (fun v => - lam * eta v) u (a21 m * ds0 + a22 m * dphi).
Proof.
  pose proof landing_equation as landing.
  pose proof eta_moves as turned.
  assert (ds1_is : ds1 = - (t * (K0 * ds0 + dphi) + cos (phi u) * ds0) / cos (eta u)).
  { rewrite <- landing. field. exact not_grazing. }
  split.
  - rewrite ds1_is. unfold bounce; simpl. field. exact not_grazing.
  - replace (a21 (bounce K0 K1 t (cos (phi u)) (cos (eta u)) lam) * ds0
             + a22 (bounce K0 K1 t (cos (phi u)) (cos (eta u)) lam) * dphi)
      with (- lam * (- K1 * ds1 + K0 * ds0 + dphi)).
    + apply (is_derive_scal eta u (- lam)). exact turned.
    + rewrite ds1_is. unfold bounce; simpl. field. exact not_grazing.
Qed.

End Flight.
