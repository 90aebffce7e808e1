/// This file implements way_checker.hpp.
#include "verify/proof/way_checker.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>
#include <verisq/error.hpp>

#include "verify/numbers/points.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/proof/posed_superquadric.hpp"
#include "verify/proof/triangle_piece.hpp"
#include "verify/proof/verdict.hpp"
#include "verify/solids/model.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/distance.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/insertion.hpp"

namespace verisq {

using verify::RigidPath;

struct InsertionChecker::State {
  State(const Model& model, std::span<const Pose> poses) : implant(model), path(poses, verify::seat_of(model, poses)) {}

  /// The lower end; nothing is proven unless the parts follow each other from the first time to the last.
  [[nodiscard]] double lower(const Point& point, double asked, const InsertionCertificate& certificate,
                             const verify::Hook& interrupted) const {
    double least = infinity;
    verify::Moment begin = verify::moment_of(path, point, 0.0);
    for (std::size_t k = 0; k < certificate.parts.size(); ++k) {
      const WayPart& part = certificate.parts[k];
      if (interrupted && interrupted()) return -infinity;
      const bool all_at_rest = k == 0 && part.until == 0.0;
      if (!(part.until > begin.time || all_at_rest) || !(part.until <= path.last_time())) return -infinity;
      const verify::Moment end = verify::moment_of(path, point, part.until);
      const verify::Chord chord = verify::chord_of(path, point, begin, end);
      least = std::min(least, verify::lower_end(implant, chord, part, asked));
      if (least == -infinity) return least;
      begin = end;
    }
    return !certificate.parts.empty() && begin.time == path.last_time() ? least : -infinity;
  }

  [[nodiscard]] double upper(const Point& point, double asked, const InsertionCertificate& certificate,
                             const verify::Hook& interrupted) const {
    const double time = certificate.deepest;
    if (!(time >= 0.0 && time <= path.last_time())) return infinity;
    return verify::upper_end(implant, verify::moment_of(path, point, time).place, asked, certificate.at_deepest,
                             interrupted);
  }

  Checker implant;
  RigidPath path;
};

InsertionChecker::InsertionChecker(const Model& implant, std::span<const Pose> path) {
  verify::require_valid(implant);  // the path's seat is that of superquadrics
  check_path(path);
  state_ = hidden<State>(implant, path);
}

Finding InsertionChecker::operator()(const Point& point, const Enclosure& claimed,
                                     const InsertionCertificate& certificate,
                                     const std::function<bool()>& interrupted) const {
  const Enclosure proven = verify::between(state_->lower(point, claimed.lo, certificate, interrupted),
                                           state_->upper(point, claimed.hi, certificate, interrupted), [&] {
                                             return "the smallest distance on the way of " + verify::text_of(point);
                                           });
  return verify::judged(claimed, proven, proven);
}

using verify::Direction;
using verify::PointBall;
using verify::RigidPath;

namespace {

/// The number of triangles between two reports of progress.
constexpr std::size_t triangles_at_a_time = 64;

const Model& required_union(const Model& model) {
  verify::require_union_of_convex(model, "certificates of whole surfaces along a way in");
  return model;
}

/// Each once, and in their order; and not too many cells.
bool is_in_order(const std::vector<WayTriangle>& proofs, std::size_t triangles) {
  std::size_t next = 0;
  std::size_t cells = 0;
  for (const WayTriangle& proof : proofs) {
    if (proof.triangle < next || proof.triangle >= triangles) return false;
    next = std::size_t{proof.triangle} + 1;
    if (proof.cells.size() > most_cells_of_way_surface - cells) return false;
    cells += proof.cells.size();
  }
  return true;
}

}  // namespace

struct WaySurfaceChecker::State {
  State(const Model& model, std::span<const Pose> poses, const Mesh& mesh)
      : bone(mesh),
        implant(required_union(model)),
        solids(verify::solids_of(model)),
        path(poses, verify::seat_of(model, poses)) {}

  /// The lower bound that the vertices give for each triangle.
  [[nodiscard]] std::vector<double> least_by_vertices(std::span<const Enclosure> of_vertices) const {
    std::vector<double> least(bone.triangles.size());
    for (std::size_t n = 0; n < least.size(); ++n)
      least[n] = verify::least_on(verify::triangle_of(bone, n), verify::lower_ends(bone, n, of_vertices));
    return least;
  }

