(** Stepping a result that was rounded to nearest outward, by (φ|c| + η), bounds the exact one: binary64 with its
    subnormal numbers, unbounded above. docs/rounding.md §1, §2; kernels/rounding.clh (step_up, step_down, and with
    them every _up and _down function) and kernels/interval.clh (interval_add, interval_sub, interval_mul) rely on it.
    *)
From Coq Require Import ZArith Reals Lra Psatz.
From Flocq Require Import Core.
Open Scope R_scope.

(** Binary64: 53 bits, the least positive number 2⁻¹⁰⁷⁴; rounding to nearest, ties to even. *)
Notation exponent := (FLT_exp (-1074) 53).
Notation power_of_two := (bpow radix2).
Definition nearest : R -> R := round radix2 exponent ZnearestE.

(** φ = u (1 + 2u), u = 2⁻⁵³; η = 2⁻¹⁰²². *)
Definition phi := power_of_two (-53) + power_of_two (-105).
Definition eta := power_of_two (-1022).

(** c ± fma(φ, |c|, η), as kernels/rounding.clh computes them. *)
Definition step (c : R) := nearest (phi * Rabs c + eta).
Definition step_up (c : R) := nearest (c + step c).
Definition step_down (c : R) := nearest (c - step c).

Lemma precision_positive : Prec_gt_0 53.
Proof. reflexivity. Qed.
#[local] Existing Instance precision_positive.

(** φ as the kernels write it: 0x1.0000000000001p-53. *)
Theorem phi_is_the_kernels : phi = F2R (Float radix2 0x10000000000001 (-105)).
Proof.
  unfold phi, F2R; simpl Fnum; simpl Fexp. replace (-53)%Z with (52 + -105)%Z by reflexivity.
  rewrite bpow_plus. replace (power_of_two 52) with (IZR (2 ^ 52)) by reflexivity.
  replace (IZR 0x10000000000001) with (IZR (2 ^ 52) + 1) by (rewrite <- plus_IZR; reflexivity). ring.
Qed.

Lemma phi_positive : 0 < phi.
Proof. unfold phi. pose proof (bpow_gt_0 radix2 (-53)). pose proof (bpow_gt_0 radix2 (-105)). lra. Qed.

Lemma nearest_increases v w : v <= w -> nearest v <= nearest w.
Proof. apply round_le; apply _. Qed.

Lemma nearest_is_a_number v : generic_format radix2 exponent (nearest v).
Proof. apply generic_format_round; apply _. Qed.

Lemma nearest_of_a_number v : generic_format radix2 exponent v -> nearest v = v.
Proof. apply round_generic; apply _. Qed.

Lemma nearest_of_zero : nearest 0 = 0.
Proof. apply round_0; apply _. Qed.

Lemma eta_is_a_number : generic_format radix2 exponent eta.
Proof. apply generic_format_bpow. unfold FLT_exp. simpl. lia. Qed.

Lemma step_at_least_eta c : eta <= step c.
Proof.
  rewrite <- (nearest_of_a_number eta eta_is_a_number). apply nearest_increases.
  pose proof (Rabs_pos c). pose proof phi_positive. nra.
Qed.

(** φ 2^e is a number of binary64 where it is not subnormal. *)
Lemma phi_times_power e : (-969 <= e)%Z -> generic_format radix2 exponent (phi * power_of_two e).
Proof.
  intros large. apply generic_format_FLT. exists (Float radix2 0x10000000000001 (-105 + e)).
  - rewrite phi_is_the_kernels. unfold F2R; cbn [Fnum Fexp]. rewrite bpow_plus. ring.
  - simpl. reflexivity.
  - cbn [Fexp]. lia.
Qed.

(** The step is more than half a unit in the last place. *)
Lemma step_exceeds_half_ulp c : / 2 * ulp radix2 exponent c < step c.
Proof.
  assert (half : forall e, / 2 * power_of_two e = power_of_two (e - 1)).
  { intros e. replace (e - 1)%Z with (e + -1)%Z by lia. rewrite bpow_plus. replace (power_of_two (-1)) with (/ 2) by
    reflexivity. ring. }
  destruct (Req_dec c 0) as [-> | nonzero].
  { apply Rlt_le_trans with eta; [| apply step_at_least_eta]. rewrite ulp_FLT_0 by reflexivity. rewrite half.
    apply bpow_lt. reflexivity. }
  rewrite ulp_neq_0, half by assumption. unfold cexp, FLT_exp.
  destruct (Rlt_or_le (Rabs c) (power_of_two (-969))) as [small | large].
  - apply Rlt_le_trans with eta; [| apply step_at_least_eta]. apply bpow_lt.
    pose proof (mag_le_bpow radix2 c (-969) nonzero small). lia.
  - set (e := mag radix2 c : Z).
    assert (bound : (-969 < e)%Z) by (apply mag_gt_bpow; assumption).
    replace (Z.max (e - 53) (-1074) - 1)%Z with (-53 + (e - 1))%Z by lia.
    apply Rlt_le_trans with (phi * power_of_two (e - 1)).
    + rewrite bpow_plus. apply Rmult_lt_compat_r; [apply bpow_gt_0 |]. unfold phi.
      pose proof (bpow_gt_0 radix2 (-105)). lra.
    + rewrite <- (nearest_of_a_number (phi * power_of_two (e - 1))) by (apply phi_times_power; lia).
      apply nearest_increases. pose proof phi_positive. pose proof (bpow_gt_0 radix2 (-1022)) as eta_positive. fold eta
        in eta_positive.
      pose proof (bpow_mag_le radix2 c nonzero) as magnitude. fold e in magnitude. nra.
