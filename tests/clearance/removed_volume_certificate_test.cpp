/// What an implant takes away is proved again from its cubes, and no forgery of them is.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <numbers>
#include <string>
#include <vector>
#include <verisq/deviation.hpp>

#include "tests/fixtures/error_matchers.hpp"
#include "tests/fixtures/removals.hpp"
#include "tests/fixtures/requested_count.hpp"
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
using verisq::testing::Screw;
using verisq::testing::shaft_and_neck;
using verisq::testing::turned_ball;
using verisq::testing::turned_box;

/// A way in, and how much bone it takes away in truth.
struct Removal {
  std::string name;
  Model implant;
  std::vector<Pose> path;
  BoneRegion bone;
  double exact;
};

const Quaterniond turn_of_box = Quaterniond(0.8, 0.3, -0.4, 0.2).normalized();
const Vector3d corner_of_box(3.0, -2.0, 1.0);

/// A ball of radius 1 moves by 6 along the turned x, at this height above a face of the box, far from its edges.
Removal along_face(const std::string& name, double height, BoneRegion bone, double exact) {
  const Vector3d last = corner_of_box + turn_of_box * Vector3d(20.0, 20.0, height);
  return {name,
          {"mm", {turned_ball({}, 1.0)}, {}},
          straight_path({point_of(last)}, point_of(turn_of_box * Vector3d::UnitX()), 6.0, 1),
          std::move(bone),
          exact};
}

BoneSurface box_of_bone(BoneSide side, double below = 0.0) {
  return {turned_box(corner_of_box - turn_of_box * Vector3d(0.0, 0.0, below), turn_of_box, {40.0, 40.0, 40.0}), side};
}

std::vector<Removal> removals() {
  const double whole = 4.0 / 3.0 * pi + 6.0 * pi;
  std::vector<Pose> circle;
  for (const double angle : {0.0, 0.5, 1.2})
    circle.push_back({{}, {std::cos(angle / 2.0), 0.0, 0.0, std::sin(angle / 2.0)}});
  Removal at_edge = along_face("at an edge", 0.0, {{box_of_bone(BoneSide::inside)}, {}}, whole / 4.0);
  for (Pose& pose : at_edge.path) {
    const Vector3d shift = turn_of_box * Vector3d(0.0, -20.0, 0.0);
    for (std::size_t i = 0; i < 3; ++i) pose.translation[i] += shift[static_cast<int>(i)];
  }
  const Vector3d above = turn_of_box * Vector3d(0.0, 0.0, 2.5);
  BoneSurface open_inward = box_of_bone(BoneSide::inside);
  open_inward.mesh.triangles.resize(10);
  for (auto& [a, b, c] : open_inward.mesh.triangles) std::swap(b, c);
  return {
      along_face("in an open surface that faces inward", 0.3, {{open_inward}, {}}, whole - capsule_beyond(0.3)),
      {"at a corner",
       {"mm", {turned_ball({}, 1.0)}, {}},
       {{point_of(corner_of_box)}},
       {{box_of_bone(BoneSide::inside)}, {}},
       pi / 6.0},

      along_face("in bone", 0.3, {{box_of_bone(BoneSide::inside)}, {}}, whole - capsule_beyond(0.3)),
      along_face("in a shell", 0.3, {{box_of_bone(BoneSide::outside), box_of_bone(BoneSide::inside, 0.2)}, {}},
                 capsule_beyond(0.3) - capsule_beyond(0.5)),
      at_edge,
      along_face("before a resection", 0.3, {{}, Plane{point_of(corner_of_box), point_of(above)}}, capsule_beyond(0.3)),
      {"on a circle", {"mm", {turned_ball({5.0, 0.0, 0.0}, 1.0)}, {}}, circle, {}, 4.0 / 3.0 * pi + 5.0 * 1.2 * pi},
      {"two balls at rest",
       {"mm", {turned_ball({}, 1.0), turned_ball({1.0, 0.0, 0.0}, 1.0)}, {}},
       {Pose{}},
       {},
       8.0 / 3.0 * pi - 5.0 / 12.0 * pi}};
}

struct CertifiedRemoval {
  RemovedVolume found;
  CertifiedRemovedVolume certified;
};

CertifiedRemoval certified(const Removal& removal, double relative) {
  RemovedVolume found = removed_volume(removal.path, removal.implant, removal.bone, {.relative_tolerance = relative});
  CertifiedRemovedVolume certified = certified_removed_volume(removal.path, removal.implant, removal.bone, found, {});
  return {std::move(found), std::move(certified)};
}

