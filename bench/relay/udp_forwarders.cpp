#include <pthread.h>
#include <sched.h>
#include <sys/socket.h>
#include <time.h>

#include <array>
#include <atomic>
#include <boost/asio/io_context.hpp>
#include <chrono>
#include <cstring>
#include <stdexcept>
#include <thread>

#include "bench/relay/forwarders.hpp"
#include "peerd/net/greeting/unicast_frame.hpp"
#include "peerd/net/os/host_clock.hpp"
#include "peerd/net/os/udp_batch.hpp"
#include "peerd/net/relay/relay.hpp"

namespace peerd::bench {
namespace {

namespace asio = boost::asio;
using asio::ip::udp;

constexpr std::size_t kMostBytes = net::kMaxDatagramBytes + net::kRelayHeaderBytes;
constexpr int kBuffer_bytes = 4 << 20;

udp::endpoint on_lo(std::uint16_t port) { return {asio::ip::address_v4::loopback(), port}; }

double cpu_of(pthread_t thread) {
  clockid_t clock{};
  if (pthread_getcpuclockid(thread, &clock) != 0) throw std::runtime_error("a thread has no clock here");
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) / 1e9;
}

// A socket on lo, for a source or a sink.
struct End {
  explicit End(asio::io_context& io) : socket(io, on_lo(0)) {
    socket.set_option(asio::socket_base::receive_buffer_size(kBuffer_bytes));
  }
  udp::socket socket;
  net::ReceiveBatch batch{kMostBytes};
};

// Source and sinks, which a forwarder's port is between.
class UdpForwarder : public Forwarder {
 public:
  explicit UdpForwarder(std::size_t sinks) {
    for (std::size_t i = 0; i <= sinks; ++i) ends_.push_back(std::make_unique<End>(io_));
  }
  void send(const std::vector<std::vector<std::byte>>& datagrams) override {
    for (const auto& datagram : datagrams) {
      if (queue_.full()) queue_.flush(source().socket.native_handle(), counters_);
      queue_.push(on_lo(port_), header_, datagram);
    }
    queue_.flush(source().socket.native_handle(), counters_);
  }
  std::size_t receive(std::size_t sink, std::vector<std::byte>& all) override {
    End& end = *ends_[1 + sink];
    std::size_t datagrams = 0;
    for (int count = end.batch.read(end.socket.native_handle()); count > 0;
         count = end.batch.read(end.socket.native_handle())) {
      for (int i = 0; i < count; ++i) {
        const auto bytes = end.batch[static_cast<std::size_t>(i)].bytes;
        if (!is_datagram(bytes)) continue;
        const auto payload = bytes.subspan(header_.size());
        all.insert(all.end(), payload.begin(), payload.end());
        ++datagrams;
      }
    }
    return datagrams;
  }

 protected:
  [[nodiscard]] virtual bool is_datagram(std::span<const std::byte>) const { return true; }
  [[nodiscard]] End& source() { return *ends_.front(); }

  asio::io_context io_;
  std::vector<std::unique_ptr<End>> ends_;
  std::uint16_t port_ = 0;
  std::vector<std::byte> header_;
  net::SendQueue queue_{kMostBytes};
  net::TrafficCounters counters_;
};

class BareForwarder final : public UdpForwarder {
 public:
  explicit BareForwarder(std::size_t sinks) : UdpForwarder(sinks), socket_(io_, on_lo(0)) {
    socket_.set_option(asio::socket_base::receive_buffer_size(kBuffer_bytes));
    port_ = socket_.local_endpoint().port();
    for (std::size_t i = 1; i < ends_.size(); ++i) to_.push_back(ends_[i]->socket.local_endpoint());
    thread_ = std::thread([this] { run(); });
  }
  ~BareForwarder() override {
    source().socket.send_to(asio::buffer("", 0), on_lo(port_));
    thread_.join();
  }
  double cpu_s() const override { return cpu_of(const_cast<std::thread&>(thread_).native_handle()); }

