/// Everything that is to be known of one OpenCL device, in one JSON file: its self-test, a sample of soundness, rates.
///   on_device DEVICE OUT.json        DEVICE as `verisq map --device` takes it: "auto", an index, a part of a name
#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>
#include <verisq/device.hpp>
#include <verisq/version.hpp>

#include "bench/on_device/measured_rates.hpp"
#include "bench/on_device/sampled_soundness.hpp"
#include "host/command_line/summaries.hpp"
#include "host/device/device.hpp"

namespace verisq::bench {
namespace {

using command_line::JsonObject;
using command_line::JsonValue;

const DeviceReport& report_of(const std::vector<DeviceReport>& reports, const std::string& name) {
  const auto found = std::ranges::find(reports, name, &DeviceReport::name);
  if (found == reports.end()) throw std::runtime_error("no report on " + name);
  return *found;
}

JsonObject described(const DeviceReport& report, const cl::Device& device) {
  return {{"name", report.name},
          {"platform", report.platform},
          {"driver", report.driver},
          {"opencl", device.getInfo<CL_DEVICE_VERSION>()},
          {"compute_units", device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>()},
          {"megahertz", device.getInfo<CL_DEVICE_MAX_CLOCK_FREQUENCY>()},
          {"global_memory_bytes", device.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>()},
          {"points_per_work_item", report.vector_width},
          {"self_test", report.passed ? "passed" : report.failure}};
}

std::vector<JsonValue> rows_of(const std::vector<SoundnessSample>& samples) {
  std::vector<JsonValue> rows;
  rows.reserve(samples.size());
  for (const SoundnessSample& sample : samples)
    rows.push_back(JsonObject{{"queries", sample.queries},
                              {"judge", sample.judge},
                              {"cases", sample.cases},
                              {"proven_by_device", sample.by_device},
                              {"wrong", sample.wrong}});
  return rows;
}

std::vector<JsonValue> rows_of(const std::vector<MeasuredRate>& rates) {
  std::vector<JsonValue> rows;
  rows.reserve(rates.size());
  for (const MeasuredRate& rate : rates)
    rows.push_back(JsonObject{{"what", rate.what},
                              {"object", rate.object},
                              {"queries", rate.queries},
                              {"per_second", rate.per_second},
                              {"per_device_second", rate.per_device_second},
                              {"verified_by_device", rate.verified_fraction},
                              {"largest_width", rate.largest_width}});
  return rows;
}

void write(const std::string& path, const JsonValue& json) {
  std::ofstream file(path);
  file << json.indented_text() << '\n';
  if (!file.flush()) throw std::runtime_error("cannot write " + path);
}

int run(const std::string& request, const std::string& path) {
  const std::vector<DeviceReport> reports = test_devices();
  const device::Selection selection = device::select_device(request);  // throws for one that failed its self-test
  if (!selection.device) throw std::runtime_error(selection.notice);
  const std::string& name = selection.device->name;
  JsonObject json{{"verisq", VERISQ_VERSION},
                  {"device", described(report_of(reports, name), selection.device->device)}};

  fmt::print("{}: self-test passed\n", name);
  const std::vector<SoundnessSample> samples = sampled_soundness(request, VERISQ_EXAMPLES "/bent_stem.json");
  std::size_t wrong = 0;
  for (const SoundnessSample& sample : samples) {
    fmt::print("{:16} {:>9} cases beside {}, {} wrong\n", sample.queries, sample.cases, sample.judge,
               sample.wrong.size());
    for (const std::string& line : sample.wrong) fmt::print("  {}\n", line);
    wrong += sample.wrong.size();
  }
  json.set("soundness", rows_of(samples));

  const std::vector<MeasuredRate> rates = measured_rates(request, VERISQ_EXAMPLES);
  for (const MeasuredRate& rate : rates)
    fmt::print("{:16} {:16} {:>10.4g} a second, {:>10.4g} a second of kernels\n", rate.what, rate.object,
               rate.per_second, rate.per_device_second);
  json.set("rates", rows_of(rates));
  write(path, json);
  return wrong == 0 ? 0 : 1;
}

}  // namespace
}  // namespace verisq::bench

int main(int argc, char** argv) {
  try {
    const std::vector<std::string> arguments(argv + 1, argv + argc);
    if (arguments.size() == 2) return verisq::bench::run(arguments[0], arguments[1]);
    fmt::print(stderr, "usage: on_device DEVICE OUT.json\n");
  } catch (const std::exception& error) {
    fmt::print(stderr, "on_device: {}\n", error.what());
  }
  return 2;
}
