#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <thread>

#include <fcntl.h>
#include <spawn.h>
#include <spdlog/fmt/fmt.h>
#include <sys/wait.h>
#include <unistd.h>

#include "peerd/commands/commands.hpp"
#include "peerd/commands/print.hpp"
#include "peerd/netem/lab.hpp"
#include "peerd/scenario/assemble.hpp"
#include "peerd/scenario/live_events.hpp"

namespace peerd {
namespace {

namespace fs = std::filesystem;

// Joining takes two seconds, leaving none; a peer that is not done by then hangs.
constexpr std::chrono::seconds kGrace{20};
// Sessions of two scenario runs on one computer must not meet: each takes a port of its own from this range,
// below the ephemeral ports, which the system may hand to anybody.
constexpr int kPortBegin = 20000, kPortCount = 12000;

// JSON is TOML but for its tables.
std::string toml_value(const nlohmann::ordered_json& value) {
  if (!value.is_structured()) return value.dump();
  std::string text;
  for (const auto& [key, item] : value.items()) {
    text +=
        (text.empty() ? "" : ", ") + (value.is_object() ? nlohmann::json(key).dump() + " = " : "") + toml_value(item);
  }
  return value.is_object() ? "{" + text + "}" : "[" + text + "]";
}

// One real peer as a child process; its log lines go to a file.
class Child {
 public:
  Child(std::string name, const std::vector<std::string>& command, const fs::path& output)
      : name_(std::move(name)), output_(output) {
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    posix_spawn_file_actions_adddup2(&files, STDOUT_FILENO, STDERR_FILENO);
    std::vector<char*> arguments;
    for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    posix_spawnattr_t attributes;  // the child hears the signals that its parent has set aside
    sigset_t none;
    sigemptyset(&none);
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
    if (posix_spawnp(&pid_, arguments[0], &files, &attributes, arguments.data(), environ) != 0) pid_ = -1;
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&files);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    if (!running()) return;
    kill(pid_, SIGTERM);
    for (int tries = 0; tries < 50 && running(); ++tries) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    if (!running()) return;
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }

  [[nodiscard]] bool running() {
    if (pid_ <= 0 || done_) return false;
    done_ = waitpid(pid_, &status_, WNOHANG) == pid_;
    return !done_;
  }
  // To leave (SIGTERM), or at once and without a word (SIGKILL).
  void end(int signal) {
    killed_ = signal == SIGKILL;
    if (running()) kill(pid_, signal);
  }
  [[nodiscard]] bool killed() const { return killed_; }
  // 0 when it left as it should; its own exit code, or 3 when a signal or the system ended it.
  [[nodiscard]] int exit_code() const { return pid_ > 0 && WIFEXITED(status_) ? WEXITSTATUS(status_) : 3; }
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const fs::path& output() const { return output_; }

 private:
  std::string name_;
  fs::path output_;
  pid_t pid_ = -1;
  int status_ = 0;
  bool done_ = false, killed_ = false;
};

sigset_t stop_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  return signals;
}

constexpr std::chrono::milliseconds kWait{20};

// Waits that long for one of them; they are blocked, so that the peers can be ended before this process is.
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

struct Launch {
  const ScenarioOptions& options;
  const fs::path& program;
  fs::path out;
  std::string run_name;  // run-001
  int port;
  netem::Lab* lab;  // null: the peers are in this computer's own network
};

std::vector<std::string> peer_command(const Launch& launch, const config::RunSettings& run,
                                      const config::PeerSettings& peer, const fs::path& record) {
  std::vector<std::string> command{
      launch.program.string(), "run",    "--config", launch.options.scenario.string(), "--peer", peer.name, "--record",
      record.string(),         "--once", "--verbose"};
  const auto set = [&](const std::string& assignment) { command.insert(command.end(), {"--set", assignment}); };
  for (const std::string& s : launch.options.sets) set(s);
  for (const auto& [key, value] : run.params.items()) set(key + "=" + toml_value(value));
  set("seed=" + std::to_string(run.seed));
  const std::uint32_t port = run.transport.port.value_or(static_cast<std::uint32_t>(launch.port));
  if (run.transport.multicast == config::kMulticastNever) {  // by unicast each has a port of its own
    std::string all;
    for (std::uint32_t i = 0; i < run.peers.size(); ++i) {
      if (run.peers[i].id == peer.id) set("transport.port=" + std::to_string(port + i));
      const std::string host = launch.lab ? netem::Lab::address(i) : "127.0.0.1";
      all += (i == 0 ? "" : ", ") + nlohmann::json(host + ":" + std::to_string(port + i)).dump();
    }
    set("transport.peers=[" + all + "]");
  } else {
    set("transport.port=" + std::to_string(port));
  }
  std::string wanted = launch.options.interface.empty() ? run.transport.interface : launch.options.interface;
  if (wanted.empty()) wanted = "lo";
  if (launch.lab) wanted = netem::Lab::kInterface;
  set("transport.interface=" + json_line(wanted));
  for (const fs::path& overlay : launch.options.configs) command.insert(command.end(), {"--overlay", overlay.string()});
  return command;
}

