/// This file implements volume_in_cube.hpp.
#include "verify/proof/volume_in_cube.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "verify/numbers/functions.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/numbers/vector.hpp"
#include "verify/proof/posed_superquadric.hpp"

namespace verisq::verify {
namespace {

/// A limit so that no cube costs more than a moment: a cube that needs more tetrahedra is bounded by nothing or all of
/// it.
constexpr std::size_t most_tetrahedra = 4096;
/// Cuts lie by this share before the place where the function vanishes: on this side of it, whatever the rounding.
constexpr double just_short = 1.0 - 0x1p-48;

struct Tetrahedron {
  Interval volume;
  std::array<std::uint32_t, 4> corners;
};

/// The wanted tetrahedra: those that surely lie in a set, or those that may.
enum class Wanted : std::uint8_t { surely, maybe };

/// Cuts the cube at functions until each tetrahedron surely lies in the set, surely does not, or is thin.
class Dissection {
 public:
  Dissection(double half_width, Wanted wanted) : half_width_(half_width), wanted_(wanted) {}

  /// A bound from below of `surely`, from above of `maybe`.
  double operator()(const PartOfCube& part) {
    if (!take_what_matters(part)) return 0.0;
    cut_cube_into_six();
    for (const auto& [first, last] : unions_) {
      if (!keep_union(first, last)) return wanted_ == Wanted::surely ? 0.0 : volume_of_cube(half_width_).upper();
    }
    return volume();
  }

 private:
  enum class Place : std::uint8_t { before, on, beyond };
  struct Piece {
    Tetrahedron tetrahedron;
    std::array<Place, 4> places;
  };

  /// If this is not positive, a point is surely in the part (`surely`), or surely not in its interior (`maybe`).
  [[nodiscard]] double decisive(const Interval& height) const {
    return wanted_ == Wanted::surely ? height.upper() : -height.lower();
  }

  /// Drops functions that are decided for the whole cube: they need no cuts. False if the set is empty.
  bool take_what_matters(const PartOfCube& part) {
    for (const UnionOfParts& whole : part) {
      const std::size_t first = functions_.size();
      bool all = false;
      for (const CornerHeights& heights : whole) {
        const auto decided =
            std::ranges::count_if(heights, [&](const Interval& height) { return decisive(height) <= 0.0; });
        const bool holds_all = wanted_ == Wanted::surely ? decided == 8 : decided == 0;
        const bool holds_nothing = wanted_ == Wanted::surely ? decided == 0 : decided == 8;
        all = all || holds_all;
        if (!holds_nothing) functions_.push_back(&heights);
      }
      if (all) {
        functions_.resize(first);
        continue;
      }
      if (functions_.size() == first) return false;
      unions_.emplace_back(first, functions_.size());
    }
    return true;
  }

  /// Tetrahedra from the corner 0 to the corner 7 along the axes, in each order of the axes.
  void cut_cube_into_six() {
    for (std::size_t corner = 0; corner < 8; ++corner)
      for (const CornerHeights* function : functions_) heights_.push_back((*function)[corner]);
    const Interval sixth = volume_of_cube(half_width_) / Interval(6);
    std::array<std::uint32_t, 3> axes{0, 1, 2};
    do {
      const std::uint32_t first = 1U << axes[0];
      tetrahedra_.push_back({sixth, {0, first, first | 1U << axes[1], 7}});
    } while (std::ranges::next_permutation(axes).found);
  }

  /// Keeps the part of each tetrahedron that lies in one of the parts. False if that takes too many tetrahedra.
  bool keep_union(std::size_t first, std::size_t last) {
    std::vector<Tetrahedron> kept;
    std::vector<Tetrahedron> rest = std::move(tetrahedra_);
    for (std::size_t function = first; function < last; ++function) {
      std::vector<Tetrahedron> decided;
      std::vector<Tetrahedron> others;
      for (const Tetrahedron& whole : rest) split(whole, function, decided, others);
      if (wanted_ == Wanted::maybe) std::swap(decided, others);
      kept.insert(kept.end(), decided.begin(), decided.end());
      rest = std::move(others);
      if (kept.size() + rest.size() > most_tetrahedra) return false;
    }
    tetrahedra_ = std::move(kept);
    return true;
  }

  [[nodiscard]] const Interval& height(std::uint32_t corner, std::size_t function) const {
    return heights_[corner * functions_.size() + function];
  }

