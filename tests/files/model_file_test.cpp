/// The model format: what it accepts, and the message for everything it refuses.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <limits>
#include <random>
#include <string>
#include <tuple>
#include <verisq/error.hpp>
#include <verisq/features.hpp>
#include <verisq/files.hpp>
#include <verisq/mesh.hpp>

#include "tests/fixtures/error_matchers.hpp"
#include "tests/fixtures/places.hpp"
#include "tests/fixtures/sample_meshes.hpp"
#include "tests/fixtures/temporary_folder.hpp"
#include "verify/proof/uncertain_model.hpp"

namespace verisq {
namespace {

using testing::expect_input_error;
using testing::TemporaryFolder;

std::string model_of(const std::string& primitives, const std::string& rest = "") {
  return R"({"format": "verisq-model/1", "primitives": [)" + primitives + "]" + rest + "}";
}

std::string superquadric(const std::string& semi_axes, const std::string& exponents) {
  return R"({"name": "a", "superquadric": {"semi_axes": )" + semi_axes + R"(, "exponents": )" + exponents + "}}";
}

std::string posed(const std::string& pose) {
  return R"({"name": "a", "superquadric": {"semi_axes": [1, 2, 3], "exponents": [1, 1]}, "pose": )" + pose + "}";
}

std::string ball(const std::string& name) {
  return R"({"name": ")" + name + R"(", "superquadric": {"semi_axes": [1, 1, 1], "exponents": [1, 1]}})";
}

std::string stem_head_bore(const std::string& csg) {
  return model_of(ball("stem") + "," + ball("head") + "," + ball("bore"), R"(, "csg": )" + csg);
}

TEST(ModelFile, ReadsEveryField) {
  const Model model = parse_model(R"({
    "format": "verisq-model/1", "units": "mm",
    "primitives": [
      {"name": "stem", "superquadric": {"semi_axes": [6.0, 9.0, 60], "exponents": [0.4, 2]},
       "pose": {"translation": [0, 0.1, -40], "quaternion": [1, 0, 0, -2]}},
      {"name": "head", "superquadric": {"semi_axes": [1e-310, 1e300, 3], "exponents": [4e-324, 1]},
       "pose": {"translation": [1, 2, 3]}}]})",
                                  "m.json");
  EXPECT_EQ(model.units, "mm");
  ASSERT_EQ(model.primitives.size(), 2U);
  const Primitive& stem = model.primitives[0];
  EXPECT_EQ(stem.name, "stem");
  EXPECT_EQ(stem.superquadric.semi_axes, (std::array<double, 3>{6.0, 9.0, 60.0}));
  EXPECT_EQ(stem.superquadric.exponents, (std::array<double, 2>{0.4, 2.0}));
  EXPECT_EQ(stem.pose.translation, (Point{0.0, 0.1, -40.0}));
  EXPECT_EQ(stem.pose.quaternion, (std::array<double, 4>{1.0, 0.0, 0.0, -2.0}));
  const Primitive& head = model.primitives[1];
  EXPECT_EQ(head.superquadric.semi_axes, (std::array<double, 3>{1e-310, 1e300, 3.0}));
  EXPECT_EQ(head.superquadric.exponents[0], std::numeric_limits<double>::denorm_min());
  EXPECT_EQ(head.pose.translation, (Point{1.0, 2.0, 3.0}));
  EXPECT_EQ(head.pose.quaternion, (std::array<double, 4>{1.0, 0.0, 0.0, 0.0}));
}

TEST(ModelFile, PoseUnitsAndCsgAreOptional) {
  const Model model = parse_model(model_of(ball("a")), "m.json");
  EXPECT_EQ(model.units, "");
  ASSERT_EQ(model.primitives.size(), 1U);
  EXPECT_EQ(model.primitives[0].pose.translation, (Point{0.0, 0.0, 0.0}));
  EXPECT_EQ(model.primitives[0].pose.quaternion, (std::array<double, 4>{1.0, 0.0, 0.0, 0.0}));
}

TEST(ModelFile, ReadsDecimalsToTheNearestBinary64) {
  // Halfway between 1 and the next number, and just above it.
  const std::string axes = "[1.00000000000000011102230246251565404, 1.00000000000000011102230246251565405, 1]";
  const Model model = parse_model(model_of(superquadric(axes, "[1, 1]")), "m.json");
  EXPECT_EQ(model.primitives[0].superquadric.semi_axes[0], 1.0);
  EXPECT_EQ(model.primitives[0].superquadric.semi_axes[1], 1.0 + std::numeric_limits<double>::epsilon());
}

std::string bent(const std::string& semi_axes, const std::string& exponents, const std::string& bend) {
  return model_of(R"({"name": "a", "superquadric": {"semi_axes": )" + semi_axes + R"(, "exponents": )" + exponents +
                  R"(}, "bend": )" + bend + "}");
}

std::string tapered(const std::string& taper, const std::string& semi_axis = "1") {
  return model_of(R"({"name": "a", "superquadric": {"semi_axes": [1, 1, )" + semi_axis +
                  R"(], "exponents": [1, 1], "taper": )" + taper + "}}");
}

TEST(ModelFile, ReadsTapers) {
  EXPECT_EQ(parse_model(tapered("2.5"), "m.json").primitives[0].superquadric.taper, 2.5);
  EXPECT_EQ(parse_model(tapered("0.01"), "m.json").primitives[0].superquadric.taper, 0.01);
  EXPECT_EQ(parse_model(tapered("100"), "m.json").primitives[0].superquadric.taper, 100.0);
  EXPECT_EQ(parse_model(model_of(ball("a")), "m.json").primitives[0].superquadric.taper, 1.0);
  EXPECT_TRUE(is_union_of_convex(parse_model(tapered("0.5"), "m.json")));
}

TEST(ModelFile, ReadsBends) {
  const Model model =
      parse_model(bent("[6.0, 9.0, 60.0]", "[0.4, 0.9]", R"({"curvature": -0.002, "angle_deg": 70.5})"), "m.json");
  ASSERT_TRUE(model.primitives[0].bend);
  EXPECT_EQ(model.primitives[0].bend->curvature, -0.002);
  EXPECT_EQ(model.primitives[0].bend->angle_degrees, 70.5);
  EXPECT_FALSE(parse_model(model_of(ball("a")), "m.json").primitives[0].bend);
}

