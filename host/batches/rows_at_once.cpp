/// This file implements the launch from the caller's points to his rows in one step.
#include "host/batches/rows_at_once.hpp"

#include <string_view>

#include "host/opencl/program.hpp"
#include "kernels/embedded_sources.hpp"

namespace verisq::device {
namespace {

std::string_view sources_of(const DeviceModel& model) {
  return model.has_tapered() ? kernels::embedded_tapered_point_map() : kernels::embedded_point_map();
}

}  // namespace

cl::Program point_map_program(const Device& device, const DeviceModel& model) {
  return build_program(device.context, device.device, device.vector_width, sources_of(model), model.memory);
}

RowsAtOnce::RowsAtOnce(const Device& device, const cl::Program& program, const DeviceModel& model,
                       const RowCriterion& criterion, const RowTotals& totals)
    : groups_(device), primitives_(model.primitives), point_map_(program, sources_of(model), "point_map") {
  point_map_.set("vectors", groups_.vectors_of_item());
  bind_criterion(point_map_, Scale(model.scale_exponent), criterion);
  point_map_.set("primitives", primitives_);
  totals.bind_refusal(point_map_);
  totals.bind(point_map_, groups_);
}

void RowsAtOnce::enqueue(ChunkQueue& queue, const BoundChunk& chunk, std::size_t size) {
  point_map_.set("size", size);
  bind_points(point_map_, chunk);
  bind_rows(point_map_, chunk);
  queue.launch(point_map_, blocks_of(size) * groups_.group_size, groups_.group_size);
}

}  // namespace verisq::device
