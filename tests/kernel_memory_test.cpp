/// The kernels' memory accesses on Oclgrind, launched here on buffers that are exact and not initialised: no access
/// beyond a buffer or an array, no read of what was never written, no data race. (On the host's buffers its search for
/// uninitialised values is of no use: Oclgrind 21.10 takes a buffer that clEnqueueFillBuffer filled for one that nobody
/// wrote.)
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "host/device/primitive_parameters.hpp"
#include "host/device/self_test.hpp"
#include "kernels/embedded_sources.hpp"
#include "tests/oracle/random_cases.hpp"
#include "tests/temporary_folder.hpp"

namespace verisq::device {
namespace {

using ::testing::HasSubstr;

constexpr const char* simulator = "/usr/lib/oclgrind/liboclgrind-rt-icd.so";  // Debian's package oclgrind

/// Buffers of exactly the size that a launch needs, so that oclgrind sees the first access beyond; what kernels are to
/// write is not initialised.
class KernelRun {
 public:
  KernelRun(const cl::Context& context, const cl::Device& device, const cl::Program& program, int width)
      : context_(context),
        queue_(context, device),
        program_(program),
        points_(groups * static_cast<std::size_t>(width)) {
    std::vector<PrimitiveParameters> parameters;
    for (const Primitive& primitive : model.primitives)
      parameters.push_back(primitive_parameters(primitive, scale_exponent(model)));
    primitives_ = cl::Buffer(context_, CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR,
                             parameters.size() * sizeof(PrimitiveParameters), parameters.data());
    for (cl::Buffer& column : per_primitive_) column = numbers(points_ * model.primitives.size());
    scratch_ = numbers(points_ * scratch_per_point);
    nearest_ = numbers(points_);
    for (cl::Buffer& column : result_) column = numbers(points_);
    write_points();
  }

  /// A whole map, as host/device/batch.cpp has it made.
  void map() {
    for (cl_uint index = 0; index < model.primitives.size(); ++index) {
      std::array<cl::Buffer, 5> own;
      for (std::size_t i = 0; i < own.size(); ++i) {
        const cl_buffer_region region{index * points_ * sizeof(double), points_ * sizeof(double)};
        own[i] = per_primitive_[i].createSubBuffer(CL_MEM_READ_WRITE, CL_BUFFER_CREATE_TYPE_REGION, &region);
      }
      launch("point_distance", cl_ulong{groups}, coordinates_, primitives_, index, nearest_, own);
      launch("interior_depth", cl_ulong{groups}, groups_per_block, coordinates_, primitives_, index, tolerance,
             scratch_, own);
    }
    launch("union_distance", cl_ulong{groups}, cl_ulong{points_}, coordinates_, primitives_,
           static_cast<cl_uint>(model.primitives.size()), per_primitive_, result_);
    queue_.finish();
  }

 private:
  static constexpr std::size_t groups = 13;
  static constexpr cl_uint groups_per_block = 4;
  static constexpr std::size_t work_items = 16;  // more than there are groups: some have nothing to do
  static constexpr std::size_t work_group = 8;
  static constexpr std::size_t scratch_per_point = 8;  // SCRATCH_SIZE in kernels/interior_depth.cl
  static constexpr double tolerance = 1e-3;

  inline static const Model model{"",
                                  {{"one", {{1.0, 1.5, 0.6}, {1.0, 1.2}}, {}},
                                   {"other", {{0.4, 1.0, 1.2}, {0.5, 1.8}}, {{1.0, 0.0, 0.0}, {1.0, 1.0, 1.0, 1.0}}}}};

  [[nodiscard]] cl::Buffer numbers(std::size_t count) const {
    return {context_, CL_MEM_READ_WRITE, count * sizeof(double)};
  }

  // On all sides of the surfaces.
  void write_points() {
    oracle::RandomCases random(1);
    std::array<std::vector<double>, 3> columns;
    for (std::size_t i = 0; i < points_; ++i) {
      const Point point = random.point(model.primitives[i % model.primitives.size()]).point;
      for (std::size_t k = 0; k < 3; ++k) columns[k].push_back(point[k]);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      coordinates_[k] = numbers(points_);
      queue_.enqueueWriteBuffer(coordinates_[k], CL_TRUE, 0, points_ * sizeof(double), columns[k].data());
    }
  }

  template <class... Arguments>
  void launch(const char* name, const Arguments&... arguments) {
    cl::Kernel kernel(program_, name);
    cl_uint next = 0;
    (set(kernel, next, arguments), ...);
    queue_.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(work_items), cl::NDRange(work_group));
  }