  [[nodiscard]] double lower(std::span<const Enclosure> of_vertices, const WaySurfaceCertificate& certificate,
                             const CheckOptions& options) const {
    const std::vector<WayTriangle>& proofs = certificate.triangles;
    if (!is_in_order(proofs, bone.triangles.size())) return -infinity;
    std::vector<double> least = least_by_vertices(of_vertices);
    std::atomic<bool> is_whole{true};
    for (std::size_t first = 0; first < proofs.size() && is_whole; first += triangles_at_a_time) {
      const std::size_t now = std::min(triangles_at_a_time, proofs.size() - first);
      options.in_parallel(now, [&](std::size_t i) {
        const WayTriangle& proof = proofs[first + i];
        const std::size_t n = proof.triangle;
        if (options.interrupted()) {
          is_whole = false;
        } else {
          const auto at_vertices = verify::lower_ends(bone, n, of_vertices);
          least[n] = std::max(least[n], verify::least_on(path, solids, verify::triangle_of(bone, n), at_vertices, proof,
                                                         options.interrupted));
        }
      });
      options.progress(static_cast<double>(first + now) / static_cast<double>(proofs.size()));
    }
    return is_whole ? std::ranges::min(least) : -infinity;
  }

  [[nodiscard]] double upper_by(const WayWitness& witness, double asked, const verify::Hook& interrupted) const {
    const auto& [triangle, weights, time, certificate] = witness;
    if (triangle >= bone.triangles.size() || !verify::in_triangle(weights)) return infinity;
    if (!(time >= 0.0 && time <= path.last_time())) return infinity;
    const auto& [a, b, c] = verify::triangle_of(bone, triangle);
    const verify::PreciseVector exact =
        verify::point_of({verify::precise(a), verify::precise(b), verify::precise(c)}, weights);
    const verify::Proposal middle = verify::midpoint(exact);
    const Point near{static_cast<double>(middle[0]), static_cast<double>(middle[1]), static_cast<double>(middle[2])};
    if (!verify::is_finite(near)) return infinity;
    // Motions keep distances: the exact point is seen no farther from the near one than it is.
    const double off = verify::length<verify::Real>(verify::PreciseVector(exact - verify::precise(near)))
                           .upper()
                           .to_double(Direction::up);
    PointBall place = verify::moment_of(path, near, time).place;
    place.radius = verify::add(place.radius, off, Direction::up);
    return verify::upper_end(implant, place, asked, certificate, interrupted);
  }

  [[nodiscard]] double upper(std::span<const Enclosure> of_vertices, double asked,
                             const WaySurfaceCertificate& certificate, const verify::Hook& interrupted) const {
    const double by_vertices = verify::least_upper_end(bone, of_vertices);
    return certificate.deepest ? std::min(by_vertices, upper_by(*certificate.deepest, asked, interrupted))
                               : by_vertices;
  }

