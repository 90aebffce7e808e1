/// The kernel of point_distance alone, on points that already lie on the device: no transfers, no fallback.
#pragma once

#include <memory>
#include <span>
#include <verisq/device.hpp>
#include <verisq/model.hpp>

namespace verisq::bench {

enum class KernelVariant {
  verified,     ///< proposes and proves: the kernel as the library runs it
  solver_only,  ///< built from the same source with SOLVER_ONLY defined: proposes, proves nothing
};

class PointDistanceKernel {
 public:
  /// Builds the kernel for the device and uploads the points, as many as fill whole vectors.
  PointDistanceKernel(const DeviceReport& device, KernelVariant variant, const Superquadric& solid,
                      std::span<const Point> points);
  ~PointDistanceKernel();
  PointDistanceKernel(PointDistanceKernel&&) noexcept;
  PointDistanceKernel& operator=(PointDistanceKernel&&) noexcept;

  [[nodiscard]] std::size_t points() const;

  /// One launch over all points; returns when it has finished.
  void run();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace verisq::bench
