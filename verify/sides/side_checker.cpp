/// The centre's side first, then triangle by triangle.
#include "verisq/side_checker.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <span>

#include "verify/placement/check_steps.hpp"
#include "verify/sets/bend_range.hpp"
#include "verify/sides/deep_part.hpp"
#include "verify/sides/oriented_surface.hpp"
#include "verisq/error.hpp"

namespace verisq {

namespace {

using Side = verify::OrientedSurface::Side;

constexpr std::size_t triangles_a_task = 32;

/// A reader refuses such models, too.
void require_bends(const Model& model) {
  for (const Primitive& primitive : model.primitives) {
    if (!is_bent(primitive)) continue;
    if (!verify::keeps_off_its_centre(*primitive.bend, primitive.superquadric) ||
        !verify::is_less_than_a_full_turn(*primitive.bend, primitive.superquadric)) {
      throw Error(ErrorKind::input, fmt::format("sides: the bend of primitive \"{}\" is too strong", primitive.name));
    }
  }
}

/// All of them. Neighbours in a mesh are often near each other.
bool keep_off(const verify::DeepPart& part, std::span<const Triangle> triangles, const CheckOptions& options) {
  const std::size_t tasks = (triangles.size() + triangles_a_task - 1) / triangles_a_task;
  std::atomic<std::size_t> kept = 0;  // tasks; one that is not begun is not kept
  std::atomic<bool> failed = false;
  verify::CheckSteps(tasks, options).each(tasks, [&](std::size_t task) {
    const std::size_t first = task * triangles_a_task;
    if (failed) return;
    if (part.keeps_off(triangles.subspan(first, std::min(triangles_a_task, triangles.size() - first))))
      ++kept;
    else
      failed = true;
  });
  return kept == tasks;
}

}  // namespace

struct SideChecker::State {
  State(const Model& m, const Mesh& mesh, double limit) : model(m), surface(mesh), penetration_limit(limit) {}

  Model model;
  verify::OrientedSurface surface;
  double penetration_limit;
};

SideChecker::SideChecker(const Model& model, const Mesh& surface, double penetration_limit) {
  if (!(penetration_limit >= 0.0) || !std::isfinite(penetration_limit)) {
    throw Error(ErrorKind::input,
                fmt::format("sides: penetration limit: must be finite and at least 0, not {}", penetration_limit));
  }
  require_bends(model);
  state_ = std::make_unique<State>(model, surface, penetration_limit);
}

SideChecker::~SideChecker() = default;
SideChecker::SideChecker(SideChecker&&) noexcept = default;
SideChecker& SideChecker::operator=(SideChecker&&) noexcept = default;

std::optional<bool> SideChecker::faces_outward() const {
  return state_->surface.faces_outward();
}

std::size_t SideChecker::rims() const {
  return state_->surface.rims();
}

Verdict verdict_of(SideFinding finding) {
  if (finding == SideFinding::kept) return Verdict::proved;
  return finding == SideFinding::other_side ? Verdict::refuted : Verdict::unproved;
}

SideFinding SideChecker::operator()(const SideClaim& claim, const CheckOptions& options) const {
  if (claim.side == SurfaceSide::any) return SideFinding::kept;
  const verify::OrientedSurface& surface = state_->surface;
  const Primitive& primitive = state_->model.primitives[claim.primitive];
  const verify::DeepPart part(primitive, state_->penetration_limit);
  if (!part.holds_centre()) return SideFinding::no_deep_point;
  if (!part.is_connected()) return SideFinding::strongly_bent;
  const std::optional<Side> side = surface.side_of(primitive.pose.translation);
  if (!side) return SideFinding::on_the_surface;
  if (*side != (claim.side == SurfaceSide::inside ? Side::inside : Side::outside)) return SideFinding::other_side;
  const std::span<const Triangle> triangles = surface.triangles();
  if (!keep_off(part, triangles.first(surface.triangles_of_mesh()), options)) return SideFinding::enters_surface;
  if (!keep_off(part, triangles.subspan(surface.triangles_of_mesh()), options)) return SideFinding::reaches_through;
  if (surface.components() > 1) return SideFinding::several_parts;
  return surface.faces_outward() ? SideFinding::kept : SideFinding::no_volume;
}

}  // namespace verisq
