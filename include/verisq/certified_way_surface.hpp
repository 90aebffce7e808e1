/// The smallest distance of a whole surface along an implant's way in, with what proves it again.
#pragma once

#include <span>
#include <verisq/insertion.hpp>
#include <verisq/mesh_clearance.hpp>
#include <verisq/way_surface_certificate.hpp>

namespace verisq {

struct CertifiedWaySurface {
  Enclosure smallest_distance{};  ///< what the certificate proves
  WaySurfaceCertificate certificate;
  bool interrupted = false;  ///< then there is neither
};

/// Of what `mesh_clearance_along` found with the same arguments, and of what certificates prove of each vertex
/// (certified_insertion.hpp). About as tight as what was found, and wider where a certificate would have too many
/// cells. No device is used. Throws Error(input) as WaySurfaceChecker.
[[nodiscard]] CertifiedWaySurface certified_way_surface(std::span<const Pose> path, const Model& implant,
                                                        const Mesh& bone, std::span<const Enclosure> of_vertices,
                                                        const MeshClearance& found, const InsertionOptions& options);

}  // namespace verisq
