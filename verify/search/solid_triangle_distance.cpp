/// This file implements solid_triangle_distance.hpp.
#include "verify/search/solid_triangle_distance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "verify/numbers/points.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/proposals/support_mapping.hpp"
#include "verify/search/mesh_union.hpp"
#include "verify/search/set_tree.hpp"
#include "verify/search/solid_certificate.hpp"
#include "verify/solids/model.hpp"
#include "verisq/distance.hpp"
#include "verisq/error.hpp"

namespace verisq::verify {
namespace {

constexpr std::size_t kProbes = 3;
constexpr int kLooksAtWhole = 10;
constexpr int kLooksAtPart = 2;
constexpr std::size_t kPartsAtATime = 1024;
constexpr std::size_t kPointsAPart = 16;  ///< requested so far, for each part processed at a time
constexpr double kFarthestCentre = 8.0;   ///< in sizes of the solid: centres farther from bent solids often take a
                                          ///< search
constexpr double kNextReach = 0.125;      ///< factor for the reach of a centre that was too far
constexpr double kShareOfReach = 0.9;     ///< share of the reach at which another point is as near as the look's
constexpr double kShareOfAim = 0.5;       ///< this share of the tolerance is left for the errors of proposals

double squared_edge(const Triangle& corners, std::size_t edge) {
  const Point way = difference(corners[(edge + 1) % 3], corners[edge]);
  return dot(way, way);
}

std::size_t longest_edge(const Triangle& corners) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < 3; ++i)
    if (squared_edge(corners, i) > squared_edge(corners, best)) best = i;
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

std::optional<Point> unit_of(const Point& v) {
  const double size = std::sqrt(dot(v, v));
  if (!(size > 0.0) || !std::isfinite(size)) return std::nullopt;
  return Point{v[0] / size, v[1] / size, v[2] / size};
}

/// The distance r from the look, towards the centre, at which a point is as far from `near` as from the point of the
/// look's distance. With w = look - near, u the direction to the centre and d the distance, |w + r u| = d + r.
double reach_beside(const Look& look, const Point& centre, const Point& near) {
  const std::optional<Point> u = unit_of(difference(centre, look.at));
  if (!u) return 0.0;
  const Point w = difference(look.at, near);
  const double farther = look.distance - dot(w, *u);
  return farther > 0.0 ? std::max(0.0, dot(w, w) - look.distance * look.distance) / (2.0 * farther) : 0.0;
}

/// A power of two.
double unit_about(const Triangle& triangle, const SolidExtent& extent) {
  constexpr int ordinary = 300;  // cubes of these lengths are numbers
  constexpr int extreme = 1000;
  const double largest = std::max({largest_coordinate(triangle), largest_coordinate(extent.centre), extent.radius});
  if (!(largest > 0.0) || !std::isfinite(largest)) return 1.0;
  const int exponent = std::ilogb(largest);
  return std::abs(exponent) > ordinary ? std::ldexp(1.0, std::clamp(exponent, -extreme, extreme)) : 1.0;
}

Point scaled(const Point& x, double by) {
  return {by * x[0], by * x[1], by * x[2]};
}

Triangle in_units(const Triangle& triangle, double unit) {
  return {scaled(triangle[0], 1.0 / unit), scaled(triangle[1], 1.0 / unit), scaled(triangle[2], 1.0 / unit)};
}

/// In these units: the error of a point by underflow of its coordinates, when divided by the unit or multiplied again.
double lost_in_units(double unit) {
  return unit == 1.0 ? 0.0 : 0x1p-1073 / std::min(unit, 1.0);
}

}  // namespace

TriangleBranchAndBound::TriangleBranchAndBound(const Triangle& triangle, const SolidExtent& extent, double tolerance)
    : TriangleBranchAndBound(triangle, extent, tolerance, unit_about(triangle, extent)) {}

