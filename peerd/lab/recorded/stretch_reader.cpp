#include "peerd/lab/recorded/stretch_reader.hpp"

#include <cassert>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>

#include "peerd/input/compression.hpp"

namespace peerd::recorded {
namespace {

constexpr std::size_t kCountAt = 4, kTimeAt = 8;  // in the head of a frame

template <class T>
T taken(const char* at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

}  // namespace

void read_frames(const Stretch& stretch, const std::function<void(double t_s, std::span<const view::PoseRow>)>& take) {
  const auto frames = decompress(stretch.frames, stretch.size_bytes);
  if (!frames) throw std::logic_error("a stretch in memory can't be unpacked: " + frames.error());
  std::vector<view::PoseRow> rows;
  for (std::size_t at = 0; at < frames->size();) {
    const char* const frame = frames->data() + at;
    rows.resize(taken<std::uint32_t>(frame + kCountAt));
    const std::size_t bytes = rows.size() * view::kPoseRow_bytes;
    assert(at + view::kPoseFrameHeader_bytes + bytes <= frames->size());
    if (bytes > 0) std::memcpy(rows.data(), frame + view::kPoseFrameHeader_bytes, bytes);
    take(taken<double>(frame + kTimeAt), rows);
    at += view::kPoseFrameHeader_bytes + bytes;
  }
}

}  // namespace peerd::recorded
