(** No cycle of the cardioid's pinball map is stable, for any contraction [0 <= lam < 1]. Paper: section 4.1.

    The cone makes the derivative of orbits that stay near a cycle grow without bound, and the boundary is only so long. *)

From Coq Require Import Nsatz Reals Lra Lia Psatz.
From Coquelicot Require Import Coquelicot.
From Pinball Require Import Bounce Cone Cardioid Stretch Cycles Map Landing Near.
Open Scope R_scope.

Section All_stay.

Variable lam : R.
Hypothesis lam_range : 0 <= lam < 1.
Variables H Phi : nat -> R.
Variable eps : R.
Hypothesis steep : forall k, 64 * eps <= Rabs (side (H (S k)) (direction (H k) (Phi k))).
Hypothesis eps_pos : 0 < eps.
Variable delta : R.
Hypothesis delta_pos : 0 < delta.
Hypothesis all_stay : forall u n, Rabs u < delta ->
  exists h phi eta t, near lam H Phi eps n h phi eta t /\ h 0%nat = H 0%nat + u /\ phi 0%nat = Phi 0%nat.

(** That cannot be: the derivative grows without bound, and the boundary has the length 8. *)
Let place_of : nat -> R -> R := place lam H Phi eps.

Lemma not_all_stay : False.
Proof.
  assert (off0 : off_cusp (H 0%nat)).
  { destruct (all_stay 0 0) as [h [phi [eta [t [[[_ [off _]] _] [h0 _]]]]]]; [rewrite Rabs_R0; exact delta_pos |].
    rewrite Rplus_0_r in h0. rewrite <- h0. exact off. }
  assert (c_pos : 0 < cos (H 0%nat)) by (apply cos_pos, off0).
  set (w := Rmin (delta / 2) (cos (H 0%nat) / 2)).
  assert (w_pos : 0 < w) by (unfold w; apply Rmin_pos; lra).
  assert (w_delta : w <= delta / 2) by apply Rmin_l. assert (w_cos : w <= cos (H 0%nat) / 2) by apply Rmin_r.
  assert (angle : 0 < (1 - lam) * PI / 4 < PI).
  { assert (pi := PI_RGT_0). split; [apply Rdiv_lt_0_compat; [apply Rmult_lt_0_compat |]; lra | nra]. }
  set (k := / 4 * sin ((1 - lam) * PI / 4) ^ 4).
  assert (k_pos : 0 < k) by (unfold k; apply Rmult_lt_0_compat; [lra | apply pow_lt, sin_gt_0; lra]).
  assert (g_above : 1 < growth lam) by (apply growth_above_1; lra).
  set (c := k * (4 * (cos (H 0%nat) / 2)) * w).
  assert (c_positive : 0 < c) by (unfold c; apply Rmult_lt_0_compat; [apply Rmult_lt_0_compat |]; lra).
  destruct (Pow_x_infinity (growth lam)) with (b := 9 / c) as [M large]; [rewrite Rabs_right; lra |].
  specialize (large M (Nat.le_refl M)). rewrite Rabs_right in large by (apply Rle_ge, pow_le; lra).
  set (n := S (S M)).
  assert (steady : forall u, 0 <= u <= w -> exists dh, is_derive (place_of n) u dh
    /\ k * growth lam ^ M * (4 * (cos (H 0%nat) / 2)) <= 4 * cos (place_of n u) * dh).
  { intros u range. assert (small : Rabs u < delta) by (rewrite Rabs_right; lra).
    destruct (all_stay u n small) as [h [phi [eta [t from]]]].
    destruct (depends_differentiably lam H Phi eps steep eps_pos delta all_stay n u h phi eta t small from) as [dh [_ [moves [_ [ds_is _]]]]].
    exists dh. split; [exact moves |]. unfold place_of. destruct (place_is lam H Phi eps steep eps_pos delta u n n h phi eta t small from (Nat.le_refl n)) as [-> _].
    rewrite ds_is. destruct from as [[bounces _] [h0 _]].
    assert (stretched := every_orbit_stretches lam h phi eta t n ltac:(lra) bounces n ltac:(unfold n; lia)).
    replace (n - 2)%nat with M in stretched by (unfold n; lia). fold k in stretched.
    assert (start : cos (H 0%nat) / 2 <= cos (h 0%nat)).
    { rewrite h0. assert (near_cos := cos_lipschitz (H 0%nat + u) (H 0%nat)).
      replace (H 0%nat + u - H 0%nat) with u in near_cos by ring. rewrite (Rabs_right u) in near_cos by lra.
      apply Rabs_le_between in near_cos. lra. }
    apply Rmult_le_compat; try lra. apply Rmult_le_pos; [lra | apply pow_le; lra]. }
  destruct (MVT_gen (fun u => 4 * sin (place_of n u)) 0 w (Derive (fun u => 4 * sin (place_of n u)))) as [u [range mean]].
  - intros u. rewrite Rmin_left, Rmax_right by lra. intros range. apply Derive_correct.
    destruct (steady u ltac:(lra)) as [dh [moves _]]. auto_derive. eexists. exact moves.
  - intros u. rewrite Rmin_left, Rmax_right by lra. intros range. apply continuity_pt_filterlim.
    apply (@ex_derive_continuous R_AbsRing R_NormedModule (fun u => 4 * sin (place_of n u)) u).
    destruct (steady u ltac:(lra)) as [dh [moves _]]. auto_derive. eexists. exact moves.
  - rewrite Rmin_left, Rmax_right in range by lra. destruct (steady u range) as [dh [moves fast]].
    assert (slope : Derive (fun u => 4 * sin (place_of n u)) u = 4 * cos (place_of n u) * dh).
    { apply is_derive_unique. auto_derive; [eexists; exact moves |]. known moves. ring. }
    rewrite slope, Rminus_0_r in mean.
    assert (a := SIN_bound (place_of n w)). assert (b := SIN_bound (place_of n 0)).
    assert (nine : 9 <= c * growth lam ^ M).
    { apply Rmult_le_reg_r with (/ c); [apply Rinv_0_lt_compat; exact c_positive |].
      replace (c * growth lam ^ M * / c) with (growth lam ^ M) by (field; lra). unfold Rdiv in large. lra. }
    assert (long : c * growth lam ^ M <= 4 * cos (place_of n u) * dh * w).
    { unfold c. replace (k * (4 * (cos (H 0%nat) / 2)) * w * growth lam ^ M)
        with (k * growth lam ^ M * (4 * (cos (H 0%nat) / 2)) * w) by ring. apply Rmult_le_compat_r; lra. }
    lra.
