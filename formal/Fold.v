(** The egg's equilateral triangles: cycles of period 3 that a third of a turn maps to themselves exist from the fold on,
    and not before. Paper: section 6.4. *)

From Coq Require Import Reals Lra Psatz.
From Coquelicot Require Import Coquelicot.
From Interval Require Import Tactic.
From Pinball Require Import Generated.
Open Scope R_scope.

Section Tilt.

Variable alpha : R.
Hypothesis range : 0 < alpha <= 1 / 10.

Let under : 0 < 1 - alpha ^ 2. Proof. nra. Qed.
Let root_pos : 0 < sqrt (1 - alpha ^ 2). Proof. apply sqrt_lt_R0, under. Qed.
Let root_squared : sqrt (1 - alpha ^ 2) ^ 2 = 1 - alpha ^ 2. Proof. apply pow2_sqrt. generalize under. lra. Qed.
Let radius_pos x : 0 < alpha * cos x + 1.
Proof. generalize (COS_bound x). nra. Qed.

Theorem largest_tilt_bounds theta : tilt_tangent alpha theta <= largest_tilt alpha.
Proof.
  unfold tilt_tangent, largest_tilt.
  assert (circle := sin2_cos2 (3 * theta)). unfold Rsqr in circle.
  assert (rho := radius_pos (3 * theta)).
  set (c := cos (3 * theta)) in *. set (s := sin (3 * theta)) in *. set (q := sqrt (1 - alpha ^ 2)) in *.
  apply Rmult_le_reg_r with ((alpha * c + 1) * q); [apply Rmult_lt_0_compat; assumption |].
  replace (3 * alpha * s / (alpha * c + 1) * ((alpha * c + 1) * q)) with (3 * alpha * (s * q)) by (field; lra).
  replace (3 * alpha / q * ((alpha * c + 1) * q)) with (3 * alpha * (alpha * c + 1)) by (field; lra).
  apply Rmult_le_compat_l; [lra |].
  apply Rsqr_incr_0_var; [unfold Rsqr | lra].
  replace (s * q * (s * q)) with (s * s * q ^ 2) by ring. rewrite root_squared.
  replace (s * s) with (1 - c * c) by lra.
  assert (0 <= (c + alpha) ^ 2) by apply pow2_ge_0. lra.
Qed.

