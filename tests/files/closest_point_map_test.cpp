/// Maps with closest points, as CSV, NumPy arrays and VTK: which columns, and every number of them.
#include <gmock/gmock.h>

#include <array>
#include <bit>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/map_file.hpp>

#include "host/files/input_file.hpp"
#include "tests/fixtures/error_matchers.hpp"
#include "tests/fixtures/temporary_folder.hpp"

namespace verisq {
namespace {

using testing::expect_input_error;
using ::testing::HasSubstr;
using testing::TemporaryFolder;
using enum MapColumn;

const Mesh triangle{{{0, 0, 0.1}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
const std::vector<MapResult> results{
    {{0.1, 0.3}, Status::device_verified}, {{1.0, 2.0}, Status::wide}, {{-1.0, -0.5}, Status::host_verified}};
const std::vector<ClosestPoint> closest{
    {{0.1, 0.3}, {{{1, 2}, {3, 4}, {5, 6}}}, {{{-1, -0.5}, {0, 0.25}, {0.5, 1}}}, 3, true},
    {{1.0, 2.0}, {{{-infinity, infinity}, {0, 0}, {0, 0}}}, {{{-1, 1}, {-1, 1}, {-1, 1}}}, {}, false},
    {{-1.0, -0.5}, {{{0.1, 0.2}, {0, 0}, {0, 0}}}, {{{0, 0}, {0, 0}, {1, 1}}}, 0, true}};

std::string written(const char* name, const Mesh* mesh, MapForm form) {
  const TemporaryFolder folder;
  form.contents = MapContents::closest_points;
  MapWriter writer(folder / name, mesh, form);
  const std::span<const Point> points =
      mesh == nullptr ? std::span<const Point>(triangle.vertices) : std::span<const Point>();
  const auto part = [&](std::size_t first, std::size_t count) {
    writer.append_closest(points.empty() ? points : points.subspan(first, count),
                          std::span(results).subspan(first, count), std::span(closest).subspan(first, count));
  };
  part(0, 1);
  part(1, 2);
  writer.finish();
  return folder.contents(name);
}

double number_at(std::string_view bytes, std::size_t at) {
  return number_from<double>(bytes.data() + at, std::endian::little);
}

TEST(ClosestPointMap, HasTwoColumnsForEachCoordinateOfABox) {
  EXPECT_EQ(written("map.csv", &triangle, {}),
            "index,lo,hi,status,unique,closest_x_lo,closest_x_hi,closest_y_lo,closest_y_hi,closest_z_lo,closest_z_hi,"
            "normal_x_lo,normal_x_hi,normal_y_lo,normal_y_hi,normal_z_lo,normal_z_hi,primitive\n"
            "0,0.1,0.3,device-verified,1,1,2,3,4,5,6,-1,-0.5,0,0.25,0.5,1,3\n"
            "1,1,2,wide,0,-inf,inf,0,0,0,0,-1,1,-1,1,-1,1,-1\n"
            "2,-1,-0.5,host-verified,1,0.1,0.2,0,0,0,0,0,0,0,0,1,1,0\n");
}

TEST(ClosestPointMap, HasColumnsOfChoice) {
  EXPECT_EQ(written("map.csv", nullptr, {.columns = {primitive, normal_z_hi, x, unique, closest_y_lo}}),
            "primitive,normal_z_hi,x,unique,closest_y_lo\n3,1,0,1,3\n-1,1,1,0,0\n0,1,0,1,0\n");
}

TEST(ClosestPointMap, IsANumPyArray) {
  const std::string file = written("map.npy", nullptr, {.columns = {unique, closest_x_hi, primitive}});
  EXPECT_THAT(file, HasSubstr("[('unique', '|u1'), ('closest_x_hi', '<f8'), ('primitive', '<i4')]"));
  const std::string_view rows = std::string_view(file).substr(file.size() - 3 * 13);
  EXPECT_EQ(rows[0], 1);
  EXPECT_EQ(number_at(rows, 1), 2.0);
  EXPECT_EQ(number_from<std::int32_t>(rows.data() + 9, std::endian::little), 3);
  EXPECT_EQ(number_at(rows, 14), infinity);
  EXPECT_EQ(number_from<std::int32_t>(rows.data() + 22, std::endian::little), -1);
}

/// The last arrays: six of the rows, each after the number of its bytes.
TEST(ClosestPointMap, IsDrawnByItsNormals) {
  const std::string file = written("map.vtp", &triangle, {});
  EXPECT_THAT(file, HasSubstr("<PointData Scalars=\"dist_mid\" Vectors=\"normal\">"));
  constexpr std::string_view end = "\n  </AppendedData>\n</VTKFile>\n";
  constexpr std::size_t vectors = 8 + 3 * 24;
  constexpr std::size_t bytes = 8 + 3 + 5 * vectors + 8 + 12;
  const std::string_view arrays = std::string_view(file).substr(file.size() - end.size() - bytes, bytes);
  EXPECT_EQ(arrays.substr(8, 3), std::string_view("\1\0\1", 3));
  const std::array<std::array<double, 3>, 5> first_and_last{
      {{1, 3, 0.1}, {2, 4, 0.2}, {-1, 0, 0}, {-0.5, 0.25, 0}, {-0.75, 0.125, 0}}};  // x, y of row 0; x of row 2
  for (std::size_t k = 0; k < 5; ++k) {
    const std::string_view array = arrays.substr(11 + k * vectors + 8);
    EXPECT_EQ(number_at(array, 0), first_and_last[k][0]) << k;
    EXPECT_EQ(number_at(array, 8), first_and_last[k][1]) << k;
    EXPECT_EQ(number_at(array, 48), first_and_last[k][2]) << k;
  }
  EXPECT_EQ(number_from<std::int32_t>(arrays.data() + bytes - 12, std::endian::little), 3);
  EXPECT_EQ(number_from<std::int32_t>(arrays.data() + bytes - 8, std::endian::little), -1);
}

TEST(ClosestPointMap, OfPosesHasTheBoxesOfBothModels) {
  const std::vector<ClosestPoints> pairs{
      {{{{1, 2}, {3, 4}, {5, 6}}}, {{{-1, -0.5}, {0, 0.25}, {0.5, 1}}}, true},
      {{{{-infinity, infinity}, {0, 0}, {0, 0}}}, {{{7, 8}, {0, 0}, {0, 9}}}, false}};
  const TemporaryFolder folder;
  const auto write = [&](const char* name, const std::vector<MapColumn>& columns) {
    MapWriter writer(folder / name, nullptr,
                     {.contents = MapContents::closest_points, .elements = MapElements::poses, .columns = columns});
    writer.append_closest(std::span(results).first(2), pairs);
    writer.finish();
    return folder.contents(name);
  };
  EXPECT_EQ(write("map.csv", {}),
            "index,lo,hi,status,unique,on_a_x_lo,on_a_x_hi,on_a_y_lo,on_a_y_hi,on_a_z_lo,on_a_z_hi,on_b_x_lo,on_b_x_hi,"
            "on_b_y_lo,on_b_y_hi,on_b_z_lo,on_b_z_hi\n"
            "0,0.1,0.3,device-verified,1,1,2,3,4,5,6,-1,-0.5,0,0.25,0.5,1\n"
            "1,1,2,wide,0,-inf,inf,0,0,0,0,7,8,0,0,0,9\n");
  const std::string file = write("map.npy", {unique, on_b_z_hi});
  EXPECT_EQ(file.substr(file.size() - 18, 1), "\1");
  EXPECT_EQ(number_at(file, file.size() - 8), 9.0);
}

TEST(ClosestPointMap, IsRefusedWhereThereIsNoPlaceForIt) {
  const TemporaryFolder folder;
  const auto refuse = [&](const char* name, const MapForm& form, const std::string& message) {
    expect_input_error([&] { MapWriter writer(folder / name, &triangle, form); }, folder / name, message);
  };
  constexpr MapContents with = MapContents::closest_points;
  refuse("map.ply", {.contents = with}, ": closest points are written to .csv, .npy and .vtp only");
  refuse("map.csv", {.contents = with, .elements = MapElements::triangles},
         ": closest points are those of points and poses only");
  refuse("map.csv", {.columns = {lo, primitive}}, ": columns of closest points in a map without them");
  refuse("map.csv", {.contents = with, .columns = {unique, on_a_x_lo}}, ": columns of poses in a map of points");
  refuse("map.csv", {.contents = with, .elements = MapElements::poses, .columns = {closest_x_lo}},
         ": columns of points in a map of poses");
  EXPECT_TRUE(folder.names().empty());
}

}  // namespace
}  // namespace verisq
