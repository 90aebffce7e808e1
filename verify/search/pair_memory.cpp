/// Displacements in binary64, with one bound for all rounding errors.
#include "verify/search/pair_memory.hpp"

#include <algorithm>
#include <cmath>

#include "verify/analysis/length.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

double width_up(const PreciseInterval& x) {
  return (PreciseInterval(x.upper()) - PreciseInterval(x.lower())).upper().to_double(Direction::up);
}

}  // namespace

Placement placement_of(const PosedPairs& pairs, std::size_t j) {
  const RigidMotion& motion = pairs.motion_b(j);
  Placement placement{{}, {}, pairs.radius_b(j).upper().to_double(Direction::up), 0.0, 0.0};
  placement.size = placement.radius;
  for (std::size_t i = 0; i < 3; ++i) {
    placement.centre[i] = motion.translation[i].upper().to_double(Direction::up);
    placement.size += std::fabs(placement.centre[i]);
    placement.width += width_up(motion.translation[i]);
    for (std::size_t k = 0; k < 3; ++k) {
      const PreciseInterval& entry = motion.rotation(static_cast<int>(i), static_cast<int>(k));
      placement.rotation[3 * i + k] = entry.upper().to_double(Direction::up);
      placement.width += placement.radius * width_up(entry);
    }
  }
  return placement;
}

// A point of the primitive is c + R x, |x| <= r, and moves by at most |c' - c| + |R' - R| r, where the largest singular
// value of R' - R is at most the root of the sum of its squared entries. With u = 2^-53, s = |c|_1 + r of either
// placement and S the sum of both: beyond the widths, coordinates and entries are rounded to binary64 by 2 u of
// themselves, of which entries are at most 1, so that c' - c is off by 3 u S and each of the nine entries of R' - R by
// 6 u, their root by 18 u; length (length.hpp) adds 8 u S twice and more for the entries, whose three lengths have one
// in turn: by 32 u in all. Times r these are less than 2^6 u S. The factor of the widths covers their own rounding.
// Subnormal numbers round by less than the last term.
double displacement_up(const Placement& from, const Placement& to) {
  const Point& c = from.centre;
  const Point& d = to.centre;
  const auto row = [&](std::size_t i) {
    const auto apart = [&](std::size_t k) { return to.rotation[3 * i + k] - from.rotation[3 * i + k]; };
    return length(apart(0), apart(1), apart(2));
  };
  const double turned = length(row(0), row(1), row(2)) * std::max(from.radius, to.radius);
  const double error = 0x1p-45 * (from.size + to.size) + 2.0 * (from.width + to.width) + 0x1p-1000;
  return length(d[0] - c[0], d[1] - c[1], d[2] - c[2]) + turned + error;
}

void PairMemory::look_at(const PosedPairs& pairs) {
  if (now_.size() != pairs.size_b() || known_.size() != pairs.size_a() * pairs.size_b()) {
    now_.resize(pairs.size_b());
    known_.assign(pairs.size_a() * pairs.size_b(), {});
    nearest_.reset();
  }
  for (std::size_t j = 0; j < pairs.size_b(); ++j) now_[j] = placement_of(pairs, j);
}

double PairMemory::lower(PrimitivePair pair) const {
  const Known& known = known_[place(pair)];
  if (!(known.lower > 0.0)) return 0.0;
  // Rounded down; NaN, where numbers overflow, says nothing.
  const double left = std::nextafter(known.lower - displacement_up(known.at, now_[pair.b]), -infinity);
  return left > 0.0 ? left : 0.0;
}

void PairMemory::keep(PrimitivePair pair, double lower) {
  known_[place(pair)] = {lower, now_[pair.b]};
}

}  // namespace verisq::verify
