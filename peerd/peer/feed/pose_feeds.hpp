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
#include "peerd/peer/feed/pose_feed.hpp"
#include "peerd/peer/feed/pose_message.hpp"

namespace peerd::feed {

// The outcome for the poses of one message.
struct Outcome {
  struct Refused {
    std::string object;
    Refusal why;
  };
  std::size_t taken = 0;
  std::vector<Refused> refused;
};

// An event that is worth a log line: each object's first pose and its silences, and the first refusal of each kind.
// Counters count all of them.
struct Notice {
  enum class Kind : std::uint8_t { kBegan, kSilent, kResumed, kRefused, kNotUnderstood };
  Kind kind;
  std::string what;    // the object, or the reason
  bool again = false;  // this object has had such an event before
};

// All objects of a peer that external programs move.
class PoseFeeds {
 public:
  struct Settings {
    std::map<std::string, ObjectId> objects;  // by the path that programs use; one path for each object
    Duration stale = std::chrono::milliseconds(500);
  };
  PoseFeeds(Settings settings, const Scene& scene);

  // Takes the poses of one message. Unix time + `host_minus_wall` is the time of this host.
  Outcome push(HostTime now, Duration host_minus_wall, std::span<const FedPose> poses);
  // Counts a datagram that is no message of poses, for the reason `why`.
  void refuse_message(const std::string& why);

  // Poses move this object, too, from now on, under that path; until the first one it stands at `place`. No poses move
  // it yet.
  void add(const std::string& path, ObjectId object, const Pose& place);
  // No poses move the object any more. What is counted of it stays.
  void remove(ObjectId object);

  [[nodiscard]] bool feeds(ObjectId object) const;
  // Whether a pose of the object has been taken. Poses move it.
  [[nodiscard]] bool begun(ObjectId object) const;
  [[nodiscard]] std::span<const ObjectId> objects() const { return objects_; }  // sorted
  [[nodiscard]] std::optional<ObjectId> find(std::string_view path) const;
  // The object's state at a tick or between two; the times that are asked of one object must not decrease.
  [[nodiscard]] KinematicState sample(ObjectId object, HostTime t);
  [[nodiscard]] std::optional<Notice> poll_notice();
  // Adds the counters of all feeds; none where no object has a feed.
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
  [[nodiscard]] std::size_t index_of(ObjectId object) const;

  void build_index();

  Duration stale_;
  std::vector<ObjectId> objects_;  // sorted
  std::vector<Fed> feeds_;         // parallel to objects_
  // Index into both, by path.
  std::unordered_map<std::string, std::size_t, HashOfPath, std::equal_to<>> by_path_;
  std::uint64_t taken_ = 0, messages_refused_ = 0;
  std::uint64_t silences_of_removed_ = 0;
  std::array<std::uint64_t, kRefusals> refused_{};
  std::deque<Notice> notices_;
};

}  // namespace peerd::feed
