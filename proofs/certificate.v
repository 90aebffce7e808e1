(** What the parts of a certificate prove about the signed distance s of a point q to any set K: normals, points of K,
    balls in K, bounding spheres, escapes; and what a normal proves of triangles and of pairs. docs/mathematics.md §2,
    §6, §7, §12; verify/solids/superquadric.cpp, exact_checker.cpp, posed_superquadric.cpp, pair_bounds.cpp rely on
    it. *)
From Coq Require Import Reals Lra Psatz Classical.
From verisq Require Import vector signed_distance.
Open Scope R_scope.

(** h is an upper bound of v·x over K. *)
Definition supports (K : region) v h := forall x, K x -> dot v x <= h.

Lemma dot_of_difference v x y : dot v x - dot v y <= length v * distance x y.
Proof.
  pose proof (cauchy_schwarz v (sub x y)). unfold distance.
  replace (dot v x - dot v y) with (dot v (sub x y)) by (coordinates; ring). assumption.
Qed.

Lemma quotient_at_most a b c : 0 < b -> a <= b * c -> a / b <= c.
Proof. intros. apply Rmult_le_reg_r with b; [assumption |]. field_simplify; lra. Qed.

Lemma quotient_at_least a b c : 0 < b -> b * c <= a -> c <= a / b.
Proof. intros. apply Rmult_le_reg_r with b; [assumption |]. field_simplify; lra. Qed.

(** The farthest point of a ball along v gives v·q + t|v| ≤ h(v). *)
Theorem ball_below_a_plane (K : region) v h q t :
  v <> zero -> supports K v h -> 0 <= t -> lies_in (ball q t) K -> t <= (h - dot v q) / length v.
Proof.
  intros nonzero plane nonnegative in_K. pose proof (length_positive v nonzero) as positive.
  apply quotient_at_least; [assumption |].
  set (x := add q (scale (t / length v) v)).
  assert (near : ball q t x).
  { unfold ball, distance, x. replace (sub q (add q (scale (t / length v) v))) with (scale (- (t / length v)) v)
      by (coordinates; ring).
    assert (0 <= t / length v) by (apply quotient_at_least; lra).
    rewrite length_scale, Rabs_Ropp, Rabs_right by lra. right. field. lra. }
  pose proof (plane x (in_K x near)) as farthest. unfold x in farthest.
  replace (dot v (add q (scale (t / length v) v))) with (dot v q + t / length v * dot v v) in farthest
    by (coordinates; ring).
  rewrite <- length_squared in farthest.
  replace (t / length v * (length v * length v)) with (length v * t) in farthest by (field; lra). lra.
Qed.

(** Lower bound. For every v: sd(q) ≥ (v·q − h(v)) / |v|, for points outside and inside alike. *)
Theorem lower_bound (K : region) v h q s :
  v <> zero -> supports K v h -> signed_distance K q s -> (dot v q - h) / length v <= s.
Proof.
  intros nonzero plane is_sd. pose proof (length_positive v nonzero) as positive.
  apply quotient_at_most; [assumption |]. destruct (classic (K q)) as [inside | outside].
  - destruct (inside_it_is_the_largest_ball _ _ _ is_sd inside) as [largest _].
    pose proof (not_positive_inside _ _ _ is_sd inside).
    assert (bound : forall t, 0 <= t -> t < - s -> length v * t <= h - dot v q).
    { intros t nonnegative smaller.
      pose proof (ball_below_a_plane K v h q t nonzero plane nonnegative (largest t smaller)) as below.
      apply Rmult_le_compat_l with (r := length v) in below; [| lra].
      replace (length v * ((h - dot v q) / length v)) with (h - dot v q) in below by (field; lra). assumption. }
    destruct (Rle_or_lt (- s) ((h - dot v q) / length v)) as [enough | more].
    { apply Rmult_le_compat_l with (r := length v) in enough; [| lra].
      replace (length v * ((h - dot v q) / length v)) with (h - dot v q) in enough by (field; lra). lra. }
    exfalso. set (m := (h - dot v q) / length v) in *.
    assert (product : length v * m = h - dot v q) by (unfold m; field; lra).
    assert (0 <= m).
    { apply quotient_at_least; [assumption |]. rewrite Rmult_0_r. pose proof (plane q inside). lra. }
    pose proof (bound ((m - s) / 2) ltac:(lra) ltac:(lra)). nra.
  - destruct is_sd as [[contradiction _] | [_ [_ greatest]]]; [tauto |].
    assert (plane_distance : (dot v q - h) / length v <= s).
    { apply greatest. intros x in_K. apply quotient_at_most; [assumption |].
      pose proof (dot_of_difference v q x). pose proof (plane x in_K). lra. }
    apply Rmult_le_compat_l with (r := length v) in plane_distance; [| lra].
    replace (length v * ((dot v q - h) / length v)) with (dot v q - h) in plane_distance by (field; lra). assumption.
