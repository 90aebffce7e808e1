(** Covers of the neighbourhood of a point or triangle: cells that hold nothing of a solid nearer than r.
    docs/mathematics.md §28; verify/proof/empty_neighbourhood.hpp relies on it. *)
From Coq Require Import Reals Lra Psatz List.
From verisq Require Import vector signed_distance certificate.
Import ListNotations.
Open Scope R_scope.

(** {e : normal·e ≤ offset} with a multiplier. *)
Record cut := Cut { multiplier : R; normal : vector; offset : R }.

Definition holds e (c : cut) := 0 <= multiplier c /\ dot (normal c) e <= offset c.
Definition total (cuts : list cut) := fold_right (fun c sum => add (scale (multiplier c) (normal c)) sum) zero cuts.
Definition cost (cuts : list cut) := fold_right (fun c sum => multiplier c * offset c + sum) 0 cuts.

Lemma total_is_at_most_the_cost cuts e : Forall (holds e) cuts -> dot (total cuts) e <= cost cuts.
Proof.
  induction 1 as [| c rest [nonnegative inside] _ bound]; simpl.
  - coordinates; lra.
  - replace (dot (add (scale (multiplier c) (normal c)) (total rest)) e)
      with (multiplier c * dot (normal c) e + dot (total rest) e) by (coordinates; ring).
    pose proof (Rmult_le_compat_l _ _ _ nonnegative inside). unfold cost, total in *. lra.
Qed.

(** |o + e − c|² ≥ 2 N·(c − o) − |N|² − 2 Σ m b, N = Σ m n. *)
Theorem duality_of_cuts cuts o e c :
  Forall (holds e) cuts ->
  2 * dot (total cuts) (sub c o) - dot (total cuts) (total cuts) - 2 * cost cuts
    <= dot (sub (add o e) c) (sub (add o e) c).
Proof.
  intros inside. pose proof (total_is_at_most_the_cost cuts e inside) as bound.
  set (N := total cuts) in *. pose proof (dot_self_nonnegative (add (sub (add o e) c) N)) as square.
  replace (dot (add (sub (add o e) c) N) (add (sub (add o e) c) N))
    with (dot (sub (add o e) c) (sub (add o e) c) + 2 * dot N e - 2 * dot N (sub c o) + dot N N) in square
    by (clear; coordinates; ring).
  lra.
Qed.

(** If that reaches r² at the corners of a triangle, no point of it is nearer to o + e than r. *)
Theorem cell_is_far cuts o e r a b c t :
  Forall (holds e) cuts -> 0 <= r -> in_triangle a b c t ->
  (forall v, v = a \/ v = b \/ v = c ->
             r * r <= 2 * dot (total cuts) (sub v o) - dot (total cuts) (total cuts) - 2 * cost cuts) ->
  r <= distance (add o e) t.
Proof.
  intros inside positive [u [w [u_range [w_range [sum ->]]]]] corners.
  apply length_at_least. set (t := add a (add (scale u (sub b a)) (scale w (sub c a)))).
  pose proof (duality_of_cuts cuts o e t inside) as bound. set (N := total cuts) in *.
  assert (linear : dot N (sub t o)
                   = (1 - u - w) * dot N (sub a o) + u * dot N (sub b o) + w * dot N (sub c o))
    by (unfold t; clear; coordinates; ring).
  pose proof (corners a ltac:(auto)) as at_a. pose proof (corners b ltac:(auto)) as at_b.
  pose proof (corners c ltac:(auto)) as at_c. rewrite linear in bound.
  set (p := dot N (sub a o)) in *. set (q := dot N (sub b o)) in *. set (s := dot N (sub c o)) in *.
  assert ((1 - u - w) * (r * r) + u * (r * r) + w * (r * r)
          <= (1 - u - w) * (2 * p - dot N N - 2 * cost cuts) + u * (2 * q - dot N N - 2 * cost cuts)
             + w * (2 * s - dot N N - 2 * cost cuts)).
  { repeat apply Rplus_le_compat; apply Rmult_le_compat_l; lra. }
  lra.
