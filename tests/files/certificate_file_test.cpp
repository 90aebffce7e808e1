/// Certificate files: what is written is read again bit for bit; what is not of the format is refused.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <variant>
#include <verisq/certificate_file.hpp>
#include <verisq/error.hpp>

#include "host/files/input_file.hpp"
#include "tests/fixtures/error_matchers.hpp"
#include "tests/fixtures/temporary_folder.hpp"

namespace verisq {
namespace {

using testing::expect_input_error;
using ::testing::HasSubstr;
using testing::TemporaryFolder;
using ::testing::ThrowsMessage;

/// FIPS 180-4's examples, as NIST publishes them, and every length about a block's end against coreutils.
TEST(Sha256, IsThatOfTheStandard) {
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(
      sha256("abcdefghbcdefghicdefghijdefghijkefghijklfghijklmghijklmnhijklmnoijklmnopjklmnopqklmnopqrlmnopqrsmnop"
             "qrstnopqrstu"),
      "cf5b16a778af8380036ce59e7b0492370b249b11e8f07a51afac45037afee9d1");
  EXPECT_EQ(sha256(std::string(1000000, 'a')), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

PairAnswer answer() {
  return {{{{"a.json", sha256("a")}, {"b.json", sha256("b")}}},
          "mm",
          {{0.1, -0.0, 5e-324}, {1.0, 2.0, 3.0, 4.0}},
          {1.0 / 3.0, infinity},
          {.separations = {{0, 1, {0.1, 0.2, 0.3}, {1e308, 0.0, -1.0}, {3.0, 2.0, 1.0}}, {1, 1, {}, {}, {}}},
           .divisions = {{0,
                          1,
                          {SectionCut::b, SectionCut::none, SectionCut::a, SectionCut::none, SectionCut::none},
                          {{{0.1, 0.2, 0.3}, 1.0 / 3.0, -0.0}, {{1e308, 5e-324, 0.0}, 1.0, 2.0}, {{}, 0.0, 0.0}}},
                         {1, 1, {SectionCut::none}, {{}}}},
           .balls_a = {{0, {0.5, 0.25, 1.0 / 3.0}, 7.0, 0.1, {{{2, {1.0, 0.0, 0.1}}}, {}}},
                       {3, {}, 0.0, -1.0, {{}, Point{1, 2, 3}, {}, Point{0.1, 0.2, 0.3}, {true, false, false}}}},
           .balls_b = {{1, {1.0, 2.0, 3.0}, 0.0, 0.0, {{}, {}}}},
           .covers_a = {{2, 0.3, {true, false, true, false, false}}},
           .covers_b = {{0, 1.0 / 3.0, {false}}, {1, -5.0, {true, false, false}}},
           .near_points = std::array{Point{0.1, 0.2, 0.3}, Point{0.4, 0.5, 0.6}},
           .common = Point{0.7, 0.8, 0.9}}};
}

void expect_same(const EnclosingBall& a, const EnclosingBall& b) {
  EXPECT_EQ(a.primitive, b.primitive);
  EXPECT_EQ(a.centre, b.centre);
  EXPECT_EQ(a.multiplier, b.multiplier);
  EXPECT_EQ(a.distance, b.distance);
  EXPECT_EQ(a.proof, b.proof);
}

void expect_same(const std::vector<SurroundedPrimitive>& a, const std::vector<SurroundedPrimitive>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].primitive, b[i].primitive);
    EXPECT_EQ(a[i].distance, b[i].distance);
    EXPECT_EQ(a[i].cover, b[i].cover);
  }
}

/// All but the separations.
void expect_same_rest(const PairCertificate& a, const PairCertificate& b) {
  ASSERT_EQ(a.divisions.size(), b.divisions.size());
  for (std::size_t i = 0; i < a.divisions.size(); ++i) {
    EXPECT_EQ(a.divisions[i].primitive_b, b.divisions[i].primitive_b);
    EXPECT_EQ(a.divisions[i].cuts, b.divisions[i].cuts);
    ASSERT_EQ(a.divisions[i].planes.size(), b.divisions[i].planes.size());
    for (std::size_t k = 0; k < a.divisions[i].planes.size(); ++k) {
      EXPECT_EQ(a.divisions[i].planes[k].normal, b.divisions[i].planes[k].normal);
      EXPECT_EQ(a.divisions[i].planes[k].slope_a, b.divisions[i].planes[k].slope_a);
      EXPECT_EQ(a.divisions[i].planes[k].slope_b, b.divisions[i].planes[k].slope_b);
    }
  }
  ASSERT_EQ(a.balls_a.size(), b.balls_a.size());
  for (std::size_t i = 0; i < a.balls_a.size(); ++i) expect_same(a.balls_a[i], b.balls_a[i]);
  ASSERT_EQ(a.balls_b.size(), b.balls_b.size());
  for (std::size_t i = 0; i < a.balls_b.size(); ++i) expect_same(a.balls_b[i], b.balls_b[i]);
  expect_same(a.covers_a, b.covers_a);
  expect_same(a.covers_b, b.covers_b);
  EXPECT_EQ(a.near_points, b.near_points);
  EXPECT_EQ(a.common, b.common);
}

TEST(CertificateFile, GivesTheSameBitsAgain) {
  const TemporaryFolder folder;
  const auto path = folder / "proof.json";
  const PairAnswer written = answer();
  write_answer(path, written);
  const PairAnswer read = read_pair_answer(path);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(read.models[i].name, written.models[i].name);
    EXPECT_EQ(read.models[i].sha256, written.models[i].sha256);
  }
  EXPECT_EQ(read.units, "mm");
  EXPECT_EQ(read.pose.translation, written.pose.translation);
  EXPECT_TRUE(std::signbit(read.pose.translation[1]));
  EXPECT_EQ(read.pose.quaternion, written.pose.quaternion);
  EXPECT_EQ(read.distance, written.distance);
  ASSERT_EQ(read.certificate.separations.size(), 2U);
  const Separation& first = read.certificate.separations[0];
  EXPECT_EQ(first.primitive_b, 1U);
  EXPECT_EQ(first.vector, written.certificate.separations[0].vector);
  EXPECT_EQ(first.on_a, written.certificate.separations[0].on_a);
  EXPECT_EQ(first.on_b, written.certificate.separations[0].on_b);
  expect_same_rest(read.certificate, written.certificate);
}

