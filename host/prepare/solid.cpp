/// This file implements solid.hpp.
#include "host/prepare/solid.hpp"

#include <algorithm>
#include <boost/math/special_functions/cos_pi.hpp>
#include <boost/math/special_functions/sin_pi.hpp>
#include <boost/math/special_functions/sinc.hpp>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "host/device/primitive_parameters.hpp"

namespace verisq::tessellation {
namespace {

/// (|a|^(2/e) + |b|^(2/e))^(e/2): of degree 1, so that the larger can be taken out before the powers underflow.
double superellipse_gauge(double a, double b, double exponent) {
  const double larger = std::max(std::abs(a), std::abs(b));
  const double smaller = std::min(std::abs(a), std::abs(b));
  if (larger == 0.0) return 0.0;
  const double ratio = smaller / larger;
  if (exponent == 1.0) return larger * std::sqrt(1.0 + ratio * ratio);  // circles need no powers
  return larger * std::pow(1.0 + std::pow(ratio, 2.0 / exponent), exponent / 2.0);
}

/// The image of a point under the taper, in semi-axes.
Eigen::Array3d tapered(const Eigen::Array3d& point, double k) {
  const double z = (point[2] - k) / (1.0 - k * point[2]);
  const double scale = 1.0 + k * z;
  return {scale * point[0], scale * point[1], z};
}

/// Undoes it. Precondition: |z| <= 1.
Eigen::Array3d untapered(const Eigen::Array3d& point, double k) {
  return Eigen::Array3d(point[0], point[1], point[2] + k) / (1.0 + k * point[2]);
}

Eigen::Matrix3d matrix(const std::array<double, 9>& rows) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rows.data());
}

/// The point of the curve |x|^(2/exponent) + |y|^(2/exponent) = 1 in the direction `quarter_turns` from x to y.
Eigen::Vector2d superellipse(double quarter_turns, double exponent) {
  // Exact zeros at the axes: neighbouring quarters share their points bit by bit.
  const double x = boost::math::cos_pi(quarter_turns / 2.0);
  const double y = boost::math::sin_pi(quarter_turns / 2.0);
  return Eigen::Vector2d(x, y) / superellipse_gauge(x, y, exponent);
}

}  // namespace

PlacedPrimitive::PlacedPrimitive(const Primitive& primitive)
    : semi_axes_(primitive.superquadric.semi_axes[0], primitive.superquadric.semi_axes[1],
                 primitive.superquadric.semi_axes[2]),
      exponents_(primitive.superquadric.exponents),
      k_((primitive.superquadric.taper - 1.0) / (primitive.superquadric.taper + 1.0)),
      rotation_(matrix(device::rotation_matrix(primitive.pose.quaternion))),
      translation_(primitive.pose.translation[0], primitive.pose.translation[1], primitive.pose.translation[2]) {
  // A solid with exponents up to 1 holds the ellipsoid of its semi-axes, any other the octahedron.
  steepness_ = smallest_semi_axis() / (std::max(exponents_[0], exponents_[1]) > 1.0 ? std::numbers::sqrt3 : 1.0);
  if (!primitive.bend) return;
  const double half_turns = primitive.bend->angle_degrees / 180.0;
  arc_ = {primitive.bend->curvature, boost::math::cos_pi(half_turns), boost::math::sin_pi(half_turns)};
  const double reach = std::abs(arc_.curvature) * std::hypot(semi_axes_[0], semi_axes_[1]) * (1.0 + std::abs(k_));
  steepness_ *= std::max(1.0 - reach, 0.1);
}

Eigen::Vector3d PlacedPrimitive::surface_point(const SurfaceParameters& parameters) const {
  const Eigen::Vector2d along = superellipse(parameters.latitude, exponents_[0]);
  const Eigen::Vector2d around = superellipse(parameters.longitude, exponents_[1]);
  const Eigen::Array3d unit(along[0] * around[0], along[0] * around[1], along[1]);
  return rotation_ * arc_.bent((tapered(unit, k_) * semi_axes_).matrix()) + translation_;
}

