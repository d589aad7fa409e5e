#pragma once
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "replication/session/membership.hpp"
#include "replication/settings/output/outbox.hpp"
#include "replication/wire/codec.hpp"
#include "tests/replication/peer/worlds.hpp"

// Helpers that the tests of a peer's single parts share.
namespace peerd::replication::test {

// A member of the session that was received at `now`, in incarnation 100.
inline Member& add_member(Membership& members, std::uint32_t id, HostTime now = host(0s)) {
  members.on_datagram(now, PeerId{id}, 100);
  Member& member = *members.find(PeerId{id});
  member.synchronised = true;
  return member;
}

// The member echoes this peer: `loss` of this peer's datagrams get lost on their way to it.
inline void echo_us(Member& member, double loss, const Received& received = {}) {
  (void)member.echo.on_echo({PeerId{1}, received.highest, Duration{0}, received, loss});
}

// The outputs of one kind, in order. The outbox is empty afterwards.
template <class Kind>
std::vector<Kind> drain(Outbox& outbox) {
  std::vector<Kind> all;
  while (auto out = outbox.poll()) {
    if (auto* kind = std::get_if<Kind>(&*out)) all.push_back(std::move(*kind));
  }
  return all;
}

// The messages that were sent, in order, with the region of each. The outbox is empty afterwards.
inline std::vector<std::pair<RegionId, Message>> drain_messages(Outbox& outbox, SimTime near) {
  std::vector<std::pair<RegionId, Message>> all;
  for (const Send& send : drain<Send>(outbox)) {
    auto message = decode(send.datagram, near);
    if (message) {
      all.emplace_back(send.region, std::move(*message));
    } else {
      ADD_FAILURE() << to_string(message.error());
    }
  }
  return all;
}

}  // namespace peerd::replication::test
