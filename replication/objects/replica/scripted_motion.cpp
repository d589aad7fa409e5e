#include "replication/objects/replica/scripted_motion.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>

namespace peerd::replication {
namespace {

// World time [s] beyond which a count of nanoseconds would overflow: 100 years.
constexpr double kFarthest_s = 3.2e9;

bool is_same(const PredefinedMotion::Piece& a, const PredefinedMotion::Piece& b) {
  return a.begin_s == b.begin_s && a.end_s == b.end_s && moves_alike(a.state, b.state) &&
         a.state.orientation.coeffs() == b.state.orientation.coeffs() && a.turning_rad_s == b.turning_rad_s;
}

}  // namespace

ScriptedMotion::ScriptedMotion(const ModelInForce& model) : model_(model) {
  if (!model->moving.empty()) motion_.emplace(*model->scene);
}

void ScriptedMotion::restart() {
  pieces_.clear();
  follow_model();
}

void ScriptedMotion::follow_model() {
  if (!motion_ && !model_->moving.empty()) motion_.emplace(*model_->scene);
  const std::size_t before = pieces_.size();
  for (const ObjectId object : model_->moving) {
    const auto above = model_->carrier_of(object);
    const auto end = pieces_.begin() + static_cast<std::ptrdiff_t>(before);
    const auto known = std::find_if(pieces_.begin(), end, [&](const Piece& p) { return p.object == object; });
    if (known == end) {
      pieces_.push_back({object, above, std::nullopt, std::nullopt});
    } else if (known->carrier != above) {
      known->carrier = above;
      known->known_until.reset();
    }
  }
}

std::vector<ObjectId> ScriptedMotion::follow_scene(SimTime at, std::optional<SimTime> world_zero) {
  motion_.reset();
  std::vector<ObjectId> standing;
  std::erase_if(pieces_, [&](const Piece& p) {
    if (std::ranges::find(model_->moving, p.object) != model_->moving.end()) return false;
    standing.push_back(p.object);
    return true;
  });
  follow_model();
  if (!world_zero) return standing;
  for (Piece& p : pieces_) {
    if (p.last && p.known_until && *p.known_until > at) {
      const PredefinedMotion::Piece now = motion_->piece(p.object, to_seconds(at - *world_zero), p.carrier);
      if (is_same(now, *p.last)) continue;
    }
    p.known_until = p.owned_until = at;
  }
  return standing;
}

void ScriptedMotion::extend(SimTime to, std::optional<SimTime> world_zero, const Owners& owners,
                            const SceneObjects& scene, Replica& replica) {
  assert(replica.begun());
  if (!world_zero) return;
  assert(pieces_.empty() || motion_);
  bool answers = false;
  for (Piece& p : pieces_) {
    if (owners.of(p.object) != kNobody) {
      p.known_until.reset();
      p.owned_until = to;
    } else if (scene.contains(p.object)) {
      answers = true;
    } else {
      while (!p.known_until || *p.known_until <= to) extend(p, to, *world_zero, replica);
    }
  }
  if (answers) extend_answering(to, *world_zero, owners, scene, replica);
}

// An object that answers contacts gets the next piece of its way only if it has met nothing on the last one. Pieces are
// given in order of time, each once both worlds have come to its begin.
void ScriptedMotion::extend_answering(SimTime to, SimTime world_zero, const Owners& owners, const SceneObjects& scene,
                                      Replica& replica) {
  const auto is_due = [&](const Piece& p) {
    return owners.of(p.object) == kNobody && scene.contains(p.object) && !scene.is_moved(p.object) &&
           (!p.known_until || *p.known_until <= to);
  };
  for (;;) {
    Piece* next = nullptr;
    for (Piece& p : pieces_) {
      if (is_due(p) && (next == nullptr || p.known_until < next->known_until)) next = &p;
    }
    if (next == nullptr) return;
    if (next->known_until) {
      const SimTime begin = *next->known_until;
      replica.advance_truth(begin);
      replica.advance_ghosts(begin);
      if (replica.truth().is_moved_by_contact(next->object, begin)) {
        next->known_until = to + Duration{1};  // that contact may still be retracted
        continue;
      }
    }
    extend(*next, to, world_zero, replica);
  }
}

void ScriptedMotion::extend(Piece& p, SimTime to, SimTime world_zero, Replica& replica) {
  // The session time is rounded up, so that the nanosecond lies within the piece.
  const auto session_time = [&](double world_s) {
    return world_zero + Duration{static_cast<std::int64_t>(std::ceil(world_s * 1e9))};
  };
  const SimTime from = p.known_until.value_or(to);
  const PredefinedMotion::Piece piece = motion_->piece(p.object, to_seconds(from - world_zero), p.carrier);
  p.last = piece;
  const SimTime begin = std::max(session_time(piece.begin_s), p.owned_until.value_or(SimTime::min()));
  MotionModel law(piece.state);
  law.rate_rad_s = piece.turning_rad_s;
  if (!piece.turning_rad_s.isZero(0.0)) law.kind = MotionKind::kTurning;
  law = rebased(law, std::max(0.0, to_seconds(begin - world_zero) - piece.begin_s));
  replica.note_change_ahead(p.object);
  replica.truth().set_base(p.object, begin, law);
  replica.ghosts().set_base(p.object, begin, law);
  const bool ends = piece.end_s < kFarthest_s;
  p.known_until = ends ? std::max(session_time(piece.end_s), from + Duration{1}) : SimTime::max();
  assert(*p.known_until > from);
}

Vec3 ScriptedMotion::to_world(SimTime at, std::optional<SimTime> world_zero, ObjectId object, const Vec3& in_parent) {
  if (!motion_ || !world_zero) return model_->scene->to_world(object, in_parent);
  return motion_->to_world(object, in_parent, to_seconds(at - *world_zero));
}

}  // namespace peerd::replication
