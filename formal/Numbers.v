(** Numbers of the paper, enclosed by the tactic [interval]; existence by the intermediate value theorem. *)

From Coq Require Import Reals Ranalysis5 Lra Psatz.
From Coquelicot Require Import Coquelicot.
From Interval Require Import Tactic.
From Pinball Require Import Bounce Cardioid Generated Algebra.
Open Scope R_scope.

Theorem lambda_c_enclosed : 0.093400335431360241 < lambda_c < 0.093400335431360242.
Proof.
  destruct lambda_c_is_a_period_doubling as [<- _]. unfold printed_cuspless_lambda_c. split; interval with (i_prec 90).
Qed.

(** * The orbit through both corners of the cuspless cardioid, where the chaotic attractor is born. Section 5.2

    A corner is the cardioid's point [h = PI/3]: the joins are smooth, so its tangent is the arc's. The orbit leaves the
    upper corner, meets the arc at [h], the lower corner, the arc at [-h], and returns. *)

Definition corner : R := PI / 3.

(** Components of the chord from [h0] to [h1] along the tangent and the inward normal at [h0]. *)
Definition tangential (h0 h1 : R) : R := - sin (3 * h0) * (X h1 - X h0) + cos (3 * h0) * (Y h1 - Y h0).
Definition normal (h0 h1 : R) : R := - cos (3 * h0) * (X h1 - X h0) - sin (3 * h0) * (Y h1 - Y h0).

(** The angle at which the chord to [h1] leaves [h0]; also the one at which the chord from [h1] lands at [h0]. *)
Definition angle (h0 h1 : R) : R := atan (tangential h0 h1 / normal h0 h1).

Definition chord_length (h0 h1 : R) : R := sqrt (normal h0 h1 ^ 2 + tangential h0 h1 ^ 2).

Lemma polar n s : 0 < n -> let t := sqrt (n ^ 2 + s ^ 2) in
  0 < t /\ t * cos (atan (s / n)) = n /\ t * sin (atan (s / n)) = s.
Proof.
  intros n_pos t. assert (square_pos : 0 < n ^ 2 + s ^ 2) by nra.
  assert (t_pos : 0 < t) by (apply sqrt_lt_R0; exact square_pos).
  assert (root : sqrt (1 + (s / n)²) = t / n).
  { unfold Rsqr. replace (1 + s / n * (s / n)) with ((n ^ 2 + s ^ 2) / n ^ 2) by (field; lra).
    rewrite sqrt_div_alt by nra. rewrite sqrt_pow2 by lra. reflexivity. }
  rewrite cos_atan, sin_atan, root. repeat split; [exact t_pos | field; lra | field; lra].
Qed.

Lemma frame_of h : cos (3 * h) * cos (3 * h) + sin (3 * h) * sin (3 * h) = 1.
Proof. generalize (sin2_cos2 (3 * h)). unfold Rsqr. lra. Qed.

Theorem flight_exists h0 h1 :
  0 < normal h0 h1 -> 0 < normal h1 h0 -> flight h0 h1 (chord_length h0 h1) (angle h0 h1) (angle h1 h0).
