(** The hypotheses of the general theorems are met: an instance of each. Those of the interval Newton theorem have theirs in
    [Doublings] and [Numbers], that of [Unstable] is [vertical_orbit_is_not_stable]. *)

From Coq Require Import Reals Lra Lia Psatz.
From Coquelicot Require Import Coquelicot.
From Pinball Require Import Bounce Cone Cardioid Stretch Cycles Map.
Open Scope R_scope.

(** [Bounce.derivative_matrix]: in the unit circle a ray from [s = 0] lands at [PI - 2*phi], so the landing moves by -2. *)
Theorem derivative_matrix_in_the_circle phi lam :
  Rabs phi < PI / 2 -> a12 (bounce (- 1) (- 1) (2 * cos phi) (cos phi) (cos phi) lam) = - 2.
Proof.
  intros range. apply Rabs_def2 in range. assert (pos : 0 < cos phi) by (apply cos_gt_0; lra).
  assert (land : forall v, cos (PI - 2 * v) = 1 + 2 * cos v * cos (PI - v) /\ sin (PI - 2 * v) = 2 * cos v * sin (PI - v)).
  { intros v. rewrite !cos_minus, !sin_minus, cos_PI, sin_PI, cos_2a_cos, sin_2a. split; ring. }
  assert (eta_is : forall v, PI - 2 * v + PI / 2 - (0 + PI / 2 + PI / 2 - v) - PI / 2 = - v) by (intros; field).
  assert (towards : forall v, 0 + PI / 2 + PI / 2 - v = PI - v) by (intros; field).
  destruct (derivative_matrix cos sin (fun s => s + PI / 2) cos sin (fun s => s + PI / 2)
    (fun _ => 0) (fun v => v) (fun v => PI - 2 * v) phi (- 1) (- 1) (2 * cos phi) lam 0 1 (- 2)) as [moved _].
  - auto_derive; trivial. rewrite cos_plus, cos_PI2, sin_PI2. ring.
  - auto_derive; trivial. rewrite sin_plus, cos_PI2, sin_PI2. ring.
  - auto_derive; trivial. ring.
  - auto_derive; trivial. rewrite cos_plus, cos_PI2, sin_PI2. ring.
  - auto_derive; trivial. rewrite sin_plus, cos_PI2, sin_PI2. ring.
  - auto_derive; trivial. ring.
  - auto_derive; trivial.
  - auto_derive; trivial.
  - auto_derive; trivial. ring.
  - exists (mkposreal 1 Rlt_0_1). intros v _. unfold flight_equation, direction. rewrite towards, cos_0, sin_0.
    destruct (land v) as [-> ->]. ring.
  - unfold direction. rewrite towards, cos_0. apply (land phi).
  - unfold direction. rewrite towards, sin_0, Rplus_0_l. apply (land phi).
  - unfold eta, direction. rewrite eta_is, cos_neg. lra.
  - unfold eta, direction in moved. rewrite eta_is, cos_neg in moved. rewrite Rmult_0_r, Rplus_0_l, Rmult_1_r in moved.
    symmetry. exact moved.
Qed.

(** [Cone.cone_invariant]: along a diameter of the unit circle the condition [t >= D0 + d1] holds with equality. *)
Theorem cone_on_a_diameter lam :
  0 <= lam ->
  let m := bounce (- / 1) (- / 1) 2 1 1 lam in cone lam 1 (a11 m * 1 + a12 m * 0) (a21 m * 1 + a22 m * 0).
Proof. intros nonneg. apply (cone_invariant 1 1 2 1 1 lam 1 0); unfold cone; lra. Qed.

(** [Cycles.every_cycle_is_unstable]: the orbit between [theta = PI/3] and [theta = -PI/3]. *)
Theorem vertical_orbit_has_a_multiplier_above_1 lam :
  0 <= lam <= 1 ->
  exists mu, characteristic (derivative lam swing (fun _ => 0) (fun _ => 0) (fun _ => 3 * sqrt 3 / 2) 2) mu = 0 /\ 1 < mu.
Proof.
  intros range. assert (bounces := map_orbit_is_orbit _ _ _ _ _ _ (vertical_orbit lam 2)).
  destruct (every_cycle_is_unstable lam swing (fun _ => 0) (fun _ => 0) (fun _ => 3 * sqrt 3 / 2) 2 range bounces)
    as [slope [mu [_ [_ [_ [root [above _]]]]]]]; [lia | split; reflexivity |].
  exists mu. split; assumption.
Qed.
