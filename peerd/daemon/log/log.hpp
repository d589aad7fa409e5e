#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <utility>

#include <spdlog/logger.h>

#include "core/time.hpp"
#include "peerd/daemon/log/line_limiter.hpp"
#include "peerd/daemon/log/standard_output.hpp"
#include "peerd/peer/node/log_line.hpp"

namespace peerd {

enum class LogFormat : std::uint8_t {
  kText,     // time, level, peer and the fact
  kJson,     // one JSON object for each line
  kJournal,  // the fact behind its priority, as sd-daemon(3) says: systemd's journal knows the rest
};

// Writes one line for each fact to standard output, or gives it to a program, but not too many of a kind. Debug lines,
// which somebody must ask for, have no limit. Lines that nobody reads are dropped and counted: the log never waits.
class Log {
 public:
  struct Options {
    LogFormat format = LogFormat::kText;
    bool verbose = false;  // debug lines too
    LineLimiter::Limits limits = LineLimiter::kLimits;
    std::function<void(const LogLine&)> sink{};  // a program's; empty: standard output
  };

  // `now` is the time of a line, and does not run backwards.
  Log(std::string peer, const Options& options, std::function<HostTime()> now);
  // Says what was left out at the end.
  ~Log();
  Log(const Log&) = delete;
  Log& operator=(const Log&) = delete;

  void operator()(const LogLine& line);
  void operator()(LogLevel level, std::string text) { (*this)({level, std::move(text)}); }
  // From now on; the format stays.
  void change(bool verbose, LineLimiter::Limits limits);
  // Says which lines were left out a while ago, and how many nobody read; to be called about once a second.
  void report_left_out();

 private:
  void write(const LogLine& line);
  void write_left_out(const std::vector<LineLimiter::LeftOut>& left_out);
  void write_dropped();

  StandardOutput output_;
  spdlog::logger logger_;
  LogFormat format_;
  std::function<void(const LogLine&)> sink_;
  std::function<HostTime()> now_;
  LineLimiter limiter_;
};

}  // namespace peerd
