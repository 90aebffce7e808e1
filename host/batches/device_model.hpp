/// A model in the memory of a device, and how large its chunks are.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "host/device/device.hpp"
#include "verisq/model.hpp"

namespace verisq::device {

/// Why only the host can make maps and octrees of it; empty where devices can.
[[nodiscard]] std::string why_not_on_devices(const Model& model);
/// Likewise, for triangles and pairs.
[[nodiscard]] std::string why_not_as_triangles_or_pairs(const Model& model);

/// Largest magnitudes, in units of the model's largest semi-axis, that the kernels' arithmetic is made for; a model
/// beyond is the host's.
[[nodiscard]] bool within_device_range(const Model& model);

/// The primitives of both models, those of `a` first: a device holds them under one scale.
[[nodiscard]] Model joined(const Model& a, const Model& b);

/// What a processor's chunk holds of a small model. Long against a launch, short against a mesh, so that work overlaps.
inline constexpr std::size_t usual_processor_chunk = std::size_t{1} << 14U;

struct DeviceModel {
  DeviceModel(const Device& device, const Model& model, std::size_t processor_chunk = usual_processor_chunk);

  int scale_exponent;         ///< numbers of the device are model units times 2^scale_exponent
  cl::Buffer primitives;      ///< PrimitiveParameters of each
  std::size_t count;          ///< of primitives
  std::vector<bool> tapered;  ///< which of them
  std::string memory;         ///< option of programs that read them (model_memory.hpp)
  std::size_t chunk_size;     ///< queries a chunk may hold: memory stays bounded however large the model

  [[nodiscard]] bool has_tapered() const { return std::ranges::find(tapered, true) != tapered.end(); }
};

/// OpenCL implementations put off the end of compilation to the first launch: a chunk of so many queries makes them do
/// it before the first one of a map.
inline constexpr std::size_t queries_of_warm_up = 256;

/// A coordinate far from every model, in model units: what that chunk is filled with.
[[nodiscard]] double far_away(const DeviceModel& model);

}  // namespace verisq::device
