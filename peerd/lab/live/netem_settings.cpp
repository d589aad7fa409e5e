#include "peerd/lab/live/netem_settings.hpp"

#include <cmath>

#include <spdlog/fmt/fmt.h>

namespace peerd::live {
namespace {

// The number of packets that may wait. netem drops further ones, and its default (1,000) is 500 ms of 2,000 packets/s:
// a loss that the scenario does not ask for. Memory is taken as packets come, so a large number costs nothing.
constexpr std::uint32_t kLimit = 1'000'000'000;
constexpr int kTableSize =
    8192;  // steps of a probability; the kernel takes twice as many, but a message of tc does not
constexpr double kTableUnit = 8192;  // NETEM_DIST_SCALE: the entry that means one spread

// A share `reordering` of the entries is delayed by another latency + jitter. Both kinds are uniform over their own
// jitter.
std::string delay_table(const config::LinkSettings& link, double mean_ms, double spread_ms) {
  const int held = static_cast<int>(std::lround(link.reordering * kTableSize));
  std::string table;
  const auto add = [&](int count, double least_ms) {
    for (int i = 0; i < count; ++i) {
      const double delay_ms = least_ms + link.jitter_ms * (i + 0.5) / count;
      table += fmt::format("{}\n", std::lround((delay_ms - mean_ms) / spread_ms * kTableUnit));
    }
  };
  add(kTableSize - held, link.latency_ms);
  add(held, 2.0 * link.latency_ms + link.jitter_ms);
  return table;
}

std::string loss(const config::LinkSettings& link) {
  if (link.loss_burst > 0.0) {
    // Gilbert's model has two states. All datagrams are lost in the bad one, which is left with probability 1 / burst
    // and entered so often that its share is the loss.
    const double leave = 1.0 / link.loss_burst, enter = leave * link.loss / (1.0 - link.loss);
    return fmt::format(" loss gemodel {:.7f}% {:.7f}%", 100.0 * enter, 100.0 * leave);
  }
  return fmt::format(" loss random {:.7f}%", 100.0 * link.loss);
}

}  // namespace

NetemSettings netem_settings(const config::LinkSettings& link) {
  NetemSettings settings{fmt::format("netem limit {}", kLimit), {}};
  const double most_ms = (link.latency_ms + link.jitter_ms) * (link.reordering > 0.0 ? 2.0 : 1.0);
  const double mean_ms = 0.5 * (link.latency_ms + most_ms), spread_ms = most_ms - mean_ms;
  settings.options += fmt::format(" delay {:.3f}us", 1e3 * mean_ms);
  if (spread_ms > 0.0) {
    settings.options += fmt::format(" {:.3f}us distribution {}", 1e3 * spread_ms, kTable);
    settings.table = delay_table(link, mean_ms, spread_ms);
  }
  if (link.loss > 0.0) settings.options += loss(link);
  if (link.duplication > 0.0) settings.options += fmt::format(" duplicate {:.7f}%", 100.0 * link.duplication);
  return settings;
}

}  // namespace peerd::live