TriangleBranchAndBound::TriangleBranchAndBound(const Triangle& triangle, const SolidExtent& extent, double tolerance,
                                               double unit)
    : unit_(unit),
      triangle_(in_units(triangle, unit), lost_in_units(unit)),
      frame_(in_units(triangle, unit)),
      extent_{scaled(extent.centre, 1.0 / unit), extent.radius / unit},
      tolerance_(std::min(tolerance / unit, std::numeric_limits<double>::max())) {
  Node root{.piece = whole_triangle,
            .corners = in_units(triangle, unit),
            .lower = 0.0,
            .look = std::nullopt,
            .own_look = false,
            .looks_left = kLooksAtWhole,
            .curvature = Curvature(extent_.radius),
            .reach = 0.0,
            .question = Question::none,
            .at = {},
            .distance = {},
            .step = 0.0,
            .ball_reach = 0.0};
  const Point nearest = nearest_to_centre(root);
  const double size = std::max(extent_.radius, apart(nearest, extent_.centre));
  root.curvature = Curvature(size);
  root.reach = kFarthestCentre * size;
  plan_look(root, nearest);
  asking_.push_back(root);
}

/// The nearest point, as if the solid were its centre.
Point TriangleBranchAndBound::nearest_to_centre(const Node& node) const {
  const Look towards{node.corners[0], 0.0, difference(node.corners[0], extent_.centre)};
  return triangle_.point(least_point(frame_, node.piece, node.corners, towards, Curvature(1.0)).weights);
}

bool TriangleBranchAndBound::settled(double lower) const {
  return verified({std::min(lower, upper_), upper_}, tolerance_);
}

bool TriangleBranchAndBound::finished() const {
  return settled(0.0) || (asking_.empty() && (open_.empty() || settled(open_.top().lower)));
}

std::optional<Point> TriangleBranchAndBound::nearest() const {
  return nearest_ ? std::optional(scaled(*nearest_, unit_)) : std::nullopt;
}

Enclosure TriangleBranchAndBound::enclosure() const {
  const auto [lo, hi] = enclosure_in_units();
  return {multiply(lo, unit_, Direction::down), multiply(hi, unit_, Direction::up)};
}

Enclosure TriangleBranchAndBound::enclosure_in_units() const {
  double lower = std::min(left_out_, open_.empty() ? infinity : open_.top().lower);
  for (const Node& node : asking_) lower = std::min(lower, node.lower);
  return {std::min(lower, upper_), upper_};
}

double TriangleBranchAndBound::aim() const {
  return upper_ - kShareOfAim * tolerance_;
}

void TriangleBranchAndBound::ask(std::vector<Point>& points) {
  const std::size_t most = std::clamp<std::size_t>(asked_ / kPointsAPart, 1, kPartsAtATime);
  while (asking_.size() < most && !open_.empty() && !settled(open_.top().lower)) {
    const Node node = open_.top();
    open_.pop();
    advance(node);
  }
  for (const Node& node : asking_) {
    if (node.question != Question::probes) {
      points.push_back(scaled(node.at, unit_));
    } else {
      for (const Point& probe : frame_.probes(node.at, node.step)) points.push_back(scaled(probe, unit_));
    }
  }
}

void TriangleBranchAndBound::answer(std::span<const Answer> in_lengths) {
  asked_ += in_lengths.size();
  std::vector<Answer> in_units(in_lengths.begin(), in_lengths.end());
  for (Answer& answer : in_units) {
    answer.distance = {divide(answer.distance.lo, unit_, Direction::down),
                       divide(answer.distance.hi, unit_, Direction::up)};
  }
  std::span<const Answer> answers = in_units;
  std::vector<Node> asked;
  std::swap(asked, asking_);
  for (Node& node : asked) {
    const Question question = std::exchange(node.question, Question::none);
    const std::span<const Answer> told = answers.first(question == Question::probes ? kProbes : 1);
    answers = answers.subspan(told.size());
    if (question == Question::look) told_look(node, told.front());
    if (question == Question::probes) told_probes(node, told);
    if (question == Question::ball) told_ball(node, told.front());
    if (node.question == Question::none) {
      keep(node);
    } else {
      asking_.push_back(node);
    }
  }
}

