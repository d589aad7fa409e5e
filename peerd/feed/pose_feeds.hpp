#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "core/ids.hpp"
#include "core/scene/scene.hpp"
#include "peerd/feed/pose_feed.hpp"

namespace peerd::feed {

// One pose as it came: of an object by its path, at that Unix time or, where it says none, when it came.
struct FedPose {
  std::string object;
  std::optional<double> time_s;
  PoseSample pose;
};

// What became of a message.
struct Outcome {
  struct Refused {
    std::string object;
    Refusal why;
  };
  std::size_t taken = 0;
  std::vector<Refused> refused;
};

// Worth a log line: each object's first pose and its silences, and the first refusal of each kind. Counters tell of
// all.
struct Notice {
  enum class Kind : std::uint8_t { kBegan, kSilent, kResumed, kRefused, kNotUnderstood };
  Kind kind;
  std::string what;    // the object; why not
  bool again = false;  // not the first such thing of that object
};

// All objects of a peer that programs outside move.
class PoseFeeds {
 public:
  struct Settings {
    std::map<std::string, ObjectId> objects;  // by the path that programs say; each has one
    Duration stale = std::chrono::milliseconds(500);
  };
  PoseFeeds(Settings settings, const Scene& scene);

  // host_minus_wall turns Unix time into this host's.
  Outcome push(HostTime now, Duration host_minus_wall, std::span<const FedPose> poses);
  // Something came by UDP that was no message of poses.
  void refuse_message(const std::string& why);

  [[nodiscard]] bool feeds(ObjectId object) const;
  [[nodiscard]] std::span<const ObjectId> objects() const { return objects_; }  // sorted
  [[nodiscard]] std::optional<ObjectId> find(std::string_view path) const;
  // The object's state at a tick or between two; the ticks of one object never go back.
  [[nodiscard]] KinematicState sample(ObjectId object, HostTime t);
  [[nodiscard]] std::optional<Notice> poll_notice();
  // Into a peer's counters. Nothing where nothing is fed.
  void count(std::map<std::string, std::uint64_t>& counters) const;

 private:
  struct Fed {
    std::string path;
    PoseFeed feed;
    bool begun = false, silent = false;
    std::uint64_t silences = 0;
  };
  void notice(Notice::Kind kind, std::string what, bool again = false);

  struct HashOfPath : std::hash<std::string_view> {
    using is_transparent = void;
  };
  [[nodiscard]] Fed& fed(ObjectId object);

  std::vector<ObjectId> objects_;  // sorted
  std::vector<Fed> feeds_;         // of each of them
  // An object's place in both.
  std::unordered_map<std::string, std::size_t, HashOfPath, std::equal_to<>> by_path_;
  std::uint64_t taken_ = 0, messages_refused_ = 0;
  std::array<std::uint64_t, kRefusals> refused_{};
  std::deque<Notice> notices_;
};

}  // namespace peerd::feed
