/// The known answers of examples/cavity.off: what README says of it, and what follows from how it was made.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>
#include <verisq/distance.hpp>
#include <verisq/files.hpp>
#include <verisq/mesh_topology.hpp>

#include "tests/fixtures/places.hpp"
#include "tests/fixtures/program_test.hpp"

namespace verisq::testing {
namespace {

constexpr double gap = 2.0;         // mm
constexpr double rounding = 1e-11;  // mm: how far the generator may miss the gap

const std::string implant = places::example("stem_mm.json");
const std::string cavity = places::example("cavity.off");

class CavityExample : public ProgramTest {
 protected:
  /// Of all vertices, while the implant moves down into its seat along the z axis, the last `length` of its way.
  [[nodiscard]] std::vector<Row> insertion(double length, double tolerance) const {
    const Outcome outcome =
        run({"insert", "--implant", implant, "--mesh", cavity, "--along", "0,0,-1", "--length", std::to_string(length),
             "--tol", std::to_string(tolerance), "--device", "host", "-o", path("way.csv")});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return rows_of(path("way.csv"));
  }
};

TEST_F(CavityExample, IsTheGapAwayFromTheImplantAtEveryVertex) {
  const Mesh mesh = read_mesh(cavity);
  ASSERT_EQ(mesh.vertices.size(), 786U);
  const SignedDistance distance(read_model(implant));
  for (const Point& vertex : mesh.vertices) {
    const Enclosure enclosure = distance(vertex, 0.0);
    EXPECT_NEAR(enclosure.lo, gap, rounding);
    EXPECT_NEAR(enclosure.hi, gap, rounding);
  }
}

TEST_F(CavityExample, BoundsOneSolidWithoutHoles) {
  const Mesh mesh = read_mesh(cavity);
  const MeshTopology topology = mesh_topology(mesh);
  EXPECT_TRUE(topology.bounds_solid());
  EXPECT_EQ(topology.components, 1U);
  EXPECT_EQ(topology.genus(), 0);
  EXPECT_GT(signed_volume(mesh), 0.0);
}

TEST_F(CavityExample, IsWhatItsGeneratorMakes) {
  const Outcome outcome = Process({places::cavity_generator(), implant, "2", path("again.off")}, folder_.path()).wait();
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Mesh shipped = read_mesh(cavity);
  const Mesh again = read_mesh(path("again.off"));
  EXPECT_EQ(again.triangles, shipped.triangles);
  ASSERT_EQ(again.vertices.size(), shipped.vertices.size());
  for (std::size_t n = 0; n < again.vertices.size(); ++n) {
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(again.vertices[n][k], shipped.vertices[n][k], 1e-9) << n;
  }
}

TEST_F(CavityExample, IsMappedToTheGap) {
  const Outcome outcome = run({"map", "--model", implant, "--mesh", cavity, "-o", path("map.csv")});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const std::vector<Row> rows = rows_of(path("map.csv"));
  ASSERT_EQ(rows.size(), 786U);
  for (const Row& row : rows) {
    EXPECT_LE(row.distance.lo, gap + rounding);
    EXPECT_GE(row.distance.hi, gap - rounding);
  }
}

TEST_F(CavityExample, IsApproachedByNoMoreThanTheWayOfTheImplant) {
  constexpr double length = 1.5;
  const std::vector<Row> rows = insertion(length, 0.01);
  ASSERT_EQ(rows.size(), 786U);
  for (const Row& row : rows) {
    EXPECT_LE(row.distance.lo, gap + rounding);
    EXPECT_GE(row.distance.hi, gap - length - rounding);
  }
  // The last vertex lies above the head, a ball, which comes closest where the way begins.
  const Point pole = read_mesh(cavity).vertices.back();
  const Primitive head = read_model(implant).primitives.back();
  const Point& centre = head.pose.translation;
  const double exact = std::hypot(pole[0] - centre[0], pole[1] - centre[1], pole[2] - centre[2] - length) -
                       head.superquadric.semi_axes[0];
  EXPECT_LT(exact, 0.55);
  EXPECT_LE(rows.back().distance.width(), 0.01);
  EXPECT_LE(rows.back().distance.lo, exact + rounding);
  EXPECT_GE(rows.back().distance.hi, exact - rounding);
}

TEST_F(CavityExample, IsCutByAnImplantFromOutside) {
  constexpr double length = 300.0;  // more than the cavity is high
  const std::vector<Row> rows = insertion(length, 1.0);
  ASSERT_EQ(rows.size(), 786U);
  // The middle of the head, a ball, passes the vertex above it at this distance, so that it is as deep inside at least.
  const Point pole = read_mesh(cavity).vertices.back();
  const Primitive head = read_model(implant).primitives.back();
  const double beside = std::hypot(pole[0] - head.pose.translation[0], pole[1] - head.pose.translation[1]);
  EXPECT_LE(rows.back().distance.lo, beside - head.superquadric.semi_axes[0] + rounding);
  EXPECT_LT(rows.back().distance.hi, -10.0);
}

}  // namespace
}  // namespace verisq::testing