Qed.

(** Upper bound outside. For every b of K: sd(q) ≤ |q − b|. *)
Theorem upper_bound_outside (K : region) b q s : K b -> signed_distance K q s -> s <= distance q b.
Proof.
  intros in_K [[_ depth] | [_ [below _]]]; [| now apply below].
  pose proof (distance_to_nonnegative _ _ _ depth). pose proof (distance_nonnegative q b). lra.
Qed.

(** Upper bound inside. If a ball of radius t about q lies in K, sd(q) ≤ −t. *)
Theorem upper_bound_inside (K : region) q t s : 0 <= t -> lies_in (ball q t) K -> signed_distance K q s -> s <= - t.
Proof.
  intros nonnegative in_K is_sd.
  assert (K q) as inside by (apply in_K; unfold ball; rewrite distance_to_itself; assumption).
  pose proof (proj2 (inside_it_is_the_largest_ball _ _ _ is_sd inside) t in_K). lra.
Qed.

(** No normal for a far primitive: sd(q) ≥ |q − centre| − circumradius. *)
Theorem bounding_sphere (K : region) c r q s : lies_in K (ball c r) -> signed_distance K q s -> distance q c - r <= s.
Proof.
  intros in_ball is_sd.
  assert (planes : forall v, supports K v (dot v c + length v * r)).
  { intros v x in_K. pose proof (dot_of_difference v x c). pose proof (in_ball x in_K) as near. unfold ball in near.
    rewrite distance_symmetric in near. pose proof (length_nonnegative v). nra. }
  destruct (classic (sub q c = zero)) as [same | nonzero].
  - set (v := Vector 1 0 0). assert (v <> zero) as nonzero by (unfold v, zero; injection; lra).
    pose proof (lower_bound K v _ q s nonzero (planes v) is_sd) as bound.
    pose proof (length_positive v nonzero).
    unfold distance. rewrite same, length_zero.
    replace (dot v q) with (dot v c + dot v (sub q c)) in bound by (coordinates; ring). rewrite same in bound.
    replace (dot v zero) with 0 in bound by (unfold v, zero, dot; simpl; ring).
    replace ((dot v c + 0 - (dot v c + length v * r)) / length v) with (- r) in bound by (field; lra). lra.
  - pose proof (lower_bound K _ _ q s nonzero (planes _) is_sd) as bound.
    pose proof (length_positive _ nonzero). unfold distance.
    replace (dot (sub q c) q) with (dot (sub q c) c + dot (sub q c) (sub q c)) in bound by (coordinates; ring).
    rewrite <- length_squared in bound.
    replace ((dot (sub q c) c + length (sub q c) * length (sub q c) - (dot (sub q c) c + length (sub q c) * r))
             / length (sub q c)) with (length (sub q c) - r) in bound by (field; lra). lra.
Qed.

(** sd(q) ≥ −|w − q| for any escape w outside K, a union or not: its boundary is no farther. *)
Theorem escape (K : region) w q s : ~ K w -> signed_distance K q s -> - distance w q <= s.
Proof.
  intros outside is_sd. destruct (classic (K q)) as [inside | also].
  - destruct (ways_cross_the_boundary K q w inside outside) as [u [range crossing]].
    destruct is_sd as [[_ [below _]] | [contradiction _]]; [| tauto].
    pose proof (below _ crossing) as near. rewrite distance_from_start, Rabs_right in near by lra.
    rewrite distance_symmetric. pose proof (distance_nonnegative q w). nra.
  - pose proof (not_negative_outside _ _ _ is_sd also). pose proof (distance_nonnegative w q). lra.
Qed.

(** A larger set has a smaller signed distance; *)
Theorem larger_sets_are_nearer (K S : region) q s t :
  lies_in K S -> signed_distance K q s -> signed_distance S q t -> t <= s.
