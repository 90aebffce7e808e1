/// Maps as NumPy arrays: bytes, the count in the header at every moment, and where it cannot be corrected.
#include <gmock/gmock.h>

#include <bit>
#include <limits>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/map_file.hpp>

#include "host/files/input_file.hpp"
#include "host/files/npy_header.hpp"
#include "tests/fixtures/error_matchers.hpp"
#include "tests/fixtures/temporary_folder.hpp"

namespace verisq {
namespace {

using ::testing::ElementsAre;
using testing::expect_input_error;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

const std::vector<Point> points{{1, 2, 3}, {-0.5, 0, 1e300}};
const std::vector<MapResult> results{{{0.1, 0.30000000000000004}, Status::device_verified},
                                     {{-infinity, -1e-310}, Status::wide}};

double double_at(std::string_view bytes, std::size_t at) {
  return number_from<double>(bytes.data() + at, std::endian::little);
}

/// The header of a whole file, which must be as long as it says.
std::string header_of(std::string_view file) {
  EXPECT_TRUE(file.starts_with(std::string("\x93NUMPY\1\0", 8)));
  const std::size_t length = 10 + number_from<std::uint16_t>(file.data() + 8, std::endian::little);
  EXPECT_EQ(length % 64, 0U);  // NumPy wants numbers aligned
  EXPECT_EQ(file[length - 1], '\n');
  return std::string(file.substr(10, file.find('}') - 9));
}

TEST(NpyMap, HoldsNamedFields) {
  const TemporaryFolder folder;
  MapWriter writer(folder / "map.npy", nullptr);
  writer.append(std::span(points).first(1), std::span(results).first(1));
  writer.append(std::span(points).last(1), std::span(results).last(1));
  writer.finish();
  const std::string file = folder.contents("map.npy");
  EXPECT_EQ(header_of(file),
            "{'descr': [('lo', '<f8'), ('hi', '<f8'), ('status', '|u1')], 'fortran_order': False, 'shape': (2,), }");
  ASSERT_EQ(file.size() % 64, 2U * 17U);
  const std::string_view rows = std::string_view(file).substr(file.size() - 34);
  EXPECT_EQ(double_at(rows, 0), 0.1);
  EXPECT_EQ(double_at(rows, 8), 0.30000000000000004);
  EXPECT_EQ(rows[16], 0);
  EXPECT_EQ(double_at(rows, 17), -infinity);
  EXPECT_EQ(double_at(rows, 25), -1e-310);
  EXPECT_EQ(rows[33], 2);
}

TEST(NpyMap, HoldsColumnsInTheOrderAskedFor) {
  const TemporaryFolder folder;
  using enum MapColumn;
  MapWriter writer(folder / "map", nullptr,
                   {.format = ".npy", .columns = {status, z, index, width, y, mid, x, hi, lo}});
  writer.append(points, results);
  writer.finish();
  const std::string file = folder.contents("map");
  EXPECT_THAT(header_of(file), HasSubstr("[('status', '|u1'), ('z', '<f8'), ('index', '<u8'), ('width', '<f8'), "
                                         "('y', '<f8'), ('mid', '<f8'), ('x', '<f8'), ('hi', '<f8'), ('lo', '<f8')]"));
  const std::string_view row = std::string_view(file).substr(file.size() - 65);
  EXPECT_EQ(row[0], 2);
  EXPECT_EQ(double_at(row, 1), 1e300);
  EXPECT_EQ(number_from<std::uint64_t>(row.data() + 9, std::endian::little), 1U);
  EXPECT_EQ(double_at(row, 17), infinity);
  EXPECT_EQ(double_at(row, 25), 0.0);
  EXPECT_EQ(double_at(row, 33), -1e-310);
  EXPECT_EQ(double_at(row, 41), -0.5);
  EXPECT_EQ(double_at(row, 49), -1e-310);
  EXPECT_EQ(double_at(row, 57), -infinity);
}

/// What a killed run leaves is an array of the rows so far.
TEST(NpyMap, IsWholeAfterEveryCall) {
  const TemporaryFolder folder;
  MapWriter writer(folder / "map.npy", nullptr);
  writer.append(std::span(points).first(1), std::span(results).first(1));
  const std::string file = folder.contents(folder.names().at(0));
  EXPECT_THAT(header_of(file), HasSubstr("'shape': (1,)"));
  EXPECT_EQ(file.size() % 64, 17U);
}

TEST(NpyMap, KeepsThePartOfAnInterruptedMap) {
  const TemporaryFolder folder;
  MapWriter writer(folder / "map.npy", nullptr);
  writer.append(std::span(points).first(1), std::span(results).first(1));
  EXPECT_EQ(writer.keep_partial(), folder / "map.npy.partial");
  EXPECT_THAT(header_of(folder.contents("map.npy.partial")), HasSubstr("'shape': (1,)"));
  EXPECT_THAT(folder.names(), ElementsAre("map.npy.partial"));
}

TEST(NpyMap, HasRoomForAnyNumberOfRows) {
  const std::size_t length = npy_header("[('lo', '<f8')]", 0).size();
  for (const std::uint64_t rows : {std::uint64_t{1}, std::numeric_limits<std::uint64_t>::max()}) {
    EXPECT_EQ(npy_header("[('lo', '<f8')]", rows).size(), length);
  }
}

TEST(NpyMap, OfManyRowsIsThatOfEach) {
  constexpr std::size_t count = 100'000;  // several processors share them
  const TemporaryFolder folder;
  std::vector<MapResult> many(count);
  for (std::size_t k = 0; k < count; ++k) many[k] = {{static_cast<double>(k), infinity}, Status::wide};
  MapWriter writer(folder / "map.npy", nullptr, {.columns = {MapColumn::lo}});
  writer.append(std::vector<Point>(count), many);
  writer.finish();
  const std::string file = folder.contents("map.npy");
  for (std::size_t k = 0; k < count; ++k) {
    ASSERT_EQ(double_at(file, file.size() - 8 * (count - k)), static_cast<double>(k));
  }
}

TEST(NpyMap, NeedsTheNumberOfRowsWhereItCannotGoBack) {
  const std::filesystem::path device = "/dev/null";
  expect_input_error([&] { MapWriter writer(device, nullptr, {.format = ".npy"}); }, device,
                     ": a .npy begins with the number of its rows, which is not known of such an input: give a file, "
                     "or .csv");
  MapWriter writer(device, nullptr, {.format = ".npy", .rows = 2});
  writer.append(points, results);
  writer.finish();
  MapWriter too_short(device, nullptr, {.format = ".npy", .rows = 2});
  too_short.append(std::span(points).first(1), std::span(results).first(1));
  EXPECT_EQ(too_short.keep_partial(), "");
  testing::expect_error([&] { too_short.finish(); }, ErrorKind::failure, device,
                        ": cannot be written: 1 rows, and the header promised 2");
}

}  // namespace
}  // namespace verisq