Qed.

(** A cut with one normal in place of another: what they differ by is paid for within the cell. *)
Theorem cut_with_another_normal n nbar e b excess :
  dot n e <= b -> - excess <= dot (sub n nbar) e -> dot nbar e <= b + excess.
Proof.
  intros cut difference. replace (dot (sub n nbar) e) with (dot n e - dot nbar e) in difference by (coordinates; ring).
  lra.
Qed.

(** Both halves of a cell cover it. *)
Theorem halves_cover_a_cell x o h :
  Rabs (x - o) <= h -> Rabs (x - (o - h / 2)) <= h / 2 \/ Rabs (x - (o + h / 2)) <= h / 2.
Proof.
  intros inside. destruct (Rle_or_lt x o) as [low | high]; [left | right]; unfold Rabs in *;
  destruct (Rcase_abs (x - o)), (Rcase_abs (x - (o - h / 2))), (Rcase_abs (x - (o + h / 2))); lra.
Qed.

Definition convex (f : vector -> R) :=
  forall a b s, 0 <= s <= 1 -> f (add (scale (1 - s) a) (scale s b)) <= (1 - s) * f a + s * f b.

Lemma convex_between f a b s m : convex f -> 0 <= s <= 1 -> f a <= m -> f b <= m ->
  f (add (scale (1 - s) a) (scale s b)) <= m.
Proof. intros is_convex range at_a at_b. pose proof (is_convex a b s range). nra. Qed.

Lemma share h x : Rabs x <= h -> exists s, 0 <= s <= 1 /\ x = (1 - s) * - h + s * h.
Proof.
  intros inside. destruct (Req_dec h 0) as [none | some].
  - exists 0. subst h. unfold Rabs in inside. destruct (Rcase_abs x); split; lra.
  - assert (0 < h) by (unfold Rabs in inside; destruct (Rcase_abs x); lra).
    exists ((x + h) / (2 * h)). unfold Rabs in inside. split; [| field; lra].
    split; [apply Rle_mult_inv_pos; destruct (Rcase_abs x); lra |].
    apply (Rmult_le_reg_r (2 * h)); [lra |]. unfold Rdiv. rewrite Rmult_assoc, Rinv_l by lra.
    destruct (Rcase_abs x); lra.
Qed.

(** A convex function of a box is largest at a corner. *)
Theorem largest_at_a_corner f hx hy hz m x y z :
  convex f ->
  (forall sx sy sz, (sx = hx \/ sx = - hx) -> (sy = hy \/ sy = - hy) -> (sz = hz \/ sz = - hz) ->
                    f (Vector sx sy sz) <= m) ->
  Rabs x <= hx -> Rabs y <= hy -> Rabs z <= hz -> f (Vector x y z) <= m.
Proof.
  intros is_convex corners in_x in_y in_z.
  destruct (share hx x in_x) as [s [s_range ->]]. destruct (share hy y in_y) as [t [t_range ->]].
  destruct (share hz z in_z) as [u [u_range ->]].
  assert (along_z : forall cx cy, (cx = hx \/ cx = - hx) -> (cy = hy \/ cy = - hy) ->
            f (Vector cx cy ((1 - u) * - hz + u * hz)) <= m).
  { intros cx cy is_x is_y.
    replace (Vector cx cy ((1 - u) * - hz + u * hz))
      with (add (scale (1 - u) (Vector cx cy (- hz))) (scale u (Vector cx cy hz))) by (coordinates; ring).
    apply convex_between; auto. }
  assert (along_y : forall cx, (cx = hx \/ cx = - hx) ->
            f (Vector cx ((1 - t) * - hy + t * hy) ((1 - u) * - hz + u * hz)) <= m).
  { intros cx is_x. set (cz := (1 - u) * - hz + u * hz) in *.
    replace (Vector cx ((1 - t) * - hy + t * hy) cz)
      with (add (scale (1 - t) (Vector cx (- hy) cz)) (scale t (Vector cx hy cz))) by (coordinates; ring).
    apply convex_between; auto. }
  set (cy := (1 - t) * - hy + t * hy) in *. set (cz := (1 - u) * - hz + u * hz) in *.
  replace (Vector ((1 - s) * - hx + s * hx) cy cz)
    with (add (scale (1 - s) (Vector (- hx) cy cz)) (scale s (Vector hx cy cz))) by (coordinates; ring).
  apply convex_between; auto.