ProvenRemovedVolume checked(const Removal& removal, const RemovedVolumeCertificate& certificate) {
  return RemovedVolumeChecker(removal.implant, removal.path, removal.bone)(certificate, {});
}

TEST(RemovedVolumeCertificate, ProvesWhatWasFoundAsClosely) {
  for (const Removal& removal : removals()) {
    const auto [found, proof] = certified(removal, 0.1);
    std::cout << removal.name << ": exact " << removal.exact << ", found [" << found.volume.lo << ", "
              << found.volume.hi << "], proved [" << proof.volume.lo << ", " << proof.volume.hi << "], "
              << proof.certificate.cubes.size() << " cubes\n";
    EXPECT_LE(proof.volume.lo, removal.exact * (1.0 + 1e-12)) << removal.name;
    EXPECT_GE(proof.volume.hi, removal.exact * (1.0 - 1e-12)) << removal.name;
    EXPECT_LE(proof.volume.width(), 1.1 * found.volume.width()) << removal.name;
    EXPECT_EQ(check(proof.volume, checked(removal, proof.certificate).volume).verdict, Verdict::proved);
  }
}

/// Of bone above z = 0; how much is not known.
Removal screw_of(Model implant) {
  return {"a screw", std::move(implant), Screw().path(), {{}, Plane{{}, {0.0, 0.0, -1.0}}}, 0.0};
}

TEST(RemovedVolumeCertificate, OfAScrewContainsWhatALatticeCounts) {
  Removal removal = screw_of(shaft_and_neck());
  removal.exact = counted_volume(removal.implant, Screw(), 0.35);
  const auto [found, proof] = certified(removal, 0.15);
  std::cout << "counted " << removal.exact << ", found [" << found.volume.lo << ", " << found.volume.hi << "], proved ["
            << proof.volume.lo << ", " << proof.volume.hi << "]\n";
  EXPECT_GE(removal.exact, proof.volume.lo);
  EXPECT_LE(removal.exact, proof.volume.hi);
  EXPECT_LE(proof.volume.width(), 1.3 * found.volume.width());
}

/// No closed form: but what the search says, by other formulas.
TEST(RemovedVolumeCertificate, OfTaperedImplantsAgreesWithTheSearch) {
  Removal removal = screw_of(shaft_and_neck());
  removal.implant.primitives[0].superquadric.taper = 1.8;
  removal.implant.primitives[1].superquadric.taper = 0.6;
  const auto [found, proof] = certified(removal, 0.5);
  EXPECT_LE(proof.volume.lo, found.volume.hi);
  EXPECT_GE(proof.volume.hi, found.volume.lo);
  EXPECT_LE(proof.volume.width(), found.volume.width());
  EXPECT_EQ(check(proof.volume, checked(removal, proof.certificate).volume).verdict, Verdict::proved);
}

/// Certificates that are another one's, or no one's.
class ForgedCubes {
 public:
  ForgedCubes(RemovedVolumeCertificate own, std::uint64_t seed) : own_(std::move(own)), random_(seed) {}

  RemovedVolumeCertificate operator()(std::size_t kind) {
    RemovedVolumeCertificate forged = own_;
    const double width = own_.half_width;
    auto& cubes = forged.cubes;
    switch (kind % 16) {
      case 0: break;
      case 1: flip(cubes, 1); break;
      case 2: flip(cubes, 20); break;
      case 3: cubes.resize(index(cubes)); break;
      case 4: cubes.assign(1, CubeDivision::none); break;
      case 5: cubes.push_back(CubeDivision::none); break;
      case 6: cubes.erase(cubes.begin() + static_cast<std::ptrdiff_t>(index(cubes))); break;
      case 7: forged.centre[kind % 3] += width * random_.uniform(-1.0, 1.0); break;
      case 8: forged.half_width = width / 2.0; break;
      case 9: forged.half_width = width * random_.uniform(0.1, 3.0); break;
      case 10: std::ranges::reverse(cubes); break;
      case 11: forged.half_width = odd_widths_[kind / 16 % odd_widths_.size()]; break;
      case 12: join(cubes, 30); break;
      case 13: divide(cubes, 100); break;
      case 14: join(cubes, 5), divide(cubes, 30); break;
      default: forged.half_width = 2.0 * width, forged.centre[kind % 3] += 0.7 * width; break;
    }
    return forged;
  }

 private:
  std::size_t index(const std::vector<CubeDivision>& cubes) {
    return static_cast<std::size_t>(random_.uniform(0.0, 1.0) * static_cast<double>(cubes.size() - 1));
  }

