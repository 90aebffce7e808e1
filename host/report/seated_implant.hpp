/// The implant of a report where its way ends.
#pragma once

#include <verisq/mesh.hpp>
#include <verisq/posed_model.hpp>
#include <verisq/report.hpp>

#include "host/report/model_surface.hpp"

namespace verisq::report {

[[nodiscard]] inline Mesh seated_surface(const Report& report) {
  return model_surface(report.path.empty() ? report.implant : posed(report.implant, report.path.back()));
}

}  // namespace verisq::report
