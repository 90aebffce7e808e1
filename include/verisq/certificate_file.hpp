/// Reads and writes answers with their proofs: `verisq-certificate/1` (JSON), docs/formats.md §9.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/clearance.hpp>
#include <verisq/deviation.hpp>
#include <verisq/distance.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/features.hpp>
#include <verisq/fit.hpp>
#include <verisq/insertion.hpp>
#include <verisq/mesh.hpp>
#include <verisq/mesh_topology.hpp>
#include <verisq/model.hpp>
#include <verisq/path.hpp>
#include <verisq/penetration.hpp>
#include <verisq/recovery.hpp>
#include <verisq/stance.hpp>
#include <verisq/stance_equilibrium.hpp>

namespace verisq {

/// A file that an answer is about.
struct SubjectFile {
  std::string name;    ///< as it was called; only for people
  std::string sha256;  ///< of its bytes, 64 lower-case hexadecimal digits; of a model: and of the meshes that it names
};

/// Reads the file to its end, and the mesh files that it names if it is a model: their bytes are taken behind its own,
/// in the order of the primitives. Throws Error(input).
[[nodiscard]] SubjectFile subject_file(const std::filesystem::path& path);

/// The kind `pair`: the distance of model A and of model B moved by `pose`, with its proof.
struct PairAnswer {
  std::array<SubjectFile, 2> models;  ///< A, B
  std::string units;                  ///< free text; empty when not given
  Pose pose;
  Enclosure distance;  ///< the claim: what a checker proves, refutes or leaves open
  PairCertificate certificate;
  std::optional<CertifiedPenetration> penetration = {};  ///< another claim: how deep they reach into each other
};

/// The distance at one pose of many, with its proof.
struct PosedAnswer {
  Pose pose;  ///< of model B
  Enclosure distance;
  PairCertificate certificate;
};

/// The kind `poses`: the distances of model A and of model B moved by each of many poses, in the order of a file.
struct PoseAnswers {
  std::array<SubjectFile, 2> models;  ///< A, B
  std::string units;                  ///< free text; empty when not given
  std::vector<PosedAnswer> answers;
};

/// So many points, or triangles, one after the other, are of an area.
struct AreaRun {
  std::uint32_t area;  ///< index of `StatedTerms::areas`
  std::uint64_t points;
  [[nodiscard]] bool operator==(const AreaRun&) const = default;
};

/// As `ClearanceTerms`, of points in the order of the vertices.
struct StatedTerms {
  Fitness fitness;
  double penetration_limit;
  std::vector<Area> areas;
  std::vector<AreaRun> area_runs;
};

/// How many vertices the runs are of.
[[nodiscard]] std::uint64_t points_of(const StatedTerms& stated);
[[nodiscard]] std::uint64_t points_of(std::span<const AreaRun> runs);
[[nodiscard]] std::vector<AreaRun> runs_of(std::span<const std::uint32_t> area_of);
/// Precondition: `points_of` as many as fit into memory.
[[nodiscard]] ClearanceTerms terms_of(const StatedTerms& stated);

/// The kind `fit`: what a fit claims of the distances of a bone's vertices to the fitted model. What proves them is the
/// map with certificates of these vertices; model and mesh alone are what proves the sides.
struct FitAnswer {
  SubjectFile model;  ///< the fitted one
  SubjectFile mesh;
  std::string units;  ///< free text; empty when not given
  StatedTerms terms;
  std::vector<ClearanceClaim> claims;
  std::vector<SideClaim> sides = {};  ///< inside or outside of the mesh, at most one a primitive
};

/// The kind `best_fit`: how good a fit of a bone's vertices can be at best.
struct BestFitAnswer {
  std::vector<SubjectFile> models;  ///< the implants, as they lie in their files
  SubjectFile mesh;
  std::string units;  ///< free text; empty when not given
  StatedTerms terms;
  PoseRange range;
  std::vector<Point> centres;  ///< about which the range turns them, one an implant
  double upper;                ///< the claim: that of `BestFitClaim`
  BestFitCertificate certificate;
};

/// Precondition: as of `terms_of`.
[[nodiscard]] BestFitClaim claim_of(const BestFitAnswer& answer);

/// How much bone an implant takes away on its way in.
struct RemovalAnswer {
  BoneSide bone;                      ///< of the mesh
  std::optional<SubjectFile> within;  ///< a mesh in which bone lies, too
  std::optional<Plane> resection;     ///< bone lies before it
  Enclosure volume;                   ///< the claim, in cubic units
  RemovedVolumeCertificate certificate;
};

/// The smallest signed distance of all points of all triangles of a bone along an implant's way in.
struct WaySurfaceAnswer {
  Enclosure distance;  ///< the claim
  WaySurfaceCertificate certificate;
};

/// The kind `insertion`: the smallest signed distance of each of a bone's vertices to an implant along its way in, and
/// of its whole surface, how much bone it takes away, or both.
struct InsertionAnswer {
  struct Row {
    Enclosure distance;  ///< the claim
    InsertionCertificate certificate;
  };

