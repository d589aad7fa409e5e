#include "peerd/net/nats/nats_transport.hpp"

#include <cassert>
#include <random>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "peerd/net/nats/connection.hpp"

namespace peerd::nats {
namespace {

// A datagram that waits longer for the network is not sent any more: what it says is in later ones, too.
constexpr Duration kStale = std::chrono::milliseconds(500);
// How often the worker looks after the connection where nothing is to be sent.
constexpr Duration kCheck = std::chrono::milliseconds(500);
// Between two tries to connect anew, where the library has given up: at least and at most.
constexpr int kAgainMin_ms = 1000, kAgainMax_ms = 3000;

}  // namespace

std::expected<std::unique_ptr<NatsTransport>, net::NetError> NatsTransport::open(boost::asio::io_context& io,
                                                                                 const net::HostClock& clock,
                                                                                 const NatsOptions& options) {
  std::unique_ptr<NatsTransport> opened(new NatsTransport(io, clock, options));
  auto connection = Connection::open(options, opened->mailbox_, opened->state_);
  if (connection) {
    opened->connection_ = *std::move(connection);
    opened->server_ = opened->connection_->server();
  } else if (connection.error().is_final) {
    return std::unexpected(connection.error().error);
  } else {
    opened->state_->on_down(connection.error().error.sentence + ": goes on trying");
  }
  opened->worker_ = std::thread([&transport = *opened] { transport.work(); });
  return opened;
}

NatsTransport::NatsTransport(boost::asio::io_context& io, const net::HostClock& clock, const NatsOptions& options)
    : options_(options),
      clock_(clock),
      mailbox_(std::make_shared<Mailbox>(io, clock, options.receive_bytes)),
      state_(std::make_shared<ConnectionState>()) {}

NatsTransport::~NatsTransport() {
  mailbox_->close();
  outbox_.stop();
  if (worker_.joinable()) worker_.join();
}

std::string NatsTransport::describe() const {
  const Subjects subjects(options_.settings.subject, options_.world, options_.session);
  return fmt::format("NATS subjects {} and {} at {}", subjects.of(RegionId{0}), subjects.all(),
                     server_.empty() ? "no server so far" : server_);
}

std::expected<void, net::NetError> NatsTransport::join(RegionId region) {
  if (joined_.insert(region).second) outbox_.change({region, true});
  return {};
}

std::expected<void, net::NetError> NatsTransport::leave(RegionId region) {
  if (joined_.erase(region) > 0) outbox_.change({region, false});
  return {};
}

void NatsTransport::send(RegionId region, std::span<const std::byte> datagram) {
  if (datagram.size() > net::kMaxDatagramBytes) {
    ++counters_.out_too_large;
    return;
  }
  if (!outbox_.put(region, clock_.now(), datagram)) ++counters_.out_queue_full;
}

void NatsTransport::on_receive(ReceiveHandler handler) {
  assert(handler && !handler_);
  handler_ = std::move(handler);
  mailbox_->open([this] { (void)receive_pending(); });
}

bool NatsTransport::receive_pending() {
  mailbox_->take(letters_);
  const bool any = !letters_.empty();
  for (const Letter& letter : letters_) take(letter);
  letters_.clear();
  return any;
}

void NatsTransport::take(const Letter& letter) {
  const std::span datagram(reinterpret_cast<const std::byte*>(natsMsg_GetData(letter.message.get())),
                           static_cast<std::size_t>(natsMsg_GetDataLength(letter.message.get())));
  if (datagram.size() > net::kMaxDatagramBytes) {
    ++counters_.in_truncated;
    return;
  }
  if (!joined_.contains(letter.region)) {
    ++counters_.in_other_region;
    return;
  }
  ++counters_.packets_in;
  counters_.bytes_in += datagram.size();
  handler_({.region = letter.region, .datagram = datagram, .at = letter.at, .from = options_.nobody});
}

std::optional<net::InterfaceChange> NatsTransport::follow_interface() {
  if (auto change = state_->take_change()) return change;
  const std::uint64_t lost = counters().in_queue_overflow;
  if (lost == lost_said_) return std::nullopt;
  const std::uint64_t more = lost - std::exchange(lost_said_, lost);
  return net::InterfaceChange{
      false, fmt::format("{} datagrams that came by NATS were lost: this peer reads them too slowly", more)};
}

const net::TrafficCounters& NatsTransport::counters() const {
  const std::scoped_lock lock(counts_mutex_);
  counters_.packets_out = counters_.calls_out = counts_.packets_out;
  counters_.bytes_out = counts_.bytes_out;
  counters_.out_unreachable = counts_.unreachable;
  counters_.out_stale = counts_.stale;
  counters_.out_errors = counts_.errors;
  counters_.in_queue_overflow = mailbox_->lost() + counts_.thrown_away;
  return counters_;
}

// ---- the worker ----

void NatsTransport::work() {
  Outbox::Taken taken = Outbox::make_taken();
  HostTime checked = clock_.now(), again = clock_.now();
  std::minstd_rand random{std::random_device{}()};
  std::uniform_int_distribution<int> wait_ms(kAgainMin_ms, kAgainMax_ms);
  while (!taken.stop) {
    outbox_.take(taken, kCheck);
    const HostTime now = clock_.now();
    if (connection_ && state_->is_closed()) {
      count_thrown_away();
      thrown_away_before_ = counts_.thrown_away;
      connection_.reset();
    }
    if (!connection_ && now >= again && !taken.stop) {
      connect();
      again = clock_.now() + std::chrono::milliseconds(wait_ms(random));
    }
    for (const RegionChange& each : taken.changes) change(each);
    for (const Parcel& parcel : taken.all()) publish(parcel);
    if (connection_ && now - checked >= kCheck) {
      checked = now;
      count_thrown_away();
    }
  }
  connection_.reset();
}

void NatsTransport::count_thrown_away() {
  const std::uint64_t all = thrown_away_before_ + connection_->thrown_away();
  const std::scoped_lock lock(counts_mutex_);
  counts_.thrown_away = all;
}

void NatsTransport::connect() {
  auto connection = Connection::open(options_, mailbox_, state_);
  if (!connection) return state_->on_down(connection.error().error.sentence + ": goes on trying");
  connection_ = *std::move(connection);
  for (const RegionId region : wanted_) change({region, true});
}

void NatsTransport::change(const RegionChange& change) {
  if (change.joins) {
    wanted_.insert(change.region);
  } else {
    wanted_.erase(change.region);
  }
  if (!connection_) return;
  const natsStatus status =
      change.joins ? connection_->subscribe(change.region) : connection_->unsubscribe(change.region);
  // A connection that is closed is made anew, and subscribes to what is wanted.
  if (status == NATS_OK || status == NATS_CONNECTION_CLOSED || status == NATS_INVALID_SUBSCRIPTION) return;
  state_->warn(fmt::format("region {} can't be {} by NATS: {}", change.region.value, change.joins ? "joined" : "left",
                           natsStatus_GetText(status)));
}

void NatsTransport::publish(const Parcel& parcel) {
  const bool stale = clock_.now() - parcel.at > kStale;
  const bool up = connection_ && state_->is_up();
  const natsStatus status = up && !stale ? connection_->publish(parcel.region, parcel.datagram()) : NATS_OK;
  const bool lost_server = status == NATS_INSUFFICIENT_BUFFER || status == NATS_CONNECTION_CLOSED;
  const std::scoped_lock lock(counts_mutex_);
  if (!up || lost_server) {
    ++counts_.unreachable;
  } else if (stale) {
    ++counts_.stale;
  } else if (status == NATS_OK) {
    ++counts_.packets_out;
    counts_.bytes_out += parcel.size;
  } else {
    ++counts_.errors;
  }
}

}  // namespace peerd::nats
