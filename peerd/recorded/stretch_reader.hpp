#pragma once
#include <functional>
#include <span>
#include <vector>

#include "peerd/picture/pose_frame.hpp"
#include "peerd/recorded/recording.hpp"

namespace peerd::recorded {

// Calls `take` with each frame of a stretch in memory: its time and its rows, which are those that have changed.
void read_frames(const Stretch& stretch,
                 const std::function<void(double t_s, std::span<const picture::PoseRow>)>& take);

}  // namespace peerd::recorded
