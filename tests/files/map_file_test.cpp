/// The map writers: what each format holds, byte by byte where it matters, and that no half-written map remains. The
/// readers: every bit comes back, and everything that is not a certified map is refused.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <csignal>
#include <cstring>
#include <future>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <pugixml.hpp>
#include <random>
#include <sstream>
#include <string>
#include <vector>
#include <verisq/enclosure.hpp>
#include <verisq/files.hpp>
#include <verisq/map_file.hpp>

#include "host/files/input_file.hpp"
#include "tests/fixtures/error_matchers.hpp"
#include "tests/fixtures/temporary_folder.hpp"

namespace verisq {
namespace {

using ::testing::ElementsAre;
using testing::expect_error;
using testing::expect_input_error;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::TemporaryFolder;

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
            "0,0.1,0.30000000000000004,device-verified\n"
            "1,-inf,inf,wide\n"
            "2,-2,inf,wide\n"
            "3,-inf,-1e-310,host-verified\n");
  EXPECT_THAT(folder.names(), ElementsAre("map.csv"));
}

/// `results` of the four triangles of the tetrahedron, in two pieces.
void write_triangles(const std::filesystem::path& path) {
  MapWriter writer(path, &tetrahedron, MapContents::enclosures, MapElements::triangles);
  writer.append(std::span(results).first(3));
  writer.append(std::span(results).last(1));
  writer.finish();
}

TEST(MapFile, CsvOfTriangles) {
  const TemporaryFolder folder;
  write(folder / "vertices.csv", &tetrahedron);
  write_triangles(folder / "triangles.csv");
  EXPECT_EQ(folder.contents("triangles.csv"), folder.contents("vertices.csv"));
}

TEST(MapFile, OfPosesIsTextWithoutCertificates) {
  const TemporaryFolder folder;
  const auto write_poses = [&](const char* name, MapContents contents = MapContents::enclosures) {
    MapWriter writer(folder / name, nullptr, contents, MapElements::poses);
    writer.append(std::span(results).first(1));
    writer.finish();
  };
  write_poses("map.csv");
  write_poses("map.json");
  EXPECT_EQ(folder.contents("map.csv"), "index,lo,hi,status\n0,0.1,0.30000000000000004,device-verified\n");
  EXPECT_EQ(folder.contents("map.json"),
            "{\"format\": \"verisq-map/1\",\n \"elements\": \"poses\",\n \"results\": [\n"
            "  {\"index\": 0, \"lo\": 0.1, \"hi\": 0.30000000000000004, "
            "\"status\": \"device-verified\"}\n ]}\n");
  const std::string formats = ": maps of poses are written to .csv, .npy and .json only";
  expect_input_error([&] { write_poses("map.vtp"); }, folder / "map.vtp", formats);
  expect_input_error([&] { write_poses("map.ply"); }, folder / "map.ply", formats);
  expect_input_error([&] { write_poses("certified.csv", MapContents::certified); }, folder / "certified.csv",
                     ": maps of poses have no certificates");
  EXPECT_THAT(folder.names(), ::testing::UnorderedElementsAre("map.csv", "map.json"));
}

/// Numbers where forms and roundings of text change.
std::vector<double> numbers_of_all_kinds() {
  std::vector<double> numbers{0.0, 1e22, 1e23, 9007199254740993.0, 5e-324, std::numeric_limits<double>::max()};
  for (int exponent = -1074; exponent < 1024; ++exponent) numbers.push_back(std::ldexp(1.0, exponent));
  for (int exponent = -307; exponent < 309; ++exponent) numbers.push_back(std::stod(fmt::format("1e{}", exponent)));
  const std::size_t count = numbers.size();
  for (std::size_t k = 0; k < count; ++k) {
    numbers.push_back(std::nextafter(numbers[k], 0.0));
    numbers.push_back(std::nextafter(numbers[k], infinity));
  }
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int k = 0; k < 20'000; ++k) {
    numbers.push_back(unit(random));
    numbers.push_back(std::ldexp(unit(random), static_cast<int>(random() % 300) - 200));
    numbers.push_back(std::bit_cast<double>(random() & ~(std::uint64_t{1} << 62U)));  // finite
  }
  return numbers;
}

