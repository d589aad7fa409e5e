#include "peerd/cli/commands/check_command.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <map>
#include <optional>
#include <ostream>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "collision/contact/containment.hpp"
#include "core/formats/world_kind.hpp"
#include "core/geometry/tessellate.hpp"
#include "core/motion/predefined_motion.hpp"
#include "core/scene/scene_defects.hpp"
#include "core/scene/scene_statistics.hpp"
#include "core/writer/writer.hpp"
#include "peerd/cli/shell/error_json.hpp"
#include "peerd/cli/shell/problems.hpp"
#include "peerd/input/json_text.hpp"
#include "peerd/input/printable.hpp"
#include "peerd/input/text_file.hpp"
#include "peerd/input/world_file.hpp"
#include "replication/physics/world/motion_world.hpp"

namespace peerd {
namespace {

using Json = nlohmann::ordered_json;

// A short text can ask for many more polygons. So many take about 20 s, and 2 GB where half of them are one geometry's,
// which is the most that the reader allows.
constexpr std::uint64_t kMostPolygons = std::uint64_t{1} << 25;

// The number of polygons in the meshes that collision makes of objects that interests name. An object inside another
// one counts again.
std::uint64_t polygons_of_bodies(const Scene& scene) {
  std::vector<std::uint64_t> of_geometry;
  for (const Geometry& geometry : scene.geometries) {
    of_geometry.push_back(mesh_size(geometry, scene.tessellation).polygons);
  }
  std::vector<std::uint64_t> before = {0};  // number of polygons of the instances before each instance
  for (const Instance& instance : scene.instances) {
    const bool solid = instance.geometry != Instance::kNone && instance.collides;
    before.push_back(before.back() + (solid ? of_geometry[instance.geometry] : 0));
  }
  std::set<ObjectId> named;
  for (const CollisionInterest& interest : scene.interests) {
    named.insert(interest.colliders.ends.begin(), interest.colliders.ends.end());
    named.insert(interest.collidees.ends.begin(), interest.collidees.ends.end());
  }
  std::uint64_t polygons = 0;
  for (const ObjectId id : named) polygons += before[scene.at(id).subtree_end] - before[scene.index_of(id)];
  return polygons;
}

// The objects that interests name and whose surface is closed; and which of two that may meet begins inside the other.
struct Enclosures {
  std::vector<ObjectId> closed;
  struct Inside {
    ObjectId inner, outer;
  };
  std::vector<Inside> inside;
};

Enclosures enclosures_of(const replication::WorldModel& model) {
  const SimTime start{};
  const replication::MotionWorld world(model, start, replication::MotionWorld::Watched::kNone);
  Enclosures found;
  std::map<const collision::Surface*, bool> closed;  // several objects may share one
  std::set<ObjectId> seen;
  const auto has_inside = [&](ObjectId id) {
    const collision::Body* const body = model.body(id);
    if (body == nullptr || !body->surface) return false;
    const auto [at, is_new] = closed.try_emplace(body->surface.get(), false);
    if (is_new) at->second = collision::is_closed(body->surface->soup());
    if (at->second && seen.insert(id).second) found.closed.push_back(id);
    return at->second;
  };
  for (const replication::CollisionPair& pair : model.pairs) {
    for (const auto& [inner, outer] : {std::pair{pair.collider, pair.collidee}, {pair.collidee, pair.collider}}) {
      if (!has_inside(outer) || model.body(inner) == nullptr) continue;
      const KinematicState at_inner = world.at(inner, start), at_outer = world.at(outer, start);
      const bool inside = collision::is_inside({*model.body(inner), at_inner}, {*model.body(outer), at_outer});
      const auto same = [&](const Enclosures::Inside& known) { return known.inner == inner && known.outer == outer; };
      if (inside && std::ranges::none_of(found.inside, same)) found.inside.push_back({inner, outer});
    }
  }
  std::ranges::sort(found.closed);
  return found;
}

// Lengths are the sentences of `check` about the unit and the axes of a file that is no VRML97.
struct Lengths {
  std::string format;   // empty: it is VRML97
  std::string taken;    // how its unit and axes are understood, and why
  std::string doubted;  // what looks wrong about them; empty: nothing
};

// The largest extent of the faces of a scene [m]; 0 where it has none.
double largest_extent_m(const Scene& scene) {
  Eigen::AlignedBox3d box;
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    const Geometry* const geometry = scene.geometry(scene.id_of(i));
    const auto* const faces = geometry == nullptr ? nullptr : std::get_if<FaceSetGeometry>(geometry);
    if (faces == nullptr || faces->points.empty()) continue;
    Eigen::AlignedBox3d local;
    for (const Eigen::Vector3f& point : faces->points) local.extend(point.cast<double>());
    const Eigen::Affine3d place = scene.world_from_local(scene.id_of(i));
    for (int corner = 0; corner < 8; ++corner) {
      box.extend(place * local.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)));
    }
  }
  return box.isEmpty() ? 0.0 : box.sizes().maxCoeff();
}

