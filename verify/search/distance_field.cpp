/// This file implements distance_field.hpp.
#include "verify/search/distance_field.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "verify/numbers/points.hpp"
#include "verify/search/set_tree.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Room for the roundings of a norm of three numbers, and for normals in binary32, which are a little longer than 1.
constexpr double kRoundedUp = 1.0 + 0x1p-20;

Matrix3d cross_matrix(const Vector3d& v) {
  Matrix3d cross;
  cross << 0.0, -v[2], v[1], v[2], 0.0, -v[0], -v[1], v[0], 0.0;
  return cross;
}

double sinc(double x) {
  return x == 0.0 ? 1.0 : std::sin(x) / x;
}

/// (x - sin x) / x³, by its series where the difference would lose digits.
double cubic_sinc(double x) {
  if (x >= 1.0) return (x - std::sin(x)) / (x * x * x);
  double term = 1.0 / 6.0;
  double sum = term;
  for (int k = 4; k < 24; k += 2) {
    term *= -x * x / (k * (k + 1));
    sum += term;
  }
  return sum;
}

/// exp(ω) and its left Jacobian: 1 + b W + (...) W², W the matrix of the cross product with ω.
struct Exponential {
  explicit Exponential(const Vector3d& omega) {
    const double angle = omega.norm();
    const Matrix3d cross = cross_matrix(omega);
    const Matrix3d square = cross * cross;
    const double half_sinc = sinc(angle / 2.0);
    const double versine = half_sinc * half_sinc / 2.0;  // (1 - cos) / angle²
    rotation = Matrix3d::Identity() + sinc(angle) * cross + versine * square;
    jacobian = Matrix3d::Identity() + versine * cross + cubic_sinc(angle) * square;
  }
  Matrix3d rotation;
  Matrix3d jacobian;
};

}  // namespace

PoseBoxMotion::PoseBoxMotion(const PoseSpace& space, const PoseBox& box, double rounding)
    : pivot_(space.start_centre + box.centre.head<3>()),
      centre_(space.centre),
      half_(box.half),
      moved_(box.half.head<3>().norm() * kRoundedUp),
      turned_(box.half.tail<3>().norm() * kRoundedUp),
      rounding_(rounding) {
  const Exponential exponential(box.centre.tail<3>());
  rotation_ = exponential.rotation * space.start_rotation;
  jacobian_ = exponential.jacobian;
}

// With y = v - t - τ(0) and R(s) = exp(ω(0) + s δω) R0, x - c = R(1)^T (y - δτ). Rotations along the line turn at the
// angular velocity J δω, which is no faster than |δω|: |R(1)^T y - R(0)^T y| <= |δω| |y|, and R^T keeps the length of
// δτ. Second derivatives along the line are at most 3/2 |δω|² |y| (docs/mathematics.md §24). So the remainder of R^T y
// is at most 3/4 of that square times |y|; the remainder of R^T δτ is |R(1)^T δτ - R(0)^T δτ| <= |δω| |δτ|.
PoseBoxMotion::Place PoseBoxMotion::place(const Vector3d& v) const {
  const Vector3d arm = v - pivot_;
  const double length = arm.norm();
  return {.arm = arm,
          .point = centre_ + rotation_.transpose() * arm,
          .reach = (moved_ + turned_ * length) * kRoundedUp + rounding_,
          .remainder = turned_ * (0.75 * turned_ * length + moved_) * kRoundedUp + rounding_};
}

// With m = R n: n·R^T (y - δτ) changes by -m·δτ. If the implant turns by θ = J δω, it changes by -m·(θ x y) = θ·(m x
// y).
PoseParameters PoseBoxMotion::slope(const Place& place, const Vector3d& normal) const {
  const Vector3d turned = rotation_ * normal;
  PoseParameters result;
  result.head<3>() = -turned;
  result.tail<3>() = jacobian_.transpose() * turned.cross(place.arm);
  return result;
}

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Nodes of the finest grid, about; each coarser one has fewer.
constexpr double kFineNodes = 100000.0;
/// Share of the smallest semi-axis: a finer grid would hardly improve the bounds of so small a solid.
constexpr double kFinestSpacing = 0.3;
/// The ratio of spacings from a grid to the next.
constexpr double kCoarsening = 3.5;
/// The reach of the finest grid beyond the model, in nodes.
constexpr double kFineMargin = 6.0;
/// The largest distance from the surface, in nodes, at which balls are still sought that prove points too deep.
constexpr double kBallMargin = 1.5;
/// The largest number of nodes of the finest grid: long thin models have a coarser one.
constexpr double kMostNodes = 400000.0;

/// Nodes along each axis: the model, and the margin on both sides.
double nodes_of(const Vector3d& lengths, double spacing) {
  return ((lengths / spacing).array() + 2.0 * kFineMargin + 2.0).prod();
}

