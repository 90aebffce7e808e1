/// What people look at: the page holds every bit of the map, texts cannot break out of it, surfaces are those of the
/// model, pictures show warm and cold where they belong.
#include <cairo.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <regex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>
#include <verisq/distance.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/files.hpp>
#include <verisq/report.hpp>

#include "host/files/input_file.hpp"
#include "host/report/html_report.hpp"
#include "host/report/projection.hpp"
#include "tests/fixtures/error_matchers.hpp"
#include "tests/fixtures/places.hpp"
#include "tests/fixtures/program_test.hpp"
#include "tests/fixtures/temporary_folder.hpp"

namespace verisq::testing {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

// ---------------------------------------------------------------- surfaces

Model model_of(const Superquadric& superquadric, std::optional<Bend> bend = {}) {
  const Pose pose{{0.3, -2.0, 5.0}, {0.4, -1.0, 0.2, 3.0}};
  return {"mm", {{"a", superquadric, pose, bend}}};
}

using Edge = std::pair<std::uint32_t, std::uint32_t>;

/// How often each directed edge occurs.
std::map<Edge, int> edges_of(const Mesh& mesh) {
  std::map<Edge, int> edges;
  for (const auto& [i, j, k] : mesh.triangles) {
    for (const Edge& edge : {Edge{i, j}, Edge{j, k}, Edge{k, i}}) ++edges[edge];
  }
  return edges;
}

/// Every edge lies between two triangles that agree on what is outside.
void expect_closed(const Mesh& mesh) {
  const std::map<Edge, int> edges = edges_of(mesh);
  for (const auto& [edge, count] : edges) {
    ASSERT_EQ(count, 1);
    ASSERT_TRUE(edges.contains({edge.second, edge.first}));
  }
}

/// Vertices, less edges, plus triangles.
long euler_characteristic(const Mesh& mesh) {
  return static_cast<long>(mesh.vertices.size()) - static_cast<long>(edges_of(mesh).size() / 2) +
         static_cast<long>(mesh.triangles.size());
}

/// Positive for triangles that look outward.
double volume(const Mesh& mesh) {
  const Point& o = mesh.vertices.front();
  double six_times = 0.0;
  for (const auto& triangle : mesh.triangles) {
    std::array<Point, 3> v;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      for (std::size_t axis = 0; axis < 3; ++axis) v[corner][axis] = mesh.vertices[triangle[corner]][axis] - o[axis];
    }
    six_times += v[0][0] * (v[1][1] * v[2][2] - v[1][2] * v[2][1]) + v[0][1] * (v[1][2] * v[2][0] - v[1][0] * v[2][2]) +
                 v[0][2] * (v[1][0] * v[2][1] - v[1][1] * v[2][0]);
  }
  return six_times / 6.0;
}

/// Jaklic, Leonardis, Solina: Segmentation and Recovery of Superquadrics (2000), §2.4.
double exact_volume(const Superquadric& s) {
  const auto [e1, e2] = s.exponents;
  return 2.0 * s.semi_axes[0] * s.semi_axes[1] * s.semi_axes[2] * e1 * e2 * std::beta(e1 / 2.0 + 1.0, e1) *
         std::beta(e2 / 2.0, e2 / 2.0);
}

/// The same solid, of which distances are searched: certificates are tight outside, and inside, not always within a
/// rounding of a sharp tapered edge.
Model searched(Model model) {
  model.csg = SetExpression{{{{}, SetOperation::unite, 0}}, SetOperation::intersect};
  return model;
}

/// What the taper makes of the volume: with u the height before, sections grow by (1 - k^2)/(1 - ku), and heights by
/// (1 - k^2)/(1 - ku)^2 (docs/mathematics.md §18). Midpoints: the integrand is smooth but at the ends.
double tapered_volume(const Superquadric& s) {
  constexpr int steps = 200000;
  const double k = (s.taper - 1.0) / (s.taper + 1.0);
  double tapered = 0.0;
  double straight = 0.0;
  for (int step = 0; step < steps; ++step) {
    const double u = (2.0 * step + 1.0) / steps - 1.0;
    const double section = std::pow(1.0 - std::pow(std::abs(u), 2.0 / s.exponents[0]), s.exponents[0]);
    straight += section;
    tapered += section * std::pow(1.0 - k * k, 3.0) / std::pow(1.0 - k * u, 4.0);
  }
  return exact_volume(s) * tapered / straight;
}

/// Some of the vertices, by proof.
void expect_on_surface(const Mesh& mesh, const Model& model, double tolerance) {
  const SignedDistance distance(model);
  const std::size_t step = std::max<std::size_t>(1, mesh.vertices.size() / 60);
  for (std::size_t k = 0; k < mesh.vertices.size(); k += step) {
    const Enclosure enclosure = distance(mesh.vertices[k], tolerance / 4.0);
    EXPECT_GE(enclosure.lo, -tolerance) << k;
    EXPECT_LE(enclosure.hi, tolerance) << k;
  }
}

class OnePrimitive : public ::testing::TestWithParam<std::array<double, 2>> {};

