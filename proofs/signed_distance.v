(** The signed distance of a point to any set of points: what it is, that it is 1-Lipschitz, and that inside it is
    minus the radius of the largest ball about the point that lies in the set. docs/mathematics.md, before §1;
    everything that says sd relies on it. *)
From Coq Require Import Reals Lra Psatz Classical.
From verisq Require Import vector.
Open Scope R_scope.

Definition region := vector -> Prop.
Definition ball (q : vector) (t : R) : region := fun x => distance q x <= t.
Definition lies_in (A B : region) := forall x, A x -> B x.
Definition on_the_way p q s := add p (scale s (sub q p)).
Definition convex (K : region) := forall p q s, K p -> K q -> 0 <= s <= 1 -> K (on_the_way p q s).

(** Points all of whose neighbourhoods meet both the set and its complement. *)
Definition boundary (K : region) : region := fun b =>
  forall e, 0 < e -> (exists x, K x /\ distance b x < e) /\ (exists x, ~ K x /\ distance b x < e).

Definition below_all (A : region) q m := forall x, A x -> m <= distance q x.
(** m is the distance of q to A: the greatest number that no point of A is nearer than. *)
Definition distance_to (A : region) q m := below_all A q m /\ forall other, below_all A q other -> other <= m.

(** s is sd(q): the distance to the solid outside, minus the distance to its boundary inside. *)
Definition signed_distance (K : region) q s := (K q /\ distance_to (boundary K) q (- s)) \/ (~ K q /\ distance_to K q
  s).

Lemma distance_to_nonnegative A q m : distance_to A q m -> 0 <= m.
Proof. intros [_ greatest]. apply greatest. intros x _. apply distance_nonnegative. Qed.

Lemma distance_to_unique A q m n : distance_to A q m -> distance_to A q n -> m = n.
Proof. intros [lower greatest] [lower' greatest']. apply Rle_antisym; auto. Qed.

Lemma distance_to_exists A q : (exists x, A x) -> exists m, distance_to A q m.
Proof.
  intros [x in_A].
  destruct (completeness (fun m => below_all A q m)) as [m [upper least]].
  - exists (distance q x). intros m below. now apply below.
  - exists 0. intros y _. apply distance_nonnegative.
  - exists m. split; [| auto]. intros y in_A'. apply least. intros n below. now apply below.
Qed.

Lemma distance_to_lipschitz A p q m n : distance_to A p m -> distance_to A q n -> m - distance p q <= n.
Proof.
  intros [below _] [_ greatest]. apply greatest. intros x in_A.
  pose proof (below x in_A). pose proof (distance_triangle p q x). lra.
Qed.

Lemma distance_from_start p q s : distance p (on_the_way p q s) = Rabs s * distance p q.
Proof.
  rewrite (distance_symmetric p q). unfold distance at 2. rewrite <- length_scale, distance_symmetric.
  unfold distance, on_the_way. f_equal. coordinates; ring.
Qed.

Lemma distance_along p q s t : distance (on_the_way p q s) (on_the_way p q t) = Rabs (s - t) * distance p q.
Proof.
  rewrite (distance_symmetric p q). unfold distance. rewrite <- length_scale. f_equal.
  unfold on_the_way. coordinates; ring.
Qed.

Lemma at_the_end p q : on_the_way p q 1 = q.
Proof. unfold on_the_way; coordinates; ring. Qed.

Lemma at_the_start p q : on_the_way p q 0 = p.
Proof. unfold on_the_way; coordinates; ring. Qed.

(** The way from a point of the set to one that is not of it meets the boundary. *)
Theorem ways_cross_the_boundary (K : region) p q :
  K p -> ~ K q -> exists s, 0 <= s <= 1 /\ boundary K (on_the_way p q s).
Proof.
  intros inside outside.
  destruct (completeness (fun s => 0 <= s <= 1 /\ K (on_the_way p q s))) as [s [upper least]].
  - exists 1. intros s [[_ ?] _]. assumption.
  - exists 0. rewrite at_the_start. split; [lra | assumption].
  - assert (0 <= s) by (apply upper; rewrite at_the_start; split; [lra | assumption]).
    assert (s <= 1) by (apply least; intros t [[_ ?] _]; assumption).
    exists s. split; [lra |]. intros e positive.
    pose proof (distance_nonnegative p q).
    set (reach := e / (distance p q + 1)).
    assert (0 < reach) by (apply Rdiv_lt_0_compat; lra).
    assert (enough : reach * distance p q < e).
    { apply Rlt_le_trans with (reach * (distance p q + 1)); [nra |]. unfold reach. right. field. lra. }
    split.
    + destruct (classic (exists t, s - reach < t /\ 0 <= t <= 1 /\ K (on_the_way p q t))) as [[t [near [range in_K]]] |
      none].
      * exists (on_the_way p q t). split; [assumption |]. rewrite distance_along.
        assert (t <= s) by (apply upper; split; assumption). rewrite Rabs_right by lra. nra.
      * exfalso. assert (s <= s - reach); [| lra]. apply least. intros t [range in_K].
        destruct (Rle_or_lt t (s - reach)); [assumption |]. exfalso. apply none. exists t. auto.
    + destruct (Rle_lt_or_eq_dec s 1) as [early | late]; [assumption | |].
      * set (t := Rmin 1 (s + reach)).
        assert (s < t <= 1 /\ t <= s + reach) as [[later range] close].
        { unfold t, Rmin. destruct (Rle_dec 1 (s + reach)); lra. }
        exists (on_the_way p q t). split.
        { intros in_K. assert (t <= s); [| lra]. apply upper. split; [lra | assumption]. }
        rewrite distance_along, Rabs_left by lra. nra.
      * exists q. split; [assumption |]. rewrite late, at_the_end, distance_to_itself. assumption.
