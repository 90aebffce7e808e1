/// Primitives in the order of their surfaces' distances; of each, what the others leave of it within that distance.
#include "verify/sets/set_closest_point.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "verify/search/candidates.hpp"
#include "verify/search/enclosing_box.hpp"
#include "verify/sets/set_tree.hpp"
#include "verify/sets/solid_distance.hpp"
#include "verify/sets/union_part.hpp"
#include "verisq/signed_distance.hpp"

namespace verisq::verify {
namespace {

void add_leaves(const SetNode& node, std::set<std::uint32_t>& leaves) {
  if (node.kind == SetNode::Kind::leaf) leaves.insert(node.primitive);
  for (const SetNode& operand : node.operands) add_leaves(operand, leaves);
}

/// A primitive of the tree, alone.
class Part {
 public:
  Part(const Primitive& primitive, std::uint32_t index) : index_(index), part_(part_of(primitive)) {
    if (!is_bent(primitive)) return;
    const Model alone{.units = {}, .primitives = {primitive}};
    inside_ = std::make_unique<SolidDistance>(alone);
    roughness_ = 1e-3 * bounding_radius(alone);
  }

  [[nodiscard]] std::uint32_t index() const { return index_; }
  [[nodiscard]] double lower_by_sphere(const Point& x) const { return verify::lower_by_sphere(part_, x); }
  [[nodiscard]] ClosestSurfacePoint closest(const Point& x) const { return closest_surface_point(part_, x); }

  /// Contains the signed distance, inside bent ones, too.
  [[nodiscard]] Enclosure signed_distance(const Point& x) const {
    const Enclosure found = rough_distance(part_, x);
    if (!inside_ || found.lo > 0.0) return found;
    return (*inside_)(x, roughness_, {-infinity, found.hi}, [] { return false; });
  }

 private:
  std::uint32_t index_;
  UnionPart part_;
  std::unique_ptr<SolidDistance> inside_;  ///< of bent ones
  double roughness_ = 0.0;
};

/// What is known of a part's surface about x.
struct Surface {
  const Part* part;
  Enclosure distance;  ///< signed

  /// Of x from the surface.
  [[nodiscard]] double nearest() const { return std::max({distance.lo, -distance.hi, 0.0}); }
  [[nodiscard]] double farthest() const { return std::max(distance.hi, -distance.lo); }
};

ClosestPoint answer_of(const Surface& surface, const Point& x, bool is_complement) {
  auto [distance, point, normal, unique] = surface.part->closest(x);
  if (!unique && std::isinf(distance.lower().to_double(Direction::down))) {
    ClosestPoint found = closest_point_within(surface.distance, x);
    if (is_complement) found.distance = {-surface.distance.hi, -surface.distance.lo};
    found.primitive = surface.part->index();
    return found;
  }
  if (is_complement) {
    distance = -distance;
    for (std::size_t k = 0; k < 3; ++k) normal[k] = -normal[k];
  }
  return {rounded_outward(distance), rounded_outward(point), rounded_outward(normal), surface.part->index(), unique};
}

}  // namespace

struct SetClosestPoint::State {
  explicit State(const Model& model) : tree(normal_form(model, Side::inside)), primitives(model.primitives.size()) {
    std::set<std::uint32_t> leaves;
    add_leaves(tree, leaves);
    parts.reserve(leaves.size());
    for (const std::uint32_t leaf : leaves) parts.emplace_back(model.primitives[leaf], leaf);
  }

  /// What the others leave of it within the distance of its surface: black where the model is that primitive there,
  /// white where it is its complement, gray where that is not proven. Of parts that are not among `known` the ball is
  /// all outside.
  [[nodiscard]] Colour share(const Surface& deciding, std::span<const Surface> known) const {
    std::vector<Colour> colours(primitives, Colour::white);
    for (const Surface& other : known) {
      // Strictly: then the same holds of a larger ball, and about p, too.
      if (!(other.nearest() > deciding.farthest()))
        colours[other.part->index()] = Colour::gray;
      else if (other.distance.hi < 0.0)
        colours[other.part->index()] = Colour::black;
    }
    colours[deciding.part->index()] = Colour::black;
    const Colour where_it_is = colour(tree, colours);
    colours[deciding.part->index()] = Colour::white;
    const Colour where_it_is_not = colour(tree, colours);
    if (where_it_is == Colour::gray || where_it_is_not == Colour::gray || where_it_is == where_it_is_not)
      return Colour::gray;
    return where_it_is;
  }

  SetNode tree;
  std::vector<Part> parts;
  std::size_t primitives;
};

SetClosestPoint::SetClosestPoint(const Model& model) : state_(std::make_unique<State>(model)) {}

SetClosestPoint::~SetClosestPoint() = default;
SetClosestPoint::SetClosestPoint(SetClosestPoint&&) noexcept = default;
SetClosestPoint& SetClosestPoint::operator=(SetClosestPoint&&) noexcept = default;

std::optional<ClosestPoint> SetClosestPoint::operator()(const Point& x, double farthest) const {
  const std::vector<Part>& parts = state_->parts;
  const auto order = nearest_spheres_first(parts.size(), [&](std::size_t i) { return parts[i].lower_by_sphere(x); });
  std::vector<Surface> known;       // all parts whose bounding spheres are no farther than the present one
  std::vector<Surface> candidates;  // of these, the ones that have not been asked
  for (std::size_t next = 0; next <= order.size(); ++next) {
    // Parts from here on lie outside a ball of that radius.
    const double clear = next < order.size() ? order[next].sphere_bound : infinity;
    std::ranges::sort(candidates, {}, &Surface::farthest);
    auto candidate = candidates.begin();
    for (; candidate != candidates.end() && candidate->farthest() < clear; ++candidate) {
      if (candidate->nearest() > farthest) return std::nullopt;
      const Colour share = state_->share(*candidate, known);
      if (share != Colour::gray) return answer_of(*candidate, x, share == Colour::white);
    }
    candidates.erase(candidates.begin(), candidate);
    if (next == order.size()) break;
    const Part& part = parts[order[next].index];
    known.push_back({&part, part.signed_distance(x)});
    candidates.push_back(known.back());
  }
  return std::nullopt;
}

}  // namespace verisq::verify