StatedTerms stated_terms() {
  return {.fitness = {2.0, 1.0 / 3.0, {1.0, infinity}},
          .penetration_limit = 0.1,
          .areas = {{"proximal", 3.0}, {"elsewhere", 0.0}},
          .area_runs = {{1, 4}, {0, 2}, {1, 1}}};
}

void expect_stated_terms(const StatedTerms& read) {
  const StatedTerms written = stated_terms();
  EXPECT_EQ(read.fitness.target, 2.0);
  EXPECT_EQ(read.fitness.scale, 1.0 / 3.0);
  EXPECT_EQ(read.fitness.serves, written.fitness.serves);
  EXPECT_EQ(read.penetration_limit, 0.1);
  EXPECT_EQ(read.areas, written.areas);
  EXPECT_EQ(read.area_runs, written.area_runs);
}

FitAnswer fit_answer() {
  return {.model = {"fitted.json", sha256("fitted")},
          .mesh = {"bone.off", sha256("bone")},
          .units = "mm",
          .terms = stated_terms(),
          .claims = {{"objective", "", {-infinity, 0.7}}, {"mean_distance", "proximal", {0.1, 0.2}}},
          .sides = {{2, SurfaceSide::outside}, {0, SurfaceSide::inside}}};
}

TEST(CertificateFile, GivesTheSameBitsOfAFitAgain) {
  const TemporaryFolder folder;
  const FitAnswer written = fit_answer();
  write_answer(folder / "proof.json", written);
  const auto read = std::get<FitAnswer>(read_answer(folder / "proof.json"));
  EXPECT_EQ(read.model.sha256, written.model.sha256);
  EXPECT_EQ(read.mesh.name, "bone.off");
  EXPECT_EQ(read.units, "mm");
  expect_stated_terms(read.terms);
  ASSERT_EQ(read.claims.size(), 2U);
  EXPECT_EQ(read.claims[0].value, written.claims[0].value);
  EXPECT_EQ(read.claims[1].what, "mean_distance");
  EXPECT_EQ(read.claims[1].area, "proximal");
  EXPECT_EQ(points_of(read.terms), 7U);
  const ClearanceTerms terms = terms_of(read.terms);
  EXPECT_THAT(terms.area_of, ::testing::ElementsAre(1, 1, 1, 1, 0, 0, 1));
  EXPECT_EQ(runs_of(terms.area_of), written.terms.area_runs);
  ASSERT_EQ(read.sides.size(), 2U);
  EXPECT_EQ(read.sides[0].primitive, 2U);
  EXPECT_EQ(read.sides[0].side, SurfaceSide::outside);
  EXPECT_EQ(read.sides[1].side, SurfaceSide::inside);
}

/// Of a valid document in which what stands at `pointer` is another value.
void expect_refused_change(nlohmann::json document, const std::string& pointer, const nlohmann::json& value,
                           const std::string& message) {
  document[nlohmann::json::json_pointer(pointer)] = value;
  EXPECT_THAT([&] { (void)parse_answer(document.dump(), "p"); }, ThrowsMessage<Error>(HasSubstr(message)));
}

TEST(CertificateFile, RefusesWhatIsNoFit) {
  const TemporaryFolder folder;
  write_answer(folder / "proof.json", fit_answer());
  std::ifstream in(folder / "proof.json");
  const nlohmann::json valid = nlohmann::json::parse(in);
  const auto refused = [&](const std::string& pointer, const nlohmann::json& value, const std::string& message) {
    expect_refused_change(valid, pointer, value, message);
  };
  refused("/models", nlohmann::json::array(), "must be an array of one model");
  refused("/mesh/sha256", "12", "mesh");
  refused("/criterion/scale", 0.0, "must be above 0");
  refused("/criterion/target", -1.0, "must be at least 0");
  refused("/penetration_limit", -0.5, "must be at least 0");
  refused("/areas/0/weight", -2.0, "must be at least 0");
  refused("/areas/1/name", "", "must not be empty");
  refused("/areas/1/name", "a\tb", "must have no control characters");
  refused("/claims/0/what", "a\nb", "must have no control characters");
  refused("/criterion/serves", {{"lo", 2.0}, {"hi", 1.0}}, "must have lo no larger than hi");
  refused("/areas/1/name", "proximal", "is the name of an area before");
  refused("/area_runs/0", {2, 4}, "must be below 2");
  refused("/area_runs/0", {0}, "must be an area's index and a number of points");
  refused("/area_runs", {{0, 4294967295U}, {1, 4294967295U}}, "points in all");
  refused("/claims", nlohmann::json::array(), "must not be empty");
  refused("/claims/1", {{"what", "objective"}, {"lo", 0.0}, {"hi", 1.0}}, "is claimed before");
  refused("/claims/0/lo", "nothing", "claims[0].lo");
  refused("/sides/0/side", "any", "must be inside or outside");
  refused("/sides/0/primitive", -1, "must be an index");
  refused("/sides/1/primitive", 2, "is of a primitive before");
  refused("/surface", 1, "surface");
}

