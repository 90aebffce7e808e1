/// Which device makes a map, or why none does.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "host/batches/device_model.hpp"
#include "host/device/device.hpp"
#include "verisq/map.hpp"

namespace verisq {

struct ChosenDevice {
  std::optional<device::Device> device;  ///< nothing: the host does all
  std::string notice;                    ///< why a device was passed over; empty when nothing to say
  std::vector<device::Device> further;   ///< that work beside it

  [[nodiscard]] std::string name() const {
    if (!device) return "host";
    std::string names = device->name;
    for (const device::Device& other : further) names += " and " + other.name;
    return names;
  }
};

/// `primitives` are all that the device must be able to hold; `unsuited`, unless it is empty, says why none is to be
/// used. Throws as device::select_device.
[[nodiscard]] inline ChosenDevice chosen_device(const MapOptions& options, const Model& primitives,
                                                const std::string& unsuited) {
  if (options.device == "host") return {};
  device::Selection selection = device::select_device(options.device);
  if (!selection.device) return {std::nullopt, selection.notice, {}};
  if (std::string reason = device::why_not_on_devices(primitives); !reason.empty())
    return {std::nullopt, std::move(reason), {}};
  if (!unsuited.empty()) return {std::nullopt, unsuited, {}};
  return {std::move(selection.device), selection.notice, {}};
}

/// One, or as many as the options name: for maps of points about unions of convex solids. Throws likewise.
[[nodiscard]] inline ChosenDevice chosen_devices(const MapOptions& options, const Model& primitives) {
  const std::vector<std::string> requests = device::requests_in(options.device);
  MapOptions of_one = options;
  of_one.device = requests.front();
  ChosenDevice chosen = chosen_device(of_one, primitives, {});
  if (!chosen.device) return chosen;
  for (const std::string& request : std::span(requests).subspan(1))
    chosen.further.push_back(*device::select_device(request).device);
  return chosen;
}

}  // namespace verisq
