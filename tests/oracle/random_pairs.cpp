/// The constructions of the random pairs.
#include "tests/oracle/random_pairs.hpp"

#include <algorithm>
#include <cmath>

#include "tests/oracle/reference_distance.hpp"

namespace verisq::oracle {

namespace {

using Quaternion = std::array<double, 4>;

[[nodiscard]] double size_of(const Superquadric& superquadric) {
  return *std::max_element(superquadric.semi_axes.begin(), superquadric.semi_axes.end());
}

[[nodiscard]] Quaternion any_rotation(RandomCases& random) {
  const double length = random.log_uniform(1e-3, 1e3);
  Quaternion quaternion;
  for (double& component : quaternion) component = length * random.uniform(-1, 1);
  return quaternion;
}

/// Identity or a half turn about an axis: exact in binary64.
[[nodiscard]] Quaternion exact_rotation(RandomCases& random) {
  Quaternion quaternion{0.0, 0.0, 0.0, 0.0};
  quaternion[random.choice(4)] = random.choice(2) == 0 ? 1.0 : -2.0;
  return quaternion;
}

[[nodiscard]] Quaternion product(const Quaternion& p, const Quaternion& q) {
  return {p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3], p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
          p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1], p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0]};
}

/// Turns the unit vector `from` to `to`, then by a random angle about it.
[[nodiscard]] Quaternion rotation_onto(RandomCases& random, const Point& from, const Point& to) {
  const Quaternion arc{1 + dot(from, to), from[1] * to[2] - from[2] * to[1], from[2] * to[0] - from[0] * to[2],
                       from[0] * to[1] - from[1] * to[0]};
  const double angle = random.uniform(-3.14, 3.14);
  const double sine = std::sin(angle);
  return product({std::cos(angle), sine * to[0], sine * to[1], sine * to[2]}, arc);
}

/// Moves B so that the boundary points meet with opposite normals, `opening` apart.
void bring_together(RandomCases& random, const Primitive& a, Primitive& b, double opening) {
  const BoundaryPoint on_a = random.boundary_point(a.superquadric);
  const BoundaryPoint on_b = random.boundary_point(b.superquadric);
  const PosedSolid solid(a.superquadric, a.pose);
  const Vector contact = solid.from_own_frame(widened(on_a.point));
  const Vector normal = difference(solid.from_own_frame(widened(on_a.normal)), solid.centre());
  b.pose.quaternion = rotation_onto(random, on_b.normal, rounded(scaled<Real>(normal, Real(-1))));
  b.pose.translation = {0.0, 0.0, 0.0};
  const Vector foot = PosedSolid(b.superquadric, b.pose).from_own_frame(widened(on_b.point));
  const Vector target = difference(contact, scaled<Real>(normal, Real(-opening)));
  b.pose.translation = rounded(difference(target, foot));
}

/// B beside A along an axis of the common frame; the opening may be exactly 0.
void align(RandomCases& random, Primitive& a, Primitive& b) {
  const std::size_t axis = random.choice(3);
  a.pose.quaternion = exact_rotation(random);
  b.pose.quaternion = exact_rotation(random);
  const double apart = a.superquadric.semi_axes[axis] + b.superquadric.semi_axes[axis];
  const double opening = random.choice(4) == 0 ? 0.0 : apart * random.log_uniform(1e-9, 3);
  b.pose.translation = a.pose.translation;
  b.pose.translation[axis] += (random.choice(2) == 0 ? 1.0 : -1.0) * (apart + opening);
  for (std::size_t k = 0; k < 3; ++k) {
    if (k != axis && random.choice(2) == 0)
      b.pose.translation[k] += a.superquadric.semi_axes[k] * random.uniform(-2, 2);
  }
}

}  // namespace

std::string_view to_string(PairFamily family) {
  switch (family) {
    case PairFamily::gap: return "gap";
    case PairFamily::far: return "far";
    case PairFamily::touching: return "touching";
    case PairFamily::overlapping: return "overlapping";
    case PairFamily::aligned: return "aligned";
    case PairFamily::anywhere: break;
  }
  return "anywhere";
}

RandomPair random_pair(RandomCases& random, const Superquadric& a, const Superquadric& b) {
  const double size = std::max(size_of(a), size_of(b));
  RandomPair pair{{"a", a, {}}, {"b", b, {}}, pair_families[random.choice(pair_families.size())]};
  const double reach = random.choice(4) == 0 ? 0.0 : 3 * size;
  for (double& coordinate : pair.a.pose.translation) coordinate = reach * random.uniform(-1, 1);
  pair.a.pose.quaternion = any_rotation(random);
  switch (pair.family) {
    case PairFamily::gap: bring_together(random, pair.a, pair.b, size * random.log_uniform(1e-9, 3)); break;
    case PairFamily::far: bring_together(random, pair.a, pair.b, size * random.log_uniform(10, 1e3)); break;
    case PairFamily::touching: bring_together(random, pair.a, pair.b, 1e-15 * size * random.uniform(-1, 1)); break;
    case PairFamily::overlapping: bring_together(random, pair.a, pair.b, -size * random.log_uniform(1e-9, 1)); break;
    case PairFamily::aligned: align(random, pair.a, pair.b); break;
    case PairFamily::anywhere:
      pair.b.pose.quaternion = any_rotation(random);
      for (std::size_t k = 0; k < 3; ++k) {
        pair.b.pose.translation[k] = pair.a.pose.translation[k] + 4 * size * random.uniform(-1, 1);
      }
      break;
  }
  return pair;
}

RandomPair random_pair(RandomCases& random) {
  const Superquadric a = random.solid().superquadric;
  if (random.choice(8) == 0) return random_pair(random, a, a);
  Superquadric b = random.solid().superquadric;
  const double scale = size_of(a) / size_of(b) * random.log_uniform(0.1, 10);
  for (double& axis : b.semi_axes) axis *= scale;
  return random_pair(random, a, b);
}

}  // namespace verisq::oracle