TEST(MapFile, CsvGivesBackEveryBitInTheShortestText) {
  std::vector<MapResult> rows;
  for (const double number : numbers_of_all_kinds()) rows.push_back({{number, -number}, Status::wide});
  const TemporaryFolder folder;
  MapWriter writer(folder / "map.csv", nullptr);
  writer.append(std::vector<Point>(rows.size()), rows);
  writer.finish();
  std::istringstream lines(folder.contents("map.csv"));
  std::string line;
  std::getline(lines, line);
  const auto digits_of = [](std::string_view number) {
    number = number.substr(0, number.find('e'));
    std::string digits;
    std::ranges::copy_if(number, std::back_inserter(digits), [](char c) { return '0' <= c && c <= '9'; });
    const std::size_t first = std::min(digits.find_first_not_of('0'), digits.size());
    return digits.substr(first, digits.find_last_not_of('0') + 1 - first);
  };
  for (const MapResult& row : rows) {
    std::getline(lines, line);
    std::istringstream fields(line);
    std::string index;
    std::getline(fields, index, ',');
    for (const double expected : {row.distance.lo, row.distance.hi}) {
      std::string field;
      std::getline(fields, field, ',');
      double number = 0.0;
      std::from_chars(field.data(), field.data() + field.size(), number);
      ASSERT_EQ(std::bit_cast<std::uint64_t>(number), std::bit_cast<std::uint64_t>(expected)) << line;
      std::array<char, 64> shortest{};
      const auto written =
          std::to_chars(shortest.data(), shortest.data() + shortest.size(), expected, std::chars_format::scientific);
      ASSERT_EQ(digits_of(field), digits_of({shortest.data(), written.ptr})) << line;
    }
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

TEST(MapFile, JsonSaysThatItIsOfTriangles) {
  const TemporaryFolder folder;
  write(folder / "vertices.json", &tetrahedron);
  write_triangles(folder / "triangles.json");
  nlohmann::json map = nlohmann::json::parse(folder.contents("triangles.json"));
  EXPECT_EQ(map.at("elements"), "triangles");
  map.erase("elements");
  EXPECT_EQ(map, nlohmann::json::parse(folder.contents("vertices.json")));
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

TEST(MapFile, PlyOfTrianglesReadsBackAsTheMesh) {
  const TemporaryFolder folder;
  write_triangles(folder / "map.ply");
  const Mesh mesh = read_mesh(folder / "map.ply");
  EXPECT_EQ(mesh.vertices, tetrahedron.vertices);
  EXPECT_EQ(mesh.triangles, tetrahedron.triangles);
}

TEST(MapFile, PlyFacesCarryTheEnclosuresOfTriangles) {
  const TemporaryFolder folder;
  write_triangles(folder / "map.ply");
  const std::string contents = folder.contents("map.ply");
  const std::string end =
      "element vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
      "element face 4\nproperty list uchar uint vertex_indices\n"
      "property double dist_lo\nproperty double dist_hi\nproperty double dist_mid\nproperty uchar status\nend_header\n";
  ASSERT_THAT(contents, HasSubstr(end));
  const std::string_view faces =
      std::string_view(contents).substr(contents.find(end) + end.size() + std::size_t{4} * 24);
  ASSERT_EQ(faces.size(), std::size_t{4} * 38);
  const std::vector<double> middles{std::midpoint(0.1, 0.30000000000000004), 0.0, -2.0, -1e-310};
  for (std::size_t k = 0; k < 4; ++k) {
    const std::string_view face = faces.substr(k * 38, 38);
    EXPECT_EQ(face[0], 3);
    EXPECT_EQ(double_at(face.substr(13)), results[k].distance.lo);
    EXPECT_EQ(double_at(face.substr(21)), results[k].distance.hi);
    EXPECT_EQ(double_at(face.substr(29)), middles[k]);
    EXPECT_EQ(face[37], static_cast<char>(results[k].status));
  }
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

/// Where the file cannot be rewritten, as a pipe, all is kept in memory and written in order.
TEST(MapFile, VtpIsTheSameInPlaceAndInOrder) {
  const TemporaryFolder folder;
  const Mesh points_alone{tetrahedron.vertices, {}};
  const Mesh bow_tie{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}}, {{0, 1, 2}, {0, 3, 4}}};
  for (const Mesh& mesh : {tetrahedron, points_alone, bow_tie}) {
    for (const MapElements elements : {MapElements::vertices, MapElements::triangles}) {
      const std::size_t rows = elements == MapElements::vertices ? mesh.vertices.size() : mesh.triangles.size();
      std::vector<MapResult> all(rows, {{-1.0, 2.0}, Status::wide});
      for (std::size_t k = 0; k < rows; ++k) all[k].distance.hi += static_cast<double>(k);
      const auto write_to = [&](const std::filesystem::path& path) {
        MapWriter writer(path, &mesh, MapContents::enclosures, elements);
        for (const MapResult& row : all) writer.append(std::span(&row, 1));
        writer.finish();
      };
      const auto pipe = folder / "pipe.vtp";
      ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
      auto reader = std::async(std::launch::async, [&] { return folder.contents("pipe.vtp"); });
      write_to(pipe);
      write_to(folder / "map.vtp");
      EXPECT_EQ(folder.contents("map.vtp"), reader.get());
      std::filesystem::remove(pipe);
    }
  }
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

TEST(MapFile, VtpOfTrianglesHasCellData) {
  const TemporaryFolder folder;
  Mesh mesh = tetrahedron;  // with other numbers of vertices and triangles
  mesh.vertices.push_back({7, 8, 9});
  MapWriter writer(folder / "map.vtp", &mesh, MapContents::enclosures, MapElements::triangles);
  writer.append(results);
  writer.finish();
  const VtpFile file(folder.contents("map.vtp"));
  EXPECT_THAT(file.contents(), HasSubstr("<Piece NumberOfPoints=\"5\" NumberOfVerts=\"0\" NumberOfLines=\"0\" "
                                         "NumberOfStrips=\"0\" NumberOfPolys=\"4\">"));
  EXPECT_THAT(file.contents(), HasSubstr("<CellData Scalars=\"dist_mid\">"));
  EXPECT_THAT(file.contents(), Not(HasSubstr("PointData")));
  EXPECT_THAT(file.array<std::int64_t>("Int64", "connectivity"), ElementsAre(0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3));
  EXPECT_THAT(file.array<double>("Float64", "dist_lo"), ElementsAre(0.1, -infinity, -2.0, -infinity));
  EXPECT_THAT(file.array<double>("Float64", "dist_hi"), ElementsAre(0.30000000000000004, infinity, infinity, -1e-310));
  EXPECT_THAT(file.array<double>("Float64", "dist_mid"),
              ElementsAre(std::midpoint(0.1, 0.30000000000000004), 0.0, -2.0, -1e-310));
  EXPECT_THAT(file.array<std::uint8_t>("UInt8", "status"), ElementsAre(0, 2, 2, 1));
}

/// A map of no triangles at all: every format stays well-formed, although the mesh has vertices.
TEST(MapFile, OfNoTriangles) {
  const TemporaryFolder folder;
  const Mesh cloud{tetrahedron.vertices, {}};
  for (const char* name : {"map.csv", "map.json", "map.ply", "map.vtp"}) {
    MapWriter(folder / name, &cloud, MapContents::enclosures, MapElements::triangles).finish();
  }
  EXPECT_EQ(folder.contents("map.csv"), "index,lo,hi,status\n");
  EXPECT_EQ(nlohmann::json::parse(folder.contents("map.json"))["results"], nlohmann::json::array());
  EXPECT_EQ(read_mesh(folder / "map.ply").vertices, cloud.vertices);
  EXPECT_THAT(folder.contents("map.ply"), HasSubstr("element face 0\n"));
  const VtpFile file(folder.contents("map.vtp"));
  EXPECT_THAT(file.contents(), HasSubstr("NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" "
                                         "NumberOfPolys=\"0\">"));
  EXPECT_THAT(file.array<double>("Float64", "dist_lo"), IsEmpty());
}

// --- certificates ------------------------------------------------------------------------------------------------

const std::vector<Certificate> certificates{
    {{{0, {0.1, -0.0, 5e-324}}}, std::nullopt},
    {{}, Point{1, 2, 3}},
    {{{2, {1, 0, 0}}, {0, {0, 1e300, 0}}, {7, {-1.5, 0, 2}}}, Point{-0.0, 1e-310, 0.1}},
    {{}, std::nullopt}};

/// `results` with `certificates`, in two pieces.
void write_certified(const std::filesystem::path& path, const Mesh* mesh) {
  MapWriter writer(path, mesh, MapContents::certified);
  const std::span<const Point> points = tetrahedron.vertices;
  writer.append(points.first(3), std::span(results).first(3), std::span(certificates).first(3));
  writer.append(points.last(1), std::span(results).last(1), std::span(certificates).last(1));
  writer.finish();
}

std::string certified(const std::string& name, const Mesh* mesh = nullptr) {
  const TemporaryFolder folder;
  write_certified(folder / name, mesh);
  return folder.contents(name);
}

const std::vector<Certificate> triangle_certificates{
    {{{0, {0.1, -0.0, 5e-324}}}, std::nullopt, {{0.25, 0.1}}},
    {{}, std::nullopt, {{-0.0, 1e300}}},  // proves nothing, but is no less a certificate
    {{{2, {1, 0, 0}}, {0, {0, 1e300, 0}}, {7, {-1.5, 0, 2}}}, std::nullopt, {{5e-324, -1}}},
    {{}, std::nullopt, std::nullopt}};

/// `results` with `triangle_certificates`, in two pieces.
std::string certified_triangles(const std::string& name) {
  const TemporaryFolder folder;
  MapWriter writer(folder / name, &tetrahedron, MapContents::certified, MapElements::triangles);
  writer.append(std::span(results).first(3), std::span(triangle_certificates).first(3));
  writer.append(std::span(results).last(1), std::span(triangle_certificates).last(1));
  writer.finish();
  return folder.contents(name);
}

const std::string csv_header =
    "index,lo,hi,status,primitive,normal_x,normal_y,normal_z,further_normals,escape_x,escape_y,escape_z\n";
const std::vector<std::string> csv_rows{
    "0,0.1,0.30000000000000004,device-verified,0,0.1,-0,5e-324,,,,\n",
    "1,-inf,inf,wide,,,,,,1,2,3\n",
    "2,-2,inf,wide,2,1,0,0,0:0:1e+300:0 7:-1.5:0:2,-0,1e-310,0.1\n",
    "3,-inf,-1e-310,host-verified,,,,,,,,\n",
};

const std::string csv_triangle_header =
    "index,lo,hi,status,primitive,normal_x,normal_y,normal_z,further_normals,weight_1,weight_2\n";
const std::vector<std::string> csv_triangle_rows{
    "0,0.1,0.30000000000000004,device-verified,0,0.1,-0,5e-324,,0.25,0.1\n",
    "1,-inf,inf,wide,,,,,,-0,1e+300\n",
    "2,-2,inf,wide,2,1,0,0,0:0:1e+300:0 7:-1.5:0:2,5e-324,-1\n",
    "3,-inf,-1e-310,host-verified,,,,,,,\n",
};

TEST(CertifiedMap, CsvOfTriangles) {
  EXPECT_EQ(certified_triangles("map.csv"), csv_triangle_header + csv_triangle_rows[0] + csv_triangle_rows[1] +
                                                csv_triangle_rows[2] + csv_triangle_rows[3]);
}

TEST(CertifiedMap, VtpOfTrianglesHoldsTheCertificates) {
  const VtpFile file(certified_triangles("map.vtp"));
  const auto nan = ::testing::NanSensitiveDoubleEq(std::numeric_limits<double>::quiet_NaN());
  EXPECT_THAT(file.contents(), HasSubstr("<CellData Scalars=\"dist_mid\" Vectors=\"normal\">"));
  EXPECT_THAT(file.contents(), HasSubstr("Name=\"weights\" NumberOfComponents=\"2\""));
  EXPECT_THAT(file.contents(), Not(HasSubstr("escape")));
  EXPECT_THAT(file.array<std::int32_t>("Int32", "further_primitive"), ElementsAre(0, 7));
  EXPECT_THAT(file.array<double>("Float64", "dist_lo"), ElementsAre(0.1, -infinity, -2.0, -infinity));
  EXPECT_THAT(file.array<std::int32_t>("Int32", "primitive"), ElementsAre(0, -1, 2, -1));
  EXPECT_THAT(file.array<double>("Float64", "normal"), ElementsAre(0.1, -0.0, 5e-324, 0, 0, 0, 1, 0, 0, 0, 0, 0));
  EXPECT_THAT(file.array<double>("Float64", "weights"), ElementsAre(0.25, 0.1, -0.0, 1e300, 5e-324, -1, nan, nan));
  EXPECT_THAT(file.array<std::int64_t>("Int64", "further_normals_end"), ElementsAre(0, 0, 2, 2));
}

TEST(CertifiedMap, Csv) {
  EXPECT_EQ(certified("map.csv"), csv_header + csv_rows[0] + csv_rows[1] + csv_rows[2] + csv_rows[3]);
}

TEST(CertifiedMap, VtpDeclaresTheCertificates) {
  const std::string contents = certified("map.vtp", &tetrahedron);
  const std::string xml = R"(<?xml version="1.0"?>
<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64">
  <PolyData>
    <FieldData>
        <DataArray type="Int32" Name="further_primitive" NumberOfComponents="1" NumberOfTuples="2" format="appended" offset="0"/>
        <DataArray type="Float64" Name="further_normal" NumberOfComponents="3" NumberOfTuples="2" format="appended" offset="16"/>
    </FieldData>
    <Piece NumberOfPoints="4" NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="4">
      <Points>
        <DataArray type="Float64" Name="Points" NumberOfComponents="3" format="appended" offset="72"/>
      </Points>
      <Polys>
        <DataArray type="Int64" Name="connectivity" NumberOfComponents="1" format="appended" offset="176"/>
        <DataArray type="Int64" Name="offsets" NumberOfComponents="1" format="appended" offset="280"/>
      </Polys>
      <PointData Scalars="dist_mid" Vectors="normal">
        <DataArray type="Float64" Name="dist_lo" NumberOfComponents="1" format="appended" offset="320"/>
        <DataArray type="Float64" Name="dist_hi" NumberOfComponents="1" format="appended" offset="360"/>
        <DataArray type="Float64" Name="dist_mid" NumberOfComponents="1" format="appended" offset="400"/>
        <DataArray type="UInt8" Name="status" NumberOfComponents="1" format="appended" offset="440"/>
        <DataArray type="Int32" Name="primitive" NumberOfComponents="1" format="appended" offset="452"/>
        <DataArray type="Float64" Name="normal" NumberOfComponents="3" format="appended" offset="476"/>
        <DataArray type="Float64" Name="escape" NumberOfComponents="3" format="appended" offset="580"/>
        <DataArray type="Int64" Name="further_normals_end" NumberOfComponents="1" format="appended" offset="684"/>
      </PointData>
    </Piece>
  </PolyData>
  <AppendedData encoding="raw">
_)";
  EXPECT_EQ(contents.substr(0, xml.size()), xml);
  EXPECT_TRUE(contents.ends_with("\n  </AppendedData>\n</VTKFile>\n"));
}

TEST(CertifiedMap, VtpHoldsTheCertificates) {
  const VtpFile file(certified("map.vtp"));
  const auto nan = ::testing::NanSensitiveDoubleEq(std::numeric_limits<double>::quiet_NaN());
  EXPECT_THAT(file.array<std::int32_t>("Int32", "further_primitive"), ElementsAre(0, 7));
  EXPECT_THAT(file.array<double>("Float64", "further_normal"), ElementsAre(0, 1e300, 0, -1.5, 0, 2));
  EXPECT_THAT(file.array<double>("Float64", "Points"), ElementsAre(0, 0, 0, 1, 0, 0, 0, 0.1, 0, 0, 0, 1e300));
  EXPECT_THAT(file.array<double>("Float64", "dist_lo"), ElementsAre(0.1, -infinity, -2.0, -infinity));
  EXPECT_THAT(file.array<std::int32_t>("Int32", "primitive"), ElementsAre(0, -1, 2, -1));
  EXPECT_THAT(file.array<double>("Float64", "normal"), ElementsAre(0.1, -0.0, 5e-324, 0, 0, 0, 1, 0, 0, 0, 0, 0));
  EXPECT_THAT(file.array<double>("Float64", "escape"),
              ElementsAre(nan, nan, nan, 1, 2, 3, -0.0, 1e-310, 0.1, nan, nan, nan));
  EXPECT_THAT(file.array<std::int64_t>("Int64", "further_normals_end"), ElementsAre(0, 0, 2, 2));
}

/// What a VTK reader relies on: the XML before the raw bytes parses, and the arrays lie one after the other, each as
/// long as its tuples (stated in FieldData, those of the piece elsewhere) need.
void expect_arrays_fill_the_appended_part(const std::string& contents) {
  const std::size_t start = contents.find("\n_") + 2;
  pugi::xml_document xml;
  const std::string closed = contents.substr(0, start) + "</AppendedData></VTKFile>";
  ASSERT_TRUE(xml.load_string(closed.c_str()));
  std::size_t end = 0;
  std::size_t arrays = 0;
  for (const pugi::xpath_node& found : xml.select_nodes("//DataArray")) {
    const pugi::xml_node array = found.node();
    const std::string type = array.attribute("type").value();
    const std::size_t number = type == "UInt8" ? 1 : type == "Int32" ? 4 : 8;
    const std::string parent = array.parent().name();
    const pugi::xml_node piece = xml.select_node("//Piece").node();
    std::size_t tuples = piece.attribute("NumberOfPoints").as_ullong();
    if (parent == "FieldData") tuples = array.attribute("NumberOfTuples").as_ullong();
    if (parent == "Polys" || parent == "CellData") tuples = piece.attribute("NumberOfPolys").as_ullong();
    if (array.attribute("Name").value() == std::string("connectivity") && parent == "Polys") tuples *= 3;
    EXPECT_EQ(array.attribute("offset").as_ullong(), end) << array.attribute("Name").value();
    const std::size_t bytes = tuples * array.attribute("NumberOfComponents").as_ullong() * number;
    EXPECT_EQ(number_from<std::uint64_t>(contents.data() + start + end, std::endian::little), bytes);
    end += 8 + bytes;
    ++arrays;
  }
  EXPECT_EQ(arrays, 13U);
  EXPECT_EQ(contents.substr(start + end), "\n  </AppendedData>\n</VTKFile>\n");
}

TEST(CertifiedMap, VtpArraysFillTheAppendedPart) {
  expect_arrays_fill_the_appended_part(certified("map.vtp"));
  expect_arrays_fill_the_appended_part(certified("map.vtp", &tetrahedron));
  expect_arrays_fill_the_appended_part(certified_triangles("map.vtp"));
}

TEST(CertifiedMap, IsWrittenToCsvAndVtpOnly) {
  const TemporaryFolder folder;
  for (const char* name : {"map.ply", "map.json", "map.PLY", "map.npy"}) {
    expect_input_error([&] { MapWriter writer(folder / name, &tetrahedron, MapContents::certified); }, folder / name,
                       ": certificates are written to .csv and .vtp only");
  }
  expect_input_error([&] { MapWriter writer(folder / "map.vtu", nullptr, MapContents::certified); }, folder / "map.vtu",
                     ": unknown map format '.vtu': known are .csv, .npy, .vtp, .ply, .json");
  EXPECT_THAT(folder.names(), IsEmpty());
}

// --- reading -----------------------------------------------------------------------------------------------------

/// All rows, read in pieces of `piece`, into rows that still hold something else.
std::vector<CertifiedRow> read_map(const std::filesystem::path& path, std::size_t piece = 3) {
  MapReader reader(path);
  std::vector<CertifiedRow> all;
  std::vector<CertifiedRow> rows(piece, {{{9, 9}, Status::wide}, {{{9, {9, 9, 9}}}, Point{9, 9, 9}, {{9, 9}}}});
  std::size_t count = 0;
  do {
    count = reader.read(rows);
    all.insert(all.end(), rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(count));
  } while (count == piece);
  EXPECT_EQ(reader.read(rows), 0U);
  return all;
}

/// Equal for equal bits only: hexadecimal digits tell 0 from -0.
std::string text(const MapResult& result, const Certificate& certificate) {
  std::string line = fmt::format("[{:a}, {:a}] {}", result.distance.lo, result.distance.hi, to_string(result.status));
  for (const auto& [primitive, v] : certificate.normals)
    line += fmt::format(" {}: ({:a}, {:a}, {:a})", primitive, v[0], v[1], v[2]);
  if (const auto& e = certificate.escape) line += fmt::format(" escape ({:a}, {:a}, {:a})", (*e)[0], (*e)[1], (*e)[2]);
  if (const auto& w = certificate.weights) line += fmt::format(" weights ({:a}, {:a})", (*w)[0], (*w)[1]);
  return line;
}

TEST(MapReader, GivesBackWhatWasWritten) {
  const TemporaryFolder folder;
  for (const char* name : {"map.csv", "map.vtp", "MAP.CSV", "MAP.VTP"}) {
    for (const Mesh* mesh : {&tetrahedron, static_cast<const Mesh*>(nullptr)}) {
      write_certified(folder / name, mesh);
      for (const std::size_t piece : {1, 2, 3, 4, 5}) {
        const std::vector<CertifiedRow> rows = read_map(folder / name, piece);
        ASSERT_EQ(rows.size(), results.size());
        for (std::size_t k = 0; k < rows.size(); ++k)
          EXPECT_EQ(text(rows[k].result, rows[k].certificate), text(results[k], certificates[k])) << name;
      }
    }
  }
}

TEST(MapReader, GivesBackWhatWasWrittenOfTriangles) {
  const TemporaryFolder folder;
  for (const char* name : {"map.csv", "map.vtp"}) {
    const auto path = folder.file(name, certified_triangles(name));
    EXPECT_EQ(MapReader(path).elements(), MapElements::triangles);
    for (const std::size_t piece : {1, 2, 3, 4, 5}) {
      const std::vector<CertifiedRow> rows = read_map(path, piece);
      ASSERT_EQ(rows.size(), results.size());
      for (std::size_t k = 0; k < rows.size(); ++k)
        EXPECT_EQ(text(rows[k].result, rows[k].certificate), text(results[k], triangle_certificates[k])) << name;
    }
  }
}

TEST(MapReader, GivesBackWitnessesAndCovers) {
  const TemporaryFolder folder;
  for (const MapElements elements : {MapElements::vertices, MapElements::triangles}) {
    std::vector<Certificate> covered = elements == MapElements::vertices ? certificates : triangle_certificates;
    covered[0].witness = {0.1, -0.0, 5e-324};
    covered[0].cover = {true, false, true, false, false};
    covered[2].cover = {false};
    covered[3].witness = {1, 2, 3};
    for (const char* name : {"map.csv", "map.vtp"}) {
      MapWriter writer(folder / name, &tetrahedron, MapContents::covered, elements);
      writer.append(std::span(results), std::span(covered));
      writer.finish();
      const std::vector<CertifiedRow> rows = read_map(folder / name);
      ASSERT_EQ(rows.size(), covered.size());
      for (std::size_t k = 0; k < rows.size(); ++k) {
        EXPECT_EQ(text(rows[k].result, rows[k].certificate), text(results[k], covered[k])) << name;
        EXPECT_EQ(rows[k].certificate, covered[k]) << name << k;
      }
    }
  }
}

TEST(MapReader, TellsVerticesFromTriangles) {
  const TemporaryFolder folder;
  for (const char* name : {"map.csv", "map.vtp"}) {
    for (const Mesh* mesh : {&tetrahedron, static_cast<const Mesh*>(nullptr)}) {
      write_certified(folder / name, mesh);
      EXPECT_EQ(MapReader(folder / name).elements(), MapElements::vertices);
    }
    const Mesh cloud{tetrahedron.vertices, {}};
    MapWriter(folder / name, &cloud, MapContents::certified, MapElements::triangles).finish();
    EXPECT_EQ(MapReader(folder / name).elements(), MapElements::triangles);
    EXPECT_THAT(read_map(folder / name), IsEmpty());
  }
}

/// Random rows of every shape.
class RandomRows {
 public:
  MapResult result() { return {{end(), end()}, static_cast<Status>(below(3))}; }
  Certificate certificate(MapElements elements) {
    Certificate certificate;
    const std::uint64_t normals = below(2) == 0 ? below(2) : below(9);
    for (std::uint64_t k = 0; k < normals; ++k) {
      const auto primitive = static_cast<std::uint32_t>(below(2) == 0 ? below(10) : below(std::uint64_t{1} << 31));
      certificate.normals.push_back({primitive, {finite(), finite(), finite()}});
    }
    if (below(2) == 0) return certificate;
    if (elements == MapElements::vertices) {
      certificate.escape = {finite(), finite(), finite()};
    } else {
      certificate.weights = {finite(), finite()};
    }
    return certificate;
  }

 private:
  std::uint64_t below(std::uint64_t limit) { return bits_() % limit; }
  double finite() {
    if (below(8) == 0) return below(2) == 0 ? 0.0 : -0.0;
    // A zero exponent makes it subnormal.
    const std::uint64_t mask = below(4) == 0 ? 0x800fffffffffffffU : ~std::uint64_t{0};
    const auto value = std::bit_cast<double>(bits_() & mask);
    return std::isfinite(value) ? value : finite();
  }
  double end() {
    if (below(8) == 0) return below(2) == 0 ? infinity : -infinity;
    return finite();
  }

  std::mt19937_64 bits_{20240917};
};

class RandomMaps : public ::testing::TestWithParam<MapElements> {};
INSTANTIATE_TEST_SUITE_P(MapReader, RandomMaps, ::testing::Values(MapElements::vertices, MapElements::triangles));

TEST_P(RandomMaps, ComeBackInEveryBit) {
  RandomRows random;
  std::vector<MapResult> rows;
  std::vector<Certificate> proofs;
  for (std::size_t k = 0; k < 5000; ++k) {
    rows.push_back(random.result());
    proofs.push_back(random.certificate(GetParam()));
  }
  const Mesh mesh{std::vector<Point>(rows.size()), std::vector<std::array<std::uint32_t, 3>>(rows.size())};
  const TemporaryFolder folder;
  for (const char* name : {"map.csv", "map.vtp"}) {
    MapWriter writer(folder / name, &mesh, MapContents::certified, GetParam());
    writer.append(rows, proofs);
    writer.finish();
    const std::vector<CertifiedRow> read = read_map(folder / name, 777);
    ASSERT_EQ(read.size(), rows.size());
    for (std::size_t k = 0; k < rows.size(); ++k)
      ASSERT_EQ(text(read[k].result, read[k].certificate), text(rows[k], proofs[k])) << name << " row " << k;
  }
}

TEST(MapReader, ReadsMapsWithoutRows) {
  const TemporaryFolder folder;
  for (const char* name : {"map.csv", "map.vtp"}) {
    MapWriter(folder / name, nullptr, MapContents::certified).finish();
    EXPECT_THAT(read_map(folder / name), IsEmpty()) << name;
  }
}

TEST(MapReader, ReadsThePartOfAnInterruptedCsv) {
  const TemporaryFolder folder;
  MapWriter writer(folder / "map.csv", nullptr, MapContents::certified);
  writer.append(std::vector<Point>(1), std::span(results).first(1), std::span(certificates).first(1));
  const std::vector<CertifiedRow> rows = read_map(writer.keep_partial());
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows[0].certificate, certificates[0]);
}

TEST(MapReader, LeavesOutARowThatWasBeingWritten) {
  const TemporaryFolder folder;
  for (const char* name : {"map.csv.partial", "map.csv.00c0ffee.partial", "MAP.CSV.PARTIAL"}) {
    for (std::size_t size = 0; size < csv_rows[1].size(); ++size) {
      const auto path = folder.file(name, csv_header + csv_rows[0] + csv_rows[1].substr(0, size));
      EXPECT_TRUE(MapReader(path).partial());
      EXPECT_EQ(read_map(path).size(), 1U) << name << ", " << size << " bytes";
    }
    EXPECT_EQ(read_map(folder.file(name, csv_header + csv_rows[0] + csv_rows[1])).size(), 2U);
  }
  EXPECT_FALSE(MapReader(folder.file("map.csv", csv_header)).partial());
  const auto vtp = folder.file("map.vtp.00c0ffee.partial", "");
  expect_input_error([&] { read_map(vtp); }, vtp,
                     ": what a killed run left of a .vtp, which is written when all is known: map again");
}

TEST(MapReader, RefusesOtherFormats) {
  const TemporaryFolder folder;
  for (const std::string extension : {".ply", ".json", "", ".partial", ".vtp.partial"}) {
    const auto path = folder.file("map" + extension, csv_header);
    expect_input_error([&] { read_map(path); }, path,
                       ": a map as '" + path.extension().string() + "': check reads .csv and .vtp");
  }
  expect_input_error([&] { read_map(folder / "none.csv"); }, folder / "none.csv", ": no such file");
  expect_input_error([&] { read_map(folder / "none.vtp"); }, folder / "none.vtp", ": no such file");
}

TEST(MapReader, RefusesMapsWithoutCertificates) {
  const TemporaryFolder folder;
  const std::string advice = "written without `certificates`: map again with `certificates`";
  write(folder / "map.csv", nullptr);
  expect_input_error([&] { read_map(folder / "map.csv"); }, folder / "map.csv", ": line 1: " + advice);
  write(folder / "map.vtp", nullptr);
  expect_input_error([&] { read_map(folder / "map.vtp"); }, folder / "map.vtp", ": " + advice);
}

void expect_refused(const std::string& name, const std::string& contents, const std::string& message) {
  const TemporaryFolder folder;
  const auto path = folder.file(name, contents);
  expect_input_error([&] { read_map(path); }, path, ": " + message);
}

TEST(MapReader, RefusesCsvWithAnotherHeader) {
  const std::string expected = csv_header.substr(0, csv_header.size() - 1) + "; of triangles " +
                               csv_triangle_header.substr(0, csv_triangle_header.size() - 1);
  for (const std::string header : {"", "index,lo,hi", "Index,lo"}) {
    expect_refused("map.csv", header + "\n" + csv_rows[0],
                   fmt::format("line 1: '{}': not the header of a map: expected {}", header, expected));
  }
  expect_refused("map.csv", "", "the file is empty");
}

struct BadRow {
  std::string row;
  std::string message;
};

TEST(MapReader, RefusesBadCsvRows) {
  const std::vector<BadRow> cases{
      {"", "'': 1 fields, expected 12"},
      {"0,1,2,wide,,,,,,,", "'0,1,2,wide,,,,,,,': 11 fields, expected 12"},
      {"0,1,2,wide,,,,,,,,,", "'0,1,2,wide,,,,,,,,,': 13 fields, expected 12"},
      {"1,1,2,wide,,,,,,,,", "index = '1': expected 0"},
      {"-1,1,2,wide,,,,,,,,", "index = '-1': expected 0"},
      {"a,1,2,wide,,,,,,,,", "index = 'a': not an integer"},
      {",1,2,wide,,,,,,,,", "index is missing"},
      {"99999999999999999999,1,2,wide,,,,,,,,", "index = '99999999999999999999': not an integer"},
      {"0,nan,2,wide,,,,,,,,", "lo = 'nan': not a finite number"},
      {"0,1,-nan,wide,,,,,,,,", "hi = '-nan': not a finite number"},
      {"0,,2,wide,,,,,,,,", "lo is missing"},
      {"0,1, 2,wide,,,,,,,,", "hi = ' 2': not a number"},
      {"0,1,2x,wide,,,,,,,,", "hi = '2x': not a number"},
      {"0,1,2e999,wide,,,,,,,,", "hi = '2e999': beyond the range of binary64"},
      {"0,1,2,Wide,,,,,,,,", "status = 'Wide': not one of device-verified, host-verified, wide"},
      {"0,1,2,,,,,,,,,", "status = '': not one of device-verified, host-verified, wide"},
      {"0,1,2,wide,-1,1,0,0,,,,", "primitive = '-1': not an index of a primitive"},
      {"0,1,2,wide,4294967296,1,0,0,,,,", "primitive = '4294967296': not an index of a primitive"},
      {"0,1,2,wide,1.0,1,0,0,,,,", "primitive = '1.0': not an integer"},
      {"0,1,2,wide,,1,0,0,,,,", "primitive is missing"},
      {"0,1,2,wide,1,,,,,,,", "primitive = '1': without a first normal"},
      {"0,1,2,wide,1,1,,0,,,,", "normal_y is missing"},
      {"0,1,2,wide,1,1,inf,0,,,,", "normal_y = 'inf': not a finite number"},
      {"0,1,2,wide,,,,,1:1:1:1,,,", "further_normals = '1:1:1:1': without a first normal"},
      {"0,1,2,wide,1,1,1,1,1:1:1,,,", "further_normals: '1:1:1': expected primitive:x:y:z"},
      {"0,1,2,wide,1,1,1,1,1:1:1:1:1,,,", "further_normals: '1:1:1:1:1': expected primitive:x:y:z"},
      {"0,1,2,wide,1,1,1,1,1:1:1:1 -2:1:1:1,,,", "primitive = '-2': not an index of a primitive"},
      {"0,1,2,wide,1,1,1,1,1:1:nan:1,,,", "y = 'nan': not a finite number"},
      {"0,1,2,wide,1,1,1,1,1:1:1:,,,", "z is missing"},
      {"0,1,2,wide,,,,,,1,2,", "escape_z is missing"},
      {"0,1,2,wide,,,,,,nan,nan,nan", "escape_x = 'nan': not a finite number"},
      {std::string("0,1,2,wi\0de,,,,,,,,", 19),
       "status = 'wi\\x00de': not one of device-verified, host-verified, wide"},
  };
  for (const auto& [row, message] : cases) {
    expect_refused("map.csv", csv_header + row + "\n", "line 2: " + message);
    if (!row.empty()) expect_refused("map.csv", csv_header + row, "line 2: " + message);
  }
  expect_refused("map.csv", csv_header + csv_rows[0] + csv_rows[0], "line 3: index = '0': expected 1");
  expect_refused("map.csv", csv_header + csv_rows[0] + "\n", "line 3: '': 1 fields, expected 12");
}

TEST(MapReader, RefusesBadCsvRowsOfTriangles) {
  const std::vector<BadRow> cases{
      {"", "'': 1 fields, expected 11"},
      {"0,1,2,wide,,,,,,", "'0,1,2,wide,,,,,,': 10 fields, expected 11"},
      {"0,1,2,wide,,,,,,,,", "'0,1,2,wide,,,,,,,,': 12 fields, expected 11"},
      {"1,1,2,wide,,,,,,,", "index = '1': expected 0"},
      {"0,1,nan,wide,,,,,,,", "hi = 'nan': not a finite number"},
      {"0,1,2,wide,1,1,,0,,,", "normal_y is missing"},
      {"0,1,2,wide,1,1,1,1,1:1:1,,", "further_normals: '1:1:1': expected primitive:x:y:z"},
      {"0,1,2,wide,,,,,,1,", "weight_2 is missing"},
      {"0,1,2,wide,,,,,,,1", "weight_1 is missing"},
      {"0,1,2,wide,,,,,,nan,nan", "weight_1 = 'nan': not a finite number"},
      {"0,1,2,wide,,,,,,0,inf", "weight_2 = 'inf': not a finite number"},
      {"0,1,2,wide,,,,,,0.5x,0", "weight_1 = '0.5x': not a number"},
      {"0,1,2,wide,,,,,,0,1e999", "weight_2 = '1e999': beyond the range of binary64"},
  };
  for (const auto& [row, message] : cases) {
    expect_refused("map.csv", csv_triangle_header + row + "\n", "line 2: " + message);
  }
  expect_refused("map.csv", csv_triangle_header + csv_rows[0],
                 "line 2: '" + csv_rows[0].substr(0, 60) + "...': 12 fields, expected 11");
  expect_refused("map.csv", csv_triangle_header + csv_triangle_rows[0] + csv_triangle_rows[0],
                 "line 3: index = '0': expected 1");
}

TEST(MapReader, ReadsTheLargestIndexOfAPrimitive) {
  const TemporaryFolder folder;
  const auto path = folder.file("map.csv", csv_header + "0,1,2,wide,4294967295,1,0,0,,,,\r\n");
  EXPECT_EQ(read_map(path).at(0).certificate.normals.at(0).primitive, 4294967295U);
}

/// A cut may shorten the last number of a certificate, never an enclosure.
TEST(MapReader, NoticesWhereACsvIsCut) {
  const TemporaryFolder folder;
  const std::string rows = csv_header + csv_rows[0] + csv_rows[1] + csv_rows[2];
  const std::size_t last_row = rows.size() - csv_rows[2].size();
  const std::size_t last_field = rows.rfind(',') + 1;
  for (std::size_t size = last_row + 1; size < last_field; ++size) {
    const auto path = folder.file("map.csv", rows.substr(0, size));
    EXPECT_THROW(read_map(path), Error) << size;
  }
  const auto path = folder.file("map.csv", rows.substr(0, rows.size() - 2));
  EXPECT_EQ(read_map(path).at(2).result.distance.lo, -2.0);
}

std::string replaced(std::string contents, const std::string& from, const std::string& to) {
  const std::size_t at = contents.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return contents.replace(at, from.size(), to);
}

struct BadElement {
  std::string from;
  std::string to;
  std::string place;  ///< what the changed file holds at the byte that the message names
  std::string message;
};

TEST(MapReader, RefusesVtpOfOtherKinds) {
  const std::string map = certified("map.vtp");
  const std::string wide = "99999999999999999999";
  const std::string appended = "_\x08";  // the first array has 8 bytes
  const std::vector<BadElement> cases{
      {"\"PolyData\"", "\"ImageData\"", "VTKFile", "'VTKFile': type = 'ImageData': expected 'PolyData'"},
      {"\"1.0\" b", "\"0.1\" b", "VTKFile", "'VTKFile': version = '0.1': expected '1.0'"},
      {"LittleEndian", "BigEndian", "VTKFile", "'VTKFile': byte_order = 'BigEndian': expected 'LittleEndian'"},
      {"UInt64", "UInt32", "VTKFile", "'VTKFile': header_type = 'UInt32': expected 'UInt64'"},
      {"header_type=\"UInt64\"", "", "VTKFile", "'VTKFile': header_type = '': expected 'UInt64'"},
      {"<VTKFile ", "<VTKFile compressor=\"z\" ", "VTKFile", "'VTKFile': compressor = 'z': expected ''"},
      {"\"raw\"", "\"base64\"", "AppendedData", "'AppendedData': encoding = 'base64': expected 'raw'"},
      {"<VTKFile ", "<File ", appended, "not XML: Start-end tags mismatch"},
      {"<VTKFile ", "VTKFile ", appended, "not XML: Start-end tags mismatch"},
      {"<AppendedData", "<!-- <AppendedData", appended, "not XML: Error parsing comment"},
      {"encoding", "en_coding", "_coding", "not XML: Error parsing element attribute"},
      {"<FieldData>", "<FieldData/><FieldData>", "FieldData>", "'FieldData': a second one"},
      {"<Piece ", "<Piece/><Piece ", "Piece N", "'Piece': a second one"},
      {"<PointData ", "<PointData/><PointData ", "PointData S", "'PointData': a second one"},
      {"NumberOfPoints=\"4\"", "NumberOfPoints=\"-4\"", "Piece",
       "'Piece': NumberOfPoints = '-4': not a whole number of 64 bits"},
      {"NumberOfPoints=\"4\"", "NumberOfPoints=\"" + wide + "\"", "Piece",
       "'Piece': NumberOfPoints = '" + wide + "': not a whole number of 64 bits"},
      {"NumberOfPoints=\"4\"", "", "Piece", "'Piece': NumberOfPoints = '': not a whole number of 64 bits"},
      {"NumberOfTuples=\"2\"", "", "DataArray", "'DataArray': NumberOfTuples = '': not a whole number of 64 bits"},
      {"offset=\"0\"", "offset=\"0 \"", "DataArray", "'DataArray': offset = '0 ': not a whole number of 64 bits"},
      {"Name=\"escape\"", "Name=\"refuge\"", "PointData", "'PointData': no DataArray with Name = 'escape'"},
      {"Name=\"dist_mid\"", "Name=\"dist_lo\" ", "DataArray type=\"Float64\" Name=\"dist_lo\"  ",
       "'DataArray': Name = 'dist_lo': a second one"},
      {"\"Float64\" Name=\"dist_hi\"", "\"Float32\" Name=\"dist_hi\"", "DataArray type=\"Float32\"",
       "'DataArray': type = 'Float32': expected 'Float64'"},
      {"Name=\"normal\" NumberOfComponents=\"3\"", "Name=\"normal\" NumberOfComponents=\"4\"",
       "DataArray type=\"Float64\" Name=\"normal\"", "'DataArray': NumberOfComponents = '4': expected '3'"},
      {"appended", "ascii", "DataArray", "'DataArray': format = 'ascii': expected 'appended'"},
  };
  for (const auto& [from, to, place, message] : cases) {
    const std::string changed = replaced(map, from, to);
    expect_refused("map.vtp", changed, fmt::format("byte {}: {}", changed.find(place), message));
  }
  expect_refused("map.vtp", "index,lo,hi,status\n", "no appended data in the first 19 bytes: not a map as .vtp");
  expect_refused("map.vtp", "", "the file is empty");
}

TEST(MapReader, RefusesVtpSizesThatTheFileDoesNotHold) {
  const std::string map = certified("map.vtp");
  const std::string huge = "18446744073709551615";
  const std::vector<std::array<std::string, 3>> cases{
      {"NumberOfPoints=\"4\"", "NumberOfPoints=\"5\"", "array 'Points': 96 bytes, expected 5 times 24"},
      {"NumberOfPoints=\"4\"", "NumberOfPoints=\"" + huge + "\"",
       "array 'Points': 96 bytes, expected " + huge + " times 24"},
      // 24 times this is 0 in 64 bits, and 96 when it is one of 4 more.
      {"NumberOfPoints=\"4\"", "NumberOfPoints=\"2305843009213693956\"",
       "array 'Points': 96 bytes, expected 2305843009213693956 times 24"},
      {"NumberOfTuples=\"2\"", "NumberOfTuples=\"3\"", "array 'further_primitive': 8 bytes, expected 3 times 4"},
      {"offset=\"16\"", "offset=\"15\"", "array 'further_normal': offset = 15: the array before it ends at 16"},
      {"offset=\"16\"", "offset=\"0\"", "array 'further_normal': offset = 0: the array before it ends at 16"},
      {"offset=\"16\"", "offset=\"17\"", "array 'further_normal': 0 bytes, expected 2 times 24"},
      {"offset=\"16\"", "offset=\"" + huge + "\"",
       "array 'further_normal': offset = " + huge + ": beyond the end of the file"},
  };
  for (const auto& [from, to, message] : cases) expect_refused("map.vtp", replaced(map, from, to), message);

  // A file that declares and counts as many bytes as there are addresses.
  std::string vast = replaced(map, "NumberOfTuples=\"2\"", "NumberOfTuples=\"2305843009213693951\"");
  const std::uint64_t bytes = in_little_endian(std::uint64_t{4} * 2305843009213693951U);
  std::memcpy(vast.data() + vast.find("\n_") + 2, &bytes, sizeof bytes);
  expect_refused("map.vtp", vast,
                 "array 'further_primitive': truncated: 9223372036854775804 bytes, the file has 682 more");
}

/// `map`, a .vtp, with one number of an array changed.
template <class Number>
std::string with_number(std::string map, const std::string& name, std::size_t index, Number number) {
  const std::string key = "offset=\"";
  const std::size_t offset = std::stoul(map.substr(map.find(key, map.find("Name=\"" + name + "\"")) + key.size()));
  const Number stored = in_little_endian(number);
  std::memcpy(map.data() + map.find("\n_") + 2 + offset + 8 + index * sizeof(Number), &stored, sizeof stored);
  return map;
}

/// The map of `certificates` with one number of an array changed.
template <class Number>
std::string with_number(const std::string& name, std::size_t index, Number number) {
  return with_number(certified("map.vtp"), name, index, number);
}

TEST(MapReader, RefusesVtpTriangleValuesThatAreNone) {
  const std::string map = certified_triangles("map.vtp");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect_refused("map.vtp", with_number(map, "dist_lo", 2, nan), "triangle 2: dist_lo = nan");
  expect_refused("map.vtp", with_number(map, "primitive", 0, -2), "triangle 0: primitive = -2");
  expect_refused("map.vtp", with_number(map, "weights", 1, nan),
                 "triangle 0: weights = 0.25 nan: neither finite nor all nan");
  expect_refused("map.vtp", with_number(map, "weights", 2, nan),
                 "triangle 1: weights = nan 1e+300: neither finite nor all nan");
  expect_refused("map.vtp", with_number(map, "weights", 6, 0.0),
                 "triangle 3: weights = 0 nan: neither finite nor all nan");
  expect_refused("map.vtp", with_number(map, "weights", 4, -infinity),
                 "triangle 2: weights = -inf -1: neither finite nor all nan");
  expect_refused("map.vtp", with_number<std::int64_t>(map, "further_normals_end", 0, -1),
                 "triangle 0: further_normals_end = -1: expected at least 0");
  expect_refused("map.vtp", with_number<std::int64_t>(map, "further_normals_end", 3, 3),
                 "further_normals_end = 3 at the last triangle: expected 2");
}

/// Cell data has a row for every cell of the piece: only where all are triangles are the rows theirs.
TEST(MapReader, RefusesVtpWhoseRowsAreNotThoseOfTriangles) {
  const std::string map = certified_triangles("map.vtp");
  const std::vector<BadElement> cases{
      {"NumberOfVerts=\"0\"", "NumberOfVerts=\"1\"", "Piece", "'Piece': NumberOfVerts = '1': expected '0'"},
      {"NumberOfLines=\"0\"", "NumberOfLines=\"4\"", "Piece", "'Piece': NumberOfLines = '4': expected '0'"},
      {"NumberOfStrips=\"0\"", "", "Piece", "'Piece': NumberOfStrips = '': expected '0'"},
      {"NumberOfPolys=\"4\"", "NumberOfPolys=\"-1\"", "Piece",
       "'Piece': NumberOfPolys = '-1': not a whole number of 64 bits"},
      {"<CellData ", "<CellData/><CellData ", "CellData S", "'CellData': a second one"},
      {"<CellData ", "<PointData><DataArray Name=\"primitive\"/></PointData><CellData ", "Piece",
       "'Piece': both points and cells have a DataArray 'primitive'"},
      {"Name=\"weights\"", "Name=\"escape\"", "CellData", "'CellData': no DataArray with Name = 'weights'"},
      {"Name=\"weights\" NumberOfComponents=\"2\"", "Name=\"weights\" NumberOfComponents=\"3\"",
       "DataArray type=\"Float64\" Name=\"weights\"", "'DataArray': NumberOfComponents = '3': expected '2'"},
  };
  for (const auto& [from, to, place, message] : cases) {
    const std::string changed = replaced(map, from, to);
    expect_refused("map.vtp", changed, fmt::format("byte {}: {}", changed.find(place), message));
  }
  expect_refused("map.vtp", replaced(map, "NumberOfPolys=\"4\"", "NumberOfPolys=\"5\""),
                 "array 'connectivity': 96 bytes, expected 5 times 24");
}

struct AddedElement {
  std::string from;
  std::string to;
  std::string message;
};

/// What nobody checks, a viewer may show instead of what was checked.
TEST(MapReader, RefusesVtpWithAnythingThatIsNotChecked) {
  const std::string array =
      R"(<DataArray type="Float64" Name="EXTRA" NumberOfComponents="1" format="appended" offset="320"/>)";
  const std::vector<AddedElement> cases{
      {"      </PointData>", array + "      </PointData>", "'<DataArray type=\"Float64\" Name=\"EXTRA\" Numb"},
      {"      <PointData ", "<CellData>" + array + "</CellData>      <PointData ", "'<CellData>"},
      {"      <Polys>", "<Verts>" + array + "</Verts>      <Polys>", "'<Verts>"},
      {"    </FieldData>", array + "    </FieldData>", "'<DataArray"},
      {"Scalars=\"dist_mid\"", "Scalars=\"dist_lo\"", "'Scalars=\"dist_lo\" Vectors"},
      {"NumberOfPolys=\"4\"", "NumberOfPolys=\"4\" Extent=\"1\"", "'NumberOfPolys=\"4\" Extent"},
      {"NumberOfVerts=\"0\"", "NumberOfVerts=\"4\"", "'NumberOfVerts=\"4\""},
      {"      <Points>", "<!-- note -->      <Points>", "'<!-- note -->"},
      {"<?xml version=\"1.0\"?>", "<?xml version=\"1.1\"?>", "'version=\"1.1\"?>'"},
  };
  const std::string map = certified("map.vtp", &tetrahedron);
  const TemporaryFolder folder;
  for (const auto& [from, to, message] : cases) {
    const auto path = folder.file("map.vtp", replaced(map, from, to));
    try {
      read_map(path);
      ADD_FAILURE() << to;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      EXPECT_THAT(error.what(), HasSubstr(": " + message));
      EXPECT_THAT(error.what(), HasSubstr(": expected '"));
    }
  }
  expect_refused("map.vtp", map + " ", fmt::format("byte {}: not the end of a map", map.rfind("\n  </App")));
  expect_refused("map.vtp", map.substr(0, map.size() - 1),
                 fmt::format("byte {}: not the end of a map", map.rfind("\n  </App")));
}

/// The first difference of the map at `path` from `mesh`, in one line.
std::string difference(const std::filesystem::path& path, const Mesh& mesh) {
  MapReader reader(path);
  const auto found = reader.difference_from(mesh);
  if (!found) return "";
  return found->array + (found->index ? fmt::format("[{}]", *found->index) : "") + " " + found->shown + " for " +
         found->expected;
}

/// What the reader has of a map: its rows, and how the picture differs from that of the tetrahedron.
std::string all_that_is_read(const std::filesystem::path& path) {
  std::string all = difference(path, tetrahedron);
  for (const CertifiedRow& row : read_map(path)) all += fmt::format("\n{}", text(row.result, row.certificate));
  return all;
}

TEST(MapReader, NoticesEveryChangedByteOfAVtp) {
  const TemporaryFolder folder;
  const auto write = [&](MapElements elements, const std::vector<Certificate>& of_rows) {
    MapWriter writer(folder / "map.vtp", &tetrahedron, MapContents::certified, elements);
    writer.append(results, of_rows);
    writer.finish();
    return folder.contents("map.vtp");
  };
  const Certificate& a = triangle_certificates[0];
  const Certificate& b = triangle_certificates[1];
  const Certificate& c = triangle_certificates[2];
  for (const std::string& map :
       {write(MapElements::vertices, {certificates[1], certificates[2], certificates[2], certificates[1]}),
        write(MapElements::triangles, {a, b, c, a})}) {
    const auto path = folder / "map.vtp";
    const std::string honest = all_that_is_read(folder.file("map.vtp", map));
    for (std::size_t k = 0; k < map.size(); ++k) {
      std::string changed = map;
      changed[k] = static_cast<char>(map[k] ^ 1);
      std::filesystem::remove(path);  // rewriting thousands of files in place is slow
      (void)folder.file("map.vtp", changed);
      try {
        EXPECT_NE(all_that_is_read(path), honest) << "byte " << k;
      } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input) << error.what();
      }
    }
  }
}

