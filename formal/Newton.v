(** The interval Newton theorem in Krawczyk's form, for any number of unknowns: existence and uniqueness of a zero in a
    box. *)

From Coq Require Import Reals Lra Lia Psatz FunctionalExtensionality.
From Coquelicot Require Import Coquelicot.
Open Scope R_scope.

Fixpoint total (n : nat) (v : nat -> R) : R := match n with O => 0 | S m => total m v + v m end.

Definition unit_matrix (i j : nat) : R := if Nat.eqb i j then 1 else 0.

(** The box with centre [m] and radii [r]; unknowns are numbered from 0, and radii beyond the last are 0. *)
Definition in_box (m r x : nat -> R) : Prop := forall j, Rabs (x j - m j) <= r j.

Definition segment (x y : nat -> R) (t : R) : nat -> R := fun j => x j + t * (y j - x j).

Lemma total_ext n v w : (forall j, (j < n)%nat -> v j = w j) -> total n v = total n w.
Proof. induction n as [| n IH]; intros same; simpl; [reflexivity |]. rewrite IH, same by (intros; try apply same; lia). ring. Qed.

Lemma total_plus n v w : total n (fun j => v j + w j) = total n v + total n w.
Proof. induction n as [| n IH]; simpl; [ring |]. rewrite IH. ring. Qed.

Lemma total_scal n a v : total n (fun j => a * v j) = a * total n v.
Proof. induction n as [| n IH]; simpl; [ring |]. rewrite IH. ring. Qed.

Lemma total_zero n : total n (fun _ => 0) = 0.
Proof. induction n as [| n IH]; simpl; [reflexivity |]. rewrite IH. ring. Qed.

Lemma total_abs n v w : (forall j, (j < n)%nat -> Rabs (v j) <= w j) -> Rabs (total n v) <= total n w.
Proof.
  induction n as [| n IH]; intros small; simpl; [rewrite Rabs_R0; lra |].
  assert (Rabs (v n) <= w n) by (apply small; lia).
  assert (Rabs (total n v) <= total n w) by (apply IH; intros; apply small; lia).
  assert (Rabs (total n v + v n) <= Rabs (total n v) + Rabs (v n)) by apply Rabs_triang. lra.
Qed.

Lemma total_le n v w : (forall j, (j < n)%nat -> v j <= w j) -> total n v <= total n w.
Proof.
  induction n as [| n IH]; intros less; simpl; [lra |].
  assert (v n <= w n) by (apply less; lia). assert (total n v <= total n w) by (apply IH; intros; apply less; lia). lra.
Qed.

(** Sums over rows and over columns are the same. *)
Lemma total_swap n k a : total n (fun i => total k (a i)) = total k (fun j => total n (fun i => a i j)).
Proof. induction n as [| n IH]; simpl; [symmetry; apply total_zero |]. rewrite IH, <- total_plus. reflexivity. Qed.

Lemma total_unit n i v : (i < n)%nat -> total n (fun j => unit_matrix i j * v j) = v i.
Proof.
  induction n as [| n IH]; intros below; simpl; [lia |]. unfold unit_matrix at 2.
  destruct (Nat.eqb i n) eqn:last.
  - apply Nat.eqb_eq in last. subst i. rewrite (total_ext n _ (fun _ => 0)).
    + rewrite total_zero. ring.
    + intros j less. unfold unit_matrix. destruct (Nat.eqb n j) eqn:same; [apply Nat.eqb_eq in same; lia | ring].
  - apply Nat.eqb_neq in last. rewrite IH by lia. ring.
Qed.

Lemma total_derive n (f : nat -> R -> R) (df : nat -> R) t :
  (forall k, (k < n)%nat -> is_derive (f k) t (df k)) -> is_derive (fun s => total n (fun k => f k s)) t (total n df).
Proof.
  induction n as [| n IH]; intros each; simpl; [apply @is_derive_const |].
  apply (@is_derive_plus R_AbsRing R_NormedModule); [apply IH; intros; apply each; lia | apply each; lia].
Qed.

Lemma box_segment m r x y t : in_box m r x -> in_box m r y -> 0 <= t <= 1 -> in_box m r (segment x y t).
Proof.
  intros inx iny range j. unfold segment. specialize (inx j). specialize (iny j).
  replace (x j + t * (y j - x j) - m j) with ((1 - t) * (x j - m j) + t * (y j - m j)) by ring.
  apply Rle_trans with (1 := Rabs_triang _ _). rewrite !Rabs_mult, (Rabs_right (1 - t)), (Rabs_right t) by lra. nra.
