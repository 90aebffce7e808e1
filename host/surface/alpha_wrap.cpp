/// CGAL's alpha wrapping (GPL).
#include "host/surface/alpha_wrap.hpp"

#include <CGAL/alpha_wrap_3.h>

#include "host/surface/cgal_mesh.hpp"

namespace verisq::surface {

Mesh alpha_wrap(const Mesh& input, double alpha, double offset) {
  CgalMesh wrap;
  if (input.triangles.empty()) {
    CGAL::alpha_wrap_3(cgal_points(input.vertices), alpha, offset, wrap);
  } else {
    const TriangleSoup soup = triangle_soup(input);
    CGAL::alpha_wrap_3(soup.points, soup.triangles, alpha, offset, wrap);
  }
  return indexed_mesh(wrap);
}

}  // namespace verisq::surface
