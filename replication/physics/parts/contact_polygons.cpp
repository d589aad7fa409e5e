#include "replication/physics/parts/contact_polygons.hpp"

#include <algorithm>
#include <cassert>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "collision/query/mesh_distance.hpp"
#include "collision/query/wide_query.hpp"
#include "replication/physics/laws/composed_motion.hpp"

namespace peerd::replication {
namespace {

using collision::kAdvancementTolerance_m, collision::magnitude, collision::RelativeMotion, collision::WideTree;

// Parts that meet by fine pieces are no farther apart than the tolerance and twice the errors of both
// (part_contact.hpp), and their pieces that far from where they really are.
constexpr double kLeftApart_m = 2.0 * kAdvancementTolerance_m + 6.0 * kFineError_m;

// The soup of a flexible part as it stands, with its hierarchy.
struct StandingForm {
  collision::TriangleSoup soup;
  std::optional<WideTree> tree;
};

// A part of an end where it stands at the contact.
struct StandingPart {
  Pose pose;                                    // world from part
  double near_m = 0.0;                          // what the part adds to how far apart two may be that meet
  WideTree* tree = nullptr;                     // none: it has no polygons
  const collision::Surface* surface = nullptr;  // none: the polygons are those of `shape`
  ObjectId shape;                               // the first Shape of it
  std::shared_ptr<StandingForm> form;           // of a flexible part

  [[nodiscard]] ShapePolygon polygon(std::uint32_t number) const {
    return surface != nullptr ? surface->polygon(number) : ShapePolygon{shape, number};
  }
};

class TouchedPolygonsSearch {
 public:
  TouchedPolygonsSearch(const WorldModel& model, const MotionWorld& world, FlexibleParts* flexible,
                        const ContactEvent& contact)
      : model_(model),
        world_(world),
        flexible_(flexible),
        t_(contact.at),
        a_(parts_of(contact.collider, contact.collider_before)),
        b_(parts_of(contact.collidee, contact.collidee_before)) {}

  [[nodiscard]] std::vector<ShapePair> pairs() {
    for_each_pair([&](const StandingPart& a, const StandingPart& b, const RelativeMotion& motion, bool turned) {
      for (const collision::PolygonPair& pair : query_.all_pairs(*a.tree, *b.tree, motion)) {
        add(a.polygon(pair.a), b.polygon(pair.b), turned);
      }
    });
    if (found_.empty()) add_nearest();
    std::ranges::sort(found_);
    found_.erase(std::ranges::unique(found_).begin(), found_.end());
    return std::move(found_);
  }

 private:
  [[nodiscard]] std::vector<StandingPart> parts_of(ObjectId end, const KinematicState& before) const {
    const std::uint32_t node = model_.index_of(end);
    std::vector<StandingPart> parts;
    if (!is_known(node)) return parts;
    // An answer may have set the end back (CollisionResponse::set_back): its parts went with it.
    const KinematicState now = world_.at(end, t_);
    const bool set_back = now.position != before.position || now.orientation.coeffs() != before.orientation.coeffs();
    for (const std::uint32_t part : model_.parts_of_node[node]) {
      const std::uint32_t frame = model_.frame_of(part);
      if (frame != ModelNode::kNone && !is_known(frame)) return {};
      KinematicState state = frame == ModelNode::kNone ? KinematicState{} : world_.at(model_.nodes[frame].object, t_);
      if (set_back) state = composed(at_rest(before.pose()), relative_to(at_rest(now.pose()), state));
      StandingPart standing = model_.is_flexible(part) ? flexible_part(part) : rigid_part(part);
      if (standing.tree == nullptr) continue;
      const double extent_m = standing.tree->extent_m() + magnitude(standing.tree->origin());
      standing.pose = state.pose();
      standing.near_m +=
          collision::kClockTick_s * (magnitude(state.velocity) + magnitude(state.angular_velocity_body) * extent_m);
      parts.push_back(std::move(standing));
    }
    return parts;
  }

  [[nodiscard]] bool is_known(std::uint32_t node) const {
    for (std::uint32_t i = node; i != ModelNode::kNone; i = model_.nodes[i].carrier) {
      if (!world_.has_history_at(model_.nodes[i].object, t_)) return false;
    }
    return true;
  }

