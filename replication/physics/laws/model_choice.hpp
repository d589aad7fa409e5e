#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <optional>

#include <boost/circular_buffer.hpp>

#include "core/prefetch.hpp"
#include "core/time.hpp"
#include "replication/physics/laws/motion_model.hpp"

namespace peerd::replication {

// The models that a sender may choose from, and the evidence by which it chooses.
struct ModelPolicy {
  std::array<bool, std::size(kMotionKinds)> allowed{true, true, true, true,
                                                    true, true, true};  // in the order of kMotionKinds
  double memory_s = 0.5;                   // time constant with which the outcome of an old prediction is forgotten
  double horizon_max_s = 1;                // the farthest ahead that a prediction is judged by
  MotionKind first = MotionKind::kSecond;  // before there is any evidence
};

// A receiver uses what is sent now from `latency_s` on, for `interval_s`.
struct Horizon {
  double latency_s = 0.0, interval_s = 0.25;
  [[nodiscard]] double end_s() const { return latency_s + interval_s; }
};

// Chooses the model that an object's next update should name: the one that, made from what was known a horizon ago,
// would have been nearest to what has followed. It sees samples up to now, nothing else.
//
// A *run* is the samples since the last corner (a jump of velocity or acceleration, as a bounce makes): derivatives
// are not taken across a corner, and no prediction is blamed for one. In a young run only short predictions have an
// outcome yet; an error e at h counts as e (H/h)^p at the horizon H, where p is the first power of time that the model
// leaves out.
class ModelChooser {
 public:
  explicit ModelChooser(const ModelPolicy& policy) : policy_(policy) {}

  // Adds the object's state at t, which is later than that of every call before.
  void push(SimTime t, const KinematicState& state, const Horizon& horizon);

  // Fetches from memory what the next push() will need.
  [[gnu::always_inline]] inline void prefetch() const {
    if (samples_.size() < 2) return;
    peerd::prefetch(&samples_.back(), 2 * sizeof(Sample));  // the last sample, and the place of the next one
    peerd::prefetch(samples_[1].at);
  }

  // The chosen model, based on the last sample. At least one sample has been pushed. Ties go to the simpler model,
  // then to the one chosen before.
  [[nodiscard]] MotionModel choose();
  // The error that the model chosen last would have had at the horizon [m]; infinite where nothing is known.
  [[nodiscard]] double expected_error_m() const { return expected_error_m_; }

 private:
  static constexpr std::size_t kKinds = std::size(kMotionKinds);
  struct Sample {
    KinematicState state;
    SimTime at;
    std::size_t run = 1;  // the number of samples of its run so far, itself included; at most kSamplesMax
  };
  struct Score {
    double weight = 0.0, error = 0.0;  // error [m, rad]: weighted mean
    void add(double e, double share);
  };

  [[nodiscard]] bool make(MotionKind kind, std::size_t i, MotionModel& model) const;
  [[nodiscard]] Vec3 rate_of_change(std::size_t i, Vec3 KinematicState::*what) const;
  [[nodiscard]] bool make_oscillating(std::size_t i, MotionModel& model) const;
  [[nodiscard]] bool make_history(std::size_t i, MotionModel& model) const;
  [[nodiscard]] bool is_corner(const Sample& before, const Sample& now) const;
  void learn_what_is_usual(const Sample& before, const Sample& now);
  void keep(const Sample& now);
  void judge(const Horizon& horizon);

  ModelPolicy policy_;
  boost::circular_buffer<Sample> samples_;
  SimTime judged_at_ = SimTime::min();
  std::size_t judged_ = 1;  // the judged prediction was made so many samples earlier
  std::array<Score, kKinds> scores_{};
  Score spin_constant_, spin_accelerated_;
  double usual_jump_m_s_ = 0.0, usual_change_m_s2_ = 0.0;  // changes of velocity and acceleration from sample to sample
  std::optional<MotionKind> chosen_;
  double expected_error_m_ = std::numeric_limits<double>::infinity();
};

}  // namespace peerd::replication