  /// Splits into tetrahedra whose corners are all decided, where a linear function is decided everywhere, and others.
  void split(const Tetrahedron& whole, std::size_t function, std::vector<Tetrahedron>& decided,
             std::vector<Tetrahedron>& others) {
    Piece start{whole, {}};
    for (std::size_t k = 0; k < 4; ++k) {
      start.places[k] = decisive(height(whole.corners[k], function)) <= 0.0 ? Place::before : Place::beyond;
    }
    pieces_.assign(1, start);
    while (!pieces_.empty()) {
      Piece piece = pieces_.back();
      pieces_.pop_back();
      const auto* const before = std::ranges::find(piece.places, Place::before);
      const auto* const beyond = std::ranges::find(piece.places, Place::beyond);
      if (beyond == piece.places.end()) {
        decided.push_back(piece.tetrahedron);
      } else if (before == piece.places.end()) {
        others.push_back(piece.tetrahedron);
      } else {
        cut(piece, static_cast<std::size_t>(before - piece.places.begin()),
            static_cast<std::size_t>(beyond - piece.places.begin()), function);
      }
    }
  }

  /// Cuts at a decided point of the edge from a decided corner, as near as possible to the place where the function
  /// vanishes. Does not cut if that is the corner itself.
  void cut(Piece& piece, std::size_t from, std::size_t to, std::size_t function) {
    const std::uint32_t a = piece.tetrahedron.corners[from];
    const std::uint32_t b = piece.tetrahedron.corners[to];
    const double at_a = decisive(height(a, function));
    const double share = just_short * (at_a / (at_a - decisive(height(b, function))));
    if (!(share > 0.0 && share < 1.0) || !add_corner(a, b, share, function)) {
      piece.places[from] = Place::on;
      pieces_.push_back(piece);
      return;
    }
    const auto corner = static_cast<std::uint32_t>(heights_.size() / functions_.size() - 1);
    const Interval s(share);
    Piece near = piece;
    near.tetrahedron.corners[to] = corner;
    near.tetrahedron.volume = piece.tetrahedron.volume * s;
    near.places[to] = Place::on;
    piece.tetrahedron.corners[from] = corner;
    piece.tetrahedron.volume = piece.tetrahedron.volume * (Interval(1) - s);
    piece.places[from] = Place::on;
    pieces_.push_back(near);
    pieces_.push_back(piece);
  }

  /// False, and none, where it is not decided.
  bool add_corner(std::uint32_t a, std::uint32_t b, double share, std::size_t function) {
    const Interval s(share);
    const Interval rest = Interval(1) - s;
    const auto between = [&](std::size_t k) { return rest * height(a, k) + s * height(b, k); };
    if (!(decisive(between(function)) <= 0.0)) return false;
    for (std::size_t k = 0; k < functions_.size(); ++k) heights_.push_back(between(k));
    return true;
  }

  [[nodiscard]] double volume() const {
    double sum = 0.0;
    for (const Tetrahedron& tetrahedron : tetrahedra_) {
      const Interval& volume = tetrahedron.volume;
      sum = wanted_ == Wanted::surely ? add(sum, volume.lower(), Direction::down)
                                      : add(sum, volume.upper(), Direction::up);
    }
    return sum;
  }

