#include "tests/attack/hostile_member.hpp"

#include <algorithm>
#include <random>

#include "replication/wire/envelope.hpp"

namespace peerd::attack {
namespace {

using namespace std::chrono_literals;
using namespace replication;

constexpr std::size_t kPart_bytes = 1000;  // of a log, in one datagram

std::optional<seal::Contents> contents_of(std::span<const std::byte> datagram) {
  const auto envelope = envelope_of(datagram);
  if (!envelope) return std::nullopt;
  return seal::Contents{envelope->sender, !envelope->has_only_updates, envelope->changes_world};
}

PeerId number_of(const Target& target) {
  return PeerId{target.number != 0 ? target.number : std::random_device{}() | 1u};
}

}  // namespace

HostileMember::HostileMember(const Target& target)
    : world_(snapshot(target)),
      id_(number_of(target)),
      incarnation_(static_cast<std::uint64_t>(clock_.now().time_since_epoch().count())),
      author_{},
      signer_([&] {
        const keys::Identity self = identity(target);
        author_ = seal::fresh_author(self.public_key());
        net::MulticastOptions options = multicast(target);
        options.groups = net::plan_of_world(options.groups, world_.offer.session);
        auto socket = net::MulticastSocket::open(io_, clock_, options);
        if (!socket) fail(socket.error().sentence);
        transport_ = std::make_unique<seal::SealedTransport>(io_, clock_, *std::move(socket), session_key(target),
                                                             seal::Sealer::Self{.peer = id_, .identity = self},
                                                             contents_of, [](const std::string&) {});
        return seal::OperationSigner(world_.offer.genesis, self, author_.salt,
                                     [](const keys::PublicKey&) { return true; });
      }()) {
  if (!transport_->join(kAll)) fail("can't join the session's group");
  transport_->on_receive([this](const net::Arrival& arrival) { on_datagram(arrival); });
}

SimTime HostileMember::session_now() const {
  return SimTime{clock_.now().time_since_epoch() + session_minus_host_.value_or(Duration{0})};
}

void HostileMember::on_datagram(const net::Arrival& arrival) {
  const auto message = decode(arrival.datagram, session_now());
  if (!message || message->sender == id_) return;
  if (message->hello && message->hello->session_tx) {
    session_minus_host_ = message->hello->session_tx->time_since_epoch() - arrival.at.time_since_epoch();
  }
  for (const OperationRange& asked : message->operation_requests) {
    if (asked.author != author_.id || asked.from >= log_.size()) continue;
    Message answer = this->message();
    const auto to = std::min<std::uint64_t>({asked.to, asked.from + kPart_bytes, log_.size()});
    answer.operations.push_back(
        {author_.id,
         asked.from,
         {log_.begin() + static_cast<std::ptrdiff_t>(asked.from), log_.begin() + static_cast<std::ptrdiff_t>(to)}});
    send(answer);
  }
}

void HostileMember::serve(std::chrono::microseconds time) {
  if (clock_.now() >= hello_at_) {
    Message next = hello();
    change_hello(next);
    send(next);
    hello_at_ = clock_.now() + 200ms;
  }
  transport_->flush();
  io_.run_for(time);
}

void HostileMember::enter() {
  for (int i = 0; i < 100 && !session_minus_host_; ++i) serve(50ms);
  if (!session_minus_host_) fail("no peer says what time it is");
  for (int i = 0; i < 20; ++i) serve(50ms);
}

Message HostileMember::message() {
  Message m;
  m.sender = id_;
  m.incarnation = incarnation_low(incarnation_);
  return m;
}

Message HostileMember::hello() {
  Message m = message();
  m.incarnation = incarnation_;
  Hello& hello = m.hello.emplace();
  hello.sessions = 1;
  if (session_minus_host_) {
    hello.session_tx = session_now();
    hello.clock_error = 5ms;
  }
  Introduction& introduction = hello.introduction.emplace();
  introduction.name = "attacker";
  introduction.world_hash = world_.offer.session;
  introduction.line = world_.offer.line;
  introduction.has_edits = world_.offer.line != 0;
  if (!log_.empty()) hello.logs.push_back({author_.id, log_.size()});
  return m;
}

void HostileMember::send(const Message& message, RegionId region) {
  Message numbered = message;
  numbered.number = ++numbers_[region];
  transport_->send(region, encode(numbered));
  ++sent_;
}

std::vector<std::byte> HostileMember::write(OperationBody body, SimTime stamp) {
  last_stamp_ = std::max(stamp, last_stamp_ + Duration{1});  // those of an author ascend
  auto bytes =
      encode_unsigned({{author_.id, ++operations_}, last_stamp_, std::move(body)}, signed_.key_of_next(signer_));
  signed_.sign(signer_, author_.id, bytes);
  log_.insert(log_.end(), bytes.begin(), bytes.end());
  return bytes;
}

void HostileMember::publish(std::uint64_t from) {
  for (; from < log_.size(); from += kPart_bytes) {
    const auto to = std::min<std::uint64_t>(from + kPart_bytes, log_.size());
    Message m = message();
    m.operations.push_back(
        {author_.id,
         from,
         {log_.begin() + static_cast<std::ptrdiff_t>(from), log_.begin() + static_cast<std::ptrdiff_t>(to)}});
    send(m);
  }
  transport_->flush();
}

}  // namespace peerd::attack
