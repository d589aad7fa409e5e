// Everything that comes before a tag is right: sealed datagrams, announcements, frames of a sealed connection, and
// texts of keys. The first byte says which the rest is. Nothing that this file did not seal itself may be opened.
#include <cstdint>
#include <string_view>
#include <vector>

#include "peerd/net/seal/sealer.hpp"
#include "peerd/net/seal/stream_seal.hpp"
#include "tests/fuzz/require.hpp"

namespace {

using namespace peerd;
using fuzz::require;
using seal::Sealer;
using seal::StreamSeal;

struct Session {
  keys::SymmetricKey key = keys::SymmetricKey::random();
  Sealer one{key, {.peer = PeerId{1}, .identity = keys::Identity::random()}};
  Sealer other{key, {.peer = PeerId{2}, .identity = keys::Identity::random()}};
  HostTime now{};

  Session() {
    for (int i = 0; i < 3; ++i, now += std::chrono::milliseconds(20)) {
      if (const auto due = one.announcement_due(now)) require(!other.hear(*due, now));
      if (const auto due = other.announcement_due(now)) require(!one.hear(*due, now));
    }
    require(other.open(now, RegionId{0}, one.seal(now, RegionId{0}, {}, true)).has_value());
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static Session session;
  if (size == 0) return 0;
  const std::span<const std::byte> bytes(reinterpret_cast<const std::byte*>(data) + 1, size - 1);
  const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
  switch (data[0] % 4) {
    case 0:
      require(!session.other.open(session.now, RegionId{0}, bytes));
      break;
    case 1:
      if (Sealer::is_announcement(bytes)) require(session.other.hear(bytes, session.now).has_value());
      break;
    case 2: {
      StreamSeal stream(session.key, StreamSeal::End::kServer);
      if (text.size() < StreamSeal::kHello_bytes) return 0;
      if (!stream.take_hello(text.substr(0, StreamSeal::kHello_bytes))) return 0;
      require(!stream.open(text.substr(StreamSeal::kHello_bytes)));
      break;
    }
    default:
      if (const auto key = keys::SymmetricKey::of_text(text)) require(key->text() == text);
  }
  return 0;
}
