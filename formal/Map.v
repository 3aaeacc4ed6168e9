(** The cardioid's pinball map itself: the first landing of a ray that leaves the boundary, and the law. Paper: section 2.

    The cusp is left out, as there: the map is not defined where a ray meets it. *)

From Coq Require Import Reals Lra Lia Psatz.
From Coquelicot Require Import Coquelicot.
From Pinball Require Import Bounce Cone Cardioid Stretch Cycles.
Open Scope R_scope.

Definition on_boundary (x y : R) : Prop := exists h, - (PI / 2) <= h <= PI / 2 /\ X h = x /\ Y h = y.

(** The point at distance [s] on the ray that leaves [h0] at the exit angle [phi]. *)
Definition ray_x (h0 phi s : R) : R := X h0 + s * cos (psi h0 + PI / 2 - phi).
Definition ray_y (h0 phi s : R) : R := Y h0 + s * sin (psi h0 + PI / 2 - phi).

(** The flight ends at the first point of the boundary on the ray, and that is not the cusp. *)
Definition first_landing (h0 phi h1 t eta : R) : Prop :=
  off_cusp h1 /\ Rabs eta < PI / 2 /\ flight h0 h1 t phi eta
  /\ forall s, 0 < s < t -> ~ on_boundary (ray_x h0 phi s) (ray_y h0 phi s).

Definition pinball (lam h0 phi0 h1 phi1 : R) : Prop :=
  off_cusp h0 /\ Rabs phi0 < PI / 2 /\ exists t eta, first_landing h0 phi0 h1 t eta /\ phi1 = - lam * eta.

Lemma same_point h g : off_cusp h -> off_cusp g -> X h = X g -> Y h = Y g -> h = g.
Proof.
  intros rh rg same_x same_y. assert (ch := cos_pos h rh). assert (cg := cos_pos g rg).
  assert (one_h := sin2_cos2 h). assert (one_g := sin2_cos2 g). unfold Rsqr in one_h, one_g.
  assert (polar : forall u, X u * X u + Y u * Y u = (2 * (cos u * cos u)) ^ 2 * ((sin u * sin u + cos u * cos u) ^ 2)).
  { intros u. unfold X, Y. rewrite cos_2a, sin_2a. assert (one := sin2_cos2 u). unfold Rsqr in one.
    replace (1 + (cos u * cos u - sin u * sin u)) with (2 * (cos u * cos u)) by lra. ring. }
  assert (radii : (2 * (cos h * cos h)) ^ 2 = (2 * (cos g * cos g)) ^ 2).
  { assert (ph := polar h). assert (pg := polar g). rewrite one_h in ph. rewrite one_g in pg. rewrite same_x, same_y in ph. lra. }
  assert (squares : cos h * cos h = cos g * cos g) by nra.
  assert (cosines : cos h = cos g) by nra.
  assert (sines : sin h = sin g).
  { unfold Y in same_y. rewrite !cos_2a, !sin_2a in same_y.
    replace (1 + (cos h * cos h - sin h * sin h)) with (2 * (cos h * cos h)) in same_y by lra.
    replace (1 + (cos g * cos g - sin g * sin g)) with (2 * (cos g * cos g)) in same_y by lra.
    rewrite cosines in same_y. apply Rmult_eq_reg_l with (4 * (cos g * cos g * cos g)); [lra |].
    apply Rgt_not_eq. assert (0 < cos g * cos g * cos g) by (repeat apply Rmult_lt_0_compat; exact cg). lra. }
  destruct rh, rg. destruct (Rtotal_order h g) as [less | [equal | more]]; [exfalso | exact equal | exfalso].
  - assert (sin h < sin g) by (apply sin_increasing_1; lra). lra.
  - assert (sin g < sin h) by (apply sin_increasing_1; lra). lra.
Qed.

