/// This file implements point_pipe.hpp.
#include "host/device/point_pipe.hpp"

#include <algorithm>
#include <array>
#include <deque>
#include <exception>
#include <iterator>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host/device/chunk_pipeline.hpp"
#include "host/device/chunk_queue.hpp"
#include "host/device/device.hpp"
#include "host/device/device_model.hpp"
#include "host/device/program_self_test.hpp"
#include "kernels/embedded_sources.hpp"
#include "verisq/error.hpp"

namespace verisq::device {
namespace {

constexpr std::array<std::string_view, 3> axes{"x", "y", "z"};

void bind(NamedKernel& kernel, std::string_view name, const BoundColumn& column) {
  const std::string of(name);
  kernel.set("memory_" + of, column.buffer);
  kernel.set("offset_" + of, column.offset);
  kernel.set("stride_" + of, column.stride);
}

}  // namespace

RowTotals::RowTotals(const Device& device, ChunkQueue& queue, std::size_t capacity)
    : refused_(device.context, CL_MEM_READ_WRITE, sizeof(cl_uint)),
      sums_(device.context, CL_MEM_WRITE_ONLY, blocks_of(capacity) * sizeof(RowSums)) {
  forget_refusal(queue);
}

void RowTotals::bind(NamedKernel& rows, const RowGroups& groups) const {
  rows.set("sums", sums_);
  rows.set("of_items", cl::Local(groups.group_size * sizeof(RowSums)));
}

void RowTotals::fetch(ChunkQueue& queue, std::size_t size) {
  queue.read_bytes(refused_, std::as_writable_bytes(std::span(&is_refused_, 1)));
  of_blocks_.resize(blocks_of(size));
  queue.read_bytes(sums_, std::as_writable_bytes(std::span(of_blocks_)));
}

void RowTotals::forget_refusal(ChunkQueue& queue) {
  queue.clear(refused_, sizeof(cl_uint));
}

void bind_points(NamedKernel& kernel, const BoundChunk& chunk) {
  for (std::size_t i = 0; i < axes.size(); ++i) bind(kernel, axes[i], chunk.coordinates[i]);
}

void bind_rows(NamedKernel& kernel, const BoundChunk& chunk) {
  bind(kernel, "lo", chunk.ends[0]);
  bind(kernel, "hi", chunk.ends[1]);
  bind(kernel, "status", chunk.status);
}

void bind_criterion(NamedKernel& kernel, const Scale& scale, const RowCriterion& criterion) {
  kernel.set("factor", scale.factor());
  kernel.set("inverse", scale.inverse());
  kernel.set("tolerance", criterion.tolerance);
  kernel.set("inside", criterion.inside);
  kernel.set("outside", criterion.outside);
  kernel.set("radius", criterion.radius);
}

namespace {

std::string_view sources_of(const DeviceModel& model) {
  return model.has_tapered() ? kernels::embedded_tapered_point_map() : kernels::embedded_point_map();
}

}  // namespace

cl::Program point_map_program(const Device& device, const DeviceModel& model) {
  const cl::Program program =
      build_program(device.context, device.device, device.vector_width, sources_of(model), model.memory);
  require_sound(device, program, "kernel of rows at once",
                [&] { return first_fault_at_once(device, program, model.has_tapered()); });
  return program;
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

RowsInSteps::RowsInSteps(const Device& device, const PointPrograms& programs, const DeviceModel& model,
                         ChunkQueue& queue, const RowCriterion& criterion, const RowTotals& totals)
    : groups_(device),
      scale_(model.scale_exponent),
      kernels_(device, programs, model, queue, scale_.to_device(criterion.tolerance)),
      point_columns_(programs.untapered, kernels::embedded_point_sources(), "point_columns"),
      point_rows_(programs.untapered, kernels::embedded_point_sources(), "point_rows") {
  point_columns_.set("vectors", vectors_of_columns());
  point_columns_.set("factor", scale_.factor());
  point_columns_.set(coordinate_arguments, kernels_.coordinates());
  totals.bind_refusal(point_columns_);
  point_rows_.set("vectors", groups_.vectors_of_item());
  bind_criterion(point_rows_, scale_, criterion);
  point_rows_.set(coordinate_arguments, kernels_.coordinates());
  point_rows_.set(union_arguments, kernels_.ends());
  totals.bind(point_rows_, groups_);
}

void RowsInSteps::enqueue(ChunkQueue& queue, const BoundChunk& chunk, std::size_t size, bool searched) {
  point_columns_.set("size", size);
  bind_points(point_columns_, chunk);
  point_rows_.set("size", size);
  bind_rows(point_rows_, chunk);
  const std::size_t vectors = groups_.vectors_of(size);
  const std::size_t items = (vectors + vectors_of_columns() - 1) / vectors_of_columns();
  groups_.group_size == 1 ? queue.launch(point_columns_, items, 1) : queue.launch(point_columns_, items);
  searched ? kernels_.enqueue(queue, vectors) : kernels_.enqueue_outside(queue, vectors);
  enqueue_rows(queue, size);
}

void RowsInSteps::enqueue_depths(ChunkQueue& queue, std::size_t size) {
  kernels_.enqueue_inside(queue, groups_.vectors_of(size));
  enqueue_rows(queue, size);
}

void RowsInSteps::enqueue_rows(ChunkQueue& queue, std::size_t size) {
  queue.launch(point_rows_, blocks_of(size) * groups_.group_size, groups_.group_size);
}

namespace {

// If the host has no work for a point between two chunks, a launch is their whole cost. Open rows make chunks shorter
// (host/maps/piped_map.hpp), so that limits are still noticed soon.
constexpr std::size_t points_of_processor_chunk = std::size_t{1} << 16U;

// The programs that a pipe's slots share, each compiled at its first use: maps without points inside wait for one
// kernel alone.
class PipePrograms {
 public:
  PipePrograms(const Device& device, const DeviceModel& model) : device_(device), model_(model) {}

  const PointPrograms& in_steps() {
    if (!in_steps_) in_steps_ = point_programs(device_, model_.memory, model_.has_tapered());
    return *in_steps_;
  }
  const cl::Program& at_once() {
    if (!at_once_) at_once_ = point_map_program(device_, model_);
    return *at_once_;
  }

 private:
  Device device_;
  DeviceModel model_;
  std::optional<PointPrograms> in_steps_;
  std::optional<cl::Program> at_once_;
};

// One chunk on its way through the device.
class PipeSlot {
 public:
  PipeSlot(const Device& device, const DeviceModel& model, const RowCriterion& criterion, bool copied,
           std::shared_ptr<PipePrograms> programs)
      : device_(device),
        model_(model),
        criterion_(criterion),
        programs_(std::move(programs)),
        queue_(device),
        memory_(copied ? copied_memory(device, queue_, model.chunk_size) : shared_memory(device)),
        totals_(std::make_unique<RowTotals>(device, queue_, model.chunk_size)) {
    if (model.count == 1)
      at_once_.emplace(device, programs_->at_once(), model, criterion, *totals_);
    else
      make_steps();
  }

  /// `searched`: whether points inside are searched at once, or only when there are some.
  void start(const PointColumns& points, const ResultColumns& rows, bool searched) {
    size_ = points.size();
    searched_ = searched;
    bound_ = memory_->bind(queue_, points, rows);
    if (at_once_ && !searched)
      at_once_->enqueue(queue_, bound_, size_);
    else
      steps().enqueue(queue_, bound_, size_, searched);
    fetch();
  }

  std::vector<Running> finish() {
    const Release release(*this);
    std::vector<Running> times = queue_.finish();
    if (!searched_ && !totals_->refused() && may_be_inside()) {
      searched_ = true;
      at_once_ ? steps().enqueue(queue_, bound_, size_, true) : steps().enqueue_depths(queue_, size_);
      fetch();
      std::ranges::copy(queue_.finish(), std::back_inserter(times));
    }
    memory_->deliver();
    if (totals_->refused()) totals_->forget_refusal(queue_);
    return times;
  }

  /// Returns whether depths were searched for the chunk that was finished last.
  [[nodiscard]] bool searched() const { return searched_; }

  // Precondition: finished.
  [[nodiscard]] ChunkOutcome outcome() {
    blocks_.clear();
    for (const RowSums& sums : totals_->of_blocks()) {
      const std::size_t first = blocks_.size() * rows_of_block;
      blocks_.push_back({first, std::min(rows_of_block, size_ - first), sums});
    }
    return {totals_->refused(), blocks_};
  }

 private:
  // Whatever happens, nothing is kept of the caller's memory.
  class Release {
   public:
    explicit Release(PipeSlot& slot) : slot_(slot) {}
    ~Release() {
      slot_.bound_ = {};
      slot_.memory_->release();
    }
    Release(const Release&) = delete;
    Release& operator=(const Release&) = delete;

   private:
    PipeSlot& slot_;
  };

  void make_steps() { in_steps_.emplace(device_, programs_->in_steps(), model_, queue_, criterion_, *totals_); }
  RowsInSteps& steps() {
    if (!in_steps_) make_steps();
    return *in_steps_;
  }

  void fetch() {
    memory_->fetch(queue_);
    totals_->fetch(queue_, size_);
    queue_.flush();
  }

  // A point inside whose depth is not searched has a row at least as wide as it is deep. If that is more than the
  // tolerance, the row is open, or wide.
  [[nodiscard]] bool may_be_inside() const {
    return std::ranges::any_of(totals_->of_blocks(),
                               [](const RowSums& s) { return s.open_inside > 0 || s.wide_inside > 0; });
  }

  Device device_;
  DeviceModel model_;
  RowCriterion criterion_;
  std::shared_ptr<PipePrograms> programs_;
  ChunkQueue queue_;
  std::unique_ptr<HostMemory> memory_;
  std::unique_ptr<RowTotals> totals_;  // where the others know it
  std::optional<RowsAtOnce> at_once_;
  std::optional<RowsInSteps> in_steps_;  // of a single primitive nothing until points inside are met
  BoundChunk bound_;
  std::size_t size_ = 0;
  bool searched_ = false;
  std::vector<RowBlock> blocks_;
};

class DevicePipe final : public PointPipe {
 public:
  DevicePipe(const Device& device, const Model& model, const RowCriterion& criterion, bool copied)
      : device_(device.name) {
    const DeviceModel uploaded(device, model, points_of_processor_chunk);
    capacity_ = uploaded.chunk_size;
    const auto programs = std::make_shared<PipePrograms>(device, uploaded);
    slots_.reserve(2);
    for (int slot = 0; slot < 2; ++slot) slots_.emplace_back(device, uploaded, criterion, copied, programs);
    warm_up({far_away(uploaded), 0.0, 0.0});
  }

  [[nodiscard]] std::size_t capacity() const override { return capacity_; }
  [[nodiscard]] double device_seconds() const override { return busy_.seconds(); }

  void submit(const PointColumns& points, const ResultColumns& rows) override {
    PipeSlot& slot = slots_[next_];
    in_flight_.push_back(next_);  // first: what begins before a failure must end, too
    next_ = (next_ + 1) % slots_.size();
    reporting_failures(device_, [&] { slot.start(points, rows, has_points_inside_); });
  }

  ChunkOutcome collect() override {
    PipeSlot& oldest = slots_[in_flight_.front()];
    in_flight_.pop_front();
    busy_.add(reporting_failures(device_, [&] { return oldest.finish(); }));
    has_points_inside_ = has_points_inside_ || oldest.searched();
    return oldest.outcome();
  }

  void discard() override {
    std::exception_ptr failure;
    while (!in_flight_.empty()) {
      try {
        (void)DevicePipe::collect();
      } catch (const Error&) {
        failure = std::current_exception();  // the other chunk must end, too
      }
    }
    if (failure) std::rethrow_exception(failure);
  }

 private:
  void warm_up(const Point& point) {
    const std::vector<Point> points(std::min(capacity_, queries_of_warm_up), point);
    std::vector<MapResult> rows(points.size());
    for (std::size_t slot = 0; slot < slots_.size(); ++slot) {
      DevicePipe::submit(std::span(points), std::span(rows));
      (void)DevicePipe::collect();
    }
    busy_ = {};
  }

  std::string device_;
  std::size_t capacity_ = 0;
  std::vector<PipeSlot> slots_;
  std::deque<std::size_t> in_flight_;
  std::size_t next_ = 0;
  // Depths are searched together with distances once a chunk has needed them. Before, maps without points inside wait
  // neither for their kernel's compilation nor, in every chunk, for its empty run.
  bool has_points_inside_ = false;
  BusyTime busy_;
};

}  // namespace

std::unique_ptr<PointPipe> point_pipe(const Device& device, const Model& model, const RowCriterion& criterion,
                                      MemoryAccess access) {
  const bool copied = access == MemoryAccess::by_copies || !shares_memory(device);
  return reporting_failures(device.name,
                            [&] { return std::make_unique<DevicePipe>(device, model, criterion, copied); });
}

namespace {

// One of the pipes, and how fast it was.
struct Member {
  std::unique_ptr<PointPipe> pipe;
  double points_a_second = 0.0;  // of its last chunks; 0: not known yet
};

class SeveralPipes final : public PointPipe {
 public:
  explicit SeveralPipes(std::vector<std::unique_ptr<PointPipe>> pipes) {
    for (auto& pipe : pipes) members_.push_back({std::move(pipe)});
  }

  [[nodiscard]] std::size_t largest_chunk() const override {
    std::size_t largest = 0;
    for (const Member& member : members_) largest = std::max(largest, member.pipe->largest_chunk());
    return largest;
  }

  // Chosen so that all take about as long for their chunks: rows come back in order, and the fast ones would wait for
  // the slow.
  [[nodiscard]] std::size_t capacity() const override {
    const Member& next = members_[next_];
    const auto slower = [](const Member& a, const Member& b) { return a.points_a_second < b.points_a_second; };
    const double fastest = std::ranges::max_element(members_, slower)->points_a_second;
    const std::size_t all = next.pipe->capacity();
    if (next.points_a_second == 0.0) return all;
    const auto share = static_cast<std::size_t>(static_cast<double>(all) * next.points_a_second / fastest);
    return std::max(share - share % rows_side_by_side, rows_side_by_side);
  }

  [[nodiscard]] std::size_t depth() const override {
    std::size_t sum = 0;
    for (const Member& member : members_) sum += member.pipe->depth();
    return sum;
  }

  void submit(const PointColumns& points, const ResultColumns& rows) override {
    in_flight_.push_back({next_, points.size()});  // first: what begins before a failure must end, too
    next_ = (next_ + 1) % members_.size();
    members_[in_flight_.back().member].pipe->submit(points, rows);
  }

  ChunkOutcome collect() override {
    const Flight oldest = in_flight_.front();
    in_flight_.pop_front();
    Member& member = members_[oldest.member];
    const double before = member.pipe->device_seconds();
    const ChunkOutcome outcome = member.pipe->collect();
    const double seconds = member.pipe->device_seconds() - before;
    if (seconds > 0.0) member.points_a_second = static_cast<double>(oldest.points) / seconds;
    return outcome;
  }

  void discard() override {
    in_flight_.clear();
    std::exception_ptr failure;
    for (const Member& member : members_) {
      try {
        member.pipe->discard();
      } catch (const Error&) {
        failure = std::current_exception();  // the others must end, too
      }
    }
    if (failure) std::rethrow_exception(failure);
  }

  // The time of the pipe that took longest.
  [[nodiscard]] double device_seconds() const override {
    double longest = 0.0;
    for (const Member& member : members_) longest = std::max(longest, member.pipe->device_seconds());
    return longest;
  }

 private:
  struct Flight {
    std::size_t member, points;
  };

  std::vector<Member> members_;
  std::deque<Flight> in_flight_;
  std::size_t next_ = 0;
};

}  // namespace

std::unique_ptr<PointPipe> several_pipes(std::vector<std::unique_ptr<PointPipe>> pipes) {
  if (pipes.size() == 1) return std::move(pipes.front());
  return std::make_unique<SeveralPipes>(std::move(pipes));
}

}  // namespace verisq::device