bool PlacedPrimitive::contains(const Eigen::Vector3d& point) const {
  const Eigen::Array3d placed = in_semi_axes(point);
  if (std::abs(placed[2]) > 1.0) return false;
  const Eigen::Array3d unit = untapered(placed, k_);
  const Eigen::Array3d magnitudes = unit.abs();
  // Between the octahedron, which exponents up to 2 leave inside, and the cube the gauge decides.
  if (magnitudes.maxCoeff() > 1.0) return false;
  return magnitudes.sum() <= 1.0 || gauge(unit) <= 1.0;
}

double PlacedPrimitive::level(const Eigen::Vector3d& point) const {
  Eigen::Array3d placed = in_semi_axes(point);
  // The taper's inverse has a pole beyond the ends: from there on the height alone counts.
  const double beyond = std::max(std::abs(placed[2]) - 1.0, 0.0);
  placed[2] = std::clamp(placed[2], -1.0, 1.0);
  return (gauge(untapered(placed, k_)) - 1.0 + beyond) * steepness_;
}

Eigen::Array3d PlacedPrimitive::in_semi_axes(const Eigen::Vector3d& point) const {
  return arc_.unbent(rotation_.transpose() * (point - translation_)).array() / semi_axes_;
}

double PlacedPrimitive::gauge(const Eigen::Array3d& unit) const {
  return superellipse_gauge(superellipse_gauge(unit[0], unit[1], exponents_[1]), unit[2], exponents_[0]);
}

Eigen::Vector3d PlacedPrimitive::Arc::bent(const Eigen::Vector3d& unbent) const {
  if (curvature == 0.0) return unbent;
  const double r = unbent[0] * cosine + unbent[1] * sine;
  const double s = unbent[1] * cosine - unbent[0] * sine;
  const double angle = curvature * unbent[2];
  // (1 - cos kz) / k without its cancellation
  const double along = r * std::cos(angle) + unbent[2] * std::sin(angle / 2.0) * boost::math::sinc_pi(angle / 2.0);
  const double up = (1.0 - curvature * r) * unbent[2] * boost::math::sinc_pi(angle);
  return {along * cosine - s * sine, along * sine + s * cosine, up};
}

Eigen::Vector3d PlacedPrimitive::Arc::unbent(const Eigen::Vector3d& bent) const {
  if (curvature == 0.0) return bent;
  const double along = bent[0] * cosine + bent[1] * sine;
  const double s = bent[1] * cosine - bent[0] * sine;
  const double m = 1.0 - curvature * along;
  const double rise = curvature * bent[2];
  const double r = (2.0 * along - curvature * (along * along + bent[2] * bent[2])) / (1.0 + std::hypot(m, rise));
  return {r * cosine - s * sine, r * sine + s * cosine, std::atan2(rise, m) / curvature};
}

namespace {

/// Share of the deviation for each of two directions, whose deviations add up.
constexpr double share_of_a_chord = 0.45;
constexpr int deepest_halving = 40;
/// The number of lines across one family, on which its chords are evaluated.
constexpr int lines_looked_at = 32;

using CurvePoint = std::function<Eigen::Vector3d(double parameter, double across)>;

class GridOfChords {
 public:
  GridOfChords(CurvePoint point, std::vector<double> across, double sag)
      : point_(std::move(point)), across_(std::move(across)), sag_(sag) {}

  /// From `first` to `last` eighths of a turn, both included: at multiples of 1/2 edges and corners may lie.
  [[nodiscard]] std::vector<double> between(int first, int last) {
    grid_ = {first / 2.0};
    for (int eighth = first; eighth < last; ++eighth) halve(eighth / 2.0, (eighth + 1) / 2.0, 0);
    return grid_;
  }

 private:
  void halve(double a, double b, int depth) {
    if (depth < deepest_halving && leaves_chord(a, b)) {
      halve(a, (a + b) / 2.0, depth + 1);
      halve((a + b) / 2.0, b, depth + 1);
    } else {
      grid_.push_back(b);
    }
  }

