(** Points, tangents and curvatures of the paper's tables, from their parametrisations. Sections 2 to 6.

    The parametrisations, and the printed curvatures, come from [Generated]. *)

From Coq Require Import Reals Lra Psatz.
From Coquelicot Require Import Coquelicot.
From Pinball Require Import Cardioid Generated.
Open Scope R_scope.

(** At [theta] the curve is at [(px, py)] with unit tangent [(tx, ty)] and curvature [K], negative where it focuses. *)
Definition frame_is (x y : R -> R) (theta px py tx ty K : R) : Prop :=
  exists x1 y1 : R -> R, exists x2 y2 speed : R,
    (forall u, is_derive x u (x1 u)) /\ (forall u, is_derive y u (y1 u))
    /\ is_derive x1 theta x2 /\ is_derive y1 theta y2
    /\ 0 < speed /\ speed ^ 2 = x1 theta ^ 2 + y1 theta ^ 2
    /\ x theta = px /\ y theta = py /\ x1 theta = speed * tx /\ y1 theta = speed * ty
    /\ K = - (x1 theta * y2 - y1 theta * x2) / speed ^ 3.

Ltac derivative := intros; auto_derive; trivial; try ring.

Theorem ellipse_curvature a theta :
  0 < a -> exists px py tx ty,
    frame_is (ellipse_x a) ellipse_y theta px py tx ty (printed_ellipse_curvature a theta).
Proof.
  intros a_pos.
  set (square := a ^ 2 * sin theta ^ 2 + cos theta ^ 2).
  assert (circle := sin2_cos2 theta). unfold Rsqr in circle.
  assert (square_pos : 0 < square).
  { unfold square. destruct (Req_dec (cos theta) 0) as [zero | nonzero].
    - rewrite zero in *. assert (0 < a ^ 2) by nra. nra.
    - assert (0 < cos theta ^ 2) by (apply pow2_gt_0; exact nonzero).
      assert (0 <= (a * sin theta) ^ 2) by apply pow2_ge_0. nra. }
  assert (speed_pos : 0 < sqrt square) by (apply sqrt_lt_R0; exact square_pos).
  exists (ellipse_x a theta), (ellipse_y theta), (- a * sin theta / sqrt square), (cos theta / sqrt square).
  exists (fun u => - a * sin u), (fun u => cos u), (- a * cos theta), (- sin theta), (sqrt square).
  repeat match goal with |- _ /\ _ => split end.
  - unfold ellipse_x. derivative.
  - unfold ellipse_y. derivative.
  - derivative.
  - derivative.
  - exact speed_pos.
  - rewrite pow2_sqrt by lra. unfold square. ring.
  - reflexivity.
  - reflexivity.
  - field. lra.
  - field. lra.
  - unfold printed_ellipse_curvature. fold square.
    replace (- (- a * sin theta * - sin theta - cos theta * (- a * cos theta)))
      with (- a * (sin theta * sin theta + cos theta * cos theta)) by ring.
    rewrite circle. field. lra.
Qed.

Ltac frame := repeat match goal with |- _ /\ _ => split end; [derivative | derivative | derivative | derivative | ..].

Theorem ellipse_frames a :
  0 < a ->
  frame_is (ellipse_x a) ellipse_y (PI / 2) 0 1 (- 1) 0 (- (1 / a ^ 2))
  /\ frame_is (ellipse_x a) ellipse_y (- (PI / 2)) 0 (- 1) 1 0 (- (1 / a ^ 2))
  /\ frame_is (ellipse_x a) ellipse_y 0 a 0 0 1 (- a)
  /\ frame_is (ellipse_x a) ellipse_y PI (- a) 0 0 (- 1) (- a).
Proof.
  intros a_pos. unfold frame_is, ellipse_x, ellipse_y.
  repeat match goal with |- _ /\ _ => split end.
  - exists (fun u : R => - a * sin u), (fun u : R => cos u), (- a * cos (PI / 2)), (- sin (PI / 2)), a; frame;
      rewrite ?cos_PI2, ?sin_PI2; try ring; try lra; field; lra.
  - exists (fun u : R => - a * sin u), (fun u : R => cos u), (- a * cos (- (PI / 2))), (- sin (- (PI / 2))), a; frame;
      rewrite ?cos_neg, ?sin_neg, ?cos_PI2, ?sin_PI2; try ring; try lra; field; lra.
  - exists (fun u : R => - a * sin u), (fun u : R => cos u), (- a * cos 0), (- sin 0), 1; frame;
      rewrite ?cos_0, ?sin_0; try ring; try lra; field; lra.
  - exists (fun u : R => - a * sin u), (fun u : R => cos u), (- a * cos PI), (- sin PI), 1; frame;
      rewrite ?cos_PI, ?sin_PI; try ring; try lra; field; lra.
