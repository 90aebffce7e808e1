/// This file implements the way of points through a device from the caller's memory and back to it.
#include "host/batches/point_pipe.hpp"

#include <algorithm>
#include <deque>
#include <exception>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/batches/busy_time.hpp"
#include "host/batches/chunk_pipeline.hpp"
#include "host/batches/chunk_queue.hpp"
#include "host/batches/convex_distance.hpp"
#include "host/batches/device_model.hpp"
#include "host/batches/host_memory.hpp"
#include "host/batches/row_kernels.hpp"
#include "host/batches/rows_at_once.hpp"
#include "host/batches/rows_in_steps.hpp"

namespace verisq::device {
namespace {

// With no work for a point on the host between two chunks a launch is what they cost; open rows make chunks shorter
// (host/maps/piped_run.hpp), so that limits are felt all the same.
constexpr std::size_t points_of_processor_chunk = std::size_t{1} << 16U;

bool shares_memory(const Device& device) {
  return (device.device.getInfo<CL_DEVICE_TYPE>() & CL_DEVICE_TYPE_CPU) != 0;
}

// The programs that a pipe's slots share, each compiled when it is first asked for: maps without points inside wait for
// one kernel alone.
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

  /// `searched`: whether points inside are searched at once, or when it is known that there are some.
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

  /// Of the chunk that was finished last.
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

  // A point inside whose depth is not searched has a row at least as wide as it is deep: where that is more than asked
  // for, the row is open, or wide.
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
  // Depths are searched together with distances once a chunk has asked for them: before, maps without any wait neither
  // for their kernel's compilation nor, in every chunk, for it to find nothing.
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

}  // namespace verisq::device