TEST(MapReader, RefusesVtpNormalsOfNoPrimitive) {
  expect_refused("map.vtp", with_number("normal", 4, 0.5), "point 1: normal = 0 0.5 0: of no primitive");
}

TEST(MapReader, FindsWhatIsDrawnDifferently) {
  const TemporaryFolder folder;
  const Mesh points{tetrahedron.vertices, {}};
  const auto csv = folder.file("map.csv", certified("map.csv"));
  EXPECT_FALSE(MapReader(csv).draws());
  EXPECT_EQ(difference(csv, {}), "");
  const auto cloud = folder.file("map.vtp", certified("map.vtp"));
  EXPECT_TRUE(MapReader(cloud).draws());
  EXPECT_EQ(difference(cloud, points), "");
  EXPECT_EQ(difference(cloud, tetrahedron), "NumberOfPolys 0 for 4");
  EXPECT_EQ(difference(cloud, {}), "NumberOfPoints 4 for 0");
  for (const std::string& map : {certified("map.vtp", &tetrahedron), certified_triangles("map.vtp")}) {
    const auto path = folder.file("map.vtp", map);
    EXPECT_EQ(difference(path, tetrahedron), "");
    EXPECT_EQ(difference(path, points), "NumberOfPolys 4 for 0");
    Mesh moved = tetrahedron;
    moved.vertices[2][1] = std::nextafter(0.1, 1.0);
    EXPECT_EQ(difference(path, moved), "Points[2] (0, 0.10000000000000001, 0) for (0, 0.10000000000000002, 0)");
    moved = tetrahedron;
    std::swap(moved.triangles[1], moved.triangles[2]);
    EXPECT_EQ(difference(path, moved), "connectivity[1] (0, 1, 3) for (1, 2, 3)");
  }
}

