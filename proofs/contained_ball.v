(** A ball lies in a convex set that cones from its centre cover, each cut off by a face with corners in the set.
    docs/mathematics.md §5; verify/proof/contained_ball.cpp, revolution.hpp, verify/search/convex_primitive.cpp,
    kernels/interior_depth.cl and tapered_interior.clh rely on it. *)
From Coq Require Import Reals Lra Psatz.
From verisq Require Import vector signed_distance power norm superquadric.
Open Scope R_scope.

Definition combination l m n a b c := add (scale l a) (add (scale m b) (scale n c)).
Definition cone (a b c : vector) : region := fun v =>
  exists l m n, 0 <= l /\ 0 <= m /\ 0 <= n /\ v = combination l m n a b c.

Lemma two_points_span (K : region) p r l m : convex K -> K p -> K r -> 0 <= l -> 0 <= m -> l + m = 1 -> K (add (scale l
  p) (scale m r)).
Proof.
  intros is_convex in_p in_r l_range m_range sum.
  replace (add (scale l p) (scale m r)) with (on_the_way p r m); [apply is_convex; auto; lra |].
  replace l with (1 - m) by lra. unfold on_the_way. coordinates; ring.
Qed.

(** The hull of q and the q + dᵢ lies in the convex K. *)
Lemma hull_of_four (K : region) q a b c l m n :
  convex K -> K q -> K (add q a) -> K (add q b) -> K (add q c) -> 0 <= l -> 0 <= m -> 0 <= n -> l + m + n <= 1 ->
  K (add q (combination l m n a b c)).
Proof.
  intros is_convex in_q in_a in_b in_c l_range m_range n_range sum.
  assert (step : forall p d s rest, 0 <= s -> 0 <= rest -> s + rest <= 1 ->
            K (add q d) -> (forall u, 0 <= u -> u <= 1 -> K (add q (scale u p))) ->
            K (add q (add (scale s d) (scale rest p)))).
  { intros p d s rest s_range rest_range total in_d in_p.
    destruct (Req_dec s 1) as [-> | part].
    - assert (rest = 0) as -> by lra.
      replace (add q (add (scale 1 d) (scale 0 p))) with (add q d) by (coordinates; ring). assumption.
    - replace (add q (add (scale s d) (scale rest p)))
        with (add (scale (1 - s) (add q (scale (rest / (1 - s)) p))) (scale s (add q d))) by (coordinates; field; lra).
      apply two_points_span; auto; try lra. apply in_p.
      + apply Rmult_le_pos; [| apply Rlt_le, Rinv_0_lt_compat]; lra.
      + apply Rmult_le_reg_r with (1 - s); [| field_simplify]; lra. }
  assert (ray : forall d u, K (add q d) -> 0 <= u -> u <= 1 -> K (add q (scale u d))).
  { intros d u in_d low high. replace (add q (scale u d)) with (add (scale (1 - u) q) (scale u (add q d)))
      by (coordinates; ring). apply two_points_span; auto; lra. }
  assert (fan : forall u, 0 <= u -> u <= 1 -> 0 <= m / (m + n) -> 0 <= n / (m + n) -> m / (m + n) + n / (m + n) <= 1 ->
            K (add q (scale u (add (scale (m / (m + n)) b) (scale (n / (m + n)) c))))).
  { intros u low high. intros. apply ray; [| assumption ..]. apply step; auto. }
  unfold combination. destruct (Req_dec (m + n) 0) as [none | some].
  - assert (m = 0) as -> by lra. assert (n = 0) as -> by lra.
    replace (add q (add (scale l a) (add (scale 0 b) (scale 0 c)))) with (add q (scale l a)) by (coordinates; ring).
    apply ray; auto; lra.
  - assert (0 <= m / (m + n)) by (apply Rmult_le_pos; [| apply Rlt_le, Rinv_0_lt_compat]; lra).
    assert (0 <= n / (m + n)) by (apply Rmult_le_pos; [| apply Rlt_le, Rinv_0_lt_compat]; lra).
    assert (m / (m + n) + n / (m + n) <= 1) by (right; field; lra).
    replace (add (scale m b) (scale n c))
      with (scale (m + n) (add (scale (m / (m + n)) b) (scale (n / (m + n)) c))) by (coordinates; field; lra).
    apply step; auto; lra.
Qed.

(** Lemma. Let q and the q + dᵢ lie in K, c ≠ 0, c·dᵢ ≥ t|c|. Then the part of the ball {|v| ≤ t} in the cone of the dᵢ,
    moved to q, lies in K. *)
Theorem cone_of_a_ball (K : region) q a b c axis t v :
  convex K -> K q -> K (add q a) -> K (add q b) -> K (add q c) -> axis <> zero ->
  t * length axis <= dot axis a -> t * length axis <= dot axis b -> t * length axis <= dot axis c ->
  cone a b c v -> length v <= t -> K (add q v).
