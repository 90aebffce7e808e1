(** Vectors of space: sums, products, lengths, and the two inequalities of Cauchy and Schwarz and of the triangle.
    What docs/mathematics.md writes v·x and |v| is [dot v x] and [length v] here. *)
From Coq Require Import Reals Lra Psatz.
Open Scope R_scope.

Record vector := Vector { vx : R; vy : R; vz : R }.

Definition zero := Vector 0 0 0.
Definition add a b := Vector (vx a + vx b) (vy a + vy b) (vz a + vz b).
Definition sub a b := Vector (vx a - vx b) (vy a - vy b) (vz a - vz b).
Definition scale s a := Vector (s * vx a) (s * vy a) (s * vz a).
Definition dot a b := vx a * vx b + vy a * vy b + vz a * vz b.
Definition length a := sqrt (dot a a).
Definition distance a b := length (sub a b).

(** Proves equations of vectors, of dot products, and inequalities that are linear in coordinates. *)
Ltac coordinates :=
  repeat match goal with v : vector |- _ => destruct v end;
  unfold distance, dot, add, sub, scale, zero in *; simpl in *;
  try match goal with |- Vector _ _ _ = Vector _ _ _ => f_equal end.

Lemma dot_self_nonnegative a : 0 <= dot a a.
Proof. coordinates; nra. Qed.

Lemma length_nonnegative a : 0 <= length a.
Proof. apply sqrt_pos. Qed.

Lemma length_squared a : length a * length a = dot a a.
Proof. apply sqrt_sqrt, dot_self_nonnegative. Qed.

Lemma length_zero : length zero = 0.
Proof. unfold length. replace (dot zero zero) with 0 by (coordinates; ring). apply sqrt_0. Qed.

Lemma length_positive a : a <> zero -> 0 < length a.
Proof.
  intros nonzero. apply sqrt_lt_R0. destruct (Rle_lt_or_eq_dec _ _ (dot_self_nonnegative a)) as [| none]; [assumption
    |].
  exfalso. apply nonzero. coordinates; nra.
Qed.

Lemma length_scale s a : length (scale s a) = Rabs s * length a.
Proof.
  unfold length. replace (dot (scale s a) (scale s a)) with (Rsqr s * dot a a) by (unfold Rsqr; coordinates; ring).
  rewrite sqrt_mult; [| apply Rle_0_sqr | apply dot_self_nonnegative]. now rewrite sqrt_Rsqr_abs.
Qed.

(** A number is at most the length of a vector if its square is at most the vector's. *)
Lemma length_at_least s a : s * s <= dot a a -> s <= length a.
Proof.
  intros bound. pose proof (length_nonnegative a). pose proof (length_squared a).
  destruct (Rle_or_lt s (length a)); [assumption | nra].
Qed.

Lemma length_at_most s a : 0 <= s -> dot a a <= s * s -> length a <= s.
Proof.
  intros. pose proof (length_nonnegative a). pose proof (length_squared a).
  destruct (Rle_or_lt (length a) s); [assumption | nra].
Qed.

(** a·b ≤ |a||b|. *)
Theorem cauchy_schwarz a b : dot a b <= length a * length b.
Proof.
  apply Rle_trans with (sqrt (Rsqr (dot a b))).
  { rewrite sqrt_Rsqr_abs. apply Rle_abs. }
  unfold length. rewrite <- sqrt_mult; [| apply dot_self_nonnegative ..].
  apply sqrt_le_1_alt. unfold Rsqr. destruct a as [x y z], b as [u v w]; unfold dot; simpl.
  pose proof (Rle_0_sqr (x * v - y * u)). pose proof (Rle_0_sqr (y * w - z * v)). pose proof (Rle_0_sqr (x * w - z *
    u)).
  unfold Rsqr in *. lra.
Qed.

(** |a + b| ≤ |a| + |b|. *)
Theorem triangle_inequality a b : length (add a b) <= length a + length b.
Proof.
  pose proof (length_nonnegative a). pose proof (length_nonnegative b). apply length_at_most; [lra |].
  pose proof (cauchy_schwarz a b). pose proof (length_squared a). pose proof (length_squared b).
  replace (dot (add a b) (add a b)) with (dot a a + 2 * dot a b + dot b b) by (coordinates; ring). nra.
Qed.

Lemma distance_nonnegative a b : 0 <= distance a b.
Proof. apply length_nonnegative. Qed.

Lemma distance_symmetric a b : distance a b = distance b a.
Proof.
  unfold distance. replace (sub b a) with (scale (-1) (sub a b)) by (coordinates; ring).
  rewrite length_scale, Rabs_left; lra.
Qed.

Lemma distance_to_itself a : distance a a = 0.
Proof. unfold distance. replace (sub a a) with zero by (coordinates; ring). apply length_zero. Qed.

Lemma distance_triangle a b c : distance a c <= distance a b + distance b c.
Proof.
  unfold distance. replace (sub a c) with (add (sub a b) (sub b c)) by (coordinates; ring). apply triangle_inequality.
Qed.
