/// Krawczyk's operator first, caps where it does not succeed.
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "verify/numbers/norms.hpp"
#include "verify/search/krawczyk.hpp"
#include "verify/search/model_distance.hpp"
#include "verify/search/set_tree.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

constexpr const char* closest_coordinate = "a coordinate of a closest point";

bool strictly_convex(const Superquadric& solid) {
  return solid.exponents[0] < 2.0 && solid.exponents[1] < 2.0;
}

/// A pair of closest points and the vector between them, in the frame of the first solid; `on_b` in the second's.
struct PairBox {
  PreciseVector vector;
  PreciseVector on_a;
  PreciseVector on_b;
};

std::array<Real, 3> coordinates(const PreciseVector& x) {
  return {x[0].lower(), x[1].lower(), x[2].lower()};
}

/// F(v) and its Jacobian I + D^2h_A(v) + R D^2h_-B(R^T v) R^T. Here h_-B(w) = h_B(-w), and -B's support point at w is
/// minus B's support point at -w.
struct SeparationSystem {
  NormFunction<PreciseInterval> support_a;
  NormFunction<PreciseInterval> support_b;  ///< of -B
  const RigidMotion* relative;

  [[nodiscard]] SystemExpansion<3> operator()(const IntervalVector<3>& unknowns) const {
    const PreciseVector v = three_of(unknowns);
    const PreciseMatrix& r = relative->rotation;
    const NormExpansion<PreciseInterval> a = support_a(v);
    const NormExpansion<PreciseInterval> b = support_b(r.transpose() * v);
    return {block(v - relative->translation + a.gradient + r * b.gradient),
            block(PreciseMatrix::identity() + a.hessian + r * b.hessian * r.transpose())};
  }

  [[nodiscard]] PreciseVector on_b(const PreciseVector& v) const {
    return -support_b(relative->rotation.transpose() * v).gradient;
  }
};

/// The same for a flat A, whose support point is too sensitive. In the unknowns x on A's surface and s > 0 the vector
/// is v = s n with the normal n = Dg_A(x), and the equations are v - c + x + R s_-B(R^T v) = 0, g_A(x) = 1. A zero
/// gives a zero of F, because x = s_A(v).
struct SurfaceSystem {
  NormFunction<PreciseInterval> gauge_a;
  SeparationSystem separation;

  [[nodiscard]] SystemExpansion<4> operator()(const IntervalVector<4>& unknowns) const {
    const PreciseVector x = three_of(unknowns);
    const PreciseInterval& s = unknowns[3];
    const PreciseMatrix& r = separation.relative->rotation;
    const NormExpansion<PreciseInterval> g = gauge_a(x);
    const PreciseVector v = g.gradient * s;
    const NormExpansion<PreciseInterval> b = separation.support_b(r.transpose() * v);
    const PreciseMatrix by_v = PreciseMatrix::identity() + r * b.hessian * r.transpose();
    SystemExpansion<4> f;
    f.value.head<3>() = block(v - separation.relative->translation + x + r * b.gradient);
    f.value[3] = g.value - PreciseInterval(1);
    f.jacobian.topLeftCorner<3, 3>() = block(PreciseMatrix::identity() + by_v * (g.hessian * s));
    f.jacobian.topRightCorner<3, 1>() = block(by_v * g.gradient);
    f.jacobian.bottomLeftCorner<1, 3>() = block(g.gradient).transpose();
    f.jacobian(3, 3) = PreciseInterval(0);
    return f;
  }
};

/// The same for two flat solids: the unknowns are x and s as above, y on B's surface and m > 0 with v = -m R Dg_B(y).
/// The equations are c + R y - x = s Dg_A(x), s Dg_A(x) + m R Dg_B(y) = 0, g_A(x) = 1, g_B(y) = 1.
struct SurfacesSystem {
  NormFunction<PreciseInterval> gauge_a;
  NormFunction<PreciseInterval> gauge_b;
  const RigidMotion* relative;

