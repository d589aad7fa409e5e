#include "peerd/daemon/log/log.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/sinks/base_sink.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "peerd/input/json_text.hpp"

namespace peerd {
namespace {

spdlog::level::level_enum level_of(LogLevel level) {
  switch (level) {
    case LogLevel::kDebug:
      return spdlog::level::debug;
    case LogLevel::kInfo:
      return spdlog::level::info;
    case LogLevel::kWarning:
      return spdlog::level::warn;
    case LogLevel::kError:
      return spdlog::level::err;
  }
  return spdlog::level::err;
}

// The priorities of syslog(3).
int priority_of(LogLevel level) {
  switch (level) {
    case LogLevel::kDebug:
      return 7;
    case LogLevel::kInfo:
      return 6;
    case LogLevel::kWarning:
      return 4;
    case LogLevel::kError:
      return 3;
  }
  return 3;
}

const char* pattern_of(LogFormat format) {
  switch (format) {
    case LogFormat::kText:
      return "%H:%M:%S.%e %-7l %n: %v";
    case LogFormat::kJson:
      return R"({"time":"%Y-%m-%dT%H:%M:%S.%e%z","peer":%n,"level":"%l","text":%v})";
    case LogFormat::kJournal:
      return "%v";
  }
  return "%v";
}

// Gives the lines of a logger to StandardOutput.
class OutputSink : public spdlog::sinks::base_sink<spdlog::details::null_mutex> {
 public:
  explicit OutputSink(StandardOutput& output) : output_(output) {}

 protected:
  void sink_it_(const spdlog::details::log_msg& message) override {
    spdlog::memory_buf_t line;
    formatter_->format(message, line);
    output_.write({line.data(), line.size()});
  }
  void flush_() override {}

 private:
  StandardOutput& output_;
};

spdlog::level::level_enum least_level(bool verbose) { return verbose ? spdlog::level::debug : spdlog::level::info; }

}  // namespace

Log::Log(std::string peer, const Options& options, std::function<HostTime()> now)
    : logger_(options.format == LogFormat::kJson ? json_line(peer) : std::move(peer),
              std::make_shared<OutputSink>(output_)),
      format_(options.format),
      sink_(options.sink),
      now_(std::move(now)),
      limiter_(options.limits) {
  logger_.set_level(least_level(options.verbose));
  logger_.set_pattern(pattern_of(options.format));
}

Log::~Log() {
  write_left_out(limiter_.take_all_left_out());
  write_dropped();
}

void Log::operator()(const LogLine& line) {
  if (!logger_.should_log(level_of(line.level))) return;
  if (line.level != LogLevel::kDebug && !limiter_.admits(now_(), line.text)) return;
  write(line);
}

void Log::change(bool verbose, LineLimiter::Limits limits) {
  logger_.set_level(least_level(verbose));
  limiter_.limit(limits);
}

void Log::report_left_out() {
  output_.flush();
  write_left_out(limiter_.take_left_out(now_()));
  write_dropped();
}

void Log::write_dropped() {
  if (const std::uint64_t lines = output_.take_dropped(); lines > 0) {
    write({LogLevel::kWarning,
           fmt::format("{} {} dropped: nobody read the log", lines, lines == 1 ? "line was" : "lines were")});
  }
}

void Log::write_left_out(const std::vector<LineLimiter::LeftOut>& left_out) {
  for (const LineLimiter::LeftOut& kind : left_out) {
    write({LogLevel::kWarning, fmt::format("{} lines like this one were left out: {}", kind.lines, kind.kind)});
  }
}

void Log::write(const LogLine& line) {
  if (sink_) return sink_(line);
  switch (format_) {
    case LogFormat::kText:
      return logger_.log(level_of(line.level), line.text);
    case LogFormat::kJson:
      return logger_.log(level_of(line.level), json_line(line.text));
    case LogFormat::kJournal:
      return logger_.log(level_of(line.level), fmt::format("<{}>{}", priority_of(line.level), line.text));
  }
}

}  // namespace peerd
