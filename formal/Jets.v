(** Formulas, their partial derivatives, and enclosures of both over a box of intervals. *)

From Coq Require Import Reals ZArith Bool List Lra Lia Psatz.
From Coquelicot Require Import Coquelicot.
From Interval.Real Require Import Xreal.
From Interval.Interval Require Import Interval Float Float_full.
From Interval.Float Require Import Basic Specific_bigint Specific_ops.
From Pinball Require Import Newton.
Open Scope R_scope.

Module F := SpecificFloat BigIntRadix2.
Module I := FloatIntervalFull F.

Inductive formula :=
  | Var (i : nat) | Int (z : Z) | Pi
  | Add (a b : formula) | Sub (a b : formula) | Mul (a b : formula) | Div (a b : formula)
  | Sin (a : formula) | Cos (a : formula) | Atan (a : formula).

Fixpoint value (x : nat -> R) (e : formula) : R :=
  match e with
  | Var i => x i
  | Int z => IZR z
  | Pi => PI
  | Add a b => value x a + value x b
  | Sub a b => value x a - value x b
  | Mul a b => value x a * value x b
  | Div a b => value x a / value x b
  | Sin a => sin (value x a)
  | Cos a => cos (value x a)
  | Atan a => atan (value x a)
  end.

(** No division by zero. *)
Fixpoint defined (x : nat -> R) (e : formula) : Prop :=
  match e with
  | Var _ | Int _ | Pi => True
  | Add a b | Sub a b | Mul a b => defined x a /\ defined x b
  | Div a b => defined x a /\ defined x b /\ value x b <> 0
  | Sin a | Cos a | Atan a => defined x a
  end.

(** The partial derivative by unknown [j]. *)
Fixpoint partial (x : nat -> R) (e : formula) (j : nat) : R :=
  match e with
  | Var i => unit_matrix i j
  | Int _ | Pi => 0
  | Add a b => partial x a j + partial x b j
  | Sub a b => partial x a j - partial x b j
  | Mul a b => partial x a j * value x b + value x a * partial x b j
  | Div a b => (partial x a j - value x a / value x b * partial x b j) / value x b
  | Sin a => cos (value x a) * partial x a j
  | Cos a => - (sin (value x a) * partial x a j)
  | Atan a => partial x a j / (1 + value x a * value x a)
  end.

Lemma partial_derivatives n x y t e :
  (forall j, (n <= j)%nat -> y j = x j) -> defined (segment x y t) e ->
  is_derive (fun s => value (segment x y s) e) t (total n (fun j => partial (segment x y t) e j * (y j - x j))).