BestFitAnswer best_fit_answer() {
  using enum PoseDivision;
  return {.models = {{"first.json", sha256("first")}, {"second.json", sha256("second")}},
          .mesh = {"bone.off", sha256("bone")},
          .units = "mm",
          .terms = stated_terms(),
          .range = {{{0.1, 1.0 / 3.0, -2.0}, {0.9, 0.1, 0.0, 0.0}}, 15.0, 30.0},
          .centres = {{1.0, 2.0, 3.0}, {-1.0, 0.1, 0.0}},
          .upper = 12.3,
          .certificate = {{{along_x, about_z, none, none, none}, {none}}}};
}

TEST(CertificateFile, GivesTheSameBitsOfABestFitAgain) {
  const TemporaryFolder folder;
  BestFitAnswer written = best_fit_answer();
  write_answer(folder / "proof.json", written);
  const auto read = std::get<BestFitAnswer>(read_answer(folder / "proof.json"));
  ASSERT_EQ(read.models.size(), 2U);
  EXPECT_EQ(read.models[1].sha256, written.models[1].sha256);
  EXPECT_EQ(read.mesh.sha256, written.mesh.sha256);
  EXPECT_EQ(read.units, "mm");
  expect_stated_terms(read.terms);
  EXPECT_EQ(read.range.start.translation, written.range.start.translation);
  EXPECT_EQ(read.range.start.quaternion, written.range.start.quaternion);
  EXPECT_EQ(read.range.translation, 15.0);
  EXPECT_EQ(read.range.rotation_degrees, 30.0);
  EXPECT_EQ(read.centres, written.centres);
  EXPECT_EQ(read.upper, 12.3);
  EXPECT_EQ(read.certificate.ranges, written.certificate.ranges);
  EXPECT_THAT(claim_of(read).terms.area_of, ::testing::ElementsAre(1, 1, 1, 1, 0, 0, 1));
  written.upper = -infinity;
  write_answer(folder / "none.json", written);
  EXPECT_EQ(std::get<BestFitAnswer>(read_answer(folder / "none.json")).upper, -infinity);
}

TEST(CertificateFile, RefusesWhatIsNoBestFit) {
  const TemporaryFolder folder;
  write_answer(folder / "proof.json", best_fit_answer());
  std::ifstream in(folder / "proof.json");
  const nlohmann::json valid = nlohmann::json::parse(in);
  const auto refused = [&](const std::string& pointer, const nlohmann::json& value, const std::string& message) {
    expect_refused_change(valid, pointer, value, message);
  };
  refused("/models", nlohmann::json::array(), "must not be empty");
  refused("/centres", nlohmann::json::array(), "must be 2, one a model");
  refused("/centres/0", {1.0, 2.0}, "must be an array of 3 numbers");
  refused("/ranges", nlohmann::json::array({"."}), "must be 2, one a model");
  refused("/ranges/0", "x.t", "must consist of the letters x, y, z, u, v, w and .");
  refused("/range/translation", -1.0, "must be at least 0");
  refused("/range/rotation_degrees", 180.5, "must be at most 180");
  refused("/range/start/quaternion", {0, 0, 0, 0}, "must not be zero");
  refused("/upper", "nothing", "upper");
  refused("/upper", "inf", "must be a number, or \"-inf\"");
  refused("/criterion/scale", 0.0, "must be above 0");
  refused("/claims", nlohmann::json::array(), "claims");
}

/// A valid file in which what stands at `pointer` is another value.
std::string changed(const std::string& pointer, const nlohmann::json& value) {
  const TemporaryFolder folder;
  write_answer(folder / "proof.json", answer());
  std::ifstream in(folder / "proof.json");
  nlohmann::json document = nlohmann::json::parse(in);
  document[nlohmann::json::json_pointer(pointer)] = value;
  return document.dump();
}

void expect_refusal(const std::string& pointer, const nlohmann::json& value, const std::string& message) {
  expect_input_error([&] { (void)parse_pair_answer(changed(pointer, value), "proof.json"); }, "proof.json",
                     ": " + message);
}

TEST(CertificateFile, RefusesWhatIsNotOfTheFormat) {
  expect_refusal("/format", "verisq-certificate/2",
                 "format = \"verisq-certificate/2\": must be \"verisq-certificate/1\"");
  expect_refusal("/kind", "fit", "kind = \"fit\": must be \"pair\"");
  expect_refusal("/prof", 1, "prof = 1: unknown key");
  expect_refusal("/models/2", 1, "models = [...]: must be an array of two models");
  expect_refusal("/models/0/sha256", "abc", "models[0].sha256 = \"abc\": must be 64 lower-case hexadecimal digits");
  expect_refusal("/pose/quaternion", {0, 0, 0, 0}, "pose.quaternion = [0,0,0,0]: must not be zero");
  expect_refusal("/pose/translation", {0, 0}, "pose.translation = [0,0]: must be an array of 3 numbers");
  expect_refusal("/distance/lo", "nan", "distance.lo = \"nan\": must be a number, \"inf\" or \"-inf\"");
  expect_refusal("/proof/separations/0/primitive_a", -1, "proof.separations[0].primitive_a = -1: must be an index");
  expect_refusal("/proof/separations/0/primitive_a", 4294967296,
                 "proof.separations[0].primitive_a = 4294967296: must be an index");
  expect_refusal("/proof/separations/1/primitive_a", 0,
                 "proof.separations[1] = {...}: these two primitives have been separated before");
  expect_refusal("/proof/divisions/1/primitive_a", 0,
                 "proof.divisions[1] = {...}: these two primitives have been separated before");
  expect_refusal("/proof/divisions/0/cuts", "b.c",
                 "proof.divisions[0].cuts = \"b.c\": must consist of the letters a, b and .");
  expect_refusal("/proof/divisions/0/cuts", "b..",
                 "proof.divisions[0].planes = [...]: must be 2 planes, one for each . of the cuts");
  expect_refusal("/proof/divisions/0/planes/0", {1, 2, 3},
                 "proof.divisions[0].planes[0] = [1,2,3]: must be an array of 5 numbers");
  expect_refusal("/proof/balls_a/1/primitive", 0, "proof.balls_a[1] = {...}: this primitive has a ball before");
  expect_refusal("/proof/balls_a/1/cover", "g",
                 "proof.balls_a[1].cover = \"g\": must be the hexadecimal digits of a cover");
  expect_refusal("/proof/near_points/on_c", 1, "proof.near_points.on_c = 1: unknown key");
  expect_refusal("/proof/common", {1, 2}, "proof.common = [1,2]: must be an array of 3 numbers");
}