Lemma same_angle a e f : Rabs e < PI / 2 -> Rabs f < PI / 2 -> cos (a - e) = cos (a - f) -> sin (a - e) = sin (a - f) -> e = f.
Proof.
  intros re rf same_cos same_sin. apply Rabs_def2 in re, rf.
  assert (one := sin2_cos2 (a - e)). unfold Rsqr in one.
  assert (turn : sin (e - f) = 0).
  { replace (e - f) with ((a - f) - (a - e)) by ring. rewrite sin_minus, same_cos, same_sin. ring. }
  assert (ahead : cos (e - f) = 1).
  { replace (e - f) with ((a - f) - (a - e)) by ring. rewrite cos_minus, <- same_cos, <- same_sin. lra. }
  destruct (Rtotal_order e f) as [less | [equal | more]]; [exfalso | exact equal | exfalso].
  - assert (0 < sin (f - e)) by (apply sin_gt_0; lra). replace (e - f) with (- (f - e)) in turn by ring.
    rewrite sin_neg in turn. lra.
  - assert (0 < sin (e - f)) by (apply sin_gt_0; lra). lra.
Qed.

(** It is a map: one start, one landing. *)
Theorem pinball_is_a_map lam h0 phi0 h1 phi1 h2 phi2 :
  pinball lam h0 phi0 h1 phi1 -> pinball lam h0 phi0 h2 phi2 -> h1 = h2 /\ phi1 = phi2.
Proof.
  intros [_ [_ [t1 [eta1 [[off1 [range1 [flies1 first1]]] law1]]]]] [_ [_ [t2 [eta2 [[off2 [range2 [flies2 first2]]] law2]]]]].
  destruct flies1 as [pos1 [x1 [y1 [u1 v1]]]]. destruct flies2 as [pos2 [x2 [y2 [u2 v2]]]].
  assert (landed1 : on_boundary (ray_x h0 phi0 t1) (ray_y h0 phi0 t1)).
  { exists h1. unfold off_cusp in off1. unfold ray_x, ray_y. repeat split; lra. }
  assert (landed2 : on_boundary (ray_x h0 phi0 t2) (ray_y h0 phi0 t2)).
  { exists h2. unfold off_cusp in off2. unfold ray_x, ray_y. repeat split; lra. }
  assert (together : t1 = t2).
  { destruct (Rtotal_order t1 t2) as [less | [equal | more]]; [exfalso | exact equal | exfalso].
    - apply (first2 t1); [lra | exact landed1].
    - apply (first1 t2); [lra | exact landed2]. }
  subst t2.
  assert (same : h1 = h2) by (apply same_point; try assumption; lra). subst h2. split; [reflexivity |].
  assert (etas : eta1 = eta2).
  { apply (same_angle (psi h1 - PI / 2)); try assumption; apply Rmult_eq_reg_l with t1; lra. }
  rewrite law1, law2, etas. reflexivity.
Qed.

(** [n] bounces of the map, with the lengths of flight and the angles of incidence. *)
Definition map_orbit (lam : R) (h phi eta t : nat -> R) (n : nat) : Prop :=
  off_cusp (h 0%nat) /\ Rabs (phi 0%nat) < PI / 2
  /\ forall k, (k < n)%nat -> first_landing (h k) (phi k) (h (S k)) (t k) (eta (S k)) /\ phi (S k) = - lam * eta (S k).

Lemma map_orbit_is_orbit lam h phi eta t n : map_orbit lam h phi eta t n -> orbit lam h phi eta t n.
Proof.
  intros [off [range step]]. split; [exact range | split; [exact off |]]. intros k below.
  destruct (step k below) as [[lands [angle [flies _]]] law]. repeat split; try assumption; apply flies || apply lands.
Qed.

(** * An orbit: up and down between [theta = PI/3] and [theta = -PI/3], for every contraction *)

Definition swing (k : nat) : R := if Nat.even k then PI / 6 else - (PI / 6).

Lemma vertical_chord h : h = PI / 6 \/ h = - (PI / 6) -> X h = 3 / 4 /\ off_cusp h.
Proof.
  assert (pi := PI_RGT_0).
  assert (third : cos (PI / 3) = 1 / 2) by apply cos_PI3.
  intros [-> | ->]; (split; [| split; lra]); unfold X.
  - replace (2 * (PI / 6)) with (PI / 3) by field. rewrite third. field.
  - replace (2 * - (PI / 6)) with (- (PI / 3)) by field. rewrite cos_neg, third. field.
