#include "peerd/peer/feed/pose_feeds.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <utility>

namespace peerd::feed {
namespace {

constexpr double kUnixTimeMax_s = 9e9;  // the year 2255; int64 nanoseconds end 7 years later

// Makes hostile text fit for a log: one short line of printable ASCII characters.
std::string printable(std::string_view text) {
  std::string line(text.substr(0, 160));
  for (char& c : line) {
    if (c < ' ' || c > '~') c = '?';
  }
  return line;
}

}  // namespace

PoseFeeds::PoseFeeds(Settings settings, const Scene& scene) : stale_(settings.stale) {
  std::vector<std::pair<ObjectId, std::string>> paths;
  for (const auto& [path, object] : settings.objects) paths.emplace_back(object, path);
  std::ranges::sort(paths);
  for (auto& [object, path] : paths) {
    assert(objects_.empty() || objects_.back() != object);
    objects_.push_back(object);
    feeds_.push_back({std::move(path), PoseFeed(scene.rigid_pose(object), stale_)});
  }
  build_index();
}

void PoseFeeds::add(const std::string& path, ObjectId object, const Pose& place) {
  assert(!feeds(object) && !find(path));
  const auto at = std::ranges::lower_bound(objects_, object);
  feeds_.insert(feeds_.begin() + (at - objects_.begin()), Fed{path, PoseFeed(place, stale_)});
  objects_.insert(at, object);
  build_index();
}

void PoseFeeds::remove(ObjectId object) {
  assert(feeds(object));
  const auto at = std::ranges::lower_bound(objects_, object);
  const auto fed = feeds_.begin() + (at - objects_.begin());
  silences_of_removed_ += fed->silences;
  feeds_.erase(fed);
  objects_.erase(at);
  build_index();
}

void PoseFeeds::build_index() {
  by_path_.clear();
  for (std::size_t i = 0; i < feeds_.size(); ++i) by_path_.emplace(feeds_[i].path, i);
}

bool PoseFeeds::feeds(ObjectId object) const { return std::ranges::binary_search(objects_, object); }

bool PoseFeeds::begun(ObjectId object) const { return feeds_[index_of(object)].feed.begun(); }

std::size_t PoseFeeds::index_of(ObjectId object) const {
  const auto at = std::ranges::lower_bound(objects_, object);
  assert(at != objects_.end() && *at == object);
  return static_cast<std::size_t>(at - objects_.begin());
}

Outcome PoseFeeds::push(HostTime now, Duration host_minus_wall, std::span<const FedPose> poses) {
  Outcome outcome;
  const auto push_one = [&](const FedPose& fed) -> std::expected<void, Refusal> {
    const auto at = by_path_.find(fed.object);
    if (at == by_path_.end()) return std::unexpected(Refusal::kObject);
    std::optional<HostTime> stamp;
    if (fed.time_s) {
      if (!(*fed.time_s >= 0.0 && *fed.time_s <= kUnixTimeMax_s)) return std::unexpected(Refusal::kTime);
      stamp = HostTime{from_seconds(*fed.time_s) + host_minus_wall};
    }
    return feeds_[at->second].feed.push(now, stamp, fed.pose);
  };
  for (const FedPose& fed : poses) {
    if (const auto pushed = push_one(fed); pushed) {
      ++outcome.taken;
    } else {
      const Refusal why = pushed.error();
      if (refused_[static_cast<std::size_t>(why)]++ == 0) {
        notice(Notice::Kind::kRefused, printable(fed.object) + " is not used: " + sentence(why));
      }
      outcome.refused.push_back({fed.object, why});
    }
  }
  taken_ += outcome.taken;
  return outcome;
}

void PoseFeeds::refuse_message(const std::string& why) {
  if (messages_refused_++ == 0) notice(Notice::Kind::kNotUnderstood, printable(why));
}

std::optional<ObjectId> PoseFeeds::find(std::string_view path) const {
  const auto at = by_path_.find(path);
  return at == by_path_.end() ? std::nullopt : std::optional(objects_[at->second]);
}

KinematicState PoseFeeds::sample(ObjectId object, HostTime t) {
  Fed& fed = feeds_[index_of(object)];
  if (fed.feed.begun() && !fed.begun) {
    fed.begun = true;
    notice(Notice::Kind::kBegan, fed.path);
  }
  if (const bool silent = fed.feed.silent(t); silent != fed.silent) {
    fed.silent = silent;
    fed.silences += silent;
    notice(silent ? Notice::Kind::kSilent : Notice::Kind::kResumed, fed.path, fed.silences > 1);
  }
  return fed.feed.at(t);
}

std::optional<Notice> PoseFeeds::poll_notice() {
  if (notices_.empty()) return std::nullopt;
  Notice notice = std::move(notices_.front());
  notices_.pop_front();
  return notice;
}

void PoseFeeds::notice(Notice::Kind kind, std::string what, bool again) {
  notices_.push_back({kind, std::move(what), again});
}

void PoseFeeds::count(std::map<std::string, std::uint64_t>& counters) const {
  if (feeds_.empty() && taken_ == 0) return;
  counters["poses_taken"] = taken_;
  counters["poses_refused"] = std::accumulate(refused_.begin(), refused_.end(), std::uint64_t{0});
  for (std::size_t i = 0; i < refused_.size(); ++i) {
    if (refused_[i] > 0) counters[std::string("poses_refused_") + to_string(static_cast<Refusal>(i))] = refused_[i];
  }
  counters["pose_messages_refused"] = messages_refused_;
  counters["feeds_silent"] = std::accumulate(feeds_.begin(), feeds_.end(), silences_of_removed_,
                                             [](std::uint64_t n, const Fed& f) { return n + f.silences; });
}

}  // namespace peerd::feed
