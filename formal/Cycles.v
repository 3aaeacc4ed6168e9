(** Orbits of the cardioid: the theorem, bounce after bounce. Paper: section 4.1. *)

From Coq Require Import Reals Lra Lia Psatz.
From Coquelicot Require Import Coquelicot.
From Pinball Require Import Bounce Cone Cardioid Stretch.
Open Scope R_scope.

Definition curvature (h : R) : R := - / radius h.

Section Orbit.

Variable lam : R.
Variables h phi eta t : nat -> R.
Variable N : nat.  (* bounces of this piece of orbit *)

(** Bounce [n+1] follows bounce [n] by a chord between points off the cusp, and the law [phi = -lam*eta] holds. *)
Definition orbit : Prop :=
  Rabs (phi 0%nat) < PI / 2 /\ off_cusp (h 0%nat) /\
  forall n, (n < N)%nat ->
    off_cusp (h (S n)) /\ Rabs (eta (S n)) < PI / 2 /\
    flight (h n) (h (S n)) (t n) (phi n) (eta (S n)) /\ phi (S n) = - lam * eta (S n).

(** The derivative of the n-th iterate of the map, in arc length and exit angle ([Bounce.derivative_matrix]). *)
Fixpoint derivative (n : nat) : matrix :=
  match n with
  | O => identity
  | S m =>
      product (bounce (curvature (h m)) (curvature (h (S m))) (t m) (cos (phi m)) (cos (eta (S m))) lam) (derivative m)
  end.

Hypothesis lam_range : 0 <= lam <= 1.
Hypothesis bounces : orbit.

Lemma leaves_steeply n : (n < N)%nat -> Rabs (phi (S n)) <= lam * PI / 2.
Proof.
  intros below. destruct bounces as [_ [_ step]]. destruct (step n below) as [_ [range [_ law]]].
  rewrite law, Rabs_mult, Rabs_Ropp, (Rabs_right lam) by lra. nra.
Qed.

Lemma leaves n : (n <= N)%nat -> Rabs (phi n) < PI / 2.
Proof.
  intros upto. destruct bounces as [start [_ step]]. destruct n as [| n]; [exact start |].
  destruct (step n) as [_ [range [_ law]]]; [lia |].
  rewrite law, Rabs_mult, Rabs_Ropp, (Rabs_right lam) by lra.
  assert (0 <= Rabs (eta (S n))) by apply Rabs_pos. nra.
Qed.

Lemma stays n : (n <= N)%nat -> off_cusp (h n).
Proof. intros upto. destruct bounces as [_ [start step]]. destruct n as [| n]; [exact start | apply step; lia]. Qed.

Lemma radius_pos n : (n <= N)%nat -> 0 < radius (h n).
Proof. intros upto. unfold radius. assert (0 < cos (h n)) by (apply cos_pos, stays, upto). lra. Qed.

Definition gain_at (n : nat) : R := gain (radius (h n)) (radius (h (S n))) (t n) (cos (phi n)) (cos (eta (S n))).

(** The hypotheses of a lemma on one flight, from those on the orbit. *)
Ltac facts := try assumption; first [apply stays; lia | apply leaves; lia | apply leaves_steeply; lia].

Section Direction.

Variables ds dphi : R.
Hypothesis starts_in_cone : cone lam (radius (h 0%nat)) ds dphi.

Definition moved_s (n : nat) : R := a11 (derivative n) * ds + a12 (derivative n) * dphi.
Definition moved_phi (n : nat) : R := a21 (derivative n) * ds + a22 (derivative n) * dphi.

Lemma step_of_cone n :
  (n < N)%nat -> cone lam (radius (h n)) (moved_s n) (moved_phi n) ->
  cone lam (radius (h (S n))) (moved_s (S n)) (moved_phi (S n))
  /\ gain_at n * (moved_s n / radius (h n)) <= moved_s (S n) / radius (h (S n)).
