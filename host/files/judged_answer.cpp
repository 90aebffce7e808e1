/// Proves the answers of certificate files again, claim by claim, from the files that they are about.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>
#include <verisq/certificate_file.hpp>
#include <verisq/files.hpp>
#include <verisq/map_file.hpp>

#include "host/errors/refusal.hpp"
#include "host/files/input_file.hpp"
#include "host/files/model_file.hpp"
#include "verify/proof/triangle_tree.hpp"

namespace verisq {

std::uint64_t JudgedAnswer::unbounded() const {
  return static_cast<std::uint64_t>(std::ranges::count_if(claims, &JudgedClaim::is_unbounded));
}

bool JudgedAnswer::all_proved() const {
  const auto is_proved = [](const JudgedClaim& claim) { return claim.finding.verdict == Verdict::proved; };
  return !interrupted && !claims.empty() && unbounded() == 0 && std::ranges::all_of(claims, is_proved);
}

namespace {

std::string exact_text(const Enclosure& enclosure) {
  return fmt::format("[{:.17g}, {:.17g}]", enclosure.lo, enclosure.hi);
}

bool has_no_end(const Enclosure& claimed) {
  return !std::isfinite(claimed.width());
}

/// A distance, an area or a share: they have a lower end by themselves.
JudgedClaim bounded_below(std::string of, std::string what, const Enclosure& claimed, const Finding& finding) {
  return {std::move(of), std::move(what), "", claimed, finding, !std::isfinite(claimed.hi)};
}

JudgedClaim number(std::string of, std::string what, const Enclosure& claimed, const Finding& finding) {
  return {std::move(of), std::move(what), "", claimed, finding, has_no_end(claimed)};
}

JudgedClaim statement(std::string of, std::string what, Verdict verdict) {
  const Enclosure proven = verdict == Verdict::proved    ? Enclosure{1.0, 1.0}
                           : verdict == Verdict::refuted ? Enclosure{0.0, 0.0}
                                                         : Enclosure{0.0, 1.0};
  return {std::move(of), std::move(what), "", {1.0, 1.0}, {verdict, proven}, false};
}

}  // namespace

// Judges answers about subjects that were read before.

JudgedAnswer judge(const PathAnswer& answer, const Model& a, const Model& b, const CheckOptions& options) {
  const PathClaims proven = PathChecker(a, b, answer.path).prove(answer.certificate, options);
  JudgedAnswer judged{.claims = {}, .parts = answer.certificate.parts.size(), .interrupted = options.interrupted()};
  if (judged.interrupted) return judged;
  const auto& [smallest, first_contact] = answer.claims;
  const PathFindings findings = check(answer.claims, proven);
  judged.claims.push_back(bounded_below("", "smallest distance of all times", smallest, findings.smallest));
  judged.claims.back().unit = answer.units;
  if (findings.first_contact)
    judged.claims.push_back({"", "time of the first contact", "", *first_contact, *findings.first_contact});
  return judged;
}

namespace {

void refuse_other_sizes(const DeviationAnswer& answer, const Mesh& mesh, const std::string& name) {
  const auto& [vertices, triangles, surface] = answer.certificate;
  if (vertices.size() == mesh.vertices.size() && triangles.size() == mesh.triangles.size()) return;
  refuse(fmt::format("{}: is of {} vertices and {} triangles, and there are {} and {}", name, vertices.size(),
                     triangles.size(), mesh.vertices.size(), mesh.triangles.size()));
}

std::string percentile_in_words(const DeviationAnswer& answer, std::size_t i) {
  return fmt::format("{} %", answer.percentiles[i]);
}

void add_claims(const DeviationAnswer& answer, const char* of, const DistanceSummary& claimed,
                const DistanceSummary& proven, std::vector<JudgedClaim>& claims) {
  const std::vector<Finding> findings = check(claimed, proven);
  claims.push_back(bounded_below(of, "largest", claimed.largest, findings[0]));
  claims.push_back(bounded_below(of, "mean", claimed.mean, findings[1]));
  for (std::size_t i = 0; i < answer.percentiles.size(); ++i)
    claims.push_back(bounded_below(of, percentile_in_words(answer, i), claimed.percentiles[i], findings[2 + i]));
}

/// What is claimed of the model's surface, if anything.
void add_other_way(const DeviationAnswer& answer, const ProvenDeviation& proven, std::vector<JudgedClaim>& claims) {
  if (!proven.from_model) return;
  const auto add = [&](const char* of, const std::string& what, const Enclosure& claimed, const Finding& finding) {
    claims.push_back(bounded_below(of, what, claimed, finding));
  };
  add("model", "largest", *answer.from_model, check(*answer.from_model, *proven.from_model));
  if (const auto& claimed = answer.statistics_from_model) {
    const std::vector<Finding> findings = check(*claimed, *proven.statistics_from_model);
    add("model", "mean", claimed->mean, findings[0]);
    for (std::size_t i = 0; i < answer.percentiles.size(); ++i)
      add("model", percentile_in_words(answer, i), claimed->percentiles[i], findings[1 + i]);
  }
  add("both", "largest", *answer.hausdorff, check(*answer.hausdorff, *proven.hausdorff));
}

bool is_cloud(const DeviationAnswer& answer) {
  return answer.certificate.triangles.empty();
}

}  // namespace

JudgedAnswer judge(const DeviationAnswer& answer, const std::string& name, const Model& model, const Mesh& mesh,
                   const CheckOptions& options) {
  refuse_other_sizes(answer, mesh, name);
  const ProvenDeviation proven =
      DeviationChecker(model)(mesh, answer.certificate,
                              {.percentiles = answer.percentiles,
                               .statistics_of_model = answer.statistics_from_model.has_value(),
                               .check = options});
  JudgedAnswer judged{{}, proven.samples, proven.unproved_samples, proven.interrupted};
  if (proven.interrupted) return judged;
  if (answer.from_mesh) add_claims(answer, "mesh", *answer.from_mesh, *proven.from_mesh, judged.claims);
  add_claims(answer, is_cloud(answer) ? "points" : "vertices", answer.of_vertices, proven.of_vertices, judged.claims);
  add_other_way(answer, proven, judged.claims);
  return judged;
}

namespace {

void refuse_other_sizes(const ContactAnswer& answer, const Model& model, const Mesh& mesh, const std::string& name) {
  const auto& [vertices, divided, surface] = answer.certificate;
  const std::size_t triangles = mesh.triangles.size();
  if (vertices.size() != mesh.vertices.size())
    refuse(fmt::format("{}: is of {} vertices, and the mesh has {}", name, vertices.size(), mesh.vertices.size()));
  if (!divided.empty() && divided.back().triangle >= triangles)
    refuse(fmt::format("{}: names triangle {}, of {}", name, divided.back().triangle, triangles));
  if (!answer.regions.empty() && points_of(answer.region_runs) != triangles)
    refuse(fmt::format("{}: region_runs: are of {} triangles, and the mesh has {}", name, points_of(answer.region_runs),
                       triangles));
  if (surface && answer.counted.size() != model.primitives.size())
    refuse(fmt::format("{}: has patches of {} primitives, and the model has {}", name, answer.counted.size(),
                       model.primitives.size()));
  if (surface && triangles == 0) refuse(fmt::format("{}: is of a mesh, and there are no triangles", name));
}

void add_claims(const std::string& of, const ContactClaim& claimed, const AreaWithin& proven,
                std::vector<JudgedClaim>& claims) {
  const auto [area, within, percent] = check(claimed, proven);
  claims.push_back(bounded_below(of, "area", claimed.area, area));
  claims.push_back(bounded_below(of, "within", claimed.within, within));
  claims.push_back(bounded_below(of, "percent", claimed.percent, percent));
}

}  // namespace

JudgedAnswer judge(const ContactAnswer& answer, const std::string& name, const Model& model, const Mesh& mesh,
                   const CheckOptions& options) {
  refuse_other_sizes(answer, model, mesh, name);
  const ProvenContact proven = ContactChecker(model)(mesh, terms_of(answer), answer.certificate, options);
  JudgedAnswer judged{{}, proven.samples, proven.unproved_samples, proven.interrupted};
  if (proven.interrupted) return judged;
  add_claims("contact", answer.claims.of_mesh, proven.of_mesh, judged.claims);
  for (std::size_t r = 0; r < answer.regions.size(); ++r)
    add_claims("contact:" + answer.regions[r], answer.claims.by_region[r], proven.by_region[r], judged.claims);
  if (const auto& claimed = answer.claims.of_model)
    add_claims("implant_contact", *claimed, *proven.of_model, judged.claims);
  return judged;
}

namespace {

/// The claims with the model's own indices. Throws Error(input) for names that it does not have.
stance::EquilibriumClaims claims_of(const EquilibriumAnswer& answer, const stance::Model& model,
                                    const std::string& name) {
  stance::EquilibriumClaims claims = answer.claims;
  for (std::size_t i = 0; i < answer.parameters.size(); ++i) {
    const auto found = std::ranges::find(model.parameters, answer.parameters[i], &stance::Parameter::name);
    if (found == model.parameters.end())
      refuse(fmt::format("{}: the model has no parameter {}", name, quotation(answer.parameters[i])));
    const Enclosure& range = claims.ranges[i];
    if (range.lo < found->range.lo || range.hi > found->range.hi) {
      refuse(fmt::format("{}: {} in {} is not within the model's range, {}", name, quotation(found->name),
                         exact_text(range), exact_text(found->range)));
    }
    claims.uncertain[i] = static_cast<std::uint32_t>(found - model.parameters.begin());
  }
  if (!claims.standing) return claims;
  if (answer.joints != stance::joint_names(model))
    refuse(fmt::format("{}: its joints are not those of the model, in their order", name));
  if (!std::ranges::equal(answer.cylinders, model.cylinders, {}, {}, &stance::ContactCylinder::name))
    refuse(fmt::format("{}: its cylinders are not those of the model, in their order", name));
  return claims;
}

/// Adds the numbers of a body that stands, in the order of `stance::check`.
void add_numbers(const stance::Standing& standing, const stance::Model& model, std::span<const Finding> findings,
                 std::vector<JudgedClaim>& claims) {
  const std::vector<Enclosure> numbers = stance::numbers_of(standing);
  auto add = [&, i = std::size_t{0}](const std::string& of, const char* what, const char* unit) mutable {
    claims.push_back(number(of, what, numbers[i], findings[i]));
    claims.back().unit = unit;
    ++i;
  };
  const std::vector<std::string> joints = stance::joint_names(model);
  std::vector<bool> turns;
  for (const stance::Body& body : model.bodies)
    for (const stance::Joint& joint : body.joints) turns.push_back(joint.kind == stance::JointKind::rotation);
  for (std::size_t k = 0; k < joints.size(); ++k) add(joints[k], "position of ", turns[k] ? "rad" : "m");
  for (std::size_t k = 0; k < joints.size(); ++k) add(joints[k], "torque that holds ", turns[k] ? "N m" : "N");
  for (const stance::ContactCylinder& cylinder : model.cylinders) {
    add(cylinder.name, "force on ", "N");
    add(cylinder.name, "penetration of ", "m");
  }
  add("", "centre of pressure, x", "m");
  add("", "centre of pressure, z", "m");
  add("", "least penetration of all points", "m");
}

}  // namespace

JudgedAnswer judge(const EquilibriumAnswer& answer, const std::string& name, const stance::Model& model,
                   const CheckOptions& options) {
  const stance::EquilibriumClaims claims = claims_of(answer, model, name);
  const stance::ProvenEquilibrium proven = stance::prove(model, claims, answer.certificate, options);
  JudgedAnswer judged{{}, proven.parts, proven.unproved_parts, proven.interrupted};
  if (proven.interrupted) return judged;
  const std::vector<Finding> findings = stance::check(claims, proven);
  judged.claims.push_back(number("", "share of the box that has an equilibrium on all cylinders, at least",
                                 {claims.stands, 1.0}, findings.front()));
  if (claims.standing) add_numbers(*claims.standing, model, std::span(findings).subspan(1), judged.claims);
  return judged;
}

JudgedAnswer judge(const FeaturesAnswer& answer) {
  const FeatureFindings findings = check(answer.claims);
  JudgedAnswer judged;
  const auto add = [&](const std::string& of, const std::string& what, FeatureUnit unit, const Enclosure& claimed,
                       const Finding& finding) {
    const bool is_angle = unit == FeatureUnit::degrees;
    const bool any_angle = is_angle && claimed.lo <= 0.0 && claimed.hi >= 180.0;
    judged.claims.push_back(
        {of, what, is_angle ? "degrees" : "mm", claimed, finding, any_angle || has_no_end(claimed)});
  };
  const auto add_all = [&](const std::vector<Feature>& features, const std::vector<Finding>& found) {
    for (std::size_t i = 0; i < features.size(); ++i)
      add(features[i].name, features[i].method, features[i].unit, features[i].value, found[i]);
  };
  add_all(answer.claims.features, findings.features);
  if (const auto& frame = answer.claims.frame) {
    const std::array axes{&frame->x, &frame->y, &frame->z};
    for (std::size_t i = 0; i < axes.size(); ++i)
      add(fmt::format("frame_{}", "xyz"[i]), "how far the axis tilts from the direction that is stated",
          FeatureUnit::degrees, {0.0, axes[i]->tilt_degrees}, (*findings.frame)[i]);
  }
  add_all(answer.claims.changes, findings.changes);
  return judged;
}

namespace {

// The files that answers are about.

void refuse_other_digest(const std::string& digest, const std::filesystem::path& file, const char* what,
                         const SubjectFile& expected, const std::string& name) {
  if (digest == expected.sha256) return;
  refuse(fmt::format("{}: {} is about another {}: its SHA-256 is {}, not {}", file.string(), name, what,
                     expected.sha256, digest));
}

}  // namespace

std::string subject_bytes(const std::filesystem::path& file, const char* what, const SubjectFile& expected,
                          const std::string& name) {
  InputFile input(file);
  std::string bytes(input.peek(std::numeric_limits<std::size_t>::max()));
  refuse_other_digest(digest_of_model(bytes, file), file, what, expected, name);
  return bytes;
}

Model subject_model(const std::filesystem::path& file, const SubjectFile& expected, const std::string& name) {
  const std::string bytes = subject_bytes(file, "model", expected, name);
  return is_mesh_name(file) ? model_of_mesh(parse_mesh(bytes, file), file) : parse_model(bytes, file.string());
}

Mesh subject_mesh(const std::filesystem::path& file, const SubjectFile& expected, const std::string& name) {
  return parse_mesh(subject_bytes(file, "mesh", expected, name), file);
}

void refuse_other_file(const std::filesystem::path& file, const char* what, const SubjectFile& expected,
                       const std::string& name) {
  refuse_other_digest(subject_file(file).sha256, file, what, expected, name);
}

namespace {

/// Reads the subjects of an answer, and judges it.
class Judge {
 public:
  Judge(const std::string& name, const AnswerFiles& files, const CheckOptions& options)
      : name_(name), files_(files), options_(options) {}

