(** Two period doublings of the egg at [alpha = 2/25]: cycles of period 4 and of period 8 with the multiplier -1.
    Paper: section 6.6, lambda_3 and lambda_4. *)

From Coquelicot Require Import Coquelicot.
From Coq Require Import Reals ZArith List Lra Lia Psatz.
From Pinball Require Import Newton Jets Checked Bounce Generated Cascade Equations Boxes.
Open Scope R_scope.

(** * A cycle of period [n] with the multiplier -1: the unknowns are the points, the contraction, and all entries of the
    null vector but the first, which is 1 *)

Section Period.

Variable n : nat.
Hypothesis long : (2 <= n)%nat.

Definition next (j : nat) : nat := Nat.modulo (S j) n.
Definition before (j : nat) : nat := Nat.modulo (j + (n - 1)) n.
Definition entry_ (j : nat) : formula := match j with O => Int 1 | _ => Var (n + j) end.
Definition reversed_ (e : formula) : formula := Mul (Int (-1)) e.

Definition laws : list formula := map (fun j => law_ (Var (before j)) (Var j) (Var (next j)) (Var n)) (seq 0 n).
Definition nulls : list formula :=
  map (fun j => moves_ (Var (before j)) (Var j) (Var (next j)) (Var n)
    (if Nat.eqb j 0 then reversed_ (entry_ (n - 1)) else entry_ (j - 1))
    (entry_ j)
    (if Nat.eqb j (n - 1) then reversed_ (entry_ 0) else entry_ (S j))) (seq 0 n).
Definition doubling_system : list formula := laws ++ nulls.

(** The chords leave and land on the inner side. *)
Definition chords : list formula :=
  map (fun j => normal_ (Var j) (Var (next j))) (seq 0 n) ++ map (fun j => normal_ (Var (next j)) (Var j)) (seq 0 n).

Variable x : nat -> R.
Hypothesis zero : forall i, (i < 2 * n)%nat -> value x (nth i doubling_system (Int 1)) = 0.
Hypothesis chords_inside : forall e, In e chords -> 0 < value x e.

Definition theta (i : nat) : R := x (Nat.modulo i n).
Definition phi (i : nat) : R := angle shape (theta i) (theta (S i)).
Definition eta (i : nat) : R := match i with O => 0 | S j => angle shape (theta i) (theta j) end.
Definition t (i : nat) : R := sqrt (square shape (theta i) (theta (S i))).
Definition w (j : nat) : R := match j with O => 1 | _ => x (n + j)%nat end.
Definition v (i : nat) : R := if Nat.even (Nat.div i n) then w (Nat.modulo i n) else - w (Nat.modulo i n).

Lemma below i : (Nat.modulo i n < n)%nat.
Proof. apply Nat.mod_upper_bound. lia. Qed.

Lemma next_mod i : next (Nat.modulo i n) = Nat.modulo (S i) n.
Proof.
  unfold next. replace (S (Nat.modulo i n)) with (Nat.modulo i n + 1)%nat by lia.
  rewrite Nat.add_mod_idemp_l by lia. f_equal. lia.
Qed.

Lemma before_mod i : before (Nat.modulo (S i) n) = Nat.modulo i n.
Proof.
  unfold before. rewrite Nat.add_mod_idemp_l by lia. replace (S i + (n - 1))%nat with (i + 1 * n)%nat by lia.
  apply Nat.mod_add. lia.
Qed.

