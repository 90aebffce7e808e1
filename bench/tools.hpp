/// What the benchmark programs agree on: how a device's rows are called, and how a whole set of points is mapped.
#pragma once

#include <algorithm>
#include <cctype>
#include <span>
#include <string>
#include <vector>
#include <verisq/device.hpp>
#include <verisq/map.hpp>

namespace verisq::bench {

/// "verisq_pocl", "verisq_nvidia_cuda": the first part of the names of a platform's rows.
[[nodiscard]] inline std::string tool_name(const DeviceReport& device) {
  if (device.platform == "Portable Computing Language") return "verisq_pocl";
  std::string name = "verisq_" + device.platform;
  std::ranges::transform(name, name.begin(), [](unsigned char c) {
    return std::isalnum(c) != 0 ? static_cast<char>(std::tolower(c)) : '_';
  });
  return name;
}

/// The first device of each platform that passed its self-test.
[[nodiscard]] inline std::vector<DeviceReport> usable_devices() {
  std::vector<DeviceReport> usable;
  for (const DeviceReport& device : test_devices()) {
    const bool is_new =
        std::ranges::none_of(usable, [&](const DeviceReport& other) { return other.platform == device.platform; });
    if (device.passed && is_new) usable.push_back(device);
  }
  return usable;
}

/// The enclosures of all points, triangles or poses, by the public interface: transfers, the host's fallback and
/// delivery included.
template <class Query>
MapSummary map_all(Mapper<Query>& mapper, std::span<const Query> queries, std::vector<Enclosure>& enclosures) {
  enclosures.clear();
  enclosures.reserve(queries.size());
  const auto next = [&queries](std::span<Query> chunk) {
    const std::size_t count = std::min(chunk.size(), queries.size());
    std::copy_n(queries.begin(), count, chunk.begin());
    queries = queries.subspan(count);
    return count;
  };
  const auto keep = [&enclosures](std::span<const Query>, std::span<const MapResult> results,
                                  std::span<const Certificate> /*none*/) {
    for (const MapResult& result : results) enclosures.push_back(result.distance);
  };
  return mapper.map(next, keep);
}

template <class Query>
MapSummary map_all(Mapper<Query>& mapper, const std::vector<Query>& queries, std::vector<Enclosure>& enclosures) {
  return map_all(mapper, std::span<const Query>(queries), enclosures);
}

}  // namespace verisq::bench