  JudgedAnswer operator()(const PairAnswer& answer) const {
    const auto [a, b] = two_models(answer.models);
    const Finding finding = PairChecker(a, b)(answer.pose, answer.distance, answer.certificate, options_.interrupted);
    std::vector<JudgedClaim> claims{bounded_below("", "distance", answer.distance, finding)};
    if (const auto& claimed = answer.penetration) {
      const PenetrationChecker checker(a, b);
      claims.push_back(bounded_below("", "penetration depth", claimed->depth,
                                     checker(answer.pose, claimed->depth, claimed->certificate, options_.interrupted)));
    }
    return ended(std::move(claims));
  }

  JudgedAnswer operator()(const PoseAnswers& answers) const {
    const auto [a, b] = two_models(answers.models);
    const PairChecker checker(a, b);
    const auto& all = answers.answers;
    std::vector<JudgedClaim> claims(all.size());
    options_.in_parallel(all.size(), [&](std::size_t i) {
      const auto& [pose, distance, certificate] = all[i];
      claims[i] = bounded_below(fmt::format("pose {}", i), "distance", distance,
                                checker(pose, distance, certificate, options_.interrupted));
    });
    return ended(std::move(claims));
  }

  JudgedAnswer operator()(const PathAnswer& answer) const {
    const auto [a, b] = two_models(answer.models);
    return judge(answer, a, b, options_);
  }

