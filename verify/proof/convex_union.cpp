/// The messages of refused models, with the place of what is not supported.
#include "verify/proof/convex_union.hpp"

#include <algorithm>
#include <string>

#include "verisq/error.hpp"

namespace verisq::verify {

namespace {

[[noreturn]] void refuse(std::string_view what, const std::string& solids) {
  throw Error(ErrorKind::input, std::string(what) + ": not supported for " + solids);
}

}  // namespace

void require_union_of_convex(const Model& model, std::string_view what) {
  const auto bent = std::ranges::find_if(model.primitives, is_bent);
  if (bent != model.primitives.end()) {
    refuse(what, "bent solids: primitives[" + std::to_string(bent - model.primitives.begin()) + "].bend");
  }
  if (!is_union_of_convex(model)) refuse(what, "csg other than the union of all primitives");
}

void require_union(const Model& model, std::string_view what) {
  if (!is_union(model)) refuse(what, "csg other than the union of all primitives");
}

void require_no_taper(const Model& model, std::string_view what) {
  const auto tapered =
      std::ranges::find_if(model.primitives, [](const Primitive& p) { return is_tapered(p.superquadric); });
  if (tapered == model.primitives.end()) return;
  const std::string index = std::to_string(tapered - model.primitives.begin());
  refuse(what, "tapered solids: primitives[" + index + "].superquadric.taper");
}

}  // namespace verisq::verify