TEST(ModelFile, AcceptsEveryBendThatLeavesTheSolidWhole) {
  // Magnitudes just below 1/extent, where the extent is that towards the bend; just below pi/a3; none; the smallest.
  for (const auto& [semi_axes, exponents, bend] : {
           std::tuple{"[1, 1, 1]", "[1, 1]", R"({"curvature": 0.9999999999999999, "angle_deg": 0})"},
           std::tuple{"[1, 1, 1]", "[1, 1]", R"({"curvature": -0.9999999999999999, "angle_deg": 12.3})"},
           std::tuple{"[5, 2, 1]", "[1, 1]", R"({"curvature": 0.4999999999999999, "angle_deg": 90})"},
           std::tuple{"[5, 2, 1]", "[1, 1]", R"({"curvature": 0.4999999999999999, "angle_deg": -2430})"},
           std::tuple{"[2, 2, 1]", "[1, 2]", R"({"curvature": 0.70710678, "angle_deg": 45})"},
           std::tuple{"[1e-3, 1, 10]", "[1, 1]", R"({"curvature": 0.31415926535897, "angle_deg": 1e300})"},
           std::tuple{"[5, 2, 1]", "[1, 1]", R"({"curvature": 0, "angle_deg": 20})"},
           std::tuple{"[5, 2, 1]", "[1, 1]", R"({"curvature": 5e-324, "angle_deg": 20})"},
       }) {
    EXPECT_TRUE(parse_model(bent(semi_axes, exponents, bend), "m.json").primitives[0].bend) << bend;
  }
}

/// A tetrahedron.
std::string meshed(const std::string& vertices, const std::string& triangles, const std::string& more = "") {
  return model_of(R"({"name": "a", "mesh": {"vertices": )" + vertices + R"(, "triangles": )" + triangles + more + "}}");
}

constexpr const char* four_vertices = "[[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]";
constexpr const char* four_triangles = "[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]";

TEST(ModelFile, ReadsAMeshThatItHolds) {
  const Model model = parse_model(meshed(four_vertices, four_triangles, R"(, "scale": 0.5)"), "m.json");
  ASSERT_TRUE(model.primitives[0].mesh);
  EXPECT_EQ(model.primitives[0].mesh->vertices[3], (Point{0.0, 0.0, 0.5}));
  EXPECT_EQ(model.primitives[0].mesh->triangles[3], (std::array<std::uint32_t, 3>{1, 2, 3}));
  EXPECT_TRUE(has_mesh(model));
  EXPECT_FALSE(is_union_of_convex(model));
}

TEST(ModelFile, ReadsAMeshBesideIt) {
  const testing::TemporaryFolder folder;
  const Mesh mesh = testing::tetrahedron();
  write_mesh(folder.path() / "implant.ply", mesh);
  const auto write = [&](const std::string& text) { std::ofstream(folder.path() / "m.json") << text; };
  write(model_of(R"({"name": "a", "mesh": {"file": "implant.ply"}, "pose": {"translation": [1, 2, 3]}})"));
  const Model model = read_model(folder.path() / "m.json");
  EXPECT_EQ(model.primitives[0].mesh->vertices, mesh.vertices);
  EXPECT_EQ(model.primitives[0].pose.translation, (Point{1.0, 2.0, 3.0}));
  EXPECT_EQ(read_model(folder.path() / "implant.ply").primitives[0].name, "implant");
  write_model(folder.path() / "again.json", model);
  EXPECT_EQ(read_model(folder.path() / "again.json").primitives[0].mesh->vertices, mesh.vertices);
}