double fine_spacing(const Vector3d& lengths, double smallest) {
  double spacing = std::max(std::cbrt(lengths.prod() / kFineNodes), kFinestSpacing * smallest);
  while (nodes_of(lengths, spacing) > kMostNodes) spacing *= 1.2;
  return spacing;
}

/// Half the sides of the box about the solid: its sections along z are at most 1 + |k| times the middle one, k = (t -
/// 1)/(t + 1).
Vector3d half_sides_of(const Superquadric& solid) {
  const double widening = (1.0 + std::abs(taper_coefficient<double>(solid.taper))) * (1.0 + 0x1p-50);
  const auto& [a, b, c] = solid.semi_axes;
  return {a * widening, b * widening, c};
}

/// Larger than every distance, and far from overflow.
constexpr float kFar = 0x1p100F;

Vector3d vector(const Point& p) {
  return {p[0], p[1], p[2]};
}

}  // namespace

DistanceField::DistanceField(const Model& model, double extent, double size)
    : rounding_(PoseBoxMotion::rounding(size)), slack_(0x1p-21 * size) {
  const Box box = bounding_box(model);
  lower_ = vector(box.lower);
  upper_ = vector(box.upper);
  smallest_ = infinity;
  for (const Primitive& primitive : model.primitives) {
    const Superquadric& solid = primitive.superquadric;
    const Matrix3d rotation = unit_quaternion(primitive.pose.quaternion).toRotationMatrix();
    const Vector3d translation = vector(primitive.pose.translation);
    const double to_focus = -taper_coefficient<double>(solid.taper) * solid.semi_axes[2];
    primitives_.push_back({SuperquadricBounds<double>(solid), rotation, translation,
                           translation + to_focus * rotation.col(2), half_sides_of(solid)});
    smallest_ = std::min(smallest_, std::ranges::min(primitive.superquadric.semi_axes));
  }
  const double spacing = fine_spacing(upper_ - lower_, smallest_);
  double margin = kFineMargin * spacing;
  grids_.push_back(grid(margin, spacing));
  for (double coarse = kCoarsening * spacing; margin < extent; coarse *= kCoarsening) {
    margin *= kCoarsening;
    grids_.push_back(grid(std::min(margin, extent), coarse));
  }
}

DistanceField::Grid DistanceField::grid(double margin, double spacing) const {
  Grid result{lower_.array() - margin, spacing, 1.0 / spacing, {}, {}};
  std::size_t nodes = 1;
  for (int i = 0; i < 3; ++i) {
    const double length = upper_[i] - lower_[i] + 2.0 * margin;
    result.count[static_cast<std::size_t>(i)] = static_cast<std::int32_t>(std::ceil(length / spacing)) + 1;
    nodes *= static_cast<std::size_t>(result.count[static_cast<std::size_t>(i)]);
  }
  result.nodes.resize(nodes);
  return result;
}

bool DistanceField::Grid::contains(const Vector3d& x) const {
  const Vector3d at = (x - lower) * per_length;
  return at[0] >= 0.0 && at[1] >= 0.0 && at[2] >= 0.0 && at[0] <= count[0] - 1 && at[1] <= count[1] - 1 &&
         at[2] <= count[2] - 1;
}

std::size_t DistanceField::Grid::index(const Vector3d& x) const {
  const Vector3d at = (x - lower) * per_length;
  const auto along = [&](int i) {
    const double last = count[static_cast<std::size_t>(i)] - 1;
    return static_cast<std::size_t>(std::min(std::max(at[i] + 0.5, 0.0), last));
  };
  return (along(2) * static_cast<std::size_t>(count[1]) + along(1)) * static_cast<std::size_t>(count[0]) + along(0);
}

Vector3d DistanceField::Grid::place(std::size_t index) const {
  Vector3d at;
  for (int i = 0; i < 3; ++i) {
    const auto along = static_cast<std::size_t>(count[static_cast<std::size_t>(i)]);
    at[i] = lower[i] + spacing * static_cast<double>(index % along);
    index /= along;
  }
  return at;
}

DistanceField::Found DistanceField::near(const Vector3d& x) const {
  const auto grid = std::find_if(grids_.begin(), grids_.end() - 1, [&](const Grid& g) { return g.contains(x); });
  const std::size_t index = grid->index(x);
  return {grid->nodes[index], grid->place(index)};
}

std::size_t DistanceField::slabs() const {
  std::size_t slabs = 0;
  for (const Grid& grid : grids_) slabs += static_cast<std::size_t>(grid.count[2]);
  return slabs;
}

void DistanceField::find_slab(std::size_t slab, const ProposedNormal& normal) {
  for (Grid& grid : grids_) {
    const auto count = static_cast<std::size_t>(grid.count[2]);
    if (slab >= count) {
      slab -= count;
      continue;
    }
    const std::size_t nodes = grid.nodes.size() / count;
    for (std::size_t i = slab * nodes; i < (slab + 1) * nodes; ++i) grid.nodes[i] = node(grid.place(i), normal);
    return;
  }
}

