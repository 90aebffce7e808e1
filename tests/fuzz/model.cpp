/// Fuzz target of parse_model.
#include <algorithm>
#include <cmath>
#include <set>
#include <verisq/model_file.hpp>

#include "tests/fuzz/promise.hpp"
#include "tests/fuzz/targets.hpp"

namespace verisq::fuzz {
namespace {

void check_primitive(const Primitive& primitive) {
  const auto finite = [](double value) { return std::isfinite(value); };
  const auto& [semi_axes, exponents] = primitive.superquadric;
  const auto& [translation, quaternion] = primitive.pose;
  check(std::ranges::all_of(semi_axes, [](double a) { return 0.0 < a && std::isfinite(a); }),
        "semi-axes are positive and finite");
  check(std::ranges::all_of(exponents, [](double e) { return 0.0 < e && e <= 2.0; }), "exponents are in (0, 2]");
  check(std::ranges::all_of(translation, finite), "translations are finite");
  check(std::ranges::all_of(quaternion, finite), "quaternions are finite");
  check(std::ranges::any_of(quaternion, [](double q) { return q != 0.0; }), "quaternions are not zero");
}

void check_model(const Model& model) {
  check(!model.primitives.empty(), "a model has primitives");
  std::set<std::string> names;
  for (const Primitive& primitive : model.primitives) {
    check_primitive(primitive);
    check(names.insert(primitive.name).second, "names of primitives are distinct");
  }
}

}  // namespace

void model(Bytes bytes) {
  const std::string name = "model.json";
  const std::string json(bytes.begin(), bytes.end());  // a copy, so that reading past its end shows
  read_or_refuse(name, [&] { check_model(parse_model(json, name)); });
}

}  // namespace verisq::fuzz
