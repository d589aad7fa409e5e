#include "peerd/lab/live/link_probe.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>

namespace peerd::live {
namespace {

constexpr std::uint32_t kProbes = 100;
constexpr std::int64_t kInterval_ns = 10'000'000;
constexpr std::uint16_t kPort = 19'999;  // below the ports of scenario runs
constexpr const char* kGroup = "239.192.80.255";

struct Probe {
  std::uint32_t from = 0, number = 0;
  std::int64_t sent_ns = 0;
};

std::int64_t read_clock_ns(clockid_t id) {
  timespec t{};
  clock_gettime(id, &t);
  return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec;
}

InputError system_error(const std::string& what) {
  return {"error: netem: " + what + ": " + std::generic_category().message(errno), kSystemFailed};
}

sockaddr_in group_address() {
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(kPort);
  inet_pton(AF_INET, kGroup, &to.sin_addr);
  return to;
}

struct Received {
  Probe probe;
  std::int64_t at_ns = 0;
};

// Receives one datagram. False means that none waits.
bool receive(int fd, Received& received) {
  iovec part{&received.probe, sizeof received.probe};
  alignas(cmsghdr) std::byte control[CMSG_SPACE(sizeof(timespec))];
  msghdr message{};
  message.msg_iov = &part, message.msg_iovlen = 1;
  message.msg_control = control, message.msg_controllen = sizeof control;
  if (recvmsg(fd, &message, MSG_DONTWAIT) != sizeof received.probe) return false;
  for (cmsghdr* c = CMSG_FIRSTHDR(&message); c != nullptr; c = CMSG_NXTHDR(&message, c)) {
    if (c->cmsg_level != SOL_SOCKET || c->cmsg_type != SCM_TIMESTAMPNS) continue;
    timespec t{};
    std::memcpy(&t, CMSG_DATA(c), sizeof t);
    received.at_ns = std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec;
  }
  return received.at_ns != 0;
}

}  // namespace

Result<ProbeSocket> ProbeSocket::open(const std::string& address) {
  ProbeSocket made(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  sockaddr_in to = group_address();
  ip_mreq membership{};
  membership.imr_multiaddr = to.sin_addr;
  inet_pton(AF_INET, address.c_str(), &membership.imr_interface);
  const int on = 1, off = 0;
  const auto set = [&](int level, int name, const auto& value) {
    return setsockopt(made.fd_, level, name, &value, sizeof value) == 0;
  };
  if (made.fd_ < 0 || !set(SOL_SOCKET, SO_TIMESTAMPNS, on) || !set(IPPROTO_IP, IP_MULTICAST_LOOP, off) ||
      !set(IPPROTO_IP, IP_MULTICAST_IF, membership.imr_interface) ||
      bind(made.fd_, reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0 ||
      !set(IPPROTO_IP, IP_ADD_MEMBERSHIP, membership)) {
    return std::unexpected(system_error("a socket for probes"));
  }
  return made;
}

ProbeSocket::~ProbeSocket() {
  if (fd_ >= 0) close(fd_);
}

Result<void> probe(const std::vector<ProbeSocket>& sockets, double patience_ms,
                   std::vector<measure::LinkMeasured>& links, std::vector<double>& oversleep_ms) {
  const std::size_t peers = sockets.size();
  const sockaddr_in to = group_address();
  std::vector<std::vector<std::uint32_t>> copies(links.size(), std::vector<std::uint32_t>(kProbes));
  const auto read_all = [&] {
    for (std::size_t at = 0; at < peers; ++at) {
      for (Received r; receive(sockets[at].fd(), r); r = {}) {
        if (r.probe.from >= peers || r.probe.number >= kProbes) continue;
        const std::size_t link = r.probe.from * peers + at;
        ++copies[link][r.probe.number];
        links[link].delay_ms.push_back(static_cast<double>(r.at_ns - r.probe.sent_ns) * 1e-6);
      }
    }
  };
  const auto sends = static_cast<std::int64_t>(kProbes);
  const std::int64_t steps = sends + static_cast<std::int64_t>(patience_ms * 1e6) / kInterval_ns + 1;
  for (std::int64_t step = 0; step < steps; ++step) {
    for (std::size_t from = 0; from < peers && step < sends; ++from) {
      const Probe p{static_cast<std::uint32_t>(from), static_cast<std::uint32_t>(step), read_clock_ns(CLOCK_REALTIME)};
      if (sendto(sockets[from].fd(), &p, sizeof p, 0, reinterpret_cast<const sockaddr*>(&to), sizeof to) != sizeof p) {
        return std::unexpected(system_error("sending a probe"));
      }
    }
    const std::int64_t before = read_clock_ns(CLOCK_MONOTONIC);
    const timespec wait{0, kInterval_ns};
    nanosleep(&wait, nullptr);
    oversleep_ms.push_back(static_cast<double>(read_clock_ns(CLOCK_MONOTONIC) - before - kInterval_ns) * 1e-6);
    read_all();
  }
  for (std::size_t link = 0; link < links.size(); ++link) {
    if (link / peers == link % peers) continue;
    links[link].probes_sent = kProbes;
    for (const std::uint32_t n : copies[link]) {
      links[link].probes_lost += n == 0;
      links[link].probes_duplicated += n > 1;
    }
  }
  return {};
}

}  // namespace peerd::live
