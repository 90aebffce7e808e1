/// How large a certificate file may be, for its reader and its writer.
#pragma once

#include <cstddef>

namespace verisq {

/// Bytes, as of a model file.
constexpr std::size_t largest_certificate = std::size_t{1} << 26;

}  // namespace verisq