Qed.

(** With y(e) = y₀ + D e for one linear D: where g(y(e)) ≥ 1 and g(y) − w·(y − y₀) ≤ 1 + m at the corners,
    w·(D e) ≥ −m. g is convex. *)
Theorem cut_outside g D y0 w m hx hy hz x y z :
  convex g ->
  (forall a b s, D (add (scale (1 - s) a) (scale s b)) = add (scale (1 - s) (D a)) (scale s (D b))) ->
  (forall sx sy sz, (sx = hx \/ sx = - hx) -> (sy = hy \/ sy = - hy) -> (sz = hz \/ sz = - hz) ->
                    g (add y0 (D (Vector sx sy sz))) - dot w (D (Vector sx sy sz)) <= 1 + m) ->
  Rabs x <= hx -> Rabs y <= hy -> Rabs z <= hz -> 1 <= g (add y0 (D (Vector x y z))) ->
  - m <= dot w (D (Vector x y z)).
Proof.
  intros is_convex linear corners in_x in_y in_z outside.
  assert (f_convex : convex (fun e => g (add y0 (D e)) - dot w (D e))).
  { intros a b s range. rewrite linear.
    replace (add y0 (add (scale (1 - s) (D a)) (scale s (D b))))
      with (add (scale (1 - s) (add y0 (D a))) (scale s (add y0 (D b))))
      by (clear; destruct (D a), (D b); coordinates; ring).
    pose proof (is_convex (add y0 (D a)) (add y0 (D b)) s range).
    replace (dot w (add (scale (1 - s) (D a)) (scale s (D b)))) with ((1 - s) * dot w (D a) + s * dot w (D b))
      by (clear; destruct (D a), (D b); coordinates; ring).
    lra. }
  pose proof (largest_at_a_corner _ hx hy hz (1 + m) x y z f_convex corners in_x in_y in_z). simpl in *. lra.
Qed.

(** A point of the bend's plane whose angle γ is at most A < π, (m, kZ) = ρ (cos γ, sin γ): m sin A ≥ |kZ| cos A. What
    lies beyond is no point of a solid that is bent by no more. *)
Theorem ends_of_a_bend rho gamma A :
  0 <= rho -> Rabs gamma <= A -> A < PI -> Rabs (rho * sin gamma) * cos A <= rho * cos gamma * sin A.
Proof.
  intros positive inside turn.
  assert (same : Rabs (rho * sin gamma) = rho * sin (Rabs gamma) /\ cos gamma = cos (Rabs gamma)).
  { unfold Rabs at 2 3. destruct (Rcase_abs gamma) as [negative | nonnegative].
    - rewrite cos_neg, sin_neg. split; [| reflexivity].
      assert (0 <= sin (- gamma)) as nonnegative
        by (unfold Rabs in inside; destruct (Rcase_abs gamma); apply sin_ge_0; lra).
      rewrite sin_neg in nonnegative. rewrite Rabs_left1; nra.
    - split; [| reflexivity].
      assert (0 <= sin gamma) by (unfold Rabs in inside; destruct (Rcase_abs gamma); apply sin_ge_0; lra).
      apply Rabs_right. nra. }
  destruct same as [-> ->].
  pose proof (Rabs_pos gamma). assert (0 <= sin (A - Rabs gamma)) as nonnegative by (apply sin_ge_0; lra).
  rewrite sin_minus in nonnegative. nra.
Qed.
