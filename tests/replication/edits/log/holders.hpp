#pragma once
#include <gtest/gtest.h>

#include <memory>
#include <queue>
#include <random>
#include <tuple>

#include "replication/edits/log/operation_exchange.hpp"
#include "replication/wire/codec.hpp"
#include "replication/wire/operation_lists.hpp"
#include "tests/replication/peer/operations.hpp"

// Holders of logs on a network of their own, in fake time, which lose, copy and delay datagrams by a seed.
namespace peerd::replication::test {

struct Weather {
  Duration latency = std::chrono::milliseconds(2), jitter = std::chrono::milliseconds(1);
  double loss = 0.0, duplicates = 0.0;
};

inline PeerId peer(std::size_t i) { return PeerId{static_cast<std::uint32_t>(i + 1)}; }
inline AuthorId author(std::size_t i) { return AuthorId{static_cast<std::uint32_t>(100 + i)}; }

class Holders {
 public:
  static constexpr Duration kHello = std::chrono::milliseconds(250);

  Holders(std::size_t count, const Weather& weather, std::uint64_t seed) : weather_(weather), random_(seed) {
    for (std::size_t i = 0; i < count; ++i) add();
  }

  std::size_t add() {
    const std::size_t i = holders_.size();
    Holder& h = *holders_.emplace_back(std::make_unique<Holder>(peer(i), author(i), random_()));
    h.exchange.set_link(weather_.latency + weather_.jitter, weather_.loss);
    h.next_hello = now_ + Duration{static_cast<std::int64_t>(random_() % static_cast<std::uint64_t>(kHello.count()))};
    for (std::size_t k = 0; k < i; ++k) {
      if (!holders_[k]->here) continue;
      h.exchange.on_joined(peer(k));
      holders_[k]->exchange.on_joined(peer(i));
    }
    return i;
  }
  void lose(std::size_t i) {
    holders_[i]->here = false;
    for (std::size_t k = 0; k < holders_.size(); ++k) {
      if (k != i && holders_[k]->here) holders_[k]->exchange.on_lost(peer(i));
    }
  }

  OperationLogs& logs(std::size_t i) { return holders_[i]->logs; }
  OperationExchange& exchange(std::size_t i) { return holders_[i]->exchange; }
  // Gives a log to a holder as if its store had it.
  void give(std::size_t i, AuthorId of, const std::vector<std::byte>& log) {
    ASSERT_TRUE(holders_[i]->logs.restore({of, 0, log}));
  }
  void append(std::size_t i, const Operation& operation) {
    ASSERT_TRUE(holders_[i]->logs.append(operation));
    holders_[i]->exchange.on_append(now_, operation.id);
  }

  void run(Duration time) {
    const HostTime until = now_ + time;
    for (;;) {
      HostTime next = until;
      if (!flying_.empty()) next = std::min(next, flying_.top().at);
      for (const auto& h : holders_) {
        if (!h->here) continue;
        next = std::min(next, h->next_hello);
        if (const auto deadline = h->exchange.next_deadline()) next = std::min(next, std::max(now_, *deadline));
      }
      if (next >= until) break;
      now_ = next;
      step();
    }
    now_ = until;
  }

  [[nodiscard]] bool all_equal() const {
    std::optional<std::vector<LogLength>> lengths;
    for (const auto& h : holders_) {
      if (!h->here) continue;
      if (lengths && *lengths != h->logs.lengths()) return false;
      lengths = h->logs.lengths();
    }
    return true;
  }
  // The time until all are equal, at most `most`.
  Duration run_until_equal(Duration most) {
    const HostTime begin = now_;
    while (!all_equal() && now_ - begin < most) run(std::chrono::milliseconds(10));
    return now_ - begin;
  }

  [[nodiscard]] std::uint64_t messages() const { return messages_; }
  [[nodiscard]] std::uint64_t part_bytes() const { return part_bytes_; }
  [[nodiscard]] const std::vector<Operation>& operations(std::size_t i) const { return holders_[i]->operations; }

 private:
  struct Holder {
    Holder(PeerId of, AuthorId as, std::uint64_t seed) : id(of), logs(as), exchange(logs, of, as, seed) {}
    PeerId id;
    OperationLogs logs;
    OperationExchange exchange;
    HostTime next_hello{};
    bool here = true;
    std::vector<Operation> operations;  // that have come
  };
  struct Flying {
    HostTime at{};
    std::uint64_t order = 0;
    std::size_t to = 0;
    std::shared_ptr<const Bytes> datagram;
    bool operator<(const Flying& o) const { return std::tuple(at, order) > std::tuple(o.at, o.order); }
  };

  double uniform() { return static_cast<double>(random_() >> 11) * 0x1p-53; }

  void send(const Holder& from, Message&& m) {
    m.sender = from.id;
    m.incarnation = 1;
    m.number = 0xFFFF'FFFF;
    for (const OperationPart& part : m.operations) part_bytes_ += part.bytes.size();
    const auto datagram = std::make_shared<const Bytes>(encode(m));
    EXPECT_LE(datagram->size(), kDatagramMax_bytes);
    for (std::size_t to = 0; to < holders_.size(); ++to) {
      if (holders_[to]->id == from.id) continue;
      const int copies = uniform() < weather_.loss ? 0 : uniform() < weather_.duplicates ? 2 : 1;
      for (int i = 0; i < copies; ++i) {
        flying_.push(
            {now_ + weather_.latency + from_seconds(uniform() * to_seconds(weather_.jitter)), ++order_, to, datagram});
      }
    }
  }

  void receive(Holder& h, const Bytes& datagram) {
    const auto m = decode(datagram, SimTime{});
    ASSERT_TRUE(m.has_value());
    if (m->hello) h.exchange.on_lengths(now_, m->sender, m->hello->logs);
    for (const OperationPart& part : m->operations) {
      auto taken = h.logs.receive(part);
      if (taken) std::ranges::move(*taken, std::back_inserter(h.operations));
      h.exchange.on_part(now_, m->sender, part);
    }
    if (!m->operation_requests.empty()) h.exchange.on_requests(now_, m->sender, m->operation_requests);
  }

  void step() {
    while (!flying_.empty() && flying_.top().at <= now_) {
      const Flying next = flying_.top();
      flying_.pop();
      if (holders_[next.to]->here) receive(*holders_[next.to], *next.datagram);
    }
    for (const auto& h : holders_) {
      if (!h->here) continue;
      for (OperationMessage& out : h->exchange.on_tick(now_)) {
        ++messages_;
        Message m;
        m.operations = std::move(out.operations);
        m.operation_requests = std::move(out.operation_requests);
        send(*h, std::move(m));
      }
      if (h->next_hello > now_) continue;
      h->next_hello += kHello;
      Message m;
      m.hello.emplace().logs = h->exchange.lengths_for_hello(300);
      send(*h, std::move(m));
    }
  }

  Weather weather_;
  std::mt19937_64 random_;
  HostTime now_{std::chrono::seconds(1000)};
  std::vector<std::unique_ptr<Holder>> holders_;
  std::priority_queue<Flying> flying_;
  std::uint64_t order_ = 0, messages_ = 0, part_bytes_ = 0;
};

}  // namespace peerd::replication::test
