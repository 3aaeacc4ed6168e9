(** The egg's cycles, bounce by bounce, and when one has the multiplier -1. Paper: section 6.6. *)

From Coq Require Import Reals ZArith List Lra Lia Psatz Nsatz.
From Coquelicot Require Import Coquelicot.
From Pinball Require Import Bounce Generated.
Open Scope R_scope.

Section Egg.

Variable alpha : R.

Definition X1 (u : R) : R := - 3 * alpha * sin (3 * u) * cos u - (alpha * cos (3 * u) + 1) * sin u.
Definition Y1 (u : R) : R := - 3 * alpha * sin (3 * u) * sin u + (alpha * cos (3 * u) + 1) * cos u.
Definition X2 (u : R) : R := - 10 * alpha * cos (3 * u) * cos u + 6 * alpha * sin (3 * u) * sin u - cos u.
Definition Y2 (u : R) : R := - 10 * alpha * cos (3 * u) * sin u - 6 * alpha * sin (3 * u) * cos u - sin u.

Theorem egg_derivatives u :
  is_derive (egg_x alpha) u (X1 u) /\ is_derive (egg_y alpha) u (Y1 u) /\ is_derive X1 u (X2 u) /\ is_derive Y1 u (Y2 u).
Proof.
  unfold egg_x, egg_y, X1, Y1, X2, Y2. split; [| split; [| split]]; auto_derive; trivial; ring.
Qed.

Definition speed (u : R) : R := sqrt (X1 u ^ 2 + Y1 u ^ 2).
Definition egg_curvature (u : R) : R := - (X1 u * Y2 u - Y1 u * X2 u) / speed u ^ 3.

(** Components of the chord from [b] to [c] along the inward normal and the tangent at [b], times the speed. *)
Definition normal (b c : R) : R := X1 b * (egg_y alpha c - egg_y alpha b) - Y1 b * (egg_x alpha c - egg_x alpha b).
Definition tangential (b c : R) : R := X1 b * (egg_x alpha c - egg_x alpha b) + Y1 b * (egg_y alpha c - egg_y alpha b).
Definition square (b c : R) : R := (egg_x alpha c - egg_x alpha b) ^ 2 + (egg_y alpha c - egg_y alpha b) ^ 2.

(** A chord of length [t] leaves [b] at the angle [phi] and lands at [c] at the angle [eta], both measured from the inward
    normals as in [Bounce]. *)
Definition flight (b c t phi eta : R) : Prop :=
  0 < t /\ Rabs phi < PI / 2 /\ Rabs eta < PI / 2
  /\ t * cos phi * speed b = normal b c /\ t * sin phi * speed b = tangential b c
  /\ t * cos eta * speed c = normal c b /\ t * sin eta * speed c = tangential c b.

(** The same in the directions of [Bounce]. *)
Theorem flight_directions b c t phi eta psi0 psi1 :
  0 < speed b -> 0 < speed c ->
  X1 b = speed b * cos psi0 -> Y1 b = speed b * sin psi0 -> X1 c = speed c * cos psi1 -> Y1 c = speed c * sin psi1 ->
  flight b c t phi eta ->
  egg_x alpha c - egg_x alpha b = t * cos (psi0 + PI / 2 - phi)
  /\ egg_y alpha c - egg_y alpha b = t * sin (psi0 + PI / 2 - phi)
  /\ egg_x alpha c - egg_x alpha b = t * cos (psi1 - PI / 2 - eta)
  /\ egg_y alpha c - egg_y alpha b = t * sin (psi1 - PI / 2 - eta).
Proof.
  intros vb vc xb yb xc yc [_ [_ [_ [n0 [s0 [n1 s1]]]]]].
  unfold normal, tangential in *. rewrite xb, yb in n0, s0. rewrite xc, yc in n1, s1.
  set (dx := egg_x alpha c - egg_x alpha b) in *. set (dy := egg_y alpha c - egg_y alpha b) in *.
  replace (egg_x alpha b - egg_x alpha c) with (- dx) in * by (unfold dx; ring).
  replace (egg_y alpha b - egg_y alpha c) with (- dy) in * by (unfold dy; ring).
  assert (one0 := sin2_cos2 psi0). assert (one1 := sin2_cos2 psi1). unfold Rsqr in one0, one1.
  replace (psi0 + PI / 2 - phi) with ((psi0 - phi) + PI / 2) by ring.
  replace (psi1 - PI / 2 - eta) with (- (PI / 2 - (psi1 - eta))) by ring.
  rewrite (cos_neg (PI / 2 - _)), (sin_neg (PI / 2 - _)), cos_shift, sin_shift.
  replace (cos (psi0 - phi + PI / 2)) with (- sin (psi0 - phi)) by (rewrite sin_cos, Rplus_comm; ring).
  replace (sin (psi0 - phi + PI / 2)) with (cos (psi0 - phi)) by (rewrite cos_sin, Rplus_comm; ring).
  rewrite !cos_minus, !sin_minus.
  assert (n0' : t * cos phi = cos psi0 * dy - sin psi0 * dx) by (apply Rmult_eq_reg_r with (speed b); lra).
  assert (s0' : t * sin phi = cos psi0 * dx + sin psi0 * dy) by (apply Rmult_eq_reg_r with (speed b); lra).
  assert (n1' : t * cos eta = - (cos psi1 * dy - sin psi1 * dx)) by (apply Rmult_eq_reg_r with (speed c); lra).
  assert (s1' : t * sin eta = - (cos psi1 * dx + sin psi1 * dy)) by (apply Rmult_eq_reg_r with (speed c); lra).
  clear - n0' s0' n1' s1' one0 one1. repeat split; nsatz.
Qed.

Definition angle (b c : R) : R := atan (tangential b c / normal b c).

Lemma flight_exists b c :
  0 < speed b -> 0 < speed c -> 0 < normal b c -> 0 < normal c b -> flight b c (sqrt (square b c)) (angle b c) (angle c b).
Proof.
  assert (one : forall b c, 0 < speed b -> 0 < normal b c -> 0 < square b c /\ Rabs (angle b c) < PI / 2
    /\ sqrt (square b c) * cos (angle b c) * speed b = normal b c
    /\ sqrt (square b c) * sin (angle b c) * speed b = tangential b c).
  { clear b c. intros b c v_pos n_pos.
    assert (v2 : speed b ^ 2 = X1 b ^ 2 + Y1 b ^ 2) by (unfold speed; apply pow2_sqrt; nra).
    assert (sum : normal b c ^ 2 + tangential b c ^ 2 = speed b ^ 2 * square b c).
    { rewrite v2. unfold normal, tangential, square. ring. }
    assert (v2_pos : 0 < speed b ^ 2) by (apply pow_lt; exact v_pos).
    assert (sq_pos : 0 < square b c) by nra.
    assert (t_pos : 0 < sqrt (square b c)) by (apply sqrt_lt_R0; exact sq_pos).
    assert (root : sqrt (1 + (tangential b c / normal b c)²) = sqrt (square b c) * speed b / normal b c).
    { replace (1 + (tangential b c / normal b c)²) with ((sqrt (square b c) * speed b / normal b c) ^ 2).
      - apply sqrt_pow2. apply Rmult_le_pos; [nra | left; apply Rinv_0_lt_compat; lra].
      - replace ((sqrt (square b c) * speed b / normal b c) ^ 2) with (sqrt (square b c) ^ 2 * speed b ^ 2 / normal b c ^ 2)
          by (field; lra). rewrite pow2_sqrt by lra. unfold Rsqr.
        replace (square b c * speed b ^ 2) with (normal b c ^ 2 + tangential b c ^ 2) by (rewrite sum; ring). field. lra. }
    split; [exact sq_pos | split].
    - unfold angle. assert (bound := atan_bound (tangential b c / normal b c)). apply Rabs_def1; lra.
    - unfold angle. rewrite cos_atan, sin_atan, root. split; field; lra. }
  intros vb vc nb nc. destruct (one b c vb nb) as [sq [ab [cb sb]]]. destruct (one c b vc nc) as [_ [ac [cc sc]]].
  assert (same : square c b = square b c) by (unfold square; ring). rewrite same in cc, sc.
  unfold flight. repeat split; try assumption. apply sqrt_lt_R0, sq.
Qed.

(** * A sequence of bounces *)

Variable lam : R.
Variables theta phi eta t : nat -> R.

Definition follows (i : nat) : Prop :=
  flight (theta i) (theta (S i)) (t i) (phi i) (eta (S i)) /\ phi (S i) = - lam * eta (S i).

Fixpoint monodromy (n : nat) : matrix :=
  match n with
  | O => identity
  | S m =>
      product (bounce (egg_curvature (theta m)) (egg_curvature (theta (S m))) (t m) (cos (phi m)) (cos (eta (S m))) lam)
        (monodromy m)
  end.

Definition is_cycle (n : nat) : Prop :=
  (forall i, (i < n)%nat -> follows i) /\ theta n = theta 0%nat /\ phi n = phi 0%nat.

(** What keeps the law when the bounce points move by [v]: three neighbours in one linear equation. *)
Definition moves_along (a b c va vb vc : R) : Prop :=
  normal c b / square b c * vc
  + ((1 + lam) * (egg_curvature b * speed b) + normal b c / square b c + lam * (normal b a / square b a)) * vb
  + lam * (normal a b / square a b) * va = 0.

Variable v : nat -> R.

Let ds (i : nat) : R := speed (theta i) * v i.
Let dphi (i : nat) : R :=
  - (cos (eta (S i)) / t i) * ds (S i) - (egg_curvature (theta i) + cos (phi i) / t i) * ds i.

Hypothesis regular : forall i, 0 < speed (theta i).

Lemma flight_square b c s f e : 0 < speed b -> flight b c s f e -> square b c = s ^ 2 /\ 0 < s ^ 2.
Proof.
  intros v_pos [s_pos [_ [_ [n0 [s0 _]]]]].
  assert (v2 : speed b ^ 2 = X1 b ^ 2 + Y1 b ^ 2) by (unfold speed; apply pow2_sqrt; nra).
  assert (v2_pos : 0 < speed b ^ 2) by (apply pow_lt; exact v_pos).
  assert (sum : normal b c ^ 2 + tangential b c ^ 2 = speed b ^ 2 * square b c).
  { rewrite v2. unfold normal, tangential, square. ring. }
  rewrite <- n0, <- s0 in sum. assert (one := sin2_cos2 f). unfold Rsqr in one.
  replace ((s * cos f * speed b) ^ 2 + (s * sin f * speed b) ^ 2)
    with (speed b ^ 2 * (s ^ 2 * (sin f * sin f + cos f * cos f))) in sum by ring. rewrite one, Rmult_1_r in sum.
  split; [apply Rmult_eq_reg_l with (speed b ^ 2); lra | apply pow_lt, s_pos].
Qed.

Lemma one_step i :
  follows i -> follows (S i) ->
  moves_along (theta i) (theta (S i)) (theta (S (S i))) (v i) (v (S i)) (v (S (S i))) ->
  let m := bounce (egg_curvature (theta i)) (egg_curvature (theta (S i))) (t i) (cos (phi i)) (cos (eta (S i))) lam in
  a11 m * ds i + a12 m * dphi i = ds (S i) /\ a21 m * ds i + a22 m * dphi i = dphi (S i).
Proof.
  intros [here law] [there _] moves. cbv zeta.
  destruct (flight_square _ _ _ _ _ (regular i) here) as [sq0 sq0_pos].
  destruct (flight_square _ _ _ _ _ (regular (S i)) there) as [sq1 sq1_pos].
  destruct here as [t0_pos [_ [eta_range [n0 [_ [m0 _]]]]]]. destruct there as [t1_pos [_ [_ [n1 [_ [m1 _]]]]]].
  assert (eta_pos : 0 < cos (eta (S i))) by (apply Rabs_def2 in eta_range; apply cos_gt_0; lra).
  unfold moves_along in moves.
  replace (square (theta (S i)) (theta i)) with (square (theta i) (theta (S i))) in moves by (unfold square; ring).
  rewrite sq0, sq1, <- n0, <- m0, <- n1, <- m1 in moves.
  assert (v0 := regular i). assert (v1 := regular (S i)). assert (v2 := regular (S (S i))).
  unfold dphi, ds, bounce; cbn [a11 a12 a21 a22].
  set (K0 := egg_curvature (theta i)) in *. set (K1 := egg_curvature (theta (S i))) in *.
  set (w0 := speed (theta i)) in *. set (w1 := speed (theta (S i))) in *. set (w2 := speed (theta (S (S i)))) in *.
  set (c0 := cos (phi i)) in *. set (c1 := cos (phi (S i))) in *. set (e1 := cos (eta (S i))) in *.
  set (e2 := cos (eta (S (S i)))) in *. set (t0 := t i) in *. set (t1 := t (S i)) in *.
  split; [field; lra |].
  apply Rminus_diag_uniq.
  match type of moves with ?left = 0 => replace 0 with left by exact moves end. field. lra.
Qed.

(** Bounce points that move along a cycle and come back reversed: the multiplier -1. *)
Theorem reversed_is_multiplier n :
  (forall i, (i <= n)%nat -> follows i) ->
  (forall i, (i < n)%nat ->
    moves_along (theta i) (theta (S i)) (theta (S (S i))) (v i) (v (S i)) (v (S (S i)))) ->
  theta n = theta 0%nat -> theta (S n) = theta 1%nat -> phi n = phi 0%nat -> eta (S n) = eta 1%nat -> t n = t 0%nat ->
  v n = - v 0%nat -> v (S n) = - v 1%nat -> v 0%nat <> 0 ->
  characteristic (monodromy n) (- 1) = 0.
Proof.
  intros bounces moves th0 th1 ph et tt v0 v1 nonzero.
  assert (moved : forall k, (k <= n)%nat ->
    a11 (monodromy k) * ds 0 + a12 (monodromy k) * dphi 0 = ds k
    /\ a21 (monodromy k) * ds 0 + a22 (monodromy k) * dphi 0 = dphi k).
  { induction k as [| k IH]; intros upto; [simpl; split; ring |]. destruct IH as [first second]; [lia |].
    destruct (one_step k) as [third fourth]; [apply bounces; lia | apply bounces; lia | apply moves; lia |].
    cbn [monodromy]. rewrite <- first, <- second in third, fourth. unfold product; cbn [a11 a12 a21 a22].
    set (m := bounce _ _ _ _ _ _) in *. split; [rewrite <- third | rewrite <- fourth]; ring. }
  destruct (moved n (Nat.le_refl n)) as [first second].
  assert (ds_back : ds n = - ds 0) by (unfold ds; rewrite th0, v0; ring).
  assert (dphi_back : dphi n = - dphi 0) by (unfold dphi, ds; rewrite th0, th1, ph, et, tt, v0, v1; ring).
  rewrite ds_back in first. rewrite dphi_back in second.
  assert (ds0 : ds 0 <> 0) by (unfold ds; apply Rmult_integral_contrapositive_currified; [apply Rgt_not_eq, regular | exact nonzero]).
  set (m := monodromy n) in *. set (x := ds 0) in *. set (y := dphi 0) in *.
  unfold characteristic, trace, det. apply Rmult_eq_reg_r with x; [| exact ds0].
  replace (((- 1) ^ 2 - (a11 m + a22 m) * - 1 + (a11 m * a22 m - a12 m * a21 m)) * x)
    with ((a22 m + 1) * (a11 m * x + a12 m * y + x) - a12 m * (a21 m * x + a22 m * y + y)) by ring.
  rewrite first, second. ring.
Qed.

End Egg.