Proof.
  intros same. set (w := segment x y t).
  assert (linear : forall (f g : nat -> R) a b,
    total n (fun j => (a * f j + b * g j) * (y j - x j))
    = a * total n (fun j => f j * (y j - x j)) + b * total n (fun j => g j * (y j - x j))).
  { intros f g a b. rewrite <- !total_scal, <- total_plus. apply total_ext. intros. ring. }
  assert (scaled : forall (f : nat -> R) a,
    total n (fun j => (a * f j) * (y j - x j)) = a * total n (fun j => f j * (y j - x j))).
  { intros f a. rewrite <- total_scal. apply total_ext. intros. ring. }
  induction e as [i | z | | a IHa b IHb | a IHa b IHb | a IHa b IHb | a IHa b IHb | a IHa | a IHa | a IHa]; intros def;
    cbn [value partial defined] in *.
  - replace (total n (fun j => unit_matrix i j * (y j - x j))) with (y i - x i).
    + unfold segment. auto_derive; [trivial | ring].
    + destruct (Nat.lt_ge_cases i n) as [below | above].
      * rewrite (total_unit n i (fun j => y j - x j)) by exact below. reflexivity.
      * rewrite same by exact above. rewrite (total_ext n _ (fun _ => 0)); [rewrite total_zero; ring |].
        intros j less. unfold unit_matrix. destruct (Nat.eqb i j) eqn:eq; [apply Nat.eqb_eq in eq; lia | ring].
  - rewrite (total_ext n _ (fun _ => 0)) by (intros; ring). rewrite total_zero. apply @is_derive_const.
  - rewrite (total_ext n _ (fun _ => 0)) by (intros; ring). rewrite total_zero. apply @is_derive_const.
  - destruct def as [da db].
    rewrite (total_ext n _ (fun j => (1 * partial w a j + 1 * partial w b j) * (y j - x j))) by (intros; ring).
    rewrite linear, !Rmult_1_l. apply (@is_derive_plus R_AbsRing R_NormedModule); auto.
  - destruct def as [da db].
    rewrite (total_ext n _ (fun j => (1 * partial w a j + (-1) * partial w b j) * (y j - x j))) by (intros; ring).
    rewrite linear, Rmult_1_l. replace (-1 * _) with (- total n (fun j => partial w b j * (y j - x j))) by ring.
    apply (@is_derive_minus R_AbsRing R_NormedModule); auto.
  - destruct def as [da db].
    rewrite (total_ext n _ (fun j => (value w b * partial w a j + value w a * partial w b j) * (y j - x j))) by (intros; ring).
    rewrite linear.
    replace (value w b * _ + value w a * _) with
      (total n (fun j => partial w a j * (y j - x j)) * value w b + value w a * total n (fun j => partial w b j * (y j - x j)))
      by ring.
    apply (is_derive_mult (fun s => value (segment x y s) a) (fun s => value (segment x y s) b)); auto.
    intros u v. apply Rmult_comm.
  - destruct def as [da [db nonzero]].
    rewrite (total_ext n _ (fun j => (/ value w b * partial w a j + - (value w a / value w b / value w b) * partial w b j) * (y j - x j)))
      by (intros; field; exact nonzero).
    rewrite linear.
    replace (/ value w b * total n (fun j => partial w a j * (y j - x j))
             + - (value w a / value w b / value w b) * total n (fun j => partial w b j * (y j - x j)))
      with ((total n (fun j => partial w a j * (y j - x j)) * value w b
             - value w a * total n (fun j => partial w b j * (y j - x j))) / value w b ^ 2) by (field; exact nonzero).
    apply (is_derive_div (fun s => value (segment x y s) a) (fun s => value (segment x y s) b)); auto.
  - rewrite scaled, Rmult_comm. apply (is_derive_comp sin (fun s => value (segment x y s) a)); auto. apply is_derive_sin.
  - rewrite (total_ext n _ (fun j => (- sin (value w a) * partial w a j) * (y j - x j))) by (intros; ring).
    rewrite scaled, Rmult_comm. apply (is_derive_comp cos (fun s => value (segment x y s) a)); auto. apply is_derive_cos.
  - rewrite (total_ext n _ (fun j => (/ (1 + value w a * value w a) * partial w a j) * (y j - x j))) by (intros; unfold Rdiv; ring).
    rewrite scaled, Rmult_comm. apply (is_derive_comp atan (fun s => value (segment x y s) a)); auto.
    apply is_derive_Reals. replace (/ (1 + value w a * value w a)) with (/ (1 + value w a ^ 2)) by (f_equal; ring).
    apply derivable_pt_lim_atan.
Qed.

(** * Enclosures *)

Definition holds (X : I.type) (x : R) : Prop := contains (I.convert X) (Xreal x).

Section Arithmetic.

Variable prec : I.F.precision.

Lemma nothing X x : contains (I.convert X) Xnan -> holds X x.
Proof. unfold holds. destruct (I.convert X); simpl; tauto. Qed.

Lemma holds_int z : holds (I.fromZ prec z) (IZR z).
Proof. apply I.fromZ_correct. Qed.

Lemma holds_pi : holds (I.pi prec) PI.
Proof. apply I.pi_correct. Qed.

Lemma holds_add X Y x y : holds X x -> holds Y y -> holds (I.add prec X Y) (x + y).
Proof. intros hx hy. exact (I.add_correct prec X Y (Xreal x) (Xreal y) hx hy). Qed.