TEST(ModelFile, RefusesMeshesThatAreNoSolids) {
  const auto refusal = [](const std::string& text) -> std::string {
    try {
      static_cast<void>(parse_model(text, "m.json"));
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(refusal(meshed(four_vertices, "[[0, 2, 1], [0, 1, 3], [0, 3, 2]]")),
              ::testing::HasSubstr("3 of its edges are open"));
  EXPECT_THAT(refusal(meshed(four_vertices, "[]")), ::testing::HasSubstr("no triangles"));
  EXPECT_THAT(refusal(meshed(four_vertices, "[[0, 2, 4]]")),
              ::testing::HasSubstr("triangles[0][2] = 4: must be the index"));
  EXPECT_THAT(refusal(meshed(four_vertices, "[[0, 2, -1]]")), ::testing::HasSubstr("= -1: must be the index"));
  EXPECT_THAT(refusal(meshed(four_vertices, four_triangles, R"(, "scale": 0)")),
              ::testing::HasSubstr("scale = 0: must be"));
  EXPECT_THAT(refusal(meshed(four_vertices, four_triangles, R"(, "file": "a.stl")")),
              ::testing::HasSubstr("unknown key"));
  EXPECT_THAT(refusal(model_of(R"({"name": "a", "mesh": {"file": "none.stl"}})")), ::testing::HasSubstr("none.stl"));
  const std::string solid =
      R"({"vertices": )" + std::string(four_vertices) + R"(, "triangles": )" + four_triangles + "}";
  EXPECT_THAT(
      refusal(model_of(R"({"name": "a", "mesh": )" + solid + R"(, "bend": {"curvature": 0.1, "angle_deg": 0}})")),
      ::testing::HasSubstr("a mesh has no bend"));
}

TEST(ModelFile, ReadsTheBentStem) {
  const Model model = read_model(places::example("bent_stem.json"));
  EXPECT_TRUE(model.primitives[0].bend);
  EXPECT_FALSE(is_union_of_convex(model));
}

TEST(ModelFile, ReadsTheTaperedStems) {
  const Model straight = read_model(places::example("tapered_stem.json"));
  EXPECT_TRUE(is_union_of_convex(straight));
  const Superquadric& neck = straight.primitives[2].superquadric;
  EXPECT_NEAR(2.0 * neck.semi_axes[0] * 2.0 / (1.0 + neck.taper), 14.0, 0.01);
  EXPECT_NEAR(2.0 * neck.semi_axes[0] * 2.0 * neck.taper / (1.0 + neck.taper), 12.0, 0.01);

  const Model bent = read_model(places::example("bent_tapered_stem.json"));
  EXPECT_FALSE(is_union_of_convex(bent));
  ASSERT_EQ(bent.primitives.size(), straight.primitives.size());
  for (std::size_t k = 0; k < bent.primitives.size(); ++k) {
    EXPECT_EQ(is_bent(bent.primitives[k]), k == 0);
    EXPECT_EQ(bent.primitives[k].superquadric.semi_axes, straight.primitives[k].superquadric.semi_axes);
    EXPECT_EQ(bent.primitives[k].superquadric.taper, straight.primitives[k].superquadric.taper);
  }
}

std::string words(const SetExpression& expression, const Model& model) {
  if (expression.operands.empty()) return model.primitives.at(expression.primitive).name;
  std::string text = expression.operation == SetOperation::unite       ? "union("
                     : expression.operation == SetOperation::intersect ? "intersection("
                                                                       : "difference(";
  for (const SetExpression& operand : expression.operands) text += words(operand, model) + " ";
  text.back() = ')';
  return text;
}

TEST(ModelFile, ReadsSetOperations) {
  const auto read = [](const char* csg) {
    const Model model = parse_model(stem_head_bore(csg), "m.json");
    EXPECT_EQ(model.primitives.size(), 3U);
    EXPECT_TRUE(model.csg);
    return words(*model.csg, model);
  };
  EXPECT_EQ(read(R"({"union": ["stem", {"difference": ["head", "bore"]}]})"), "union(stem difference(head bore))");
  EXPECT_EQ(read(R"({"intersection": [{"union": ["bore", "head"]}, "stem"]})"), "intersection(union(bore head) stem)");
  EXPECT_EQ(read(R"({"difference": ["stem", "head", "bore"]})"), "difference(stem head bore)");
  EXPECT_EQ(read(R"({"difference": ["stem", "stem"]})"), "difference(stem stem)");
  EXPECT_EQ(read(R"({"union": ["bore"]})"), "union(bore)");
  EXPECT_EQ(read(R"({"intersection": [{"union": [{"union": ["bore"]}]}]})"), "intersection(union(union(bore)))");
  EXPECT_FALSE(parse_model(model_of(ball("a")), "m.json").csg);
}

TEST(ModelFile, TellsUnionsOfAllPrimitives) {
  const auto is_union = [](const char* csg) { return is_union_of_convex(parse_model(stem_head_bore(csg), "m.json")); };
  EXPECT_TRUE(is_union(R"({"union": ["stem", "head", "bore"]})"));
  EXPECT_TRUE(is_union(R"({"union": ["bore", {"union": ["head"]}, {"union": [{"union": ["stem", "head"]}]}]})"));
  EXPECT_FALSE(is_union(R"({"union": ["stem", {"union": ["bore"]}]})"));
  EXPECT_FALSE(is_union(R"({"union": ["stem", "head", {"intersection": ["bore"]}]})"));
}

/// "a" in `depth` operators, each the first operand of the one around it; unions by turns with differences.
std::string nested(std::size_t depth) {
  std::string opened;
  std::string closed;
  for (std::size_t k = 0; k < depth; ++k) {
    opened += k % 2 == 0 ? R"({"union": [)" : R"({"difference": [)";
    closed += R"(, "b"]})";
  }
  return model_of(ball("a") + "," + ball("b"), R"(, "csg": )" + opened + R"("a")" + closed);
}

std::size_t depth_of(const SetExpression& expression) {
  return expression.operands.empty() ? 0 : 1 + depth_of(expression.operands[0]);
}

TEST(ModelFile, ReadsAThousandNestedOperators) {
  const Model model = parse_model(nested(1000), "m.json");
  ASSERT_TRUE(model.csg);
  EXPECT_EQ(depth_of(*model.csg), 1000U);
  const Model copy = model;
  EXPECT_EQ(depth_of(*copy.csg), 1000U);
  const TemporaryFolder folder;
  write_model(folder / "m.json", model);
  EXPECT_EQ(depth_of(*read_model(folder / "m.json").csg), 1000U);
}

TEST(ModelFile, RefusesTenThousandNestedOperatorsInOneShortLine) {
  const std::string text = nested(10'000);
  try {
    (void)parse_model(text, "m.json");
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    EXPECT_THAT(error.what(), ::testing::MatchesRegex(
                                  "m\\.json: line 1, column [0-9]+: nested deeper than 2048 levels: give operators of "
                                  "one kind all their operands at once"));
  }
}

/// Some megabytes; of 60 MiB the tree took 2.1 GB.
TEST(ModelFile, RefusesValuesThatHoldNextToNothing) {
  for (const std::string value : {"{},", "[],", "{\"a\":0},"}) {
    std::string text = "[";
    for (int i = 0; i < 1'500'000; ++i) text += value;
    text.back() = ']';
    try {
      (void)parse_model(text, "m.json");
      ADD_FAILURE() << "no error";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      EXPECT_THAT(error.what(), ::testing::MatchesRegex(
                                    "m\\.json: \\[[0-9]+\\].*: too many values that hold next to nothing: those up "
                                    "to here would take [0-9]+ MiB of memory, and the file has [0-9]+ bytes"));
    }
  }
}

TEST(ModelFile, ReadsTenThousandPrimitives) {
  std::string primitives;
  std::string operands;
  for (int k = 0; k < 10'000; ++k) {
    const std::string separator = k == 0 ? "" : ",";
    const std::string name = fmt::format("p{}", k);
    primitives += separator + ball(name);
    operands += fmt::format("{}\"{}\"", separator, name);
  }
  const Model model = parse_model(model_of(primitives, R"(, "csg": {"union": [)" + operands + "]}"), "m.json");
  EXPECT_EQ(model.primitives.size(), 10'000U);
  EXPECT_EQ(model.csg->operands.size(), 10'000U);
}

/// What is wrong deep inside is told in a line that can be read.
TEST(ModelFile, ShortensLongPathsInMessages) {
  const std::string text = nested(1000);
  for (const auto& [from, to, end] :
       {std::tuple{R"(["a")", R"(["ghost")", R"([0].difference[0] = "ghost": no primitive has this name)"},
        std::tuple{R"("a",)", R"(1e999,)", "[0].difference[0] = 1e999: not a finite number"},
        std::tuple{R"("a", "b"])", R"({"union": [], "union": []}])", ".union: the key appears twice"}}) {
    std::string wrong = text;
    wrong.replace(wrong.rfind(from), std::string(from).size(), to);
    try {
      (void)parse_model(wrong, "m.json");
      ADD_FAILURE() << to;
    } catch (const Error& error) {
      const std::string message = error.what();
      EXPECT_THAT(message, ::testing::StartsWith("m.json: csg.union[0].difference[0]."));
      EXPECT_THAT(message, ::testing::EndsWith(end));
      EXPECT_LT(message.size(), 300U);
    }
  }
}

struct Refusal {
  const char* name;
  std::string json;
  std::string message;  // after "m.json"
};

void PrintTo(const Refusal& refusal, std::ostream* stream) {
  *stream << refusal.json;
}

std::string name_of(const ::testing::TestParamInfo<Refusal>& info) {
  return info.param.name;
}

class ModelRefusal : public ::testing::TestWithParam<Refusal> {};

TEST_P(ModelRefusal, NamesKeyAndValue) {
  expect_input_error([] { (void)parse_model(GetParam().json, "m.json"); }, "m.json", GetParam().message);
}

const std::string first = ": primitives[0].superquadric.";
const std::string curvature = ": primitives[0].bend.curvature";
const std::string too_strong = ": its magnitude times the solid's extent towards angle_deg, ";
const std::string to_be_below_1 = ", must be below 1";

const std::string out_of_range = ": the section at z = a3 over that at z = -a3 must be in [0.01, 100]";

INSTANTIATE_TEST_SUITE_P(Tapers, ModelRefusal,
                         ::testing::Values(Refusal{"TaperZero", tapered("0"), first + "taper = 0" + out_of_range},
                                           Refusal{"TaperNegative", tapered("-2"), first + "taper = -2" + out_of_range},
                                           Refusal{"TaperTooLarge", tapered("100.00000000000001"),
                                                   first + "taper = 100.00000000000001" + out_of_range},
                                           Refusal{"TaperInterval", tapered("[1, 2]"),
                                                   first + "taper = [1,2]: must be a number"}),
                         name_of);

INSTANTIATE_TEST_SUITE_P(
    Values, ModelRefusal,
    ::testing::Values(Refusal{"ExponentTooLarge", model_of(ball("b") + "," + superquadric("[1, 1, 1]", "[2.5, 1]")),
                              ": primitives[1].superquadric.exponents[0] = 2.5: must be in (0, 2]"},
                      Refusal{"ExponentJustTooLarge", model_of(superquadric("[1, 1, 1]", "[1, 2.0000000000000004]")),
                              first + "exponents[1] = 2.0000000000000004: must be in (0, 2]"},
                      Refusal{"ExponentZero", model_of(superquadric("[1, 1, 1]", "[0, 1]")),
                              first + "exponents[0] = 0: must be in (0, 2]"},
                      Refusal{"ExponentUnderflows", model_of(superquadric("[1, 1, 1]", "[1, 1e-400]")),
                              first + "exponents[1] = 0.0: must be in (0, 2]"},
                      Refusal{"SemiAxisNegative", model_of(superquadric("[1, -2.5, 1]", "[1, 1]")),
                              first + "semi_axes[1] = -2.5: must be positive"},
                      Refusal{"SemiAxisZero", model_of(superquadric("[1, 1, 0.0]", "[1, 1]")),
                              first + "semi_axes[2] = 0.0: must be positive"},
                      Refusal{"SemiAxisOverflows", model_of(superquadric("[1, 1e999, 1]", "[1, 1]")),
                              first + "semi_axes[1] = 1e999: not a finite number"},
                      Refusal{"TranslationOverflows",
                              model_of(ball("b") + "," + posed(R"({"translation": [0, 0, -1e400]})")),
                              ": primitives[1].pose.translation[2] = -1e400: not a finite number"},
                      Refusal{"ZeroQuaternion", model_of(posed(R"({"quaternion": [0, -0.0, 0, 0]})")),
                              ": primitives[0].pose.quaternion = [0,-0.0,0,0]: must not be zero"},
                      Refusal{"DuplicateName", model_of(ball("stem") + "," + ball("stem")),
                              ": primitives[1].name = \"stem\": another primitive has this name"},
                      Refusal{"NoPrimitives", model_of(""), ": primitives = []: must have at least one primitive"}),
    name_of);

INSTANTIATE_TEST_SUITE_P(
    Structure, ModelRefusal,
    ::testing::Values(
        Refusal{"OtherFormat", R"({"format": "verisq-model/2"})",
                ": format = \"verisq-model/2\": must be \"verisq-model/1\""},
        Refusal{"FormatMissing", R"({"primitives": []})", ": format: missing"},
        Refusal{"FormatNotText", R"({"format": 1})", ": format = 1: must be a string"},
        Refusal{"PrimitivesMissing", R"({"format": "verisq-model/1"})", ": primitives: missing"},
        Refusal{"PrimitivesNotAnArray", R"({"format": "verisq-model/1", "primitives": {"name": "a"}})",
                ": primitives = {...}: must be an array"},
        Refusal{"UnitsNotText", model_of(ball("a"), R"(, "units": null)"), ": units = null: must be a string"},
        Refusal{"NameMissing", model_of(R"({"superquadric": {}})"), ": primitives[0].name: missing"},
        Refusal{"NameNotText", model_of(R"({"name": ["a"], "superquadric": {}})"),
                ": primitives[0].name = [\"a\"]: must be a string"},
        Refusal{"SuperquadricMissing", model_of(R"({"name": "a"})"), ": primitives[0].superquadric: missing"},
        Refusal{"ExponentsMissing", model_of(R"({"name": "a", "superquadric": {"semi_axes": [1, 1, 1]}})"),
                first + "exponents: missing"},
        Refusal{"TwoSemiAxes", model_of(superquadric("[1, 2]", "[1, 1]")),
                first + "semi_axes = [1,2]: must be an array of 3 numbers"},
        Refusal{"SemiAxesNotAnArray", model_of(superquadric("5", "[1, 1]")), first + "semi_axes = 5: must be an array"},
        Refusal{"SemiAxisText", model_of(superquadric("[1, \"2\", 1]", "[1, 1]")),
                first + "semi_axes[1] = \"2\": must be a number"},
        Refusal{"SemiAxisNull", model_of(superquadric("[1, null, 1]", "[1, 1]")),
                first + "semi_axes[1] = null: must be a number"},
        Refusal{"PrimitiveNotAnObject", model_of("7"), ": primitives[0] = 7: must be an object"},
        Refusal{"PoseNotAnObject", model_of(posed("[]")), ": primitives[0].pose = []: must be an object"},
        Refusal{"DocumentNotAnObject", "[1, 2]", ": the document = [1,2]: must be an object"},
        Refusal{"UnknownKeyAtTheTop", model_of(ball("a"), R"(, "colour": "red")"), ": colour = \"red\": unknown key"},
        Refusal{"UnknownKeyInside", model_of(R"({"name": "a", "superquadric": {"axes": [1, 2, 3]}})"),
                first + "axes = [1,2,3]: unknown key"},
        Refusal{"UnknownKeyInPose", model_of(posed(R"({"rotation": {"w": 1}})")),
                ": primitives[0].pose.rotation = {...}: unknown key"},
        Refusal{"UnknownKeyOfOddCharacters", model_of(ball("a"), R"(, "a\nb": 1)"), ": \"a\\nb\" = 1: unknown key"},
        Refusal{"KeyTwice", model_of(R"({"name": "a", "superquadric": {"exponents": [1, 1], "exponents": [2, 2]}})"),
                first + "exponents: the key appears twice"},
        Refusal{"NestedTooDeep", "{\"[\\\"{\":\n" + std::string(100000, '['),
                ": line 2, column 2048: nested deeper than 2048 levels: give operators of one kind all their operands "
                "at once"}),
    name_of);

INSTANTIATE_TEST_SUITE_P(
    Bend, ModelRefusal,
    ::testing::Values(
        Refusal{"ReachesItsCentre", bent("[1, 1, 1]", "[1, 1]", R"({"curvature": 1, "angle_deg": 0})"),
                curvature + " = 1" + too_strong + "1" + to_be_below_1},
        Refusal{"ReachesItsCentreTheOtherWay", bent("[5, 2, 1]", "[1, 1]", R"({"curvature": -0.2, "angle_deg": 0})"),
                curvature + " = -0.2" + too_strong + "5" + to_be_below_1},
        Refusal{"ReachesItsCentreAcross", bent("[5, 2, 1]", "[1, 1]", R"({"curvature": 0.5, "angle_deg": 90})"),
                curvature + " = 0.5" + too_strong + "2" + to_be_below_1},
        Refusal{"ReachesItsCentreAlongADiagonal",
                bent("[2, 2, 1]", "[1, 2]", R"({"curvature": 0.7072, "angle_deg": 45})"),
                curvature + " = 0.7072" + too_strong + "1.41421" + to_be_below_1},
        Refusal{"EndsMeet", bent("[1, 1, 10]", "[1, 1]", R"({"curvature": -0.3141592653589794, "angle_deg": 0})"),
                curvature + " = -0.3141592653589794: its magnitude times a3, 10, must be below pi"},
        Refusal{"CurvatureMissing", bent("[1, 1, 1]", "[1, 1]", R"({"angle_deg": 0})"), curvature + ": missing"},
        Refusal{"AngleMissing", bent("[1, 1, 1]", "[1, 1]", R"({"curvature": 0})"),
                ": primitives[0].bend.angle_deg: missing"},
        Refusal{"AngleOverflows", bent("[1, 1, 1]", "[1, 1]", R"({"curvature": 0, "angle_deg": 1e999})"),
                ": primitives[0].bend.angle_deg = 1e999: not a finite number"},
        Refusal{"CurvatureInterval", bent("[1, 1, 1]", "[1, 1]", R"({"curvature": [0, 0.1], "angle_deg": 0})"),
                curvature + " = [0,0.1]: must be a number"},
        Refusal{"UnknownKey", bent("[1, 1, 1]", "[1, 1]", R"({"curvature": 0, "angle": 0})"),
                ": primitives[0].bend.angle = 0: unknown key"},
        Refusal{"NotAnObject", bent("[1, 1, 1]", "[1, 1]", "0.1"), ": primitives[0].bend = 0.1: must be an object"}),
    name_of);

INSTANTIATE_TEST_SUITE_P(
    OnlyExactNumbers, ModelRefusal,
    ::testing::Values(
        Refusal{"IntervalSemiAxis", model_of(superquadric("[1, [5.5, 6], 1]", "[1, 1]")),
                first + "semi_axes[1] = [5.5,6]: is an interval, where only an exact model is supported"},
        Refusal{"IntervalExponent", model_of(superquadric("[1, 1, 1]", "[[0.5, 0.6], 1]")),
                first + "exponents[0] = [0.5,0.6]: is an interval, where only an exact model is supported"},
        Refusal{"IntervalTranslation", model_of(posed(R"({"translation": [0, 0, [-1, 1]]})")),
                ": primitives[0].pose.translation[2] = [-1,1]: is an interval, where only an exact model is supported"},
        Refusal{"IntervalNotAllowed", model_of(posed(R"({"quaternion": [1, 0, 0, [0, 1]]})")),
                ": primitives[0].pose.quaternion[3] = [0,1]: must be a number"},
        Refusal{"NotAnInterval", model_of(superquadric("[1, [5, 6, 7], 1]", "[1, 1]")),
                first + "semi_axes[1] = [5,6,7]: must be a number"}),
    name_of);

TEST(UncertainModelFile, ReadsIntervalsAndNumbers) {
  const UncertainModel model = parse_uncertain_model(R"({
    "format": "verisq-model/1", "units": "mm",
    "primitives": [
      {"name": "stem", "superquadric": {"semi_axes": [[5.5, 6], 9, [60, 60]], "exponents": [[0.4, 0.5], 2]},
       "pose": {"translation": [0, [-1, 0.1], -40], "quaternion": [1, 0, 0, -2]}}],
    "csg": {"union": ["stem"]}})",
                                                     "m.json");
  EXPECT_EQ(model.units, "mm");
  ASSERT_EQ(model.primitives.size(), 1U);
  const UncertainPrimitive& stem = model.primitives[0];
  EXPECT_EQ(stem.name, "stem");
  EXPECT_EQ(stem.semi_axes, (std::array<Enclosure, 3>{{{5.5, 6}, {9, 9}, {60, 60}}}));
  EXPECT_EQ(stem.exponents, (std::array<Enclosure, 2>{{{0.4, 0.5}, {2, 2}}}));
  EXPECT_EQ(stem.translation, (std::array<Enclosure, 3>{{{0, 0}, {-1, 0.1}, {-40, -40}}}));
  EXPECT_EQ(stem.quaternion, (std::array<double, 4>{1, 0, 0, -2}));
}

TEST(UncertainModelFile, ReadsExactModels) {
  EXPECT_TRUE(is_exact(read_uncertain_model(places::example("stem.json"))));
  EXPECT_FALSE(is_exact(read_uncertain_model(places::example("uncertain_stem.json"))));
}

TEST(UncertainModelFile, KeepsBendsAndSetOperationsOfExactModels) {
  const auto exact = [](const std::string& text) {
    return verify::bracket_of_primitives(parse_uncertain_model(text, "m.json")).largest;
  };
  const Model stem = exact(bent("[1, 1, 1]", "[1, 1]", R"({"curvature": 0.5, "angle_deg": 20})"));
  ASSERT_TRUE(stem.primitives[0].bend);
  EXPECT_EQ(stem.primitives[0].bend->curvature, 0.5);
  const Model difference = exact(stem_head_bore(R"({"difference": ["stem", "head"]})"));
  ASSERT_TRUE(difference.csg);
  EXPECT_EQ(words(*difference.csg, difference), "difference(stem head)");
}

TEST(UncertainModelFile, AllowsIntervalsInUnionsOfAllPrimitives) {
  const std::string primitives = ball("a") + R"(, {"name": "b", "superquadric": {"semi_axes": [1, [1, 2], 1],
      "exponents": [1, 1]}, "bend": {"curvature": 0, "angle_deg": 20}})";
  EXPECT_FALSE(is_exact(parse_uncertain_model(model_of(primitives, R"(, "csg": {"union": ["b", "a"]})"), "m.json")));
}