  [[nodiscard]] bool leaves_chord(double a, double b) const {
    return std::ranges::any_of(across_, [&](double across) {
      const Eigen::Vector3d from = point_(a, across);
      const Eigen::Vector3d chord = point_(b, across) - from;
      if (chord.norm() <= sag_) return false;  // nothing between lies farther away
      const std::array inner{0.25, 0.5, 0.75};
      return std::ranges::any_of(inner, [&](double t) {
        const Eigen::Vector3d way = point_(a + t * (b - a), across) - from;
        const double along = std::clamp(way.dot(chord) / chord.squaredNorm(), 0.0, 1.0);
        return (way - along * chord).norm() > sag_;
      });
    });
  }

  CurvePoint point_;
  std::vector<double> across_;
  double sag_;
  std::vector<double> grid_;
};

/// Evenly spread, with the ends and all multiples of 1/2.
std::vector<double> lines_across(double first, double last) {
  std::vector<double> lines;
  for (int i = 0; i <= lines_looked_at; ++i) lines.push_back(first + (last - first) * i / lines_looked_at);
  return lines;
}

struct Grid {
  std::vector<double> longitudes;  // 0 to 4; the last one is the first again
  std::vector<double> latitudes;   // -1 to 1: the poles
};

Grid grid_of(const PlacedPrimitive& primitive, double deviation) {
  const double sag = share_of_a_chord * deviation;
  const auto by_longitude = [&](double longitude, double latitude) {
    return primitive.surface_point({longitude, latitude});
  };
  const auto by_latitude = [&](double latitude, double longitude) {
    return primitive.surface_point({longitude, latitude});
  };
  GridOfChords around(by_longitude, lines_across(-1.0, 1.0), sag);
  GridOfChords along(by_latitude, lines_across(0.0, 4.0), sag);
  return {around.between(0, 8), along.between(-2, 2)};
}

}  // namespace

Mesh parametric_surface(const PlacedPrimitive& primitive, double deviation) {
  const auto [longitudes, latitudes] = grid_of(primitive, deviation);
  const auto columns = static_cast<std::uint32_t>(longitudes.size() - 1);
  const auto rows = static_cast<std::uint32_t>(latitudes.size() - 2);  // without the poles
  Mesh mesh;
  const auto add_vertex = [&](double longitude, double latitude) {
    const Eigen::Vector3d point = primitive.surface_point({longitude, latitude});
    mesh.vertices.push_back({point[0], point[1], point[2]});
  };
  for (std::uint32_t row = 0; row < rows; ++row) {
    for (std::uint32_t column = 0; column < columns; ++column) add_vertex(longitudes[column], latitudes[row + 1]);
  }
  add_vertex(0.0, -1.0);
  add_vertex(0.0, 1.0);
  const std::uint32_t south = rows * columns;
  const std::uint32_t north = south + 1;
  for (std::uint32_t column = 0; column < columns; ++column) {
    const std::uint32_t next = (column + 1) % columns;
    mesh.triangles.push_back({south, next, column});
    for (std::uint32_t row = 0; row + 1 < rows; ++row) {
      const std::uint32_t low = row * columns;
      const std::uint32_t high = low + columns;
      mesh.triangles.push_back({low + column, low + next, high + next});
      mesh.triangles.push_back({low + column, high + next, high + column});
    }
    const std::uint32_t last = (rows - 1) * columns;
    mesh.triangles.push_back({last + column, last + next, north});
  }
  return mesh;
}

