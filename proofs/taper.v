(** A projective taper leaves a superquadric convex; its gauge about the focus and a bound of its support function.
    docs/mathematics.md §18; verify/solids/superquadric.cpp, mixed_norm.hpp, kernels/tapered.clh,
    tapered_enclosure.clh, tapered_interior.clh and tapered_box_gauge.clh rely on it. *)
From Coq Require Import Reals Lra Psatz.
From verisq Require Import vector signed_distance power norm certificate superquadric contained_ball.
Open Scope R_scope.

Section taper.
Variables a1 a2 a3 eps1 eps2 k : R.
Hypothesis a1_positive : 0 < a1.
Hypothesis a2_positive : 0 < a2.
Hypothesis a3_positive : 0 < a3.
Hypothesis eps1_range : 0 < eps1 <= 2.
Hypothesis eps2_range : 0 < eps2 <= 2.
Hypothesis k_range : -1 < k < 1.

(** N and M, gauge and support function of the superquadric K. *)
Let N := gauge a1 a2 a3 eps1 eps2.
Let M := support a1 a2 a3 eps1 eps2.

(** P(x, y, z) = (s x, s y, a₃ ζ′), ζ = z/a₃, ζ′ = (ζ − k)/(1 − kζ), s = 1 + kζ′. *)
Definition taper (x : vector) : vector :=
  let zeta := (vz x / a3 - k) / (1 - k * (vz x / a3)) in
  let s := 1 + k * zeta in Vector (s * vx x) (s * vy x) (a3 * zeta).
(** T = P(K), as points w = y + (0, 0, k a₃): the focus (0, 0, −k a₃) is their origin. *)
Definition tapered : region := fun w =>
  exists x, solid a1 a2 a3 eps1 eps2 x /\ w = add (taper x) (Vector 0 0 (k * a3)).
(** g(w) = (N(w) − k w_z/a₃)/(1 − k²). *)
Definition tapered_gauge (w : vector) : R := (N w - k * (vz w / a3)) / (1 - k * k).
(** S = 1 − k² + k w_z/a₃, the size of the section at w. *)
Definition section_size (w : vector) : R := 1 - k * k + k * (vz w / a3).

Lemma fall_positive : 0 < 1 - k * k.
Proof. nra. Qed.

Lemma height_below_gauge w : Rabs (vz w / a3) <= N w.
Proof. unfold N, gauge. apply second_below_norm. pose proof (exponent_range eps1 eps1_range). lra. Qed.

Lemma height_range w : - N w <= vz w / a3 <= N w.
Proof. pose proof (height_below_gauge w) as bound. unfold Rabs in bound. destruct (Rcase_abs (vz w / a3)); lra. Qed.

Lemma size_of_k : 0 <= Rabs k < 1 /\ k * k = Rabs k * Rabs k.
Proof. unfold Rabs. destruct (Rcase_abs k); split; try lra; ring. Qed.

Lemma k_times_height w : - (Rabs k * N w) <= k * (vz w / a3) <= Rabs k * N w.
Proof. pose proof (height_range w). unfold Rabs. destruct (Rcase_abs k); nra. Qed.

(** With w = s x. *)
Lemma taper_scales x : vz x / a3 * k < 1 ->
  add (taper x) (Vector 0 0 (k * a3)) = scale ((1 - k * k) / (1 - k * (vz x / a3))) x.
Proof.
  intros small. destruct x as [x y z]. unfold taper, add, scale; simpl in *.
  set (zeta := z / a3) in *. replace z with (a3 * zeta) by (unfold zeta; field; lra). f_equal; field; lra.
Qed.

Lemma gauge_below_section w : tapered_gauge w <= 1 <-> N w <= section_size w.
Proof.
  pose proof fall_positive. unfold tapered_gauge, section_size. split; intros bound.
  - apply Rmult_le_compat_r with (r := 1 - k * k) in bound; [| lra].
    replace ((N w - k * (vz w / a3)) / (1 - k * k) * (1 - k * k)) with (N w - k * (vz w / a3)) in bound by (field;
      lra). lra.
  - apply quotient_at_most; lra.