Qed.

End All_stay.

Lemma least_of_periodic (p : nat -> R) N :
  (0 < N)%nat -> (forall k, p (k + N)%nat = p k) -> (forall k, 0 < p k) -> exists e, 0 < e /\ forall k, e <= p k.
Proof.
  intros some periodic positive.
  assert (first : forall M, exists e, 0 < e /\ forall k, (k < M)%nat -> e <= p k).
  { induction M as [| M [e [e_pos least]]]; [exists 1; split; [lra | lia] |].
    exists (Rmin e (p M)). split; [apply Rmin_pos; auto |]. intros k below.
    destruct (Nat.eq_dec k M) as [-> | other]; [apply Rmin_r | apply Rle_trans with (1 := Rmin_l _ _), least; lia]. }
  destruct (first N) as [e [e_pos least]]. exists e. split; [exact e_pos |].
  assert (all : forall M k, (k < M * N)%nat -> e <= p k).
  { induction M as [| M IH]; intros k below; [lia |].
    destruct (Nat.lt_ge_cases k N) as [less | more]; [apply least, less |].
    replace k with ((k - N) + N)%nat by lia. rewrite periodic. apply IH. simpl in below. lia. }
  intros k. apply (all (S k)). destruct N; [lia |]. simpl. lia.
Qed.

(** * The theorem *)

(** Lyapunov's stability: every start near the cycle's has an orbit, and it stays near the cycle for ever. *)
Definition stable (lam : R) (H Phi : nat -> R) : Prop :=
  forall eps, 0 < eps -> exists delta, 0 < delta /\ forall h0 phi0,
    Rabs (h0 - H 0%nat) < delta -> Rabs (phi0 - Phi 0%nat) < delta -> forall n, exists h phi eta t,
      map_orbit lam h phi eta t n /\ h 0%nat = h0 /\ phi 0%nat = phi0
      /\ forall k, (k <= n)%nat -> Rabs (h k - H k) <= eps /\ Rabs (phi k - Phi k) <= eps.

Theorem no_cycle_is_stable lam H Phi Eta T N :
  0 <= lam < 1 -> (0 < N)%nat -> (forall n, map_orbit lam H Phi Eta T n) ->
  (forall k, H (k + N)%nat = H k /\ Phi (k + N)%nat = Phi k) ->
  ~ stable lam H Phi.
Proof.
  intros range some bounces cycle is_stable.
  set (p := fun k => Rabs (side (H (S k)) (direction (H k) (Phi k))) / 64).
  destruct (least_of_periodic p N some) as [eps [eps_pos least]].
  - intros k. unfold p. replace (S (k + N)) with (S k + N)%nat by lia.
    destruct (cycle k) as [-> ->]. destruct (cycle (S k)) as [-> _]. reflexivity.
  - intros k. unfold p. assert (bounced := map_orbit_is_orbit _ _ _ _ _ _ (bounces (S k))).
    destruct bounced as [_ [_ step]]. destruct (step k) as [off [angle [flies _]]]; [lia |].
    rewrite (flight_side _ _ _ _ _ flies), Rabs_Ropp.
    assert (0 < cos (H (S k))) by (apply cos_pos, off). assert (0 < cos (Eta (S k))) by (apply cos_pos, abs_off_cusp, angle).
    assert (0 < 4 * cos (H (S k)) * cos (Eta (S k))) by (repeat apply Rmult_lt_0_compat; lra).
    rewrite Rabs_right by lra. lra.
  - destruct (is_stable eps eps_pos) as [delta [delta_pos stays]].
    apply (not_all_stay lam range H Phi eps) with (delta := delta); try assumption.
    + intros k. specialize (least k). unfold p in least. lra.
    + intros u n small. destruct (stays (H 0%nat + u) (Phi 0%nat)) with (n := n) as [h [phi [eta [t [orbit_ [h0 [phi0 close]]]]]]].
      * replace (H 0%nat + u - H 0%nat) with u by ring. exact small.
      * unfold Rminus. rewrite Rplus_opp_r, Rabs_R0. exact delta_pos.
      * exists h, phi, eta, t. split; [split; [apply map_orbit_is_orbit, orbit_ | exact close] | split; assumption].
Qed.

(** The orbit between [theta = PI/3] and [theta = -PI/3] is such a cycle. *)
Theorem vertical_orbit_is_not_stable lam : 0 <= lam < 1 -> ~ stable lam swing (fun _ => 0).
Proof.
  intros range. apply (no_cycle_is_stable lam swing (fun _ => 0) (fun _ => 0) (fun _ => 3 * sqrt 3 / 2) 2 range); [lia | |].
  - intros n. apply vertical_orbit.
  - intros k. split; [| reflexivity]. unfold swing. rewrite Nat.even_add. simpl. destruct (Nat.even k); reflexivity.
Qed.