Lemma holds_sub X Y x y : holds X x -> holds Y y -> holds (I.sub prec X Y) (x - y).
Proof. intros hx hy. exact (I.sub_correct prec X Y (Xreal x) (Xreal y) hx hy). Qed.

Lemma holds_mul X Y x y : holds X x -> holds Y y -> holds (I.mul prec X Y) (x * y).
Proof. intros hx hy. exact (I.mul_correct prec X Y (Xreal x) (Xreal y) hx hy). Qed.

Lemma holds_div X Y x y : holds X x -> holds Y y -> holds (I.div prec X Y) (x / y).
Proof.
  intros hx hy. assert (found := I.div_correct prec X Y (Xreal x) (Xreal y) hx hy). simpl in found.
  unfold Xdiv' in found. destruct (is_zero y); [apply nothing; exact found | exact found].
Qed.

Lemma holds_neg X x : holds X x -> holds (I.neg X) (- x).
Proof. intros hx. exact (I.neg_correct X (Xreal x) hx). Qed.

Lemma holds_abs X x : holds X x -> holds (I.abs X) (Rabs x).
Proof. intros hx. exact (I.abs_correct X (Xreal x) hx). Qed.

Lemma holds_sin X x : holds X x -> holds (I.sin prec X) (sin x).
Proof. intros hx. exact (I.sin_correct prec X (Xreal x) hx). Qed.

Lemma holds_cos X x : holds X x -> holds (I.cos prec X) (cos x).
Proof. intros hx. exact (I.cos_correct prec X (Xreal x) hx). Qed.

Lemma holds_atan X x : holds X x -> holds (I.atan prec X) (atan x).
Proof. intros hx. exact (I.atan_correct prec X (Xreal x) hx). Qed.

Definition negative (X : I.type) : bool := match I.sign_strict X with Xlt => true | _ => false end.
Definition signed (X : I.type) : bool := match I.sign_strict X with Xlt | Xgt => true | _ => false end.

Lemma negative_holds X x : negative X = true -> holds X x -> x < 0.
Proof.
  unfold negative, holds. intros yes inside. assert (sign := I.sign_strict_correct X).
  destruct (I.sign_strict X); try discriminate. apply (sign (Xreal x) inside).
Qed.

Lemma signed_holds X x : signed X = true -> holds X x -> x <> 0.
Proof.
  unfold signed, holds. intros yes inside. assert (sign := I.sign_strict_correct X).
  destruct (I.sign_strict X); try discriminate; destruct (sign (Xreal x) inside) as [_ less]; simpl in less; lra.
Qed.

Lemma holds_between L U l u x : holds L l -> holds U u -> l <= x <= u ->
  holds (I.meet (I.lower_extent U) (I.upper_extent L)) x.
Proof.
  intros hl hu [low high]. apply I.meet_correct.
  - apply I.lower_extent_correct with u; assumption.
  - apply I.upper_extent_correct with l; assumption.
Qed.

(** The enclosures of a formula and of its partial derivatives by the unknowns below [n]; none where a divisor may be 0. *)
Variable n : nat.
Variable box : nat -> I.type.

Definition jet : Type := I.type * list I.type.

Definition both (f : I.type -> I.type -> I.type) (da db : list I.type) : list I.type :=
  map (fun pair => f (fst pair) (snd pair)) (combine da db).

