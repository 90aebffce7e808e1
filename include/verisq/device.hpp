/// OpenCL devices that passed their self-test, and how long may be waited for them.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace verisq {

// The one clock of a command or a call: when all its work is to end. Its hooks are what options of the library ask.

/// True once one of them says so: an interruption, or a time limit. Each may be empty, and says nothing then.
[[nodiscard]] inline std::function<bool()> either(std::function<bool()> first, std::function<bool()> second) {
  if (!second) return first;
  if (!first) return second;
  return [first = std::move(first), second = std::move(second)] { return first() || second(); };
}

/// A time limit, and an interruption. May be asked by all threads that the interruption may.
class Deadline {
 public:
  using Clock = std::chrono::steady_clock;

  /// In seconds; nothing: no limit. `now` tells the time.
  explicit Deadline(std::optional<double> seconds, std::function<bool()> interrupted = {},
                    std::function<Clock::time_point()> now = Clock::now)
      : seconds_(seconds), interrupted_(std::move(interrupted)), now_(std::move(now)) {}
  /// Others keep its hooks, which refer to it.
  Deadline(const Deadline&) = delete;
  Deadline& operator=(const Deadline&) = delete;

  [[nodiscard]] bool given() const { return seconds_.has_value(); }

  /// Begins to count: preparations before it are free. Precondition: nobody asks meanwhile.
  void start() { begun_ = now_(); }

  /// True once the time limit is reached; never before `start`.
  [[nodiscard]] bool passed() const {
    return seconds_ && begun_ && std::chrono::duration<double>(now_() - *begun_).count() >= *seconds_;
  }

  [[nodiscard]] bool interrupted() const { return interrupted_ && interrupted_(); }
  /// For whatever reason.
  [[nodiscard]] bool over() const { return interrupted() || passed(); }

  /// Hooks for options of the library, to be called while this lives. Without a limit the first one is empty.
  [[nodiscard]] std::function<bool()> out_of_time() const {
    if (!given()) return {};
    return [this] { return passed(); };
  }
  [[nodiscard]] std::function<bool()> stop() const {
    return [this] { return over(); };
  }

 private:
  std::optional<double> seconds_;
  std::function<bool()> interrupted_;
  std::function<Clock::time_point()> now_;
  std::optional<Clock::time_point> begun_;
};

// OpenCL devices: which there are, and whether their arithmetic passed the self-test.

/// One row of `verisq devices`.
struct DeviceReport {
  std::size_t index;  ///< what `--device` accepts
  std::string name;
  std::string platform;
  std::string driver;
  int vector_width;     ///< points a work-item: 16, 8, 4 or 1
  bool passed;          ///< self-test
  std::string failure;  ///< the failing operation and operands; empty when passed
};

/// Runs (or takes from the cache) the self-test of every device. Empty when there is no OpenCL device.
[[nodiscard]] std::vector<DeviceReport> test_devices();

/// An interruption or a time limit may end work while a driver compiles kernels. The compilation then goes on in a
/// thread, and the process waits for it at its end. After this call the process leaves at once instead, by std::_Exit:
/// for programs that have nothing left to do at `exit`.
void leave_compilations_at_exit();

/// How tight one directed operation is: the largest distance of a bound from the tightest binary64 bound, in units of
/// the exact value's last place (at least 2^-1022, the slack of the kernels near zero). NaN where nothing was measured.
struct FunctionAccuracy {
  std::string function;
  double down, up;  ///< lower and upper bounds
  std::uint64_t samples;
  std::uint64_t unsound;  ///< bounds that lie inside the exact value, or none where there must be one: 0, or a defect
};

/// Every directed operation and interval operation of the host's trusted core on `samples` adversarial and random
/// operands each, the same at every call, against MPFR. `progress` is called with the finished part in [0, 1].
[[nodiscard]] std::vector<FunctionAccuracy> host_accuracy(std::size_t samples,
                                                          const std::function<void(double)>& progress = {});

/// The same of the kernels on the device of this index in `test_devices`. Throws Error(input) when there is none or it
/// failed its self-test, Error(failure) for errors of the device. Rows are those of `host_accuracy`, in its order.
[[nodiscard]] std::vector<FunctionAccuracy> device_accuracy(std::size_t index, std::size_t samples,
                                                            const std::function<void(double)>& progress = {});

}  // namespace verisq