  double half_width_;
  Wanted wanted_;
  std::vector<const CornerHeights*> functions_;              // those of one union after those of the other
  std::vector<std::pair<std::size_t, std::size_t>> unions_;  // first and last + 1 of them
  std::vector<Interval> heights_;                            // of each corner the values of all functions
  std::vector<Tetrahedron> tetrahedra_;
  std::vector<Piece> pieces_;  // of one tetrahedron, kept to save allocations
};

}  // namespace

CornerHeights linear_heights(const Interval& at_centre, const Vector3<double>& rise) {
  CornerHeights heights;
  for (std::size_t k = 0; k < 8; ++k) {
    heights[k] = at_centre;
    for (std::size_t i = 0; i < 3; ++i) heights[k] += (k >> i & 1U) != 0 ? rise[i] : -rise[i];
  }
  return heights;
}

CornerHeights negative(const CornerHeights& heights) {
  CornerHeights result;
  std::ranges::transform(heights, result.begin(), [](const Interval& height) { return -height; });
  return result;
}

void leave_nothing(BracketedPart& part) {
  part.inner.emplace_back();
  part.outer.emplace_back();
}

void leave_unknown(BracketedPart& part) {
  part.inner.emplace_back();
}

Interval volume_of_cube(double half_width) {
  const Interval edge = Interval(2) * Interval(half_width);
  return edge * edge * edge;
}

Enclosure volume_in_cube(double half_width, const BracketedPart& part) {
  const double all = volume_of_cube(half_width).upper();
  return {std::max(0.0, Dissection(half_width, Wanted::surely)(part.inner)),
          std::min(all, Dissection(half_width, Wanted::maybe)(part.outer))};
}

namespace {

using Eigen::Vector3d;

/// All points of the cube.
Vector3<double> range_of(const Cube& cube) {
  const Interval about(-cube.half_width, cube.half_width);
  return exact_vector(cube.centre) + Vector3<double>(about, about, about);
}

Vector3<double> corner_of(const Cube& cube, std::size_t k) {
  Vector3<double> corner = exact_vector(cube.centre);
  for (std::size_t i = 0; i < 3; ++i) corner[i] += Interval((k >> i & 1U) != 0 ? cube.half_width : -cube.half_width);
  return corner;
}

/// Exactly.
PreciseVector in_127_bits(const Vector3<double>& v) {
  PreciseVector result;
  for (std::size_t i = 0; i < 3; ++i) result[i] = {Real(v[i].lower()), Real(v[i].upper())};
  return result;
}

/// The smaller value at each corner.
void lower(CornerHeights& heights, const CornerHeights& others) {
  for (std::size_t k = 0; k < 8; ++k) heights[k] = Interval(std::min(heights[k].lower(), others[k].lower()));
}

bool all_positive(const CornerHeights& heights) {
  return std::ranges::all_of(heights, [](const Interval& height) { return height.lower() > 0.0; });
}

}  // namespace

/// The primitive at one time: from its own frame to that of the bone.
struct SweptPrimitive::Placement {
  Matrix3<double> rotation;
  Vector3<double> origin;
};

/// A plane that moves with the primitive, which lies behind it, during a part of a leg.
struct SweptPrimitive::Facing {
  PartOfLeg times;
  CornerHeights heights;  ///< the swept part of the cube lies where the heights are not positive
  double sag;             ///< the amount by which they were lowered, for the plane's motion between begin and end
  double time;            ///< when the gauge at the cube's centre is least, about
  double gauge;           ///< about the gauge at the centre at that time
};

/// Returns whether the plane excludes nothing of the cube, however short its part of a leg is. Approximate: it proposes
/// which parts need no halving.
bool SweptPrimitive::is_beyond_nothing(const Facing& deepest) {
  return std::ranges::all_of(deepest.heights, [&](const Interval& h) { return h.lower() + deepest.sag <= 0.0; });
}

/// Returns whether the plane admits little more than the deepest one, however short that one's part is. Approximate,
/// too.
bool SweptPrimitive::is_above(const Facing& other, const Facing& deepest, double allowed) {
  for (std::size_t k = 0; k < 8; ++k) {
    if (other.heights[k].lower() < deepest.heights[k].lower() + deepest.sag - allowed) return false;
  }
  return true;
}

SweptPrimitive::SweptPrimitive(const Primitive& primitive, const EnclosedPath& path)
    : path_(path),
      bounds_(primitive.superquadric),
      smallest_semi_axis_(std::ranges::min(primitive.superquadric.semi_axes)),
      gauge_(NormFunction<double>::gauge(primitive.superquadric)) {
  const PosedSuperquadric posed(primitive);
  rotation_ = in_binary64(posed.motion().rotation);
  translation_ = in_binary64(posed.motion().translation);
  radius_ = in_binary64(posed.radius());
}

std::vector<PartOfLeg> SweptPrimitive::whole_path() const {
  std::vector<PartOfLeg> whole;
  for (std::uint32_t leg = 0; leg < path_.legs(); ++leg) whole.push_back({leg, 0.0, 1.0});
  return whole;
}

// The origin moves on a curve with |x''| <= |w|² |R p|: no farther from its chord than an eighth of that.
std::array<Interval, 3> SweptPrimitive::box() const {
  std::array<Interval, 3> box;
  for (std::uint32_t leg = 0; leg < path_.legs(); ++leg) {
    const Interval bow = square(length<double>(path_.motion(leg).spin)) * length<double>(translation_) / Interval(8);
    const double about = (radius_ + bow).upper();
    const Vector3<double> begin = placement(leg, 0.0).origin;
    const Vector3<double> end = placement(leg, 1.0).origin;
    for (std::size_t i = 0; i < 3; ++i) {
      const Interval reached = hull(begin[i], end[i]) + Interval(-about, about);
      box[i] = leg == 0 ? reached : hull(box[i], reached);
    }
  }
  return box;
}

SweptPrimitive::Placement SweptPrimitive::placement(std::uint32_t leg, double time) const {
  const EnclosedPose at = path_.pose(leg, time);
  return {at.rotation * rotation_, at.rotation * translation_ + at.translation};
}

MovingGauge SweptPrimitive::moving_gauge(std::uint32_t leg) const {
  return {gauge_, {rotation_, translation_}, path_.pose(leg, 0.0), path_.motion(leg)};
}

/// Let y = R^T (x - t) be the place of a point x of the cube in the implant's frame, and v a vector of length 1 of that
/// frame. Then |(v·y)''| <= |w|² |x - t| + 2 |w| |t'|. Between two times, v·y lies above its chord minus an eighth of
/// that bound times the square of the time between. Precondition: the leg turns.
double SweptPrimitive::sag(const Cube& cube, const PartOfLeg& times) const {
  const EnclosedMotion& motion = path_.motion(times.leg);
  const Interval spin = length<double>(motion.spin);
  const Interval speed = length<double>(motion.velocity);
  const Interval lasts = Interval(times.end) - Interval(times.begin);
  const Interval distance = length<double>(range_of(cube) - path_.pose(times.leg, times.begin).translation);
  const Interval bend = square(spin) * (distance + speed * lasts) + Interval(2) * spin * speed;
  return (square(lasts) * bend / Interval(8)).upper();
}

/// The plane goes through the support point of v, which moves with the primitive: v·z <= h(v) for all points z of the
/// primitive. For a point of the cube v·z is linear in the point at each time.
SweptPrimitive::Facing SweptPrimitive::facing(const Cube& cube, const PartOfLeg& times) const {
  const MovingGauge moving = moving_gauge(times.leg);
  const Vector3d centre(cube.centre[0], cube.centre[1], cube.centre[2]);
  Facing result{times, {}, 0.0, 0.0, 0.0};
  result.time = moving.nearest_time(times.begin, times.end, centre);
  const MovingGauge::Slope slope = moving.slope(result.time, centre);
  result.gauge = slope.value;
  const bool is_between = times.begin < result.time && result.time < times.end;
  const Vector3d own = moving.own_direction(result.time, moving.normal(result.time, is_between, slope, centre));
  const Vector3<double> v = exact_vector({own[0], own[1], own[2]});

  if (path_.motion(times.leg).turns) result.sag = (Interval(sag(cube, times)) * length<double>(v)).upper();
  const Interval below = Interval(bounds_.support_up(in_127_bits(v)).to_double(Direction::up)) + Interval(result.sag);
  for (const double time : {times.begin, times.end}) {
    const Placement at = placement(times.leg, time);
    const Vector3<double> normal = at.rotation * v;
    const Interval at_centre = normal.dot(exact_vector(cube.centre) - at.origin) - below;
    const CornerHeights heights = linear_heights(at_centre, normal * Interval(cube.half_width));
    if (time == times.begin) result.heights = heights;
    lower(result.heights, heights);
  }
  return result;
}

/// Parts of legs are halved if the motion of their planes in between decides, beside the square of the cube.
SweptPrimitive::InCube SweptPrimitive::in(const Cube& cube, std::span<const PartOfLeg> times,
                                          const std::function<bool()>& interrupted) const {
  const double allowed = cube.half_width * std::min(1.0, cube.half_width / smallest_semi_axis_) / 8.0;
  std::vector<Facing> open;
  std::vector<PartOfLeg> next(times.begin(), times.end());
  while (!next.empty()) {
    for (const PartOfLeg& part : next) {
      if (interrupted()) return {};
      Facing found = facing(cube, part);
      if (!all_positive(found.heights)) open.push_back(std::move(found));
    }
    next.clear();
    if (open.empty()) return {};
    const Facing deepest = *std::ranges::min_element(open, {}, &Facing::gauge);
    if (is_beyond_nothing(deepest)) break;
    std::erase_if(open, [&](const Facing& other) {
      const bool decides = other.sag > allowed && !is_above(other, deepest, allowed);
      const std::optional<double> half = decides ? middle_of(other.times) : std::nullopt;
      if (!half) return false;
      next.push_back({other.times.leg, other.times.begin, *half});
      next.push_back({other.times.leg, *half, other.times.end});
      return true;
    });
  }
  const Facing& deepest = *std::ranges::min_element(open, {}, &Facing::gauge);
  InCube result{.times = {}, .outer = deepest.heights, .deepest = {deepest.times.leg, deepest.time}};
  for (const Facing& found : open) {
    lower(result.outer, found.heights);
    result.times.push_back(found.times);
  }
  return result;
}

CornerHeights SweptPrimitive::inner(const Cube& cube, const Moment& moment) const {
  const auto& [leg, time] = moment;
  const double step = path_.step();
  const bool turns = path_.motion(leg).turns;
  const Placement at = placement(leg, turns ? std::clamp(std::round(time / step) * step, 0.0, 1.0) : time);
  const Matrix3<double> to_own = at.rotation.transpose();
  CornerHeights heights;
  for (std::size_t k = 0; k < 8; ++k) {
    const Real gauge = bounds_.gauge_up(in_127_bits(to_own * (corner_of(cube, k) - at.origin)));
    heights[k] = Interval(subtract(gauge.to_double(Direction::up), 1.0, Direction::up));
  }
  return heights;
}

/// The middle; nothing if the part cannot be halved at a time at which the path is known.
std::optional<double> SweptPrimitive::middle_of(const PartOfLeg& times) const {
  const double middle = std::round((times.begin + times.end) / (2.0 * path_.step())) * path_.step();
  if (!(times.begin < middle && middle < times.end)) return std::nullopt;
  return middle;
}

}  // namespace verisq::verify
