/// Both models posed, and what the certificate proves about them.
#include "verisq/pair_certificate.hpp"

#include "verify/proof/convex_union.hpp"
#include "verify/proof/judgement.hpp"
#include "verify/proof/posed_pairs.hpp"

namespace verisq {

using namespace verify;

Enclosure prove(const Model& a, const Model& b, const Pose& pose, const PairCertificate& certificate) {
  for (const Model* model : {&a, &b}) require_union_of_convex(*model, "certificates");
  const PosedPrimitives posed_a(a);
  const PosedPrimitives posed_b(b);
  return proven_distance(PosedPairs(posed_a, posed_b, pose), certificate);
}

Finding check(const Model& a, const Model& b, const Pose& pose, const Enclosure& claimed,
              const PairCertificate& certificate) {
  const Enclosure proven = prove(a, b, pose, certificate);
  return judged(claimed, proven, proven);
}

}  // namespace verisq
