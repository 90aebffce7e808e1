/// Areas of a cavity: boxes of the model file, labels of a mesh, and the message for everything refused.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <verisq/clearance.hpp>
#include <verisq/files.hpp>

#include "tests/fixtures/error_matchers.hpp"
#include "tests/fixtures/places.hpp"
#include "tests/fixtures/temporary_folder.hpp"

namespace verisq {
namespace {

using ::testing::ElementsAre;
using testing::expect_input_error;
using testing::TemporaryFolder;

std::string model_with(const std::string& areas) {
  return R"({"format": "verisq-model/1", "primitives": [{"name": "a", "superquadric":
      {"semi_axes": [1, [1, 2], 1], "exponents": [1, 1]}}], "areas": )" +
         areas + "}";
}

std::string area(const std::string& name, const std::string& weight, const std::string& box) {
  return R"({"name": ")" + name + R"(", "weight": )" + weight + R"(, "box": )" + box + "}";
}

/// As a JSON array.
std::string list(const std::string& elements) {
  return fmt::format("[{}]", elements);
}

std::string one(const std::string& name, const std::string& weight, const std::string& box) {
  return list(area(name, weight, box));
}

const std::string unit_box = "[[0, 0, 0], [1, 1, 1]]";

TEST(Areas, ReadsBoxes) {
  const auto boxes = parse_areas(
      model_with(list(area("proximal", "3", "[[-1, 2.5, 0], [1, 2.5, 1e300]]") + "," + area("distal", "0", unit_box))),
      "m.json");
  ASSERT_EQ(boxes.size(), 2U);
  EXPECT_EQ(boxes[0].area.name, "proximal");
  EXPECT_EQ(boxes[0].area.weight, 3.0);
  EXPECT_EQ(boxes[0].lower, (Point{-1.0, 2.5, 0.0}));
  EXPECT_EQ(boxes[0].upper, (Point{1.0, 2.5, 1e300}));
  EXPECT_EQ(boxes[1].area.name, "distal");
  EXPECT_EQ(boxes[1].area.weight, 0.0);
}

TEST(Areas, AreNoPartOfTheModel) {
  const std::string text = model_with(one("proximal", "3", unit_box));
  EXPECT_EQ(parse_uncertain_model(text, "m.json").primitives.size(), 1U);
  EXPECT_TRUE(parse_areas(model_with("[]"), "m.json").empty());
}

TEST(Areas, AreReadFromFiles) {
  const TemporaryFolder folder;
  const auto file = folder.file("m.json", model_with(one("proximal", "3", unit_box)));
  EXPECT_EQ(read_areas(file).size(), 1U);
  EXPECT_TRUE(read_areas(places::example("stem.json")).empty());
  expect_input_error([&] { (void)read_areas(folder / "none.json"); }, folder / "none.json", ": no such file");
}

struct Refusal {
  const char* name;
  std::string areas;
  std::string message;
};

void PrintTo(const Refusal& refusal, std::ostream* stream) {
  *stream << refusal.areas;
}

class AreaRefusal : public ::testing::TestWithParam<Refusal> {};

TEST_P(AreaRefusal, NamesKeyAndValueWhoeverReads) {
  const std::string text = model_with(GetParam().areas);
  expect_input_error([&] { (void)parse_areas(text, "m.json"); }, "m.json", ": areas" + GetParam().message);
  expect_input_error([&] { (void)parse_uncertain_model(text, "m.json"); }, "m.json", ": areas" + GetParam().message);
}

