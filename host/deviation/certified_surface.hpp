/// The certificate of how far a model's surface lies from a mesh: patches that cover it.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>

#include "host/threads/seen_interruption.hpp"
#include "verisq/deviation.hpp"
#include "verisq/deviation_certificate.hpp"

namespace verisq {

struct CertifiedSurface {
  std::optional<SurfaceProof> proof;
  std::string missing;  ///< why there is none; empty where there is one, or it is interrupted
};

/// Of what `deviation` found with the same arguments, in about so many `bytes` of a file, or nothing. Precondition:
/// `found.from_model`.
[[nodiscard]] CertifiedSurface certified_surface(const Model& model, const Mesh& mesh, const Deviation& found,
                                                 const DeviationOptions& options, std::size_t bytes,
                                                 const SeenInterruption& interrupted,
                                                 const std::function<void(double)>& progress);

}  // namespace verisq
