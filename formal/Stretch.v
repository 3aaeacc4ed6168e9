(** Every orbit of the cardioid off its cusp stretches, and every cycle has a multiplier above 1. Paper: section 4.1. *)

From Coq Require Import Reals Lra Lia Psatz.
From Coquelicot Require Import Coquelicot.
From Pinball Require Import Bounce Cone Cardioid.
Open Scope R_scope.

Definition off_cusp (h : R) : Prop := - (PI / 2) < h < PI / 2.

Lemma cos_pos x : off_cusp x -> 0 < cos x.
Proof. intros [low high]. apply cos_gt_0; lra. Qed.

Lemma abs_off_cusp x : Rabs x < PI / 2 -> off_cusp x.
Proof. intros small. apply Rabs_def2 in small. split; lra. Qed.

(** The growth of a bounce: [1 + tan((1 - lam)*PI/8)^2/2], written with the cosine of twice that angle. *)
Definition kappa (lam : R) : R := cos ((1 - lam) * PI / 4).
Definition growth (lam : R) : R := 1 + / 2 * ((1 - kappa lam) / (1 + kappa lam)).

Section One_flight.

Variables h0 h1 t phi eta : R.
Hypothesis flies : flight h0 h1 t phi eta.
Hypothesis start_off_cusp : off_cusp h0.
Hypothesis end_off_cusp : off_cusp h1.
Hypothesis phi_range : Rabs phi < PI / 2.
Hypothesis eta_range : Rabs eta < PI / 2.

Let c0 := cos h0.
Let c1 := cos h1.
Let C := cos (h1 - h0).
Let S := sin (h1 - h0).
Let e := c1 + 2 * c0 * C.

Let t_pos : 0 < t. Proof. apply flies. Qed.
Let c0_pos : 0 < c0. Proof. apply cos_pos, start_off_cusp. Qed.
Let c1_pos : 0 < c1. Proof. apply cos_pos, end_off_cusp. Qed.
Let phi_pos : 0 < cos phi. Proof. apply cos_pos, abs_off_cusp, phi_range. Qed.
Let eta_pos : 0 < cos eta. Proof. apply cos_pos, abs_off_cusp, eta_range. Qed.
Let circle : C * C + S * S = 1.
Proof. unfold C, S. generalize (sin2_cos2 (h1 - h0)). unfold Rsqr. lra. Qed.
Let normal0 : t * cos phi = 2 * (S * S) * (c0 + 2 * c1 * C). Proof. apply (along_normal0 _ _ _ _ _ flies). Qed.
Let normal1 : t * cos eta = 2 * (S * S) * e. Proof. apply (along_normal1 _ _ _ _ _ flies). Qed.
Let apart : S * S = c0 * c0 + c1 * c1 - 2 * c0 * c1 * C. Proof. apply distance. Qed.

Let S_pos : 0 < S * S.
Proof.
  destruct (Rle_lt_or_eq_dec 0 (S * S)) as [pos | zero]; [apply Rle_0_sqr | exact pos |].
  exfalso. assert (0 < t * cos eta) by nra. rewrite normal1, <- zero in *. lra.
Qed.

Let e_pos : 0 < e.
Proof. assert (0 < t * cos eta) by nra. rewrite normal1 in *. nra. Qed.

Let c0c1_pos : 0 < c0 * c1. Proof. apply Rmult_lt_0_compat; assumption. Qed.
Let c1e_pos : 0 < c1 * e. Proof. apply Rmult_lt_0_compat; assumption. Qed.
Let C_le_1 : C <= 1. Proof. unfold C. apply COS_bound. Qed.

(** [C > -1/2] on every flight: the sum of both cosines has the sign of [(c0 + c1)*(1 + 2*C)]. *)
Let C_low : - (1 / 2) < C.
Proof.
  assert (0 < t * cos phi) by nra. rewrite normal0 in *.
  assert (0 < c0 + 2 * c1 * C) by nra.
  assert (0 < (c0 + c1) * (1 + 2 * C)) by (unfold e in e_pos; lra).
  nra.
Qed.

(** The defocusing inequality. *)
Theorem defocusing : radius h0 * cos phi + radius h1 * cos eta < t.
Proof.
  assert (found := defocusing_identity _ _ _ _ _ flies). fold S in found.
  assert (0 < t * (t - radius h0 * cos phi - radius h1 * cos eta)) by (rewrite found; nra).
  nra.
Qed.

Let radius0_pos : 0 < radius h0. Proof. unfold radius. fold c0. lra. Qed.
Let radius1_pos : 0 < radius h1. Proof. unfold radius. fold c1. lra. Qed.