Proof.
  intros larger of_K of_S. destruct (classic (K q)) as [inside | outside].
  - destruct (inside_it_is_the_largest_ball _ _ _ of_K inside) as [largest _].
    destruct (inside_it_is_the_largest_ball _ _ _ of_S (larger q inside)) as [_ bound].
    destruct (Rle_or_lt t s) as [| more]; [assumption | exfalso].
    pose proof (not_positive_inside _ _ _ of_S (larger q inside)).
    assert ((- s - t) / 2 <= - t); [| lra]. apply bound. intros x near. apply larger. now apply (largest ((- s - t) /
      2) ltac:(lra)).
  - pose proof (not_negative_outside _ _ _ of_K outside). destruct (classic (S q)) as [in_S | out].
    + pose proof (not_positive_inside _ _ _ of_S in_S). lra.
    + destruct of_K as [[contradiction _] | [_ [_ greatest]]]; [tauto |].
      destruct of_S as [[contradiction _] | [_ [below _]]]; [tauto |].
      apply greatest. intros x in_K. apply below. now apply larger.
Qed.

(** so sd(q, S) ≤ min sdᵢ(q) for a union S of any sets, always, *)
Definition union {I : Type} (K : I -> region) : region := fun x => exists i, K i x.

Theorem union_is_no_farther {I : Type} (K : I -> region) i q s t :
  signed_distance (K i) q s -> signed_distance (union K) q t -> t <= s.
Proof. intros of_one of_all. apply (larger_sets_are_nearer (K i) (union K) q); try assumption. intros x in_one. now
  exists i. Qed.

(** and sd(q, S) ≥ min sdᵢ(q) where every sdᵢ(q) is positive. *)
Theorem union_from_outside {I : Type} (K : I -> region) m q t :
  0 < m -> (forall i, exists s, signed_distance (K i) q s /\ m <= s) -> signed_distance (union K) q t -> m <= t.
Proof.
  intros positive far of_all.
  assert (outside : forall i, ~ K i q).
  { intros i inside. destruct (far i) as [s [of_one large]]. pose proof (not_positive_inside _ _ _ of_one inside). lra.
    }
  destruct of_all as [[[i inside] _] | [_ [_ greatest]]]; [now apply outside in inside |].
  apply greatest. intros x [i in_one]. destruct (far i) as [s [[[inside _] | [_ [below _]]] large]].
  - now apply outside in inside.
  - pose proof (below x in_one). lra.
Qed.

(** Two sets on either side of a slab: K in {v·x ≤ h}, the other one in {v·y ≥ l}. For pairs, l = −h(−v) of the other
    solid: d ≥ (l − h(v)) / |v|. *)
Theorem slab v h l x y : v <> zero -> dot v x <= h -> l <= dot v y -> (l - h) / length v <= distance y x.
Proof.
  intros nonzero below above. apply quotient_at_most; [now apply length_positive |].
  pose proof (dot_of_difference v y x). lra.
Qed.

Definition in_triangle a b c x := exists u w, 0 <= u /\ 0 <= w /\ u + w <= 1 /\ x = add a (add (scale u (sub b a))
  (scale w (sub c a))).

(** The distance of a triangle to K: d ≥ (min v·tᵢ − h(v)) / |v|. *)
Theorem triangle_lower_bound (K : region) v h a b c x y :
  v <> zero -> supports K v h -> in_triangle a b c x -> K y ->
  (Rmin (dot v a) (Rmin (dot v b) (dot v c)) - h) / length v <= distance x y.
Proof.
  intros nonzero plane [u [w [u_nonnegative [w_nonnegative [sum ->]]]]] in_K. apply slab; [assumption | now apply plane
    |].
  set (m := Rmin _ _).
  assert (m <= dot v a /\ m <= dot v b /\ m <= dot v c) as [first [second third]].
  { pose proof (Rmin_l (dot v a) (Rmin (dot v b) (dot v c))). pose proof (Rmin_r (dot v a) (Rmin (dot v b) (dot v c))).
    pose proof (Rmin_l (dot v b) (dot v c)). pose proof (Rmin_r (dot v b) (dot v c)). unfold m. lra. }
  replace (dot v (add a (add (scale u (sub b a)) (scale w (sub c a)))))
    with ((1 - u - w) * dot v a + u * dot v b + w * dot v c) by (coordinates; ring). nra.
Qed.