TEST(CertificateFile, RefusesWhatIsTooLarge) {
  const TemporaryFolder folder;
  const auto path = folder.file("proof.json", std::string((std::size_t{1} << 26) + 1, ' '));
  expect_input_error([&] { (void)read_pair_answer(path); }, path, ": larger than 67108864 bytes: not a certificate");
}

TEST(CertificateFile, OfManyPosesGivesTheSameBitsAgain) {
  const TemporaryFolder folder;
  const PairAnswer one = answer();
  PoseAnswers written{one.models, one.units, {{one.pose, one.distance, one.certificate}, {{}, {0.0, 0.5}, {}}}};
  write_answer(folder / "proof.json", written);
  const PoseAnswers read = std::get<PoseAnswers>(read_answer(folder / "proof.json"));
  EXPECT_EQ(read.models[1].sha256, one.models[1].sha256);
  EXPECT_EQ(read.units, "mm");
  ASSERT_EQ(read.answers.size(), 2U);
  EXPECT_EQ(read.answers[0].pose.translation, one.pose.translation);
  EXPECT_TRUE(std::signbit(read.answers[0].pose.translation[1]));
  EXPECT_EQ(read.answers[0].pose.quaternion, one.pose.quaternion);
  EXPECT_EQ(read.answers[0].distance, one.distance);
  ASSERT_EQ(read.answers[0].certificate.separations.size(), 2U);
  EXPECT_EQ(read.answers[0].certificate.separations[0].on_a, one.certificate.separations[0].on_a);
  expect_same_rest(read.answers[0].certificate, one.certificate);
  EXPECT_EQ(read.answers[1].distance, (Enclosure{0.0, 0.5}));
  EXPECT_TRUE(read.answers[1].certificate.separations.empty());

  std::ifstream in(folder / "proof.json");
  const nlohmann::json document = nlohmann::json::parse(in);
  const auto refused = [&](const std::string& pointer, const nlohmann::json& value, const std::string& message) {
    nlohmann::json other = document;
    other[nlohmann::json::json_pointer(pointer)] = value;
    expect_input_error([&] { (void)parse_answer(other.dump(), "proof.json"); }, "proof.json", ": " + message);
  };
  refused("/kind", "recovery",
          "kind = \"recovery\": must be \"pair\", \"poses\", \"path\", \"fit\", \"best_fit\", \"insertion\", "
          "\"deviation\", \"contact\", \"containment\", "
          "\"features\" or \"equilibrium\"");
  refused("/kind", "pair", "answers = [...]: unknown key");
  refused("/answers", nlohmann::json::array(), "answers = []: must not be empty");
  refused("/answers/1/extra", 1, "answers[1].extra = 1: unknown key");
  refused("/answers/1/pose/quaternion", {0, 0, 0, 0}, "answers[1].pose.quaternion = [0,0,0,0]: must not be zero");
}

TEST(CertificateFile, OfADeviationGivesTheSameBitsAgain) {
  const TemporaryFolder folder;
  const Certificate certificate{
      {{1, {0.1, -0.0, 5e-324}}}, Point{1, 2, 3}, {}, Point{0.1, 0.2, 0.3}, {true, false, false}};
  const DistanceSummary summary{{0.1, 1.0 / 3.0}, {0.0, infinity}, {{0.5, 0.7}}};
  const DeviationAnswer written{
      .model = {"m.json", sha256("m")},
      .mesh = {"b.stl", sha256("b")},
      .units = "mm",
      .pose = Pose{{0.1, 0.2, 0.3}, {1.0, 0.5, 0.0, 0.0}},
      .percentiles = {95.0},
      .of_vertices = summary,
      .from_mesh = summary,
      .from_model = Enclosure{0.3, infinity},
      .statistics_from_model = AreaStatistics{{0.2, 1.0 / 3.0}, {{0.1, infinity}}},
      .hausdorff = Enclosure{1.0 / 3.0, 0.5},
      .certificate = {
          .vertices = {{{-infinity, 0.1}, certificate}, {{0.2, 0.3}, {}}},
          .triangles = {{{PieceProof::halved, PieceProof::corners, PieceProof::centre},
                         {{{0.1, 0.2}, {}}, {{0.3, 0.4}, certificate}}},
                        {{PieceProof::corners}, {}}},
          .surface = SurfaceProof{1.0 / 3.0,
                                  {{{PatchProof::halved_along, PatchProof::on, PatchProof::near, PatchProof::off}, {}},
                                   {{{0.1, 0.2, 0.3}, {{-infinity, -0.1}, certificate}}},
                                   {{{0.4, 0.5, 0.6}, {{-infinity, infinity}, certificate}}}},
                                  {{1.0 / 3.0, 0.0, -1.0}, {{-0.0, 5e-324}, certificate}}}}};
  write_answer(folder / "proof.json", written);
  const auto read = std::get<DeviationAnswer>(read_answer(folder / "proof.json"));
  EXPECT_EQ(read.mesh.sha256, written.mesh.sha256);
  EXPECT_EQ(read.pose->translation, written.pose->translation);
  EXPECT_EQ(read.percentiles, written.percentiles);
  EXPECT_EQ(read.of_vertices.largest, summary.largest);
  EXPECT_EQ(read.from_mesh->mean, summary.mean);
  EXPECT_EQ(read.from_mesh->percentiles, summary.percentiles);
  const auto& [vertices, triangles, surface] = read.certificate;
  ASSERT_EQ(vertices.size(), 2U);
  EXPECT_EQ(vertices[0].distance, (Enclosure{-infinity, 0.1}));
  EXPECT_EQ(vertices[0].certificate, certificate);
  ASSERT_EQ(triangles.size(), 2U);
  EXPECT_EQ(triangles[0].pieces, written.certificate.triangles[0].pieces);
  ASSERT_EQ(triangles[0].samples.size(), 2U);
  EXPECT_EQ(triangles[0].samples[1].certificate, certificate);
  EXPECT_TRUE(triangles[1].samples.empty());
  EXPECT_EQ(read.from_model, written.from_model);
  EXPECT_EQ(read.statistics_from_model, written.statistics_from_model);
  EXPECT_EQ(read.hausdorff, written.hausdorff);
  const SurfaceProof& written_surface = *written.certificate.surface;
  EXPECT_EQ(surface->within, written_surface.within);
  EXPECT_EQ(surface->cover.patches, written_surface.cover.patches);
  ASSERT_EQ(surface->cover.off.size(), 1U);
  EXPECT_EQ(surface->cover.off[0].point, written_surface.cover.off[0].point);
  EXPECT_EQ(surface->cover.off[0].signed_distance.distance, (Enclosure{-infinity, -0.1}));
  ASSERT_EQ(surface->cover.on.size(), 1U);
  EXPECT_EQ(surface->cover.on[0].point, written_surface.cover.on[0].point);
  EXPECT_EQ(surface->cover.on[0].signed_distance.certificate, certificate);
  EXPECT_EQ(surface->farthest.point, written_surface.farthest.point);
  EXPECT_EQ(surface->farthest.signed_distance.certificate, certificate);
}