Lemma law_holds j : (j < n)%nat -> angle shape (x j) (x (next j)) = - x n * angle shape (x j) (x (before j)).
Proof.
  intros less. assert (found := zero j ltac:(lia)). unfold doubling_system in found.
  rewrite app_nth1 in found by (unfold laws; rewrite map_length, seq_length; lia). unfold laws in found.
  rewrite nth_indep with (d' := law_ (Var (before 0)) (Var 0) (Var (next 0)) (Var n)) in found
    by (rewrite map_length, seq_length; lia).
  rewrite (map_nth (fun j => law_ (Var (before j)) (Var j) (Var (next j)) (Var n)) (seq 0 n) 0%nat), seq_nth in found by lia.
  rewrite value_law in found. cbn [value Nat.add] in found. lra.
Qed.

Lemma null_holds j : (j < n)%nat ->
  moves_along shape (x n) (x (before j)) (x j) (x (next j))
    (if Nat.eqb j 0 then - w (n - 1) else w (j - 1)) (w j) (if Nat.eqb j (n - 1) then - w 0 else w (S j)).
Proof.
  intros less. assert (found := zero (n + j) ltac:(lia)). unfold doubling_system in found.
  assert (size : length laws = n) by (unfold laws; rewrite map_length, seq_length; reflexivity).
  rewrite app_nth2 in found by lia. rewrite size in found. replace (n + j - n)%nat with j in found by lia.
  unfold nulls in found.
  set (f := fun j : nat => _) in found.
  rewrite nth_indep with (d' := f 0%nat) in found by (rewrite map_length, seq_length; lia).
  rewrite (map_nth f), seq_nth in found by lia. unfold f in found. apply value_moves in found.
  cbn [value Nat.add] in found.
  assert (entry_is : forall i, value x (entry_ i) = w i) by (intros [| i]; reflexivity).
  replace (- w (n - 1)) with (value x (reversed_ (entry_ (n - 1)))) by (unfold reversed_; cbn [value]; rewrite entry_is; lra).
  replace (- w 0) with (value x (reversed_ (entry_ 0))) by (unfold reversed_; cbn [value]; rewrite entry_is; lra).
  rewrite entry_is in found.
  destruct (Nat.eqb j 0); destruct (Nat.eqb j (n - 1)); rewrite ?entry_is in found; exact found.
Qed.

Lemma every_bounce i : follows shape (x n) theta phi eta t i.
Proof.
  assert (chord : forall j, (j < n)%nat -> 0 < normal shape (x j) (x (next j)) /\ 0 < normal shape (x (next j)) (x j)).
  { intros j less. split.
    - replace (normal shape (x j) (x (next j))) with (value x (normal_ (Var j) (Var (next j)))) by apply value_normal.
      apply chords_inside. unfold chords. apply in_or_app. left.
      apply (in_map (fun j => normal_ (Var j) (Var (next j)))). apply in_seq. lia.
    - replace (normal shape (x (next j)) (x j)) with (value x (normal_ (Var (next j)) (Var j))) by apply value_normal.
      apply chords_inside. unfold chords. apply in_or_app. right.
      apply (in_map (fun j => normal_ (Var (next j)) (Var j))). apply in_seq. lia. }
  split.
  - unfold phi, eta, t, theta. destruct (chord (Nat.modulo i n) (below i)) as [out in_]. rewrite next_mod in out, in_.
    apply flight_exists; try apply speed_pos; assumption.
  - unfold phi, eta, theta. assert (law := law_holds (Nat.modulo (S i) n) (below (S i))).
    rewrite next_mod, before_mod in law. exact law.
Qed.

Lemma theta_back i : theta (n + i) = theta i.
Proof. unfold theta. replace (n + i)%nat with (i + 1 * n)%nat by lia. rewrite Nat.mod_add by lia. reflexivity. Qed.

Lemma v_back i : v (n + i) = - v i.
Proof.
  unfold v. replace (n + i)%nat with (i + 1 * n)%nat by lia. rewrite Nat.mod_add, Nat.div_add by lia.
  rewrite Nat.add_1_r, Nat.even_succ, <- Nat.negb_even. destruct (Nat.even (i / n)); simpl; ring.
Qed.

Lemma v_first j : (j < n)%nat -> v j = w j.
Proof. intros less. unfold v. rewrite Nat.div_small, Nat.mod_small by exact less. reflexivity. Qed.

Lemma theta_first j : (j < n)%nat -> theta j = x j.
Proof. intros less. unfold theta. rewrite Nat.mod_small by exact less. reflexivity. Qed.

Lemma every_move i : (i < n)%nat ->
  moves_along shape (x n) (theta i) (theta (S i)) (theta (S (S i))) (v i) (v (S i)) (v (S (S i))).
Proof.
  intros less. assert (null := null_holds (Nat.modulo (S i) n) (below (S i))).
  rewrite next_mod, before_mod in null. fold (theta (S (S i))) (theta i) in null. unfold theta at 2.
  assert (w0 : v n = - w 0) by (replace n with (n + 0)%nat at 1 by lia; rewrite v_back, v_first by lia; reflexivity).
  assert (w1 : v (S n) = - w 1) by (replace (S n) with (n + 1)%nat at 1 by lia; rewrite v_back, v_first by lia; reflexivity).
  destruct (Nat.eq_dec (S i) n) as [last | inner].
  - replace (Nat.modulo (S i) n) with 0%nat in * by (rewrite last, Nat.mod_same by lia; reflexivity).
    destruct (Nat.eqb 0 (n - 1)) eqn:small; [apply Nat.eqb_eq in small; lia |]. cbn [Nat.eqb] in null.
    rewrite (v_first i), last, w0, w1 by lia. replace (n - 1)%nat with i in null by lia.
    rewrite last in null. unfold moves_along in *. lra.
  - rewrite (Nat.mod_small (S i)) in null |- * by lia.
    change (Nat.eqb (S i) 0) with false in null. replace (S i - 1)%nat with i in null by lia.
    rewrite (v_first i), (v_first (S i)) by lia.
    destruct (Nat.eqb (S i) (n - 1)) eqn:near.
    + apply Nat.eqb_eq in near. replace (S (S i)) with n in * by lia. rewrite w0. exact null.
    + apply Nat.eqb_neq in near. rewrite (v_first (S (S i))) by lia. exact null.
Qed.

Theorem zero_is_a_doubling :
  is_cycle shape (x n) theta phi eta t n /\ characteristic (monodromy shape (x n) theta phi eta t n) (- 1) = 0.
Proof.
  assert (back : forall i, theta (n + i) = theta i) by exact theta_back.
  assert (th0 : theta n = theta 0%nat) by (rewrite <- (back 0%nat); f_equal; lia).
  assert (th1 : theta (S n) = theta 1%nat) by (rewrite <- (back 1%nat); f_equal; lia).
  assert (ph : phi n = phi 0%nat) by (unfold phi; rewrite th0, th1; reflexivity).
  split; [split; [intros; apply every_bounce | split; assumption] |].
  apply (reversed_is_multiplier shape (x n) theta phi eta t v).
  - intros i. apply speed_pos.
  - intros i _. apply every_bounce.
  - exact every_move.
  - exact th0.
  - exact th1.
  - exact ph.
  - replace (eta 1) with (angle shape (theta 1) (theta 0)) by reflexivity. rewrite <- th0, <- th1. reflexivity.
  - unfold t. rewrite th0, th1. reflexivity.
  - rewrite <- (v_back 0). f_equal. lia.
  - rewrite <- (v_back 1). f_equal. lia.
  - rewrite v_first by lia. simpl. lra.
Qed.

End Period.

(** * The two doublings at [alpha = 2/25] *)

Definition bits : I.F.precision := I.F.PtoP 130.

Definition in_doubling3 : (nat -> R) -> Prop := in_box (middle doubling3_den doubling3_centre) (reach 8 doubling3_den doubling3_radius).
Definition in_doubling4 : (nat -> R) -> Prop := in_box (middle doubling4_den doubling4_centre) (reach 16 doubling4_den doubling4_radius).

Ltac computed := vm_cast_no_check (eq_refl true).

(** [lambda_3], where period 4 becomes period 8; in the box there is no other. *)
Theorem doubling_of_period_4 :
  exists x, in_doubling3 x
    /\ is_cycle shape (x 4%nat) (theta 4 x) (phi 4 x) (eta 4 x) (t 4 x) 4
    /\ characteristic (monodromy shape (x 4%nat) (theta 4 x) (phi 4 x) (eta 4 x) (t 4 x) 4) (- 1) = 0
    /\ forall y, in_doubling3 y -> (forall i, (i < 8)%nat -> value y (nth i (doubling_system 4) (Int 1)) = 0) ->
       forall j, y j = x j.
Proof.
  destruct (checked_zero bits 8 (doubling_system 4) doubling3_den doubling3_centre doubling3_radius
    doubling3_matrix_den doubling3_inverse doubling3_matrix_den doubling3_jacobian) as [x [inside [zero alone]]]; [computed |].
  exists x. split; [exact inside |].
  destruct (zero_is_a_doubling 4 ltac:(lia) x zero) as [cycle multiplier].
  - intros e there. apply (checked_positive bits 8 doubling3_den doubling3_centre doubling3_radius (chords 4)); [computed | exact inside | exact there].
  - split; [exact cycle | split; [exact multiplier | exact alone]].
Qed.

Theorem doubling_of_period_8 :
  exists x, in_doubling4 x
    /\ is_cycle shape (x 8%nat) (theta 8 x) (phi 8 x) (eta 8 x) (t 8 x) 8
    /\ characteristic (monodromy shape (x 8%nat) (theta 8 x) (phi 8 x) (eta 8 x) (t 8 x) 8) (- 1) = 0
    /\ forall y, in_doubling4 y -> (forall i, (i < 16)%nat -> value y (nth i (doubling_system 8) (Int 1)) = 0) ->
       forall j, y j = x j.
Proof.
  destruct (checked_zero bits 16 (doubling_system 8) doubling4_den doubling4_centre doubling4_radius
    doubling4_matrix_den doubling4_inverse doubling4_matrix_den doubling4_jacobian) as [x [inside [zero alone]]]; [computed |].
  exists x. split; [exact inside |].
  destruct (zero_is_a_doubling 8 ltac:(lia) x zero) as [cycle multiplier].
  - intros e there. apply (checked_positive bits 16 doubling4_den doubling4_centre doubling4_radius (chords 8)); [computed | exact inside | exact there].
  - split; [exact cycle | split; [exact multiplier | exact alone]].
Qed.
(** The decimals of one coordinate of a box. *)
Ltac coordinate inside j :=
  let found := fresh "found" in
  assert (found := inside j%nat); unfold in_doubling3, in_doubling4, in_box, middle, reach, entry in found;
  change (Nat.ltb j _) with true in found; cbv iota in found;
  match type of found with
  | Rabs (_ - IZR ?p / IZR ?q) <= IZR ?r / IZR ?q =>
      let p' := eval vm_compute in p in let q' := eval vm_compute in q in let r' := eval vm_compute in r in
      change p with p' in found; change q with q' in found; change r with r' in found
  end;
  apply Rabs_le_between in found.

(** [lambda_3]: a cycle of period 4, at four points, has the multiplier -1. *)
Theorem lambda_3_enclosed :
  exists lam theta phi eta t,
    0.371235502527919523 < lam < 0.371235502527919524
    /\ is_cycle shape lam theta phi eta t 4 /\ characteristic (monodromy shape lam theta phi eta t 4) (- 1) = 0
    /\ - PI < theta 1%nat < theta 2%nat /\ theta 2%nat < theta 0%nat /\ theta 0%nat < theta 3%nat < PI.
Proof.
  destruct doubling_of_period_4 as [x [inside [cycle [multiplier _]]]].
  exists (x 4%nat), (theta 4 x), (phi 4 x), (eta 4 x), (t 4 x).
  coordinate inside 4%nat. split; [lra |]. split; [exact cycle |]. split; [exact multiplier |]. clear cycle multiplier found.
  change (theta 4 x 0) with (x 0%nat). change (theta 4 x 1) with (x 1%nat).
  change (theta 4 x 2) with (x 2%nat). change (theta 4 x 3) with (x 3%nat).
  coordinate inside 0%nat. coordinate inside 1%nat. coordinate inside 2%nat. coordinate inside 3%nat.
  assert (pi := PI2_3_2).
  split; [lra |]. split; lra.
Qed.

(** [lambda_4]: a cycle of period 8 has the multiplier -1; it is not one of period 4 run through twice. *)
Theorem lambda_4_enclosed :
  exists lam theta phi eta t,
    0.388761023460840300 < lam < 0.388761023460840301
    /\ is_cycle shape lam theta phi eta t 8 /\ characteristic (monodromy shape lam theta phi eta t 8) (- 1) = 0
    /\ (forall i, (i < 8)%nat -> - PI < theta i < PI)
    /\ forall i j, (i < j < 8)%nat -> theta i <> theta j.
Proof.
  destruct doubling_of_period_8 as [x [inside [cycle [multiplier _]]]].
  exists (x 8%nat), (theta 8 x), (phi 8 x), (eta 8 x), (t 8 x).
  coordinate inside 8%nat. split; [lra |]. split; [exact cycle |]. split; [exact multiplier |]. clear cycle multiplier found.
  assert (same : forall i, (i < 8)%nat -> theta 8 x i = x i) by (intros; apply theta_first; assumption).
  coordinate inside 0%nat. coordinate inside 1%nat. coordinate inside 2%nat. coordinate inside 3%nat.
  coordinate inside 4%nat. coordinate inside 5%nat. coordinate inside 6%nat. coordinate inside 7%nat.
  assert (pi := PI2_3_2). clear inside. split.
  - intros i below. rewrite same by exact below. clear same.
    destruct i as [| [| [| [| [| [| [| [| i]]]]]]]]; [lra .. | lia].
  - intros i j below. rewrite !same by lia. clear same.
    destruct j as [| [| [| [| [| [| [| [| j]]]]]]]]; try lia;
      destruct i as [| [| [| [| [| [| [| i]]]]]]]; try lia; apply Rlt_dichotomy_converse; first [left; lra | right; lra].
Qed.
