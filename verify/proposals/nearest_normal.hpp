/// The normal of a superquadric where it is nearest to a point, in plain floating point. Proposes, proves nothing.
#pragma once

#include "verify/proposals/boundary.hpp"
#include "verify/proposals/support_mapping.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// Tapered or not, not bent.
class NearestNormal {
 public:
  explicit NearestNormal(const Superquadric& solid);

  struct Found {
    Coordinates<double> normal;  ///< of length 1; zero where nothing was found
    double distance;             ///< signed, about
  };

  /// In the solid's own frame, whose origin is its focus. Outside by GJK, inside by the shortest walk that
  /// is found.
  [[nodiscard]] Found operator()(const Coordinates<double>& q) const;

 private:
  [[nodiscard]] Found from_outside(const Coordinates<double>& q) const;

  SuperquadricSet<double> set_;
  Boundary<double> boundary_;
  bool tapered_;
};

}  // namespace verisq::verify
