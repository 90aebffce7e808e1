/// This file implements the choice of a device and the cache of self-test outcomes.
#include "host/device/device.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <sstream>

#include "host/device/opencl_library.hpp"
#include "host/device/sample_operations.hpp"
#include "host/threads/background_work.hpp"
#include "verisq/device.hpp"
#include "verisq/error.hpp"

namespace verisq::device {
namespace {

std::vector<cl::Device> all_devices() {
  std::vector<cl::Platform> platforms;
  try {
    cl::Platform::get(&platforms);
  } catch (const cl::Error&) {
    return {};  // the loader reports "no platform" as an error
  }
  std::vector<cl::Device> devices;
  for (const cl::Platform& platform : platforms) {
    std::vector<cl::Device> own;
    try {
      platform.getDevices(CL_DEVICE_TYPE_ALL, &own);
    } catch (const cl::Error&) {
      continue;  // a platform without devices
    }
    devices.insert(devices.end(), own.begin(), own.end());
  }
  return devices;
}

// Processors vectorise explicit vector types only; two registers a value hide the latency of the long dependency
// chains (measured: 1.2 times the speed of one register for interior_depth). Others vectorise across work-items.
int vector_width(const cl::Device& device) {
  if ((device.getInfo<CL_DEVICE_TYPE>() & CL_DEVICE_TYPE_CPU) == 0) return 1;
  const auto native = static_cast<int>(device.getInfo<CL_DEVICE_NATIVE_VECTOR_WIDTH_DOUBLE>());
  return native >= 8 ? 16 : native >= 4 ? 8 : native >= 2 ? 4 : 1;
}

struct Opened {
  Device device;
  LoadedProgram self_test;
};

bool is_in_path(std::string_view program) {
  const char* const path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');)
    if (access((std::filesystem::path(folder) / program).c_str(), X_OK) == 0) return true;
  return false;
}

// PoCL links each kernel by `ld`, and ends the whole process where there is none.
bool lacks_linker(const cl::Device& device) {
  const cl::Platform platform(device.getInfo<CL_DEVICE_PLATFORM>());
  const bool links = platform.getInfo<CL_PLATFORM_NAME>() == "Portable Computing Language" &&
                     (device.getInfo<CL_DEVICE_TYPE>() & CL_DEVICE_TYPE_CPU) != 0;
  return links && !is_in_path("ld");
}

void require_linker(const cl::Device& device) {
  if (lacks_linker(device))
    throw Error(ErrorKind::failure,
                "PoCL links kernels by ld, which is not in PATH (Debian's package binutils has it)");
}

// Throws where it cannot be used at all.
Opened open(const cl::Device& device) {
  require_linker(device);
  if (device.getInfo<CL_DEVICE_DOUBLE_FP_CONFIG>() == 0)
    throw Error(ErrorKind::failure, "no binary64 arithmetic (cl_khr_fp64)");
  const cl::Context context(device);
  const int width = vector_width(device);
  return {{device.getInfo<CL_DEVICE_NAME>(), device, context, width,
           static_cast<std::size_t>(device.getInfo<CL_DEVICE_MAX_CONSTANT_BUFFER_SIZE>())},
          load_program(context, device, width, self_test_sources())};
}

// The first failure of the self-test, or an empty string. It comes from the cache if the same self-test has tried the
// same binary on the same device and driver.
std::string self_test_failure(const Opened& opened) {
  const Device& device = opened.device;
  const std::string& binary = opened.self_test.binary;
  const auto tried = [&] {
    return self_test(device.context, device.device, opened.self_test.program, device.vector_width);
  };
  if (binary.empty()) return tried();  // another run may get another one
  const std::string key =
      fmt::format("self-test {}\n{}\n{}\nbinary of {} bytes, CRC-64 {:016x}\n{}", VERISQ_SELF_TEST_DIGEST,
                  identity(device.device), device.vector_width, binary.size(), checksum(binary), self_test_sources());
  return remembered_failure(key, tried);
}

struct Tested {
  std::optional<Device> device;  // nothing when it failed
  std::string failure;
};

Tested test(const cl::Device& device) {
  try {
    const Opened opened = open(device);
    std::string failure = self_test_failure(opened);
    if (failure.empty()) return {opened.device, {}};
    return {std::nullopt, std::move(failure)};
  } catch (const cl::Error& error) {
    return {std::nullopt, fmt::format("{} failed with OpenCL error {}", error.what(), error.err())};
  } catch (const Error& error) {
    return {std::nullopt, error.what()};
  }
}

// The devices that passed their self-test in this process. They keep their context, and so the programs that were
// compiled for it (host/device/program.cpp): a second mapper is ready at once.
class ReadyDevices {
 public:
  // Never destroyed: a compilation that was given up may end while the process exits.
  static ReadyDevices& of_process() {
    static auto* const devices = new ReadyDevices;  // NOLINT(cppcoreguidelines-*): locked, and never destroyed
    return *devices;
  }