// The command in the peer's place: its namespace, where the peers have any.
std::vector<std::string> in_place(const Launch& launch, std::size_t peer, const std::vector<std::string>& command) {
  std::vector<std::string> words = launch.lab ? netem::Lab::inside(peer) : std::vector<std::string>{};
  words.insert(words.end(), command.begin(), command.end());
  return words;
}

// Oversleep: by how much waiting for a signal took longer than it should, each time [ms].
Result<std::vector<PeerLog>> run_live(const Launch& launch, const config::RunSettings& run,
                                      std::vector<double>& oversleep_ms) {
  auto events = LiveEvents::make(run.events);
  if (!events) return std::unexpected(events.error());
  std::vector<std::unique_ptr<Child>> captures;  // end when the peers have
  std::vector<std::unique_ptr<Child>> children;  // in the order in which they came
  const auto stem_of = [&](const std::string& peer) { return (launch.out / (launch.run_name + "." + peer)).string(); };
  const auto start = [&](const config::PeerSettings& peer) {
    const std::string record = stem_of(peer.name) + ".rows";
    fs::remove(record);
    auto command = peer_command(launch, run, peer, record);
    if (children.empty() && !events->control().empty()) {
      command.insert(command.end(), {"--control", events->control().string()});
    }
    const auto place = static_cast<std::size_t>(&peer - run.peers.data());
    children.push_back(
        std::make_unique<Child>(peer.name, in_place(launch, place, command), stem_of(peer.name) + ".log"));
  };
  for (std::size_t i = 0; i < run.peers.size() && launch.options.tcpdump; ++i) {
    const std::string file = stem_of(run.peers[i].name);
    captures.push_back(std::make_unique<Child>(
        run.peers[i].name + "'s tcpdump",
        in_place(launch, i, {"tcpdump", "-Z", "root", "-U", "-i", netem::Lab::kInterface, "-w", file + ".pcap"}),
        file + ".tcpdump.log"));
  }
  for (const config::PeerSettings& peer : run.peers) {
    if (config::starts_with(run.events, peer.name)) start(peer);
  }
  const auto happen = [&](const config::ScenarioEvent& event) {
    if (event.kind == config::EventKind::kJoin) {
      return start(*std::ranges::find(run.peers, event.peer, &config::PeerSettings::name));
    }
    const auto child = std::ranges::find(children, event.peer, [](const auto& c) { return c->name(); });
    (*child)->end(event.kind == config::EventKind::kKill ? SIGKILL : SIGTERM);
  };
  const bool show_progress = isatty(STDERR_FILENO) != 0;
  const auto begun = std::chrono::steady_clock::now();
  const auto most = std::chrono::duration<double>(run.duration_s) + kGrace;
  const auto fail = [&](Child& child, const std::string& what) {
    return std::unexpected(InputError{fmt::format("error: peer {} {}; its last words ({}):\n{}", child.name(), what,
                                                  child.output().string(), last_lines(child.output(), 5)),
                                      child.exit_code() == 0 ? 3 : child.exit_code()});
  };
  for (auto shown = begun;;) {
    bool any = false;
    for (auto& child : children) {
      if (child->running()) {
        any = true;
      } else if (child->exit_code() != 0 && !child->killed()) {
        return fail(*child, "ended by itself");
      }
    }
    if (!any) break;
    while (const config::ScenarioEvent* event = events->take_due()) happen(*event);
    for (auto& capture : captures) {
      if (!capture->running()) return fail(*capture, "ended by itself");
    }
    const auto now = std::chrono::steady_clock::now();
    if (now - begun > most) {
      const auto hung = std::ranges::find_if(children, [](const auto& c) { return c->running(); });
      return fail(**hung, "did not come to an end");
    }
    if (now - shown >= std::chrono::seconds(1)) {
      shown = now;
      const auto line = fmt::format("{}: {:2.0f} s, {} peers live", launch.run_name,
                                    std::chrono::duration<double>(now - begun).count(), children.size());
      std::cerr << (show_progress ? "\r" + line : line + "\n") << std::flush;
    }
    const auto sleep_began = std::chrono::steady_clock::now();
    if (asked_to_stop()) {
      return std::unexpected(InputError{"error: stopped by a signal; the peers were stopped too", 3});
    }
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - sleep_began;
    oversleep_ms.push_back((took - kWait).count());
  }
  if (show_progress) std::cerr << "\r\033[K";
  std::vector<PeerLog> logs;
  for (const auto& child : children) {
    if (child->killed()) continue;  // it had no time to write its record
    auto log = load_peer_log(stem_of(child->name()) + ".rows");
    if (!log) return std::unexpected(log.error());
    logs.push_back(std::move(*log));
  }
  return logs;
}

}  // namespace