  SubjectFile model;
  SubjectFile mesh;
  std::string units;                             ///< free text; empty when not given
  std::optional<Pose> pose;                      ///< moves the model first (verisq/posed_model.hpp)
  std::vector<Pose> path;                        ///< at least one
  std::vector<Row> rows;                         ///< in the order of the vertices; none where only a volume is claimed
  std::optional<WaySurfaceAnswer> surface = {};  ///< with rows alone
  std::optional<RemovalAnswer> removed = {};
};

/// The kind `deviation`: how far a mesh, or the points of a cloud, and a model's surface lie apart.
struct DeviationAnswer {
  SubjectFile model;
  SubjectFile mesh;                          ///< or points
  std::string units;                         ///< free text; empty when not given
  std::optional<Pose> pose;                  ///< moves the model first (verisq/posed_model.hpp)
  std::vector<double> percentiles;           ///< each above 0, at most 100
  DistanceSummary of_vertices;               ///< the claims; as many percentiles
  std::optional<DistanceSummary> from_mesh;  ///< of all points of all triangles; nothing of a cloud
  /// The largest distance of the model's surface from the mesh. It and `hausdorff`, the larger one of both ways, are
  /// there exactly if there is a `SurfaceProof`.
  std::optional<Enclosure> from_model = {};
  std::optional<AreaStatistics> statistics_from_model = {};  ///< may be missing; as many percentiles
  std::optional<Enclosure> hausdorff = {};
  DeviationCertificate certificate;
};

/// The kind `contact`: how much of a mesh's area is in contact with a model.
struct ContactAnswer {
  SubjectFile model;
  SubjectFile mesh;
  std::string units;                 ///< free text; empty when not given
  double distance;                   ///< as `ContactTerms`
  std::vector<std::string> regions;  ///< names of the regions of triangles
  std::vector<AreaRun> region_runs;  ///< of all triangles in their order; none without regions
  ContactClaims claims;              ///< of as many regions
  /// For each primitive: whether its surface counts. Empty without a claim about the model's surface.
  std::vector<bool> counted = {};
  ContactCertificate certificate;
};

/// The kind `containment`: a model lies within the solid of a closed mesh, or around it.
struct ContainmentAnswer {
  SubjectFile model;
  SubjectFile mesh;
  std::string units;  ///< free text; empty when not given
  Containment containment;
  ContainmentCertificate certificate;
};

/// Precondition: no more triangles than fit into memory.
[[nodiscard]] ContactTerms terms_of(const ContactAnswer& answer);

/// The kind `features`: what a surgeon measures of a femur, by its landmarks, which are all the proof.
struct FeaturesAnswer {
  std::optional<SubjectFile> implant;  ///< a model, where it changes the bone
  std::optional<SubjectFile> mesh;     ///< or model, in which landmarks were found; only for people
  FeatureClaims claims;                ///< lengths in mm
};

/// The kind `equilibrium`: where a model of stance stands still on the ground.
struct EquilibriumAnswer {
  SubjectFile model;                    ///< of stance
  std::vector<std::string> parameters;  ///< names of the uncertain ones
  std::vector<std::string> joints;      ///< names of all, as `stance::joint_names`; none without `standing`
  std::vector<std::string> cylinders;   ///< likewise
  stance::EquilibriumClaims claims;     ///< `uncertain` are indices of `parameters`
  stance::EquilibriumCertificate certificate;
};

/// The kind `path`: the smallest distance of model A and of model B, which moves, and when they first meet.
struct PathAnswer {
  std::array<SubjectFile, 2> models;  ///< A, B
  std::string units;                  ///< free text; empty when not given
  std::vector<Pose> path;             ///< of model B, at least one
  PathClaims claims;
  PathCertificate certificate;
};

using Answer = std::variant<PairAnswer, PoseAnswers, PathAnswer, FitAnswer, BestFitAnswer, InsertionAnswer,
                            DeviationAnswer, ContactAnswer, ContainmentAnswer, FeaturesAnswer, EquilibriumAnswer>;

/// Reads an answer of any kind. Throws as `read_pair_answer`.
[[nodiscard]] Answer read_answer(const std::filesystem::path& path);

/// The same from text; `name` stands for the file in messages.
[[nodiscard]] Answer parse_answer(std::string_view json, std::string_view name);

/// Throws Error(input) naming file, key and value for what the format does not allow, for other kinds, and for files
/// above 64 MiB. Two separations never are of the same primitives. Reading proves nothing.
[[nodiscard]] PairAnswer read_pair_answer(const std::filesystem::path& path);

/// The same from text; `name` stands for the file in messages.
[[nodiscard]] PairAnswer parse_pair_answer(std::string_view json, std::string_view name);

/// Writes the file so that `read_answer` gives the same bits; it appears under its name when it is complete. Throws
/// Error(failure), and Error(input) for more than a file may hold. Precondition: an answer that it accepts.
void write_answer(const std::filesystem::path& path, const Answer& answer);

/// The bytes of such a file; `name` stands for it in messages. Throws Error(input) likewise.
[[nodiscard]] std::string text_of(const Answer& answer, const std::string& name);

/// The word of its kind in the file: "pair", "poses", "path", "fit", "best_fit", "insertion", "deviation", "contact",
/// "containment", "features", "equilibrium".
[[nodiscard]] std::string_view kind_of(const Answer& answer);

// Proves answers again, from the files that they are about.

/// One claim of an answer, and what its certificate proves of it.
struct JudgedClaim {
  std::string of;             ///< "mesh", "contact:AREA", "pelvis ty"; empty where the answer is about one thing
  std::string what;           ///< "largest", "percent", "position of "
  std::string unit;           ///< "m", "degrees", "%"; empty: none, or that of the answer
  Enclosure claimed;          ///< [1, 1] of a statement
  Finding finding;            ///< of a statement `proven` is [1, 1], [0, 0] or, where that is open, [0, 1]
  bool is_unbounded = false;  ///< it claims nothing on a side: to prove it says little
};

struct JudgedAnswer {
  std::vector<JudgedClaim> claims;   ///< none where it was interrupted
  std::uint64_t parts = 0;           ///< samples, cells or boxes that the certificate consists of
  std::uint64_t unproved_parts = 0;  ///< of these, parts whose statement is not proven
  bool interrupted = false;

