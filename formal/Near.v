(** Orbits that stay near a cycle of the cardioid depend differentiably on their start, with the derivative of [Cycles]. *)

From Coq Require Import Nsatz Reals Lra Lia Psatz.
From Coquelicot Require Import Coquelicot.
From Pinball Require Import Bounce Cone Cardioid Stretch Cycles Map Landing.
Open Scope R_scope.

Section Near.

Variable lam : R.
Hypothesis lam_range : 0 <= lam < 1.
Variables H Phi : nat -> R.  (* the cycle *)
Variable eps : R.
Hypothesis steep : forall k, 64 * eps <= Rabs (side (H (S k)) (direction (H k) (Phi k))).
Hypothesis eps_pos : 0 < eps.

Definition near (n : nat) (h phi eta t : nat -> R) : Prop :=
  orbit lam h phi eta t n /\ forall k, (k <= n)%nat -> Rabs (h k - H k) <= eps /\ Rabs (phi k - Phi k) <= eps.

Lemma near_prefix n m h phi eta t : (m <= n)%nat -> near n h phi eta t -> near m h phi eta t.
Proof.
  intros less [[range [off step]] close]. split; [| intros; apply close; lia].
  split; [exact range | split; [exact off |]]. intros k below. apply step. lia.
Qed.

Lemma direction_near h0 phi0 g0 f0 : Rabs (direction h0 phi0 - direction g0 f0) <= 3 * Rabs (h0 - g0) + Rabs (phi0 - f0).
Proof.
  unfold direction, psi.
  replace (3 * h0 + PI / 2 + PI / 2 - phi0 - (3 * g0 + PI / 2 + PI / 2 - f0)) with (3 * (h0 - g0) + - (phi0 - f0)) by ring.
  apply Rle_trans with (1 := Rabs_triang _ _). rewrite Rabs_Ropp, Rabs_mult, (Rabs_right 3) by lra. lra.
Qed.

Lemma side_large k y h0 phi0 :
  Rabs (y - H (S k)) <= eps -> Rabs (h0 - H k) <= eps -> Rabs (phi0 - Phi k) <= eps ->
  32 * eps <= Rabs (side y (direction h0 phi0)).
Proof.
  intros near_y near_h near_phi. assert (reference := steep k).
  assert (moved := side_lipschitz y (direction h0 phi0) (H (S k)) (direction (H k) (Phi k))).
  assert (turned := direction_near h0 phi0 (H k) (Phi k)).
  assert (back := Rabs_triang (side y (direction h0 phi0)) (side (H (S k)) (direction (H k) (Phi k)) - side y (direction h0 phi0))).
  replace (side y (direction h0 phi0) + (side (H (S k)) (direction (H k) (Phi k)) - side y (direction h0 phi0)))
    with (side (H (S k)) (direction (H k) (Phi k))) in back by ring.
  rewrite (Rabs_minus_sym (side (H (S k)) _)) in back. lra.
Qed.

Lemma between_near a b c xi : Rabs (a - c) <= eps -> Rabs (b - c) <= eps ->
  Rabs (xi - b) <= Rabs (a - b) -> Rabs (xi - a) <= Rabs (a - b) -> Rabs (xi - c) <= eps.
Proof.
  intros ha hb hx hy. apply Rabs_le_between in ha, hb. apply Rabs_le_between.
  destruct (Rle_lt_dec b a).
  - rewrite (Rabs_right (a - b)) in hx, hy by lra. apply Rabs_le_between in hx, hy. lra.
  - rewrite (Rabs_left (a - b)) in hx, hy by lra. apply Rabs_le_between in hx, hy. lra.
Qed.

(** Near the cycle an orbit is known by its start. *)
Lemma same_orbit n h phi eta t h' phi' eta' t' :
  near n h phi eta t -> near n h' phi' eta' t' -> h 0%nat = h' 0%nat -> phi 0%nat = phi' 0%nat ->
  forall k, (k <= n)%nat -> h k = h' k /\ phi k = phi' k.