void TriangleBranchAndBound::keep(const Node& node) {
  if (settled(node.lower)) {
    left_out_ = std::min(left_out_, node.lower);
  } else {
    open_.push(node);
  }
}

/// The next step for a part: a question, or halving.
void TriangleBranchAndBound::advance(Node node) {
  if (plan_ball(node) || plan_next_look(node)) {
    asking_.push_back(node);
  } else {
    split(node);
  }
}

/// The smallest ball that is expected to do.
bool TriangleBranchAndBound::plan_ball(Node& node) const {
  if (!node.look) return false;
  const ProvingDirections directions = proving_directions(frame_, node.corners, *node.look, aim());
  for (std::size_t i = 0; i < directions.count; ++i) {
    const auto ball = proving_ball(node.corners, *node.look, directions.directions[i], aim(), node.reach);
    if (!ball || (node.question == Question::ball && node.ball_reach <= ball->reach)) continue;
    node.question = Question::ball;
    node.at = ball->centre;
    node.ball_reach = ball->reach;
  }
  return node.question == Question::ball;
}

/// False if another look promises nothing.
bool TriangleBranchAndBound::plan_next_look(Node& node) const {
  if (node.looks_left == 0) return false;
  if (!node.look) {
    plan_look(node, nearest_to_centre(node));
    return true;
  }
  const LeastPoint least = least_point(frame_, node.piece, node.corners, *node.look, node.curvature);
  constexpr double worth_a_look = 0.125;
  if (node.own_look && !(least.gain > worth_a_look * tolerance_)) return false;
  plan_look(node, triangle_.point(least.weights));
  return true;
}

/// Probes are so near that the distance is nearly linear, and so far that the enclosures' widths hardly count.
void TriangleBranchAndBound::plan_look(Node& node, const Point& at) const {
  node.question = Question::look;
  node.at = at;
  const double size = std::max(extent_.radius, apart(at, extent_.centre));
  node.step = std::max(1e-6 * size, 0.3 * std::sqrt(width_ * size));
}

void TriangleBranchAndBound::told_look(Node& node, const Answer& answer) {
  --node.looks_left;
  const double upper = triangle_.upper_by_point(answer.distance.hi);
  if (upper < upper_) nearest_ = node.at;
  upper_ = std::min(upper_, upper);
  node.lower = std::max(node.lower, triangle_.lower_by_ball(node.corners, node.at, answer.distance.lo));
  node.distance = answer.distance;
  if (settled(node.lower)) return;
  if (!is_finite(answer.distance)) {
    node.looks_left = 0;
    return;
  }
  width_ = answer.distance.width();
  const std::optional<Point> direction = unit_of(answer.direction);
  if (direction) {
    learn(node, direction);
  } else {
    node.question = Question::probes;
  }
}

void TriangleBranchAndBound::told_probes(Node& node, std::span<const Answer> answers) const {
  std::array<double, kProbes> distances{};
  for (std::size_t i = 0; i < kProbes; ++i) distances[i] = middle(answers[i].distance);
  learn(node, frame_.direction(middle(node.distance), distances, node.step));
}

void TriangleBranchAndBound::learn(Node& node, const std::optional<Point>& direction) const {
  if (!direction) {
    node.looks_left = 0;
    return;
  }
  const Look found{node.at, node.distance.lo, *direction};
  if (node.look) node.curvature.learn(frame_, *node.look, found);
  if (node.own_look && node.look->distance <= found.distance) return;  // it went too far
  node.look = found;
  node.own_look = true;
}

/// If the centre is not as far as it seemed, other points of the solid are nearer to it.
void TriangleBranchAndBound::told_ball(Node& node, const Answer& answer) const {
  node.lower = std::max(node.lower, triangle_.lower_by_ball(node.corners, node.at, answer.distance.lo));
  const std::optional<Point> direction = unit_of(answer.direction);
  const double reach = direction ? reach_beside(*node.look, node.at, along(node.at, *direction, -answer.distance.hi))
                                 : kNextReach * node.ball_reach;
  node.reach = std::min(kShareOfReach * reach, 0.5 * node.ball_reach);
}

