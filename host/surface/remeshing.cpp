/// CGAL's isotropic remeshing (GPL).
#include "host/surface/remeshing.hpp"

#include <CGAL/Polygon_mesh_processing/remesh.h>

#include "host/surface/cgal_mesh.hpp"

namespace verisq::surface {

Mesh remeshed(const Mesh& mesh, double edge) {
  constexpr unsigned rounds = 3;
  CgalMesh halfedges = halfedge_mesh(mesh);
  CGAL::Polygon_mesh_processing::isotropic_remeshing(faces(halfedges), edge, halfedges,
                                                     CGAL::parameters::number_of_iterations(rounds));
  return indexed_mesh(halfedges);
}

}  // namespace verisq::surface