Qed.

Lemma section_size_positive w : N w <= section_size w -> 0 < section_size w.
Proof.
  intros bound. pose proof (k_times_height w). pose proof fall_positive. destruct size_of_k as [size square].
  assert (0 <= N w) by apply gauge_nonnegative. unfold section_size in *.
  destruct (Req_dec (N w) 0) as [none | some]; [rewrite none in *; lra | lra].
Qed.

(** y ∈ T says g(w) ≤ 1. *)
Theorem tapered_is_a_unit_ball w : tapered w <-> tapered_gauge w <= 1.
Proof.
  rewrite gauge_below_section. split.
  - intros [x [in_K ->]]. unfold solid in in_K. fold N in in_K. pose proof (k_times_height x).
    assert (0 <= N x) by apply gauge_nonnegative. destruct size_of_k as [size _].
    assert (k * (vz x / a3) < 1) by nra. assert (0 < 1 - k * (vz x / a3)) as positive by lra.
    rewrite taper_scales by lra. set (s := (1 - k * k) / (1 - k * (vz x / a3))).
    assert (0 < s) by (apply Rdiv_lt_0_compat; [apply fall_positive | assumption]).
    unfold N. rewrite gauge_is_homogeneous, Rabs_right by (assumption || lra). fold N.
    unfold section_size. simpl. replace (s * vz x / a3) with (s * (vz x / a3)) by (field; lra).
    replace (1 - k * k) with (s * (1 - k * (vz x / a3)))
      by (unfold s; rewrite <- (Rmult_1_r (1 - k * k)) at 2; unfold Rdiv at 1; rewrite Rmult_assoc, Rinv_l; lra).
    apply Rle_trans with (s * 1); [apply Rmult_le_compat_l; lra | right; ring].
  - intros bound. pose proof (section_size_positive w bound) as positive. set (s := section_size w) in *.
    exists (scale (/ s) w). split.
    + now apply scaled_point_is_in_the_solid.
    + assert (equal : 1 - k * (vz (scale (/ s) w) / a3) = (1 - k * k) / s).
      { simpl. apply Rmult_eq_reg_r with s; [| lra]. field_simplify; [| lra ..]. unfold s, section_size. field. lra. }
      pose proof fall_positive. assert (0 < (1 - k * k) / s) by (apply Rdiv_lt_0_compat; assumption).
      rewrite taper_scales by lra. rewrite equal.
      replace ((1 - k * k) / ((1 - k * k) / s)) with s by (field; lra). coordinates; field; lra.
Qed.

(** Points inside on the device: w lies in T where S is positive and w/S lies in K, or S is replaced by a smaller
    number. *)
Theorem tapered_by_the_section s w : 0 < s <= section_size w -> solid a1 a2 a3 eps1 eps2 (scale (/ s) w) -> tapered w.
Proof.
  intros [positive smaller] in_K. apply tapered_is_a_unit_ball, gauge_below_section. unfold solid in in_K.
  pose proof (Rinv_0_lt_compat s positive).
  rewrite gauge_is_homogeneous, Rabs_right in in_K by (assumption || lra). fold N in in_K.
  apply Rmult_le_compat_l with (r := s) in in_K; [| lra]. replace (s * (/ s * N w)) with (N w) in in_K by (field; lra).
    lra.
Qed.

(** g is homogeneous, *)
Theorem tapered_gauge_is_homogeneous c w : 0 <= c -> tapered_gauge (scale c w) = c * tapered_gauge w.
Proof.
  intros. pose proof fall_positive. unfold tapered_gauge, N. rewrite gauge_is_homogeneous, Rabs_right by (assumption ||
    lra).
  simpl. field. lra.
Qed.

