/// Turns what the kernels found about a point into the certificate of its enclosure.
#pragma once

#include <vector>

#include "verisq/certificate.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/model.hpp"

namespace verisq::device {

/// In model units. Nothing here needs to be true: certificates are proposals until they are checked.
struct Evidence {
  struct OfPrimitive {
    double hi;     ///< upper end for this primitive alone; infinite where it was passed over
    Point normal;  ///< of the lower end, of any length
  };
  std::vector<OfPrimitive> primitives;
  Point escape;  ///< meaningful where the union's lower end is finite and not positive
};

/// Of each primitive, the same about a triangle, and where on it the upper end's point lies.
struct TriangleEvidenceOfPrimitive {
  Evidence::OfPrimitive bounds;
  std::array<double, 2> weights;
};
using TriangleEvidence = std::vector<TriangleEvidenceOfPrimitive>;

/// With every normal that a kernel found: a primitive without one is far by its bounding sphere.
[[nodiscard]] Certificate certificate_of(const TriangleEvidence& evidence);

class CertificateAssembly {
 public:
  explicit CertificateAssembly(const Model& model);

  /// As few normals as prove the enclosure: outside, those of the primitives whose bounding sphere is too near; inside,
  /// that of the primitive that decides the upper end.
  [[nodiscard]] Certificate operator()(const Point& point, const Enclosure& distance, const Evidence& evidence) const;

 private:
  struct Sphere {
    Point centre;
    double radius;
  };

  [[nodiscard]] static bool clear_of_sphere(const Point& point, double distance, const Sphere& sphere);

  std::vector<Sphere> spheres_;  ///< about each primitive
};

}  // namespace verisq::device
