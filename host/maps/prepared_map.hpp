/// A prover and, unless the host does all, a device made ready: a map of one kind of query.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "host/batches/batch.hpp"
#include "host/device/device.hpp"
#include "host/maps/chosen_device.hpp"
#include "host/maps/exact_map.hpp"
#include "host/maps/map_run.hpp"

namespace verisq {

/// `Prover` as MapRun asks for it.
template <class Query, class Prover>
class PreparedMap final : public ExactMap<Query> {
 public:
  /// Makes a device ready for a kind of work.
  using MakeBatch = std::function<std::unique_ptr<device::Batch<Query>>(const device::Device&)>;

  /// `primitives` are all that the device must be able to hold; `make_batch` makes the device ready, unless
  /// `unsuited` says why no device is to be used (for all that are, `make_batch` may be empty); `make_search`, where
  /// there is one, for MapRun::Search.
  PreparedMap(Prover prover, const MapOptions& options, const Model& primitives, const MakeBatch& make_batch,
              const std::string& unsuited = {}, const MakeBatch& make_search = {})
      : options_(options), prover_(std::move(prover)), chosen_(chosen_device(options, primitives, unsuited)) {
    if (!chosen_.device) return;
    batch_ = make_batch(*chosen_.device);
    if (make_search) make_search_ = [make_search, device = *chosen_.device] { return make_search(device); };
  }

  MapSummary map(const Source<Query>& source, const Sink<Query>& sink) override {
    typename MapRun<Query, Prover>::Search search;
    if (make_search_) search = [this]() -> device::Batch<Query>& { return ready_search(); };
    MapRun<Query, Prover> run(prover_, options_, source, sink, search);
    MapSummary summary = batch_ ? run.on_device(*batch_) : run.on_host();
    summary.device = chosen_.name();
    summary.notice = chosen_.notice;
    return summary;
  }

 private:
  device::Batch<Query>& ready_search() {
    if (!search_) search_ = make_search_();
    return *search_;
  }

  MapOptions options_;
  Prover prover_;
  ChosenDevice chosen_;
  std::unique_ptr<device::Batch<Query>> batch_;                         // nothing: the host does all
  std::function<std::unique_ptr<device::Batch<Query>>()> make_search_;  // empty: the host searches
  std::unique_ptr<device::Batch<Query>> search_;                        // nothing until it is asked for
};

}  // namespace verisq
