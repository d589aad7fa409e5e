#include "peerd/lab/recorded/stretch_writer.hpp"

#include <cassert>
#include <cmath>
#include <cstring>
#include <utility>

#include "peerd/input/compression.hpp"

namespace peerd::recorded {
namespace {

using view::PoseKind;
using view::PoseRow;

// Places are kept in steps of 2^-20 m, a micrometre: the bits below are noise, which does not compress.
constexpr double kSteps_per_m = 1'048'576.0;
// Instants that are meant to be that far apart may differ by rounding.
constexpr double kRounding_s = 1e-6;

PoseRow rounded(PoseRow row) {
  for (double& x : row.position) x = std::round(x * kSteps_per_m) / kSteps_per_m;
  return row;
}

template <class T>
void put(std::string& out, const T& value) {
  char bytes[sizeof value];
  std::memcpy(bytes, &value, sizeof value);
  out.append(bytes, sizeof value);
}

}  // namespace

void StretchWriter::add(double t_s, std::uint32_t revision, std::size_t nodes, const view::PoseTable::Times& times,
                        std::span<const PoseRow> rows) {
  if (open_ && (open_->revision != revision || known_[0].size() != nodes)) interrupt();
  if (!open_) {
    for (auto& known : known_) known.assign(nodes, {});
    open_.emplace(Stretch{.from_s = t_s, .until_s = t_s, .revision = revision});
  }
  assert(t_s >= open_->until_s);
  ++instant_;
  find_changes(rows);
  put_frame(t_s, times);
  if (t_s - open_->from_s >= kStretch_s - kRounding_s) {
    close();
    begin(t_s, times);
  }
}

void StretchWriter::find_changes(std::span<const PoseRow> rows) {
  changed_.clear();
  for (const PoseRow& exact : rows) {
    const PoseRow row = rounded(exact);
    Known& known = known_[row.kind][row.node];
    const bool is_same = known.at != 0 && known.row == row;
    known = {row, instant_};
    if (!is_same) changed_.push_back(row);
  }
  for (auto& kind : known_) {
    for (Known& known : kind) {
      if (known.at == 0 || known.at == instant_) continue;
      PoseRow gone = known.row;
      gone.owner = kNobody.value;
      known.at = 0;
      if (static_cast<PoseKind>(gone.kind) != PoseKind::kShown) changed_.push_back(gone);
    }
  }
}

void StretchWriter::put_frame(double t_s, const view::PoseTable::Times& times) {
  std::string& out = open_->frames;
  put(out, view::kPoseFrameMagic);
  put(out, static_cast<std::uint32_t>(changed_.size()));
  put(out, t_s);
  put(out, times.world_s);
  put(out, times.since_start_s);
  put(out, open_->revision);
  put(out, static_cast<std::uint32_t>(view::kPoseRow_bytes));
  for (const PoseRow& row : changed_) put(out, row);
  rows_ += changed_.size();
  open_->until_s = t_s;
}

// The next stretch begins where the last one ended, with all that is known then.
void StretchWriter::begin(double t_s, const view::PoseTable::Times& times) {
  const std::uint32_t revision = stretches_.back().revision;
  open_.emplace(Stretch{.from_s = t_s, .until_s = t_s, .revision = revision});
  changed_.clear();
  for (const auto& kind : known_) {
    for (const Known& known : kind) {
      if (known.at == instant_) changed_.push_back(known.row);
    }
  }
  put_frame(t_s, times);
}

void StretchWriter::close() {
  Stretch stretch = *std::exchange(open_, std::nullopt);
  stretch.size_bytes = stretch.frames.size();
  stretch.frames = compress(stretch.frames);
  stretch.frames.shrink_to_fit();
  size_bytes_ += sizeof stretch + stretch.frames.size();
  stretches_.push_back(std::move(stretch));
}

void StretchWriter::interrupt() {
  if (open_) close();
}

std::vector<Stretch> StretchWriter::finish() {
  interrupt();
  return std::move(stretches_);
}

}  // namespace peerd::recorded
