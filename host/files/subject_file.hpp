/// The file that an answer is about, as certificates and parts of maps name it: by its digest.
#pragma once

#include <array>

#include "host/files/json_document.hpp"
#include "verisq/certificate_file.hpp"

namespace verisq {

/// {"file", "sha256"}; fails at the value unless the digest is 64 lower-case hexadecimal digits.
[[nodiscard]] SubjectFile read_subject_file(const JsonValue& value);

/// An array of those of model A and of model B.
[[nodiscard]] std::array<SubjectFile, 2> read_two_models(const JsonValue& value);

}  // namespace verisq
