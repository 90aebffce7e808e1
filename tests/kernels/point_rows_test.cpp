/// The kernels between the caller's memory and those of distances, on vectors and on scalars: every coordinate as it
/// is, every end rounded outward and no farther, every status and sum as the host has it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/device/device.hpp"
#include "kernels/embedded_sources.hpp"
#include "tests/kernels/point_map_judge.hpp"
#include "tests/kernels/row_judge.hpp"

namespace verisq::device {
namespace {

class PointRowsTest : public ::testing::TestWithParam<int> {
 protected:
  void SetUp() override {
    const Selection selection = select_device("auto");
    if (!selection.device) GTEST_SKIP() << "no OpenCL device: " << selection.notice;
    device_ = *selection.device;
    device_.vector_width = GetParam();
    program_ = build_program(device_.context, device_.device, GetParam(), kernels::embedded_point_sources());
  }

  Device device_;
  cl::Program program_;
};

TEST_P(PointRowsTest, ColumnsAreThoseOfTheCallersMemory) {
  EXPECT_EQ(false_columns(device_, program_), "");
}

TEST_P(PointRowsTest, RowsAreThoseOfTheHost) {
  EXPECT_EQ(false_rows(device_, program_), "");
}

TEST_P(PointRowsTest, OneStepDoesWhatThreeDo) {
  const cl::Program program = build_program(device_.context, device_.device, GetParam(), kernels::embedded_point_map());
  EXPECT_EQ(false_point_map(device_, program), "");
}

INSTANTIATE_TEST_SUITE_P(Widths, PointRowsTest, ::testing::Values(1, 4, 8, 16),
                         [](const auto& test) { return fmt::format("Width{}", test.param); });

}  // namespace
}  // namespace verisq::device
