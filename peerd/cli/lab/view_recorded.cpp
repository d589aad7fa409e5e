#include "peerd/cli/lab/view_recorded.hpp"

#include <chrono>
#include <iostream>
#include <utility>

#include <spdlog/fmt/fmt.h>
#include <unistd.h>
#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>

#include "peerd/cli/shell/print.hpp"
#include "peerd/input/console/progress.hpp"
#include "peerd/input/console/stop_signals.hpp"
#include "peerd/input/printable.hpp"
#include "peerd/input/text_file.hpp"
#include "peerd/lab/recorded/record_capture.hpp"
#include "peerd/lab/recorded/record_run.hpp"
#include "peerd/lab/recorded/recorded_source.hpp"
#include "peerd/view/gateway/gateway.hpp"
#include "peerd/view/gateway/listen_address.hpp"

namespace peerd {
namespace {

// Makes the recording. What is stopped by a signal is not shown.
Result<recorded::Recording> make_recording(const ViewOptions& options, const StopSignals& signals) {
  ProgressDisplay display(isatty(STDERR_FILENO) != 0);
  recorded::Recorder how{.hz = options.hz, .most_bytes = options.memory_mib * kMiB};
  how.progress = [&](std::optional<double> run_s) {
    if (display.due()) display.show(fmt::format("simulating again: {:.1f} s", run_s.value_or(0.0)));
    return signals.signal() == 0;
  };
  return recorded::record({.path = options.what, .world = options.world, .size_max_mib = options.size_max_mib},
                          options.run, how);
}

void print_summary(const recorded::Recording& recording, double took_s) {
  std::size_t objects = 0;
  for (const recorded::RecordedView& view : recording.views) {
    objects = std::max(objects, view.errors.of_object.size());
  }
  const std::size_t bytes = recorded::size_bytes(recording);
  std::cout << fmt::format("{}, {}: {:.3g} s of {}, {:.2f} MiB", recording.name, recording.title, recording.end_s,
                           counted(recording.views.size(), "peer"), static_cast<double>(bytes) / kMiB);
  if (objects > 0 && recording.end_s > 0.0) {
    const double object_seconds = static_cast<double>(objects * recording.views.size()) * recording.end_s;
    std::cout << fmt::format(" ({:.0f} bytes an object, second and peer)", static_cast<double>(bytes) / object_seconds);
  }
  std::cout << fmt::format(", ready after {:.2f} s\n", took_s);
  for (const std::string& note : recording.notes) std::cerr << "warning: " << note << '\n';
}

}  // namespace

int view_recorded(const ViewOptions& options) {
  const auto begun = std::chrono::steady_clock::now();
  const auto at = gateway::listen_address(options.listen, /*beyond_loopback=*/false);
  if (!at) return failed(at.error());
  std::optional<recorded::RecordedSource> source;
  {
    StopSignals signals("stopped before there was anything to show");
    auto recording = make_recording(options, signals);
    if (!recording) return failed(recording.error());
    if (signals.signal() != 0) return signals.exit_code();
    print_summary(*recording, std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count());
    source.emplace(*std::move(recording));
  }
  boost::asio::io_context io(1);
  const auto gateway = gateway::Gateway::open(
      io, *source, {.at = *at, .assets = gateway::built_viewer(), .token = "", .log = [](const LogLine& line) {
                      std::cerr << line.text << '\n';
                    }});
  if (!gateway) return failed(gateway.error());
  if (gateway::built_viewer().empty()) std::cerr << "warning: this program was built without the viewer's page\n";
  std::cout << "the viewer is at " << (*gateway)->url() << '\n' << std::flush;
  boost::asio::signal_set ends(io, SIGINT, SIGTERM);
  ends.async_wait([&io](const boost::system::error_code&, int) { io.stop(); });
  io.run();
  return 0;
}

}  // namespace peerd