class UncertainModelRefusal : public ::testing::TestWithParam<Refusal> {};

TEST_P(UncertainModelRefusal, NamesKeyAndValue) {
  expect_input_error([] { (void)parse_uncertain_model(GetParam().json, "m.json"); }, "m.json", GetParam().message);
}

INSTANTIATE_TEST_SUITE_P(
    Values, UncertainModelRefusal,
    ::testing::Values(Refusal{"LowerEndAboveTheUpper", model_of(superquadric("[1, [6, 5.5], 1]", "[1, 1]")),
                              first + "semi_axes[1] = [6,5.5]: the lower end of the interval exceeds the upper"},
                      Refusal{"SemiAxisReachesZero", model_of(superquadric("[1, 1, [0, 1]]", "[1, 1]")),
                              first + "semi_axes[2] = [0,1]: must be positive"},
                      Refusal{"ExponentReachesZero", model_of(superquadric("[1, 1, 1]", "[[0.0, 1], 1]")),
                              first + "exponents[0] = [0.0,1]: must be in (0, 2]"},
                      Refusal{"ExponentTooLarge", model_of(superquadric("[1, 1, 1]", "[1, [1, 2.5]]")),
                              first + "exponents[1] = [1,2.5]: must be in (0, 2]"},
                      Refusal{"EndOverflows", model_of(superquadric("[1, [1, 1e999], 1]", "[1, 1]")),
                              first + "semi_axes[1][1] = 1e999: not a finite number"},
                      Refusal{"ThreeNumbers", model_of(superquadric("[1, [5, 6, 7], 1]", "[1, 1]")),
                              first + "semi_axes[1] = [5,6,7]: must be a number or an interval [lo, hi]"},
                      Refusal{
                          "EndIsText", model_of(posed(R"({"translation": [0, ["a", 1], 0]})")),
                          ": primitives[0].pose.translation[1] = [\"a\",1]: must be a number or an interval [lo, hi]"},
                      Refusal{"NotForQuaternions", model_of(posed(R"({"quaternion": [1, 0, 0, [0, 1]]})")),
                              ": primitives[0].pose.quaternion[3] = [0,1]: must be a number"},
                      Refusal{"SemiAxisNegative", model_of(superquadric("[1, -2.5, 1]", "[1, 1]")),
                              first + "semi_axes[1] = -2.5: must be positive"},
                      Refusal{"TwoSemiAxes", model_of(superquadric("[1, 2]", "[1, 1]")),
                              first + "semi_axes = [1,2]: must be an array of 3 numbers"}),
    name_of);