  const Mesh& bone;
  Checker implant;
  std::vector<verify::PosedSuperquadric> solids;
  RigidPath path;
};

WaySurfaceChecker::WaySurfaceChecker(const Model& implant, std::span<const Pose> path, const Mesh& bone) {
  check_path(path);
  if (bone.triangles.empty()) throw Error(ErrorKind::input, "the mesh has no triangles");
  state_ = hidden<State>(implant, path, bone);
}

Finding WaySurfaceChecker::operator()(std::span<const Enclosure> of_vertices, const Enclosure& claimed,
                                      const WaySurfaceCertificate& certificate, const CheckOptions& options) const {
  const Enclosure proven = verify::between(state_->lower(of_vertices, certificate, options),
                                           state_->upper(of_vertices, claimed.hi, certificate, options.interrupted),
                                           [] { return "the smallest distance of the whole surface on the way"; });
  return verify::judged(claimed, proven, proven);
}

void check_path(std::span<const Pose> path) {
  if (path.empty()) throw Error(ErrorKind::input, "the path has no pose");
  for (std::size_t k = 0; k < path.size(); ++k) {
    const Point& t = path[k].translation;
    const auto& q = path[k].quaternion;
    const auto refuse = [&](const char* why) {
      throw Error(ErrorKind::input, fmt::format("pose {} of the path, ({}, {}, {}), quaternion ({}, {}, {}, {}), {}", k,
                                                t[0], t[1], t[2], q[0], q[1], q[2], q[3], why));
    };
    const auto finite = [](double c) { return std::isfinite(c); };
    if (!std::ranges::all_of(t, finite) || !std::ranges::all_of(q, finite)) refuse("is not finite");
    if (std::ranges::all_of(q, [](double c) { return c == 0.0; })) refuse("has a zero quaternion");
  }
}

void check_turns(std::span<const Pose> path) {
  constexpr double nearly = 1e-9;
  for (std::size_t k = 1; k < path.size(); ++k) {
    if (!(cosine_of_half_turn(path[k - 1], path[k]) <= nearly)) continue;
    throw Error(ErrorKind::input,
                fmt::format("pose {} of the path is half a turn from the one before, which has two ways: put a pose "
                            "between them",
                            k));
  }
}

double cosine_of_half_turn(const Pose& from, const Pose& to) {
  const auto p = verify::near_one(from.quaternion);
  const auto q = verify::near_one(to.quaternion);
  const double lengths = std::hypot(std::hypot(p[0], p[1]), std::hypot(p[2], p[3])) *
                         std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3]));
  return std::min(std::abs(p[0] * q[0] + p[1] * q[1] + p[2] * q[2] + p[3] * q[3]) / lengths, 1.0);
}

}  // namespace verisq

