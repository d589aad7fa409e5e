#include <fcntl.h>
#include <netinet/in.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <deque>
#include <random>
#include <thread>

#include "peerd/net/snapshot/framed_stream.hpp"
#include "peerd/net/snapshot/snapshot_message.hpp"
#include "replication/wire/codec.hpp"
#include "tests/attack/attacks.hpp"
#include "tests/attack/target.hpp"

namespace peerd::attack {
namespace {

using namespace std::chrono_literals;
namespace asio = boost::asio;

// To each question come three answers for the world: one that says that it is open, one with a port where nobody
// listens, and one with a port where somebody listens who says nothing.
Sent forged_answers(const Target& target) {
  asio::io_context io(1);
  const net::HostClock clock;
  asio::ip::tcp::acceptor silent(io, {asio::ip::tcp::v4(), 0});
  std::vector<asio::ip::tcp::socket> held;
  std::function<void()> accept = [&] {
    silent.async_accept([&](const boost::system::error_code& failed, asio::ip::tcp::socket socket) {
      if (!failed) held.push_back(std::move(socket));
      accept();
    });
  };
  accept();
  net::MulticastOptions options = multicast(target);
  options.groups = discovery::group_for(options.groups.base);
  options.receives_own_datagrams = false;
  auto socket = net::MulticastSocket::open(io, clock, options);
  if (!socket) fail(socket.error().sentence);
  if (!(*socket)->join(kAll)) fail("can't join the group of those who ask");
  std::mt19937_64 random(std::random_device{}());
  std::uint64_t questions = 0, answers = 0;
  (*socket)->on_receive([&](const net::Arrival& arrival) {
    if (!discovery::is_question(arrival.datagram)) return;
    ++questions;
    for (int i = 0; i < 3; ++i) {
      const discovery::Beacon beacon{.protocol = replication::kProtocolVersion,
                                     .session = random(),
                                     .peer = PeerId{static_cast<std::uint32_t>(random()) | 1u},
                                     .incarnation = random() >> 1,
                                     .snapshot_port = i == 1 ? std::uint16_t{9} : silent.local_endpoint().port(),
                                     .world = target.world,
                                     .name = "anna",
                                     .sealed = i != 0};
      (*socket)->send(kAll, encode(beacon));
      ++answers;
    }
    (*socket)->flush();
  });
  repeat(
      target, 0, [] {}, [&] { io.run_for(50ms); });
  return {{"questions", questions}, {"answers", answers}, {"connections", held.size()}};
}

void allow_many_files() {
  rlimit limit{};
  getrlimit(RLIMIT_NOFILE, &limit);
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
}

// Connects so often, says `bytes` on each connection and nothing else, and keeps as many open as it is told.
Sent connections(const Target& target, std::string_view bytes) {
  allow_many_files();
  const auto at = provider(target).at;
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(at.port());
  to.sin_addr.s_addr = htonl(at.address().to_v4().to_uint());
  std::deque<int> open;
  const std::size_t kept = target.count > 0 ? target.count : 4000;
  std::uint64_t begun = 0, spoken = 0;
  std::deque<int> silent;
  const auto speak = [&] {
    while (!silent.empty() && !bytes.empty()) {
      const ssize_t sent = send(silent.front(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
      if (sent < 0 && (errno == EAGAIN || errno == ENOTCONN)) return;
      spoken += sent > 0 ? 1 : 0;
      silent.pop_front();
    }
  };
  repeat(
      target, target.rate > 0 ? target.rate : 4000,
      [&] {
        const int fd = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
        if (fd < 0) return;
        const linger now{1, 0};  // a closed one takes no port
        setsockopt(fd, SOL_SOCKET, SO_LINGER, &now, sizeof now);
        (void)connect(fd, reinterpret_cast<const sockaddr*>(&to), sizeof to);
        ++begun;
        open.push_back(fd);
        silent.push_back(fd);
        if (open.size() > kept) {
          std::erase(silent, open.front());
          close(open.front());
          open.pop_front();
        }
      },
      [&] {
        speak();
        if (bytes.empty()) silent.clear();
        std::this_thread::sleep_for(500us);
      });
  for (const int fd : open) close(fd);
  return {{"connections", begun}, {"spoken", spoken}};
}

Sent silent_connections(const Target& target) { return connections(target, ""); }

// The first frame of a joining peer is a key of 32 bytes.
Sent keyed_connections(const Target& target) {
  std::string hello{32, 0, 0, 0};
  std::mt19937 random(1);
  for (int i = 0; i < 32; ++i) hello += static_cast<char>(random());
  return connections(target, hello);
}

// Members ask over and over for the digests of all logs that there are.
Sent digests(const Target& target) {
  const snapshot::Snapshot world = snapshot(target);
  const auto from = provider(target);
  const keys::SymmetricKey key = session_key(target);
  asio::io_context io(1);
  std::uint64_t asked = 0, answered = 0;
  const std::string request = encode(snapshot::Request{world.offer.session, snapshot::DigestRequest{world.offer.logs}});
  using Stream = std::shared_ptr<snapshot::FramedStream>;
  std::vector<Stream> streams;
  std::function<void(Stream)> ask = [&](const Stream& stream) {
    stream->write(request, [&, stream] {
      ++asked;
      stream->read([&, stream](const std::string&) {
        ++answered;
        ask(stream);
      });
    });
  };
  const std::uint32_t count = target.count > 0 ? target.count : 16;
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto stream = std::make_shared<snapshot::FramedStream>(
        asio::ip::tcp::socket(io), snapshot::kReplyMax_bytes, 60s, [](const std::string&) {},
        seal::StreamSeal(key, seal::StreamSeal::End::kClient));
    streams.push_back(stream);
    stream->connect(from.at, [&, stream] { ask(stream); });
  }
  repeat(
      target, 0, [] {}, [&] { io.run_for(50ms); });
  std::uint64_t bytes = 0;
  for (const auto& log : world.offer.logs) bytes += log.bytes;
  return {{"asked", asked}, {"answered", answered}, {"log_bytes", bytes}};
}

constexpr std::array kJoinAttacks{
    Attack{"forged-answers", "a stranger gives three forged answers to each question who is here", forged_answers},
    Attack{"silent-connections", "a stranger connects 4,000 times a second to a peer's port and says nothing",
           silent_connections},
    Attack{"keyed-connections", "the same, and each connection begins with a key of 32 bytes", keyed_connections},
    Attack{"digests", "a member asks over 16 connections for digests of 14.5 MB of edits", digests},
};

}  // namespace

std::span<const Attack> join_attacks() { return kJoinAttacks; }

}  // namespace peerd::attack