INSTANTIATE_TEST_SUITE_P(
    OtherSolids, UncertainModelRefusal,
    ::testing::Values(
        Refusal{"BentAndMoved", model_of(R"({"name": "a", "superquadric": {"semi_axes": [1, 2, 3], "exponents": [1, 1]},
                                  "bend": {"curvature": 0.1, "angle_deg": 0}, "pose": {"translation": [0, [0, 1], 0]}})"),
                ": intervals of translations: not supported for bent solids: primitives[0].bend"},
        Refusal{"Tapered", tapered("2", "[1, 2]"),
                ": intervals: not supported for tapered solids: primitives[0].superquadric.taper"},
        Refusal{"ReachesItsCentreAtTheUpperEnd",
                bent("[[1, 5], 1, 1]", "[1, 1]", R"({"curvature": 0.2, "angle_deg": 0})"),
                curvature + " = 0.2" + too_strong + "5" + to_be_below_1},
        Refusal{"MovedInADifference",
                model_of(ball("b") + "," + posed(R"({"translation": [0, [0, 1], 0]})"),
                         R"(, "csg": {"difference": ["b", "a"]})"),
                ": intervals of translations: not supported for csg other than the union of all primitives"}),
    name_of);

INSTANTIATE_TEST_SUITE_P(
    Csg, ModelRefusal,
    ::testing::Values(Refusal{"UnknownName", stem_head_bore(R"({"union": ["stem", "Head", "bore"]})"),
                              ": csg.union[1] = \"Head\": no primitive has this name"},
                      Refusal{"UnknownNameInDifference", stem_head_bore(R"({"difference": ["stem", "hole"]})"),
                              ": csg.difference[1] = \"hole\": no primitive has this name"},
                      Refusal{"UnknownOperator", stem_head_bore(R"({"minus": ["stem", "head"]})"),
                              ": csg.minus = [\"stem\",\"head\"]: unknown key"},
                      Refusal{"TwoOperators", stem_head_bore(R"({"union": ["stem"], "difference": ["head", "bore"]})"),
                              ": csg = {...}: must have exactly one key: union, intersection or difference"},
                      Refusal{"NoOperator", stem_head_bore("{}"),
                              ": csg = {}: must have exactly one key: union, intersection or difference"},
                      Refusal{"NoOperands", stem_head_bore(R"({"union": []})"),
                              ": csg.union = []: must have at least one operand"},
                      Refusal{"NoOperandsDeepInside", stem_head_bore(R"({"union": ["stem", {"intersection": []}]})"),
                              ": csg.union[1].intersection = []: must have at least one operand"},
                      Refusal{"DifferenceOfOne", stem_head_bore(R"({"difference": ["stem"]})"),
                              ": csg.difference = [\"stem\"]: must have at least two operands: the first without the "
                              "others"},
                      Refusal{"OperandsNotAnArray", stem_head_bore(R"({"union": "stem"})"),
                              ": csg.union = \"stem\": must be an array"},
                      Refusal{"OperandNumber", stem_head_bore(R"({"union": ["stem", 3]})"),
                              ": csg.union[1] = 3: must be the name of a primitive or an operator"},
                      Refusal{"NotAnOperator", stem_head_bore(R"("stem")"), ": csg = \"stem\": must be an object"}),
    name_of);

