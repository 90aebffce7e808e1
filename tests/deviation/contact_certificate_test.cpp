/// Certificates of areas in contact prove what was found, and never what is false. VERISQ_FORGED_CONTACTS says how many
/// changes of each case are tried.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>
#include <verisq/distance.hpp>
#include <verisq/error.hpp>

#include "host/threads/parallel.hpp"
#include "tests/deviation/brute_force.hpp"
#include "tests/fixtures/forged_numbers.hpp"
#include "tests/fixtures/forged_samples.hpp"
#include "tests/fixtures/forgeries.hpp"
#include "tests/fixtures/requested_count.hpp"
#include "tests/fixtures/sample_meshes.hpp"
#include "tests/oracle/random_cases.hpp"
#include "verisq/deviation.hpp"

namespace verisq::testing {
namespace {

using oracle::forge;
using oracle::moved;
using oracle::RandomCases;

struct Case {
  Model model;
  Mesh mesh;
  ContactAreas found;
  CertifiedContact certified;
};

ProvenContact proven_of(const Model& model, const Mesh& mesh, const ContactTerms& terms,
                        const ContactCertificate& certificate) {
  return ContactChecker(model)(mesh, terms, certificate,
                               {.in_parallel = [](auto count, auto work) { in_parallel(count, work); }});
}

/// Three regions: every third triangle, and none.
Case certified(const Model& model, const Mesh& mesh, double distance, double share_width) {
  ContactAreaOptions options{.distance = distance, .share_width = share_width, .device = "host"};
  for (std::size_t n = 0; n < mesh.triangles.size(); ++n) options.region_of.push_back(n % 3 == 0 ? 0 : 1);
  options.regions = 3;
  ContactAreas found = contact_areas(model, mesh, options);
  CertifiedContact proof = certified_contact(model, mesh, found, options);
  return {model, mesh, std::move(found), std::move(proof)};
}

Primitive superquadric(const std::array<double, 3>& axes, const std::array<double, 2>& exponents, const Point& centre) {
  return {"", {axes, exponents}, {centre, {0.9, 0.2, -0.3, 0.1}}, {}};
}

Primitive ball(double radius) {
  return superquadric({radius, radius, radius}, {1.0, 1.0}, {});
}

/// A ball, one convex solid, a union, a bent solid and a difference, each in a torus that lies about them.
const std::vector<Case>& cases() {
  const Mesh torus = torus_mesh(3.0, 1.0, 8, 5);
  const Primitive soap = superquadric({2.0, 1.6, 1.0}, {0.4, 0.7}, {0.1, 0.2, -0.1});
  const Primitive side = superquadric({0.8, 0.8, 0.8}, {1.0, 1.0}, {1.4, 1.0, 0.2});
  Primitive bent = superquadric({0.6, 0.5, 2.0}, {0.8, 0.9}, {0.3, 0.0, 0.0});
  bent.bend = Bend{0.2, 30.0};
  const SetExpression difference{{{.primitive = 0}, {.primitive = 1}}, SetOperation::subtract};
  const Mesh coarse = torus_mesh(3.0, 1.0, 4, 3);
  static const std::vector<Case> all{
      certified({"", {ball(2.0)}, {}}, torus, 0.7, 0.02), certified({"", {soap}, {}}, torus, 0.7, 0.05),
      certified({"", {soap, side}, {}}, torus, 0.7, 0.1), certified({"", {bent, side}, {}}, coarse, 0.5, 0.2),
      certified({"", {soap, side}, difference}, coarse, 0.5, 0.7)};
  return all;
}

bool meet(const Enclosure& a, const Enclosure& b) {
  return a.lo <= b.hi && b.lo <= a.hi;
}

bool holds(const Enclosure& outer, const Enclosure& inner) {
  return outer.lo <= inner.lo && inner.hi <= outer.hi;
}

void expect_true_of(const AreaWithin& proven, const AreaWithin& found) {
  EXPECT_TRUE(meet(proven.area, found.area));
  EXPECT_TRUE(meet(proven.within, found.within));
  EXPECT_TRUE(meet(proven.share, found.share));
}

void expect_true_of(const ProvenContact& proven, const ContactAreas& found) {
  expect_true_of(proven.of_mesh, found.of_mesh);
  ASSERT_EQ(proven.by_region.size(), found.by_region.size());
  for (std::size_t r = 0; r < found.by_region.size(); ++r) expect_true_of(proven.by_region[r], found.by_region[r]);
}

void expect_as_found(const ContactClaim& claimed, const AreaWithin& found) {
  const auto [area, within, percent] = claim_of(found);
  EXPECT_NEAR(claimed.area.width(), area.width(), 1e-12 * area.hi);
  EXPECT_NEAR(claimed.within.width(), within.width(), 1e-12 * area.hi);
  EXPECT_NEAR(claimed.percent.width(), percent.width(), 1e-9);
  EXPECT_TRUE(holds(claimed.percent, percent));
}

/// What the search found, digit by digit, and with few vertices that have certificates of their own.
TEST(ContactCertificateTest, ProvesWhatWasFound) {
  for (const Case& of : cases()) {
    const auto& [terms, claims, certificate, proven] = of.certified;
    EXPECT_EQ(proven.unproved_samples, 0U);
    expect_true_of(proven, of.found);
    expect_as_found(claims.of_mesh, of.found.of_mesh);
    for (std::size_t r = 0; r < 3; ++r) expect_as_found(claims.by_region[r], of.found.by_region[r]);
    EXPECT_EQ(claims.by_region[2].area, (Enclosure{0.0, 0.0}));
    const ProvenContact again = proven_of(of.model, of.mesh, terms, certificate);
    EXPECT_EQ(again.of_mesh.share, proven.of_mesh.share);
    EXPECT_TRUE(are_proved(claims, again));
    const auto own =
        std::ranges::count_if(certificate.vertices, [](const VertexProof& v) { return v.own.has_value(); });
    std::cout << own << " of " << certificate.vertices.size() << " vertices and " << certificate.triangles.size()
              << " of " << of.mesh.triangles.size() << " triangles have " << proven.samples
              << " samples for a share in [" << proven.of_mesh.share.lo << ", " << proven.of_mesh.share.hi << "]\n";
  }
}

/// Of all points of the triangles, by dense samples.
TEST(ContactCertificateTest, HoldsWhatSamplesSay) {
  for (const Case& of : cases()) {
    const SignedDistance distance(of.model);
    double near = 0.0;
    double all = 0.0;
    const int rows = is_union_of_convex(of.model) ? 10 : 4;
    for (std::size_t n = 0; n < of.mesh.triangles.size(); ++n) {
      const Triangle corners = corners_of(of.mesh, n);
      const LongPoint normal = cross(difference(widened(corners[1]), widened(corners[0])),
                                     difference(widened(corners[2]), widened(corners[0])));
      const std::vector<Point> samples = grid_on(corners, rows);
      const double each = static_cast<double>(std::sqrt(dot(normal, normal))) / static_cast<double>(samples.size());
      for (const Point& sample : samples) {
        all += each;
        if (std::abs(distance(sample, 1e-3).hi) <= of.certified.terms.distance) near += each;
      }
    }
    constexpr double of_samples = 0.03;
    EXPECT_GE(near / all, of.certified.proven.of_mesh.share.lo - of_samples);
    EXPECT_LE(near / all, of.certified.proven.of_mesh.share.hi + of_samples);
  }
}

/// A square at 6 above the middle of a ball of radius 5: within 2 of it is a disc of 13 pi.
Mesh square() {
  return {.vertices = {{-10, -10, 6}, {10, -10, 6}, {10, 10, 6}, {-10, 10, 6}}, .triangles = {{0, 1, 2}, {0, 2, 3}}};
}

TEST(ContactCertificateTest, OfADisc) {
  const Model model{"", {ball(5.0)}, {}};
  const ContactAreaOptions options{.distance = 2.0, .share_width = 0.001, .device = "host"};
  const CertifiedContact certified =
      certified_contact(model, square(), contact_areas(model, square(), options), options);
  const AreaWithin& proven = certified.proven.of_mesh;
  EXPECT_TRUE(proven.within.contains(13.0 * std::numbers::pi));
  EXPECT_TRUE(proven.area.contains(400.0));
  EXPECT_LE(proven.share.width(), 0.001);
  EXPECT_TRUE(certified.proven.by_region.empty());
}

/// Far from it nobody needs a certificate but one vertex.
TEST(ContactCertificateTest, OneVertexTellsAllThatIsFar) {
  Mesh far = sphere_mesh(3);
  for (Point& vertex : far.vertices) vertex[0] += 100.0;
  const Model model{"", {ball(5.0)}, {}};
  const ContactAreaOptions options{.distance = 2.0, .device = "host"};
  const CertifiedContact certified = certified_contact(model, far, contact_areas(model, far, options), options);
  EXPECT_EQ(certified.proven.samples, 1U);
  EXPECT_TRUE(certified.certificate.triangles.empty());
  EXPECT_EQ(certified.claims.of_mesh.percent, (Enclosure{0.0, 0.0}));
  EXPECT_TRUE(are_proved(certified.claims, certified.proven));
}

/// Where the file must be small the claims are wider, and proven.
TEST(ContactCertificateTest, ClaimsNoMoreThanItProves) {
  const Case& of = cases()[1];
  ContactAreaOptions options{.distance = of.certified.terms.distance, .device = "host"};
  options.region_of = of.certified.terms.region_of;
  options.regions = 3;
  const CertifiedContact small = certified_contact(
      of.model, of.mesh, of.found, options, [](double) {}, 1);
  EXPECT_GT(small.claims.of_mesh.percent.width(), 2.0 * of.certified.claims.of_mesh.percent.width());
  EXPECT_TRUE(are_proved(small.claims, small.proven));
  expect_true_of(small.proven, of.found);
  options.interrupted = [] { return true; };
  EXPECT_TRUE(certified_contact(of.model, of.mesh, of.found, options).proven.interrupted);
  options.regions = 1;
  EXPECT_THROW((void)certified_contact(of.model, of.mesh, of.found, options), Error);
}

/// All triangles with nothing said of them: any share.
TEST(ContactCertificateTest, OfNothingNothingIsProven) {
  const Case& of = cases()[0];
  ContactCertificate nothing;
  nothing.vertices.resize(of.mesh.vertices.size());
  const ProvenContact proven = proven_of(of.model, of.mesh, of.certified.terms, nothing);
  EXPECT_EQ(proven.of_mesh.share, (Enclosure{0.0, 1.0}));
  EXPECT_EQ(proven.samples, 0U);
  ContactCertificate elsewhere = nothing;
  for (VertexProof& vertex : elsewhere.vertices) vertex.told_by = 1'000'000;
  elsewhere.triangles = {{1'000'000, {}}};
  EXPECT_EQ(proven_of(of.model, of.mesh, of.certified.terms, elsewhere).of_mesh.share, (Enclosure{0.0, 1.0}));
}

/// What is known of the truth by the search and by the certificate: no claim beyond it is true.
Enclosure both(const Enclosure& a, const Enclosure& b) {
  return {std::max(a.lo, b.lo), std::min(a.hi, b.hi)};
}

class ContactForger {
 public:
  explicit ContactForger(oracle::Forgeries& forgeries) : forgeries_(forgeries) {}

