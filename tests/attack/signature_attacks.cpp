#include <sodium.h>

#include <algorithm>
#include <array>

#include "peerd/net/keys/little_endian.hpp"
#include "peerd/net/seal/sealer.hpp"
#include "tests/attack/attacks.hpp"
#include "tests/attack/hostile_member.hpp"

namespace peerd::attack {
namespace {

using namespace std::chrono_literals;

// A raw member: it announces itself as others do, and sends whatever bytes it likes.
class RawMember {
 public:
  RawMember(const Target& target, PeerId id)
      : key_(session_key(target)), self_{.peer = id, .identity = identity(target)}, sealer_(key_, self_) {
    auto socket = net::MulticastSocket::open(io_, clock_, multicast(target));
    if (!socket) fail(socket.error().sentence);
    socket_ = *std::move(socket);
    if (!socket_->join(kAll)) fail("can't join the session's group");
    socket_->on_receive([this](const net::Arrival& arrival) {
      if (seal::Sealer::is_announcement(arrival.datagram)) (void)sealer_.hear(arrival.datagram, clock_.now());
    });
  }
  void serve(std::chrono::microseconds time) {
    if (const auto announcement = sealer_.announcement_due(clock_.now())) socket_->send(kAll, *announcement);
    socket_->flush();
    io_.run_for(time);
  }
  // Until it has been heard.
  void enter() {
    for (int i = 0; i < 40; ++i) serve(50ms);
    if (sealer_.proven_count() == 0) fail("no peer has heard of the attacker");
  }
  void send(std::span<const std::byte> datagram) { socket_->send(kAll, datagram); }
  // A datagram that is right but for its signature, which is of nobody; as tests/peerd/net/seal/insider_test.cpp makes
  // it.
  [[nodiscard]] std::vector<std::byte> wrongly_signed(std::uint64_t counter) const {
    std::array<std::uint8_t, 53> of{};
    keys::put(self_.peer.value, std::span(of).subspan<1, 4>());
    std::ranges::copy(self_.identity.public_key().bytes(), of.begin() + 5);
    std::ranges::copy(self_.boot, of.begin() + 37);
    const keys::SymmetricKey key = key_.derived("datagrams", of);
    constexpr std::size_t kContents_bytes = 40 + keys::PublicKey::kSignature_bytes;
    std::vector<std::byte> sealed(seal::Sealer::kAdded_bytes + kContents_bytes);
    const auto out = keys::as_octets(std::span(sealed));
    out[0] = 0xA0;
    keys::put(self_.peer.value, out.subspan(1, 4));
    keys::put(counter, out.subspan(5, 3));
    std::array<std::uint8_t, 12> nonce{}, associated{};
    keys::put(kAll.value, std::span(nonce).first<4>());
    keys::put(counter, std::span(nonce).last<8>());
    std::ranges::copy(somebody_elses_, out.subspan(8 + 40).begin());
    std::ranges::copy(out.first<8>(), associated.begin());
    keys::put(kAll.value, std::span(associated).last<4>());
    crypto_aead_chacha20poly1305_ietf_encrypt(out.data() + 8, nullptr, out.data() + 8, kContents_bytes,
                                              associated.data(), associated.size(), nullptr, nonce.data(), key.data());
    return sealed;
  }

 private:
  keys::SymmetricKey key_;
  seal::Sealer::Self self_;
  seal::Sealer sealer_;
  // It has the form of a signature, so that whoever checks it does all of the work.
  keys::PublicKey::Signature somebody_elses_ = keys::Identity::random().sign("attack", {});
  boost::asio::io_context io_{1};
  net::HostClock clock_;
  std::unique_ptr<net::MulticastSocket> socket_;
};

Sent wrong_signatures(const Target& target) {
  RawMember member(target, PeerId{target.number != 0 ? target.number : 60'000});
  member.enter();
  const auto datagram = member.wrongly_signed(1000);
  std::uint64_t sent = 0;
  repeat(
      target, target.rate > 0 ? target.rate : 8000,
      [&] {
        member.send(datagram);
        ++sent;
      },
      [&] { member.serve(1ms); });
  return {{"datagrams", sent}};
}

Sent different_wrong_signatures(const Target& target) {
  RawMember member(target, PeerId{target.number != 0 ? target.number : 60'000});
  member.enter();
  std::uint64_t sent = 0;
  repeat(
      target, target.rate > 0 ? target.rate : 8000, [&] { member.send(member.wrongly_signed(1000 + sent++)); },
      [&] { member.serve(1ms); });
  return {{"datagrams", sent}};
}

// Requests that ask for nothing are signed, and cost a check each.
Sent right_signatures(const Target& target) {
  HostileMember member(target);
  member.enter();
  const std::uint64_t before = member.sent();
  repeat(
      target, target.rate > 0 ? target.rate : 7000,
      [&] {
        replication::Message m = member.message();
        m.operation_requests.push_back({replication::AuthorId{7}, 0, 1});
        member.send(m);
      },
      [&] { member.serve(1ms); });
  return {{"datagrams", member.sent() - before}};
}

constexpr std::array kSignatureAttacks{
    Attack{"signatures", "a member sends one datagram with a wrong signature 8,000 times a second", wrong_signatures},
    Attack{"many-signatures", "the same, with a datagram of its own each time", different_wrong_signatures},
    Attack{"signed-flood", "a member signs 7,000 datagrams a second, rightly", right_signatures},
};

}  // namespace

std::span<const Attack> signature_attacks() { return kSignatureAttacks; }

}  // namespace peerd::attack
