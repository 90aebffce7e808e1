(** Powers of numbers that are not negative, with real exponents: that they are convex for exponents of at least 1,
    and Young's inequality. docs/mathematics.md §1 and §4 rest on these through the norms of norm.v. *)
From Coq Require Import Reals Lra Psatz.
Open Scope R_scope.

(** t^p for t ≥ 0; Coq's own [Rpower 0 p] is 1. *)
Definition power (p t : R) : R := if Rle_dec t 0 then 0 else Rpower t p.

Lemma power_of_zero p : power p 0 = 0.
Proof. unfold power. destruct (Rle_dec 0 0); lra. Qed.

Lemma power_of_positive p t : 0 < t -> power p t = Rpower t p.
Proof. intros. unfold power. destruct (Rle_dec t 0); [lra | reflexivity]. Qed.

Lemma power_positive p t : 0 < t -> 0 < power p t.
Proof. intros. rewrite power_of_positive by assumption. apply exp_pos. Qed.

Lemma power_nonnegative p t : 0 <= power p t.
Proof. unfold power. destruct (Rle_dec t 0); [lra | left; apply exp_pos]. Qed.

Lemma power_one t : 0 <= t -> power 1 t = t.
Proof.
  intros [positive | <-]; [| apply power_of_zero]. rewrite power_of_positive by assumption. now apply Rpower_1.
Qed.

Lemma power_of_one p : power p 1 = 1.
Proof. rewrite power_of_positive by lra. unfold Rpower. rewrite ln_1, Rmult_0_r. apply exp_0. Qed.

Lemma power_increases p s t : 0 < p -> 0 <= s <= t -> power p s <= power p t.
Proof.
  intros. destruct (Rle_lt_or_eq_dec 0 s) as [| <-]; [lra | | rewrite power_of_zero; apply power_nonnegative].
  rewrite !power_of_positive by lra. apply Rle_Rpower_l; lra.
Qed.

Lemma power_of_power a b t : power a (power b t) = power (b * a) t.
Proof.
  unfold power at 2 3. destruct (Rle_dec t 0); [apply power_of_zero |].
  rewrite power_of_positive by apply exp_pos. apply Rpower_mult.
Qed.

Lemma power_and_root p t : p <> 0 -> 0 <= t -> power p (power (1 / p) t) = t.
Proof. intros. rewrite power_of_power. replace (1 / p * p) with 1 by (field; assumption). now apply power_one. Qed.

Lemma root_and_power p t : p <> 0 -> 0 <= t -> power (1 / p) (power p t) = t.
Proof. intros. rewrite power_of_power. replace (p * (1 / p)) with 1 by (field; assumption). now apply power_one. Qed.

Lemma power_of_product p s t : 0 <= s -> 0 <= t -> power p (s * t) = power p s * power p t.
Proof.
  intros [s_positive | <-] [t_positive | <-]; rewrite ?Rmult_0_l, ?Rmult_0_r, ?power_of_zero; try lra.
  rewrite !power_of_positive by nra. symmetry. now apply Rpower_mult_distr.
Qed.

Lemma power_of_sum p q t : power (p + q) t = power p t * power q t.
Proof. unfold power. destruct (Rle_dec t 0); [ring |]. apply Rpower_plus. Qed.

Lemma power_at_most_one p t : 0 < p -> 0 <= t <= 1 -> power p t <= 1.
Proof. intros. rewrite <- (power_of_one p). apply power_increases; lra. Qed.

Lemma exp_above_tangent c t : exp c * (1 + (t - c)) <= exp t.
Proof.
  replace (exp t) with (exp c * exp (t - c)) by (rewrite <- exp_plus; f_equal; ring).
  apply Rmult_le_compat_l; [left; apply exp_pos | apply exp_ineq1_le].
Qed.

(** e^((1−θ)s + θt) ≤ (1−θ) e^s + θ e^t. *)
Theorem exp_is_convex s t theta :
  0 <= theta <= 1 -> exp ((1 - theta) * s + theta * t) <= (1 - theta) * exp s + theta * exp t.
Proof.
  intros. set (c := (1 - theta) * s + theta * t).
  pose proof (exp_above_tangent c s) as at_s. pose proof (exp_above_tangent c t) as at_t.
  apply Rle_trans with ((1 - theta) * (exp c * (1 + (s - c))) + theta * (exp c * (1 + (t - c)))).
  - right. unfold c. ring.
  - apply Rplus_le_compat; apply Rmult_le_compat_l; lra.
Qed.

(** t^θ ≤ 1 + θ (t − 1) for θ in [0, 1], with which §4 bounds g and h. *)
Theorem small_powers_are_below_the_tangent theta t : 0 <= theta <= 1 -> 0 < t -> Rpower t theta <= 1 + theta * (t - 1).
Proof.
  intros range positive. pose proof (exp_is_convex 0 (ln t) theta range) as convex.
  rewrite exp_0, exp_ln in convex by assumption. unfold Rpower.
  replace (theta * ln t) with ((1 - theta) * 0 + theta * ln t) by ring. lra.
Qed.

(** Bernoulli's inequality: t^p ≥ 1 + p (t − 1) for p ≥ 1. *)
Theorem large_powers_are_above_the_tangent p t : 1 <= p -> 0 <= t -> 1 + p * (t - 1) <= power p t.
Proof.
  intros large [positive | <-]; [| rewrite power_of_zero; lra]. rewrite power_of_positive by assumption.
  assert (range : 0 <= 1 / p <= 1).
  { split; [apply Rlt_le, Rdiv_lt_0_compat; lra |]. apply Rmult_le_reg_r with p; [lra |]. field_simplify; lra. }
  pose proof (small_powers_are_below_the_tangent (1 / p) (Rpower t p) range (exp_pos _)) as below.
  rewrite Rpower_mult in below. replace (p * (1 / p)) with 1 in below by (field; lra). rewrite Rpower_1 in below by
    assumption.
  apply Rmult_le_compat_l with (r := p) in below; [| lra]. field_simplify in below; lra.
Qed.

(** ((1−θ)s + θt)^p ≤ (1−θ) s^p + θ t^p for p ≥ 1. *)
Theorem powers_are_convex p s t theta :
  1 <= p -> 0 <= s -> 0 <= t -> 0 <= theta <= 1 ->
  power p ((1 - theta) * s + theta * t) <= (1 - theta) * power p s + theta * power p t.
Proof.
  intros large s_nonnegative t_nonnegative range. set (m := (1 - theta) * s + theta * t).
  assert (0 <= m) as [positive | zero] by (unfold m; nra).
  - assert (above : forall x, 0 <= x -> power p m * (1 + p * (x / m - 1)) <= power p x).
    { intros x nonnegative. assert (0 <= x / m) by (apply Rmult_le_pos; [| apply Rlt_le, Rinv_0_lt_compat]; lra).
      replace (power p x) with (power p m * power p (x / m)).
      - apply Rmult_le_compat_l; [apply power_nonnegative | now apply large_powers_are_above_the_tangent].
      - rewrite <- power_of_product by lra. f_equal. field. lra. }
    pose proof (above s s_nonnegative). pose proof (above t t_nonnegative).
    apply Rle_trans with ((1 - theta) * (power p m * (1 + p * (s / m - 1))) + theta * (power p m * (1 + p * (t / m -
      1)))).
    + right. transitivity (power p m * (1 + p * (((1 - theta) * s + theta * t) / m - 1))); [| field; lra].
      fold m. field. lra.
    + apply Rplus_le_compat; apply Rmult_le_compat_l; lra.
  - rewrite <- zero, power_of_zero. pose proof (power_nonnegative p s). pose proof (power_nonnegative p t). nra.
Qed.

(** Young's inequality: st ≤ s^p/p + t^q/q for conjugate exponents, 1/p + 1/q = 1. *)
Theorem young p q s t :
  0 < p -> 0 < q -> 1 / p + 1 / q = 1 -> 0 <= s -> 0 <= t -> s * t <= power p s / p + power q t / q.
Proof.
  intros p_positive q_positive conjugate [s_positive | <-] [t_positive | <-]; rewrite ?power_of_zero, ?Rmult_0_l,
    ?Rmult_0_r.
  2, 3: match goal with |- context [power ?a ?x] => pose proof (power_nonnegative a x) end.
  2, 3: unfold Rdiv; pose proof (Rinv_0_lt_compat _ p_positive); pose proof (Rinv_0_lt_compat _ q_positive); nra.
  2: unfold Rdiv; lra.
  pose proof (Rdiv_lt_0_compat 1 p Rlt_0_1 p_positive). pose proof (Rdiv_lt_0_compat 1 q Rlt_0_1 q_positive).
  pose proof (exp_is_convex (p * ln s) (q * ln t) (1 / q) ltac:(lra)) as convex.
  rewrite !power_of_positive by assumption. unfold Rpower.
  replace (1 - 1 / q) with (1 / p) in convex by lra.
  replace (1 / p * (p * ln s) + 1 / q * (q * ln t)) with (ln s + ln t) in convex by (field; lra).
  rewrite exp_plus, !exp_ln in convex by assumption. unfold Rdiv in *. lra.
Qed.