Proof.
  intros is_convex in_q in_a in_b in_c nonzero far_a far_b far_c [l [m [n [l_range [m_range [n_range ->]]]]]] short.
  pose proof (length_positive axis nonzero). pose proof (length_nonnegative (combination l m n a b c)).
  destruct (Req_dec t 0) as [-> | nonnull].
  - assert (none : combination l m n a b c = zero).
    { destruct (combination l m n a b c) as [x y z] eqn:equation. rewrite <- equation in *.
      pose proof (length_squared (combination l m n a b c)) as square.
      replace (length (combination l m n a b c)) with 0 in square by lra. rewrite equation in square |- *.
      unfold dot in square; simpl in square. unfold zero. f_equal; nra. }
    rewrite none. replace (add q zero) with q by (coordinates; ring). assumption.
  - apply hull_of_four; auto. pose proof (cauchy_schwarz axis (combination l m n a b c)) as bound.
    replace (dot axis (combination l m n a b c)) with (l * dot axis a + m * dot axis b + n * dot axis c) in bound
      by (unfold combination; coordinates; ring).
    assert (lower : (l + m + n) * (t * length axis) <= l * dot axis a + m * dot axis b + n * dot axis c) by nra.
    assert (upper : length axis * length (combination l m n a b c) <= length axis * t) by (apply Rmult_le_compat_l;
      lra).
    apply Rmult_le_reg_r with (t * length axis); nra.
Qed.

Definition middle a b := scale (1 / 2) (add a b).

(** The checker's proof that the cone of three directions is covered: a face with corners at distances r along the
    directions, proven in K, or two halves of it. *)
Inductive covered (K : region) (q : vector) (t : R) : vector -> vector -> vector -> Prop :=
  | face a b c axis r1 r2 r3 :
      axis <> zero -> 0 <= r1 -> 0 <= r2 -> 0 <= r3 ->
      K (add q (scale r1 a)) -> K (add q (scale r2 b)) -> K (add q (scale r3 c)) ->
      t * length axis <= dot axis (scale r1 a) -> t * length axis <= dot axis (scale r2 b) ->
      t * length axis <= dot axis (scale r3 c) -> covered K q t a b c
  | halves a b c : covered K q t (middle a b) b c -> covered K q t a (middle a b) c -> covered K q t a b c
  | halves_in_a_plane a b :
      covered K q t (middle a b) b b -> covered K q t a (middle a b) (middle a b) -> covered K q t a b b
  | turned a b c : covered K q t b c a -> covered K q t a b c.

Theorem covered_part_of_a_ball (K : region) q t a b c v :
  convex K -> K q -> 0 < t -> covered K q t a b c -> cone a b c v -> length v <= t -> K (add q v).
Proof.
  intros is_convex in_q positive cover in_cone short. induction cover as [a b c axis r1 r2 r3 nonzero r1_range r2_range
    r3_range in_a in_b in_c far_a far_b far_c | a b c _ first _ second | a b _ first _ second | a b c _ rest].
  - destruct in_cone as [l [m [n [l_range [m_range [n_range equal]]]]]].
    pose proof (length_positive axis nonzero).
    assert (proper : forall r d, 0 <= r -> t * length axis <= dot axis (scale r d) -> 0 < r).
    { intros r d [more | <-] far; [assumption | exfalso].
      replace (dot axis (scale 0 d)) with 0 in far by (coordinates; ring). nra. }
    pose proof (proper r1 a r1_range far_a). pose proof (proper r2 b r2_range far_b). pose proof (proper r3 c r3_range
      far_c).
    apply (cone_of_a_ball K q (scale r1 a) (scale r2 b) (scale r3 c) axis t v); auto.
    assert (share : forall s r, 0 <= s -> 0 < r -> 0 <= s / r) by
      (intros; apply Rmult_le_pos; [| apply Rlt_le, Rinv_0_lt_compat]; assumption).
    exists (l / r1), (m / r2), (n / r3). repeat split; auto.
    rewrite equal. unfold combination. clear - H0 H1 H2. coordinates; field; lra.
  - destruct in_cone as [l [m [n [l_range [m_range [n_range equal]]]]]].
    destruct (Rle_or_lt l m) as [less | more].
    + apply first. exists (2 * l), (m - l), n. repeat split; try lra. rewrite equal. unfold combination, middle.
      coordinates; field.
    + apply second. exists (l - m), (2 * m), n. repeat split; try lra. rewrite equal. unfold combination, middle.
      coordinates; field.
  - destruct in_cone as [l [m [n [l_range [m_range [n_range equal]]]]]].
    destruct (Rle_or_lt l (m + n)) as [less | more].
    + apply first. exists (2 * l), (m + n - l), 0. repeat split; try lra. rewrite equal. unfold combination, middle.
      coordinates; field.
    + apply second. exists (l - (m + n)), (2 * (m + n)), 0. repeat split; try lra. rewrite equal.
      unfold combination, middle. coordinates; field.
  - apply rest. destruct in_cone as [l [m [n [l_range [m_range [n_range equal]]]]]].
    exists m, n, l. repeat split; try assumption. rewrite equal. unfold combination. coordinates; ring.