Proof.
  intros [[_ [_ step]] close] [[_ [_ step']] close'] h0 phi0. induction k as [| k IH]; intros upto; [split; assumption |].
  destruct IH as [same_h same_phi]; [lia |].
  destruct (step k) as [_ [range [flies law]]]; [lia |]. destruct (step' k) as [_ [range' [flies' law']]]; [lia |].
  rewrite <- same_h, <- same_phi in flies'.
  assert (landing : h (S k) = h' (S k)).
  { destruct (secant (h k) (phi k) (h (S k)) (h' (S k))) as [xi [x1 [x2 mean]]].
    rewrite (flight_hits _ _ _ _ _ flies), (flight_hits _ _ _ _ _ flies') in mean.
    assert (xi_near : Rabs (xi - H (S k)) <= eps).
    { apply (between_near (h (S k)) (h' (S k))); [apply close; lia | apply close'; lia | exact x1 | exact x2]. }
    assert (large := side_large k xi (h k) (phi k) xi_near (proj1 (close k ltac:(lia))) (proj2 (close k ltac:(lia)))).
    rewrite Rminus_0_r in mean. symmetry in mean. apply Rmult_integral in mean. destruct mean as [zero | zero]; [| lra].
    rewrite zero, Rabs_R0 in large. lra. }
  split; [exact landing |]. rewrite law, law'. f_equal.
  destruct (flight_turns _ _ _ _ _ flies) as [c1 s1]. destruct (flight_turns _ _ _ _ _ flies') as [c2 s2].
  rewrite <- landing in c2, s2. apply (same_angle (psi (h (S k)) - PI / 2)); try assumption; congruence.
Qed.

(** * Suppose that every start on a short segment stays near for ever *)

Variable delta : R.
Hypothesis delta_pos : 0 < delta.
Hypothesis all_stay : forall u n, Rabs u < delta ->
  exists h phi eta t, near n h phi eta t /\ h 0%nat = H 0%nat + u /\ phi 0%nat = Phi 0%nat.

Definition starts (u : R) (n : nat) (h phi eta t : nat -> R) : Prop :=
  near n h phi eta t /\ h 0%nat = H 0%nat + u /\ phi 0%nat = Phi 0%nat.

(** The point and the angle after [n] bounces, as functions of the start. *)
Definition place (n : nat) (u : R) : R :=
  @iota R_CompleteNormedModule (fun y => exists h phi eta t, starts u n h phi eta t /\ h n = y).
Definition aim (n : nat) (u : R) : R :=
  @iota R_CompleteNormedModule (fun y => exists h phi eta t, starts u n h phi eta t /\ phi n = y).

Lemma place_is u n m h phi eta t :
  Rabs u < delta -> starts u m h phi eta t -> (n <= m)%nat -> place n u = h n /\ aim n u = phi n.
Proof.
  intros small [close [h0 phi0]] upto. assert (prefix := near_prefix m n h phi eta t upto close).
  assert (only : forall g f e s, starts u n g f e s -> g n = h n /\ f n = phi n).
  { intros g f e s [close' [g0 f0]]. destruct (same_orbit n g f e s h phi eta t close' prefix) with (k := n) as [a b];
      [congruence | congruence | lia | split; assumption]. }
  split.
  - assert (found := @iota_correct R_AbsRing R_CompleteNormedModule
      (fun y => exists h phi eta t, starts u n h phi eta t /\ h n = y)). destruct found as [g [f [e [s [from is]]]]].
    + exists (h n). split; [exists h, phi, eta, t; split; [split; [exact prefix | split; assumption] | reflexivity] |].
      intros y [g [f [e [s [from is]]]]]. rewrite <- is. symmetry. apply (only _ _ _ _ from).
    + exact (eq_trans (eq_sym is) (proj1 (only _ _ _ _ from))).
  - assert (found := @iota_correct R_AbsRing R_CompleteNormedModule
      (fun y => exists h phi eta t, starts u n h phi eta t /\ phi n = y)). destruct found as [g [f [e [s [from is]]]]].
    + exists (phi n). split; [exists h, phi, eta, t; split; [split; [exact prefix | split; assumption] | reflexivity] |].
      intros y [g [f [e [s [from is]]]]]. rewrite <- is. symmetry. apply (only _ _ _ _ from).
    + exact (eq_trans (eq_sym is) (proj2 (only _ _ _ _ from))).
Qed.

Lemma still_small u : Rabs u < delta -> locally u (fun v => Rabs v < delta).
Proof.
  intros small. assert (room : 0 < delta - Rabs u) by lra. exists (mkposreal _ room). intros v close.
  assert (bound : Rabs (v - u) < delta - Rabs u) by exact close.
  replace v with ((v - u) + u) by ring. apply Rle_lt_trans with (1 := Rabs_triang _ _). lra.
Qed.

(** The derivative after [n] bounces is that of [Cycles]. *)
Lemma depends_differentiably n : forall u h phi eta t, Rabs u < delta -> starts u n h phi eta t ->
  exists dh dphi, is_derive (place n) u dh /\ is_derive (aim n) u dphi
    /\ 4 * cos (h n) * dh = a11 (derivative lam h phi eta t n) * (4 * cos (h 0%nat))
    /\ dphi = a21 (derivative lam h phi eta t n) * (4 * cos (h 0%nat)).
Proof.
  induction n as [| n IH]; intros u h phi eta t small from.
  - exists 1, 0. split; [| split; [| split]].
    + apply (is_derive_ext_loc (fun v => H 0%nat + v)); [| auto_derive; trivial].
      apply (filter_imp (fun v => Rabs v < delta)); [| exact (still_small u small)].
      intros v less. destruct (all_stay v 0 less) as [g [f [e [s [close [g0 f0]]]]]].
      destruct (place_is v 0 0 g f e s less) as [-> _]; [split; [exact close | split; assumption] | lia | symmetry; exact g0].
    + apply (is_derive_ext_loc (fun _ => Phi 0%nat)); [| auto_derive; trivial].
      apply (filter_imp (fun v => Rabs v < delta)); [| exact (still_small u small)].
      intros v less. destruct (all_stay v 0 less) as [g [f [e [s [close [g0 f0]]]]]].
      destruct (place_is v 0 0 g f e s less) as [_ ->]; [split; [exact close | split; assumption] | lia | symmetry; exact f0].
    + simpl. ring.
    + simpl. ring.
  - assert (from' : starts u n h phi eta t).
    { destruct from as [close rest]. split; [apply (near_prefix (S n)); [lia | exact close] | exact rest]. }
    destruct (IH u h phi eta t small from') as [dh [dphi [moves_h [moves_phi [ds_is dphi_is]]]]].
    destruct (place_is u n (S n) h phi eta t small from ltac:(lia)) as [a_u b_u].
    destruct (place_is u (S n) (S n) h phi eta t small from ltac:(lia)) as [f_u c_u].
    assert (from_ := from). destruct from_ as [[[range0 [off0 step]] close] [h0_is phi0_is]].
    destruct (step n) as [off1 [range [flies law]]]; [lia |].
    assert (turning : is_derive (fun v => direction (place n v) (aim n v)) u (3 * dh - dphi)).
    { unfold direction, psi. auto_derive; [split; [eexists; exact moves_h | split; [eexists; exact moves_phi | trivial]] |].
      known moves_h. known moves_phi. ring. }
    set (d := direction (h n) (phi n)).
    assert (d_is : direction (place n u) (aim n u) = d) by (rewrite a_u, b_u; reflexivity).
    set (g1 := - (4 * cos (h n) * cos (psi (h n)) * dh) * sin d + (X (h (S n)) - X (h n)) * (cos d * (3 * dh - dphi))
      + (4 * cos (h n) * sin (psi (h n)) * dh) * cos d + (Y (h (S n)) - Y (h n)) * (sin d * (3 * dh - dphi))).
    set (g2 := side (h (S n)) d).
    assert (others : forall v, Rabs v < delta -> exists g f e s, starts v (S n) g f e s /\ place n v = g n /\ aim n v = f n
      /\ place (S n) v = g (S n) /\ aim (S n) v = f (S n)).
    { intros v less. destruct (all_stay v (S n) less) as [g [f [e [s from_v]]]].
      destruct (place_is v n (S n) g f e s less from_v ltac:(lia)) as [p1 p2].
      destruct (place_is v (S n) (S n) g f e s less from_v ltac:(lia)) as [p3 p4].
      exists g, f, e, s. split; [exact from_v | split; [exact p1 | split; [exact p2 | split; [exact p3 | exact p4]]]]. }
    assert (landing : is_derive (place (S n)) u (- g1 / g2)).
    { apply (implicit_derivative (fun v y => miss (place n v) y (aim n v)) (place (S n)) u g1 g2 (32 * eps)).
      - lra.
      - unfold g2, d. apply side_large with n; [apply close; lia | apply close; lia | apply close; lia].
      - rewrite f_u. unfold miss.
        destruct (frenet (h n)) as [_ [along [up _]]]. rewrite <- a_u in along, up.
        assert (turning' := turning). unfold direction in turning'.
        set (dir := fun v => direction (place n v) (aim n v)) in *.
        change (is_derive (fun v => (X (h (S n)) - X (place n v)) * sin (dir v) - (Y (h (S n)) - Y (place n v)) * cos (dir v)) u g1).
        assert (turning'' : is_derive dir u (3 * dh - dphi)) by exact turning.
        assert (dir_u : dir u = d) by exact d_is. clearbody dir. clear turning turning'.
        auto_derive.
        + repeat split; eexists; eassumption.
        + known along. known up. known moves_h. known turning''. rewrite dir_u, a_u. unfold g1. ring.
      - apply (filter_imp (fun v => Rabs v < delta)); [| exact (still_small u small)].
        intros v less. destruct (others v less) as [g [f [e [s [[[[_ [_ step_v]] _] _] [-> [-> [-> _]]]]]]]].
        destruct (step_v n) as [_ [_ [flies_v _]]]; [lia |]. exact (flight_hits _ _ _ _ _ flies_v).
      - intros error error_pos.
        assert (continuous : continuous (fun v => direction (place n v) (aim n v)) u).
        { apply (@ex_derive_continuous R_AbsRing R_NormedModule (fun v => direction (place n v) (aim n v)) u).
          eexists. exact turning. }
        assert (part : 0 < error / 16) by lra.
        destruct (continuous (fun y => Rabs (y - direction (place n u) (aim n u)) < error / 16)) as [d1 close1].
        { exists (mkposreal _ part). intros y near_y. exact near_y. }
        destruct (still_small u small) as [d2 close2].
        exists (Rmin (Rmin d1 d2) (error / 64)). split.
        { apply Rmin_pos; [apply Rmin_pos; apply cond_pos | lra]. }
        intros v near_v.
        assert (n1 : Rabs (v - u) < d1).
        { apply Rlt_le_trans with (1 := near_v). apply Rle_trans with (1 := Rmin_l _ _). apply Rmin_l. }
        assert (n2 : Rabs (v - u) < d2).
        { apply Rlt_le_trans with (1 := near_v). apply Rle_trans with (1 := Rmin_l _ _). apply Rmin_r. }
        assert (turned : Rabs (direction (place n v) (aim n v) - direction (place n u) (aim n u)) < error / 16) by exact (close1 v n1).
        assert (less : Rabs v < delta) by exact (close2 v n2).
        destruct (others v less) as [g [f [e [s [[[_ close_v] _] [pn [an [pm _]]]]]]]].
        destruct (secant (place n v) (aim n v) (place (S n) v) (place (S n) u)) as [xi [x1 [x2 mean]]].
        exists (side xi (direction (place n v) (aim n v))). split; [exact mean |].
        assert (xi_near : Rabs (xi - H (S n)) <= eps).
        { apply (between_near (place (S n) v) (place (S n) u)); [rewrite pm; apply close_v; lia | rewrite f_u; apply close; lia | exact x1 | exact x2]. }
        split.
        + apply side_large with n; [exact xi_near | rewrite pn; apply close_v; lia | rewrite an; apply close_v; lia].
        + intros f_near. unfold g2. rewrite <- d_is, <- f_u.
          apply Rle_lt_trans with (1 := side_lipschitz _ _ _ _).
          assert (Rabs (place (S n) v - place (S n) u) < error / 64) by (apply Rlt_le_trans with (1 := f_near); apply Rmin_r).
          lra. }
    assert (eta_pos : 0 < cos (eta (S n))) by (apply cos_pos, abs_off_cusp, range).
    assert (cos1_pos : 0 < cos (h (S n))) by (apply cos_pos, off1).
    assert (cos0_pos : 0 < cos (h n)).
    { destruct n as [| k]; [apply cos_pos, off0 | apply cos_pos, (step k); lia]. }
    assert (g1_is : g1 = t n * (3 * dh - dphi) - 4 * cos (h n) * cos (phi n) * dh).
    { assert (flies' := flies). destruct flies' as [_ [dx [dy _]]]. fold (direction (h n) (phi n)) in dx, dy. fold d in dx, dy.
      assert (leaving : sin d * cos (psi (h n)) - cos d * sin (psi (h n)) = cos (phi n)).
      { rewrite <- sin_minus. unfold d, direction. replace (psi (h n) + PI / 2 - phi n - psi (h n)) with (PI / 2 - phi n) by ring.
        apply sin_shift. }
      assert (one := sin2_cos2 d). unfold Rsqr in one.
      unfold g1. rewrite dx, dy, <- leaving.
      transitivity (t n * (3 * dh - dphi) * (sin d * sin d + cos d * cos d)
        - 4 * cos (h n) * (sin d * cos (psi (h n)) - cos d * sin (psi (h n))) * dh); [ring | rewrite one; ring]. }
    assert (g2_is : g2 = - (4 * cos (h (S n)) * cos (eta (S n)))) by exact (flight_side _ _ _ _ _ flies).
    set (dh1 := - g1 / g2) in *.
    assert (ds1 : 4 * cos (h (S n)) * dh1 = (t n * (3 * dh - dphi) - 4 * cos (h n) * cos (phi n) * dh) / cos (eta (S n))).
    { unfold dh1. rewrite g2_is, g1_is. field. lra. }
    clearbody dh1. clear g1_is g2_is. clear g1.
    (* the angle of incidence, from the direction of the tangent where the particle lands *)
    set (formula := fun v => psi (place (S n) v) - direction (place n v) (aim n v) - PI / 2).
    set (rounds := eta (S n) - formula u).
    assert (formula_moves : is_derive formula u (3 * dh1 - (3 * dh - dphi))).
    { unfold formula, psi at 1. set (dir := fun v => direction (place n v) (aim n v)) in *.
      change (is_derive (fun v => 3 * place (S n) v + PI / 2 - dir v - PI / 2) u (3 * dh1 - (3 * dh - dphi))).
      assert (turning' : is_derive dir u (3 * dh - dphi)) by exact turning. clearbody dir.
      auto_derive; [split; [eexists; exact landing | split; [eexists; exact turning' | trivial]] |].
      known landing. known turning'. ring. }
    assert (whole : forall a, cos (a - rounds) = cos a /\ sin (a - rounds) = sin a).
    { destruct (flight_turns _ _ _ _ _ flies) as [same_cos same_sin]. fold d in same_cos, same_sin.
      assert (formula_u : formula u = psi (h (S n)) - d - PI / 2) by (unfold formula; rewrite f_u, d_is; reflexivity).
      assert (turn : psi (h (S n)) - PI / 2 - eta (S n) = d - rounds) by (unfold rounds; rewrite formula_u; ring).
      rewrite turn in same_cos, same_sin.
      assert (one := sin2_cos2 d). unfold Rsqr in one. rewrite cos_minus in same_cos. rewrite sin_minus in same_sin.
      assert (c : cos rounds = 1) by nsatz. assert (s : sin rounds = 0) by nsatz.
      intros a. rewrite cos_minus, sin_minus, c, s. split; ring. }
    assert (angle_is : locally u (fun v => aim (S n) v = - lam * (formula v + rounds))).
    { assert (continuous : continuous formula u).
      { apply (@ex_derive_continuous R_AbsRing R_NormedModule formula u). eexists. exact formula_moves. }
      assert (margin : 0 < PI / 2 - Rabs (eta (S n))) by lra.
      destruct (continuous (fun y => Rabs (y - formula u) < PI / 2 - Rabs (eta (S n)))) as [d1 close1].
      { exists (mkposreal _ margin). intros y near_y. exact near_y. }
      destruct (still_small u small) as [d2 close2].
      exists (mkposreal _ (Rmin_stable_in_posreal d1 d2)). intros v near_v.
      assert (near_v' : Rabs (v - u) < Rmin d1 d2) by exact near_v.
      assert (moved : Rabs (formula v - formula u) < PI / 2 - Rabs (eta (S n))).
      { apply (close1 v). apply Rlt_le_trans with (1 := near_v'). apply Rmin_l. }
      assert (less : Rabs v < delta).
      { apply (close2 v). apply Rlt_le_trans with (1 := near_v'). apply Rmin_r. }
      destruct (others v less) as [g [f [e [s [[[[_ [_ step_v]] _] _] [pn [an [pm am]]]]]]]].
      destruct (step_v n) as [_ [range_v [flies_v law_v]]]; [lia |]. rewrite am, law_v. f_equal.
      destruct (flight_turns _ _ _ _ _ flies_v) as [same_cos same_sin]. rewrite <- pn, <- an, <- pm in same_cos, same_sin.
      apply (same_angle (psi (place (S n) v) - PI / 2)).
      - exact range_v.
      - replace (formula v + rounds) with ((formula v - formula u) + eta (S n)) by (unfold rounds; ring).
        apply Rle_lt_trans with (1 := Rabs_triang _ _). lra.
      - rewrite same_cos. replace (psi (place (S n) v) - PI / 2 - (formula v + rounds))
          with (direction (place n v) (aim n v) - rounds) by (unfold formula; ring). symmetry. apply whole.
      - rewrite same_sin. replace (psi (place (S n) v) - PI / 2 - (formula v + rounds))
          with (direction (place n v) (aim n v) - rounds) by (unfold formula; ring). symmetry. apply whole. }
    clear whole. clearbody rounds. clearbody formula.
    exists dh1, (- lam * (3 * dh1 - (3 * dh - dphi))).
    split; [exact landing | split; [| split]].
    + apply (is_derive_ext_loc (fun v => - lam * (formula v + rounds))).
      * revert angle_is. apply filter_imp. intros v is. symmetry. exact is.
      * auto_derive; [eexists; exact formula_moves |]. known formula_moves. ring.
    + rewrite ds1. cbn [derivative]. unfold product, bounce, curvature, radius; cbn [a11 a12 a21 a22].
      set (d11 := a11 (derivative lam h phi eta t n)) in *. set (d21 := a21 (derivative lam h phi eta t n)) in *.
      transitivity ((- ((t n * - / (4 * cos (h n) / 3) + cos (phi n)) / cos (eta (S n))) * (d11 * (4 * cos (h 0%nat)))
        + - (t n / cos (eta (S n))) * (d21 * (4 * cos (h 0%nat))))); [| ring].
      rewrite <- ds_is, <- dphi_is. field. lra.
    + cbn [derivative]. unfold product, bounce, curvature, radius; cbn [a11 a12 a21 a22].
      set (d11 := a11 (derivative lam h phi eta t n)) in *. set (d21 := a21 (derivative lam h phi eta t n)) in *.
      set (K0 := - / (4 * cos (h n) / 3)). set (K1 := - / (4 * cos (h (S n)) / 3)).
      set (A := (t n * K0 + cos (phi n)) / cos (eta (S n))). set (B := t n / cos (eta (S n))).
      match goal with |- _ = ?right => replace right with
        (- (lam * (K1 * A + K0)) * (d11 * (4 * cos (h 0%nat))) + - (lam * (K1 * B + 1)) * (d21 * (4 * cos (h 0%nat)))) by ring end.
      unfold A, B, K0, K1.
      rewrite <- ds_is, <- dphi_is.
      assert (dh1_is : @eq R dh1
        ((t n * (3 * dh - dphi) - 4 * cos (h n) * cos (phi n) * dh) / cos (eta (S n)) / (4 * cos (h (S n)))))
        by (rewrite <- ds1; field; lra).
      rewrite dh1_is. match goal with |- ?left = ?right => change (@eq R left right) end. field. lra.
Qed.

End Near.