  JudgedAnswer operator()(const FitAnswer& answer) const;
  JudgedAnswer operator()(const BestFitAnswer& answer) const;
  JudgedAnswer operator()(const InsertionAnswer& answer) const;

  JudgedAnswer operator()(const DeviationAnswer& answer) const {
    const Model model = moved_model(answer.pose, answer.model);
    if (!is_cloud(answer)) return judge(answer, name_, model, mesh(answer.mesh), options_);
    const Mesh cloud = read_cloud(given(files_.mesh, "mesh"));
    refuse_other_file(files_.mesh, "cloud", answer.mesh, name_);
    return judge(answer, name_, model, cloud, options_);
  }

  JudgedAnswer operator()(const ContactAnswer& answer) const {
    return judge(answer, name_, one_model(answer.model), mesh(answer.mesh), options_);
  }

  JudgedAnswer operator()(const ContainmentAnswer& answer) const {
    const ContainmentChecker checker(one_model(answer.model), mesh(answer.mesh));
    const char* const what = answer.containment == Containment::within
                                 ? "every point of the model lies in the mesh's solid"
                                 : "every point of the mesh's solid lies in the model";
    return ended({statement("", what, checker(answer.containment, answer.certificate, options_).verdict)});
  }

  JudgedAnswer operator()(const EquilibriumAnswer& answer) const {
    const std::string file = model_file(0, 1);
    const std::string xml = subject_bytes(file, "model", answer.model, name_);
    return judge(answer, name_, stance::parse_model(xml, file), options_);
  }

