/// The model format: what it accepts, and the message for everything it refuses.
#include <gmock/gmock.h>

#include <limits>
#include <string>
#include <tuple>
#include <verisq/model_file.hpp>

#include "tests/error_matchers.hpp"
#include "tests/temporary_folder.hpp"

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

TEST(ModelFile, AcceptsUnionsOfAllPrimitives) {
  for (const char* csg :
       {R"({"union": ["stem", "head", "bore"]})", R"({"union": ["bore", {"union": ["head", "stem"]}]})",
        R"({"union": ["bore", {"union": ["head"]}, {"union": [{"union": ["stem", "head"]}]}]})"}) {
    EXPECT_EQ(parse_model(stem_head_bore(csg), "m.json").primitives.size(), 3U) << csg;
  }
}

std::string hundred_times(const std::string& text) {
  std::string result;
  for (int k = 0; k < 100; ++k) result += text;
  return result;
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
const std::string only_union = ": not supported yet: only the union of all primitives is";

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
        Refusal{"NestedTooDeep", std::string(100000, '['),
                ": " + hundred_times("[0]") + ": nested deeper than 100 levels"}),
    name_of);

INSTANTIATE_TEST_SUITE_P(
    NotYet, ModelRefusal,
    ::testing::Values(
        Refusal{"Bend", model_of(R"({"name": "a", "superquadric": {"semi_axes": [1, 1, 1], "exponents": [1, 1]},
                             "bend": {"curvature": 0.002, "angle_deg": 70.0}})"),
                ": primitives[0].bend: bent superquadrics are not supported yet"},
        Refusal{"IntervalSemiAxis", model_of(superquadric("[1, [5.5, 6], 1]", "[1, 1]")),
                first + "semi_axes[1] = [5.5,6]: is an interval, where only an exact model is supported"},
        Refusal{"IntervalExponent", model_of(superquadric("[1, 1, 1]", "[[0.5, 0.6], 1]")),
                first + "exponents[0] = [0.5,0.6]: is an interval, where only an exact model is supported"},
        Refusal{"IntervalTranslation", model_of(posed(R"({"translation": [0, 0, [-1, 1]]})")),
                ": primitives[0].pose.translation[2] = [-1,1]: is an interval, where only an exact model is supported"},
        Refusal{"IntervalNotAllowed", model_of(posed(R"({"quaternion": [1, 0, 0, [0, 1]]})")),
                ": primitives[0].pose.quaternion[3] = [0,1]: must be a number"},
        Refusal{"NotAnInterval", model_of(superquadric("[1, [5, 6, 7], 1]", "[1, 1]")),
                first + "semi_axes[1] = [5,6,7]: must be a number"},
        Refusal{"Difference", stem_head_bore(R"({"union": ["stem", {"difference": ["head", "bore"]}]})"),
                ": csg.union[1].difference" + only_union},
        Refusal{"Intersection", stem_head_bore(R"({"intersection": ["stem", "head", "bore"]})"),
                ": csg.intersection" + only_union},
        Refusal{"LeavesOutAPrimitive", stem_head_bore(R"({"union": ["stem", {"union": ["bore"]}]})"),
                ": csg: leaves out primitive \"head\": not supported yet, only the union of all primitives is"}),
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
  EXPECT_TRUE(is_exact(read_uncertain_model(VERISQ_EXAMPLES "/stem.json")));
  EXPECT_FALSE(is_exact(read_uncertain_model(VERISQ_EXAMPLES "/uncertain_stem.json")));
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
                      Refusal{"OperandsNotAnArray", stem_head_bore(R"({"union": "stem"})"),
                              ": csg.union = \"stem\": must be an array"},
                      Refusal{"OperandNumber", stem_head_bore(R"({"union": ["stem", 3]})"),
                              ": csg.union[1] = 3: must be the name of a primitive or an operator"},
                      Refusal{"NotAnOperator", stem_head_bore(R"("stem")"), ": csg = \"stem\": must be an object"}),
    name_of);

INSTANTIATE_TEST_SUITE_P(
    Syntax, ModelRefusal,
    ::testing::Values(Refusal{"Empty", "", ": the file is empty"},
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

}  // namespace
}  // namespace verisq
