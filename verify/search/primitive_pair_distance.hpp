/// Distances of two primitives, and of their sections.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <queue>
#include <vector>

#include "verify/numbers/vector.hpp"
#include "verify/proposals/support_mapping.hpp"
#include "verify/solids/bend.hpp"
#include "verify/solids/cube.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/distance.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

// A primitive cut across its axis, bent or not: how far each of its sections reaches, proven, and where, proposed
// (docs/mathematics.md §9).

/// All vectors are in the primitive's own frame, with its centre as origin. A bent solid is not convex, but the thinner
/// a section of it is, the more nearly convex it is. Immutable.
class SectionedPrimitive {
 public:
  explicit SectionedPrimitive(const Primitive& primitive);

  /// The bend's effect on the axis at a height z: the axis turns by kz.
  struct End {
    double height;
    Interval cosine, sine;  ///< of kz
    Interval along, up;     ///< R and Z of the axis point
  };

  /// The image of the points with heights between those of two ends.
  struct Section {
    End lower, upper;
  };

  [[nodiscard]] Section whole() const;

  /// Nothing if there is no bend, or no number between the heights.
  [[nodiscard]] std::optional<std::array<Section, 2>> halves(const Section& section) const;

  /// About how far the hull of a section, or the bounds of that hull, exceed the section.
  [[nodiscard]] double slack(const Section& section) const;

  /// At least the largest direction·x over the section; infinity if it overflows. With (n_R, n_S, n_Z) the direction in
  /// the frame of the bend, and at a height z
  ///     e(z) = n·(the axis' point),   c(z) = n_R cos kz - n_Z sin kz,
  /// the image of (r, s, z) has n·x = e(z) + c(z) r + n_S s. Let H(c) be the support function of the unbent solid
  /// towards (c, n_S, v) for a number v. It is convex in c, and changes by at most the largest |r| times the change of
  /// c. So
  ///     n·x <= e(z) - v z + H(c(z))   for any v,
  /// Between the two ends e and c leave their chords by at most an eighth of the squared difference of heights times
  /// |e''| = |k c| and |c''| = |k² c|. e does not leave its chord upwards where it is convex, k c >= 0. The chords of
  /// e, of H along the chord of c, and v z are linear: largest at an end.
  [[nodiscard]] double support_up(const Vector3<double>& direction, const Section& section) const;

  /// The number v of `support_up` that gives about the least bound; it may overflow.
  [[nodiscard]] double slope(const Coordinates<double>& direction, const Section& section) const;

  /// About a point of the section where direction·x is largest.
  [[nodiscard]] Coordinates<double> support_point(const Coordinates<double>& direction, const Section& section) const;

 private:
  [[nodiscard]] End end_at(double height) const;

  double half_length_;
  double curvature_ = 0.0;
  std::optional<BendMap<double>> map_;  ///< set if there is a bend
  SuperquadricBounds<double> bounds_;
  Interval focus_;          ///< along z
  double extent_ = 0.0;     ///< at least the largest |r|
  SectionMapping mapping_;  ///< proposes slopes and farthest points
};

// The distance of two primitives, bent or not, from below: best first over pairs of their sections, each separated by
// a plane.

/// A primitive of a model, ready to be separated from others.
struct SeparablePrimitive {
  explicit SeparablePrimitive(const Primitive& primitive);

  SectionedPrimitive sections;
  Point centre;
  double reach;  ///< more than any sphere's radius that a proof uses
  bool bent;
  RigidMotion motion;               ///< to its model's frame
  ApproximateMotion<double> about;  ///< the same, about
  Matrix3<double> to_own_frame;     ///< takes directions to it
};

/// d >= (n·(t_B - t_A) - h_A(R_Aᵀ n) - h_B(-R_Bᵀ n)) / |n| for any n, with support functions about the centres t
/// (docs/mathematics.md §7). The least bound of all pairs of sections counts. All vectors are in the frame of model A.
class PrimitivePairDistance {
 public:
  /// `pose` moves B's model. Both primitives must outlive this. If the search succeeds, bounds are within about
  /// `tolerance` of the distance.
  PrimitivePairDistance(const SeparablePrimitive& a, const SeparablePrimitive& b, const Pose& pose, double tolerance);

  /// At least 0, proven.
  [[nodiscard]] double lower() const;

  /// Divides sections until one of these holds: `lower` is at least `enough`; finer sections promise no more than the
  /// tolerance; hulls of fairly fine sections still meet; `steps` are taken; `interrupted`, polled between them,
  /// returns true. Returns whether any step was taken.
  bool raise(double enough, std::uint64_t steps, const std::function<bool()>& interrupted);

  /// A certificate that proves `lower` again, but for the rounding of its plain numbers. Precondition: a step was
  /// taken.
  [[nodiscard]] DividedSeparation certificate(std::uint32_t primitive_a, std::uint32_t primitive_b) const;

  struct Points {
    Point on_a;  ///< in the frame of model A
    Point on_b;  ///< in the frame of model B
  };

  /// Points of the hulls of the sections that seem nearest: proves nothing. Nothing before the first step, or if
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
    Plain separation;        ///< from A to B; any length
    Plain on_a, on_b;
  };

  /// The division of a pair of sections.
  struct Division {
    std::uint32_t a, b;  ///< indices of the sections
    SectionCut cut = SectionCut::none;
    std::uint32_t halves = 0;  ///< the first of two, if the pair was cut
    Plain normal{};            ///< normal of the plane with the best bound
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
  Matrix3<double> to_b_;              ///< takes directions of model A's frame to the frame of B's primitive
  Vector3<double> between_;           ///< vector between the centres
  double tolerance_;
  std::vector<Node> nodes_a_, nodes_b_;
  std::vector<Division> divisions_;
  std::priority_queue<SectionPair, std::vector<SectionPair>, Later> queue_;
  double settled_;  ///< the least bound of pairs that are in the queue no more
  std::uint64_t steps_ = 0;
};

// A convex primitive as a whole, where others have a cell: its support function is exact, so that it needs no cells.

class WholePrimitive {
 public:
  /// The cube contains the primitive, which has no bend and must outlive this. Nearest points are as far as they are
  /// but for `tolerance`.
  WholePrimitive(const SeparablePrimitive& primitive, const Cube& cube, double tolerance)
      : primitive_(&primitive), cube_(cube), tolerance_(tolerance) {}

  [[nodiscard]] const Cube& cube() const { return cube_; }

  /// At least the largest direction·(x - the cube's centre) over the primitive.
  [[nodiscard]] double support(const Point& direction) const;

  /// Approximate: proves nothing.
  [[nodiscard]] Point nearest(const Point& x) const;

 private:
  [[nodiscard]] double proven_support(const Point& direction) const;

  const SeparablePrimitive* primitive_;
  Cube cube_;
  double tolerance_;
};

}  // namespace verisq::verify
