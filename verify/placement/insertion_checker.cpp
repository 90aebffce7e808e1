/// The lower end is that of all parts of the way, the upper end that of one point on it.
#include <algorithm>

#include "verify/placement/path_check.hpp"
#include "verify/placement/way_part.hpp"
#include "verify/proof/intersection.hpp"
#include "verify/proof/judgement.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/insertion_certificate.hpp"

namespace verisq {

using verify::RigidPath;

struct InsertionChecker::State {
  State(const Model& model, std::span<const Pose> poses) : implant(model), path(poses, verify::seat_of(model, poses)) {}

  /// Of parts that do not follow each other from the first time to the last nothing.
  [[nodiscard]] double lower(const Point& point, double asked, const InsertionCertificate& certificate) const {
    double least = infinity;
    verify::Moment begin = verify::moment_of(path, point, 0.0);
    for (std::size_t k = 0; k < certificate.parts.size(); ++k) {
      const WayPart& part = certificate.parts[k];
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

  [[nodiscard]] double upper(const Point& point, double asked, const InsertionCertificate& certificate) const {
    const double time = certificate.deepest;
    if (!(time >= 0.0 && time <= path.last_time())) return infinity;
    return verify::upper_end(implant, verify::moment_of(path, point, time).place, asked, certificate.at_deepest);
  }

  Checker implant;
  RigidPath path;
};

InsertionChecker::InsertionChecker(const Model& implant, std::span<const Pose> path) {
  check_path(path);
  state_ = std::make_unique<State>(implant, path);
}
InsertionChecker::~InsertionChecker() = default;
InsertionChecker::InsertionChecker(InsertionChecker&&) noexcept = default;
InsertionChecker& InsertionChecker::operator=(InsertionChecker&&) noexcept = default;

Finding InsertionChecker::operator()(const Point& point, const Enclosure& claimed,
                                     const InsertionCertificate& certificate) const {
  const Enclosure proven =
      verify::between(state_->lower(point, claimed.lo, certificate), state_->upper(point, claimed.hi, certificate),
                      [&] { return "the smallest distance on the way of " + verify::text_of(point); });
  return verify::judged(claimed, proven, proven);
}

}  // namespace verisq