(** triangles' inequalities hold, *)
Theorem tapered_gauge_of_sum v w : tapered_gauge (add v w) <= tapered_gauge v + tapered_gauge w.
Proof.
  pose proof fall_positive as positive. apply Rmult_le_reg_r with (1 - k * k); [assumption |].
  unfold tapered_gauge, N. pose proof (gauge_of_sum a1 a2 a3 eps1 eps2 a1_positive a2_positive a3_positive eps1_range
    eps2_range v w).
  simpl. field_simplify; [| lra ..].
  replace (k * (vz v + vz w) / a3) with (k * vz v / a3 + k * vz w / a3) in * by (field; lra).
  apply Rmult_le_reg_r with a3; [assumption |]. field_simplify; [| lra ..]. nra.
Qed.

(** and it is positive, between N/(1 + |k|) and N/(1 − |k|). *)
Theorem tapered_gauge_beside_gauge w :
  N w / (1 + Rabs k) <= tapered_gauge w /\ tapered_gauge w <= N w / (1 - Rabs k).
Proof.
  pose proof (k_times_height w) as bounds. destruct size_of_k as [range square].
  unfold tapered_gauge. replace (1 - k * k) with ((1 - Rabs k) * (1 + Rabs k)) by (rewrite square; ring). split.
  - apply quotient_at_least; [nra |].
    replace ((1 - Rabs k) * (1 + Rabs k) * (N w / (1 + Rabs k))) with ((1 - Rabs k) * N w) by (field; lra). lra.
  - apply quotient_at_most; [nra |].
    replace ((1 - Rabs k) * (1 + Rabs k) * (N w / (1 - Rabs k))) with ((1 + Rabs k) * N w) by (field; lra). lra.
Qed.

(** T is convex. *)
Theorem tapered_is_convex : convex tapered.
Proof.
  intros v w s in_v in_w range. apply tapered_is_a_unit_ball in in_v, in_w. apply tapered_is_a_unit_ball.
  replace (on_the_way v w s) with (add (scale (1 - s) v) (scale s w)) by (unfold on_the_way; coordinates; ring).
  eapply Rle_trans; [apply tapered_gauge_of_sum |]. rewrite !tapered_gauge_is_homogeneous by lra. nra.
Qed.

(** A point b = x/g⁺ lies in T for every g⁺ ≥ g(x), g⁺ > 0. *)
Theorem scaled_point_is_in_the_tapered x g : 0 < g -> tapered_gauge x <= g -> tapered (scale (/ g) x).
Proof.
  intros positive bound. apply tapered_is_a_unit_ball. pose proof (Rinv_0_lt_compat g positive).
  rewrite tapered_gauge_is_homogeneous by lra.
  replace 1 with (/ g * g) by (field; lra). apply Rmult_le_compat_l; lra.
Qed.

(** The kernels make u m times as long with m (N(u) − k u_z/a₃) ≤ 1 − k². *)
Theorem kernels_point_is_in_the_tapered u m :
  0 <= m -> m * (N u - k * (vz u / a3)) <= 1 - k * k -> tapered (scale m u).
Proof.
  intros nonnegative bound. apply tapered_is_a_unit_ball. rewrite tapered_gauge_is_homogeneous by assumption.
  unfold tapered_gauge. pose proof fall_positive.
  replace (m * ((N u - k * (vz u / a3)) / (1 - k * k))) with (m * (N u - k * (vz u / a3)) / (1 - k * k)) by (field;
    lra).
  apply quotient_at_most; lra.
Qed.

Lemma gauge_in_the_tapered w : tapered w -> N w <= 1 + Rabs k.
Proof.
  intros in_T. apply tapered_is_a_unit_ball in in_T. destruct (tapered_gauge_beside_gauge w) as [lower _].
  pose proof (Rabs_pos k).
  apply Rmult_le_reg_r with (/ (1 + Rabs k)); [apply Rinv_0_lt_compat; lra |].
  rewrite Rinv_r by lra. unfold Rdiv in lower. lra.
Qed.

(** f(τ) = M(v + (0, 0, kτ/a₃)) − τ. For any τ: h(v) ≤ (1 − k²) τ + (1 + |k|) max(0, f(τ)). *)
Definition tilted v tau := add v (Vector 0 0 (k * tau / a3)).

Theorem tapered_support v tau :
  supports tapered v ((1 - k * k) * tau + (1 + Rabs k) * Rmax 0 (M (tilted v tau) - tau)).
Proof.
  intros w in_T. pose proof (gauge_in_the_tapered w in_T) as small.
  apply tapered_is_a_unit_ball, gauge_below_section in in_T. unfold section_size in in_T.
  pose proof (height_range w) as heights.
  pose proof (support_times_gauge a1 a2 a3 eps1 eps2 a1_positive a2_positive a3_positive eps1_range eps2_range
                (tilted v tau) w) as hoelder. fold N M in hoelder.
  replace (dot (tilted v tau) w) with (dot v w + k * tau * (vz w / a3)) in hoelder
    by (unfold tilted; coordinates; field; lra).
  assert (0 <= M (tilted v tau)) by (apply support_nonnegative; assumption).
  set (m := M (tilted v tau)) in *. set (o := vz w / a3) in *. set (n := N w) in *.
  pose proof (Rmax_l 0 (m - tau)). pose proof (Rmax_r 0 (m - tau)). set (f := Rmax 0 (m - tau)) in *.
  assert (0 <= n) by apply gauge_nonnegative. pose proof (Rabs_pos k).
  destruct (Rle_or_lt 0 tau).
  - apply Rle_trans with ((tau + f) * n - k * tau * o); [nra |].
    assert (tau * (n - k * o) <= tau * (1 - k * k)) by (apply Rmult_le_compat_l; lra). nra.
  - (* v·w ≤ m n − kτo, n ≤ 1 + |k|, |o| ≤ n, f ≥ m − τ *)
    destruct size_of_k as [_ square].
    assert (m * n <= m * (1 + Rabs k)) by (apply Rmult_le_compat_l; assumption).
    assert (tilt : (- tau) * (k * o) <= (- tau) * (Rabs k * (1 + Rabs k))).
    { apply Rmult_le_compat_l; [lra |]. pose proof (k_times_height w) as share. fold o n in share.
      assert (Rabs k * n <= Rabs k * (1 + Rabs k)) by (apply Rmult_le_compat_l; assumption). lra. }
    assert ((1 + Rabs k) * (m - tau) <= (1 + Rabs k) * f) by (apply Rmult_le_compat_l; lra).
    rewrite square. lra.
Qed.

(** Normals need no root. For any n, v = n − (0, 0, M(n) k/a₃) has h(v) ≤ (1 − k²) M(n); m, an upper bound of M(n),
    may stand for it in both places. *)
Theorem tilted_normal n m : M n <= m -> supports tapered (sub n (Vector 0 0 (m * k / a3))) ((1 - k * k) * m).
Proof.
  intros bound w in_T. apply tapered_is_a_unit_ball, gauge_below_section in in_T. unfold section_size in in_T.
  pose proof (support_times_gauge a1 a2 a3 eps1 eps2 a1_positive a2_positive a3_positive eps1_range eps2_range n w) as
    hoelder.
  fold N M in hoelder. pose proof (height_range w).
  assert (0 <= M n) by (apply support_nonnegative; assumption).
  replace (dot (sub n (Vector 0 0 (m * k / a3))) w) with (dot n w - m * (k * (vz w / a3))) by (coordinates; field; lra).
  assert (M n * N w <= m * N w) by (apply Rmult_le_compat_r; lra).
  assert (m * (N w - k * (vz w / a3)) <= m * (1 - k * k)) by (apply Rmult_le_compat_l; lra). lra.
Qed.

(** §2 for a tapered solid: sd(q) ≥ (v·q − h)/|v| for the h above, sd(q) ≤ |q − x/g⁺|. *)
Theorem tapered_lower_bound v tau q s :
  v <> zero -> signed_distance tapered q s ->
  (dot v q - ((1 - k * k) * tau + (1 + Rabs k) * Rmax 0 (M (tilted v tau) - tau))) / length v <= s.
Proof. intros. apply lower_bound with (K := tapered); auto using tapered_support. Qed.

Theorem tapered_upper_bound x g q s :
  0 < g -> tapered_gauge x <= g -> signed_distance tapered q s -> s <= distance q (scale (/ g) x).
Proof. intros. apply upper_bound_outside with (K := tapered); auto using scaled_point_is_in_the_tapered. Qed.

(** Points are folded by |x| and |y| alone: what ball_by_cones_of_two_octants asks for. *)
Theorem tapered_falls_with_width : falls_with_width tapered.
Proof.
  intros v w first second height in_T. apply tapered_is_a_unit_ball in in_T. apply tapered_is_a_unit_ball.
  apply gauge_below_section in in_T. apply gauge_below_section. unfold section_size in *. rewrite height.
  eapply Rle_trans; [| exact in_T]. unfold N. apply gauge_rises; try assumption.
  unfold no_larger. rewrite height. repeat split; try assumption. apply Rle_refl.
Qed.

(** The ball of radius (1 − g(q)) r (1 − |k|) about q lies in T, if the one of radius r about the centre lies in K. *)
Theorem tapered_central_ball q r t :
  0 < r -> (forall y, N y <= length y / r) -> t <= (1 - tapered_gauge q) * (r * (1 - Rabs k)) ->
  lies_in (ball q t) tapered.
Proof.
  intros positive inner bound x near. unfold ball in near. rewrite distance_symmetric in near.
  apply tapered_is_a_unit_ball. replace x with (add q (sub x q)) by (coordinates; ring).
  eapply Rle_trans; [apply tapered_gauge_of_sum |]. unfold distance in near.
  destruct (tapered_gauge_beside_gauge (sub x q)) as [_ upper]. pose proof (inner (sub x q)) as small.
  destruct size_of_k as [below_one _].
  set (share := r * (1 - Rabs k)) in *. assert (0 < share) by (unfold share; nra).
  assert (scaled : tapered_gauge (sub x q) <= length (sub x q) / share).
  { eapply Rle_trans; [exact upper |].
    replace (length (sub x q) / share) with (length (sub x q) / r / (1 - Rabs k)) by (unfold share; field; lra).
    unfold Rdiv at 1 2. apply Rmult_le_compat_r; [apply Rlt_le, Rinv_0_lt_compat; lra | assumption]. }
  apply Rmult_le_compat_l with (r := share) in scaled; [| lra].
  replace (share * (length (sub x q) / share)) with (length (sub x q)) in scaled by (field; lra). nra.
Qed.

(** Cubes: a point w of T whose section's norm is at least r has a r + b w_z/a₃ ≤ D N(w) ≤ D S, D = ‖(a, b)‖_q₁. *)
Theorem tapered_white a b r w :
  0 <= a -> r <= norm (2 / eps2) (vx w / a1) (vy w / a2) -> tapered w ->
  a * r + b * (vz w / a3) <= dual_norm eps1 a b * section_size w.
Proof.
  intros nonnegative section in_T. apply tapered_is_a_unit_ball, gauge_below_section in in_T.
  pose proof (hoelder eps1 a b (norm (2 / eps2) (vx w / a1) (vy w / a2)) (vz w / a3) eps1_range) as bound.
  fold (gauge a1 a2 a3 eps1 eps2 w) in bound. fold N in bound.
  pose proof (dual_norm_nonnegative eps1 a b eps1_range).
  assert (a * r <= a * norm (2 / eps2) (vx w / a1) (vy w / a2)) by (apply Rmult_le_compat_l; assumption).
  assert (dual_norm eps1 a b * N w <= dual_norm eps1 a b * section_size w) by (apply Rmult_le_compat_l; assumption).
    lra.
Qed.
End taper.