TEST(MapReader, RefusesVtpValuesThatAreNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect_refused("map.vtp", with_number("dist_lo", 2, nan), "point 2: dist_lo = nan");
  expect_refused("map.vtp", with_number("dist_hi", 3, nan), "point 3: dist_hi = nan");
  expect_refused("map.vtp", with_number<std::uint8_t>("status", 1, 3), "point 1: status = 3");
  expect_refused("map.vtp", with_number("primitive", 0, -2), "point 0: primitive = -2");
  expect_refused("map.vtp", with_number("primitive", 2, -1), "point 2: further normals without a first normal");
  expect_refused("map.vtp", with_number("normal", 0, infinity), "point 0: normal = inf -0 5e-324: not finite");
  expect_refused("map.vtp", with_number("escape", 3, nan), "point 1: escape = nan 2 3: neither finite nor all nan");
  expect_refused("map.vtp", with_number("escape", 0, 1.0), "point 0: escape = 1 nan nan: neither finite nor all nan");
  expect_refused("map.vtp", with_number("further_primitive", 1, -1), "further normal 1: primitive = -1");
  expect_refused("map.vtp", with_number("further_normal", 2, -infinity), "further normal 0: 0 1e+300 -inf: not finite");
}

TEST(MapReader, RefusesVtpFurtherNormalsThatDoNotAddUp) {
  const auto ends = [](std::size_t point, std::int64_t end) { return with_number("further_normals_end", point, end); };
  expect_refused("map.vtp", ends(0, -1), "point 0: further_normals_end = -1: expected at least 0");
  expect_refused("map.vtp", ends(3, 1), "point 3: further_normals_end = 1: expected at least 2");
  expect_refused("map.vtp", ends(3, 3), "further_normals_end = 3 at the last point: expected 2");
  expect_refused("map.vtp", ends(2, std::numeric_limits<std::int64_t>::max()),
                 "point 3: further_normals_end = 2: expected at least 9223372036854775807");
  expect_refused("map.vtp", ends(3, std::numeric_limits<std::int64_t>::max()),
                 "further_normals_end = 9223372036854775807 at the last point: expected 2");
  std::string fewer =
      replaced(certified("map.vtp"), "Components=\"3\" NumberOfTuples=\"2\"", "Components=\"3\" NumberOfTuples=\"1\"");
  const std::uint64_t bytes = in_little_endian(std::uint64_t{24});
  std::memcpy(fewer.data() + fewer.find("\n_") + 2 + 16, &bytes, sizeof bytes);
  expect_refused("map.vtp", fewer, "2 of further_primitive, but 1 of further_normal");
}

