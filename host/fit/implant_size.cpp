/// Sections of a superquadric are superellipses, whose areas are known.
#include "host/fit/implant_size.hpp"

#include <cmath>

#include "verisq/fit.hpp"

namespace verisq {

namespace fit_search {
namespace {

constexpr int slices_of_tapered = 2000;

double beta(double a, double b) {
  return std::exp(std::lgamma(a) + std::lgamma(b) - std::lgamma(a + b));
}

/// Of the section at height h in parts of the semi-axis, in parts of the middle one's area.
double section(double h, double e1) {
  return std::pow(1.0 - std::pow(std::fabs(h), 2.0 / e1), e1);
}

/// The integral of the section over heights from -1 to 1. A taper takes (x, y, z) to (L x, L y, z') with
/// L = (1 - k^2)/(1 - k h) and dz'/dz = (1 - k^2)/(1 - k h)^2, so that a slice grows by the product of L^2 and that.
double integrated_sections(const Superquadric& solid) {
  const double e1 = solid.exponents[0];
  if (!is_tapered(solid)) return e1 * beta(0.5 * e1, e1 + 1.0);
  const double k = (solid.taper - 1.0) / (solid.taper + 1.0);
  double sum = 0.0;
  for (int i = 0; i < slices_of_tapered; ++i) {
    const double h = (2.0 * i + 1.0) / slices_of_tapered - 1.0;
    sum += section(h, e1) * std::pow(1.0 - k * h, -4.0);
  }
  return std::pow(1.0 - k * k, 3.0) * sum * 2.0 / slices_of_tapered;
}

}  // namespace

double volume(const Superquadric& solid) {
  const auto& [a1, a2, a3] = solid.semi_axes;
  const double e2 = solid.exponents[1];
  const double middle = a1 * a2 * e2 * beta(0.5 * e2, 0.5 * e2);
  return middle * a3 * integrated_sections(solid);
}

}  // namespace fit_search

double implant_size(const Model& implant) {
  double size = 0.0;
  for (const Primitive& primitive : implant.primitives) size += fit_search::volume(primitive.superquadric);
  return size;
}

}  // namespace verisq