  /// Claims past the truth of this case, by what a changed certificate proves.
  void try_claims_past(const Case& of, const ProvenContact& proven) {
    expect_true_of(proven, of.found);
    try_past(of.found.of_mesh, of.certified.proven.of_mesh, proven.of_mesh);
    for (std::size_t r = 0; r < of.found.by_region.size(); ++r)
      try_past(of.found.by_region[r], of.certified.proven.by_region[r], proven.by_region[r]);
  }

  /// The claims of a case, of which this one at least is false.
  void expect_none(const ContactClaim& claimed, const AreaWithin& proven, std::size_t which) {
    const Finding finding = check(claimed, proven)[which];
    forgeries_.expect_not_proved(finding, which == 0 ? claimed.area : claimed.percent, "a claim of something else");
  }

 private:
  void try_past(const AreaWithin& found, const AreaWithin& own, const AreaWithin& proven) {
    try_past(both(found.area, own.area), proven, &ContactClaim::area, 0);
    try_past(both(found.within, own.within), proven, &ContactClaim::within, 1);
    const Enclosure share = both(found.share, own.share);
    try_past({100.0 * share.lo, 100.0 * share.hi}, proven, &ContactClaim::percent, 2);
  }

  void try_past(const Enclosure& truth, const AreaWithin& proven, Enclosure ContactClaim::*number, std::size_t which) {
    constexpr Enclosure anything{-infinity, infinity};
    for (const Enclosure& past :
         {Enclosure{moved(truth.hi, infinity), infinity}, {-infinity, moved(truth.lo, -infinity)}}) {
      ContactClaim claimed{anything, anything, anything};
      claimed.*number = past;
      forgeries_.expect_not_proved(check(claimed, proven)[which], past, "a claim past the truth");
    }
  }

