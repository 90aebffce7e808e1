/// Proves again that no pose of a range fits better than a bound says, without device or search.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>
#include <verisq/check_options.hpp>
#include <verisq/checker.hpp>
#include <verisq/clearance_claim.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/model.hpp>
#include <verisq/pose_range.hpp>

namespace verisq {

/// No implant of the series, in any pose of the range whose points all keep the limit, has a larger objective than
/// `upper`.
struct BestFitClaim {
  ClearanceTerms terms;        ///< which distances serve, how deep points may lie, weights
  PoseRange range;             ///< the same for all implants, each about its own centre
  std::vector<Point> centres;  ///< one an implant, in its own frame
  double upper;                ///< -infinity: no pose of the range keeps the limit
};

/// What becomes of a box of poses: it is bounded as it is, or halved, along one of the three translations or of the
/// three coordinates of the rotation vector.
enum class PoseDivision : std::uint8_t { along_x, along_y, along_z, about_x, about_y, about_z, none };

/// What proves the claim, whatever it holds: of each implant the range with all of its parts in preorder, the half of
/// the smaller parameters first.
struct BestFitCertificate {
  std::vector<std::vector<PoseDivision>> ranges;
};

struct ProvenBestFit {
  double upper;              ///< proven: the objective of no pose that keeps the limit is larger; -infinity: none does
  std::uint64_t boxes = 0;   ///< that are not halved
  std::uint64_t open = 0;    ///< of these: more than the claim is possible by what is proven of them
  bool interrupted = false;  ///< then only the weights say something
};

/// A certificate, and what it proves.
struct RefinedBestFit {
  BestFitCertificate certificate;
  double upper;
};

/// By interval arithmetic alone. Immutable after construction: safe to call from many threads.
class BestFitChecker {
 public:
  /// Points are those of the bone, one a member of `terms.area_of`. Throws Error(input) for a series that is empty or
  /// holds other than unions of convex primitives, for no points, for other numbers of points or centres than the claim
  /// has, and for what is not finite or out of its range.
  BestFitChecker(std::span<const Model> series, std::span<const Point> points, const BestFitClaim& claim);
  ~BestFitChecker();
  BestFitChecker(BestFitChecker&&) noexcept;
  BestFitChecker& operator=(BestFitChecker&&) noexcept;

  /// What the certificate proves, whatever it holds: of an implant whose divisions make no sense the sum of the
  /// weights. Where few of its boxes are bounded by more than the claim, these are halved further.
  [[nodiscard]] ProvenBestFit operator()(const BestFitCertificate& certificate, const CheckOptions& options) const;

  /// The same where boxes whose bound is above `enough` are halved further, by no more than `further` levels. Once
  /// interrupted it says no more than the weights do.
  [[nodiscard]] RefinedBestFit refined(const BestFitCertificate& certificate, double enough, std::size_t further,
                                       const CheckOptions& options) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Of a bound: never `proved` of a claim that is not true.
[[nodiscard]] Verdict check(const BestFitClaim& claim, const ProvenBestFit& proven);

}  // namespace verisq
