(** A superquadric is the unit ball of a norm g, and the dual norm h is its support function. docs/mathematics.md §1,
    §2, §5 (the shortcut through the centre); verify/solids/superquadric.cpp, mixed_norm.hpp, contained_ball.cpp and
    kernels/superquadric.clh rely on it. *)
From Coq Require Import Reals Lra Psatz.
From verisq Require Import vector signed_distance power norm certificate.
Open Scope R_scope.

Section superquadric.
Variables a1 a2 a3 eps1 eps2 : R.
Hypothesis a1_positive : 0 < a1.
Hypothesis a2_positive : 0 < a2.
Hypothesis a3_positive : 0 < a3.
Hypothesis eps1_range : 0 < eps1 <= 2.
Hypothesis eps2_range : 0 < eps2 <= 2.

(** g(x) = ‖(‖(x/a₁, y/a₂)‖_p₂, z/a₃)‖_p₁, p₁ = 2/ε₁, p₂ = 2/ε₂. *)
Definition gauge (x : vector) : R := norm (2 / eps1) (norm (2 / eps2) (vx x / a1) (vy x / a2)) (vz x / a3).
(** K = {g ≤ 1}. *)
Definition solid : region := fun x => gauge x <= 1.
(** F, the left side of the paper's Eq. (1). *)
Definition paper_left_side (x : vector) : R :=
  power (eps2 / eps1) (power (2 / eps2) (Rabs (vx x / a1)) + power (2 / eps2) (Rabs (vy x / a2)))
  + power (2 / eps1) (Rabs (vz x / a3)).
(** h(v), with the conjugate exponents. *)
Definition support (v : vector) : R := dual_norm eps1 (dual_norm eps2 (a1 * vx v) (a2 * vy v)) (a3 * vz v).

Let p1_large : 1 <= 2 / eps1 := exponent_range eps1 eps1_range.
Let p2_large : 1 <= 2 / eps2 := exponent_range eps2 eps2_range.

(** F = g^p₁. *)
Theorem paper_left_side_is_a_power_of_the_gauge x : paper_left_side x = power (2 / eps1) (gauge x).
Proof.
  unfold paper_left_side, gauge. rewrite power_of_norm by lra. f_equal.
  rewrite abs_of_norm. unfold norm. rewrite power_of_power. f_equal. field. lra.
Qed.

(** {F ≤ 1} = {g ≤ 1}. *)
Theorem solid_is_the_papers x : solid x <-> paper_left_side x <= 1.
Proof.
  rewrite paper_left_side_is_a_power_of_the_gauge. unfold solid.
  assert (0 <= gauge x) by apply norm_nonnegative. split; intros bound.
  - apply power_at_most_one; lra.
  - rewrite <- (root_and_power (2 / eps1) (gauge x)) by lra. apply power_at_most_one; [apply inverse_positive; lra |].
    split; [apply power_nonnegative | assumption].
Qed.

Lemma gauge_nonnegative x : 0 <= gauge x.
Proof. apply norm_nonnegative. Qed.

Theorem gauge_is_homogeneous c x : gauge (scale c x) = Rabs c * gauge x.
Proof.
  unfold gauge. destruct x as [x y z]; simpl.
  replace (c * x / a1) with (c * (x / a1)) by (field; lra). replace (c * y / a2) with (c * (y / a2)) by (field; lra).
  replace (c * z / a3) with (c * (z / a3)) by (field; lra).
  rewrite norm_is_homogeneous by lra. rewrite <- (norm_is_homogeneous (2 / eps1)) by lra.
  apply Rle_antisym; apply norm_rises; try lra; rewrite !Rabs_mult, ?Rabs_Rabsolu; lra.
Qed.

(** g is a norm: g(x + y) ≤ g(x) + g(y), *)
Theorem gauge_of_sum x y : gauge (add x y) <= gauge x + gauge y.
Proof.
  unfold gauge. destruct x as [x y' z], y as [u v w]; simpl.
  replace ((x + u) / a1) with (x / a1 + u / a1) by (field; lra). replace ((y' + v) / a2) with (y' / a2 + v / a2) by
    (field; lra).
  replace ((z + w) / a3) with (z / a3 + w / a3) by (field; lra).
  eapply Rle_trans; [| now apply minkowski]. apply norm_rises; [lra | | lra].
  pose proof (norm_nonnegative (2 / eps2) (x / a1) (y' / a2)). pose proof (norm_nonnegative (2 / eps2) (u / a1) (v /
    a2)).
  rewrite abs_of_norm, (Rabs_right (_ + _)) by lra. now apply minkowski.
Qed.

(** and 0 at the centre alone. *)
Theorem gauge_is_definite x : gauge x = 0 <-> x = zero.
Proof.
  unfold gauge. split.
  - intros none. apply norm_zero_only in none as [section height]; [| lra].
    apply norm_zero_only in section as [first second]; [| lra]. destruct x as [x y z]; simpl in *.
    unfold zero. f_equal.
    + replace x with (x / a1 * a1) by (field; lra). rewrite first. ring.
    + replace y with (y / a2 * a2) by (field; lra). rewrite second. ring.
    + replace z with (z / a3 * a3) by (field; lra). rewrite height. ring.
  - intros ->. unfold zero; simpl. unfold Rdiv. rewrite !Rmult_0_l, !norm_of_zero. reflexivity.
Qed.

(** K is convex. *)
Theorem solid_is_convex : convex solid.
Proof.
  intros x y s in_x in_y range. unfold solid in *.
  replace (on_the_way x y s) with (add (scale (1 - s) x) (scale s y)) by (unfold on_the_way; coordinates; ring).
  eapply Rle_trans; [apply gauge_of_sum |]. rewrite !gauge_is_homogeneous, !Rabs_right by lra. nra.
Qed.

Definition no_larger (x y : vector) := Rabs (vx x) <= Rabs (vx y) /\ Rabs (vy x) <= Rabs (vy y) /\ Rabs (vz x) <= Rabs
  (vz y).

Lemma abs_of_quotient x a : 0 < a -> Rabs (x / a) = Rabs x * / a.
Proof. intros. unfold Rdiv. rewrite Rabs_mult, (Rabs_right (/ a)); [reflexivity |]. apply Rle_ge, Rlt_le,
  Rinv_0_lt_compat; assumption. Qed.

(** g is even in each coordinate and rises with each |coordinate|. *)
Theorem gauge_rises x y : no_larger x y -> gauge x <= gauge y.
Proof.
  intros [first [second third]].
  assert (quotient : forall u v a, 0 < a -> Rabs u <= Rabs v -> Rabs (u / a) <= Rabs (v / a)).
  { intros u v a positive smaller. rewrite !abs_of_quotient by assumption.
    apply Rmult_le_compat_r; [apply Rlt_le, Rinv_0_lt_compat |]; assumption. }
  unfold gauge. apply norm_rises; [lra | | auto].
  rewrite !abs_of_norm. apply norm_rises; auto; lra.
Qed.

(** Hölder: v·x ≤ h(v) g(x), *)
Theorem support_times_gauge v x : dot v x <= support v * gauge x.
Proof.
  unfold support, gauge, dot. destruct v as [u v w], x as [x y z]; simpl.
  replace (u * x + v * y + w * z) with (a1 * u * (x / a1) + a2 * v * (y / a2) + a3 * w * (z / a3)) by (field; lra).
  eapply Rle_trans; [| now apply hoelder]. apply Rplus_le_compat_r. now apply hoelder.
Qed.

Lemma dual_norm_nonnegative eps s t : 0 < eps <= 2 -> 0 <= dual_norm eps s t.
Proof.
  intros. unfold dual_norm. destruct (Req_EM_T eps 2); [| apply norm_nonnegative].
  pose proof (Rabs_pos s). pose proof (Rmax_l (Rabs s) (Rabs t)). lra.
Qed.

Lemma support_nonnegative v : 0 <= support v.
Proof. now apply dual_norm_nonnegative. Qed.

(** so that h(v) ≥ v·x for all x in K. *)
Theorem support_is_a_bound v : supports solid v (support v).
Proof.
  intros x in_K. unfold solid in in_K. pose proof (support_times_gauge v x). pose proof (support_nonnegative v).
  pose proof (gauge_nonnegative x). nra.
Qed.

(** §2 for a superquadric, from below: sd(q) ≥ (v·q − h(v)) / |v|. *)
Theorem superquadric_lower_bound v q s :
  v <> zero -> signed_distance solid q s -> (dot v q - support v) / length v <= s.
Proof. intros. apply lower_bound with (K := solid); auto using support_is_a_bound. Qed.

(** b = x/g⁺ lies in K for every g⁺ ≥ g(x), g⁺ > 0, *)
Theorem scaled_point_is_in_the_solid x g : 0 < g -> gauge x <= g -> solid (scale (/ g) x).
Proof.
  intros positive bound. unfold solid. pose proof (Rinv_0_lt_compat g positive).
  rewrite gauge_is_homogeneous, Rabs_right by lra.
  replace 1 with (/ g * g) by (field; lra). apply Rmult_le_compat_l; lra.
Qed.

(** so that sd(q) ≤ |q − b|. *)
Theorem superquadric_upper_bound x g q s :
  0 < g -> gauge x <= g -> signed_distance solid q s -> s <= distance q (scale (/ g) x).
Proof. intros. apply upper_bound_outside with (K := solid); auto using scaled_point_is_in_the_solid. Qed.

(** The kernels take b = (1 − L) x with L ≥ log g(x), L ≤ 1: g(b) = (1 − L) g(x) ≤ (1 − L) e^L ≤ 1. *)
Theorem kernels_point_is_in_the_solid x L : ln (gauge x) <= L -> L <= 1 -> solid (scale (1 - L) x).
Proof.
  intros bound small. unfold solid. rewrite gauge_is_homogeneous, Rabs_right by lra.
  pose proof (gauge_nonnegative x) as nonnegative. pose proof (exp_ineq1_le (- L)) as tangent.
  assert (gauge x <= exp L).
  { destruct nonnegative as [positive | <-]; [| left; apply exp_pos].
    rewrite <- (exp_ln (gauge x)) by assumption. destruct bound as [less | ->]; [left; now apply exp_increasing | lra].
      }
  pose proof (exp_pos L). apply Rle_trans with (exp (- L) * exp L); [nra |].
  rewrite <- exp_plus. replace (- L + L) with 0 by ring. rewrite exp_0. lra.
Qed.

(** K contains the ball of its centre whose radius is (Σ 1/aᵢ²)^(−1/2): g(y) ≤ |y| (Σ 1/aᵢ²)^(1/2), *)
Theorem gauge_below_length y : gauge y <= length y * length (Vector (/ a1) (/ a2) (/ a3)).
Proof.
  assert (sum : gauge y <= Rabs (vx y) * / a1 + Rabs (vy y) * / a2 + Rabs (vz y) * / a3).
  { assert (one : forall p s t, 1 <= p -> norm p s t <= Rabs s + Rabs t).
    { intros p s t large. eapply Rle_trans; [apply (norms_fall_as_exponents_rise 1 p); lra |]. unfold norm.
      replace (1 / 1) with 1 by field.
      pose proof (Rabs_pos s). pose proof (Rabs_pos t). rewrite !power_one by (rewrite ?power_one; lra). lra. }
    unfold gauge. eapply Rle_trans; [now apply one |]. rewrite abs_of_norm.
    rewrite <- !abs_of_quotient by assumption. apply Rplus_le_compat_r. now apply one. }
  eapply Rle_trans; [exact sum |].
  pose proof (cauchy_schwarz (Vector (Rabs (vx y)) (Rabs (vy y)) (Rabs (vz y))) (Vector (/ a1) (/ a2) (/ a3))) as bound.
  unfold dot at 1 in bound; simpl in bound. eapply Rle_trans; [exact bound |].
  apply Rmult_le_compat_r; [apply length_nonnegative |]. right. unfold length, dot; simpl. f_equal.
  pose proof (fun x => Rsqr_abs x) as square. unfold Rsqr in square. rewrite <- !square. reflexivity.
Qed.

Lemma p_norm_below_euclidean p s t : 2 <= p -> norm p s t <= sqrt (s * s + t * t).
Proof.
  intros large. eapply Rle_trans; [apply (norms_fall_as_exponents_rise 2 p); lra |]. right. unfold norm.
  assert (square : forall x, power 2 (Rabs x) = x * x).
  { intros x. replace 2 with (1 + 1) by ring. rewrite power_of_sum, power_one by apply Rabs_pos.
    pose proof (Rsqr_abs x) as equal. unfold Rsqr in equal. lra. }
  rewrite !square. assert (0 <= s * s + t * t) as [positive | none] by nra.
  - rewrite power_of_positive by assumption. unfold Rdiv. rewrite Rmult_1_l. now apply Rpower_sqrt.
  - rewrite <- none, power_of_zero, sqrt_0. reflexivity.
Qed.

(** and for exponents ε of at most 1 the ball of radius min aᵢ. *)
Theorem gauge_below_length_of_round_solids r y :
  eps1 <= 1 -> eps2 <= 1 -> 0 < r -> r <= a1 -> r <= a2 -> r <= a3 -> gauge y <= length y / r.
Proof.
  intros small1 small2 positive r1 r2 r3.
  assert (large : forall eps, 0 < eps <= 2 -> eps <= 1 -> 2 <= 2 / eps).
  { intros eps range small. apply Rmult_le_reg_r with eps; [lra |]. field_simplify; lra. }
  assert (share : forall x a, r <= a -> x / a * (x / a) <= x / r * (x / r)).
  { intros x a above. assert (/ a <= / r) by (apply Rinv_le_contravar; assumption).
    assert (0 < / a) by (apply Rinv_0_lt_compat; lra). unfold Rdiv. pose proof (Rle_0_sqr x) as square. unfold Rsqr in
      square.
    replace (x * / a * (x * / a)) with (x * x * (/ a * / a)) by ring.
    replace (x * / r * (x * / r)) with (x * x * (/ r * / r)) by ring. apply Rmult_le_compat_l; [assumption | nra]. }
  unfold gauge. eapply Rle_trans; [apply p_norm_below_euclidean, large; lra |].

  assert (section : norm (2 / eps2) (vx y / a1) (vy y / a2) * norm (2 / eps2) (vx y / a1) (vy y / a2)
                    <= vx y / a1 * (vx y / a1) + vy y / a2 * (vy y / a2)).
  { pose proof (p_norm_below_euclidean (2 / eps2) (vx y / a1) (vy y / a2) (large eps2 ltac:(lra) ltac:(lra))) as below.
    pose proof (norm_nonnegative (2 / eps2) (vx y / a1) (vy y / a2)).
    pose proof (sqrt_sqrt (vx y / a1 * (vx y / a1) + vy y / a2 * (vy y / a2)) ltac:(nra)) as square.
    rewrite <- square. apply Rmult_le_compat; assumption. }
  replace (length y / r) with (sqrt (vx y / r * (vx y / r) + vy y / r * (vy y / r) + vz y / r * (vz y / r))).
  - apply sqrt_le_1_alt. pose proof (share (vx y) a1 r1). pose proof (share (vy y) a2 r2). pose proof (share (vz y) a3
    r3). lra.
  - unfold length, dot. replace (vx y / r * (vx y / r) + vy y / r * (vy y / r) + vz y / r * (vz y / r))
      with (Rsqr (/ r) * (vx y * vx y + vy y * vy y + vz y * vz y)) by (unfold Rsqr; field; lra).
    rewrite sqrt_mult_alt by apply Rle_0_sqr. rewrite sqrt_Rsqr by (apply Rlt_le, Rinv_0_lt_compat; assumption).
    field. lra.
Qed.

(** The ball of radius (1 − g(q)) r about q lies in K if the one of radius r about the centre does: g(q + y) ≤ g(q) +
    g(y). *)
Theorem central_ball q r t :
  0 < r -> (forall y, gauge y <= length y / r) -> t <= (1 - gauge q) * r -> lies_in (ball q t) solid.
Proof.
  intros positive inner bound x near. unfold ball in near. rewrite distance_symmetric in near. unfold solid.
  replace x with (add q (sub x q)) by (coordinates; ring).
  eapply Rle_trans; [apply gauge_of_sum |]. pose proof (inner (sub x q)) as small. unfold distance in near.
  apply Rmult_le_compat_l with (r := r) in small; [| lra].
  replace (r * (length (sub x q) / r)) with (length (sub x q)) in small by (field; lra). nra.
Qed.
End superquadric.
