(** The cardioid's flights along the normal, and what they refute: the slap map does not expand everywhere, and one bounce may
    expand areas. Sections 1 and 4.2. *)

From Coq Require Import Nsatz Reals Lra Psatz.
From Coquelicot Require Import Coquelicot.
From Pinball Require Import Bounce Cone Cardioid Stretch Cycles Numbers.
Open Scope R_scope.

(** The cusp is at [s = 4] and at [s = -4]; at [s = 0] the boundary is flattest. *)
Theorem cusp_and_flattest_point :
  arc_length (PI / 2) = 4 /\ arc_length (- (PI / 2)) = - 4 /\ radius (PI / 2) = 0
  /\ arc_length 0 = 0 /\ forall h, radius h <= radius 0.
Proof.
  unfold arc_length, radius. rewrite sin_neg, sin_PI2, cos_PI2, sin_0, cos_0. repeat split; try lra.
  intros h. generalize (COS_bound h). lra.
Qed.

Lemma chord_components h0 h1 :
  let C := cos (h1 - h0) in
  let S := sin (h1 - h0) in
  normal h0 h1 = 2 * (S * S) * (cos h0 + 2 * cos h1 * C)
  /\ tangential h0 h1 = 2 * S * (cos h0 * C + cos h1 * (2 * (C * C) - 1)).
Proof.
  intros C S.
  assert (c1 : cos h1 = cos h0 * C - sin h0 * S) by (unfold C, S; rewrite <- cos_plus; f_equal; ring).
  assert (s1 : sin h1 = sin h0 * C + cos h0 * S) by (unfold C, S; rewrite <- sin_plus; f_equal; ring).
  assert (circle0 : cos h0 * cos h0 + sin h0 * sin h0 = 1) by (generalize (sin2_cos2 h0); unfold Rsqr; lra).
  assert (circle : C * C + S * S = 1) by (generalize (sin2_cos2 (h1 - h0)); unfold Rsqr, C, S; lra).
  assert (c3 : cos (3 * h0) = cos h0 * (cos h0 * cos h0 - 3 * (sin h0 * sin h0))).
  { replace (3 * h0) with (2 * h0 + h0) by ring. rewrite cos_plus, cos_2a, sin_2a. ring. }
  assert (s3 : sin (3 * h0) = sin h0 * (3 * (cos h0 * cos h0) - sin h0 * sin h0)).
  { replace (3 * h0) with (2 * h0 + h0) by ring. rewrite sin_plus, cos_2a, sin_2a. ring. }
  unfold normal, tangential, X, Y. rewrite c3, s3, !cos_2a, !sin_2a, s1, c1. clear - circle0 circle.
  split; nsatz.
Qed.

(** A flight along the normal for every [delta] between [PI/4] and [PI/2], with its incidence angle and slope. *)
Theorem slap_flights delta :
  PI / 4 < delta < PI / 2 ->
  let C := cos delta in
  exists h0 h1 t eta,
    off_cusp h0 /\ off_cusp h1 /\ Rabs eta < PI / 2 /\ flight h0 h1 t 0 eta
    /\ cos eta = C * (3 - 4 * C ^ 2)
    /\ a11 (bounce (curvature h0) (curvature h1) t (cos 0) (cos eta) 0) = (1 + C ^ 2) / (2 * C * (1 - 2 * C ^ 2) * (3 - 4 * C ^ 2)).
