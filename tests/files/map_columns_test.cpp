/// Columns of maps as CSV, chosen by whoever writes them.
#include <gmock/gmock.h>

#include <vector>
#include <verisq/map_file.hpp>

#include "tests/fixtures/error_matchers.hpp"
#include "tests/fixtures/temporary_folder.hpp"

namespace verisq {
namespace {

using testing::expect_input_error;
using ::testing::IsEmpty;
using testing::TemporaryFolder;
using enum MapColumn;

const Mesh triangle{{{0, 0, 0.1}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
const std::vector<MapResult> results{
    {{0.1, 0.3}, Status::device_verified}, {{-infinity, 2.0}, Status::wide}, {{-1.0, 0x1p-60}, Status::host_verified}};

std::string text_of(const Mesh* mesh, const MapForm& form) {
  const TemporaryFolder folder;
  MapWriter writer(folder / "map.csv", mesh, form);
  const std::span<const MapResult> rows = results;
  const std::span<const Point> points = triangle.vertices;
  writer.append(points.first(1), rows.first(1));
  if (mesh == nullptr) {
    writer.append(points.last(2), rows.last(2));
  } else {
    writer.append(rows.last(2));
  }
  writer.finish();
  return folder.contents("map.csv");
}

TEST(MapColumns, AreThoseAskedForInTheirOrder) {
  EXPECT_EQ(text_of(nullptr, {.columns = {status, z, x, lo, index}}),
            "status,z,x,lo,index\n"
            "device-verified,0.1,0,0.1,0\n"
            "wide,0,1,-inf,1\n"
            "host-verified,0,0,-1,2\n");
}

TEST(MapColumns, AreByDefaultWhatTheyAlwaysWere) {
  EXPECT_EQ(text_of(nullptr, {}), text_of(nullptr, {.columns = {index, lo, hi, status}}));
}

TEST(MapColumns, TakeCoordinatesFromAMesh) {
  const MapForm form{.columns = {x, y, z, hi}};
  EXPECT_EQ(text_of(&triangle, form), text_of(nullptr, form));
}

/// 2^-60 + 1 is no binary64 number: the next above it is the width.
TEST(MapColumns, RoundWidthsUpward) {
  EXPECT_EQ(text_of(nullptr, {.columns = {mid, width}}),
            "mid,width\n0.2,0.19999999999999998\n2,inf\n-0.5,1.0000000000000002\n");
}

TEST(MapColumns, AreRefusedWhereTheyAreNot) {
  const TemporaryFolder folder;
  const auto refuse = [&](const char* name, const MapForm& form, const std::string& message) {
    expect_input_error([&] { MapWriter writer(folder / name, &triangle, form); }, folder / name, message);
  };
  for (const char* name : {"map.vtp", "map.ply", "map.json"}) {
    refuse(name, {.columns = {lo}}, ": columns are chosen of .csv and .npy only");
  }
  refuse("map.csv", {.contents = MapContents::certified, .columns = {lo}},
         ": the columns of certificates are not to be chosen");
  refuse("map.csv", {.elements = MapElements::triangles, .columns = {lo, y}},
         ": x, y, z are columns of maps of points only");
  refuse("map.npy", {.elements = MapElements::poses, .columns = {x}}, ": x, y, z are columns of maps of points only");
  refuse("map.csv", {.columns = {lo, hi, lo}}, ": column lo twice");
  refuse("map.csv", {.format = ".xyz"}, ": unknown map format '.xyz': known are .csv, .npy, .vtp, .ply, .json");
  EXPECT_THAT(folder.names(), IsEmpty());
}

}  // namespace
}  // namespace verisq