namespace verisq::verify {
namespace {

double distance_down(const Point& x, const Point& y) {
  return length<Real>(PreciseVector(precise(x) - precise(y))).lower().to_double(Direction::down);
}

double sum_up(double a, double b) {
  return add(a, b, Direction::up);
}

/// The largest possible distance of a point of the ball from `x`.
double farthest(const PointBall& ball, const Point& x) {
  return sum_up(distance_up(ball.centre, x), ball.radius);
}

}  // namespace

Point seat_of(const Model& implant, std::span<const Pose> path) {
  const Point seat = implant.primitives.empty() ? Point{} : implant.primitives.front().pose.translation;
  return posed(seat, path.back());
}

Moment moment_of(const RigidPath& path, const Point& c, double time) {
  return {time, RigidPath::local_point(path.nearest_pose(time), c)};
}

bool is_finite(const PointBall& ball) {
  return is_finite(ball.centre) && std::isfinite(ball.radius);
}

Chord chord_of(const RigidPath& path, const Point& c, const Moment& begin, const Moment& end) {
  const PointBall& a = begin.place;
  const PointBall& b = end.place;
  const double way = path.length_up(c, begin.time, end.time);
  if (!is_finite(a) || !is_finite(b) || !std::isfinite(way)) return {begin, end, infinity};
  const double apart = subtract(distance_down(a.centre, b.centre), sum_up(a.radius, b.radius), Direction::down);
  const double chord = std::clamp(apart, 0.0, way);
  // (L - l) (L + l): only the first factor is rounded by a large share of itself.
  const double product = multiply(subtract(way, chord, Direction::up), sum_up(way, chord), Direction::up);
  return {begin, end, multiply(0.5, square_root(product, Direction::up), Direction::up)};
}

// A point of the way is at most the bulge off a point x of the straight line from `begin` to `end`. Consider the point
// of the segment that divides it alike: x is no farther from it than the farther of the ends from the segment's end.
double offset_of(const Chord& chord, const std::array<Point, 2>& segment) {
  const auto& [first, last] = segment;
  if (!std::isfinite(chord.bulge) || !is_finite(first) || !is_finite(last)) return infinity;
  return sum_up(chord.bulge, std::max(farthest(chord.begin.place, first), farthest(chord.end.place, last)));
}

// All points of the segment are outside, and at least as far as the segment. The signed distance changes by no more
// than a point moves.
double lower_end(const Checker& implant, const Chord& chord, const WayPart& part, double asked) {
  const double offset = offset_of(chord, part.segment);
  if (!std::isfinite(offset)) return -infinity;
  const auto& [first, last] = part.segment;
  const double far = std::max(sum_up(asked, offset), std::numeric_limits<double>::denorm_min());
  const double proven = implant(Triangle{first, last, last}, {far, infinity}, part.certificate).proven.lo;
  return proven > 0.0 ? subtract(proven, offset, Direction::down) : -infinity;
}

double upper_end(const Checker& implant, const PointBall& place, double asked, const Certificate& certificate,
                 const Hook& interrupted) {
  if (!is_finite(place)) return infinity;
  const double of_centre = subtract(asked, place.radius, Direction::down);
  const double proven = implant(place.centre, {-infinity, of_centre}, certificate, interrupted).proven.hi;
  return sum_up(proven, place.radius);
}

namespace {

Point sum(const Point& a, const Point& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

bool are_finite(const Triangle& corners) {
  return std::ranges::all_of(corners, [](const Point& corner) { return is_finite(corner); });
}

/// {v·x <= h(v)} contains the solid, and the hull of both triangles lies beyond it by as much as the nearer triangle: v
/// is the same for both.
double beyond(const PosedSuperquadric& solid, const PosedTriangle& begin, const PosedTriangle& end, const Proposal& v) {
  return std::min(lower_by_normal(solid, begin, v), lower_by_normal(solid, end, v));
}

/// A lower bound of the distance between the solid and the hull.
double distance_of(const PosedSuperquadric& solid, const MovedPrism& hull, std::size_t index,
                   std::span<const Normal> normals) {
  const PosedTriangle begin(hull.begin, solid.motion());
  const PosedTriangle end(hull.end, solid.motion());
  double best = -infinity;
  bool has_own = false;
  for (const auto& [primitive, v] : normals) {
    if (primitive != index) continue;
    has_own = true;
    best = std::max(best, beyond(solid, begin, end, {v[0], v[1], v[2]}));
  }
  return has_own ? best : beyond(solid, begin, end, outward_normal(solid, hull));
}

}  // namespace

std::vector<PosedSuperquadric> solids_of(const Model& model) {
  std::vector<PosedSuperquadric> solids;
  for (const Primitive& primitive : model.primitives) solids.emplace_back(primitive);
  return solids;
}

MovedPrism moved(const WayPrism& prism, const Point& step) {
  MovedPrism hull{};
  for (std::size_t i = 0; i < 3; ++i) {
    hull.begin[i] = sum(prism.corners[i].begin.place.centre, step);
    hull.end[i] = sum(prism.corners[i].end.place.centre, step);
  }
  return hull;
}

// A point of the piece is a mean Σ λ_i c_i of its corners, λ_i >= 0. At any time it is seen at Σ λ_i q_i, where the
// corners are seen at q_i. It is no farther from Σ λ_i y_i than the farthest of the q_i from its y_i, whatever these
// are. Such y_i exist on the corners' segments, by their chords, and Σ λ_i y_i is in the hull of these. The exact
// corners are seen no farther from q_i than they are from c_i, because motions keep distances.
double offset_of(const WayPrism& prism, const MovedPrism& hull) {
  double offset = 0.0;
  for (std::size_t i = 0; i < 3; ++i)
    offset = std::max(offset, offset_of(prism.corners[i], {hull.begin[i], hull.end[i]}));
  return add(offset, prism.off, Direction::up);
}

Proposal outward_normal(const PosedSuperquadric& solid, const MovedPrism& hull) {
  Point middle{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) middle[k] += (hull.begin[i][k] + hull.end[i][k]) / 6.0;
  return is_finite(middle) ? midpoint(solid.motion().local_point(middle)) : Proposal{};
}

// Like a WayPart: all points of the hull are outside, and at least as far as the nearest solid. The signed distance
// changes by no more than a point moves.
double lower_end(std::span<const PosedSuperquadric> solids, const WayPrism& prism, const MovedCell& cell) {
  if (!is_finite(cell.step)) return -infinity;
  const MovedPrism hull = moved(prism, cell.step);
  if (!are_finite(hull.begin) || !are_finite(hull.end)) return -infinity;
  const double offset = offset_of(prism, hull);
  if (!std::isfinite(offset)) return -infinity;
  double nearest = infinity;
  for (std::size_t k = 0; k < solids.size() && nearest > 0.0; ++k)
    nearest = std::min(nearest, distance_of(solids[k], hull, k, cell.normals));
  return nearest > 0.0 && nearest < infinity ? subtract(nearest, offset, Direction::down) : -infinity;
}

namespace {

class Walk {
 public:
  Walk(const RigidPath& path, std::span<const PosedSuperquadric> solids, const Triangle& whole,
       const std::array<double, 3>& at_vertices, const WayTriangle& proof, const Hook& interrupted)
      : solids_(solids),
        at_vertices_(at_vertices),
        proof_(proof),
        interrupted_(interrupted),
        pieces_(path, whole),
        open_{pieces_.whole()} {}