TEST_P(OnePrimitive, HasAClosedSurface) {
  const Superquadric superquadric{{1.5, 0.7, 2.0}, GetParam()};
  const Model model = model_of(superquadric);
  const Mesh mesh = report::model_surface(model);
  expect_closed(mesh);
  EXPECT_EQ(euler_characteristic(mesh), 2);
  EXPECT_NEAR(volume(mesh) / exact_volume(superquadric), 1.0, 0.02);
  expect_on_surface(mesh, model, 1e-9);
}

TEST_P(OnePrimitive, HasAClosedSurfaceBent) {
  const Superquadric superquadric{{0.5, 0.7, 2.0}, GetParam()};
  const Model model = model_of(superquadric, Bend{0.4, 30.0});
  const Mesh mesh = report::model_surface(model);
  expect_closed(mesh);
  EXPECT_EQ(euler_characteristic(mesh), 2);
  // The bend stretches one side as much as it squeezes the other.
  EXPECT_NEAR(volume(mesh) / exact_volume(superquadric), 1.0, 0.02);
  expect_on_surface(mesh, model, 1e-9);
}

TEST_P(OnePrimitive, HasAClosedSurfaceTapered) {
  for (const double taper : {0.02, 0.4, 1.5, 10.0, 100.0}) {
    const Superquadric superquadric{{1.5, 0.7, 2.0}, GetParam(), taper};
    const Model model = model_of(superquadric);
    const Mesh mesh = report::model_surface(model);
    expect_closed(mesh);
    EXPECT_EQ(euler_characteristic(mesh), 2);
    EXPECT_NEAR(volume(mesh) / tapered_volume(superquadric), 1.0, 0.02) << taper;
    expect_on_surface(mesh, searched(model), 1e-9);
  }
}