Lemma gain_is : gain (radius h0) (radius h1) t (cos phi) (cos eta) = 1 + S * S / (2 * c1 * e).
Proof.
  assert (found := defocusing_identity _ _ _ _ _ flies). fold S in found.
  unfold gain.
  assert (d1_pos : 0 < radius h1 * cos eta) by nra.
  replace ((t - radius h0 * cos phi) / (radius h1 * cos eta))
    with (1 + t * (t - radius h0 * cos phi - radius h1 * cos eta) / (radius h1 * (t * cos eta))) by (field; lra).
  rewrite found, normal1. unfold radius. fold c1.
  assert (S <> 0) by (intros zero; generalize S_pos; rewrite zero; lra).
  field. lra.
Qed.

Lemma gain_above_1 : 1 < gain (radius h0) (radius h1) t (cos phi) (cos eta).
Proof.
  rewrite gain_is. assert (0 < S * S / (2 * c1 * e)) by (apply Rdiv_lt_0_compat; nra). lra.
Qed.

Let half_tangent : 0 <= C -> (1 - C) / (1 + C) <= S * S / (c1 * e).
Proof.
  intros C_nonneg.
  assert (C_high : C < 1) by nra.
  assert (squares : (S * S) * ((1 + C) ^ 2 - c1 * e) = ((1 + C) * c0 - 2 * C * c1) ^ 2 + 2 * C * (1 - C) * c1 ^ 2).
  { replace ((S * S) * ((1 + C) ^ 2 - c1 * e)) with ((S * S) * (1 + C) ^ 2 - (1 - C * C) * (c1 * e))
      by (replace (1 - C * C) with (S * S) by lra; ring).
    rewrite apart. unfold e. ring. }
  assert (enough : c1 * e <= (1 + C) ^ 2).
  { assert (0 <= ((1 + C) * c0 - 2 * C * c1) ^ 2) by apply pow2_ge_0.
    assert (0 <= 2 * C * (1 - C) * c1 ^ 2) by (apply Rmult_le_pos; [nra | apply pow2_ge_0]).
    apply Rmult_le_reg_l with (S * S); [exact S_pos | lra]. }
  apply Rmult_le_reg_r with ((1 + C) * (c1 * e)); [apply Rmult_lt_0_compat; lra |].
  replace ((1 - C) / (1 + C) * ((1 + C) * (c1 * e))) with ((1 - C) * (c1 * e)) by (field; lra).
  replace (S * S / (c1 * e) * ((1 + C) * (c1 * e))) with ((S * S) * (1 + C)) by (field; lra).
  replace (S * S) with ((1 - C) * (1 + C)) by lra. nra.
Qed.

Variable lam : R.
Hypothesis lam_range : 0 <= lam <= 1.
Hypothesis law_range : Rabs phi <= lam * PI / 2.  (* so leaves who has bounced before *)

Let kappa_low : / 2 <= kappa lam * kappa lam /\ 0 < kappa lam <= 1.
Proof.
  unfold kappa. assert (pi := PI_RGT_0).
  assert (0 <= (1 - lam) * PI / 4 <= PI / 4) by (clear - lam_range pi; split; nra).
  assert (cos (PI / 4) <= cos ((1 - lam) * PI / 4)) by (apply cos_decr_1; lra).
  assert (0 < cos (PI / 4)) by (apply cos_gt_0; lra).
  assert (half : cos (PI / 4) * cos (PI / 4) = / 2).
  { rewrite cos_PI4. replace (1 / sqrt 2 * (1 / sqrt 2)) with (1 / (sqrt 2 * sqrt 2)).
    - rewrite sqrt_sqrt; lra.
    - assert (0 < sqrt 2) by (apply sqrt_lt_R0; lra). field. lra. }
  set (k := cos ((1 - lam) * PI / 4)) in *. set (q := cos (PI / 4)) in *.
  assert (q * q <= k * k) by (apply Rmult_le_compat; lra).
  assert (k <= 1) by (unfold k; apply COS_bound). lra.
Qed.

