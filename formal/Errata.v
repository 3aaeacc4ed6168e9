(** Where the paper's print differs from what follows from its own definitions, each with a witness in its range. *)

From Coq Require Import Reals Lra Psatz.
From Pinball Require Import Bounce Generated Algebra.
Open Scope R_scope.

(** Entry (2, 2) of the egg's matrix has one factor [lam] too many; the other three are right. *)
Theorem egg_monodromy_has_a_factor_too_many alpha lam :
  alpha ^ 2 < 1 ->
  let printed := printed_egg_monodromy alpha lam in
  let m := egg_diameter_flights alpha lam in
  a11 printed = a11 m /\ a12 printed = a12 m /\ a21 printed = a21 m /\ a22 printed = lam * a22 m.
Proof.
  intros small. cbv zeta. destruct (egg_derived alpha lam small) as [-> _].
  assert (- 1 < alpha < 1) by (split; nra).
  unfold printed_egg_monodromy, egg_diameter_monodromy; cbn [a11 a12 a21 a22].
  replace (alpha ^ 2 - 1) with ((alpha - 1) * (alpha + 1)) by ring.
  repeat split; field; lra.
Qed.

(** Nor is the printed matrix that of another base point or other coordinates: its determinant is not [lam^2]. *)
Theorem egg_monodromy_refuted :
  exists alpha lam, 0 <= alpha <= 1 / 10 /\ 0 <= lam <= 1
    /\ det (printed_egg_monodromy alpha lam) <> det (egg_diameter_flights alpha lam)
    /\ trace (printed_egg_monodromy alpha lam) <> trace (egg_diameter_flights alpha lam).
Proof.
  exists 0, (1 / 2). destruct (egg_derived 0 (1 / 2)) as [same _]; [lra |]. rewrite same.
  unfold det, trace, printed_egg_monodromy, egg_diameter_monodromy; cbn [a11 a12 a21 a22].
  repeat split; lra.
Qed.

(** The matrix printed for [(0, 0)] in the cuspless cardioid is that of [(C, 0)], and the two differ. *)
Theorem cuspless_monodromy_refuted :
  exists lam, 0 <= lam <= 1 /\ printed_cuspless_monodromy lam <> cuspless_horizontal_flights lam.
Proof.
  exists (1 / 2). split; [lra |]. destruct (cuspless_derived (1 / 2)) as [-> [-> _]]. intros same.
  assert (a12 (cuspless_horizontal_monodromy_from_the_arc (1 / 2)) = a12 (cuspless_horizontal_monodromy (1 / 2)))
    by (rewrite same; reflexivity).
  unfold cuspless_horizontal_monodromy_from_the_arc, cuspless_horizontal_monodromy in *; cbn [a12] in *. lra.
Qed.

(** At [a = sqrt 2] the discriminant [P2] touches 0 and does not cross it: it is not positive on either side. *)
Theorem P2_does_not_cross lam :
  0 < lam <= 1 ->
  printed_ellipse_P2 (sqrt 2) lam = 0
  /\ forall a, Rabs (a ^ 2 - 2) < lam / 2 -> printed_ellipse_P2 a lam <= 0.
Proof.
  intros range. unfold printed_ellipse_P2. split.
  - replace (sqrt 2 ^ 2) with 2 by (symmetry; apply pow2_sqrt; lra). ring.
  - intros a near. apply Rabs_def2 in near. replace (a ^ 4) with ((a ^ 2) ^ 2) by ring.
    set (x := a ^ 2 - 2) in *. replace (a ^ 2) with (2 + x) by (unfold x; ring). clearbody x.
    replace (lam ^ 2 * (2 + x - 2) ^ 2 - 2 * lam * ((2 + x) ^ 2 + 4 * (2 + x) - 4) + (2 + x - 2) ^ 2)
      with (x ^ 2 * (1 - lam) ^ 2 - 16 * lam * (1 + x)) by ring.
    assert (square : x ^ 2 <= (lam / 2) ^ 2) by nra.
    assert (less : (1 - lam) ^ 2 <= 1) by nra.
    assert (0 <= x ^ 2) by apply pow2_ge_0.
    assert (x ^ 2 * (1 - lam) ^ 2 <= x ^ 2 * 1) by (apply Rmult_le_compat_l; lra).
    assert (rest : x ^ 2 * (1 - lam) ^ 2 - 16 * lam * (1 + x) <= 0) by nra.
    assert (0 <= (2 + x - 2) ^ 2 * (lam + 1) ^ 2) by (apply Rmult_le_pos; apply pow2_ge_0). nra.
Qed.

(** "[lambda_plus] is always outside" [[0, 1]]: at [a = 1] it is 1. *)
Theorem lambda_plus_is_inside_at_the_circle : printed_ellipse_lambda_plus 1 = 1.
Proof. unfold printed_ellipse_lambda_plus. replace (1 ^ 2 - 1) with 0 by ring. rewrite sqrt_0. field. Qed.

(** "[mu <> 1]" for the egg's diameter: at [alpha = 0], the circle, 1 is a multiplier, and for no other shape. *)
Theorem egg_multiplier_1_at_the_circle_alone alpha lam :
  0 <= alpha <= 1 / 10 -> 0 <= lam <= 1 ->
  (characteristic (egg_diameter_flights alpha lam) 1 = 0 <-> alpha = 0).
Proof.
  intros shape range. assert (small : alpha ^ 2 < 1) by nra.
  destruct (egg_derived alpha lam small) as [-> [trace_is det_is]].
  unfold characteristic. rewrite trace_is, det_is.
  replace (1 ^ 2 - ((1 + lam) ^ 2 * (1 - tilt alpha ^ 2) - 2 * lam) * 1 + lam ^ 2)
    with (((1 + lam) * tilt alpha) ^ 2) by ring.
  assert (tilted : tilt alpha * (1 - alpha ^ 2) = 18 * alpha) by (unfold tilt; field; lra).
  split.
  - intros zero. assert (tilt alpha = 0).
    { replace (((1 + lam) * tilt alpha) ^ 2) with (((1 + lam) * tilt alpha) * ((1 + lam) * tilt alpha)) in zero by ring.
      apply Rmult_integral in zero. destruct zero as [zero | zero]; apply Rmult_integral in zero; lra. }
    rewrite H in tilted. lra.
  - intros ->. replace (tilt 0) with 0 by (unfold tilt; field). ring.
Qed.
