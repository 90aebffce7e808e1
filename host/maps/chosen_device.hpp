/// Which device makes a map, or why none does.
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "host/batches/device_model.hpp"
#include "host/device/device.hpp"
#include "verisq/map.hpp"

namespace verisq {

struct ChosenDevice {
  std::optional<device::Device> device;  ///< nothing: the host does all
  std::string notice;                    ///< why a device was passed over; empty when nothing to say

  [[nodiscard]] std::string name() const { return device ? device->name : "host"; }
};

/// `primitives` are all that the device must be able to hold; `unsuited`, unless it is empty, says why none is to be
/// used. Throws as device::select_device.
[[nodiscard]] inline ChosenDevice chosen_device(const MapOptions& options, const Model& primitives,
                                                const std::string& unsuited) {
  if (options.device == "host") return {};
  device::Selection selection = device::select_device(options.device);
  if (!selection.device) return {std::nullopt, selection.notice};
  if (std::string reason = device::why_not_on_devices(primitives); !reason.empty())
    return {std::nullopt, std::move(reason)};
  if (!unsuited.empty()) return {std::nullopt, unsuited};
  return {std::move(selection.device), selection.notice};
}

}  // namespace verisq
