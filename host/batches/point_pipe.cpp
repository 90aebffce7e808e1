/// This file implements the way of points through a device from the caller's memory and back to it.
#include "host/batches/point_pipe.hpp"

#include <algorithm>
#include <array>
#include <deque>
#include <exception>
#include <iterator>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host/batches/busy_time.hpp"
#include "host/batches/chunk_pipeline.hpp"
#include "host/batches/chunk_queue.hpp"
#include "host/batches/convex_distance.hpp"
#include "host/batches/device_model.hpp"
#include "host/batches/host_memory.hpp"
#include "host/batches/kernel_arguments.hpp"
#include "host/batches/point_kernels.hpp"
#include "kernels/embedded_sources.hpp"

namespace verisq::device {
namespace {

// Of one work-group of point_rows, which a look at open rows costs the host at most.
constexpr std::size_t rows_of_block = 1024;

// With no work for a point on the host between two chunks a launch is what they cost; open rows make chunks shorter
// (host/maps/piped_run.hpp), so that limits are felt all the same.
constexpr std::size_t points_of_processor_chunk = std::size_t{1} << 16U;

constexpr std::size_t scalar_group_size = 64;  // work-items of a graphics processor that share a block

bool shares_memory(const Device& device) {
  return (device.device.getInfo<CL_DEVICE_TYPE>() & CL_DEVICE_TYPE_CPU) != 0;
}

void set(NamedKernel& kernel, const std::string& name, const BoundColumn& column) {
  kernel.set("memory_" + name, column.buffer);
  kernel.set("offset_" + name, column.offset);
  kernel.set("stride_" + name, column.stride);
}

// One chunk on its way through the device.
class PipeSlot {
 public:
  PipeSlot(const Device& device, const PointPrograms& programs, const DeviceModel& model, const RowCriterion& criterion,
           bool copied)
      : width_(static_cast<std::size_t>(device.vector_width)),
        group_size_(device.vector_width > 1 ? 1 : scalar_group_size),
        scale_(model.scale_exponent),
        queue_(device),
        memory_(copied ? copied_memory(device, queue_, model.chunk_size) : shared_memory(device)),
        kernels_(device, programs, model, queue_, scale_.to_device(criterion.tolerance)),
        point_columns_(programs.untapered, kernels::embedded_point_sources(), "point_columns"),
        point_rows_(programs.untapered, kernels::embedded_point_sources(), "point_rows"),
        refused_(device.context, CL_MEM_READ_WRITE, sizeof(cl_uint)),
        sums_(device.context, CL_MEM_WRITE_ONLY, blocks_of(model.chunk_size) * sizeof(RowSums)) {
    forget_refused();
    point_columns_.set("vectors", vectors_of_columns());
    point_columns_.set("factor", scale_.factor());
    point_columns_.set(coordinate_arguments, kernels_.coordinates());
    point_columns_.set("refused", refused_);
    point_rows_.set("vectors", rows_of_block / width_ / group_size_);
    point_rows_.set("factor", scale_.factor());
    point_rows_.set("inverse", scale_.inverse());
    point_rows_.set("tolerance", criterion.tolerance);
    point_rows_.set("inside", criterion.inside);
    point_rows_.set("outside", criterion.outside);
    point_rows_.set("radius", criterion.radius);
    point_rows_.set(coordinate_arguments, kernels_.coordinates());
    point_rows_.set(union_arguments, kernels_.ends());
    point_rows_.set("sums", sums_);
    point_rows_.set("of_items", cl::Local(group_size_ * sizeof(RowSums)));
  }

