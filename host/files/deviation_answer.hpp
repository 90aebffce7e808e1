/// The kind `deviation` of certificate files: claims, and the distances that prove them (docs/formats.md §9).
#pragma once

#include "host/files/json_document.hpp"
#include "verisq/certificate_file.hpp"

namespace verisq {

/// Fails at the first value that is not such a one's.
[[nodiscard]] DeviationAnswer read_deviation(const JsonValue& root);

/// Keys "lo", "hi" and those of its certificate, and no others. Fails likewise.
[[nodiscard]] CertifiedEnclosure read_sample(const JsonValue& value);

/// The keys "pieces" and "samples" of an object: as many samples as pieces need. Fails likewise.
[[nodiscard]] TriangleProof read_triangle_proof(const JsonValue& value);

/// The keys "patches", "off" and "on" of an object: as many points as patches need. Fails likewise.
[[nodiscard]] SurfaceCover read_surface_cover(const JsonValue& value);

/// One letter each, as the format has them.
[[nodiscard]] std::string text_of(const std::vector<PieceProof>& pieces);
[[nodiscard]] std::string text_of(const std::vector<PatchProof>& patches);

}  // namespace verisq
