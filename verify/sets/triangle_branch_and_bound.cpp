/// The nearest part first: its least point is looked for, a ball about a point beyond it shows that there is none
/// nearer, or the part is halved.
#include "verify/sets/triangle_branch_and_bound.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "verify/proof/intersection.hpp"
#include "verify/proof/triangle.hpp"

namespace verisq::verify {

namespace {

constexpr std::size_t kPointsOfLook = 4;  // with its probes
constexpr int kLooksAtWhole = 10;
constexpr int kLooksAtPart = 2;
constexpr std::size_t kPartsAtATime = 8;
constexpr std::size_t kEasy = 64;  ///< points; triangles that take more are asked about several parts at a time
constexpr double kFarthestCentre = 0x1p14;  ///< in parts of the solid's radius: farther, rounding counts
constexpr double kShareOfAim = 0.5;         ///< of the tolerance is left for what proposals do not know

double longest(const Triangle& corners, std::size_t edge) {
  const Point way = difference(corners[(edge + 1) % 3], corners[edge]);
  return dot(way, way);
}

std::size_t longest_edge(const Triangle& corners) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < 3; ++i)
    if (longest(corners, i) > longest(corners, best)) best = i;
  return best;
}

bool is_finite(const Enclosure& e) {
  return std::isfinite(e.lo) && std::isfinite(e.hi);
}

double middle(const Enclosure& e) {
  return 0.5 * e.lo + 0.5 * e.hi;
}

double apart(const Point& a, const Point& b) {
  const Point way = difference(a, b);
  return std::sqrt(dot(way, way));
}

/// As if the solid were a point, which its centre is near enough to for a start.
Look towards(const Point& centre, const Triangle& corners) {
  return {corners[0], 0.0, difference(corners[0], centre)};
}

}  // namespace

TriangleBranchAndBound::TriangleBranchAndBound(const Triangle& triangle, const SolidExtent& extent, double tolerance)
    : triangle_(triangle), frame_(triangle), extent_(extent), tolerance_(tolerance) {
  Node root{whole_triangle,
            triangle,
            0.0,
            {},
            Curvature(extent.radius),
            kFarthestCentre * extent.radius,
            kLooksAtWhole,
            false,
            {},
            {},
            {},
            0.0};
  const Weights nearest = nearest_to_extent(whole_triangle, triangle);
  root.curvature = Curvature(std::max(extent.radius, apart(triangle_.point(nearest), extent.centre)));
  plan_look(root, nearest);
  asking_.push_back(std::move(root));
}

Weights TriangleBranchAndBound::nearest_to_extent(const Piece& piece, const Triangle& corners) const {
  const Curvature of_squares(1.0);
  return least_point(frame_, piece, corners, towards(extent_.centre, corners), of_squares).weights;
}

bool TriangleBranchAndBound::settled(double lower) const {
  return verified({std::min(lower, upper_), upper_}, tolerance_);
}

double TriangleBranchAndBound::aim() const {
  return upper_ - kShareOfAim * tolerance_;
}

bool TriangleBranchAndBound::finished() const {
  return asking_.empty() && (open_.empty() || settled(open_.top().lower) || settled(0.0));
}

Enclosure TriangleBranchAndBound::enclosure() const {
  double lower = std::min(left_out_, open_.empty() ? infinity : open_.top().lower);
  for (const Node& node : asking_) lower = std::min(lower, node.lower);
  return {std::min(lower, upper_), upper_};
}

void TriangleBranchAndBound::ask(std::vector<Point>& points) {
  const std::size_t most = asked_ < kEasy ? 1 : kPartsAtATime;
  while (asking_.size() < most && !open_.empty() && !settled(open_.top().lower)) {
    Node node = open_.top();
    open_.pop();
    if (plan(node)) {
      asking_.push_back(std::move(node));
    } else {
      split(node);
    }
  }
  for (const Node& node : asking_) {
    points.push_back(node.ball ? node.ball->centre : node.at);
    if (node.ball) continue;
    for (const Point& probe : frame_.probes(node.at, node.step)) points.push_back(probe);
  }
}

