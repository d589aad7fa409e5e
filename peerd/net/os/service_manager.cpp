#include "peerd/net/os/service_manager.hpp"

#include <systemd/sd-daemon.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <system_error>

namespace peerd::net {

ServiceManager ServiceManager::of_environment() {
  ServiceManager manager;
  if (const char* const socket = std::getenv("NOTIFY_SOCKET")) manager.socket_ = socket;
  std::uint64_t period_us = 0;
  if (sd_watchdog_enabled(/*unset_environment=*/1, &period_us) > 0 && manager.is_there()) {
    manager.watches_for_ = std::chrono::microseconds(period_us);
  }
  unsetenv("NOTIFY_SOCKET");
  return manager;
}

Result<void> ServiceManager::reloading() const {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  const auto now_us = std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::seconds(now.tv_sec) +
                                                                            std::chrono::nanoseconds(now.tv_nsec));
  return notify("RELOADING=1\nMONOTONIC_USEC=" + std::to_string(now_us.count()));
}

Result<void> ServiceManager::status(const std::string& text) const {
  std::string line = text;
  std::ranges::replace(line, '\n', ' ');  // what follows a line's end would be another message
  return notify("STATUS=" + line);
}

// libsystemd reads the socket from the environment, which has it only meanwhile.
Result<void> ServiceManager::notify(const std::string& state) const {
  if (!is_there()) return {};
  setenv("NOTIFY_SOCKET", socket_.c_str(), 1);
  const int done = sd_notify(/*unset_environment=*/1, state.c_str());
  if (done > 0) return {};
  const std::string why = done == 0 ? "it has gone" : std::error_code(-done, std::generic_category()).message();
  return std::unexpected(
      InputError{"error: can't reach the service manager at " + socket_ + ": " + why, kSystemFailed});
}

}  // namespace peerd::net
