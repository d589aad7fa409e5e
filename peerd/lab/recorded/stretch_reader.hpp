#pragma once
#include <functional>
#include <span>
#include <vector>

#include "peerd/lab/recorded/recording.hpp"
#include "peerd/view/frames/pose_frame.hpp"

namespace peerd::recorded {

// Calls `take` with each frame of a stretch in memory: its time and its rows, which are those that have changed.
void read_frames(const Stretch& stretch, const std::function<void(double t_s, std::span<const view::PoseRow>)>& take);

}  // namespace peerd::recorded