ContactAnswer contact_answer() {
  const Certificate certificate{
      {{1, {0.1, -0.0, 5e-324}}}, Point{1, 2, 3}, {}, Point{0.1, 0.2, 0.3}, {true, false, false}};
  const ContactClaim claim{{0.1, 1.0 / 3.0}, {0.0, infinity}, {5e-324, 100.0}};
  return {.model = {"m.json", sha256("m")},
          .mesh = {"b.stl", sha256("b")},
          .units = "mm",
          .distance = 1.0 / 3.0,
          .regions = {"upper", "elsewhere"},
          .region_runs = {{1, 2}, {0, 1}},
          .claims = {claim, {claim, claim}, claim},
          .counted = {false, true},
          .certificate = {.vertices = {{{}, 2}, {{}, 2}, {CertifiedEnclosure{{-infinity, 0.1}, certificate}, 2}},
                          .triangles = {{1,
                                         {{PieceProof::halved, PieceProof::corners, PieceProof::centre},
                                          {{{0.1, 0.2}, {}}, {{0.3, 0.4}, certificate}}}}},
                          .surface = SurfaceCover{{{}, {PatchProof::on, PatchProof::near}},
                                                  {},
                                                  {{{0.4, 0.5, 0.6}, {{-infinity, infinity}, certificate}}}}}};
}

TEST(CertificateFile, OfContactGivesTheSameBitsAgain) {
  const TemporaryFolder folder;
  const ContactAnswer written = contact_answer();
  write_answer(folder / "proof.json", written);
  const auto read = std::get<ContactAnswer>(read_answer(folder / "proof.json"));
  EXPECT_EQ(read.model.sha256, written.model.sha256);
  EXPECT_EQ(read.mesh.sha256, written.mesh.sha256);
  EXPECT_EQ(read.distance, written.distance);
  EXPECT_EQ(read.regions, written.regions);
  EXPECT_THAT(terms_of(read).region_of, ::testing::ElementsAre(1, 1, 0));
  EXPECT_EQ(read.claims.of_mesh.percent, written.claims.of_mesh.percent);
  EXPECT_EQ(read.claims.by_region[1].within, written.claims.by_region[1].within);
  EXPECT_EQ(read.claims.of_model->within, written.claims.of_model->within);
  EXPECT_EQ(terms_of(read).counted, (std::vector<bool>{false, true}));
  const auto& [vertices, triangles, surface] = read.certificate;
  EXPECT_EQ(surface->patches, written.certificate.surface->patches);
  EXPECT_TRUE(surface->off.empty());
  EXPECT_EQ(surface->on[0].signed_distance.certificate, written.certificate.surface->on[0].signed_distance.certificate);
  ASSERT_EQ(vertices.size(), 3U);
  EXPECT_FALSE(vertices[0].own.has_value());
  EXPECT_EQ(vertices[1].told_by, 2U);
  EXPECT_EQ(vertices[2].own->certificate, written.certificate.vertices[2].own->certificate);
  ASSERT_EQ(triangles.size(), 1U);
  EXPECT_EQ(triangles[0].triangle, 1U);
  EXPECT_EQ(triangles[0].proof.pieces, written.certificate.triangles[0].proof.pieces);
  EXPECT_EQ(triangles[0].proof.samples.size(), 2U);
}

