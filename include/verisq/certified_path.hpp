/// The smallest distance of two models of which one moves, with what proves it again.
#pragma once

#include <span>
#include <verisq/path_certificate.hpp>
#include <verisq/path_distance.hpp>

namespace verisq {

struct CertifiedPath {
  PathClaims claims;  ///< what the certificate proves
  PathCertificate certificate;
  bool interrupted;
};

/// Of what `distance_along` found with the same arguments: about as tight, and wider where the certificates of pairs
/// are (verisq/model_search.hpp) or too many parts would be needed. Interrupted, it holds what is proven by then.
[[nodiscard]] CertifiedPath certified_path(std::span<const Pose> path, const Model& a, const Model& b,
                                           const PathDistance& found, const PathDistanceOptions& options);

}  // namespace verisq
