/// What a certificate file says to prove the distance of two models (docs/formats.md §9).
#pragma once

#include "host/files/json_document.hpp"
#include "verisq/pair_certificate.hpp"

namespace verisq {

/// Fails at what the format does not allow. Two separations, and two divisions, never are of the same primitives, so
/// that no more work can be asked for than there are pairs, and planes.
[[nodiscard]] PairCertificate read_pair_proof(const JsonValue& value);

/// One letter each, as the format has them.
[[nodiscard]] std::string text_of(const std::vector<SectionCut>& cuts);

}  // namespace verisq
