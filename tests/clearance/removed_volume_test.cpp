/// Removed volumes against closed forms, and against lattices of points that know nothing of the proof.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/fixtures/error_matchers.hpp"
#include "tests/fixtures/removals.hpp"
#include "tests/oracle/random_cases.hpp"
#include "verisq/insertion.hpp"

namespace verisq::oracle {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using std::numbers::pi;
using verisq::testing::capsule_beyond;
using verisq::testing::counted_volume;
using verisq::testing::expect_error;
using verisq::testing::point_of;
using verisq::testing::rotation_of;
using verisq::testing::Screw;
using verisq::testing::shaft_and_neck;
using verisq::testing::turned_ball;
using verisq::testing::turned_box;

Model model_of(std::vector<Primitive> primitives) {
  return {"mm", std::move(primitives), {}};
}

std::array<double, 4> random_quaternion(RandomCases& random) {
  std::array<double, 4> q;
  for (double& x : q) x = random.uniform(-1.0, 1.0);
  return q;
}

Vector3d random_direction(RandomCases& random) {
  return Vector3d(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)).normalized();
}

void expect_encloses(const RemovedVolume& found, double exact, double relative_width) {
  const double rounding = 1e-12 * exact;
  EXPECT_LE(found.volume.lo, exact + rounding);
  EXPECT_GE(found.volume.hi, exact - rounding);
  EXPECT_LE(found.volume.width(), relative_width * found.volume.lo);
  EXPECT_TRUE(found.within_tolerance);
}

RemovedVolume removed(const std::vector<Pose>& path, const Model& implant, const BoneRegion& bone, double relative) {
  return removed_volume(path, implant, bone, {.relative_tolerance = relative});
}

TEST(RemovedVolume, OfAnEllipsoidAlongALineIsItsVolumeAndThatOfItsShadow) {
  RandomCases random(1);
  for (int n = 0; n < 12; ++n) {
    Primitive ellipsoid = turned_ball({random.uniform(-3.0, 3.0), 1.0, 2.0}, 1.0);
    for (double& a : ellipsoid.superquadric.semi_axes) a = random.uniform(0.5, 3.0);
    ellipsoid.pose.quaternion = random_quaternion(random);
    const Vector3d along = random_direction(random);
    const double length = random.uniform(0.5, 10.0);
    const Pose last{{1.0, -2.0, 0.5}, random_quaternion(random)};
    const Vector3d own =
        rotation_of(ellipsoid.pose.quaternion).inverse() * (rotation_of(last.quaternion).inverse() * along);
    const auto& [a, b, c] = ellipsoid.superquadric.semi_axes;
    const double shadow = pi * Vector3d(b * c * own[0], a * c * own[1], a * b * own[2]).norm();
    const double exact = 4.0 / 3.0 * pi * a * b * c + length * shadow;
    expect_encloses(removed(straight_path(last, point_of(along), length, 1), model_of({ellipsoid}), {}, 0.05), exact,
                    0.05);
  }
}

/// Of one quarter of (x/a)^(2/e) + (y/b)^(2/e) <= 1, without a b.
double quarter(double e) {
  return std::tgamma(1.0 + e / 2.0) * std::tgamma(1.0 + e / 2.0) / std::tgamma(1.0 + e);
}

TEST(RemovedVolume, OfASuperquadricAlongItsAxisIsItsVolumeAndThatOfItsSection) {
  RandomCases random(2);
  for (int n = 0; n < 6; ++n) {
    const double e1 = random.uniform(0.2, 1.9);
    const double e2 = random.uniform(0.2, 1.9);
    Primitive primitive = turned_ball({}, 1.0);
    primitive.superquadric = {{2.0, 1.0, 3.0}, {e1, e2}};
    primitive.pose.quaternion = random_quaternion(random);
    const Vector3d axis = rotation_of(primitive.pose.quaternion) * Vector3d::UnitZ();
    const double section = 4.0 * 2.0 * 1.0 * quarter(e2);
    // Sections at z scale by (1 - (z/3)^(2/e1))^e1.
    const double heights =
        2.0 * 3.0 * std::tgamma(1.0 + e1 / 2.0) * std::tgamma(1.0 + e1) / std::tgamma(1.0 + 1.5 * e1);
    expect_encloses(removed(straight_path({}, point_of(axis), 5.0, 1), model_of({primitive}), {}, 0.1),
                    section * (heights + 5.0), 0.1);
  }
}