  std::optional<Device> find(const cl::Device& device) {
    const std::lock_guard lock(mutex_);
    const auto known = std::ranges::find_if(devices_, [&](const Device& d) { return d.device() == device(); });
    if (known == devices_.end()) return std::nullopt;
    return *known;
  }

  void keep(const Device& device) {
    const std::lock_guard lock(mutex_);
    devices_.push_back(device);
  }

 private:
  std::mutex mutex_;
  std::vector<Device> devices_;
};

// Like `test`, but a device that passed before in this process is ready at once.
Tested tested_once(const cl::Device& device) {
  ReadyDevices& devices = ReadyDevices::of_process();
  if (std::optional<Device> known = devices.find(device); known && !lacks_linker(device)) return {std::move(known), {}};
  Tested tested = test(device);
  if (tested.device) devices.keep(*tested.device);
  return tested;
}

std::string why_no_device() {
  const std::string missing = missing_opencl_library();
  return missing.empty() ? "no OpenCL device found" : fmt::format("no OpenCL library ({})", missing);
}

Selection select_automatically(std::vector<cl::Device> devices) {
  if (devices.empty()) return {std::nullopt, why_no_device()};
  const auto is_gpu = [](const cl::Device& device) {
    return (device.getInfo<CL_DEVICE_TYPE>() & CL_DEVICE_TYPE_GPU) != 0;
  };
  std::stable_partition(devices.begin(), devices.end(), is_gpu);
  Selection selection;
  for (const cl::Device& device : devices) {
    Tested tested = tested_once(device);
    if (tested.device) {
      selection.device = std::move(tested.device);
      return selection;
    }
    selection.notice += fmt::format("{}refused {}: {}", selection.notice.empty() ? "" : "; ",
                                    device.getInfo<CL_DEVICE_NAME>(), tested.failure);
  }
  return selection;
}

std::optional<std::size_t> as_index(std::string_view text) {
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), index);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return index;
}

const cl::Device* find(const std::vector<cl::Device>& devices, std::string_view request) {
  if (const auto index = as_index(request)) return *index < devices.size() ? &devices[*index] : nullptr;
  const auto match = std::find_if(devices.begin(), devices.end(), [request](const cl::Device& device) {
    return device.getInfo<CL_DEVICE_NAME>().find(request) != std::string::npos;
  });
  return match == devices.end() ? nullptr : &*match;
}

std::vector<std::string> parts_of(std::string_view request) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (std::size_t end = 0; end != std::string_view::npos; begin = end + 1) {
    end = request.find(',', begin);
    parts.emplace_back(request.substr(begin, end - begin));
  }
  return parts;
}

bool all_found(const std::vector<cl::Device>& devices, const std::vector<std::string>& parts) {
  return std::ranges::all_of(parts,
                             [&](const std::string& part) { return !part.empty() && find(devices, part) != nullptr; });
}