  /// The landmarks are all the proof: files may be left out, and must be the right ones where they are given.
  JudgedAnswer operator()(const FeaturesAnswer& answer) const {
    if (!files_.models.empty()) {
      const auto& about = answer.implant ? answer.implant : answer.mesh;  // landmarks may have been found in a model
      if (!about) refuse(fmt::format("{}: is about no model: give none", name_));
      refuse_other_file(model_file(0, 1), answer.implant ? "implant" : "model", *about, name_);
    }
    if (!files_.mesh.empty()) {
      if (!answer.mesh) refuse(fmt::format("{}: is about no mesh: give none", name_));
      refuse_other_file(files_.mesh, "mesh", *answer.mesh, name_);
    }
    return judge(answer);
  }

 private:
  const std::filesystem::path& given(const std::filesystem::path& file, const char* argument) const {
    if (file.empty()) refuse(fmt::format("{}: give the `{}`", name_, argument));
    return file;
  }

  [[nodiscard]] std::string model_file(std::size_t i, std::size_t expected) const {
    if (files_.models.size() != expected)
      refuse(fmt::format("{}: is about {} models: give each, in its order, not {}", name_, expected,
                         files_.models.size()));
    return files_.models[i].string();
  }

  [[nodiscard]] Model one_model(const SubjectFile& expected, std::size_t i = 0, std::size_t of = 1) const {
    return subject_model(model_file(i, of), expected, name_);
  }
  [[nodiscard]] std::array<Model, 2> two_models(const std::array<SubjectFile, 2>& expected) const {
    return {one_model(expected[0], 0, 2), one_model(expected[1], 1, 2)};
  }
  [[nodiscard]] Model moved_model(const std::optional<Pose>& pose, const SubjectFile& expected) const {
    const Model model = one_model(expected);
    return pose ? posed(model, *pose) : model;
  }
  [[nodiscard]] Mesh mesh(const SubjectFile& expected) const {
    return subject_mesh(given(files_.mesh, "mesh"), expected, name_);
  }

