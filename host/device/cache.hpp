/// Small files that save work between runs: device programs and outcomes of self-tests. Losing them loses only time.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace verisq::device {

// Small files that save work between runs: device programs and self-test outcomes. Losing them loses only time.

/// The whole content stored under `key`, or nothing. A damaged file is removed. The directory is $XDG_CACHE_HOME/verisq
/// or ~/.cache/verisq.
[[nodiscard]] std::optional<std::string> cached(std::string_view key);

/// Stores `content` under `key`; failing to is not an error. Other processes may do the same at the same time.
void store_in_cache(std::string_view key, std::string_view content);

// Checksums that reveal damaged files, and distinguish device programs.

/// CRC-64/XZ (the polynomial of ECMA-182), the same in every build. Finds every damage within 64 consecutive bits, and
/// all other damage but for one case in 2^64. It does not protect against forgery.
[[nodiscard]] std::uint64_t checksum(std::string_view bytes);

// Outcomes of self-tests in the cache: each is tried once, and believed only where the cache states it in full.

/// The first failure of a self-test, or an empty string: the result in the cache under `key`, else the result of
/// `tried`, which the cache keeps from then on. With an empty key nothing is remembered.
[[nodiscard]] std::string remembered_failure(const std::string& key, const std::function<std::string()>& tried);

}  // namespace verisq::device