Qed.

(** fl(c + (φ|c| + η)) ≥ v, where c is v rounded to nearest: v the exact value of + − × ÷ sqrt fma alike. *)
Theorem step_up_is_an_upper_bound v : v <= step_up (nearest v).
Proof.
  set (c := nearest v). pose proof (step_exceeds_half_ulp c) as more.
  assert (above : c <= step_up c).
  { rewrite <- (nearest_of_a_number c) at 1 by apply nearest_is_a_number. apply nearest_increases.
    pose proof (step_at_least_eta c). pose proof (bpow_gt_0 radix2 (-1022)). unfold eta in *. lra. }
  destruct (Rle_or_lt v c) as [| late]; [lra |].
  destruct (Rle_or_lt v (step_up c)) as [| short]; [assumption | exfalso].
  destruct above as [above | same].
  - (* a number nearer to v than c *)
    destruct (round_N_pt radix2 exponent (fun x => negb (Z.even x)) v) as [_ closest].
    specialize (closest (step_up c) (nearest_is_a_number _)). fold (nearest v) in closest. fold c in closest.
    rewrite !Rabs_left in closest by lra. lra.
  - (* c + step is farther from c than half a unit *)
    pose proof (error_le_half_ulp_round radix2 exponent (fun x => negb (Z.even x)) (c + step c)) as error.
    fold (nearest (c + step c)) in error. fold (step_up c) in error. rewrite <- same in error.
    pose proof (step_at_least_eta c). pose proof (bpow_gt_0 radix2 (-1022)). unfold eta in *.
    rewrite Rabs_left in error by lra. lra.
Qed.

Lemma nearest_is_odd v : nearest (- v) = - nearest v.
Proof. apply round_NE_opp. Qed.

Lemma step_down_is_step_up c : step_down c = - step_up (- c).
Proof.
  unfold step_down, step_up. rewrite <- nearest_is_odd. f_equal. unfold step. rewrite Rabs_Ropp. ring.
Qed.

(** fl(c − (φ|c| + η)) ≤ v. *)
Theorem step_down_is_a_lower_bound v : step_down (nearest v) <= v.
Proof.
  rewrite step_down_is_step_up, <- nearest_is_odd. pose proof (step_up_is_an_upper_bound (- v)). lra.
Qed.

(** A device may flush each subnormal result to 0. *)
Definition flush (c : R) : R := if Rlt_dec (Rabs c) eta then 0 else c.
Definition flushed_step_up (c : R) := flush (nearest (c + flush (step c))).

Theorem flushed_step_up_is_an_upper_bound v : v <= flushed_step_up (flush (nearest v)).
Proof.
  assert (eta_positive : 0 < eta) by apply bpow_gt_0.
  assert (kept : forall c, flush (step c) = step c).
  { intros c. unfold flush. pose proof (step_at_least_eta c). destruct (Rlt_dec (Rabs (step c)) eta) as [less | _]; [|
    reflexivity].
    rewrite Rabs_right in less; lra. }
  unfold flushed_step_up. rewrite kept.
  destruct (Rlt_dec (Rabs (nearest v)) eta) as [subnormal | normal].
  - assert (none : step 0 = eta).
    { unfold step. rewrite Rabs_R0, Rmult_0_r, Rplus_0_l. apply nearest_of_a_number, eta_is_a_number. }
    replace (flush (nearest v)) with 0 by (unfold flush; destruct (Rlt_dec (Rabs (nearest v)) eta); tauto).
    rewrite none, Rplus_0_l, (nearest_of_a_number eta) by apply eta_is_a_number.
    unfold flush. destruct (Rlt_dec (Rabs eta) eta) as [less | _]; [rewrite Rabs_right in less; lra |].
    destruct (Rle_or_lt v eta) as [| more]; [assumption | exfalso].
    assert (eta <= nearest v) by (rewrite <- (nearest_of_a_number eta eta_is_a_number); apply nearest_increases; lra).
    rewrite Rabs_right in subnormal; lra.
  - replace (flush (nearest v)) with (nearest v)
      by (unfold flush; destruct (Rlt_dec (Rabs (nearest v)) eta); tauto).
    fold (step_up (nearest v)). pose proof (step_up_is_an_upper_bound v) as bound. unfold flush.
    destruct (Rlt_dec (Rabs (step_up (nearest v))) eta) as [small | _]; [| assumption].
    destruct (Rle_or_lt v 0) as [| positive]; [assumption | exfalso].
    assert (0 <= nearest v) by (rewrite <- nearest_of_zero; apply nearest_increases; lra).
    assert (nearest v <= step_up (nearest v)).
    { rewrite <- (nearest_of_a_number (nearest v)) at 1 by apply nearest_is_a_number. apply nearest_increases.
      pose proof (step_at_least_eta (nearest v)). lra. }
    rewrite Rabs_right in * by lra. apply normal. lra.
