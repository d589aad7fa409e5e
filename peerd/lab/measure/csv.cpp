#include "peerd/lab/measure/csv.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <concepts>
#include <cstddef>
#include <string_view>
#include <vector>

#include "peerd/lab/measure/agreement.hpp"
#include "peerd/lab/measure/lookup.hpp"

namespace peerd::measure {
namespace {

// Appends cells to one growing text. A report may be tens of megabytes with a budget of time, so there are no streams.
class CsvText {
 public:
  explicit CsvText(std::string_view heading) : text_(heading) { text_ += '\n'; }
  void reserve(std::size_t bytes) { text_.reserve(bytes); }

  template <class Number>
  requires std::integral<Number> || std::floating_point<Number> CsvText& number(Number value) {
    std::array<char, 32> digits;  // the longest binary64, -2.2250738585072014e-308, takes 24
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
    text_.append(digits.data(), end);
    text_ += ',';
    return *this;
  }
  CsvText& vector(const Vec3& v) { return number(v.x()).number(v.y()).number(v.z()); }
  CsvText& raw(std::string_view cell) {
    text_ += cell;
    text_ += ',';
    return *this;
  }
  void end_row() { text_.back() = '\n'; }
  [[nodiscard]] std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

std::string quoted(const std::string& cell) {
  if (cell.find_first_of(",\"\r\n") == std::string::npos) return cell;
  std::string out = "\"";
  for (const char c : cell) {
    if (c == '"') out += '"';
    out += c;
  }
  return out + '"';
}

std::string peer_cell(const RunRecord& run, PeerId peer) { return quoted(peer_name(run, peer)); }
std::string object_cell(const RunRecord& run, ObjectId object) { return quoted(object_path(run, object)); }

// PATH NUMBER - PATH NUMBER; .. for each pair that is kept, the polygon of the collider first.
std::string polygons_text(const RunRecord& run, const TouchedPolygons& polygons) {
  const auto name = [&](const ShapePolygon& p) { return object_path(run, p.shape) + ' ' + std::to_string(p.polygon); };
  std::string text;
  for (const ShapePair& pair : polygons.pairs) {
    text += (text.empty() ? "" : "; ") + name(pair.collider) + " - " + name(pair.collidee);
  }
  return text;
}

// Indices of rows in order of time, rows of one instant in their given order.
template <class Row>
std::vector<std::size_t> by_time(const std::vector<Row>& rows) {
  std::vector<std::size_t> order(rows.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return rows[i].t_s; });
  return order;
}

// The rows of views that a table has: every `row_stride`-th row of every `view_stride`-th view.
struct RowChoice {
  std::size_t view_stride = 1, row_stride = 1;

