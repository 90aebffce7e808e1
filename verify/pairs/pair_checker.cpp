/// The pose enclosed, the certificate's bounds, and what they say of a claim.
#include "verisq/pair_checker.hpp"

#include "verify/pairs/model_pair.hpp"
#include "verify/proof/judgement.hpp"

namespace verisq {

struct PairChecker::State {
  verify::ModelPair models;
};

PairChecker::PairChecker(const Model& a, const Model& b)
    : state_(std::make_unique<State>(State{verify::ModelPair(a, b)})) {}
PairChecker::~PairChecker() = default;
PairChecker::PairChecker(PairChecker&&) noexcept = default;
PairChecker& PairChecker::operator=(PairChecker&&) noexcept = default;

Enclosure PairChecker::prove(const Pose& pose, const PairCertificate& certificate) const {
  return state_->models.distance(verify::RigidMotion(pose), certificate);
}

Finding PairChecker::operator()(const Pose& pose, const Enclosure& claimed, const PairCertificate& certificate) const {
  const Enclosure proven = prove(pose, certificate);
  return verify::judged(claimed, proven, proven);
}

}  // namespace verisq
