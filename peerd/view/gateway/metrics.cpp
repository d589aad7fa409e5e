#include "peerd/view/gateway/metrics.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

#include "peerd/input/json_text.hpp"
#include "peerd/peer/node/counter_meanings.hpp"

namespace peerd::gateway {
namespace {

using nlohmann::json;
using Labels = std::vector<std::pair<std::string_view, std::string>>;

constexpr double kMsPerSecond = 1e3;

// The metrics by name, so that all values of one stand together, as the format asks.
class Metrics {
 public:
  // A missing value, or null, is not known yet: it has no line.
  void add(const std::string& name, std::string_view type, std::string_view help, const json& value,
           const Labels& labels = {}, double per_unit = 1.0) {
    if (!value.is_number() && !value.is_boolean()) return;
    Metric& metric = metrics_[name];
    metric.type = type;
    metric.help = help;
    std::string number;
    if (value.is_boolean()) {
      number = value.get<bool>() ? "1" : "0";
    } else if (value.is_number_integer() && per_unit == 1.0) {
      number = json_line(value);
    } else {
      number = fmt::format("{}", value.get<double>() / per_unit);
    }
    metric.lines += name + written(labels) + ' ' + number + '\n';
  }
  [[nodiscard]] std::string text() const {
    std::string all;
    for (const auto& [name, metric] : metrics_) {
      all += fmt::format("# HELP {} {}\n# TYPE {} {}\n{}", name, metric.help, name, metric.type, metric.lines);
    }
    return all;
  }

 private:
  struct Metric {
    std::string_view type, help;
    std::string lines;
  };

  static std::string written(const Labels& labels) {
    std::string all;
    for (const auto& [name, value] : labels) {
      all += all.empty() ? '{' : ',';
      all += fmt::format("{}=\"{}\"", name, escaped(value));
    }
    return all.empty() ? all : all + '}';
  }
  static std::string escaped(const std::string& value) {
    std::string text;
    for (const char c : value) {
      if (c == '\n') {
        text += "\\n";
        continue;
      }
      if (c == '"' || c == '\\') text += '\\';
      text += c;
    }
    return text;
  }

