#pragma once
#include <cstdint>
#include <string>

namespace peerd {

enum class LogLevel : std::uint8_t {
  kDebug,    // details: contacts and updates of objects
  kInfo,     // the session changed
  kWarning,  // the world is worse than it should be
  kError,    // a person must act
};

// One line of the log, which states one fact.
struct LogLine {
  LogLevel level;
  std::string text;
};

}  // namespace peerd
