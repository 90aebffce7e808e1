/// Proves again how much bone an implant takes away on its way in: interval arithmetic, no OpenCL, no search.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>
#include <verisq/bone_side.hpp>
#include <verisq/check_options.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/model.hpp>

namespace verisq {

/// What becomes of a cube: it is looked at as it is, or divided into its eight octants.
enum class CubeDivision : std::uint8_t { none, divided };

/// More cubes than that prove nothing: what would take longer to follow no checker need have.
inline constexpr std::size_t most_cubes_of_certificate = std::size_t{1} << 23U;

/// A cube that holds all that is swept, with all of its parts in preorder: of the octants those of smaller z first, of
/// these those of smaller y, then x. Wherever they are, volumes in them can be bounded; where the cubes are small, they
/// are bounded closely (docs/mathematics.md §23).
struct RemovedVolumeCertificate {
  Point centre{};           ///< of the whole cube
  double half_width = 0.0;  ///< likewise, in the units of the model
  std::vector<CubeDivision> cubes = {};
};

struct ProvenRemovedVolume {
  Enclosure volume{0.0, infinity};  ///< proven, in cubic model units
  std::uint64_t cubes = 0;          ///< that were looked at
  bool interrupted = false;         ///< then nothing is proven
};

/// The implant, a union of convex primitives, moves by the poses after its primitives' own, between them as in
/// insertion.hpp. Immutable after construction: safe to call from many threads.
class RemovedVolumeChecker {
 public:
  /// Throws Error(input) for another model, for a path without poses, for poses that are not finite or have a zero
  /// quaternion, for a resection that is not finite or has no normal, and for surfaces that are not finite, that are
  /// not closed with the fans over their rims, each edge run through as often one way as the other, or enclose nothing;
  /// and where a cavity lies beside the bone's outer surface, so that it is not one in that bone.
  RemovedVolumeChecker(const Model& implant, std::span<const Pose> path, const BoneRegion& bone);
  ~RemovedVolumeChecker();
  RemovedVolumeChecker(RemovedVolumeChecker&&) noexcept;
  RemovedVolumeChecker& operator=(RemovedVolumeChecker&&) noexcept;

  /// Of all bone that lies in the implant at some time the volume that the certificate proves, whatever it holds: from
  /// above nothing where its cube may miss a part of what is swept, nothing at all where its parts are not those of one
  /// cube, or where their centres or widths are no binary64 numbers.
  [[nodiscard]] ProvenRemovedVolume operator()(const RemovedVolumeCertificate& certificate,
                                               const CheckOptions& options) const;

  /// Over how many rims each surface was closed.
  [[nodiscard]] const std::vector<std::size_t>& rims() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace verisq