  [[nodiscard]] SystemExpansion<8> operator()(const IntervalVector<8>& unknowns) const {
    const PreciseMatrix& r = relative->rotation;
    const PreciseVector x = three_of(unknowns);
    const PreciseVector y = three_of(unknowns, 3);
    const PreciseInterval& s = unknowns[6];
    const PreciseInterval& m = unknowns[7];
    const NormExpansion<PreciseInterval> a = gauge_a(x);
    const NormExpansion<PreciseInterval> b = gauge_b(y);
    const PreciseVector normal_b = r * b.gradient;
    const PreciseMatrix curvature_a = a.hessian * s;
    SystemExpansion<8> f;
    f.value << block(relative->translation + r * y - x - a.gradient * s), block(a.gradient * s + normal_b * m),
        a.value - PreciseInterval(1), b.value - PreciseInterval(1);
    for (int i = 0; i < 8; ++i) {
      for (int j = 0; j < 8; ++j) f.jacobian(i, j) = PreciseInterval(0);
    }
    f.jacobian.block<3, 3>(0, 0) = block(-(PreciseMatrix::identity() + curvature_a));
    f.jacobian.block<3, 3>(0, 3) = block(r);
    f.jacobian.block<3, 1>(0, 6) = block(-a.gradient);
    f.jacobian.block<3, 3>(3, 0) = block(curvature_a);
    f.jacobian.block<3, 3>(3, 3) = block(r * (b.hessian * m));
    f.jacobian.block<3, 1>(3, 6) = block(a.gradient);
    f.jacobian.block<3, 1>(3, 7) = block(normal_b);
    f.jacobian.block<1, 3>(6, 0) = block(a.gradient).transpose();
    f.jacobian.block<1, 3>(7, 3) = block(b.gradient).transpose();
    return f;
  }
};

std::optional<PairBox> by_surfaces(const SurfacesSystem& system, const PreciseContact& start) {
  const auto [x1, x2, x3] = coordinates(start.on_a);
  const auto [y1, y2, y3] = coordinates(start.on_b);
  const Real s = start.vector.dot(start.on_a).lower();
  const Real m = -PreciseVector(system.relative->rotation.transpose() * start.vector).dot(start.on_b).lower();
  const auto zero = krawczyk<8>(system, {x1, x2, x3, y1, y2, y3, s, m});
  if (!zero || !((*zero)[6].lower() > Real(0)) || !((*zero)[7].lower() > Real(0))) return std::nullopt;
  const PreciseVector on_a = three_of(*zero);
  return PairBox{system.gauge_a(on_a).gradient * (*zero)[6], on_a, three_of(*zero, 3)};
}

std::optional<PairBox> by_separation(const SeparationSystem& system, const PreciseContact& start) {
  const auto zero = krawczyk<3>(system, coordinates(start.vector));
  if (!zero) return std::nullopt;
  const PreciseVector v = three_of(*zero);
  return PairBox{v, system.support_a(v).gradient, system.on_b(v)};
}

std::optional<PairBox> by_surface(const SurfaceSystem& system, const PreciseContact& start) {
  const auto [x, y, z] = coordinates(start.on_a);
  const Real s = start.vector.dot(start.on_a).lower();  // n·x = 1
  const auto zero = krawczyk<4>(system, {x, y, z, s});
  if (!zero || !((*zero)[3].lower() > Real(0))) return std::nullopt;
  const PreciseVector on_a = three_of(*zero);
  const PreciseVector v = system.gauge_a(on_a).gradient * (*zero)[3];
  return PairBox{v, on_a, system.separation.on_b(v)};
}

/// The part {x in K : v·x >= h(v) - depth} of a solid, in its own frame, with x_k = 0 for every k in `planes`.
struct Cap {
  const SuperquadricBounds<Real>* solid;
  PreciseVector v;
  PreciseInterval level;  ///< h(v) - depth, rounded down
  std::array<bool, 3> planes;

  /// A bound of e·x over the cap, by duality: h(e + t v) - t (h(v) - depth) for any t >= 0.
  [[nodiscard]] Real largest(const PreciseVector& e, const Real& t) const {
    const PreciseInterval multiplier(t);
    const PreciseVector direction = e + v * multiplier;
    return (PreciseInterval(solid->support(direction).upper()) - multiplier * level).upper();
  }

  /// About the least of these bounds: they are convex in t. Golden section in ln t. Precondition: |e| <= 1.
  [[nodiscard]] Real largest(const PreciseVector& e) const {
    constexpr double golden = 0.6180339887498949;
    const double scale = std::log(static_cast<double>(length<Real>(v).upper().to_long_double()));
    const auto at = [&](double s) { return largest(e, Real(std::exp(static_cast<long double>(s - scale)))); };
    double low = -7.0;
    double high = 60.0;
    double left = high - golden * (high - low);
    double right = low + golden * (high - low);
    Real at_left = at(left);
    Real at_right = at(right);
    Real least = solid->support(e).upper();  // t = 0
    while (high - low > 0.5) {
      if (at_left < at_right) {
        high = right;
        right = left;
        at_right = at_left;
        left = high - golden * (high - low);
        at_left = at(left);
      } else {
        low = left;
        left = right;
        at_left = at_right;
        right = low + golden * (high - low);
        at_right = at(right);
      }
      least = std::min({least, at_left, at_right});
    }
    return least;
  }

