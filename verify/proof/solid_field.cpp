/// This file implements solid_field.hpp.
#include "verify/proof/solid_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <unordered_map>

#include "verify/numbers/functions.hpp"
#include "verify/numbers/interval.hpp"
#include "verify/numbers/vector.hpp"
#include "verify/proposals/gjk.hpp"
#include "verify/solids/superquadric.hpp"

namespace verisq::verify {

namespace {

PreciseMatrix cross_matrix(const PreciseVector& v) {
  return {{0, -v[2], v[1]}, {v[2], 0, -v[0]}, {-v[1], v[0], 0}};
}

/// (a - sin a)/a³ = 1/6 - a²/120 + ..., whose terms fall and change their signs: for small a between its first sums.
PreciseInterval cubic_quotient(const PreciseInterval& a) {
  const PreciseInterval squared = square(a);
  if (squared.upper() < Real(0x1p-20)) {
    const PreciseInterval first = PreciseInterval(1) / PreciseInterval(6);
    return {(first - squared / PreciseInterval(120)).lower(), first.upper()};
  }
  return (PreciseInterval(1) - quotient_of_sine(a)) / squared;
}

/// exp(ω) and its left Jacobian J: 1 + s W + c W², with W the matrix of the cross product with ω. For exp(ω), s = sin
/// a/a and c = (1 - cos a)/a²; for J, s is that c, and c = (a - sin a)/a³; a = |ω|.
struct Exponential {
  explicit Exponential(const PreciseVector& omega) {
    const PreciseInterval angle = length<Real>(omega);
    const PreciseMatrix cross = cross_matrix(omega);
    const PreciseMatrix squared = cross * cross;
    const PreciseInterval half_quotient = quotient_of_sine(angle / PreciseInterval(2));
    const PreciseInterval versine = square(half_quotient) / PreciseInterval(2);
    rotation = PreciseMatrix::identity() + cross * quotient_of_sine(angle) + squared * versine;
    jacobian = PreciseMatrix::identity() + cross * versine + squared * cubic_quotient(angle);
  }
  PreciseMatrix rotation;
  PreciseMatrix jacobian;
};

/// Rounded up.
double length_up(double a, double b, double c) {
  return length<double>(IntervalVector(Interval(a), Interval(b), Interval(c))).upper();
}

}  // namespace

RangeOfPoses::RangeOfPoses(const PoseRange& range, const Point& centre) {
  const RigidMotion start(range.start);
  start_rotation_ = start.rotation;
  start_centre_ = in_binary64(start(precise(centre)));
  const PreciseInterval angle = PreciseInterval(Real(range.rotation_degrees)) * half_turn() / PreciseInterval(180);
  for (std::size_t k = 0; k < 3; ++k) {
    ends_[k] = range.translation;
    ends_[3 + k] = in_binary64(angle).upper();
  }
}

// The parameters of the cell lie between the exact shares (2 i / 2^l - 1) of the ends. The centre is any number near
// their middle; the half-width `half_` covers all of them from it.
BoxOfPoses::BoxOfPoses(const RangeOfPoses& range, const PoseCell& cell) {
  std::array<double, pose_parameters> centre{};
  for (std::size_t k = 0; k < pose_parameters; ++k) {
    const auto share = [&](std::uint32_t index) { return std::ldexp(index, 1 - cell.level[k]) - 1.0; };  // exact
    const Interval end(range.end(k));
    const Interval low = end * Interval(share(cell.index[k]));
    const Interval high = end * Interval(share(cell.index[k] + 1));
    centre[k] = 0.5 * low.lower() + 0.5 * high.upper();
    half_[k] = std::max((high - Interval(centre[k])).upper(), (Interval(centre[k]) - low).upper());
  }
  const Exponential exponential(precise(Point{centre[3], centre[4], centre[5]}));
  rotation_ = in_binary64(exponential.rotation * range.start_rotation());
  inverse_ = rotation_.transpose();
  jacobian_transposed_ = in_binary64(exponential.jacobian.transpose());
  pivot_ = range.start_centre() + IntervalVector(Interval(centre[0]), Interval(centre[1]), Interval(centre[2]));
  moved_ = length_up(half_[0], half_[1], half_[2]);
  turned_ = length_up(half_[3], half_[4], half_[5]);
}

// x - c = R(1)^T (arm - δτ). Rotations along the line from the centre turn no faster than |δω|, so that R^T arm goes no
// farther than |δω| |arm|. Its second derivative is at most 3/2 |δω|² |arm|: its remainder is half of that. The
// remainder of R^T δτ is |R(1)^T δτ - R(0)^T δτ| <= |δω| |δτ|.
BoxOfPoses::Arm BoxOfPoses::arm(const Point& v) const {
  Arm result{IntervalVector(Interval(v[0]), Interval(v[1]), Interval(v[2])) - pivot_, {}, 0.0, 0.0};
  result.from_centre = inverse_ * result.from_pivot;
  const Interval length = verify::length<double>(result.from_pivot);
  const Interval moved(moved_);
  const Interval turned(turned_);
  result.reach = (moved + turned * length).upper();
  result.remainder = (turned * (Interval(0.75) * turned * length + moved)).upper();
  return result;
}

// n·R^T (arm - δτ) changes by -(R n)·δτ. If the implant turns by θ = J δω, it changes by (θ × R n)·arm = θ·(R n × arm).
PoseSlope BoxOfPoses::slope(const Arm& arm, const IntervalVector& turned) const {
  const IntervalVector by_rotation = jacobian_transposed_ * cross(turned, arm.from_pivot);
  return {-turned[0], -turned[1], -turned[2], by_rotation[0], by_rotation[1], by_rotation[2]};
}

double BoxOfPoses::range_up(const PoseSlope& slope) const {
  Interval sum(0);
  for (std::size_t k = 0; k < pose_parameters; ++k) sum += abs(slope[k]) * Interval(half_[k]);
  return sum.upper();
}

namespace {

/// The number of the finest cubes about the model's box.
constexpr double fine_cubes = 100000.0;
/// Share of the smallest semi-axis: finer cubes would hardly improve the bounds of so small a solid.
constexpr double finest_edge = 0.3;
/// The next size begins so many cubes beyond the box, and is larger by the factor `coarsening`.
constexpr double cubes_of_a_size = 6.0;
constexpr double coarsening = 3.5;
constexpr std::int32_t most_sizes = 60;
/// The largest distance from the surface, in cubes, at which balls are still sought that prove points too deep.
constexpr double ball_margin = 1.5;
/// Shares of a depth found in floating point: balls that touch the surface take long to prove.
constexpr std::array<double, 2> shares_of_depth{0.97, 0.8};
/// Depths of balls that are tried, as shares of the smallest semi-axis.
constexpr std::array<double, 3> tried_depths{0.5, 0.9, 1.5};
/// A factor that makes the length of a rounded unit vector less than 1.
constexpr double shortened = 1.0 - 0x1p-40;

/// The largest number of the finest cubes: long thin and flat models have coarser ones.
constexpr double most_cubes = 400000.0;

constexpr std::size_t shards = 64;

double dot(const Point& a, const Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Point sum(const Point& a, const Point& b, double share) {
  return {a[0] + share * b[0], a[1] + share * b[1], a[2] + share * b[2]};
}

double nearest(const Real& lower, const Real& upper) {
  return 0.5 * lower.to_double(Direction::down) + 0.5 * upper.to_double(Direction::up);
}

/// The middle, in floating point.
Point middle(const PreciseVector& v) {
  return {nearest(v[0].lower(), v[0].upper()), nearest(v[1].lower(), v[1].upper()),
          nearest(v[2].lower(), v[2].upper())};
}

struct Key {
  std::int32_t size;
  std::array<std::int32_t, 3> index;
  [[nodiscard]] bool operator==(const Key&) const = default;
};

struct KeyHash {
  [[nodiscard]] std::size_t operator()(const Key& key) const {
    std::uint64_t hash = static_cast<std::uint32_t>(key.size);
    for (const std::int32_t i : key.index) {
      hash = (hash ^ static_cast<std::uint32_t>(i)) * 0x9E3779B97F4A7C15U;
      hash ^= hash >> 29U;
    }
    return hash;
  }
};

}  // namespace

class SolidField::Cube {
 public:
  Point from_centre{};  ///< the cube's middle
  std::vector<ContainingHalfSpace> half_spaces;
  std::optional<std::size_t> close;  ///< the primitive whose surface is within the margin, or that the middle lies in
  std::once_flag ball_is_sought;
  std::optional<ContainedBall> ball;
};

struct SolidField::State {
  struct Shard {
    std::mutex mutex;
    std::unordered_map<Key, std::unique_ptr<Cube>, KeyHash> cubes;
  };

