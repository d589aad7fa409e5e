#include "peerd/lab/chaos/host_store.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace peerd::chaos {

Result<HostStore::Opened> HostStore::open(std::uint64_t genesis, replication::AuthorId fresh) {
  assert(!store_);
  auto store = store::OperationStore::open(std::make_unique<SimulatedFolder>(files_, path_), genesis, {fresh});
  if (!store) return std::unexpected(std::move(store.error()));
  store_ = *std::move(store);
  Opened opened{store_->author(), store_->take_log(), std::nullopt};
  for (const auto& [author, bytes] : promised_) {
    const auto log = std::ranges::find(store_->logs(), author, &store::StoredLog::author);
    if (log == store_->logs().end() || log->bytes < bytes) opened.lost = author;
  }
  return opened;
}

bool HostStore::exists() const { return store::OperationStore::exists(SimulatedFolder(files_, path_)); }

void HostStore::keep(const replication::OperationLogs& logs) {
  assert(store_ && !keeper_);
  keeper_.emplace(*store_, logs);
}

void HostStore::add(const store::UnstoredGrowth::Growth& growth, HostTime now) {
  assert(keeper_);
  keeper_->add(growth, now);
  added_[growth.range.author] = growth.range.to;
}

store::StoreKeeper::Written HostStore::write(HostTime now) {
  assert(keeper_);
  auto written = keeper_->write(now);
  if (!written.error) {
    for (const auto& [author, bytes] : std::exchange(added_, {})) promised_[author] = bytes;
  }
  return written;
}

void HostStore::close() {
  keeper_.reset();
  store_.reset();
  added_.clear();
}

void HostStore::crash(bool power_was_cut) {
  disk_.die();
  close();
  disk_.revive(power_was_cut);
}

}  // namespace peerd::chaos
