(** The cardioid [rho = 1 + cos(theta)] and its chords: every one is longer than defocusing asks. Paper: section 4.

    A boundary point is given by half its polar angle, [h = theta/2], in (-PI/2, PI/2): the cusp is left out. *)

From Coq Require Import Nsatz Reals Lra Psatz.
From Coquelicot Require Import Coquelicot.
Open Scope R_scope.

Definition X (h : R) : R := (1 + cos (2 * h)) * cos (2 * h).
Definition Y (h : R) : R := (1 + cos (2 * h)) * sin (2 * h).
Definition psi (h : R) : R := 3 * h + PI / 2.  (* the direction of the tangent *)
Definition radius (h : R) : R := 4 * cos h / 3.  (* of curvature *)
Definition arc_length (h : R) : R := 4 * sin h.

(** The Frenet equations: the speed is [4*cos(h)], the tangent has direction [psi], and [K = -1/radius]. *)
Theorem frenet h :
  is_derive arc_length h (4 * cos h)
  /\ is_derive X h (4 * cos h * cos (psi h))
  /\ is_derive Y h (4 * cos h * sin (psi h))
  /\ (cos h <> 0 -> is_derive psi h (4 * cos h * - (- / radius h))).
Proof.
  assert (cos3 : cos (psi h) = - (sin (2 * h) * cos h + cos (2 * h) * sin h)).
  { unfold psi. replace (3 * h + PI / 2) with ((2 * h + h) + PI / 2) by ring.
    rewrite cos_plus, cos_PI2, sin_PI2, sin_plus. ring. }
  assert (sin3 : sin (psi h) = cos (2 * h) * cos h - sin (2 * h) * sin h).
  { unfold psi. replace (3 * h + PI / 2) with ((2 * h + h) + PI / 2) by ring.
    rewrite sin_plus, cos_PI2, sin_PI2, cos_plus. ring. }
  assert (circle := sin2_cos2 h). unfold Rsqr in circle.
  rewrite cos3, sin3.
  split; [| split; [| split]].
  - unfold arc_length. auto_derive; trivial.
    ring.
  - unfold X. auto_derive; trivial. clear cos3 sin3. rewrite cos_2a, sin_2a. nsatz.
  - unfold Y. auto_derive; trivial. rewrite cos_2a, sin_2a. nsatz.
  - intros nonzero. unfold psi, radius. auto_derive; trivial. field. exact nonzero.
Qed.

(** A flight from [h0] to [h1]: the chord has length [t], leaves at the angle [phi] from the inward normal, and lands
    at the angle [eta]. That it meets no other part of the boundary is not asked: all chords obey what follows. *)
Definition flight (h0 h1 t phi eta : R) : Prop :=
  0 < t /\ X h1 - X h0 = t * cos (psi h0 + PI / 2 - phi) /\ Y h1 - Y h0 = t * sin (psi h0 + PI / 2 - phi)
  /\ X h1 - X h0 = t * cos (psi h1 - PI / 2 - eta) /\ Y h1 - Y h0 = t * sin (psi h1 - PI / 2 - eta).

(** The chord in the frames of tangent and normal at its ends, with [c = cos(h)] and [delta = h1 - h0]. *)
Section Chord.

Variables h0 h1 t phi eta : R.
Hypothesis flies : flight h0 h1 t phi eta.

Let c0 := cos h0.
Let c1 := cos h1.
Let C := cos (h1 - h0).
Let S := sin (h1 - h0).

Let circle0 : c0 * c0 + sin h0 * sin h0 = 1.
Proof. unfold c0. generalize (sin2_cos2 h0). unfold Rsqr. lra. Qed.

Let circle : C * C + S * S = 1.
Proof. unfold C, S. generalize (sin2_cos2 (h1 - h0)). unfold Rsqr. lra. Qed.

Let c1_is : c1 = c0 * C - sin h0 * S.
Proof. unfold c1, c0, C, S. replace h1 with (h0 + (h1 - h0)) at 1 by ring. apply cos_plus. Qed.

Let s1_is : sin h1 = sin h0 * C + c0 * S.
Proof. unfold c0, C, S. replace h1 with (h0 + (h1 - h0)) at 1 by ring. apply sin_plus. Qed.

Let triple_cos h : cos (3 * h) = cos h * (cos h * cos h - 3 * (sin h * sin h)).
Proof. replace (3 * h) with (2 * h + h) by ring. rewrite cos_plus, cos_2a, sin_2a. ring. Qed.

Let triple_sin h : sin (3 * h) = sin h * (3 * (cos h * cos h) - sin h * sin h).
Proof. replace (3 * h) with (2 * h + h) by ring. rewrite sin_plus, cos_2a, sin_2a. ring. Qed.