  [[nodiscard]] StandingPart rigid_part(std::uint32_t part) const {
    const collision::Body& body = model_.bodies[part];
    StandingPart standing;
    if (!body.surface || body.surface->soup().faces.empty()) return standing;
    standing.tree = &body.surface->tree();
    standing.surface = body.surface.get();
    standing.shape = body.surface->polygon(0).shape;
    if (body.sphere) standing.near_m = body.sphere->radius_m;
    return standing;
  }

  [[nodiscard]] StandingPart flexible_part(std::uint32_t part) const {
    assert(flexible_ != nullptr);
    const auto number = part - static_cast<std::uint32_t>(model_.nodes.size());
    StandingPart standing;
    standing.form = std::make_shared<StandingForm>();
    FlexibleParts::Form form;
    flexible_->form(number, t_, form);
    if (form.faces.empty()) return {};
    collision::TriangleSoup& soup = standing.form->soup;
    soup.vertices = std::move(form.vertices);
    soup.faces = std::move(form.faces);
    for (const collision::TriangleSoup::Face& face : soup.faces) {
      for (const std::uint32_t corner : face.corners) soup.box.merge(soup.vertices[corner]);
    }
    standing.tree = &standing.form->tree.emplace(soup);
    standing.shape = model_.flexible_part(part).shape;
    standing.near_m = collision::kClockTick_s * flexible_->course(number, t_, collision::kClockTick_s).bounds.speed_m_s;
    return standing;
  }

  // Calls function(a, b, motion, turned) for each part of the one end with each of the other. The part with the lower
  // Shape is `a` and gives the frame, as in SceneQuery; `turned`: it is of the collidee.
  template <class Function>
  void for_each_pair(Function function) const {
    for (const StandingPart& of_a : a_) {
      for (const StandingPart& of_b : b_) {
        const bool turned = of_b.shape < of_a.shape;
        const StandingPart &a = turned ? of_b : of_a, &b = turned ? of_a : of_b;
        function(a, b, RelativeMotion(a.pose, b.pose), turned);
      }
    }
  }

  void add(const ShapePolygon& a, const ShapePolygon& b, bool turned) {
    if (a.shape == b.shape) return;  // what the two ends have in common does not meet itself
    found_.push_back(turned ? ShapePair{b, a} : ShapePair{a, b});
  }

  void add_nearest() {
    double nearest_m = std::numeric_limits<double>::infinity();
    for_each_pair([&](const StandingPart& a, const StandingPart& b, const RelativeMotion& motion, bool) {
      if (a.tree == b.tree) return;
      const double farthest_m = std::min(nearest_m, kLeftApart_m + a.near_m + b.near_m);
      const double apart_m = distance_.distance(*a.tree, *b.tree, motion, {.stop_above_m = farthest_m}).upper_m;
      if (apart_m <= farthest_m) nearest_m = apart_m;
    });
    if (nearest_m == std::numeric_limits<double>::infinity()) return;
    for_each_pair([&](const StandingPart& a, const StandingPart& b, const RelativeMotion& motion, bool turned) {
      if (a.tree == b.tree) return;
      const auto& faces = query_.faces_within(*a.tree, *b.tree, motion, nearest_m + kAdvancementTolerance_m);
      for (const collision::FacePair& pair : faces) {
        add(a.polygon(a.tree->soup().faces[pair.a].polygon), b.polygon(b.tree->soup().faces[pair.b].polygon), turned);
      }
    });
  }

  const WorldModel& model_;
  const MotionWorld& world_;
  FlexibleParts* flexible_;
  SimTime t_;
  std::vector<StandingPart> a_, b_;
  collision::WideQuery query_;
  collision::MeshDistanceQuery distance_;
  std::vector<ShapePair> found_;
};

}  // namespace

TouchedPolygons touched_polygons(const WorldModel& model, const MotionWorld& world, FlexibleParts* flexible,
                                 const ContactEvent& contact) {
  TouchedPolygons touched;
  if (contact.type == CollisionType::kBox) return touched;
  touched.pairs = TouchedPolygonsSearch(model, world, flexible, contact).pairs();
  if (contact.type == CollisionType::kWitness && touched.pairs.size() > 1) touched.pairs.resize(1);
  touched.count = touched.pairs.size();
  if (touched.pairs.size() > TouchedPolygons::kKept) touched.pairs.resize(TouchedPolygons::kKept);
  touched.pairs.shrink_to_fit();
  return touched;
}

}  // namespace peerd::replication
