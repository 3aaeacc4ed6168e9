(** The cone of directions that every bounce maps into itself, on any focusing boundary where the chords are long
    enough. Paper: section 4.1.

    Where the boundary has radius of curvature [r], so [K = -1/r], the directions with [-lam/r <= dphi/ds <= 0] are
    those of beams that leave with a focus not beyond [D0 = r0*cos(phi0)]. A chord is long enough when [t >= D0 + d1],
    with [d1 = r1*cos(eta1)]. This is defocusing; it needs no elastic law. *)

From Coq Require Import Reals Lra Psatz.
From Pinball Require Import Bounce.
Open Scope R_scope.

Definition cone (lam r ds dphi : R) : Prop := 0 < ds /\ - lam * ds <= r * dphi <= 0.

(** By what the length [ds/r] of a direction in the cone grows at least. *)
Definition gain (r0 r1 t cos_phi0 cos_eta1 : R) : R := (t - r0 * cos_phi0) / (r1 * cos_eta1).

Lemma gain_at_least_1 r0 r1 t cos_phi0 cos_eta1 :
  0 < r1 -> 0 < cos_eta1 -> r0 * cos_phi0 + r1 * cos_eta1 <= t -> 1 <= gain r0 r1 t cos_phi0 cos_eta1.
Proof.
  intros r1_pos cos_pos long. unfold gain.
  apply Rmult_le_reg_r with (r1 * cos_eta1); [nra |]. field_simplify; [lra | lra].
Qed.

Theorem cone_invariant r0 r1 t cos_phi0 cos_eta1 lam ds dphi :
  0 <= lam -> 0 < r0 -> 0 < r1 -> 0 < cos_phi0 -> 0 < cos_eta1 ->
  r0 * cos_phi0 + r1 * cos_eta1 <= t ->
  cone lam r0 ds dphi ->
  let m := bounce (- / r0) (- / r1) t cos_phi0 cos_eta1 lam in
  let ds1 := a11 m * ds + a12 m * dphi in
  let dphi1 := a21 m * ds + a22 m * dphi in
  cone lam r1 ds1 dphi1 /\ gain r0 r1 t cos_phi0 cos_eta1 * (ds / r0) <= ds1 / r1.
Proof.
  intros lam_nonneg r0_pos r1_pos phi_pos eta_pos long [ds_pos [low high]].
  unfold gain, cone, bounce; simpl.
  set (w := ds / r0 - dphi).  (* the beam turns by -w across *)
  assert (w_least : ds / r0 <= w).
  { unfold w. assert (dphi <= 0) by (destruct (Rle_lt_dec dphi 0); [lra | nra]). lra. }
  assert (x_pos : 0 < ds / r0) by (apply Rdiv_lt_0_compat; lra).
  set (x := ds / r0) in *.
  assert (ds_is : ds = x * r0) by (unfold x; field; lra).
  assert (dphi_is : dphi = x - w) by (unfold w; ring).
  clearbody x w. subst ds dphi.
  replace (- ((t * - / r0 + cos_phi0) / cos_eta1) * (x * r0) + - (t / cos_eta1) * (x - w))
    with ((t * w - cos_phi0 * r0 * x) / cos_eta1) by (field; lra).
  replace (- (lam * (- / r1 * ((t * - / r0 + cos_phi0) / cos_eta1) + - / r0)) * (x * r0)
           + - (lam * (- / r1 * (t / cos_eta1) + 1)) * (x - w))
    with (lam * (w - (t * w - cos_phi0 * r0 * x) / (cos_eta1 * r1))) by (field; lra).
  assert (D0_pos : 0 < r0 * cos_phi0) by nra.
  assert (d1_pos : 0 < r1 * cos_eta1) by nra.
  set (D0 := r0 * cos_phi0) in *.
  assert (width : D0 * x <= (t - r1 * cos_eta1) * w).
  { apply Rle_trans with (D0 * w); nra. }
  replace (cos_phi0 * r0 * x) with (D0 * x) by (unfold D0; ring).
  assert (top : (t - D0) * x <= t * w - D0 * x) by nra.
  assert (top_pos : 0 < t * w - D0 * x) by nra.
  set (y := t * w - D0 * x) in *.
  assert (y_large : r1 * cos_eta1 * w <= y) by (unfold y; nra).
  repeat split.
  - apply Rdiv_lt_0_compat; lra.
  - replace (r1 * (lam * (w - y / (cos_eta1 * r1)))) with (lam * (r1 * w - y / cos_eta1)) by (field; lra).
    assert (0 <= lam * (r1 * w)) by (apply Rmult_le_pos; nra). lra.
  - replace (r1 * (lam * (w - y / (cos_eta1 * r1)))) with (- (lam * ((y - r1 * cos_eta1 * w) / cos_eta1))) by (field; lra).
    assert (0 <= (y - r1 * cos_eta1 * w) / cos_eta1) by (apply Rmult_le_pos; [lra | left; apply Rinv_0_lt_compat; lra]). nra.
  - replace (y / cos_eta1 / r1) with (y * / (r1 * cos_eta1)) by (field; lra).
    replace ((t - D0) / (r1 * cos_eta1) * x) with ((t - D0) * x * / (r1 * cos_eta1)) by (field; lra).
    apply Rmult_le_compat_r with (r := / (r1 * cos_eta1)); [left; apply Rinv_0_lt_compat; lra | lra].
Qed.