namespace {

/// Share of the line that is searched for the surface.
constexpr double fraction_precision = 1e-12;

template <class InPrimitive>
bool in_set(const SetExpression& set, const InPrimitive& in_primitive) {
  if (set.operands.empty()) return in_primitive(set.primitive);
  const auto in_operand = [&](const SetExpression& operand) { return in_set(operand, in_primitive); };
  switch (set.operation) {
    case SetOperation::unite: return std::ranges::any_of(set.operands, in_operand);
    case SetOperation::intersect: return std::ranges::all_of(set.operands, in_operand);
    case SetOperation::subtract: break;
  }
  return in_operand(set.operands.front()) && std::none_of(set.operands.begin() + 1, set.operands.end(), in_operand);
}

template <class LevelOf>
Solid::Level level_of_set(const SetExpression& set, const LevelOf& level_of) {
  if (set.operands.empty()) return level_of(set.primitive);
  Solid::Level result = level_of_set(set.operands.front(), level_of);
  for (std::size_t i = 1; i < set.operands.size(); ++i) {
    Solid::Level operand = level_of_set(set.operands[i], level_of);
    if (set.operation == SetOperation::subtract) operand.value = -operand.value;
    const bool decides =
        set.operation == SetOperation::unite ? operand.value < result.value : operand.value > result.value;
    if (decides) result = operand;
  }
  return result;
}

}  // namespace

Solid::Solid(const Model& model) : model_(model) {
  for (const Primitive& primitive : model.primitives) primitives_.emplace_back(primitive);
}

bool Solid::contains(const Eigen::Vector3d& point) const {
  return contains(point, primitives_.size(), false);
}

bool Solid::contains(const Eigen::Vector3d& point, std::size_t k, bool in_k) const {
  const auto in_primitive = [&](std::size_t i) {
    if (i == k) return in_k;
    const PlacedPrimitive& primitive = primitives_[i];
    const double radius = primitive.radius();
    return (point - primitive.centre()).squaredNorm() <= radius * radius && primitive.contains(point);
  };
  if (model_.csg) return in_set(*model_.csg, in_primitive);
  for (std::size_t i = 0; i < primitives_.size(); ++i) {
    if (in_primitive(i)) return true;
  }
  return false;
}

Solid::Level Solid::level(const Eigen::Vector3d& point) const {
  const auto level_of = [&](std::size_t i) {
    const PlacedPrimitive& primitive = primitives_[i];
    const double beyond = (point - primitive.centre()).norm() - primitive.radius();
    return Level{beyond > 0.0 ? beyond + primitive.smallest_semi_axis() : primitive.level(point), i};
  };
  if (model_.csg) return level_of_set(*model_.csg, level_of);
  Level least = level_of(0);
  for (std::size_t i = 1; i < primitives_.size(); ++i) {
    const Level other = level_of(i);
    if (other.value < least.value) least = other;
  }
  return least;
}

Eigen::Vector3d Solid::outward(const Eigen::Vector3d& point, double step) const {
  Eigen::Vector3d gradient;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d offset = step * Eigen::Vector3d::Unit(axis);
    gradient[axis] = level(point + offset).value - level(point - offset).value;
  }
  return gradient.stableNormalized();
}

double Solid::crossing(const Eigen::Vector3d& inside, const Eigen::Vector3d& outside) const {
  const auto level_at = [&](double t) { return level(inside + t * (outside - inside)).value; };
  const double first = level_at(0.0);
  const double last = level_at(1.0);
  if (!(first < 0.0)) return 0.0;
  if (!(last > 0.0)) return 1.0;
  const auto precise = [](double a, double b) { return b - a <= fraction_precision; };
  std::uintmax_t evaluations = 100;
  const auto [a, b] = boost::math::tools::toms748_solve(level_at, 0.0, 1.0, first, last, precise, evaluations);
  return (a + b) / 2.0;
}

std::optional<Eigen::Vector3d> Solid::surface_along(const Eigen::Vector3d& point, const Eigen::Vector3d& outward,
                                                    double reach) const {
  const Eigen::Vector3d inside = point - reach * outward;
  const Eigen::Vector3d outside = point + reach * outward;
  if (!contains(inside) || contains(outside)) return std::nullopt;
  return inside + crossing(inside, outside) * (outside - inside);
}

}  // namespace verisq::tessellation