TEST_P(OnePrimitive, HasAClosedSurfaceTaperedAndBent) {
  for (const double taper : {0.3, 4.0}) {
    const Superquadric superquadric{{0.5, 0.7, 2.0}, GetParam(), taper};
    const Model model = model_of(superquadric, Bend{0.4, 30.0});
    const Mesh mesh = report::model_surface(model);
    expect_closed(mesh);
    EXPECT_EQ(euler_characteristic(mesh), 2);
    EXPECT_NEAR(volume(mesh) / tapered_volume(superquadric), 1.0, 0.02) << taper;
    expect_on_surface(mesh, model, 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(ModelSurface, OnePrimitive,
                         ::testing::Values(std::array{1.0, 1.0}, std::array{0.1, 0.1}, std::array{1.5, 0.4},
                                           std::array{0.6, 1.9}, std::array{2.0, 2.0}));

constexpr Superquadric ball(double radius) {
  return {{radius, radius, radius}, {1.0, 1.0}};
}

SetExpression operation(SetOperation operation) {
  return {{{{}, SetOperation::unite, 0}, {{}, SetOperation::unite, 1}}, operation};
}

TEST(ModelSurface, TurnsWhatIsCutAwayInsideOut) {
  const Model shell{"", {{"outer", ball(1.0), {}}, {"inner", ball(0.5), {}}}, operation(SetOperation::subtract)};
  const Mesh mesh = report::model_surface(shell);
  expect_closed(mesh);
  EXPECT_EQ(euler_characteristic(mesh), 4);
  EXPECT_NEAR(volume(mesh), 4.0 / 3.0 * std::numbers::pi * (1.0 - 0.125), 0.05);
  expect_on_surface(mesh, shell, 1e-9);
}

TEST(ModelSurface, KeepsTheBoundaryOfTheWholeAlone) {
  for (const auto operator_ : {SetOperation::intersect, SetOperation::subtract, SetOperation::unite}) {
    const Model lens{"", {{"a", ball(1.0), {}}, {"b", ball(1.0), {{0.8, 0.0, 0.0}}}}, operation(operator_)};
    // As far beyond the cut as the smallest triangles are large.
    expect_on_surface(report::model_surface(lens), lens, 0.01);
  }
}

// The ball lies across the thin end of the one, and beside that of the other, which is bent away from it.
TEST(ModelSurface, CutsTaperedPrimitives) {
  const Superquadric shaft{{0.5, 0.4, 2.0}, {0.3, 1.0}, 4.0};
  for (const std::optional<Bend>& bend : {std::optional<Bend>{}, std::optional(Bend{0.4, 180.0})}) {
    for (const auto operator_ : {SetOperation::intersect, SetOperation::subtract, SetOperation::unite}) {
      const Model cut{"", {{"shaft", shaft, {}, bend}, {"ball", ball(0.5), {{0.3, 0.0, -1.6}}}}, operation(operator_)};
      const Mesh mesh = report::model_surface(cut);
      EXPECT_FALSE(mesh.triangles.empty());
      expect_on_surface(mesh, cut, 0.02);
    }
  }
}

TEST(ModelSurface, KeepsAHoleSmallerThanItsTriangles) {
  const Model drilled{"",
                      {{"plate", {{1.0, 1.0, 0.2}, {0.1, 0.1}}, {}}, {"drill", {{0.02, 0.02, 1.0}, {0.1, 1.0}}, {}}},
                      operation(SetOperation::subtract)};
  const Mesh mesh = report::model_surface(drilled);
  const auto in_hole = [](const Point& p) { return std::hypot(p[0], p[1]) < 0.021 && std::abs(p[2]) < 0.19; };
  EXPECT_GT(std::ranges::count_if(mesh.vertices, in_hole), 8);
}

TEST(ModelSurface, LeavesOutWhatAUnionHides) {
  const Model hidden{"", {{"outer", ball(1.0), {}}, {"inner", ball(0.5), {}}}};
  EXPECT_EQ(report::model_surface(hidden).triangles.size(),
            report::model_surface({"", {hidden.primitives[0]}}).triangles.size());
}

// ---------------------------------------------------------------- the page

TEST(Base64, IsThatOfRfc4648) {
  const auto encoded = [](std::string_view text) { return report::base64(std::as_bytes(std::span(text))); };
  EXPECT_EQ(encoded(""), "");
  EXPECT_EQ(encoded("f"), "Zg==");
  EXPECT_EQ(encoded("fo"), "Zm8=");
  EXPECT_EQ(encoded("foo"), "Zm9v");
  EXPECT_EQ(encoded("foob"), "Zm9vYg==");
  EXPECT_EQ(encoded("fooba"), "Zm9vYmE=");
  EXPECT_EQ(encoded("foobar"), "Zm9vYmFy");
  EXPECT_EQ(encoded("\xff\xfe\xfb"), "//77");
}

std::string decoded(const std::string& text) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text.substr(0, text.find('='))) {
    const std::size_t digit = digits.find(c);
    EXPECT_NE(digit, std::string_view::npos);
    bits = bits << 6U | static_cast<std::uint32_t>(digit);
    if ((count += 6) >= 8) bytes.push_back(static_cast<char>(bits >> (count -= 8)));
  }
  return bytes;
}

template <class Number>
std::vector<Number> numbers_in(const nlohmann::json& text) {
  const std::string bytes = decoded(text.get<std::string>());
  std::vector<Number> numbers(bytes.size() / sizeof(Number));
  std::memcpy(numbers.data(), bytes.data(), bytes.size());  // little-endian, as the machines of these tests
  return numbers;
}

/// The text of the page's data element.
std::string data_text(const std::string& page) {
  constexpr std::string_view opening = R"(<script type="application/json" id="verisq-report">)";
  const std::size_t begin = page.find(opening);
  EXPECT_NE(begin, std::string::npos);
  const std::size_t end = page.find("</script>", begin);
  return page.substr(begin + opening.size(), end - begin - opening.size());
}

const Mesh tetrahedron{{{0.1, 0.0, 3.0}, {1.0, 1.0 / 3.0, 4.0}, {0.0, 1.0, 4.0}, {-1.0, -1.0, 4.0}},
                       {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}};
const std::vector<MapResult> rows{{{-0.1, 1.0 / 3.0}, Status::device_verified},
                                  {{-infinity, infinity}, Status::wide},
                                  {{-0.0, 5e-324}, Status::host_verified},
                                  {{1e300, std::nextafter(1e300, infinity)}, Status::wide}};
const Model implant{"mm", {{"ball", ball(1.0), {}}}};

Report report_of(std::string title = "a title") {
  return {.title = std::move(title),
          .bone = tetrahedron,
          .rows = rows,
          .implant = implant,
          .units = "mm",
          .summary = {{"smallest distance", "[0.1, 0.2] mm"}, {"wide", "2"}},
          .area_names = {},
          .area_of = {}};
}

nlohmann::json written_data(const Report& report) {
  const TemporaryFolder folder;
  write_html_report(folder / "page.html", report);
  EXPECT_THAT(folder.names(), ElementsAre("page.html"));
  return nlohmann::json::parse(data_text(folder.contents("page.html")));
}

TEST(HtmlReport, HoldsEveryBitOfTheMap) {
  const nlohmann::json data = written_data(report_of());
  EXPECT_EQ(data.at("format"), "verisq-report/1");
  EXPECT_EQ(data.at("title"), "a title");
  EXPECT_EQ(data.at("units"), "mm");
  EXPECT_EQ(data.at("summary").dump(),
            R"([{"label":"smallest distance","value":"[0.1, 0.2] mm"},{"label":"wide","value":"2"}])");
  EXPECT_TRUE(data.at("areas").is_null());
  const auto lo = numbers_in<std::uint64_t>(data.at("lo"));
  const auto hi = numbers_in<std::uint64_t>(data.at("hi"));
  const auto status = numbers_in<std::uint8_t>(data.at("status"));
  ASSERT_EQ(lo.size(), rows.size());
  ASSERT_EQ(hi.size(), rows.size());
  ASSERT_EQ(status.size(), rows.size());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    EXPECT_EQ(lo[k], std::bit_cast<std::uint64_t>(rows[k].distance.lo));
    EXPECT_EQ(hi[k], std::bit_cast<std::uint64_t>(rows[k].distance.hi));
    EXPECT_EQ(status[k], static_cast<std::uint8_t>(rows[k].status));
  }
}

TEST(HtmlReport, HoldsBothSurfaces) {
  const nlohmann::json data = written_data(report_of());
  const auto centre = data.at("centre").get<Point>();
  EXPECT_THAT(centre, ElementsAre(0.0, 0.0, 3.5));
  const Mesh surface = report::model_surface(implant);
  for (const auto& [name, mesh] : {std::pair{"bone", &tetrahedron}, {"implant", &surface}}) {
    const auto positions = numbers_in<float>(data.at(name).at("positions"));
    const auto triangles = numbers_in<std::uint32_t>(data.at(name).at("triangles"));
    ASSERT_EQ(positions.size(), 3 * mesh->vertices.size());
    ASSERT_EQ(triangles.size(), 3 * mesh->triangles.size());
    for (std::size_t k = 0; k < positions.size(); ++k) {
      EXPECT_EQ(positions[k], static_cast<float>(mesh->vertices[k / 3][k % 3] - centre[k % 3]));
    }
    for (std::size_t k = 0; k < triangles.size(); ++k) EXPECT_EQ(triangles[k], mesh->triangles[k / 3][k % 3]);
  }
}