  oracle::Forgeries& forgeries_;
};

/// Changes of a certificate, after which it proves less, or nothing; never what is false.
void forge(ContactCertificate& certificate, std::size_t what, RandomCases& random) {
  const auto any_of = [&](auto& elements) -> auto& {
    return elements[random.choice(elements.size())];
  };
  VertexProof& vertex = any_of(certificate.vertices);
  DividedTriangle& divided = any_of(certificate.triangles);
  switch (what) {
    case 0:
      if (vertex.own) forge(*vertex.own, random);
      break;
    case 1: vertex = {{}, static_cast<std::uint32_t>(random.choice(certificate.vertices.size()))}; break;
    case 2: std::swap(vertex.own, any_of(certificate.vertices).own); break;
    case 3:
      for (CertifiedEnclosure& sample : divided.proof.samples) forge(sample, random);
      break;
    case 4: forge(divided.proof, random); break;
    case 5: std::swap(divided.proof, any_of(certificate.triangles).proof); break;
    case 6: divided.triangle = static_cast<std::uint32_t>(random.choice(certificate.vertices.size())); break;
    default: certificate.triangles.erase(certificate.triangles.begin() + (&divided - certificate.triangles.data()));
  }
}

constexpr std::size_t kinds_of_changes = 8;

/// A triangle more in one region, and less in another: the areas of both are others.
void try_other_regions(const Case& of, RandomCases& random, ContactForger& forger) {
  ContactTerms terms = of.certified.terms;
  std::uint32_t& region = terms.region_of[random.choice(terms.region_of.size())];
  const std::uint32_t before = std::exchange(region, (region + 1 + static_cast<std::uint32_t>(random.choice(2))) % 3);
  const ProvenContact proven = proven_of(of.model, of.mesh, terms, of.certified.certificate);
  for (const std::uint32_t changed : {before, region})
    forger.expect_none(of.certified.claims.by_region[changed], proven.by_region[changed], 0);
}

/// Another distance, a larger model or another place of the mesh, of which the share is another.
void try_other_subjects(const Case& of, double by, ContactForger& forger) {
  ContactAreaOptions options{.distance = of.certified.terms.distance, .share_width = 0.02, .device = "host"};
  const auto try_of = [&](const Model& model, const Mesh& mesh) {
    const ContactClaim& claimed = of.certified.claims.of_mesh;
    if (meet(claim_of(contact_areas(model, mesh, options).of_mesh).percent, claimed.percent)) return;
    ContactTerms terms = of.certified.terms;
    terms.distance = options.distance;
    forger.expect_none(claimed, proven_of(model, mesh, terms, of.certified.certificate).of_mesh, 2);
  };
  Model larger = of.model;
  for (double& axis : larger.primitives[0].superquadric.semi_axes) axis *= 1.0 + by;
  try_of(larger, of.mesh);
  Mesh elsewhere = of.mesh;
  for (Point& vertex : elsewhere.vertices) vertex[2] += by;
  try_of(of.model, elsewhere);
  options.distance *= 1.0 + by;
  try_of(of.model, of.mesh);
}

/// Whatever is left out or changed, what is proven is true; claims past the truth, and of other things, are never
/// proved.
TEST(ContactCertificateTest, NeverProvesAForgery) {
  oracle::Forgeries forgeries;
  ContactForger forger(forgeries);
  const std::size_t changes = oracle::requested_count("VERISQ_FORGED_CONTACTS", 3);
  RandomCases random(7);
  for (const Case& of : cases()) {
    forger.try_claims_past(of, of.certified.proven);
    for (std::size_t k = 0; k < changes; ++k) {
      ContactCertificate changed = of.certified.certificate;
      forge(changed, random.choice(kinds_of_changes), random);
      forger.try_claims_past(of, proven_of(of.model, of.mesh, of.certified.terms, changed));
      if (k % 4 == 0) try_other_regions(of, random, forger);
    }
    if (of.model.primitives.size() == 1) try_other_subjects(of, random.uniform(0.1, 0.5), forger);
  }
  EXPECT_GT(forgeries.told(), 400U);
}

/// All is told, or nothing: of the rest of the triangle nobody knows.
TEST(ContactCertificateTest, OfAProofThatIsCutShortNothingIsProven) {
  const Case& of = cases()[0];
  for (std::size_t k = 0; k < of.certified.certificate.triangles.size(); k += 20) {
    ContactCertificate cut = of.certified.certificate;
    cut.triangles[k].proof.pieces.pop_back();
    const ProvenContact proven = proven_of(of.model, of.mesh, of.certified.terms, cut);
    EXPECT_GT(proven.of_mesh.share.width(), of.certified.proven.of_mesh.share.width());
  }
}

}  // namespace
}  // namespace verisq::testing
