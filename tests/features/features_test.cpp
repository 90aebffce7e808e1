/// Features of femora: exact where they are known, intervals that hold what moved landmarks give, bad input refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>
#include <verisq/error.hpp>
#include <verisq/features.hpp>
#include <verisq/files.hpp>

#include "host/prepare/femur.hpp"
#include "tests/features/synthetic_femur.hpp"
#include "tests/fixtures/places.hpp"
#include "tests/fixtures/temporary_folder.hpp"

namespace verisq {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;

Vector3d at(const std::optional<Point>& x) {
  return Vector3d((*x)[0], (*x)[1], (*x)[2]);
}

double degrees(double radians) {
  return radians * 180.0 / std::numbers::pi;
}

double middle(const Enclosure& e) {
  return 0.5 * (e.lo + e.hi);
}

const Feature& feature(const FemurFeatures& found, const std::string& name, const std::string& method = "") {
  for (const Feature& f : found.features) {
    if (f.name == name && f.method.find(method) != std::string::npos) return f;
  }
  throw std::runtime_error("no feature " + name);
}

/// By projections and arc functions: another way than the library's.
double version_of(const FemurLandmarks& l, const Vector3d& lateral, const Vector3d& medial, const Vector3d& neck,
                  Side side) {
  const Vector3d up = (at(l.shaft_proximal) - at(l.shaft_distal)).normalized();
  const auto flat = [&](const Vector3d& v) { return (v - up * up.dot(v)).normalized(); };
  const Vector3d inward = flat(medial - lateral);
  const Vector3d outward_right = side == Side::right ? Vector3d(-inward) : inward;
  const Vector3d ahead = up.cross(outward_right);  // y x z
  const Vector3d n = flat(neck);
  return degrees(std::asin(std::clamp(n.dot(ahead), -1.0, 1.0)));
}

struct Expected {
  const char* name;
  const char* method;
  double value;
};

std::vector<Expected> expected(const FemurLandmarks& l, Side side) {
  const Vector3d head = at(l.head_centre);
  const Vector3d shaft = (at(l.shaft_proximal) - at(l.shaft_distal)).normalized();
  const Vector3d neck = head - at(l.neck_centre);
  const Vector3d from_shaft = head - at(l.shaft_distal);
  const Vector3d knee = 0.5 * (at(l.medial_epicondyle) + at(l.lateral_epicondyle));
  const Vector3d lateral = at(l.lateral_posterior_condyle);
  const Vector3d medial = at(l.medial_posterior_condyle);
  return {
      {"ccd", "", degrees(std::acos(-neck.normalized().dot(shaft)))},
      {"offset", "", (from_shaft - shaft * shaft.dot(from_shaft)).norm()},
      {"version", "neck axis against the posterior", version_of(l, lateral, medial, neck, side)},
      {"version", "neck axis against the transepicondylar",
       version_of(l, at(l.lateral_epicondyle), at(l.medial_epicondyle), neck, side)},
      {"version", "shaft axis to head", version_of(l, lateral, medial, from_shaft, side)},
      {"length", "", (head - knee).norm()},
      {"epicondylar_width", "", (at(l.medial_epicondyle) - at(l.lateral_epicondyle)).norm()},
      {"anatomical_mechanical_angle", "", degrees(std::acos((head - knee).normalized().dot(shaft)))},
  };
}

class SyntheticFemurTest : public ::testing::TestWithParam<Side> {};

TEST_P(SyntheticFemurTest, IsFoundToAHundredth) {
  const SyntheticFemur femur;
  const DetectedFemur found = detect_femur(mesh_of(femur, GetParam(), 1.25));
  EXPECT_EQ(found.side, GetParam());
  const FemurFeatures features = femur_features(found.landmarks, found.side, 0.0);
  EXPECT_TRUE(features.missing.empty());
  constexpr double exact = 0.01;
  EXPECT_NEAR(*found.landmarks.head_radius, femur.head_radius, exact);
  EXPECT_NEAR(middle(feature(features, "ccd").value), femur.ccd_degrees, exact);
  EXPECT_NEAR(middle(feature(features, "offset").value), femur.offset(), exact);
  EXPECT_NEAR(middle(feature(features, "version", "neck axis against the posterior").value), femur.version_degrees,
              exact);
  EXPECT_NEAR(middle(feature(features, "version", "shaft axis to head").value), femur.version_degrees, exact);
  EXPECT_NEAR(middle(feature(features, "version", "transepicondylar").value), femur.version_degrees, exact);
  Vector3d head = femur.head_centre();
  if (GetParam() == Side::left) head[2] = -head[2];
  EXPECT_NEAR((at(found.landmarks.head_centre) - head).norm(), 0.0, exact);
}

INSTANTIATE_TEST_SUITE_P(BothSides, SyntheticFemurTest, ::testing::Values(Side::left, Side::right));

/// Its edge is no epicondyle: the knee does not turn about it.
TEST(DetectedFemurTest, EpicondylesLieBesideTheAxisOfTheCondyles) {
  SyntheticFemur femur;
  femur.ridge = true;
  const DetectedFemur found = detect_femur(mesh_of(femur, Side::right, 1.25));
  const FemurFeatures features = femur_features(found.landmarks, found.side, 0.0);
  EXPECT_NEAR(middle(feature(features, "version", "transepicondylar").value), femur.version_degrees, 0.01);
  EXPECT_NEAR(middle(feature(features, "epicondylar_width").value), 82.0, 0.01);
}

TEST(DetectedFemurTest, OfAProximalOneHasNoCondyles) {
  SyntheticFemur femur;
  femur.condyles = false;
  const DetectedFemur found = detect_femur(mesh_of(femur, Side::right, 2.0));
  EXPECT_FALSE(found.landmarks.medial_epicondyle);
  const FemurFeatures features = femur_features(found.landmarks, found.side, 0.0);
  EXPECT_NEAR(middle(feature(features, "ccd").value), femur.ccd_degrees, 0.05);
  EXPECT_EQ(features.features.size(), 3U) << "head, CCD, offset";
  EXPECT_FALSE(features.missing.empty());
}

TEST(DetectedFemurTest, RefusesTheOtherSide) {
  const Mesh mesh = mesh_of({}, Side::right, 3.0);
  EXPECT_THROW(static_cast<void>(detect_femur(mesh, Side::left)), Error);
  EXPECT_EQ(detect_femur(mesh, Side::right).side, Side::right);
}

FemurLandmarks usual_landmarks() {
  return {.head_centre = Point{40.0, 30.0, 5.0},
          .head_radius = 24.0,
          .neck_centre = Point{25.0, 18.0, 1.0},
          .shaft_proximal = Point{1.0, -60.0, 0.0},
          .shaft_distal = Point{-2.0, -280.0, 3.0},
          .medial_posterior_condyle = Point{25.0, -370.0, -30.0},
          .lateral_posterior_condyle = Point{-24.0, -371.0, -28.0},
          .medial_epicondyle = Point{42.0, -360.0, -4.0},
          .lateral_epicondyle = Point{-41.0, -362.0, -7.0}};
}

/// A point of the ball, as often as not of its sphere.
Point moved(const Point& x, double radius, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const Vector3d d = Vector3d(normal(random), normal(random), normal(random)).normalized();
  const double size = random() % 2 == 0 ? radius : radius * std::uniform_real_distribution(0.0, 1.0)(random);
  constexpr double within = 1.0 - 1e-12;
  return {x[0] + within * size * d[0], x[1] + within * size * d[1], x[2] + within * size * d[2]};
}

TEST(FemurFeaturesTest, HoldThoseOfMovedLandmarks) {
  std::mt19937_64 random(1);
  constexpr double radius = 2.0;
  constexpr double rounding = 1e-9;
  for (const Side side : {Side::left, Side::right}) {
    const FemurLandmarks landmarks = usual_landmarks();
    const FemurFeatures features = femur_features(landmarks, side, radius);
    ASSERT_TRUE(features.missing.empty());
    std::vector<Enclosure> hull(expected(landmarks, side).size(), {infinity, -infinity});
    for (int i = 0; i < 10'000; ++i) {
      FemurLandmarks other = landmarks;
      for (const auto& [name, point] : named_landmarks) other.*point = moved(*(landmarks.*point), radius, random);
      const std::vector<Expected> values = expected(other, side);
      for (std::size_t k = 0; k < values.size(); ++k) {
        const Enclosure& found = feature(features, values[k].name, values[k].method).value;
        ASSERT_GE(values[k].value, found.lo - rounding) << values[k].name << values[k].method;
        ASSERT_LE(values[k].value, found.hi + rounding) << values[k].name << values[k].method;
        hull[k] = {std::min(hull[k].lo, values[k].value), std::max(hull[k].hi, values[k].value)};
      }
    }
    const std::vector<Expected> values = expected(landmarks, side);
    for (std::size_t k = 0; k < values.size(); ++k) {
      const Enclosure& found = feature(features, values[k].name, values[k].method).value;
      EXPECT_LE(found.width(), 2.5 * hull[k].width()) << values[k].name << " is no wider than it need be";
    }
  }
}

TEST(FemurFeaturesTest, FrameHoldsThatOfMovedLandmarks) {
  std::mt19937_64 random(2);
  constexpr double radius = 3.0;
  const FemurLandmarks landmarks = usual_landmarks();
  const FemurFrame frame = *femur_features(landmarks, Side::right, radius).frame;
  EXPECT_NEAR(Vector3d(frame.x.direction.data())
                  .cross(Vector3d(frame.y.direction.data()))
                  .dot(Vector3d(frame.z.direction.data())),
              1.0, 1e-12);
  for (int i = 0; i < 2'000; ++i) {
    FemurLandmarks other = landmarks;
    for (const auto& [name, point] : named_landmarks) other.*point = moved(*(landmarks.*point), radius, random);
    const FemurFrame found = *femur_features(other, Side::right, 0.0).frame;
    const auto tilted = [](const FrameAxis& a, const FrameAxis& b) {
      const Vector3d u(a.direction.data());
      const Vector3d v(b.direction.data());
      return degrees(std::atan2(u.cross(v).norm(), u.dot(v)));
    };
    ASSERT_LE(tilted(frame.x, found.x), frame.x.tilt_degrees);
    ASSERT_LE(tilted(frame.y, found.y), frame.y.tilt_degrees);
    ASSERT_LE(tilted(frame.z, found.z), frame.z.tilt_degrees);
  }
}

TEST(FemurFeaturesTest, ExactLandmarksGiveTightIntervals) {
  for (const Feature& f : femur_features(usual_landmarks(), Side::left, 0.0).features)
    EXPECT_LE(f.value.width(), 1e-11) << f.name;
}

TEST(FemurFeaturesTest, SaysWhatIsMissing) {
  FemurLandmarks landmarks = usual_landmarks();
  landmarks.shaft_distal.reset();
  const FemurFeatures found = femur_features(landmarks, Side::left, 1.0);
  EXPECT_THAT(found.missing, ::testing::Contains(HasSubstr("offset: needs head and shaft")));
  EXPECT_FALSE(femur_features(usual_landmarks(), std::nullopt, 1.0).frame) << "no side";
  // Known to no better than their distance: any direction.
  EXPECT_THAT(femur_features(usual_landmarks(), Side::left, 15.0).missing,
              ::testing::Contains(HasSubstr("ccd: needs")));
}

TEST(FemurFeaturesTest, RefusesWhatIsNoNumber) {
  FemurLandmarks landmarks = usual_landmarks();
  EXPECT_THROW(static_cast<void>(femur_features(landmarks, Side::left, -1.0)), Error);
  EXPECT_THROW(static_cast<void>(femur_features(landmarks, Side::left, infinity)), Error);
  landmarks.neck_centre = Point{0.0, std::nan(""), 0.0};
  EXPECT_THROW(static_cast<void>(femur_features(landmarks, Side::left, 1.0)), Error);
}

TEST(ImplantChangesTest, AreThoseOfItsHeadAndNeck) {
  const FemurLandmarks bone = usual_landmarks();
  const Vector3d up = (at(bone.shaft_proximal) - at(bone.shaft_distal)).normalized();
  const Vector3d longer = at(bone.head_centre) + 7.0 * up;
  const Vector3d neck = at(bone.neck_centre) + 7.0 * up;
  const auto point = [](const Vector3d& x) { return Point{x[0], x[1], x[2]}; };
  const FemurFeatures same =
      implant_changes(bone, Side::left, 0.0, {.head_centre = point(longer), .neck_centre = point(neck)});
  EXPECT_NEAR(middle(feature(same, "length_change").value), 7.0, 1e-9);
  EXPECT_NEAR(middle(feature(same, "offset_change").value), 0.0, 1e-9);
  EXPECT_NEAR(middle(feature(same, "version_change").value), 0.0, 1e-9);
  // Turned ahead by 5 degrees about the shaft: more version of a left femur turns from medial to anterior.
  const Eigen::AngleAxisd turn(5.0 * std::numbers::pi / 180.0, up);
  const Vector3d head = at(bone.neck_centre) + turn * (at(bone.head_centre) - at(bone.neck_centre));
  const auto changes = [&](Side side) {
    return implant_changes(bone, side, 0.0, {.head_centre = point(head), .neck_centre = bone.neck_centre});
  };
  EXPECT_NEAR(middle(feature(changes(Side::left), "version_change").value), 5.0, 1e-9);
  EXPECT_NEAR(middle(feature(changes(Side::right), "version_change").value), -5.0, 1e-9);
}

double distance_from_shaft(const FemurLandmarks& bone, const std::optional<Point>& point) {
  const Vector3d up = (at(bone.shaft_proximal) - at(bone.shaft_distal)).normalized();
  return up.cross(at(point) - at(bone.shaft_distal)).norm();
}

/// A stem as one may stand in the usual femur.
FemurLandmarks usual_implant() {
  return {.head_centre = Point{43.0, 34.0, 7.0},
          .neck_centre = Point{24.0, 17.0, 2.0},
          .shaft_proximal = Point{2.0, -10.0, 0.0},
          .shaft_distal = Point{-1.0, -140.0, 3.0}};
}

TEST(ImplantChangesTest, HoldThoseOfMovedLandmarks) {
  std::mt19937_64 random(2);
  constexpr double radius = 1.0;
  constexpr double rounding = 1e-9;
  const FemurLandmarks bone = usual_landmarks();
  const FemurLandmarks implant = usual_implant();
  const FemurFeatures changes = implant_changes(bone, Side::left, radius, implant);
  ASSERT_TRUE(changes.missing.empty());
  std::vector<Enclosure> hull(changes.features.size(), {infinity, -infinity});
  for (int i = 0; i < 2'000; ++i) {
    FemurLandmarks other = bone;
    for (const NamedLandmark& named : named_landmarks) {
      std::optional<Point>& point = other.*named.point;
      point = moved(*point, radius, random);
    }
    const FemurFeatures exact = implant_changes(other, Side::left, 0.0, implant);
    EXPECT_NEAR(middle(feature(exact, "offset_change").value),
                distance_from_shaft(other, implant.head_centre) - distance_from_shaft(other, other.head_centre),
                rounding);
    for (std::size_t k = 0; k < hull.size(); ++k) {
      const double value = middle(exact.features[k].value);
      ASSERT_GE(value, changes.features[k].value.lo - rounding) << changes.features[k].name;
      ASSERT_LE(value, changes.features[k].value.hi + rounding) << changes.features[k].name;
      hull[k] = {std::min(hull[k].lo, value), std::max(hull[k].hi, value)};
    }
  }
  // The heads share the shaft axis: what it moves both by is no change.
  const Enclosure& offset = feature(changes, "offset_change").value;
  EXPECT_LT(offset.width(), 1.6 * (hull[0].hi - hull[0].lo));
}

TEST(ImplantChangesTest, SayWhichPointIsMissing) {
  const FemurFeatures headless = implant_changes(usual_landmarks(), Side::left, 0.0, {});
  EXPECT_TRUE(headless.features.empty());
  EXPECT_THAT(headless.missing, ::testing::Contains(HasSubstr("offset_change: needs the heads")));
  EXPECT_THAT(headless.missing, ::testing::Not(::testing::Contains(HasSubstr("implant_tilt"))));
}

Mesh sphere() {
  SyntheticFemur femur;
  femur.condyles = false;
  femur.shaft_length = 1.0;
  femur.neck_length = 1.0;
  femur.head_radius = 31.0;
  return mesh_of(femur, Side::right, 2.0);
}

void expect_refusal(const Mesh& mesh, const std::string& words) {
  try {
    static_cast<void>(detect_femur(mesh));
    ADD_FAILURE() << "taken for a femur: " << words;
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr(words));
    EXPECT_EQ(error.kind(), ErrorKind::input);
  }
}

