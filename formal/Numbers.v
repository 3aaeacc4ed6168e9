(** Numbers of the paper, enclosed by the tactic [interval]; existence by the interval Newton theorem. *)

From Coquelicot Require Import Coquelicot.
From Coq Require Import Reals ZArith List Lra Lia Psatz.
From Interval Require Import Tactic.
From Pinball Require Import Newton Jets Checked Boxes Bounce Cardioid Generated Algebra.
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

(** Its equations: the law at [h] and the law at the lower corner. The other two bounces are their mirror images. *)
Definition corner_laws (h lam : R) : Prop :=
  angle h (- corner) = - lam * angle h corner /\ angle corner h = lam * angle (- corner) h.

Definition low : R := 0.12726343566033917125.
Definition high : R := 0.12726343566033917126.

Ltac unfolded := unfold angle, tangential, normal, X, Y, corner in *.

Lemma normals_positive h :
  low <= h <= high ->
  0 < normal corner h /\ 0 < normal h corner /\ 0 < normal h (- corner) /\ 0 < normal (- corner) h.
Proof. intros range. unfold low, high in range. unfolded. repeat split; interval. Qed.

(** ** The equations as formulas, in [h] and [lam] *)

Definition twice_ (b : formula) : formula := Mul (Int 2) b.
Definition X_ (b : formula) : formula := Mul (Add (Int 1) (Cos (twice_ b))) (Cos (twice_ b)).
Definition Y_ (b : formula) : formula := Mul (Add (Int 1) (Cos (twice_ b))) (Sin (twice_ b)).
Definition thrice_ (b : formula) : formula := Mul (Int 3) b.
Definition opposite_ (b : formula) : formula := Mul (Int (-1)) b.
Definition tangential_ (b c : formula) : formula :=
  Add (Mul (opposite_ (Sin (thrice_ b))) (Sub (X_ c) (X_ b))) (Mul (Cos (thrice_ b)) (Sub (Y_ c) (Y_ b))).
Definition normal_ (b c : formula) : formula :=
  Sub (Mul (opposite_ (Cos (thrice_ b))) (Sub (X_ c) (X_ b))) (Mul (Sin (thrice_ b)) (Sub (Y_ c) (Y_ b))).
Definition angle_ (b c : formula) : formula := Atan (Div (tangential_ b c) (normal_ b c)).
Definition corner_ : formula := Div Pi (Int 3).
Definition corner_system : list formula :=
  Add (angle_ (Var 0) (opposite_ corner_)) (Mul (Var 1) (angle_ (Var 0) corner_))
  :: Sub (angle_ corner_ (Var 0)) (Mul (Var 1) (angle_ (opposite_ corner_) (Var 0))) :: nil.

Lemma value_angle x b c : value x (angle_ b c) = angle (value x b) (value x c).
Proof.
  unfold angle_, tangential_, normal_, opposite_, thrice_, X_, Y_, twice_, angle, tangential, normal, X, Y. cbn [value].
  rewrite !(Rmult_comm (-1)). f_equal. f_equal; ring.
Qed.

Lemma corner_system_zero x :
  (forall i, (i < 2)%nat -> value x (nth i corner_system (Int 1)) = 0) <-> corner_laws (x 0%nat) (x 1%nat).
Proof.
  assert (first : value x (nth 0 corner_system (Int 1)) = angle (x 0%nat) (- corner) + x 1%nat * angle (x 0%nat) corner).
  { cbn [nth corner_system value]. rewrite !value_angle. unfold corner_, opposite_, corner. cbn [value].
    replace (-1 * (PI / 3)) with (- (PI / 3)) by ring. reflexivity. }
  assert (second : value x (nth 1 corner_system (Int 1)) = angle corner (x 0%nat) - x 1%nat * angle (- corner) (x 0%nat)).
  { cbn [nth corner_system value]. rewrite !value_angle. unfold corner_, opposite_, corner. cbn [value].
    replace (-1 * (PI / 3)) with (- (PI / 3)) by ring. reflexivity. }
  unfold corner_laws. split.
  - intros zero. assert (z0 := zero 0%nat ltac:(lia)). assert (z1 := zero 1%nat ltac:(lia)). rewrite first in z0.
    rewrite second in z1. split; lra.
  - intros [law1 law2] i below. destruct i as [| [| i]]; [rewrite first; lra | rewrite second; lra | lia].
Qed.

Ltac decimals := change corner_den with 1000000000000000000000000000000%Z; cbn [nth corner_centre corner_radius]; lra.

Definition bits : I.F.precision := I.F.PtoP 130.

(** The laws have exactly one solution in a box of radius 1e-21. *)
Theorem corner_laws_have_one_solution :
  exists h lam,
    Rabs (h - 0.127263435660339171258667522981) <= / 10 ^ 21 /\ Rabs (lam - 0.071217245248915980411597382909) <= / 10 ^ 21
    /\ corner_laws h lam
    /\ forall h' lam',
      Rabs (h' - 0.127263435660339171258667522981) <= / 10 ^ 21 -> Rabs (lam' - 0.071217245248915980411597382909) <= / 10 ^ 21 ->
      corner_laws h' lam' -> h' = h /\ lam' = lam.