Qed.

Theorem cuspless_frames :
  frame_is wall_x wall_y 0 (- (1 / 4)) 0 0 (- 1) 0
  /\ frame_is cardioid_x cardioid_y 0 2 0 0 1 (- (3 / 4)).
Proof.
  unfold frame_is, wall_x, wall_y, cardioid_x, cardioid_y. split.
  - exists (fun _ : R => 0), (fun _ : R => - 1), 0, 0, 1; frame; try ring; try lra; field; lra.
  - exists (fun u : R => - sin u * (2 * cos u + 1)), (fun u : R => - sin u * sin u + (cos u + 1) * cos u),
      (- cos 0 * (2 * cos 0 + 1) + 2 * sin 0 * sin 0), (- sin 0 * (4 * cos 0 + 1)), 2; frame;
      rewrite ?cos_0, ?sin_0; try ring; try lra; field; lra.
Qed.

Theorem egg_frames alpha :
  0 <= alpha <= 1 / 10 ->
  frame_is (egg_x alpha) (egg_y alpha) 0 (alpha + 1) 0 0 1 (printed_egg_curvature_max alpha)
  /\ frame_is (egg_x alpha) (egg_y alpha) PI (alpha - 1) 0 0 (- 1) (printed_egg_curvature_min alpha).
Proof.
  intros range. unfold frame_is, egg_x, egg_y, printed_egg_curvature_max, printed_egg_curvature_min.
  assert (cos3 : cos (3 * PI) = - 1).
  { replace (3 * PI) with (2 * PI + PI) by ring. rewrite cos_plus, cos_2PI, sin_2PI, cos_PI. ring. }
  assert (sin3 : sin (3 * PI) = 0).
  { replace (3 * PI) with (2 * PI + PI) by ring. rewrite sin_plus, cos_2PI, sin_2PI, sin_PI. ring. }
  set (x1 := fun u : R => - 3 * alpha * sin (3 * u) * cos u - (alpha * cos (3 * u) + 1) * sin u).
  set (y1 := fun u : R => - 3 * alpha * sin (3 * u) * sin u + (alpha * cos (3 * u) + 1) * cos u).
  set (x2 := fun u : R => - 10 * alpha * cos (3 * u) * cos u + 6 * alpha * sin (3 * u) * sin u - cos u).
  set (y2 := fun u : R => - 10 * alpha * cos (3 * u) * sin u - 6 * alpha * sin (3 * u) * cos u - sin u).
  split.
  - exists x1, y1, (x2 0), (y2 0), (1 + alpha); unfold x1, y1, x2, y2; frame; rewrite ?Rmult_0_r, ?cos_0, ?sin_0; try ring; try lra; field; lra.
  - exists x1, y1, (x2 PI), (y2 PI), (1 - alpha); unfold x1, y1, x2, y2; frame; rewrite ?cos3, ?sin3, ?cos_PI, ?sin_PI; try ring;
      try lra; field; lra.
Qed.

(** The cardioid in half its polar angle, as [Cardioid] has it, is the same curve with the printed curvature. *)
Theorem cardioid_in_half_angles h :
  0 < cos h ->
  cardioid_x (2 * h) = X h /\ cardioid_y (2 * h) = Y h /\ printed_cardioid_curvature (2 * h) = - / radius h.
Proof.
  intros pos. unfold cardioid_x, cardioid_y, X, Y, printed_cardioid_curvature, radius. split; [ring | split; [ring |]].
  assert (root : sqrt (8 * cos (2 * h) + 8) = 4 * cos h).
  { rewrite cos_2a_cos. replace (8 * (2 * cos h * cos h - 1) + 8) with ((4 * cos h) ^ 2) by ring. apply sqrt_pow2. lra. }
  rewrite root. field. lra.
Qed.
