#include "peerd/peer/store/store_keeper.hpp"

#include <algorithm>
#include <cassert>
#include <utility>
#include <vector>

namespace peerd::store {

void StoreKeeper::add(const UnstoredGrowth::Growth& growth, HostTime now) {
  unstored_.add(growth);
  own_waits_ = own_waits_ || growth.range.author == store_.author();
  due_ = std::min(due_, now + kStoredWithin);
}

StoreKeeper::Written StoreKeeper::write(HostTime now) {
  Written written;
  due_ = HostTime::max();
  own_waits_ = false;
  while (!unstored_.empty()) {
    const auto batch = unstored_.next_batch();
    std::vector<replication::OperationPart> parts;
    for (const UnstoredGrowth::Growth& grown : batch) {
      const auto bytes = logs_.bytes(grown.range);
      assert(bytes.size() == grown.range.to - grown.range.from);
      parts.push_back({grown.range.author, grown.range.from, {bytes.begin(), bytes.end()}});
    }
    if (auto stored = store_.append(parts); !stored) {
      written.begins_to_fail = !std::exchange(fails_, true);
      written.error = std::move(stored.error());
      written.must_stop = store_.must_stop();
      due_ = now + kTriedAgainAfter;
      return written;
    }
    for (const UnstoredGrowth::Growth& grown : batch) {
      if (grown.range.author == store_.author()) written.own = grown.last;
    }
    unstored_.drop(batch.size());
  }
  written.is_good_again = std::exchange(fails_, false);
  const bool packs = store_.packing_error().empty();
  if (std::exchange(packs_, packs) && !packs) written.begins_not_to_pack = store_.packing_error();
  return written;
}

}  // namespace peerd::store
