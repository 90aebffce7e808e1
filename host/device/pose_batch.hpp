/// Poses of a model B in, enclosures of its distances to a model A out, a chunk at a time.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "host/device/device.hpp"
#include "verisq/certificate.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/model.hpp"

namespace verisq::device {

/// As PointBatch. There are no certificates.
class PoseBatch {
 public:
  using Query = Pose;

  /// Throws Error(failure) with the name of a failed OpenCL call.
  PoseBatch(const Device& device, const Model& a, const Model& b);
  ~PoseBatch();
  PoseBatch(const PoseBatch&) = delete;
  PoseBatch& operator=(const PoseBatch&) = delete;

  [[nodiscard]] std::size_t capacity() const;
  void submit(std::span<const Pose> poses);
  void collect(std::vector<Enclosure>& enclosures, std::vector<Certificate>& certificates);
  void discard();
  [[nodiscard]] double device_seconds() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace verisq::device
