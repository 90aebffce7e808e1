/// The volume of bone that an implant takes away on its way in, with what proves it again.
#pragma once

#include <span>
#include <verisq/bone_side.hpp>
#include <verisq/check_options.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/removed_volume.hpp>
#include <verisq/removed_volume_certificate.hpp>

namespace verisq {

struct CertifiedRemovedVolume {
  Enclosure volume;  ///< what the certificate proves with a little to spare, in cubic model units
  RemovedVolumeCertificate certificate;
  bool interrupted = false;  ///< then nothing is proven
};

/// Of what `removed_volume` found with the same arguments. Throws as RemovedVolumeChecker.
[[nodiscard]] CertifiedRemovedVolume certified_removed_volume(std::span<const Pose> path, const Model& implant,
                                                              const BoneRegion& bone, const RemovedVolume& found,
                                                              const CheckOptions& options);

}  // namespace verisq
