// Question: how many datagrams does one relay pass on with one core, beside a loop of recvmmsg and sendmmsg that does
// nothing else, and beside nats-server?
//
// relay_bench [--quick] [--out DIR] [--commit NAME]: one source, 1 or 16 sinks, datagrams of 200 bytes, on lo. Source
// and sinks are on the first core and the forwarder on the second. As many datagrams are under way at once as fit into
// the buffers, so that the forwarder always has some to read. Rounds go in turns. `per_cpu_s` are copies that left by
// the second of processor time that the forwarder's thread, or nats-server's process, has used; `per_s` by the second.
//
// Exit code 1: a sink did not get each datagram once, in order and as it was sent.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <map>
#include <stdexcept>

#include "bench/figures.hpp"
#include "bench/relay/forwarders.hpp"

namespace peerd::bench {
namespace {

constexpr std::size_t kDatagramBytes = 200, kBurst = 32;
constexpr std::size_t kCopiesUnderWay = 256;  // as fit into a receive buffer of the default size
constexpr auto kLostAfter = std::chrono::seconds(10);
constexpr auto kKeptAliveApart = std::chrono::milliseconds(200);

struct Round {
  double per_cpu_s = 0.0, per_s = 0.0;
};

// Numbers at the beginning, and then what follows from the number.
std::vector<std::byte> datagram(std::uint64_t number) {
  std::vector<std::byte> bytes(kDatagramBytes);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(number * 31 + i);
  std::memcpy(bytes.data(), &number, sizeof number);
  return bytes;
}

class Sinks {
 public:
  explicit Sinks(std::size_t count) : received_(count, 0) {}

  // Returns the number of datagrams that all of them have.
  std::uint64_t receive(Forwarder& forwarder) {
    for (std::size_t sink = 0; sink < received_.size(); ++sink) {
      got_.clear();
      const std::size_t count = forwarder.receive(sink, got_);
      for (std::size_t i = 0; i < count; ++i) {
        const auto expected = datagram(received_[sink]++);
        if (!std::equal(expected.begin(), expected.end(),
                        got_.begin() + static_cast<std::ptrdiff_t>(i * kDatagramBytes))) {
          throw std::runtime_error("a datagram was lost, doubled or changed");
        }
      }
    }
    return *std::ranges::min_element(received_);
  }

 private:
  std::vector<std::uint64_t> received_;
  std::vector<std::byte> got_;
};

using Forwarders = std::map<std::string, std::unique_ptr<Forwarder>>;

Round measure(Forwarders& all, Forwarder& forwarder, Sinks& sinks, std::uint64_t& sent, std::uint64_t count,
              std::size_t copies) {
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  const double cpu_before = forwarder.cpu_s();
  const std::uint64_t first = sent, last = sent + count;
  const std::size_t under_way = std::max(kBurst, kCopiesUnderWay / copies);
  auto progress = begin, kept_alive = begin - kKeptAliveApart;
  std::uint64_t received = first;
  while (received < last) {
    if (Clock::now() - kept_alive > kKeptAliveApart) {
      kept_alive = Clock::now();
      for (auto& each : all) each.second->keep_alive();
    }
    if (sent < last && sent - received + kBurst <= under_way) {
      std::vector<std::vector<std::byte>> burst;
      for (std::size_t i = 0; i < kBurst; ++i) burst.push_back(datagram(sent++));
      forwarder.send(burst);
    }
    const std::uint64_t now = sinks.receive(forwarder);
    if (now != std::exchange(received, now)) progress = Clock::now();
    if (Clock::now() - progress > kLostAfter) throw std::runtime_error("datagrams were lost");
  }
  const double wall = std::chrono::duration<double>(Clock::now() - begin).count();
  const double copies_out = static_cast<double>(count * copies);
  return {copies_out / (forwarder.cpu_s() - cpu_before), copies_out / wall};
}

void measure_sinks(std::size_t copies, const Options& options, std::vector<Figure>& figures) {
  Forwarders forwarders;
  forwarders["bare"] = bare_forwarder(copies);
  forwarders["relay"] = relay_forwarder(copies);
  if (auto nats = nats_forwarder(copies, kDatagramBytes)) forwarders["nats-server"] = std::move(nats);
  std::map<std::string, Sinks> sinks;
  std::map<std::string, std::uint64_t> sent;
  std::map<std::string, std::vector<double>> per_cpu_s, per_s;
  const std::uint64_t count = (options.quick ? 64 : 1'600) * kBurst / copies / kBurst * kBurst;
  for (int round = 0; round < (options.quick ? 2 : 15); ++round) {
    for (auto& [name, forwarder] : forwarders) {
      const auto result = measure(forwarders, *forwarder, sinks.try_emplace(name, copies).first->second, sent[name],
                                  std::max<std::uint64_t>(count, kBurst), copies);
      per_cpu_s[name].push_back(result.per_cpu_s);
      per_s[name].push_back(result.per_s);
    }
  }
  const std::string input = "sinks" + std::to_string(copies) + ".";
  const double bare_cpu = quartiles(per_cpu_s["bare"]).median, bare_wall = quartiles(per_s["bare"]).median;
  for (const auto& [name, forwarder] : forwarders) {
    const bool is_bare = name == "bare";
    const Quartiles cpu = quartiles(per_cpu_s[name]), wall = quartiles(per_s[name]);
    const auto against = [&](const char* what) { return is_bare ? "" : input + "bare." + what; };
    figures.push_back({input + name + ".per_cpu_s", cpu.median, "1/s", against("per_cpu_s"),
                       is_bare ? std::nullopt : std::optional(cpu.median / bare_cpu), cpu.low, cpu.high});
    figures.push_back({input + name + ".per_s", wall.median, "1/s", against("per_s"),
                       is_bare ? std::nullopt : std::optional(wall.median / bare_wall), wall.low, wall.high});
  }
}

int run(const Options& options) {
  run_on(kEndsCore);
  std::vector<Figure> figures;
  for (const std::size_t copies : {1, 16}) measure_sinks(copies, options, figures);
  for (const Figure& figure : figures) {
    std::printf("%-32s %12.0f %s", figure.name.c_str(), figure.value, figure.unit.c_str());
    if (figure.ratio) std::printf("  %.2f of %s", *figure.ratio, figure.against.c_str());
    std::printf("\n");
  }
  return write_figures(options, figures) ? 0 : 1;
}

}  // namespace
}  // namespace peerd::bench

int main(int argc, char** argv) { return peerd::bench::run_main(argc, argv, peerd::bench::run); }