(** A chord makes at most the angle [2*delta] with the tangent, and the law keeps it away from the tangent. *)
Let C_high : 0 <= C -> C <= kappa lam.
Proof.
  intros C_nonneg. destruct kappa_low as [least [pos _]].
  destruct (Rle_lt_dec C (kappa lam)) as [done | above]; [exact done | exfalso].
  set (C2 := 2 * (C * C) - 1).
  assert (larger : kappa lam * kappa lam < C * C) by (clear - pos above; nra).
  assert (C2_pos : 0 <= C2) by (unfold C2; lra).
  assert (C2_le : C2 <= C) by (unfold C2; clear - C_nonneg C_le_1; nra).
  assert (tangent := along_tangent0 _ _ _ _ _ flies). fold c0 c1 C S C2 in tangent.
  assert (long := length_squared _ _ _ _ _ flies). fold c0 c1 C S in long.
  assert (steep : C2 * (c0 + c1) <= c0 * C + c1 * C2) by (clear - c0_pos C2_le; nra).
  assert (shorter : t * t <= 4 * (S * S) * ((c0 + c1) * (c0 + c1))).
  { rewrite long. apply Rmult_le_compat_l; [clear - S_pos; lra |].
    assert (c0 * c1 * C <= c0 * c1 * 1) by (apply Rmult_le_compat_l; lra). lra. }
  assert (sliding : (C2 * t) * (C2 * t) <= (t * sin phi) * (t * sin phi)).
  { rewrite tangent.
    replace (2 * S * (c0 * C + c1 * C2) * (2 * S * (c0 * C + c1 * C2)))
      with (4 * (S * S) * ((c0 * C + c1 * C2) * (c0 * C + c1 * C2))) by ring.
    apply Rle_trans with (C2 * C2 * (4 * (S * S) * ((c0 + c1) * (c0 + c1)))).
    - replace (C2 * t * (C2 * t)) with (C2 * C2 * (t * t)) by ring. apply Rmult_le_compat_l; [apply Rle_0_sqr | exact shorter].
    - replace (C2 * C2 * (4 * (S * S) * ((c0 + c1) * (c0 + c1))))
        with (4 * (S * S) * ((C2 * (c0 + c1)) * (C2 * (c0 + c1)))) by ring.
      assert (0 <= C2 * (c0 + c1)) by (apply Rmult_le_pos; lra).
      apply Rmult_le_compat_l; [lra |]. apply Rmult_le_compat; lra. }
  assert (sine : C2 * C2 <= sin phi * sin phi) by (apply Rmult_le_reg_r with (t * t); [apply Rmult_lt_0_compat; lra | lra]).
  assert (pi := PI_RGT_0).
  assert (law : sin phi * sin phi <= (2 * (kappa lam * kappa lam) - 1) * (2 * (kappa lam * kappa lam) - 1)).
  { assert (double : 2 * (kappa lam * kappa lam) - 1 = sin (lam * PI / 2)).
    { unfold kappa. replace (lam * PI / 2) with (PI / 2 - 2 * ((1 - lam) * PI / 4)) by field.
      rewrite sin_shift, cos_2a_cos. ring. }
    rewrite double.
    assert (lam * PI / 2 <= PI / 2) by (clear - lam_range pi; nra).
    assert (0 <= lam * PI / 2) by (clear - lam_range pi; nra).
    destruct (Rcase_abs phi) as [negative | nonneg].
    - rewrite Rabs_left in law_range by exact negative.
      replace (sin phi * sin phi) with (sin (- phi) * sin (- phi)) by (rewrite sin_neg; ring).
      assert (sin (- phi) <= sin (lam * PI / 2)) by (apply sin_incr_1; lra).
      assert (0 <= sin (- phi)) by (apply sin_ge_0; lra). apply Rmult_le_compat; lra.
    - rewrite Rabs_right in law_range by exact nonneg.
      assert (sin phi <= sin (lam * PI / 2)) by (apply sin_incr_1; lra).
      assert (0 <= sin phi) by (apply sin_ge_0; lra). apply Rmult_le_compat; lra. }
  set (k2 := 2 * (kappa lam * kappa lam) - 1) in *.
  assert (k2 < C2) by (unfold k2, C2; lra).
  assert (0 <= k2) by (unfold k2; lra).
  assert (k2 * k2 < C2 * C2) by (apply Rmult_le_0_lt_compat; lra). lra.
Qed.

Lemma gain_at_least_growth : growth lam <= gain (radius h0) (radius h1) t (cos phi) (cos eta).
Proof.
  destruct kappa_low as [_ [pos high]].
  rewrite gain_is. unfold growth. apply Rplus_le_compat_l.
  replace (S * S / (2 * c1 * e)) with (/ 2 * (S * S / (c1 * e))) by (field; lra).
  apply Rmult_le_compat_l; [lra |].
  destruct (Rle_lt_dec 0 C) as [nonneg | negative].
  - apply Rle_trans with ((1 - C) / (1 + C)); [| exact (half_tangent nonneg)].
    assert (C <= kappa lam) by exact (C_high nonneg).
    apply Rmult_le_reg_r with ((1 + kappa lam) * (1 + C)); [apply Rmult_lt_0_compat; lra |].
    replace ((1 - kappa lam) / (1 + kappa lam) * ((1 + kappa lam) * (1 + C))) with ((1 - kappa lam) * (1 + C)) by (field; lra).
    replace ((1 - C) / (1 + C) * ((1 + kappa lam) * (1 + C))) with ((1 - C) * (1 + kappa lam)) by (field; lra).
    lra.
  - apply Rle_trans with 1.
    + apply Rmult_le_reg_r with (1 + kappa lam); [lra |].
      replace ((1 - kappa lam) / (1 + kappa lam) * (1 + kappa lam)) with (1 - kappa lam) by (field; lra). lra.
    + apply Rmult_le_reg_r with (c1 * e); [exact c1e_pos |].
      replace (S * S / (c1 * e) * (c1 * e)) with (S * S) by (field; lra).
      rewrite apart. unfold e.
      assert (0 <= c0 * c1 * - C) by (apply Rmult_le_pos; lra). assert (0 <= c0 * c0) by apply Rle_0_sqr. lra.