TEST(CertificateFile, RefusesWhatIsNoContact) {
  const TemporaryFolder folder;
  write_answer(folder / "proof.json", contact_answer());
  std::ifstream in(folder / "proof.json");
  const nlohmann::json valid = nlohmann::json::parse(in);
  const auto refused = [&](const std::string& pointer, const nlohmann::json& value, const std::string& message) {
    expect_refused_change(valid, pointer, value, message);
  };
  refused("/models", nlohmann::json::array(), "must be an array of one model");
  refused("/distance", -1.0, "must be at least 0");
  refused("/regions/1", "upper", "is the name of a region before");
  refused("/regions/1", "a\nb", "no control characters");
  refused("/region_runs/0/0", 2, "must be below 2");
  refused("/by_region", nlohmann::json::array(), "must be 2 claims, one a region");
  refused("/of_mesh/share", 1, "unknown key");
  refused("/vertices/0", 1, "must be the index of a vertex that has a certificate");
  refused("/vertices/0", 3, "must be the index of a vertex that has a certificate");
  refused("/vertices/0", -1, "must be an index");
  refused("/triangles/0/samples", nlohmann::json::array(), "must be of 2 samples");
  refused("/triangles/0/pieces", "x", "must consist of the letters c, h and .");
  refused("/triangles/1", valid["triangles"][0], "must be above those before");
  refused("/surface/primitives", nlohmann::json::array(), "must not be empty");
  refused("/surface/primitives/0", 2, "must be below 2");
  refused("/surface/primitives/1", 1, "must be above those before");
  refused("/surface/on", nlohmann::json::array(), "must be 1 points, one for each w");
  refused("/surface/off/0", valid["surface"]["on"][0], "must be 0 points, one for each o");
  refused("/surface/within", 1, "unknown key");
  nlohmann::json claim_alone = valid;
  claim_alone.erase("surface");
  EXPECT_THROW((void)parse_answer(claim_alone.dump(), "alone.json"), Error);
}

TEST(CertificateFile, OfAContainmentGivesTheSameBitsAgain) {
  const TemporaryFolder folder;
  const ContainmentAnswer written{.model = {"hull.json", sha256("h")},
                                  .mesh = {"b.stl", sha256("b")},
                                  .units = "mm",
                                  .containment = Containment::around,
                                  .certificate = {.apart = {{0, 4, {0.1, 0, 1}, {1, 2, 3}, {4, 5, 1.0 / 3.0}}},
                                                  .common = {{{0, 1, 2, 3}, {0.1, -0.2, 1.0 / 3.0}}}}};
  write_answer(folder / "proof.json", written);
  const auto read = std::get<ContainmentAnswer>(read_answer(folder / "proof.json"));
  EXPECT_EQ(read.model.sha256, written.model.sha256);
  EXPECT_EQ(read.units, "mm");
  EXPECT_EQ(read.containment, Containment::around);
  ASSERT_EQ(read.certificate.apart.size(), 1U);
  EXPECT_EQ(read.certificate.apart[0].on_b, written.certificate.apart[0].on_b);
  ASSERT_EQ(read.certificate.common.size(), 1U);
  EXPECT_EQ(read.certificate.common[0].primitives, written.certificate.common[0].primitives);
  EXPECT_EQ(read.certificate.common[0].point, written.certificate.common[0].point);
  std::ifstream in(folder / "proof.json");
  const nlohmann::json valid = nlohmann::json::parse(in);
  expect_refused_change(valid, "/containment", "beside", "must be \"within\" or \"around\"");
  expect_refused_change(valid, "/common/0/primitives", {0, 1, 2}, "must be an array of four indices");
  expect_refused_change(valid, "/common/0/primitives/0", -1, "must be an index");
  expect_refused_change(valid, "/apart/0/side", 1, "unknown key");
}

TEST(CertificateFile, OfFeaturesGivesTheSameBitsAgain) {
  const TemporaryFolder folder;
  FeaturesAnswer written{
      .implant = SubjectFile{"i.json", sha256("i")},
      .mesh = SubjectFile{"b.stl", sha256("b")},
      .claims = {.landmarks = {.head_centre = Point{0.1, 0.2, 0.3}, .head_radius = 24.1},
                 .side = Side::right,
                 .landmark_radius = 1.0 / 3.0,
                 .features = {{"ccd", "in space", FeatureUnit::degrees, {0.1, infinity}}},
                 .frame = FemurFrame{{0.1, 0.2, 0.3}, {{1, 0, 0}, 0.5}, {{0, 1, 0}, 0.25}, {{0, 0, 1}, 1.0 / 3.0}},
                 .implant = FemurLandmarks{.neck_centre = Point{1, 2, 3}},
                 .changes = {{"offset_change", "less", FeatureUnit::length, {-0.5, 0.5}}}}};
  write_answer(folder / "proof.json", written);
  const auto read = std::get<FeaturesAnswer>(read_answer(folder / "proof.json"));
  EXPECT_EQ(read.implant->sha256, written.implant->sha256);
  EXPECT_EQ(read.mesh->name, "b.stl");
  EXPECT_EQ(read.claims.landmarks, written.claims.landmarks);
  EXPECT_EQ(read.claims.side, Side::right);
  EXPECT_EQ(read.claims.landmark_radius, written.claims.landmark_radius);
  EXPECT_EQ(read.claims.features[0].name, "ccd");
  EXPECT_EQ(read.claims.features[0].unit, FeatureUnit::degrees);
  EXPECT_EQ(read.claims.features[0].value, written.claims.features[0].value);
  EXPECT_EQ(read.claims.frame->z.tilt_degrees, written.claims.frame->z.tilt_degrees);
  EXPECT_EQ(*read.claims.implant, *written.claims.implant);
  EXPECT_EQ(read.claims.changes[0].value, written.claims.changes[0].value);
}