Proof.
  intros below inside.
  destruct bounces as [_ [_ step]]. destruct (step n below) as [lands [range [flies law]]].
  assert (taken := cone_invariant (radius (h n)) (radius (h (S n))) (t n) (cos (phi n)) (cos (eta (S n))) lam
    (moved_s n) (moved_phi n)).
  cbv zeta in taken.
  unfold gain_at.
  set (m := bounce (- / radius (h n)) (- / radius (h (S n))) (t n) (cos (phi n)) (cos (eta (S n))) lam) in *.
  replace (moved_s (S n)) with (a11 m * moved_s n + a12 m * moved_phi n).
  replace (moved_phi (S n)) with (a21 m * moved_s n + a22 m * moved_phi n).
  2, 3: unfold moved_s, moved_phi; cbn [derivative]; unfold curvature; fold m; unfold product; cbn [a11 a12 a21 a22]; ring.
  apply taken; try assumption.
  - apply lam_range.
  - apply radius_pos; lia.
  - apply radius_pos; lia.
  - apply cos_pos, abs_off_cusp, leaves; lia.
  - apply cos_pos, abs_off_cusp, range.
  - left. apply (defocusing _ _ _ _ _ flies); facts.
Qed.

Lemma growth_pos : 1 <= growth lam.
Proof.
  rewrite growth_is by exact lam_range. assert (0 <= tan ((1 - lam) * PI / 8) ^ 2) by apply pow2_ge_0. lra.
Qed.

(** Every direction of the cone stays in the cones, and its [ds/radius] grows by [growth lam] at each bounce but the
    first, where it grows by the gain of that flight. *)
Theorem invariant_cone n :
  (n <= N)%nat ->
  cone lam (radius (h n)) (moved_s n) (moved_phi n)
  /\ ((0 < n)%nat -> gain_at 0 * growth lam ^ (n - 1) * (ds / radius (h 0%nat)) <= moved_s n / radius (h n)).
Proof.
  induction n as [| n IH]; intros upto.
  - split; [| lia]. unfold moved_s, moved_phi; simpl.
    replace (1 * ds + 0 * dphi) with ds by ring. replace (0 * ds + 1 * dphi) with dphi by ring. exact starts_in_cone.
  - destruct IH as [inside grown]; [lia |].
    destruct (step_of_cone n) as [next wider]; [lia | exact inside |]. split; [exact next |]. intros _.
    apply Rle_trans with (2 := wider).
    destruct n as [| n].
    + simpl. unfold moved_s; simpl. right. replace (1 * ds + 0 * dphi) with ds by ring. ring.
    + specialize (grown ltac:(lia)).
      replace (S (S n) - 1)%nat with (S (S n - 1)) by lia. rewrite <- tech_pow_Rmult.
      assert (enough : growth lam <= gain_at (S n)).
      { destruct bounces as [_ [_ step]]. destruct (step (S n)) as [lands [range [flies law]]]; [lia |].
        apply (gain_at_least_growth _ _ _ _ _ flies); facts. }
      assert (one := growth_pos).
      assert (length_pos : 0 < moved_s (S n) / radius (h (S n))).
      { apply Rdiv_lt_0_compat; [apply inside | apply radius_pos; lia]. }
      apply Rle_trans with (growth lam * (moved_s (S n) / radius (h (S n)))).
      * apply Rle_trans with (growth lam * (gain_at 0 * growth lam ^ (S n - 1) * (ds / radius (h 0%nat)))).
        -- right. ring.
        -- apply Rmult_le_compat_l; lra.
      * apply Rmult_le_compat_r; lra.
Qed.

End Direction.

Lemma first_gain : (0 < N)%nat -> 1 < gain_at 0.
Proof.
  intros some. destruct bounces as [_ [_ step]]. destruct (step 0%nat some) as [lands [range [flies law]]].
  apply (gain_above_1 _ _ _ _ _ flies); facts.
Qed.

(** What [symbolic.cycles.defocusing.least_stretch] says: the vector (1, 0) is stretched exponentially, on every orbit. *)
Theorem every_orbit_stretches n :
  (2 <= n <= N)%nat ->
  / 4 * sin ((1 - lam) * PI / 4) ^ 4 * growth lam ^ (n - 2) <= a11 (derivative n).