  [[nodiscard]] double follow() {
    for (const WayCell letter : proof_.cells) {
      if (open_.empty() || least_ == -infinity || (interrupted_ && interrupted_())) return -infinity;
      const WayPiece piece = open_.back();
      open_.pop_back();
      if (!take(letter, piece)) return -infinity;
    }
    return open_.empty() ? least_ : -infinity;
  }

 private:
  /// False if the letter proves nothing for such a piece.
  [[nodiscard]] bool take(WayCell letter, const WayPiece& piece) {
    switch (letter) {
      case WayCell::by_vertices: least_ = std::min(least_, pieces_.least_on(piece, at_vertices_)); return true;
      case WayCell::moved:
        if (used_ == proof_.moved.size()) return false;
        least_ = std::min(least_, lower_end(solids_, pieces_.prism_of(piece), proof_.moved[used_++]));
        return true;
      case WayCell::quartered: return quarter(piece);
      case WayCell::halved: return halve(piece);
    }
    return false;
  }

  /// Pushes the parts in reverse order: the first part is put last.
  [[nodiscard]] bool quarter(const WayPiece& piece) {
    if (piece.quarterings == most_quarterings) return false;
    const std::array<Triangle, 4> parts = quarters(piece.corners);
    for (std::size_t i = 4; i-- > 0;) open_.push_back({parts[i], piece.begin, piece.end, piece.quarterings + 1});
    return true;
  }

  [[nodiscard]] bool halve(const WayPiece& piece) {
    const double middle = middle_of_way(piece.begin, piece.end);
    if (!(piece.begin < middle && middle < piece.end)) return false;
    open_.push_back({piece.corners, middle, piece.end, piece.quarterings});
    open_.push_back({piece.corners, piece.begin, middle, piece.quarterings});
    return true;
  }

  std::span<const PosedSuperquadric> solids_;
  const std::array<double, 3>& at_vertices_;
  const WayTriangle& proof_;
  const Hook& interrupted_;
  PiecesOnWay pieces_;
  std::vector<WayPiece> open_;
  std::size_t used_ = 0;  ///< number of the moved cells used so far
  double least_ = infinity;
};

}  // namespace

PiecesOnWay::PiecesOnWay(const RigidPath& path, const Triangle& whole)
    : path_(path), whole_(whole), off_(quartering_error(whole)) {}

Moment PiecesOnWay::moment(const Point& corner, double time) {
  auto found = poses_.find(time);
  if (found == poses_.end()) found = poses_.emplace(time, path_.nearest_pose(time)).first;
  return {time, RigidPath::local_point(found->second, corner)};
}

WayPrism PiecesOnWay::prism_of(const WayPiece& piece) {
  const auto way = [&](std::size_t i) {
    const Point& corner = piece.corners[i];
    return chord_of(path_, corner, moment(corner, piece.begin), moment(corner, piece.end));
  };
  return {{way(0), way(1), way(2)}, piece.quarterings == 0 ? 0.0 : off_};
}

double PiecesOnWay::least_on(const WayPiece& piece, const std::array<double, 3>& at_vertices) const {
  if (piece.quarterings == 0) return verify::least_on(whole_, at_vertices);
  return verify::least_on(piece.corners, off_, whole_, at_vertices);
}

double least_on(const RigidPath& path, std::span<const PosedSuperquadric> solids, const Triangle& whole,
                const std::array<double, 3>& at_vertices, const WayTriangle& proof, const Hook& interrupted) {
  return Walk(path, solids, whole, at_vertices, proof, interrupted).follow();
}

}  // namespace verisq::verify
