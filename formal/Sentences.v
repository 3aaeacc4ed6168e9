(** Sentences of the paper that fail at the end of their range, or as printed, each with a witness; and what is true instead.
    Sections 1, 2, 6 and the appendix. *)

From Coq Require Import Reals Lra Lia Psatz.
From Coquelicot Require Import Coquelicot.
From Pinball Require Import Bounce Generated Algebra Cardioid Stretch Cycles Map Fold Cascade.
Open Scope R_scope.

(** * The egg *)

(** The egg focuses at every point for [alpha < 1/10], and has flat points at [alpha = 1/10], in the printed range. *)
Theorem egg_focuses alpha theta : 0 <= alpha < 1 / 10 -> X1 alpha theta * Y2 alpha theta - Y1 alpha theta * X2 alpha theta > 0.
Proof.
  intros range. assert (one := sin2_cos2 theta). assert (three := sin2_cos2 (3 * theta)). assert (c_range := COS_bound (3 * theta)).
  unfold Rsqr in one, three. unfold X1, Y1, X2, Y2.
  set (s := sin theta) in *. set (c := cos theta) in *. set (p := sin (3 * theta)) in *. set (q := cos (3 * theta)) in *.
  replace ((- 3 * alpha * p * c - (alpha * q + 1) * s) * (- 10 * alpha * q * s - 6 * alpha * p * c - s)
           - (- 3 * alpha * p * s + (alpha * q + 1) * c) * (- 10 * alpha * q * c + 6 * alpha * p * s - c))
    with (((alpha * q + 1) ^ 2 + 18 * alpha ^ 2 * (p * p) + 9 * alpha * q * (alpha * q + 1)) * (s * s + c * c)) by ring.
  rewrite one. replace (p * p) with (1 - q * q) by lra.
  assert (0 < (1 - alpha) * (1 - 10 * alpha)) by (apply Rmult_lt_0_compat; lra).
  assert (0 <= alpha ^ 2 * ((1 - q) * (1 + q))) by (apply Rmult_le_pos; [apply pow2_ge_0 | apply Rmult_le_pos; lra]).
  assert (0 <= alpha * (1 + q)) by (apply Rmult_le_pos; lra). nra.
Qed.

Theorem egg_has_flat_points : printed_egg_curvature_min (1 / 10) = 0.
Proof. unfold printed_egg_curvature_min. field. Qed.

(** At [alpha = 0], in the printed range, the curvature is the same everywhere, and every flight keeps its angle: at [lam = 1]
    no islands and no chaotic sea; every point is one of "maximal curvature". *)
Theorem circle_keeps_the_angle b c t phi eta : flight 0 b c t phi eta -> eta = - phi /\ egg_curvature 0 b = - 1.
Proof.
  intros [pos [range_phi [range_eta [n0 [s0 [n1 s1]]]]]].
  assert (frame : forall u, X1 0 u = - sin u /\ Y1 0 u = cos u) by (intros; unfold X1, Y1; split; ring).
  assert (unit_speed : forall u, speed 0 u = 1).
  { intros u. unfold speed. destruct (frame u) as [-> ->]. assert (one := sin2_cos2 u). unfold Rsqr in one.
    replace ((- sin u) ^ 2 + cos u ^ 2) with 1 by (rewrite <- one; ring). apply sqrt_1. }
  rewrite unit_speed, Rmult_1_r in n0, s0, n1, s1. split.
  - assert (one_b := sin2_cos2 b). assert (one_c := sin2_cos2 c). unfold Rsqr in one_b, one_c.
    assert (normals : normal 0 b c = normal 0 c b).
    { unfold normal, egg_x, egg_y. destruct (frame b) as [-> ->]. destruct (frame c) as [-> ->].
      apply Rminus_diag_uniq. transitivity ((sin b * sin b + cos b * cos b) - (sin c * sin c + cos c * cos c)); [ring | lra]. }
    assert (tangents : tangential 0 b c = - tangential 0 c b).
    { unfold tangential, egg_x, egg_y. destruct (frame b) as [-> ->]. destruct (frame c) as [-> ->]. ring. }
    apply (same_angle 0).
    + exact range_eta.
    + rewrite Rabs_Ropp. exact range_phi.
    + apply Rmult_eq_reg_l with t; [| lra]. unfold Rminus. rewrite !Rplus_0_l, Ropp_involutive, cos_neg. lra.
    + apply Rmult_eq_reg_l with t; [| lra]. unfold Rminus. rewrite !Rplus_0_l, Ropp_involutive, sin_neg. lra.
  - unfold egg_curvature. rewrite unit_speed. destruct (frame b) as [-> ->].
    assert (one_b := sin2_cos2 b). unfold Rsqr in one_b. unfold X2, Y2.
    replace (- (- sin b * (- 10 * 0 * cos (3 * b) * sin b - 6 * 0 * sin (3 * b) * cos b - sin b)
      - cos b * (- 10 * 0 * cos (3 * b) * cos b + 6 * 0 * sin (3 * b) * sin b - cos b)) / 1 ^ 3)
      with (- (sin b * sin b + cos b * cos b)) by field. rewrite one_b. reflexivity.
