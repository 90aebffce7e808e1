(** The p-norm of two numbers, p a real number of at least 1, and its dual: Minkowski's inequality, Hölder's, and how
    norms fall as exponents rise. docs/mathematics.md §1 and §4; superquadric.v puts two of them together. *)
From Coq Require Import Reals Lra Psatz.
From verisq Require Import power.
Open Scope R_scope.

(** ‖(s, t)‖_p = (|s|^p + |t|^p)^(1/p). *)
Definition norm (p s t : R) : R := power (1 / p) (power p (Rabs s) + power p (Rabs t)).

(** The dual norm of that with p = 2/ε: the exponent is q = 2/(2 − ε), and ε = 2 gives q = ∞, the maximum. *)
Definition dual_norm (eps s t : R) : R := if Req_EM_T eps 2 then Rmax (Rabs s) (Rabs t) else norm (2 / (2 - eps)) s t.

Lemma sum_of_powers_nonnegative p s t : 0 <= power p (Rabs s) + power p (Rabs t).
Proof. pose proof (power_nonnegative p (Rabs s)). pose proof (power_nonnegative p (Rabs t)). lra. Qed.

Lemma norm_nonnegative p s t : 0 <= norm p s t.
Proof. apply power_nonnegative. Qed.

Lemma abs_of_norm p s t : Rabs (norm p s t) = norm p s t.
Proof. apply Rabs_right, Rle_ge, norm_nonnegative. Qed.

Lemma inverse_positive p : 0 < p -> 0 < 1 / p.
Proof. intros. apply Rdiv_lt_0_compat; lra. Qed.

Lemma power_of_norm p s t : 0 < p -> power p (norm p s t) = power p (Rabs s) + power p (Rabs t).
Proof. intros. apply power_and_root; [lra | apply sum_of_powers_nonnegative]. Qed.

Lemma norm_at_most p s t c : 0 < p -> 0 <= c -> power p (Rabs s) + power p (Rabs t) <= power p c -> norm p s t <= c.
Proof.
  intros positive nonnegative bound. rewrite <- (root_and_power p c) by lra.
  apply power_increases; [now apply inverse_positive |]. split; [apply sum_of_powers_nonnegative | assumption].
Qed.

Lemma norm_at_least p s t c : 0 < p -> 0 <= c -> power p c <= power p (Rabs s) + power p (Rabs t) -> c <= norm p s t.
Proof.
  intros positive nonnegative bound. rewrite <- (root_and_power p c) by lra.
  apply power_increases; [now apply inverse_positive |]. split; [apply power_nonnegative | assumption].
Qed.

Lemma first_below_norm p s t : 0 < p -> Rabs s <= norm p s t.
Proof. intros. apply norm_at_least; [assumption | apply Rabs_pos |]. pose proof (power_nonnegative p (Rabs t)). lra.
  Qed.

Lemma second_below_norm p s t : 0 < p -> Rabs t <= norm p s t.
Proof. intros. apply norm_at_least; [assumption | apply Rabs_pos |]. pose proof (power_nonnegative p (Rabs s)). lra.
  Qed.

(** Norms rise with each |coordinate|. *)
Theorem norm_rises p s t u v : 0 < p -> Rabs s <= Rabs u -> Rabs t <= Rabs v -> norm p s t <= norm p u v.
Proof.
  intros positive first second. apply norm_at_most; [assumption | apply norm_nonnegative |].
  rewrite power_of_norm by assumption.
  apply Rplus_le_compat; apply power_increases; try assumption; split; auto using Rabs_pos.
Qed.

Lemma norm_of_zero p : norm p 0 0 = 0.
Proof. unfold norm. rewrite Rabs_R0, power_of_zero, Rplus_0_l. apply power_of_zero. Qed.

Theorem norm_is_homogeneous p c s t : 0 < p -> norm p (c * s) (c * t) = Rabs c * norm p s t.
Proof.
  intros. unfold norm. rewrite !Rabs_mult, !power_of_product by apply Rabs_pos.
  rewrite <- Rmult_plus_distr_l, power_of_product; [| apply power_nonnegative | apply sum_of_powers_nonnegative].
  rewrite root_and_power; [reflexivity | lra | apply Rabs_pos].
Qed.

Lemma norm_zero_only p s t : 0 < p -> norm p s t = 0 -> s = 0 /\ t = 0.
Proof.
  intros positive zero. pose proof (first_below_norm p s t positive). pose proof (second_below_norm p s t positive).
  pose proof (Rabs_pos s). pose proof (Rabs_pos t). pose proof (Rle_abs s). pose proof (Rle_abs t).
  pose proof (Rle_abs (- s)). pose proof (Rle_abs (- t)). rewrite Rabs_Ropp in *. lra.