Proof.
  intros leaves lands.
  destruct (polar _ (tangential h0 h1) leaves) as [t_pos [n0 s0]].
  destruct (polar _ (tangential h1 h0) lands) as [_ [n1 s1]].
  assert (circle0 := frame_of h0). assert (circle1 := frame_of h1).
  set (dx := X h1 - X h0) in *. set (dy := Y h1 - Y h0) in *.
  assert (square0 : normal h0 h1 ^ 2 + tangential h0 h1 ^ 2 = dx ^ 2 + dy ^ 2).
  { unfold normal, tangential. fold dx dy.
    replace (dx ^ 2 + dy ^ 2) with ((cos (3 * h0) * cos (3 * h0) + sin (3 * h0) * sin (3 * h0)) * (dx ^ 2 + dy ^ 2))
      by (rewrite circle0; ring). ring. }
  assert (back_x : X h0 - X h1 = - dx) by (unfold dx; ring).
  assert (back_y : Y h0 - Y h1 = - dy) by (unfold dy; ring).
  assert (square1 : normal h1 h0 ^ 2 + tangential h1 h0 ^ 2 = dx ^ 2 + dy ^ 2).
  { unfold normal, tangential. rewrite back_x, back_y.
    replace (dx ^ 2 + dy ^ 2) with ((cos (3 * h1) * cos (3 * h1) + sin (3 * h1) * sin (3 * h1)) * (dx ^ 2 + dy ^ 2))
      by (rewrite circle1; ring). ring. }
  unfold flight, chord_length, angle. rewrite square0 in *. rewrite square1 in *.
  set (t := sqrt (dx ^ 2 + dy ^ 2)) in *.
  set (phi := atan (tangential h0 h1 / normal h0 h1)) in *. set (eta := atan (tangential h1 h0 / normal h1 h0)) in *.
  fold dx dy. unfold psi.
  replace (3 * h0 + PI / 2 + PI / 2 - phi) with (3 * h0 - phi + PI) by lra.
  replace (3 * h1 + PI / 2 - PI / 2 - eta) with (3 * h1 - eta) by lra.
  rewrite neg_cos, neg_sin, !cos_minus, !sin_minus.
  replace (t * - (cos (3 * h0) * cos phi + sin (3 * h0) * sin phi))
    with (- cos (3 * h0) * (t * cos phi) - sin (3 * h0) * (t * sin phi)) by ring.
  replace (t * - (sin (3 * h0) * cos phi - cos (3 * h0) * sin phi))
    with (- sin (3 * h0) * (t * cos phi) + cos (3 * h0) * (t * sin phi)) by ring.
  replace (t * (cos (3 * h1) * cos eta + sin (3 * h1) * sin eta))
    with (cos (3 * h1) * (t * cos eta) + sin (3 * h1) * (t * sin eta)) by ring.
  replace (t * (sin (3 * h1) * cos eta - cos (3 * h1) * sin eta))
    with (sin (3 * h1) * (t * cos eta) - cos (3 * h1) * (t * sin eta)) by ring.
  rewrite n0, s0, n1, s1. unfold normal, tangential. rewrite back_x, back_y. fold dx dy.
  repeat split; [exact t_pos | | | |].
  - replace dx with ((cos (3 * h0) * cos (3 * h0) + sin (3 * h0) * sin (3 * h0)) * dx) at 1 by (rewrite circle0; ring). ring.
  - replace dy with ((cos (3 * h0) * cos (3 * h0) + sin (3 * h0) * sin (3 * h0)) * dy) at 1 by (rewrite circle0; ring). ring.
  - replace dx with ((cos (3 * h1) * cos (3 * h1) + sin (3 * h1) * sin (3 * h1)) * dx) at 1 by (rewrite circle1; ring). ring.
  - replace dy with ((cos (3 * h1) * cos (3 * h1) + sin (3 * h1) * sin (3 * h1)) * dy) at 1 by (rewrite circle1; ring). ring.
Qed.

Lemma mirror h0 h1 : tangential (- h0) (- h1) = - tangential h0 h1 /\ normal (- h0) (- h1) = normal h0 h1.
Proof.
  unfold tangential, normal, X, Y.
  replace (3 * - h0) with (- (3 * h0)) by ring. replace (2 * - h0) with (- (2 * h0)) by ring.
  replace (2 * - h1) with (- (2 * h1)) by ring. rewrite !cos_neg, !sin_neg. split; ring.
Qed.

Lemma mirror_angle h0 h1 : angle (- h0) (- h1) = - angle h0 h1.
Proof.
  unfold angle. destruct (mirror h0 h1) as [-> ->]. rewrite <- atan_opp. f_equal. unfold Rdiv. ring.
Qed.

(** Zero where the law holds at [h] with the contraction that it needs at the corner. *)
Definition law_defect (h : R) : R :=
  angle h (- corner) * angle corner (- h) - angle corner h * angle h corner.

Definition low : R := 0.12726343566033917125.
Definition high : R := 0.12726343566033917126.

Ltac unfolded := unfold law_defect, angle, tangential, normal, X, Y, corner in *.

Lemma normals_positive h :
  low <= h <= high ->
  0 < normal corner h /\ 0 < normal h corner /\ 0 < normal h (- corner) /\ 0 < normal (- corner) h
  /\ 0 < normal corner (- h).
Proof.
  intros range. unfold low, high in range. unfolded. repeat split; interval.