Qed.

Lemma largest n (v : nat -> R) : exists l, forall k, (k < n)%nat -> Rabs (v k) <= Rabs (v l).
Proof.
  induction n as [| n [l most]]; [exists 0%nat; intros; lia |].
  destruct (Rle_lt_dec (Rabs (v n)) (Rabs (v l))) as [less | more].
  - exists l. intros k below. destruct (Nat.eq_dec k n) as [-> | other]; [exact less | apply most; lia].
  - exists n. intros k below. destruct (Nat.eq_dec k n) as [-> | other]; [lra |].
    specialize (most k ltac:(lia)). lra.
Qed.

(** A matrix with a left inverse, nearly, takes nothing but 0 to 0. *)
Lemma regular n (Z Y : nat -> nat -> R) :
  (forall i, (i < n)%nat -> total n (fun j => Rabs (unit_matrix i j - total n (fun k => Z i k * Y k j))) < 1) ->
  forall v, (forall i, (i < n)%nat -> total n (fun k => Y i k * v k) = 0) -> forall k, (k < n)%nat -> v k = 0.
Proof.
  intros near v zero.
  assert (found : exists l, forall k, (k < n)%nat -> Rabs (v k) <= Rabs (if Nat.ltb l n then v l else 0)).
  { destruct (largest n (fun k => if Nat.ltb k n then v k else 0)) as [l most]. exists l. intros k below.
    specialize (most k below). destruct (Nat.ltb k n) eqn:is; [exact most | apply Nat.ltb_ge in is; lia]. }
  destruct found as [l most]. destruct (Nat.ltb l n) eqn:below.
  2: { intros k less. specialize (most k less). rewrite Rabs_R0 in most. apply Rabs_eq_0.
       assert (0 <= Rabs (v k)) by apply Rabs_pos. lra. }
  apply Nat.ltb_lt in below. intros k less. apply Rabs_eq_0. specialize (near l below).
  assert (same : v l = total n (fun j => (unit_matrix l j - total n (fun i => Z l i * Y i j)) * v j)).
  { rewrite (total_ext n _ (fun j => unit_matrix l j * v j + (-1) * total n (fun i => Z l i * (Y i j * v j)))).
    - rewrite total_plus, total_scal, total_unit, <- total_swap by exact below.
      rewrite (total_ext n (fun i => total n (fun j => Z l i * (Y i j * v j))) (fun _ => 0)).
      + rewrite total_zero. ring.
      + intros i lessi. rewrite total_scal, zero by exact lessi. ring.
    - intros j _. rewrite (total_ext n (fun i => Z l i * (Y i j * v j)) (fun i => v j * (Z l i * Y i j))) by (intros; ring).
      rewrite total_scal. ring. }
  assert (bound : Rabs (v l) <= Rabs (v l) * total n (fun j => Rabs (unit_matrix l j - total n (fun i => Z l i * Y i j)))).
  { rewrite same at 1. rewrite <- total_scal. apply total_abs. intros j lessj. rewrite Rabs_mult, Rmult_comm.
    apply Rmult_le_compat_r; [apply Rabs_pos | apply most, lessj]. }
  assert (0 <= Rabs (v l)) by apply Rabs_pos. assert (0 <= Rabs (v k)) by apply Rabs_pos. specialize (most k less). nra.
Qed.

Section Newton.

Variable n : nat.
Variable F : nat -> (nat -> R) -> R.  (* the equations *)
Variable D : nat -> nat -> (nat -> R) -> R.  (* their partial derivatives *)
Variables m r : nat -> R.  (* the box *)
Variable Y : nat -> nat -> R.  (* near the inverse of the Jacobian *)
Variable q : R.

Definition off (i j : nat) (x : nat -> R) : R := Rabs (unit_matrix i j - total n (fun k => Y i k * D k j x)).

Hypothesis radii : forall j, (j < n)%nat -> 0 < r j.
Hypothesis no_more : forall j, (n <= j)%nat -> r j = 0.
Hypothesis derivatives : forall i x y t, (i < n)%nat -> in_box m r x -> in_box m r y -> 0 <= t <= 1 ->
  is_derive (fun s => F i (segment x y s)) t (total n (fun j => D i j (segment x y t) * (y j - x j))).