Fixpoint enclose (e : formula) : option jet :=
  match e with
  | Var i => Some (box i, map (fun j => I.fromZ prec (if Nat.eqb i j then 1 else 0)) (seq 0 n))
  | Int z => Some (I.fromZ prec z, map (fun _ => I.fromZ prec 0) (seq 0 n))
  | Pi => Some (I.pi prec, map (fun _ => I.fromZ prec 0) (seq 0 n))
  | Add a b =>
      match enclose a, enclose b with
      | Some (va, da), Some (vb, db) => Some (I.add prec va vb, both (I.add prec) da db)
      | _, _ => None
      end
  | Sub a b =>
      match enclose a, enclose b with
      | Some (va, da), Some (vb, db) => Some (I.sub prec va vb, both (I.sub prec) da db)
      | _, _ => None
      end
  | Mul a b =>
      match enclose a, enclose b with
      | Some (va, da), Some (vb, db) =>
          Some (I.mul prec va vb, both (fun x y => I.add prec (I.mul prec x vb) (I.mul prec va y)) da db)
      | _, _ => None
      end
  | Div a b =>
      match enclose a, enclose b with
      | Some (va, da), Some (vb, db) =>
          if signed vb
          then
            let quotient := I.div prec va vb in
            Some (quotient, both (fun x y => I.div prec (I.sub prec x (I.mul prec quotient y)) vb) da db)
          else None
      | _, _ => None
      end
  | Sin a =>
      match enclose a with
      | Some (va, da) => let slope := I.cos prec va in Some (I.sin prec va, map (I.mul prec slope) da)
      | None => None
      end
  | Cos a =>
      match enclose a with
      | Some (va, da) => let slope := I.sin prec va in Some (I.cos prec va, map (fun x => I.neg (I.mul prec slope x)) da)
      | None => None
      end
  | Atan a =>
      match enclose a with
      | Some (va, da) =>
          let under := I.add prec (I.fromZ prec 1) (I.mul prec va va) in
          Some (I.atan prec va, map (fun x => I.div prec x under) da)
      | None => None
      end
  end.

Definition row_holds (X : list I.type) (f : nat -> R) : Prop :=
  length X = n /\ forall j, (j < n)%nat -> holds (nth j X I.nai) (f j).

Lemma row_map (g : I.type -> I.type) X f h :
  row_holds X f -> (forall Z j, holds Z (f j) -> holds (g Z) (h j)) -> row_holds (map g X) h.