  [[nodiscard]] std::uint64_t unbounded() const;
  /// At least one claim, all of them proved, and none without an end.
  [[nodiscard]] bool all_proved() const;
};

/// The files that an answer is about; the ones that it does not need stay empty.
struct AnswerFiles {
  std::vector<std::filesystem::path> models;  ///< in the order of the certificate; of stance one (.xml)
  std::filesystem::path mesh;                 ///< or cloud
  std::filesystem::path within;               ///< the surface in which bone lies (`RemovalAnswer::within`)
  std::filesystem::path map;                  ///< of a fit: the distances of the vertices, with certificates
  std::filesystem::path surface_map;          ///< of a fit that claims a surface distance: those of the triangles
};

/// Every claim of an answer of any kind. `name` stands for the certificate file in messages. Throws Error(input) for
/// files that are missing, and for others than those that the answer is about.
[[nodiscard]] JudgedAnswer judge(const Answer& answer, const std::string& name, const AnswerFiles& files,
                                 const CheckOptions& options = {});

// The same of subjects that were read before. Throw Error(input) for subjects that cannot be those of the answer.

[[nodiscard]] JudgedAnswer judge(const PathAnswer& answer, const Model& a, const Model& b, const CheckOptions& options);
[[nodiscard]] JudgedAnswer judge(const DeviationAnswer& answer, const std::string& name, const Model& model,
                                 const Mesh& mesh, const CheckOptions& options);
[[nodiscard]] JudgedAnswer judge(const ContactAnswer& answer, const std::string& name, const Model& model,
                                 const Mesh& mesh, const CheckOptions& options);
[[nodiscard]] JudgedAnswer judge(const EquilibriumAnswer& answer, const std::string& name, const stance::Model& model,
                                 const CheckOptions& options);
[[nodiscard]] JudgedAnswer judge(const FeaturesAnswer& answer);

/// The bytes of a file, a `what`, read once: they are hashed and parsed. Throws Error(input) unless they are the ones
/// that the certificate `name` is about.
[[nodiscard]] std::string subject_bytes(const std::filesystem::path& file, const char* what,
                                        const SubjectFile& expected, const std::string& name);

/// The model, or mesh, that these bytes state. Throw likewise, and for what is none.
[[nodiscard]] Model subject_model(const std::filesystem::path& file, const SubjectFile& expected,
                                  const std::string& name);
[[nodiscard]] Mesh subject_mesh(const std::filesystem::path& file, const SubjectFile& expected,
                                const std::string& name);

/// Throws likewise, of a file that is not parsed.
void refuse_other_file(const std::filesystem::path& file, const char* what, const SubjectFile& expected,
                       const std::string& name);

}  // namespace verisq