Qed.

Definition ex := Vector 1 0 0.
Definition ey := Vector 0 1 0.
Definition ez := Vector 0 0 1.
Definition below := Vector 0 0 (-1).

(** No point of K leaves it when its |coordinates| get smaller; with a taper, those of x and y. *)
Definition falls_with_coordinates (K : region) := forall x y, no_larger x y -> K y -> K x.
Definition falls_with_width (K : region) :=
  forall x y, Rabs (vx x) <= Rabs (vx y) -> Rabs (vy x) <= Rabs (vy y) -> vz x = vz y -> K y -> K x.

Lemma length_of_magnitudes v : length (Vector (Rabs (vx v)) (Rabs (vy v)) (Rabs (vz v))) = length v.
Proof.
  unfold length, dot; simpl. f_equal. pose proof (fun x => Rsqr_abs x) as square. unfold Rsqr in square.
  rewrite <- !square. reflexivity.
Qed.

Lemma abs_of_coordinate x q p : Rabs q <= p -> Rabs x <= Rabs (p + Rabs (x - q)).
Proof.
  intros bound. pose proof (Rabs_triang q (x - q)) as sum. replace (q + (x - q)) with x in sum by ring.
  pose proof (Rle_abs (p + Rabs (x - q))). lra.
Qed.

(** If cones cover the octant, the whole ball about q lies in K; p is |q|, or larger. *)
Theorem ball_by_cones_of_an_octant (K : region) p q t :
  convex K -> falls_with_coordinates K -> Rabs (vx q) <= vx p -> Rabs (vy q) <= vy p -> Rabs (vz q) <= vz p ->
  K p -> 0 < t -> covered K p t ex ey ez -> lies_in (ball q t) K.
Proof.
  intros is_convex falls px py pz in_p positive cover x near. unfold ball in near. rewrite distance_symmetric in near.
  set (d := sub x q) in *. set (v := Vector (Rabs (vx d)) (Rabs (vy d)) (Rabs (vz d))).
  apply (falls x (add p v)).
  - unfold v, d, no_larger. simpl. repeat split; now apply abs_of_coordinate.
  - apply (covered_part_of_a_ball K p t ex ey ez); auto.
    + exists (Rabs (vx d)), (Rabs (vy d)), (Rabs (vz d)). repeat split; auto using Rabs_pos.
      unfold v, combination, ex, ey, ez. clear. coordinates; ring.
    + unfold v. rewrite length_of_magnitudes. assumption.
Qed.

(** With a taper the cones cover z < 0, too. *)
Theorem ball_by_cones_of_two_octants (K : region) p q t :
  convex K -> falls_with_width K -> Rabs (vx q) <= vx p -> Rabs (vy q) <= vy p -> vz p = vz q ->
  K p -> 0 < t -> covered K p t ex ey ez -> covered K p t ex ey below -> lies_in (ball q t) K.
Proof.
  intros is_convex falls px py pz in_p positive above beneath x near. unfold ball in near.
  rewrite distance_symmetric in near.
  set (d := sub x q) in *. set (v := Vector (Rabs (vx d)) (Rabs (vy d)) (vz d)).
  assert (short : length v <= t).
  { rewrite <- length_of_magnitudes. unfold v; simpl. rewrite !Rabs_Rabsolu.
    change (length (Vector (Rabs (vx d)) (Rabs (vy d)) (Rabs (vz d))) <= t). now rewrite length_of_magnitudes. }
  apply (falls x (add p v)).
  - unfold v, d. simpl. now apply abs_of_coordinate.
  - unfold v, d. simpl. now apply abs_of_coordinate.
  - unfold v, d. simpl. lra.
  - destruct (Rle_or_lt 0 (vz d)).
    + apply (covered_part_of_a_ball K p t ex ey ez); auto.
      exists (Rabs (vx d)), (Rabs (vy d)), (vz d). repeat split; auto using Rabs_pos.
      unfold v, combination, ex, ey, ez. clear. coordinates; ring.
    + apply (covered_part_of_a_ball K p t ex ey below); auto.
      exists (Rabs (vx d)), (Rabs (vy d)), (- vz d). repeat split; auto using Rabs_pos; try lra.
      unfold v, combination, ex, ey, below. clear. coordinates; ring.
