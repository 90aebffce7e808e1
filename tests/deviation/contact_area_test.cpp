/// Areas in contact contain those that geometry gives, and those of dense samples.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>
#include <verisq/distance.hpp>
#include <verisq/error.hpp>

#include "tests/deviation/brute_force.hpp"
#include "tests/fixtures/error_matchers.hpp"
#include "tests/fixtures/sample_meshes.hpp"
#include "verisq/deviation.hpp"

namespace verisq::testing {
namespace {

constexpr double pi = std::numbers::pi;

Primitive ball(double radius, const Point& centre) {
  return {"", {{radius, radius, radius}, {1.0, 1.0}}, {centre, {1.0, 0.0, 0.0, 0.0}}, {}};
}

/// A square of 20 x 20 at this height, its two triangles.
Mesh square(double height) {
  return {.vertices = {{-10, -10, height}, {10, -10, height}, {10, 10, height}, {-10, 10, height}},
          .triangles = {{0, 1, 2}, {0, 2, 3}}};
}

ContactAreaOptions within(double distance) {
  return {.distance = distance, .share_width = 0.002, .device = "host"};
}

void expect_narrow_about(const Enclosure& found, double exact, double width) {
  EXPECT_TRUE(found.contains(exact)) << exact << " in [" << found.lo << ", " << found.hi << "]";
  EXPECT_LE(found.width(), width);
}

/// Of the plane what is no farther than 2 from the ball is a disc of radius sqrt(7^2 - 6^2); of the sphere, what is no
/// farther from the plane, the cap above z = 4.
TEST(ContactArea, IsThatOfADiscAndACap) {
  ContactAreaOptions options = within(2.0);
  options.of_model = true;
  options.region_of = {0, 2};
  options.regions = 3;
  const ContactAreas found = contact_areas({"", {ball(5.0, {})}, {}}, square(6.0), options);
  expect_narrow_about(found.of_mesh.area, 400.0, 1e-9);
  expect_narrow_about(found.of_mesh.within, 13.0 * pi, 400.0 * 0.002);
  expect_narrow_about(found.of_mesh.share, 13.0 * pi / 400.0, 0.002);
  expect_narrow_about(found.by_region[0].share, 13.0 * pi / 400.0, 0.002);
  expect_narrow_about(found.by_region[2].within, 6.5 * pi, 200.0 * 0.002);
  EXPECT_EQ(found.by_region[1].area, (Enclosure{0.0, 0.0}));
  expect_narrow_about(found.of_model->area, 100.0 * pi, 3.0);
  expect_narrow_about(found.of_model->share, 0.1, 0.002);
  EXPECT_FALSE(found.interrupted);
}

/// From inside as from outside: the plane cuts the ball in a disc of radius 3, and of its points those within 1 of the
/// sphere lie between the radii 0 and sqrt(6^2 - 4^2) but for the ones that are deeper: |p| < 4 none.
TEST(ContactArea, CountsWhatLiesInside) {
  const ContactAreas found = contact_areas({"", {ball(5.0, {})}, {}}, square(4.0), within(1.0));
  expect_narrow_about(found.of_mesh.within, 20.0 * pi, 400.0 * 0.002);
}

/// The far ball is never in contact: it counts as surface, or does not.
TEST(ContactArea, OfTheCountedPrimitivesAlone) {
  const Model model{"", {ball(5.0, {}), ball(5.0, {0.0, 0.0, -30.0})}, {}};
  ContactAreaOptions options = within(2.0);
  options.of_model = true;
  expect_narrow_about(contact_areas(model, square(6.0), options).of_model->share, 0.05, 0.002);
  options.counted = {true, false};
  expect_narrow_about(contact_areas(model, square(6.0), options).of_model->share, 0.1, 0.002);
  options.counted = {false, true};
  EXPECT_EQ(contact_areas(model, square(6.0), options).of_model->share.hi, 0.0);
}

/// Two balls that overlap: what of one lies in the other is no surface. In the plane x = 0 between them they meet.
TEST(ContactArea, OfTheBoundaryOfAUnion) {
  const Model model{"", {ball(5.0, {-3.0, 0.0, 0.0}), ball(5.0, {3.0, 0.0, 0.0})}, {}};
  ContactAreaOptions options = within(2.0);
  options.of_model = true;
  options.share_width = 0.02;
  const ContactAreas found = contact_areas(model, square(6.0), options);
  // Of each sphere the cap beyond the plane is missing: 2 pi 5 (5 - 3).
  expect_narrow_about(found.of_model->area, 2.0 * (100.0 - 20.0) * pi, 60.0);
  double share = 0.0;  // by samples of the left sphere: lambda and height are even in area
  double all = 0.0;
  constexpr int steps = 400;
  for (int i = 0; i < steps; ++i) {
    const double z = 5.0 * (2.0 * (i + 0.5) / steps - 1.0);
    for (int k = 0; k < steps; ++k) {
      const double x = -3.0 + std::sqrt(25.0 - z * z) * std::cos(2.0 * pi * (k + 0.5) / steps);
      if (x > 0.0) continue;
      all += 1.0;
      if (z >= 4.0) share += 1.0;
    }
  }
  expect_narrow_about(found.of_model->share, share / all, 0.02);
}

/// A bent solid and a ball, against samples of every triangle.
TEST(ContactArea, ContainsThatOfSamples) {
  Primitive bent{"", {{3.0, 2.0, 9.0}, {0.6, 0.8}}, {{0.5, -1.0, 0.3}, {0.9, 0.2, -0.3, 0.1}}, Bend{0.05, 40.0}};
  const Model model{"", {bent, ball(4.0, {2.0, 2.0, 5.0})}, {}};
  Mesh mesh = sphere_mesh(1);
  for (Point& vertex : mesh.vertices)
    for (double& x : vertex) x *= 7.0;
  const SignedDistance distance(model);
  ContactAreaOptions options = within(1.5);
  options.share_width = 0.1;
  const ContactAreas found = contact_areas(model, mesh, options);
  double near = 0.0;
  double all = 0.0;
  for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
    const Triangle corners = corners_of(mesh, n);
    const LongPoint normal = cross(difference(widened(corners[1]), widened(corners[0])),
                                   difference(widened(corners[2]), widened(corners[0])));
    const auto weight = static_cast<double>(std::sqrt(dot(normal, normal)));
    const std::vector<Point> samples = grid_on(corners, 7);
    for (const Point& sample : samples) {
      const double each = weight / static_cast<double>(samples.size());
      all += each;
      if (std::abs(distance(sample, 1e-3).hi) <= 1.5) near += each;
    }
  }
  constexpr double of_samples = 0.01;
  EXPECT_GE(near / all, found.of_mesh.share.lo - of_samples);
  EXPECT_LE(near / all, found.of_mesh.share.hi + of_samples);
  EXPECT_LE(found.of_mesh.share.width(), 0.1);
}

TEST(ContactArea, EndsWithWhatIsProven) {
  ContactAreaOptions options = within(2.0);
  options.of_model = true;
  options.most_samples = 1;
  const ContactAreas few = contact_areas({"", {ball(5.0, {})}, {}}, square(6.0), options);
  EXPECT_TRUE(few.of_mesh.share.contains(13.0 * pi / 400.0));
  EXPECT_TRUE(few.of_model->share.contains(0.1));
  options.interrupted = [] { return true; };
  const ContactAreas none = contact_areas({"", {ball(5.0, {})}, {}}, square(6.0), options);
  EXPECT_TRUE(none.interrupted);
  EXPECT_TRUE(none.of_mesh.share.contains(13.0 * pi / 400.0));
}

TEST(ContactArea, RefusesWhatHasNone) {
  const Model model{"", {ball(5.0, {})}, {}};
  const auto refused = [&](const Mesh& mesh, const ContactAreaOptions& options) {
    EXPECT_THROW((void)contact_areas(model, mesh, options), Error);
  };
  refused({.vertices = {{0, 0, 0}}, .triangles = {}}, within(1.0));
  refused(square(6.0), within(-1.0));
  ContactAreaOptions regions = within(1.0);
  regions.region_of = {0};
  regions.regions = 1;
  refused(square(6.0), regions);
  ContactAreaOptions counted = within(1.0);
  counted.counted = {true, false};
  refused(square(6.0), counted);
}

}  // namespace
}  // namespace verisq::testing