Proof.
  assert (boxes : forall x, in_box (middle corner_den corner_centre) (reach 2 corner_den corner_radius) x <->
    Rabs (x 0%nat - 0.127263435660339171258667522981) <= / 10 ^ 21 /\ Rabs (x 1%nat - 0.071217245248915980411597382909) <= / 10 ^ 21
    /\ forall j, (2 <= j)%nat -> x j = 0).
  { intros x.
    assert (m0 : middle corner_den corner_centre 0 = 0.127263435660339171258667522981) by (unfold middle, entry; decimals).
    assert (m1 : middle corner_den corner_centre 1 = 0.071217245248915980411597382909) by (unfold middle, entry; decimals).
    assert (r0 : reach 2 corner_den corner_radius 0 = / 10 ^ 21) by (unfold reach, entry; cbn [Nat.ltb Nat.leb]; decimals).
    assert (r1 : reach 2 corner_den corner_radius 1 = / 10 ^ 21) by (unfold reach, entry; cbn [Nat.ltb Nat.leb]; decimals).
    assert (rest : forall j, (2 <= j)%nat -> middle corner_den corner_centre j = 0 /\ reach 2 corner_den corner_radius j = 0).
    { intros [| [| j]] above; try lia. split; [| reflexivity]. unfold middle, entry. simpl. destruct j; simpl; lra. }
    split.
    - intros inside. assert (i0 := inside 0%nat). assert (i1 := inside 1%nat). rewrite m0, r0 in i0. rewrite m1, r1 in i1.
      split; [exact i0 | split; [exact i1 |]]. intros j above. specialize (inside j). destruct (rest j above) as [m r].
      rewrite m, r in inside. apply Rabs_le_between in inside. lra.
    - intros [i0 [i1 others]] j. destruct j as [| [| j]].
      + rewrite m0, r0. exact i0.
      + rewrite m1, r1. exact i1.
      + destruct (rest (S (S j)) ltac:(lia)) as [m r]. rewrite m, r, others by lia. rewrite Rminus_0_r, Rabs_R0. lra. }
  destruct (checked_zero bits 2 corner_system corner_den corner_centre corner_radius
    corner_matrix_den corner_inverse corner_matrix_den corner_jacobian) as [x [inside [zero alone]]];
    [vm_cast_no_check (eq_refl true) |].
  exists (x 0%nat), (x 1%nat). destruct (proj1 (boxes x) inside) as [b0 [b1 _]].
  split; [exact b0 | split; [exact b1 | split; [exact (proj1 (corner_system_zero x) zero) |]]].
  intros h' lam' c0 c1 laws.
  set (y := fun j : nat => match j with 0%nat => h' | 1%nat => lam' | _ => 0 end).
  assert (same := alone y). split; [apply (same) with (j := 0%nat) | apply (same) with (j := 1%nat)];
    try (apply (proj2 (boxes y)); repeat split; try assumption; intros [| [| j]] above; [lia | lia | reflexivity]);
    exact (proj2 (corner_system_zero y) laws).
Qed.

(** [lambda-star] and [phi-star]: the contraction at which the orbit through both corners exists. *)
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
  destruct corner_laws_have_one_solution as [h [lam [near_h [near_lam [[law back] _]]]]].
  apply Rabs_le_between in near_h, near_lam.
  assert (range : low <= h <= high) by (unfold low, high; lra).
  destruct (normals_positive h range) as [n1 [n2 [n3 n4]]].
  exists lam, h, (angle corner h).
  split; [lra | split; [| split]].
  - clear - range. unfold low, high in range. unfolded. split; interval with (i_prec 120).
  - unfold low, high. lra.
  - exists (chord_length corner h), (chord_length h (- corner)), (angle h (- corner)), (angle h corner), (angle (- corner) h).
    assert (first := flight_exists corner h n1 n2). assert (second := flight_exists h (- corner) n3 n4).
    assert (turned : forall h0 h1, 0 < normal h0 h1 -> 0 < normal h1 h0 ->
      flight (- h0) (- h1) (chord_length h0 h1) (- angle h0 h1) (- angle h1 h0)).
    { intros h0 h1 m0 m1. rewrite <- !mirror_angle.
      replace (chord_length h0 h1) with (chord_length (- h0) (- h1)).
      - apply flight_exists; [destruct (mirror h0 h1) as [_ ->] | destruct (mirror h1 h0) as [_ ->]]; assumption.
      - unfold chord_length. destruct (mirror h0 h1) as [-> ->]. f_equal. ring. }
    assert (third := turned corner h n1 n2). assert (fourth := turned h (- corner) n3 n4).
    rewrite Ropp_involutive in fourth.
    repeat (split; [first [assumption | lra] |]). lra.
Qed.
