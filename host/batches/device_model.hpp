/// A model in the memory of a device, and how large its chunks are.
#pragma once

#include <string>

#include "host/device/device.hpp"
#include "verisq/model.hpp"

namespace verisq::device {

/// Largest magnitudes, in units of the model's largest semi-axis, that the kernels' arithmetic is made for; a model
/// beyond is the host's.
[[nodiscard]] bool within_device_range(const Model& model);

/// The primitives of both models, those of `a` first: a device holds them under one scale.
[[nodiscard]] Model joined(const Model& a, const Model& b);

struct DeviceModel {
  DeviceModel(const Device& device, const Model& model);

  int scale_exponent;      ///< numbers of the device are model units times 2^scale_exponent
  cl::Buffer primitives;   ///< PrimitiveParameters of each
  std::size_t count;       ///< of primitives
  std::string memory;      ///< option of programs that read them (model_memory.hpp)
  std::size_t chunk_size;  ///< queries a chunk may hold: memory stays bounded however large the model
};

/// A coordinate far from every model, in model units: what a chunk that only warms up is filled with.
[[nodiscard]] double far_away(const DeviceModel& model);

}  // namespace verisq::device
