/// An OpenCL device that passed its self-test.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/device/opencl.hpp"
#include "host/threads/background_work.hpp"
#include "verisq/error.hpp"

namespace verisq::device {

/// Copies share the OpenCL objects, which release themselves.
struct Device {
  std::string name;
  cl::Device device;
  cl::Context context;
  int vector_width;             ///< points a work-item
  std::size_t constant_memory;  ///< bytes that a buffer in constant memory may have: 64 KiB on many graphics processors
};

/// A device, whose arithmetic passed, erred on samples of a program (host/device/program_self_test.hpp): nothing that
/// it computes is to be used. The message is that of a notice.
class RefusedDevice : public Error {
 public:
  RefusedDevice(const std::string& name, const std::string& failure);
};

/// The requested device ("auto", an index or a part of a name; see `test_devices`). Nothing if "auto" finds none that
/// passes; `notice` then gives the reason. Throws Error(input) if a request matches no device, or one that failed its
/// self-test.
struct Selection {
  std::optional<Device> device;
  std::string notice;
};
[[nodiscard]] Selection select_device(std::string_view request);

/// The same, but no device, with a notice, once `ended` returns true: the kernels of a self-test compile for seconds.
[[nodiscard]] Selection select_device(std::string_view request, const std::function<bool()>& ended);

/// Adds the refusal to the notice; the host steps in. Throws Error(input) if `request` named the device.
void note_refusal(std::string& notice, std::string_view request, const RefusedDevice& refused);
/// Adds that the work ended before the kernels were compiled.
void note_early_end(std::string& notice);

/// Makes the selected device ready by `make`, which must own all that it uses: it may be given up. Returns nothing if
/// there is no device. If the device errs on samples, or `ended` returns true first: returns nothing, clears the device
/// and gives the reason in the notice. Throws like note_refusal.
template <class Make>
[[nodiscard]] auto made_ready(Selection& selection, std::string_view request, const std::function<bool()>& ended,
                              const Make& make) -> decltype(make(*selection.device)) {
  if (!selection.device) return nullptr;
  try {
    using Ready = decltype(make(*selection.device));
    WorkThatMayBeGivenUp<Ready> work([make, device = *selection.device] { return make(device); });
    if (std::optional<Ready> ready = work.result(ended)) return *std::move(ready);
    note_early_end(selection.notice);
  } catch (const RefusedDevice& refused) {
    note_refusal(selection.notice, request, refused);
  }
  selection.device.reset();
  return nullptr;
}

/// The requests for one device each, from a request for several: indices or parts of names with commas between, at
/// least one. Names may contain commas, too. Throws Error(input) if one of them requests no device, or a device that
/// another one requests.
[[nodiscard]] std::vector<std::string> requests_in(std::string_view request);

}  // namespace verisq::device