  /// The box of the cap in the frame that `motion` leads to.
  [[nodiscard]] PreciseVector box(const RigidMotion& motion) const {
    PreciseVector result;
    for (int k = 0; k < 3; ++k) {
      PreciseVector axis = motion.rotation.row(k);
      for (int i = 0; i < 3; ++i) {
        if (planes[static_cast<std::size_t>(i)]) axis[i] = PreciseInterval(0);  // e_i x_i = 0
      }
      const Real upper = largest(axis);
      const Real lower = -largest(-axis);
      result[k] = motion.translation[k] + PreciseInterval(lower, upper);
    }
    return result;
  }
};

/// Boxes wider than this share of the solids' size are worth another attempt.
constexpr double kNarrow = 1e-14;

/// In the frame of model A.
struct Boxes {
  PreciseVector on_a;
  PreciseVector on_b;

  [[nodiscard]] double width() const {
    double widest = 0.0;
    for (int k = 0; k < 3; ++k) {
      for (const PreciseInterval& side : {on_a[k], on_b[k]}) {
        widest = std::max(widest, subtract(side.upper(), side.lower(), Direction::up).to_double(Direction::up));
      }
    }
    return widest;
  }
};

/// The intersection of two enclosures of the same pair of points, or the only one that exists.
std::optional<Boxes> both(const std::optional<Boxes>& x, const std::optional<Boxes>& y) {
  if (!x || !y) return x ? x : y;
  return Boxes{intersection(x->on_a, y->on_a, closest_coordinate), intersection(x->on_b, y->on_b, closest_coordinate)};
}

Boxes hull_of(const Boxes& x, const Boxes& y) {
  Boxes result;
  for (int k = 0; k < 3; ++k) {
    result.on_a[k] = hull(x.on_a[k], y.on_a[k]);
    result.on_b[k] = hull(x.on_b[k], y.on_b[k]);
  }
  return result;
}

/// A pair of primitives that may be the nearest.
struct Remaining {
  std::size_t i;
  std::size_t j;
  PairBounds bounds;
  PreciseContact contact;
  Real lower;  ///< lower bound of the pair's distance

  [[nodiscard]] bool strictly_convex_both() const {
    return strictly_convex(bounds.a().superquadric()) && strictly_convex(bounds.b().superquadric());
  }
  [[nodiscard]] bool strictly_convex_one() const {
    return strictly_convex(bounds.a().superquadric()) || strictly_convex(bounds.b().superquadric());
  }

  [[nodiscard]] bool tapered_one() const {
    return is_tapered(bounds.a().superquadric()) || is_tapered(bounds.b().superquadric());
  }

  [[nodiscard]] double size() const {
    return std::max(std::ranges::max(bounds.a().superquadric().semi_axes),
                    std::ranges::max(bounds.b().superquadric().semi_axes));
  }

  /// The boxes in the frame of model A. Each point is also enclosed by the other point and the vector, which is tighter
  /// beside a face.
  [[nodiscard]] std::optional<Boxes> boxes(const std::optional<PairBox>& found, const PosedPairs& pairs) const {
    if (!found) return std::nullopt;
    const auto& [v, on_a, on_b] = *found;
    const RigidMotion& motion = pairs.motion_a(i);
    const PreciseVector a = motion(on_a);
    const PreciseVector b = pairs.motion_b(j)(on_b);
    const PreciseVector apart = motion.rotation * v;
    return Boxes{intersection(a, b - apart, closest_coordinate), intersection(b, a + apart, closest_coordinate)};
  }