TEST(RemovedVolume, OfABallThatCirclesIsThatOfATube) {
  std::vector<Pose> path;
  for (const double angle : {0.0, 0.5, 1.2})
    path.push_back({{}, {std::cos(angle / 2.0), 0.0, 0.0, std::sin(angle / 2.0)}});
  expect_encloses(removed(path, model_of({turned_ball({5.0, 0.0, 0.0}, 1.0)}), {}, 0.1),
                  4.0 / 3.0 * pi + 5.0 * 1.2 * pi, 0.1);
}

TEST(RemovedVolume, OfAPoseAloneIsTheVolumeOfTheUnion) {
  // Two balls of radius 1 whose centres are 1 apart share a lens of 5 pi / 12.
  const Model two = model_of({turned_ball({}, 1.0), turned_ball({1.0, 0.0, 0.0}, 1.0)});
  expect_encloses(removed({Pose{}}, two, {}, 0.02), 8.0 / 3.0 * pi - 5.0 / 12.0 * pi, 0.02);
}

class InBone : public ::testing::Test {
 protected:
  const Quaterniond turn_ = Quaterniond(0.8, 0.3, -0.4, 0.2).normalized();
  const Vector3d origin_{3.0, -2.0, 1.0};
  /// Along the turned x, so far from the corner along the turned y and z.
  [[nodiscard]] std::vector<Pose> path(double y, double z) const {
    const Vector3d last = origin_ + turn_ * Vector3d(20.0, y, z);
    return straight_path({point_of(last)}, point_of(turn_ * Vector3d::UnitX()), 6.0, 1);
  }
  [[nodiscard]] BoneRegion box(BoneSide side) const {
    return {{{turned_box(origin_, turn_, {40.0, 40.0, 40.0}), side}}, {}};
  }
  const Model ball_ = model_of({turned_ball({}, 1.0)});
  const double whole_ = 4.0 / 3.0 * pi + 6.0 * pi;
};

TEST_F(InBone, WhatLiesBeyondItsFaceIsNone) {
  const auto at_face = path(20.0, 0.3);
  expect_encloses(removed(at_face, ball_, box(BoneSide::inside), 0.05), whole_ - capsule_beyond(0.3), 0.05);
  expect_encloses(removed(at_face, ball_, box(BoneSide::outside), 0.05), capsule_beyond(0.3), 0.05);
  const Vector3d above = turn_ * Vector3d(0.0, 0.0, 2.5);
  expect_encloses(removed(at_face, ball_, {{}, Plane{point_of(origin_), point_of(above)}}, 0.05), capsule_beyond(0.3),
                  0.05);
}

TEST_F(InBone, AnEdgeOfAWedgeIsExact) {
  const auto at_edge = path(0.0, 0.0);
  const RemovedVolume quarter = removed(at_edge, ball_, box(BoneSide::inside), 0.05);
  expect_encloses(quarter, whole_ / 4.0, 0.05);
  const RemovedVolume rest = removed(at_edge, ball_, box(BoneSide::outside), 0.05);
  expect_encloses(rest, 0.75 * whole_, 0.05);
}

TEST_F(InBone, ACornerIsAnEighth) {
  const std::vector<Pose> at_corner{{point_of(origin_)}};
  expect_encloses(removed(at_corner, ball_, box(BoneSide::inside), 0.05), pi / 6.0, 0.05);
}

TEST_F(InBone, ACavityAndAnOuterSurfaceBoundItTogether) {
  // A shell between 0.3 above the axis and 0.5 below it.
  const auto at_face = path(20.0, 0.3);
  BoneRegion shell = box(BoneSide::outside);
  shell.surfaces.push_back(
      {turned_box(origin_ + turn_ * Vector3d(0.0, 0.0, -0.2), turn_, {40.0, 40.0, 30.0}), BoneSide::inside});
  expect_encloses(removed(at_face, ball_, shell, 0.05), capsule_beyond(0.3) - capsule_beyond(0.5), 0.05);
}

TEST_F(InBone, AnOpenSurfaceIsClosedOverItsRimsAndFacesEitherWay) {
  const auto at_face = path(20.0, 0.3);
  BoneRegion bone = box(BoneSide::inside);
  Mesh& mesh = bone.surfaces[0].mesh;
  mesh.triangles.erase(mesh.triangles.begin() + 10, mesh.triangles.end());
  for (auto& [a, b, c] : mesh.triangles) std::swap(b, c);
  const RemovedVolume found = removed(at_face, ball_, bone, 0.05);
  expect_encloses(found, whole_ - capsule_beyond(0.3), 0.05);
  EXPECT_THAT(found.rims, ::testing::ElementsAre(1U));
}

