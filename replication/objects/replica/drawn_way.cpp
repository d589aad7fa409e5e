#include "replication/objects/replica/drawn_way.hpp"

#include <algorithm>
#include <cassert>
#include <span>
#include <vector>

#include "collision/contact/box_contact.hpp"
#include "collision/contact/contact_time.hpp"
#include "collision/contact/deforming_contact.hpp"
#include "collision/contact/rigid_step.hpp"

namespace peerd::replication {
namespace {

using collision::ContactState;

// A part that is drawn on a straight way: where it begins, turned as at its end.
struct DrawnPart {
  const collision::Body* body = nullptr;  // none: it is flexible
  KinematicState motion;                  // in one second; of its frame
  FlexibleParts::Form begin, end;         // of a flexible part, in its frame

  [[nodiscard]] Affine at_begin() const { return {motion.orientation.toRotationMatrix(), motion.position}; }
  [[nodiscard]] Affine at_end() const {
    return {motion.orientation.toRotationMatrix(), motion.position + motion.velocity};
  }
};

// The vertices of one side at both ends of the way, in the world.
struct DrawnSoup {
  std::vector<Vec3> at_begin, at_end;
  std::vector<collision::TriangleSoup::Face> faces;

  [[nodiscard]] collision::SoupStep step() const { return {at_begin, at_end, faces}; }
};

// These keep memory between calls, never values.
thread_local collision::SoupImpactQuery drawn_impacts;
thread_local collision::RigidStep drawn_rigid;

DrawnSoup soup_of(const DrawnPart& part) {
  DrawnSoup soup;
  const Affine begin = part.at_begin(), end = part.at_end();
  for (const Vec3& v : part.begin.vertices) soup.at_begin.push_back(multiply(begin.linear, v) + begin.offset);
  for (const Vec3& v : part.end.vertices) soup.at_end.push_back(multiply(end.linear, v) + end.offset);
  soup.faces = part.begin.faces;
  return soup;
}

bool soups_meet(const DrawnPart& a, const DrawnPart& b) {
  assert(a.body == nullptr || b.body == nullptr);
  if (a.body != nullptr) return soups_meet(b, a);
  const DrawnSoup of_a = soup_of(a);
  if (of_a.faces.empty()) return false;
  DrawnSoup of_b;
  collision::SoupStep step_b;
  if (b.body == nullptr) {
    of_b = soup_of(b);
    step_b = of_b.step();
  } else {
    if (b.body->surface == nullptr || b.body->surface->soup().faces.empty()) return false;
    const WorldBox near = collision::swept_box(of_a.step(), 2.0 * collision::kAdvancementTolerance_m);
    drawn_rigid.gather(b.body->surface->tree(), b.at_begin(), b.at_end(), near);
    step_b = drawn_rigid.step();
  }
  const auto state = drawn_impacts.first_impact(of_a.step(), step_b).state;
  return state != collision::SoupImpactState::kSeparated;
}

// The world box of all of an end's parts at one end of the way.
WorldBox box_of(std::span<const DrawnPart> end, bool at_begin) {
  WorldBox box;
  for (const DrawnPart& part : end) {
    const Affine place = at_begin ? part.at_begin() : part.at_end();
    const std::span<const Vec3> vertices =
        part.body != nullptr ? part.body->vertices() : (at_begin ? part.begin : part.end).vertices;
    for (const Vec3& v : vertices) box.merge(Vec3(multiply(place.linear, v) + place.offset));
  }
  return box;
}

// Whether two boxes whose sides go straight from the one place to the other overlap on the way.
bool boxes_meet(std::span<const DrawnPart> a, std::span<const DrawnPart> b) {
  const WorldBox a0 = box_of(a, true), a1 = box_of(a, false), b0 = box_of(b, true), b1 = box_of(b, false);
  if (a0.is_empty() || b0.is_empty()) return false;
  double from = 0.0, until = 1.0;  // they overlap along all axes so far
  for (int axis = 0; axis < 3; ++axis) {
    for (const auto& [gap0, gap1] : {std::pair(a0.lo[axis] - b0.hi[axis], a1.lo[axis] - b1.hi[axis]),
                                     std::pair(b0.lo[axis] - a0.hi[axis], b1.lo[axis] - a1.hi[axis])}) {
      if (gap0 > 0.0 && gap1 > 0.0) return false;
      if (gap0 > 0.0) from = std::max(from, gap0 / (gap0 - gap1));
      if (gap1 > 0.0) until = std::min(until, gap0 / (gap0 - gap1));
    }
  }
  return from <= until;
}

class WayCheck {
 public:
  WayCheck(const DrawnWay& way, const WorldModel& model, const OwnObjects& own, const Replica& replica)
      : way_(way),
        model_(model),
        own_(own),
        replica_(replica),
        node_(model.index_of(way.object)),
        ghost_(replica.ghosts().at(way.object, way.t)) {}