Qed.

Lemma law_defect_continuous h : low <= h <= high -> continuity_pt law_defect h.
Proof.
  intros range. destruct (normals_positive h range) as [n1 [n2 [n3 [_ n5]]]].
  apply continuity_pt_filterlim. apply (@ex_derive_continuous R_AbsRing R_NormedModule).
  unfolded. auto_derive. repeat split; try (apply Rgt_not_eq; assumption).
Qed.

(** [lambda-star] and [phi-star]: there is a contraction at which the orbit through both corners exists. *)
Theorem corner_orbit :
  exists lam h phi,
    0.071217245248915980 < lam < 0.071217245248915981
    /\ -0.028979473786913960 < phi < -0.028979473786913959
    /\ low < h < high
    /\ exists t0 t1 phi1 eta1 eta2,
      flight corner h t0 phi eta1 /\ phi1 = - lam * eta1
      /\ flight h (- corner) t1 phi1 eta2 /\ - phi = - lam * eta2
      /\ flight (- corner) (- h) t0 (- phi) (- eta1) /\ - phi1 = - lam * - eta1
      /\ flight (- h) corner t1 (- phi1) (- eta2) /\ phi = - lam * - eta2.
Proof.
  assert (order : low < high) by (unfold low, high; lra).
  assert (at_low : law_defect low < 0) by (unfold low; unfolded; interval with (i_prec 120)).
  assert (at_high : 0 < law_defect high) by (unfold high; unfolded; interval with (i_prec 120)).
  destruct (IVT_interv law_defect low high law_defect_continuous order at_low at_high) as [h [range zero]].
  destruct (normals_positive h range) as [n1 [n2 [n3 [n4 n5]]]].
  assert (nonzero : angle corner (- h) < 0 \/ 0 < angle corner (- h)).
  { unfold low, high in range. unfolded. first [left; interval | right; interval]. }
  assert (not0 : angle corner (- h) <> 0) by (destruct nonzero; lra).
  exists (- angle corner h / angle corner (- h)), h, (angle corner h).
  split; [| split; [| split]].
  - clear - range. unfold low, high in range. unfolded. split; interval with (i_prec 120).
  - clear - range. unfold low, high in range. unfolded. split; interval with (i_prec 120).
  - destruct range as [[less | same] [more | same']]; try lra; exfalso; subst; lra.
  - assert (other : angle (- corner) h = - angle corner (- h)).
    { rewrite <- mirror_angle. rewrite Ropp_involutive. reflexivity. }
    exists (chord_length corner h), (chord_length h (- corner)), (angle h (- corner)), (angle h corner), (angle (- corner) h).
    assert (first := flight_exists corner h n1 n2). assert (second := flight_exists h (- corner) n3 n4).
    assert (turned : forall h0 h1, 0 < normal h0 h1 -> 0 < normal h1 h0 ->
      flight (- h0) (- h1) (chord_length h0 h1) (- angle h0 h1) (- angle h1 h0)).
    { intros h0 h1 m0 m1. rewrite <- !mirror_angle.
      replace (chord_length h0 h1) with (chord_length (- h0) (- h1)).
      - apply flight_exists; [destruct (mirror h0 h1) as [_ ->] | destruct (mirror h1 h0) as [_ ->]]; assumption.
      - unfold chord_length. destruct (mirror h0 h1) as [-> ->]. f_equal. ring. }
    assert (third := turned corner h n1 n2). assert (fourth := turned h (- corner) n3 n4).
    rewrite Ropp_involutive in fourth.
    assert (law : angle h (- corner) = - (- angle corner h / angle corner (- h)) * angle h corner).
    { unfold law_defect in zero. apply Rmult_eq_reg_r with (angle corner (- h)); [| exact not0].
      replace (- (- angle corner h / angle corner (- h)) * angle h corner * angle corner (- h))
        with (angle corner h * angle h corner) by (field; exact not0). lra. }
    assert (back : - angle corner h = - (- angle corner h / angle corner (- h)) * angle (- corner) h).
    { rewrite other. field. exact not0. }
    set (lam := - angle corner h / angle corner (- h)) in *. clearbody lam.
    repeat (split; [first [assumption | lra] |]). lra.
Qed.
