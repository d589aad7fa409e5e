#include "peerd/lab/live/live_run.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <fstream>
#include <iostream>
#include <memory>
#include <utility>

#include <spdlog/fmt/fmt.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include "peerd/input/json_text.hpp"
#include "peerd/lab/live/child_process.hpp"
#include "peerd/lab/live/companions.hpp"
#include "peerd/lab/live/lab.hpp"
#include "peerd/lab/live/live_events.hpp"
#include "peerd/net/keys/key_file.hpp"

namespace peerd {
namespace {

namespace fs = std::filesystem;

// A peer takes two seconds to join and none to leave; one that is not done so long after the scenario's end hangs.
constexpr std::chrono::seconds kGrace{20};

// JSON values are TOML values, except for tables.
std::string toml_value(const nlohmann::ordered_json& value) {
  if (!value.is_structured()) return json_line(value);
  std::string text;
  for (const auto& [key, item] : value.items()) {
    text += (text.empty() ? "" : ", ") + (value.is_object() ? json_line(nlohmann::json(key)) + " = " : "") +
            toml_value(item);
  }
  return value.is_object() ? "{" + text + "}" : "[" + text + "]";
}

sigset_t stop_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  return signals;
}

constexpr std::chrono::milliseconds kWait{20};

// Waits kWait for a stop signal. The signals are blocked, so that the peers can be ended before this process ends.
bool asked_to_stop() {
  const sigset_t signals = stop_signals();
  const timespec wait{0, std::chrono::nanoseconds(kWait).count()};
  return sigtimedwait(&signals, nullptr, &wait) > 0;
}

std::string last_lines(const fs::path& path, std::size_t count) {
  std::ifstream in(path);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  std::string text;
  for (std::size_t i = lines.size() > count ? lines.size() - count : 0; i < lines.size(); ++i)
    text += "  " + lines[i] + "\n";
  return text;
}

bool contains(const fs::path& path, const std::string& words) {
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);) {
    if (line.find(words) != std::string::npos) return true;
  }
  return false;
}

// The peers of one run seal what they send by a key whose file is gone with this object.
struct KeyOfRun {
  fs::path file;
  KeyOfRun(const KeyOfRun&) = delete;
  KeyOfRun& operator=(const KeyOfRun&) = delete;
  explicit KeyOfRun(fs::path at) : file(std::move(at)) {}
  ~KeyOfRun() {
    std::error_code ignored;
    fs::remove(file, ignored);
  }
};
fs::path key_file_of(const LiveRun& launch) { return fs::absolute(launch.out / (launch.run_name + ".key")); }

Islands islands_of(const LiveRun& launch) {
  return {.stem = launch.out / launch.run_name,
          .port = launch.port,
          .program = launch.program,
          .key_file = key_file_of(launch),
          .apart = launch.lab != nullptr};
}

std::vector<std::string> peer_command(const LiveRun& launch, const config::RunSettings& run,
                                      const config::PeerSettings& peer, const fs::path& record,
                                      const fs::path& key_file) {
  std::vector<std::string> command{launch.program.string(),
                                   "run",
                                   "--config",
                                   launch.scenario.string(),
                                   "--peer",
                                   peer.name,
                                   "--record",
                                   record.string(),
                                   "--once",
                                   "--verbose",
                                   "--take-over"};
  const auto set = [&](const std::string& assignment) { command.insert(command.end(), {"--set", assignment}); };
  const bool has_key = !run.transport.key_file.empty() || !run.transport.password_file.empty();
  if (run.transport.sealed && !has_key) set("transport.key_file=" + json_line(key_file.string()));
  for (const std::string& s : launch.sets) set(s);
  for (const auto& [key, value] : run.params.items()) set(key + "=" + toml_value(value));
  set("seed=" + std::to_string(run.seed));
  const std::uint32_t port = run.transport.port.value_or(static_cast<std::uint32_t>(launch.port));
  if (run.transport.multicast == net::kMulticastNever) {  // each peer needs a port of its own
    std::string all;
    for (std::uint32_t i = 0; i < run.peers.size(); ++i) {
      if (run.peers[i].id == peer.id) set("transport.port=" + std::to_string(port + i));
      const std::string host = launch.lab ? live::Lab::address(i) : "127.0.0.1";
      all += (i == 0 ? "" : ", ") + json_line(nlohmann::json(host + ":" + std::to_string(port + i)));
    }
    set("transport.peers=[" + all + "]");
  } else {
    set("transport.port=" + std::to_string(port));
  }
  for (const std::string& s :
       settings_by_companions(run, islands_of(launch), static_cast<std::size_t>(&peer - run.peers.data()))) {
    set(s);
  }
  std::string wanted = launch.interface.empty() ? run.transport.interface : launch.interface;
  if (wanted.empty()) wanted = "lo";
  if (launch.lab && run.via != config::Via::kRelay) wanted = live::Lab::kInterface;
  if (run.via == config::Via::kRelay) wanted = "lo";  // each peer's island
  set("transport.interface=" + json_line(wanted));
  for (const fs::path& overlay : launch.configs) command.insert(command.end(), {"--overlay", overlay.string()});
  return command;
}

