/// The map writers: what each format holds, byte by byte where it matters, and that no half-written map remains.
#include <gmock/gmock.h>
#include <sys/resource.h>

#include <bit>
#include <charconv>
#include <csignal>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <vector>
#include <verisq/map_file.hpp>
#include <verisq/mesh_file.hpp>

#include "host/files/byte_order.hpp"
#include "tests/error_matchers.hpp"
#include "tests/temporary_folder.hpp"

namespace verisq {
namespace {

using ::testing::ElementsAre;
using testing::expect_error;
using testing::expect_input_error;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::TemporaryFolder;

constexpr double infinity = std::numeric_limits<double>::infinity();

const Mesh tetrahedron{{{0, 0, 0}, {1, 0, 0}, {0, 0.1, 0}, {0, 0, 1e300}},
                       {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};

const std::vector<MapResult> results{{{0.1, 0.30000000000000004}, Status::device_verified},
                                     {{-infinity, infinity}, Status::wide},
                                     {{-2.0, infinity}, Status::wide},
                                     {{-infinity, -1e-310}, Status::host_verified}};

/// In two pieces, as a map arrives.
void write(const std::filesystem::path& path, const Mesh* mesh) {
  MapWriter writer(path, mesh);
  const std::span<const Point> points = tetrahedron.vertices;
  const std::span<const MapResult> rows = results;
  writer.append(points.first(3), rows.first(3));
  writer.append(points.last(1), rows.last(1));
  writer.finish();
}

// --- text --------------------------------------------------------------------------------------------------------

TEST(MapFile, Csv) {
  const TemporaryFolder folder;
  write(folder / "map.csv", &tetrahedron);
  EXPECT_EQ(folder.contents("map.csv"),
            "index,lo,hi,status\n"
            "0,0.10000000000000001,0.30000000000000004,device-verified\n"
            "1,-inf,inf,wide\n"
            "2,-2,inf,wide\n"
            "3,-inf,-9.9999999999999694e-311,host-verified\n");
  EXPECT_THAT(folder.names(), ElementsAre("map.csv"));
}

TEST(MapFile, CsvGivesBackEveryBit) {
  std::vector<MapResult> rows;
  for (std::uint64_t k = 0; k < 1000; ++k) {
    const double lo = std::bit_cast<double>(0x9e3779b97f4a7c15U * (k + 1) >> 2U);  // positive and finite
    rows.push_back({{lo, -lo}, Status::wide});
  }
  const TemporaryFolder folder;
  MapWriter writer(folder / "map.csv", nullptr);
  writer.append(std::vector<Point>(rows.size()), rows);
  writer.finish();
  std::istringstream lines(folder.contents("map.csv"));
  std::string line;
  std::getline(lines, line);
  for (const MapResult& row : rows) {
    std::getline(lines, line);
    const std::size_t start = line.find(',') + 1;
    double lo = 0.0;
    std::from_chars(line.data() + start, line.data() + line.size(), lo);
    EXPECT_EQ(lo, row.distance.lo) << line;
  }
}

TEST(MapFile, Json) {
  const TemporaryFolder folder;
  write(folder / "map.JSON", nullptr);
  const nlohmann::json map = nlohmann::json::parse(folder.contents("map.JSON"));
  EXPECT_EQ(map, nlohmann::json::parse(R"({"format": "verisq-map/1", "results": [
      {"index": 0, "lo": 0.1, "hi": 0.30000000000000004, "status": "device-verified"},
      {"index": 1, "lo": "-inf", "hi": "inf", "status": "wide"},
      {"index": 2, "lo": -2, "hi": "inf", "status": "wide"},
      {"index": 3, "lo": "-inf", "hi": -1e-310, "status": "host-verified"}]})"));
}

TEST(MapFile, JsonWithoutRows) {
  const TemporaryFolder folder;
  MapWriter(folder / "map.json", nullptr).finish();
  EXPECT_EQ(nlohmann::json::parse(folder.contents("map.json"))["results"], nlohmann::json::array());
}

// --- PLY ---------------------------------------------------------------------------------------------------------

TEST(MapFile, PlyReadsBackAsTheMesh) {
  const TemporaryFolder folder;
  write(folder / "map.ply", &tetrahedron);
  const Mesh mesh = read_mesh(folder / "map.ply");
  EXPECT_EQ(mesh.vertices, tetrahedron.vertices);
  EXPECT_EQ(mesh.triangles, tetrahedron.triangles);
}

TEST(MapFile, PlyOfPoints) {
  const TemporaryFolder folder;
  write(folder / "map.ply", nullptr);
  const Mesh mesh = read_mesh(folder / "map.ply");
  EXPECT_EQ(mesh.vertices, tetrahedron.vertices);
  EXPECT_THAT(mesh.triangles, IsEmpty());
}

double double_at(std::string_view bytes) {
  return number_from<double>(bytes.data(), std::endian::little);
}

TEST(MapFile, PlyCarriesTheEnclosures) {
  const TemporaryFolder folder;
  write(folder / "map.ply", &tetrahedron);
  const std::string contents = folder.contents("map.ply");
  const std::string end =
      "property uchar status\nelement face 4\nproperty list uchar uint vertex_indices\nend_header\n";
  ASSERT_THAT(contents, HasSubstr(end));
  EXPECT_THAT(contents, HasSubstr("element vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
                                  "property double dist_lo\nproperty double dist_hi\nproperty double dist_mid\n"));
  std::string_view rows = std::string_view(contents).substr(contents.find(end) + end.size());
  const std::vector<double> middles{std::midpoint(0.1, 0.30000000000000004), 0.0, -2.0, -1e-310};
  for (std::size_t k = 0; k < 4; ++k) {
    const std::string_view row = rows.substr(k * 49, 49);
    EXPECT_EQ(double_at(row.substr(24)), results[k].distance.lo);
    EXPECT_EQ(double_at(row.substr(32)), results[k].distance.hi);
    EXPECT_EQ(double_at(row.substr(40)), middles[k]);
    EXPECT_EQ(row[48], static_cast<char>(results[k].status));
  }
  EXPECT_EQ(rows.size(), std::size_t{4 * 49 + 4 * 13});
}

// --- VTP ---------------------------------------------------------------------------------------------------------

/// The arrays of an appended-raw .vtp file, found as a reader finds them: by the offsets in the XML.
class VtpFile {
 public:
  explicit VtpFile(std::string contents) : contents_(std::move(contents)) {}