TEST(HtmlReport, HoldsAreas) {
  const std::vector<std::uint32_t> area_of{0, 1, 1, 70000};
  Report report = report_of();
  report.area_names = {"neck", "shaft"};
  report.area_of = area_of;
  const nlohmann::json data = written_data(report);
  EXPECT_EQ(data.at("areas").at("names").dump(), R"(["neck","shaft"])");
  EXPECT_EQ(numbers_in<std::uint32_t>(data.at("areas").at("of")), area_of);
}

TEST(HtmlReport, HoldsTheRangeOfTheColours) {
  Report report = report_of();
  EXPECT_EQ(written_data(report).at("range"), default_range(report.rows, report.units));
  report.range = 12.5;
  EXPECT_EQ(written_data(report).at("range"), 12.5);
}

TEST(HtmlReport, HoldsWhatIsOnTop) {
  Report report = report_of();
  const std::vector<double> by_itself = written_data(report).at("up");
  EXPECT_NEAR(std::hypot(by_itself[0], by_itself[1], by_itself[2]), 1.0, 1e-12);
  report.up = Point{0.0, -3e200, 4e200};
  EXPECT_THAT(written_data(report).at("up").get<std::vector<double>>(),
              ElementsAre(0.0, DoubleNear(-0.6, 1e-15), DoubleNear(0.8, 1e-15)));
}

TEST(HtmlReport, TextsStayTexts) {
  const std::string title =
      "</script><script>alert(1)</script> <!-- <script> & ]]> \xe2\x80\xa8\xe2\x80\xa9 \xc3\xa4 \"quoted\" \\ \x01";
  const TemporaryFolder folder;
  Report report = report_of(title);
  report.units = "</SCRIPT >";
  report.summary = {{"<b>", "&amp;"}};
  write_html_report(folder / "page.html", report);
  const std::string page = folder.contents("page.html");
  const std::string text = data_text(page);
  EXPECT_EQ(text.find_first_of("<>&"), std::string::npos);
  EXPECT_TRUE(std::ranges::all_of(text, [](char c) { return c >= 0x20 && c < 0x7f; }));
  const auto data = nlohmann::json::parse(text);
  EXPECT_EQ(data.at("title"), title);
  EXPECT_EQ(data.at("units"), "</SCRIPT >");
  EXPECT_EQ(data.at("summary").at(0).at("value"), "&amp;");
}

TEST(HtmlReport, ReplacesWhatIsNotUtf8) {
  EXPECT_EQ(written_data(report_of("a\xff"
                                   "b"))
                .at("title"),
            "a\xef\xbf\xbd"
            "b");
}