Proof.
  intros range C. assert (pi := PI_RGT_0).
  assert (C_pos : 0 < C) by (apply cos_gt_0; lra).
  set (S := sin delta). assert (S_pos : 0 < S) by (apply sin_gt_0; lra).
  assert (circle : S * S + C * C = 1) by (generalize (sin2_cos2 delta); unfold Rsqr, S, C; lra).
  assert (C_small : 0 < 1 - 2 * C ^ 2).
  { replace (1 - 2 * C ^ 2) with (sin (2 * delta - PI / 2)).
    - apply sin_gt_0; lra.
    - replace (2 * delta - PI / 2) with (- (PI / 2 - 2 * delta)) by ring. rewrite sin_neg, sin_shift, cos_2a_cos. unfold C. ring. }
  set (T := - (2 * C ^ 3) / (S * (1 - 2 * C ^ 2))).
  set (h0 := atan T). set (h1 := h0 + delta).
  assert (c0_pos : 0 < cos h0) by (unfold h0; destruct (atan_bound T); apply cos_gt_0; lra).
  set (c0 := cos h0) in *.
  assert (s0_is : sin h0 = c0 * T).
  { unfold c0. replace T with (tan h0) at 1 by (unfold h0; apply tan_atan). unfold tan. field. exact (Rgt_not_eq _ _ c0_pos). }
  assert (c1_is : cos h1 = c0 * (C / (1 - 2 * C ^ 2))).
  { unfold h1. rewrite cos_plus. fold c0 C S. rewrite s0_is. unfold T. field. lra. }
  set (c1 := cos h1) in *.
  assert (c1_pos : 0 < c1) by (rewrite c1_is; apply Rmult_lt_0_compat; [assumption | apply Rdiv_lt_0_compat; assumption]).
  assert (h0_range : off_cusp h0) by (unfold h0; destruct (atan_bound T); split; lra).
  assert (h1_range : off_cusp h1).
  { destruct h0_range as [low high]. split; [unfold h1; lra |]. apply Rnot_le_lt. intros beyond.
    assert (cos h1 <= 0) by (apply cos_le_0; unfold h1 in *; lra). fold c1 in H. lra. }
  assert (turn : h1 - h0 = delta) by (unfold h1; ring).
  assert (back : h0 - h1 = - delta) by (unfold h1; ring).
  destruct (chord_components h0 h1) as [n0 s0]. destruct (chord_components h1 h0) as [n1 _].
  rewrite turn in n0, s0. rewrite back, cos_neg, sin_neg in n1. fold C S c0 c1 in n0, s0, n1.
  assert (along : tangential h0 h1 = 0) by (rewrite s0, c1_is; field; lra).
  assert (S2_pos : 0 < S * S) by (apply Rmult_lt_0_compat; assumption).
  assert (c1C : 0 < c1 * C) by (apply Rmult_lt_0_compat; assumption).
  assert (c0C : 0 < c0 * C) by (apply Rmult_lt_0_compat; assumption).
  assert (n0_pos : 0 < normal h0 h1) by (rewrite n0; apply Rmult_lt_0_compat; lra).
  assert (n1_pos : 0 < normal h1 h0) by (rewrite n1; apply Rmult_lt_0_compat; lra).
  assert (flies := flight_exists h0 h1 n0_pos n1_pos).
  assert (straight : angle h0 h1 = 0).
  { unfold angle. rewrite along. replace (0 / normal h0 h1) with 0 by (unfold Rdiv; ring). apply atan_0. }
  rewrite straight in flies. set (t := chord_length h0 h1) in *. set (eta := angle h1 h0) in *.
  exists h0, h1, t, eta.
  assert (t_is := along_normal0 _ _ _ _ _ flies). assert (e_is := along_normal1 _ _ _ _ _ flies).
  rewrite turn, cos_0, Rmult_1_r in t_is. rewrite turn in e_is. fold C S c0 c1 in t_is, e_is.
  assert (t_pos : 0 < t) by apply flies.
  assert (three : 0 < 3 - 4 * C ^ 2) by lra.
  assert (c0_up : c0 + 2 * c1 * C = c0 / (1 - 2 * C ^ 2)) by (rewrite c1_is; field; lra).
  assert (c1_up : c1 + 2 * c0 * C = c0 * (C * (3 - 4 * C ^ 2)) / (1 - 2 * C ^ 2)) by (rewrite c1_is; field; lra).
  rewrite c0_up in t_is. rewrite c1_up in e_is.
  assert (cos_eta : cos eta = C * (3 - 4 * C ^ 2)).
  { apply Rmult_eq_reg_l with t; [| lra]. rewrite e_is, t_is. field. lra. }
  split; [exact h0_range | split; [exact h1_range | split; [| split; [exact flies | split; [exact cos_eta |]]]]].
  - unfold eta, angle. destruct (atan_bound (tangential h1 h0 / normal h1 h0)); apply Rabs_def1; lra.
  - rewrite cos_eta, cos_0. unfold bounce, curvature, radius; cbn [a11]. fold c0. rewrite t_is.
    replace (S * S) with (1 - C * C) by lra. field. lra.
