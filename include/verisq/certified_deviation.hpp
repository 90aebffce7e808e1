/// How far a mesh and a model's surface lie apart, with what proves it again.
#pragma once

#include <cstddef>
#include <string>
#include <verisq/deviation.hpp>
#include <verisq/deviation_certificate.hpp>

namespace verisq {

struct CertifiedDeviation {
  ProvenDeviation proven;  ///< what the certificate proves; `interrupted`: there is none
  DeviationCertificate certificate;
  std::string without_surface;  ///< why it says nothing of the model's surface; empty where it does, or none was found
};

/// Of what `deviation` found with the same arguments: from the mesh to the model vertices, and of a mesh with triangles
/// all of their points; where it is found, the largest distance of the model's surface from the mesh. Largest distances
/// are about as tight as those found; mean and percentiles, of the mesh alone, as the samples leave them, of which
/// those that nothing else needs are left out where the certificate would take more than about so many `bytes` as a
/// file (verisq/certificate_file.hpp); what the model's surface takes is at most half of that. Uses no device;
/// `progress`, `interrupted` as there, no time limit. Precondition: `found` is not interrupted.
[[nodiscard]] CertifiedDeviation certified_deviation(const Model& model, const Mesh& mesh, const Deviation& found,
                                                     const DeviationOptions& options, std::size_t bytes = 64'000'000);

}  // namespace verisq