  std::map<std::string, Metric> metrics_;
};

// Counters whose names end with what they count: that becomes a label.
struct Family {
  std::string_view prefix, metric, label;
};
constexpr std::array kFamilies{
    Family{"dropped_", "peerd_dropped_total", "reason"},
    Family{"poses_refused_", "peerd_poses_refused_for_total", "reason"},
    Family{"updates_out_up_to_", "peerd_updates_out_up_to_total", "size"},
    Family{"updates_out_longer_than_", "peerd_updates_out_longer_than_total", "size"},
    Family{"gateway.refused_", "peerd_gateway_refused_total", "kind"},
};

void add_counters(Metrics& metrics, const json& counters) {
  for (const auto& [name, value] : counters.items()) {
    const std::string_view meaning = meaning_of_counter(name);
    const auto family =
        std::ranges::find_if(kFamilies, [&](const Family& each) { return name.starts_with(each.prefix); });
    if (family != kFamilies.end()) {
      metrics.add(std::string(family->metric), "counter", meaning, value,
                  {{family->label, name.substr(family->prefix.size())}});
      continue;
    }
    std::string metric = "peerd_" + name + "_total";
    std::ranges::replace(metric, '.', '_');
    metrics.add(metric, "counter", meaning, value);
  }
}

void add_session(Metrics& metrics, const json& status, const json& clock) {
  const json& session = status.at("session");
  metrics.add("peerd_peer_info", "gauge", "this peer", 1,
              {{"peer", std::to_string(status.at("peer").at("id").get<std::uint64_t>())},
               {"name", status.at("peer").at("name").get<std::string>()}});
  metrics.add("peerd_joined", "gauge", "whether this peer has a session", session.at("joined"));
  metrics.add("peerd_session_time_seconds", "gauge", "session time", session.at("time_s"));
  metrics.add("peerd_world_time_seconds", "gauge", "time of the world's TimeSensors", status.at("world_time_s"));
  metrics.add("peerd_since_start_seconds", "gauge", "time since the motions began", status.at("since_start_s"));
  metrics.add("peerd_members", "gauge", "other peers in the session", status.at("members").size());
  metrics.add("peerd_clock_offset_seconds", "gauge", "session time minus the host clock", clock.at("offset_ms"), {},
              kMsPerSecond);
  metrics.add("peerd_clock_error_seconds", "gauge", "error bound of session time", clock.at("error_ms"), {},
              kMsPerSecond);
  metrics.add("peerd_clock_to_slew_seconds", "gauge", "correction that the clock is still working off",
              clock.at("to_slew_ms"), {}, kMsPerSecond);
  metrics.add("peerd_os_clock_error_seconds", "gauge", "error bound of the operating system's clock",
              clock.at("os_clock_error_ms"), {}, kMsPerSecond);
}

struct Column {
  std::string_view member, metric, type, help;
  double per_unit = 1.0;
};
constexpr std::array kOfPeers{
    Column{"joined", "peerd_peer_joined", "gauge", "whether that peer has a session"},
    Column{"leads", "peerd_peer_leads", "gauge", "whether session time is that peer's"},
    Column{"heard_ms_ago", "peerd_peer_silence_seconds", "gauge", "time since its last datagram", kMsPerSecond},
    Column{"round_trip_ms", "peerd_peer_round_trip_seconds", "gauge", "of the last echo, without the hold time",
           kMsPerSecond},
    Column{"delay_ms", "peerd_peer_delay_seconds", "gauge", "delay of its hellos by session time, mean of the last 16",
           kMsPerSecond},
    Column{"clock_ahead_ms", "peerd_peer_clock_ahead_seconds", "gauge",
           "its session time minus this peer's, the likeliest value", kMsPerSecond},
    Column{"clock_error_ms", "peerd_peer_clock_error_seconds", "gauge", "error bound that it publishes", kMsPerSecond},
    Column{"datagrams_in", "peerd_peer_datagrams_in_total", "counter", "datagrams received from it"},
    Column{"bytes_in", "peerd_peer_bytes_in_total", "counter", "UDP payload received from it"},
    Column{"loss_in", "peerd_peer_loss_in_ratio", "gauge", "part of its datagrams that was lost on the way here"},
    Column{"loss_out", "peerd_peer_loss_out_ratio", "gauge", "part of the datagrams to it that was lost"},
    Column{"duplicates", "peerd_peer_duplicates_total", "counter", "its datagrams that came twice"},
    Column{"overtaken", "peerd_peer_overtaken_total", "counter", "its datagrams that came after a later one"},
    Column{"ghosts_differ", "peerd_peer_ghosts_differ_total", "counter",
           "its objects shown elsewhere than it believes, for no known reason"},
    Column{"ghosts_differ_explained", "peerd_peer_ghosts_differ_explained_total", "counter",
           "its objects shown elsewhere, as something was lost or is late"},
};
constexpr std::array kOfRegions{
    Column{"datagrams_in", "peerd_region_datagrams_in_total", "counter", "datagrams of the region received"},
    Column{"bytes_in", "peerd_region_bytes_in_total", "counter", "UDP payload of the region received"},
    Column{"datagrams_out", "peerd_region_datagrams_out_total", "counter", "datagrams of the region sent"},
    Column{"bytes_out", "peerd_region_bytes_out_total", "counter", "UDP payload of the region sent"},
    Column{"loss_in", "peerd_region_loss_in_ratio", "gauge", "part of the region's datagrams that was lost"},
    Column{"duplicates", "peerd_region_duplicates_total", "counter", "datagrams of the region that came twice"},
    Column{"overtaken", "peerd_region_overtaken_total", "counter", "datagrams of the region that were overtaken"},
};

void add_row(Metrics& metrics, const json& row, std::span<const Column> columns, const Labels& labels,
             const std::string& drops) {
  for (const Column& column : columns) {
    metrics.add(std::string(column.metric), column.type, column.help, row.at(std::string(column.member)), labels,
                column.per_unit);
  }
  for (const auto& [reason, count] : row.at("drops").items()) {
    Labels of_reason = labels;
    of_reason.emplace_back("reason", reason);
    metrics.add(drops, "counter", "dropped here, by reason (docs/protocol.md, Drop reasons)", count, of_reason);
  }
}

}  // namespace

std::string metrics_text(const json& status, const json& peers) {
  Metrics metrics;
  add_counters(metrics, status.at("counters"));
  add_session(metrics, status, peers.at("clock"));
  for (const json& peer : peers.at("peers")) {
    add_row(
        metrics, peer, kOfPeers,
        {{"peer", std::to_string(peer.at("id").get<std::uint64_t>())}, {"name", peer.at("name").get<std::string>()}},
        "peerd_peer_drops_total");
  }
  for (const json& region : peers.at("regions")) {
    add_row(metrics, region, kOfRegions, {{"region", std::to_string(region.at("region").get<std::uint64_t>())}},
            "peerd_region_drops_total");
  }
  return metrics.text();
}

}  // namespace peerd::gateway