Lengths lengths_of(const WorldFile& file) {
  Lengths lengths;
  if (formats::is_text_of_nodes(file.kind)) return lengths;
  lengths.format = formats::name_of(file.kind);
  const bool says = formats::says_its_unit(file.kind);
  lengths.taken = file.has_unit ? "the unit is as asked for"
                  : says        ? "metres, as the format has it"
                                : "taken as metres: the format says no unit, --unit does";
  lengths.taken += file.has_up ? "; the axis that points up is as asked for"
                   : says      ? "; +Y up, as the format has it"
                               : "; taken as +Y up: the format says no axis, --up does";
  constexpr double kLarge_m = 1000.0, kSmall_m = 0.001;
  const double extent_m = file.result.scene ? largest_extent_m(*file.result.scene) : 0.0;
  if (file.has_unit || extent_m == 0.0 || (extent_m <= kLarge_m && extent_m >= kSmall_m)) return lengths;
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), extent_m, std::chars_format::general, 4).ptr;
  lengths.doubted = "it is " + std::string(text.data(), end) + " m large" +
                    (extent_m > kLarge_m ? "; if its unit is another one, say so: --unit mm"
                                         : ", and no unit of --unit is larger than m: an Inline of it in a Transform "
                                           "with a scale makes it larger");
  return lengths;
}

// All that is printed. Without a file, only the first two members count.
struct Finding {
  std::string path;
  double read_ms = 0.0;
  const ReadResult* result = nullptr;
  const ReadResult* reported = nullptr;  // WorldFile::reported()
  double defects_ms = 0.0;
  SceneStatistics statistics{};  // these three are of a good world
  std::optional<SceneDefects> defects{};
  std::vector<std::string> unsupported{};
  Enclosures enclosures{};
  Lengths lengths{};

  [[nodiscard]] bool good() const { return result != nullptr && result->scene.has_value(); }
};

struct Row {
  const char* name;
  std::uint64_t count;
  const char* what;
};
using StatisticsRows = std::array<Row, 20>;
using DefectRows = std::array<Row, kDefects>;
using EdgeRows = std::array<Row, 4>;

StatisticsRows rows_of(const SceneStatistics& s) {
  return {{{"nodes", s.nodes, "PROTOs expanded"},
           {"instances", s.instances, "groups and shapes; a USE counts again"},
           {"groups", s.groups, ""},
           {"shapes", s.shapes, ""},
           {"shapes_not_colliding", s.shapes_not_colliding, "not chosen, replaced by a proxy, .."},
           {"depth", s.depth, "of the deepest instance"},
           {"geometries", s.geometries, "stored once however often they are used"},
           {"geometries_without_surface", s.geometries_without_surface, "lines, points and text"},
           {"polygons", s.polygons, "of the geometries"},
           {"triangles", s.triangles, "that the polygons are cut into"},
           {"faces", s.faces, "of the polygons: as the files write them"},
           {"face_triangles", s.face_triangles, ""},
           {"polygons_instanced", s.polygons_instanced, "a USE counts again"},
           {"triangles_instanced", s.triangles_instanced, ""},
           {"collision_interests", s.collision_interests, ""},
           {"interests", s.interests, "pairs registered for collision"},
           {"key_sensors", s.key_sensors, ""},
           {"routes", s.routes, ""},
           {"moving_objects", s.moving_objects, "Transforms with a velocity of their own"},
           {"pending_inlines", s.pending_inlines, ""}}};
}