TEST_F(InBone, WhereNothingIsCutNothingIsRemoved) {
  const auto beside = path(20.0, -1.5);
  const RemovedVolume found =
      removed_volume(beside, ball_, box(BoneSide::inside), {.relative_tolerance = 0.0, .tolerance = 1e-6});
  EXPECT_EQ(found.volume.lo, 0.0);
  EXPECT_LE(found.volume.hi, 1e-6);
  EXPECT_TRUE(found.within_tolerance);
}

TEST(RemovedVolume, OfAScrewIsWhatALatticeCounts) {
  const Model stem = shaft_and_neck();
  const Screw screw;
  const RemovedVolume found = removed(screw.path(), stem, {{}, Plane{{}, {0.0, 0.0, -1.0}}}, 0.05);
  EXPECT_TRUE(found.within_tolerance);
  const double counted = counted_volume(stem, screw, 0.25);
  EXPECT_GE(counted, found.volume.lo);
  EXPECT_LE(counted, found.volume.hi);
}

TEST(RemovedVolume, IsValidWhereItEndsEarly) {
  const auto path = straight_path({}, {0.0, 0.0, 1.0}, 6.0, 1);
  const Model one = model_of({turned_ball({}, 1.0)});
  const double exact = 4.0 / 3.0 * pi + 6.0 * pi;
  RemovedVolumeOptions options{.relative_tolerance = 0.0, .most_cubes = 2000};
  const RemovedVolume few = removed_volume(path, one, {}, options);
  EXPECT_TRUE(few.volume.contains(exact));
  EXPECT_FALSE(few.within_tolerance);
  EXPECT_FALSE(few.interrupted);
  int asked = 0;
  options.interrupted = [&] { return ++asked > 5; };
  const RemovedVolume ended = removed_volume(path, one, {}, options);
  EXPECT_TRUE(ended.volume.contains(exact));
  EXPECT_TRUE(ended.interrupted);
}

TEST(RemovedVolume, RefusesWhatHasNone) {
  const std::vector<Pose> rest{Pose{}};
  Model bent = model_of({turned_ball({}, 1.0)});
  bent.primitives[0].bend = Bend{0.1, 0.0};
  const auto refused = [](const auto& action, const std::string& file, const std::string& why) {
    expect_error(action, ErrorKind::input, file, why);
  };
  refused([&] { (void)removed(rest, bent, {}, 0.1); }, "removed volume",
          ": only of unions of convex primitives, without a bend");
  const Model one = model_of({turned_ball({}, 1.0)});
  refused([&] { (void)removed({}, one, {}, 0.1); }, "the path", " has no pose");
  refused([&] { (void)removed(rest, one, {}, -0.1); }, "removed volume",
          ": tolerance -0.1 is not a number of at least 0");
  refused(
      [&] {
        (void)removed(rest, one, {{}, Plane{{}, {}}}, 0.1);
      },
      "removed volume", ": the resection's point or normal is not finite, or the normal is zero");
  const BoneRegion cloud{{{Mesh{{{0.0, 0.0, 0.0}}, {}}, BoneSide::inside}}, {}};
  refused([&] { (void)removed(rest, one, cloud, 0.1); }, "has no triangles", ", so that it has no sides");
  const Mesh cavity = turned_box({-2.0, -2.0, -2.0}, Eigen::Quaterniond::Identity(), {4.0, 4.0, 4.0});
  const Mesh beside = turned_box({2.5, -9.0, -9.0}, Eigen::Quaterniond::Identity(), {18.0, 18.0, 18.0});
  refused(
      [&] {
        (void)removed(rest, one, {{{cavity, BoneSide::outside}, {beside, BoneSide::inside}}, {}}, 0.1);
      },
      "nothing of the cavity's surface",
      " is inside of the bone's outer surface: it lies beside the bone, or around it. Are both of one bone, in the "
      "same "
      "coordinates?");
  // A bar through the bone, whose corners are all outside of it; and through a plate, thin beside its triangles.
  const Mesh bar = turned_box({-4.0, -1.0, -1.0}, Eigen::Quaterniond::Identity(), {8.0, 2.0, 2.0});
  for (const double thickness : {6.0, 1e-3}) {
    const Mesh crossed =
        turned_box({-0.5 * thickness, -3.0, -3.0}, Eigen::Quaterniond::Identity(), {thickness, 6.0, 6.0});
    const BoneRegion bone{{{bar, BoneSide::outside}, {crossed, BoneSide::inside}}, {}};
    EXPECT_EQ(removed(rest, one, bone, 0.1).volume.lo, 0.0) << thickness;
  }
  const std::vector<Pose> far{{{1e200, 0.0, 0.0}}};
  refused([&] { (void)removed(far, one, {}, 0.1); }, "removed volume",
          ": the implant's size, its path or its place leave no exact cubes");
}

}  // namespace
}  // namespace verisq::oracle