void TriangleBranchAndBound::split(const Node& node) {
  const auto parts = halves(node.piece, longest_edge(node.corners));
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
    keep(part);
  }
}

}  // namespace verisq::verify

namespace verisq {
namespace {

constexpr std::size_t most_points = 4096;
constexpr double share_of_points = 0.125;       // of the tolerance, where a point takes a search
constexpr double share_of_proposal = 1.0 / 16;  // of the tolerance, where a cover proves the rest

constexpr Enclosure nothing_known{-infinity, infinity};

std::vector<std::optional<TriangleDistance>> convex_primitives(const Model& model) {
  std::vector<std::optional<TriangleDistance>> result(model.primitives.size());
  for (std::size_t i = 0; i < model.primitives.size(); ++i) {
    if (!is_bent(model.primitives[i])) result[i].emplace(Model{"", {model.primitives[i]}});
  }
  return result;
}

/// For models of superquadrics alone: from signed distances of points.
struct SearchedSolid {
  explicit SearchedSolid(const Model& model)
      : distance(model),
        extent(verify::extent_of(model)),
        convex(convex_primitives(model)),
        search(model),
        checker(model) {}

  /// Works until the tolerance is reached, the budget spent, or `over` returns true.
  [[nodiscard]] verify::TriangleBranchAndBound searched(const Triangle& triangle, double tolerance,
                                                        const std::function<bool()>& over) const {
    verify::TriangleBranchAndBound result(triangle, extent, tolerance);
    std::vector<Point> points;
    std::vector<verify::TriangleBranchAndBound::Answer> answers;
    while (!result.finished() && result.asked() < most_points && !over()) {
      points.clear();
      answers.clear();
      result.ask(points);
      for (const Point& point : points) {
        const bool known = verify::is_finite(point);
        answers.push_back({known ? distance(point, share_of_points * tolerance, over) : nothing_known});
      }
      result.answer(answers);
    }
    return result;
  }

  SignedDistance distance;
  verify::SolidExtent extent;
  std::vector<std::optional<TriangleDistance>> convex;  ///< for each primitive that is not bent, alone
  verify::SolidDistance search;
  verify::ExactChecker checker;
};

}  // namespace

/// One of the two.
struct TriangleSearch::State {
  explicit State(const Model& model) {
    if (has_mesh(model))
      meshes.emplace(model);
    else
      superquadrics.emplace(model);
  }

  std::optional<SearchedSolid> superquadrics;
  std::optional<verify::MeshTriangleDistance> meshes;
};

TriangleSearch::TriangleSearch(const Model& model) {
  verify::require_valid_with_meshes(model);
  state_ = hidden<State>(model);
}

namespace {

void require_query(const Triangle& triangle, double tolerance) {
  for (std::size_t k = 0; k < triangle.size(); ++k) verify::require_finite(triangle[k], fmt::format("triangle[{}]", k));
  verify::require_tolerance(tolerance);
}

}  // namespace

Enclosure TriangleSearch::operator()(const Triangle& triangle, double tolerance,
                                     const std::function<bool()>& interrupted) const {
  require_query(triangle, tolerance);
  if (state_->meshes) return (*state_->meshes)(triangle);
  return state_->superquadrics->searched(triangle, tolerance, [&] { return interrupted && interrupted(); }).enclosure();
}

CertifiedEnclosure TriangleSearch::certified(const Triangle& triangle, double tolerance,
                                             const std::function<bool()>& interrupted) const {
  require_query(triangle, tolerance);
  if (state_->meshes) return state_->meshes->certified(triangle);
  const SearchedSolid& solid = *state_->superquadrics;
  const auto over = [&] { return interrupted && interrupted(); };
  const auto nearest = solid.searched(triangle, share_of_proposal * tolerance, over).nearest();
  if (!nearest) return {{0.0, infinity}, {}};
  return verify::covered({solid.convex, solid.search, solid.checker}, triangle, *nearest, tolerance, over);
}

}  // namespace verisq
