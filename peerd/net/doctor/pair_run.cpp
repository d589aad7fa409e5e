#include "peerd/net/doctor/pair_run.hpp"

#include <netinet/in.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "peerd/net/doctor/host_facts.hpp"
#include "peerd/net/doctor/tcp_greeting.hpp"
#include "peerd/net/os/udp_receiver.hpp"
#include "peerd/net/os/udp_socket.hpp"
#include "peerd/net/transport/multicast_socket.hpp"

namespace peerd::doctor {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using asio::ip::udp;
using boost::system::error_code;

constexpr RegionId kWholeScene{0};

// HOST, HOST:PORT, [ADDRESS]:PORT or an IPv6 address: as HOST:PORT.
std::string with_port(const std::string& text, std::uint16_t port) {
  const bool bare_v6 = std::ranges::count(text, ':') > 1 && !text.contains('[');
  if (bare_v6) return fmt::format("[{}]:{}", text, port);
  return text.rfind(':') != std::string::npos && !text.ends_with(']') ? text : fmt::format("{}:{}", text, port);
}

std::string text_of(const udp::endpoint& e) {
  return e.address().is_v4() ? fmt::format("{}:{}", e.address().to_string(), e.port())
                             : fmt::format("[{}]:{}", e.address().to_string(), e.port());
}

// The address from which the kernel sends to the other computer.
std::expected<asio::ip::address, net::NetError> own_address_to(const udp::endpoint& host, const std::string& named) {
  asio::io_context io(1);
  udp::socket socket(io);
  error_code ec;
  socket.connect(host, ec);
  asio::ip::address own = ec ? asio::ip::address{} : socket.local_endpoint(ec).address();
  if (ec) {
    return net::failure(net::NetError::Kind::kOther,
                        fmt::format("there is no route to {}: {}; connect an interface from "
                                    "which it is reached",
                                    named, ec.message()));
  }
  if (own == host.address() || own.is_loopback()) {
    return net::failure(net::NetError::Kind::kBadSetting,
                        fmt::format("--with: {} is this computer; name another one", named));
  }
  return own;
}

// A multicast datagram's sender has no zone where the address of a user has one.
bool same_address(const asio::ip::address& a, const asio::ip::address& b) {
  return a.is_v6() && b.is_v6() ? a.to_v6().to_bytes() == b.to_v6().to_bytes() : a == b;
}

// Sends and receives for one PairProbe.
class PairRun {
 public:
  PairRun(const net::HostClock& clock, const PairOptions& options, const udp::endpoint& host,
          const asio::ip::address& own)
      : clock_(clock),
        options_(options),
        host_(host),
        own_(own, options.transport.multicast.groups.port),
        reading_(clock, counters_, net::kMaxDatagramBytes),
        unicast_(io_, reading_),
        listener_(io_, {own, options.snapshot_port}, host.address()),
        greeter_(io_, [this](TcpState state) { probe_->on_tcp(state); }) {}

  std::expected<PairOutcome, net::NetError> run() {
    if (auto good = open_unicast(); !good) return std::unexpected(good.error());
    open_multicast();
    outcome_.tcp_port = listener_.port();
    outcome_.tcp_problem = listener_.problem();
    const HostTime started = clock_.now();
    probe_.emplace(PairProbe::Settings{.session = options_.session,
                                       .tcp_port = listener_.port(),
                                       .multicast = multicast_ != nullptr,
                                       .wait = options_.wait},
                   started);
    listen();
    loop();
    outcome_.result = probe_->result();
    outcome_.waited = clock_.now() - started;
    return outcome_;
  }

 private:
  // It is bound to an address, so that it receives what is sent to it also where a peer has the port.
  std::expected<void, net::NetError> open_unicast() {
    udp::socket& socket = unicast_.socket();
    const net::MulticastOptions& m = options_.transport.multicast;
    const bool v4 = host_.address().is_v4();
    if (auto good = net::open_udp(socket, {v4, m.dscp, m.receive_buffer_bytes}); !good) return good;
    const int fd = socket.native_handle();
    // Datagrams are never cut into fragments: whether a length arrives shows what the way holds.
    const net::SocketOption whole =
        v4 ? net::SocketOption{IPPROTO_IP, IP_MTU_DISCOVER, IP_PMTUDISC_PROBE, "IP_MTU_DISCOVER"}
           : net::SocketOption{IPPROTO_IPV6, IPV6_MTU_DISCOVER, IPV6_PMTUDISC_PROBE, "IPV6_MTU_DISCOVER"};
    const std::array<net::SocketOption, 2> more{{{SOL_SOCKET, SO_REUSEADDR, 1, "SO_REUSEADDR"}, whole}};
    if (auto good = net::set_options(fd, more); !good) return good;
    error_code ec;
    socket.bind(own_, ec);
    if (!ec) return {};
    return net::failure(
        ec.value() == EADDRINUSE ? net::NetError::Kind::kPortBusy : net::NetError::Kind::kOther,
        fmt::format("cannot use UDP port {} ({}): stop the program that has it (ss -ulnp \"sport = :{}\" "
                    "names it), or choose another port (--port) on both computers",
                    own_.port(), ec.message(), own_.port()));
  }

