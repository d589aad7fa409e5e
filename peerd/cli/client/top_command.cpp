#include "peerd/cli/client/top_command.hpp"

#include <chrono>
#include <filesystem>
#include <iostream>
#include <optional>
#include <thread>
#include <utility>

#include "peerd/cli/client/peer_replies.hpp"
#include "peerd/cli/client/terminal.hpp"
#include "peerd/cli/client/top_screen.hpp"
#include "peerd/cli/shell/print.hpp"
#include "peerd/input/console/stop_signals.hpp"
#include "peerd/peer/control/control_path.hpp"

namespace peerd {
namespace {

using Clock = std::chrono::steady_clock;

// The screen of what is no terminal: a page of a log.
constexpr ScreenSize kPage{60, 160};

Result<PeerSample> take_sample(const std::filesystem::path& socket) {
  PeerSample sample;
  const auto ask = [&](const char* request, nlohmann::ordered_json& reply) -> Result<void> {
    auto read = ask_peer(socket, request);
    if (!read) return std::unexpected(read.error());
    reply = *std::move(read);
    return {};
  };
  if (auto done = ask(R"({"do":"status"})", sample.status); !done) return std::unexpected(done.error());
  sample.at_s = std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
  if (auto done = ask(R"({"do":"peers"})", sample.peers); !done) return std::unexpected(done.error());
  if (auto done = ask(R"({"do":"objects"})", sample.objects); !done) return std::unexpected(done.error());
  return sample;
}

// Whether somebody has asked it to end.
bool wait_for_end(const std::optional<Terminal>& terminal, const StopSignals& signals, std::chrono::milliseconds time) {
  if (!terminal) {
    std::this_thread::sleep_for(time);  // a signal ends this process at once
    return false;
  }
  const auto until = Clock::now() + time;
  for (auto now = Clock::now(); now < until && signals.signal() == 0; now = Clock::now()) {
    char key = 0;
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - now);
    if (terminal->wait(left, key) == Terminal::Waited::kKey && (key == 'q' || key == 'Q')) return true;
  }
  return signals.signal() != 0;
}

}  // namespace

int run_top(const TopOptions& options) {
  const auto socket = options.socket.empty() ? control::find_socket(options.name) : options.socket;
  if (!socket) return failed(socket.error());
  auto now = take_sample(*socket);  // an error shows before the terminal changes
  if (!now) return failed(now.error());
  std::optional<Terminal> terminal;
  StopSignals signals("stopped");
  if (Terminal::is_there()) {
    signals.note_from_now_on("stopped");
    terminal.emplace();
  }
  const std::chrono::milliseconds every(static_cast<std::int64_t>(options.every_s * 1e3));
  std::optional<PeerSample> before;
  for (std::uint64_t shown = 0;;) {
    if (terminal) {
      terminal->show(top_screen(before, *now, terminal->size()));
    } else {
      std::cout << top_screen(before, *now, kPage) << '\n' << std::flush;
    }
    if (++shown == options.count || !std::cout.good()) return 0;
    if (wait_for_end(terminal, signals, every)) return signals.signal() == 0 ? 0 : signals.exit_code();
    before = *std::move(now);
    now = take_sample(*socket);
    if (!now) {
      terminal.reset();  // the sentence goes to the normal screen
      return failed(now.error());
    }
  }
}

}  // namespace peerd