Qed.

(** In a solid of revolution the section y = 0 decides. *)
Definition radius x := sqrt (vx x * vx x + vy x * vy x).
Definition of_revolution (K : region) := forall x, K x <-> K (Vector (radius x) 0 (vz x)).

Lemma radius_nonnegative x : 0 <= radius x.
Proof. apply sqrt_pos. Qed.

(** |(x + u, y + v)| ≤ |(x, y)| + |(u, v)|. *)
Lemma radius_of_sum a b : radius (add a b) <= radius a + radius b.
Proof.
  pose proof (triangle_inequality (Vector (vx a) (vy a) 0) (Vector (vx b) (vy b) 0)) as sum.
  unfold length, dot, add in sum; simpl in sum. rewrite !Rmult_0_l, !Rplus_0_r, ?Rmult_0_l, ?Rplus_0_r in sum.
    assumption.
Qed.

Lemma length_in_the_section d : length (Vector (radius d) 0 (Rabs (vz d))) = length d.
Proof.
  unfold length, dot, radius; simpl. rewrite sqrt_sqrt by nra. f_equal. pose proof (Rsqr_abs (vz d)) as square.
  unfold Rsqr in square. lra.
Qed.

Theorem ball_in_a_solid_of_revolution (K : region) p q t :
  convex K -> falls_with_coordinates K -> of_revolution K -> radius q <= vx p -> vy p = 0 -> Rabs (vz q) <= vz p ->
  K p -> 0 < t -> covered K p t ex ez ez -> lies_in (ball q t) K.
Proof.
  intros is_convex falls revolves px py pz in_p positive cover x near. unfold ball in near.
  rewrite distance_symmetric in near. set (d := sub x q) in *. set (v := Vector (radius d) 0 (Rabs (vz d))).
  apply revolves. apply (falls _ (add p v)).
  - unfold v, no_larger. simpl. repeat split.
    + pose proof (radius_of_sum q d) as sum. replace (add q d) with x in sum by (unfold d; coordinates; ring).
      pose proof (radius_nonnegative x). pose proof (radius_nonnegative d). pose proof (radius_nonnegative q).
      rewrite !Rabs_right by lra. lra.
    + rewrite py, Rplus_0_r. lra.
    + unfold d. simpl. now apply abs_of_coordinate.
  - apply (covered_part_of_a_ball K p t ex ez ez); auto.
    + exists (radius d), (Rabs (vz d)), 0. repeat split; auto using Rabs_pos, radius_nonnegative; try lra.
      unfold v, combination, ex, ez. clear. coordinates; ring.
    + unfold v. now rewrite length_in_the_section.
Qed.

(** A superquadric is such a set, *)
Theorem superquadric_falls_with_coordinates a1 a2 a3 eps1 eps2 :
  0 < a1 -> 0 < a2 -> 0 < a3 -> 0 < eps1 <= 2 -> 0 < eps2 <= 2 -> falls_with_coordinates (solid a1 a2 a3 eps1 eps2).
Proof. intros. intros x y smaller in_y. unfold solid in *. eapply Rle_trans; [apply gauge_rises |]; eassumption. Qed.

(** and of revolution where a₁ = a₂, ε₂ = 1. *)
Theorem superquadric_of_revolution a a3 eps1 : 0 < a -> of_revolution (solid a a a3 eps1 1).
Proof.
  intros positive x. unfold solid, gauge, radius; simpl.
  assert (section : forall s t, norm (2 / 1) (s / a) (t / a) = sqrt (s * s + t * t) / a).
  { intros s t. pose proof (norm_is_homogeneous (2 / 1) (/ a) s t ltac:(lra)) as scaled.
    replace (s / a) with (/ a * s) by (field; lra). replace (t / a) with (/ a * t) by (field; lra). rewrite scaled.
    rewrite Rabs_right by (apply Rle_ge, Rlt_le, Rinv_0_lt_compat; assumption). unfold Rdiv at 2. rewrite Rmult_comm.
      f_equal.
    replace (2 / 1) with 2 by field. unfold norm.
    assert (square : forall y, power 2 (Rabs y) = y * y).
    { intros y. replace 2 with (1 + 1) by ring. rewrite power_of_sum, power_one by apply Rabs_pos.
      pose proof (Rsqr_abs y) as equal. unfold Rsqr in equal. lra. }
    rewrite !square. assert (0 <= s * s + t * t) as [more | none] by nra.
    - rewrite power_of_positive by assumption. unfold Rdiv. rewrite Rmult_1_l. now apply Rpower_sqrt.
    - rewrite <- none, power_of_zero, sqrt_0. reflexivity. }
  rewrite !section. rewrite sqrt_sqrt by nra.
  rewrite Rmult_0_l, Rplus_0_r. tauto.
Qed.