Qed.

(** Inside: the open ball that no point of the boundary is nearer than lies in the set, *)
Lemma ball_free_of_the_boundary (K : region) q m t : K q -> below_all (boundary K) q m -> t < m -> lies_in (ball q t) K.
Proof.
  intros inside far smaller x near. apply NNPP. intros outside.
  destruct (ways_cross_the_boundary K q x inside outside) as [s [range crossing]].
  pose proof (far _ crossing) as contradiction. rewrite distance_from_start, Rabs_right in contradiction by lra.
  unfold ball in near. pose proof (distance_nonnegative q x). nra.
Qed.

(** and a ball in the set meets the boundary at its own surface at most. *)
Lemma boundary_is_outside_balls (K : region) q t : lies_in (ball q t) K -> below_all (boundary K) q t.
Proof.
  intros inside b on_boundary. destruct (Rle_or_lt t (distance q b)) as [| near]; [assumption | exfalso].
  destruct (on_boundary (t - distance q b)) as [_ [x [outside close]]]; [lra |].
  apply outside, inside. unfold ball. pose proof (distance_triangle q b x). lra.
Qed.

(** There is one signed distance, and no more, to every set that is neither empty nor everything. *)
Theorem signed_distance_is_a_number (K : region) q :
  (exists x, K x) -> (exists x, ~ K x) -> exists s, signed_distance K q s /\ forall t, signed_distance K q t -> t = s.
Proof.
  intros some [outside none]. destruct (classic (K q)) as [inside | not_inside].
  - destruct (ways_cross_the_boundary K q outside inside none) as [s [_ on_boundary]].
    destruct (distance_to_exists (boundary K) q) as [m is_distance]; [eauto |].
    exists (- m). split; [left; split; [assumption | now rewrite Ropp_involutive] |].
    intros t [[_ other] | [contradiction _]]; [| tauto].
    pose proof (distance_to_unique _ _ _ _ is_distance other). lra.
  - destruct (distance_to_exists K q some) as [m is_distance].
    exists m. split; [now right |]. intros t [[contradiction _] | [_ other]]; [tauto |].
    apply (distance_to_unique K q); assumption.
Qed.

Theorem not_positive_inside (K : region) q s : signed_distance K q s -> K q -> s <= 0.
Proof.
  intros [[_ is_distance] | [outside _]] inside; [| tauto].
  pose proof (distance_to_nonnegative _ _ _ is_distance). lra.
Qed.

Theorem not_negative_outside (K : region) q s : signed_distance K q s -> ~ K q -> 0 <= s.
Proof.
  intros [[inside _] | [_ is_distance]] outside; [tauto |]. apply (distance_to_nonnegative _ _ _ is_distance).
Qed.

(** "The largest such t is −sd(q)": every smaller ball lies in the set, and no larger one does. *)
Theorem inside_it_is_the_largest_ball (K : region) q s :
  signed_distance K q s -> K q ->
  (forall t, t < - s -> lies_in (ball q t) K) /\ (forall t, lies_in (ball q t) K -> t <= - s).
Proof.
  intros [[_ [below greatest]] | [outside _]] inside; [| tauto]. split.
  - intros t. now apply ball_free_of_the_boundary.
  - intros t in_K. apply greatest. now apply boundary_is_outside_balls.
Qed.

(** |sd(q) − sd(q′)| ≤ |q − q′|. *)
Theorem one_lipschitz (K : region) p q s t : signed_distance K p s -> signed_distance K q t -> Rabs (s - t) <= distance
  p q.
Proof.
  assert (mixed : forall p q s t, K p -> distance_to (boundary K) p (- s) -> ~ K q -> distance_to K q t ->
                                  Rabs (s - t) <= distance p q).
  { clear p q s t. intros p q s t inside depth outside height.
    destruct (ways_cross_the_boundary K p q inside outside) as [u [range on_boundary]].
    set (b := on_the_way p q u) in *.
    pose proof (distance_to_nonnegative _ _ _ depth). pose proof (distance_to_nonnegative _ _ _ height).
    pose proof (proj1 depth b on_boundary) as first.
    assert (second : t <= distance q b).
    { apply le_epsilon. intros e positive. destruct (on_boundary e positive) as [[x [in_K close]] _].
      pose proof (proj1 height x in_K). pose proof (distance_triangle q b x). lra. }
    unfold b in first, second. rewrite distance_from_start, Rabs_right in first by lra.
    rewrite <- (at_the_end p q) in second at 1. rewrite distance_along, Rabs_right in second by lra.
    apply Rabs_le. lra. }
  intros [[p_inside p_depth] | [p_outside p_height]] [[q_inside q_depth] | [q_outside q_height]].
  - pose proof (distance_to_lipschitz _ _ _ _ _ p_depth q_depth).
    pose proof (distance_to_lipschitz _ _ _ _ _ q_depth p_depth) as other. rewrite (distance_symmetric q p) in other.
    apply Rabs_le. lra.
  - now apply mixed.
  - rewrite Rabs_minus_sym, distance_symmetric. now apply mixed.
  - pose proof (distance_to_lipschitz _ _ _ _ _ p_height q_height).
    pose proof (distance_to_lipschitz _ _ _ _ _ q_height p_height) as other. rewrite (distance_symmetric q p) in other.
    apply Rabs_le. lra.
Qed.