TEST(DetectedFemurTest, RefusesWhatIsNoFemur) {
  expect_refusal(sphere(), "no long axis");
  expect_refusal({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}}, "no triangles");
  Mesh two = mesh_of({}, Side::right, 3.0);
  const Mesh one = two;
  for (const Point& x : one.vertices) two.vertices.push_back({x[0] + 150.0, x[1], x[2]});
  const auto count = static_cast<std::uint32_t>(one.vertices.size());
  for (const auto& [a, b, c] : one.triangles) two.triangles.push_back({a + count, b + count, c + count});
  expect_refusal(two, "several bones");
  Mesh metres = one;
  for (Point& x : metres.vertices) x = {x[0] / 1000.0, x[1] / 1000.0, x[2] / 1000.0};
  expect_refusal(metres, "no femur in millimetres");
}

/// Its condyles, of few large triangles, cover the sphere of another bone's head to 131 %.
TEST(DetectedFemurTest, RefusesAHeadThatIsCoveredTwice) {
  expect_refusal(read_mesh(places::source() + "/tests/features/coarse_bone.off"),
                 "would be covered to 131 %, more than the whole: triangles are too large to tell");
}

TEST(DetectedFemurTest, RefusesWhatNoFemurHas) {
  constexpr double step = 4.0;
  expect_refusal(mesh_of({.ccd_degrees = 172.0}, Side::right, step), "degrees, and bones have 75 to 165");
  expect_refusal(mesh_of({.neck_length = 125.0}, Side::left, step),
                 "offset (head's centre to the shaft axis) would be");
  expect_refusal(mesh_of({.head_radius = 34.0}, Side::left, step),
                 "times the head's radius of 34.0 mm, and bones have 7");
}