INSTANTIATE_TEST_SUITE_P(
    Syntax, ModelRefusal,
    ::testing::Values(Refusal{"Empty", "", ": the file is empty"},
                      Refusal{"ZeroByte", std::string("{}\0x", 4), ": byte 2 is 0, which is no JSON"},
                      Refusal{"NameOfTwoLines", model_of(ball("a\\nb")),
                              ": primitives[0].name = \"a\\nb\": must have no control characters"},
                      Refusal{"Comma", "{\"format\": \"verisq-model/1\",\n \"units\": \"mm\",\n}",
                              ": line 3, column 1: syntax error while parsing object key - unexpected '}'; expected "
                              "string literal"},
                      Refusal{"NaN", model_of(superquadric("[NaN, 1, 1]", "[1, 1]")),
                              ": line 1, column 90: syntax error while parsing value - invalid literal; last read: "
                              "'\"semi_axes\": [N'"},
                      Refusal{"Truncated", "{\"format\": \"verisq",
                              ": line 1, column 19: syntax error while parsing value - invalid string: missing closing "
                              "quote; last read: '\"verisq'"},
                      Refusal{"LongString", "{\"" + std::string(1000, 'k'),
                              ": line 1, column 1003: syntax error while parsing object key - invalid string: missing "
                              "closing quote; last read: '\"" +
                                  std::string(187, 'k') + "..."},
                      Refusal{"BehindTheEnd", model_of(ball("a")) + "\n\n x",
                              ": line 3, column 2: syntax error while parsing value - invalid literal; last read: "
                              "'1]}}]}<U+000A><U+000A> x'; expected end of input"},
                      Refusal{
                          "NotUtf8", "{\"format\": \"\xff\"}",
                          ": line 1, column 13: syntax error while parsing value - invalid string: ill-formed UTF-8 "
                          "byte; last read: '\"\\xff'"}),
    name_of);

