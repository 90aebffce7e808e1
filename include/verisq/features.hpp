/// Landmarks and features of a femur, enclosed, and their certificate.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/mesh.hpp>

namespace verisq {

// Features of a femur, of landmarks that are known to a given radius: what a surgeon plans to keep (paper, section 1).

/// The patient's side.
enum class Side { left, right };

/// Points of a femur; what is missing was not found, or not given. Two points make an axis.
struct FemurLandmarks {
  std::optional<Point> head_centre = {};
  std::optional<double> head_radius = {};
  std::optional<Point> neck_centre = {};     ///< with the head's centre, the neck axis
  std::optional<Point> shaft_proximal = {};  ///< with the next one, the shaft axis
  std::optional<Point> shaft_distal = {};
  std::optional<Point> medial_posterior_condyle = {};  ///< with the next one, the posterior condylar line
  std::optional<Point> lateral_posterior_condyle = {};
  std::optional<Point> medial_epicondyle = {};  ///< with the next one, the transepicondylar line
  std::optional<Point> lateral_epicondyle = {};

  bool operator==(const FemurLandmarks&) const = default;
};

/// A point's name in files, and where it is kept.
struct NamedLandmark {
  const char* name;
  std::optional<Point> FemurLandmarks::*point;
};
inline constexpr std::array named_landmarks{
    NamedLandmark{"head_centre", &FemurLandmarks::head_centre},
    NamedLandmark{"neck_centre", &FemurLandmarks::neck_centre},
    NamedLandmark{"shaft_proximal", &FemurLandmarks::shaft_proximal},
    NamedLandmark{"shaft_distal", &FemurLandmarks::shaft_distal},
    NamedLandmark{"medial_posterior_condyle", &FemurLandmarks::medial_posterior_condyle},
    NamedLandmark{"lateral_posterior_condyle", &FemurLandmarks::lateral_posterior_condyle},
    NamedLandmark{"medial_epicondyle", &FemurLandmarks::medial_epicondyle},
    NamedLandmark{"lateral_epicondyle", &FemurLandmarks::lateral_epicondyle},
};

enum class FeatureUnit { length, degrees };

/// A number that describes a femur. `value` contains what every choice of the landmarks within their radius gives.
struct Feature {
  std::string name;    ///< "ccd", "offset", ...
  std::string method;  ///< by which definition, in words
  FeatureUnit unit;
  Enclosure value;
};

/// An axis of the femur's frame: every choice of the landmarks gives a unit vector within `tilt_degrees` of this one.
struct FrameAxis {
  Point direction;
  double tilt_degrees;
};

/// The frame of the International Society of Biomechanics (Wu et al., J. Biomech. 35 (2002), 543): origin at the head's
/// centre, y from the middle of the epicondyles to it, z across y in the plane of both to the patient's right, x ahead.
struct FemurFrame {
  Point origin;
  FrameAxis x;
  FrameAxis y;
  FrameAxis z;
};

struct FemurFeatures {
  std::vector<Feature> features;
  std::optional<FemurFrame> frame;
  std::vector<std::string> missing;  ///< what could not be said, and why, a sentence each
};

/// Encloses what the landmarks say, each of them anywhere within `landmark_radius` (>= 0) of where it is given; the
/// head's radius, too, is known to that. A feature whose enclosure would hold every angle is missing;
/// version and frame are missing without a side. Throws
/// Error(input) for a radius that is negative or not finite, and for coordinates that are not finite.
[[nodiscard]] FemurFeatures femur_features(const FemurLandmarks& landmarks, std::optional<Side> side,
                                           double landmark_radius);

/// How an implant in its place changes what the bone was, with the implant's head centre, a point on its neck's axis
/// and two on its shaft's, as far as it has them, exact in the bone's coordinates: change of offset, of leg length
/// (along the bone's shaft axis, positive: longer), of version and of CCD, the heads' distance, the implant's own CCD
/// and its tilt against the bone's shaft. Throws as above; what misses the landmarks is missing, but for the tilt of an
/// implant without a shaft.
[[nodiscard]] FemurFeatures implant_changes(const FemurLandmarks& bone, std::optional<Side> side,
                                            double landmark_radius, const FemurLandmarks& implant);

/// The landmarks that were found in a mesh, with words for a summary.
struct DetectedFemur {
  FemurLandmarks landmarks;
  std::optional<Side> side;        ///< as given, or of a whole femur as found
  std::vector<std::string> notes;  ///< how each landmark was found, a sentence each
};

/// Finds the landmarks of a whole or a proximal femur, in floating point: nothing is proven of it. In millimetres.
/// Which side it is of is asked of a whole femur's condyles, which reach farther back from the shaft than ahead; of a
/// proximal one nothing needs it. Throws Error(input), one line, for a mesh that is none: no triangles, several bones,
/// no long axis, no head of a radius of 12 to 35 mm, no neck, or no shaft; and for a side that the condyles contradict.
[[nodiscard]] DetectedFemur detect_femur(const Mesh& mesh, std::optional<Side> side = {});

// Claims about a femur's features, which 127-bit intervals prove again: the landmarks are all the proof.

/// As `femur_features` and `implant_changes` say of the same landmarks.
struct FeatureClaims {
  FemurLandmarks landmarks;
  std::optional<Side> side;
  double landmark_radius;
  std::vector<Feature> features;
  std::optional<FemurFrame> frame = {};
  std::optional<FemurLandmarks> implant = {};  ///< the points that count; nothing: no changes are claimed
  std::vector<Feature> changes = {};
};

/// In the order of the claims. Those of another name, method or unit, or that the landmarks do not tell, are unproved.
struct FeatureFindings {
  std::vector<Finding> features;
  /// For x, y, z: how far each true axis tilts from the claimed direction, in degrees. The claim is at most its tilt.
  std::optional<std::array<Finding, 3>> frame;
  std::vector<Finding> changes;

  [[nodiscard]] std::vector<Finding> all() const;
};

/// Throws Error(input) as `femur_features`. Precondition: the claims hold no NaN.
[[nodiscard]] FeatureFindings check(const FeatureClaims& claims);

// Reads and writes landmarks of a femur: `verisq-landmarks/1` (docs/formats.md).

struct LandmarkFile {
  FemurLandmarks landmarks;
  std::optional<Side> side;  ///< nothing when the file does not say
};

/// Throws Error(input) naming file, key and value for what the format does not allow.
[[nodiscard]] LandmarkFile read_landmarks(const std::filesystem::path& path);

/// The same from text; `name` stands for the file in messages.
[[nodiscard]] LandmarkFile parse_landmarks(std::string_view json, std::string_view name);

/// The same landmarks are read again, bit for bit. The file appears when it is complete. Throws Error(failure).
void write_landmarks(const std::filesystem::path& path, const LandmarkFile& file);

/// The points that a model file names (key `landmarks`), in the model's coordinates: of an implant its head's centre
/// and points on the axes of neck and shaft. None where it has no such key. Throws Error(input) as
/// `read_uncertain_model`.
[[nodiscard]] FemurLandmarks read_model_landmarks(const std::filesystem::path& model);

/// The same from text; `name` stands for the file in messages.
[[nodiscard]] FemurLandmarks parse_model_landmarks(std::string_view json, std::string_view name);

}  // namespace verisq
