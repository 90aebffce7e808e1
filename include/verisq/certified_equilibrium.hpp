/// Equilibria with what proves them again.
#pragma once

#include <cstdint>
#include <verisq/equilibrium_certificate.hpp>

namespace verisq::stance {

struct CertifiedEquilibrium {
  EquilibriumClaims claims;  ///< what the certificate proves: other formulas, so a little wider or narrower
  EquilibriumCertificate certificate;
  std::uint64_t left_out = 0;  ///< cells that are found to stand, of which no certificate was found
  bool interrupted = false;    ///< nothing is claimed then
};

/// Of what was found of this model, with the same control. Throws Error(input) as `equilibrium`.
[[nodiscard]] CertifiedEquilibrium certified_equilibrium(const Model& model, UncertainSet uncertain,
                                                         JointControl control, const Equilibrium& found,
                                                         const CheckOptions& options);

}  // namespace verisq::stance