  void refuse_other_count(const StatedTerms& terms, const Mesh& bone) const {
    if (points_of(terms) == bone.vertices.size()) return;
    refuse(fmt::format("{}: area_runs: are of {} vertices, and the mesh has {}", name_, points_of(terms),
                       bone.vertices.size()));
  }

  /// After an interruption nothing is said: a verdict may be of half the work.
  [[nodiscard]] JudgedAnswer ended(std::vector<JudgedClaim> claims) const {
    const bool interrupted = options_.interrupted();
    return {interrupted ? std::vector<JudgedClaim>() : std::move(claims), 0, 0, interrupted};
  }

  /// Encloses the distance of each element by the certificate of its row; a row that proves nothing bounds nothing.
  template <class Element>
  std::vector<Enclosure> proven_rows(const std::filesystem::path& file, MapElements kind, const Model& model,
                                     const std::vector<Element>& elements) const;

  [[nodiscard]] std::vector<JudgedClaim> judged_sides(const FitAnswer& answer, const Model& model,
                                                      const Mesh& bone) const;
  [[nodiscard]] std::vector<Finding> judged_rows(const InsertionAnswer& answer, const Model& implant,
                                                 const Mesh& bone) const;
  [[nodiscard]] JudgedClaim judged_removal(const InsertionAnswer& answer, const Model& implant, const Mesh& bone) const;

