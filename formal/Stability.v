(** Where the cycles of period 2 in the ellipse and in the egg have their multipliers, and the paper's sentences that fail at
    the end of their range. Sections 3.3 and 6.3. *)

From Coq Require Import Reals Lra Psatz.
From Coquelicot Require Import Coquelicot.
From Pinball Require Import Bounce Generated Algebra.
Open Scope R_scope.

(** The complex number [x + i*y] is a multiplier. *)
Definition multiplier (m : matrix) (x y : R) : Prop :=
  x ^ 2 - y ^ 2 - trace m * x + det m = 0 /\ 2 * x * y - trace m * y = 0.

Theorem inside_the_unit_circle m :
  0 < characteristic m 1 -> 0 < characteristic m (- 1) -> det m < 1 -> forall x y, multiplier m x y -> x ^ 2 + y ^ 2 < 1.
Proof.
  unfold characteristic, multiplier. intros above below small x y [real imaginary].
  destruct (Req_dec y 0) as [zero | nonzero].
  - subst y. set (other := trace m - x).
    assert (product : x * other = det m) by (unfold other; lra).
    assert (p1 : 0 < (1 - x) * (1 - other)) by (replace ((1 - x) * (1 - other)) with (1 ^ 2 - trace m * 1 + det m) by (rewrite <- product; unfold other; ring); exact above).
    assert (p2 : 0 < (1 + x) * (1 + other)) by (replace ((1 + x) * (1 + other)) with ((- 1) ^ 2 - trace m * - 1 + det m) by (rewrite <- product; unfold other; ring); exact below).
    assert (x < 1) by (destruct (Rlt_le_dec x 1); [assumption | exfalso; assert (1 < other) by nra; nra]).
    assert (- 1 < x) by (destruct (Rlt_le_dec (- 1) x); [assumption | exfalso; assert (other < - 1) by nra; nra]). nra.
  - assert (x_is : x = trace m / 2).
    { apply Rmult_eq_reg_r with y; [| exact nonzero]. lra. }
    assert (x ^ 2 + y ^ 2 = det m) by (rewrite x_is in *; lra). lra.
Qed.