// The primitive lies in {v·q <= h(v)} of its own frame, q = R^T (x - t) about its focus t. So its signed distance is at
// least (v·q - h(v)) / |v|, h rounded up. The normal of binary32 is taken as exact, v = R^T n. |n| differs from 1 by
// less than 2^-22, and the offset from its binary32 number by less than 2^-23 of itself: the slack is more than both
// errors. Below the normal numbers of binary32 an offset rounds by 2^-150 instead, and the slack is at least 2^-121
// (PoseBoxMotion::smallest_size). A component of a normal rounds by 2^-150, too, which `size` multiplies.
RoundedHalfSpace DistanceField::half_space(const PosedPrimitive& primitive, const Vector3d& local_normal) const {
  const Vector3d unit = vector(near_one(Point{local_normal[0], local_normal[1], local_normal[2]})).normalized();
  const Eigen::Vector3f normal = (primitive.rotation * unit).cast<float>();
  const Vector3d direction = normal.cast<double>();
  const Vector3d v = primitive.rotation.transpose() * direction;
  const double support = primitive.bounds.support_up({Interval(v[0]), Interval(v[1]), Interval(v[2])});
  return {normal, static_cast<float>(support + direction.dot(primitive.focus) + slack_)};
}

DistanceField::Node DistanceField::node(const Vector3d& x, const ProposedNormal& normal) const {
  const RoundedHalfSpace nothing{Eigen::Vector3f::Zero(), -kFar};
  Node result{{nothing, nothing}, kFar, -1};
  std::array<double, 2> distances{kFar, kFar};
  std::vector<Vector3d> local;
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t k = 0; k < primitives_.size(); ++k) {
    const PosedPrimitive& primitive = primitives_[k];
    local.push_back(primitive.rotation.transpose() * (x - primitive.translation));
    order.emplace_back(distance_to_box(primitive, local[k]), k);
  }
  std::ranges::sort(order);
  for (const auto& [to_box, k] : order) {
    const bool is_far = to_box > distances[1];
    const Vector3d proposed = is_far ? Vector3d::Zero() : normal(k, local[k]);
    // The primitive is farther than two others, or nothing is proposed: the bound by its box is valid.
    if (proposed.isZero(0.0) || !proposed.allFinite()) {
      result.others = std::min(result.others, static_cast<float>(to_box - slack_));
      continue;
    }
    RoundedHalfSpace candidate = half_space(primitives_[k], proposed);
    double distance = candidate.distance(x);
    for (std::size_t i = 0; i < 2; ++i) {
      if (!(distance < distances[i])) continue;
      std::swap(distance, distances[i]);
      std::swap(candidate, result.nearest[i]);
    }
    result.others = std::min(result.others, static_cast<float>(distance - slack_));
  }
  return result;
}

/// Rounded down; minus infinity in the box.
double DistanceField::distance_to_box(const PosedPrimitive& primitive, const Vector3d& local) const {
  const double distance = (local.cwiseAbs() - primitive.half_sides).cwiseMax(0.0).norm();
  return distance > 0.0 ? distance - rounding_ : -infinity;
}

// A point at depth r is the centre of a ball of that radius in the model. About a node near the surface the best balls
// touch the surface where it is nearest to the node, and are as large as possible. The search tries candidates.
void DistanceField::find_balls(const DistancesUp& distances_up) {
  Grid& fine = grids_.front();
  std::vector<Point> centres;
  std::vector<std::uint32_t> node_of;
  for (std::size_t i = 0; i < fine.nodes.size(); ++i) {
    const RoundedHalfSpace& nearest = fine.nodes[i].nearest[0];
    const Vector3d at = fine.place(i);
    const double distance = nearest.distance(at);
    const auto propose = [&](double depth) {
      const Vector3d centre = at - (distance + depth) * nearest.direction();
      centres.push_back({centre[0], centre[1], centre[2]});
      node_of.push_back(static_cast<std::uint32_t>(i));
    };
    if (distance > kBallMargin * fine.spacing) continue;
    for (const double depth : {0.5 * smallest_, 0.9 * smallest_, 1.5 * smallest_})
      if (depth > -distance) propose(depth);
    if (distance < 0.0) propose(-distance);
  }
  const std::vector<double> distances = distances_up(centres);
  balls_.clear();
  for (std::size_t i = 0; i < centres.size(); ++i) {
    const InnerBall ball{vector(centres[i]), -distances[i] - rounding_};
    if (!(ball.radius > 0.0)) continue;
    Node& node = fine.nodes[node_of[i]];
    const Vector3d at = fine.place(node_of[i]);
    const auto reached = [&](const InnerBall& of) { return (at - of.centre).norm() - of.radius; };
    const bool first = node.ball < 0;
    if (!first && !(reached(ball) < reached(balls_.back()))) continue;
    if (first) {
      node.ball = static_cast<std::int32_t>(balls_.size());
      balls_.push_back(ball);
    } else {
      balls_.back() = ball;  // the proposals of a node follow one another
    }
  }
}

}  // namespace verisq::verify
