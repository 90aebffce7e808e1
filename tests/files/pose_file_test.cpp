/// Streaming of poses from CSV: what is theirs alone. Forms of lines and chunks are those of point_file_test.cpp.
#include <gmock/gmock.h>

#include <string>
#include <vector>
#include <verisq/files.hpp>

#include "tests/fixtures/error_matchers.hpp"
#include "tests/fixtures/read_all.hpp"
#include "tests/fixtures/temporary_folder.hpp"

namespace verisq {
namespace {

using testing::expect_input_error;
using testing::TemporaryFolder;

/// All poses of the file, read `chunk` at a time.
std::vector<Pose> read_all(const std::filesystem::path& path, std::size_t chunk) {
  return testing::read_all<Pose>(PoseFile(path), chunk);
}

void expect_refusal(std::string_view text, const std::string& rest) {
  const TemporaryFolder folder;
  const auto path = folder.file("poses.csv", text);
  expect_input_error([&] { (void)read_all(path, 2); }, path, rest);
}

TEST(PoseFile, FormsOfLines) {
  const TemporaryFolder folder;
  for (const std::string text :
       {"tx,ty,tz,qw,qx,qy,qz\n1,-2.5,3e2,0.1,0,-0,7\n4,5,6,-1e308,5e-324,2,3\n",
        "1,-2.5,3e2,0.1,0,-0,7\n4,5,6,-1e308,5e-324,2,3",
        "\xEF\xBB\xBFTX, \"TY\", tz, qW,qx,qy,qz\r\n 1 ,\t-2.5,+3e2,.1,0,-0,7\r\n4,5,6,-1e308,5e-324,2,3\r\n\r\n"}) {
    const auto poses = read_all(folder.file("poses.csv", text), 2);
    ASSERT_EQ(poses.size(), 2U) << text;
    EXPECT_EQ(poses[0].translation, (Point{1, -2.5, 3e2}));
    EXPECT_EQ(poses[0].quaternion, (std::array<double, 4>{0.1, 0, -0.0, 7}));
    EXPECT_EQ(poses[1].translation, (Point{4, 5, 6}));
    EXPECT_EQ(poses[1].quaternion, (std::array<double, 4>{-1e308, 5e-324, 2, 3}));
  }
}

TEST(PoseFile, StreamsAcrossChunksAndBlocks) {
  constexpr std::size_t count = 80000;
  std::string text;
  for (std::size_t k = 0; k < count; ++k) text += std::to_string(k) + ".25,0,0,1,0,-" + std::to_string(k) + ",1e-3\n";
  ASSERT_GT(text.size(), std::size_t{1} << 21);
  const TemporaryFolder folder;
  const auto path = folder.file("poses.csv", text);
  for (const std::size_t chunk : {std::size_t{1}, std::size_t{4096}, count, count + 1}) {
    const std::vector<Pose> poses = read_all(path, chunk);
    ASSERT_EQ(poses.size(), count);
    for (std::size_t k = 0; k < count; ++k) {
      const auto value = static_cast<double>(k);
      ASSERT_EQ(poses[k].translation, (Point{value + 0.25, 0, 0}));
      ASSERT_EQ(poses[k].quaternion, (std::array<double, 4>{1, 0, -value, 1e-3}));
    }
  }
}

TEST(PoseFile, CountsBytesForProgress) {
  const TemporaryFolder folder;
  PoseFile file(folder.file("poses.csv", "0,0,0,1,0,0,0\n0,0,0,1,0,0,0\n"));
  std::vector<Pose> one(1);
  EXPECT_EQ(file.bytes_total(), 28U);
  EXPECT_EQ(file.bytes_read(), 0U);
  EXPECT_EQ(file.read(one), 1U);
  EXPECT_EQ(file.bytes_read(), 14U);
  EXPECT_EQ(file.read(one), 1U);
  EXPECT_EQ(file.read(one), 0U);
  EXPECT_EQ(file.read(one), 0U);
}

TEST(PoseFile, RefusesZeroQuaternions) {
  const std::string message = "quaternion = 0,0,0,0: must not be zero";
  expect_refusal("1,2,3,1,0,0,0\n1,2,3,0,0,0,0\n", ": line 2: " + message);
  expect_refusal("1,2,3,-0,0.0,0,-0\n", ": line 1: " + message);
  expect_refusal("tx,ty,tz,qw,qx,qy,qz\n1,2,3,1e-400,0,0,0\n", ": line 2: " + message);
}

TEST(PoseFile, RefusesValues) {
  expect_refusal("0,0,0,1,0,0,0\n0,0,0,nan,0,0,0\n", ": line 2: qw = 'nan': not a finite number");
  expect_refusal("inf,0,0,1,0,0,0\n", ": line 1: tx = 'inf': not a finite number");
  expect_refusal("0,0,0,1,0,0,-inf\n", ": line 1: qz = '-inf': not a finite number");
  expect_refusal("0,1e999,0,1,0,0,0\n", ": line 1: ty = '1e999': beyond the range of binary64");
  expect_refusal("0,0,0,1,one,0,0\n", ": line 1: qx = 'one': not a number");
  expect_refusal("0,0,,1,0,0,0\n", ": line 1: tz is missing");
  expect_refusal("0,0,0,1,0,,0\n", ": line 1: qy is missing");
}

TEST(PoseFile, RefusesLines) {
  const std::string expected = ": expected seven numbers tx,ty,tz,qw,qx,qy,qz";
  expect_refusal("0,0,0,1,0,0\n", ": line 1: '0,0,0,1,0,0'" + expected);
  expect_refusal("0,0,0,1,0,0,0\n0,0,0,1,0,0,0,0\n", ": line 2: '0,0,0,1,0,0,0,0'" + expected);
  expect_refusal("0 0 0 1 0 0 0\n", ": line 1: '0 0 0 1 0 0 0'" + expected);
  expect_refusal("x,y,z\n", ": line 1: 'x,y,z'" + expected);
  expect_refusal("tx,ty,tz,qx,qy,qz,qw\n0,0,0,1,0,0,0\n", ": line 1: tx = 'tx': not a number");
  expect_refusal("0,0,0,1,0,0,0\n\n0,0,0,1,0,0,0\n",
                 ": line 3: a pose after a blank line: blank lines are fine at the end only");
}

TEST(PoseFile, RefusesFiles) {
  expect_refusal("", ": the file is empty");
  expect_refusal("tx,ty,tz,qw,qx,qy,qz\n", ": no poses");
  const TemporaryFolder folder;
  expect_input_error([&] { PoseFile file(folder / "none.csv"); }, folder / "none.csv", ": no such file");
}

}  // namespace
}  // namespace verisq