Qed.

Lemma abs_of_mean s u theta :
  0 <= theta <= 1 -> Rabs ((1 - theta) * s + theta * u) <= (1 - theta) * Rabs s + theta * Rabs u.
Proof.
  intros. eapply Rle_trans; [apply Rabs_triang |]. rewrite !Rabs_mult, (Rabs_right (1 - theta)), (Rabs_right theta) by
    lra.
  apply Rle_refl.
Qed.

(** The unit ball is convex, *)
Lemma mean_of_units p s t u v theta :
  1 <= p -> 0 <= theta <= 1 -> norm p s t <= 1 -> norm p u v <= 1 ->
  norm p ((1 - theta) * s + theta * u) ((1 - theta) * t + theta * v) <= 1.
Proof.
  intros large range first second.
  assert (powers : forall a b, norm p a b <= 1 -> power p (Rabs a) + power p (Rabs b) <= 1).
  { intros a b small. rewrite <- power_of_norm by lra. apply power_at_most_one; [lra |].
    split; [apply norm_nonnegative | assumption]. }
  apply norm_at_most; [lra .. |]. rewrite power_of_one.
  assert (one : forall a b, power p (Rabs ((1 - theta) * a + theta * b))
                            <= (1 - theta) * power p (Rabs a) + theta * power p (Rabs b)).
  { intros a b. eapply Rle_trans; [| apply powers_are_convex; auto using Rabs_pos].
    apply power_increases; [lra |]. split; [apply Rabs_pos | now apply abs_of_mean]. }
  pose proof (one s u). pose proof (one t v). pose proof (powers s t first). pose proof (powers u v second). nra.
Qed.