// The rows are in the order of Defect.
DefectRows polygon_rows_of(const SceneDefects& d) {
  return {{{"degenerate", d[Defect::kDegenerate].polygons, "without an area, or whose parts make up for each other"},
           {"duplicate", d[Defect::kDuplicate].polygons, "with the corners of an earlier one"},
           {"non_planar", d[Defect::kNonPlanar].polygons, "by however little, most by rounding alone"},
           {"warped", d[Defect::kWarped].polygons, "non-planar by more than 1/10,000 of the longest edge"},
           {"non_manifold", d[Defect::kNonManifold].polygons, "with an edge of more than two polygons"}}};
}

EdgeRows edge_rows_of(const SceneDefects& d) {
  return {{{"non_manifold_edges", d.non_manifold_edges, "of more than two polygons"},
           {"boundary_edges", d.boundary_edges, "where a surface ends"},
           {"same_direction_edges", d.same_direction_edges, "between a front and a back"},
           {"edges_without_length", d.edges_without_length, ""}}};
}

void print_row(const Row& row, const std::string& where, std::ostream& out) {
  std::string label = std::string("  ") + row.name;
  for (char& c : label) c = c == '_' ? ' ' : c;
  label.resize(30, ' ');
  std::string number = std::to_string(row.count);
  if (number.size() < 10) number.insert(0, 10 - number.size(), ' ');
  out << label << number << (*row.what == '\0' && where.empty() ? "" : "  ") << row.what << where << '\n';
}

std::string first_of(const SceneDefects::Count& count, const Scene& scene) {
  return "; first: " + (count.shape ? scene.path_of(*count.shape) : "a geometry of no Shape") + " polygon " +
         std::to_string(count.polygon);
}

void print_defects(const SceneDefects& defects, const Scene& scene, std::ostream& out) {
  const DefectRows polygons = polygon_rows_of(defects);
  const EdgeRows edges = edge_rows_of(defects);
  const auto some = [](const Row& row) { return row.count > 0; };
  if (std::ranges::none_of(polygons, some) && std::ranges::none_of(edges, some)) {
    out << "no defects of polygons\n";
    return;
  }
  out << "defects\n";
  for (std::size_t i = 0; i < polygons.size(); ++i) {
    if (some(polygons[i])) print_row(polygons[i], first_of(defects.counts[i], scene), out);
  }
  for (const Row& row : edges) {
    if (some(row)) print_row(row, "", out);
  }
}

std::string milliseconds(double ms) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), ms, std::chars_format::fixed, 2).ptr;
  return std::string(text.data(), end) + " ms";
}

std::size_t bytes_of(const ReadResult& result) {
  std::size_t bytes = 0;
  for (const Source& source : result.sources) bytes += source.text.size();
  return bytes;
}

ProblemCount print_problems(const Finding& finding, std::ostream& err) {
  const ProblemCount count = print_problems(*finding.reported, err);
  for (std::size_t i = 0; i < std::min(kShownProblems, finding.unsupported.size()); ++i) {
    err << finding.path << ": note: unsupported: " << finding.unsupported[i] << '\n';
  }
  std::string more;
  const auto add = [&](std::size_t all, const char* what) {
    if (all > kShownProblems) more += (more.empty() ? "" : ", ") + counted(all - kShownProblems, what);
  };
  add(count.errors, "more error");
  add(count.warnings, "more warning");
  add(finding.unsupported.size(), "more unsupported request");
  if (!more.empty()) err << finding.path << ": note: " << more << "; --json lists all\n";
  return count;
}

