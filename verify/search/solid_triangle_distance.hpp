/// Distances of triangles to solids of any kind, by branch and bound.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <queue>
#include <span>
#include <vector>

#include "verify/search/set_tree.hpp"
#include "verify/search/triangle_pieces.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

/// Requests points, receives enclosures of their signed distances, and repeats until the distance of the triangle is
/// enclosed. So the caller may process the points of many triangles at a time. Internally, lengths are in units of a
/// power of two if their squares would not be binary64 numbers.
class TriangleBranchAndBound {
 public:
  /// Stops at the tolerance. Precondition: finite corners.
  TriangleBranchAndBound(const Triangle& triangle, const SolidExtent& extent, double tolerance);

  /// Returns whether no more requests are needed: the enclosure is at most the tolerance wide, or no part can be
  /// divided further.
  [[nodiscard]] bool finished() const;

  /// Contains the distance, 0 if the triangle meets the solid, at any time.
  [[nodiscard]] Enclosure enclosure() const;

  /// Appends the next requested points: finite but for overflow. Precondition: all earlier requests are answered.
  void ask(std::vector<Point>& points);

  struct Answer {
    Enclosure distance;  ///< contains the signed distance of the point; an end may be infinite
    Point direction{};   ///< about its gradient, of any length, for proposals: zero if unknown
  };

  /// The answers for each of the requested points, in their order.
  void answer(std::span<const Answer> in_lengths);

  /// The answered point that gives the upper end: nothing is proven about it.
  [[nodiscard]] std::optional<Point> nearest() const;

  /// The number of points requested so far.
  [[nodiscard]] std::size_t asked() const { return asked_; }

 private:
  enum class Question : std::uint8_t {
    none,
    look,    ///< the distance at a point of a part
    probes,  ///< the distances about it, if the direction in which it grows is unknown
    ball,    ///< the distance of the centre of a ball that holds a part
  };

  /// A part of the triangle, and its data for proposals.
  struct Node {
    Piece piece;
    Triangle corners;
    double lower;  ///< proven lower bound of its distance
    std::optional<Look> look;
    bool own_look;  ///< the look was made for this part: at its least point, as far as it is known
    int looks_left;
    Curvature curvature;
    double reach;  ///< as far from the look a centre may be as far from the solid as it seems
    Question question;
    Point at;            ///< the requested point, or the point about which probes are requested
    Enclosure distance;  ///< the distance of that point, if probes about it are requested
    double step;         ///< of probes
    double ball_reach;
  };
  struct Farther {
    bool operator()(const Node& a, const Node& b) const { return a.lower > b.lower; }
  };

  /// The constructor for the whole triangle; the extent is in these units.
  TriangleBranchAndBound(const Triangle& triangle, const SolidExtent& extent, double tolerance, double unit);

  [[nodiscard]] Enclosure enclosure_in_units() const;
  [[nodiscard]] Point nearest_to_centre(const Node& node) const;
  [[nodiscard]] bool settled(double lower) const;
  [[nodiscard]] bool plan_ball(Node& node) const;
  [[nodiscard]] bool plan_next_look(Node& node) const;
  void plan_look(Node& node, const Point& at) const;
  void advance(Node node);
  [[nodiscard]] double aim() const;
  void split(const Node& node);
  void told_look(Node& node, const Answer& answer);
  void told_probes(Node& node, std::span<const Answer> answers) const;
  void learn(Node& node, const std::optional<Point>& direction) const;
  void told_ball(Node& node, const Answer& answer) const;
  void keep(const Node& node);

  double unit_;
  DividedTriangle triangle_;
  TriangleFrame frame_;
  SolidExtent extent_;
  double tolerance_;
  double upper_ = infinity;
  std::optional<Point> nearest_;
  double left_out_ = infinity;  ///< the least lower bound of the parts that are looked at no more
  double width_ = 0.0;          ///< width of the enclosure of the last point
  std::priority_queue<Node, std::vector<Node>, Farther> open_;
  std::vector<Node> asking_;
  std::size_t asked_ = 0;
};

}  // namespace verisq::verify