Proof.
  intros [two upto].
  assert (inside0 : cone lam (radius (h 0%nat)) 1 0).
  { assert (0 < radius (h 0%nat)) by (apply radius_pos; lia). unfold cone. lra. }
  destruct n as [| [| n]]; [lia | lia |].
  destruct (invariant_cone 1 0 inside0 (S n)) as [inside grown]; [lia |]. specialize (grown ltac:(lia)).
  replace (S n - 1)%nat with n in grown by lia. replace (S (S n) - 2)%nat with n by lia.
  assert (one := first_gain ltac:(lia)).
  assert (power : 0 < growth lam ^ n) by (apply pow_lt; generalize growth_pos; lra).
  assert (r0 : / radius (h 0%nat) >= 3 / 4).
  { unfold radius. assert (0 < cos (h 0%nat)) by (apply cos_pos, stays; lia).
    assert (cos (h 0%nat) <= 1) by apply COS_bound.
    replace (/ (4 * cos (h 0%nat) / 3)) with (3 / 4 * / cos (h 0%nat)) by (field; lra).
    assert (1 <= / cos (h 0%nat)) by (rewrite <- Rinv_1; apply Rinv_le_contravar; lra). lra. }
  assert (long : 3 / 4 * growth lam ^ n <= moved_s 1 0 (S n) / radius (h (S n))).
  { apply Rle_trans with (2 := grown).
    replace (gain_at 0 * growth lam ^ n * (1 / radius (h 0%nat)))
      with (growth lam ^ n * (gain_at 0 * / radius (h 0%nat))) by (unfold Rdiv; ring).
    assert (3 / 4 <= gain_at 0 * / radius (h 0%nat)) by nra. nra. }
  destruct (step_of_cone 1 0 (S n)) as [_ wider]; [lia | exact inside |].
  destruct bounces as [_ [_ step]]. destruct (step (S n)) as [lands [range [flies law]]]; [lia |].
  assert (advance : / 3 * sin ((1 - lam) * PI / 4) ^ 4 <= t (S n) - radius (h (S n)) * cos (phi (S n))).
  { apply (advance_at_least _ _ _ _ _ flies); facts. }
  assert (r2 : 0 < radius (h (S (S n)))) by (apply radius_pos; lia).
  assert (eta_pos : 0 < cos (eta (S (S n)))) by (apply cos_pos, abs_off_cusp, range).
  assert (eta_le : cos (eta (S (S n))) <= 1) by apply COS_bound.
  replace (a11 (derivative (S (S n)))) with (moved_s 1 0 (S (S n))) by (unfold moved_s; ring).
  set (x := moved_s 1 0 (S n) / radius (h (S n))) in *.
  set (y := moved_s 1 0 (S (S n))) in *.
  unfold gain_at, gain in wider.
  set (D := t (S n) - radius (h (S n)) * cos (phi (S n))) in *.
  assert (quartic : 0 <= sin ((1 - lam) * PI / 4) ^ 4).
  { replace (sin ((1 - lam) * PI / 4) ^ 4) with ((sin ((1 - lam) * PI / 4) ^ 2) ^ 2) by ring. apply pow2_ge_0. }
  set (q := sin ((1 - lam) * PI / 4) ^ 4) in *.
  assert (D_x : D * x <= y * cos (eta (S (S n)))).
  { apply Rmult_le_reg_r with (/ (radius (h (S (S n))) * cos (eta (S (S n))))); [apply Rinv_0_lt_compat; nra |].
    replace (y * cos (eta (S (S n))) * / (radius (h (S (S n))) * cos (eta (S (S n))))) with (y / radius (h (S (S n))))
      by (field; lra).
    apply Rle_trans with (2 := wider). right. field. lra. }
  assert (least : / 3 * q * (3 / 4 * growth lam ^ n) <= D * x) by (apply Rmult_le_compat; nra).
  assert (0 <= y).
  { assert (0 <= y * cos (eta (S (S n)))).
    { apply Rle_trans with (2 := D_x). apply Rle_trans with (2 := least). nra. }
    nra. }
  nra.
Qed.

(** A cycle: the piece of orbit closes. *)
Hypothesis some_bounces : (0 < N)%nat.
Hypothesis closes : h N = h 0%nat /\ phi N = phi 0%nat.

Lemma cycle_gain : growth lam <= gain_at 0.
Proof.
  destruct bounces as [_ [_ step]]. destruct (step 0%nat some_bounces) as [lands [range [flies law]]].
  apply (gain_at_least_growth _ _ _ _ _ flies); try assumption; try (apply stays; lia); try (apply leaves; lia).
  destruct closes as [_ <-]. replace N with (S (N - 1)) by lia. apply leaves_steeply. lia.
Qed.

(** Every cycle has a real multiplier above 1, at least [growth lam] for each bounce, and its direction lies in the
    cone. At [lam = 1] the bound is [1 < mu]. *)
Theorem every_cycle_is_unstable :
  exists slope mu : R,
    let m := derivative N in
    a11 m * 1 + a12 m * slope = mu * 1 /\ a21 m * 1 + a22 m * slope = mu * slope
    /\ cone lam (radius (h 0%nat)) 1 slope
    /\ characteristic m mu = 0 /\ 1 < mu /\ growth lam ^ N <= mu.