  const std::string& name_;
  const AnswerFiles& files_;
  const CheckOptions& options_;
};

template <class Element>
std::vector<Enclosure> Judge::proven_rows(const std::filesystem::path& file, MapElements kind, const Model& model,
                                          const std::vector<Element>& elements) const {
  MapReader map(file);
  if (map.elements() != kind)
    refuse(fmt::format("{}: is no map of {}", file.string(), kind == MapElements::vertices ? "vertices" : "triangles"));
  std::vector<CertifiedRow> rows(elements.size() + 1);
  const std::size_t count = map.read(rows);
  if (count != elements.size())
    refuse(fmt::format("{}: has not one row for each of {} {}", file.string(), elements.size(),
                       kind == MapElements::vertices ? "vertices" : "triangles"));
  const Checker checker(model);
  std::vector<Enclosure> proven(count, {-infinity, infinity});
  options_.in_parallel(count, [&](std::size_t i) {
    proven[i] = checker(elements[i], rows[i].result.distance, rows[i].certificate, options_.interrupted).proven;
  });
  return proven;
}

std::vector<JudgedClaim> Judge::judged_sides(const FitAnswer& answer, const Model& model, const Mesh& bone) const {
  std::vector<JudgedClaim> claims;
  if (answer.sides.empty()) return claims;
  const SideChecker checker(model, bone, answer.terms.penetration_limit);
  for (const SideClaim& claim : answer.sides) {
    if (claim.primitive >= model.primitives.size())
      refuse(fmt::format("{}: sides: primitive {}, and the model has {}", name_, claim.primitive,
                         model.primitives.size()));
    claims.push_back(statement(name_of_primitive(model, claim.primitive),
                               fmt::format("lies {} of the mesh, but for the penetration limit", to_string(claim.side)),
                               verdict_of(checker(claim, options_))));
  }
  return claims;
}

JudgedAnswer Judge::operator()(const FitAnswer& answer) const {
  const Model model = one_model(answer.model);
  const Mesh bone = mesh(answer.mesh);
  refuse_other_count(answer.terms, bone);
  const std::vector<Enclosure> distances =
      proven_rows(given(files_.map, "map"), MapElements::vertices, model, bone.vertices);
  std::optional<Enclosure> surface;
  if (!files_.surface_map.empty()) {
    surface = Enclosure{infinity, infinity};
    for (const Enclosure& each :
         proven_rows(files_.surface_map, MapElements::triangles, model, verify::triangles_of(bone)))
      surface = {std::min(surface->lo, each.lo), std::min(surface->hi, each.hi)};
  }
  const std::vector<Finding> findings = check(answer.claims, clearance_of(terms_of(answer.terms), distances), surface);
  std::vector<JudgedClaim> claims;
  for (std::size_t i = 0; i < findings.size(); ++i)
    claims.push_back(number(answer.claims[i].area, answer.claims[i].what, answer.claims[i].value, findings[i]));
  for (JudgedClaim& side : judged_sides(answer, model, bone)) claims.push_back(std::move(side));
  return ended(std::move(claims));
}

JudgedAnswer Judge::operator()(const BestFitAnswer& answer) const {
  std::vector<Model> implants;
  for (std::size_t i = 0; i < answer.models.size(); ++i)
    implants.push_back(one_model(answer.models[i], i, answer.models.size()));
  const Mesh bone = mesh(answer.mesh);
  refuse_other_count(answer.terms, bone);
  const BestFitClaim claim = claim_of(answer);
  const ProvenBestFit proven = BestFitChecker(implants, bone.vertices, claim)(answer.certificate, options_);
  JudgedAnswer judged =
      ended({bounded_below("", "F of any pose that keeps the limit, at most", {-infinity, answer.upper},
                           {check(claim, proven), {-infinity, proven.upper}})});
  judged.parts = proven.boxes;
  return judged;
}

std::vector<Finding> Judge::judged_rows(const InsertionAnswer& answer, const Model& implant, const Mesh& bone) const {
  if (answer.rows.empty()) return {};
  if (bone.vertices.size() != answer.rows.size())
    refuse(fmt::format("{}: {} rows for the {} vertices of {}", name_, answer.rows.size(), bone.vertices.size(),
                       files_.mesh.string()));
  const InsertionChecker checker(implant, answer.path);
  std::vector<Finding> findings(answer.rows.size());
  options_.in_parallel(findings.size(), [&](std::size_t i) {
    const auto& [claimed, certificate] = answer.rows[i];
    findings[i] = checker(bone.vertices[i], claimed, certificate, options_.interrupted);
  });
  return findings;
}

JudgedClaim Judge::judged_removal(const InsertionAnswer& answer, const Model& implant, const Mesh& bone) const {
  const RemovalAnswer& removed = *answer.removed;
  BoneRegion region{.surfaces = {{bone, removed.bone}}, .resection = removed.resection};
  if (removed.within)
    region.surfaces.push_back({subject_mesh(given(files_.within, "within"), *removed.within, name_), BoneSide::inside});
  const ProvenRemovedVolume proven = RemovedVolumeChecker(implant, answer.path, region)(removed.certificate, options_);
  return number("bone", "removed volume", removed.volume, check(removed.volume, proven.volume));
}

JudgedAnswer Judge::operator()(const InsertionAnswer& answer) const {
  const Model implant = moved_model(answer.pose, answer.model);
  const Mesh bone = mesh(answer.mesh);
  std::vector<JudgedClaim> claims;
  const std::vector<Finding> rows = judged_rows(answer, implant, bone);
  std::vector<Enclosure> proven;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    claims.push_back(number(fmt::format("vertex {}", i), "smallest distance", answer.rows[i].distance, rows[i]));
    proven.push_back(rows[i].proven);
  }
  if (const auto& surface = answer.surface) {
    const Finding finding =
        WaySurfaceChecker(implant, answer.path, bone)(proven, surface->distance, surface->certificate, options_);
    claims.push_back(number("whole surface", "smallest distance", surface->distance, finding));
  }
  if (answer.removed) claims.push_back(judged_removal(answer, implant, bone));
  return ended(std::move(claims));
}

/// A file that the answer does not need would seem to be proven something about.
void refuse_needless_files(const Answer& answer, const std::string& name, const AnswerFiles& files) {
  const auto refuse_unless = [&](bool is_needed, const std::filesystem::path& file, const char* argument) {
    if (!is_needed && !file.empty()) refuse(fmt::format("{}: needs no `{}`: {}", name, argument, file.string()));
  };
  const bool is_fit = std::holds_alternative<FitAnswer>(answer);
  const auto* const insertion = std::get_if<InsertionAnswer>(&answer);
  const bool has_mesh = std::visit(
      [](const auto& kind) {
        return requires {
          kind.mesh;
        };
      },
      answer);
  refuse_unless(has_mesh, files.mesh, "mesh");
  refuse_unless(insertion != nullptr && insertion->removed && insertion->removed->within, files.within, "within");
  refuse_unless(is_fit, files.map, "map");
  refuse_unless(is_fit, files.surface_map, "surface_map");
}

}  // namespace

JudgedAnswer judge(const Answer& answer, const std::string& name, const AnswerFiles& files,
                   const CheckOptions& options) {
  refuse_needless_files(answer, name, files);
  return std::visit(Judge(name, files, options), answer);
}

}  // namespace verisq