Let polar_X h : X h = (1 + (cos h * cos h - sin h * sin h)) * (cos h * cos h - sin h * sin h).
Proof. unfold X. rewrite cos_2a. reflexivity. Qed.

Let polar_Y h : Y h = (1 + (cos h * cos h - sin h * sin h)) * (2 * sin h * cos h).
Proof. unfold Y. rewrite cos_2a, sin_2a. reflexivity. Qed.

(** The direction in the frame of the start, [direction = 3*h0 + PI - phi], and of the landing, [3*h1 - eta]. *)
Let leaves :
  X h1 - X h0 = t * (- cos (3 * h0) * cos phi - sin (3 * h0) * sin phi)
  /\ Y h1 - Y h0 = t * (- sin (3 * h0) * cos phi + cos (3 * h0) * sin phi).
Proof.
  destruct flies as [_ [along [up _]]]. rewrite along, up. unfold psi.
  replace (3 * h0 + PI / 2 + PI / 2 - phi) with (3 * h0 - phi + PI) by lra.
  rewrite neg_cos, neg_sin, cos_minus, sin_minus. split; ring.
Qed.

Let arrives :
  X h1 - X h0 = t * (cos (3 * h1) * cos eta + sin (3 * h1) * sin eta)
  /\ Y h1 - Y h0 = t * (sin (3 * h1) * cos eta - cos (3 * h1) * sin eta).
Proof.
  destruct flies as [_ [_ [_ [along up]]]]. rewrite along, up. unfold psi.
  replace (3 * h1 + PI / 2 - PI / 2 - eta) with (3 * h1 - eta) by lra.
  rewrite cos_minus, sin_minus. split; ring.
Qed.

Let circle3 h : cos (3 * h) * cos (3 * h) + sin (3 * h) * sin (3 * h) = 1.
Proof. generalize (sin2_cos2 (3 * h)). unfold Rsqr. lra. Qed.

Lemma along_normal0 : t * cos phi = 2 * (S * S) * (c0 + 2 * c1 * C).
Proof.
  replace (t * cos phi) with (- cos (3 * h0) * (X h1 - X h0) - sin (3 * h0) * (Y h1 - Y h0)).
  - rewrite triple_cos, triple_sin, !polar_X, !polar_Y. fold c0. fold c1. rewrite s1_is, c1_is. clear - circle0 circle. nsatz.
  - destruct leaves as [-> ->]. generalize (circle3 h0). intros one. nsatz.
Qed.

Lemma along_tangent0 : t * sin phi = 2 * S * (c0 * C + c1 * (2 * (C * C) - 1)).
Proof.
  replace (t * sin phi) with (- sin (3 * h0) * (X h1 - X h0) + cos (3 * h0) * (Y h1 - Y h0)).
  - rewrite triple_cos, triple_sin, !polar_X, !polar_Y. fold c0. fold c1. rewrite s1_is, c1_is. clear - circle0 circle. nsatz.
  - destruct leaves as [-> ->]. generalize (circle3 h0). intros one. nsatz.
Qed.

Lemma along_normal1 : t * cos eta = 2 * (S * S) * (c1 + 2 * c0 * C).
Proof.
  replace (t * cos eta) with (cos (3 * h1) * (X h1 - X h0) + sin (3 * h1) * (Y h1 - Y h0)).
  - rewrite triple_cos, triple_sin, !polar_X, !polar_Y. fold c0. fold c1. rewrite s1_is, c1_is. clear - circle0 circle. nsatz.
  - destruct arrives as [-> ->]. generalize (circle3 h1). intros one. nsatz.
Qed.

Lemma distance : S * S = c0 * c0 + c1 * c1 - 2 * c0 * c1 * C.
Proof. rewrite c1_is. clear - circle0 circle. nsatz. Qed.

Lemma length_squared : t * t = 4 * (S * S) * (c0 * c0 + c1 * c1 + 2 * c0 * c1 * C).
Proof.
  assert (one := sin2_cos2 phi). unfold Rsqr in one.
  replace (t * t) with ((t * sin phi) * (t * sin phi) + (t * cos phi) * (t * cos phi)) by nsatz.
  rewrite along_normal0, along_tangent0. clear - circle. nsatz.
Qed.

(** The defocusing inequality, as an identity: [D0 = radius*cos(phi)] and [d1 = radius*cos(eta)]. *)
Theorem defocusing_identity :
  t * (t - radius h0 * cos phi - radius h1 * cos eta) = 4 / 3 * (S * S) * (S * S).
Proof.
  replace (t * (t - radius h0 * cos phi - radius h1 * cos eta))
    with (t * t - 4 / 3 * c0 * (t * cos phi) - 4 / 3 * c1 * (t * cos eta))
    by (unfold radius; fold c0 c1; field).
  rewrite length_squared, along_normal0, along_normal1, distance. field.
Qed.

End Chord.