  void flip(std::vector<CubeDivision>& cubes, int count) {
    for (int n = 0; n < count; ++n) {
      CubeDivision& cube = cubes[index(cubes)];
      cube = cube == CubeDivision::none ? CubeDivision::divided : CubeDivision::none;
    }
  }

  /// Cubes that are divided into undivided ones no more.
  void join(std::vector<CubeDivision>& cubes, int count) {
    for (int n = 0; n < count; ++n) {
      const std::size_t at = index(cubes);
      const auto octants = cubes.begin() + static_cast<std::ptrdiff_t>(at) + 1;
      if (cubes[at] == CubeDivision::none || cubes.end() - octants < 8) continue;
      if (std::ranges::count(octants, octants + 8, CubeDivision::none) < 8) continue;
      cubes[at] = CubeDivision::none;
      cubes.erase(octants, octants + 8);
    }
  }

  /// Undivided ones divided.
  void divide(std::vector<CubeDivision>& cubes, int count) {
    for (int n = 0; n < count; ++n) {
      const std::size_t at = index(cubes);
      if (cubes[at] == CubeDivision::divided) continue;
      cubes[at] = CubeDivision::divided;
      cubes.insert(cubes.begin() + static_cast<std::ptrdiff_t>(at) + 1, 8, CubeDivision::none);
    }
  }

  static constexpr std::array<double, 8> odd_widths_{
      0.0, -1.0, 1e-320, 1e300, 0x1p-1074, infinity, -infinity, std::numeric_limits<double>::quiet_NaN()};

  RemovedVolumeCertificate own_;
  RandomCases random_;
};

/// Ends that do not contain the truth, which is rounded by less than 1e-13 of itself.
std::vector<Enclosure> untrue_claims(double exact) {
  const double below = exact * (1.0 - 1e-12);
  const double above = exact * (1.0 + 1e-12);
  return {{0.0, below}, {exact * 0.99, below}, {above, exact * 1.01}, {above, infinity}, {above, below}, {-1.0, 0.0}};
}

TEST(RemovedVolumeCertificate, NeverProvesAForgery) {
  const std::size_t of_each = requested_count("VERISQ_FORGED_REMOVALS", 16);
  std::size_t tried = 0;
  std::size_t valid = 0;
  for (const Removal& removal : removals()) {
    const RemovedVolumeChecker check_removal(removal.implant, removal.path, removal.bone);
    ForgedCubes forge(certified(removal, 0.3).certified.certificate, 5);
    for (std::size_t kind = 0; kind < of_each; ++kind) {
      const Enclosure proven = check_removal(forge(kind), {}).volume;
      EXPECT_LE(proven.lo, removal.exact * (1.0 + 1e-12)) << removal.name << ' ' << kind;
      EXPECT_GE(proven.hi, removal.exact * (1.0 - 1e-12)) << removal.name << ' ' << kind;
      valid += proven.hi < infinity ? 1 : 0;
      for (const Enclosure& claim : untrue_claims(removal.exact)) {
        EXPECT_NE(check(claim, proven).verdict, Verdict::proved) << removal.name << ' ' << kind;
        ++tried;
      }
    }
  }
  std::cout << "forged: " << tried << ", of cubes that prove something from above: " << valid << "\n";
  EXPECT_GE(tried, 48U * of_each);
}

/// A larger implant, another way, the other side, bone elsewhere.
std::vector<Removal> others_than(const Removal& removal, std::size_t axis, RandomCases& random) {
  std::vector<Removal> others(4, removal);
  for (Primitive& primitive : others[0].implant.primitives)
    primitive.superquadric.semi_axes[axis] *= random.uniform(1.1, 1.3);
  for (Pose& pose : others[1].path) pose.translation[2] *= random.uniform(0.3, 0.9);
  if (removal.path.size() > 1) others[1].path.pop_back();
  for (BoneSurface& surface : others[2].bone.surfaces)
    surface.bone = surface.bone == BoneSide::inside ? BoneSide::outside : BoneSide::inside;
  for (BoneSurface& surface : others[3].bone.surfaces)
    for (Point& vertex : surface.mesh.vertices) vertex[0] += 50.0;
  return others;
}

/// Whether it is: a claim may be true of another case, too.
bool is_untrue_of(const Removal& other, const Enclosure& claim) {
  const RemovedVolume truth = removed_volume(other.path, other.implant, other.bone, {.relative_tolerance = 0.2});
  return claim.lo > truth.volume.hi || truth.volume.lo > claim.hi;
}

