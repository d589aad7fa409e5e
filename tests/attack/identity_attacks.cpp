#include <array>
#include <random>

#include "peerd/net/seal/sealer.hpp"
#include "tests/attack/attacks.hpp"
#include "tests/attack/target.hpp"

namespace peerd::attack {
namespace {

using namespace std::chrono_literals;

// The last announcements of the session's own peers, which tell a new identity which boots to name.
class Overheard {
 public:
  explicit Overheard(const Target& target) : socket_(opened(target)) {
    if (!socket_->join(kAll)) fail("can't join the session's group");
    socket_->on_receive([this](const net::Arrival& arrival) {
      if (!seal::Sealer::is_announcement(arrival.datagram)) return;
      last_[arrival.from.address()] = {arrival.datagram.begin(), arrival.datagram.end()};
    });
  }
  void listen(std::chrono::milliseconds time) { io_.run_for(time); }
  [[nodiscard]] const auto& last() const { return last_; }
  [[nodiscard]] HostTime now() const { return clock_.now(); }
  void send(std::span<const std::byte> datagram) { socket_->send(kAll, datagram); }
  void flush() { socket_->flush(); }

 private:
  [[nodiscard]] std::unique_ptr<net::MulticastSocket> opened(const Target& target) {
    net::MulticastOptions options = multicast(target);
    options.receives_own_datagrams = false;
    auto socket = net::MulticastSocket::open(io_, clock_, options);
    if (!socket) fail(socket.error().sentence);
    return *std::move(socket);
  }

  boost::asio::io_context io_{1};
  net::HostClock clock_;
  std::unique_ptr<net::MulticastSocket> socket_;
  std::map<boost::asio::ip::address, std::vector<std::byte>> last_;
};

// Announces a start of `self()` so often. It names all boots by its first announcement, and is proven at once.
template <class Self>
std::uint64_t announce(const Target& target, double rate, Self self) {
  const keys::SymmetricKey key = session_key(target);
  Overheard session(target);
  session.listen(1500ms);
  if (session.last().empty()) fail("no peer announces itself");
  std::uint64_t sent = 0;
  const auto one = [&] {
    seal::Sealer sealer(key, self());
    for (const auto& [address, announcement] : session.last()) {
      (void)sealer.hear(announcement, session.now(), boost::asio::ip::address());
    }
    if (const auto announcement = sealer.announcement_due(session.now())) {
      session.send(*announcement);
      ++sent;
    }
  };
  repeat(target, target.rate > 0 ? target.rate : rate, one, [&] {
    session.flush();
    session.listen(1ms);
  });
  session.flush();
  return sent;
}

Sent identities(const Target& target) {
  std::mt19937 random(std::random_device{}());
  return {{"identities", announce(target, 195, [&] {
             return seal::Sealer::Self{.peer = PeerId{static_cast<std::uint32_t>(random()) | 1u},
                                       .identity = keys::Identity::random()};
           })}};
}

// Starts of an identity that is here, with its number: as a copy of its key file would make them.
Sent second_process(const Target& target) {
  return {{"starts", announce(target, 20, [&] {
             return seal::Sealer::Self{.peer = PeerId{target.number}, .identity = identity(target)};
           })}};
}

constexpr std::array kIdentityAttacks{
    Attack{"identities", "a member announces 195 identities a second, each with a number and a start of its own",
           identities},
    Attack{"second-process", "somebody who has copied a peer's identity starts it 20 times a second", second_process},
};

}  // namespace

std::span<const Attack> identity_attacks() { return kIdentityAttacks; }

}  // namespace peerd::attack
