/// What spheres and gauges prove of every two primitives.
#include "verify/pairs/posed_pairs.hpp"

#include <algorithm>
#include <cmath>

namespace verisq::verify {

namespace {

bool is_in(const PosedSuperquadric& solid, const RigidMotion& to_own_frame, const PreciseVector& x) {
  return solid.bounds().gauge(to_own_frame(x)).upper() <= Real(1);
}

}  // namespace

PosedPrimitives::PosedPrimitives(const Model& model) : primitives(model.primitives.begin(), model.primitives.end()) {
  for (const PosedSuperquadric& primitive : primitives) {
    motions.push_back(primitive.motion());
    inverse_motions.push_back(motions.back().inverse());
  }
}

PosedPairs::PosedPairs(const PosedPrimitives& a, const PosedPrimitives& b, const RigidMotion& motion) : a_(&a), b_(&b) {
  for (const RigidMotion& own : b.motions) moved_.push_back(motion.after(own));
}

double PosedPairs::lower_by_spheres(std::size_t i, std::size_t j) const {
  const PreciseVector between = moved_[j].translation - a_->motions[i].translation;
  return (length<Real>(between) - a_->primitives[i].radius() - b_->primitives[j].radius())
      .lower()
      .to_double(Direction::down);
}

bool PosedPairs::share(const Point& x) const {
  if (!std::ranges::all_of(x, [](double c) { return std::isfinite(c); })) return false;
  const PreciseVector point = precise(x);
  bool in_a = false;
  for (std::size_t i = 0; i < size_a() && !in_a; ++i) in_a = is_in(a_->primitives[i], a_->inverse_motions[i], point);
  bool in_b = false;
  for (std::size_t j = 0; j < size_b() && !in_b; ++j) in_b = is_in(b_->primitives[j], moved_[j].inverse(), point);
  return in_a && in_b;
}

}  // namespace verisq::verify
