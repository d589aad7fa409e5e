#include <array>
#include <string>

#include "tests/attack/attacks.hpp"
#include "tests/attack/hostile_member.hpp"

namespace peerd::attack {
namespace {

using namespace std::chrono_literals;
using namespace replication;

constexpr Duration kAhead = std::chrono::milliseconds(300);  // as peers stamp what all shall have by then

// Each prototype has the one before it twice: 2^times nodes.
std::string doubling(int times) {
  std::string text = "#VRML V2.0 utf8\nPROTO P0 [ ] { Group { } }\n";
  for (int i = 1; i <= times; ++i) {
    const std::string before = "P" + std::to_string(i - 1) + " { } ";
    text += "PROTO P" + std::to_string(i) + " [ ] { Group { children [ " + before + before + "] } }\n";
  }
  return text + "P" + std::to_string(times) + " { }\n";
}

// A text of about that size, in one Shape.
std::string large_text(std::size_t bytes) {
  std::string text = "#VRML V2.0 utf8\nShape { geometry PointSet { coord Coordinate { point [ ";
  for (std::size_t i = 0; text.size() < bytes; ++i) text += std::to_string(i % 1000) + " 0 0, ";
  return text + "] } } }\n";
}

// Writes and publishes an edit so often.
template <class Body>
Sent edits(const Target& target, double rate, Body body, Duration ahead = kAhead) {
  HostileMember member(target);
  member.enter();
  std::uint64_t edits = 0;
  repeat(
      target, target.rate > 0 ? target.rate : rate,
      [&] {
        const std::uint64_t from = member.log_bytes();
        (void)member.write(body(edits), member.session_now() + ahead);
        member.publish(from);
        ++edits;
      },
      [&] { member.serve(1ms); });
  for (int i = 0; i < 20; ++i) member.serve(50ms);  // who has lost some of it asks for it
  return {{"edits", edits}, {"bytes", member.log_bytes()}};
}

// Ids of what an edit adds count on by so many, which is more than it adds.
AddNodes add(std::uint64_t number, std::string text, std::uint32_t ids) {
  const auto first = 1 + static_cast<std::uint32_t>(number) * ids;
  return {{}, {}, std::move(text), first, first, {}};
}

Sent doubling_edit(const Target& target) {
  return edits(target, 1, [](std::uint64_t number) { return add(number, doubling(18), 1u << 20); });
}

// The largest of these that peers take (docs/security.md).
Sent growing_edit(const Target& target) {
  return edits(target, 1, [](std::uint64_t number) { return add(number, doubling(9), 1u << 14); });
}

Sent large_edits(const Target& target) {
  return edits(target, 1, [](std::uint64_t number) { return add(number, large_text(1'000'000), 1u << 20); });
}

Sent stamps_ahead(const Target& target) {
  return edits(
      target, 500,
      [](std::uint64_t number) {
        return SendMessage{PeerId{60'000}, "topic", std::to_string(number)};
      },
      std::chrono::hours(24));
}

Sent locks(const Target& target) {
  return edits(target, 200, [](std::uint64_t number) {
    return LockObject{ObjectId{static_cast<std::uint32_t>(number % 400)}, false};
  });
}

// It takes each object of the world for itself, whoever owns it.
Sent claims(const Target& target) {
  HostileMember member(target);
  member.enter();
  std::uint64_t hellos = 0;
  repeat(
      target, target.rate > 0 ? target.rate : 200,
      [&] {
        Message hello = member.hello();
        for (std::uint32_t i = 0; i < 50; ++i) {
          hello.hello->introduction->owned.push_back(ObjectId{static_cast<std::uint32_t>(hellos * 50 % 200) + i});
        }
        member.send(hello);
        ++hellos;
      },
      [&] { member.serve(1ms); });
  return {{"hellos", hellos}};
}

Sent gives(const Target& target) {
  return edits(target, 100, [&](std::uint64_t number) {
    return GiveObject{ObjectId{static_cast<std::uint32_t>(number % 400)}, PeerId{60'000},
                      PeerId{1 + static_cast<std::uint32_t>(number % 3)}};
  });
}

// It says that it leads, and that it is a day later.
Sent clock_shift(const Target& target) {
  Target low = target;
  if (low.number == 0) low.number = 1'000'000;
  HostileMember member(low);
  member.change_hello = [&](Message& hello) {
    if (!hello.hello->session_tx) return;
    hello.hello->session_tx = *hello.hello->session_tx + std::chrono::hours(24);
    hello.hello->clock_error.reset();
  };
  member.enter();
  std::uint64_t hellos = 0;
  repeat(
      target, target.rate > 0 ? target.rate : 50,
      [&] {
        Message hello = member.hello();
        member.change_hello(hello);
        member.send(hello);
        ++hellos;
      },
      [&] { member.serve(1ms); });
  return {{"hellos", hellos}};
}

// It listens to 150 regions anew by each datagram, which no peer has heard of, and sends to their groups.
Sent region_groups(const Target& target) {
  HostileMember member(target);
  member.enter();
  std::uint64_t datagrams = 0;
  repeat(
      target, target.rate > 0 ? target.rate : 1000,
      [&] {
        Message m = member.message();
        const auto first = static_cast<std::uint32_t>(datagrams * kSubscriptionsMax % 100'000) + 1;
        for (std::uint32_t i = 0; i < kSubscriptionsMax; ++i) {
          m.subscriptions.push_back({RegionId{first + i}, member.session_now()});
        }
        member.send(m);
        Message near = member.message();
        member.send(near, RegionId{first});
        ++datagrams;
      },
      [&] { member.serve(1ms); });
  return {{"datagrams", member.sent()}};
}

constexpr std::array kEditAttacks{
    Attack{"doubling-edit", "a member adds 1,048 bytes that stand for 524,287 nodes, once a second", doubling_edit},
    Attack{"growing-edit", "a member adds 536 bytes that stand for 1,023 nodes, which is allowed, once a second",
           growing_edit},
    Attack{"large-edits", "a member adds a text of 1 MB each second", large_edits},
    Attack{"stamps-ahead", "a member writes 500 messages a second that hold from tomorrow on", stamps_ahead},
    Attack{"locks", "a member locks 200 objects a second", locks},
    Attack{"claims", "a member says 200 times a second that it owns others' objects", claims},
    Attack{"gives", "a member takes 100 objects a second of others by edits", gives},
    Attack{"clock-shift", "a member says 50 times a second that it leads and that it is tomorrow", clock_shift},
    Attack{"region-groups", "a member subscribes to 150,000 regions a second and sends to their groups", region_groups},
};

}  // namespace

std::span<const Attack> edit_attacks() { return kEditAttacks; }

}  // namespace peerd::attack