  [[nodiscard]] std::size_t count(std::span<const std::size_t> lengths) const {
    std::size_t rows = 0;
    for (std::size_t i = 0; i < lengths.size(); i += view_stride) rows += (lengths[i] + row_stride - 1) / row_stride;
    return rows;
  }
};

constexpr std::size_t kLeastRowsOfView = 20;  // fewer do not show how an object moves

RowChoice choose_rows(std::span<const std::size_t> lengths, std::size_t most) {
  assert(most > 0);
  RowChoice choice;
  std::size_t least = 0;
  for (const std::size_t length : lengths) least += std::min(length, kLeastRowsOfView);
  choice.view_stride = std::max<std::size_t>(1, (least + most - 1) / most);
  while (choice.count(lengths) > most && choice.row_stride < (std::size_t{1} << 40)) {
    // The quotient of rows that there are and may be is a lower bound for the factor that is missing.
    choice.row_stride = std::max(choice.row_stride + 1, choice.row_stride * choice.count(lengths) / most);
  }
  return choice;
}

// The lengths of all views of all runs, in their order.
std::vector<std::size_t> view_lengths(std::span<const RunRecord> runs) {
  std::vector<std::size_t> lengths;
  for (const RunRecord& run : runs) {
    const GhostSample* last = nullptr;
    for (const GhostSample& s : run.ghost_samples) {
      if (last == nullptr || last->observer != s.observer || last->object != s.object) lengths.push_back(0);
      ++lengths.back();
      last = &s;
    }
  }
  return lengths;
}

RowChoice choose_samples(std::span<const std::size_t> lengths, std::optional<std::size_t> most) {
  return most ? choose_rows(lengths, *most) : RowChoice{};
}

std::size_t kept_traffic(std::span<const RunRecord> runs) {
  std::size_t rows = 0;
  for (const RunRecord& run : runs) rows += run.updates.size() + run.datagrams.size();
  return rows;
}

// Every so many rows of the traffic that is kept are written; 0: none.
std::size_t traffic_stride(std::span<const RunRecord> runs, std::optional<std::size_t> most) {
  if (!most) return 1;
  return *most == 0 ? 0 : std::max<std::size_t>(1, (kept_traffic(runs) + *most - 1) / *most);
}

}  // namespace

RowCount errors_rows(std::span<const RunRecord> runs, std::optional<std::size_t> most) {
  RowCount count;
  const std::vector<std::size_t> lengths = view_lengths(runs);
  if (most != 0u) count.written = choose_samples(lengths, most).count(lengths);
  for (const RunRecord& run : runs) count.of += run.measured ? run.measured->whole.samples() : run.ghost_samples.size();
  return count;
}

RowCount traffic_rows(std::span<const RunRecord> runs, std::optional<std::size_t> most) {
  RowCount count;
  const std::size_t stride = traffic_stride(runs, most);
  if (stride > 0) count.written = (kept_traffic(runs) + stride - 1) / stride;
  for (const RunRecord& run : runs) {
    const bool all = !run.measured;
    count.of += all ? run.updates.size() + run.datagrams.size()
                    : run.measured->whole.updates_sent() + run.measured->whole.datagrams;
  }
  return count;
}

std::string errors_csv(std::span<const RunRecord> runs, std::optional<std::size_t> most) {
  CsvText csv(
      "run,t_s,observer,object,truth_x,truth_y,truth_z,ghost_x,ghost_y,ghost_z,shown_x,shown_y,shown_z,"
      "ghost_error_m,shown_error_m,ghost_angle_error_rad");
  if (most == 0u) return csv.take();
  const std::vector<std::size_t> lengths = view_lengths(runs);
  const RowChoice choice = choose_samples(lengths, most);
  csv.reserve(choice.count(lengths) * 240 + 256);  // a moving object's row is about this long

  std::size_t view = 0;  // number of views before this one
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const RunRecord& run = runs[r];
    for (std::size_t begin = 0; begin < run.ghost_samples.size(); begin += lengths[view++]) {
      if (view % choice.view_stride != 0) continue;
      const GhostSample& first = run.ghost_samples[begin];
      const std::string names = peer_cell(run, first.observer) + ',' + object_cell(run, first.object);
      for (std::size_t i = begin; i < begin + lengths[view]; i += choice.row_stride) {
        const GhostSample& s = run.ghost_samples[i];
        csv.number(r + 1).number(s.t_s).raw(names);
        csv.vector(s.truth.position).vector(s.ghost.position).vector(s.shown.position);
        csv.number(ghost_error_m(s)).number(shown_error_m(s));
        csv.number(angle_between(s.truth.orientation, s.ghost.orientation)).end_row();
      }
    }
  }
  return csv.take();
}

std::string traffic_csv(std::span<const RunRecord> runs, std::optional<std::size_t> most) {
  CsvText csv("run,t_s,sender,kind,object,bytes,threshold_m,reason");
  const std::size_t stride = traffic_stride(runs, most);
  if (stride == 0) return csv.take();
  std::size_t row = 0;  // number of rows before this one, written or not
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const RunRecord& run = runs[r];
    const auto add_update = [&](const UpdateSent& u) {
      if (row++ % stride != 0) return;
      csv.number(r + 1).number(u.t_s).raw(peer_cell(run, u.sender)).raw("update").raw(object_cell(run, u.object));
      csv.number(u.bytes).number(u.threshold_m).raw(quoted(u.reason)).end_row();
    };
    const auto add_datagram = [&](const DatagramSent& d) {
      if (row++ % stride != 0) return;
      csv.number(r + 1).number(d.t_s).raw(peer_cell(run, d.sender)).raw("datagram").raw("");
      csv.number(d.bytes).raw("").raw("").end_row();
    };
    const std::vector<std::size_t> updates = by_time(run.updates);
    auto update = updates.begin();
    for (const std::size_t d : by_time(run.datagrams)) {
      while (update != updates.end() && run.updates[*update].t_s <= run.datagrams[d].t_s)
        add_update(run.updates[*update++]);
      add_datagram(run.datagrams[d]);
    }
    while (update != updates.end()) add_update(run.updates[*update++]);
  }
  return csv.take();
}

std::string collisions_csv(std::span<const RunRecord> runs) {
  CsvText csv(
      "run,t_s,peer,kind,collider,collidee,normal_x,normal_y,normal_z,reported_at_s,verdict,type,polygon_pairs,"
      "polygons");
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const RunRecord& run = runs[r];
    const Agreement judged = agreement(run);
    for (const std::size_t i : by_time(run.contacts)) {
      const ContactRow& c = run.contacts[i];
      csv.number(r + 1).number(c.t_s).raw(peer_cell(run, c.peer)).raw(quoted(c.kind));
      csv.raw(object_cell(run, c.collider)).raw(object_cell(run, c.collidee)).vector(c.normal);
      csv.number(c.reported_at_s).raw(to_string(judged.verdicts[i])).raw(name_of(c.type));
      csv.number(c.polygons.count).raw(quoted(polygons_text(run, c.polygons))).end_row();
    }
  }
  return csv.take();
}

}  // namespace peerd::measure