int run_scenario(const ScenarioOptions& options, const fs::path& program) {
  config::ScenarioRequest request{options.scenario, options.configs, options.sets, options.seed,
                                  options.repeat,   !options.netem,  true};
  const auto scenario = config::read_scenario(request);
  if (!scenario) return failed(scenario.error());
  print_warnings(scenario->warnings);
  for (const config::RunSettings& run : scenario->runs) {
    if (const auto error = why_not_live(run.events)) return failed(*error);
  }
  const auto shared = share_world(scenario->world, scenario->inlines_when_needed);
  if (!shared) return failed(shared.error());

  report::ScenarioInfo info{
      scenario->name, "real", scenario->seed, {}, scenario->repeat, command_line("scenario", options)};
  for (const std::string& line : (*shared)->model->unsupported) info.warnings.push_back("unsupported: " + line);
  if (!options.netem) {
    info.warnings.push_back(
        "the network is this computer's own: latency_ms, jitter_ms, loss and the like do not apply");
  }
  for (const config::ScenarioEvent& event : scenario->runs.front().events) {
    if (event.kind != config::EventKind::kKill) continue;
    info.warnings.push_back("peer " + event.peer + " was killed: what it did and believed is not in the report");
  }
  const auto out = options.out.empty() ? fs::path("out") / scenario->name : options.out;
  std::error_code error;
  fs::create_directories(out, error);
  if (error) return failed({"error: can't make the folder " + out.string() + ": " + error.message(), 3});

  std::unique_ptr<netem::Lab> lab;
  if (options.netem) {
    auto built = netem::Lab::build(scenario->runs.front().peers.size());
    if (!built) return failed(built.error());
    lab = std::move(*built);
  }
  const sigset_t signals = stop_signals();
  sigprocmask(SIG_BLOCK, &signals, nullptr);
  std::vector<report::RunRecord> records;
  for (const config::RunSettings& run : scenario->runs) {
    const int number = static_cast<int>(records.size()) + 1;
    const int port = kPortBegin + (getpid() * 37 + number) % kPortCount;
    std::optional<report::NetworkMeasured> network;
    if (lab) {
      if (auto set = lab->set_links(run); !set) return failed(set.error());
      if (auto on = lab->set_multicast(true); !on) return failed(on.error());  // the probes'
      auto measured = lab->measure(run);
      if (!measured) return failed(measured.error());
      // Who is to do without it gets none.
      const bool multicast = run.transport.multicast != config::kMulticastNever;
      if (auto set = lab->set_multicast(multicast); !set) return failed(set.error());
      network = std::move(*measured);
    }
    std::vector<double> oversleep_ms;
    const auto logs =
        run_live({options, program, out, fmt::format("run-{:03}", number), port, lab.get()}, run, oversleep_ms);
    if (!logs) return failed(logs.error());
    auto record = assemble(run, **shared, *logs);
    if (!record) return failed(record.error());
    if (lab) {
      network->oversleep_during_ms = std::move(oversleep_ms);
      if (auto counted = lab->count(*network); !counted) return failed(counted.error());
      record->network = std::move(network);
      if (!report::kept_time(*record->network)) {
        info.warnings.push_back(
            fmt::format("run-{:03} does not count: this computer did not keep time (network.oversleep_ms)", number));
      }
    }
    records.push_back(std::move(*record));
  }
  const int code = print_report(info, records, scenario->expectations, out, options.json);
  if (code > 1 || options.json) return code;
  std::cout << "report: " << (out / "report.html").string() << '\n';
  return code;
}

}  // namespace peerd
