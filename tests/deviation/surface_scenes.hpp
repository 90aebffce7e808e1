/// Primitives and set operations whose surfaces the tests of patches look at.
#pragma once

#include <array>
#include <verisq/model.hpp>

namespace verisq::testing {

inline Primitive superquadric(const std::array<double, 3>& axes, const std::array<double, 2>& exponents,
                              const Point& centre, double taper = 1.0) {
  return {"", {axes, exponents, taper}, {centre, {0.9, 0.2, -0.3, 0.1}}, {}};
}

/// Solids that overlap: a rounded one, a ball, one with edges and a taper, a bent one.
struct SurfaceScene {
  Primitive soap = superquadric({2.0, 1.6, 1.0}, {0.4, 0.7}, {0.1, 0.2, -0.1});
  Primitive side = superquadric({1.0, 1.0, 1.0}, {1.0, 1.0}, {1.8, 0.0, 0.2});
  Primitive sharp = superquadric({1.5, 1.0, 1.2}, {2.0, 1.4}, {-1.0, 0.5, 0.0}, 0.6);
  Primitive bent = bent_rod();
  /// Of the first two primitives.
  SetExpression difference{{{.primitive = 0}, {.primitive = 1}}, SetOperation::subtract};
  SetExpression intersection{{{.primitive = 0}, {.primitive = 1}}, SetOperation::intersect};

 private:
  static Primitive bent_rod() {
    Primitive rod = superquadric({0.6, 0.5, 2.0}, {0.8, 0.9}, {0.3, 0.0, 0.0});
    rod.bend = Bend{0.2, 30.0};
    return rod;
  }
};

}  // namespace verisq::testing
