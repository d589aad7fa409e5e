// Sends any datagrams to the logs of operations and their exchange: what is held never changes, memory and answers stay
// within their limits, and what is said can be read by others. The input is also read as a log.
//
// An input is a row of datagrams. Each follows two bytes of its length (low byte first) and one byte of the time that
// passes before it [10 ms]. The rest is the last datagram.
#include <algorithm>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "replication/edits/log/operation_exchange.hpp"
#include "replication/wire/codec.hpp"
#include "tests/fuzz/require.hpp"

namespace {

using namespace peerd;
using fuzz::require;
using namespace peerd::replication;

constexpr AuthorId kOwn{1}, kAuthor{2};
constexpr PeerId kSelf{2};
constexpr int kDatagramsMax = 64;  // in one input

void check(const Operation& operation) {
  const auto bytes = encode(operation);
  const auto again = decode_operation(operation.id.author, bytes);
  require(again && *again && (*again)->size_bytes == bytes.size());
  require((*again)->operation.id == operation.id && (*again)->operation.stamp == operation.stamp);
  require((*again)->operation.body == operation.body && (*again)->operation.knows == operation.knows);
}

class Driver {
 public:
  Driver() {
    exchange_.on_joined(PeerId{1});
    for (std::uint32_t number = 1; number <= 3; ++number) {
      require(logs_.append({{kOwn, number}, SimTime{Duration{number}}, RemoveObject{ObjectId{number}}}).has_value());
      exchange_.on_append(now_, {kOwn, number});
    }
  }

  void pass(Duration time) {
    const HostTime until = now_ + time;
    for (int calls = 0; calls < 1000; ++calls) {
      const auto deadline = exchange_.next_deadline();
      if (!deadline || *deadline > until) break;
      now_ = std::max(now_, *deadline);
      tick();
    }
    now_ = until;
    tick();
  }

  void receive(std::span<const std::byte> datagram) {
    const auto m = decode(datagram, SimTime{});
    if (!m) return;
    const auto again = decode(encode(*m), SimTime{});
    require(encode(*m).size() > kDatagramMax_bytes || (again && encode(*again) == encode(*m)));
    if (m->hello) exchange_.on_lengths(now_, m->sender, m->hello->logs);
    for (const OperationPart& part : m->operations) {
      const auto taken = logs_.receive(part);
      for (const Operation& operation : taken ? *taken : std::vector<Operation>{}) {
        require(operation.id.number == ++numbers_[operation.id.author]);
        check(operation);
      }
      exchange_.on_part(now_, m->sender, part);
    }
    exchange_.on_requests(now_, m->sender, m->operation_requests);
  }

  void check_logs() const {
    require(logs_.last(kOwn).number == 3);
    require(logs_.ahead_bytes() <= OperationLogs::kAheadMax_bytes);
    for (const auto& [author, number] : numbers_) require(author != kOwn && logs_.last(author).number == number);
    for (const auto& [author, length] : logs_.lengths()) require(logs_.bytes({author, 0, length}).size() == length);
  }

 private:
  void tick() {
    std::size_t bytes = 0;
    for (OperationMessage& out : exchange_.on_tick(now_)) {
      Message m;
      m.sender = PeerId{0xFFFF'FFFF};
      m.incarnation = incarnation_low(~std::uint64_t{0});
      m.number = 0xFFFF'FFFF;
      m.operations = std::move(out.operations);
      m.operation_requests = std::move(out.operation_requests);
      const Bytes datagram = encode(m);
      require(datagram.size() <= kDatagramMax_bytes && decode(datagram, SimTime{}).has_value());
      bytes += datagram.size();
    }
    require(bytes < 100'000);
  }

  OperationLogs logs_{kOwn};
  OperationExchange exchange_{logs_, kSelf, kOwn, 1};
  std::map<AuthorId, std::uint32_t> numbers_;
  HostTime now_{std::chrono::seconds(1'000)};
};

void read_as_log(std::span<const std::byte> log) {
  while (!log.empty()) {
    const auto next = decode_operation(kAuthor, log);
    if (!next || !*next) break;
    check((*next)->operation);
    log = log.subspan((*next)->size_bytes);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::span<const std::byte> rest = std::as_bytes(std::span(data, size));
  read_as_log(rest);
  Driver driver;
  for (int i = 0; i < kDatagramsMax && rest.size() > 3; ++i) {
    const auto length = std::to_integer<std::size_t>(rest[0]) | std::to_integer<std::size_t>(rest[1]) << 8;
    driver.pass(std::chrono::milliseconds(10 * std::to_integer<int>(rest[2])));
    rest = rest.subspan(3);
    const auto datagram = rest.first(std::min(length, rest.size()));
    driver.receive(datagram);
    rest = rest.subspan(datagram.size());
  }
  driver.pass(std::chrono::seconds(3));
  driver.check_logs();
  return 0;
}