  /// Solves from both solids' sides if the first system leaves wide boxes or does not succeed.
  [[nodiscard]] std::optional<Boxes> by_krawczyk(const PosedPairs& pairs) const {
    if (!strictly_convex_both()) return std::nullopt;
    const Superquadric& a = bounds.a().superquadric();
    const Superquadric& b = bounds.b().superquadric();
    const auto support_a = NormFunction<PreciseInterval>::support(a);
    const auto against_a = NormFunction<PreciseInterval>::support_of_reflected(a);
    const auto support_b = NormFunction<PreciseInterval>::support(b);
    const auto against_b = NormFunction<PreciseInterval>::support_of_reflected(b);
    const RigidMotion& relative = bounds.relative();
    const SeparationSystem forward{support_a, against_b, &relative};
    std::optional<Boxes> found = boxes(by_separation(forward, contact), pairs);
    if (found && found->width() <= kNarrow * size()) return found;
    const SurfaceSystem surface_a{NormFunction<PreciseInterval>::gauge(a), forward};
    found = both(found, boxes(by_surface(surface_a, contact), pairs));
    if (found && found->width() <= kNarrow * size()) return found;
    const RigidMotion inverse = relative.inverse();
    const PreciseVector back = -(relative.rotation.transpose() * contact.vector);
    const auto gauge_b = NormFunction<PreciseInterval>::gauge(b);
    const SurfaceSystem surface_b{gauge_b, {support_b, against_a, &inverse}};
    if (const auto swapped = by_surface(surface_b, {back, contact.on_b, contact.on_a})) {
      const PairBox restored{-(relative.rotation * swapped->vector), swapped->on_b, swapped->on_a};
      found = both(found, boxes(restored, pairs));
      if (found->width() <= kNarrow * size()) return found;
    }
    const SurfacesSystem surfaces{surface_a.gauge_a, gauge_b, &relative};
    return both(found, boxes(by_surfaces(surfaces, contact), pairs));
  }

  /// The coordinates whose reflection x_k -> -x_k maps A and B onto themselves. It maps each solid alone onto itself,
  /// but for z and a taper. If R e_k = ±e_k and c_k = 0, all exactly, it commutes with B's motion. It then maps closest
  /// points to closest points; if there is only one pair of them, both have x_k = 0.
  [[nodiscard]] std::array<bool, 3> planes_of_closest_points() const {
    const auto zero = [](const PreciseInterval& x) { return x.lower() == Real(0) && x.upper() == Real(0); };
    const auto& [rotation, translation] = bounds.relative();
    std::array<bool, 3> planes{};
    for (int k = 0; k < 3; ++k) {
      bool symmetric = strictly_convex_one() && zero(translation[k]) && (k < 2 || !tapered_one());
      for (int l = 0; l < 3; ++l) symmetric = symmetric && (l == k || (zero(rotation(l, k)) && zero(rotation(k, l))));
      planes[static_cast<std::size_t>(k)] = symmetric;
    }
    return planes;
  }

  /// `upper` bounds the distance of the models.
  [[nodiscard]] Boxes by_caps(const PosedPairs& pairs, const Real& upper) const {
    const PreciseVector& v = contact.vector;
    const PreciseVector w = -(bounds.relative().rotation.transpose() * v);
    const PreciseInterval support_a = bounds.a().bounds().support(v);
    const PreciseInterval support_b = bounds.b().bounds().support(w);
    const PreciseInterval gap = v.dot(bounds.relative().translation) - support_a - support_b;
    const PreciseInterval depth = (length<Real>(v) * PreciseInterval(upper) - gap).upper();
    const std::array<bool, 3> planes = planes_of_closest_points();
    const Cap on_a{&bounds.a().bounds(), v, (support_a - depth).lower(), planes};
    const Cap on_b{&bounds.b().bounds(), w, (support_b - depth).lower(), planes};
    return {on_a.box(pairs.motion_a(i)), on_b.box(pairs.motion_b(j))};
  }
};

/// The best vector and the best points found for one pair, and the bounds that they prove.
struct BestContact {
  PreciseContact contact;
  Real lower;
  Real upper;

  /// A zero vector, as between solids that touch but for rounding, bounds nothing.
  [[nodiscard]] static BestContact of(const PairBounds& bounds, const PreciseContact& c) {
    const bool direction = length<Real>(c.vector).lower() > Real(0);
    return {c, direction ? bounds.lower_by_vector(c.vector) : Real(-infinity), bounds.upper_by_points(c.on_a, c.on_b)};
  }

  void improve(const BestContact& other) {
    if (other.lower > lower) {
      lower = other.lower;
      contact.vector = other.contact.vector;
    }
    if (other.upper < upper) {
      upper = other.upper;
      contact.on_a = other.contact.on_a;
      contact.on_b = other.contact.on_b;
    }
  }