(** which is Minkowski's inequality: ‖(s + u, t + v)‖ ≤ ‖(s, t)‖ + ‖(u, v)‖. *)
Theorem minkowski p s t u v : 1 <= p -> norm p (s + u) (t + v) <= norm p s t + norm p u v.
Proof.
  intros large. pose proof (norm_nonnegative p s t). pose proof (norm_nonnegative p u v).
  destruct (Req_dec (norm p s t) 0) as [zero | first].
  { rewrite zero. apply norm_zero_only in zero as [-> ->]; [| lra]. rewrite !Rplus_0_l. lra. }
  destruct (Req_dec (norm p u v) 0) as [zero | second].
  { rewrite zero. apply norm_zero_only in zero as [-> ->]; [| lra]. rewrite !Rplus_0_r. lra. }
  set (m := norm p s t) in *. set (n := norm p u v) in *.
  assert (unit : forall a b c, 0 < c -> norm p a b = c -> norm p (/ c * a) (/ c * b) <= 1).
  { intros a b c positive length. rewrite norm_is_homogeneous, length, Rabs_right by
      (try lra; apply Rle_ge, Rlt_le, Rinv_0_lt_compat; assumption). right. field. lra. }
  pose proof (mean_of_units p (/ m * s) (/ m * t) (/ n * u) (/ n * v) (n / (m + n))) as mean.
  assert (0 <= n / (m + n)) by (apply Rmult_le_pos; [| apply Rlt_le, Rinv_0_lt_compat]; lra).
  assert (n / (m + n) <= 1) by (apply Rmult_le_reg_r with (m + n); [| field_simplify]; lra).
  specialize (mean large ltac:(lra) (unit s t m ltac:(lra) eq_refl) (unit u v n ltac:(lra) eq_refl)).
  replace ((1 - n / (m + n)) * (/ m * s) + n / (m + n) * (/ n * u)) with (/ (m + n) * (s + u)) in mean by (field; lra).
  replace ((1 - n / (m + n)) * (/ m * t) + n / (m + n) * (/ n * v)) with (/ (m + n) * (t + v)) in mean by (field; lra).
  rewrite norm_is_homogeneous, Rabs_right in mean by (try lra; apply Rle_ge, Rlt_le, Rinv_0_lt_compat; lra).
  apply Rmult_le_compat_l with (r := m + n) in mean; [| lra].
  rewrite <- Rmult_assoc, Rinv_r, Rmult_1_l in mean by lra. lra.
Qed.

(** Hölder's inequality for conjugate exponents: su + tv ≤ ‖(s, t)‖_q ‖(u, v)‖_p, *)
Lemma hoelder_of_conjugates p q s t u v :
  0 < p -> 0 < q -> 1 / p + 1 / q = 1 -> s * u + t * v <= norm q s t * norm p u v.
Proof.
  intros p_positive q_positive conjugate. pose proof (norm_nonnegative q s t). pose proof (norm_nonnegative p u v).
  destruct (Req_dec (norm q s t) 0) as [zero | first].
  { rewrite zero. apply norm_zero_only in zero as [-> ->]; lra. }
  destruct (Req_dec (norm p u v) 0) as [zero | second].
  { rewrite zero. apply norm_zero_only in zero as [-> ->]; lra. }
  pose proof (power_of_norm q s t q_positive) as first_power. pose proof (power_of_norm p u v p_positive) as
    second_power.
  set (m := norm q s t) in *. set (n := norm p u v) in *.
  assert (scaled : forall c r a, 0 < c -> power r (Rabs a / c) * power r c = power r (Rabs a)).
  { intros c r a positive. assert (0 <= Rabs a / c) by
      (apply Rmult_le_pos; [apply Rabs_pos | apply Rlt_le, Rinv_0_lt_compat; assumption]).
    rewrite <- power_of_product by lra. f_equal. field. lra. }
  assert (quotient : forall a c, 0 < c -> 0 <= Rabs a / c) by
    (intros; apply Rmult_le_pos; [apply Rabs_pos | apply Rlt_le, Rinv_0_lt_compat; assumption]).
  pose proof (young q p (Rabs s / m) (Rabs u / n) q_positive p_positive ltac:(lra)
                    (quotient s m ltac:(lra)) (quotient u n ltac:(lra))) as one.
  pose proof (young q p (Rabs t / m) (Rabs v / n) q_positive p_positive ltac:(lra)
                    (quotient t m ltac:(lra)) (quotient v n ltac:(lra))) as two.
  assert (shares : forall r c a b, 0 < c -> power r c = power r (Rabs a) + power r (Rabs b) ->
                                   power r (Rabs a / c) + power r (Rabs b / c) = 1).
  { intros r c a b positive total. pose proof (power_positive r c positive).
    rewrite <- (scaled c r a), <- (scaled c r b) in total by assumption.
    apply Rmult_eq_reg_r with (power r c); lra. }
  pose proof (shares q m s t ltac:(lra) first_power) as q_total.
  pose proof (shares p n u v ltac:(lra) second_power) as p_total.
  assert (unit : Rabs s / m * (Rabs u / n) + Rabs t / m * (Rabs v / n) <= 1).
  { unfold Rdiv in *. pose proof (Rinv_0_lt_compat _ p_positive). pose proof (Rinv_0_lt_compat _ q_positive).
    apply Rle_trans with ((power q (Rabs s * / m) + power q (Rabs t * / m)) * / q
                          + (power p (Rabs u * / n) + power p (Rabs v * / n)) * / p); [lra |].
    rewrite q_total, p_total. lra. }
  apply Rmult_le_compat_l with (r := m * n) in unit; [| nra].
  replace (m * n * (Rabs s / m * (Rabs u / n) + Rabs t / m * (Rabs v / n))) with (Rabs (s * u) + Rabs (t * v)) in unit
    by (rewrite !Rabs_mult; field; lra).
  pose proof (Rle_abs (s * u)). pose proof (Rle_abs (t * v)). lra.
Qed.

Lemma exponent_range eps : 0 < eps <= 2 -> 1 <= 2 / eps.
Proof. intros. apply Rmult_le_reg_r with eps; [| field_simplify]; lra. Qed.

(** in the exponents of the docs: su + tv ≤ (dual norm of (s, t)) · ‖(u, v)‖_p, p = 2/ε, for ε in (0, 2]. *)
Theorem hoelder eps s t u v : 0 < eps <= 2 -> s * u + t * v <= dual_norm eps s t * norm (2 / eps) u v.
Proof.
  intros range. unfold dual_norm. destruct (Req_EM_T eps 2) as [-> | smaller].
  - replace (2 / 2) with 1 by field. unfold norm. replace (1 / 1) with 1 by field. rewrite !power_one by
      (try apply Rplus_le_le_0_compat; rewrite ?power_one; auto using Rabs_pos).
    pose proof (Rle_abs (s * u)). pose proof (Rle_abs (t * v)). rewrite Rabs_mult in *.
    pose proof (Rmax_l (Rabs s) (Rabs t)). pose proof (Rmax_r (Rabs s) (Rabs t)).
    pose proof (Rabs_pos u). pose proof (Rabs_pos v). nra.
  - apply hoelder_of_conjugates; [apply Rdiv_lt_0_compat; lra .. | field; lra].
Qed.

(** Norms fall as exponents rise: an upper bound takes the exponent rounded down, a lower bound the one rounded up. *)
Theorem norms_fall_as_exponents_rise p r s t : 0 < p <= r -> norm r s t <= norm p s t.
Proof.
  intros range. destruct (Req_dec (norm p s t) 0) as [zero | nonzero].
  { apply norm_zero_only in zero as [-> ->]; [| lra]. rewrite !norm_of_zero. lra. }
  pose proof (norm_nonnegative p s t). set (m := norm p s t) in *.
  apply norm_at_most; [lra .. |].
  assert (lower : forall x, 0 <= x <= m -> power r x <= power (r - p) m * power p x).
  { intros x bounds. replace (power r x) with (power (r - p) x * power p x) by (rewrite <- power_of_sum; f_equal; ring).
    apply Rmult_le_compat_r; [apply power_nonnegative |].
    destruct (Req_dec r p) as [-> | different]; [| apply power_increases; lra].
    unfold power. rewrite Rminus_diag_eq by reflexivity. unfold Rpower. rewrite !Rmult_0_l, exp_0.
    destruct (Rle_dec x 0), (Rle_dec m 0); lra. }
  pose proof (lower (Rabs s) (conj (Rabs_pos s) (first_below_norm p s t ltac:(lra)))).
  pose proof (lower (Rabs t) (conj (Rabs_pos t) (second_below_norm p s t ltac:(lra)))).
  replace (power r m) with (power (r - p) m * power p m) by (rewrite <- power_of_sum; f_equal; ring).
  unfold m at 2. rewrite power_of_norm by lra. lra.
Qed.

(** ‖w‖_p ≤ 2^(1/p − 1/r) ‖w‖_r for two numbers and p ≤ r, by which §4 makes up for an exponent rounded down. *)
Theorem norms_of_two_numbers_fall_slowly p r s t :
  0 < p <= r -> norm p s t <= Rpower 2 (1 / p - 1 / r) * norm r s t.
Proof.
  intros range. pose proof (norm_nonnegative r s t). pose proof (exp_pos ((1 / p - 1 / r) * ln 2)).
  assert (large : 1 <= r / p) by (apply Rmult_le_reg_r with p; [| field_simplify]; lra).
  pose proof (powers_are_convex (r / p) (power p (Rabs s)) (power p (Rabs t)) (1 / 2) large
                (power_nonnegative _ _) (power_nonnegative _ _) ltac:(lra)) as mean.
  rewrite !power_of_power in mean. replace (p * (r / p)) with r in mean by (field; lra).
  apply norm_at_most; [lra | unfold Rpower; nra |].
  rewrite power_of_product by (unfold Rpower; nra).
  rewrite <- (root_and_power (r / p) (power p (Rabs s) + power p (Rabs t))) by
    (try apply sum_of_powers_nonnegative; lra).
  replace (power p (Rpower 2 (1 / p - 1 / r)) * power p (norm r s t))
    with (power (1 / (r / p)) (power (r / p) 2 * ((1 - 1 / 2) * power r (Rabs s) + 1 / 2 * power r (Rabs t)))).
  - apply power_increases; [apply inverse_positive; lra |]. split; [apply power_nonnegative |].
    replace (power p (Rabs s) + power p (Rabs t)) with (2 * ((1 - 1 / 2) * power p (Rabs s) + 1 / 2 * power p (Rabs t)))
      by field.
    pose proof (power_nonnegative p (Rabs s)). pose proof (power_nonnegative p (Rabs t)).
    rewrite power_of_product by lra. apply Rmult_le_compat_l; [apply power_nonnegative | assumption].
  - unfold norm. rewrite power_of_power.
    replace (power (r / p) 2 * ((1 - 1 / 2) * power r (Rabs s) + 1 / 2 * power r (Rabs t)))
      with (power (r / p - 1) 2 * (power r (Rabs s) + power r (Rabs t))).
    + rewrite power_of_product, power_of_power by (apply power_nonnegative || apply sum_of_powers_nonnegative).
      f_equal; [| f_equal; field; lra].
      rewrite !power_of_positive by (lra || apply exp_pos). rewrite Rpower_mult. f_equal. field. lra.
    + replace (r / p) with (r / p - 1 + 1) at 2 by ring. rewrite power_of_sum, (power_one 2) by lra. field.
Qed.