  /// A primitive's proposals in floating point.
  struct Proposer {
    NearestNormal nearest;
    std::array<Point, 3> rows;  ///< rows of its rotation
    Point origin;               ///< origin of its own frame, from the centre
    double smallest;            ///< semi-axis

    [[nodiscard]] Point local(const Point& from_centre) const {
      const Point x = sum(from_centre, origin, -1.0);
      Point q{};
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) q[i] += rows[j][i] * x[j];
      }
      return q;
    }
    [[nodiscard]] Point turned(const Point& v) const { return {dot(rows[0], v), dot(rows[1], v), dot(rows[2], v)}; }
  };

  State(const Model& model, const Point& middle_of_all) : centre(middle_of_all) {
    lower.fill(infinity);
    upper.fill(-infinity);
    double smallest = infinity;
    for (const Primitive& primitive : model.primitives) {
      const PosedSuperquadric& solid = solids.emplace_back(primitive);
      const RigidMotion& motion = solid.motion();
      proposers.push_back(
          {NearestNormal(primitive.superquadric),
           {middle(motion.rotation.row(0)), middle(motion.rotation.row(1)), middle(motion.rotation.row(2))},
           middle(PreciseVector(motion.translation - precise(centre))),
           std::ranges::min(primitive.superquadric.semi_axes)});
      smallest = std::min(smallest, proposers.back().smallest);
      const PreciseVector box = motion.rotation * solid.box() + motion.translation - precise(centre);
      for (std::size_t i = 0; i < 3; ++i) {
        lower[i] = std::min(lower[i], box[i].lower().to_double(Direction::down));
        upper[i] = std::max(upper[i], box[i].upper().to_double(Direction::up));
      }
    }
    const double volume = (upper[0] - lower[0]) * (upper[1] - lower[1]) * (upper[2] - lower[2]);
    edge = std::max({std::cbrt(volume / fine_cubes), finest_edge * smallest, std::numeric_limits<double>::min()});
    while (cubes_of(edge) > most_cubes) edge *= 1.2;
  }

