(** The multipliers of the egg's equilateral triangles: 1 exactly at the fold, above 1 on the vertices' side of it. Sections 6.1
    and 6.4. *)

From Coq Require Import Reals Lra Psatz.
From Coquelicot Require Import Coquelicot.
From Pinball Require Import Bounce Generated Fold Cascade.
Open Scope R_scope.

(** One bounce of a triangle. By the symmetry the other two are the same, so the cycle's matrix is the cube. *)
Definition third_of_a_triangle (alpha theta lam : R) : matrix :=
  let K := egg_curvature alpha theta in
  bounce K K (2 * rho alpha theta * cos (PI / 6)) (cos (PI / 6 + delta alpha theta)) (cos (delta alpha theta - PI / 6)) lam.

Section Shape.

Variable alpha : R.
Hypothesis range : 0 < alpha <= 1 / 10.

Lemma rho_pos theta : 0 < rho alpha theta.
Proof. unfold rho. generalize (COS_bound (3 * theta)). nra. Qed.

Lemma squared_speed theta : X1 alpha theta ^ 2 + Y1 alpha theta ^ 2 = rho alpha theta ^ 2 + (3 * alpha * sin (3 * theta)) ^ 2.
Proof.
  unfold X1, Y1, rho. assert (one := sin2_cos2 theta). unfold Rsqr in one. apply Rminus_diag_uniq.
  transitivity (((alpha * cos (3 * theta) + 1) ^ 2 + (3 * alpha * sin (3 * theta)) ^ 2) * ((sin theta * sin theta + cos theta * cos theta) - 1));
    [ring | rewrite one; ring].
Qed.

Lemma speed_is theta : 0 < speed alpha theta /\ speed alpha theta ^ 2 = rho alpha theta ^ 2 + (3 * alpha * sin (3 * theta)) ^ 2.
Proof.
  assert (pos : 0 < rho alpha theta ^ 2 + (3 * alpha * sin (3 * theta)) ^ 2).
  { assert (0 < rho alpha theta ^ 2) by apply (pow_lt _ 2 (rho_pos theta)). assert (0 <= (3 * alpha * sin (3 * theta)) ^ 2) by apply pow2_ge_0. lra. }
  unfold speed. rewrite squared_speed. split; [apply sqrt_lt_R0; exact pos | apply pow2_sqrt; lra].
Qed.

Lemma curvature_is theta :
  egg_curvature alpha theta
  = - (rho alpha theta ^ 2 + 2 * (3 * alpha * sin (3 * theta)) ^ 2 + 9 * alpha * cos (3 * theta) * rho alpha theta) / speed alpha theta ^ 3.
Proof.
  unfold egg_curvature. f_equal. f_equal. unfold X1, Y1, X2, Y2, rho. assert (one := sin2_cos2 theta). unfold Rsqr in one.
  apply Rminus_diag_uniq.
  transitivity (((alpha * cos (3 * theta) + 1) ^ 2 + 2 * (3 * alpha * sin (3 * theta)) ^ 2 + 9 * alpha * cos (3 * theta) * (alpha * cos (3 * theta) + 1))
    * ((sin theta * sin theta + cos theta * cos theta) - 1)); [ring | rewrite one; ring].
Qed.

(** A third of a turn changes neither the curvature nor the angles. *)
Theorem thirds_are_alike theta lam : third_of_a_triangle alpha (theta + 2 * PI / 3) lam = third_of_a_triangle alpha theta lam.
Proof.
  assert (cosines : cos (3 * (theta + 2 * PI / 3)) = cos (3 * theta)).
  { replace (3 * (theta + 2 * PI / 3)) with (3 * theta + 2 * PI) by field. rewrite cos_plus, cos_2PI, sin_2PI. ring. }
  assert (sines : sin (3 * (theta + 2 * PI / 3)) = sin (3 * theta)).
  { replace (3 * (theta + 2 * PI / 3)) with (3 * theta + 2 * PI) by field. rewrite sin_plus, cos_2PI, sin_2PI. ring. }
  unfold third_of_a_triangle. rewrite !curvature_is. unfold speed. rewrite !squared_speed.
  unfold rho, delta, tilt_tangent. rewrite cosines, sines. reflexivity.
Qed.

(** The characteristic polynomial at 1 has the sign of [- (cos (3*theta) + alpha)]. *)
Theorem multiplier_1_at_the_fold theta lam :
  0 <= lam -> Rabs (delta alpha theta - PI / 6) < PI / 2 ->
  exists k, 0 < k /\ characteristic (third_of_a_triangle alpha theta lam) 1 = - k * (cos (3 * theta) + alpha).
Proof.
  intros lam_nonneg eta_range. assert (pi := PI_RGT_0).
  assert (eta_pos : 0 < cos (delta alpha theta - PI / 6)) by (apply Rabs_def2 in eta_range; apply cos_gt_0; lra).
  assert (r_pos := rho_pos theta). destruct (speed_is theta) as [v_pos v2].
  assert (sixth : 0 < cos (PI / 6)) by (apply cos_gt_0; lra).
  assert (cos_delta : cos (delta alpha theta) = rho alpha theta / speed alpha theta).
  { unfold delta. rewrite cos_atan. set (T := tilt_tangent alpha theta).
    assert (root : sqrt (1 + T²) = speed alpha theta / rho alpha theta).
    { replace (1 + T²) with ((speed alpha theta / rho alpha theta) ^ 2).
      - apply sqrt_pow2. left. apply Rdiv_lt_0_compat; assumption.
      - replace ((speed alpha theta / rho alpha theta) ^ 2) with (speed alpha theta ^ 2 / rho alpha theta ^ 2) by (field; lra).
        rewrite v2. unfold T, tilt_tangent, Rsqr. fold (rho alpha theta). field. lra. }
    rewrite root. field. lra. }
  assert (angles : cos (PI / 6 + delta alpha theta) + cos (delta alpha theta - PI / 6) = 2 * cos (PI / 6) * cos (delta alpha theta))
    by (rewrite cos_plus, cos_minus; ring).
  exists ((1 + lam) * (2 * cos (PI / 6)) * (9 * alpha * rho alpha theta) / (speed alpha theta ^ 3 * cos (delta alpha theta - PI / 6))).
  assert (cube : 0 < speed alpha theta ^ 3) by (apply pow_lt, v_pos). split.
  - apply Rdiv_lt_0_compat; [| apply Rmult_lt_0_compat; assumption].
    repeat apply Rmult_lt_0_compat; lra.
  - set (K := egg_curvature alpha theta).
    transitivity ((1 + lam) * (2 * cos (PI / 6)) * (cos (delta alpha theta) + rho alpha theta * K) / cos (delta alpha theta - PI / 6)).
    + replace ((1 + lam) * (2 * cos (PI / 6)) * (cos (delta alpha theta) + rho alpha theta * K))
        with ((1 + lam) * ((cos (PI / 6 + delta alpha theta) + cos (delta alpha theta - PI / 6)) + 2 * rho alpha theta * cos (PI / 6) * K))
        by (rewrite angles; ring).
      unfold characteristic, trace, det, third_of_a_triangle, bounce; cbn [a11 a12 a21 a22]. fold K. field. lra.
    + unfold K. rewrite cos_delta, curvature_is.
      replace (rho alpha theta / speed alpha theta) with (rho alpha theta * speed alpha theta ^ 2 / speed alpha theta ^ 3) by (field; lra).
      rewrite v2. assert (one := sin2_cos2 (3 * theta)). unfold Rsqr in one.
      assert (inner : rho alpha theta * (rho alpha theta ^ 2 + (3 * alpha * sin (3 * theta)) ^ 2)
        - rho alpha theta * (rho alpha theta ^ 2 + 2 * (3 * alpha * sin (3 * theta)) ^ 2 + 9 * alpha * cos (3 * theta) * rho alpha theta)
        = - (9 * alpha * rho alpha theta) * (cos (3 * theta) + alpha)).
      { unfold rho at 5. apply Rminus_diag_uniq.
        transitivity (9 * alpha ^ 2 * rho alpha theta * (1 - (sin (3 * theta) * sin (3 * theta) + cos (3 * theta) * cos (3 * theta))));
          [unfold rho; ring | rewrite one; ring]. }
      set (v3 := speed alpha theta ^ 3) in *. set (e := cos (delta alpha theta - PI / 6)) in *.
      transitivity ((1 + lam) * (2 * cos (PI / 6)) * ((rho alpha theta * (rho alpha theta ^ 2 + (3 * alpha * sin (3 * theta)) ^ 2)
        - rho alpha theta * (rho alpha theta ^ 2 + 2 * (3 * alpha * sin (3 * theta)) ^ 2 + 9 * alpha * cos (3 * theta) * rho alpha theta)) / v3) / e);
        [field; lra | rewrite inner; field; lra].
Qed.

End Shape.

(** At [lam = 1]: the triangle of the flat points has its multipliers on the unit circle, that of the vertices one above 1; at
    [alpha = 0], in the printed range, both are parabolic, and every equilateral triangle is an orbit. *)
Theorem elastic_triangles alpha :
  0 <= alpha <= 1 / 10 ->
  let third K r := bounce K K (2 * r * cos (PI / 6)) (cos (PI / 6)) (cos (PI / 6)) 1 in
  let flat := third (printed_egg_curvature_min alpha) (1 - alpha) in
  let vertex := third (printed_egg_curvature_max alpha) (1 + alpha) in
  det flat = 1 /\ discriminant flat <= 0
  /\ (0 < alpha -> characteristic vertex 1 < 0) /\ (alpha = 0 -> characteristic vertex 1 = 0).
Proof.
  intros range third flat vertex. assert (pi := PI_RGT_0). assert (pos : 0 < cos (PI / 6)) by (apply cos_gt_0; lra).
  assert (det_is : det flat = 1) by (unfold flat, third, det, bounce; cbn [a11 a12 a21 a22]; field; lra).
  set (p := (1 - 10 * alpha) / (1 - alpha)). set (q := (1 + 10 * alpha) / (1 + alpha)).
  assert (p_is : p * (1 - alpha) = 1 - 10 * alpha) by (unfold p; field; lra).
  assert (q_is : q * (1 + alpha) = 1 + 10 * alpha) by (unfold q; field; lra).
  split; [exact det_is | split; [| split]].
  - unfold discriminant. rewrite det_is.
    replace (trace flat) with (4 * p - 2)
      by (unfold p, flat, third, trace, bounce, printed_egg_curvature_min; cbn [a11 a22]; field; lra).
    assert (0 <= p <= 1) by (split; nra). nra.
  - intros positive.
    replace (characteristic vertex 1) with (4 * (1 - q))
      by (unfold q, vertex, third, characteristic, trace, det, bounce, printed_egg_curvature_max; cbn [a11 a12 a21 a22]; field; lra).
    nra.
  - intros ->.
    replace (characteristic vertex 1) with (4 * (1 - q))
      by (unfold q, vertex, third, characteristic, trace, det, bounce, printed_egg_curvature_max; cbn [a11 a12 a21 a22]; field; lra).
    unfold q. field.
Qed.
