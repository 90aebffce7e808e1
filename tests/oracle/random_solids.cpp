/// The distributions of the random models.
#include "tests/oracle/random_solids.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "tests/oracle/approach.hpp"

namespace verisq::oracle {

std::string_view to_string(ModelFamily family) {
  switch (family) {
    case ModelFamily::bent: return "bent";
    case ModelFamily::plain_csg: return "plain CSG";
    case ModelFamily::bent_csg: return "bent CSG";
    case ModelFamily::thin_difference: return "thin difference";
    case ModelFamily::nearly_touching: return "nearly touching";
    case ModelFamily::tiny_curvature: return "tiny curvature";
    case ModelFamily::tapered: break;
  }
  return "tapered";
}

std::string_view to_string(SolidPointFamily family) {
  switch (family) {
    case SolidPointFamily::far: return "far";
    case SolidPointFamily::around: return "around";
    case SolidPointFamily::near_surface: return "near surface";
    case SolidPointFamily::on_surface: return "on surface";
    case SolidPointFamily::near_rim: return "near rim";
    case SolidPointFamily::on_axis: return "on axis";
    case SolidPointFamily::bend_centre: break;
  }
  return "bend centre";
}

double RandomSolids::exponent() {
  switch (random_.choice(8)) {
    case 0: return 0.05;
    case 1: return 1.0;
    case 2: return 2.0;
    default: return random_.uniform(0.05, 2.0);
  }
}

Superquadric RandomSolids::superquadric(double scale) {
  Superquadric s{{0.0, 0.0, 0.0}, {exponent(), exponent()}};
  for (double& axis : s.semi_axes) axis = scale * random_.log_uniform(0.2, 2.0);
  return s;
}

std::array<double, 4> RandomSolids::quaternion() {
  if (random_.choice(3) == 0) return {1.0, 0.0, 0.0, 0.0};
  const double length = random_.log_uniform(1e-2, 1e2);
  std::array<double, 4> q{};
  for (double& component : q) component = length * random_.uniform(-1, 1);
  return q;
}

Bend RandomSolids::bend(const Superquadric& s) {
  const double degrees = random_.choice(3) == 0 ? 90.0 * static_cast<double>(random_.choice(4))  //
                                                : random_.uniform(-180, 360);
  const double angle = degrees * std::numbers::pi / 180;
  const double extent = MixedNorm<double>(s).support({std::cos(angle), std::sin(angle), 0.0});
  const double limit = std::min(0.9 / extent, 3.0 / s.semi_axes[2]);
  const double share = random_.choice(3) == 0 ? 0.999 : random_.log_uniform(1e-3, 0.999);
  return {random_.choice(2) == 0 ? limit * share : -limit * share, degrees};
}

Primitive RandomSolids::primitive(double scale, double reach, bool bent) {
  Primitive p{"", superquadric(scale), {}, {}};
  p.pose.quaternion = quaternion();
  for (double& t : p.pose.translation) t = reach * random_.uniform(-1, 1);
  if (bent) p.bend = bend(p.superquadric);
  return p;
}

/// The widest section keeps as far off the centre of a bend as the one without a taper.
void RandomSolids::taper(Primitive& p) {
  const double ratio = random_.log_uniform(1.0 / 19.0, 19.0);
  p.superquadric.taper = ratio;
  if (p.bend) p.bend->curvature /= 1 + std::abs((ratio - 1) / (ratio + 1));
}

/// Each leaf once, in any grouping: up to `depth` operators above it.
SetExpression RandomSolids::tree(std::vector<std::uint32_t> leaves, int depth) {
  if (leaves.size() == 1) return {{}, SetOperation::unite, leaves.front()};
  SetExpression node;
  constexpr std::array operations{SetOperation::unite, SetOperation::intersect, SetOperation::subtract};
  node.operation = operations[random_.choice(3)];
  while (!leaves.empty()) {
    const std::size_t rest = leaves.size();
    // The first operand leaves at least one leaf for the second.
    const std::size_t most = node.operands.empty() ? rest - 1 : rest;
    const std::size_t count = depth <= 1 ? 1 : 1 + random_.choice(most);
    node.operands.push_back(tree({leaves.end() - static_cast<std::ptrdiff_t>(count), leaves.end()}, depth - 1));
    leaves.resize(rest - count);
  }
  return node;
}

Model RandomSolids::overlapping(double share_of_bent) {
  const double scale = random_.log_uniform(1e-2, 1e2);
  Model model;
  const std::size_t count = 2 + random_.choice(4);
  for (std::size_t i = 0; i < count; ++i) {
    model.primitives.push_back(primitive(scale, 0.6 * scale, random_.uniform(0, 1) < share_of_bent));
  }
  std::vector<std::uint32_t> leaves(count);
  std::iota(leaves.begin(), leaves.end(), 0U);
  if (random_.choice(6) != 0) model.csg = tree(leaves, 3);
  return model;
}

Model RandomSolids::shell() {
  const double scale = random_.log_uniform(1e-2, 1e2);
  Model model;
  Primitive outer = primitive(scale, scale, random_.choice(2) == 0);
  Primitive inner = outer;
  const double thickness = random_.log_uniform(1e-4, 1e-1);
  for (double& axis : inner.superquadric.semi_axes) axis *= 1 - thickness;
  model.primitives = {outer, inner};
  model.csg = SetExpression{{{{}, SetOperation::unite, 0}, {{}, SetOperation::unite, 1}}, SetOperation::subtract, 0};
  if (random_.choice(2) == 0) {
    model.primitives.push_back(primitive(scale, scale, false));
    model.csg->operands.push_back({{}, SetOperation::unite, 2});
  }
  return model;
}

/// Tip to tip along the third axis of both; a bend carries the first one's tip along.
Model RandomSolids::pair_with_gap() {
  const double scale = random_.log_uniform(1e-2, 1e2);
  const double gap = scale * random_.log_uniform(1e-9, 1e-3) * (random_.choice(2) == 0 ? 1 : -1);
  const Primitive first = primitive(scale, scale, random_.choice(2) == 0);
  Primitive second = primitive(scale, scale, false);
  second.pose = first.pose;
  const PlacedPrimitive placed(first);
  const double a = first.superquadric.semi_axes[2];
  const Point tip = placed.placed({0, 0, a});
  const Point below = placed.placed({0, 0, a * (1 - 1e-6)});
  const double step = length(difference(tip, below));
  const double away = second.superquadric.semi_axes[2] + gap;
  for (std::size_t i = 0; i < 3; ++i) second.pose.translation[i] = tip[i] + away * (tip[i] - below[i]) / step;
  return {"", {first, second}, {}};
}

Model RandomSolids::model(ModelFamily family) {
  Model model;
  switch (family) {
    case ModelFamily::bent: {
      const double scale = random_.log_uniform(1e-2, 1e2);
      model.primitives = {primitive(scale, 2 * scale, true)};
      break;
    }
    case ModelFamily::plain_csg: model = overlapping(0.0); break;
    case ModelFamily::bent_csg: model = overlapping(0.7); break;
    case ModelFamily::thin_difference: model = shell(); break;
    case ModelFamily::nearly_touching: model = pair_with_gap(); break;
    case ModelFamily::tiny_curvature: {
      model = this->model(random_.choice(2) == 0 ? ModelFamily::bent : ModelFamily::bent_csg);
      constexpr std::array curvatures{1e-5, 1e-9, 1e-300};
      for (Primitive& p : model.primitives) {
        if (p.bend) p.bend->curvature = std::copysign(curvatures[random_.choice(3)], p.bend->curvature);
      }
      break;
    }
    case ModelFamily::tapered: {
      model = this->model(random_.choice(2) == 0 ? ModelFamily::bent : ModelFamily::bent_csg);
      for (Primitive& p : model.primitives)
        if (model.primitives.size() == 1 || random_.choice(4) != 0) taper(p);
      break;
    }
  }
  for (std::size_t i = 0; i < model.primitives.size(); ++i) model.primitives[i].name = fmt::format("p{}", i);
  return model;
}

std::array<Model, 2> RandomSolids::pair() {
  std::array<Model, 2> models;
  for (Model& m : models) {
    do {
      m = model(model_families[random_.choice(model_families.size())]);
    } while (SolidReference(m).points_of_solid().empty());
  }
  const Ball first = PlacedModel(models[0]).bounding_ball();
  const double scale = first.radius / PlacedModel(models[1]).bounding_ball().radius;
  for (Primitive& p : models[1].primitives) {
    for (double& axis : p.superquadric.semi_axes) axis *= scale;
    for (double& t : p.pose.translation) t *= scale;
    // Rounded towards 0, so that the preconditions of the bend stay.
    if (p.bend) p.bend->curvature *= (1 - 1e-12) / scale;
  }
  const Point to = moved(first.centre, first.radius * random_.uniform(0.05, 1.5));
  const Point shift = difference(to, PlacedModel(models[1]).bounding_ball().centre);
  for (Primitive& p : models[1].primitives) {
    for (std::size_t i = 0; i < 3; ++i) p.pose.translation[i] += shift[i];
  }
  return models;
}

const PlacedPrimitive& RandomSolids::any_of(const PlacedModel& model) {
  return model.primitives()[random_.choice(model.primitives().size())];
}

Point RandomSolids::moved(const Point& x, double distance) {
  const Point d = random_.direction();
  return {x[0] + distance * d[0], x[1] + distance * d[1], x[2] + distance * d[2]};
}

Point RandomSolids::surface_point(const PlacedPrimitive& p) {
  return p.placed(random_.boundary_point(p.primitive().superquadric).point);
}

/// Bisects between two boundary points of one primitive, on different sides of another one.
Point RandomSolids::rim_point(const PlacedModel& model) {
  for (int attempt = 0; attempt < 30; ++attempt) {
    const PlacedPrimitive& carrier = any_of(model);
    const PlacedPrimitive& cutter = any_of(model);
    Point a = random_.boundary_point(carrier.primitive().superquadric).point;
    Point b = random_.boundary_point(carrier.primitive().superquadric).point;
    const auto cut = [&](const Point& local) { return cutter.membership(carrier.placed(local)) == Membership::inside; };
    if (&carrier == &cutter || cut(a) == cut(b)) continue;
    for (int i = 0; i < 50; ++i) {
      const Point chord = between(a, b, 0.5);
      const Point middle = scaled(chord, 1 / carrier.norm().gauge(chord));
      (cut(middle) == cut(a) ? a : b) = middle;
    }
    return carrier.placed(a);
  }
  return surface_point(any_of(model));
}

Point RandomSolids::axis_point(const PlacedPrimitive& p) {
  Point local;
  for (std::size_t i = 0; i < 3; ++i) local[i] = p.primitive().superquadric.semi_axes[i] * random_.uniform(-1.5, 1.5);
  const std::size_t axis = random_.choice(3);
  const bool plane = random_.choice(2) == 0;
  for (std::size_t i = 0; i < 3; ++i) {
    if ((i == axis) == plane) local[i] = 0.0;
  }
  if (random_.choice(8) == 0) local = {0.0, 0.0, 0.0};
  return p.placed(local);
}

Point RandomSolids::behind_bend(const PlacedModel& model) {
  for (const PlacedPrimitive& p : model.primitives()) {
    const auto& bend = p.primitive().bend;
    // Farther away than this, the centre says nothing about bends.
    if (!bend || std::abs(bend->curvature) * model.bounding_ball().radius < 1e-2) continue;
    const double along = random_.choice(3) == 0 ? 0.0 : random_.uniform(0.0, 2.0);
    const double distance = (1 + along) / bend->curvature;
    const double angle = bend->angle_degrees * std::numbers::pi / 180;
    const double across = random_.choice(2) == 0 ? 0.0 : p.reach() * random_.uniform(-1, 1);
    Primitive straight = p.primitive();
    straight.bend.reset();
    const Point centre = PlacedPrimitive(straight).placed({distance * std::cos(angle) - across * std::sin(angle),
                                                           distance * std::sin(angle) + across * std::cos(angle), 0.0});
    return random_.choice(2) == 0 ? centre
                                  : moved(centre, model.bounding_ball().radius * random_.log_uniform(1e-9, 0.1));
  }
  return axis_point(any_of(model));
}

Point RandomSolids::point(const PlacedModel& model, SolidPointFamily family) {
  const auto& [centre, size] = model.bounding_ball();
  switch (family) {
    case SolidPointFamily::far: return moved(centre, size * random_.log_uniform(2, 1e3));
    case SolidPointFamily::around: return moved(centre, size * random_.uniform(0, 1));
    case SolidPointFamily::near_surface:
      return moved(surface_point(any_of(model)), size * random_.log_uniform(1e-9, 0.1));
    case SolidPointFamily::on_surface: return surface_point(any_of(model));
    case SolidPointFamily::near_rim: return moved(rim_point(model), size * random_.log_uniform(1e-9, 0.1));
    case SolidPointFamily::on_axis: return axis_point(any_of(model));
    case SolidPointFamily::bend_centre: break;
  }
  return behind_bend(model);
}

}  // namespace verisq::oracle