Qed.

(** "Three critical points": at [alpha = 0.08] the slap map's slope is negative at the flat points and positive at the
    vertices; these alternate around the egg, so there is a critical point in each of the six arcs between them. *)
Theorem slap_slope_changes_sign_six_times :
  let flat := printed_egg_curvature_min (2 / 25) in
  let vertex := printed_egg_curvature_max (2 / 25) in
  a11 (bounce flat vertex 2 1 1 0) < 0 < a11 (bounce vertex flat 2 1 1 0).
Proof. cbv zeta. unfold bounce, printed_egg_curvature_min, printed_egg_curvature_max; cbn [a11]. lra. Qed.

(** At [lam = 1] every cycle of the egg has the determinant 1, so none attracts: the doubling at [alpha_tilde 1] creates no
    "stable period-4 orbit". *)
Theorem elastic_cycles_keep_area alpha theta phi eta t n :
  is_cycle alpha 1 theta phi eta t n -> det (monodromy alpha 1 theta phi eta t n) = 1.
Proof.
  intros [step [_ back]].
  assert (cos_start : (0 < n)%nat -> 0 < cos (phi 0%nat)).
  { intros some. destruct (step 0%nat some) as [[_ [range _]] _]. apply Rabs_def2 in range. apply cos_gt_0; lra. }
  assert (running : forall k, (k <= n)%nat -> cos (phi k) * det (monodromy alpha 1 theta phi eta t k) = cos (phi 0%nat)).
  { induction k as [| k IH]; intros upto; [unfold det; simpl; ring |].
    destruct (step k) as [[_ [_ [range _]]] law]; [lia |]. specialize (IH ltac:(lia)).
    assert (eta_pos : 0 < cos (eta (S k))) by (apply Rabs_def2 in range; apply cos_gt_0; lra).
    assert (same : cos (phi (S k)) = cos (eta (S k))).
    { rewrite law. replace (- (1) * eta (S k)) with (- eta (S k)) by ring. apply cos_neg. }
    assert (product_det : forall m l, det (product m l) = det m * det l) by (intros; unfold det, product; cbn [a11 a12 a21 a22]; ring).
    cbn [monodromy]. rewrite product_det, bounce_det, same by lra. rewrite <- IH. field. lra. }
  destruct n as [| n]; [unfold det; simpl; ring |].
  assert (last := running (S n) ltac:(lia)). rewrite back in last. specialize (cos_start ltac:(lia)).
  apply Rmult_eq_reg_l with (cos (phi 0%nat)); lra.
Qed.

(** "No period-3 orbits for [lam < 0.4]", "[lambda_c] = 0.39": at [alpha = 0.08] there is one at [lam = 0.38]. *)
Theorem triangle_below_0_39 : exists theta, PI / 6 + delta (2 / 25) theta = - (0.38) * (delta (2 / 25) theta - PI / 6).
Proof.
  apply (triangles_exist_from_the_fold (2 / 25)) with (lam := 0.38); [lra | lra |]. assert (fold := fold_enclosed). lra.
Qed.

(** * The map *)

(** For [lam > 1] the rule may give an angle beyond the tangent: in the circle, after [phi = 3/2] with [lam = 3/2]. *)
Theorem whispering_gallery_refuted : exists lam phi, 1 < lam /\ Rabs phi < PI / 2 /\ PI / 2 < lam * phi.
Proof.
  exists (3 / 2), (3 / 2). assert (three := PI2_3_2). assert (four := PI_4). rewrite Rabs_right by lra. repeat split; lra.