  /// `searched`: whether points inside are searched at once, or when it is known that there are some.
  void start(const PointColumns& points, const ResultColumns& rows, bool searched) {
    size_ = points.size();
    searched_ = searched;
    bound_ = memory_->bind(queue_, points, rows);
    point_columns_.set("size", size_);
    for (std::size_t i = 0; i < 3; ++i) set(point_columns_, std::string(axes[i]), bound_.coordinates[i]);
    point_rows_.set("size", size_);
    set(point_rows_, "lo", bound_.ends[0]);
    set(point_rows_, "hi", bound_.ends[1]);
    set(point_rows_, "status", bound_.status);

    const std::size_t column_items = (groups() + vectors_of_columns() - 1) / vectors_of_columns();
    group_size_ == 1 ? queue_.launch(point_columns_, column_items, 1) : queue_.launch(point_columns_, column_items);
    queue_.read_bytes(refused_, std::as_writable_bytes(std::span(&is_refused_, 1)));
    searched_ ? kernels_.enqueue(queue_, groups()) : kernels_.enqueue_outside(queue_, groups());
    enqueue_rows();
  }

  std::vector<Running> finish() {
    const Release release(*this);
    std::vector<Running> times = queue_.finish();
    if (!searched_ && may_be_inside()) {
      searched_ = true;
      kernels_.enqueue_inside(queue_, groups());
      enqueue_rows();
      std::ranges::copy(queue_.finish(), std::back_inserter(times));
    }
    memory_->deliver();
    if (is_refused_ != 0) forget_refused();
    return times;
  }

  /// Of the chunk that was finished last.
  [[nodiscard]] bool searched() const { return searched_; }

  // Precondition: finished.
  [[nodiscard]] ChunkOutcome outcome() {
    blocks_.clear();
    for (const RowSums& sums : sums_of_blocks_) {
      const std::size_t first = blocks_.size() * rows_of_block;
      blocks_.push_back({first, std::min(rows_of_block, size_ - first), sums});
    }
    return {is_refused_ != 0, blocks_};
  }

 private:
  static constexpr std::array<std::string_view, 3> axes{"x", "y", "z"};

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

  void enqueue_rows() {
    queue_.launch(point_rows_, blocks_of(size_) * group_size_, group_size_);
    memory_->fetch(queue_);
    sums_of_blocks_.resize(blocks_of(size_));
    queue_.read_bytes(sums_, std::as_writable_bytes(std::span(sums_of_blocks_)));
    queue_.flush();
  }

  // A point inside whose depth is not searched has a row at least as wide as it is deep: where that is more than asked
  // for, the row is open, or wide.
  [[nodiscard]] bool may_be_inside() const {
    return std::ranges::any_of(sums_of_blocks_, [](const RowSums& s) { return s.open > 0 || s.wide_inside > 0; });
  }

  [[nodiscard]] std::size_t groups() const { return (size_ + width_ - 1) / width_; }
  static std::size_t blocks_of(std::size_t size) { return (size + rows_of_block - 1) / rows_of_block; }
  // A graphics processor's work-item takes one point, next to those of its neighbours.
  [[nodiscard]] std::size_t vectors_of_columns() const { return group_size_ == 1 ? rows_of_block / width_ : 1; }
  void forget_refused() { queue_.clear(refused_, sizeof(cl_uint)); }

  std::size_t width_;
  std::size_t group_size_;
  Scale scale_;
  ChunkQueue queue_;
  std::unique_ptr<HostMemory> memory_;
  PointKernels kernels_;
  NamedKernel point_columns_;
  NamedKernel point_rows_;
  // Kernels do not keep the buffers that they are given.
  cl::Buffer refused_;
  cl::Buffer sums_;
  BoundChunk bound_;
  std::size_t size_ = 0;
  bool searched_ = false;
  std::vector<RowSums> sums_of_blocks_;
  cl_uint is_refused_ = 0;
  std::vector<RowBlock> blocks_;
};

class DevicePipe final : public PointPipe {
 public:
  DevicePipe(const Device& device, const Model& model, const RowCriterion& criterion, bool copied)
      : device_(device.name) {
    const DeviceModel uploaded(device, model, points_of_processor_chunk);
    capacity_ = uploaded.chunk_size;
    const PointPrograms programs = point_programs(device, uploaded.memory, uploaded.has_tapered());
    slots_.reserve(2);
    for (int slot = 0; slot < 2; ++slot) slots_.emplace_back(device, programs, uploaded, criterion, copied);
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
