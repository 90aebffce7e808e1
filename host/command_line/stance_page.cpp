/// Numbers as JSON in the page's place for them.
#include "host/command_line/stance_page.hpp"

#include <array>

#include "host/command_line/json_value.hpp"
#include "host/report/filled_page.hpp"
#include "host/stance/side_view.hpp"
#include "report/page_template.hpp"

namespace verisq::command_line {
namespace {

using namespace stance;

JsonValue ends(const Enclosure& enclosure) {
  return std::array{enclosure.lo, enclosure.hi};
}

/// x and y, lower and upper ends.
JsonValue ends(const SidePoint& point) {
  return std::array{point.x.lo, point.x.hi, point.y.lo, point.y.hi};
}

template <class Items, class Part>
JsonValue list_of(const Items& items, const Part& part) {
  JsonValue::Array list;
  for (const auto& item : items) list.push_back(part(item));
  return list;
}

Enclosure range_of(const Quantity& quantity, UncertainSet uncertain) {
  for (const std::uint32_t i : uncertain) {
    if (quantity.parameter == i) return quantity.range;
  }
  return {quantity.nominal, quantity.nominal};
}

/// What of the model is drawn: a line for each body to that which carries it, a disc for each cylinder.
class Figure {
 public:
  Figure(const StanceSummary& summary, std::vector<std::uint32_t> bodies, std::vector<std::uint32_t> cylinders)
      : summary_(summary), bodies_(std::move(bodies)), cylinders_(std::move(cylinders)) {}

  /// All of it.
  [[nodiscard]] static Figure whole(const StanceSummary& summary) {
    return {summary, counted(summary.model.bodies.size()), counted(summary.model.cylinders.size())};
  }

  /// One of each pair.
  [[nodiscard]] static Figure of(const StanceSummary& summary, const SagittalModel& sagittal) {
    std::vector<std::uint32_t> bodies;
    std::vector<std::uint32_t> cylinders;
    for (const SagittalBody& body : sagittal.bodies) bodies.push_back(body.body);
    for (const SagittalContact& contact : sagittal.contacts) cylinders.push_back(contact.cylinder);
    return {summary, std::move(bodies), std::move(cylinders)};
  }

  [[nodiscard]] JsonObject shape() const {
    const Model& model = summary_.model;
    const auto line = [&](std::uint32_t b) -> JsonValue {
      const Body& body = model.bodies[b];
      return JsonObject{{"name", body.name}, {"parent", body.parent ? JsonValue(place(*body.parent)) : JsonValue()}};
    };
    const auto disc = [&](std::uint32_t c) -> JsonValue {
      const ContactCylinder& cylinder = model.cylinders[c];
      return JsonObject{{"name", cylinder.name}, {"radius", ends(range_of(cylinder.radius, summary_.uncertain))}};
    };
    return {{"bodies", list_of(bodies_, line)}, {"cylinders", list_of(cylinders_, disc)}};
  }

  [[nodiscard]] JsonValue points(const std::vector<Enclosure>& positions) const {
    const SideView view = side_view(summary_.model, summary_.uncertain, positions);
    return JsonObject{{"bodies", list_of(bodies_, [&](std::uint32_t b) { return ends(view.origins[b]); })},
                      {"cylinders", list_of(cylinders_, [&](std::uint32_t c) { return ends(view.cylinders[c]); })},
                      {"trunk", ends(view.trunk)}};
  }

 private:
  static std::vector<std::uint32_t> counted(std::size_t count) {
    std::vector<std::uint32_t> all;
    for (std::uint32_t i = 0; i < count; ++i) all.push_back(i);
    return all;
  }

  /// Parents are drawn, too, or a body of their pair is.
  [[nodiscard]] std::size_t place(std::uint32_t body) const {
    return static_cast<std::size_t>(std::find(bodies_.begin(), bodies_.end(), body) - bodies_.begin());
  }

  const StanceSummary& summary_;
  std::vector<std::uint32_t> bodies_;
  std::vector<std::uint32_t> cylinders_;
};

/// Names do not tell what is turned and what is moved.
JsonValue joints_of(const Model& model) {
  const std::vector<std::string> names = joint_names(model);
  JsonValue::Array joints;
  for (const Body& body : model.bodies) {
    for (const Joint& joint : body.joints) {
      joints.push_back(JsonObject{{"name", names[joints.size()]},
                                  {"is_translation", joint.kind == JointKind::translation},
                                  {"is_of_root", !body.parent.has_value()}});
    }
  }
  return joints;
}

JsonValue standing_of(const StanceSummary& summary) {
  if (!summary.equilibrium || !summary.equilibrium->standing) return {};
  const Figure figure = Figure::whole(summary);
  return JsonObject{{"figure", figure.shape()}, {"points", figure.points(summary.equilibrium->standing->positions)}};
}

JsonValue motion_of(const StanceSummary& summary) {
  if (!summary.motion) return {};
  const Motion& motion = *summary.motion;
  const SagittalModel sagittal = sagittal_model(summary.model, summary.uncertain);
  const Figure figure = Figure::of(summary, sagittal);
  const auto list = [](const std::vector<Enclosure>& enclosures) {
    return list_of(enclosures, [](const Enclosure& each) { return ends(each); });
  };
  const auto slab = [&](const MotionSlab& each) -> JsonValue {
    return JsonObject{
        {"from", each.from},
        {"to", each.to},
        {"positions", list(each.positions)},
        {"velocities", list(each.velocities)},
        {"normal", list_of(each.contacts, [](const MotionContact& contact) { return ends(contact.normal); })},
        {"friction", list_of(each.contacts, [](const MotionContact& contact) { return ends(contact.friction); })},
        {"points", figure.points(all_positions(sagittal, each.positions))}};
  };
  return JsonObject{{"duration", summary.motion_duration},
                    {"joints", motion.joints},
                    {"contacts", motion.contacts},
                    {"figure", figure.shape()},
                    {"slabs", list_of(motion.slabs, slab)}};
}

}  // namespace

std::string stance_page_data(const StanceSummary& summary) {
  return JsonObject{{"format", "verisq-stance/1"},
                    {"result", json_value(summary)},
                    {"joints", joints_of(summary.model)},
                    {"standing", standing_of(summary)},
                    {"motion", motion_of(summary)}}
      .text();
}

void write_stance_page(const std::string& file, const StanceSummary& summary) {
  report::write_filled_page(file, report::stance_page_template(), stance_page_data(summary));
}

}  // namespace verisq::command_line