Qed.

Lemma slap_of_cosine C : 0 < C -> 2 * C ^ 2 < 1 -> PI / 4 < acos C < PI / 2.
Proof.
  intros pos small. assert (pi := PI_RGT_0). assert (C < 1) by nra. assert (bound := acos_bound C).
  assert (is : cos (acos C) = C) by (apply cos_acos; lra). split.
  - apply Rnot_le_lt. intros less. assert (root := cos_PI4). assert (r2 : 0 < sqrt 2) by (apply sqrt_lt_R0; lra).
    assert (two : sqrt 2 * sqrt 2 = 2) by (apply sqrt_sqrt; lra).
    assert (cos (PI / 4) <= cos (acos C)) by (apply cos_decr_1; lra). rewrite is, root in H0.
    assert (half : 1 / sqrt 2 * (1 / sqrt 2) = / 2) by (replace (1 / sqrt 2 * (1 / sqrt 2)) with (1 / (sqrt 2 * sqrt 2)) by (field; lra); rewrite two; lra).
    assert (0 < 1 / sqrt 2) by (apply Rdiv_lt_0_compat; lra). nra.
  - apply Rnot_le_lt. intros more. assert (cos (acos C) <= 0) by (apply cos_le_0; lra). lra.
Qed.

(** "[|T0'| > 1] everywhere": on one flight along the normal the slope is 135/161. *)
Theorem slap_is_slow_somewhere :
  exists h0 h1 t eta, off_cusp h0 /\ off_cusp h1 /\ Rabs eta < PI / 2 /\ flight h0 h1 t 0 eta
    /\ a11 (bounce (curvature h0) (curvature h1) t (cos 0) (cos eta) 0) = 135 / 161.
Proof.
  destruct (slap_flights (acos (1 / 3))) as [h0 [h1 [t [eta [r0 [r1 [re [flies [_ slope]]]]]]]]]; [apply slap_of_cosine; lra |].
  exists h0, h1, t, eta. repeat (split; [assumption |]). rewrite slope, cos_acos by lra. field.
Qed.

(** "Phase space is contracted": on one flight with [lam = 1/2] the map expands areas, in [(s, phi)] and in [(s, sin phi)],
    where the second factor is [cos (lam*eta)]. *)
Theorem one_bounce_may_expand_areas :
  exists h0 h1 t eta, off_cusp h0 /\ off_cusp h1 /\ Rabs eta < PI / 2 /\ flight h0 h1 t 0 eta
    /\ let d := det (bounce (curvature h0) (curvature h1) t (cos 0) (cos eta) (1 / 2)) in 1 < d /\ 1 < d * cos (1 / 2 * eta).
Proof.
  destruct (slap_flights (acos (1 / 100))) as [h0 [h1 [t [eta [r0 [r1 [re [flies [cos_eta _]]]]]]]]]; [apply slap_of_cosine; lra |].
  exists h0, h1, t, eta. repeat (split; [assumption |]). cbv zeta.
  rewrite cos_acos in cos_eta by lra.
  assert (pos : 0 < cos eta < 3 / 100) by (rewrite cos_eta; lra).
  rewrite bounce_det, cos_0 by lra.
  assert (large : 16 < 1 / 2 * 1 / cos eta).
  { apply Rmult_lt_reg_r with (cos eta); [lra |]. replace (1 / 2 * 1 / cos eta * cos eta) with (1 / 2) by (field; lra). lra. }
  assert (half : 1 / 2 <= cos (1 / 2 * eta)).
  { assert (pi := PI_RGT_0). apply Rabs_def2 in re. apply Rle_trans with (cos (PI / 3)); [rewrite cos_PI3; lra |].
    destruct (Rle_lt_dec 0 eta).
    - apply cos_decr_1; lra.
    - replace (1 / 2 * eta) with (- (1 / 2 * - eta)) by ring. rewrite cos_neg. apply cos_decr_1; lra. }
  split; [lra | nra].
Qed.