/// Any binary64 numbers that the format accepts, from subnormal to huge: their bits must survive.
class RandomModels {
 public:
  explicit RandomModels(std::uint32_t seed) : generator_(seed) {}

  [[nodiscard]] Model model() {
    Model result{pick(2) == 0 ? "" : "mm \"\u00e9\"", {}};
    const std::size_t count = 1 + pick(5);
    for (std::size_t k = 0; k < count; ++k) result.primitives.push_back(primitive("part " + std::to_string(k)));
    if (pick(2) == 0) result.csg = expression(count, 3);
    return result;
  }

 private:
  std::size_t pick(std::size_t count) { return generator_() % count; }
  /// Finite, with random bits.
  double number() {
    const auto any = std::bit_cast<double>(generator_());
    return std::isfinite(any) ? any : 0.1;
  }
  double signed_number() { return pick(10) == 0 ? -0.0 : number(); }
  double positive() { return std::max(std::abs(number()), std::numeric_limits<double>::denorm_min()); }
  double exponent() { return std::ldexp(1.0 + std::uniform_real_distribution(0.0, 1.0)(generator_), -int(pick(1000))); }

  Primitive primitive(const std::string& name) {
    Primitive result{name,
                     {{positive(), positive(), positive()}, {exponent(), exponent()}},
                     {{signed_number(), signed_number(), signed_number()}, {number(), number(), number(), -1.0 / 3.0}}};
    if (pick(2) == 0) result.superquadric.taper = std::uniform_real_distribution(0.01, 100.0)(generator_);
    if (pick(2) == 0) {
      result.superquadric.semi_axes = {0.1, 1.0 / 3.0, 2.0 / 7.0};
      result.bend = Bend{std::uniform_real_distribution(-1.0, 1.0)(generator_), signed_number()};
    }
    return result;
  }

