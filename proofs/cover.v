(** Signed distances are 1-Lipschitz, so that balls about a few points bound them on a whole triangle or mesh.
    docs/mathematics.md §6 (bent solids and set operations), §20; verify/search/solid_triangle_distance.hpp,
    verify/proof/triangle_piece.cpp rely on it. *)
From Coq Require Import Reals Lra Psatz.
From verisq Require Import vector signed_distance certificate.
Open Scope R_scope.

(** |x − c| ≤ ρ on a triangle, ρ the largest |vᵢ − c|. *)
Theorem triangle_lies_in_a_ball a b c centre rho x :
  distance centre a <= rho -> distance centre b <= rho -> distance centre c <= rho -> in_triangle a b c x ->
  distance centre x <= rho.
Proof.
  intros first second third [u [w [u_range [w_range [sum ->]]]]]. unfold distance in *.
  replace (sub centre (add a (add (scale u (sub b a)) (scale w (sub c a)))))
    with (add (scale (1 - u - w) (sub centre a)) (add (scale u (sub centre b)) (scale w (sub centre c))))
    by (coordinates; ring).
  eapply Rle_trans; [apply triangle_inequality |]. rewrite length_scale, Rabs_right by lra.
  pose proof (triangle_inequality (scale u (sub centre b)) (scale w (sub centre c))) as rest.
  rewrite !length_scale, !Rabs_right in rest by lra. nra.
Qed.

(** sd(x) ≥ sd(c) − maxᵢ |vᵢ − c|, and sd(x) ≤ sd(c) + maxᵢ |vᵢ − c|, on a triangle. *)
Theorem one_lipschitz_on_a_triangle (K : region) a b c centre rho x s t :
  distance centre a <= rho -> distance centre b <= rho -> distance centre c <= rho -> in_triangle a b c x ->
  signed_distance K centre s -> signed_distance K x t -> s - rho <= t <= s + rho.
Proof.
  intros first second third inside of_centre of_x.
  pose proof (triangle_lies_in_a_ball a b c centre rho x first second third inside).
  pose proof (one_lipschitz K centre x s t of_centre of_x) as close. unfold Rabs in close.
  destruct (Rcase_abs (s - t)); lra.
Qed.

(** If balls cover a set M, and sd(c) + ρ ≤ u for each of them, sd ≤ u on M; likewise from below, and for |sd|. *)
Theorem cover_by_balls (K M : region) (listed : vector -> R -> Prop) l u :
  (forall x, M x -> exists c rho, listed c rho /\ distance c x <= rho) ->
  (forall c rho, listed c rho -> exists s, signed_distance K c s /\ l <= s - rho /\ s + rho <= u) ->
  forall x t, M x -> signed_distance K x t -> l <= t <= u.
Proof.
  intros covers bounds x t in_M of_x. destruct (covers x in_M) as [c [rho [is_listed near]]].
  destruct (bounds c rho is_listed) as [s [of_c [lower upper]]].
  pose proof (one_lipschitz K c x s t of_c of_x) as close. unfold Rabs in close. destruct (Rcase_abs (s - t)); lra.
Qed.

(** No point of a triangle is farther from the nearest corner than (longest side)/√3. *)
Theorem nearest_corner a b c side x :
  distance a b <= side -> distance b c <= side -> distance c a <= side -> in_triangle a b c x ->
  exists v, (v = a \/ v = b \/ v = c) /\ distance v x * distance v x <= side * side / 3.
Proof.
  intros ab bc ca [u [w [u_range [w_range [sum equal]]]]].
  assert (square : forall p q, distance p q * distance p q = dot (sub p q) (sub p q)) by (intros; apply length_squared).
  assert (short : forall p q, distance p q <= side -> dot (sub p q) (sub p q) <= side * side).
  { intros p q bound. rewrite <- square. pose proof (distance_nonnegative p q). nra. }
  apply short in ab, bc, ca.
  assert (mean : (1 - u - w) * dot (sub a x) (sub a x) + u * dot (sub b x) (sub b x) + w * dot (sub c x) (sub c x)
                 = (1 - u - w) * u * dot (sub a b) (sub a b) + u * w * dot (sub b c) (sub b c)
                   + w * (1 - u - w) * dot (sub c a) (sub c a)) by (rewrite equal; clear; coordinates; ring).
  assert (third : (1 - u - w) * u + u * w + w * (1 - u - w) <= 1 / 3).
  { pose proof (Rle_0_sqr (u - w)). pose proof (Rle_0_sqr (1 - 2 * u - w)). pose proof (Rle_0_sqr (1 - u - 2 * w)).
    unfold Rsqr in *. nra. }
  assert (bound : (1 - u - w) * dot (sub a x) (sub a x) + u * dot (sub b x) (sub b x) + w * dot (sub c x) (sub c x)
                  <= side * side / 3).
  { assert (sides : forall m d, 0 <= m -> d <= side * side -> m * d <= m * (side * side)) by (intros; apply
    Rmult_le_compat_l; assumption).
    pose proof (sides ((1 - u - w) * u) _ ltac:(apply Rmult_le_pos; lra) ab). pose proof (sides (u * w) _ ltac:(apply
      Rmult_le_pos; lra) bc).
    pose proof (sides (w * (1 - u - w)) _ ltac:(apply Rmult_le_pos; lra) ca).
    pose proof (Rmult_le_compat_r (side * side) _ _ (Rle_0_sqr side) third). rewrite mean. lra. }
  setoid_rewrite square.
  set (third_of_square := side * side / 3) in *.
  destruct (Rle_or_lt (dot (sub a x) (sub a x)) third_of_square) as [| far_a]; [exists a; auto |].
  destruct (Rle_or_lt (dot (sub b x) (sub b x)) third_of_square) as [| far_b]; [exists b; auto |].
  destruct (Rle_or_lt (dot (sub c x) (sub c x)) third_of_square) as [| far_c]; [exists c; auto |].
  exfalso. set (d := Rmin (dot (sub a x) (sub a x)) (Rmin (dot (sub b x) (sub b x)) (dot (sub c x) (sub c x)))).
  assert (third_of_square < d) by (unfold d; repeat apply Rmin_glb_lt; assumption).
  assert (d <= dot (sub a x) (sub a x) /\ d <= dot (sub b x) (sub b x) /\ d <= dot (sub c x) (sub c x)) as [d_a [d_b
    d_c]].
  { pose proof (Rmin_l (dot (sub a x) (sub a x)) (Rmin (dot (sub b x) (sub b x)) (dot (sub c x) (sub c x)))).
    pose proof (Rmin_r (dot (sub a x) (sub a x)) (Rmin (dot (sub b x) (sub b x)) (dot (sub c x) (sub c x)))).
    pose proof (Rmin_l (dot (sub b x) (sub b x)) (dot (sub c x) (sub c x))).
    pose proof (Rmin_r (dot (sub b x) (sub b x)) (dot (sub c x) (sub c x))). unfold d. lra. }
  apply Rmult_le_compat_l with (r := 1 - u - w) in d_a; [| lra]. apply Rmult_le_compat_l with (r := u) in d_b; [| lra].
  apply Rmult_le_compat_l with (r := w) in d_c; [| lra]. lra.
Qed.