TEST(HtmlReport, HoldsEveryBitOfTheCertificates) {
  const TemporaryFolder folder;
  const auto model = folder.file("ball.json", "{ \"format\": \"\u00b5\" }\n");
  const auto mesh = folder.file("mesh.off", "abc");
  std::vector<Certificate> certificates{
      {{{0, {0.1, -0.0, 5e-324}}, {3, {1e300, 2.0, 1.0 / 3.0}}}, Point{1.0, 2.0, 0.1}},
      {},
      {{{1, {1.0, 0.0, 0.0}}}, std::nullopt},
      {{}, Point{-1.0, 0.0, 7.0}, {}, Point{0.1, -2.0, 5.0}, {true, false, true, false, false}}};
  certificates[1].cover = {true, true, false, false, true, false, false};
  Report report = report_of();
  report.proof = ReportProof{.certificates = certificates, .model_file = model, .mesh_file = mesh};
  const nlohmann::json proof = written_data(report).at("proof");
  EXPECT_EQ(proof.at("model"), "{ \"format\": \"\u00b5\" }\n");
  EXPECT_EQ(proof.at("model_name"), "ball.json");
  EXPECT_EQ(proof.at("mesh_name"), "mesh.off");
  EXPECT_EQ(proof.at("mesh_sha256"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_TRUE(proof.at("poses").is_null());
  EXPECT_THAT(numbers_in<double>(proof.at("vertices")),
              ElementsAre(0.1, 0.0, 3.0, 1.0, 1.0 / 3.0, 4.0, 0.0, 1.0, 4.0, -1.0, -1.0, 4.0));
  const nlohmann::json& columns = proof.at("certificates");
  EXPECT_THAT(numbers_in<std::uint32_t>(columns.at("normals_end")), ElementsAre(2, 2, 3, 3));
  EXPECT_THAT(numbers_in<std::uint32_t>(columns.at("primitives")), ElementsAre(0, 3, 1));
  EXPECT_THAT(numbers_in<double>(columns.at("normals")),
              ElementsAre(0.1, 0.0, 5e-324, 1e300, 2.0, 1.0 / 3.0, 1.0, 0.0, 0.0));
  EXPECT_THAT(numbers_in<std::uint32_t>(columns.at("escaping")), ElementsAre(0, 3));
  EXPECT_THAT(numbers_in<double>(columns.at("escapes")), ElementsAre(1.0, 2.0, 0.1, -1.0, 0.0, 7.0));
  EXPECT_THAT(numbers_in<std::uint32_t>(columns.at("witnessing")), ElementsAre(3));
  EXPECT_THAT(numbers_in<double>(columns.at("witnesses")), ElementsAre(0.1, -2.0, 5.0));
  EXPECT_THAT(numbers_in<std::uint32_t>(columns.at("covers_end")), ElementsAre(0, 7, 7, 12));
  EXPECT_THAT(numbers_in<std::uint8_t>(columns.at("covers")), ElementsAre(0b11001001, 0b01000000));

  report.proof->moved = true;
  EXPECT_THAT(numbers_in<double>(written_data(report).at("proof").at("poses")), ElementsAre(0, 0, 0, 1, 0, 0, 0));
  report.proof->model_file = folder / "missing.json";
  expect_error([&] { write_html_report(folder / "page.html", report); }, ErrorKind::input,
               (folder / "missing.json").string(), ": no such file");
}

TEST(HtmlReport, HasItsCheckerWithCertificatesAlone) {
  const TemporaryFolder folder;
  const auto file = folder.file("model.json", "{}");
  Report report = report_of();
  write_html_report(folder / "without.html", report);
  EXPECT_TRUE(nlohmann::json::parse(data_text(folder.contents("without.html"))).at("proof").is_null());
  EXPECT_THAT(folder.contents("without.html"), Not(HasSubstr("<script id=\"verisq-prover\"")));
  const std::vector<Certificate> certificates(rows.size());
  report.proof = ReportProof{.certificates = certificates, .model_file = file, .mesh_file = file};
  write_html_report(folder / "with.html", report);
  EXPECT_THAT(folder.contents("with.html"), HasSubstr("<script id=\"verisq-prover\""));
  EXPECT_THAT(folder.contents("with.html"), HasSubstr("GNU LESSER GENERAL PUBLIC LICENSE"));
}

TEST(HtmlReport, ThePlaceOfTheDataIsFilled) {
  const TemporaryFolder folder;
  write_html_report(folder / "page.html", report_of());
  EXPECT_THAT(folder.contents("page.html"), Not(HasSubstr("verisq-report-data")));
}

TEST(HtmlReport, FailsWhereItCannotBeWritten) {
  const TemporaryFolder folder;
  const auto path = folder / "no/such/page.html";
  expect_error([&] { write_html_report(path, report_of()); }, ErrorKind::failure, path.string(),
               ": cannot be written: No such file or directory");
}

// ---------------------------------------------------------------- the picture

TEST(ColourScale, IsWarmWithinAndColdOutside) {
  const report::ColourScale scale(2.0);
  EXPECT_GT(scale.colour(-1e-12)[0], scale.colour(-1e-12)[2] + 0.3);
  EXPECT_GT(scale.colour(-2.0)[0], scale.colour(-2.0)[2] + 0.2);
  EXPECT_GT(scale.colour(1.0)[2], scale.colour(1.0)[0] + 0.3);
  EXPECT_EQ(scale.colour(2.0), scale.colour(1e300));
  EXPECT_EQ(scale.colour(-2.0), scale.colour(-1e300));
  EXPECT_THAT(scale.ticks(), ElementsAre(-2.0, -1.5, -1.0, -0.5, 0.0, 0.5, 1.0, 1.5, 2.0));
}

/// The colours of a list in report/src/colours.js.
std::vector<std::string> page_colours(const std::string& name) {
  std::ifstream file(VERISQ_PAGE_COLOURS);
  const std::string source{std::istreambuf_iterator<char>(file), {}};
  const std::string opening = "const " + name + " = [";
  const std::size_t begin = source.find(opening);
  EXPECT_NE(begin, std::string::npos) << name;
  const std::string list = source.substr(begin, source.find(']', begin) - begin);
  const std::regex colour("#[0-9a-f]{6}");
  std::vector<std::string> colours;
  for (std::sregex_iterator match(list.begin(), list.end(), colour); match != std::sregex_iterator(); ++match) {
    colours.push_back(match->str());
  }
  return colours;
}

std::string hexadecimal(const report::Colour& colour) {
  const auto channel = [&](int k) { return std::lround(255.0 * colour[k]); };
  return fmt::format("#{:02x}{:02x}{:02x}", channel(0), channel(1), channel(2));
}

TEST(ColourScale, IsThatOfThePage) {
  const std::vector<std::string> outside = page_colours("outside");
  const std::vector<std::string> inside = page_colours("inside");
  ASSERT_GT(outside.size(), 1U);
  ASSERT_EQ(inside.size(), outside.size());
  const report::ColourScale scale(static_cast<double>(outside.size() - 1));  // one stop a unit
  for (std::size_t k = 0; k < outside.size(); ++k) {
    const double distance = k == 0 ? 1e-12 : static_cast<double>(k);
    EXPECT_EQ(hexadecimal(scale.colour(distance)), outside[k]) << k;
    EXPECT_EQ(hexadecimal(scale.colour(-distance)), inside[k]) << k;
  }
  std::ifstream file(VERISQ_PAGE_COLOURS);
  const std::string source{std::istreambuf_iterator<char>(file), {}};
  EXPECT_THAT(source, HasSubstr("unboundedColour = \"" + hexadecimal(scale.colour(-infinity)) + "\""));
}

TEST(ColourScale, ShowsMostOfTheMap) {
  std::vector<MapResult> map;
  map.reserve(1000);
  for (int k = 0; k < 1000; ++k) map.push_back({{k == 0 ? -infinity : 0.00731 * k, infinity}, Status::wide});
  map.back().distance.lo = 1e300;
  EXPECT_NEAR(default_range(map, ""), 8.0, 1e-12);  // 98 % are below 7.2, in steps of 1
  EXPECT_EQ(default_range({}, "mm"), 1.0);
  const std::vector<MapResult> zeros(3, {{0.0, 0.0}, Status::wide});
  EXPECT_EQ(default_range(zeros, ""), 1.0);
}

TEST(ColourScale, ShowsThreeMillimetresWhereEnoughIsNearer) {
  std::vector<MapResult> map(10, {{50.0, 50.0}, Status::wide});
  EXPECT_NEAR(default_range(map, "mm"), 50.0, 1e-12);
  map.front().distance.lo = -2.0;
  EXPECT_EQ(default_range(map, "mm"), 3.0);
  EXPECT_NEAR(default_range(map, "inch"), 50.0, 1e-12);
  EXPECT_NEAR(default_range(map, "m"), 50.0, 1e-12);
}

struct Picture {
  std::shared_ptr<cairo_surface_t> surface;

  explicit Picture(const std::filesystem::path& path)
      : surface(cairo_image_surface_create_from_png(path.c_str()), cairo_surface_destroy) {
    EXPECT_EQ(cairo_surface_status(surface.get()), CAIRO_STATUS_SUCCESS);
  }
  [[nodiscard]] int width() const { return cairo_image_surface_get_width(surface.get()); }
  [[nodiscard]] int height() const { return cairo_image_surface_get_height(surface.get()); }
  /// Red, green, blue in [0, 255].
  [[nodiscard]] std::array<int, 3> at(int x, int y) const {
    std::uint32_t rgb = 0;
    const std::ptrdiff_t row_size = cairo_image_surface_get_stride(surface.get());
    const std::ptrdiff_t offset = y * row_size + std::ptrdiff_t{4} * x;
    std::memcpy(&rgb, cairo_image_surface_get_data(surface.get()) + offset, sizeof rgb);
    return {static_cast<int>(rgb >> 16U & 0xffU), static_cast<int>(rgb >> 8U & 0xffU), static_cast<int>(rgb & 0xffU)};
  }
  [[nodiscard]] int warmth(int x, int y) const { return at(x, y)[0] - at(x, y)[2]; }
};

/// The surface of the box [-1, 1] x [-0.6, 0.6] x [-3, 3] in small squares: each face has vertices of its own.
Mesh box() {
  Mesh mesh;
  constexpr int steps = 12;
  const Point half{1.0, 0.6, 3.0};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
      for (int k = 0; k < (steps + 1) * (steps + 1); ++k) {
        const int row = k / (steps + 1);
        const int column = k % (steps + 1);
        Point p{};
        p[axis] = side * half[axis];
        p[(axis + 1) % 3] = side * half[(axis + 1) % 3] * (2.0 * column / steps - 1.0);
        p[(axis + 2) % 3] = half[(axis + 2) % 3] * (2.0 * row / steps - 1.0);
        mesh.vertices.push_back(p);
      }
      for (std::uint32_t row = 0; row < steps; ++row) {
        for (std::uint32_t column = 0; column < steps; ++column) {
          const std::uint32_t k = first + row * (steps + 1) + column;
          mesh.triangles.push_back({k, k + 1, k + steps + 2});
          mesh.triangles.push_back({k, k + steps + 2, k + steps + 1});
        }
      }
    }
  }
  return mesh;
}