Qed.

(** Phase space is mapped into the strip of [lam] times its height. *)
Theorem angles_are_contracted lam eta : 0 <= lam <= 1 -> Rabs eta < PI / 2 -> Rabs (- lam * eta) <= lam * (PI / 2).
Proof. intros range small. rewrite Rabs_mult, Rabs_Ropp, (Rabs_right lam) by lra. apply Rmult_le_compat_l; lra. Qed.

(** * The appendix *)

(** "[eta = acos (v . n)]", with the inward normal: the arrival has [v . n = - cos eta], so the formula gives [PI - eta]. *)
Theorem incoming_angle_refuted psi eta :
  0 <= eta < PI / 2 ->
  let d := psi - PI / 2 - eta in
  acos (cos d * cos (psi + PI / 2) + sin d * sin (psi + PI / 2)) = PI - eta /\ PI - eta <> eta.
Proof.
  intros range d. assert (pi := PI_RGT_0). split; [| lra].
  rewrite <- cos_minus. unfold d. replace (psi - PI / 2 - eta - (psi + PI / 2)) with (- (PI + eta)) by field.
  rewrite cos_neg. replace (cos (PI + eta)) with (cos (PI - eta)).
  - apply acos_cos. lra.
  - rewrite cos_minus, cos_plus, sin_PI. ring.
Qed.

(** "Trigonometric functions unavoidable": at [lam = 1/2] a square root does. *)
Theorem half_angles_by_a_root eta : Rabs eta < PI / 2 -> cos (1 / 2 * eta) = sqrt ((1 + cos eta) / 2).
Proof.
  intros range. apply Rabs_def2 in range.
  replace ((1 + cos eta) / 2) with (cos (1 / 2 * eta) ^ 2).
  - symmetry. apply sqrt_pow2. left. apply cos_gt_0; lra.
  - replace eta with (2 * (1 / 2 * eta)) at 2 by field. rewrite cos_2a_cos. field.
Qed.

(** "The logarithm of the mean rate of contraction": rates 1/2 and 2 in turn have the mean logarithm 0. *)
Theorem mean_rate_refuted : (ln (/ 2) + ln 2) / 2 <> ln ((/ 2 + 2) / 2).
Proof.
  rewrite ln_Rinv by lra. replace ((- ln 2 + ln 2) / 2) with 0 by field.
  assert (0 < ln ((/ 2 + 2) / 2)) by (rewrite <- ln_1; apply ln_increasing; lra). lra.
Qed.

Fixpoint power (m : matrix) (n : nat) : matrix := match n with O => identity | S k => product m (power m k) end.

(** "A zero exponent means a periodic attractor": in the elastic circle every orbit has [DT^n] with entries 1, -2n, 0, 1. *)
Theorem elastic_circle_shears phi n :
  Rabs phi < PI / 2 ->
  power (bounce (- 1) (- 1) (2 * cos phi) (cos phi) (cos phi) 1) n = Matrix 1 (- (2 * INR n)) 0 1.
Proof.
  intros range. apply Rabs_def2 in range. assert (pos : 0 < cos phi) by (apply cos_gt_0; lra).
  induction n as [| n IH]; [simpl; unfold identity; f_equal; ring |].
  rewrite S_INR. cbn [power]. rewrite IH.
  unfold product, bounce; cbn [a11 a12 a21 a22]. f_equal; field; lra.
Qed.

(** "The particle hits the vertical line instead": the ray [x = -1/8] meets the part of the cardioid that was cut off, at the
    smaller of two heights, and never the line [x = -1/4]; where it ends is on the arc. *)
Theorem beyond_the_dent :
  let far := - (1 / 2) + sqrt 2 / 4 in
  let near := - (1 / 2) - sqrt 2 / 4 in
  (1 + far) * far = - (1 / 8) /\ (1 + near) * near = - (1 / 8) /\ near < - (1 / 2) < far
  /\ (1 + near) ^ 2 * (1 - near ^ 2) < (1 + far) ^ 2 * (1 - far ^ 2).
Proof.
  cbv zeta. assert (root : 0 < sqrt 2) by (apply sqrt_lt_R0; lra). assert (two : sqrt 2 * sqrt 2 = 2) by (apply sqrt_sqrt; lra).
  assert (small : sqrt 2 < 3 / 2) by nra. repeat split; nra.
Qed.
