#include "peerd/lab/chaos/watch/message_watch.hpp"

#include <variant>

#include <spdlog/fmt/fmt.h>

#include "peerd/peer/node/peer_node.hpp"

namespace peerd::chaos {
namespace {

using namespace replication;

// Peers of one session have its time alike, but for a part of the way between them. Stamps of another session mean
// other times, so that its messages may seem to be of before this one.
constexpr Duration kSameTime = std::chrono::milliseconds(250);

// Each of the two knows the other, and both are in one session.
bool are_connected(const Peer& a, const Peer& b) {
  const auto knows = [](const Peer& one, const Peer& other) {
    const OtherPeer* const known = one.members().find_any(other.id());
    return known != nullptr && known->synchronised;
  };
  const Duration apart = a.clock().to_session(a.next_deadline()) - b.clock().to_session(b.next_deadline());
  return std::chrono::abs(apart) < kSameTime && knows(a, b) && knows(b, a);
}

}  // namespace

void MessageWatch::on_sent(const WatchedPeer& sender, OperationId message, std::span<const WatchedPeer> all) {
  findings_.count("message sent");
  std::set<std::size_t>& there = sent_[message];
  there.clear();  // of a message of that number that was lost with its author
  for (const WatchedPeer& peer : all) {
    const bool is_sender = peer.life == sender.life;
    if (is_sender || are_connected(peer.node->peer(), sender.node->peer())) there.insert(peer.life);
  }
}

void MessageWatch::on_received(double now_s, const WatchedPeer& peer, const MessageReceived& message) {
  findings_.count("message received");
  Received& received = received_[peer.life];
  if (!received.all.insert(message.operation).second) {
    findings_.violate(now_s,
                      fmt::format("{} has received message {} twice", name_of(peer), name_of(message.operation)));
  }
  std::uint32_t& last = received.last[message.operation.author];
  if (message.operation.number < last) {
    findings_.violate(now_s, fmt::format("{} has received message {} after {} of the same author", name_of(peer),
                                         name_of(message.operation), last));
  }
  last = std::max(last, message.operation.number);
  const Operation* const operation = book_.find(message.operation);
  const auto* const sent = operation == nullptr ? nullptr : std::get_if<SendMessage>(&operation->body);
  const bool is_as_sent = sent != nullptr && *sent == SendMessage{message.by, message.topic, message.text};
  if (is_as_sent) return;
  findings_.violate(now_s, fmt::format("{} has received message {}, which nobody has sent so", name_of(peer),
                                       name_of(message.operation)));
}

void MessageWatch::finish(double now_s, std::span<const WatchedPeer> all) {
  for (const WatchedPeer& peer : all) {
    const Received& received = received_[peer.life];
    for (const auto& [message, there] : sent_) {
      const Operation* const known = book_.find(message);
      if (known == nullptr || !std::holds_alternative<SendMessage>(known->body)) {
        findings_.count("message lost with its author");  // who may have given its number to another operation since
        continue;
      }
      const bool has_it = peer.node->peer().logs().last(message.author).number >= message.number;
      const bool is_received = received.all.contains(message);
      const bool was_there = there.contains(peer.life);
      if (has_it && !was_there) findings_.count(is_received ? "message of a peer apart" : "message of before a life");
      if (!has_it || is_received || !was_there) continue;
      findings_.violate(now_s, fmt::format("{} was there when message {} was sent, and has not received it",
                                           name_of(peer), name_of(message)));
    }
  }
}

}  // namespace peerd::chaos
