#include "peerd/daemon/open/peer_service.hpp"

#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

#include "peerd/daemon/open/reload.hpp"
#include "peerd/input/json_text.hpp"

namespace peerd {
namespace {

// Whether this process has a terminal that can be closed.
bool has_terminal() {
  const int terminal = open("/dev/tty", O_RDONLY | O_NOCTTY | O_CLOEXEC);
  if (terminal >= 0) close(terminal);
  return terminal >= 0;
}

std::string listed(const std::vector<std::string>& words) {
  std::string all;
  for (const std::string& word : words) all += (all.empty() ? "" : ", ") + word;
  return all;
}

// Why the peer has refused a request of the control protocol; empty: it has not.
std::string refusal_in(const std::string& reply) {
  const auto answer = json_if_valid(reply);
  if (answer.is_discarded() || answer.value("ok", false)) return {};
  return answer.value("error", "it says no more");
}

}  // namespace

PeerService::PeerService(Parts parts)
    : parts_(std::move(parts)),
      service_(parts_.io, parts_.manager,
               {.status = [this] { return status(); },
                .ticks = [this] { return parts_.node.peer().counters().ticks; },
                .every_second = [this] { parts_.log.report_left_out(); }},
               [this](const LogLine& line) { parts_.log(line); }) {
  parts_.daemon.on_begin([this] { service_.begin(); });
  parts_.daemon.on_leave([this] {
    if (!parts_.node.goes_over()) service_.leave();  // else this process goes on with another peer
  });
  if (service_.manager().is_there() || !has_terminal()) {
    parts_.daemon.on_hangup([this] { service_.reload([this] { reload(); }); });
  }
}

std::string PeerService::status() const {
  const std::size_t others = parts_.node.peer().members().count();
  return fmt::format("peer {} (id {}) in {}, with {} other peer{}", parts_.peer, parts_.node.peer().id().value,
                     parts_.world, others, others == 1 ? "" : "s");
}

void PeerService::reload() {
  if (!parts_.read) {
    return parts_.log({LogLevel::kWarning, "got SIGHUP, but has no configuration that it could read again"});
  }
  const auto settings = parts_.read();
  if (!settings) {
    return parts_.log({LogLevel::kError, "the configuration stays as it was: " + settings.error().text});
  }
  apply(*settings);
}

void PeerService::apply(const config::RunSettings& settings) {
  const Reload changes = reload_of(parts_.settings, settings, parts_.peer);
  parts_.settings = settings;
  parts_.log.change(parts_.verbose || settings.log.verbose, limits_of(settings.log));
  for (const std::string& request : changes.requests) {
    const std::string why = refusal_in(parts_.daemon.on_control(request).line);
    if (!why.empty()) parts_.log({LogLevel::kError, "the configuration asks " + request + ", but: " + why});
  }
  if (!changes.later.empty()) {
    parts_.log({LogLevel::kWarning, "counts when this peer is started again: " + listed(changes.later)});
  }
  parts_.log({LogLevel::kInfo, changes.now.empty()
                                   ? "read its configuration again: nothing else is new"
                                   : "read its configuration again: now counts " + listed(changes.now)});
}

}  // namespace peerd