/// A long box with a ball in its upper part: warm above z = 0, cold below.
class PictureOfABox : public ::testing::Test {
 protected:
  PictureOfABox() {
    for (const Point& p : bone_.vertices) map_.push_back({{-p[2], 5.0}, Status::host_verified});
  }
  [[nodiscard]] Report report(std::string title) const {
    return {.title = std::move(title),
            .bone = bone_,
            .rows = map_,
            .implant = ball_,
            .units = "mm",
            .summary = {{"label", "value"}},
            .area_names = {},
            .area_of = {}};
  }
  [[nodiscard]] Picture drawn(std::string title, int width, int height) const {
    write_picture(folder_ / "box.png", report(std::move(title)), width, height);
    return Picture(folder_ / "box.png");
  }

  Mesh bone_ = box();
  std::vector<MapResult> map_;
  Model ball_{"mm", {{"ball", ball(0.4), {{0.0, 0.0, 2.0}}}}};
  TemporaryFolder folder_;
};

TEST_F(PictureOfABox, IsWarmWithinAndColdOutside) {
  const Picture picture = drawn("box", 1600, 1000);
  ASSERT_EQ(picture.width(), 1600);
  ASSERT_EQ(picture.height(), 1000);
  // The panels' middles; the box is upright, from about y = 94 to 936, 141 pixels for a unit.
  for (const int middle : {310, 894}) {
    EXPECT_GT(picture.warmth(middle - 90, 130), 40);
    EXPECT_GT(picture.warmth(middle + 90, 400), 40);
    EXPECT_LT(picture.warmth(middle - 90, 620), -40);
    EXPECT_LT(picture.warmth(middle + 90, 900), -40);
    // To the edge of the bone, and not beyond.
    EXPECT_GT(picture.warmth(middle - 138, 130), 40);
    EXPECT_THAT(picture.at(middle - 144, 130), ElementsAre(255, 255, 255));
    EXPECT_THAT(picture.at(middle, 942), ElementsAre(255, 255, 255));
  }
}

