(** The paper's closed forms, derived: monodromy matrices, multipliers and thresholds. Sections 2 to 6.

    Every definition that is not made here comes from [Generated]: SymPy's derivation, or the paper's print. *)

From Coq Require Import Reals Lra Psatz.
From Coquelicot Require Import Coquelicot.
From Pinball Require Import Bounce Generated.
Open Scope R_scope.

(** Equality of two matrices entry by entry, each closed by [field]. *)
Ltac entries := unfold product, bounce; cbn [a11 a12 a21 a22]; f_equal; field; try lra.

(** * The derivative matrix *)

Theorem derivative_matrix_printed K0 K1 cos_eta1 cos_phi0 lam t :
  cos_eta1 <> 0 ->
  printed_map_derivative_matrix K0 K1 cos_eta1 cos_phi0 lam t = bounce K0 K1 t cos_phi0 cos_eta1 lam
  /\ derived_derivative_matrix K0 K1 cos_eta1 cos_phi0 lam t = bounce K0 K1 t cos_phi0 cos_eta1 lam.
Proof. intros nonzero. split; unfold printed_map_derivative_matrix, derived_derivative_matrix; entries. Qed.

(** * The ellipse's minor axis *)

Theorem minor_axis_derived a lam :
  a <> 0 ->
  minor_axis_flights a lam = minor_axis_monodromy a lam
  /\ printed_ellipse_monodromy a lam = minor_axis_monodromy a lam.
Proof.
  intros nonzero. split; unfold minor_axis_flights, minor_axis_monodromy, printed_ellipse_monodromy; entries; assumption.
Qed.

Theorem P1_and_P2 a lam :
  a <> 0 ->
  let m := minor_axis_monodromy a lam in
  trace m = printed_ellipse_P1 a lam / a ^ 4 /\ det m = lam ^ 2
  /\ discriminant m = printed_ellipse_P2 a lam / (a ^ 4) ^ 2.
Proof.
  intros nonzero. unfold discriminant, trace, det, minor_axis_monodromy, printed_ellipse_P1, printed_ellipse_P2;
    cbn [a11 a12 a21 a22].
  repeat split; field; assumption.
Qed.

(** Roots of a quadratic whose discriminant is [d^2]. *)
Lemma roots m d mu : discriminant m = d ^ 2 -> mu = (trace m + d) / 2 \/ mu = (trace m - d) / 2 -> characteristic m mu = 0.
Proof.
  intros squared cases. unfold discriminant in squared. unfold characteristic.
  replace (det m) with ((trace m ^ 2 - d ^ 2) / 4) by lra. destruct cases as [-> | ->]; field.
Qed.

Theorem ellipse_multipliers a lam :
  a <> 0 -> 0 <= printed_ellipse_P2 a lam ->
  let P1 := printed_ellipse_P1 a lam in
  let P2 := printed_ellipse_P2 a lam in
  characteristic (minor_axis_monodromy a lam) (printed_ellipse_mu_0 P1 P2 a) = 0
  /\ characteristic (minor_axis_monodromy a lam) (printed_ellipse_mu_1 P1 P2 a) = 0.
Proof.
  intros nonzero real P1 P2. destruct (P1_and_P2 a lam nonzero) as [tr [_ disc]].
  assert (squared : discriminant (minor_axis_monodromy a lam) = (sqrt P2 / a ^ 4) ^ 2).
  { rewrite disc. fold P2. replace ((sqrt P2 / a ^ 4) ^ 2) with (sqrt P2 ^ 2 / (a ^ 4) ^ 2) by (field; assumption).
    rewrite pow2_sqrt by exact real. reflexivity. }
  split; apply (roots _ _ _ squared); rewrite tr; fold P1;
    unfold printed_ellipse_mu_0, printed_ellipse_mu_1; [left | right]; field; assumption.
Qed.

Section Lambda_minus.

Variable a : R.
Hypothesis a_range : 1 < a.
Hypothesis a_generic : a ^ 2 <> 2.

Let w := sqrt (a ^ 2 - 1).

Let w_pos : 0 < w. Proof. apply sqrt_lt_R0. nra. Qed.
Let w_squared : a ^ 2 = w ^ 2 + 1. Proof. unfold w. rewrite pow2_sqrt by nra. ring. Qed.
Let w_not_1 : w - 1 <> 0.
Proof. intros zero. apply a_generic. rewrite w_squared. replace w with 1 by lra. ring. Qed.

Theorem lambda_minus_printed : printed_ellipse_lambda_minus a = lambda_minus a /\ 0 <= lambda_minus a < 1.
Proof.
  unfold printed_ellipse_lambda_minus, lambda_minus. fold w.
  replace (a ^ 4) with ((a ^ 2) ^ 2) by ring. rewrite w_squared. split.
  - assert (generic : w ^ 2 + 1 - 2 <> 0).
    { replace (w ^ 2 + 1 - 2) with ((w - 1) * (w + 1)) by ring.
      apply Rmult_integral_contrapositive_currified; [exact w_not_1 | lra]. }
    field. split; [lra | exact generic].
  - assert (0 <= (w - 1) ^ 2) by apply pow2_ge_0. assert (0 < (w + 1) ^ 2) by nra. split.
    + apply Rmult_le_pos; [assumption | left; apply Rinv_0_lt_compat; assumption].
    + apply Rmult_lt_reg_r with ((w + 1) ^ 2); [assumption |].
      replace ((w - 1) ^ 2 / (w + 1) ^ 2 * (w + 1) ^ 2) with ((w - 1) ^ 2) by (field; lra). lra.
Qed.

(** Complex multipliers above [lambda_minus], real ones up to it. *)
Theorem complex_above_lambda_minus lam :
  0 <= lam <= 1 -> (printed_ellipse_P2 a lam < 0 <-> lambda_minus a < lam).
Proof.
  intros range.
  assert (factored : printed_ellipse_P2 a lam =
    ((lam + 1) * (w ^ 2 - 1)) ^ 2 * ((w + 1) ^ 2 * (lam - lambda_minus a)) * ((w - 1) ^ 2 * lam - (w + 1) ^ 2)).
  { unfold printed_ellipse_P2, lambda_minus. fold w. replace (a ^ 4) with ((a ^ 2) ^ 2) by ring. rewrite w_squared.
    field. lra. }
  assert (last : (w - 1) ^ 2 * lam - (w + 1) ^ 2 < 0).
  { assert ((w - 1) ^ 2 * lam <= (w - 1) ^ 2 * 1) by (apply Rmult_le_compat_l; [apply pow2_ge_0 | lra]).
    assert ((w - 1) ^ 2 < (w + 1) ^ 2) by nra. lra. }
  assert (first : 0 < ((lam + 1) * (w ^ 2 - 1)) ^ 2).
  { apply pow2_gt_0. replace ((lam + 1) * (w ^ 2 - 1)) with ((lam + 1) * (w + 1) * (w - 1)) by ring.
    apply Rmult_integral_contrapositive_currified; [| exact w_not_1].
    apply Rgt_not_eq. apply Rmult_lt_0_compat; lra. }
  assert (second : 0 < (w + 1) ^ 2) by nra.
  set (p := ((lam + 1) * (w ^ 2 - 1)) ^ 2) in *. set (q := (w - 1) ^ 2 * lam - (w + 1) ^ 2) in *.
  set (r := (w + 1) ^ 2) in *. set (x := lambda_minus a) in *. clearbody p q r x.
  assert (product_pos : 0 < p * r * - q) by (apply Rmult_lt_0_compat; [apply Rmult_lt_0_compat |]; lra).
  replace (p * (r * (lam - x)) * q) with (- (p * r * - q * (lam - x))) in factored by ring.
  set (k := p * r * - q) in *. clearbody k. rewrite factored. clear - product_pos. split; intros less; nra.
Qed.

End Lambda_minus.

(** * The ellipse's major axis *)

(** The characteristic polynomial is negative at 1, so one multiplier is real and above 1, at [lam = 1] too. *)
Theorem major_axis_unstable a lam :
  1 < a -> 0 <= lam ->
  major_axis_flights a lam = major_axis_monodromy a lam
  /\ characteristic (major_axis_monodromy a lam) 1 < 0.
Proof.
  intros longer nonneg. split.
  - unfold major_axis_flights, major_axis_monodromy. entries.
  - replace (characteristic (major_axis_monodromy a lam) 1) with (- (4 * a ^ 2 * (a ^ 2 - 1) * (1 + lam) ^ 2))
      by (unfold characteristic, trace, det, major_axis_monodromy; cbn [a11 a12 a21 a22]; ring).
    assert (0 < a ^ 2 * (a ^ 2 - 1)) by (apply Rmult_lt_0_compat; nra).
    assert (0 < (1 + lam) ^ 2) by (apply pow_lt; lra). nra.
Qed.

(** * The cuspless cardioid's horizontal orbit *)

Theorem cuspless_derived lam :
  cuspless_horizontal_flights lam = cuspless_horizontal_monodromy lam
  /\ printed_cuspless_monodromy lam = cuspless_horizontal_monodromy_from_the_arc lam
  /\ product (bounce 0 (- (3 / 4)) (9 / 4) 1 1 lam) (bounce (- (3 / 4)) 0 (9 / 4) 1 1 lam)
      = cuspless_horizontal_monodromy_from_the_arc lam.
Proof.
  repeat split; unfold cuspless_horizontal_flights, cuspless_horizontal_monodromy, printed_cuspless_monodromy,
    cuspless_horizontal_monodromy_from_the_arc; entries.
Qed.

Theorem cuspless_multipliers lam :
  0 <= lam ->
  characteristic (cuspless_horizontal_monodromy lam) (printed_cuspless_mu_0 lam) = 0
  /\ characteristic (cuspless_horizontal_monodromy lam) (printed_cuspless_mu_1 lam) = 0.
Proof.
  intros nonneg.
  assert (squared : discriminant (cuspless_horizontal_monodromy lam) =
    (sqrt 11 * (lam + 1) * sqrt (11 * lam ^ 2 + 86 * lam + 11) / 16) ^ 2).
  { replace ((sqrt 11 * (lam + 1) * sqrt (11 * lam ^ 2 + 86 * lam + 11) / 16) ^ 2)
      with (sqrt 11 ^ 2 * (lam + 1) ^ 2 * sqrt (11 * lam ^ 2 + 86 * lam + 11) ^ 2 / 256) by field.
    rewrite !pow2_sqrt by nra. unfold discriminant, trace, det, cuspless_horizontal_monodromy; cbn [a11 a12 a21 a22]. field. }
  split; apply (roots _ _ _ squared); unfold printed_cuspless_mu_0, printed_cuspless_mu_1, trace,
    cuspless_horizontal_monodromy; cbn [a11 a22]; [left | right]; field.
Qed.

Lemma root11 : 3.3 < sqrt 11 < 3.4 /\ sqrt 11 * sqrt 11 = 11.
Proof.
  assert (squared := sqrt_sqrt 11 ltac:(lra)). assert (pos : 0 < sqrt 11) by (apply sqrt_lt_R0; lra).
  repeat split; try exact squared; nra.
Qed.

(** At [lambda_c] one multiplier is -1; below it both lie in (-1, 0], above it one is below -1. *)
Theorem lambda_c_is_a_period_doubling :
  printed_cuspless_lambda_c = lambda_c
  /\ characteristic (cuspless_horizontal_monodromy lambda_c) (- 1) = 0
  /\ (forall lam, 0 <= lam < lambda_c -> 0 < characteristic (cuspless_horizontal_monodromy lam) (- 1))
  /\ (forall lam, lambda_c < lam <= 1 -> characteristic (cuspless_horizontal_monodromy lam) (- 1) < 0).
Proof.
  destruct root11 as [near squared].
  assert (same : printed_cuspless_lambda_c = lambda_c).
  { unfold printed_cuspless_lambda_c, lambda_c. apply Rmult_eq_reg_r with (sqrt 11 / 4 + 1); [| lra].
    replace ((1 - sqrt 11 / 4) / (sqrt 11 / 4 + 1) * (sqrt 11 / 4 + 1)) with (1 - sqrt 11 / 4) by (field; lra). lra. }
  assert (value : forall lam, characteristic (cuspless_horizontal_monodromy lam) (- 1) =
    5 / 16 * ((lam - lambda_c) * (lam - (27 + 8 * sqrt 11) / 5))).
  { intros lam. rewrite <- same. unfold characteristic, trace, det, cuspless_horizontal_monodromy, printed_cuspless_lambda_c;
      cbn [a11 a12 a21 a22].
    replace (5 / 16 * ((lam - (27 / 5 - 8 * sqrt 11 / 5)) * (lam - (27 + 8 * sqrt 11) / 5)))
      with (5 / 16 * (lam ^ 2 - 54 / 5 * lam + (729 - 64 * (sqrt 11 * sqrt 11)) / 25)) by field.
    rewrite squared. field. }
  assert (small : lambda_c < 1) by (rewrite <- same; unfold printed_cuspless_lambda_c; lra).
  repeat split.
  - exact same.
  - rewrite value. ring.
  - intros lam range. rewrite value. nra.
  - intros lam range. rewrite value. nra.
Qed.

(** * The egg's diameter *)

Definition tilt (alpha : R) : R := 18 * alpha / (1 - alpha ^ 2).

Theorem egg_derived alpha lam :
  alpha ^ 2 < 1 ->
  egg_diameter_flights alpha lam = egg_diameter_monodromy alpha lam
  /\ trace (egg_diameter_monodromy alpha lam) = (1 + lam) ^ 2 * (1 - tilt alpha ^ 2) - 2 * lam
  /\ det (egg_diameter_monodromy alpha lam) = lam ^ 2.
Proof.
  intros small. assert (- 1 < alpha < 1) by (split; nra).
  unfold tilt. split; [| split].
  - unfold egg_diameter_flights, egg_diameter_monodromy.
    replace (alpha ^ 2 - 2 * alpha + 1) with ((1 - alpha) ^ 2) by ring.
    replace (alpha ^ 2 + 2 * alpha + 1) with ((1 + alpha) ^ 2) by ring. entries.
  - unfold trace, egg_diameter_monodromy; cbn [a11 a22]. field. lra.
  - unfold det, egg_diameter_monodromy; cbn [a11 a12 a21 a22]. field. lra.
Qed.

(** [x/(y + sqrt(y^2 + x^2))] with [y = 9*(1 + lam)] is the shape with the tilt [x/(1 + lam)]. *)
Lemma shape_of_tilt x lam :
  0 <= lam ->
  let y := 9 * (1 + lam) in
  let alpha := x / (y + sqrt (y ^ 2 + x ^ 2)) in
  alpha ^ 2 < 1 /\ tilt alpha = x / (1 + lam).
Proof.
  intros nonneg y alpha. assert (y_pos : 0 < y) by (unfold y; lra).
  set (r := sqrt (y ^ 2 + x ^ 2)) in *.
  assert (squared : r ^ 2 = y ^ 2 + x ^ 2) by (unfold r; apply pow2_sqrt; nra).
  assert (0 <= r) by apply sqrt_pos.
  assert (law : alpha * (y + r) = x) by (unfold alpha; field; lra).
  assert (squares : alpha ^ 2 * (y + r) = r - y).
  { apply Rmult_eq_reg_r with (y + r); [| lra].
    replace (alpha ^ 2 * (y + r) * (y + r)) with ((alpha * (y + r)) ^ 2) by ring. rewrite law.
    replace ((r - y) * (y + r)) with (r ^ 2 - y ^ 2) by ring. lra. }
  clearbody alpha. assert (small : alpha ^ 2 < 1) by (apply Rmult_lt_reg_r with (y + r); lra).
  split; [exact small |].
  unfold tilt. apply Rmult_eq_reg_r with ((1 - alpha ^ 2) * (1 + lam)); [| apply Rgt_not_eq, Rmult_lt_0_compat; lra].
  replace (18 * alpha / (1 - alpha ^ 2) * ((1 - alpha ^ 2) * (1 + lam))) with (2 * y * alpha) by (unfold y; field; lra).
  replace (x / (1 + lam) * ((1 - alpha ^ 2) * (1 + lam))) with (x * (1 - alpha ^ 2)) by (field; lra).
  rewrite <- law. replace (alpha * (y + r) * (1 - alpha ^ 2)) with (alpha * (y + r - alpha ^ 2 * (y + r))) by ring.
  rewrite squares. ring.
Qed.

Theorem alpha_tilde_is_a_period_doubling lam :
  0 <= lam <= 1 ->
  printed_egg_alpha_tilde lam = alpha_tilde lam
  /\ characteristic (egg_diameter_monodromy (alpha_tilde lam) lam) (- 1) = 0.
Proof.
  intros range.
  set (x := sqrt (2 * lam ^ 2 + 2)). set (y := 9 * (1 + lam)). set (r := sqrt (y ^ 2 + x ^ 2)).
  assert (x2 : x ^ 2 = 2 * lam ^ 2 + 2) by (unfold x; apply pow2_sqrt; nra).
  assert (x_pos : 0 < x) by (apply sqrt_lt_R0; nra).
  assert (y_pos : 0 < y) by (unfold y; lra).
  assert (r2 : r ^ 2 = y ^ 2 + x ^ 2) by (unfold r; apply pow2_sqrt; nra).
  assert (r_large : y < r).
  { assert (0 <= r) by apply sqrt_pos. assert (0 < x ^ 2) by nra. nra. }
  assert (is : alpha_tilde lam = x / (y + r)).
  { unfold alpha_tilde. fold x. unfold r, y. rewrite x2.
    replace (2 * lam ^ 2 + 81 * (lam + 1) ^ 2 + 2) with ((9 * (1 + lam)) ^ 2 + (2 * lam ^ 2 + 2)) by ring.
    f_equal. ring. }
  assert (other : x / (y + r) = (r - y) / x).
  { apply Rmult_eq_reg_r with (x * (y + r)); [| nra].
    replace (x / (y + r) * (x * (y + r))) with (x ^ 2) by (field; lra).
    replace ((r - y) / x * (x * (y + r))) with (r ^ 2 - y ^ 2) by (field; lra). lra. }
  split.
  - rewrite is, other. unfold printed_egg_alpha_tilde.
    replace (83 * lam ^ 2 + 162 * lam + 83) with (y ^ 2 + x ^ 2) by (rewrite x2; unfold y; ring). fold r.
    assert (half_pos : 0 < sqrt (lam ^ 2 + 1)) by (apply sqrt_lt_R0; nra).
    assert (two_pos : 0 < sqrt 2) by (apply sqrt_lt_R0; lra).
    assert (x_is : x = sqrt 2 * sqrt (lam ^ 2 + 1)).
    { unfold x. replace (2 * lam ^ 2 + 2) with (2 * (lam ^ 2 + 1)) by ring. apply sqrt_mult; nra. }
    assert (under : 82 * lam ^ 2 + 162 * lam - 9 * (lam + 1) * r + 82 = ((r - y) / sqrt 2) ^ 2).
    { replace (((r - y) / sqrt 2) ^ 2) with ((r ^ 2 - 2 * r * y + y ^ 2) / (sqrt 2 ^ 2)) by (field; apply Rgt_not_eq; exact two_pos).
      rewrite pow2_sqrt, r2, x2 by lra. unfold y. field. }
    rewrite under, sqrt_pow2.
    + rewrite x_is. field. lra.
    + apply Rmult_le_pos; [lra | left; apply Rinv_0_lt_compat; lra].
  - destruct (shape_of_tilt x lam) as [small tilted]; [lra |]. fold y in small, tilted. fold r in small, tilted.
    rewrite <- is in small, tilted. destruct (egg_derived (alpha_tilde lam) lam small) as [_ [trace_is det_is]].
    unfold characteristic. rewrite trace_is, det_is, tilted.
    replace ((x / (1 + lam)) ^ 2) with (x ^ 2 / (1 + lam) ^ 2) by (field; lra). rewrite x2. field. lra.
Qed.

Theorem alpha_hat_is_a_double_multiplier lam :
  0 <= lam < 1 ->
  printed_egg_alpha_hat lam = alpha_hat lam
  /\ discriminant (egg_diameter_monodromy (alpha_hat lam) lam) = 0.
Proof.
  intros range.
  set (x := 1 - lam). set (y := 9 * (1 + lam)). set (r := sqrt (y ^ 2 + x ^ 2)).
  assert (r2 : r ^ 2 = y ^ 2 + x ^ 2) by (unfold r; apply pow2_sqrt; nra).
  assert (0 <= r) by apply sqrt_pos.
  assert (x_pos : 0 < x) by (unfold x; lra).
  assert (y_pos : 0 < y) by (unfold y; lra).
  assert (is : alpha_hat lam = x / (y + r)).
  { unfold alpha_hat. fold x. unfold r, y.
    replace (x ^ 2 + 81 * (lam + 1) ^ 2) with ((9 * (1 + lam)) ^ 2 + x ^ 2) by ring. f_equal. ring. }
  split.
  - rewrite is. unfold printed_egg_alpha_hat.
    replace (82 * lam ^ 2 + 160 * lam + 82) with (y ^ 2 + x ^ 2) by (unfold x, y; ring). fold r.
    replace (lam - 1) with (- x) by (unfold x; ring).
    replace (9 * lam - r + 9) with (y - r) by (unfold y; ring).
    apply Rmult_eq_reg_r with (- x * (y + r)); [| apply Rlt_not_eq; nra].
    replace ((y - r) / - x * (- x * (y + r))) with (y ^ 2 - r ^ 2) by (field; lra).
    replace (x / (y + r) * (- x * (y + r))) with (- x ^ 2) by (field; lra). lra.
  - destruct (shape_of_tilt x lam) as [small tilted]; [lra |]. fold y in small, tilted. fold r in small, tilted.
    rewrite <- is in small, tilted. destruct (egg_derived (alpha_hat lam) lam small) as [_ [trace_is det_is]].
    unfold discriminant. rewrite trace_is, det_is, tilted. unfold x. field. lra.
Qed.

(** Complex multipliers exactly where the tilt lies between its values at [alpha_hat] and at [alpha_tilde 1]. *)
Theorem egg_complex_region alpha lam :
  0 <= alpha -> alpha ^ 2 < 1 -> 0 <= lam <= 1 ->
  (discriminant (egg_diameter_monodromy alpha lam) < 0 <-> (1 - lam) / (1 + lam) < tilt alpha < 1).
Proof.
  intros nonneg small range. destruct (egg_derived alpha lam small) as [_ [trace_is det_is]].
  unfold discriminant. rewrite trace_is, det_is.
  assert (0 <= tilt alpha) by (unfold tilt; apply Rmult_le_pos; [lra | left; apply Rinv_0_lt_compat; lra]).
  set (W := tilt alpha) in *. set (v := (1 - lam) / (1 + lam)).
  assert (v_is : v * (1 + lam) = 1 - lam) by (unfold v; field; lra).
  assert (v_range : 0 <= v <= 1).
  { split; [| nra]. unfold v. apply Rmult_le_pos; [lra | left; apply Rinv_0_lt_compat; lra]. }
  assert (lam_is : 4 * lam = (1 + lam) ^ 2 * (1 - v ^ 2)).
  { replace ((1 + lam) ^ 2 * (1 - v ^ 2)) with ((1 + lam) ^ 2 - (v * (1 + lam)) ^ 2) by ring. rewrite v_is. ring. }
  replace (((1 + lam) ^ 2 * (1 - W ^ 2) - 2 * lam) ^ 2 - 4 * lam ^ 2)
    with ((1 + lam) ^ 2 * (1 - W ^ 2) * ((1 + lam) ^ 2 * (1 - W ^ 2) - 4 * lam)) by ring.
  rewrite lam_is.
  replace ((1 + lam) ^ 2 * (1 - W ^ 2) * ((1 + lam) ^ 2 * (1 - W ^ 2) - (1 + lam) ^ 2 * (1 - v ^ 2)))
    with (((1 + lam) ^ 2) ^ 2 * ((1 - W ^ 2) * (v ^ 2 - W ^ 2))) by ring.
  assert (0 < ((1 + lam) ^ 2) ^ 2) by (apply pow_lt, pow_lt; lra).
  clearbody W v. clear - H H0 v_range. split.
  - intros negative. assert (product : (1 - W ^ 2) * (v ^ 2 - W ^ 2) < 0) by nra. clear negative. split.
    + destruct (Rlt_le_dec v W) as [done | no]; [exact done | exfalso]. assert (0 <= 1 - W ^ 2) by nra.
      assert (0 <= v ^ 2 - W ^ 2) by nra. nra.
    + destruct (Rlt_le_dec W 1) as [done | no]; [exact done | exfalso]. assert (1 - W ^ 2 <= 0) by nra.
      assert (v ^ 2 - W ^ 2 <= 0) by nra. nra.
  - intros [above below]. assert (0 < 1 - W ^ 2) by nra. assert (v ^ 2 - W ^ 2 < 0) by nra.
    assert ((1 - W ^ 2) * (v ^ 2 - W ^ 2) < 0) by nra. nra.
Qed.