Hypothesis q_range : 0 <= q < 1.
Hypothesis contracts : forall i x, (i < n)%nat -> in_box m r x -> total n (fun j => off i j x * r j) <= q * r i.
Hypothesis inside : forall i x, (i < n)%nat -> in_box m r x ->
  Rabs (total n (fun k => Y i k * F k m)) + total n (fun j => off i j x * r j) <= r i.
Hypothesis injective : forall v, (forall i, (i < n)%nat -> total n (fun k => Y i k * v k) = 0) ->
  forall k, (k < n)%nat -> v k = 0.

Let step (x : nat -> R) (i : nat) : R := if Nat.ltb i n then x i - total n (fun k => Y i k * F k x) else m i.

Let radii_nonneg j : 0 <= r j.
Proof. destruct (Nat.lt_ge_cases j n) as [below | above]; [left; apply radii, below | rewrite no_more by exact above; lra]. Qed.

(** The mean value theorem, on the segment from [x] to [y]. *)
Let mean_value x y b i :
  in_box m r x -> in_box m r y -> (i < n)%nat -> (forall j, Rabs (y j - x j) <= b j) ->
  exists z, in_box m r z /\ Rabs (step y i - step x i) <= total n (fun j => off i j z * b j).
Proof.
  intros inx iny below near. unfold step. destruct (Nat.ltb i n) eqn:less; [| apply Nat.ltb_ge in less; lia]. clear less.
  set (g := fun t => segment x y t i - total n (fun k => Y i k * F k (segment x y t))).
  set (dg := fun t => total n (fun j => (unit_matrix i j - total n (fun k => Y i k * D k j (segment x y t))) * (y j - x j))).
  assert (slope : forall t, 0 <= t <= 1 -> is_derive g t (dg t)).
  { intros t range. unfold g, dg.
    replace (total n (fun j => (unit_matrix i j - total n (fun k => Y i k * D k j (segment x y t))) * (y j - x j)))
      with ((y i - x i) - total n (fun k => Y i k * total n (fun j => D k j (segment x y t) * (y j - x j)))).
    - apply (@is_derive_minus R_AbsRing R_NormedModule).
      + unfold segment. auto_derive; [trivial | ring].
      + apply (total_derive n (fun k s => Y i k * F k (segment x y s))). intros k less.
        apply is_derive_scal. apply derivatives; assumption.
    - rewrite (total_ext n (fun j => (unit_matrix i j - _) * _)
        (fun j => unit_matrix i j * (y j - x j) + (-1) * total n (fun k => Y i k * D k j (segment x y t) * (y j - x j)))).
      + rewrite total_plus, total_scal, total_unit by exact below. rewrite <- total_swap.
        rewrite (total_ext n (fun k => Y i k * _) (fun k => total n (fun j => Y i k * D k j (segment x y t) * (y j - x j)))).
        * ring.
        * intros k _. rewrite <- total_scal. apply total_ext. intros. ring.
      + intros j _. rewrite (total_ext n (fun k => _ * _ * _) (fun k => (y j - x j) * (Y i k * D k j (segment x y t))))
          by (intros; ring). rewrite total_scal. ring. }
  destruct (MVT_gen g 0 1 dg) as [t [range mean]].
  { intros t. rewrite Rmin_left, Rmax_right by lra. intros. apply slope. lra. }
  { intros t. rewrite Rmin_left, Rmax_right by lra. intros. apply continuity_pt_filterlim.
    apply (@ex_derive_continuous R_AbsRing R_NormedModule). eexists. apply slope. lra. }
  rewrite Rmin_left, Rmax_right in range by lra.
  replace (y i - total n (fun k => Y i k * F k y) - (x i - total n (fun k => Y i k * F k x))) with (g 1 - g 0).
  2: { unfold g. replace (segment x y 1) with y by (apply functional_extensionality; intros; unfold segment; ring).
       replace (segment x y 0) with x by (apply functional_extensionality; intros; unfold segment; ring). reflexivity. }
  exists (segment x y t). split; [apply box_segment; assumption |].
  rewrite mean, Rminus_0_r, Rmult_1_r. unfold dg. apply total_abs. intros j less. rewrite Rabs_mult.
  apply Rmult_le_compat_l; [apply Rabs_pos | apply near].