(** * The ellipse's minor axis *)

(** At [a = 1], the circle, 1 is a multiplier for every contraction: no focus, no node, not elliptic. *)
Theorem minor_axis_at_the_circle lam : characteristic (minor_axis_flights 1 lam) 1 = 0.
Proof.
  destruct (minor_axis_derived 1 lam ltac:(lra)) as [-> _].
  unfold characteristic, trace, det, minor_axis_monodromy; cbn [a11 a12 a21 a22]. field.
Qed.

(** At [a = sqrt 2] the matrix is [-lam]: real multipliers above [lambda_minus = 0] too. *)
Theorem minor_axis_at_root_2 lam : minor_axis_flights (sqrt 2) lam = Matrix (- lam) 0 0 (- lam).
Proof.
  assert (pos : 0 < sqrt 2) by (apply sqrt_lt_R0; lra). assert (two : sqrt 2 ^ 2 = 2) by (apply pow2_sqrt; lra).
  assert (four : sqrt 2 ^ 4 = 4) by (replace (sqrt 2 ^ 4) with ((sqrt 2 ^ 2) ^ 2) by ring; rewrite two; ring).
  destruct (minor_axis_derived (sqrt 2) lam ltac:(lra)) as [-> _]. unfold minor_axis_monodromy.
  rewrite two, four. f_equal; [field | field; lra | | field].
  replace (2 * lam * (sqrt 2 - 1) * (sqrt 2 + 1) * (2 - 2) * (lam + 1)) with 0 by ring. unfold Rdiv. ring.
Qed.

(** For every other ellipse and [lam < 1] all multipliers lie inside the unit circle. *)
Theorem minor_axis_stable a lam x y :
  1 < a -> 0 <= lam < 1 -> multiplier (minor_axis_flights a lam) x y -> x ^ 2 + y ^ 2 < 1.
Proof.
  intros longer range. destruct (minor_axis_derived a lam ltac:(lra)) as [-> _].
  assert (a2 : 1 < a ^ 2) by nra. assert (a4 : 0 < a ^ 4) by (apply pow_lt; lra).
  apply inside_the_unit_circle.
  - replace (characteristic (minor_axis_monodromy a lam) 1) with (4 * (a ^ 2 - 1) * (1 + lam) ^ 2 / a ^ 4)
      by (unfold characteristic, trace, det, minor_axis_monodromy; cbn [a11 a12 a21 a22]; field; lra).
    apply Rdiv_lt_0_compat; [apply Rmult_lt_0_compat; nra | exact a4].
  - replace (characteristic (minor_axis_monodromy a lam) (- 1))
      with (((1 - lam) ^ 2 * a ^ 4 + (1 + lam) ^ 2 * (a ^ 2 - 2) ^ 2) / a ^ 4)
      by (unfold characteristic, trace, det, minor_axis_monodromy; cbn [a11 a12 a21 a22]; field; lra).
    apply Rdiv_lt_0_compat; [| exact a4]. assert (0 < (1 - lam) ^ 2) by (apply pow_lt; lra).
    assert (0 < (1 - lam) ^ 2 * a ^ 4) by (apply Rmult_lt_0_compat; assumption).
    assert (0 <= (1 + lam) ^ 2 * (a ^ 2 - 2) ^ 2) by (apply Rmult_le_pos; apply pow2_ge_0). lra.
  - destruct (P1_and_P2 a lam ltac:(lra)) as [_ [-> _]]. nra.
Qed.

(** [lambda_plus] exceeds 1 for every [a > 1]; at [a = 1] it is 1 ([Errata.lambda_plus_is_inside_at_the_circle]). *)
Theorem lambda_plus_outside a : 1 < a -> a ^ 2 <> 2 -> 1 < printed_ellipse_lambda_plus a.
Proof.
  intros longer generic. set (w := sqrt (a ^ 2 - 1)).
  assert (w_pos : 0 < w) by (apply sqrt_lt_R0; nra).
  assert (w2 : a ^ 2 = w ^ 2 + 1) by (unfold w; rewrite pow2_sqrt by nra; ring).
  assert (not_1 : w - 1 <> 0) by (intros zero; apply generic; rewrite w2; replace w with 1 by lra; ring).
  unfold printed_ellipse_lambda_plus. fold w. replace (a ^ 4) with ((a ^ 2) ^ 2) by ring. rewrite w2.
  assert (square : 0 < (w - 1) ^ 2) by (apply pow2_gt_0; exact not_1).
  replace (((w ^ 2 + 1) ^ 2 + 4 * (w ^ 2 + 1) * w + 4 * (w ^ 2 + 1) - 4) / (w ^ 2 + 1 - 2) ^ 2) with (1 + 4 * w / (w - 1) ^ 2).
  - assert (0 < 4 * w / (w - 1) ^ 2) by (apply Rdiv_lt_0_compat; lra). lra.
  - field. split; [| exact not_1]. replace (w ^ 2 + 1 - 2) with ((w - 1) * (w + 1)) by ring.
    apply Rmult_integral_contrapositive_currified; [exact not_1 | lra].
Qed.

(** At [lambda_minus] the multipliers coincide and only one direction is invariant: no dominated splitting there. *)
Theorem one_direction_at_lambda_minus a :
  1 < a -> a ^ 2 <> 2 ->
  let m := minor_axis_flights a (lambda_minus a) in
  discriminant m = 0
  /\ forall mu x y x' y', a11 m * x + a12 m * y = mu * x -> a11 m * x' + a12 m * y' = mu * x' -> x * y' = x' * y.
Proof.
  intros longer generic. cbv zeta. destruct (minor_axis_derived a (lambda_minus a) ltac:(lra)) as [-> _].
  destruct (lambda_minus_printed a longer generic) as [_ range].
  assert (a2 : 0 < a ^ 2) by nra. set (lam := lambda_minus a) in *. split.
  - destruct (P1_and_P2 a lam ltac:(lra)) as [_ [_ ->]].
    set (w := sqrt (a ^ 2 - 1)).
    assert (w_pos : 0 < w) by (apply sqrt_lt_R0; nra).
    assert (w2 : a ^ 2 = w ^ 2 + 1) by (unfold w; rewrite pow2_sqrt by nra; ring).
    assert (zero : printed_ellipse_P2 a lam = 0).
    { unfold printed_ellipse_P2, lam, lambda_minus. fold w. replace (a ^ 4) with ((a ^ 2) ^ 2) by ring. rewrite w2.
      field. lra. }
    rewrite zero. unfold Rdiv. ring.
  - intros mu x y x' y' first second.
    assert (off : a12 (minor_axis_monodromy a lam) <> 0).
    { assert (not_2 : a ^ 2 - 2 <> 0) by (intros zero; apply generic; lra).
      unfold minor_axis_monodromy; cbn [a12]. unfold Rdiv.
      repeat apply Rmult_integral_contrapositive_currified; try apply Rinv_neq_0_compat; try exact not_2; lra. }
    set (p := a11 _) in *. set (q := a12 _) in *. apply Rmult_eq_reg_l with q; [| exact off].
    replace (q * (x * y')) with (x * (q * y')) by ring. replace (q * (x' * y)) with (x' * (q * y)) by ring.
    replace (q * y') with ((mu - p) * x') by lra. replace (q * y) with ((mu - p) * x) by lra. ring.
Qed.

(** At [a = 1.2] the slap map's second iterate has the slope 49/324 at the ends of the minor axis, which are one orbit. *)
Theorem slap_of_the_minor_axis : a11 (minor_axis_flights (6 / 5) 0) = 49 / 324.
Proof. destruct (minor_axis_derived (6 / 5) 0 ltac:(lra)) as [-> _]. unfold minor_axis_monodromy; cbn [a11]. field. Qed.

(** * The ellipse's major axis *)

(** Two real multipliers, [0 < mu < 1 < mu'] for [0 < lam < 1]. At [lam = 0], in the printed range, one of them is 0. *)
Theorem major_axis_multipliers a lam :
  1 < a -> 0 <= lam < 1 ->
  exists mu mu', characteristic (major_axis_flights a lam) mu = 0 /\ characteristic (major_axis_flights a lam) mu' = 0
    /\ 0 <= mu < 1 /\ 1 < mu' /\ (mu = 0 <-> lam = 0).
Proof.
  intros longer range. destruct (major_axis_unstable a lam longer ltac:(lra)) as [-> below].
  set (m := major_axis_monodromy a lam) in *.
  assert (det_is : det m = lam ^ 2) by (unfold m, det, major_axis_monodromy; cbn [a11 a12 a21 a22]; ring).
  unfold characteristic in *. rewrite det_is in *.
  assert (large : 1 + lam ^ 2 < trace m) by lra.
  set (d := sqrt (trace m ^ 2 - 4 * lam ^ 2)).
  assert (inner : 0 < trace m ^ 2 - 4 * lam ^ 2).
  { assert (0 <= (1 - lam) ^ 2) by apply pow2_ge_0. assert (2 * lam < trace m) by lra.
    replace (trace m ^ 2 - 4 * lam ^ 2) with ((trace m - 2 * lam) * (trace m + 2 * lam)) by ring.
    apply Rmult_lt_0_compat; lra. }
  assert (d_pos : 0 < d) by (apply sqrt_lt_R0; exact inner).
  assert (d2 : d ^ 2 = trace m ^ 2 - 4 * lam ^ 2) by (unfold d; apply pow2_sqrt; lra).
  assert (product : (trace m - d) / 2 * ((trace m + d) / 2) = lam ^ 2) by (transitivity ((trace m ^ 2 - d ^ 2) / 4); [field | rewrite d2; field]).
  assert (sum : (trace m - d) / 2 + (trace m + d) / 2 = trace m) by field.
  exists ((trace m - d) / 2), ((trace m + d) / 2).
  set (mu := (trace m - d) / 2) in *. set (mu' := (trace m + d) / 2) in *.
  assert (apart : mu < mu') by (unfold mu, mu'; lra).
  assert (mu'_pos : 0 < mu') by (unfold mu'; nra).
  assert (signs : (1 - mu) * (1 - mu') < 0) by nra.
  repeat split.
  - nra.
  - nra.
  - assert (0 <= mu * mu') by (rewrite product; apply pow2_ge_0). nra.
  - nra.
  - nra.
  - intros zero. rewrite zero in product. nra.
  - intros zero. rewrite zero in product. nra.
Qed.

(** * The egg's diameter *)

Lemma tilt_increases x y : 0 <= x < y -> y < 1 -> tilt x < tilt y.
Proof.
  intros less small. assert (dx : 0 < 1 - x ^ 2) by nra. assert (dy : 0 < 1 - y ^ 2) by nra.
  unfold tilt. apply Rmult_lt_reg_r with ((1 - x ^ 2) * (1 - y ^ 2)); [apply Rmult_lt_0_compat; assumption |].
  replace (18 * x / (1 - x ^ 2) * ((1 - x ^ 2) * (1 - y ^ 2))) with (18 * x * (1 - y ^ 2)) by (field; lra).
  replace (18 * y / (1 - y ^ 2) * ((1 - x ^ 2) * (1 - y ^ 2))) with (18 * y * (1 - x ^ 2)) by (field; lra).
  assert (0 < (y - x) * (1 + x * y)) by (apply Rmult_lt_0_compat; nra). nra.
Qed.

Lemma alpha_tilde_range lam : 0 <= lam <= 1 -> 0 < alpha_tilde lam < 1.
Proof.
  intros range. unfold alpha_tilde.
  assert (x_pos : 0 < sqrt (2 * lam ^ 2 + 2)) by (apply sqrt_lt_R0; nra).
  assert (x_small : sqrt (2 * lam ^ 2 + 2) <= 2) by (apply Rsqr_incr_0_var; [unfold Rsqr; rewrite sqrt_sqrt; nra | lra]).
  assert (0 <= sqrt (2 * lam ^ 2 + 81 * (lam + 1) ^ 2 + 2)) by apply sqrt_pos.
  split; [apply Rdiv_lt_0_compat; lra |].
  apply Rmult_lt_reg_r with (9 * lam + sqrt (2 * lam ^ 2 + 81 * (lam + 1) ^ 2 + 2) + 9); [lra |].
  unfold Rdiv. rewrite Rmult_assoc, Rinv_l by lra. lra.
Qed.

(** Stable between the circle and [alpha_tilde], unstable beyond it. At [alpha = 0] 1 is a multiplier, and at [lam = 1] the
    determinant is 1: both are in the printed range. *)
Theorem egg_diameter_stability alpha lam :
  0 <= alpha < 1 -> 0 <= lam <= 1 ->
  (0 < alpha < alpha_tilde lam -> lam < 1 -> forall x y, multiplier (egg_diameter_flights alpha lam) x y -> x ^ 2 + y ^ 2 < 1)
  /\ (alpha_tilde lam < alpha -> characteristic (egg_diameter_flights alpha lam) (- 1) < 0)
  /\ (alpha = 0 -> characteristic (egg_diameter_flights alpha lam) 1 = 0)
  /\ (lam = 1 -> det (egg_diameter_flights alpha lam) = 1).
Proof.
  intros shape range. assert (small : alpha ^ 2 < 1) by nra.
  destruct (egg_derived alpha lam small) as [-> [trace_is det_is]].
  destruct (alpha_tilde_range lam range) as [at_pos at_small].
  destruct (egg_derived (alpha_tilde lam) lam ltac:(nra)) as [_ [trace_at det_at]].
  destruct (alpha_tilde_is_a_period_doubling lam range) as [_ doubling].
  unfold characteristic in *. rewrite trace_at, det_at in doubling.
  assert (tilt_pos : forall x, 0 < x < 1 -> 0 < tilt x) by (intros; unfold tilt; apply Rdiv_lt_0_compat; nra).
  split; [| split; [| split]].
  - intros inner less. apply inside_the_unit_circle; unfold characteristic; rewrite ?trace_is, det_is.
    + assert (0 < tilt alpha) by (apply tilt_pos; lra). assert (0 < (1 + lam) * tilt alpha) by (apply Rmult_lt_0_compat; lra). nra.
    + assert (order : tilt alpha < tilt (alpha_tilde lam)) by (apply tilt_increases; lra).
      assert (0 < tilt alpha) by (apply tilt_pos; lra).
      assert (tilt alpha ^ 2 < tilt (alpha_tilde lam) ^ 2) by nra. assert (0 < (1 + lam) ^ 2) by (apply pow_lt; lra). nra.
    + nra.
  - intros above. rewrite trace_is, det_is.
    assert (order : tilt (alpha_tilde lam) < tilt alpha) by (apply tilt_increases; lra).
    assert (0 < tilt (alpha_tilde lam)) by (apply tilt_pos; lra).
    assert (tilt (alpha_tilde lam) ^ 2 < tilt alpha ^ 2) by nra. assert (0 < (1 + lam) ^ 2) by (apply pow_lt; lra). nra.
  - intros ->. rewrite trace_is, det_is. replace (tilt 0) with 0 by (unfold tilt; field). ring.
  - intros ->. rewrite det_is. ring.
Qed.
