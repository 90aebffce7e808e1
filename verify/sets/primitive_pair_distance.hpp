/// The distance of two primitives, bent or not, from below: best first over pairs of their sections, each separated by
/// a plane.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <queue>
#include <vector>

#include "verify/proof/rigid_motion.hpp"
#include "verify/sets/sectioned_primitive.hpp"
#include "verisq/pair_certificate.hpp"

namespace verisq::verify {

/// A primitive of a model, ready to be separated from others.
struct SeparablePrimitive {
  explicit SeparablePrimitive(const Primitive& primitive);

  SectionedPrimitive sections;
  Point centre;
  double reach;  ///< more than any sphere's radius that a proof uses
  bool bent;
  RigidMotion motion;               ///< to its model's frame
  ApproximateMotion<double> about;  ///< the same, about
  Matrix3<double> to_own_frame;     ///< of directions
};

/// d >= (n·(t_B - t_A) - h_A(R_Aᵀ n) - h_B(-R_Bᵀ n)) / |n| for any n, with support functions about the centres t
/// (docs/mathematics.md §7); of all pairs of sections the least counts. All in the frame of model A.
class PrimitivePairDistance {
 public:
  /// `pose` moves B's model. Both primitives must outlive this. Bounds are within about `tolerance` of the distance
  /// where the search succeeds.
  PrimitivePairDistance(const SeparablePrimitive& a, const SeparablePrimitive& b, const Pose& pose, double tolerance);

  /// At least 0, proven.
  [[nodiscard]] double lower() const;

  /// Divides sections until `lower` is at least `enough`, no finer sections promise more than the tolerance, hulls of
  /// fairly fine ones still meet, `steps` are taken, or `interrupted`, polled between them, says so. Whether any step
  /// was taken.
  bool raise(double enough, std::uint64_t steps, const std::function<bool()>& interrupted);

  /// What proves `lower` again, but for what rounding of the plain numbers in it costs. Precondition: a step was taken.
  [[nodiscard]] DividedSeparation certificate(std::uint32_t primitive_a, std::uint32_t primitive_b) const;

  struct Points {
    Point on_a;  ///< in the frame of model A
    Point on_b;  ///< in the frame of model B
  };

  /// Of the hulls of those sections that seem nearest: proves nothing. Nothing before the first step, or where
  /// numbers overflow.
  [[nodiscard]] std::optional<Points> near_points() const;

 private:
  using Plain = Coordinates<double>;

  struct Node {
    SectionedPrimitive::Section section;
    double slack;
    std::uint32_t children = 0;  ///< the first of two; 0: not yet divided
  };

  struct SectionPair {
    double lower;
    double slack;  ///< of both sections
    std::uint32_t a, b;
    std::uint32_t division;  ///< index of its own
    Plain separation;        ///< from A to B; of any length
    Plain on_a, on_b;
  };

  /// What became of a pair of sections.
  struct Division {
    std::uint32_t a, b;  ///< indices of the sections
    SectionCut cut = SectionCut::none;
    std::uint32_t halves = 0;  ///< the first of two, where it was cut
    Plain normal{};            ///< of the plane with the best bound
  };

  /// The least bound first; where hulls meet, the larger sections.
  struct Later {
    bool operator()(const SectionPair& p, const SectionPair& q) const {
      return p.lower != q.lower ? p.lower > q.lower : p.slack < q.slack;
    }
  };

  bool step(double enough);
  void bound(SectionPair pair, double enough);
  void separate(SectionPair& pair);
  void add_planes(const Division& division, DividedSeparation& certificate) const;
  [[nodiscard]] double lower_by(const Plain& direction, std::uint32_t a, std::uint32_t b) const;
  [[nodiscard]] double proven_by(const Plain& direction, std::uint32_t a, std::uint32_t b) const;
  [[nodiscard]] std::optional<std::uint32_t> divided(const SectionedPrimitive& primitive, std::vector<Node>& nodes,
                                                     std::uint32_t index);

  const SeparablePrimitive* a_;
  const SeparablePrimitive* b_;
  ApproximateMotion<double> motion_;  ///< B's model to A's, about
  Matrix3<double> to_b_;              ///< directions of model A's frame to those of B's primitive
  Vector3<double> between_;           ///< of the centres
  double tolerance_;
  std::vector<Node> nodes_a_, nodes_b_;
  std::vector<Division> divisions_;
  std::priority_queue<SectionPair, std::vector<SectionPair>, Later> queue_;
  double settled_;  ///< the least bound of pairs that are in the queue no more
  std::uint64_t steps_ = 0;
};

}  // namespace verisq::verify