  SetExpression expression(std::size_t primitives, std::size_t depth) {
    SetExpression result{.operation =
                             std::array{SetOperation::unite, SetOperation::intersect, SetOperation::subtract}[pick(3)]};
    const std::size_t operands = 2 + pick(3);
    for (std::size_t k = 0; k < operands; ++k) {
      result.operands.push_back(depth == 0 || pick(2) == 0
                                    ? SetExpression{.primitive = static_cast<std::uint32_t>(pick(primitives))}
                                    : expression(primitives, depth - 1));
    }
    return result;
  }

  std::mt19937_64 generator_;
};

template <std::size_t N>
std::array<std::uint64_t, N> bits(const std::array<double, N>& numbers) {
  return std::bit_cast<std::array<std::uint64_t, N>>(numbers);
}

void expect_same_bits(const Primitive& a, const Primitive& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(bits(a.superquadric.semi_axes), bits(b.superquadric.semi_axes));
  EXPECT_EQ(bits(a.superquadric.exponents), bits(b.superquadric.exponents));
  EXPECT_EQ(bits(std::array{a.superquadric.taper}), bits(std::array{b.superquadric.taper}));
  EXPECT_EQ(bits(a.pose.translation), bits(b.pose.translation));
  EXPECT_EQ(bits(a.pose.quaternion), bits(b.pose.quaternion));
  ASSERT_EQ(a.bend.has_value(), b.bend.has_value());
  if (!a.bend) return;
  EXPECT_EQ(bits(std::array{a.bend->curvature, a.bend->angle_degrees}),
            bits(std::array{b.bend->curvature, b.bend->angle_degrees}));
}

TEST(ModelWriter, WritesWhatIsReadAsTheSameBits) {
  const TemporaryFolder folder;
  RandomModels random(1);
  for (int k = 0; k < 200; ++k) {
    const Model written = random.model();
    write_model(folder / "m.json", written);
    SCOPED_TRACE(folder.contents("m.json"));
    const Model read = read_model(folder / "m.json");
    EXPECT_EQ(read.units, written.units);
    ASSERT_EQ(read.primitives.size(), written.primitives.size());
    for (std::size_t i = 0; i < read.primitives.size(); ++i) {
      expect_same_bits(read.primitives[i], written.primitives[i]);
    }
    ASSERT_EQ(read.csg.has_value(), written.csg.has_value());
    if (read.csg) {
      EXPECT_EQ(words(*read.csg, read), words(*written.csg, written));
    }
    if (HasFailure()) return;
  }
}

TEST(ModelWriter, WritesAPrimitiveAloneAsItsUnion) {
  const TemporaryFolder folder;
  Model model = parse_model(stem_head_bore(R"({"union": ["stem"]})"), "m.json");
  model.csg = SetExpression{.primitive = 1};
  write_model(folder / "m.json", model);
  const Model read = read_model(folder / "m.json");
  ASSERT_TRUE(read.csg);
  EXPECT_EQ(words(*read.csg, read), "union(head)");
}

TEST(ModelWriter, LeavesNothingWhereItCannotWrite) {
  const TemporaryFolder folder;
  const Model model = parse_model(model_of(ball("a")), "m.json");
  testing::expect_error([&] { write_model(folder / "none" / "m.json", model); }, ErrorKind::failure,
                        (folder / "none" / "m.json").string(), ": cannot be written: No such file or directory");
  EXPECT_TRUE(folder.names().empty());
}

TEST(ModelFile, ReadsFiles) {
  const TemporaryFolder folder;
  const auto path = folder.file("m.json", model_of(ball("a")));
  EXPECT_EQ(read_model(path).primitives.size(), 1U);
}

TEST(ModelFile, NamesTheFileInMessages) {
  const TemporaryFolder folder;
  const auto read = [](const auto& path) { return [path] { (void)read_model(path); }; };
  const auto wrong = folder.file("wrong.json", model_of(superquadric("[1, 1, -1]", "[1, 1]")));
  expect_input_error(read(wrong), wrong, first + "semi_axes[2] = -1: must be positive");
  const auto empty = folder.file("empty.json", "");
  expect_input_error(read(empty), empty, ": the file is empty");
  expect_input_error(read(folder / "none.json"), folder / "none.json", ": no such file");
  expect_input_error(read(folder.path()), folder.path(), ": is a directory, not a file");
}

TEST(ModelLandmarksTest, AreReadAndWrittenAgain) {
  const std::string points = R"(, "landmarks": {"head_centre": [19.3, -0.0, 85.3], "shaft_distal": [1e-9, 2, -8]})";
  const std::string json = model_of(ball("a"), points);
  const FemurLandmarks landmarks = parse_model_landmarks(json, "m.json");
  EXPECT_EQ(landmarks.head_centre, (Point{19.3, 0.0, 85.3}));
  EXPECT_EQ(landmarks.shaft_distal, (Point{1e-9, 2.0, -8.0}));
  EXPECT_FALSE(landmarks.neck_centre);
  EXPECT_EQ(parse_model_landmarks(model_of(ball("a")), "m.json"), FemurLandmarks{});
  const TemporaryFolder folder;
  write_model(folder / "m.json", parse_model(json, "m.json"), landmarks);
  EXPECT_EQ(read_model_landmarks(folder / "m.json"), landmarks);
  EXPECT_EQ(read_model(folder / "m.json").primitives.size(), 1U);
}

TEST(ModelLandmarksTest, AreRefusedByName) {
  const auto refused = [](const std::string& points) {
    return [points] { static_cast<void>(parse_model(model_of(ball("a"), R"(, "landmarks": )" + points), "m.json")); };
  };
  expect_input_error(refused(R"({"origin": [0, 0, 0]})"), "m.json", ": landmarks.origin = [0,0,0]: is no landmark");
  expect_input_error(refused(R"({"head_centre": [0, 0]})"), "m.json",
                     ": landmarks.head_centre = [0,0]: must be an array of 3 numbers");
  expect_input_error(refused("[]"), "m.json", ": landmarks = []: must be an object");
}

}  // namespace
}  // namespace verisq
