#include "replication/wire/hello_lists.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "replication/wire/varint.hpp"

namespace peerd::replication {
namespace {

constexpr std::uint64_t kAddedCollidee = std::uint64_t{1} << 33;  // in a note: the origin of the collidee follows
constexpr std::size_t kEntryMax_bytes = 64;                       // an entry of any list; the longest entry has 33

// The bytes that `put` writes for each entry.
template <class Entry, class Put>
std::string packed_by(const std::vector<Entry>& entries, Put put) {
  std::string bytes;
  std::array<std::byte, kEntryMax_bytes> entry_bytes;
  for (const Entry& entry : entries) {
    BitWriter out(entry_bytes);
    put(out, entry);
    bytes.append(reinterpret_cast<const char*>(entry_bytes.data()), out.finish());
  }
  return bytes;
}

template <class Entry, class Take>
bool take_all(std::string_view bytes, std::vector<Entry>& entries, Take take) {
  BitReader in(std::as_bytes(std::span(bytes)));
  while (in.size_bytes() < bytes.size()) {
    if (!take(in, entries.emplace_back()) || !in.good()) return false;
  }
  return true;
}

template <class Id>
bool take_id(BitReader& in, Id& id) {
  return take_varint(in, id.value);
}

// Whether the mask of missing datagrams is sent; the first missing one is right behind the run.
bool names_holes(const Received& r) { return r.run < std::min(r.highest, Received::kWindow); }

bool take_received(BitReader& in, std::uint32_t highest, Received& r) {
  r.highest = highest;
  r.last = ~std::uint64_t{0};
  if (!take_varint(in, r.run) || highest == 0 || r.run > std::min(highest, Received::kRunMax)) return false;
  if (!names_holes(r)) return true;
  std::uint64_t absent = 0;
  const std::uint32_t counted = std::min(highest, Received::kWindow) - r.run;
  if (!take_varint(in, absent) || absent % 2 == 0) return false;
  if (counted < Received::kWindow && absent >> counted != 0) return false;
  r.last = ~(absent << r.run);
  return true;
}

}  // namespace

std::string packed(const std::vector<Echo>& echoes) {
  return packed_by(echoes, [](BitWriter& out, const Echo& e) {
    const Received& r = e.received;
    assert(r.highest >= e.hello && e.hold_time >= Duration{0});
    put_varint(out, e.peer.value);
    put_varint(out, e.hello);
    put_varint(out, static_cast<std::uint64_t>(e.hold_time.count()));
    put_varint(out, r.highest - e.hello);
    put_varint(out, r.run);
    if (names_holes(r)) put_varint(out, ~r.last >> r.run);
    put_varint(out, static_cast<std::uint64_t>(std::lround(1000.0 * e.loss)));
  });
}

bool take_echoes(std::string_view bytes, std::vector<Echo>& echoes) {
  return take_all(bytes, echoes, [](BitReader& in, Echo& e) {
    std::uint64_t held_ns = 0;
    std::uint32_t newer = 0, loss_permille = 0;
    if (!take_id(in, e.peer) || !take_varint(in, e.hello) || !take_varint(in, held_ns) || !take_varint(in, newer) ||
        newer > std::numeric_limits<std::uint32_t>::max() - e.hello ||
        !take_received(in, e.hello + newer, e.received) || !take_varint(in, loss_permille)) {
      return false;
    }
    if (held_ns > static_cast<std::uint64_t>(kHeldMax.count()) || loss_permille > 1000) return false;
    e.hold_time = Duration{static_cast<std::int64_t>(held_ns)};
    e.loss = 1e-3 * loss_permille;
    return true;
  });
}

bool leaves_out(std::span<const Echo> echoes, PeerId peer) {
  if (echoes.size() < kEchoesMax) return true;
  for (std::size_t i = 1; i < echoes.size(); ++i) {
    const bool after = echoes[i - 1].peer < peer, before = peer < echoes[i].peer;
    const bool round = echoes[i].peer < echoes[i - 1].peer;
    if (round ? after || before : after && before) return true;
  }
  return false;
}

std::string packed(const std::vector<ObjectId>& objects) {
  std::uint64_t last = 0;
  return packed_by(objects, [&](BitWriter& out, ObjectId id) {
    assert(id.packed() >= last);
    put_varint(out, id.packed() - last);
    last = id.packed();
  });
}

bool take_objects(std::string_view bytes, std::vector<ObjectId>& objects) {
  std::uint64_t last = 0;
  return take_all(bytes, objects, [&](BitReader& in, ObjectId& id) {
    std::uint64_t more = 0;
    if (!take_varint(in, more) || more > std::numeric_limits<std::uint64_t>::max() - last) return false;
    id = ObjectId::unpacked(last += more);
    return true;
  });
}

std::string packed(const std::vector<ContactNote>& notes, SimTime base) {
  return packed_by(notes, [&](BitWriter& out, const ContactNote& n) {
    put_object(out, n.collider);
    const bool of_file = n.collidee.origin == 0;
    put_varint(out, (of_file ? 0 : kAddedCollidee) | std::uint64_t{n.collidee.number} << 1 | (n.deferred ? 1 : 0));
    if (!of_file) put_varint(out, n.collidee.origin);
    put_time(out, base, n.contact);
  });
}

bool take_notes(std::string_view bytes, SimTime base, std::vector<ContactNote>& notes) {
  return take_all(bytes, notes, [&](BitReader& in, ContactNote& n) {
    std::uint64_t collidee = 0;
    if (!take_object(in, n.collider) || !take_varint(in, collidee) || collidee >> 34 != 0) return false;
    n.collidee = ObjectId{static_cast<std::uint32_t>(collidee >> 1)};
    if ((collidee & kAddedCollidee) != 0) {
      if (!take_varint(in, n.collidee.origin) || n.collidee.origin == 0) return false;
    }
    n.deferred = (collidee & 1) != 0;
    return take_time(in, base, n.contact);
  });
}

}  // namespace peerd::replication