/// Of the same cubes, and the claim that is proved of the case itself.
TEST(RemovedVolumeCertificate, IsOfNoOtherImplantWayOrBone) {
  const std::size_t of_each = requested_count("VERISQ_FORGED_REMOVAL_CASES", 1);
  RandomCases random(17);
  std::size_t tried = 0;
  for (const Removal& removal : removals()) {
    const CertifiedRemovedVolume own = certified(removal, 0.1).certified;
    for (std::size_t n = 0; n < of_each; ++n) {
      for (const Removal& other : others_than(removal, n % 3, random)) {
        if (!is_untrue_of(other, own.volume)) continue;
        EXPECT_NE(check(own.volume, checked(other, own.certificate).volume).verdict, Verdict::proved) << removal.name;
        ++tried;
      }
    }
  }
  std::cout << "other cases: " << tried << "\n";
  EXPECT_GE(tried, 8U * of_each);
}

TEST(RemovedVolumeCertificate, SaysNothingOnceInterrupted) {
  const Removal removal = removals().front();
  const auto proof = certified(removal, 0.1).certified;
  int asked = 0;
  const ProvenRemovedVolume ended = RemovedVolumeChecker(removal.implant, removal.path, removal.bone)(
      proof.certificate, {.interrupted = [&] { return ++asked > 20; }});
  EXPECT_TRUE(ended.interrupted);
  EXPECT_EQ(ended.volume, (Enclosure{0.0, infinity}));
}

TEST(RemovedVolumeCertificate, BearsDeepAndWideTrees) {
  const Removal removal = removals().front();
  RemovedVolumeCertificate deep = certified(removal, 0.3).certified.certificate;
  for (const std::size_t levels : {20, 63, 64, 65, 100'000}) {
    deep.cubes.assign(levels, CubeDivision::divided);
    deep.cubes.insert(deep.cubes.end(), 7 * levels + 1, CubeDivision::none);
    const ProvenRemovedVolume proven = checked(removal, deep);
    EXPECT_LE(proven.volume.lo, removal.exact);
    EXPECT_GE(proven.volume.hi, removal.exact);
    EXPECT_EQ(proven.volume.hi < infinity, levels <= 64) << levels;
  }
}

TEST(RemovedVolumeCertificate, RefusesWhatHasNone) {
  const Removal removal = removals().front();
  const auto refused = [&](Model implant, std::vector<Pose> path, BoneRegion bone, const std::string& file,
                           const std::string& why) {
    expect_error([&] { (void)RemovedVolumeChecker(implant, path, bone); }, ErrorKind::input, file, why);
  };
  Model bent = removal.implant;
  bent.primitives[0].bend = Bend{0.1, 0.0};
  EXPECT_THROW((void)RemovedVolumeChecker(bent, removal.path, removal.bone), Error);
  refused(removal.implant, {}, removal.bone, "the path", " has no pose");
  refused(removal.implant, removal.path, {{}, Plane{{}, {}}}, "removed volume",
          ": the resection's point or normal is not finite, or the normal is zero");
  BoneRegion torn = removal.bone;
  std::swap(torn.surfaces[0].mesh.triangles[3][0], torn.surfaces[0].mesh.triangles[3][1]);
  refused(removal.implant, removal.path, torn, "removed volume", ": a surface that its rims do not close");
  BoneRegion flat = removal.bone;
  flat.surfaces[0].mesh.triangles.resize(1);
  refused(removal.implant, removal.path, flat, "removed volume",
          ": a surface that encloses nothing, as far as can be proven");
  BoneRegion cloud = removal.bone;
  cloud.surfaces[0].mesh.triangles.clear();
  refused(removal.implant, removal.path, cloud, "removed volume",
          ": a surface that encloses nothing, as far as can be proven");
  refused(removal.implant, removal.path, {{{}}, {}}, "removed volume", ": a surface without triangles");
  const Mesh cavity = turned_box({0.0, 0.0, 0.0}, Eigen::Quaterniond::Identity(), {1.0, 1.0, 1.0});
  const Mesh beside = turned_box({2.0, 0.0, 0.0}, Eigen::Quaterniond::Identity(), {1.0, 1.0, 1.0});
  BoneRegion elsewhere = removal.bone;
  elsewhere.surfaces = {{cavity, BoneSide::outside}, {beside, BoneSide::inside}};
  refused(removal.implant, removal.path, elsewhere, "nothing of the cavity's surface",
          " is inside of the bone's outer surface: it lies beside the bone, or around it. Are both of one bone, in the "
          "same coordinates?");
}

}  // namespace
}  // namespace verisq::oracle