/// Reads and removes the map (rewriting thousands of files in place is slow); an error must be the user's, in one line.
void expect_rows_or_input_error(const std::filesystem::path& path) {
  try {
    EXPECT_THAT(read_map(path).size(), ::testing::Le(4U));
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input) << error.what();
    EXPECT_THAT(error.what(), Not(HasSubstr("\n")));
  }
  std::filesystem::remove(path);
}

TEST(MapReader, NoticesWhereAVtpIsCut) {
  const TemporaryFolder folder;
  for (const std::string& map : {certified("map.vtp"), certified_triangles("map.vtp")}) {
    const std::size_t arrays_end = map.find("\n  </AppendedData>");
    for (std::size_t size = 0; size < arrays_end; ++size) {
      const auto path = folder.file("map.vtp", map.substr(0, size));
      EXPECT_THROW(read_map(path), Error) << size;
      expect_rows_or_input_error(path);
    }
  }
}

TEST(MapReader, SurvivesAnyChangedByte) {
  const TemporaryFolder folder;
  for (const std::string name : {"map.csv", "map.vtp"}) {
    for (const std::string& map : {certified(name), certified_triangles(name)}) {
      for (std::size_t k = 0; k < map.size(); ++k) {
        for (const char byte : {'\0', '9', static_cast<char>(map[k] ^ 1)}) {
          std::string changed = map;
          changed[k] = byte;
          expect_rows_or_input_error(folder.file(name, changed));
        }
      }
    }
  }
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

/// As a killed run leaves it: without the writer's destructor.
TEST(MapFile, CsvHoldsEveryAppendedRowAtOnce) {
  const TemporaryFolder folder;
  MapWriter writer(folder / "map.csv", nullptr);
  const auto so_far = [&] { return folder.contents(folder.names().at(0)); };
  EXPECT_EQ(so_far(), "index,lo,hi,status\n");
  writer.append(std::vector<Point>(1), std::span(results).first(1));
  EXPECT_EQ(so_far(), "index,lo,hi,status\n0,0.1,0.30000000000000004,device-verified\n");
}

TEST(MapFile, KeepsThePartOfAnInterruptedCsv) {
  const TemporaryFolder folder;
  MapWriter writer(folder / "map.csv", nullptr);
  writer.append(std::vector<Point>(1), std::span(results).first(1));
  EXPECT_EQ(writer.keep_partial(), folder / "map.csv.partial");
  EXPECT_EQ(folder.contents("map.csv.partial"), "index,lo,hi,status\n0,0.1,0.30000000000000004,device-verified\n");
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
    const std::string more = extension.empty() ? "; end the file's name in one, or name the format" : "";
    expect_input_error([&] { MapWriter writer(path, nullptr); }, path,
                       ": unknown map format '" + extension + "': known are .csv, .npy, .vtp, .ply, .json" + more);
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
    expect_error(
        [&] {
          MapWriter writer(path, &tetrahedron, MapContents::enclosures, MapElements::triangles);
          writer.append(std::span(results).first(3));
          writer.finish();
        },
        ErrorKind::failure, path.string(), ": cannot be written: 3 results for 4 triangles");
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