Proof.
  set (m := derivative N). set (r := radius (h 0%nat)).
  assert (r_pos : 0 < r) by (apply radius_pos; lia).
  assert (inside : forall x, - lam / r <= x <= 0 -> cone lam r 1 x).
  { intros x [low high]. unfold cone. repeat split; [lra | | nra].
    apply Rmult_le_compat_l with (r := r) in low; [| lra].
    replace (r * (- lam / r)) with (- lam) in low by (field; lra). lra. }
  assert (image : forall x, - lam / r <= x <= 0 ->
    cone lam r (a11 m + a12 m * x) (a21 m + a22 m * x)
    /\ gain_at 0 * growth lam ^ (N - 1) <= a11 m + a12 m * x).
  { intros x range. destruct (invariant_cone 1 x (inside x range) N) as [stay grown]; [lia |].
    specialize (grown some_bounces). unfold moved_s, moved_phi in *.
    destruct closes as [back _]. rewrite back in *. fold m in stay, grown. fold r in stay, grown.
    rewrite !Rmult_1_r in *. split; [exact stay |].
    apply Rmult_le_reg_r with (/ r); [apply Rinv_0_lt_compat; lra |].
    replace (gain_at 0 * growth lam ^ (N - 1) * / r) with (gain_at 0 * growth lam ^ (N - 1) * (1 / r)) by (field; lra).
    exact grown. }
  set (turn := fun x : R => (a21 m + a22 m * x) - x * (a11 m + a12 m * x)).
  assert (low_end : - lam / r <= 0).
  { unfold Rdiv. assert (0 < / r) by (apply Rinv_0_lt_compat; lra). nra. }
  assert (found : exists x, (- lam / r <= x <= 0) /\ turn x = 0).
  { assert (at_low : 0 <= turn (- lam / r)).
    { destruct (image (- lam / r)) as [[_ [least _]] _]; [lra |]. unfold turn.
      set (p := a11 m + a12 m * (- lam / r)) in *. set (q := a21 m + a22 m * (- lam / r)) in *.
      apply Rmult_le_reg_l with r; [lra |]. rewrite Rmult_0_r.
      replace (r * (q - - lam / r * p)) with (r * q + lam * p) by (field; lra). lra. }
    assert (at_high : turn 0 <= 0).
    { destruct (image 0) as [[_ [_ most]] _]; [lra |]. unfold turn. nra. }
    assert (continuous : continuity (fun x => - turn x)).
    { unfold turn. intros x. apply derivable_continuous_pt. reg. }
    destruct (Rle_lt_or_eq_dec _ _ low_end) as [less | same].
    - destruct (Rle_lt_or_eq_dec _ _ at_low) as [positive | zero].
      + destruct (Rle_lt_or_eq_dec _ _ at_high) as [negative | zero].
        * destruct (IVT (fun x => - turn x) (- lam / r) 0 continuous less ltac:(simpl; lra) ltac:(simpl; lra))
            as [x [range root]].
          exists x. split; [exact range | lra].
        * exists 0. split; [lra | exact zero].
      + exists (- lam / r). split; [lra | now symmetry].
    - exists 0. split; [lra |]. rewrite same in at_low. lra. }
  destruct found as [x [range root]]. destruct (image x range) as [_ large].
  exists x, (a11 m + a12 m * x).
  assert (one := growth_pos). assert (first := first_gain some_bounces). assert (steep := cycle_gain).
  assert (power : 1 <= growth lam ^ (N - 1)) by (apply pow_R1_Rle; lra).
  unfold turn in root.
  split; [ring |]. split; [lra |]. split; [exact (inside x range) |]. split; [| split].
  - unfold characteristic, trace, det.
    replace ((a11 m + a12 m * x) ^ 2 - (a11 m + a22 m) * (a11 m + a12 m * x) + (a11 m * a22 m - a12 m * a21 m))
      with (- a12 m * (a21 m + a22 m * x - x * (a11 m + a12 m * x))) by ring.
    rewrite root. ring.
  - nra.
  - apply Rle_trans with (2 := large). replace N with (S (N - 1)) at 1 by lia.
    rewrite <- tech_pow_Rmult. apply Rmult_le_compat_r; [lra | exact steep].
Qed.

End Orbit.