  template <class Argument>
  static void set(cl::Kernel& kernel, cl_uint& next, const Argument& argument) {
    kernel.setArg(next++, argument);
  }
  template <std::size_t count>
  static void set(cl::Kernel& kernel, cl_uint& next, const std::array<cl::Buffer, count>& buffers) {
    for (const cl::Buffer& buffer : buffers) kernel.setArg(next++, buffer);
  }

  cl::Context context_;
  cl::CommandQueue queue_;
  cl::Program program_;
  std::size_t points_;
  cl::Buffer primitives_;
  std::array<cl::Buffer, 3> coordinates_;
  cl::Buffer nearest_;
  cl::Buffer scratch_;
  std::array<cl::Buffer, 5> per_primitive_;
  std::array<cl::Buffer, 5> result_;  // union's ends and escape
};

class KernelMemoryTest : public ::testing::TestWithParam<int> {
 protected:
  // The loader of OpenCL takes oclgrind for the only device. (`oclgrind PROGRAM` would preload a loader of its own,
  // which a program that opens libOpenCL itself does not see.) To be set before the first call of OpenCL.
  void SetUp() override {
    ASSERT_TRUE(std::filesystem::exists(simulator)) << simulator << " is missing: install the Debian package oclgrind";
    set("OCL_ICD_VENDORS", simulator);
    set("OCLGRIND_LOG", log_);
    set("OCLGRIND_CHECK_API", "1");
    set("OCLGRIND_DATA_RACES", "1");
    set("OCLGRIND_UNINITIALIZED", "1");
  }

  static void set(const char* name, const std::string& value) { setenv(name, value.c_str(), 1); }

  /// What `use(context, device, program)` makes oclgrind report.
  template <class Use>
  std::string reported(const std::string& sources, const Use& use) const {
    std::vector<cl::Platform> platforms;
    cl::Platform::get(&platforms);
    std::vector<cl::Device> devices;
    platforms.at(0).getDevices(CL_DEVICE_TYPE_ALL, &devices);
    EXPECT_EQ(devices.at(0).getInfo<CL_DEVICE_NAME>(), "Oclgrind Simulator");
    const cl::Context context(devices[0]);
    const cl::Program program(context, sources);
    program.build({devices[0]}, fmt::format("-cl-std=CL1.2 -DVECTOR_WIDTH={}", GetParam()).c_str());
    use(context, devices[0], program);
    return folder_.contents("oclgrind.log");
  }

  std::string reported_of_map(const std::string& sources) const {
    return reported(sources, [](const cl::Context& context, const cl::Device& device, const cl::Program& program) {
      KernelRun(context, device, program, GetParam()).map();
    });
  }

  /// The kernels with one text replaced.
  static std::string broken(std::string_view text, std::string_view replacement) {
    std::string sources(kernels::embedded_sources());
    const std::size_t at = sources.find(text);
    EXPECT_NE(at, std::string::npos) << "the kernels no longer contain " << text;
    return sources.replace(at, text.size(), replacement);
  }

  const testing::TemporaryFolder folder_;
  const std::string log_ = folder_ / "oclgrind.log";
};

TEST_P(KernelMemoryTest, FindsNothingInAMap) {
  EXPECT_EQ(reported_of_map(std::string(kernels::embedded_sources())), "");
}

TEST_P(KernelMemoryTest, FindsNothingInTheSelfTest) {
  const auto use = [](const cl::Context& context, const cl::Device& device, const cl::Program& program) {
    EXPECT_EQ(self_test(context, device, program, GetParam()), "");
  };
  EXPECT_EQ(reported(std::string(kernels::embedded_sources()), use), "");
}

// What the silence above rests on: oclgrind speaks where something is wrong.

TEST_P(KernelMemoryTest, FindsAnAccessBeyondTheBuffers) {
  const std::string sources =
      broken("if (group >= groups) return;\n  constant const superquadric* s", "constant const superquadric* s");
  EXPECT_THAT(reported_of_map(sources), HasSubstr("Invalid read"));
}

TEST_P(KernelMemoryTest, FindsAReadOfWhatWasNotWritten) {
  EXPECT_THAT(reported_of_map(broken("  STORE(proven_hi, group, his);\n", "")), HasSubstr("ninitialized"));
}

TEST_P(KernelMemoryTest, FindsADataRace) {
  EXPECT_THAT(reported_of_map(broken("STORE(hi, group, union_his)", "STORE(hi, 0, union_his)")),
              HasSubstr("data race"));
}

INSTANTIATE_TEST_SUITE_P(Widths, KernelMemoryTest, ::testing::Values(1, 4),
                         [](const auto& test) { return fmt::format("Width{}", test.param); });

}  // namespace
}  // namespace verisq::device