 private:
  void run() {
    run_on(kForwardersCore);
    std::vector<std::byte> buffer(net::kBatch * kMostBytes);
    std::array<iovec, net::kBatch> into{};
    std::array<mmsghdr, net::kBatch> in{};
    for (std::size_t i = 0; i < net::kBatch; ++i) {
      into[i] = {buffer.data() + i * kMostBytes, kMostBytes};
      in[i].msg_hdr.msg_iov = &into[i];
      in[i].msg_hdr.msg_iovlen = 1;
    }
    std::vector<iovec> from(net::kBatch * to_.size());
    std::vector<mmsghdr> out(from.size());
    const int fd = socket_.native_handle();
    for (;;) {
      const int count = recvmmsg(fd, in.data(), net::kBatch, MSG_WAITFORONE, nullptr);
      if (count <= 0) throw std::runtime_error("recvmmsg fails");
      std::size_t n = 0;
      for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
        if (in[i].msg_len == 0) return;
        for (udp::endpoint& to : to_) {
          from[n] = {into[i].iov_base, in[i].msg_len};
          out[n].msg_hdr = {};
          out[n].msg_hdr.msg_name = to.data();
          out[n].msg_hdr.msg_namelen = static_cast<socklen_t>(to.size());
          out[n].msg_hdr.msg_iov = &from[n];
          out[n].msg_hdr.msg_iovlen = 1;
          ++n;
        }
      }
      for (std::size_t sent = 0; sent < n;) {
        const int more = sendmmsg(fd, &out[sent], static_cast<unsigned>(std::min<std::size_t>(n - sent, 1024)), 0);
        if (more <= 0) throw std::runtime_error("sendmmsg fails");
        sent += static_cast<std::size_t>(more);
      }
    }
  }

  udp::socket socket_;
  std::vector<udp::endpoint> to_;
  std::thread thread_;
};

class RelayForwarder final : public UdpForwarder {
 public:
  explicit RelayForwarder(std::size_t sinks) : UdpForwarder(sinks), numbers_(ends_.size()) {
    relay::RelayOptions options{.key = {1, 2}};
    auto opened = relay::Relay::open(relay_io_, clock_, options, [](bool, const std::string&) {});
    if (!opened) throw std::runtime_error(opened.error().sentence);
    relay_ = *std::move(opened);
    port_ = relay_->port();
    const auto header = net::relay_header({RegionId{0}});
    header_.assign(header.begin(), header.end());
    relay_->start();
    thread_ = std::thread([this] {
      run_on(kForwardersCore);
      relay_io_.run();
    });
    for (std::size_t i = 0; i < ends_.size(); ++i) meet(i);
  }
  ~RelayForwarder() override {
    relay_io_.stop();
    thread_.join();
  }
  double cpu_s() const override { return cpu_of(const_cast<std::thread&>(thread_).native_handle()); }
  void keep_alive() override {
    for (std::size_t i = 0; i < ends_.size(); ++i) greet(i);
  }

 private:
  [[nodiscard]] bool is_datagram(std::span<const std::byte> bytes) const override {
    return net::read_relay_header(bytes).has_value();
  }
  void greet(std::size_t end) {
    net::Greeting greeting{.instance = static_cast<std::uint32_t>(100 + end), .number = 1, .echo = numbers_[end]};
    greeting.reply = numbers_[end] == 0;
    if (!greeting.reply) {
      greeting.link = net::LinkNote{.sent_at_ns = ++notes_};
      if (end > 0) greeting.regions = {RegionId{0}};  // the source wants nothing
    }
    ends_[end]->socket.send_to(asio::buffer(net::encode(greeting, true)), on_lo(port_));
  }
  [[nodiscard]] net::Greeting answer(std::size_t end) {
    std::array<std::byte, kMostBytes> bytes{};
    const std::size_t size = ends_[end]->socket.receive(asio::buffer(bytes));
    const auto greeting = net::decode_greeting(std::span(bytes).first(size), true);
    if (!greeting) throw std::runtime_error("the relay answers with no greeting");
    return *greeting;
  }
  void meet(std::size_t end) {
    greet(end);
    numbers_[end] = answer(end).number;
    greet(end);
    if (!answer(end).link) throw std::runtime_error("the relay does not know an end");
  }

  asio::io_context relay_io_{1};
  net::HostClock clock_;
  std::unique_ptr<relay::Relay> relay_;
  std::vector<std::uint64_t> numbers_;  // of the relay for each end
  std::int64_t notes_ = 0;
  std::thread thread_;
};

}  // namespace

void run_on(int core) {
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(core, &set);
  (void)pthread_setaffinity_np(pthread_self(), sizeof set, &set);  // a figure says how many cores there were
}

std::unique_ptr<Forwarder> bare_forwarder(std::size_t sinks) { return std::make_unique<BareForwarder>(sinks); }
std::unique_ptr<Forwarder> relay_forwarder(std::size_t sinks) { return std::make_unique<RelayForwarder>(sinks); }

}  // namespace peerd::bench
