/// Small files that save work between runs: device programs and self-test outcomes. Losing them loses only time.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace verisq::device {

/// What was stored under `key`, all of it, or nothing. A damaged file is removed. The directory is
/// $XDG_CACHE_HOME/verisq or ~/.cache/verisq.
[[nodiscard]] std::optional<std::string> cached(std::string_view key);

/// Stores `content` under `key`; failing to is not an error. Other processes may do the same at the same time.
void store_in_cache(std::string_view key, std::string_view content);

}  // namespace verisq::device