Qed.

Let beyond x i : (n <= i)%nat -> step x i = m i.
Proof. intros above. unfold step. destruct (Nat.ltb i n) eqn:less; [apply Nat.ltb_lt in less; lia | reflexivity]. Qed.

Let step_contracts x y d :
  0 <= d -> in_box m r x -> in_box m r y -> (forall j, Rabs (y j - x j) <= d * r j) ->
  forall i, Rabs (step y i - step x i) <= q * d * r i.
Proof.
  intros d_nonneg inx iny near i. destruct (Nat.lt_ge_cases i n) as [below | above].
  - destruct (mean_value x y (fun j => d * r j) i inx iny below near) as [z [inz less]].
    apply Rle_trans with (1 := less).
    rewrite (total_ext n _ (fun j => d * (off i j z * r j))) by (intros; ring). rewrite total_scal.
    specialize (contracts i z below inz). nra.
  - rewrite !beyond, no_more by exact above. unfold Rminus. rewrite Rplus_opp_r, Rabs_R0. lra.
Qed.

Let centre_in : in_box m r m.
Proof. intros j. unfold Rminus. rewrite Rplus_opp_r, Rabs_R0. apply radii_nonneg. Qed.

Let step_inside x : in_box m r x -> in_box m r (step x).
Proof.
  intros inx i. destruct (Nat.lt_ge_cases i n) as [below | above].
  - destruct (mean_value m x r i centre_in inx below inx) as [z [inz moved]]. specialize (inside i z below inz).
    assert (centre : step m i - m i = - total n (fun k => Y i k * F k m)).
    { unfold step. destruct (Nat.ltb i n) eqn:less; [ring | apply Nat.ltb_ge in less; lia]. }
    replace (step x i - m i) with ((step x i - step m i) + (step m i - m i)) by ring.
    apply Rle_trans with (1 := Rabs_triang _ _). rewrite centre, Rabs_Ropp. lra.
  - rewrite beyond by exact above. apply centre_in.
Qed.

Fixpoint iterate (k : nat) : nat -> R := match k with O => m | S l => step (iterate l) end.

Let iterate_in k : in_box m r (iterate k).
Proof. induction k; [exact centre_in | apply step_inside, IHk]. Qed.

Let iterate_near k j : Rabs (iterate (S k) j - iterate k j) <= q ^ k * r j.
Proof.
  revert j. induction k as [| k IH]; intros j.
  - simpl. rewrite Rmult_1_l. apply step_inside, centre_in.
  - replace (q ^ S k * r j) with (q * q ^ k * r j) by (simpl; ring).
    apply (step_contracts (iterate k) (iterate (S k)) (q ^ k)); [apply pow_le; lra | apply iterate_in .. | exact IH].
Qed.

Let iterate_far k l j : Rabs (iterate (k + l) j - iterate k j) <= q ^ k * r j / (1 - q).
Proof.
  assert (finer : Rabs (iterate (k + l) j - iterate k j) <= q ^ k * r j * ((1 - q ^ l) / (1 - q))).
  { induction l as [| l IH].
    - rewrite Nat.add_0_r. unfold Rminus at 1. rewrite Rplus_opp_r, Rabs_R0. simpl. right. field. lra.
    - replace (k + S l)%nat with (S (k + l)) by lia.
      replace (iterate (S (k + l)) j - iterate k j)
        with ((iterate (S (k + l)) j - iterate (k + l) j) + (iterate (k + l) j - iterate k j)) by ring.
      apply Rle_trans with (1 := Rabs_triang _ _). assert (one := iterate_near (k + l) j). rewrite pow_add in one.
      replace (q ^ k * r j * ((1 - q ^ S l) / (1 - q)))
        with (q ^ k * q ^ l * r j + q ^ k * r j * ((1 - q ^ l) / (1 - q))) by (simpl; field; lra). lra. }
  apply Rle_trans with (1 := finer). unfold Rdiv. rewrite <- Rmult_assoc.
  assert (0 <= q ^ k) by (apply pow_le; lra). assert (0 <= q ^ l) by (apply pow_le; lra).
  assert (0 <= r j) by apply radii_nonneg. assert (0 < / (1 - q)) by (apply Rinv_0_lt_compat; lra).
  apply Rmult_le_compat_r; [lra |]. assert (0 <= q ^ k * r j) by (apply Rmult_le_pos; lra). nra.
