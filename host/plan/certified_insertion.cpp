/// A point's way is cut into parts, each so short that one segment beside or before the implant bounds all of it.
#include <algorithm>
#include <cmath>
#include <utility>
#include <verisq/distance.hpp>

#include "host/device/primitive_parameters.hpp"
#include "host/maps/certified_rows.hpp"
#include "host/threads/parallel.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/proof/way_checker.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/insertion.hpp"

namespace verisq {
namespace {

using verify::Chord;
using verify::Moment;
using verify::RigidPath;

/// Limits for one point: about the number of parts of its certificate, and the number of searches for ways out, some of
/// which take hundredths of a second.
constexpr std::size_t most_parts = 512;
constexpr std::size_t most_ways_out = 96;
/// Share of the tolerance for the point at the deepest time, and again for the remainder beyond a way out.
constexpr double share_of_points = 0.25;
/// The number of points between two reports of progress.
constexpr std::size_t points_at_a_time = 256;

Point operator+(const Point& a, const Point& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

Point operator*(double factor, const Point& a) {
  return {factor * a[0], factor * a[1], factor * a[2]};
}

double length_of(const Point& a) {
  return std::hypot(a[0], a[1], a[2]);
}

struct ProvenPart {
  WayPart part;
  double lower;
};

class InsertionProver {
 public:
  InsertionProver(std::span<const Pose> path, const Model& implant, double tolerance)
      : tolerance_(tolerance),
        implant_(implant),
        path_(path, verify::seat_of(implant, path)),
        points_(implant),
        triangles_(implant),
        insertions_(implant, path) {}

  [[nodiscard]] std::pair<Enclosure, InsertionCertificate> operator()(const Point& point, const Enclosure& found,
                                                                      double deepest) const {
    const auto [centre, radius] = moment(point, deepest).place;
    CertifiedEnclosure there = points_.certified(centre, share_of_points * tolerance_);
    InsertionCertificate certificate{deepest, std::move(there.certificate), {}};
    // Rounded up, so that the checker, which subtracts the radius again, requires no more than was proven.
    const double upper = verify::add(there.distance.hi, radius, verify::Direction::up);
    const double goal = upper - tolerance_;
    Enclosure proven = prove(point, {goal, upper}, certificate);
    // That goal may be higher than the truth; the found bound is not.
    if (!verified(proven, tolerance_) && found.lo < goal) proven = prove(point, {found.lo, upper}, certificate);
    return {proven, std::move(certificate)};
  }

 private:
  [[nodiscard]] Moment moment(const Point& point, double time) const { return verify::moment_of(path_, point, time); }

  // For one point: the goal of each part of its way, the proven parts, and the number of ways out searched for.
  struct Search {
    const Point& point;
    double goal;
    std::vector<WayPart>& parts;
    std::size_t ways_out = 0;
  };

  // The enclosure that the certificate proves with parts none of whose distances is below the claim, or as near to it
  // as possible.
  [[nodiscard]] Enclosure prove(const Point& point, const Enclosure& claim, InsertionCertificate& certificate) const {
    certificate.parts.clear();
    Search search{point, claim.lo, certificate.parts};
    if (std::isfinite(claim.lo)) prove(search, moment(point, 0.0), moment(point, path_.last_time()));
    return insertions_(point, claim, certificate).proven;
  }

  // Appends parts from `begin` to `end`, halved until each reaches the goal, or the search has had its share of work.
  void prove(Search& search, const Moment& begin, const Moment& end) const {
    const Chord chord = verify::chord_of(path_, search.point, begin, end);
    ProvenPart best = beside(chord);
    if (best.lower >= search.goal) {
      search.parts.push_back(std::move(best.part));
      return;
    }
    const Moment half = moment(search.point, verify::middle_of_way(begin.time, end.time));
    if (search.goal < 0.0 && search.ways_out < most_ways_out) {
      ++search.ways_out;
      ProvenPart outward = before_the_way_out(search.goal, chord, half.place.centre);
      if (outward.lower > best.lower) best = std::move(outward);
    }
    const bool spent = search.ways_out >= most_ways_out || search.parts.size() + 1 >= most_parts;
    if (best.lower >= search.goal || spent || !(begin.time < half.time && half.time < end.time)) {
      if (best.lower == -infinity) best = far_away(chord);
      search.parts.push_back(std::move(best.part));
      return;
    }
    prove(search, begin, half);
    prove(search, half, end);
  }

  // Proves by the straight way itself, if it is outside.
  [[nodiscard]] ProvenPart beside(const Chord& chord) const {
    return proven_by({chord.begin.place.centre, chord.end.place.centre}, chord);
  }

  // Proves by that way moved out of the implant: where its middle leaves the implant soonest, by all that the goal
  // allows; or by a little more than necessary, if another primitive is near.
  [[nodiscard]] ProvenPart before_the_way_out(double goal, const Chord& chord, const Point& centre) const {
    const double slack = share_of_points * tolerance_;
    const CertifiedEnclosure there = points_.certified(
        centre, slack, [] { return false; }, false);
    const Point way_out = way_out_of(centre, there.certificate);
    const double length = length_of(way_out);
    ProvenPart best{{chord.end.time, {}, {}}, -infinity};
    if (!(length > 0.0) || !std::isfinite(length)) return best;
    const double rounding = chord.bulge + 2.0 * std::max(chord.begin.place.radius, chord.end.place.radius);
    const double room = (-goal - rounding) * (1.0 - 0x1p-40);
    for (const double moved : {room, std::min(room, slack - there.distance.lo)}) {
      ProvenPart next = moved_by((moved / length) * way_out, chord);
      if (next.lower > best.lower) best = std::move(next);
      if (best.lower >= goal) break;
    }
    return best;
  }

  // Proves by that way beside all of the implant, wherever it is: a bound, though not a tight one.
  [[nodiscard]] ProvenPart far_away(const Chord& chord) const {
    const Point& from = implant_.primitives.front().pose.translation;
    const double beyond = 4.0 * bounding_radius(implant_) + length_of(chord.begin.place.centre + (-1.0) * from) +
                          length_of(chord.end.place.centre + (-1.0) * from);
    return moved_by({beyond, 0.0, 0.0}, chord);
  }

  [[nodiscard]] ProvenPart moved_by(const Point& step, const Chord& chord) const {
    return proven_by({chord.begin.place.centre + step, chord.end.place.centre + step}, chord);
  }

  // The vector from a point inside to a point outside, or along the gradient of the distance; zero if nothing is known.
  [[nodiscard]] Point way_out_of(const Point& inside, const Certificate& certificate) const {
    if (certificate.escape) return *certificate.escape + (-1.0) * inside;
    if (certificate.normals.empty()) return {};
    const auto& [primitive, v] = certificate.normals.front();
    const auto r = device::rotation_matrix(implant_.primitives[primitive].pose.quaternion);
    Point outward{};
    for (std::size_t i = 0; i < 3; ++i) outward[i] = r[3 * i] * v[0] + r[3 * i + 1] * v[1] + r[3 * i + 2] * v[2];
    return outward;
  }

  [[nodiscard]] ProvenPart proven_by(const std::array<Point, 2>& segment, const Chord& chord) const {
    const double offset = verify::offset_of(chord, segment);
    if (!std::isfinite(offset)) return {{chord.end.time, {}, {}}, -infinity};  // numbers overflow
    CertifiedEnclosure distance = triangles_.certified({segment[0], segment[1], segment[1]});
    distance.certificate.weights.reset();  // which say something of the upper end alone
    const double lower = distance.distance.lo > 0.0
                             ? verify::subtract(distance.distance.lo, offset, verify::Direction::down)
                             : -infinity;
    return {{chord.end.time, segment, std::move(distance.certificate)}, lower};
  }

  double tolerance_;
  Model implant_;
  RigidPath path_;
  SignedDistance points_;
  TriangleDistance triangles_;
  InsertionChecker insertions_;
};

}  // namespace

CertifiedInsertion certified_insertion(std::span<const Pose> path, const Model& implant, std::span<const Point> bone,
                                       const Insertion& found, const InsertionOptions& options) {
  const InsertionProver prover(path, implant, options.tolerance);
  CertifiedInsertion result{found.rows, std::vector<InsertionCertificate>(found.rows.size()), {}};
  const auto prove = [&](std::size_t n) {
    auto [distance, certificate] = prover(bone[n], found.rows[n].distance, found.deepest[n]);
    result.rows[n] = {distance, verified(distance, options.tolerance) ? Status::host_verified : Status::wide};
    result.certificates[n] = std::move(certificate);
  };
  const std::size_t done = in_parallel_steps(result.rows.size(), points_at_a_time,
                                             SeenInterruption(options.interrupted), options.progress, prove);
  result.rows.resize(done);
  result.certificates.resize(done);
  result.summary = recounted(found.summary, result.rows);
  result.summary.interrupted = found.summary.interrupted || done < found.rows.size();
  return result;
}

}  // namespace verisq