  void improve_by_refining(const PairBounds& bounds, const PreciseVector& start) {
    const auto refined =
        refined_pair_contact(bounds.a().superquadric(), bounds.b().superquadric(), bounds.relative(), start);
    if (refined) improve(of(bounds, *refined));
  }

  /// Returns whether the difference of the ends is no more than the rounding errors of 127 bits.
  [[nodiscard]] bool tight(const Real& magnitude) const {
    return (PreciseInterval(upper) - PreciseInterval(lower) - PreciseInterval(Real(1e-32)) * magnitude).upper() <
           Real(0);
  }
};

/// x / g(x): on the surface but for rounding, which the errors of projections are not.
PreciseVector onto_surface(const SuperquadricBounds<Real>& solid, const PreciseVector& x) {
  const PreciseInterval gauge = solid.gauge(x).upper();
  return gauge.lower() > Real(0) ? thin(x / gauge) : x;
}

BestContact best_contact(const PairBounds& bounds, const Separation& s) {
  const Superquadric& a = bounds.a().superquadric();
  const Superquadric& b = bounds.b().superquadric();
  const RigidMotion& relative = bounds.relative();
  const Enclosure proven = bounds.distance(s);
  // If spheres separate the solids, the line of centres does.
  const PreciseVector start = proven.lo > 0.0 ? precise(s.vector) : thin(relative.translation);
  const bool points = proven.hi < infinity;
  const Point centre{0.0, 0.0, 0.0};
  BestContact best =
      BestContact::of(bounds, {start, precise(points ? s.on_a : centre), precise(points ? s.on_b : centre)});
  best.improve_by_refining(bounds, start);
  const Real magnitude = (bounds.a().radius() + bounds.b().radius() + PreciseInterval(best.upper)).upper();
  if (best.tight(magnitude)) return best;
  for (PreciseContact projected : projected_pair_contacts(a, b, relative)) {
    projected.on_a = onto_surface(bounds.a().bounds(), projected.on_a);
    projected.on_b = onto_surface(bounds.b().bounds(), projected.on_b);
    const BestContact found = BestContact::of(bounds, projected);
    best.improve(found);
    if (found.lower > Real(0)) best.improve_by_refining(bounds, projected.vector);
    if (best.tight(magnitude)) return best;
  }
  return best;
}

/// All pairs of primitives that single evaluations in 127 bits do not prove to be farther than the nearest.
struct Nearest {
  std::vector<Remaining> pairs;
  Real upper;  ///< upper bound of the distance of the models
};

/// Nothing if interrupted.
std::optional<Nearest> nearest_pairs(const PosedPairs& pairs, const ModelDistance& found,
                                     const std::function<bool()>& interrupted) {
  Nearest nearest{{}, found.distance.hi};
  for (const Separation& s : found.certificate.separations) {
    if (interrupted && interrupted()) return std::nullopt;
    const PairBounds bounds = pairs(s.primitive_a, s.primitive_b);
    if (bounds.distance(s).lo > found.distance.hi) continue;
    const BestContact best = best_contact(bounds, s);
    nearest.upper = std::min(nearest.upper, best.upper);
    nearest.pairs.push_back({s.primitive_a, s.primitive_b, bounds, best.contact, best.lower});
  }
  std::erase_if(nearest.pairs, [&](const Remaining& pair) { return pair.lower > nearest.upper; });
  return nearest;
}

}  // namespace

std::optional<ClosestPoints> closest_points(const PosedPairs& pairs, const ModelDistance& found,
                                            const std::function<bool()>& interrupted) {
  const std::optional<Nearest> nearest = nearest_pairs(pairs, found, interrupted);
  if (!nearest) return std::nullopt;
  std::optional<Boxes> all;
  for (const Remaining& pair : nearest->pairs) {
    if (interrupted && interrupted()) return std::nullopt;
    std::optional<Boxes> boxes = pair.by_krawczyk(pairs);
    if (!boxes) boxes = pair.by_caps(pairs, nearest->upper);
    all = all ? hull_of(*all, *boxes) : *boxes;
  }
  const bool unique = nearest->pairs.size() == 1 && nearest->pairs.front().strictly_convex_one();
  if (!all) return std::nullopt;
  return ClosestPoints{rounded_outward(all->on_a), rounded_outward(all->on_b), unique};
}

}  // namespace verisq::verify