TEST(DetectedFemurTest, RefusesHeadsAndNecksThatAreNone) {
  const auto refused = [](const features::HeadSphere& head, double distance, const std::string& words) {
    try {
      features::check_head_and_neck(head, {{0, 0, 0}, 90.0, distance});
      EXPECT_EQ(words, "");
    } catch (const Error& error) {
      EXPECT_NE(words, "");
      EXPECT_THAT(error.what(), HasSubstr(words));
    }
  };
  refused({{1, 2, 3}, 24.0, 0.7, 100}, 24.0, "");
  refused({{1, 2, 3}, 24.0, 1.01, 100}, 24.0, "covered to 101 %");
  refused({{1, 2, 3}, 24.0, 0.7, 39}, 24.0, "that of 39 vertices, and 40 can tell it");
  refused({{1, 2, 3}, 24.0, 0.7, 100}, 18.0, "narrowest 18.0 mm from its centre");
}

TEST(LandmarkFileTest, IsReadAsItWasWritten) {
  const testing::TemporaryFolder folder;
  const LandmarkFile written{usual_landmarks(), Side::left};
  const auto path = folder.path() / "landmarks.json";
  write_landmarks(path, written);
  const LandmarkFile read = read_landmarks(path);
  EXPECT_EQ(read.landmarks, written.landmarks);
  EXPECT_EQ(read.side, written.side);
}

}  // namespace
}  // namespace verisq