TEST_F(PictureOfABox, ShowsTheImplant) {
  const Picture picture = drawn("box", 1600, 1000);
  const int ball_y = 515 - 281;
  // Cut open it is metal, in front of a warm wall; through the bone its outline is darker than its surroundings.
  EXPECT_LT(std::abs(picture.warmth(894, ball_y)), 20);
  EXPECT_GT(picture.at(894, ball_y)[2], 150);
  EXPECT_GT(picture.warmth(310, ball_y), 40);
  EXPECT_LT(picture.at(310 - 55, ball_y)[0], picture.at(310 - 62, ball_y)[0] - 30);
}

TEST_F(PictureOfABox, HasWords) {
  const Picture picture = drawn("box", 1600, 1000);
  const Picture untitled = drawn("", 1600, 1000);
  int dark = 0;
  for (int y = 30; y < 70; ++y) {
    for (int x = 30; x < 120; ++x) {
      dark += picture.at(x, y)[0] < 100 ? 1 : 0;
      EXPECT_EQ(untitled.at(x, y)[0], 255);
    }
  }
  EXPECT_GT(dark, 100);
}

TEST_F(PictureOfABox, IsDrawnInEverySize) {
  for (const auto& [width, height] : {std::pair{64, 64}, {64, 700}, {901, 77}, {333, 500}}) {
    const Picture picture = drawn("\xff not UTF-8\n" + std::string(1000000, 'w'), width, height);
    EXPECT_EQ(picture.width(), width);
    EXPECT_EQ(picture.height(), height);
  }
}

TEST_F(PictureOfABox, IsDrawnWithoutBounds) {
  for (MapResult& row : map_) row.distance.lo = -infinity;
  const Picture picture = drawn("box", 1600, 1000);
  EXPECT_LT(std::abs(picture.warmth(310 - 90, 130)), 20);
  EXPECT_LT(picture.at(310 - 90, 130)[1], 200);
}