Qed.

(** Intervals: the ends computed to nearest, moved outward. *)
Theorem interval_sum a b c d x y :
  a <= x <= b -> c <= y <= d -> step_down (nearest (a + c)) <= x + y <= step_up (nearest (b + d)).
Proof.
  intros. pose proof (step_down_is_a_lower_bound (a + c)). pose proof (step_up_is_an_upper_bound (b + d)). lra.
Qed.

Theorem interval_difference a b c d x y :
  a <= x <= b -> c <= y <= d -> step_down (nearest (a - d)) <= x - y <= step_up (nearest (b - c)).
Proof.
  intros. pose proof (step_down_is_a_lower_bound (a - d)). pose proof (step_up_is_an_upper_bound (b - c)). lra.
Qed.

Definition least (p q r s : R) := Rmin (Rmin p q) (Rmin r s).
Definition greatest (p q r s : R) := Rmax (Rmax p q) (Rmax r s).

Lemma nearest_of_minimum p q : Rmin (nearest p) (nearest q) = nearest (Rmin p q).
Proof.
  destruct (Rle_or_lt p q) as [less | more].
  - rewrite !Rmin_left; auto using nearest_increases.
  - rewrite !Rmin_right by (try apply nearest_increases; lra). reflexivity.
Qed.

Lemma nearest_of_maximum p q : Rmax (nearest p) (nearest q) = nearest (Rmax p q).
Proof.
  destruct (Rle_or_lt p q) as [less | more].
  - rewrite !Rmax_right; auto using nearest_increases.
  - rewrite !Rmax_left by (try apply nearest_increases; lra). reflexivity.
Qed.

Lemma product_range a b c d x y :
  a <= x <= b -> c <= y <= d -> least (a * c) (a * d) (b * c) (b * d) <= x * y <= greatest (a * c) (a * d) (b * c) (b *
    d).
Proof.
  intros x_range y_range. unfold least, greatest.
  pose proof (Rmin_l (Rmin (a * c) (a * d)) (Rmin (b * c) (b * d))). pose proof (Rmin_r (Rmin (a * c) (a * d)) (Rmin (b
    * c) (b * d))).
  pose proof (Rmin_l (a * c) (a * d)). pose proof (Rmin_r (a * c) (a * d)).
  pose proof (Rmin_l (b * c) (b * d)). pose proof (Rmin_r (b * c) (b * d)).
  pose proof (Rmax_l (Rmax (a * c) (a * d)) (Rmax (b * c) (b * d))). pose proof (Rmax_r (Rmax (a * c) (a * d)) (Rmax (b
    * c) (b * d))).
  pose proof (Rmax_l (a * c) (a * d)). pose proof (Rmax_r (a * c) (a * d)).
  pose proof (Rmax_l (b * c) (b * d)). pose proof (Rmax_r (b * c) (b * d)).
  assert (between : forall s t u w, s <= w <= t -> Rmin (u * s) (u * t) <= u * w <= Rmax (u * s) (u * t)).
  { intros s t u w range. unfold Rmin, Rmax. destruct (Rle_dec (u * s) (u * t)), (Rle_or_lt 0 u); nra. }
  pose proof (between c d a y y_range). pose proof (between c d b y y_range).
  pose proof (between a b y x x_range) as last. unfold Rmin, Rmax in last.
  rewrite (Rmult_comm x y). destruct (Rle_dec (y * a) (y * b)); rewrite (Rmult_comm y a), (Rmult_comm y b) in *; lra.
Qed.

(** Rounding to nearest is monotone: the least of the rounded products is the rounded least product. *)
Theorem interval_product a b c d x y :
  a <= x <= b -> c <= y <= d ->
  step_down (least (nearest (a * c)) (nearest (a * d)) (nearest (b * c)) (nearest (b * d))) <= x * y
  <= step_up (greatest (nearest (a * c)) (nearest (a * d)) (nearest (b * c)) (nearest (b * d))).
Proof.
  intros x_range y_range. pose proof (product_range a b c d x y x_range y_range) as [lower upper].
  unfold least, greatest in *. rewrite !nearest_of_minimum, !nearest_of_maximum.
  split; eapply Rle_trans; [apply step_down_is_a_lower_bound | exact lower | exact upper | apply
    step_up_is_an_upper_bound].
Qed.