void TriangleBranchAndBound::answer(std::span<const Enclosure> distances) {
  asked_ += distances.size();
  std::vector<Node> asked;
  std::swap(asked, asking_);
  for (Node& node : asked) {
    if (node.ball) {
      told_ball(node, distances.front());
      distances = distances.subspan(1);
    } else {
      told_look(node, distances.first(kPointsOfLook));
      distances = distances.subspan(kPointsOfLook);
    }
    keep(std::move(node));
  }
}

void TriangleBranchAndBound::keep(Node node) {
  if (settled(node.lower)) {
    left_out_ = std::min(left_out_, node.lower);
  } else {
    open_.push(std::move(node));
  }
}

/// What to ask about a part; false where it is to be halved.
bool TriangleBranchAndBound::plan(Node& node) {
  node.ball.reset();
  if (node.look) node.ball = proving_ball(frame_, node.corners, *node.look, aim(), node.reach);
  if (node.ball) return true;
  if (node.looks_left == 0) return false;
  if (!node.look) {
    plan_look(node, nearest_to_extent(node.piece, node.corners));
    return true;
  }
  const LeastPoint least = least_point(frame_, node.piece, node.corners, *node.look, node.curvature);
  constexpr double worth_a_look = 0.125;
  if (node.own_look && !(least.gain > worth_a_look * tolerance_)) return false;
  plan_look(node, least.weights);
  return true;
}

/// A step so short that the distance is nearly linear, and so long that the enclosures' widths hardly count.
void TriangleBranchAndBound::plan_look(Node& node, const Weights& weights) const {
  node.weights = weights;
  node.at = triangle_.point(weights);
  const double size = std::max(extent_.radius, apart(node.at, extent_.centre));
  node.step = std::max(1e-6 * size, 0.3 * std::sqrt(width_ * size));
}

void TriangleBranchAndBound::told_look(Node& node, std::span<const Enclosure> distances) {
  const Enclosure& here = distances.front();
  upper_ = std::min(upper_, triangle_.upper_by_point(here.hi));
  node.lower = std::max(node.lower, triangle_.lower_by_ball(node.corners, node.at, here.lo));
  --node.looks_left;
  if (!std::ranges::all_of(distances, is_finite)) {
    node.looks_left = 0;
    return;
  }
  width_ = here.width();
  const auto direction =
      frame_.direction(middle(here), {middle(distances[1]), middle(distances[2]), middle(distances[3])}, node.step);
  if (!direction) {
    node.looks_left = 0;
    return;
  }
  const Look found{node.at, here.lo, *direction};
  if (node.look) node.curvature.learn(frame_, *node.look, found);
  if (node.own_look && node.look->distance <= found.distance) return;  // it went too far
  node.look = found;
  node.own_look = true;
  node.reach = kFarthestCentre * std::max(extent_.radius, apart(node.at, extent_.centre));
}

/// Where the centre is not as far as it seemed, other points of the solid are nearer to it.
void TriangleBranchAndBound::told_ball(Node& node, const Enclosure& distance) {
  node.lower = std::max(node.lower, triangle_.lower_by_ball(node.corners, node.ball->centre, distance.lo));
  node.reach = 0.5 * node.ball->reach;
}

void TriangleBranchAndBound::split(const Node& node) {
  const std::size_t edge = longest_edge(node.corners);
  const auto parts = halves(node.piece, edge);
  if (!parts) {
    left_out_ = std::min(left_out_, node.lower);
    return;
  }
  for (const Piece& piece : *parts) {
    Node part = node;
    part.piece = piece;
    part.corners = triangle_.corners(piece);
    part.looks_left = kLooksAtPart;
    part.own_look = false;
    keep(std::move(part));
  }
}

}  // namespace verisq::verify