TEST_F(PictureOfABox, IsDrawnWhateverItsTexts) {
  for (const std::string text : {"", "\xff\xfe", "\xc3", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\n\t\r\x7f"}) {
    Report report = this->report(text);
    report.units = text;
    report.summary = {{text, text}, {text, fmt::format("{0} {0}", text)}};
    write_picture(folder_ / "text.png", report);
    EXPECT_GT(Picture(folder_ / "text.png").warmth(310 - 90, 130), 40);
  }
}

TEST_F(PictureOfABox, IsDrawnWithTheImplantAnywhere) {
  for (const double place : {1e3, 1e9, 1e300, -std::numeric_limits<double>::max()}) {
    ball_.primitives[0].pose.translation = {0.0, place, 0.0};
    EXPECT_EQ(drawn("far", 400, 250).width(), 400) << place;
  }
}

// Its own ends overflow.
TEST_F(PictureOfABox, IsDrawnWithAnImplantOfAnySize) {
  for (const double radius : {1e-320, 1e150, std::numeric_limits<double>::max()}) {
    ball_ = {"mm", {{"ball", ball(radius), {{radius, radius, radius}}}}};
    EXPECT_EQ(drawn("large", 400, 250).width(), 400) << radius;
    write_html_report(folder_ / "large.html", report("large"));
  }
}

TEST(Picture, IsDrawnOfOneTriangle) {
  const TemporaryFolder folder;
  const Model model{"mm", {{"ball", ball(0.1), {}}}};
  const Point flat{1.0, 2.0, 3.0};
  for (const Point& third : {Point{0.0, 1.0, 0.0}, Point{2.0, 0.0, 0.0}, Point{0.0, 0.0, 0.0}, flat}) {
    const Point first = third == flat ? flat : Point{0.0, 0.0, 0.0};
    const Point second = third == flat ? flat : Point{1.0, 0.0, 0.0};
    const Mesh bone{{first, second, third}, {{0, 1, 2}}};
    const std::vector<MapResult> unbounded(3, {{-infinity, infinity}, Status::wide});
    const Report report{.title = "triangle",
                        .bone = bone,
                        .rows = unbounded,
                        .implant = model,
                        .units = "",
                        .summary = {},
                        .area_names = {},
                        .area_of = {}};
    write_picture(folder / "triangle.png", report);
    EXPECT_EQ(Picture(folder / "triangle.png").width(), 1600);
    write_html_report(folder / "triangle.html", report);
  }
}

TEST_F(PictureOfABox, IsDrawnInHugeAndTinyUnits) {
  for (const double scale : {1e300, 1e-300}) {
    Mesh scaled = bone_;
    for (Point& p : scaled.vertices) {
      for (double& x : p) x *= scale;
    }
    std::vector<MapResult> map = map_;
    for (MapResult& row : map) row.distance.lo *= scale;
    Model implant_scaled{"", {{"ball", ball(0.4 * scale), {{0.0, 0.0, 2.0 * scale}}}}};
    Report scaled_report{.title = "",
                         .bone = scaled,
                         .rows = map,
                         .implant = implant_scaled,
                         .units = "",
                         .summary = {},
                         .area_names = {},
                         .area_of = {}};
    write_picture(folder_ / "scaled.png", scaled_report);
    const Picture picture(folder_ / "scaled.png");
    EXPECT_GT(picture.warmth(310 - 90, 130), 40);
    EXPECT_LT(picture.warmth(310 + 90, 900), -40);
    write_html_report(folder_ / "scaled.html", scaled_report);
  }
}

TEST_F(PictureOfABox, FailsWhereItCannotBeWritten) {
  const auto path = folder_ / "no/such/box.png";
  expect_error([&] { write_picture(path, report("box")); }, ErrorKind::failure, path.string(),
               ": cannot be written: No such file or directory");
}

// ---------------------------------------------------------------- verisq map --report --png

class MapReportTest : public ProgramTest {
 protected:
  [[nodiscard]] Outcome map(Arguments arguments) const {
    arguments.insert(arguments.begin(), {"map", "--device", "host", "--model", (places::example("capsule.json"))});
    return run(arguments);
  }

  const std::string mesh_ =
      write("mesh.off", "OFF\n4 4 0\n0 0 3\n1 0 4\n0 1 4\n-1 -1 4\n3 0 1 2\n3 0 2 3\n3 0 3 1\n3 1 3 2\n");
  const std::string html_ = path("map.html");
  const std::string png_ = path("map.png");
};

TEST_F(MapReportTest, ShowsTheNumbersOfTheMap) {
  const auto outcome = map({"--mesh", mesh_, "-o", path("map.csv"), "--report", html_, "--png", png_, "--json"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.err, "");
  const auto summary = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(summary.at("report"), html_);
  EXPECT_EQ(summary.at("png"), png_);
  const auto data = nlohmann::json::parse(data_text(contents(html_)));
  const auto lo = numbers_in<double>(data.at("lo"));
  const auto hi = numbers_in<double>(data.at("hi"));
  const auto csv = rows_of(path("map.csv"));
  ASSERT_EQ(csv.size(), 4U);
  ASSERT_EQ(lo.size(), 4U);
  ASSERT_EQ(hi.size(), 4U);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ((Enclosure{lo[k], hi[k]}), csv[k].distance);
  EXPECT_THAT(data.at("title").get<std::string>(), HasSubstr("mesh.off"));
  const auto& smallest = data.at("summary").at(0);
  EXPECT_EQ(smallest.at("label"), "smallest distance of the points");
  EXPECT_EQ(Picture(png_).width(), 1600);
}

TEST_F(MapReportTest, NeedsNoMapFile) {
  const auto outcome = map({"--mesh", mesh_, "--report", html_});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.out, HasSubstr("not kept"));
  EXPECT_THAT(outcome.out, HasSubstr(html_));
  EXPECT_THAT(folder_.names(), ::testing::UnorderedElementsAre("mesh.off", "map.html", "process.out", "process.err"));
}

TEST_F(MapReportTest, RefusesWhatCannotBeShown) {
  const auto points = write("points.csv", "0,0,3\n");
  expect_refused(map({"--points", points, "--report", html_}), {"--report", "--mesh"});
  expect_refused(map({"--points", points, "--png", png_}), {"--png", "--mesh"});
  expect_refused(map({"--mesh", mesh_, "--on", "triangles", "--png", png_}), {"--png", "--on triangles"});
  expect_refused(map({"--mesh", mesh_, "--report", path("map.htm")}), {"--report", "map.htm", ".html"});
  expect_refused(map({"--mesh", mesh_, "--png", path("map.jpg")}), {"--png", "map.jpg", ".png"});
  expect_refused(map({"--mesh", mesh_}), {"--output", "--report", "--png"});
  expect_refused(map({"--mesh", mesh_, "--png", png_, "--certificates"}), {"--certificates", "--output"});
  const auto cloud = write("cloud.off", "OFF\n1 0 0\n0 0 3\n");
  expect_refused(map({"--mesh", cloud, "--report", html_}), {"--report", "cloud.off", "triangles"});
  const auto model = write("model.html", contents(places::example("capsule.json")));
  expect_refused(run({"map", "--model", model, "--mesh", mesh_, "--report", model}), {"model.html", "overwrite"});
}

TEST_F(MapReportTest, FailsBeforeTheWorkWhereItCannotBeWritten) {
  const auto outcome = map({"--mesh", mesh_, "--report", path("no/such/map.html")});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("no/such/map.html: cannot be written"));
}

TEST_F(MapReportTest, DrawsWithoutFonts) {
  const auto empty = write("fonts.conf", "<?xml version=\"1.0\"?>\n<fontconfig></fontconfig>\n");
  setenv("FONTCONFIG_FILE", empty.c_str(), 1);
  const auto outcome = map({"--mesh", mesh_, "--png", png_});
  unsetenv("FONTCONFIG_FILE");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(Picture(png_).height(), 1000);
}

}  // namespace
}  // namespace verisq::testing