Proof.
  intros [long each] image. split; [rewrite map_length; exact long |]. intros j below.
  rewrite nth_indep with (d' := g I.nai) by (rewrite map_length, long; exact below). rewrite map_nth. apply image, each, below.
Qed.

Lemma row_seq (g : nat -> I.type) f : (forall j, holds (g j) (f j)) -> row_holds (map g (seq 0 n)) f.
Proof.
  intros each. split; [rewrite map_length, seq_length; reflexivity |]. intros j below.
  rewrite nth_indep with (d' := g 0%nat) by (rewrite map_length, seq_length; exact below).
  rewrite map_nth, seq_nth by exact below. apply each.
Qed.

Lemma row_both g X Z f h k :
  row_holds X f -> row_holds Z h -> (forall V W j, holds V (f j) -> holds W (h j) -> holds (g V W) (k j)) ->
  row_holds (both g X Z) k.
Proof.
  intros [lX eX] [lZ eZ] image. unfold both. split.
  - rewrite map_length, combine_length, lX, lZ. apply Nat.min_id.
  - intros j below.
    rewrite nth_indep with (d' := g (fst (I.nai, I.nai)) (snd (I.nai, I.nai)))
      by (rewrite map_length, combine_length, lX, lZ, Nat.min_id; exact below).
    rewrite (map_nth (fun pair => g (fst pair) (snd pair))), combine_nth by (rewrite lX, lZ; reflexivity).
    apply image; [apply eX | apply eZ]; exact below.
Qed.

Theorem enclose_holds x e v d :
  (forall j, holds (box j) (x j)) -> enclose e = Some (v, d) ->
  holds v (value x e) /\ row_holds d (partial x e) /\ defined x e.
Proof.
  intros inside. revert v d.
  induction e as [i | z | | a IHa b IHb | a IHa b IHb | a IHa b IHb | a IHa b IHb | a IHa | a IHa | a IHa];
    intros v d; cbn [enclose value partial defined].
  - intros [= <- <-]. split; [apply inside | split; [| trivial]]. apply row_seq. intros j. unfold unit_matrix.
    destruct (Nat.eqb i j); apply holds_int.
  - intros [= <- <-]. split; [apply holds_int | split; [| trivial]]. apply row_seq. intros. apply holds_int.
  - intros [= <- <-]. split; [apply holds_pi | split; [| trivial]]. apply row_seq. intros. apply holds_int.
  - destruct (enclose a) as [[va da] |]; [| discriminate]. destruct (enclose b) as [[vb db] |]; [| discriminate].
    destruct (IHa _ _ eq_refl) as [ha [ra fa]], (IHb _ _ eq_refl) as [hb [rb fb]]. intros [= <- <-].
    split; [apply holds_add; assumption | split; [| split; assumption]].
    apply (row_both _ _ _ _ _ _ ra rb). intros. apply holds_add; assumption.
  - destruct (enclose a) as [[va da] |]; [| discriminate]. destruct (enclose b) as [[vb db] |]; [| discriminate].
    destruct (IHa _ _ eq_refl) as [ha [ra fa]], (IHb _ _ eq_refl) as [hb [rb fb]]. intros [= <- <-].
    split; [apply holds_sub; assumption | split; [| split; assumption]].
    apply (row_both _ _ _ _ _ _ ra rb). intros. apply holds_sub; assumption.
  - destruct (enclose a) as [[va da] |]; [| discriminate]. destruct (enclose b) as [[vb db] |]; [| discriminate].
    destruct (IHa _ _ eq_refl) as [ha [ra fa]], (IHb _ _ eq_refl) as [hb [rb fb]]. intros [= <- <-].
    split; [apply holds_mul; assumption | split; [| split; assumption]].
    apply (row_both _ _ _ _ _ _ ra rb). intros. apply holds_add; apply holds_mul; assumption.
  - destruct (enclose a) as [[va da] |]; [| discriminate]. destruct (enclose b) as [[vb db] |]; [| discriminate].
    destruct (signed vb) eqn:sign; [| discriminate].
    destruct (IHa _ _ eq_refl) as [ha [ra fa]], (IHb _ _ eq_refl) as [hb [rb fb]]. intros [= <- <-].
    split; [apply holds_div; assumption | split].
    + apply (row_both _ _ _ _ _ _ ra rb). intros.
      apply holds_div; [apply holds_sub; [| apply holds_mul; [apply holds_div |]] |]; assumption.
    + repeat split; try assumption. exact (signed_holds _ _ sign hb).
  - destruct (enclose a) as [[va da] |]; [| discriminate]. destruct (IHa _ _ eq_refl) as [ha [ra fa]]. intros [= <- <-].
    split; [apply holds_sin; assumption | split; [| assumption]].
    apply (row_map _ _ _ _ ra). intros. apply holds_mul; [apply holds_cos |]; assumption.
  - destruct (enclose a) as [[va da] |]; [| discriminate]. destruct (IHa _ _ eq_refl) as [ha [ra fa]]. intros [= <- <-].
    split; [apply holds_cos; assumption | split; [| assumption]].
    apply (row_map _ _ _ _ ra). intros. apply holds_neg, holds_mul; [apply holds_sin |]; assumption.
  - destruct (enclose a) as [[va da] |]; [| discriminate]. destruct (IHa _ _ eq_refl) as [ha [ra fa]]. intros [= <- <-].
    split; [apply holds_atan; assumption | split; [| assumption]].
    apply (row_map _ _ _ _ ra). intros.
    exact (holds_div _ _ _ _ H (holds_add (I.fromZ prec 1) _ 1 _ (holds_int 1) (holds_mul _ _ _ _ ha ha))).
Qed.

Fixpoint sum (k : nat) (v : nat -> I.type) : I.type :=
  match k with O => I.fromZ prec 0 | S l => I.add prec (sum l v) (v l) end.

Lemma holds_sum k V v : (forall j, (j < k)%nat -> holds (V j) (v j)) -> holds (sum k V) (total k v).
Proof.
  induction k as [| k IH]; intros each; [exact (holds_int 0) |].
  apply holds_add; [apply IH; intros; apply each; lia | apply each; lia].
Qed.

End Arithmetic.