Qed.

(** What the last flight of a piece of orbit leaves of the growth, near the cusp too. *)
Lemma advance_at_least : / 3 * sin ((1 - lam) * PI / 4) ^ 4 <= t - radius h0 * cos phi.
Proof.
  assert (found := defocusing_identity _ _ _ _ _ flies). fold S in found.
  assert (long := length_squared _ _ _ _ _ flies). fold c0 c1 C S in long.
  destruct kappa_low as [least [pos high]].
  assert (one := sin2_cos2 ((1 - lam) * PI / 4)). unfold Rsqr in one. fold (kappa lam) in one.
  assert (c0_le : c0 <= 1) by (unfold c0; apply COS_bound).
  assert (c1_le : c1 <= 1) by (unfold c1; apply COS_bound).
  assert (S_least : sin ((1 - lam) * PI / 4) * sin ((1 - lam) * PI / 4) <= S * S).
  { destruct (Rle_lt_dec 0 C) as [nonneg | negative].
    - assert (C <= kappa lam) by exact (C_high nonneg).
      assert (C * C <= kappa lam * kappa lam) by (apply Rmult_le_compat; lra). lra.
    - assert (C * C <= 1 / 4) by (clear - C_low negative; nra). lra. }
  assert (short : t <= 4).
  { assert (sum : c0 * c0 + c1 * c1 + 2 * c0 * c1 * C <= 4).
    { assert (c0 * c1 * C <= c0 * c1 * 1) by (apply Rmult_le_compat_l; lra).
      assert (c0 * c0 <= 1 * 1) by (apply Rmult_le_compat; lra).
      assert (c1 * c1 <= 1 * 1) by (apply Rmult_le_compat; lra).
      assert (c0 * c1 <= 1 * 1) by (apply Rmult_le_compat; lra). lra. }
    assert (S * S <= 1) by (assert (0 <= C * C) by apply Rle_0_sqr; lra).
    assert (t * t <= 16).
    { rewrite long. apply Rle_trans with (4 * (S * S) * 4); [apply Rmult_le_compat_l; lra | lra]. }
    clear - t_pos H0. nra. }
  replace (sin ((1 - lam) * PI / 4) ^ 4)
    with ((sin ((1 - lam) * PI / 4) * sin ((1 - lam) * PI / 4)) * (sin ((1 - lam) * PI / 4) * sin ((1 - lam) * PI / 4))) by ring.
  set (q := sin ((1 - lam) * PI / 4) * sin ((1 - lam) * PI / 4)) in *.
  assert (q_nonneg : 0 <= q) by (unfold q; apply Rle_0_sqr).
  assert (fourth : q * q <= S * S * (S * S)) by (apply Rmult_le_compat; lra).
  assert (d1_pos : 0 < radius h1 * cos eta) by (apply Rmult_lt_0_compat; assumption).
  set (D0 := radius h0 * cos phi) in *. set (d1 := radius h1 * cos eta) in *.
  assert (t * (t - D0 - d1) <= 4 * (t - D0 - d1)).
  { apply Rmult_le_compat_r; [| exact short].
    assert (D0 + d1 < t) by exact defocusing. lra. }
  lra.
Qed.

End One_flight.

Lemma growth_is lam : 0 <= lam <= 1 -> growth lam = 1 + tan ((1 - lam) * PI / 8) ^ 2 / 2.
Proof.
  intros range. assert (pi := PI_RGT_0). unfold growth, kappa, tan.
  replace ((1 - lam) * PI / 4) with (2 * ((1 - lam) * PI / 8)) by field.
  set (x := (1 - lam) * PI / 8).
  assert (0 < cos x) by (apply cos_gt_0; unfold x; nra).
  assert (one := sin2_cos2 x). unfold Rsqr in one.
  rewrite cos_2a.
  replace (1 - (cos x * cos x - sin x * sin x)) with (2 * (sin x * sin x)) by lra.
  replace (1 + (cos x * cos x - sin x * sin x)) with (2 * (cos x * cos x)) by lra.
  field. lra.
Qed.

Lemma growth_above_1 lam : 0 <= lam < 1 -> 1 < growth lam.
Proof.
  intros range. rewrite growth_is by lra. assert (pi := PI_RGT_0).
  assert (0 < tan ((1 - lam) * PI / 8)) by (apply tan_gt_0; nra). nra.
Qed.