  void open_multicast() {
    outcome_.multicast_wanted = options_.transport.use != net::MulticastUse::kNever;
    if (!outcome_.multicast_wanted) return;
    net::MulticastOptions m = options_.transport.multicast;
    m.receives_own_datagrams = false;
    auto opened = net::MulticastSocket::open(io_, clock_, m);
    const bool by_itself = m.interface.empty();
    if (by_itself && (!opened || (*opened)->chosen_interface().interface.loopback)) {
      m.interface = route_to({options_.host, host_}).interface;
      opened = net::MulticastSocket::open(io_, clock_, m);
      outcome_.interface_guessed = true;
    }
    std::expected<void, net::NetError> joined;
    if (opened) joined = (*opened)->join(kWholeScene);
    if (!opened || !joined) {
      outcome_.why_no_multicast = !opened ? opened.error().sentence : joined.error().sentence;
      return;
    }
    multicast_ = *std::move(opened);
    outcome_.interface = multicast_->chosen_interface().interface.name;
    outcome_.group = fmt::format("{} port {}", m.groups.base.to_string(), m.groups.port);
  }

  void listen() {
    unicast_.start([this](const net::Received& received, HostTime at) {
      if (received.from != host_ || received.truncated) return;
      probe_->on_datagram(at, Path::kUnicast, received.bytes);
    });
    if (!multicast_) return;
    multicast_->on_receive([this](const net::Arrival& arrival) {
      // A computer with several addresses may send multicast from another one than the named.
      const auto message = decode_pair_message(arrival.datagram);
      const bool known = message && probe_->other() != 0 && message->session == probe_->other();
      if (!known && !same_address(arrival.from.address(), host_.address())) return;
      probe_->on_datagram(arrival.at, Path::kMulticast, arrival.datagram);
    });
  }

  void loop() {
    options_.say(fmt::format("waiting up to {:.0f} s for {}: start peerd doctor --with {} there",
                             to_seconds(options_.wait), options_.host, own_.address().to_string()));
    bool met = false;
    while (!probe_->ended()) {
      probe_->on_tick(clock_.now());
      for (const auto& output : probe_->take_outputs()) std::visit([this](const auto& o) { apply(o); }, output);
      if (multicast_) multicast_->flush();
      if (probe_->met() && !std::exchange(met, true)) options_.say(options_.host + " is here; this takes some 6 s");
      const HostTime now = clock_.now();
      const Duration pause = std::max(Duration{0}, probe_->next_deadline() - now);
      if (!probe_->ended()) io_.run_one_for(pause);
    }
  }

  void apply(const PairProbe::Send& send) {
    if (send.path == Path::kMulticast) {
      multicast_->send(kWholeScene, send.datagram);
      return;
    }
    error_code ec;
    unicast_.socket().send_to(asio::buffer(send.datagram), host_, 0, ec);
    // EMSGSIZE: the interface itself does not take such a length.
    if (ec && ec.value() != EMSGSIZE) outcome_.unicast_problem = ec.message();
  }
  void apply(const PairProbe::Connect& connect) { greeter_.greet({host_.address(), connect.port}); }

  const net::HostClock& clock_;
  const PairOptions& options_;
  udp::endpoint host_, own_;
  PairOutcome outcome_;
  std::optional<PairProbe> probe_;
  net::TrafficCounters counters_;
  asio::io_context io_{1};
  net::Reading reading_;
  net::UdpReceiver unicast_;
  std::unique_ptr<net::MulticastSocket> multicast_;
  GreetingListener listener_;
  Greeter greeter_;
};

}  // namespace

std::expected<PairOutcome, net::NetError> run_pair(const net::HostClock& clock, const PairOptions& options) {
  const net::GroupPlan& groups = options.transport.multicast.groups;
  const net::IpFamily family = groups.base.is_v4() ? net::IpFamily::kV4 : net::IpFamily::kV6;
  const std::string named = with_port(options.host, groups.port);
  const auto addresses = net::resolve_peers({named}, family, "--with");
  if (!addresses) return std::unexpected(addresses.error());
  const udp::endpoint host = addresses->front();
  const auto own = own_address_to(host, options.host);
  if (!own) return std::unexpected(own.error());
  auto outcome = PairRun(clock, options, host, *own).run();
  if (!outcome) return outcome;
  outcome->host = named.substr(0, named.rfind(':'));
  outcome->host_address = text_of(host);
  outcome->own_address = text_of({*own, groups.port});
  return outcome;
}

}  // namespace peerd::doctor