  [[nodiscard]] bool meets(const PartPair& parts) const {
    const CollisionPair& pair = model_.pairs[parts.pair];
    for (const ObjectId end : {pair.collider, pair.collidee}) {
      if (end != way_.object && !replica_.receives(end)) return false;
    }
    if (parts.fixed) return false;
    if (parts.a == ModelNode::kNone) return whole_ends_meet(pair);
    const DrawnPart a = drawn(parts.a, moves(parts.a, parts.common)), b = drawn(parts.b, moves(parts.b, parts.common));
    if (a.body == nullptr || b.body == nullptr) {
      const DrawnPart sides[] = {a, b};
      return pair.type == CollisionType::kBox ? boxes_meet({sides, 1}, {sides + 1, 1}) : soups_meet(a, b);
    }
    const auto as =
        model_.is_answered(pair.collider, pair.collidee) ? collision::MeetAs::kSurfaces : collision::MeetAs::kPolygons;
    const ContactState met =
        collision::first_contact({*a.body, a.motion}, {*b.body, b.motion}, pair.type, 1.0, {as, 0.0}).state;
    return met == ContactState::kContact || met == ContactState::kOverlapped;
  }

 private:
  [[nodiscard]] bool moves(std::uint32_t part, std::uint32_t common) const {
    return model_.any_mover(part, common, [&](std::uint32_t i) { return i == node_; });
  }

  [[nodiscard]] bool whole_ends_meet(const CollisionPair& pair) const {
    bool all = true;
    std::vector<DrawnPart> sides[2];
    for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
      for (const std::uint32_t part :
           model_.parts_of_node[model_.index_of(side == 0 ? pair.collider : pair.collidee)]) {
        const bool moved = moves(part, ModelNode::kNone);
        all = all && moved;
        sides[side].push_back(drawn(part, moved));
      }
    }
    return !all && boxes_meet(sides[0], sides[1]);
  }

  // The world by which the part is drawn: this peer shows its own objects, and what they carry, as they are.
  [[nodiscard]] const MotionWorld& world_of(std::uint32_t part) const {
    const auto is_own = [&](std::uint32_t node) { return own_.contains(model_.nodes[node].object); };
    return model_.any_mover(part, ModelNode::kNone, is_own) ? replica_.truth() : replica_.ghosts();
  }

  [[nodiscard]] DrawnPart drawn(std::uint32_t part, bool moved) const {
    DrawnPart out;
    const std::uint32_t frame = model_.frame_of(part);
    const MotionWorld& world = moved ? replica_.ghosts() : world_of(part);
    KinematicState now;
    Vec3 then = Vec3::Zero();
    if (frame != ModelNode::kNone) {
      const ObjectId object = model_.nodes[frame].object;
      now = world.at(object, way_.t);
      then = !moved && world.has_history_at(object, way_.since) ? world.at(object, way_.since).position : now.position;
    }
    const Vec3 begin = moved ? Vec3(way_.from + (now.position - ghost_.position)) : then;
    out.motion = at_rest({begin, now.orientation});
    out.motion.velocity = moved ? Vec3(way_.to - way_.from) : Vec3(now.position - then);
    if (!model_.is_flexible(part)) {
      out.body = &model_.bodies[part];
      return out;
    }
    const auto form = part - static_cast<std::uint32_t>(model_.nodes.size());
    replica_.flexible()->form(form, way_.t, out.end);
    replica_.flexible()->form(form, moved ? way_.t : way_.since, out.begin);
    if (out.begin.vertices.size() != out.end.vertices.size()) out.begin = out.end;
    return out;
  }

  const DrawnWay& way_;
  const WorldModel& model_;
  const OwnObjects& own_;
  const Replica& replica_;
  std::uint32_t node_;
  KinematicState ghost_;
};

}  // namespace

bool is_free(const DrawnWay& way, const WorldModel& model, const OwnObjects& own, const Replica& replica) {
  if (model.node(way.object) == nullptr) return true;
  const WayCheck check(way, model, own, replica);
  return std::ranges::none_of(model.part_pairs_moved_by(model.index_of(way.object)),
                              [&](std::uint32_t k) { return check.meets(model.part_pairs[k]); });
}

}  // namespace peerd::replication
