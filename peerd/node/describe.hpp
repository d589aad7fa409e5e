#pragma once
#include <optional>
#include <string>

#include <spdlog/common.h>

#include "core/scene/scene.hpp"
#include "peerd/feed/pose_feeds.hpp"
#include "replication/output/output.hpp"

namespace peerd {

// One line a fact, for the log. Levels: error: somebody must act; warn: the world is worse than it should be; info: the
// session changed; debug: objects met, updates left. Datagrams are not worth a line.
struct LogLine {
  spdlog::level::level_enum level;
  std::string text;
};
[[nodiscard]] std::optional<LogLine> describe(const replication::Output& output, const Scene& scene);
[[nodiscard]] LogLine describe(const feed::Notice& notice);

}  // namespace peerd