// The command as it runs in the peer's namespace, where the run has a lab.
std::vector<std::string> in_place(const LiveRun& launch, std::size_t peer, const std::vector<std::string>& command) {
  std::vector<std::string> words = launch.lab ? live::Lab::inside(peer) : std::vector<std::string>{};
  words.insert(words.end(), command.begin(), command.end());
  return words;
}

// The processes of one run: its peers, and their captures.
class LiveProcesses {
 public:
  LiveProcesses(const LiveRun& launch, const config::RunSettings& run, fs::path control)
      : launch_(launch), run_(run), control_(std::move(control)) {}

  void start_captures() {
    for (std::size_t i = 0; i < run_.peers.size() && launch_.tcpdump; ++i) {
      const std::string file = stem_of(run_.peers[i].name);
      captures_.push_back(std::make_unique<ChildProcess>(
          run_.peers[i].name + "'s tcpdump",
          in_place(launch_, i, {"tcpdump", "-Z", "root", "-U", "-i", live::Lab::kInterface, "-w", file + ".pcap"}),
          file + ".tcpdump.log"));
    }
  }

  // Starts what carries the peers' datagrams, and waits until it says that it is ready.
  [[nodiscard]] Result<void> start_companions() {
    auto wanted = companions_of(run_, islands_of(launch_));
    if (!wanted) return std::unexpected(wanted.error());
    for (const Companion& companion : *wanted) {
      companions_.push_back(std::make_unique<ChildProcess>(
          run_.peers[companion.peer].name + "'s " + companion.command.front(),
          in_place(launch_, companion.peer, companion.command), stem_of(companion.name) + ".log"));
      ChildProcess& child = *companions_.back();
      const auto give_up = std::chrono::steady_clock::now() + kGrace;
      while (!contains(child.output(), companion.ready)) {
        if (!child.running()) return failed(child, "can't be run (is its package installed?)");
        if (std::chrono::steady_clock::now() > give_up) return failed(child, "is not ready");
        if (asked_to_stop()) return std::unexpected(InputError{"error: stopped by a signal", kSystemFailed});
      }
    }
    return {};
  }

  // The first peer to start has the control socket that the scenario's events go to.
  void start(const config::PeerSettings& peer) {
    const std::string record = stem_of(peer.name) + ".rows";
    fs::remove(record);
    auto command = peer_command(launch_, run_, peer, record, key_file_of(launch_));
    if (peers_.empty() && !control_.empty()) {
      command.insert(command.end(), {"--control", control_.string()});
    }
    const auto place = static_cast<std::size_t>(&peer - run_.peers.data());
    peers_.push_back(
        std::make_unique<ChildProcess>(peer.name, in_place(launch_, place, command), stem_of(peer.name) + ".log"));
  }

  void happen(const config::ScenarioEvent& event) {
    if (event.kind == config::EventKind::kJoin) {
      return start(*std::ranges::find(run_.peers, event.peer, &config::PeerSettings::name));
    }
    const auto child = std::ranges::find(peers_, event.peer, [](const auto& c) { return c->name(); });
    (*child)->end(event.kind == config::EventKind::kKill ? SIGKILL : SIGTERM);
  }

  // Whether a peer still runs; an error where one ended by itself.
  [[nodiscard]] Result<bool> any_running() {
    bool any = false;
    for (auto& peer : peers_) {
      if (peer->running()) {
        any = true;
      } else if (peer->exit_code() != 0 && !peer->killed()) {
        return failed(*peer, "ended by itself");
      }
    }
    return any;
  }