  template <class Number>
  [[nodiscard]] std::vector<Number> array(const std::string& type, const std::string& name) const {
    const std::size_t element = contents_.find("<DataArray type=\"" + type + "\" Name=\"" + name + "\"");
    if (element == std::string::npos) return {};
    const std::string key = "offset=\"";
    const std::size_t offset = std::stoul(contents_.substr(contents_.find(key, element) + key.size()));
    const std::size_t start = contents_.find("<AppendedData encoding=\"raw\">\n_") + 31 + offset;
    const auto bytes = number_from<std::uint64_t>(contents_.data() + start, std::endian::little);
    std::vector<Number> result;
    for (std::size_t at = start + 8; at < start + 8 + bytes; at += sizeof(Number)) {
      result.push_back(number_from<Number>(contents_.data() + at, std::endian::little));
    }
    return result;
  }

  [[nodiscard]] const std::string& contents() const { return contents_; }

 private:
  std::string contents_;
};

TEST(MapFile, VtpOfAMesh) {
  const TemporaryFolder folder;
  write(folder / "map.vtp", &tetrahedron);
  const VtpFile file(folder.contents("map.vtp"));
  EXPECT_THAT(file.contents(), HasSubstr("byte_order=\"LittleEndian\" header_type=\"UInt64\""));
  EXPECT_THAT(file.contents(), HasSubstr("<Piece NumberOfPoints=\"4\" NumberOfVerts=\"0\" NumberOfLines=\"0\" "
                                         "NumberOfStrips=\"0\" NumberOfPolys=\"4\">"));
  EXPECT_THAT(file.array<double>("Float64", "Points"), ElementsAre(0, 0, 0, 1, 0, 0, 0, 0.1, 0, 0, 0, 1e300));
  EXPECT_THAT(file.array<std::int64_t>("Int64", "connectivity"), ElementsAre(0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3));
  EXPECT_THAT(file.array<std::int64_t>("Int64", "offsets"), ElementsAre(3, 6, 9, 12));
  EXPECT_THAT(file.array<double>("Float64", "dist_lo"), ElementsAre(0.1, -infinity, -2.0, -infinity));
  EXPECT_THAT(file.array<double>("Float64", "dist_hi"), ElementsAre(0.30000000000000004, infinity, infinity, -1e-310));
  EXPECT_THAT(file.array<double>("Float64", "dist_mid"),
              ElementsAre(std::midpoint(0.1, 0.30000000000000004), 0.0, -2.0, -1e-310));
  EXPECT_THAT(file.array<std::uint8_t>("UInt8", "status"), ElementsAre(0, 2, 2, 1));
  EXPECT_TRUE(file.contents().ends_with(std::string("\0\2\2\1", 4) + "\n  </AppendedData>\n</VTKFile>\n"));
}

TEST(MapFile, VtpOfPointsHasAVertexCellEach) {
  const TemporaryFolder folder;
  write(folder / "map.vtp", nullptr);
  const VtpFile file(folder.contents("map.vtp"));
  EXPECT_THAT(file.contents(), HasSubstr("NumberOfVerts=\"4\" NumberOfLines=\"0\" NumberOfStrips=\"0\" "
                                         "NumberOfPolys=\"0\">"));
  EXPECT_THAT(file.contents(), HasSubstr("<Verts>"));
  EXPECT_THAT(file.array<double>("Float64", "Points"), ElementsAre(0, 0, 0, 1, 0, 0, 0, 0.1, 0, 0, 0, 1e300));
  EXPECT_THAT(file.array<std::int64_t>("Int64", "connectivity"), ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(file.array<std::int64_t>("Int64", "offsets"), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(file.array<std::uint8_t>("UInt8", "status"), ElementsAre(0, 2, 2, 1));
}

// --- files -------------------------------------------------------------------------------------------------------

TEST(MapFile, LeavesNothingWithoutFinish) {
  const TemporaryFolder folder;
  {
    MapWriter writer(folder / "map.csv", nullptr);
    writer.append(std::vector<Point>(1), std::span(results).first(1));
    EXPECT_EQ(folder.names().size(), 1U);
    EXPECT_FALSE(std::filesystem::exists(folder / "map.csv"));
  }
  EXPECT_THAT(folder.names(), IsEmpty());
}

TEST(MapFile, KeepsThePartOfAnInterruptedCsv) {
  const TemporaryFolder folder;
  MapWriter writer(folder / "map.csv", nullptr);
  writer.append(std::vector<Point>(1), std::span(results).first(1));
  EXPECT_EQ(writer.keep_partial(), folder / "map.csv.partial");
  EXPECT_EQ(folder.contents("map.csv.partial"),
            "index,lo,hi,status\n0,0.10000000000000001,0.30000000000000004,device-verified\n");
  EXPECT_THAT(folder.names(), ElementsAre("map.csv.partial"));
}

TEST(MapFile, KeepsNoPartOfOtherFormats) {
  const TemporaryFolder folder;
  for (const char* name : {"map.json", "map.vtp", "map.ply"}) {
    MapWriter writer(folder / name, &tetrahedron);
    writer.append(std::span(tetrahedron.vertices).first(1), std::span(results).first(1));
    EXPECT_EQ(writer.keep_partial(), "") << name;
  }
  EXPECT_THAT(folder.names(), IsEmpty());
}

TEST(MapFile, KeepsTheOldMapUntilTheNewOneIsWhole) {
  const TemporaryFolder folder;
  const auto path = folder.file("map.csv", "old");
  {
    MapWriter writer(path, nullptr);
    writer.append(std::vector<Point>(1), std::span(results).first(1));
  }
  EXPECT_EQ(folder.contents("map.csv"), "old");
  write(path, nullptr);
  EXPECT_THAT(folder.contents("map.csv"), HasSubstr("device-verified"));
  EXPECT_THAT(folder.names(), ElementsAre("map.csv"));
}

TEST(MapFile, RefusesUnknownExtensionsAtOnce) {
  const TemporaryFolder folder;
  for (const std::string extension : {".xyz", "", ".vtu"}) {
    const auto path = folder / ("map" + extension);
    expect_input_error([&] { MapWriter writer(path, nullptr); }, path,
                       ": unknown map format '" + extension + "': known are .csv, .vtp, .ply, .json");
  }
  EXPECT_THAT(folder.names(), IsEmpty());
}

TEST(MapFile, FailsAtOnceWhereItCannotWrite) {
  const TemporaryFolder folder;
  const auto nowhere = folder / "none/map.csv";
  expect_error([&] { MapWriter writer(nowhere, nullptr); }, ErrorKind::failure, nowhere.string(),
               ": cannot be written: No such file or directory");
  std::filesystem::create_directory(folder / "d.csv");
  expect_error([&] { MapWriter writer(folder / "d.csv", nullptr); }, ErrorKind::failure, (folder / "d.csv").string(),
               ": cannot be written: Is a directory");
  EXPECT_THAT(folder.names(), ElementsAre("d.csv"));
}

TEST(MapFile, FailsForAMeshWithoutAllResults) {
  const TemporaryFolder folder;
  for (const char* name : {"map.vtp", "map.ply"}) {
    const auto path = folder / name;
    expect_error(
        [&] {
          MapWriter writer(path, &tetrahedron);
          writer.append(std::span(tetrahedron.vertices).first(3), std::span(results).first(3));
          writer.finish();
        },
        ErrorKind::failure, path.string(), ": cannot be written: 3 results for 4 vertices");
  }
  EXPECT_THAT(folder.names(), IsEmpty());
}

/// Stands in for a full disk: no file of this process may grow beyond `bytes`.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : old_handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &old_limit_);
    const rlimit limit{bytes, old_limit_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &old_limit_);
    std::signal(SIGXFSZ, old_handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit old_limit_{};
  void (*old_handler_)(int);
};

TEST(MapFile, FailsWhenTheDiskIsFull) {
  const std::vector<Point> points(1000);
  const std::vector<MapResult> rows(points.size(), results[0]);
  for (const char* name : {"map.csv", "map.json", "map.vtp", "map.ply"}) {
    for (const int pieces : {1, 100}) {  // the failure shows in finish, or already in append
      const TemporaryFolder folder;
      const auto path = folder / name;
      std::optional<FileSizeLimit> limit(20000);
      expect_error(
          [&] {
            MapWriter writer(path, nullptr);
            for (int k = 0; k < pieces; ++k) writer.append(points, rows);
            writer.finish();
          },
          ErrorKind::failure, path.string(), ": cannot be written: File too large");
      limit.reset();
      EXPECT_THAT(folder.names(), IsEmpty());
    }
  }
}

}  // namespace
}  // namespace verisq
