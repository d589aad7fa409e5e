// Cyclone DDS by its own ddsperf, best effort as the others are, over the same interface. It prints each second's
// percentiles of half a round trip.
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <stdexcept>
#include <utility>

#include "ping_pong.hpp"

namespace peerd::bench {
namespace {

// Domains use different ports: two runs on one computer should not meet.
int domain() { return 100 + static_cast<int>(getpid() % 100); }

std::string command(int seconds, Pace pace) {
  const auto perf = [&](int core) {
    return "taskset -c " + std::to_string(core) + " timeout " + std::to_string(seconds + 10) + " ddsperf -u -i " +
           std::to_string(domain());
  };
  const Cores cores = two_cores();
  return "CYCLONEDDS_URI='<CycloneDDS><Domain><General><AllowMulticast>true</AllowMulticast><Interfaces>"
         "<NetworkInterface name=\"lo\" multicast=\"true\"/></Interfaces></General></Domain></CycloneDDS>'; "
         "export CYCLONEDDS_URI; " +
         perf(cores.pong) + " -D " + std::to_string(seconds + 1) + " pong >/dev/null 2>&1 & " + perf(cores.ping) +
         " -D " + std::to_string(seconds) + " ping " + (pace == Pace::kEveryMillisecond ? "1kHz " : "") +
         "size 64 2>&1; wait";
}

}  // namespace

bool has_ddsperf() { return system("command -v ddsperf >/dev/null 2>&1") == 0; }

// The first second is that of their meeting.
DdsRound dds_round(int seconds, Pace pace) {
  FILE* const output = popen(command(seconds + 1, pace).c_str(), "r");
  if (output == nullptr) throw std::runtime_error("ddsperf can't be started");
  std::vector<double> p50, p99;
  char line[512];
  bool first = true;
  while (std::fgets(line, sizeof line, output) != nullptr) {
    const std::string text = line;
    const auto middle = text.find(" 50% "), end = text.find(" 99% ");
    if (middle == std::string::npos || end == std::string::npos) continue;
    if (!std::exchange(first, false)) {
      p50.push_back(std::stod(text.substr(middle + 5)));
      p99.push_back(std::stod(text.substr(end + 5)));
    }
  }
  const int status = pclose(output);
  if (status != 0 || p50.empty()) throw std::runtime_error("ddsperf says no round trips");
  return {percentile(p50, 0.5), percentile(p99, 0.5)};
}

}  // namespace peerd::bench