  // The programs beside the peers have to live as long as they do.
  [[nodiscard]] Result<void> check_others() {
    for (auto& companion : companions_) {
      if (!companion->running()) return failed(*companion, "ended by itself");
    }
    for (auto& capture : captures_) {
      if (!capture->running()) return failed(*capture, "ended by itself");
    }
    return {};
  }

  // Precondition: a peer still runs.
  [[nodiscard]] std::unexpected<InputError> hung() {
    return failed(**std::ranges::find_if(peers_, [](const auto& c) { return c->running(); }), "did not come to an end");
  }

  [[nodiscard]] std::size_t started() const { return peers_.size(); }

  // The peers are in the order of starting, without the killed ones, which have written no record.
  [[nodiscard]] Result<std::vector<PeerLog>> load_logs() const {
    std::vector<PeerLog> logs;
    for (const auto& peer : peers_) {
      if (peer->killed()) continue;
      auto log = load_peer_log(stem_of(peer->name()) + ".rows");
      if (!log) return std::unexpected(log.error());
      logs.push_back(std::move(*log));
    }
    return logs;
  }

 private:
  [[nodiscard]] std::string stem_of(const std::string& peer) const {
    return (launch_.out / (launch_.run_name + "." + peer)).string();
  }

  static std::unexpected<InputError> failed(ChildProcess& child, const std::string& what) {
    return std::unexpected(InputError{fmt::format("error: peer {} {}; its last words ({}):\n{}", child.name(), what,
                                                  child.output().string(), last_lines(child.output(), 5)),
                                      child.exit_code() == 0 ? 3 : child.exit_code()});
  }

  const LiveRun& launch_;
  const config::RunSettings& run_;
  fs::path control_;
  std::vector<std::unique_ptr<ChildProcess>> companions_, captures_;  // end after the peers
  std::vector<std::unique_ptr<ChildProcess>> peers_;                  // in the order of starting
};

}  // namespace

void block_stop_signals() {
  const sigset_t signals = stop_signals();
  sigprocmask(SIG_BLOCK, &signals, nullptr);
}

Result<std::vector<PeerLog>> run_live(const LiveRun& launch, const config::RunSettings& run,
                                      std::vector<double>& oversleep_ms) {
  auto events = LiveEvents::make(run.events);
  if (!events) return std::unexpected(events.error());
  const KeyOfRun key{key_file_of(launch)};
  if (const auto made = keys::read_or_make_key(key.file); !made) return std::unexpected(made.error());
  LiveProcesses processes(launch, run, events->control());
  processes.start_captures();
  if (auto started = processes.start_companions(); !started) return std::unexpected(started.error());
  for (const config::PeerSettings& peer : run.peers) {
    if (config::starts_with(run.events, peer.name)) processes.start(peer);
  }
  const bool show_progress = isatty(STDERR_FILENO) != 0;
  const auto begun = std::chrono::steady_clock::now();
  const auto most = std::chrono::duration<double>(run.duration_s) + kGrace;
  for (auto shown = begun;;) {
    const auto any_running = processes.any_running();
    if (!any_running) return std::unexpected(any_running.error());
    if (!*any_running) break;
    while (const config::ScenarioEvent* event = events->take_due()) processes.happen(*event);
    if (auto others = processes.check_others(); !others) return std::unexpected(others.error());
    const auto now = std::chrono::steady_clock::now();
    if (now - begun > most) return processes.hung();
    if (now - shown >= std::chrono::seconds(1)) {
      shown = now;
      const auto line = fmt::format("{}: {:2.0f} s, {} peers live", launch.run_name,
                                    std::chrono::duration<double>(now - begun).count(), processes.started());
      std::cerr << (show_progress ? "\r" + line : line + "\n") << std::flush;
    }
    const auto sleep_began = std::chrono::steady_clock::now();
    if (asked_to_stop()) {
      return std::unexpected(InputError{"error: stopped by a signal; the peers were stopped too", kSystemFailed});
    }
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - sleep_began;
    oversleep_ms.push_back((took - kWait).count());
  }
  if (show_progress) std::cerr << "\r\033[K";
  return processes.load_logs();
}

}  // namespace peerd