void print_text(const Finding& finding, std::ostream& out, std::ostream& err) {
  const ProblemCount count = print_problems(finding, err);
  const ReadResult& read = *finding.reported;
  out << finding.path << ": " << (finding.good() ? "good" : counted(count.errors, "error"));
  if (count.warnings > 0) out << ", " << counted(count.warnings, "warning");
  out << "; " << counted(bytes_of(read), "byte") << " in " << counted(read.sources.size(), "file") << " read in "
      << milliseconds(finding.read_ms) << '\n';
  err << lenient_advice(read);
  if (!finding.good()) return;
  if (!finding.lengths.format.empty()) out << finding.lengths.format << ": " << finding.lengths.taken << '\n';
  if (!finding.lengths.doubted.empty()) err << finding.path << ": warning: " << finding.lengths.doubted << '\n';
  for (const Row& row : rows_of(finding.statistics)) {
    if (row.count > 0) print_row(row, "", out);
  }
  if (finding.defects) print_defects(*finding.defects, *finding.result->scene, out);
  const Scene& scene = *finding.result->scene;
  const auto& inside = finding.enclosures.inside;
  for (std::size_t i = 0; i < std::min(kShownProblems, inside.size()); ++i) {
    out << scene.path_of(inside[i].inner) << " begins inside " << scene.path_of(inside[i].outer) << '\n';
  }
  if (inside.size() > kShownProblems) {
    out << counted(inside.size() - kShownProblems, "more object") << " inside another; --json lists all\n";
  }
}

Json defects_to_json(const SceneDefects& defects, const Scene& scene) {
  Json json = Json::object(), first = Json::object();
  const DefectRows polygons = polygon_rows_of(defects);
  for (std::size_t i = 0; i < polygons.size(); ++i) {
    const SceneDefects::Count& count = defects.counts[i];
    json[polygons[i].name] = count.polygons;
    Json& place = first[polygons[i].name];
    if (count.polygons == 0) continue;
    place = {{"shape", count.shape ? Json(scene.path_of(*count.shape)) : Json()}, {"polygon", count.polygon}};
  }
  for (const Row& row : edge_rows_of(defects)) json[row.name] = row.count;
  json["first"] = std::move(first);
  return json;
}

Json to_json(const Finding& finding) {
  Json errors = Json::array(), warnings = Json::array(), statistics, defects, closed, inside;
  std::size_t files = 0, bytes = 0;
  if (finding.reported != nullptr) {
    for (const Diagnostic& d : finding.reported->diagnostics) {
      (d.severity == Severity::kError ? errors : warnings)
          .push_back({{"file", finding.reported->sources.at(d.source).name},
                      {"line", d.where.line},
                      {"column", d.where.column},
                      {"message", d.message}});
    }
    files = finding.reported->sources.size();
    bytes = bytes_of(*finding.reported);
  }
  if (finding.good()) {
    for (const Row& row : rows_of(finding.statistics)) statistics[row.name] = row.count;
    const Scene& scene = *finding.result->scene;
    if (finding.defects) defects = defects_to_json(*finding.defects, scene);
    closed = inside = Json::array();
    for (const ObjectId id : finding.enclosures.closed) closed.push_back(scene.path_of(id));
    for (const auto& [inner, outer] : finding.enclosures.inside) {
      inside.push_back({{"inner", scene.path_of(inner)}, {"outer", scene.path_of(outer)}});
    }
  }
  const auto rounded = [](double ms) { return std::round(ms * 1e3) / 1e3; };  // rounded to microseconds
  return {{"world", finding.path},
          {"good", finding.good()},
          {"errors", std::move(errors)},
          {"warnings", std::move(warnings)},
          {"unsupported", finding.unsupported},
          {"format", finding.lengths.format.empty() ? "VRML97" : finding.lengths.format},
          {"lengths", finding.lengths.taken},
          {"lengths_doubted", finding.lengths.doubted},
          {"statistics", std::move(statistics)},
          {"defects", std::move(defects)},
          {"closed", std::move(closed)},
          {"inside", std::move(inside)},
          {"files", files},
          {"bytes", bytes},
          {"read_ms", rounded(finding.read_ms)},
          {"defects_ms", rounded(finding.defects_ms)}};
}

