/// What kind of solid a model is, and that everything which rests on convex certificates refuses the other kinds.
#include <gmock/gmock.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <string_view>
#include <verisq/verisq.hpp>

#include "tests/fixtures/sample_meshes.hpp"
#include "tests/fixtures/temporary_folder.hpp"

namespace verisq {
namespace {

Primitive ball(std::optional<Bend> bend = {}) {
  return {"ball", {{1.0, 1.0, 1.0}, {1.0, 1.0}}, {}, bend};
}

SetExpression leaf(std::uint32_t primitive) {
  return {.primitive = primitive};
}

SetExpression operation(SetOperation kind, std::vector<SetExpression> operands) {
  return {std::move(operands), kind};
}

Model two_balls(std::optional<SetExpression> csg = {}) {
  return {"", {ball(), ball()}, std::move(csg)};
}

const Model bent{"", {ball(), ball(Bend{0.5, 0.0})}};
const Model difference = two_balls(operation(SetOperation::subtract, {leaf(0), leaf(1)}));

TEST(ModelTest, TellsUnionsOfConvexSolids) {
  using enum SetOperation;
  EXPECT_TRUE(is_union_of_convex(two_balls()));
  EXPECT_TRUE(is_union_of_convex({"", {ball(Bend{0.0, 45.0})}}));
  EXPECT_TRUE(is_union_of_convex(two_balls(operation(unite, {leaf(1), leaf(0)}))));
  EXPECT_TRUE(is_union_of_convex(two_balls(operation(unite, {leaf(1), operation(unite, {leaf(1), leaf(0)})}))));
  EXPECT_TRUE(is_union_of_convex({"", {ball()}, leaf(0)}));
  EXPECT_FALSE(is_union_of_convex(two_balls(leaf(0))));
  EXPECT_FALSE(is_union_of_convex(two_balls(operation(unite, {leaf(1)}))));
  EXPECT_FALSE(is_union_of_convex(two_balls(operation(intersect, {leaf(0), leaf(1)}))));
  EXPECT_FALSE(is_union_of_convex(two_balls(operation(unite, {leaf(0), operation(subtract, {leaf(1), leaf(0)})}))));
  EXPECT_FALSE(is_union_of_convex(bent));
  EXPECT_FALSE(is_union_of_convex({"", {ball(Bend{-5e-324, 0.0})}}));
  EXPECT_FALSE(is_union_of_convex(difference));
}

std::string message_of(const std::function<void(const Model&)>& use, const Model& model) {
  try {
    use(model);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    return error.what();
  }
  return "no error";
}

/// `use` of other set operations is an input error that begins with `what`, of bent solids none.
void expect_refusal_of_csg(const std::function<void(const Model&)>& use, const std::string& what) {
  EXPECT_EQ(message_of(use, difference), what + ": not supported for csg other than the union of all primitives");
  EXPECT_EQ(message_of(use, bent), "no error");
}

/// `use` of either kind of model is an input error that begins with `what`.
void expect_refusal(const std::function<void(const Model&)>& use, const std::string& what) {
  const auto message = [&](const Model& model) { return message_of(use, model); };
  EXPECT_EQ(message(bent), what + ": not supported for bent solids: primitives[1].bend");
  EXPECT_EQ(message(difference), what + ": not supported for csg other than the union of all primitives");
  EXPECT_EQ(message(two_balls()), "no error");
}

TEST(ModelTest, ConvexCertificatesRefuseOtherSolids) {
  MapOptions options{.tolerance = 1.0, .device = "host"};
  expect_refusal_of_csg([](const Model& model) { (void)Checker(model, 0.5); }, "certificates of intervals");
  expect_refusal([](const Model& model) { (void)TriangleDistance(model); }, "distances of triangles");
  options.certificates = true;
  EXPECT_NO_THROW((void)PointMapper(difference, options));
  options.covers = false;
  expect_refusal_of_csg([&](const Model& model) { (void)PointMapper(model, options); }, "certificates without covers");
  expect_refusal([&](const Model& model) { (void)TriangleMapper(model, options); }, "certificates without covers");
  options.certificates = false;
  options.method = Method::published;
  expect_refusal([&](const Model& model) { (void)PointMapper(model, options); }, "the published method");
}

TEST(ModelTest, ThePublishedMethodRefusesBentSolids) {
  const Primitive solid = ball(Bend{0.5, 0.0});
  EXPECT_THROW((void)published_distance(solid, Point{3.0, 0.0, 0.0}), Error);
  EXPECT_THROW((void)published_distance(ball(), solid), Error);
  EXPECT_THROW((void)unverified_distance(solid, Point{3.0, 0.0, 0.0}), Error);
  EXPECT_THROW((void)unverified_distance(solid, ball()), Error);
}

TEST(ModelTest, UncertainTranslationsAreForUnionsOfConvexSolids) {
  expect_refusal(
      [](const Model& model) {
        UncertainModel widened = model;
        widened.primitives[0].translation[0] = {1.0, 1.5};
        (void)bracket(widened);
      },
      "intervals of translations");
}

/// Of what a difference removes the larger one leaves the smaller solid; what is removed from that is kept.
TEST(ModelTest, WhatIsRemovedBracketsTheOtherWay) {
  UncertainModel model =
      two_balls(operation(SetOperation::subtract, {leaf(0), operation(SetOperation::subtract, {leaf(1), leaf(0)})}));
  model.primitives[0].semi_axes[0] = {1.0, 1.5};
  model.primitives[1].semi_axes[0] = {3.0, 4.0};
  model.primitives[1].exponents[0] = {0.5, 0.7};
  const auto& [smallest, largest, inflated, shift] = bracket(model);
  EXPECT_EQ(shift, 0.0);
  EXPECT_FALSE(inflated);
  // Kept both times it is named, and once removed.
  ASSERT_EQ(smallest.primitives.size(), 2U);
  EXPECT_EQ(smallest.primitives[0].superquadric.semi_axes[0], 1.0);
  EXPECT_EQ(largest.primitives[0].superquadric.semi_axes[0], 1.5);
  EXPECT_EQ(smallest.primitives[1].superquadric.semi_axes[0], 4.0);
  EXPECT_EQ(smallest.primitives[1].superquadric.exponents[0], 0.5);
  EXPECT_EQ(largest.primitives[1].superquadric.semi_axes[0], 3.0);
  EXPECT_EQ(largest.primitives[1].superquadric.exponents[0], 0.7);
  model.csg = operation(SetOperation::unite, {leaf(1), operation(SetOperation::subtract, {leaf(0), leaf(1)})});
  const Bracket apart = bracket(model);
  ASSERT_EQ(apart.smallest.primitives.size(), 3U) << "one of them kept in one place and removed in another";
  EXPECT_EQ(apart.smallest.primitives[0].superquadric.semi_axes[0], 3.0);
  EXPECT_EQ(apart.smallest.primitives[2].superquadric.semi_axes[0], 4.0);
  EXPECT_EQ(apart.largest.csg->operands[1].operands[1].primitive, 2U);
}

TEST(ModelTest, ExactModelsAreTheirOwnBrackets) {
  for (const Model& model : {bent, difference}) {
    const Bracket models = bracket(model);
    EXPECT_EQ(models.shift, 0.0);
    EXPECT_FALSE(models.inflated);
    for (const Model& same : {models.smallest, models.largest}) {
      EXPECT_EQ(same.csg.has_value(), model.csg.has_value());
      EXPECT_EQ(same.primitives[1].bend.has_value(), model.primitives[1].bend.has_value());
    }
  }
}

/// A use of each public entry that takes a model.
std::vector<std::pair<const char*, std::function<void(const Model&)>>> entries() {
  static const Mesh mesh = testing::tetrahedron();
  static const std::vector<Pose> path{{}, {.translation = {1.0, 0.0, 0.0}}};
  static const std::vector<Point> points{{2.0, 0.0, 0.0}};
  static const Cavity cavity{points, {{"all", 1.0}}, {0}};
  static const MapOptions on_host{.tolerance = 1e-3, .device = "host"};
  static const BestFitClaim claim{{}, {}, {{0.0, 0.0, 0.0}}, 0.0};
  static const FitOptions fit_options = [] {
    FitOptions options{};
    options.device = "host";
    return options;
  }();
  static const BoneRegion bone{{{mesh, {}}}, {}};
  static const testing::TemporaryFolder folder;
  const auto used = [](const auto&) {};
  return {
      {"Checker", [=](const Model& m) { used(Checker(m)); }},
      {"PairChecker", [=](const Model& m) { used(PairChecker(m, m)); }},
      {"PathChecker", [=](const Model& m) { used(PathChecker(m, m, path)); }},
      {"OctreeChecker",
       [=](const Model& m) {
         used(OctreeChecker(m, {{0.0, 0.0, 0.0}, 4.0}, {}));
       }},
      {"DeviationChecker", [=](const Model& m) { used(DeviationChecker(m)); }},
      {"ContactChecker", [=](const Model& m) { used(ContactChecker(m)); }},
      {"InsertionChecker", [=](const Model& m) { used(InsertionChecker(m, path)); }},
      {"WaySurfaceChecker", [=](const Model& m) { used(WaySurfaceChecker(m, path, mesh)); }},
      {"RemovedVolumeChecker", [=](const Model& m) { used(RemovedVolumeChecker(m, path, bone)); }},
      {"SideChecker", [=](const Model& m) { used(SideChecker(m, mesh, 0.0)); }},
      {"BestFitChecker", [=](const Model& m) { used(BestFitChecker(std::vector{m}, points, claim)); }},
      {"SignedDistance", [=](const Model& m) { used(SignedDistance(m)); }},
      {"TriangleSearch", [=](const Model& m) { used(TriangleSearch(m)); }},
      {"ModelSearch", [=](const Model& m) { used(ModelSearch(m, m)); }},
      {"PairDistance", [=](const Model& m) { used(PairDistance(m, m)); }},
      {"PointMapper", [=](const Model& m) { used(PointMapper(m, on_host)); }},
      {"TriangleMapper", [=](const Model& m) { used(TriangleMapper(m, on_host)); }},
      {"PoseMapper", [=](const Model& m) { used(PoseMapper(m, m, on_host)); }},
      {"OctreeBuilder", [=](const Model& m) { used(OctreeBuilder(m, {.depth = 1, .device = "host"})); }},
      {"deviation", [=](const Model& m) { used(deviation(m, mesh, {.device = "host"})); }},
      {"contact_areas", [=](const Model& m) { used(contact_areas(m, mesh, {.distance = 1.0, .device = "host"})); }},
      {"contact_areas of the model",
       [=](const Model& m) { used(contact_areas(m, mesh, {.distance = 1.0, .of_model = true, .device = "host"})); }},
      {"prove_containment",
       [=](const Model& m) { used(prove_containment(m, mesh, Containment::within, {.device = "host"})); }},
      {"mesh_clearance", [=](const Model& m) { used(mesh_clearance(m, mesh, {.tolerance = 0.1, .device = "host"})); }},
      {"mesh_clearance_along",
       [=](const Model& m) { used(mesh_clearance_along(path, m, mesh, {.tolerance = 0.1, .device = "host"})); }},
      {"InsertionMapper",
       [=](const Model& m) { used(InsertionMapper(path, m, points, {.tolerance = 0.1, .device = "host"})); }},
      {"removed_volume", [=](const Model& m) { used(removed_volume(path, m, bone, {})); }},
      {"distance_along", [=](const Model& m) { used(distance_along(path, m, m, {})); }},
      {"certified_clearance",
       [=](const Model& m) {
         used(certified_clearance(m, cavity, cementless(2.0, 0.0), 0.0, on_host, [](const auto&...) {}));
       }},
      {"fit", [=](const Model& m) { used(fit(std::vector<UncertainModel>{m}, cavity, fit_options)); }},
      {"bound_fit",
       [=](const Model& m) { used(bound_fit(std::vector<UncertainModel>{m}, cavity, FitBoundOptions{})); }},
      {"model_mesh", [=](const Model& m) { used(model_mesh(m, {.deviation = 0.1})); }},
      {"posed", [=](const Model& m) { used(posed(m, Pose{})); }},
      {"bracket", [=](const Model& m) { used(bracket(m)); }},
      {"bounding_radius", [=](const Model& m) { used(bounding_radius(m)); }},
      {"implant_size", [=](const Model& m) { used(implant_size(m)); }},
      {"turning_centre", [=](const Model& m) { used(turning_centre(m)); }},
      {"negligible_volume", [=](const Model& m) { used(negligible_volume(m)); }},
      {"covering_primitives", [=](const Model& m) { used(covering_primitives(m)); }},
      {"write_model", [=](const Model& m) { write_model(folder.path() / "m.json", m); }},
  };
}

/// A fault, and what the reader of files says of it behind the file's name.
struct BadModel {
  std::function<void(Model&)> spoil;
  const char* sentence;
};

std::vector<BadModel> bad_models() {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const auto at = [](Model& m) -> Primitive& { return m.primitives[1]; };
  const auto solid = [at](Model& m) -> Superquadric& { return at(m).superquadric; };
  return {
      {[](Model& m) { m.primitives.clear(); }, "primitives = []: must have at least one primitive"},
      {[=](Model& m) { solid(m).exponents[0] = 4; }, "primitives[1].superquadric.exponents[0] = 4: must be in (0, 2]"},
      {[=](Model& m) { solid(m).exponents[1] = 0; }, "primitives[1].superquadric.exponents[1] = 0: must be in (0, 2]"},
      {[=](Model& m) { solid(m).exponents[1] = nan; },
       "primitives[1].superquadric.exponents[1] = [nan, nan]: must be in (0, 2]"},
      {[=](Model& m) { solid(m).semi_axes[2] = -1; }, "primitives[1].superquadric.semi_axes[2] = -1: must be positive"},
      {[=](Model& m) { solid(m).semi_axes[0] = infinity; },
       "primitives[1].superquadric.semi_axes[0] = inf: must be finite"},
      {[=](Model& m) { solid(m).taper = 0.001; },
       "primitives[1].superquadric.taper = 0.001: the section at z = a3 over that at z = -a3 must be in [0.01, 100]"},
      {[=](Model& m) {
         at(m).pose.quaternion = {0, 0, 0, 0};
       },
       "primitives[1].pose.quaternion = [0, 0, 0, 0]: must not be zero"},
      {[=](Model& m) { at(m).pose.translation[1] = infinity; },
       "primitives[1].pose.translation[1] = inf: must be finite"},
      {[=](Model& m) {
         at(m).bend = Bend{1.5, 0.0};
       },
       "primitives[1].bend.curvature = 1.5: its magnitude times the solid's extent towards angle_deg, 1, must be "
       "below 1"},
      {[=](Model& m) {
         m.csg = operation(SetOperation::unite, {leaf(0), leaf(7)});
       },
       "csg = 7: no primitive has this index"},
  };
}

TEST(ModelTest, EveryEntryRefusesImpossibleModelsInTheReadersWords) {
  for (const BadModel& bad : bad_models()) {
    Model model = two_balls();
    bad.spoil(model);
    for (const auto& [name, use] : entries()) EXPECT_EQ(message_of(use, model), bad.sentence) << name;
  }
}

/// Who takes a mesh for its superquadric, which is all zeros, would answer for another solid.
TEST(ModelTest, EveryEntryAnswersForMeshesOrRefusesThem) {
  const Model model{"", {ball(), mesh_primitive("mesh", testing::tetrahedron())}};
  const std::vector<std::string_view> answer{"PairChecker",
                                             "PathChecker",
                                             "OctreeChecker",
                                             "DeviationChecker",
                                             "Checker",
                                             "SignedDistance",
                                             "TriangleSearch",
                                             "ModelSearch",
                                             "PointMapper",
                                             "TriangleMapper",
                                             "PoseMapper",
                                             "OctreeBuilder",
                                             "distance_along",
                                             "mesh_clearance_along",
                                             "InsertionMapper",
                                             "certified_clearance",
                                             "bounding_radius",
                                             "posed",
                                             "bracket",
                                             "write_model",
                                             "negligible_volume",
                                             "SideChecker",
                                             "contact_areas",
                                             "mesh_clearance",
                                             "implant_size",
                                             "turning_centre",
                                             "covering_primitives"};
  for (const auto& [name, use] : entries()) {
    const std::string message = message_of(use, model);
    if (std::string_view(name) == "fit")
      EXPECT_THAT(message, ::testing::HasSubstr("fitness")) << "a mesh is an implant; these options have no fitness";
    else if (std::ranges::find(answer, name) != answer.end())
      EXPECT_EQ(message, "no error") << name;
    else
      EXPECT_THAT(message, ::testing::HasSubstr("mesh")) << name;
  }
}

/// What the library refuses is what the reader refuses, to the letter.
TEST(ModelTest, TheReaderSaysTheSame) {
  const auto said = [](const std::string& number, const std::string& of) {
    const auto solid = [&](const std::string& key, const std::string& value) { return key == of ? number : value; };
    const std::string text =
        R"({"format": "verisq-model/1", "primitives": [{"name": "a", "superquadric": {"semi_axes": [1, 1, )" +
        solid("axis", "1") + R"(], "exponents": [)" + solid("exponent", "1") + R"(, 1], "taper": )" +
        solid("taper", "1") + R"(}, "bend": {"curvature": )" + solid("curvature", "0") + R"(, "angle_deg": 0}}]})";
    return message_of([&](const Model&) { static_cast<void>(parse_model(text, "m")); }, {});
  };
  const std::string place = "m: primitives[0].";
  EXPECT_EQ(said("-1", "axis"), place + "superquadric.semi_axes[2] = -1: must be positive");
  EXPECT_EQ(said("4", "exponent"), place + "superquadric.exponents[0] = 4: must be in (0, 2]");
  EXPECT_EQ(said("0.001", "taper"),
            place + "superquadric.taper = 0.001: the section at z = a3 over that at z = -a3 must be in [0.01, 100]");
  EXPECT_EQ(said("1.5", "curvature"), place +
                                          "bend.curvature = 1.5: its magnitude times the solid's extent towards "
                                          "angle_deg, 1, must be below 1");
}

std::string refusal(const std::function<void()>& use) {
  return message_of([&](const Model&) { use(); }, {});
}

TEST(ModelTest, QueriesRefuseWhatIsNoPoseNoPointAndNoTolerance) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const Model model = two_balls();
  const Pose zero{.quaternion = {0, 0, 0, 0}};
  const std::string of_zero = "pose.quaternion = [0, 0, 0, 0]: must not be zero";
  EXPECT_EQ(refusal([&] { static_cast<void>(PairDistance(model, model)(zero)); }), of_zero);
  EXPECT_EQ(refusal([&] { static_cast<void>(ModelSearch(model, model)(zero, {.tolerance = 0.1})); }), of_zero);
  EXPECT_EQ(refusal([&] { static_cast<void>(PairChecker(model, model).prove(zero, {})); }), of_zero);
  EXPECT_EQ(refusal([&] { static_cast<void>(posed(model, zero)); }), of_zero);
  EXPECT_EQ(refusal([&] {
              static_cast<void>(posed(model, {.translation = {0, nan, 0}}));
            }),
            "pose.translation[1] = nan: must be finite");
  const Point nowhere{0.0, nan, 0.0};
  const std::string of_point = "point[1] = nan: must be finite";
  EXPECT_EQ(refusal([&] { static_cast<void>(SignedDistance(model)(nowhere, 0.1)); }), of_point);
  EXPECT_EQ(refusal([&] { static_cast<void>(Checker(model)(nowhere, {0.0, 1.0}, {})); }), of_point);
  EXPECT_EQ(refusal([&] {
              static_cast<void>(TriangleSearch(model)({nowhere, nowhere, nowhere}, 0.1));
            }),
            "triangle[0][1] = nan: must be finite");
  for (const double tolerance : {nan, -1.0}) {
    const std::string shown = tolerance < 0.0 ? "-1" : "nan";
    EXPECT_EQ(refusal([&] {
                static_cast<void>(SignedDistance(model)({2, 0, 0}, tolerance));
              }),
              "tolerance = " + shown + ": must be at least 0");
    EXPECT_EQ(refusal([&] { static_cast<void>(PointMapper(model, {.tolerance = tolerance})); }),
              "map: tolerance = " + shown + ": must be at least 0");
    const std::string of_tolerance = "tolerance = " + shown + ": must be at least 0";
    EXPECT_EQ(refusal([&] { static_cast<void>(ModelSearch(model, model)({}, {.tolerance = tolerance})); }),
              of_tolerance);
    const Triangle triangle{{{2, 0, 0}, {2, 1, 0}, {2, 0, 1}}};
    EXPECT_EQ(refusal([&] { static_cast<void>(TriangleSearch(model)(triangle, tolerance)); }), of_tolerance);
    EXPECT_EQ(refusal([&] { static_cast<void>(TriangleSearch(model).certified(triangle, tolerance)); }), of_tolerance);
  }
}

TEST(ModelTest, PublishedMethodClosestPointsAndMovedPointsRefuseTheSame) {
  const Primitive good = two_balls().primitives.front();
  Primitive bad = good;
  bad.superquadric.exponents[0] = 2.5;
  const std::string of_exponent = "primitives[0].superquadric.exponents[0] = 2.5: must be in (0, 2]";
  EXPECT_EQ(refusal([&] { static_cast<void>(published_distance(bad, Point{3, 0, 0})); }), of_exponent);
  EXPECT_EQ(refusal([&] { static_cast<void>(published_distance(good, bad)); }), of_exponent);
  const Point nowhere{std::numeric_limits<double>::quiet_NaN(), 0, 0};
  const std::string of_point = "point[0] = nan: must be finite";
  EXPECT_EQ(refusal([&] { static_cast<void>(published_distance(good, nowhere)); }), of_point);
  EXPECT_EQ(refusal([&] { static_cast<void>(posed(nowhere, Pose{})); }), of_point);
  const Pose zero{.quaternion = {0, 0, 0, 0}};
  EXPECT_EQ(refusal([&] { static_cast<void>(posed(Point{}, zero)); }),
            "pose.quaternion = [0, 0, 0, 0]: must not be zero");
  const SignedDistance distance(two_balls());
  EXPECT_EQ(refusal([&] { static_cast<void>(distance.certified(nowhere, 0.1)); }), of_point);
  EXPECT_EQ(refusal([&] {
              static_cast<void>(distance.closest_point({3, 0, 0}, Enclosure{2, 1}));
            }),
            "known = [2, 1]: must hold a number");
}

/// No number is in both, so nothing proves it.
TEST(ModelTest, TheCheckerRefutesEnclosuresThatHoldNothing) {
  const SignedDistance distance(two_balls());
  const CertifiedEnclosure found = distance.certified({3, 0, 0}, 1e-9);
  const Checker checker(two_balls());
  EXPECT_EQ(checker(Point{3, 0, 0}, found.distance, found.certificate).verdict, Verdict::proved);
  EXPECT_EQ(checker(Point{3, 0, 0}, {2, 1}, found.certificate).verdict, Verdict::refuted);
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(checker(Point{3, 0, 0}, {nan, nan}, found.certificate).verdict, Verdict::proved);
}

}  // namespace
}  // namespace verisq