std::string known_devices(const std::vector<cl::Device>& devices) {
  std::vector<std::string> known;
  for (std::size_t i = 0; i < devices.size(); ++i)
    known.push_back(fmt::format("{} = {}", i, devices[i].getInfo<CL_DEVICE_NAME>()));
  known.emplace_back("auto");
  known.emplace_back("host");
  return fmt::format("{}", fmt::join(known, ", "));
}

void add_to(std::string& notice, std::string_view reason) {
  notice += fmt::format("{}{}", notice.empty() ? "" : "; ", reason);
}

}  // namespace

RefusedDevice::RefusedDevice(const std::string& name, const std::string& failure)
    : Error(ErrorKind::failure, fmt::format("refused {}: {}", name, failure)) {}

Selection select_device(std::string_view request) {
  const std::vector<cl::Device> devices = all_devices();
  if (request == "auto") return select_automatically(devices);
  const cl::Device* const chosen = find(devices, request);
  if (chosen == nullptr && request.find(',') != std::string_view::npos && all_found(devices, parts_of(request)))
    throw Error(ErrorKind::input,
                fmt::format("`device` {}: several devices make maps of points about unions of convex solids alone, "
                            "without certificates; give one",
                            request));
  if (chosen == nullptr)
    throw Error(ErrorKind::input,
                fmt::format("`device` {}: no such device (known: {})", request, known_devices(devices)));
  Tested tested = tested_once(*chosen);
  if (!tested.device)
    throw Error(ErrorKind::input,
                fmt::format("`device` {}: refused {}: {}", request, chosen->getInfo<CL_DEVICE_NAME>(), tested.failure));
  return {std::move(tested.device), {}};
}

Selection select_device(std::string_view request, const std::function<bool()>& ended) {
  WorkThatMayBeGivenUp<Selection> work([name = std::string(request)] { return select_device(name); });
  if (std::optional<Selection> selection = work.result(ended)) return *std::move(selection);
  Selection none;
  note_early_end(none.notice);
  return none;
}

void note_refusal(std::string& notice, std::string_view request, const RefusedDevice& refused) {
  if (request != "auto") throw Error(ErrorKind::input, fmt::format("`device` {}: {}", request, refused.what()));
  add_to(notice, refused.what());
}

void note_early_end(std::string& notice) {
  add_to(notice, "the work ended before the device's kernels were compiled");
}

std::vector<std::string> requests_in(std::string_view request) {
  const std::vector<cl::Device> devices =
      request.find(',') == std::string_view::npos ? std::vector<cl::Device>() : all_devices();
  const std::vector<std::string> parts = parts_of(request);
  if (parts.size() < 2 || find(devices, request) != nullptr || !all_found(devices, parts))
    return {std::string(request)};
  std::vector<const cl::Device*> found;
  for (const std::string& part : parts) {
    const cl::Device* const device = find(devices, part);
    if (std::ranges::find(found, device) != found.end())
      throw Error(ErrorKind::input, fmt::format("`device` {}: {} is named twice", request, part));
    found.push_back(device);
  }
  return parts;
}

}  // namespace verisq::device

namespace verisq {

std::vector<DeviceReport> test_devices() {
  std::vector<DeviceReport> reports;
  for (const cl::Device& device : device::all_devices()) {
    const device::Tested tested = device::test(device);
    const cl::Platform platform(device.getInfo<CL_DEVICE_PLATFORM>());
    reports.push_back({reports.size(), device.getInfo<CL_DEVICE_NAME>(), platform.getInfo<CL_PLATFORM_NAME>(),
                       device.getInfo<CL_DRIVER_VERSION>(), device::vector_width(device), tested.device.has_value(),
                       tested.failure});
  }
  return reports;
}

void leave_compilations_at_exit() {
  GivenUpThreads::leave_at_exit();
}

}  // namespace verisq