INSTANTIATE_TEST_SUITE_P(
    All, AreaRefusal,
    ::testing::Values(Refusal{"NotAnArray", "{}", " = {}: must be an array"},
                      Refusal{"NotAnObject", "[1]", "[0] = 1: must be an object"},
                      Refusal{"UnknownKey", R"([{"colour": 1}])", "[0].colour = 1: unknown key"},
                      Refusal{"NameMissing", R"([{"weight": 1, "box": []}])", "[0].name: missing"},
                      Refusal{"WeightMissing", R"([{"name": "a", "box": []}])", "[0].weight: missing"},
                      Refusal{"BoxMissing", R"([{"name": "a", "weight": 1}])", "[0].box: missing"},
                      Refusal{"NameEmpty", one("", "1", unit_box), "[0].name = \"\": must not be empty"},
                      Refusal{"NameReserved", one("elsewhere", "1", unit_box),
                              "[0].name = \"elsewhere\": is the name of what no area holds"},
                      Refusal{"NameTwice", list(area("a", "1", unit_box) + "," + area("a", "2", unit_box)),
                              "[1].name = \"a\": another area has this name"},
                      Refusal{"WeightNegative", one("a", "-0.5", unit_box), "[0].weight = -0.5: must not be negative"},
                      Refusal{"WeightOverflows", one("a", "1e999", unit_box),
                              "[0].weight = 1e999: not a finite number"},
                      Refusal{"WeightNotANumber", one("a", "[1, 2]", unit_box), "[0].weight = [1,2]: must be a number"},
                      Refusal{"OneCorner", one("a", "1", "[[0, 0, 0]]"),
                              "[0].box = [...]: must be an array of 2 corners, [[x0, y0, z0], [x1, y1, z1]]"},
                      Refusal{"TwoCoordinates", one("a", "1", "[[0, 0, 0], [1, 1]]"),
                              "[0].box[1] = [1,1]: must be an array of 3 numbers"},
                      Refusal{"CornerOverflows", one("a", "1", "[[0, -1e400, 0], [1, 1, 1]]"),
                              "[0].box[0][1] = -1e400: not a finite number"},
                      Refusal{"CornersReversed", one("a", "1", "[[0, 0, 1.5], [1, 1, 1]]"),
                              "[0].box[0][2] = 1.5: exceeds the upper corner's 1"}),
    [](const auto& refusal) { return std::string(refusal.param.name); });

std::vector<std::string> names(const Cavity& cavity) {
  std::vector<std::string> result;
  for (const Area& area : cavity.areas) result.push_back(area.name);
  return result;
}

TEST(Cavity, PutsEachPointIntoTheFirstBoxThatHoldsIt) {
  const std::vector<AreaBox> boxes{{{"a", 2.0}, {0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}},
                                   {{"b", 3.0}, {1.0, 0.0, 0.0}, {2.0, 1.0, 1.0}},
                                   {{"c", 4.0}, {5.0, 5.0, 5.0}, {5.0, 5.0, 5.0}}};
  // Inside a; on the face that a and b share; inside b; outside along one axis each; the only point of c.
  const std::vector<Point> points{{0.5, 0.5, 0.5}, {1.0, 1.0, 0.0},  {1.5, 0.5, 0.5}, {2.5, 0.5, 0.5},
                                  {0.5, 1.5, 0.5}, {0.5, 0.5, -1.0}, {5.0, 5.0, 5.0}};
  const Cavity result = cavity(points, boxes, 0.25);
  EXPECT_EQ(result.points, points);
  EXPECT_THAT(names(result), ElementsAre("a", "b", "c", "elsewhere"));
  EXPECT_THAT(result.area_of, ElementsAre(0, 0, 1, 3, 3, 3, 2));
  EXPECT_EQ(result.areas[1].weight, 3.0);
  EXPECT_EQ(result.areas[3].weight, 0.25);
}

TEST(Cavity, HasNoElsewhereWithoutPointsThere) {
  const std::vector<AreaBox> boxes{{{"a", 2.0}, {0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}},
                                   {{"empty", 2.0}, {9.0, 9.0, 9.0}, {9.0, 9.0, 9.0}}};
  EXPECT_THAT(names(cavity({{0.0, 1.0, 0.5}}, boxes)), ElementsAre("a", "empty"));
}

TEST(Cavity, WithoutBoxesIsOneArea) {
  const Cavity result = cavity({{0.0, 1.0, 0.5}, {7.0, 7.0, 7.0}}, {});
  EXPECT_THAT(names(result), ElementsAre("elsewhere"));
  EXPECT_EQ(result.areas[0].weight, 1.0);
  EXPECT_THAT(result.area_of, ElementsAre(0, 0));
}

struct Vertex {
  Point position;
  std::int16_t label;
};

const std::vector<Vertex> vertices{
    {{0.0, 0.0, 0.0}, 300}, {{1.0, 0.0, 0.0}, -2}, {{0.0, 1.0, 0.0}, 300}, {{0.0, 0.0, 1.0}, 10}};

