#include "peerd/daemon/open/run_lines.hpp"

#include <string>

#include <spdlog/fmt/fmt.h>

#include "peerd/net/transport/transport_options.hpp"

namespace peerd {

void log_beginning(const config::PeerSettings& peer, const std::filesystem::path& world,
                   const net::TransportSettings& settings, const net::OpenedTransport& reached, Log& log) {
  log(LogLevel::kInfo, fmt::format("peer {} (id {}) in {}, {}", peer.name, peer.id, world.filename().string(),
                                   reached.transport->describe()));
  if (!reached.why_unicast.empty()) log(LogLevel::kWarning, "no multicast: " + reached.why_unicast);
  if (!reached.why_only_here.empty()) {
    log(LogLevel::kWarning, "reaches this computer only, over " + reached.why_only_here + "; peerd doctor says more");
  }
  if (const std::string less = net::buffer_warning(settings, reached.transport->receive_buffer_bytes());
      !less.empty()) {
    log(LogLevel::kWarning, less);
  }
}

void log_findings(const PeerParts& parts, Log& log) {
  for (const std::string& line : parts.shared->findings()) log(LogLevel::kWarning, line);
  for (const LogLine& line : parts.opened.lines) log(line);
}

void log_totals(const PeerNode& node, const PeerLog& record, const net::Transport& transport, const Daemon& daemon,
                Log& log) {
  const net::ForwardTime& forward = daemon.forward();
  const auto count = [&](const char* name) { return record.counters.contains(name) ? record.counters.at(name) : 0; };
  log(LogLevel::kInfo, fmt::format("sent {} datagrams with {} updates, got {} with {}; {} of {} ticks were late",
                                   count("datagrams_out"), count("updates_out"), count("datagrams_in"),
                                   count("updates_in"), count("ticks_missed"), count("ticks")));
  if (const TickLateness& late = daemon.lateness(); late.count() > 0) {
    log(LogLevel::kInfo, fmt::format("ticks ran late by {:.1f} ms at most but for one in a hundred, by {:.1f} at "
                                     "the worst",
                                     to_seconds(late.p99()) * 1e3, to_seconds(late.most()) * 1e3));
  }
  if (record.counters.contains("poses_taken")) {
    log(LogLevel::kInfo, fmt::format("took {} poses, refused {} and {} messages; {} silences", count("poses_taken"),
                                     count("poses_refused"), count("pose_messages_refused"), count("feeds_silent")));
  }
  for (const auto& [reason, dropped] : node.peer().counters().drops) {
    log(LogLevel::kInfo, fmt::format("dropped {}: {}", dropped, reason));
  }
  for (const auto& [name, n] : transport.counters().named()) {
    if (n > 0 && !(name.ends_with("_in") || name.ends_with("_out")))
      log(LogLevel::kInfo, fmt::format("{}: {}", name, n));
  }
  if (forward.count() > 0) {
    log(LogLevel::kInfo, fmt::format("{} datagrams were read after a tick that they came before, by {:.1f} us at most",
                                     forward.count(), to_seconds(forward.most()) * 1e6));
  }
}

}  // namespace peerd
