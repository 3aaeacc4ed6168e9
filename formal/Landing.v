(** How the cardioid's landings depend on the start. Paper: section 2.1.

    The landing solves an equation, and its derivative is that of an implicit function. *)

From Coq Require Import Nsatz Reals Lra Lia Psatz.
From Coquelicot Require Import Coquelicot.
From Pinball Require Import Bounce Cone Cardioid Stretch Cycles Map.
Open Scope R_scope.

(** * An implicit function of one variable *)

Lemma implicit_derivative (G : R -> R -> R) (f : R -> R) (u g1 g2 m : R) :
  0 < m -> m <= Rabs g2 ->
  is_derive (fun v => G v (f u)) u g1 ->
  locally u (fun v => G v (f v) = 0) ->
  (forall eps, 0 < eps -> exists d, 0 < d /\ forall v, Rabs (v - u) < d ->
     exists q, G v (f v) - G v (f u) = q * (f v - f u) /\ m <= Rabs q /\ (Rabs (f v - f u) < d -> Rabs (q - g2) < eps)) ->
  is_derive f u (- g1 / g2).
Proof.
  intros m_pos g2_large slope zero secant.
  assert (at_u : G u (f u) = 0) by exact (locally_singleton _ _ zero).
  destruct zero as [d0 zero].
  assert (zero' : forall v, Rabs (v - u) < d0 -> G v (f v) = 0) by (intros v near; apply zero; exact near).
  apply is_derive_Reals in slope. apply is_derive_Reals.
  assert (g2_nonzero : g2 <> 0) by (intros ->; rewrite Rabs_R0 in g2_large; lra).
  intros eps eps_pos.
  set (M := Rabs g1 + 1). assert (M_pos : 0 < M) by (unfold M; assert (0 <= Rabs g1) by apply Rabs_pos; lra).
  set (e1 := Rmin 1 (eps * m / 2)).
  assert (e1_pos : 0 < e1) by (unfold e1; apply Rmin_pos; [lra | apply Rdiv_lt_0_compat; nra]).
  set (e2 := eps * m * m / (2 * M)).
  assert (e2_pos : 0 < e2) by (unfold e2; apply Rdiv_lt_0_compat; [apply Rmult_lt_0_compat; nra | lra]).
  destruct (slope e1 e1_pos) as [d1 slope1]. destruct (secant e2 e2_pos) as [d2 [d2_pos secant2]].
  (* f moves by at most M/m times as much *)
  set (d := Rmin (Rmin d0 d1) (Rmin d2 (d2 * m / (2 * M)))).
  assert (d_pos : 0 < d).
  { unfold d. apply Rmin_pos; apply Rmin_pos; try apply cond_pos; try assumption. apply Rdiv_lt_0_compat; nra. }
  exists (mkposreal d d_pos). intros h h_nonzero small. simpl in small.
  assert (s0 : Rabs h < d0) by (apply Rlt_le_trans with (1 := small); unfold d; apply Rle_trans with (1 := Rmin_l _ _); apply Rmin_l).
  assert (s1 : Rabs h < d1) by (apply Rlt_le_trans with (1 := small); unfold d; apply Rle_trans with (1 := Rmin_l _ _); apply Rmin_r).
  assert (s2 : Rabs h < d2) by (apply Rlt_le_trans with (1 := small); unfold d; apply Rle_trans with (1 := Rmin_r _ _); apply Rmin_l).
  assert (s3 : Rabs h < d2 * m / (2 * M)) by (apply Rlt_le_trans with (1 := small); unfold d; apply Rle_trans with (1 := Rmin_r _ _); apply Rmin_r).
  assert (back : u + h - u = h) by ring.
  destruct (secant2 (u + h)) as [q [sec [q_large q_near]]]; [rewrite back; exact s2 |].
  rewrite zero' in sec by (rewrite back; exact s0).
  specialize (slope1 h h_nonzero s1). rewrite at_u in slope1.
  set (k := (G (u + h) (f u) - 0) / h) in slope1.
  assert (Gk : G (u + h) (f u) = k * h) by (unfold k; field; exact h_nonzero).
  rewrite Gk in sec.
  assert (q_nonzero : q <> 0) by (intros ->; rewrite Rabs_R0 in q_large; lra).
  assert (moved : (f (u + h) - f u) / h = - k / q).
  { apply Rmult_eq_reg_r with (q * h); [| apply Rmult_integral_contrapositive_currified; assumption].
    replace ((f (u + h) - f u) / h * (q * h)) with (q * (f (u + h) - f u)) by (field; exact h_nonzero).
    rewrite <- sec. field. exact q_nonzero. }
  assert (k_le : Rabs k <= M).
  { replace k with ((k - g1) + g1) by ring. apply Rle_trans with (1 := Rabs_triang _ _). unfold M.
    assert (e1 <= 1) by apply Rmin_l. lra. }
  assert (inv_q : Rabs (/ q) <= / m) by (rewrite Rabs_inv; apply Rinv_le_contravar; lra).
  assert (close : Rabs (f (u + h) - f u) < d2).
  { replace (f (u + h) - f u) with (- k / q * h) by (rewrite <- moved; field; exact h_nonzero).
    unfold Rdiv. rewrite !Rabs_mult, Rabs_Ropp.
    assert (0 <= Rabs k) by apply Rabs_pos. assert (0 <= Rabs (/ q)) by apply Rabs_pos. assert (0 <= Rabs h) by apply Rabs_pos.
    apply Rle_lt_trans with (M * / m * Rabs h).
    - apply Rmult_le_compat_r; [assumption |]. apply Rmult_le_compat; assumption.
    - apply Rle_lt_trans with (M * / m * (d2 * m / (2 * M))).
      + apply Rmult_le_compat_l; [| lra]. apply Rmult_le_pos; [lra | left; apply Rinv_0_lt_compat; exact m_pos].
      + replace (M * / m * (d2 * m / (2 * M))) with (d2 / 2) by (field; lra). lra. }
  specialize (q_near close). rewrite moved.
  replace (- k / q - - g1 / g2) with ((g1 - k) * / q + g1 * ((q - g2) * (/ q * / g2))) by (field; split; assumption).
  apply Rle_lt_trans with (1 := Rabs_triang _ _). rewrite !Rabs_mult.
  assert (inv_g2 : Rabs (/ g2) <= / m) by (rewrite Rabs_inv; apply Rinv_le_contravar; lra).
  assert (first : Rabs (g1 - k) * Rabs (/ q) < eps / 2).
  { rewrite Rabs_minus_sym. apply Rle_lt_trans with (Rabs (k - g1) * / m).
    - apply Rmult_le_compat_l; [apply Rabs_pos | exact inv_q].
    - apply Rmult_lt_reg_r with m; [exact m_pos |]. replace (Rabs (k - g1) * / m * m) with (Rabs (k - g1)) by (field; lra).
      assert (e1 <= eps * m / 2) by apply Rmin_r. lra. }
  assert (second : Rabs g1 * (Rabs (q - g2) * (Rabs (/ q) * Rabs (/ g2))) <= eps / 2).
  { apply Rle_trans with (M * (e2 * (/ m * / m))).
    - assert (0 <= Rabs (/ q)) by apply Rabs_pos. assert (0 <= Rabs (/ g2)) by apply Rabs_pos.
      assert (0 <= Rabs (q - g2)) by apply Rabs_pos. assert (0 <= Rabs g1) by apply Rabs_pos.
      apply Rmult_le_compat; try assumption.
      + apply Rmult_le_pos; [| apply Rmult_le_pos]; assumption.
      + unfold M. lra.
      + apply Rmult_le_compat; try assumption; [apply Rmult_le_pos; assumption | lra |].
        apply Rmult_le_compat; assumption.
    - right. unfold e2. field. lra. }
  lra.
Qed.

(** * How a landing depends on the start *)

Definition direction (h0 phi : R) : R := psi h0 + PI / 2 - phi.

(** Zero where the ray from [h0] meets [h1]. *)
Definition miss (h0 h1 phi : R) : R := (X h1 - X h0) * sin (direction h0 phi) - (Y h1 - Y h0) * cos (direction h0 phi).

(** Its derivative by [h1], where the ray has direction [d]. *)
Definition side (h1 d : R) : R := 4 * cos h1 * sin (d - psi h1).

Lemma miss_derivative h0 y phi : is_derive (fun h1 => miss h0 h1 phi) y (side y (direction h0 phi)).
Proof.
  destruct (frenet y) as [_ [dx [dy _]]]. unfold miss.
  auto_derive; [split; [eexists; exact dx | split; [eexists; exact dy | trivial]] |].
  known dx. known dy. unfold side. rewrite sin_minus. ring.
Qed.

Lemma flight_hits h0 h1 t phi eta : flight h0 h1 t phi eta -> miss h0 h1 phi = 0.
Proof. intros [_ [dx [dy _]]]. unfold miss. fold (direction h0 phi) in dx, dy. rewrite dx, dy. ring. Qed.

Lemma flight_turns h0 h1 t phi eta : flight h0 h1 t phi eta ->
  cos (psi h1 - PI / 2 - eta) = cos (direction h0 phi) /\ sin (psi h1 - PI / 2 - eta) = sin (direction h0 phi).
Proof.
  intros [pos [dx [dy [ex ey]]]]. unfold direction. split; apply Rmult_eq_reg_l with t; lra.
Qed.

Lemma flight_side h0 h1 t phi eta : flight h0 h1 t phi eta -> side h1 (direction h0 phi) = - (4 * cos h1 * cos eta).
Proof.
  intros flies. destruct (flight_turns _ _ _ _ _ flies) as [same_cos same_sin].
  unfold side. rewrite sin_minus, <- same_cos, <- same_sin, <- sin_minus.
  replace (psi h1 - PI / 2 - eta - psi h1) with (- (PI / 2 + eta)) by ring. rewrite sin_neg, <- cos_sin. ring.
Qed.

Lemma sin_lipschitz x y : Rabs (sin x - sin y) <= Rabs (x - y).
Proof.
  destruct (MVT_gen sin y x cos) as [c [_ mean]].
  - intros. apply is_derive_sin.
  - intros. apply continuity_sin.
  - rewrite mean, Rabs_mult. assert (bound := COS_bound c). assert (0 <= Rabs (x - y)) by apply Rabs_pos.
    assert (Rabs (cos c) <= 1) by (apply Rabs_le; lra). nra.
Qed.

Lemma cos_lipschitz x y : Rabs (cos x - cos y) <= Rabs (x - y).
Proof.
  rewrite <- !sin_shift. apply Rle_trans with (1 := sin_lipschitz _ _).
  replace (PI / 2 - x - (PI / 2 - y)) with (- (x - y)) by ring. rewrite Rabs_Ropp. lra.
Qed.

Lemma side_lipschitz a b a' b' : Rabs (side a b - side a' b') <= 16 * Rabs (a - a') + 4 * Rabs (b - b').
Proof.
  unfold side. set (s := sin (b - psi a)). set (s' := sin (b' - psi a')).
  replace (4 * cos a * s - 4 * cos a' * s') with (4 * ((cos a - cos a') * s + cos a' * (s - s'))) by ring.
  rewrite Rabs_mult, (Rabs_right 4) by lra.
  assert (split_ := Rabs_triang ((cos a - cos a') * s) (cos a' * (s - s'))). rewrite !Rabs_mult in split_.
  assert (c_near := cos_lipschitz a a'). assert (s_near := sin_lipschitz (b - psi a) (b' - psi a')). fold s s' in s_near.
  assert (turned : Rabs (b - psi a - (b' - psi a')) <= Rabs (b - b') + 3 * Rabs (a - a')).
  { unfold psi. replace (b - (3 * a + PI / 2) - (b' - (3 * a' + PI / 2))) with ((b - b') + - (3 * (a - a'))) by ring.
    apply Rle_trans with (1 := Rabs_triang _ _). rewrite Rabs_Ropp, Rabs_mult, (Rabs_right 3) by lra. lra. }
  assert (s_le : Rabs s <= 1) by (apply Rabs_le, SIN_bound). assert (c_le : Rabs (cos a') <= 1) by (apply Rabs_le, COS_bound).
  assert (0 <= Rabs (cos a - cos a')) by apply Rabs_pos. assert (0 <= Rabs (s - s')) by apply Rabs_pos. nra.
Qed.

Lemma secant h0 phi y z : exists xi, Rabs (xi - z) <= Rabs (y - z) /\ Rabs (xi - y) <= Rabs (y - z)
  /\ miss h0 y phi - miss h0 z phi = side xi (direction h0 phi) * (y - z).
Proof.
  destruct (MVT_gen (fun h => miss h0 h phi) z y (fun h => side h (direction h0 phi))) as [xi [range mean]].
  - intros. apply miss_derivative.
  - intros u _. apply continuity_pt_filterlim. apply (@ex_derive_continuous R_AbsRing R_NormedModule (fun h => miss h0 h phi) u).
    exists (side u (direction h0 phi)). apply miss_derivative.
  - exists xi. split; [| split; [| exact mean]].
    + unfold Rmin, Rmax in range. destruct (Rle_dec z y); apply Rabs_le_between; unfold Rabs; destruct (Rcase_abs _); lra.
    + unfold Rmin, Rmax in range. destruct (Rle_dec z y); apply Rabs_le_between; unfold Rabs; destruct (Rcase_abs _); lra.
Qed.