Qed.

Theorem vertical_orbit lam n : map_orbit lam swing (fun _ => 0) (fun _ => 0) (fun _ => 3 * sqrt 3 / 2) n.
Proof.
  assert (pi := PI_RGT_0). assert (root : 0 < sqrt 3) by (apply sqrt_lt_R0; lra).
  assert (two : cos (PI / 3) = 1 / 2) by apply cos_PI3. assert (half : sin (PI / 3) = sqrt 3 / 2) by apply sin_PI3.
  assert (up : Y (PI / 6) = 3 * sqrt 3 / 4).
  { unfold Y. replace (2 * (PI / 6)) with (PI / 3) by field. rewrite two, half. field. }
  assert (down : Y (- (PI / 6)) = - (3 * sqrt 3 / 4)).
  { unfold Y. replace (2 * - (PI / 6)) with (- (PI / 3)) by field. rewrite cos_neg, sin_neg, two, half. field. }
  destruct (vertical_chord (PI / 6) (or_introl eq_refl)) as [x_up off_up].
  destruct (vertical_chord (- (PI / 6)) (or_intror eq_refl)) as [x_down off_down].
  (* the chord x = 3/4 meets the boundary at its ends only *)
  assert (between : forall y, - (3 * sqrt 3 / 4) < y < 3 * sqrt 3 / 4 -> ~ on_boundary (3 / 4) y).
  { intros y inner [h [range [at_x at_y]]].
    assert (c2 : cos (2 * h) = 1 / 2).
    { unfold X in at_x. assert (low := COS_bound (2 * h)). nra. }
    unfold Y in at_y. rewrite c2 in at_y. assert (one := sin2_cos2 (2 * h)). unfold Rsqr in one. rewrite c2 in one.
    assert (s3 : sqrt 3 * sqrt 3 = 3) by (apply sqrt_sqrt; lra). nra. }
  assert (zero : Rabs 0 < PI / 2) by (rewrite Rabs_R0; lra).
  assert (falls : forall k, first_landing (swing k) 0 (swing (S k)) (3 * sqrt 3 / 2) 0).
  { intros k. unfold swing. rewrite Nat.even_succ, <- Nat.negb_even. destruct (Nat.even k); cbn [negb].
    - assert (d1 : psi (PI / 6) + PI / 2 - 0 = PI + PI / 2) by (unfold psi; field).
      assert (d2 : psi (- (PI / 6)) - PI / 2 - 0 = - (PI / 2)) by (unfold psi; field).
      split; [exact off_down | split; [exact zero | split]].
      + unfold flight. rewrite d1, d2, x_up, x_down, up, down.
        replace (PI + PI / 2) with (PI / 2 + PI) by ring. rewrite neg_cos, neg_sin, cos_neg, sin_neg, cos_PI2, sin_PI2.
        repeat split; lra.
      + intros s inner. unfold ray_x, ray_y. rewrite d1, x_up, up.
        replace (PI + PI / 2) with (PI / 2 + PI) by ring. rewrite neg_cos, neg_sin, cos_PI2, sin_PI2.
        replace (3 / 4 + s * - 0) with (3 / 4) by ring. apply between. lra.
    - assert (d1 : psi (- (PI / 6)) + PI / 2 - 0 = PI / 2) by (unfold psi; field).
      assert (d2 : psi (PI / 6) - PI / 2 - 0 = PI / 2) by (unfold psi; field).
      split; [exact off_up | split; [exact zero | split]].
      + unfold flight. rewrite d1, d2, x_up, x_down, up, down, cos_PI2, sin_PI2. repeat split; lra.
      + intros s inner. unfold ray_x, ray_y. rewrite d1, x_down, down, cos_PI2, sin_PI2.
        replace (3 / 4 + s * 0) with (3 / 4) by ring. apply between. lra. }
  split; [exact off_up | split; [exact zero |]]. intros k _. split; [apply falls | ring].
Qed.
