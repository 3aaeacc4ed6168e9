(** The hypotheses of [interval_newton] for a system of formulas, checked by a computation in Coq's kernel. *)

From Coquelicot Require Import Coquelicot.
From Coq Require Import Reals ZArith Bool List Lra Lia Psatz.
From Pinball Require Import Newton Jets.
Open Scope R_scope.

(** Rational numbers and matrices with one denominator. *)
Definition entry (den : Z) (row : list Z) (j : nat) : R := IZR (nth j row 0%Z) / IZR den.
Definition entries (den : Z) (rows : list (list Z)) (i j : nat) : R := entry den (nth i rows nil) j.

Section Check.

Variable prec : I.F.precision.
Variable n : nat.
Variable system : list formula.
Variable den : Z.
Variables centre radius : list Z.
Variable inverse_den : Z.
Variable inverse : list (list Z).  (* near the inverse of the Jacobian at the centre *)
Variable jacobian_den : Z.
Variable jacobian : list (list Z).  (* near the Jacobian: shows that [inverse] is regular *)

Definition middle : nat -> R := entry den centre.
Definition reach (j : nat) : R := if Nat.ltb j n then entry den radius j else 0.

Definition rational (d : Z) (row : list Z) (j : nat) : I.type := I.div prec (I.fromZ prec (nth j row 0%Z)) (I.fromZ prec d).

Definition point : nat -> I.type := rational den centre.
Definition around (j : nat) : I.type :=
  let size := if Nat.ltb j n then rational den radius j else I.fromZ prec 0 in
  I.meet (I.lower_extent (I.add prec (point j) size)) (I.upper_extent (I.sub prec (point j) size)).

(** Lists are computed once. *)
Definition table (f : nat -> I.type) : list I.type := map f (seq 0 n).
Definition looked_up (X : list I.type) (j : nat) : I.type := nth j X I.nai.

Definition equation (i : nat) : formula := nth i system (Int 1).
Definition unit_enclosure (i j : nat) : I.type := I.fromZ prec (if Nat.eqb i j then 1 else 0).

Definition row_checked (at_centre : list I.type) (over_box : list (list I.type)) (i : nat) : bool :=
  let row := table (rational inverse_den (nth i inverse nil)) in
  let moved := I.abs (sum prec n (fun k => I.mul prec (looked_up row k) (looked_up at_centre k))) in
  let apart j := I.abs (I.sub prec (unit_enclosure i j)
    (sum prec n (fun k => I.mul prec (looked_up row k) (looked_up (nth k over_box nil) j)))) in
  let spread := sum prec n (fun j => I.mul prec (apart j) (rational den radius j)) in
  let r := rational den radius i in
  negative (I.neg r)
  && negative (I.sub prec (I.add prec spread spread) r)
  && negative (I.sub prec (I.add prec moved spread) r).

Definition regular_checked (i : nat) : bool :=
  let row := table (rational jacobian_den (nth i jacobian nil)) in
  negative (I.sub prec
    (sum prec n (fun j => I.abs (I.sub prec (unit_enclosure i j)
      (sum prec n (fun k => I.mul prec (looked_up row k) (rational inverse_den (nth k inverse nil) j))))))
    (I.fromZ prec 1)).

Fixpoint gathered {A} (items : list (option A)) : option (list A) :=
  match items with
  | nil => Some nil
  | Some a :: rest => match gathered rest with Some others => Some (a :: others) | None => None end
  | None :: _ => None
  end.

Definition checked : bool :=
  Nat.eqb (length system) n &&
  match gathered (map (enclose prec 0 point) system), gathered (map (enclose prec n around) system) with
  | Some centres, Some boxes =>
      forallb (row_checked (map fst centres) (map snd boxes)) (seq 0 n) && forallb regular_checked (seq 0 n)
  | _, _ => false
  end.

Lemma gathered_nth A (f : formula -> option A) es found (a : A) e i :
  gathered (map f es) = Some found -> (i < length es)%nat -> f (nth i es e) = Some (nth i found a).
Proof.
  revert found i. induction es as [| b es IH]; intros found i; simpl; [lia |].
  destruct (f b) eqn:first; [| discriminate]. destruct (gathered (map f es)) as [others |] eqn:rest; [| discriminate].
  intros [= <-] below. destruct i as [| i]; simpl; [exact first |]. apply IH; [reflexivity | lia].
Qed.

(** Formulas that are positive all over the box. *)
Definition positive_checked (es : list formula) : bool :=
  forallb (fun e => match enclose prec 0 around e with Some (v, _) => negative (I.neg v) | None => false end) es.

Lemma rational_holds d row j : holds (rational d row j) (entry d row j).
Proof. apply holds_div; apply holds_int. Qed.

Lemma unit_holds i j : holds (unit_enclosure i j) (unit_matrix i j).
Proof. unfold unit_enclosure, unit_matrix. destruct (Nat.eqb i j); apply holds_int. Qed.

Lemma around_holds x j : in_box middle reach x -> holds (around j) (x j).
Proof.
  intros inside. specialize (inside j). apply Rabs_le_between in inside. unfold around.
  apply holds_between with (middle j - reach j) (middle j + reach j); [| | lra].
  - apply holds_sub; [apply rational_holds |]. unfold reach. destruct (Nat.ltb j n); [apply rational_holds | apply (holds_int prec 0)].
  - apply holds_add; [apply rational_holds |]. unfold reach. destruct (Nat.ltb j n); [apply rational_holds | apply (holds_int prec 0)].
Qed.

Theorem checked_positive es x e : positive_checked es = true -> in_box middle reach x -> In e es -> 0 < value x e.
Proof.
  intros yes inx there. unfold positive_checked in yes. rewrite forallb_forall in yes. specialize (yes e there).
  destruct (enclose prec 0 around e) as [[v d] |] eqn:found; [| discriminate].
  destruct (enclose_holds prec 0 around x e v d (fun j => around_holds x j inx) found) as [held _].
  assert (less := negative_holds _ _ yes (holds_neg _ _ held)). lra.
Qed.

Lemma looked_up_table f j : (j < n)%nat -> looked_up (table f) j = f j.
Proof.
  intros below. unfold looked_up, table.
  rewrite nth_indep with (d' := f 0%nat) by (rewrite map_length, seq_length; exact below).
  rewrite map_nth, seq_nth by exact below. reflexivity.
Qed.

Lemma all_below (f : nat -> bool) i : forallb f (seq 0 n) = true -> (i < n)%nat -> f i = true.
Proof. intros all below. rewrite forallb_forall in all. apply all, in_seq. lia. Qed.

(** A computation that says yes is a proof: exactly one zero of the system lies in the box. *)
Theorem checked_zero :
  checked = true ->
  exists x, in_box middle reach x /\ (forall i, (i < n)%nat -> value x (equation i) = 0)
    /\ forall y, in_box middle reach y -> (forall i, (i < n)%nat -> value y (equation i) = 0) -> forall j, y j = x j.
Proof.
  intros yes. unfold checked in yes. apply andb_prop in yes as [long yes]. apply Nat.eqb_eq in long.
  destruct (gathered (map (enclose prec 0 point) system)) as [centres |] eqn:at_centre; [| discriminate].
  destruct (gathered (map (enclose prec n around) system)) as [boxes |] eqn:over_box; [| discriminate].
  apply andb_prop in yes as [rows regular_rows].
  assert (centre_in : forall j, holds (point j) (middle j)) by (intros; apply rational_holds).
  set (none := (I.nai, nil) : jet).
  assert (value_holds : forall k, (k < n)%nat -> holds (looked_up (map fst centres) k) (value middle (equation k))).
  { intros k below. assert (found := gathered_nth _ _ _ _ none (Int 1) k at_centre ltac:(lia)).
    destruct (enclose_holds prec 0 point middle (equation k) (fst (nth k centres none)) (snd (nth k centres none)) centre_in) as [held _].
    - unfold equation. rewrite found. destruct (nth k centres none); reflexivity.
    - unfold looked_up. replace I.nai with (fst none) by reflexivity. rewrite map_nth. exact held. }
  assert (partial_holds : forall x k, in_box middle reach x -> (k < n)%nat ->
    defined x (equation k) /\ forall j, (j < n)%nat -> holds (looked_up (nth k (map snd boxes) nil) j) (partial x (equation k) j)).
  { intros x k inx below. assert (found := gathered_nth _ _ _ _ none (Int 1) k over_box ltac:(lia)).
    destruct (enclose_holds prec n around x (equation k) (fst (nth k boxes none)) (snd (nth k boxes none))
      (fun j => around_holds x j inx)) as [_ [[_ held] def]].
    - unfold equation. rewrite found. destruct (nth k boxes none); reflexivity.
    - split; [exact def |]. intros j less. unfold looked_up. replace (@nil I.type) with (snd none) by reflexivity.
      rewrite map_nth. exact (held j less). }
  assert (reach_is : forall i, (i < n)%nat -> reach i = entry den radius i).
  { intros i below. unfold reach. destruct (Nat.ltb i n) eqn:is; [reflexivity | apply Nat.ltb_ge in is; lia]. }
  set (Y := entries inverse_den inverse).
  set (f := fun i x => value x (equation i)).
  set (D := fun i j x => partial x (equation i) j).
  assert (facts : forall i x, (i < n)%nat -> in_box middle reach x ->
    0 < reach i /\ total n (fun j => off n D Y i j x * reach j) <= / 2 * reach i
    /\ Rabs (total n (fun k => Y i k * f k middle)) + total n (fun j => off n D Y i j x * reach j) <= reach i).
  { intros i x below inx. assert (row := all_below _ i rows below). unfold row_checked in row.
    apply andb_prop in row as [row third]. apply andb_prop in row as [first second].
    assert (r_holds := rational_holds den radius i). rewrite <- reach_is in r_holds by exact below.
    assert (positive := negative_holds _ _ first (holds_neg _ _ r_holds)).
    assert (row_is : forall k, (k < n)%nat -> holds (looked_up (table (rational inverse_den (nth i inverse nil))) k) (Y i k)).
    { intros k less. rewrite looked_up_table by exact less. apply rational_holds. }
    set (spread := sum prec n _) in second, third. set (moved := I.abs (sum _ _ _)) in third.
    assert (spread_holds : holds spread (total n (fun j => off n D Y i j x * reach j))).
    { apply holds_sum. intros j less. rewrite reach_is by exact less. apply holds_mul; [| apply rational_holds].
      apply holds_abs, holds_sub; [apply unit_holds |]. apply holds_sum. intros k lessk.
      apply holds_mul; [apply row_is, lessk | apply partial_holds; assumption]. }
    assert (moved_holds : holds moved (Rabs (total n (fun k => Y i k * f k middle)))).
    { apply holds_abs, holds_sum. intros k lessk. apply holds_mul; [apply row_is, lessk | apply value_holds, lessk]. }
    assert (half := negative_holds _ _ second (holds_sub _ _ _ _ _ (holds_add _ _ _ _ _ spread_holds spread_holds) r_holds)).
    assert (enough := negative_holds _ _ third (holds_sub _ _ _ _ _ (holds_add _ _ _ _ _ moved_holds spread_holds) r_holds)).
    repeat split; lra. }
  assert (centre_inside : in_box middle reach middle).
  { intros j. unfold Rminus. rewrite Rplus_opp_r, Rabs_R0. unfold reach. destruct (Nat.ltb j n) eqn:is; [| lra].
    apply Nat.ltb_lt in is. rewrite <- reach_is by exact is.
    (* the radius is positive by its own row of the check *)
    assert (row := all_below _ j rows is). unfold row_checked in row.
    apply andb_prop in row as [row _]. apply andb_prop in row as [row _].
    assert (less := negative_holds _ _ row (holds_neg _ _ (rational_holds den radius j))). rewrite <- reach_is in less by exact is.
    lra. }
  apply (interval_newton n f D middle reach Y (/ 2)).
  - intros j below. apply (facts j middle below centre_inside).
  - intros j above. unfold reach. destruct (Nat.ltb j n) eqn:is; [apply Nat.ltb_lt in is; lia | reflexivity].
  - intros i x y t below inx iny range. apply (partial_derivatives n x y t (equation i)).
    + intros j above. assert (zero : reach j = 0).
      { unfold reach. destruct (Nat.ltb j n) eqn:is; [apply Nat.ltb_lt in is; lia | reflexivity]. }
      specialize (inx j). specialize (iny j). rewrite zero in inx, iny. apply Rabs_le_between in inx, iny. lra.
    + apply partial_holds; [| exact below]. apply box_segment; assumption.
  - lra.
  - intros i x below inx. apply (facts i x below inx).
  - intros i x below inx. apply (facts i x below inx).
  - intros v zero. apply (regular n (entries jacobian_den jacobian) Y); [| exact zero].
    intros i below. assert (row := all_below _ i regular_rows below). unfold regular_checked in row.
    set (size := sum prec n _) in row.
    assert (size_holds : holds size
      (total n (fun j => Rabs (unit_matrix i j - total n (fun k => entries jacobian_den jacobian i k * Y k j))))).
    { apply holds_sum. intros j less. apply holds_abs, holds_sub; [apply unit_holds |]. apply holds_sum. intros k lessk.
      apply holds_mul; [rewrite looked_up_table by exact lessk; apply rational_holds | apply rational_holds]. }
    assert (less := negative_holds _ _ row (holds_sub _ _ _ _ _ size_holds (holds_int prec 1))). lra.
Qed.

End Check.