EquilibriumAnswer equilibrium_answer() {
  return {.model = {"s.xml", sha256("s")},
          .parameters = {"mp", "px"},
          .joints = {"pelvis ty", "pelvis rz"},
          .cylinders = {"left", "right"},
          .claims = {.control = stance::JointControl::proportional,
                     .uncertain = {0, 1},
                     .ranges = {{49.5, 50.5}, {1.0 / 3.0, 0.5}},
                     .stands = 0.75,
                     .standing = stance::Standing{.positions = {{0.1, 0.2}, {-1.0 / 3.0, infinity}},
                                                  .torques = {{0.0, 0.0}, {-0.1, 0.7}},
                                                  .loads = {{{1.0, 2.0}, {0.1, 0.3}}, {{3.0, 4.0}, {0.2, 0.4}}},
                                                  .centre_of_pressure_x = {-0.01, 0.01},
                                                  .centre_of_pressure_z = {-infinity, 0.3},
                                                  .least_penetration = {0.1, 0.3}}},
          .certificate = {.reference = {0.1, -1.0, 1.0 / 7.0},
                          .parts = {{1, {}}, {{}, {{0.1, 0.3}, {-1.0 / 3.0, 0.7}}}, {}}}};
}

TEST(CertificateFile, OfAnEquilibriumGivesTheSameBitsAgain) {
  const TemporaryFolder folder;
  const EquilibriumAnswer written = equilibrium_answer();
  write_answer(folder / "proof.json", written);
  const auto read = std::get<EquilibriumAnswer>(read_answer(folder / "proof.json"));
  EXPECT_EQ(read.model.sha256, written.model.sha256);
  EXPECT_EQ(read.parameters, written.parameters);
  EXPECT_EQ(read.joints, written.joints);
  EXPECT_EQ(read.cylinders, written.cylinders);
  EXPECT_EQ(read.claims.control, written.claims.control);
  EXPECT_EQ(read.claims.uncertain, written.claims.uncertain);
  EXPECT_EQ(read.claims.ranges, written.claims.ranges);
  EXPECT_EQ(read.claims.stands, written.claims.stands);
  EXPECT_EQ(numbers_of(read.claims.standing.value()), numbers_of(written.claims.standing.value()));
  EXPECT_EQ(read.certificate.reference, written.certificate.reference);
  ASSERT_EQ(read.certificate.parts.size(), 3U);
  EXPECT_EQ(read.certificate.parts[0].halved, 1U);
  EXPECT_EQ(read.certificate.parts[1].postures, written.certificate.parts[1].postures);
  EXPECT_TRUE(read.certificate.parts[2].postures.empty());
}

TEST(CertificateFile, OfAnEquilibriumIsRefusedWhereItIsNone) {
  const TemporaryFolder folder;
  write_answer(folder / "proof.json", equilibrium_answer());
  std::ifstream in(folder / "proof.json");
  const nlohmann::json document = nlohmann::json::parse(in);
  const auto refused = [&](const std::string& pointer, const nlohmann::json& value, const std::string& message) {
    nlohmann::json other = document;
    other[nlohmann::json::json_pointer(pointer)] = value;
    expect_input_error([&] { (void)parse_answer(other.dump(), "proof.json"); }, "proof.json", ": " + message);
  };
  refused("/joints", "free", "joints = \"free\": must be \"held\" or \"proportional\"");
  refused("/uncertain/1/parameter", "mp", "uncertain[1].parameter = \"mp\": is named before");
  refused("/uncertain/0/hi", 49.0, "uncertain[0].hi = 49.0: must not be below the lower end");
  refused("/uncertain/0/hi", "inf", "uncertain[0].hi = \"inf\": must be a number");
  refused("/stands", 1.5, "stands = 1.5: must be at most 1");
  refused("/standing/joints/1/joint", "pelvis ty", "standing.joints[1].joint = \"pelvis ty\": is named before");
  refused("/standing/least_penetration", 0.1, "standing.least_penetration = 0.1: must be an object");
  refused("/reference", {0, 1}, "reference = [0,1]: must be an array of 3 numbers");
  refused("/parts/0/halved", 2, "parts[0].halved = 2: must be the index of an uncertain parameter");
  refused("/parts/0/postures", nlohmann::json::array({{0, 1}}),
          "parts[0].postures = [...]: must not be of a part that is halved");
  refused("/parts/1/postures/0", {1, 0}, "parts[1].postures[0][1] = 0: must not be below the lower end");
  refused("/parts/1/postures", nlohmann::json::array(), "parts[1].postures = []: must not be empty");
  refused("/parts/3", nlohmann::json::object(), "parts[3] = {}: is beyond the last part of the box");
  refused("/parts", {{{"halved", 0}}}, "parts = [...]: must have two parts for each that is halved");
}