(** * The triangle's angles *)

Definition delta (theta : R) : R := atan (tilt_tangent alpha theta).
Definition rho (theta : R) : R := alpha * cos (3 * theta) + 1.
Definition tangent_direction (theta : R) : R := theta + PI / 2 + delta theta.

(** [delta] is the angle from the radius to the outward normal. *)
Theorem tangent_direction_is theta :
  exists speed, 0 < speed
    /\ is_derive (egg_x alpha) theta (speed * cos (tangent_direction theta))
    /\ is_derive (egg_y alpha) theta (speed * sin (tangent_direction theta)).
Proof.
  set (T := tilt_tangent alpha theta).
  assert (root : 0 < sqrt (1 + T²)) by (apply sqrt_lt_R0; assert (0 <= T²) by apply Rle_0_sqr; lra).
  assert (rho_pos := radius_pos (3 * theta)). fold (rho theta) in rho_pos.
  assert (tilted : rho theta * T = 3 * alpha * sin (3 * theta)) by (unfold T, tilt_tangent, rho in *; field; lra).
  exists (rho theta * sqrt (1 + T²)). split; [apply Rmult_lt_0_compat; assumption |].
  unfold tangent_direction, delta. fold T.
  replace (theta + PI / 2 + atan T) with (PI / 2 + (theta + atan T)) by ring.
  rewrite <- cos_sin. replace (cos (PI / 2 + (theta + atan T))) with (- sin (theta + atan T)) by (rewrite sin_cos; ring).
  rewrite sin_plus, cos_plus, cos_atan, sin_atan. split.
  - replace (rho theta * sqrt (1 + T²) * - (sin theta * (1 / sqrt (1 + T²)) + cos theta * (T / sqrt (1 + T²))))
      with (- (rho theta * T) * cos theta - rho theta * sin theta) by (field; lra).
    rewrite tilted. unfold egg_x, rho. auto_derive; trivial. ring.
  - replace (rho theta * sqrt (1 + T²) * (cos theta * (1 / sqrt (1 + T²)) - sin theta * (T / sqrt (1 + T²))))
      with (- (rho theta * T) * sin theta + rho theta * cos theta) by (field; lra).
    rewrite tilted. unfold egg_y, rho. auto_derive; trivial. ring.
Qed.

Let third (theta : R) : R := theta + 2 * PI / 3.

Lemma symmetric theta : rho (third theta) = rho theta /\ delta (third theta) = delta theta.
Proof.
  unfold rho, delta, tilt_tangent, third.
  replace (3 * (theta + 2 * PI / 3)) with (3 * theta + 2 * PI) by field.
  rewrite cos_plus, sin_plus, cos_2PI, sin_2PI. split; [| f_equal]; [ring |].
  replace (sin (3 * theta) * 1 + cos (3 * theta) * 0) with (sin (3 * theta)) by ring.
  replace (cos (3 * theta) * 1 - sin (3 * theta) * 0) with (cos (3 * theta)) by ring. reflexivity.
Qed.

(** The chord to the next corner leaves at [PI/6 + delta] and lands at [delta - PI/6] (as in [Bounce]). *)
Theorem triangle_angles theta :
  let t := 2 * rho theta * cos (PI / 6) in
  let phi := PI / 6 + delta theta in
  let eta := delta theta - PI / 6 in
  egg_x alpha (third theta) - egg_x alpha theta = t * cos (tangent_direction theta + PI / 2 - phi)
  /\ egg_y alpha (third theta) - egg_y alpha theta = t * sin (tangent_direction theta + PI / 2 - phi)
  /\ tangent_direction theta + PI / 2 - phi = tangent_direction (third theta) - PI / 2 - eta.
Proof.
  intros t phi eta. destruct (symmetric theta) as [same tilt]. unfold tangent_direction. rewrite tilt.
  unfold egg_x, egg_y. fold (rho (third theta)) (rho theta). rewrite same. unfold t, phi, eta, third.
  replace (theta + PI / 2 + delta theta + PI / 2 - (PI / 6 + delta theta)) with ((theta + PI / 3) + PI / 2) by field.
  replace (theta + 2 * PI / 3) with ((theta + PI / 3) + PI / 3) by field.
  set (m := theta + PI / 3).
  assert (back : theta = m - PI / 3) by (unfold m; ring).
  assert (x0 : cos theta = cos m * (1 / 2) + sin m * (sqrt 3 / 2)).
  { rewrite back at 1. rewrite cos_minus, cos_PI3, sin_PI3. reflexivity. }
  assert (y0 : sin theta = sin m * (1 / 2) - cos m * (sqrt 3 / 2)).
  { rewrite back at 1. rewrite sin_minus, cos_PI3, sin_PI3. reflexivity. }
  rewrite x0, y0, !cos_plus, !sin_plus, cos_PI2, sin_PI2, cos_PI6, sin_PI3, cos_PI3.
  split; [field | split; [field | lra]].
Qed.

(** * The tilt *)

Lemma tilt_continuous : continuity (tilt_tangent alpha).
Proof.
  intros x. apply continuity_pt_filterlim. apply (@ex_derive_continuous R_AbsRing R_NormedModule).
  unfold tilt_tangent. auto_derive. apply Rgt_not_eq, radius_pos.
Qed.

(** Every tilt up to the largest is reached. *)
Theorem every_tilt_is_reached T : 0 <= T <= largest_tilt alpha -> exists theta, tilt_tangent alpha theta = T.
Proof.
  intros [low high].
  set (top := acos (- alpha) / 3).
  assert (at_top : tilt_tangent alpha top = largest_tilt alpha).
  { unfold tilt_tangent, largest_tilt, top. replace (3 * (acos (- alpha) / 3)) with (acos (- alpha)) by field.
    rewrite cos_acos, sin_acos by lra. unfold Rsqr.
    replace (1 - - alpha * - alpha) with (1 - alpha ^ 2) by ring.
    replace (alpha * - alpha + 1) with (sqrt (1 - alpha ^ 2) ^ 2) by (rewrite root_squared; ring).
    field. apply Rgt_not_eq, root_pos. }
  assert (at_0 : tilt_tangent alpha 0 = 0).
  { unfold tilt_tangent. rewrite Rmult_0_r, sin_0. unfold Rdiv. ring. }
  destruct (IVT_gen (tilt_tangent alpha) 0 top T tilt_continuous) as [theta [_ found]].
  - rewrite at_0, at_top. rewrite Rmin_left, Rmax_right by lra. lra.
  - exists theta. exact found.
Qed.

Lemma tilt_from_the_fold lam :
  0 <= lam <= 1 ->
  ((exists theta, tilt_tangent alpha theta = tan (required_tilt lam)) <-> saddle_node alpha <= lam).
Proof.
  intros lam_range. assert (pi := PI_RGT_0).
  set (d := atan (largest_tilt alpha)).
  assert (largest_pos : 0 < largest_tilt alpha) by (unfold largest_tilt; apply Rdiv_lt_0_compat; [lra | exact root_pos]).
  assert (d_pos : 0 < d) by (unfold d; rewrite <- atan_0; apply atan_increasing; exact largest_pos).
  assert (required : required_tilt lam * (1 + lam) = PI / 6 * (1 - lam)) by (unfold required_tilt; field; lra).
  assert (tilt_range : 0 <= required_tilt lam <= PI / 6) by (set (x := required_tilt lam) in *; clearbody x; split; nra).
  assert (fold_is : saddle_node alpha * (PI / 6 + d) = PI / 6 - d).
  { unfold saddle_node. change (3 * alpha / sqrt (1 - alpha ^ 2)) with (largest_tilt alpha). fold d.
    clear - d_pos pi. field. lra. }
  assert (compare : required_tilt lam <= d <-> saddle_node alpha <= lam).
  { set (x := required_tilt lam) in *. set (n := saddle_node alpha) in *. clearbody x n d.
    assert (same : (lam - n) * (PI / 6 + d) = (1 + lam) * (d - x)).
    { replace ((lam - n) * (PI / 6 + d)) with (lam * (PI / 6 + d) - n * (PI / 6 + d)) by ring. rewrite fold_is.
      replace ((1 + lam) * (d - x)) with ((1 + lam) * d - x * (1 + lam)) by ring. rewrite required. ring. }
    split; intros less.
    - destruct (Rle_lt_dec n lam) as [done | no]; [exact done | exfalso].
      assert (0 <= (1 + lam) * (d - x)) by (apply Rmult_le_pos; lra).
      assert (0 < (n - lam) * (PI / 6 + d)) by (apply Rmult_lt_0_compat; lra). lra.
    - destruct (Rle_lt_dec x d) as [done | no]; [exact done | exfalso].
      assert (0 <= (lam - n) * (PI / 6 + d)) by (apply Rmult_le_pos; lra).
      assert (0 < (1 + lam) * (x - d)) by (apply Rmult_lt_0_compat; lra). lra. }
  rewrite <- compare. split.
  - intros [theta equal]. destruct (Rle_lt_dec (required_tilt lam) d) as [done | above]; [exact done | exfalso].
    assert (tan d < tan (required_tilt lam)) by (apply tan_increasing; lra).
    unfold d in H. rewrite tan_atan in H. assert (bound := largest_tilt_bounds theta). lra.
  - intros less. apply every_tilt_is_reached. split.
    + destruct (proj1 tilt_range) as [positive | <-]; [left; apply tan_gt_0; lra | rewrite tan_0; lra].
    + replace (largest_tilt alpha) with (tan d) by (unfold d; apply tan_atan).
      assert (d < PI / 2) by apply atan_bound.
      destruct less as [less | ->]; [left; apply tan_increasing; lra | right; reflexivity].
Qed.

(** The fold: a triangle whose angles obey the law [phi = -lam*eta] exists for [lam >= saddle_node alpha], and for no
    smaller [lam]. *)
Theorem triangles_exist_from_the_fold lam :
  0 <= lam <= 1 ->
  ((exists theta, PI / 6 + delta theta = - lam * (delta theta - PI / 6)) <-> saddle_node alpha <= lam).
Proof.
  intros lam_range. rewrite <- (tilt_from_the_fold lam lam_range). assert (pi := PI_RGT_0).
  assert (odd : forall theta, tilt_tangent alpha (- theta) = - tilt_tangent alpha theta).
  { intros theta. unfold tilt_tangent. replace (3 * - theta) with (- (3 * theta)) by ring.
    rewrite cos_neg, sin_neg. unfold Rdiv. ring. }
  assert (required : required_tilt lam * (1 + lam) = PI / 6 * (1 - lam)) by (unfold required_tilt; field; lra).
  assert (tilt_range : 0 <= required_tilt lam <= PI / 6) by (set (x := required_tilt lam) in *; clearbody x; split; nra).
  split; intros [theta found]; exists (- theta).
  - rewrite odd. assert (is : delta theta = - required_tilt lam).
    { apply Rmult_eq_reg_r with (1 + lam); [| lra].
      replace (- required_tilt lam * (1 + lam)) with (- (required_tilt lam * (1 + lam))) by ring. rewrite required. lra. }
    unfold delta in is. replace (required_tilt lam) with (- atan (tilt_tangent alpha theta)) by lra.
    rewrite tan_neg, tan_atan. reflexivity.
  - unfold delta. rewrite odd, found, atan_opp, atan_tan by lra.
    replace (PI / 6 + - required_tilt lam - - lam * (- required_tilt lam - PI / 6)) with 0 by lra.
    lra.
Qed.

End Tilt.

(** At the paper's [alpha = 0.08] the fold lies at 0.378; the paper reads 0.39 off its plots. *)
Theorem fold_enclosed : 0.378121252590090235 < saddle_node (2 / 25) < 0.378121252590090236.
Proof. unfold saddle_node. split; interval with (i_prec 90). Qed.
