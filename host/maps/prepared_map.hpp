/// A prover and, unless the host does all, a device made ready: a map of one kind of query.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "host/batches/batch.hpp"
#include "host/batches/device_model.hpp"
#include "host/device/device.hpp"
#include "host/maps/exact_map.hpp"
#include "host/maps/map_run.hpp"

namespace verisq {

/// `Prover` as MapRun asks for it.
template <class Query, class Prover>
class PreparedMap final : public ExactMap<Query> {
 public:
  /// `primitives` are all that the device must be able to hold; `make_batch(device)` makes the device ready, unless
  /// `unsuited` says why no device is to be used.
  template <class MakeBatch>
  PreparedMap(Prover prover, const MapOptions& options, const Model& primitives, const MakeBatch& make_batch,
              const std::string& unsuited = {})
      : options_(options), prover_(std::move(prover)) {
    if (options.device == "host") return;
    const device::Selection selection = device::select_device(options.device);
    notice_ = selection.notice;
    if (!selection.device) return;
    if (!device::within_device_range(primitives)) {
      notice_ = "the model's sizes span more than the device's kernels are made for";
      return;
    }
    if (!unsuited.empty()) {
      notice_ = unsuited;
      return;
    }
    name_ = selection.device->name;
    batch_ = make_batch(*selection.device);
  }

  MapSummary map(const Source<Query>& source, const Sink<Query>& sink) override {
    MapRun<Query, Prover> run(prover_, options_, source, sink);
    MapSummary summary = batch_ ? run.on_device(*batch_) : run.on_host();
    summary.device = name_;
    summary.notice = notice_;
    return summary;
  }

 private:
  MapOptions options_;
  Prover prover_;
  std::string name_ = "host";
  std::string notice_;
  std::unique_ptr<device::Batch<Query>> batch_;  // nothing: the host does all
};

}  // namespace verisq