// Paths and messages may hold bytes that are not UTF-8, which JSON may not.
void print(const Json& json, std::ostream& out) { out << json_text(json) << '\n'; }

// What there is to say although the command has failed: the world can't be read, or its copy not be written.
Json with_error(const Finding& finding, const InputError& error) {
  Json json = to_json(finding);
  json["good"] = false;
  const Json said = error_json(error);
  for (const Json& entry : said["errors"]) json["errors"].push_back(entry);
  return json;
}

double ms_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

Json moving_at(const Scene& scene, double t_s, std::vector<std::string>& unsupported) {
  Json list = Json::array();
  PredefinedMotion motion(scene);
  for (const ObjectId id : motion.driven_transforms()) {
    const Pose pose = motion.rigid_pose(id, t_s);
    const Vec3& p = pose.position;
    const Quat& q = pose.orientation;
    list.push_back({{"path", scene.path_of(id)},
                    {"position", {p.x(), p.y(), p.z()}},
                    {"orientation", {q.x(), q.y(), q.z(), q.w()}}});
  }
  if (const std::optional<double> since = motion.transition_limit_reached_at()) {
    unsupported.push_back("TimeSensors that start each other so often: they stand still from " +
                          std::to_string(*since) + " s on");
  }
  return list;
}

Result<void> write_copy(const Scene& scene, const std::string& copy, std::ostream& err) {
  const auto written = write_world(scene);
  if (!written) return std::unexpected(InputError{copy + ": error: not written: " + written.error(), kFinding});
  for (const std::string& note : written->notes) err << copy << ": note: " << note << '\n';
  return write_text_file(copy, written->text);
}

// Answers what a good world is asked.
void examine(const Scene& scene, Finding& finding) {
  // Interests that collision cannot answer are not errors of the world.
  if (polygons_of_bodies(scene) <= kMostPolygons) {
    const auto model = replication::make_world_model(scene);
    finding.unsupported = model->unsupported;
    finding.enclosures = enclosures_of(*model);
  } else {
    finding.unsupported.push_back("interests in more than " + std::to_string(kMostPolygons) +
                                  " polygons: they are not looked at");
  }
  finding.statistics = statistics_of(scene);
  if (finding.statistics.polygons > kMostPolygons) {
    finding.unsupported.push_back("defects of more than " + std::to_string(kMostPolygons) + " polygons");
    return;
  }
  const auto defects_start = std::chrono::steady_clock::now();
  finding.defects = defects_of(scene);
  finding.defects_ms = ms_since(defects_start);
}

}  // namespace

int run_check(const std::string& path, const CheckOptions& options, std::ostream& out, std::ostream& err) {
  Finding finding{.path = path};
  const auto start = std::chrono::steady_clock::now();
  const auto file = read_world_asked_for(path, options.reading);
  finding.read_ms = ms_since(start);
  const auto failed_with = [&](const InputError& error) {
    err << error.text << '\n';
    if (options.json) print(with_error(finding, error), out);
    return error.exit_code;
  };
  if (!file) return failed_with(file.error());
  finding.result = &(*file)->result;
  finding.reported = &(*file)->reported();
  finding.lengths = lengths_of(**file);
  if (finding.good()) examine(*finding.result->scene, finding);
  Json moving = Json::array();
  if (finding.good() && options.at_s) {
    moving = moving_at(*finding.result->scene, *options.at_s, finding.unsupported);
  }
  if (finding.good() && !options.copy.empty()) {
    const auto written = write_copy(*finding.result->scene, options.copy, err);
    if (!written) return failed_with(written.error());
  }
  if (options.json) {
    Json json = to_json(finding);
    if (options.at_s) json["moving"] = moving;
    print(json, out);
  } else {
    print_text(finding, out, err);
    for (const Json& m : moving) {
      out << "  " << m["path"].get<std::string>() << "  at " << m["position"] << "  turned " << m["orientation"]
          << '\n';
    }
  }
  return finding.good() ? 0 : 1;
}

}  // namespace peerd
