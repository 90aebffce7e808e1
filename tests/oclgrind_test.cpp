/// The kernels on Oclgrind, a simulated device that watches every access to memory: nothing beyond a buffer, no data
/// race. A small map: the simulator takes a millisecond for what others do in a microsecond. Its search for
/// uninitialised values stays off: Oclgrind 21.10 reports all work-items of a group but the first, on the same data.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "host/device/batch.hpp"
#include "host/device/program.hpp"
#include "tests/temporary_folder.hpp"
#include "verisq/checker.hpp"

namespace verisq::device {
namespace {

constexpr const char* simulator = "/usr/lib/oclgrind/liboclgrind-rt-icd.so";  // Debian's package oclgrind

void set(const char* variable, const std::string& value) {
  ASSERT_EQ(setenv(variable, value.c_str(), 1), 0) << variable;
}

/// OpenCL is opened at the first call: until then the environment decides which platforms there are.
class OclgrindTest : public ::testing::TestWithParam<int> {
 protected:
  void SetUp() override {
    ASSERT_TRUE(std::filesystem::exists(simulator)) << simulator << " is missing: install the Debian package oclgrind";
    const std::string icd = (folder / "oclgrind.icd").string();
    std::ofstream(icd) << simulator << "\n";
    set("OCL_ICD_VENDORS", icd);
    set("OCLGRIND_LOG", log_path());
    set("OCLGRIND_DATA_RACES", "1");
    set("OCLGRIND_CHECK_API", "1");
    set("XDG_CACHE_HOME", folder.path().string());
  }

  [[nodiscard]] std::string log_path() const { return (folder / "oclgrind.log").string(); }

  /// Everything that the simulator found.
  [[nodiscard]] std::string findings() const {
    std::ifstream log(log_path());
    return {std::istreambuf_iterator<char>(log), {}};
  }

  const testing::TemporaryFolder folder;
};

Device oclgrind(int vector_width) {
  std::vector<cl::Platform> platforms;
  cl::Platform::get(&platforms);
  std::vector<cl::Device> devices;
  platforms.at(0).getDevices(CL_DEVICE_TYPE_ALL, &devices);
  const cl::Device& device = devices.at(0);
  const cl::Context context(device);
  return {device.getInfo<CL_DEVICE_NAME>(), device, context, build_program(context, device, vector_width),
          vector_width};
}

/// Two solids that overlap, one of them posed, and points outside, inside one and inside both.
const Model model{"",
                  {{"ball", {{1.0, 1.0, 1.0}, {1.0, 1.0}}, {}},
                   {"soap", {{0.9, 0.5, 1.2}, {0.4, 1.6}}, {{0.8, 0.1, 0.0}, {1.0, 0.2, 0.3, 0.4}}}}};
const std::vector<Point> points{{3.0, 1.0, -2.0}, {0.0, 0.0, 1.5}, {-0.5, 0.1, 0.2}, {0.6, 0.1, 0.1}, {1.3, 0.2, 0.0}};

TEST_P(OclgrindTest, FindsNothingInAMap) {
  const Device device = oclgrind(GetParam());
  ASSERT_THAT(device.name, ::testing::HasSubstr("Oclgrind"));
  Batch batch(device, model, 1e-2, true, points.size());
  batch.submit(points);
  std::vector<Enclosure> enclosures;
  std::vector<Certificate> certificates;
  batch.collect(enclosures, certificates);
  const Checker check(model);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(check(points[i], enclosures[i], certificates[i]).verdict, Verdict::proved) << "point " << i;
  }
  EXPECT_EQ(findings(), "");
}

INSTANTIATE_TEST_SUITE_P(VectorWidths, OclgrindTest, ::testing::Values(1, 4), ::testing::PrintToStringParamName());

/// That silence means something: a read beyond a buffer is reported.
TEST_F(OclgrindTest, ReportsAReadBeyondABuffer) {
  const Device device = oclgrind(1);
  cl::Program program(device.context, "kernel void beyond(global const int* in, global int* out) { *out = in[1]; }");
  program.build({device.device});
  cl::Kernel kernel(program, "beyond");
  kernel.setArg(0, cl::Buffer(device.context, CL_MEM_READ_WRITE, sizeof(int)));
  const cl::Buffer out(device.context, CL_MEM_READ_WRITE, sizeof(int));
  kernel.setArg(1, out);
  cl::CommandQueue queue(device.context, device.device);
  queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(1));
  queue.finish();
  EXPECT_THAT(findings(), ::testing::HasSubstr("Invalid read"));
}

}  // namespace
}  // namespace verisq::device