Qed.

Let vanishes (x a : R) : (forall k, Rabs x <= q ^ k * a) -> x = 0.
Proof.
  intros small. apply Rabs_eq_0.
  assert (limit : is_lim_seq (fun k => q ^ k * a) 0).
  { replace (Finite 0) with (Rbar_mult 0 a) by (simpl; f_equal; ring). apply is_lim_seq_scal_r, is_lim_seq_geom.
    rewrite Rabs_right; lra. }
  assert (bound : Rbar_le (Rabs x) 0) by exact (is_lim_seq_le _ _ _ _ small (is_lim_seq_const (Rabs x)) limit).
  simpl in bound. assert (0 <= Rabs x) by apply Rabs_pos. lra.
Qed.

Let limit_exists j : { x | forall k, Rabs (x - iterate k j) <= q ^ k * r j / (1 - q) }.
Proof.
  assert (cauchy : ex_lim_seq_cauchy (fun k => iterate k j)).
  { intros eps. assert (r_nonneg := radii_nonneg j).
    destruct (pow_lt_1_zero q) with (y := eps * (1 - q) / (2 * r j + 1)) as [N close].
    - rewrite Rabs_right; lra.
    - assert (0 < eps) by apply cond_pos. apply Rdiv_lt_0_compat; [apply Rmult_lt_0_compat |]; lra.
    - assert (near : forall k, (N <= k)%nat -> Rabs (iterate k j - iterate N j) < eps / 2).
      { intros k above. replace k with (N + (k - N))%nat by lia. apply Rle_lt_trans with (1 := iterate_far N (k - N) j).
        specialize (close N (Nat.le_refl N)). rewrite Rabs_right in close by (apply Rle_ge, pow_le; lra).
        assert (0 < eps) by apply cond_pos.
        apply Rmult_lt_reg_r with (1 - q); [lra |].
        replace (q ^ N * r j / (1 - q) * (1 - q)) with (q ^ N * r j) by (field; lra).
        apply Rmult_lt_compat_r with (r := 2 * r j + 1) in close; [| lra].
        replace (eps * (1 - q) / (2 * r j + 1) * (2 * r j + 1)) with (eps * (1 - q)) in close by (field; lra).
        assert (0 <= q ^ N) by (apply pow_le; lra). assert (0 < eps * (1 - q)) by (apply Rmult_lt_0_compat; lra). nra. }
      exists N. intros k l kN lN. assert (a := near k kN). assert (b := near l lN).
      replace (iterate k j - iterate l j) with ((iterate k j - iterate N j) - (iterate l j - iterate N j)) by ring.
      apply Rle_lt_trans with (1 := Rabs_triang _ _). rewrite Rabs_Ropp. lra. }
  apply ex_lim_seq_cauchy_corr in cauchy. exists (real (Lim_seq (fun k => iterate k j))).
  apply Lim_seq_correct' in cauchy. intros k.
  assert (shifted := proj1 (is_lim_seq_incr_n _ k _) cauchy).
  assert (distance : is_lim_seq (fun l => Rabs (iterate (l + k) j - iterate k j))
    (Rabs (real (Lim_seq (fun k => iterate k j)) - iterate k j))).
  { apply (is_lim_seq_abs _ (Finite (real (Lim_seq (fun k => iterate k j)) - iterate k j))).
    apply (is_lim_seq_minus' _ _ _ _ shifted (is_lim_seq_const (iterate k j))). }
  apply (is_lim_seq_le _ (fun _ => q ^ k * r j / (1 - q)) _ _) with (2 := distance) (3 := is_lim_seq_const _).
  intros l. rewrite Nat.add_comm. apply iterate_far.
Qed.

(** Exactly one zero of the equations lies in the box. *)
Theorem interval_newton :
  exists x, in_box m r x /\ (forall i, (i < n)%nat -> F i x = 0)
    /\ forall y, in_box m r y -> (forall i, (i < n)%nat -> F i y = 0) -> forall j, y j = x j.
Proof.
  set (x := fun j => proj1_sig (limit_exists j)).
  assert (close : forall k j, Rabs (x j - iterate k j) <= q ^ k / (1 - q) * r j).
  { intros k j. unfold x. destruct (limit_exists j) as [z near]; simpl. specialize (near k).
    replace (q ^ k / (1 - q) * r j) with (q ^ k * r j / (1 - q)) by (field; lra). exact near. }
  assert (power : forall k, 0 <= q ^ k / (1 - q)).
  { intros k. apply Rmult_le_pos; [apply pow_le; lra | left; apply Rinv_0_lt_compat; lra]. }
  assert (inx : in_box m r x).
  { intros j. apply Rnot_lt_le. intros outside.
    assert (zero : Rabs (x j - m j) - r j = 0).
    { apply vanishes with (r j / (1 - q)). intros k. rewrite Rabs_right by lra. specialize (close k j).
      replace (q ^ k * (r j / (1 - q))) with (q ^ k / (1 - q) * r j) by (field; lra).
      assert (Rabs (iterate k j - m j) <= r j) by apply iterate_in.
      replace (x j - m j) with ((x j - iterate k j) + (iterate k j - m j)) by ring.
      assert (sum := Rabs_triang (x j - iterate k j) (iterate k j - m j)). lra. }
    lra. }
  assert (fixed : forall y, in_box m r y -> (forall j, step y j = y j) -> forall i, (i < n)%nat -> F i y = 0).
  { intros y iny still. apply injective. intros i below. specialize (still i). unfold step in still.
    destruct (Nat.ltb i n) eqn:less; [lra | apply Nat.ltb_ge in less; lia]. }
  assert (zeros : forall y, in_box m r y -> (forall i, (i < n)%nat -> F i y = 0) -> forall j, step y j = y j).
  { intros y iny zero j. destruct (Nat.lt_ge_cases j n) as [below | above].
    - unfold step. destruct (Nat.ltb j n) eqn:less; [| apply Nat.ltb_ge in less; lia].
      rewrite (total_ext n _ (fun _ => 0)); [rewrite total_zero; ring |]. intros k inside_. rewrite zero by exact inside_. ring.
    - rewrite beyond by exact above. specialize (iny j). rewrite no_more in iny by exact above.
      assert (0 <= Rabs (y j - m j)) by apply Rabs_pos. assert (zero' : Rabs (y j - m j) = 0) by lra.
      apply Rabs_eq_0 in zero'. lra. }
  assert (still : forall j, step x j = x j).
  { intros j. apply Rminus_diag_uniq. apply vanishes with (2 * (r j / (1 - q))). intros k.
    assert (moved := step_contracts (iterate k) x (q ^ k / (1 - q)) (power k) (iterate_in k) inx (close k) j).
    assert (next := close (S k) j). simpl in next. rewrite Rabs_minus_sym in next.
    replace (step x j - x j) with ((step x j - step (iterate k) j) + (step (iterate k) j - x j)) by ring.
    apply Rle_trans with (1 := Rabs_triang _ _).
    assert (less : q * q ^ k / (1 - q) * r j <= q ^ k * (r j / (1 - q))).
    { replace (q * q ^ k / (1 - q) * r j) with (q * (q ^ k / (1 - q) * r j)) by (field; lra).
      replace (q ^ k * (r j / (1 - q))) with (1 * (q ^ k / (1 - q) * r j)) by (field; lra).
      apply Rmult_le_compat_r; [apply Rmult_le_pos; [apply power | apply radii_nonneg] | lra]. }
    replace (q * (q ^ k / (1 - q)) * r j) with (q * q ^ k / (1 - q) * r j) in moved by (field; lra). lra. }
  exists x. split; [exact inx | split; [apply fixed; assumption |]].
  intros y iny zero j. assert (stays := zeros y iny zero).
  assert (apart : forall k i, Rabs (y i - x i) <= q ^ k * 2 * r i).
  { induction k as [| k IH]; intros i.
    - simpl. replace (y i - x i) with ((y i - m i) - (x i - m i)) by ring.
      apply Rle_trans with (1 := Rabs_triang _ _). rewrite Rabs_Ropp. specialize (iny i). specialize (inx i). lra.
    - rewrite <- (stays i), <- (still i). replace (q ^ S k * 2 * r i) with (q * (q ^ k * 2) * r i) by (simpl; ring).
      apply step_contracts; try assumption. apply Rmult_le_pos; [apply pow_le |]; lra. }
  apply Rminus_diag_uniq. apply vanishes with (2 * r j). intros k. rewrite <- Rmult_assoc. apply apart.
Qed.

End Newton.