TEST(CertificateFile, IsRefusedWhereItWouldBeTooLarge) {
  const TemporaryFolder folder;
  const PairAnswer one = answer();
  PoseAnswers many{one.models, one.units, {}};
  many.answers.resize(300'000, {one.pose, one.distance, one.certificate});
  EXPECT_THAT([&] { write_answer(folder / "proof.json", many); },
              ThrowsMessage<Error>(HasSubstr("67108864 bytes of a certificate file: give fewer poses")));
  EXPECT_FALSE(std::filesystem::exists(folder / "proof.json"));
}

TEST(CertificateFile, OfAPathGivesTheSameBitsAgain) {
  const TemporaryFolder folder;
  const PairAnswer pair = answer();
  const PathAnswer written{.models = pair.models,
                           .units = "mm",
                           .path = {{{0.1, -0.0, 5e-324}, {1.0, 2.0, 3.0, 4.0}}, {}},
                           .claims = {{1.0 / 3.0, 0.4}, Enclosure{1e-300, infinity}},
                           .certificate = {0.625, pair.certificate, {{0.5, {}}, {2.0 / 3.0, pair.certificate}}}};
  write_answer(folder / "proof.json", written);
  const auto read = std::get<PathAnswer>(read_answer(folder / "proof.json"));
  EXPECT_EQ(read.models[1].sha256, written.models[1].sha256);
  EXPECT_EQ(read.units, "mm");
  ASSERT_EQ(read.path.size(), 2U);
  EXPECT_EQ(read.path[0].translation, written.path[0].translation);
  EXPECT_EQ(read.path[0].quaternion, written.path[0].quaternion);
  EXPECT_EQ(read.claims, written.claims);
  EXPECT_EQ(read.certificate.nearest, 0.625);
  expect_same_rest(read.certificate.at_nearest, written.certificate.at_nearest);
  ASSERT_EQ(read.certificate.parts.size(), 2U);
  EXPECT_EQ(read.certificate.parts[1].until, 2.0 / 3.0);
  EXPECT_EQ(read.certificate.parts[1].certificate.separations.size(), 2U);
  expect_same_rest(read.certificate.parts[1].certificate, written.certificate.parts[1].certificate);
}

TEST(CertificateFile, OfAWayInGivesTheSameBitsAgain) {
  const TemporaryFolder folder;
  const std::string hash(64, 'a');
  Certificate deep{{{3, {0.1, -1e-320, 1e300}}}, Point{1.0 / 3.0, 0.0, -2.0}};
  deep.witness = Point{0.5, 0.25, 1e-5};
  deep.cover = {true, false, true, false, false};
  const auto divided_cube = [] {
    RemovedVolumeCertificate cube{.centre = {0.1, -2.0, 1e-7}, .half_width = 0.25};
    cube.cubes.assign(17, CubeDivision::none);
    cube.cubes[0] = cube.cubes[3] = CubeDivision::divided;
    return cube;
  };
  const InsertionCertificate certificate{0.625, deep, {{0.5, {{{1, 2, 3}, {4, 5, 6}}}, deep}, {2.0, {}, {}}}};
  const InsertionAnswer written{.model = {"m.json", hash},
                                .mesh = {"b.stl", hash},
                                .units = "mm",
                                .pose = Pose{{1.0, 2.0, 3.0}, {0.5, 0.5, 0.5, 0.5}},
                                .path = {Pose{}, Pose{{0.1, 0.0, 0.0}, {1.0, 0.1, 0.0, 0.0}}},
                                .rows = {{{-infinity, 0.1}, certificate}, {{-0.5, infinity}, {}}},
                                .removed = RemovalAnswer{.bone = BoneSide::outside,
                                                         .within = SubjectFile{"f.stl", hash},
                                                         .resection = Plane{{0.1, 1e-300, 2.0}, {0.0, 0.5, -1.0 / 3.0}},
                                                         .volume = {1.0 / 3.0, infinity},
                                                         .certificate = divided_cube()}};
  write_answer(folder / "way.json", written);
  const Answer any = read_answer(folder / "way.json");
  const auto& read = std::get<InsertionAnswer>(any);
  EXPECT_EQ(read.pose->quaternion, written.pose->quaternion);
  ASSERT_EQ(read.path.size(), 2U);
  EXPECT_EQ(read.path[1].translation, written.path[1].translation);
  ASSERT_EQ(read.rows.size(), 2U);
  for (std::size_t n = 0; n < 2; ++n) {
    EXPECT_EQ(read.rows[n].distance, written.rows[n].distance);
    EXPECT_EQ(read.rows[n].certificate, written.rows[n].certificate);
  }
  ASSERT_TRUE(read.removed && read.removed->within && read.removed->resection);
  const RemovalAnswer& removed = *read.removed;
  EXPECT_EQ(removed.bone, BoneSide::outside);
  EXPECT_EQ(removed.within->name, "f.stl");
  EXPECT_EQ(removed.resection->point, written.removed->resection->point);
  EXPECT_EQ(removed.resection->normal, written.removed->resection->normal);
  EXPECT_EQ(removed.volume, written.removed->volume);
  EXPECT_EQ(removed.certificate.centre, divided_cube().centre);
  EXPECT_EQ(removed.certificate.half_width, divided_cube().half_width);
  EXPECT_EQ(removed.certificate.cubes, divided_cube().cubes);
}

/// Whatever its cubes are, they are read; what is no letter, side or number is refused.
TEST(CertificateFileTest, RemovedVolumesAreOfLettersAndSides) {
  const std::string digest(64, 'a');
  const auto text = [&](const std::string& removed) {
    return fmt::format(R"({{"format": "verisq-certificate/1", "kind": "insertion",
      "models": [{{"file": "m", "sha256": "{0}"}}], "mesh": {{"file": "b", "sha256": "{0}"}},
      "path": [{{"translation": [0, 0, 0], "quaternion": [1, 0, 0, 0]}}], "rows": [], "removed": {1}}})",
                       digest, removed);
  };
  const auto claim = [&](const std::string& bone, const std::string& width, const std::string& parts) {
    return text(fmt::format(R"({{"lo": 0, "hi": 1, "bone": "{}", "cube": {{"centre": [0, 0, 0], "half_width": {},
                               "parts": "{}"}}}})",
                            bone, width, parts));
  };
  const auto refused = [&](const std::string& json, const std::string& why) {
    try {
      (void)parse_answer(json, "c.json");
      ADD_FAILURE() << why;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), ::testing::HasSubstr(why));
    }
  };
  EXPECT_EQ(
      std::get<InsertionAnswer>(parse_answer(claim("inside", "0", ""), "c.json")).removed->certificate.cubes.size(),
      0U);
  refused(claim("beside", "1", "."), "bone = \"beside\": must be \"inside\" or \"outside\"");
  refused(claim("inside", "-1", "."), "half_width = -1: must be at least 0");
  refused(claim("inside", "1", "dx"), "must consist of the letters d and .");
  refused(claim("inside", "1", std::string((std::size_t{1} << 23U) + 1, '.')), "must be no more than 8388608 parts");
  refused(text(R"({"lo": 0, "hi": 1, "bone": "inside"})"), "cube");
}

}  // namespace
}  // namespace verisq
