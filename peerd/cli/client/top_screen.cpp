#include "peerd/cli/client/top_screen.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "peerd/cli/client/peer_tables.hpp"
#include "peerd/cli/shell/problems.hpp"
#include "peerd/input/printable.hpp"

namespace peerd {
namespace {

using Json = nlohmann::ordered_json;

// The counters of the line of traffic.
struct Rate {
  const char *counter, *shown;
};
constexpr std::array kRates{Rate{"datagrams_in", "datagrams in"},
                            Rate{"datagrams_out", "out"},
                            Rate{"bytes_in", "bytes in"},
                            Rate{"bytes_out", "out"},
                            Rate{"updates_in", "updates in"},
                            Rate{"updates_out", "out"},
                            Rate{"ticks", "ticks"},
                            Rate{"ticks_missed", "late"}};

std::uint64_t count_of(const PeerSample& sample, const std::string& counter) {
  return sample.status.at("counters").value(counter, std::uint64_t{0});
}

// The growth of a counter [1/s]; none where it is not known.
std::optional<double> rate_of(const std::optional<PeerSample>& before, const PeerSample& now,
                              const std::string& counter) {
  if (!before || now.at_s <= before->at_s || count_of(now, counter) < count_of(*before, counter)) return std::nullopt;
  return static_cast<double>(count_of(now, counter) - count_of(*before, counter)) / (now.at_s - before->at_s);
}

std::string seconds(const Json& t) { return t.is_null() ? "-" : fmt::format("{:.1f} s", t.get<double>()); }

std::string session_line(const Json& status) {
  const Json& session = status.at("session");
  const std::string clock =
      session.at("clock_error_ms").is_null()
          ? "no session yet"
          : fmt::format("session time within {:.3f} ms", session.at("clock_error_ms").get<double>());
  return fmt::format("{} (id {})   {}   world time {}   since the start {}   with {}",
                     status.at("peer").at("name").get<std::string>(), status.at("peer").at("id").get<std::uint64_t>(),
                     clock, seconds(status.at("world_time_s")), seconds(status.at("since_start_s")),
                     counted(status.at("members").size(), "other peer"));
}

PeerNames names_in(const Json& status) {
  PeerNames names;
  const auto add = [&](const Json& peer) {
    names.emplace(peer.at("id").get<std::uint64_t>(), peer.at("name").get<std::string>());
  };
  add(status.at("peer"));
  for (const Json& member : status.at("members")) add(member);
  return names;
}

std::string traffic_line(const std::optional<PeerSample>& before, const PeerSample& now) {
  std::string line = "each second:";
  for (const Rate& rate : kRates) {
    const auto per_s = rate_of(before, now, rate.counter);
    line += fmt::format(" {} {}", rate.shown, per_s ? fmt::format("{:.0f}", *per_s) : "-");
  }
  return line;
}

// Drops of all members and regions by reason, since the start.
std::string drops_line(const Json& peers) {
  std::string line;
  for (const char* const list : {"peers", "regions"}) {
    for (const Json& row : peers.at(list)) {
      for (const auto& [why, count] : row.at("drops").items()) {
        line += fmt::format("{}{} {}", line.empty() ? "dropped: " : ", ", count.get<std::uint64_t>(), why);
      }
    }
  }
  return line;
}

double squared_speed_of(const Json& object) {
  double square = 0.0;
  for (const Json& part : object.at("velocity_m_s")) square += part.get<double>() * part.get<double>();
  return square;
}

// The objects that matter most come first; equal ones stay in the order of their numbers.
Json most_interesting_first(const Json& objects) {
  std::vector<Json> rows(objects.begin(), objects.end());
  std::ranges::stable_sort(rows, [](const Json& a, const Json& b) {
    const double error_a = a.value("ghost_error_m", 0.0), error_b = b.value("ghost_error_m", 0.0);
    return error_a != error_b ? error_a > error_b : squared_speed_of(a) > squared_speed_of(b);
  });
  return rows;
}

// Lines of a limited length, as long as there is room.
class Screen {
 public:
  explicit Screen(ScreenSize size) : size_(size) {}
  void add(std::string_view line) {
    if (used_ == size_.rows) return;
    text_ += line.substr(0, size_.columns);
    text_ += '\n';
    ++used_;
  }
  void add_lines(std::string_view lines) {
    while (!lines.empty()) {
      const std::size_t end = lines.find('\n');
      add(lines.substr(0, end));
      lines.remove_prefix(end == std::string_view::npos ? lines.size() : end + 1);
    }
  }
  [[nodiscard]] std::size_t room() const { return size_.rows - used_; }
  [[nodiscard]] std::string text() && { return std::move(text_); }

 private:
  ScreenSize size_;
  std::size_t used_ = 0;
  std::string text_;
};

}  // namespace

std::string top_screen(const std::optional<PeerSample>& before, const PeerSample& now, ScreenSize size) {
  Screen screen(size);
  screen.add(session_line(now.status));
  screen.add(traffic_line(before, now));
  if (const std::string drops = drops_line(now.peers); !drops.empty()) screen.add(drops);
  screen.add("");
  screen.add_lines(table_of(peer_columns(now.peers)));
  screen.add("");
  const Json objects = most_interesting_first(now.objects.at("objects"));
  constexpr std::size_t kHeadings = 1;
  const bool all_fit = objects.size() + kHeadings <= screen.room();
  const std::size_t shown = all_fit ? objects.size() : screen.room() - std::min(screen.room(), kHeadings + 1);
  Json rows = Json::array();
  for (std::size_t i = 0; i < shown; ++i) rows.push_back(objects[i]);
  screen.add_lines(table_of(object_columns(rows, names_in(now.status))));
  if (!all_fit) screen.add(fmt::format("and {} more objects", objects.size() - shown));
  return std::move(screen).text();
}

}  // namespace peerd
