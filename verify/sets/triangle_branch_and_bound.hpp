/// The distance of a triangle to any solid by branch and bound over parts of the triangle, from signed distances of
/// points that somebody else proves (docs/mathematics.md §6).
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <queue>
#include <span>
#include <vector>

#include "verify/sets/piece_proposal.hpp"
#include "verify/sets/solid_extent.hpp"
#include "verify/sets/triangle_pieces.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

/// Asks for points, is told enclosures of their signed distances, and so on until the distance of the triangle is
/// enclosed: whoever answers may work on the points of many triangles at a time.
class TriangleBranchAndBound {
 public:
  /// Stops at the tolerance. Precondition: finite corners.
  TriangleBranchAndBound(const Triangle& triangle, const SolidExtent& extent, double tolerance);

  /// Whether there is nothing more to ask for: at most the tolerance wide, or no part can be divided further.
  [[nodiscard]] bool finished() const;

  /// Contains the distance, 0 where the triangle meets the solid, at any time.
  [[nodiscard]] Enclosure enclosure() const;

  /// Appends the points that it asks for next. Precondition: not finished, all that it asked for answered.
  void ask(std::vector<Point>& points);

  /// Enclosures of their signed distances, in that order; an end may be infinite.
  void answer(std::span<const Enclosure> distances);

  [[nodiscard]] std::size_t asked() const { return asked_; }

 private:
  /// A part of the triangle, and what is known for proposals about it.
  struct Node {
    Piece piece;
    Triangle corners;
    double lower;  ///< proven of its distance
    std::optional<Look> look;
    Curvature curvature;
    double reach;  ///< as far along the look's direction a centre may be as far as it seems
    int looks_left;
    bool own_look;                    ///< the look was made for this part: at its least point, as far as known
    std::optional<ProvingBall> ball;  ///< asked for next; else the weights' point and its probes
    Weights weights;
    Point at;
    double step;
  };
  struct Farther {
    bool operator()(const Node& a, const Node& b) const { return a.lower > b.lower; }
  };

  [[nodiscard]] Weights nearest_to_extent(const Piece& piece, const Triangle& corners) const;
  [[nodiscard]] bool settled(double lower) const;
  [[nodiscard]] double aim() const;
  [[nodiscard]] bool plan(Node& node);
  void plan_look(Node& node, const Weights& weights) const;
  void split(const Node& node);
  void told_look(Node& node, std::span<const Enclosure> distances);
  void told_ball(Node& node, const Enclosure& distance);
  void keep(Node node);

  DividedTriangle triangle_;
  TriangleFrame frame_;
  SolidExtent extent_;
  double tolerance_;
  double upper_ = infinity;
  double left_out_ = infinity;  ///< the least lower bound of the parts that are looked at no more
  double width_ = 0.0;          ///< of the enclosures of the last points
  std::priority_queue<Node, std::vector<Node>, Farther> open_;
  std::vector<Node> asking_;
  std::size_t asked_ = 0;
};

}  // namespace verisq::verify