std::string ply_header(const std::string& format, const std::string& label_property) {
  return "ply\nformat " + format + " 1.0\nelement vertex 4\nproperty double x\nproperty " + label_property +
         "\nproperty double y\nproperty double z\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n";
}

std::string ascii_ply(const std::string& label_property = "short region") {
  std::string text = ply_header("ascii", label_property);
  for (const auto& [position, label] : vertices) {
    text += std::to_string(position[0]) + " " + std::to_string(label) + " " + std::to_string(position[1]) + " " +
            std::to_string(position[2]) + "\n";
  }
  return text;
}

template <class Number>
std::string bytes(Number number, std::endian order) {
  const auto raw = std::bit_cast<std::array<char, sizeof(Number)>>(number);
  std::string text(raw.begin(), raw.end());
  if (order != std::endian::native) std::ranges::reverse(text);
  return text;
}

std::string binary_ply(std::endian order) {
  std::string text =
      ply_header(order == std::endian::little ? "binary_little_endian" : "binary_big_endian", "int16 region");
  for (const auto& [position, label] : vertices) {
    text += bytes(position[0], order) + bytes(label, order) + bytes(position[1], order) + bytes(position[2], order);
  }
  return text;
}

class LabelledCavity : public ::testing::TestWithParam<std::string> {};

TEST_P(LabelledCavity, HasAnAreaForEachValue) {
  const TemporaryFolder folder;
  const std::vector<Area> weights{{"300", 0.5}, {"-2", 4.0}};
  const Cavity result = read_labelled_cavity(folder.file("m.ply", GetParam()), "region", weights);
  EXPECT_THAT(names(result), ElementsAre("-2", "10", "300"));
  EXPECT_EQ(result.areas[0].weight, 4.0);
  EXPECT_EQ(result.areas[1].weight, 1.0);
  EXPECT_EQ(result.areas[2].weight, 0.5);
  EXPECT_THAT(result.area_of, ElementsAre(2, 0, 2, 1));
  ASSERT_EQ(result.points.size(), vertices.size());
  for (std::size_t k = 0; k < vertices.size(); ++k) EXPECT_EQ(result.points[k], vertices[k].position);
}

INSTANTIATE_TEST_SUITE_P(Encodings, LabelledCavity,
                         ::testing::Values(ascii_ply(), binary_ply(std::endian::little), binary_ply(std::endian::big)));

TEST(LabelledCavityFile, RefusesWhatIsNoLabel) {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& property, const std::string& rest, const std::string& ply = ascii_ply()) {
    const auto file = folder.file("m.ply", ply);
    expect_input_error([&] { (void)read_labelled_cavity(file, property, {}); }, file, rest);
  };
  refused("colour", ": element 'vertex' has no property 'colour'");
  refused("x", ": element 'vertex': property 'x' must be a single integer");
  refused("region", ": element 'vertex': property 'region' must be a single integer", ascii_ply("float region"));
  refused("region", ": element 'vertex': property 'region' must be a single integer",
          ascii_ply("list uchar int region"));
  std::string fraction = ascii_ply();
  fraction.replace(fraction.find("300"), 3, "3.5");
  refused("region", ": line 11: 'region' = '3.5': not an integer", fraction);
  const auto integers = folder.file("integers.ply",
                                    "ply\nformat ascii 1.0\nelement vertex 1\nproperty int x\nproperty int y\n"
                                    "property int z\nend_header\n1 2 3\n");
  expect_input_error([&] { (void)read_labelled_cavity(integers, "y", {}); }, integers,
                     ": property 'y' is a coordinate");
}

TEST(LabelledCavityFile, RefusesOtherFormatsAndUnknownValues) {
  const TemporaryFolder folder;
  const auto off = folder.file("m.off", "OFF\n1 0 0\n0 0 0\n");
  expect_input_error([&] { (void)read_labelled_cavity(off, "region", {}); }, off,
                     ": labels of vertices are read from .ply only");
  const auto ply = folder.file("m.ply", ascii_ply());
  const std::vector<Area> weights{{"10", 2.0}, {"11", 2.0}};
  expect_input_error([&] { (void)read_labelled_cavity(ply, "region", weights); }, ply,
                     ": property 'region': no vertex has the value '11', which has a weight");
}

}  // namespace
}  // namespace verisq
