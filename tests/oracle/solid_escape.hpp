/// The evidence against an enclosure of the signed distance to any model, in one line that reproduces the case.
#pragma once

#include <optional>
#include <string>
#include <verisq/enclosure.hpp>
#include <verisq/model.hpp>

#include "tests/oracle/solid_reference.hpp"

namespace verisq::oracle {

/// As a model file, in one line, every number to the last bit.
[[nodiscard]] std::string model_json(const Model& model);

/// How `enclosure` misses what `lower <= exact <= upper` says; empty when it does not.
[[nodiscard]] std::optional<std::string> escape(const Enclosure& enclosure, const Model& model, const Point& point,
                                                const Real& lower, const Real& upper);

}  // namespace verisq::oracle
