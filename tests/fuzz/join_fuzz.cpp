// What a peer that joins, or that is joined, reads of others: beacons, requests, replies and world archives.
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "peerd/input/world_archive.hpp"
#include "peerd/net/discovery/beacon.hpp"
#include "peerd/net/snapshot/snapshot_message.hpp"
#include "peerd/peer/config/shared_settings.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace peerd;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  if (const auto beacon = discovery::decode(std::as_bytes(std::span(data, size)))) {
    assert(discovery::decode(discovery::encode(*beacon)) == beacon);
  }
  if (const auto request = snapshot::decode_request(text)) {
    assert(snapshot::decode_request(snapshot::encode(*request)) == *request);
  }
  if (const auto reply = snapshot::decode_reply(text)) {
    assert(snapshot::decode_reply(snapshot::encode(*reply)) == *reply);
  }
  constexpr std::uint64_t kMost_bytes = 1 << 20;
  if (const auto archive = unpack(text, kMost_bytes)) {
    const auto load = archive->loader("w");
    for (const ArchivedUrl& each : archive->urls) (void)load(each.url, "w");
  }
  (void)config::check_shared(std::string(text));
  return 0;
}