  /// The number of cubes that lie in the box, or next to it.
  [[nodiscard]] double cubes_of(double length) const {
    double cubes = 1.0;
    for (std::size_t i = 0; i < 3; ++i) cubes *= (upper[i] - lower[i]) / length + 2.0 * cubes_of_a_size + 2.0;
    return cubes;
  }

  [[nodiscard]] double distance_to_box(const Point& x) const {
    double squared = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double beyond = std::max({lower[i] - x[i], x[i] - upper[i], 0.0});
      squared += beyond * beyond;
    }
    return std::sqrt(squared);
  }

  [[nodiscard]] Key key_of(const Point& x) const {
    Key key{0, {}};
    const double distance = distance_to_box(x);
    for (double reach = cubes_of_a_size * edge; distance > reach && key.size < most_sizes; reach *= coarsening)
      ++key.size;
    for (std::size_t i = 0; i < 3; ++i) {
      const double index = std::round((x[i] - lower[i]) / edge_of(key.size));
      if (std::isfinite(index)) key.index[i] = static_cast<std::int32_t>(std::clamp(index, -1e9, 1e9));
    }
    return key;
  }

  [[nodiscard]] double edge_of(std::int32_t size) const { return edge * std::pow(coarsening, size); }

  [[nodiscard]] std::unique_ptr<Cube> cube_of(const Key& key) const {
    auto cube = std::make_unique<Cube>();
    for (std::size_t i = 0; i < 3; ++i) cube->from_centre[i] = lower[i] + key.index[i] * edge_of(key.size);
    double least = ball_margin * edge;
    for (std::size_t k = 0; k < solids.size(); ++k) {
      const NearestNormal::Found found = proposers[k].nearest(proposers[k].local(cube->from_centre));
      cube->half_spaces.push_back(half_space(k, proposers[k].turned(found.normal)));
      if (key.size > 0 || found.distance >= least) continue;
      least = found.distance;
      cube->close = k;
    }
    return cube;
  }

  /// {x : n·x <= h(R^T n) + n·t} contains the primitive, h its support function and t the origin of its own frame.
  [[nodiscard]] ContainingHalfSpace half_space(std::size_t k, const Point& proposed) const {
    const ContainingHalfSpace nothing{{}, -infinity};
    const Point n{shortened * proposed[0], shortened * proposed[1], shortened * proposed[2]};
    if (!usable({n[0], n[1], n[2]})) return nothing;
    const PreciseVector normal = precise(n);
    if (!(normal.dot(normal).upper() <= Real(1))) return nothing;
    const RigidMotion& motion = solids[k].motion();
    const PreciseVector own = motion.rotation.transpose() * normal;
    const PreciseInterval offset = normal.dot(motion.translation) + PreciseInterval(solids[k].bounds().support_up(own));
    return {n, (normal.dot(precise(centre)) - offset).lower().to_double(Direction::down)};
  }

  /// About a place near the surface the best balls touch the surface where it is nearest to the place, and are as large
  /// as possible. The search tries candidates.
  [[nodiscard]] std::optional<ContainedBall> ball_of(const Cube& cube) const {
    if (!cube.close) return std::nullopt;
    const Proposer& proposer = proposers[*cube.close];
    const Point q = proposer.local(cube.from_centre);
    const NearestNormal::Found found = proposer.nearest(q);
    std::vector<std::pair<double, ContainedBall>> candidates;
    const auto consider = [&](double depth) {
      const Point local = sum(q, found.normal, -(found.distance + depth));
      const double radius = -proposer.nearest(local).distance;
      if (!(radius > 0.0) || !std::isfinite(found.distance)) return;
      const Point moved = proposer.turned(local);
      const Point ball = sum(sum(moved, proposer.origin, 1.0), centre, 1.0);
      candidates.push_back({std::fabs(found.distance + depth) - radius, {ball, radius}});
    };
    for (const double share : tried_depths) {
      if (share * proposer.smallest > -found.distance) consider(share * proposer.smallest);
    }
    if (found.distance < 0.0) consider(-found.distance);
    std::ranges::sort(candidates, {}, &std::pair<double, ContainedBall>::first);
    for (const auto& [reach, ball] : candidates) {
      for (const double share : shares_of_depth) {
        if (solids[*cube.close].contains_ball_about(ball.centre, share * ball.radius))
          return ContainedBall{ball.centre, share * ball.radius};
      }
    }
    return std::nullopt;
  }

  Point centre;
  std::vector<PosedSuperquadric> solids;
  std::vector<Proposer> proposers;
  Point lower{}, upper{};  ///< corners of the model's box, from the centre
  double edge;             ///< edge of the finest cubes
  mutable std::array<Shard, shards> all;
};

SolidField::SolidField(const Model& model, const Point& centre) : state_(hidden<State>(model, centre)) {}

const Point& SolidField::centre() const {
  return state_->centre;
}

SolidField::Cube& SolidField::near(const Point& from_centre) const {
  const Key key = state_->key_of(from_centre);
  State::Shard& shard = state_->all[KeyHash{}(key) % shards];
  const std::lock_guard lock(shard.mutex);
  std::unique_ptr<Cube>& cube = shard.cubes[key];
  if (!cube) cube = state_->cube_of(key);
  return *cube;
}

std::span<const ContainingHalfSpace> SolidField::half_spaces(const Cube& cube) {
  return cube.half_spaces;
}

const std::optional<ContainedBall>& SolidField::ball(Cube& cube) const {
  std::call_once(cube.ball_is_sought, [&] { cube.ball = state_->ball_of(cube); });
  return cube.ball;
}

}  // namespace verisq::verify
